"""Writes the factorisation M = L^T diag(d) L of a matrix with the zeros of a tree, by rows in SIMD lanes.

A row k has entries in the columns of its path, the ancestors of k from the root on, and in its own. The path of an
ancestor i is the beginning of the path of k, so that both rows lie side by side in memory, and row i loses multiples
of the rows of its descendants: row_i -= (row_k)_i / d_k row_k, k > i (Featherstone 2008, table 6.3, gathered by i).
"""

from __future__ import annotations

from collections.abc import Sequence

from ulna.compiler.codegen.ir_text import BYTES, Lanes
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.columns import PADDING, row_places
from ulna.compiler.language.graph import Graph


def write_row_factors(
    module: Module, name: str, paths: Sequence[Sequence[int]], layout: Lanes, target: Target
) -> None:
    """`void name(ptr rows, ptr table)`: from the rows of M, which are overwritten, L and then 1/d, into the table.

    Both arrays have the places of `row_places`, the table also one for each 1/d; they must not overlap. Lanes after the
    diagonal hold no meaningful numbers afterwards.

    Args:
        module: Where the definition goes.
        name: The name of the function.
        paths: For each row its columns before the diagonal, rising.
        layout: The widest registers to use.
        target: The processor.
    """
    layout = Lanes(min(layout.lanes, PADDING), layout.dtype)
    w = Writer(module, Graph(), layout, "", target.arithmetic)
    places, size = row_places(paths)
    below: list[list[int]] = [[k for k, path in enumerate(paths) if i in path] for i in range(len(paths))]
    for i in reversed(range(len(paths))):
        chunks = range(0, len(paths[i]) + 1, layout.lanes)
        row = [_load(w, "rows", places[i] + c, layout.real) for c in chunks]
        for k in reversed(below[i]):
            factor = w.in_all_lanes(layout.dtype, _load(w, "rows", places[k] + len(paths[i]), layout.dtype))
            for number, c in enumerate(chunks):
                product = w.binary("fmul", factor, _load(w, "table", places[k] + c, layout.real))
                row[number] = w.binary("fsub", row[number], product)
        pivot, inverse = w.fresh("d"), w.fresh("r")
        number, lane = divmod(len(paths[i]), layout.lanes)
        w.write(f"{pivot} = extractelement {layout.real} {row[number]}, i64 {lane}")
        w.write(f"{inverse} = fdiv {layout.dtype} {Lanes(1, layout.dtype).constant(1.0)}, {pivot}")
        _store(w, "table", size + i, layout.dtype, inverse)
        everywhere = w.in_all_lanes(layout.dtype, inverse)
        for number, c in enumerate(chunks):
            _store(w, "rows", places[i] + c, layout.real, row[number])
            _store(w, "table", places[i] + c, layout.real, w.binary("fmul", row[number], everywhere))
    head = f"define internal void @{name}(ptr noalias %rows, ptr noalias %table) noinline nounwind #0 {{"
    module.definitions[name] = "\n".join([head, "entry:", *w.lines, "  ret void", "}", ""])


def _place(w: Writer, array: str, index: int) -> str:
    name = w.fresh("p")
    w.write(f"{name} = getelementptr {w.layout.dtype}, ptr %{array}, i64 {index}")
    return name


def _load(w: Writer, array: str, index: int, kind: str) -> str:
    place, name = _place(w, array, index), w.fresh("x")
    w.write(f"{name} = load {kind}, ptr {place}, align {BYTES[w.layout.dtype]}")
    return name


def _store(w: Writer, array: str, index: int, kind: str, value: str) -> None:
    place = _place(w, array, index)
    w.write(f"store {kind} {value}, ptr {place}, align {BYTES[w.layout.dtype]}")
