"""The task of time-optimal parameterisation on a grid: samples, constraints at nodes, largest rates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.trajectory.certificate import misfit
from ulna.trajectory.constraint_rows import Bounds, Rows
from ulna.trajectory.grids import Sampled, at_nodes, graded, halved, sampled
from ulna.trajectory.quartics import NODES, PROBES
from ulna.trajectory.reach import HUGE
from ulna.trajectory.survey import TINY, Survey, corners, surveyed
from ulna.trajectory.trajectory import Trajectory
from ulna.typing import Floats

MOST = 20_000
"""How many segments there may be before none is halved any more."""

_FIT, _FITS = (
    5e-7,
    12,
)  # error of quartics that is allowed, in parts of the greatest value, and rounds of halving
_NOISE = 1e-3  # errors below this that halving twice does not reduce are those of rounding
_SHORTEST = 1e-5  # how long a segment lasts at least, in parts of about the whole: else times lose digits

MakeRows = Callable[[Floats, Floats, Floats], Rows]
RowArrays = tuple[Floats, Floats, Floats, Floats]


@dataclass(frozen=True, eq=False)
class Task:
    """What is asked: a path, its limits, rates at the ends, and whether limits hold at both ends of segments at first.

    `rows` makes the constraints of places on the path from q, p' and p''; `exact` says whether quartics are exact.
    """

    path: Trajectory
    names: Sequence[str]
    speeds: Bounds
    rows: MakeRows
    rates: tuple[float, float]
    both_ends: bool
    exact: bool


@dataclass(frozen=True, eq=False)
class DiscretizedTask:
    """The task on one grid: samples, rows, those at the start and the end of segments, and greatest squared rates.

    `top` are greatest squared rates of grid points, (N + 1,); `rests` are the segments at one of whose ends the path is
    at rest, (N,).
    """

    at: Sampled
    rows: Rows
    start: RowArrays
    end: RowArrays
    survey: Survey
    top: Floats
    rests: Any


def refined(task: Task, s: Floats) -> DiscretizedTask:
    """The task on a grid on whose segments quartics are good enough.

    Args:
        task: Path, limits and rates at the ends.
        s: Grid points to begin with, (N + 1,).

    Returns:
        The task on a finer grid, if need be.
    """
    at = sampled(task.path, s)
    survey = surveyed(at, task.speeds)
    if survey.slow_first.any() or survey.slow_last.any():
        at, survey = sampled(task.path, graded(s, survey.slow_first, survey.slow_last)), None
    rows = task.rows(at.q, at.tangent, at.curvature)
    before, stuck = np.inf, 0
    for _ in range(0 if task.exact else _FITS):
        errors = _fit_errors(task, at, rows)
        poor, worst = errors > _FIT, float(errors.max())
        stuck = stuck + 1 if 0.5 * before < worst < _NOISE else 0
        if not poor.any() or at.s.size > MOST or stuck == 2:
            break
        before = worst
        at, survey = sampled(task.path, halved(at.s, poor)), None
        rows = task.rows(at.q, at.tangent, at.curvature)
        if worst < 16.0 * _FIT:  # halving reduces the error by a factor of 32
            break
    return discretized(task, at, rows, survey)


def discretized(task: Task, at: Sampled, rows: Rows, survey: Survey | None = None) -> DiscretizedTask:
    """The task on a grid, from its samples.

    Args:
        task: Path, limits and rates at the ends.
        at: Samples of the path.
        rows: Constraints at the same places.
        survey: What the samples say; None to find it.

    Returns:
        The task on the grid of `at`.

    Raises:
        InputError: The path does not move, or jumps; says where.
    """
    survey = survey or surveyed(at, task.speeds)
    size = float(survey.size.max())
    if size <= TINY:
        raise InputError("The path does not move: all its points are the same; expected points that differ.")
    first, last = survey.rests_first, survey.rests_last
    rests = first | last
    top = np.full(at.s.size, HUGE)
    if rests.any() or max(survey.start.max(), survey.end.max()) > 1e-3 * HUGE:
        fast = _typical_squared_rate(at, rows) * (at.D / (2.0 * _SHORTEST * at.s[-1])) ** 2
        top[0], top[-1], top[1:-1] = fast[0], fast[-1], np.minimum(fast[:-1], fast[1:])
    stops = corners(task.path, at, size)
    if stops.size:
        top[stops] = 0.0
    starts, ends = _at_node(at, rows, 0, first, 0.5), _at_node(at, rows, -1, last, -0.5)
    return DiscretizedTask(at, rows, starts, ends, survey, top, rests)


def _at_node(at: Sampled, rows: Rows, node: int, rest: Any, step: float) -> RowArrays:
    """The rows at the first or the last node of each segment; those at its middle where the path rests at that node.

    At rest all factors are zero, so that nothing would be limited. The middle is half of D away: with `step` 0.5, or
    -0.5 seen from the end, its x is x + step D u.
    """
    four = _rows_at(rows, node)
    if not rest.any():
        return four
    a, b, low, high = (np.array(part) for part in np.broadcast_arrays(*four))
    a1, b1, low1, high1 = np.broadcast_arrays(*_rows_at(rows, 2))
    a[rest] = a1[rest] + step * at.D[rest, None] * b1[rest]
    b[rest], low[rest], high[rest] = b1[rest], low1[rest], high1[rest]
    return a, b, low, high


def _rows_at(rows: Rows, node: int) -> RowArrays:
    if rows.low.ndim == 2:
        return rows.a[:, node], rows.b[:, node], rows.low[0], rows.high[0]
    return rows.a[:, node], rows.b[:, node], rows.low[:, node], rows.high[:, node]


def _fit_errors(task: Task, at: Sampled, rows: Rows) -> Floats:
    """How far quartics through the samples are from the constraints, in parts of the greatest ones, (N,)."""
    q, tangent, curvature = at_nodes(task.path, at.s, PROBES)
    truth = task.rows(q, tangent, curvature)
    have, want = (rows.a, rows.b, rows.high), (truth.a, truth.b, truth.high)
    count = 2 if rows.high.ndim == 2 else 3
    worst = misfit(have[:count], want[:count])
    if task.speeds.any:
        worst = np.maximum(worst, misfit((at.tangent,), (tangent,)))
    return worst


def holds_still(grid: DiscretizedTask) -> bool:
    """Whether a robot at rest is within all limits everywhere: then going slower is always possible."""
    return float(grid.rows.low.max()) < 0.0 < float(grid.rows.high.min())


def _typical_squared_rate(at: Sampled, rows: Rows) -> float:
    """The median over the path of the squared rates that constraints allow.

    Raises:
        InputError: The path does not move.
    """
    limit = np.minimum(-rows.limits[0], rows.limits[1])
    hard = ((np.abs(rows.a) / (2.0 * at.s[-1]) + np.abs(rows.b)) / limit).max(axis=(1, 2))
    hard = hard[hard > 0.0]
    if not hard.size:
        raise InputError(
            "The path does not move any joint whose acceleration or torque is limited; expected way-points that "
            "differ, and limits for joints that move."
        )
    return float(np.median(1.0 / hard))


def static_violation(task: Task, grid: DiscretizedTask) -> str:
    """A sentence on the limit that a robot at rest exceeds most.

    Args:
        task: Path, limits and rates at the ends.
        grid: The task on a grid.

    Returns:
        The sentence; "" where the robot can rest anywhere on the path.
    """
    if holds_still(grid):
        return ""
    rows = grid.rows
    low, high = rows.limits
    span = high - low
    over = np.maximum(rows.low, -rows.high) / span
    k, node, j = np.unravel_index(int(np.argmax(over)), over.shape)
    value = high[j] - rows.high[k, node, j]
    limit = high[j] if value >= high[j] else low[j]
    place = grid.at.s[k] + 0.5 * grid.at.D[k] * NODES[node]
    return f"At rest at s = {place:.6g} the {rows.labels(task.names)[j]} is {value:.6g}, beyond its limit {limit:.6g}. "
