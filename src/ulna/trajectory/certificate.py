"""Bounds of what a law uses of its limits between grid points, segment by segment.

On a segment x is linear in s and u is constant. The coefficients a, b, c of a constraint are taken for the quartics
through five samples (exact for accelerations on paths of degree five and less; `fits` measures it elsewhere). So
a u + b x + c and the square of a speed, p'^2 x, are polynomials of s, and lie between the least and the greatest of
their Bernstein coefficients.

| symbol | meaning | shape |
|---|---|---|
| a, b | coefficients at the five nodes | (5, m) |
| low, high | what a u + b x may be there: limits less c | (5, m) |
| x0, x1, D | squared rates at both ends, twice the length: u = (x1 - x0) / D | () |

Source: Farouki, The Bernstein polynomial basis: a centennial retrospective (2012), section 4 and 5.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, reduce
from math import comb
from typing import Any

import numpy as np

from ulna.compiler import compile
from ulna.data_classes import dataclass
from ulna.numeric import maximum, minimum, vector, where
from ulna.trajectory.quartics import AT_PROBES, NODES, TO_BERNSTEIN, TO_HALVES
from ulna.typing import Array, Floats


@dataclass(frozen=True)
class Bound:
    """What a law uses at most of the limits of rows on each segment.

    Attributes:
        below: Greatest low - (a u + b x), (N, m); above zero it is a violation.
        above: Greatest (a u + b x) - high, (N, m).
        less_low: Part of `low`, (N, m), that would not be exceeded by a law of the same shape.
        less_high: Part of `high`, likewise.
        worst: Greatest use of what there is between rest and a limit, over all rows, (N,); 1 is at the limit.
    """

    below: Floats
    above: Floats
    less_low: Floats
    less_high: Floats
    worst: Floats


def bounded(rows: Any, x: Floats, D: Floats, more: float = 1.0) -> Bound:
    """Bounds of all rows on each segment; parts of limits are for `more` times the excess.

    Args:
        rows: Constraints at the nodes of each segment.
        x: Squared rates at the grid points, (N + 1,) [1/s^2].
        D: Twice the length of each segment, (N,).
        more: Factor on the excess for `less_low` and `less_high` [-].

    Returns:
        The bounds; see `Bound`.
    """
    kernel = _row_kernel(rows.a.shape[-1], rows.high.shape[-2])
    return Bound(*kernel(*rows.arrays, rows.limits, x[:-1], x[1:], D, more))


def speed_use(tangent: Floats, low: Floats, high: Floats, x: Floats) -> Floats:
    """Greatest squared speed in parts of the squared limit on each segment, over all joints, (N,).

    Args:
        tangent: p' at the nodes, (N, 5, n).
        low: Least speeds, (n,) [rad/s or m/s].
        high: Greatest speeds, (n,) [rad/s or m/s].
        x: Squared rates at the grid points, (N + 1,) [1/s^2].

    Returns:
        Part of the squared limit, (N,).
    """
    return _speed_kernel(tangent.shape[-1])(tangent, low, high, x[:-1], x[1:])


def misfit(have: Sequence[Floats], want: Sequence[Floats]) -> Floats:
    """How far quartics through samples are from the truth, on each segment, in parts of the greatest value, (N,).

    Args:
        have: Values at the nodes, (N, 5, m) each.
        want: Values at the probe, (N, 1, m) each.

    Returns:
        Largest difference, (N,).
    """
    sizes = np.array([np.abs(x[:, 2]).max(axis=0) for x in have]) + 1e-300
    return _misfit_kernel(len(have), sizes.shape[1])(*have, *(x[:, 0] for x in want), sizes)


@lru_cache(maxsize=32)
def _misfit_kernel(count: int, m: int) -> Any:
    def compare(*args: Array) -> Any:
        have, want, sizes = args[:count], args[count:-1], args[-1]
        worst = 0.0
        for nodes, truth, size in zip(have, want, sizes, strict=True):
            for j, guess in enumerate((AT_PROBES @ nodes)[0]):
                worst = maximum(worst, abs(guess - truth[j]) / size[j])
        return worst

    nodes = {f"have{k}": (len(NODES), m) for k in range(count)}
    probes = {f"want{k}": (m,) for k in range(count)}
    shapes: dict[str, Any] = {**nodes, **probes, "sizes": (count, m)}
    return compile(compare, **shapes).gufunc


@lru_cache(maxsize=32)
def _row_kernel(m: int, places: int) -> Any:
    def bound(
        a: Array, b: Array, low: Array, high: Array, limits: Array, x0: Any, x1: Any, D: Any, more: Any
    ) -> tuple[Any, ...]:
        u = (x1 - x0) / D
        used = np.stack([a[i] * u + b[i] * (x0 + (x1 - x0) * t) for i, t in enumerate(NODES)])
        below, above = _most(TO_HALVES @ (low - used)), _most(TO_HALVES @ (used - high))
        worst, parts = 0.0, []
        for over, slack in ((below, _most(low) * -1.0), (above, _most(high * -1.0) * -1.0)):
            for j in range(m):
                still = slack[j] > 0.0
                worst = maximum(worst, 1.0 + over[j] / where(still, slack[j], limits[1][j] - limits[0][j]))
                whole = slack[j] + maximum(over[j], 0.0) * more
                parts.append(where(still, slack[j] / where(still, whole, 1.0), 1.0))
        return below, above, vector(*parts[:m]), vector(*parts[m:]), worst

    rows: dict[str, Any] = {
        "a": (len(NODES), m),
        "b": (len(NODES), m),
        "low": (places, m),
        "high": (places, m),
    }
    return compile(bound, **rows, limits=(2, m), x0=(), x1=(), D=(), more=()).gufunc


@lru_cache(maxsize=32)
def _speed_kernel(n: int) -> Any:
    def use(tangent: Array, low: Array, high: Array, x0: Any, x1: Any) -> Any:
        c = TO_BERNSTEIN @ tangent
        square = _product(c, c)
        whole = _most(np.stack(_product(square, [x0, x1])))
        fastest = maximum(x0, x1)
        worst = 0.0
        for j in range(n):
            up, down = 1.0 / (high[j] * high[j]), 1.0 / (low[j] * low[j])
            least, most = c[0][j], c[0][j]
            for row in c[1:]:
                least, most = minimum(least, row[j]), maximum(most, row[j])
            # a joint that moves one way only has the limit of that way; of one that turns back both are bounded apart
            by_side = maximum(maximum(most, 0.0) ** 2 * up, minimum(least, 0.0) ** 2 * down) * fastest
            limit = where(least >= 0.0, up, where(most <= 0.0, down, maximum(up, down)))
            worst = maximum(worst, minimum(whole[j] * limit, by_side))
        return worst

    return compile(use, tangent=(len(NODES), n), low=(n,), high=(n,), x0=(), x1=()).gufunc


def _product(p: Any, r: Any) -> list[Any]:
    """Bernstein coefficients of a product."""
    m, n = len(p) - 1, len(r) - 1
    rows = []
    for k in range(m + n + 1):
        pairs = [
            (comb(m, i) * comb(n, k - i) / comb(m + n, k)) * (p[i] * r[k - i])
            for i in range(max(0, k - n), min(m, k) + 1)
        ]
        rows.append(sum(pairs[1:], pairs[0]))
    return rows


def _most(rows: Any) -> Array:
    """The greatest of each column."""
    return vector(*(reduce(maximum, [row[j] for row in rows]) for j in range(len(rows[0]))))
