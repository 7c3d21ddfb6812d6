"""Writes a function whose matrices are packed: the whole matrices in local arrays, then copies of the stored entries.

A loop over a table of places copies some entries at a time; written out, it would take more code than computing them.
"""

from __future__ import annotations

from collections.abc import Sequence

from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.sample_loops import begin_loop, end_loop, item
from ulna.compiler.codegen.straight_line import define
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.packed import PackedForm
from ulna.compiler.language.graph import Graph

_AT_ONCE = 8
"""Entries that are copied in one iteration."""


def write_packed(
    module: Module, name: str, form: PackedForm, whole: str, target: Target, element: DType
) -> None:
    """`void name(ptr in, ..., ptr out, ...)`, which calls the function of whole matrices.

    Args:
        module: Where the definitions go.
        name: The name of the function.
        form: Its form.
        whole: The name of the function that computes whole matrices, which is written already.
        target: The processor.
        element: Type of the array elements, "double" or "float".
    """
    inputs = [f"ptr %i{k}" for k in range(len(form.inputs))]
    lines, results, copies = [], [], []
    for k, (port, places) in enumerate(zip(form.whole.outputs, form.places, strict=True)):
        if places is None:
            results.append(f"ptr %o{k}")
            continue
        lines.append(f"  %whole{k} = alloca [{max(port.size, 1)} x {element}], align 64")
        results.append(f"ptr %whole{k}")
        if places:
            _write_copy(module, f"{name}.copy{k}", places, target, element)
            copies.append(f"  call void @{name}.copy{k}(ptr %whole{k}, ptr %o{k})")
    lines.append(f"  call void @{whole}({', '.join([*inputs, *results])})")
    arguments = [*inputs, *(f"ptr %o{k}" for k in range(len(form.outputs)))]
    define(module, name, arguments, "noinline nounwind #0", [*lines, *copies])


def _write_copy(module: Module, name: str, places: Sequence[int], target: Target, element: DType) -> None:
    """`void name(ptr whole, ptr stored)`: entry k is that of `places[k]`."""
    w = Writer(module, Graph(), Lanes(1, element), "", target.arithmetic)
    together = len(places) // _AT_ONCE
    if together:
        numbers = ", ".join(f"i32 {place}" for place in places[: together * _AT_ONCE])
        kind = f"[{together * _AT_ONCE} x i32]"
        module.declare(f"@{name}.places = private constant {kind} [{numbers}]")
        begin_loop(w, "at")
        first = w.let("first", f"mul i64 %at, {_AT_ONCE}")
        table = w.let("table", f"getelementptr i32, ptr @{name}.places, i64 {first}")
        into = w.let("into", f"getelementptr {element}, ptr %stored, i64 {first}")
        for k in range(_AT_ONCE):
            _copy(w, item(w, f"place{k}", table, k), into, k, element)
        end_loop(w, "at", str(together))
    for k in range(together * _AT_ONCE, len(places)):
        _copy(w, places[k], "%stored", k, element)
    define(module, name, ["ptr noalias %whole", "ptr noalias %stored"], "noinline nounwind", w.lines)


def _copy(w: Writer, place: int | str, into: str, k: int, element: DType) -> None:
    source, value, target = w.fresh("p"), w.fresh("x"), w.fresh("p")
    w.write(f"{source} = getelementptr {element}, ptr %whole, i64 {place}")
    w.write(f"{value} = load {element}, ptr {source}, align {BYTES[element]}")
    w.write(f"{target} = getelementptr {element}, ptr {into}, i64 {k}")
    w.write(f"store {element} {value}, ptr {target}, align {BYTES[element]}")
