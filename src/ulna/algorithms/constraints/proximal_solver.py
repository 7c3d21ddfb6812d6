"""The forces that constraints need, by the proximal point algorithm: also where some are redundant.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| G | Delassus matrix: what forces do to the constraint acceleration; semidefinite | (m, m) | [1/kg] ... | |
| b | acceleration that the forces must bring about | (m) | [m/s^2] ... | G f = b |
| r | proximal parameter: `mu` times the mean diagonal entry of G | () | | |
| s_n | step n | (m) | | (G + r 1) s_1 = b, (G + r 1) s_n+1 = r s_n |
| f_n | forces after it | (m) | [N], [N m] | f_n = s_1 + ... + s_n |
| r s_n | what is left of b after it | (m) | | b - G f_n = r s_n |
| e, R | in single precision: what is left of b; a diagonal matrix | (m), (m, m) | | below |

f_n minimises f'Gf/2 - b'f + r |f - f_n-1|^2 / 2, started from zero: it stays in the range of G where b is, and
comes to the solution of least sum of squares, by a factor r / (r + least eigenvalue above zero) a round. One
factorisation serves all rounds. Where b is outside the range (constraints that contradict each other) no forces are
right, s_n comes to rest along those directions, and f_n grows by s_n a round for ever. Then r^2 (G + r 1)^-2 f is taken
off, which is f along those directions and next to nothing along others; what stays are the forces of least squares.

In single precision the rounding errors of G are larger than r, and would be in the forces, multiplied by the condition
number of G. There r is larger. With `refine`, f starts from s_1, of which r (G + r 1)^-1 of itself is taken
off twice: it has nothing along directions that G lacks, as forces of least squares. Then

* R takes the place of r 1, a part of the diagonal of G: so rows are scaled alike, whatever their units;
* e is computed anew in every round, as b - Y' D^-1 (Y f), which has no rounding errors of G (iterative refinement,
  Higham 2002, chapter 12): the errors that are left grow with the root of the condition number;
* a step is s - (G + R)^-1 R s with (G + R) s = e: along directions that G lacks, where e is rounding, there is none;
* the rounds end when e . step, the energy of a step, does not shrink any more; that step is not taken;
* where constraints contradict each other, these rounds lead to least squares weighted by R: f is where it started.

Source: Carpentier, Budhiraja & Mansard, Proximal and sparse resolution of constrained dynamic equations, RSS 2021,
section IV; Parikh & Boyd, Proximal algorithms (2014), section 4.1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
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


_NEGLIGIBLE = 1e-14
"""A diagonal entry that is less than this part of the mean one is zero but for rounding."""
_IMMOVABLE = 1e-24
"""A pivot [1/kg, 1/(kg m^2)] that is not above this is that of something no force moves."""
_PURGES = 3
"""How often the part of the forces in the null space is subtracted; each time all but about `mu` of them go."""

_SINGLE_MU = 2.0**-19
"""In single precision: the least `mu`, 16 roundings, and R as a part of the diagonal of G."""
_SINGLE_NEGLIGIBLE = 1e-12
"""In single precision: what part of the mean diagonal entry is added to R: rows of rounding errors get no force."""
_SHRINKING = 0.8
"""In single precision: rounds go on while the energy of a step is below this part of that before."""
_SETTLED = 2.0**-44
"""In single precision: rounds end when a step has this part of the largest energy, the square of four roundings."""
_CONTRADICTION = 1e-3
"""In single precision: constraints contradict each other where more than this part of b is left."""
_UNKNOWN = 1e38
"""Above all energies."""


def dependent_part(scale: Any) -> Any:
    """A pivot that keeps less than this part of its diagonal entry belongs to a row that depends on others.

    Args:
        scale: An entry of the diagonal, or their mean, shape (...) [1/kg, 1/(kg m^2)].

    Returns:
        The part, shape (...) [-].
    """
    return numeric.by_precision(scale, 1e-12, 2.0**-20)


def solve_proximal(
    G: Array,
    b: Sequence[Any],
    settings: Proximal,
    product: Callable[[Sequence[Any]], Sequence[Any]] | None = None,
) -> Solution:
    """Solves G f = b: the f of least length where there are many, of least error where there are none.

    Args:
        G: Symmetric positive semidefinite matrix, shape (..., m, m).
        b: m numbers, or batches of numbers.
        settings: The proximal parameter, and when to stop.
        product: G f for the entries of f, from the factors that G is the product of; None for the product with G.

    Returns:
        f with G f = b, and the number of rounds.
    """
    m = len(b)
    diagonal = [G[..., i, i] for i in range(m)]
    mean = sum(diagonal[1:], diagonal[0]) * (1.0 / m)
    if settings.mu == 0.0:
        part = dependent_part(mean)
        floors = [part * entry + _NEGLIGIBLE * mean + _IMMOVABLE for entry in diagonal]
        return Solution(Factors(G, floors).solve(b), 1.0 + 0.0 * mean)
    needs_more = settings.mu < _SINGLE_MU
    refines = settings.refine and needs_more
    mu: Any = _SINGLE_MU if refines else settings.mu
    if needs_more and not refines:
        mu = numeric.by_precision(mean, mu, _SINGLE_MU)
    r = mu * mean
    damped = _damped(G, [r] * m)
    first = damped.factors.solve(b)
    if settings.iterations == 1:
        return Solution(first, 1.0 + 0.0 * mean)
    if refines:
        scaled = _damped(G, [_SINGLE_MU * entry + _SINGLE_NEGLIGIBLE * mean for entry in diagonal])
        start = damped.without_null_space(damped.without_null_space(first))
        threshold = _CONTRADICTION * largest(b)
        found = _refined(b, product or _times(G), scaled, start, threshold, settings.iterations)
    else:
        threshold = settings.tolerance * largest(b)
        found = _rounds(damped.factors, r, first, threshold, settings.iterations)
    return Solution(_purged(damped, found, threshold), found.count)


class _Found(NamedTuple):
    """Forces, the rounds they took, and the largest entry of what is left of b."""

    forces: Sequence[Any]
    count: Any
    left: Any


class _Damped(NamedTuple):
    """G + R."""

    factors: Factors
    R: Sequence[Any]

    def null_space(self, f: Sequence[Any]) -> list[Any]:
        """(G + R)^-1 R f: the part of f along directions that G lacks, and little of the rest."""
        return self.factors.solve([part * entry for part, entry in zip(self.R, f, strict=True)])

    def without_null_space(self, f: Sequence[Any]) -> list[Any]:
        """The rest of f."""
        return [x - y for x, y in zip(f, self.null_space(f), strict=True)]


def _damped(G: Array, R: Sequence[Any]) -> _Damped:
    """G + R, from the diagonal of R."""
    m = len(R)
    return _Damped(Factors(G + np.eye(m) * vector(*R)[..., None, :], [_IMMOVABLE] * m), R)


def _rounds(factors: Factors, r: Any, first: Sequence[Any], threshold: Any, limit: int) -> _Found:
    """The rounds from the first step on, while more than a threshold is left."""
    m = len(first)

    def unfinished(*state: Any) -> Any:
        return state[-1] > threshold

    def round_(*state: Any) -> tuple[Any, ...]:
        forces, step, count = state[:m], state[m : 2 * m], state[2 * m]
        step = factors.solve([r * s for s in step])
        return (*(f + s for f, s in zip(forces, step, strict=True)), *step, count + 1.0, r * largest(step))

    start = (*first, *first, 1.0 + 0.0 * r, r * largest(first))
    end = numeric.loop(unfinished, round_, start, limit - 1)
    return _Found(end[:m], end[2 * m], end[2 * m + 1])


def _refined(
    b: Sequence[Any],
    product: Callable[[Sequence[Any]], Sequence[Any]],
    damped: _Damped,
    start: Sequence[Any],
    threshold: Any,
    limit: int,
) -> _Found:
    """What refining forces that are nearly right finds.

    Args:
        b: What G f is to be.
        product: G f.
        damped: G + R.
        start: The forces.
        threshold: Constraints contradict each other where more than this is left of b.
        limit: How many rounds at most.
    """
    m = len(start)

    def rest(forces: Sequence[Any]) -> list[Any]:
        return [x - y for x, y in zip(b, product(forces), strict=True)]

    def unfinished(*state: Any) -> Any:
        energy, most = state[-2:]
        return energy > _SETTLED * most

    def round_(*state: Any) -> tuple[Any, ...]:
        forces, e, (count, before, most) = state[:m], state[m : 2 * m], state[2 * m :]
        step = damped.without_null_space(damped.factors.solve(e))
        energy = sum(x * y for x, y in zip(e, step, strict=True))
        grows = numeric.less(_SHRINKING * before, energy)  # not so where it is nan, which is to be seen
        forces = [numeric.where(grows, f, f + x) for f, x in zip(forces, step, strict=True)]
        energies = numeric.where(grows, 0.0, energy), numeric.maximum(most, energy)
        return (*forces, *rest(forces), count + 1.0, *energies)

    at_start = rest(start)
    energy = sum(x * y for x, y in zip(b, start, strict=True))
    state = (*start, *at_start, 0.0 * start[0], _UNKNOWN, energy)
    end = numeric.loop(unfinished, round_, state, limit)
    forces, e = end[:m], end[m : 2 * m]
    grew = numeric.less(sum(x * x for x in at_start), sum(x * x for x in e))
    contradict = grew & numeric.less(threshold, largest(e))
    forces = [numeric.where(contradict, x, y) for x, y in zip(start, forces, strict=True)]
    return _Found(forces, end[2 * m], largest(e))


def _purged(damped: _Damped, found: _Found, threshold: Any) -> list[Any]:
    """The forces without those in the null space, where more than a threshold is left of b."""

    def without_null_space(*state: Any) -> tuple[Any, ...]:
        *forces, left = state
        null_space = damped.null_space(damped.null_space(forces))
        return (*(f - s for f, s in zip(forces, null_space, strict=True)), left)

    state = (*found.forces, found.left)
    end = numeric.loop(lambda *state: state[-1] > threshold, without_null_space, state, _PURGES)
    return list(end[:-1])


def _times(G: Array) -> Callable[[Sequence[Any]], list[Any]]:
    """The product with a matrix (..., m, m), entry by entry."""
    m = G.shape[-1]
    return lambda f: [sum(G[..., i, j] * f[j] for j in range(m)) for i in range(m)]


def largest(values: Sequence[Any]) -> Any:
    """The largest absolute value."""
    return reduce(numeric.maximum, [abs(value) for value in values])


def largest_entry(x: Array) -> Any:
    """The largest absolute value along the last axis."""
    return largest([x[..., i] for i in range(x.shape[-1])])
