"""Which closed form fits an arm of six turning joints, and which joint of a seven-joint arm leaves one when it is held.

| symbol | meaning | source |
|---|---|---|
| W | three neighbouring axes that meet in a point, or are parallel | Pieper 1968 |
| X, Y, Z | the other three, in the order W X Y Z = G round the loop that the arm closes with its goal G | |
| a, b, c | X, Y, Z, or Z, Y, X: the first two are the pair whose relation simplifies the equations | |

Where a and b are parallel or intersect, every equation has two solutions, given by square roots; else one of them is
a quartic. Both are closed forms. An arm without any W takes elimination (see general.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Literal

import numpy as np

from ulna.data_classes import dataclass
from ulna.ik.analytic.chain import Arm
from ulna.ik.analytic.lines import Line, nearest_points

TOLERANCE = 1e-5
"""How far axes may be off a relation [rad, or arm lengths] for it to be used: models round pi/2 to a few digits."""

EXACT = 1e-9
"""How far they may be off for the closed form to be as good as exact."""

Triple = Literal["spherical", "parallel"]
Pair = Literal["parallel", "intersecting", "general"]


@dataclass(frozen=True)
class ArmGeometry:
    """The relations between the axes of an arm that a closed form uses.

    Attributes:
        free: Index of the joint that is held at chosen values (a seven-joint arm's); None where there is none.
        first: Index of the first axis of W among the remaining six.
        triple: Whether the axes of W meet in a point or are parallel.
        reverse: Whether a, b, c are Z, Y, X.
        pair: The relation of a and b.
        deviation: How far the axes are off the relations [rad, or arm lengths].
    """

    free: int | None
    first: int
    triple: Triple
    reverse: bool
    pair: Pair
    deviation: float

    @property
    def solution_counts(self) -> tuple[int, int, int]:
        """How many solutions the three equations have that have several."""
        return (4, 1, 2) if self.pair == "general" else (2, 2, 2)

    def describe(self, names: Sequence[str]) -> str:
        """The closed form as text; `names` are those of all joints of the arm."""
        used = [n for i, n in enumerate(names) if i != self.free][self.first : self.first + 3]
        relation = (
            "intersecting axes (a spherical wrist or shoulder)"
            if self.triple == "spherical"
            else "parallel axes"
        )
        method = "closed form" if self.pair != "general" else "closed form with a quartic"
        return f"three {relation}: {', '.join(used)}; {method}"


def arm_geometries(arm: Arm, free: int | None = None) -> list[ArmGeometry]:
    """The closed forms that fit an arm of six or seven joints, the simplest first.

    Args:
        arm: The arm; the joints that are not held must turn.
        free: Which of seven joints to hold; None for any.

    Returns:
        The geometries; empty where none fits.
    """
    count = len(arm.axes)
    turning = [axis.motion == "turn" for axis in arm.axes]
    holds: list[int | None] = [None]
    if count == 7:
        holds = list(range(6, -1, -1)) if free is None else [free]
        sliding = [i for i in range(7) if not turning[i]]
        holds = [h for h in holds if not sliding or sliding == [h]]
    elif count != 6 or not all(turning):
        return []
    candidates = [geometry for hold in holds for geometry in _of_six_joints(arm, hold)]
    return sorted(
        candidates, key=lambda g: (g.pair == "general", g.deviation > EXACT, _held_joint_is_inner(g))
    )


def remaining(arm: Arm, free: int | None, x: float = 0.0) -> list[Line]:
    """The axes of the joints that are not held, where the held one stands at `x`.

    Args:
        arm: The arm.
        free: Index of the joint that is held; None where there is none.
        x: Its position, before scale and offset of the coordinate [rad or m].

    Returns:
        The axes in the arm's base, from the base outwards.
    """
    if free is None:
        return [axis.line for axis in arm.axes]
    move = arm.axes[free].move(x)
    return [axis.line.moved(move) if i > free else axis.line for i, axis in enumerate(arm.axes) if i != free]


def loop_order(first: int) -> list[int]:
    """X, Y, Z as indices: the joints after W, then those before it."""
    return [(first + 3 + i) % 6 for i in range(3)]


def _held_joint_is_inner(geometry: ArmGeometry) -> bool:
    """Whether the held joint stands between others, so that axes depend on its position."""
    return geometry.free is not None and 0 < geometry.free < 6


def _of_six_joints(arm: Arm, free: int | None) -> list[ArmGeometry]:
    probes = [0.0] if free in (None, 0, len(arm.axes) - 1) else [0.3, 1.1, -2.0]
    sets = [remaining(arm, free, x) for x in probes]
    size = max(_reach(arm), 1e-9)
    candidates = []
    for first in range(4):
        triples: list[tuple[Triple, float]] = [
            (
                "spherical",
                max(_deviation_from_one_point([*lines[first : first + 3]], size) for lines in sets),
            ),
            ("parallel", max(_deviation_from_parallel(lines[first : first + 3]) for lines in sets)),
        ]
        order = loop_order(first)
        for triple, deviation in triples:
            if deviation > TOLERANCE:
                continue
            for reverse in (False, True):
                a, b, _ = order[::-1] if reverse else order
                if abs(a - b) != 1:
                    continue  # neighbours across the goal: their relation changes with it
                candidates.append(
                    _with_pair(free, first, triple, reverse, deviation, [(s[a], s[b]) for s in sets], size)
                )
    return [geometry for geometry in candidates if geometry is not None]


def _with_pair(
    free: int | None,
    first: int,
    triple: Triple,
    reverse: bool,
    deviation: float,
    pairs: list[tuple[Line, Line]],
    size: float,
) -> ArmGeometry | None:
    parallel = max(_deviation_from_parallel(pair) for pair in pairs)
    if parallel <= TOLERANCE:
        apart = min(_distance(a, b) for a, b in pairs) / size
        return (
            ArmGeometry(free, first, triple, reverse, "parallel", max(deviation, parallel))
            if apart > TOLERANCE
            else None
        )
    meet = max(_deviation_from_one_point(pair, size) for pair in pairs)
    if meet <= TOLERANCE:
        return ArmGeometry(free, first, triple, reverse, "intersecting", max(deviation, meet))
    if min(_deviation_from_parallel(pair) for pair in pairs) <= TOLERANCE:
        return None  # parallel for some positions of the held joint only
    return ArmGeometry(free, first, triple, reverse, "general", deviation)


def _deviation_from_parallel(lines: Sequence[Line]) -> float:
    """How far lines are off being parallel: the sine of the largest angle to the first."""
    return max(float(np.linalg.norm(np.cross(lines[0].direction, line.direction))) for line in lines[1:])


def _deviation_from_one_point(lines: Sequence[Line], size: float) -> float:
    """How far lines are off meeting in one point, in arm lengths; infinite where two are parallel."""
    for first, second in pairwise(lines):
        if _deviation_from_parallel((first, second)) < 1e-3:
            return np.inf
    point = meeting_point(lines)
    return max(_distance_to(point, line) for line in lines) / size


def meeting_point(lines: Sequence[Line]) -> np.ndarray:
    """The point with the least sum of squared distances to lines [m]."""
    projectors = [np.eye(3) - np.outer(line.direction, line.direction) for line in lines]
    return np.linalg.solve(
        np.sum(projectors, axis=0),
        np.sum([P @ line.point for P, line in zip(projectors, lines, strict=True)], axis=0),
    )


def _distance_to(point: np.ndarray, line: Line) -> float:
    return float(np.linalg.norm(np.cross(line.direction, point - line.point)))


def _distance(a: Line, b: Line) -> float:
    """The distance of two lines, parallel ones included [m]."""
    if _deviation_from_parallel((a, b)) < TOLERANCE:
        return _distance_to(b.point, a)
    on_a, on_b = nearest_points(a, b)
    return float(np.linalg.norm(on_b - on_a))


def _reach(arm: Arm) -> float:
    """The size of an arm: the sum of the distances from axis to axis and to the frame [m]."""
    points = [axis.line.point for axis in arm.axes] + [arm.end.translation]
    return float(sum(np.linalg.norm(b - a) for a, b in pairwise(points)))


__all__ = ["EXACT", "TOLERANCE", "ArmGeometry", "arm_geometries", "loop_order", "meeting_point", "remaining"]
