"""The table of the targets of `ulna.export`."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ulna.compiler.runtime.ptx import ARCHITECTURES
from ulna.exporting.record import ExportTarget, Option

_C = ExportTarget(
    name="c",
    text="C99 sources with a header, a test program and a CMakeLists.txt",
    module="ulna.exporting.c.folder",
    options={"test": Option(True, "whether to write a test program with recorded values")},
)

_WASM = ExportTarget(
    name="wasm",
    text="a WebAssembly module and a typed JavaScript module around it, for web pages and node",
    module="ulna.exporting.wasm.folder",
    options={"test": Option(True, "whether to write a test script with recorded values")},
)

_OBJECT = ExportTarget(
    name="object",
    text="an object file for a processor and system (triple=), with a C header and a test program",
    module="ulna.exporting.objects.folder",
    options={
        "triple": Option(
            "x86_64-linux-gnu", "the processor and system, a name of the table in docs/export.md"
        ),
        "cpu": Option("", "the processor, as LLVM names it; empty for that of the table"),
        "features": Option("", 'extensions of the processor, as LLVM names them: "+avx2,+fma"'),
        "lanes": Option(
            0, "in how many lanes searches run; 0 for as many as suit the processor", (0, 1, 2, 4, 8)
        ),
        "test": Option(True, "whether to write a test program with recorded values"),
    },
)

_PTX = ExportTarget(
    name="ptx",
    text="CUDA kernels as assembly text for NVIDIA GPUs, one thread for each sample (experimental)",
    module="ulna.exporting.ptx.folder",
    options={
        "architecture": Option(
            ARCHITECTURES[0], "the oldest GPU that it is to run on, such as sm_75 (Turing)", ARCHITECTURES
        )
    },
)

TARGETS: Mapping[str, ExportTarget] = MappingProxyType(
    {target.name: target for target in (_C, _OBJECT, _WASM, _PTX)}
)
"""The targets by name."""
