"""The random numbers of `Random` and `randomConfiguration`: a generator of NumPy, and one that compiled code runs."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ulna.numeric import cos, less, sin, sqrt, where
from ulna.typing import Array, Floats

_random = np.random.default_rng()
STATE: Floats = np.zeros(6)
"""The state of the generator that compiled code runs: an input and an output of every kernel that draws numbers."""
_MODULI = 4294967087.0, 4294944443.0
_FACTORS = (1403580.0, 810728.0), (527612.0, 1370589.0)


def seed(seed_value: int) -> None:
    """Starts the random numbers of `Random` and `randomConfiguration` anew."""
    _start(np.random.SeedSequence(seed_value))


def _start(sequence: np.random.SeedSequence) -> None:
    global _random
    _random = np.random.default_rng(sequence)
    words = sequence.spawn(1)[0].generate_state(6).reshape(2, 3)
    STATE[:] = (words % (np.array(_MODULI)[:, None].astype(np.uint64) - 1) + 1).ravel()


_start(np.random.SeedSequence())


def generator() -> np.random.Generator:
    """The generator of random numbers for what is not compiled; see `seed`."""
    return _random


class Random(NamedTuple):
    """A function of random numbers, for `BoundFunctions`.

    Attributes:
        function: A function of numbers from (0, 1), (even,); it can be traced.
        even: How many numbers it takes.
    """

    function: Any
    even: int

    def of_state(self, state: Array) -> tuple[Array, Array]:
        """The function of the next numbers.

        Args:
            state: The state of the generator (6,) [-].

        Returns:
            Its result, and the state afterwards (6,).
        """
        draws, state = drawn(self.even, state)
        return self.function(np.stack(draws)), state


def drawn(count: int, state: Array) -> tuple[list[Any], Array]:
    """Numbers from (0, 1) by the combined recursions MRG32k3a, which are exact in floating point.

    [L'Ecuyer 1999, Good parameters and implementations for combined multiple recursive random number generators,
    Operations Research 47(1), figure I]

    Args:
        count: How many.
        state: The state of the generator (6,) [-].

    Returns:
        The numbers, and the state afterwards (6,).
    """
    first, second = list(state[:3]), list(state[3:])
    numbers = []
    for _ in range(count):
        (a, b), (c, d) = _FACTORS
        first = [*first[1:], _remainder(a * first[1] - b * first[0], _MODULI[0])]
        second = [*second[1:], _remainder(c * second[2] - d * second[0], _MODULI[1])]
        gap = first[2] - second[2]
        numbers.append(where(less(0.0, gap), gap, gap + _MODULI[0]) * (1.0 / (_MODULI[0] + 1.0)))
    return numbers, np.stack([*first, *second])


def _remainder(x: Any, modulus: float) -> Any:
    """x modulo a number, for whole numbers below 2^53; the quotient may be off by one either way."""
    rest = x - np.floor(x * (1.0 / modulus)) * modulus
    rest = where(less(rest, 0.0), rest + modulus, rest)
    return where(less(rest, modulus), rest, rest - modulus)


def normal_deviates(draws: list[Any]) -> list[Any]:
    """Normal deviates of an even count of numbers from (0, 1) [Box and Muller 1958].

    Args:
        draws: The numbers.

    Returns:
        As many deviates.
    """
    deviates = []
    for u, turn in zip(draws[::2], draws[1::2], strict=True):
        radius = sqrt(-2.0 * np.log(u))
        deviates += [radius * cos(2.0 * np.pi * turn), radius * sin(2.0 * np.pi * turn)]
    return deviates
