"""The table of the targets of `ulna.export`."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

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
)

TARGETS: Mapping[str, ExportTarget] = MappingProxyType({target.name: target for target in (_C, _WASM)})
"""The targets by name."""
