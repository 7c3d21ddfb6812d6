"""Reads and writes the rows of a batch: memory holds samples, registers hold lanes, so both ways transpose."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ulna.trace.irtext import BYTES

if TYPE_CHECKING:
    from ulna.trace.emit import Writer


def _rows(to: Writer, port: str) -> list[str]:
    """Pointers to each lane's row."""
    rows = [f"%{port}"]
    for lane in range(1, to.layout.lanes):
        name = f"%{port}.r{lane}"
        to.write(f"{name} = getelementptr i8, ptr {rows[-1]}, i64 %{port}s")
        rows.append(name)
    return rows


def load(to: Writer, port: str, wanted: Sequence[int]) -> Iterator[tuple[int, str]]:
    element, lanes = to.layout.dtype, to.layout.lanes
    if not wanted:
        return
    rows = _rows(to, port)
    for j in wanted:
        vector = "poison"
        for lane, row in enumerate(rows):
            at, value = to.fresh("p"), f"%{port}.{j}.{lane}"
            to.write(f"{at} = getelementptr {element}, ptr {row}, i64 {j}")
            to.write(f"{value} = load {element}, ptr {at}, align {BYTES[element]}")
            if lanes == 1:
                vector = value
            else:
                name = to.fresh()
                to.write(f"{name} = insertelement {to.layout.real} {vector}, {element} {value}, i32 {lane}")
                vector = name
        yield j, vector


def store(to: Writer, port: str, values: Sequence[str]) -> None:
    """Writes `values[j]` of every lane to element j of the lane's row."""
    element, lanes = to.layout.dtype, to.layout.lanes
    if not values:
        return
    rows = _rows(to, port)
    if lanes == 1:
        for j, value in enumerate(values):
            at = to.fresh("p")
            to.write(f"{at} = getelementptr {element}, ptr {rows[0]}, i64 {j}")
            to.write(f"store {element} {value}, ptr {at}, align {BYTES[element]}")
        return
    # Transpose in registers, a power of two of columns at a time, so that each row is written in wide stores.
    j = 0
    while j < len(values):
        columns = lanes
        while columns > len(values) - j:
            columns //= 2
        wide = f"<{columns} x {element}>" if columns > 1 else element
        for row, chunk in zip(rows, _transpose(to, values[j : j + columns]), strict=True):
            at = to.fresh("p")
            to.write(f"{at} = getelementptr {element}, ptr {row}, i64 {j}")
            to.write(f"store {wide} {chunk}, ptr {at}, align {BYTES[element]}")
        j += columns


def _transpose(to: Writer, columns: Sequence[str]) -> list[str]:
    """From `columns` (vectors over lanes) the rows (vectors over columns), one for each lane."""
    lanes, element = to.layout.lanes, to.layout.dtype
    if len(columns) == 1:
        rows = []
        for lane in range(lanes):
            name = to.fresh()
            to.write(f"{name} = extractelement {to.layout.real} {columns[0]}, i32 {lane}")
            rows.append(name)
        return rows
    # Interleave halves of the columns: after each round a vector holds twice as many columns of half the lanes.
    vectors, count = list(columns), len(columns)
    width = lanes  # numbers in one vector
    groups: list[list[str]] = [vectors]  # groups[k] covers lanes k * lanes / len(groups) ..., its vectors the columns
    held = 1  # columns in one vector
    while held < count:
        following: list[list[str]] = []
        for group in groups:
            low, high = [], []
            half = len(group) // 2
            for a, b in zip(group[:half], group[half:], strict=True):
                for side, target in ((0, low), (1, high)):
                    target.append(_interleave(to, a, b, width, side))
            following += [low, high]
        groups, held = following, held * 2
    # Each group now has one vector: `width / count` rows of `count` columns each.
    rows = []
    for group in groups:
        for k in range(width // count):
            if width == count:
                rows.append(group[0])
                continue
            name = to.fresh()
            mask = ", ".join(f"i32 {k * count + c}" for c in range(count))
            kind = f"<{width} x {element}>"
            to.write(f"{name} = shufflevector {kind} {group[0]}, {kind} poison, <{count} x i32> <{mask}>")
            rows.append(name)
    return rows


def _interleave(to: Writer, a: str, b: str, width: int, side: int) -> str:
    """Low (0) or high (1) half of a0 b0 a1 b1 ..."""
    start = side * width // 2
    mask = ", ".join(f"i32 {start + i // 2 + (width if i % 2 else 0)}" for i in range(width))
    name = to.fresh()
    kind = f"<{width} x {to.layout.dtype}>"
    to.write(f"{name} = shufflevector {kind} {a}, {kind} {b}, <{width} x i32> <{mask}>")
    return name
