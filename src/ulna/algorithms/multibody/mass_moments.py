"""The inertia of a rigid body as mass, first and second moment about a frame's origin, which add up.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| m | mass | () | [kg] | |
| c | first moment: mass times centre of mass | (3) | [kg m] | |
| I | rotational inertia about the origin | (3, 3) | [kg m^2] | |
| h = (p, n) | momentum at the twist (v, w) | Force | [N s, N m s] | p = m v + w x c, n = I w + c x v |
| D | rate of I about an origin that is at rest | (3, 3) | [kg m^2/s] | [w] I - I [w] + 2 (c.v) 1 - c v^T - v c^T |

Source: Featherstone 2008, appendix A.3 (the ten numbers of a rigid-body inertia) and A.5 (the rotation of I about a
coordinate axis).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.algorithms.multibody.tree import Step
from ulna.data_classes import dataclass
from ulna.model import Continuous, Helical, JointKind, Model, Revolute
from ulna.numeric import apply, cross, matrix, skew
from ulna.spatial import SE3, Force, Inertia, Motion
from ulna.spatial.batched import column
from ulna.spatial.inertia import rotate_tensor
from ulna.typing import Array

UPPER = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
"""The entries on and above the diagonal of a matrix, (3, 3)."""


@dataclass(frozen=True, slots=True)
class MassMoments:
    """Mass, first and second moment of bodies about the origin of a frame; those in one frame are added."""

    mass: Any
    first: Array
    second: Array

    @classmethod
    def of_body(cls, inertia: Inertia) -> MassMoments:
        """Those of one body."""
        return cls(inertia.mass, inertia.first_moment(), inertia.about_origin())

    @classmethod
    def zero(cls) -> MassMoments:
        """Those of no body."""
        return cls(0.0, np.zeros(3), np.zeros((3, 3)))

    def __add__(self, other: MassMoments) -> MassMoments:
        return MassMoments(self.mass + other.mass, self.first + other.first, self.second + other.second)

    def __sub__(self, other: MassMoments) -> MassMoments:
        return MassMoments(self.mass - other.mass, self.first - other.first, self.second - other.second)

    def apply(self, motion: Motion) -> Force:
        """The momentum at a twist, or the force at an acceleration."""
        v, w = motion.linear, motion.angular
        linear = column(self.mass) * v + cross(w, self.first)
        return Force(linear, apply(self.second, w) + cross(self.first, v))

    def matrix(self) -> Array:
        """The 6x6 inertia, shape (..., 6, 6), linear part first: momentum = matrix @ twist."""
        c, m = skew(self.first), column(self.mass, 2) * np.eye(3)
        m, c, I = np.broadcast_arrays(m, c, self.second)
        return np.concatenate([np.concatenate([m, -c], axis=-1), np.concatenate([c, I], axis=-1)], axis=-2)

    def rate(self, V: Motion) -> Array:
        """D of a body with the twist V, about an origin at rest, shape (..., 3, 3) [kg m^2/s]."""
        w, I, c, v = V.angular, self.second, self.first, V.linear
        x, y, z = w[..., 0], w[..., 1], w[..., 2]
        e = [[I[..., i, j] for j in range(3)] for i in range(3)]
        xx = 2.0 * e[0][2] * y - 2.0 * e[0][1] * z
        yy = 2.0 * e[0][1] * z - 2.0 * e[1][2] * x
        xy = z * (e[0][0] - e[1][1]) + y * e[1][2] - x * e[0][2]
        xz = y * (e[2][2] - e[0][0]) + x * e[0][1] - z * e[1][2]
        yz = x * (e[1][1] - e[2][2]) + z * e[0][2] - y * e[0][1]
        rotation = matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, -(xx + yy)]])
        return rotation + steiner(c, v)

    def to_outer_frame(self, T: SE3, axis: int | None = None) -> MassMoments:
        """The same about the origin of the frame in which the present one has the pose T.

        Args:
            T: The pose of the present frame in the outer one [m].
            axis: The coordinate axis, 0, 1 or 2, about which T turns, which saves operations; None for any rotation.

        Returns:
            The moments about the origin of the outer frame, in its axes [kg, kg m, kg m^2].
        """
        p, m = T.translation, self.mass
        c = apply(T.rotation, self.first)
        shifted = c + column(m) * p
        I = rotate_symmetric(T.rotation, self.second, axis) + steiner(p, c + 0.5 * column(m) * p)
        return MassMoments(m, shifted, I)


def body_moments(model: Model, tree: Sequence[Step]) -> list[MassMoments]:
    """The inertia of the body of every step.

    Args:
        model: The robot.
        tree: Its steps, of which the last one of every joint carries the body.

    Returns:
        For each step the moments in the moving frame of its joint [kg, kg m, kg m^2]; zero for the inner parts of a
        joint.
    """
    return [
        MassMoments.of_body(model.inertias[model.joint_index(step.joint.name)])
        if step.is_last
        else MassMoments.zero()
        for step in tree
    ]


def in_fixed_frame(step: Step, body: MassMoments, q: Array) -> MassMoments:
    """J(q) acting on an inertia.

    Args:
        step: The step whose moving frame it is written in.
        body: Mass moments about the origin of that frame [kg, kg m, kg m^2].
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        The same inertia in the fixed frame of the step [kg, kg m, kg m^2].
    """
    return body.to_outer_frame(step.transform(q), rotation_axis(step.kind))


def in_parent_frame(step: Step, body: MassMoments, q: Array) -> MassMoments:
    """X acting on an inertia.

    Args:
        step: The step whose moving frame it is written in.
        body: Mass moments about the origin of that frame [kg, kg m, kg m^2].
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        The same inertia in the moving frame of the parent [kg, kg m, kg m^2].
    """
    return in_fixed_frame(step, body, q).to_outer_frame(step.placement)


def steiner(a: Array, b: Array) -> Array:
    """The symmetric matrix 2 (a.b) 1 - a b^T - b a^T of the parallel-axis theorem.

    Args:
        a, b: Vectors, shape (..., 3).

    Returns:
        Shape (..., 3, 3), in the product of the units of `a` and `b`.
    """
    (a0, a1, a2), (b0, b1, b2) = ([u[..., n] for n in range(3)] for u in (a, b))
    xx, yy, zz = 2.0 * a0 * b0, 2.0 * a1 * b1, 2.0 * a2 * b2
    xy, xz, yz = -(a0 * b1 + a1 * b0), -(a0 * b2 + a2 * b0), -(a1 * b2 + a2 * b1)
    return matrix([[yy + zz, xy, xz], [xy, xx + zz, yz], [xz, yz, xx + yy]])


def rotate_symmetric(R: Array, I: Array, axis: int | None = None) -> Array:
    """R I R^T of a symmetric I.

    Args:
        R: Rotation, shape (..., 3, 3) [-].
        I: Symmetric matrix, shape (..., 3, 3).
        axis: The coordinate axis, 0, 1 or 2, about which R turns, which saves operations; None for any rotation.

    Returns:
        The rotated matrix, shape (..., 3, 3), in the unit of `I`.
    """
    if axis is None:
        return rotate_tensor(R, I)
    a, b, k = (axis + 1) % 3, (axis + 2) % 3, axis
    cos, sin = R[..., a, a], R[..., b, a]
    u = sin * (I[..., a, a] - I[..., b, b]) + cos * (2.0 * I[..., a, b])
    t = sin * u
    out: list[list[Any]] = [[None] * 3 for _ in range(3)]
    out[a][a], out[b][b], out[k][k] = I[..., a, a] - t, I[..., b, b] + t, I[..., k, k]
    out[a][b] = out[b][a] = cos * u - I[..., a, b]
    out[a][k] = out[k][a] = cos * I[..., a, k] - sin * I[..., b, k]
    out[b][k] = out[k][b] = sin * I[..., a, k] + cos * I[..., b, k]
    return matrix(out)


def rotation_axis(kind: JointKind) -> int | None:
    """The coordinate axis, 0, 1 or 2, about which a joint turns its moving frame; None if it is not one."""
    if isinstance(kind, (Revolute, Continuous, Helical)):
        axis = np.asarray(kind.axis)
        if np.count_nonzero(axis) == 1:
            return int(np.abs(axis).argmax())
    return None


def symmetric(upper: Sequence[Any] | Array) -> Array:
    """A symmetric matrix.

    Args:
        upper: Its entries in the order of `UPPER`.

    Returns:
        The matrix, shape (3, 3), in the unit of the entries.
    """
    out = np.empty((3, 3), dtype=object)
    for (i, j), x in zip(UPPER, upper, strict=True):
        out[i, j] = out[j, i] = x
    return out
