"""Poses along lines, screws and circles.

| symbol | meaning | shape | unit |
|---|---|---|---|
| T(s) | pose for the part s of the way, 0 to 1 | (4, 4) | [m] |
| V | d/ds of origin, and rotation rate, in world axes | (6,) | [m], [rad] |
| xi | twist of a screw in the moving frame, log(T0^-1 T1) | (6,) | [m], [rad] |

Straight: p = p0 + s (p1 - p0), R = R0 exp(s w). Screw: T = T0 exp(s xi). Circle: p = c + exp(s w) r, R = R0 or
exp(s w) R0. Source: Lynch & Park, Modern Robotics (2017), section 9.2.1; Siciliano et al., Robotics (2009),
section 4.3.
"""

from __future__ import annotations

from typing import Any, Literal, final

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.numeric import apply, cross
from ulna.spatial import SE3, Motion, so3_exp, so3_log
from ulna.trajectory.compose import Retimed
from ulna.trajectory.inputs import pose, vector
from ulna.trajectory.paths import UnitPath, law
from ulna.trajectory.polynomial import Polynomial
from ulna.trajectory.space import Poses, Space
from ulna.trajectory.trajectory import Trajectory
from ulna.typing import ArrayLike, Floats

Interpolation = Literal["straight", "screw"]


@final
@dataclass(frozen=True, eq=False, repr=False)
class Screw(UnitPath):
    """From a pose at a constant twist in the moving frame, in one second."""

    origin: SE3
    twist: Motion
    kind: str = "screw"
    space: Space = Poses()

    def _at(self, t: Floats, order: int) -> tuple[Floats, ...]:
        T = self.origin @ SE3.exp(Motion(t[:, None] * self.twist.linear, t[:, None] * self.twist.angular))
        rows: list[Floats] = [np.asarray(T.matrix())]
        if order:
            rows.append(_side_by_side(T, self.twist.linear, self.twist.angular))
        if order > 1:
            rows.append(_side_by_side(T, cross(self.twist.angular, self.twist.linear), np.zeros(3)))
        return tuple(rows)


@final
@dataclass(frozen=True, eq=False, repr=False)
class Arc(UnitPath):
    """The origin along a circle (or a straight line, with no turn), and the rotation evenly about an axis, in
    one second.

    Attributes:
        origin: The pose at the start.
        centre: Of the circle, (3,) [m].
        sweep: Axis times angle that the origin turns about the centre, (3,) [rad].
        displacement: Straight displacement added to it, (3,) [m].
        turn: Axis times angle that the rotation turns, in world axes, (3,) [rad].
    """

    origin: SE3
    centre: Floats
    sweep: Floats
    displacement: Floats
    turn: Floats
    kind: str
    space: Space = Poses()

    def _at(self, t: Floats, order: int) -> tuple[Floats, ...]:
        s = t[:, None]
        arm = apply(so3_exp(s * self.sweep), self.origin.translation - self.centre)
        T = SE3(so3_exp(s * self.turn) @ self.origin.rotation, self.centre + arm + s * self.displacement)
        rows: list[Floats] = [np.asarray(T.matrix())]
        rate = cross(np.broadcast_to(self.sweep, arm.shape), arm)
        turn = np.broadcast_to(self.turn, arm.shape)
        if order:
            rows.append(np.concatenate([rate + self.displacement, turn], axis=1))
        if order > 1:
            pull = cross(np.broadcast_to(self.sweep, arm.shape), rate)
            rows.append(np.concatenate([pull, np.zeros_like(turn)], axis=1))
        return tuple(rows)


def pose_line(
    T0: Any,
    T1: Any,
    duration: float | None = None,
    interpolation: Interpolation = "straight",
    *,
    velocity: tuple[float, float] | None = None,
    acceleration: tuple[float, float] | None = None,
    jerk: tuple[float, float] | None = None,
) -> Trajectory:
    """From rest to rest between two poses.

    Args:
        T0: Start, T_world_frame: an SE3 or (4, 4).
        T1: End.
        duration: Time it takes [s], under a quintic law.
        interpolation: "straight": the origin on a straight line, the rotation evenly about one axis; "screw": both as
            one screw, at a constant twist of the moving frame.
        velocity: Limits of speed instead, of the origin [m/s] and of rotation [rad/s]: as fast as they allow, with a
            trapezoidal law, or an S-curve with `jerk`.
        acceleration: Limits of acceleration along the way, likewise [m/s^2, rad/s^2].
        jerk: Limits of jerk along the way, likewise; None for no limit.

    Returns:
        A trajectory of poses.

    Raises:
        InputError: Not poses, equal poses, neither a duration nor limits.
        UnknownName: No such interpolation.

    Example:
        >>> T = ulna.SE3(0.5, 0, 0)
        >>> line = ulna.trajectory.pose_line(ulna.SE3(), T, velocity=(0.25, 1.0), acceleration=(1.0, 4.0))
        >>> line.duration
        2.25
    """
    a, b = pose("T0", T0), pose("T1", T1)
    displacement, turn = b.translation - a.translation, so3_log(b.rotation @ a.rotation.T)
    if interpolation == "straight":
        path: Trajectory = Arc(a, a.translation, np.zeros(3), displacement, turn, "pose line")
        lengths = np.linalg.norm([displacement, turn], axis=1)
    elif interpolation == "screw":
        twist = (a.inverse() @ b).log()
        path = Screw(a, twist)
        lengths = np.linalg.norm([twist.linear, twist.angular], axis=1)
    else:
        raise UnknownName("interpolation", interpolation, ("straight", "screw"))
    if not lengths.any():
        raise InputError("`T0` and `T1` are the same pose; expected poses that differ.")
    return Retimed(path, _law(lengths, duration, velocity, acceleration, jerk), path.kind)


def circle(
    T0: Any,
    centre: ArrayLike,
    axis: ArrayLike,
    angle: float = 2.0 * np.pi,
    duration: float | None = None,
    orientation: Literal["fixed", "turning"] = "fixed",
    *,
    velocity: tuple[float, float] | None = None,
    acceleration: tuple[float, float] | None = None,
    jerk: tuple[float, float] | None = None,
) -> Trajectory:
    """From rest to rest along a circle.

    Args:
        T0: Pose at the start, T_world_frame: an SE3 or (4, 4); its origin lies on the circle.
        centre: Any point on the circle's axis, (3,) [m].
        axis: Direction of that axis, (3,); the motion is right-handed about it.
        angle: How far to go [rad]; negative for the other way, more than a turn for several.
        duration: Time it takes [s], under a quintic law.
        orientation: "fixed" keeps the rotation, "turning" turns it with the circle.
        velocity: Limits of speed instead; see `pose_line`. The pull towards the centre is not counted.
        acceleration: Limits of acceleration along the circle; see `pose_line`.
        jerk: Limits of jerk along the circle; see `pose_line`.

    Returns:
        A trajectory of poses.

    Raises:
        InputError: No axis, a start on the axis, an angle of zero, neither a duration nor limits.
        UnknownName: No such `orientation`.

    Example:
        >>> T = ulna.SE3.pointing_down((0.5, 0.0, 0.3))
        >>> turn = ulna.trajectory.circle(T, centre=(0.4, 0.0, 0.3), axis=(0, 0, 1), duration=4.0)
        >>> turn(2.0)[:3, 3].round(6)  # half way around
        array([0.3, 0. , 0.3])
    """
    start, middle, direction = pose("T0", T0), vector("centre", centre, 3), vector("axis", axis, 3)
    size, radius = float(np.linalg.norm(direction)), start.translation - middle
    if size == 0.0:
        raise InputError("`axis` is zero; expected a direction, such as (0, 0, 1).")
    direction = direction / size
    middle = middle + direction * (direction @ radius)
    length = float(np.linalg.norm(start.translation - middle))
    if length <= 1e-12 * max(1.0, float(np.abs(middle).max())):
        raise InputError("`T0` lies on the circle's axis; expected a start at some distance from it.")
    if not np.isfinite(angle) or angle == 0.0:
        raise InputError(f"`angle` is {angle}; expected an angle that is not zero [rad].")
    if orientation not in ("fixed", "turning"):
        raise UnknownName("orientation", orientation, ("fixed", "turning"))
    sweep = direction * float(angle)
    turn = sweep if orientation == "turning" else np.zeros(3)
    path = Arc(start, middle, sweep, np.zeros(3), turn, "circle")
    lengths = np.array([length * abs(angle), float(np.linalg.norm(turn))])
    return Retimed(path, _law(lengths, duration, velocity, acceleration, jerk), "circle")


def arc_through(T0: Any, via: ArrayLike, end: ArrayLike, duration: float, **options: Any) -> Trajectory:
    """From rest to rest along the circle through three points; see `circle` for the options.

    Args:
        T0: Pose at the start, T_world_frame: an SE3 or (4, 4).
        via: A point on the way, (3,) [m].
        end: The point at the end, (3,) [m].
        duration: Time it takes [s].
        **options: `orientation`.

    Returns:
        A trajectory of poses.

    Raises:
        InputError: The three points lie on a line.
    """
    a, b, c = pose("T0", T0).translation, vector("via", via, 3), vector("end", end, 3)
    u, w = b - a, c - a
    normal = np.cross(u, w)
    square = float(normal @ normal)
    if square <= 1e-20 * float((u @ u) * (w @ w)) or not (u @ u) * (w @ w):
        raise InputError("The three points lie on a line; expected points of a circle, or use pose_line.")
    to_centre = np.cross((u @ u) * w - (w @ w) * u, normal) / (2.0 * square)
    first, last = -to_centre, w - to_centre
    angle = np.arctan2(np.cross(first, last) @ normal / np.sqrt(square), first @ last) % (2.0 * np.pi)
    return circle(T0, a + to_centre, normal, float(angle), duration, **options)


def _law(lengths: Floats, duration: Any, velocity: Any, acceleration: Any, jerk: Any) -> Polynomial:
    """The law for ways of the origin and of the rotation of those lengths."""
    for name, value in (("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)):
        if value is not None and np.shape(value) != (2,):
            raise InputError(f"`{name}` is {value}; expected two limits: of the origin, and of the rotation.")
    return law(lengths, duration, velocity, acceleration, jerk)


def _side_by_side(T: SE3, linear: Floats, angular: Floats) -> Floats:
    """Two vectors of the moving frame in world axes, (m, 6)."""
    both = [np.broadcast_to(apply(T.rotation, x), T.translation.shape) for x in (linear, angular)]
    return np.concatenate(both, axis=1)
