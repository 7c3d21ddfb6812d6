"""The processors that object files can be written for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import final

from ulna.compiler.codegen.arithmetic import COMPLETE, Arithmetic
from ulna.compiler.codegen.target import Target
from ulna.errors import UnknownName

_BASELINE = Arithmetic(wide_integers=False, minimum_number=False, minimum=False)
_WITHOUT_FMA = Arithmetic(fused_multiply_add=False)


@final
@dataclass(frozen=True)
class Processor:
    """A processor with its system.

    Attributes:
        target: What code is generated for.
        text: Examples, for the documentation.
        undefined: What object files need from elsewhere, in float64.
        undefined_float32: The same in float32.
        suffix: How names of object files end.
        is_relocatable: Whether the code may lie anywhere in memory, as in shared libraries.
    """

    target: Target
    text: str
    undefined: tuple[str, ...] = ()
    undefined_float32: tuple[str, ...] = ()
    suffix: str = ".o"
    is_relocatable: bool = True


def _target(
    triple: str, cpu: str, features: str, arithmetic: Arithmetic, lanes: int = 2, abi: str = ""
) -> Target:
    return Target(triple, cpu, features, "", 16, arithmetic, 2 * lanes, lanes, abi=abi)


_M4 = replace(_BASELINE, double_precision=False)
_SOFT_DOUBLES = ("__aeabi_d2f", "__aeabi_dadd", "__aeabi_dmul", "__aeabi_dsub", "__aeabi_f2d", "__aeabi_ui2d")

PROCESSORS: Mapping[str, Processor] = MappingProxyType(
    {
        "x86_64-linux-gnu": Processor(
            _target("x86_64-unknown-linux-gnu", "x86-64-v2", "", _WITHOUT_FMA), "PCs and servers since 2009"
        ),
        "aarch64-linux-gnu": Processor(
            _target("aarch64-unknown-linux-gnu", "generic", "", COMPLETE), "Raspberry Pi 4, Jetson, Arm servers"
        ),
        "riscv64-linux-gnu": Processor(
            _target("riscv64-unknown-linux-gnu", "generic-rv64", "+m,+a,+f,+d,+c", COMPLETE, 1, "lp64d"),
            "64-bit RISC-V with doubles",
        ),
        "arm-linux-gnueabihf": Processor(
            _target("armv7-unknown-linux-gnueabihf", "cortex-a7", "", _BASELINE, 1),
            "Cortex-A7, 32-bit Raspberry Pi",
            ("floor",),
            ("floorf",),
        ),
        "arm64-apple-macos": Processor(
            _target("arm64-apple-macosx11.0.0", "apple-m1", "", COMPLETE), "Macs with M1 and later"
        ),
        "x86_64-apple-macos": Processor(
            _target("x86_64-apple-macosx10.13.0", "x86-64-v2", "", _WITHOUT_FMA), "Macs with Intel"
        ),
        "x86_64-windows-msvc": Processor(
            _target("x86_64-pc-windows-msvc", "x86-64-v2", "", _WITHOUT_FMA),
            "Windows",
            ("_fltused",),
            ("_fltused",),
            ".obj",
        ),
        "thumbv7em-none-eabihf": Processor(
            _target("thumbv7em-unknown-none-eabihf", "cortex-m7", "", _BASELINE, 1),
            "Cortex-M7 with doubles, without a system",
            is_relocatable=False,
        ),
        "thumbv7em-none-eabihf-m4": Processor(
            _target("thumbv7em-unknown-none-eabihf", "cortex-m4", "", _M4, 1),
            "Cortex-M4, float32 only; a library of doubles serves angles beyond 65,536 rad",
            (),
            (*_SOFT_DOUBLES, "floorf"),
            is_relocatable=False,
        ),
    }
)  # fmt: skip
"""The processors by the names that compilers use."""

_FUSED_CPUS = ("x86-64-v3", "x86-64-v4", "haswell", "skylake", "znver")


def processor(triple: str, cpu: str, features: str, lanes: int) -> Processor:
    """The processor of a name, with changes.

    Args:
        triple: A name of `PROCESSORS`.
        cpu: The processor, as LLVM names it; empty for that of the table.
        features: Extensions to add, as LLVM names them.
        lanes: In how many lanes searches run; 0 for as many as suit the processor.

    Returns:
        The processor.

    Raises:
        UnknownName: If the table has no such name.
    """
    if not isinstance(triple, str) or triple not in PROCESSORS:
        raise UnknownName("triple", triple, PROCESSORS)
    described = PROCESSORS[triple]
    target = described.target
    extensions = ",".join(part for part in (target.features, features) if part)
    arithmetic = target.arithmetic
    enabled = {word.strip()[1:] for word in features.split(",") if word.strip().startswith("+")}
    if enabled & {"fma"} or cpu.startswith(_FUSED_CPUS):
        arithmetic = replace(arithmetic, fused_multiply_add=True)
    target = replace(
        target,
        cpu=cpu or target.cpu,
        features=extensions,
        arithmetic=arithmetic,
        search_lanes=lanes or target.search_lanes,
    )
    return replace(described, target=target)
