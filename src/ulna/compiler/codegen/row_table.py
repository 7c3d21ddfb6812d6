"""Writes the rows of large outputs out of a scratch of columns: a loop over a table of places, so code stays short.

The matrices of a humanoid have a thousand entries; transposing them in straight code would take as much code as
computing them. Many of their chunks hold nothing but zeros, which need no transposing.
"""

from __future__ import annotations

from collections.abc import Sequence

from ulna.compiler.codegen.ir_text import BYTES
from ulna.compiler.codegen.node_writer import Writer
from ulna.compiler.codegen.rows import rows_of, store, transposed
from ulna.compiler.codegen.scheduling import chunks
from ulna.compiler.codegen.straight_line import at


def write_rows(to: Writer, port: str, places: Sequence[int], zero: int | None) -> None:
    """Writes all columns of `port`; column j lies in `places[j]` of the scratch, zeros in `zero`.

    Args:
        to: Where the instructions are written.
        port: Name of the output.
        places: For each column its place in the scratch, or `zero`.
        zero: The place that holds zeros, if there is one.
    """
    lanes, size = to.layout.lanes, len(places)
    full_chunks = size // lanes
    if full_chunks:
        _loop(to, port, [places[k * lanes : (k + 1) * lanes] for k in range(full_chunks)], zero)
    for start, width in chunks(lanes, size):
        if start >= full_chunks * lanes:
            columns = [_loaded_value(to, place) for place in places[start : start + width]]
            store(to, port, start, columns)


def _loop(to: Writer, port: str, table: Sequence[Sequence[int]], zero: int | None) -> None:
    """The chunks that are as wide as there are lanes; the first place of one that is zero is given as -1."""
    lanes = to.layout.lanes
    flat = [-1 if set(row) == {zero} else place for row in table for place in row]
    kind = f"[{len(flat)} x i32]"
    to.module.declare(f"@{port}.places = private constant {kind} [{', '.join(f'i32 {x}' for x in flat)}]")
    rows = rows_of(to, port)
    before, head, some, none, after = (
        to.current_block,
        *(f"{port}.{word}" for word in ("chunk", "some", "none", "end")),
    )
    following = f"{port}.next"
    to.write(f"br label %{head}")
    to.open_block(head)
    to.write(f"%{port}.k = phi i64 [ 0, %{before} ], [ %{port}.k1, %{following} ]")
    to.write(f"%{port}.column = mul i64 %{port}.k, {lanes}")
    to.write(f"%{port}.t = getelementptr i32, ptr @{port}.places, i64 %{port}.column")
    to.write(f"%{port}.first = load i32, ptr %{port}.t\n  %{port}.nothing = icmp slt i32 %{port}.first, 0")
    to.write(f"br i1 %{port}.nothing, label %{none}, label %{some}")
    to.open_block(none)
    _put(to, port, rows, ["zeroinitializer"] * lanes)
    to.jump(following)
    to.open_block(some)
    columns = []
    for j in range(lanes):
        pointer, narrow, place = to.fresh("p"), to.fresh(), to.fresh()
        to.write(
            f"{pointer} = getelementptr i32, ptr %{port}.t, i64 {j}\n  {narrow} = load i32, ptr {pointer}"
        )
        to.write(f"{place} = zext i32 {narrow} to i64")
        columns.append(_loaded_value(to, place))
    _put(to, port, rows, transposed(to, columns))
    to.jump(following)
    to.open_block(following)
    to.write(f"%{port}.k1 = add i64 %{port}.k, 1\n  %{port}.over = icmp eq i64 %{port}.k1, {len(table)}")
    to.write(f"br i1 %{port}.over, label %{after}, label %{head}")
    to.open_block(after)


def _put(to: Writer, port: str, rows: Sequence[str], values: Sequence[str]) -> None:
    """Stores a chunk of each row."""
    layout = to.layout
    for row, value in zip(rows, values, strict=True):
        pointer = to.fresh("p")
        to.write(f"{pointer} = getelementptr {layout.dtype}, ptr {row}, i64 %{port}.column")
        to.write(f"store {layout.real} {value}, ptr {pointer}, align {BYTES[layout.dtype]}")


def _loaded_value(to: Writer, place: int | str) -> str:
    pointer, value = at(to, place), to.fresh("w")
    to.write(f"{value} = load {to.layout.real}, {pointer}")
    return value
