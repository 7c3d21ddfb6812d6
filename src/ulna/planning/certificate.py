"""Proof that nothing touches on a path of straight motions, between its points, in float64.

| symbol | meaning | shape | unit |
|---|---|---|---|
| d(t) | clearance of the spheres at a time t of a motion, 0 to 1 | () | [m] |
| mu | bound of how fast anything that is checked approaches on the motion | () | [m] |

From t on, nothing touches for d(t) / mu either way. An interval is proved where its middle's clearance reaches its
ends, and halved where it does not. Source: Schwarzer, Saha and Latombe, Adaptive dynamic collision checking, IEEE
Transactions on Robotics 21 (2005).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import number
from ulna.data_classes import dataclass
from ulna.errors import ShapeError
from ulna.planning.scenes import PlanningScene
from ulna.typing import Floats

SMALLEST = 2e-6
"""Intervals on which nothing moves farther than this are not halved any more [m]."""

_FIRST = 0.05  # intervals are this long at first [m]

_AT_ONCE = 16_384  # intervals, for memory


@dataclass(frozen=True, eq=False)
class Certificate:
    """What was proved of a path.

    Attributes:
        unproved: The edges, by number, of which it was not proved that nothing touches.
        clearance: What is proved is at least this far from everything that it may not touch [m].
        checks: How many configurations were checked in float64; 0 where the steps of the search were proof enough.
    """

    unproved: tuple[int, ...]
    clearance: float
    checks: int

    def __bool__(self) -> bool:
        return not self.unproved


def certify(scene: PlanningScene, points: Floats, margin: float = 0.0) -> Certificate:
    """Proves, where it can, that nothing comes nearer than a margin on straight motions from point to point.

    Args:
        scene: The robot in its world.
        points: Configurations, shape (n, nq) [rad, m]; a single one counts as an edge of no length.
        margin: How near [m].

    Returns:
        The certificate. An edge is not proved where spheres touch or come within 2 micrometres of it.

    Raises:
        ShapeError: If `points` is not of shape (n, nq) with one point at least.
        NonFiniteError: If `points` is not finite.
        InputError: If `margin` is no length.
    """
    points = finite_array("points", points)
    if points.ndim != 2 or points.shape[1] != scene.robot.model.nq or not len(points):
        raise ShapeError("points", points.shape, f"(n, {scene.robot.model.nq}), one point at least")
    margin = number("margin", margin, "a length, not below 0 [m]", least=0.0)
    if len(points) == 1:  # a path that does not move is one edge of no length
        points = np.repeat(points, 2, axis=0)
    change = np.abs(np.diff(points, axis=0))
    speeds = [change @ bounds.T for bounds in scene.moving.bounds_of_motion if len(bounds)]
    mu = np.concatenate(speeds, axis=1).max(axis=1)
    ends = np.cumsum(np.maximum(np.ceil(mu / _FIRST), 1.0))
    unproved: set[int] = set()
    checks, first, last = 0, 0.0, float(ends[-1])
    while first < last:  # as many intervals at once as fit
        k = first + np.arange(min(_AT_ONCE, last - first))
        edge = np.searchsorted(ends, k, side="right")
        count = np.diff(ends, prepend=0.0)[edge]
        start = (k - (ends[edge] - count)) / count
        found, used = _unproved(scene, points, margin, mu, (edge, start, 1.0 / count))
        unproved, checks, first = unproved | found, checks + used, first + len(k)
    return Certificate(tuple(sorted(unproved)), margin, checks)


def _unproved(
    scene: PlanningScene, points: Floats, margin: float, mu: Floats, intervals: tuple[Any, Floats, Floats]
) -> tuple[set[int], int]:
    """Which edges are not proved on some intervals: their edges, where they begin, and widths; and how many checks."""
    edge, start, width = intervals
    unproved: set[int] = set()
    checks = 0
    while len(edge):
        middle = (start + width / 2.0)[:, None]
        q = points[edge] * (1.0 - middle) + points[edge + 1] * middle
        clearance = np.atleast_1d(scene.checker.clearance(q)) - margin
        checks += len(q)
        half = mu[edge] * width / 2.0
        open_ones = ~(clearance > half)
        failed = open_ones & ((clearance <= 0.0) | (half < SMALLEST))
        unproved |= set(edge[failed].tolist())
        again = open_ones & ~np.isin(edge, list(unproved))
        edge = np.repeat(edge[again], 2)
        width = np.repeat(width[again] / 2.0, 2)
        start = np.repeat(start[again], 2)
        start[1::2] += width[1::2]
    return unproved, checks
