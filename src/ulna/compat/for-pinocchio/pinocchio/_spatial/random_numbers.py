"""The random numbers of `Random` and `randomConfiguration`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, final

import numpy as np

_random = np.random.default_rng()
_AT_ONCE = 64


def seed(seed_value: int) -> None:
    """Starts the random numbers of `Random` and `randomConfiguration` anew."""
    global _random
    _random = np.random.default_rng(seed_value)


def generator() -> np.random.Generator:
    """The generator of all random numbers of this package; see `seed`."""
    return _random


@final
class Draws:
    """Random numbers for one object at a call, drawn for many at once: NumPy takes as long for one as for many.

    What is left is dropped when `seed` is called.

    Args:
        normal: How many normal deviates each object takes.
        even: How many numbers from [0, 1) each object takes.
    """

    __slots__ = ("_by", "_even", "_normal", "_rows")

    def __init__(self, normal: int, even: int) -> None:
        self._normal, self._even, self._by = normal, even, None
        self._rows: Iterator[Any] = iter(())

    def __call__(self) -> Any:
        """Normal deviates (normal,), then even numbers (even,)."""
        row = next(self._rows, None) if self._by is _random else None
        return self._draw() if row is None else row

    def _draw(self) -> Any:
        draws = _random
        normal, even = draws.standard_normal((_AT_ONCE, self._normal)), draws.random((_AT_ONCE, self._even))
        self._rows, self._by = zip(normal, even, strict=True), draws  # type: ignore[assignment]
        return next(self._rows)
