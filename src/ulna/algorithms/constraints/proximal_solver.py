"""The forces that constraints need, by the proximal point algorithm: also where some are redundant.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| G | Delassus matrix: what forces do to the constraint acceleration; semidefinite | (m, m) | [1/kg] ... | |
| b | acceleration that the forces must bring about | (m) | [m/s^2] ... | G f = b |
| r | proximal parameter: `mu` times the mean diagonal entry of G; see below | () | | |
| s_n | step n | (m) | | (G + r 1) s_1 = b, (G + r 1) s_n+1 = r s_n |
| f_n | forces after it | (m) | [N], [N m] | f_n = s_1 + ... + s_n |
| r s_n | what is left of b after it | (m) | | b - G f_n = r s_n |

f_n minimises f'Gf/2 - b'f + r |f - f_n-1|^2 / 2, started from zero: it stays in the range of G where b is, and
comes to the solution of least sum of squares, by a factor r / (r + least eigenvalue above zero) a round. One
factorisation serves all rounds. Where b is outside the range (constraints that contradict each other) no forces are
right, s_n comes to rest along those directions, and f_n grows by s_n a round for ever. Then r^2 (G + r 1)^-2 f is taken
off, which is f along those directions and next to nothing along others; what stays are the forces of least squares.

r must be above the rounding errors of G: else what is factored has eigenvalues below r, and steps grow from round to
round. In single precision each row therefore has an r of its own, larger by 1e-6 of its diagonal entry; and as steps
come to rest at rounding errors where constraints depend on each other, rounds end there when steps hardly shrink.
Neither is done for `mu` of 1e-6 and more.
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
from ulna.numeric import vector
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
_NEXT = 1.0 + 1e-10
"""A number that is 1 in single precision."""
_ROUNDING = 1e-6
"""In single precision: what part of a diagonal entry its rounding errors are below, some sixteen roundings."""
_STALLED = 0.7
"""In single precision: rounds end when the residual is more than this part of the one before."""
_DIVERGED = 1e3
"""In double precision the same; of exact factors no residual is so many times the one before, or times b."""
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
    one = 1.0 + 0.0 * mean
    if settings.mu == 0.0:
        return Solution(Factors(G, _floors(diagonal, mean)).solve(b), one)
    r, shrinking = _damping(diagonal, mean, settings.mu)
    factors = Factors(G + np.eye(m) * vector(*r)[..., None, :], [_IMMOVABLE] * m)
    first = factors.solve(b)
    if settings.iterations == 1:
        return Solution(first, one)

    def by_r(x: Sequence[Any]) -> list[Any]:
        return [part * entry for part, entry in zip(r, x, strict=True)]

    def unfinished(*state: Any) -> Any:
        return (state[-1] > threshold) & (state[-1] <= state[-2])

    def round_(*state: Any) -> tuple[Any, ...]:
        count, _, residual = state[2 * m :]
        step = factors.solve(state[m : 2 * m])
        forces = [f + s for f, s in zip(state, step, strict=False)]
        left = by_r(step)
        return (*forces, *left, count + 1.0, shrinking * residual, largest(left))

    def without_null_space(*state: Any) -> tuple[Any, ...]:
        null_space = factors.solve(by_r(factors.solve(by_r(state[:m]))))
        return (*(f - s for f, s in zip(state, null_space, strict=False)), *state[m:])

    threshold, limit = settings.tolerance * largest(b), _DIVERGED * largest(b)
    left = by_r(first)
    start = (*first, *left, one, limit, largest(left))
    *end, _, residual = numeric.loop(unfinished, round_, start, settings.iterations - 1)
    start = (*end[:m], limit, residual)
    forces = numeric.loop(unfinished, without_null_space, start, _PURGES)
    return Solution(list(forces[:m]), end[2 * m])


def _floors(diagonal: Sequence[Any], mean: Any) -> list[Any]:
    """What pivots without damping must be above."""
    dependent = _by_precision(mean, _DEPENDENT_PIVOT, _ROUNDING)
    return [dependent * entry + _NEGLIGIBLE * mean + _IMMOVABLE for entry in diagonal]


def _damping(diagonal: Sequence[Any], mean: Any, mu: float) -> tuple[list[Any], Any]:
    """r of each row, and what part of the residual before a residual is at most for the rounds to go on."""
    if mu >= _ROUNDING:
        return [mu * mean] * len(diagonal), _DIVERGED
    rounding = _by_precision(mean, 0.0, _ROUNDING)
    return [mu * mean + rounding * entry for entry in diagonal], _by_precision(mean, _DIVERGED, _STALLED)


def _by_precision(scale: Any, double: float, single: float) -> Any:
    """A constant in double precision; another in single precision, and where the scale, not below zero, is zero."""
    return numeric.where(numeric.less(scale, scale * _NEXT), double, single)


def largest(values: Sequence[Any]) -> Any:
    """The largest absolute value."""
    return reduce(numeric.maximum, [abs(value) for value in values])


def largest_entry(x: Array) -> Any:
    """The largest absolute value along the last axis."""
    return largest([x[..., i] for i in range(x.shape[-1])])
