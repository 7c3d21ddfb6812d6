"""Rows of a velocity controller that keep a robot away from obstacles and from itself.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| d, g | distance of two shapes, and its gradient by the joints | [m], (nv,) | |
| d_i, d_s | distance where it begins to count, where approach stops | [m] | |
| xi | speed of approach allowed at d_i | [m/s] | |
| n, p | direction from the robot to the obstacle, and the obstacle's nearest point | (3,), (3,) [m] | |
| w | velocity of that point with the obstacle | (3,) [m/s] | |
| row | -g v <= xi max(d - d_s, 0) / (d_i - d_s) + n . w | | Haviland & Corke 2021, eq. 19 |

Sources: Faverjon & Tournassoud, A local based approach for path planning of manipulators with a high number of degrees
of freedom (1987); Haviland & Corke, NEO: a novel expeditious optimisation algorithm for reactive motion control of
manipulators (2021). Nearer than d_s nothing may come nearer still, but need not retreat: standing still keeps every row
of obstacles that stand, so that a controller is never without an answer.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.checks.values import checked_robot, number
from ulna.collision import Proximity, World
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.robot import Robot
from ulna.spatial import SE3
from ulna.typing import ArrayLike, Floats

_SELF_COLLISION = (0.05, 0.01)


def obstacle_rows(
    robot: Robot,
    q: ArrayLike,
    world: World | None = None,
    *,
    influence: float = 0.3,
    stop: float = 0.05,
    gain: float = 1.0,
    own: tuple[float, float] | None = _SELF_COLLISION,
    moving: Mapping[str, ArrayLike] | None = None,
    twists: Mapping[str, ArrayLike] | None = None,
    count: int | None = None,
    **options: Any,
) -> tuple[Floats, Floats]:
    """Rows A v <= b that keep every link away from every obstacle and from the other links.

    For `Reactive(...)(q, twist, rows=obstacle_rows(...))`, and for a `ulna.ik.LinearLimit` with `count`.

    Args:
        robot: The robot.
        q: Configuration, (nq,) [rad or m].
        world: Obstacles; None for the robot alone.
        influence: How near to an obstacle a link begins to slow down [m].
        stop: How near it comes at most [m]; more than what a step may miss.
        gain: Speed of approach allowed at `influence` [m/s].
        own: `influence` and `stop` of links among each other, which are near each other by their make; None to leave
            them out.
        moving: Poses of the world's moving obstacles by name, T_world_shape (4, 4).
        twists: How obstacles move, by name: twists (6,) of their origins in world axes, linear part first
            [m/s, rad/s]. A row may then ask for retreat, faster than the robot can perhaps.
        count: Exactly so many rows, by rows of zeros; None for as many as there are.
        **options: Of `robot.collision.checker`: pairs, without, convex, missing.

    Returns:
        A (k, nv) and b (k,), one row for each two that are near: obstacles first, the nearest first.

    Raises:
        InputError: If `stop` is not less than `influence`, `gain` is below 0 or not finite, or there are more rows than
            `count`.
        UnknownName: If `moving` or `twists` names no obstacle.
        ShapeError, DtypeError, NonFiniteError, ModelError, MissingExtra: As for `robot.distance`.
    """
    links = set(checked_robot(robot).link_names)
    _check("influence", influence, stop, gain)
    for name in twists or {}:
        if world is None or name not in world:
            raise UnknownName("obstacle", name, () if world is None else world.names)
    A, b = [], []
    if world is not None:
        checker = robot.collision.checker(world, **{**options, "pairs": ()})
        for item in checker.nearest(q, moving, within=influence):
            A.append(-item.gradient)
            b.append(
                _approach(item, influence, stop, gain) + _parting(item, world, moving or {}, twists or {})
            )
    if own is not None:
        _check("own", *own, gain)
        if "without" in options:
            options["without"] = [pair for pair in options["without"] if links.issuperset(pair)]
        for item in robot.collision.checker(**options).nearest(q, within=own[0]):
            A.append(-item.gradient)
            b.append(_approach(item, *own, gain))
    if count is not None and len(b) > count:
        raise InputError(
            f"{len(b)} pairs are near, and `count` is {count}; expected a count of at least {len(b)}."
        )
    spare = 0 if count is None else count - len(b)
    return np.array([*A, *np.zeros((spare, robot.nv))]).reshape(-1, robot.nv), np.array(b + [0.0] * spare)


def _check(name: str, influence: float, stop: float, gain: float) -> None:
    number("gain", gain, "a finite speed, not below 0 [m/s]", least=0.0)
    if not 0.0 <= stop < influence < np.inf:
        raise InputError(
            f"`{name}` begins at {influence} m and stops at {stop} m; expected 0 <= stop < influence [m]."
        )


def _approach(item: Proximity, influence: float, stop: float, gain: float) -> float:
    """The speed at which two things may come nearer [m/s]."""
    return gain * max(item.distance - stop, 0.0) / (influence - stop)


def _parting(
    item: Proximity, world: World, moving: Mapping[str, ArrayLike], twists: Mapping[str, ArrayLike]
) -> float:
    """The speed at which an obstacle goes away from the link by itself [m/s]."""
    name = item.names[1]
    if name not in twists:
        return 0.0
    twist = batched_array(f"twists[{name!r}]", twists[name], (6,))
    if twist.ndim > 1:
        raise ShapeError(f"twists[{name!r}]", twist.shape, "(6,)")
    pose: Any = moving.get(name, world[name].pose)
    origin = pose.translation if isinstance(pose, SE3) else np.asarray(pose)[:3, 3]
    return float(item.normal @ (twist[:3] + np.cross(twist[3:], item.points[1] - origin)))
