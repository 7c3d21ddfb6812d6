"""The random numbers of `Random` and `randomConfiguration`."""

from __future__ import annotations

import numpy as np

_random = np.random.default_rng()


def seed(seed_value: int) -> None:
    """Starts the random numbers of `Random` and `randomConfiguration` anew."""
    global _random
    _random = np.random.default_rng(seed_value)


def generator() -> np.random.Generator:
    """The generator of all random numbers of this package; see `seed`."""
    return _random
