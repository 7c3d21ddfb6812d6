"""What code is generated for: the processor, and what follows from it for the layout of the code."""

from __future__ import annotations

from dataclasses import replace

from ulna.compiler.codegen.arithmetic import COMPLETE, Arithmetic
from ulna.compiler.codegen.ir_text import BYTES, DType
from ulna.data_classes import dataclass

_WIDE_FROM = 2500
"""Measured on a Xeon: with sines in registers of 256 bits short code took up to 40 % less time, long code 6 % more."""


@dataclass(frozen=True)
class Target:
    """A processor that code is generated for.

    Attributes:
        triple: Architecture, vendor and system, as LLVM names them.
        cpu: The processor, as LLVM names it.
        features: Its extensions, as LLVM lists them: "+avx2,-avx512f".
        llvm: The version of LLVM.
        register_bytes: Width of the widest SIMD register [byte].
        arithmetic: What it computes in one instruction.
        packed_sines: In code for one sample, how many angles share one vector of sines and cosines.
        wide_from: How many operations code for one sample has at least where it uses registers of more than 256 bits.
        abi: The calling convention, as LLVM names it, such as "lp64d"; empty for that of the system.
        search_lanes: In how many lanes a search for one goal runs: 1, 2, 4 or 8.
        stack_space: The address space of local arrays; 0 where all memory is one.
    """

    triple: str
    cpu: str
    features: str
    llvm: str
    register_bytes: int
    arithmetic: Arithmetic = COMPLETE
    packed_sines: int = 8
    search_lanes: int = 8
    stack_space: int = 0
    abi: str = ""
    wide_from: int = 0

    def lanes(self, element: DType) -> int:
        """How many values of a type the widest register holds, at least two."""
        return max(self.register_bytes // BYTES[element], 2)

    def sines_at_once(self, operations: int, element: DType) -> int:
        """How many angles share one vector of sines and cosines in straight-line code for one sample.

        Args:
            operations: How many operations the code has.
            element: Type of the array elements, "double" or "float".

        Returns:
            The number of angles, at most `packed_sines`.
        """
        most = self.packed_sines if operations >= self.wide_from else 32 // BYTES[element]
        return min(self.packed_sines, most)


def arithmetic_of(triple: str, features: str) -> Arithmetic:
    """What a processor of 64 bits with these extensions computes in one instruction.

    Args:
        triple: Architecture, vendor and system, as LLVM names them.
        features: Its extensions, as LLVM lists them.

    Returns:
        The arithmetic; x86-64 before Haswell (2013) has no fused product and sum.
    """
    is_x86 = triple.startswith(("x86_64", "amd64", "i386", "i686"))
    enabled = {name[1:] for name in features.split(",") if name.startswith("+")}
    return replace(COMPLETE, fused_multiply_add=not is_x86 or bool(enabled & {"fma", "fma4"}))


def wide_from(cpu: str, features: str) -> int:
    """From how many operations on registers of more than 256 bits pay off in straight-line code for one sample.

    On Intel's cores port 1 takes no vector arithmetic, that of single numbers included, while instructions of 512 bits
    are in flight. Processors of AMD, which LLVM calls znver, have no such rule.

    Args:
        cpu: The processor, as LLVM names it.
        features: Its extensions, as LLVM lists them.

    Returns:
        The number; 0 where they always do.
    """
    return _WIDE_FROM if register_bytes(features) > 32 and not cpu.startswith("znver") else 0


def register_bytes(features: str) -> int:
    """Width of the widest SIMD register of a processor with these extensions [byte]."""
    enabled = {name[1:] for name in features.split(",") if name.startswith("+")}
    return 64 if "avx512f" in enabled else 32 if "avx2" in enabled else 16
