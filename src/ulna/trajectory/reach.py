"""The passes of time-optimal parameterisation by reachability analysis, traced.

| symbol | meaning | shape | unit |
|---|---|---|---|
| s, x, u | path parameter, its squared rate, its acceleration | () | [1], [1/s^2], [1/s^2] |
| D | twice the length of a grid segment: x' = x + D u | () | [1] |
| a, b, low, high | rows of constraints, low <= a u + b x <= high | (m,) | |
| K | controllable set of a grid point: the x from which the end can be reached, an interval | (2,) | [1/s^2] |

On one segment a row eliminates u = (x' - x) / D and bounds x by x': with p = a - D b, x = (a x' - D w) / p for some w
in [low, high]. Two rows eliminate u between them, and bound x alone. So a set of rows becomes, once for each
segment and all segments in SIMD lanes, an interval for x and affine bounds between neighbours; the passes that
must go point by point only multiply, add and compare. Nothing is divided by a, so that points of zero inertia
(a = 0 with b != 0) need no special care.

Source: Pham & Pham, A new approach to time-optimal path parameterization based on reachability analysis (2018),
algorithm 1; the two-variable linear programs are solved in closed form by Fourier-Motzkin elimination.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np

from ulna.compiler import compile
from ulna.numeric import vector, where
from ulna.typing import Array, Floats

HUGE = 1e300
_PARALLEL = 1e-12  # a determinant below this part of its terms is none


@lru_cache(maxsize=32)
def _bounds_kernel(n: int, both_ends: bool) -> Any:
    """The kernel from rows of one segment and its D to backward bounds (3 m + 2,) and forward bounds (2 m,).

    The n rows are those at its start and, with `both_ends`, those at its end as well, m = 2 n: there x + D u stands for
    x, a' u + b' (x + D u). Backward: for each row the factor of x' and the least and greatest D w / p, then
    the interval of x from pairs of rows. Forward: for each row, x' <= factor x + offset.
    """

    def bounds(D: Any, *ends: Array) -> tuple[Array, Array]:
        rows = [_upward(*row) for row in zip(*ends[:4], strict=True)]
        if both_ends:
            rows += [_upward(a + D * b, b, *w) for a, b, *w in zip(*ends[4:], strict=True)]
        factors, least, most, forward, offsets = [], [], [], [], []
        for ai, bi, lo, hi in rows:
            p = ai - D * bi
            inverse = 1.0 / _away_from_zero(p, ai + abs(D * bi))
            w0, w1 = D * lo * inverse, D * hi * inverse
            factors.append(ai * inverse)
            least.append(_smaller(w0, w1))
            most.append(_greater(w0, w1))
            flat = ai <= _PARALLEL * abs(D * bi) + 1.0 / HUGE
            safe = 1.0 / where(flat, 1.0, ai)
            forward.append(where(flat, 0.0, p * safe))
            offsets.append(where(flat, HUGE, D * hi * safe))
        lower, upper = [-HUGE], [HUGE]
        for (ai, bi, loi, hii), (ak, bk, lok, hik) in combinations(rows, 2):
            one, two = ai * bk, ak * bi
            most_below, least_above = ai * lok - ak * hii, ai * hik - ak * loi  # these bound (one - two) x
            parallel = abs(one - two) <= _PARALLEL * (abs(one) + abs(two))
            inverse = 1.0 / where(parallel, 1.0, one - two)
            w0, w1 = most_below * inverse, least_above * inverse
            crossed = (most_below > 0.0) | (
                least_above < 0.0
            )  # parallel rows either exclude each other or say nothing
            lower.append(where(parallel, where(crossed, HUGE, -HUGE), _smaller(w0, w1)))
            upper.append(where(parallel, HUGE, _greater(w0, w1)))
        alone = [_best(_greater, lower), _best(_smaller, upper)]
        return vector(*factors, *least, *most, *alone), vector(*forward, *offsets)

    names = ("a", "b", "low", "high", "a_end", "b_end", "low_end", "high_end")[: 8 if both_ends else 4]
    shapes: dict[str, Any] = {"D": ()} | dict.fromkeys(names, (n,))
    return compile(bounds, **shapes).gufunc


@lru_cache(maxsize=32)
def _backward_kernel(m: int, steps: int) -> Any:
    """The kernel of some steps of the backward pass: bounds, greatest x, K behind them -> K of each point."""

    def backward(bounds: Array, cap: Array, K: Array) -> Array:
        sets, (low, high) = [], K
        for row, top in zip(bounds[::-1], cap[::-1], strict=True):
            ends = [(f * low, f * high) for f in row[:m]]
            tops = [_greater(*e) - w for e, w in zip(ends, row[m : 2 * m], strict=True)]
            bottoms = [_smaller(*e) - w for e, w in zip(ends, row[2 * m : 3 * m], strict=True)]
            low = _best(_greater, [0.0, row[3 * m], *bottoms])
            high = _best(_smaller, [top, row[3 * m + 1], *tops])
            sets.append(vector(low, high))
        return np.stack(sets[::-1])

    return compile(backward, bounds=(steps, 3 * m + 2), cap=(steps,), K=(2,))


@lru_cache(maxsize=32)
def _forward_kernel(m: int, steps: int) -> Any:
    """The kernel of some steps of the forward pass: bounds, K of the next points, x before them -> x of each."""

    def forward(bounds: Array, K: Array, start: Array) -> Array:
        rates, x = [], start[0]
        for row, (low, high) in zip(bounds, K, strict=True):
            x = _greater(low, _best(_smaller, [high, *(row[:m] * x + row[m:])]))
            rates.append(x)
        return vector(*rates)

    return compile(forward, bounds=(steps, 2 * m), K=(steps, 2), start=(1,))


def reachable(D: Floats, start: Sequence[Floats], end: Sequence[Floats] = ()) -> tuple[Floats, Floats]:
    """Backward and forward bounds of all segments, padded with segments that bound nothing to whole blocks.

    Args:
        D: Twice the length of each segment, (N,).
        start: a, b, low and high of the rows at the start of each segment, (N, n) each, finite.
        end: The same at its end, (N, n) each; nothing where rows hold at the starts only.

    Returns:
        Backward bounds (M, 3 m + 2) and forward bounds (M, 2 m); see `_bounds_kernel`.
    """
    n, N = start[0].shape[1], len(D)
    m = 2 * n if end else n
    total = -(-N // _steps(m)) * _steps(m)
    back, ahead = np.empty((total, 3 * m + 2)), np.empty((total, 2 * m))
    _bounds_kernel(n, bool(end))(D, *start, *end, out=(back[:N], ahead[:N]))
    if total > N:
        back[N:, :m], back[N:, m:-2], back[N:, -2], back[N:, -1] = 1.0, 0.0, -HUGE, HUGE
        ahead[N:, :m], ahead[N:, m:] = 1.0, 0.0
    return back, ahead


def controllable(back: Floats, cap: Floats, end: float) -> Floats:
    """The controllable sets K of all grid points, and of padding behind them; empty ones have their ends crossed.

    Args:
        back: Backward bounds, from `reachable`, (M, 3 m + 2) with M >= N.
        cap: Greatest x of each grid point, (N + 1,).
        end: x of the last point [1/s^2].

    Returns:
        (M + 1, 2), of which the first N + 1 count.
    """
    M, m = len(back), (back.shape[1] - 2) // 3
    steps = _steps(m)
    kernel, caps, K = _backward_kernel(m, steps), np.full(M, HUGE), np.empty((M + 1, 2))
    caps[: len(cap) - 1], K[M] = cap[:-1], end
    for k in range(M - steps, -1, -steps):
        K[k : k + steps] = kernel(back[k : k + steps], caps[k : k + steps], K[k + steps])
    return K


def fastest(ahead: Floats, K: Floats, start: float) -> Floats:
    """The greatest x of all grid points and of the padding, (M + 1,), from `start` at the first.

    Args:
        ahead: Forward bounds of all segments and the padding, (M, 2 m).
        K: Least and greatest controllable x, (M + 1, 2) [1/s^2].
        start: x at the first grid point [1/s^2].

    Returns:
        x (M + 1,) [1/s^2].
    """
    M, m = len(ahead), ahead.shape[1] // 2
    steps = _steps(m)
    kernel, x = _forward_kernel(m, steps), np.empty(M + 1)
    x[0] = start
    for k in range(0, M, steps):
        x[k + 1 : k + steps + 1] = kernel(ahead[k : k + steps], K[k + 1 : k + steps + 1], x[k : k + 1])
    return x


def _steps(m: int) -> int:
    """How many steps one kernel takes: enough that the calls cost little, few enough to compile at once."""
    return max(2, 112 // m)


def _upward(a: Any, b: Any, low: Any, high: Any) -> tuple[Any, Any, Any, Any]:
    """The same row with a >= 0."""
    down = a < 0.0
    return abs(a), where(down, -b, b), where(down, -high, low), where(down, -low, high)


def _away_from_zero(x: Any, size: Any) -> Any:
    """`x`, but no nearer to zero than rounding."""
    least = _PARALLEL * size + 1.0 / HUGE
    return where(x < 0.0, _smaller(x, -least), _greater(x, least))


def _smaller(a: Any, b: Any) -> Any:
    """The smaller of numbers that are no nan: one instruction, where that of `numeric` must carry nan through."""
    return where(a < b, a, b)


def _greater(a: Any, b: Any) -> Any:
    """The greater of numbers that are no nan."""
    return where(a < b, b, a)


def _best(choose: Any, values: Sequence[Any]) -> Any:
    """The least or greatest of values, compared in pairs so that the chain of comparisons is short."""
    values = list(values)
    while len(values) > 1:
        pairs = [choose(*values[i : i + 2]) for i in range(0, len(values) - 1, 2)]
        values = pairs + values[len(values) - len(values) % 2 :]
    return values[0]
