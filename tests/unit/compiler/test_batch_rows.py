"""Batches of any length read and write arrays of any strides, for ports of no axis to four."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ulna.compiler import compile

SHAPES = {"a": (), "b": (5,), "c": (3, 4), "d": (2, 1, 3), "e": (2, 3, 2, 2)}


def combined(a: Any, b: Any, c: Any, d: Any, e: Any) -> Any:
    """An output of each rank, each number of which is an exact multiple of one of an input."""
    return e[::-1] * 2.0, d * 4.0, c.T * 2.0, b[::-1] * 8.0, a * 0.5


KERNELS = {dtype: compile(combined, dtype, **SHAPES) for dtype in ("float64", "float32")}


def strided(array: np.ndarray, form: str, rng: np.random.Generator) -> np.ndarray:
    """The same numbers in an array with other strides."""
    if form == "every second row":
        room = rng.normal(size=(2 * len(array), *array.shape[1:])).astype(array.dtype)[::2]
    elif form == "every second number":
        room = rng.normal(size=(*array.shape[:-1], 2 * array.shape[-1])).astype(array.dtype)[..., ::2]
    elif form == "backwards":
        room = np.empty_like(array)[tuple([slice(None, None, -1)] * array.ndim)]
    elif form == "axes in another order":
        room = np.empty_like(array, order="F")
    else:
        return array
    room[...] = array
    return room


@pytest.mark.parametrize("dtype", KERNELS)
@pytest.mark.parametrize(
    "form",
    ["contiguous", "every second row", "every second number", "backwards", "axes in another order"],
)
def test_rows_of_any_strides(form, dtype):
    rng, kernel = np.random.default_rng(3), KERNELS[dtype]
    for rows in (1, 2, 3, 7, 8, 9, 16, 17, 31):
        plain = [rng.normal(size=(rows, *shape)).astype(dtype) for shape in SHAPES.values()]
        expected = [
            np.stack([np.asarray(combined(*row)[k]) for row in zip(*plain, strict=True)]) for k in range(5)
        ]
        given = [strided(x, form, rng) for x in plain]
        outputs = tuple(strided(np.zeros_like(x, dtype), form, rng) for x in expected)
        for found in (kernel(*given), kernel(*given, out=outputs), kernel(*plain, out=outputs)):
            for x, y in zip(found, expected, strict=True):
                assert np.array_equal(x, y.astype(dtype))


def test_a_port_without_numbers():
    kernel = compile(lambda a, b: (a, np.concatenate([a, 2.0 * b])), a=(0,), b=(2,))
    for rows in (1, 3, 8, 11):
        empty, doubled = kernel(np.zeros((rows, 0)), np.ones((2 * rows, 2))[::2])
        assert empty.shape == (rows, 0)
        assert np.array_equal(doubled, np.full((rows, 2), 2.0))
