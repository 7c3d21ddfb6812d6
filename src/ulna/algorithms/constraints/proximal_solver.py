"""The forces that constraints need, by the proximal point algorithm: also where some are redundant.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| G | Delassus matrix: what forces do to the constraint acceleration; semidefinite | (m, m) | [1/kg] ... | |
| b | acceleration that the forces must bring about | (m) | [m/s^2] ... | G f = b |
| r | proximal parameter: `mu` times the mean diagonal entry of G | () | | |
| s_n | step n | (m) | | (G + r 1) s_1 = b, (G + r 1) s_n+1 = r s_n |
| f_n | forces after it | (m) | [N], [N m] | f_n = s_1 + ... + s_n |
| r s_n | what is left of b after it | (m) | | b - G f_n = r s_n |

f_n minimises f'Gf/2 - b'f + r |f - f_n-1|^2 / 2, started from zero: it stays in the range of G where b is, and
comes to the solution of least sum of squares, by a factor r / (r + least eigenvalue above zero) a round. One
factorisation serves all rounds. Where b is outside the range (constraints that contradict each other) no forces are
right, s_n comes to rest along those directions, and f_n grows by s_n a round for ever. Then r^2 (G + r 1)^-2 f is taken
off, which is f along those directions and next to nothing along others; what stays are the forces of least squares.
Source: Carpentier, Budhiraja & Mansard, Proximal and sparse resolution of constrained dynamic equations, RSS 2021,
section IV; Parikh & Boyd, Proximal algorithms (2014), section 4.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from ulna import numeric
from ulna.algorithms.constraints.proximal_settings import Proximal
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.typing import Array


class Solution(NamedTuple):
    """Forces, and how many rounds they took."""

    forces: list[Any]
    iterations: Any


_DEPENDENT_PIVOT = 1e-12
"""A pivot that keeps less than this part of its diagonal entry belongs to a row that depends on others."""
_NEGLIGIBLE = 1e-14
"""A diagonal entry that is less than this part of the mean one is zero but for rounding."""
_IMMOVABLE = 1e-24
"""A pivot [1/kg, 1/(kg m^2)] that is not above this is that of something no force moves."""
_PURGES = 3
"""How often the part of the forces in the null space is subtracted; each time all but about `mu` of them go."""


def solve_proximal(G: Array, b: Sequence[Any], settings: Proximal) -> Solution:
    """Solves G f = b: the f of least length where there are many, of least error where there are none.

    Args:
        G: Symmetric positive semidefinite matrix, shape (..., m, m).
        b: m numbers, or batches of numbers.
        settings: The proximal parameter, and when to stop.

    Returns:
        f with G f = b, and the number of rounds.
    """
    m = len(b)
    diagonal = [G[..., i, i] for i in range(m)]
    mean = sum(diagonal[1:], diagonal[0]) * (1.0 / m)
    if settings.mu == 0.0:
        floors = [_DEPENDENT_PIVOT * entry + _NEGLIGIBLE * mean + _IMMOVABLE for entry in diagonal]
        return Solution(Factors(G, floors).solve(b), 1.0 + 0.0 * mean)
    r = settings.mu * mean
    raised = G + np.eye(m) * (r[..., None, None] if isinstance(r, np.ndarray) else r)
    factors = Factors(raised, [_IMMOVABLE] * m)
    first = factors.solve(b)
    threshold = settings.tolerance * largest(b)

    def unfinished(*state: Any) -> Any:
        return state[-1] > threshold

    def round_(*state: Any) -> tuple[Any, ...]:
        forces, step, count = state[:m], state[m : 2 * m], state[2 * m]
        step = factors.solve([r * s for s in step])
        return (*(f + s for f, s in zip(forces, step, strict=True)), *step, count + 1.0, r * largest(step))

    def without_null_space(forces: Sequence[Any]) -> list[Any]:
        null_space = factors.solve([r * s for s in factors.solve([r * f for f in forces])])
        return [f - s for f, s in zip(forces, null_space, strict=True)]

    start = (*first, *first, 1.0 + 0.0 * mean, r * largest(first))
    if settings.iterations == 1:
        return Solution(first, start[2 * m])
    *end, residual = numeric.loop(unfinished, round_, start, settings.iterations - 1)
    forces = numeric.loop(
        lambda *state: state[-1] > threshold,
        lambda *state: (*without_null_space(state[:m]), state[m]),
        (*end[:m], residual),
        _PURGES,
    )
    return Solution(list(forces[:m]), end[2 * m])


def largest(values: Sequence[Any]) -> Any:
    """The largest absolute value."""
    return reduce(numeric.maximum, [abs(value) for value in values])


def largest_entry(x: Array) -> Any:
    """The largest absolute value along the last axis."""
    return largest([x[..., i] for i in range(x.shape[-1])])
