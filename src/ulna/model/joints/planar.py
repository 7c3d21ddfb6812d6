"""The planar joint: slides and turns in a plane; its positions form the group SE(2)."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ulna.data_classes import dataclass
from ulna.model.joints.axes import ZERO, Axis, axis_name, constant, rotation_about, snap, unit, unit_axis
from ulna.model.joints.joint_kind import Coordinate, JointKind, angle, length
from ulna.model.joints.turning import wrap
from ulna.numeric import matrix, sincos, vector
from ulna.spatial import (
    SE3,
    Motion,
    se3_right_jacobian,
    se3_right_jacobian_inverse,
    so3_left_jacobian,
    so3_left_jacobian_inverse,
)
from ulna.typing import Array, Floats

_IN_SE3 = [0, 1, 5]  # where (vx, vy, w) of the plane z = 0 stand among the six of a spatial twist


@dataclass(frozen=True)
class Planar(JointKind):
    """Slides and turns in a plane; q is (x, y, theta) [m, m, rad], v is (vx, vy, w) in the moving frame.

    With the normal z the plane's axes are x and y of the fixed frame. For another normal, the plane's first
    axis is the projection of the coordinate axis that follows the normal's largest component in the order x,
    y, z, x; so the normal x gives (y, z) and the normal y gives (z, x).

    Args:
        normal: Normal of the plane in the fixed frame; scaled to length 1.
    """

    normal: Axis = (0.0, 0.0, 1.0)
    name: ClassVar[str] = "planar"
    symbol: ClassVar[str] = "E"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (length("x"), length("y"), angle("theta"))
    rates: ClassVar[tuple[Coordinate, ...]] = (length("x"), length("y"), angle("theta"))

    def __post_init__(self) -> None:
        object.__setattr__(self, "normal", unit_axis(self.normal))

    @property
    def axes(self) -> tuple[Axis, Axis]:
        """The plane's two axes in the fixed frame; with the normal they form a right-handed frame."""
        n = np.array(self.normal)
        follows = np.eye(3)[(int(np.argmax(np.abs(n))) + 1) % 3]
        first = unit_axis(follows - n * (n @ follows))
        x, y, z = (snap(float(c)) for c in np.cross(n, first))
        return first, (x, y, z)

    def describe(self) -> str:
        """A short label for tables."""
        return f"planar {axis_name(self.normal)}"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: a translation in the plane, then a rotation about the normal."""
        first, second = self.axes
        place = vector(*(first[i] * q[..., 0] + second[i] * q[..., 1] for i in range(3)))
        return SE3(rotation_about(self.normal, q[..., 2]), place)

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The two linear unit motions in the plane and the rotation about its normal."""
        first, second = self.axes
        return Motion(constant(first), ZERO), Motion(constant(second), ZERO), Motion(ZERO, unit(self.normal))

    def integrate(self, q: Array, v: Array) -> Array:
        """`q` followed by the exponential of the body twist `v`: an arc of a circle."""
        turn, c, s = v[..., 2], *_cos_sin(q[..., 2])
        x, y = _in_plane(so3_left_jacobian(_about_z(turn)), v[..., 0], v[..., 1])
        return vector(q[..., 0] + c * x - s * y, q[..., 1] + s * x + c * y, q[..., 2] + turn)

    def difference(self, q0: Array, q1: Array) -> Array:
        """The logarithm of the motion from `q0` to `q1`; turns the shorter way."""
        turn, c, s = wrap(q1[..., 2] - q0[..., 2]), *_cos_sin(q0[..., 2])
        dx, dy = q1[..., 0] - q0[..., 0], q1[..., 1] - q0[..., 1]
        x, y = _in_plane(so3_left_jacobian_inverse(_about_z(turn)), c * dx + s * dy, c * dy - s * dx)
        return vector(x, y, turn)

    def coordinate_rates(self, q: Array, v: Array) -> Array:
        """The linear velocity in the plane's axes, and the angle's rate."""
        c, s = _cos_sin(q[..., 2])
        x, y = v[..., 0], v[..., 1]
        return vector(c * x - s * y, s * x + c * y, v[..., 2])

    def integrate_derivatives(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The adjoint of exp(-v), and the right Jacobian of SE(2) at v."""
        by_v = se3_right_jacobian(_spatial(v))[..., _IN_SE3, :][..., :, _IN_SE3]
        return _adjoint_of_inverse(v), by_v

    def difference_derivatives(self, q0: Array, q1: Array) -> tuple[Array, Array]:
        """Minus the inverse left Jacobian, and the inverse right Jacobian, of SE(2) at the difference."""
        twist = _spatial(self.difference(q0, q1))
        by_q0 = se3_right_jacobian_inverse(-twist)[..., _IN_SE3, :][..., :, _IN_SE3]
        by_q1 = se3_right_jacobian_inverse(twist)[..., _IN_SE3, :][..., :, _IN_SE3]
        return -by_q0, by_q1

    def neutral(self) -> Floats:
        """Zeros."""
        return np.zeros(3)

    def normalize(self, q: Array) -> Array:
        """The same place with the angle in (-pi, pi]."""
        return vector(q[..., 0], q[..., 1], wrap(q[..., 2]))


def _cos_sin(theta: Array) -> tuple[Array, Array]:
    s, c = sincos(theta)
    return c, s


def _about_z(turn: Array) -> Array:
    return vector(0.0, 0.0, turn)


def _spatial(v: Array) -> Array:
    """The body twist of the plane as the spatial twist (..., 6) of the plane z = 0."""
    return vector(v[..., 0], v[..., 1], 0.0, 0.0, 0.0, v[..., 2])


def _in_plane(m: Array, x: Array, y: Array) -> tuple[Array, Array]:
    return m[..., 0, 0] * x + m[..., 0, 1] * y, m[..., 1, 0] * x + m[..., 1, 1] * y


def _adjoint_of_inverse(v: Array) -> Array:
    """Ad(exp(-v)) of SE(2), which carries a body twist before the motion to one after it."""
    s, c = sincos(v[..., 2])
    x, y = _in_plane(so3_left_jacobian(_about_z(v[..., 2])), v[..., 0], v[..., 1])
    # the motion puts the frame at p = (x, y), turned by w; its body twist is R^T (u + w k x p), w
    return matrix([[c, s, s * x - c * y], [-s, c, c * x + s * y], [0.0, 0.0, 1.0]])
