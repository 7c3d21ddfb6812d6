"""The fastest law on a path, certified: passes over the grid, a bound of every limit between grid points, and repairs.

1. Passes: reachability analysis with limits at both ends of each segment, or at its start.
2. Certificate: bounds of speeds, accelerations and torques on the whole of each segment (`certificate`).
3. Where a bound is above its limit, the segment is halved if it is much too long, and else its limits are lowered by
   that excess; then again from 1. A rest below `_STRETCH` is removed by slowing the whole motion down: in the squared
   rate and the acceleration of the path everything but torques at rest is linear.

Source: Pham & Pham 2018 for the passes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.trajectory.certificate import Bound, bounded, speed_use
from ulna.trajectory.grids import halved, sampled
from ulna.trajectory.ground import MOST, Four, Ground, Task, fitted, ground_of, holds_still, static_violation
from ulna.trajectory.infeasible import Problem
from ulna.trajectory.reach import controllable, fastest, reachable
from ulna.typing import Floats

TOLERANCE = 1e-6
"""What part of a limit may be exceeded at most, anywhere."""

_ROUNDS = 24  # of passes and repairs
_ACCEPTED_USE = 1.0 + 1e-7  # use of a limit that needs no repair
_STRETCH = 2.5e-4  # excess that slowing everything down repairs; it doubles with each round
_SPLIT_USE = 1.1  # use of a limit by a segment that should be halved
_SPLITS = 6  # rounds in which segments may be halved
_MORE, _MUCH_MORE = 1.1, 2.0  # by how much more than its excess a limit is lowered, at first and later
_CAPPED = 8  # the round from which rates are lowered too
_ROUNDING = 1e-10  # what part of the greatest squared rate an interval may lack to be one

_ALL, _NOTHING = 1.0, 0.0


@dataclass(frozen=True, eq=False)
class Answer:
    """The squared rates x (N + 1,) on the grid s, twice the lengths D, and the certified use of each limit."""

    s: Floats
    D: Floats
    x: Floats
    use: dict[str, float]


@dataclass(frozen=True, eq=False)
class _Repairs:
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


def solved(task: Task, s: Floats) -> Answer:
    """The fastest law that keeps all limits everywhere, from a first grid.

    Args:
        task: Path, limits and rates at the ends.
        s: Grid points, (N + 1,).

    Returns:
        The law and what it uses of the limits.

    Raises:
        InputError: Limits exclude each other; says where and which.
    """
    ground = fitted(task, s)
    repairs = _none(task, ground)
    can_stretch = task.rates == (0.0, 0.0) and holds_still(ground)
    for round in range(_ROUNDS):
        x = _passes(task, ground, repairs)
        bound = bounded(ground.rows, x, ground.at.D, _MORE if round < _CAPPED else _MUCH_MORE)
        speed = speed_use(ground.at.tangent, task.speeds.low, task.speeds.high, x)
        use = np.maximum(bound.worst, speed)
        worst = float(use.max())
        if worst <= _ACCEPTED_USE:
            return _answer(task, ground, x, bound, speed)
        if can_stretch and (worst <= 1.0 + _STRETCH * 2.0**round or round == _ROUNDS - 1):
            return _slowed(task, ground, x, speed, worst)
        at_ends, long = ~repairs.ends & (use > _ACCEPTED_USE), ~ground.rests & (use > _SPLIT_USE)
        if at_ends.any():  # limits at the ends come before anything else
            repairs = replace(repairs, ends=repairs.ends | at_ends)
        elif round < _SPLITS and worst > _SPLIT_USE and long.any() and ground.at.s.size < MOST:
            ground, repairs = _halved(task, ground, repairs, long)
        else:
            chosen = ground.rests if round < _CAPPED else np.ones_like(ground.rests)
            if chosen.any():
                repairs = replace(repairs, top=_topped(repairs.top, x, use, chosen))
            repairs = _lowered(ground, repairs, bound, speed)
    k = int(np.argmax(use))
    raise InputError(
        f"No motion was found that keeps the limits between the grid points near s = {ground.at.s[k]:.6g} of "
        f"{ground.at.s[-1]:.6g}: the best one exceeds them by {100.0 * (worst - 1.0):.2g} %. Choose lower rates at "
        "the ends, for a finer `grid`, or raise the limits that are nearly reached at rest."
    )


def _none(task: Task, ground: Ground) -> _Repairs:
    return _Repairs(_ALL, _ALL, _ALL, _NOTHING, np.full(ground.at.D.size, task.both_ends), ground.top)


def _passes(task: Task, ground: Ground, repairs: _Repairs) -> Floats:
    """The fastest squared rates under the limits at grid points."""
    at, (first, last) = ground.at, task.rates
    start = _usable(ground.start, repairs)
    end = _usable(ground.end, repairs) if repairs.ends.any() else ()
    if end and not repairs.ends.all():
        end = tuple(
            np.where(repairs.ends[:, None], part, inert)
            for part, inert in zip(end, (0.0, 0.0, -1.0, 1.0), strict=True)
        )
    cap = np.array(repairs.top)
    np.minimum(cap[:-1], ground.survey.start * repairs.speed, out=cap[:-1])
    np.minimum(cap[1:], ground.survey.end * repairs.speed, out=cap[1:])
    problem = Problem(at.s, at.D, task.names, at.tangent, task.speeds, ground.rows.labels, start, end, cap)
    problem.check_rate("end", last, at.s.size - 1, 0.0, cap[-1])
    back, ahead = reachable(at.D, start, end)
    K = controllable(back, cap, last * last)
    lowest, highest = K.T
    empty = ~(lowest <= highest + _ROUNDING * abs(highest.max()))
    if empty.any():
        problem.raise_empty_set(K, int(np.flatnonzero(empty)[-1]), static_violation(task, ground))
    problem.check_rate("start", first, 0, *K[0])
    return fastest(ahead, K, first * first)[: at.s.size]


def _usable(rows: Four, repairs: _Repairs) -> Four:
    """Rows with what passes may use of their limits."""
    a, b, low, high = rows
    if repairs.low is not _ALL:
        low, high = low * repairs.low, high * repairs.high
    if repairs.less is not _NOTHING:
        low, high = low + repairs.less[0], high - repairs.less[1]
    return a, b, low, high


def _lowered(ground: Ground, repairs: _Repairs, bound: Bound, speed: Floats) -> _Repairs:
    """Repairs that use less of the limits that are exceeded."""
    less = repairs.less
    if not holds_still(ground):
        over = np.maximum(np.stack([bound.below, bound.above]), 0.0) * _MORE
        slack = np.stack([-ground.rows.low.max(axis=-2), ground.rows.high.min(axis=-2)])
        less = less + np.where(slack > 0.0, 0.0, over)
    slower = repairs.speed / np.maximum(1.0 + (speed - 1.0) * _MORE, 1.0)
    return replace(
        repairs,
        low=repairs.low * bound.less_low,
        high=repairs.high * bound.less_high,
        less=less,
        speed=slower,
    )


def _topped(top: Floats, x: Floats, use: Floats, chosen: Any) -> Floats:
    """Greatest squared rates that let no segment go on as fast as it exceeded its limits."""
    slower = 1.0 / np.maximum(use, 1.0)
    wrong = chosen & (use > _ACCEPTED_USE)
    out = np.array(top)
    for side in (slice(None, -1), slice(1, None)):
        lowered = np.minimum(out[side], x[side] * slower)
        out[side] = np.where(wrong & (x[side] > 0.0), lowered, out[side])
    return out


def _halved(task: Task, ground: Ground, repairs: _Repairs, chosen: Any) -> tuple[Ground, _Repairs]:
    """The same with the chosen segments halved."""
    at = sampled(task.path, halved(ground.at.s, chosen))
    finer = ground_of(task, at, task.rows(at.q, at.tangent, at.curvature))
    parent = np.repeat(np.arange(chosen.size), 1 + chosen)
    speed, low, high = (
        x if isinstance(x, float) else x[parent] for x in (repairs.speed, repairs.low, repairs.high)
    )
    less = repairs.less if isinstance(repairs.less, float) else repairs.less[:, parent]
    return finer, _Repairs(speed, low, high, less, repairs.ends[parent], finer.top)


def _answer(task: Task, ground: Ground, x: Floats, bound: Bound, speed: Floats) -> Answer:
    """The answer with the use of each limit, from its certificate."""
    low, high = ground.rows.limits
    part = np.maximum(1.0 - bound.below.max(axis=0) / low, 1.0 + bound.above.max(axis=0) / high)
    use = {"velocity": float(np.sqrt(speed.max()))} if task.speeds.any else {}
    for what, which in ground.rows.of_quantity():
        use[what] = float(part[which].max())
    return Answer(ground.at.s, ground.at.D, x, use)


def _slowed(task: Task, ground: Ground, x: Floats, speed: Floats, factor: float) -> Answer:
    """The answer whose squared rates are smaller by a factor."""
    slower = x / factor
    return _answer(task, ground, slower, bounded(ground.rows, slower, ground.at.D), speed / factor)
