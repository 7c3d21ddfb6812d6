"""The fastest law on a path, certified: passes over the grid, bounds between grid points, and corrections.

1. Passes: reachability analysis with limits at both ends of each segment, or at its start.
2. Certificate: bounds of speeds, accelerations and torques on the whole of each segment (`certificate`).
3. Where a bound is above its limit, the segment is halved if it is much too long, and else its limits are lowered by
   that excess; then again from 1. An excess below `_SLOW_DOWN` is removed by slowing the whole motion down: in the
   squared rate and the acceleration of the path everything but torques at rest is linear.

Source: Pham & Pham 2018 for the passes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.trajectory.certificate import Bound, bounded, speed_use
from ulna.trajectory.discretization import (
    MOST,
    DiscretizedTask,
    RowArrays,
    Task,
    discretized,
    holds_still,
    refined,
    static_violation,
)
from ulna.trajectory.grids import halved, sampled
from ulna.trajectory.infeasible import Problem
from ulna.trajectory.reach import controllable, fastest, reachable
from ulna.typing import Floats

TOLERANCE = 1e-6
"""What part of a limit may be exceeded at most, anywhere."""

_ROUNDS = 24  # of passes and corrections
_ACCEPTED_USE = 1.0 + 1e-7  # use of a limit that needs no correction
_SLOW_DOWN = 2.5e-4  # excess that slowing everything down removes; it doubles with each round
_SPLIT_USE = 1.1  # use of a limit by a segment that should be halved
_SPLITS = 6  # rounds in which segments may be halved
_OVERCORRECTION, _LATE_OVERCORRECTION = 1.1, 2.0  # a limit is lowered by so many times its excess
_LOWER_RATES_FROM = 8  # the round from which rates are lowered as well, and `_LATE_OVERCORRECTION` counts
_ROUNDING = 1e-10  # what part of the greatest squared rate an interval may lack to be one

_ALL, _NOTHING = 1.0, 0.0


@dataclass(frozen=True, eq=False)
class Solution:
    """The squared rates x (N + 1,) on the grid s, twice the lengths D, and the certified use of each limit."""

    s: Floats
    D: Floats
    x: Floats
    use: dict[str, float]


@dataclass(frozen=True, eq=False)
class _UsableLimits:
    """What passes may use of each limit, segment by segment.

    `speed` is the part of the squared speed, (N,), `low` and `high` are those of the limits of rows, (N, m), and `less`
    is what rows lose on top of that, (2, N, m); one number stands for all. `ends` are the segments whose ends count,
    (N,); `top` are greatest squared rates of grid points, (N + 1,).
    """

    speed: Any
    low: Any
    high: Any
    less: Any
    ends: Any
    top: Floats


def solved(task: Task, s: Floats) -> Solution:
    """The fastest law that keeps all limits everywhere, from a first grid.

    Args:
        task: Path, limits and rates at the ends.
        s: Grid points, (N + 1,).

    Returns:
        The law and what it uses of the limits.

    Raises:
        InputError: Limits exclude each other; says where and which.
    """
    grid = refined(task, s)
    usable = _full_limits(task, grid)
    can_slow_down = task.rates == (0.0, 0.0) and holds_still(grid)
    for round in range(_ROUNDS):
        x = _backward_forward_passes(task, grid, usable)
        bound = bounded(
            grid.rows, x, grid.at.D, _OVERCORRECTION if round < _LOWER_RATES_FROM else _LATE_OVERCORRECTION
        )
        speed = speed_use(grid.at.tangent, task.speeds.low, task.speeds.high, x)
        use = np.maximum(bound.worst, speed)
        worst = float(use.max())
        if worst <= _ACCEPTED_USE:
            return _solution(task, grid, x, bound, speed)
        if can_slow_down and (worst <= 1.0 + _SLOW_DOWN * 2.0**round or round == _ROUNDS - 1):
            return _slowed(task, grid, x, speed, worst)
        at_ends, long = ~usable.ends & (use > _ACCEPTED_USE), ~grid.rests & (use > _SPLIT_USE)
        if at_ends.any():  # limits at the ends come before anything else
            usable = replace(usable, ends=usable.ends | at_ends)
        elif round < _SPLITS and worst > _SPLIT_USE and long.any() and grid.at.s.size < MOST:
            grid, usable = _halved(task, grid, usable, long)
        else:
            chosen = grid.rests if round < _LOWER_RATES_FROM else np.ones_like(grid.rests)
            if chosen.any():
                usable = replace(usable, top=_with_lower_rates(usable.top, x, use, chosen))
            usable = _lowered(grid, usable, bound, speed)
    k = int(np.argmax(use))
    raise InputError(
        f"No motion was found that keeps the limits between the grid points near s = {grid.at.s[k]:.6g} of "
        f"{grid.at.s[-1]:.6g}: the best one exceeds them by {100.0 * (worst - 1.0):.2g} %. Choose lower rates at "
        "the ends, for a finer `grid`, or raise the limits that are nearly reached at rest."
    )


def _full_limits(task: Task, grid: DiscretizedTask) -> _UsableLimits:
    return _UsableLimits(_ALL, _ALL, _ALL, _NOTHING, np.full(grid.at.D.size, task.both_ends), grid.top)


def _backward_forward_passes(task: Task, grid: DiscretizedTask, usable: _UsableLimits) -> Floats:
    """The fastest squared rates under the limits at grid points."""
    at, (first, last) = grid.at, task.rates
    start = _reduced(grid.start, usable)
    end = _reduced(grid.end, usable) if usable.ends.any() else ()
    if end and not usable.ends.all():
        end = tuple(
            np.where(usable.ends[:, None], part, inert)
            for part, inert in zip(end, (0.0, 0.0, -1.0, 1.0), strict=True)
        )
    cap = np.array(usable.top)
    np.minimum(cap[:-1], grid.survey.start * usable.speed, out=cap[:-1])
    np.minimum(cap[1:], grid.survey.end * usable.speed, out=cap[1:])
    problem = Problem(at.s, at.D, task.names, at.tangent, task.speeds, grid.rows.labels, start, end, cap)
    problem.check_rate("end", last, at.s.size - 1, 0.0, cap[-1])
    back, ahead = reachable(at.D, start, end)
    K = controllable(back, cap, last * last)
    lowest, highest = K.T
    empty = ~(lowest <= highest + _ROUNDING * abs(highest.max()))
    if empty.any():
        problem.raise_empty_set(K, int(np.flatnonzero(empty)[-1]), static_violation(task, grid))
    problem.check_rate("start", first, 0, *K[0])
    return fastest(ahead, K, first * first)[: at.s.size]


def _reduced(rows: RowArrays, usable: _UsableLimits) -> RowArrays:
    """Rows with what passes may use of their limits."""
    a, b, low, high = rows
    if usable.low is not _ALL:
        low, high = low * usable.low, high * usable.high
    if usable.less is not _NOTHING:
        low, high = low + usable.less[0], high - usable.less[1]
    return a, b, low, high


def _lowered(grid: DiscretizedTask, usable: _UsableLimits, bound: Bound, speed: Floats) -> _UsableLimits:
    """Repairs that use less of the limits that are exceeded."""
    less = usable.less
    if not holds_still(grid):
        over = np.maximum(np.stack([bound.below, bound.above]), 0.0) * _OVERCORRECTION
        slack = np.stack([-grid.rows.low.max(axis=-2), grid.rows.high.min(axis=-2)])
        less = less + np.where(slack > 0.0, 0.0, over)
    slower = usable.speed / np.maximum(1.0 + (speed - 1.0) * _OVERCORRECTION, 1.0)
    return replace(
        usable,
        low=usable.low * bound.less_low,
        high=usable.high * bound.less_high,
        less=less,
        speed=slower,
    )


def _with_lower_rates(top: Floats, x: Floats, use: Floats, chosen: Any) -> Floats:
    """Greatest squared rates that let no segment go on as fast as it exceeded its limits."""
    slower = 1.0 / np.maximum(use, 1.0)
    exceeded = chosen & (use > _ACCEPTED_USE)
    out = np.array(top)
    for side in (slice(None, -1), slice(1, None)):
        lowered = np.minimum(out[side], x[side] * slower)
        out[side] = np.where(exceeded & (x[side] > 0.0), lowered, out[side])
    return out


def _halved(
    task: Task, grid: DiscretizedTask, usable: _UsableLimits, chosen: Any
) -> tuple[DiscretizedTask, _UsableLimits]:
    """The same with the chosen segments halved."""
    at = sampled(task.path, halved(grid.at.s, chosen))
    finer = discretized(task, at, task.rows(at.q, at.tangent, at.curvature))
    parent = np.repeat(np.arange(chosen.size), 1 + chosen)
    speed, low, high = (
        x if isinstance(x, float) else x[parent] for x in (usable.speed, usable.low, usable.high)
    )
    less = usable.less if isinstance(usable.less, float) else usable.less[:, parent]
    return finer, _UsableLimits(speed, low, high, less, usable.ends[parent], finer.top)


def _solution(task: Task, grid: DiscretizedTask, x: Floats, bound: Bound, speed: Floats) -> Solution:
    """The answer with the use of each limit, from its certificate."""
    low, high = grid.rows.limits
    part = np.maximum(1.0 - bound.below.max(axis=0) / low, 1.0 + bound.above.max(axis=0) / high)
    use = {"velocity": float(np.sqrt(speed.max()))} if task.speeds.any else {}
    for what, which in grid.rows.of_quantity():
        use[what] = float(part[which].max())
    return Solution(grid.at.s, grid.at.D, x, use)


def _slowed(task: Task, grid: DiscretizedTask, x: Floats, speed: Floats, factor: float) -> Solution:
    """The answer whose squared rates are smaller by a factor."""
    slower = x / factor
    return _solution(task, grid, slower, bounded(grid.rows, slower, grid.at.D), speed / factor)
