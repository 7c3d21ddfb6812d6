"""Writes the loops that make a square matrix symmetric, in blocks that are transposed in registers."""

from __future__ import annotations

from ulna.compiler.codegen.ir_text import BYTES, Lanes
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.rows import transposed
from ulna.compiler.codegen.straight_line import define
from ulna.compiler.codegen.target import Target
from ulna.compiler.language.graph import Graph


def write_mirror(module: Module, name: str, layout: Lanes, target: Target, columns: int) -> None:
    """`void name(ptr matrix)`: copies what is below the diagonal of a square matrix above it.

    Args:
        module: Where the definition goes.
        name: The name of the function.
        layout: The lanes; a block has as many rows and columns.
        target: The processor.
        columns: How many rows and columns the matrix has, at least as many as there are lanes.
    """
    lanes = layout.lanes
    whole = columns // lanes * lanes
    w = Writer(module, Graph(), layout, "", target.arithmetic)
    w.jump("rows")
    w.open_block("rows")
    w.write("%i = phi i64 [ 0, %entry ], [ %i1, %last ]", f"%i1 = add i64 %i, {lanes}")
    w.jump("blocks")
    w.open_block("blocks")
    w.write("%j = phi i64 [ 0, %rows ], [ %j1, %blocks ]", "%is_diagonal = icmp eq i64 %j, %i")
    _write_block(w, columns)
    w.write(f"%j1 = add i64 %j, {lanes}", "%more = icmp ule i64 %j1, %i")
    w.branch("%more", "blocks", "last")
    w.open_block("last")
    w.branch(w.let("again", f"icmp ult i64 %i1, {whole}"), "rows", "rest")
    w.open_block("rest")
    if whole < columns:
        _write_rest(w, whole, columns)
    define(module, name, ["ptr noalias %matrix"], "noinline nounwind #0", w.lines)


def _write_block(w: Writer, columns: int) -> None:
    """The block of rows from %i and columns from %j on, transposed; where it is on the diagonal, only above."""
    lanes, real, truth, align = w.layout.lanes, w.layout.real, w.layout.truth, BYTES[w.layout.dtype]
    rows = []
    for k in range(lanes):
        rows.append(
            w.let(f"row{k}", f"load {real}, ptr {_place(w, f'i{k}', '%i', '%j', k, columns)}, align {align}")
        )
    for k, value in enumerate(transposed(w, rows)):
        bits = ", ".join(f"i1 {str(lane <= k).lower()}" for lane in range(lanes))
        stays = w.let(f"stays{k}", f"select i1 %is_diagonal, {truth} <{bits}>, {truth} zeroinitializer")
        chosen = w.let(f"new{k}", f"select {truth} {stays}, {real} {rows[k]}, {real} {value}")
        w.write(f"store {real} {chosen}, ptr {_place(w, f'j{k}', '%j', '%i', k, columns)}, align {align}")


def _place(w: Writer, name: str, row: str, column: str, k: int, columns: int) -> str:
    """The address of entry (row + k, column)."""
    line = w.let(f"{name}.line", f"add i64 {row}, {k}")
    start = w.let(f"{name}.start", f"mul i64 {line}, {columns}")
    at = w.let(f"{name}.at", f"add i64 {start}, {column}")
    return w.let(f"{name}.p", f"getelementptr {w.layout.dtype}, ptr %matrix, i64 {at}")


def _write_rest(w: Writer, whole: int, columns: int) -> None:
    """The columns beyond the last whole block, number by number."""
    element = w.layout.dtype
    w.jump("others")
    w.open_block("others")
    w.write(f"%r = phi i64 [ {whole}, %rest ], [ %r1, %ended ]", "%r1 = add i64 %r, 1")
    w.jump("entries")
    w.open_block("entries")
    w.write("%c = phi i64 [ 0, %others ], [ %c1, %entries ]")
    value = w.let("entry.value", f"load {element}, ptr {_place(w, 'below', '%r', '%c', 0, columns)}")
    w.write(f"store {element} {value}, ptr {_place(w, 'above', '%c', '%r', 0, columns)}")
    w.write("%c1 = add i64 %c, 1", "%further = icmp ult i64 %c1, %r")
    w.branch("%further", "entries", "ended")
    w.open_block("ended")
    w.branch(w.let("others.more", f"icmp ult i64 %r1, {columns}"), "others", "finished")
    w.open_block("finished")
