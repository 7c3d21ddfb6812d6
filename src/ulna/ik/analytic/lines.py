"""Lines that joints turn about, and turning points, vectors and poses about them; generic in the scalar.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| h, p | direction, point of an axis | (3,), (3,) [m] | |
| E(q) | turning by q about it: R = exp(q [h]x), x -> p + R (x - p) | SE3 | Murray, Li & Sastry 1994, 2.3 |
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ulna.numeric import cross, dot, sincos, skew, sqrt, vector, where
from ulna.spatial import SE3
from ulna.typing import Array


class Line(NamedTuple):
    """An axis: unit direction h and a point p on it [m]."""

    direction: Array
    point: Array

    def moved(self, pose: SE3) -> Line:
        """The line carried along by a motion."""
        return Line(pose.rotation @ self.direction, pose @ self.point)

    def reversed(self) -> Line:
        """The same line with the opposite direction: turning about it by q undoes turning by q about this one."""
        return Line(-self.direction, self.point)


def turn(direction: Array, angle: Any) -> Array:
    """exp(angle [h]x), (3, 3): Rodrigues' formula.

    Args:
        direction: Unit vector h, (3,).
        angle: Angle [rad].

    Returns:
        Rotation matrix (3, 3).
    """
    s, c = sincos(angle)
    k = skew(direction)
    return np.eye(3) + s * k + (1.0 - c) * (k @ k)


def turn_about(line: Line, angle: Any) -> SE3:
    """E(angle): the motion of turning about a line.

    Args:
        line: The axis; its direction is a unit vector.
        angle: Angle [rad].

    Returns:
        The motion.
    """
    R = turn(line.direction, angle)
    return SE3(R, line.point - R @ line.point)


def swing(direction: Array, v: Array) -> tuple[Array, Array, Array]:
    """The parts of `turn(h, x) @ v` that are constant, that go with cos x, and that go with sin x.

    Args:
        direction: Unit vector h, (3,).
        v: Vector, (3,), in any unit [-].

    Returns:
        Three vectors (3,); the first plus cos x times the second plus sin x times the third is the turned vector.
    """
    along = direction * dot(direction, v)
    return along, v - along, cross(direction, v)


def across(a: Array, b: Array) -> Array:
    """The part of `a` that is perpendicular to the unit vector `b`.

    Args:
        a: Vector, (3,).
        b: Unit vector, (3,).

    Returns:
        Vector (3,).
    """
    return a - b * dot(a, b)


def perpendicular(direction: Array) -> Array:
    """A unit vector perpendicular to a direction."""
    x, y, _ = direction
    flat = x * x + y * y < 0.5
    u = where(flat, 1.0, 0.0)
    v = cross(direction, vector(u, 0.0, 1.0 - u))
    return v / sqrt(dot(v, v))


def nearest_points(a: Line, b: Line) -> tuple[Array, Array]:
    """The feet of the common normal of two lines that are not parallel: a point of each.

    Args:
        a: A line.
        b: Another line.

    Returns:
        A point (3,) of `a` and one of `b`, both (3,) [m].
    """
    between = b.point - a.point
    normal = cross(a.direction, b.direction)
    square = dot(normal, normal)
    on_a = dot(cross(between, b.direction), normal) / square
    on_b = dot(cross(between, a.direction), normal) / square
    return a.point + on_a * a.direction, b.point + on_b * b.direction
