"""Reads and writes the rows of a batch: memory holds samples, registers hold lanes, so both ways transpose.

A row is read and written in chunks of a power of two of columns, each with one wide instruction. Between `w` vectors
that hold whole rows, w columns of each, and `w` vectors that hold one column each, log2(w) rounds of shuffles exchange
the bits of a vector's number with the low bits of the place in it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ulna.compiler.codegen.ir_text import BYTES
from ulna.compiler.codegen.node_writer import Writer
from ulna.compiler.codegen.scheduling import chunks


def load(to: Writer, port: str, size: int, wanted: Sequence[int]) -> Iterator[tuple[int, str]]:
    """The columns `wanted` of `size` in a row, each with its value in all lanes.

    Args:
        to: Where the instructions are written.
        port: Name of the input or output.
        size: Number of columns of a row.
        wanted: Which columns are read, in rising order.

    Yields:
        Pairs of a column and the name of its value in all lanes.
    """
    if not wanted:
        return
    if to.layout.lanes == 1 or to.one_sample:
        for j in wanted:
            value = _read(to, f"%{port}", j, 1)
            yield j, to.in_all_lanes(to.layout.dtype, value) if to.one_sample else value
        return
    rows = rows_of(to, port)
    for start, width in chunks(to.layout.lanes, size):
        chosen = [j for j in wanted if start <= j < start + width]
        if chosen:
            columns = _columns(to, [_read(to, row, start, width) for row in rows], width)
            yield from ((j, columns[j - start]) for j in chosen)


def store(to: Writer, port: str, start: int, values: Sequence[str]) -> None:
    """Writes neighbouring columns, one of `chunks`, of every lane to the lane's row.

    Args:
        to: Where the instructions are written.
        port: Name of the input or output.
        start: The first column.
        values: Names of the values of the columns in all lanes; their number is a power of two.
    """
    if to.layout.lanes == 1 or to.one_sample:
        for j, value in enumerate(values, start):
            _write(to, f"%{port}", j, 1, _of_first_lane(to, value) if to.one_sample else value)
        return
    for row, part in zip(rows_of(to, port), transposed(to, values), strict=True):
        _write(to, row, start, len(values), part)


def rows_of(to: Writer, port: str) -> list[str]:
    """Pointers to each lane's row.

    Args:
        to: Where the instructions are written.
        port: Name of the input or output.

    Returns:
        One name for each lane.
    """
    if port not in to.rows:
        rows = to.rows[port] = [f"%{port}"]
        for lane in range(1, to.layout.lanes):
            name = f"%{port}.r{lane}"
            to.write(f"{name} = getelementptr i8, ptr {rows[-1]}, i64 %{port}s")
            rows.append(name)
    return to.rows[port]


def _of_first_lane(to: Writer, value: str) -> str:
    first = to.fresh("f")
    to.write(f"{first} = extractelement {to.layout.real} {value}, i64 0")
    return first


def _read(to: Writer, row: str, start: int, width: int) -> str:
    element, at, value = to.layout.dtype, to.fresh("p"), to.fresh("w")
    to.write(f"{at} = getelementptr {element}, ptr {row}, i64 {start}")
    to.write(f"{value} = load {_kind(to, width)}, ptr {at}, align {BYTES[element]}")
    return value


def _write(to: Writer, row: str, start: int, width: int, value: str) -> None:
    element, at = to.layout.dtype, to.fresh("p")
    to.write(f"{at} = getelementptr {element}, ptr {row}, i64 {start}")
    to.write(f"store {_kind(to, width)} {value}, ptr {at}, align {BYTES[element]}")


def _kind(to: Writer, width: int) -> str:
    return to.layout.dtype if width == 1 else f"<{width} x {to.layout.dtype}>"


def _columns(to: Writer, parts: Sequence[str], width: int) -> list[str]:
    """From a part of each lane's row, `width` columns wide, those columns, each a vector over lanes."""
    lanes, element = to.layout.lanes, to.layout.dtype
    if width == 1:
        column = "poison"
        for lane, part in enumerate(parts):
            name = to.fresh()
            to.write(f"{name} = insertelement {to.layout.real} {column}, {element} {part}, i32 {lane}")
            column = name
        return [column]
    vectors = []
    for k in range(width):  # rows k, k + w, k + 2 w ... in one register
        group = list(parts[k::width])
        while len(group) > 1:
            size = lanes // len(group)
            group = [
                _shuffle(to, size, a, b, range(2 * size))
                for a, b in zip(group[::2], group[1::2], strict=True)
            ]
        vectors += group
    return _exchange(to, vectors)


def transposed(to: Writer, columns: Sequence[str]) -> list[str]:
    """The inverse of `_columns`: from columns, vectors over lanes, the part of each lane's row.

    Args:
        to: Where the instructions are written.
        columns: Names of the columns, a power of two of them.

    Returns:
        Names of the parts, one for each lane.
    """
    lanes, width = to.layout.lanes, len(columns)
    if width == 1:
        parts = []
        for lane in range(lanes):
            parts.append(to.fresh())
            to.write(f"{parts[-1]} = extractelement {to.layout.real} {columns[0]}, i32 {lane}")
        return parts
    vectors = _exchange(to, columns)
    if width == lanes:
        return vectors
    return [
        _shuffle(to, lanes, vectors[lane % width], "poison", range(first, first + width))
        for lane in range(lanes)
        for first in [lane // width * width]
    ]


def _exchange(to: Writer, vectors: Sequence[str]) -> list[str]:
    """Swaps the bits of a vector's number with the low bits of the place in it; its own inverse."""
    lanes, vectors = to.layout.lanes, list(vectors)
    bit = 1
    while bit < len(vectors):
        for k in range(len(vectors)):
            if not k & bit:
                a, b = vectors[k], vectors[k | bit]
                low = [lanes + i - bit if i & bit else i for i in range(lanes)]
                high = [lanes + i if i & bit else i + bit for i in range(lanes)]
                vectors[k], vectors[k | bit] = _shuffle(to, lanes, a, b, low), _shuffle(to, lanes, a, b, high)
        bit *= 2
    return vectors


def _shuffle(to: Writer, size: int, a: str, b: str, places: Sequence[int]) -> str:
    """Picks `places` from a and b one after the other, vectors of `size` elements."""
    name, kind = to.fresh(), f"<{size} x {to.layout.dtype}>"
    mask = ", ".join(f"i32 {place}" for place in places)
    to.write(f"{name} = shufflevector {kind} {a}, {kind} {b}, <{len(places)} x i32> <{mask}>")
    return name
