"""Arrays of every layout: rows and numbers in a row with gaps, backwards, transposed, repeated, barely aligned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, final

import numpy as np

_INSIDE = ("dense", "dense", "gaps", "backwards", "transposed")
_ROWS = ("dense", "dense", "gaps", "backwards", "by columns")


@final
@dataclass
class Laid:
    """A batch of samples somewhere in a larger block of memory."""

    array: np.ndarray
    block: np.ndarray  # the memory, with room on both sides
    name: str

    @property
    def strides(self) -> tuple[int, ...]:
        """From row to row, then inside a row [byte]."""
        return self.array.strides

    def addresses(self) -> np.ndarray:
        """Of every number, a row for each sample."""
        index = np.indices(self.array.shape).reshape(self.array.ndim, -1)
        offsets = np.asarray(self.array.strides) @ index
        rows = self.array.shape[0]
        return (self.array.ctypes.data + offsets).reshape(rows, self.array.size // max(rows, 1))


def laid(
    rng: np.random.Generator,
    rows: int,
    shape: tuple[int, ...],
    dtype: Any,
    repeats: bool,
    allocate: Callable[[int], np.ndarray] | None = None,
) -> Laid:
    """An array of a random layout.

    Args:
        rng: Chooses the layout.
        rows: How many samples.
        shape: Of one sample.
        dtype: Of the numbers.
        repeats: Whether strides may be 0.
        allocate: Makes the memory, as many numbers as there are from the first to the last; by default there is
            some room on both sides, and the alignment is that of one number.
    """
    inside = rng.choice([*_INSIDE, "repeated"] if repeats else _INSIDE)
    between = rng.choice([*_ROWS, "repeated"] if repeats else _ROWS)
    axes = len(shape)
    order = range(axes) if inside == "transposed" else reversed(range(axes))
    strides, step = [0] * axes, 1 + int(rng.integers(1, 3)) * (inside == "gaps")
    for axis in order:
        strides[axis] = step
        step *= max(shape[axis], 1)
    packed = step
    row = packed + int(rng.integers(1, 4)) * (between == "gaps")
    if between == "by columns":
        strides, row = [s * max(rows, 1) for s in strides], 1
    if inside == "repeated" and axes:
        strides[int(rng.integers(axes))] = 0
    if between == "repeated":
        row = 0
    everything = np.array([row * (-1 if between == "backwards" else 1), *strides])
    if inside == "backwards" and axes:
        everything[1 + int(rng.integers(axes))] *= -1
    ends = [(n - 1) * s for n, s in zip((rows, *shape), everything, strict=True)] if rows else [0]
    low, high = sum(min(e, 0) for e in ends), sum(max(e, 0) for e in ends)
    size = np.dtype(dtype).itemsize
    extent = int(high - low) + 1 if rows else 0
    first = 0 if allocate else 16 + int(rng.integers(0, 16))
    block = allocate(extent) if allocate else np.zeros(first + extent + 32, dtype)
    array = np.lib.stride_tricks.as_strided(
        block[first - low :], (rows, *shape), tuple(int(s) * size for s in everything), writeable=True
    )
    return Laid(array, block, f"{inside} rows, {between}")
