"""Functions and searches as a WebAssembly module."""

from __future__ import annotations

from ulna.compiler import Function
from ulna.compiler.codegen.arithmetic import Arithmetic
from ulna.compiler.codegen.module import emit_library
from ulna.compiler.codegen.target import Target
from ulna.compiler.runtime.cross_compile import cross_compile
from ulna.errors import InputError
from ulna.exporting.record import Export
from ulna.exporting.wasm.linking import PAGE, Linked, linked

LANES = 2
"""In how many lanes a search runs: as many as a register has numbers; four and eight spill."""

TARGET = Target(
    triple="wasm32-unknown-unknown",
    cpu="mvp",
    features="+simd128,+sign-ext,+mutable-globals",
    llvm="",
    register_bytes=16,
    arithmetic=Arithmetic(fused_multiply_add=False, wide_integers=False, minimum_number=False),
    packed_sines=2,
    search_lanes=LANES,
)
"""WebAssembly with registers of 128 bits, as in all browsers since 2023."""

_STACK = 2 * PAGE  # beside what large functions hand on between their parts, and records of loops


def traced(export: Export) -> dict[str, Function]:
    """All functions of an export by name; searches in `LANES` lanes.

    Args:
        export: What is exported.

    Returns:
        The functions.
    """
    functions = {f.name: f.function for f in export.functions}
    return {**functions, **{s.name: s.function(TARGET.search_lanes) for s in export.searches}}


def places(functions: dict[str, Function], item: int) -> tuple[dict[str, list[int]], int]:
    """Where inputs and outputs of each function lie, from the first free byte on; functions share the memory.

    Args:
        functions: The functions by name.
        item: The size of a number [byte].

    Returns:
        For each function the offsets of its inputs and then of its outputs, and how much memory they need [byte].
    """
    offsets: dict[str, list[int]] = {}
    most = 0
    for name, f in functions.items():
        at, offsets[name] = 0, []
        for port in (*f.inputs, *f.outputs):
            offsets[name].append(at)
            at += -(-port.size * item // 16) * 16
        most = max(most, at)
    return offsets, most


def module(export: Export, functions: dict[str, Function], data_size: int) -> Linked:
    """The WebAssembly module.

    Args:
        export: What is exported.
        functions: Its functions, from `traced`.
        data_size: How much memory arguments and results need [byte].

    Returns:
        The module, whose exports are `memory` and the functions by name.

    Raises:
        InputError: If searches are to be computed in float32, or a function has a name that is taken.
        TooLargeError: If a function is larger than browsers accept.
    """
    if export.searches and export.dtype.name == "float32":
        raise InputError(
            f"{export.searches[0].name!r} is a search, which needs float64 to reach its tolerance; dtype is float32. "
            "Export it with dtype=numpy.float64, and other functions with float32 to another folder."
        )
    element = "float" if export.dtype.name == "float32" else "double"
    names = {f"ulna_{name}": name for name in functions}
    ir = emit_library([(f"ulna_{name}", f) for name, f in functions.items()], TARGET, element)
    has_loops = any(f.has_loops for f in functions.values())
    content = cross_compile(ir, TARGET, has_loops, position_independent=False)
    scratch = 8 * max(f.operations + f.tape_size for f in functions.values())
    return linked(content, names, _STACK + scratch, data_size)
