"""Quadratic programs of differential inverse kinematics: with bounds in a kernel, with rows by daqp.

| symbol | meaning | shape |
|---|---|---|
| H, g | objective x^T H x / 2 + g^T x, H positive definite | (n, n), (n,) |
| l, u | bounds l <= x <= u, infinite where there is none | (n,) |
| s | side on which a variable is fixed: -1 at l, 1 at u, 0 free | (n,) |
| w | slope H x + g; at the optimum 0 where free, not below 0 at l, not above 0 at u | (n,) |

With bounds alone the optimum is found by an active-set method with projected steps: solve for the free variables; where
the solution leaves the bounds, go to its projection if that is better, else as far as the first bound, and fix what
arrived at one; where it stays inside, release all whose gradient has the wrong sign. With every step the objective
falls or another variable is fixed, so no set of fixed variables comes back. The first solution is that without bounds:
a motion away from all limits costs one factorisation. Source: More & Toraldo, On the solution of large quadratic
programming problems with bound constraints (1991); Nocedal & Wright 2006, sections 16.5 and 16.7. Variables are
eliminated last to first, which leaves the zeros between the branches of a tree as they are (Featherstone 2008, section
6.5).

Rows are left to daqp, a dual active-set solver: Arnstrom, Bemporad, Axehill (2022).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial, reduce
from typing import Any, NamedTuple

import numpy as np

from ulna import linalg
from ulna.errors import needed
from ulna.numeric import clip, is_symbolic, less, loop, matrix, maximum, minimum, vector, where
from ulna.typing import Array, Floats

_SLOPE = 1e-12  # a slope this small, beside the largest part of g, may have either sign
_RESIDUAL = 1e-7
_TOLERANCE = 1e-10
_EQUALITY, _OPTIMAL = 5, 1  # words of daqp

_Rows = Sequence[Sequence[Any]]


class Boxed(NamedTuple):
    """The optimum x (..., n), and whether it is one, as 1 or 0 (...): not where H is singular, or nan came in."""

    x: Array
    solved: Any


def solve_box(H: Array, g: Array, lower: Array, upper: Array) -> Boxed:
    """Minimises x^T H x / 2 + g^T x within bounds.

    Args:
        H: Shape (..., n, n), symmetric positive definite.
        g: Shape (..., n).
        lower: Shape (n,) or (..., n), nowhere above `upper`.
        upper: Shape (n,) or (..., n).

    Returns:
        The minimiser (..., n), and whether it was found.
    """
    n = g.shape[-1]
    rows = [[H[..., i, j][()] for j in range(n)] for i in range(n)]
    pull, low, high = ([x[..., i][()] for i in range(n)] for x in (g, lower, upper))
    bounded = [i for i in range(n) if not (_is_infinite(low[i]) and _is_infinite(high[i]))]
    large = reduce(maximum, (abs(e) for e in pull))
    size = reduce(maximum, (rows[i][i] for i in range(n)))
    box = _Box(rows, pull, low, high, bounded, large, size, 0.0 * large)

    start = [clip(box.zero, low[i], high[i]) for i in range(n)]
    state = (*(box.zero for _ in bounded), *start, box.zero, box.zero)
    if bounded:
        improve = partial(_improved, box)
        end = loop(lambda *state: less(state[-2], 0.5), improve, state, limit=20 + 10 * n)
    else:
        end = _improved(box, *state)
    return Boxed(vector(*end[len(bounded) : -2]), end[-1])


class _Box(NamedTuple):
    """A program with bounds, entry by entry."""

    H: _Rows
    g: Sequence[Any]
    low: Sequence[Any]
    high: Sequence[Any]
    bounded: Sequence[int]
    """The variables that have a finite bound."""
    large: Any
    """The largest part of g."""
    size: Any
    """The largest entry on the diagonal of H."""
    zero: Any


def _improved(box: _Box, *state: Any) -> tuple[Any, ...]:
    """The state (s of bounded variables, x, done, solved) after a step of the active-set method."""
    n, bounded, low, high, zero = len(box.g), box.bounded, box.low, box.high, box.zero
    side, x = dict(zip(bounded, state, strict=False)), state[len(bounded) : len(bounded) + n]
    t = _with_fixed(box.H, box.g, x, side)
    beyond = {i: where(less(t[i], low[i]), -1.0, where(less(high[i], t[i]), 1.0, zero)) for i in bounded}
    bound = {i: where(beyond[i] < 0.0, low[i], high[i]) for i in bounded}
    c = [where(abs(beyond[i]) > 0.5, bound[i], t[i]) if i in side else t[i] for i in range(n)]
    slope = _slope(box.H, box.g, c)
    middle = _slope(box.H, box.g, [0.5 * (c[i] + x[i]) for i in range(n)])
    change = sum(((c[i] - x[i]) * middle[i] for i in range(n)), zero)
    reach = {}
    for i in bounded:
        out = abs(beyond[i]) > 0.5
        reach[i] = where(out, (bound[i] - x[i]) / where(out, t[i] - x[i], 1.0), 2.0)
    first = reduce(minimum, reach.values(), zero + 2.0)
    inside, projected = less(1.5, first), less(change, 0.0)

    release = {i: where(less(_SLOPE * box.large, side[i] * slope[i]), 1.0, zero) for i in bounded}
    sides, following = [], list(c)
    for i in bounded:
        arrives = where(reach[i] <= first, beyond[i], side[i])
        stopped = where(reach[i] <= first, bound[i], x[i] + first * (t[i] - x[i]))
        fixed = where(abs(beyond[i]) > 0.5, beyond[i], side[i])
        released = where(release[i] > 0.5, 0.0, side[i])
        sides.append(where(inside, released, where(projected, fixed, arrives)))
        following[i] = where(inside, t[i], where(projected, c[i], stopped))
    for i in set(range(n)) - set(bounded):
        following[i] = where(inside | projected, t[i], x[i] + first * (t[i] - x[i]))
    wrong = reduce(maximum, release.values(), zero)
    done = where(inside, 1.0 - wrong, 0.0)
    residual = reduce(maximum, (_if_free(side.get(i), abs(slope[i])) for i in range(n)))
    scale = box.large + box.size * reduce(maximum, (abs(e) for e in c))
    return (*sides, *following, done, where(residual <= _RESIDUAL * scale, done, 0.0))


def _with_fixed(H: _Rows, g: Sequence[Any], x: Sequence[Any], side: Mapping[int, Any]) -> list[Any]:
    """The optimum over the free variables, the others staying where they are in x."""
    n = len(g)
    free = {i: 1.0 - s * s for i, s in side.items()}
    rows, right = [], []
    for i in range(n):
        f = free.get(i, 1.0)
        rows.append([f * H[i][j] * free.get(j, 1.0) + ((1.0 - f) if i == j else 0.0) for j in range(n)])
        pull = sum((H[i][j] * ((1.0 - free[j]) * x[j]) for j in side), g[i])
        right.append((1.0 - f) * x[i] - f * pull)
    t = linalg.solve_spd(matrix([row[::-1] for row in rows[::-1]]), vector(*right[::-1]))
    solution = [t[..., n - 1 - i][()] for i in range(n)]
    return [where(abs(side[i]) > 0.5, x[i], solution[i]) if i in side else solution[i] for i in range(n)]


def _slope(H: _Rows, g: Sequence[Any], x: Sequence[Any]) -> list[Any]:
    """H x + g."""
    return [sum((h * e for h, e in zip(row, x, strict=True)), pull) for row, pull in zip(H, g, strict=True)]


def solve_rows(
    H: Floats, g: Floats, A: Floats, lower: Floats, upper: Floats, equalities: int
) -> Floats | None:
    """Minimises x^T H x / 2 + g^T x within bounds and between rows; None when nothing lies within them.

    Args:
        H: Shape (n, n), symmetric positive definite.
        g: Shape (n,).
        A: Shape (k, n).
        lower: Shape (n + k,), bounds of x, then of A x.
        upper: Shape (n + k,), likewise.
        equalities: How many of the rows, the last ones, are equalities.

    Returns:
        The minimiser (n,), or None.

    Raises:
        MissingExtra: If daqp is not installed.
    """
    with needed("daqp", "qp", "Constraints and rows of inequalities"):
        import daqp  # pyright: ignore[reportMissingImports]
    kinds = np.zeros(len(lower), dtype=np.int32)
    kinds[len(lower) - equalities :] = _EQUALITY
    x, _, flag, _ = daqp.solve(H, g, A, upper, lower, kinds, primal_tol=_TOLERANCE)
    if flag != _OPTIMAL:
        return None
    n = len(g)
    return np.clip(x, lower[:n], upper[:n])


def _if_free(side: Any, value: Any) -> Any:
    return value if side is None else value * (1.0 - side * side)


def _is_infinite(bound: Any) -> bool:
    return not is_symbolic(bound) and bool(np.isinf(bound).all())
