"""Joints whose q holds a unit quaternion: the ball joint and the free flyer."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ulna.data_classes import dataclass
from ulna.model.joints.axes import EYE, ZERO
from ulna.model.joints.joint_kind import (
    Coordinate,
    JointKind,
    angle,
    length,
    quaternion,
    random_quaternion,
    unit_quaternion,
)
from ulna.numeric import apply, vector
from ulna.spatial import (
    SE3,
    Motion,
    quat_conjugate,
    quat_exp,
    quat_log,
    quat_multiply,
    quat_xyzw_to_matrix,
    se3_exp,
    se3_right_jacobian,
    se3_right_jacobian_inverse,
    so3_exp,
    so3_left_jacobian,
    so3_left_jacobian_inverse,
    so3_right_jacobian,
    so3_right_jacobian_inverse,
)
from ulna.typing import Array, Floats

_TURNS = (angle("x"), angle("y"), angle("z"))
_SLIDES = (length("x"), length("y"), length("z"))


@dataclass(frozen=True)
class Spherical(JointKind):
    """Turns freely about a point; q is a unit quaternion xyzw, v the angular velocity in the moving frame."""

    name: ClassVar[str] = "spherical"
    symbol: ClassVar[str] = "S"
    coordinates: ClassVar[tuple[Coordinate, ...]] = quaternion()
    rates: ClassVar[tuple[Coordinate, ...]] = _TURNS

    def describe(self) -> str:
        """A short label for tables."""
        return "spherical"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: the rotation of the quaternion."""
        return SE3(quat_xyzw_to_matrix(q), ZERO)

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The three angular unit motions."""
        return tuple(Motion(ZERO, EYE[i]) for i in range(3))

    def integrate(self, q: Array, v: Array) -> Array:
        """`q` times the exponential of `v`."""
        return quat_multiply(q, quat_exp(v))

    def difference(self, q0: Array, q1: Array) -> Array:
        """The rotation vector from `q0` to `q1`, no longer than pi; `q` and `-q` are the same place."""
        return quat_log(quat_multiply(quat_conjugate(q0), q1))

    def coordinate_rates(self, q: Array, v: Array) -> Array:
        """Half of `q` times the quaternion (v, 0)."""
        return _quaternion_rates(q, v)

    def integrate_derivatives(self, q: Array, v: Array) -> tuple[Array, Array]:
        """exp(v) transposed, and the right Jacobian of SO(3) at v."""
        return so3_exp(-v), so3_right_jacobian(v)

    def difference_derivatives(self, q0: Array, q1: Array) -> tuple[Array, Array]:
        """Minus the inverse left Jacobian, and the inverse right Jacobian, of SO(3) at the difference."""
        d = self.difference(q0, q1)
        return -so3_left_jacobian_inverse(d), so3_right_jacobian_inverse(d)

    def neutral(self) -> Floats:
        """The quaternion (0, 0, 0, 1)."""
        return np.array([0.0, 0.0, 0.0, 1.0])

    def normalize(self, q: Array) -> Array:
        """The quaternion scaled to unit length."""
        return unit_quaternion(q)

    def random(
        self,
        rng: np.random.Generator,
        lower: Array | None = None,
        upper: Array | None = None,
        size: tuple[int, ...] = (),
    ) -> Floats:
        """Unit quaternions drawn evenly over all rotations, shape (*size, 4); the limits play no part."""
        return random_quaternion(rng, size)


@dataclass(frozen=True)
class FreeFlyer(JointKind):
    """Moves freely in space; q is (x, y, z) [m] and a unit quaternion xyzw, v the twist in the moving frame.

    `integrate` is the exponential of SE(3): with a constant v the frame runs along a screw.
    """

    name: ClassVar[str] = "free flyer"
    symbol: ClassVar[str] = "F"
    coordinates: ClassVar[tuple[Coordinate, ...]] = _SLIDES + quaternion()
    rates: ClassVar[tuple[Coordinate, ...]] = (
        *(Coordinate(f"v{c.name}", c.unit) for c in _SLIDES),
        *(Coordinate(f"w{c.name}", c.unit) for c in _TURNS),
    )

    def describe(self) -> str:
        """A short label for tables."""
        return "free flyer"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving."""
        return SE3(quat_xyzw_to_matrix(q[..., 3:]), q[..., :3])

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The three linear and the three angular unit motions."""
        return (*(Motion(EYE[i], ZERO) for i in range(3)), *(Motion(ZERO, EYE[i]) for i in range(3)))

    def integrate(self, q: Array, v: Array) -> Array:
        """`q` followed by the exponential of the body twist `v`."""
        turn = v[..., 3:]
        step = apply(quat_xyzw_to_matrix(q[..., 3:]), apply(so3_left_jacobian(turn), v[..., :3]))
        return _join(q[..., :3] + step, quat_multiply(q[..., 3:], quat_exp(turn)))

    def difference(self, q0: Array, q1: Array) -> Array:
        """The logarithm of the motion from `q0` to `q1`, as a body twist."""
        back = quat_conjugate(q0[..., 3:])
        turn = quat_log(quat_multiply(back, q1[..., 3:]))
        step = apply(quat_xyzw_to_matrix(back), q1[..., :3] - q0[..., :3])
        return _join(apply(so3_left_jacobian_inverse(turn), step), turn)

    def coordinate_rates(self, q: Array, v: Array) -> Array:
        """The linear velocity in the fixed frame, and half of the quaternion times (w, 0)."""
        turned = apply(quat_xyzw_to_matrix(q[..., 3:]), v[..., :3])
        return _join(turned, _quaternion_rates(q[..., 3:], v[..., 3:]))

    def integrate_derivatives(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The adjoint of exp(-v), and the right Jacobian of SE(3) at v."""
        return se3_exp(-v).adjoint(), se3_right_jacobian(v)

    def difference_derivatives(self, q0: Array, q1: Array) -> tuple[Array, Array]:
        """Minus the inverse left Jacobian, and the inverse right Jacobian, of SE(3) at the difference."""
        d = self.difference(q0, q1)
        return -se3_right_jacobian_inverse(-d), se3_right_jacobian_inverse(d)

    def neutral(self) -> Floats:
        """At the origin, not turned."""
        return np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])

    def normalize(self, q: Array) -> Array:
        """The same place with the quaternion scaled to unit length."""
        return _join(q[..., :3], unit_quaternion(q[..., 3:]))

    def random(
        self,
        rng: np.random.Generator,
        lower: Array | None = None,
        upper: Array | None = None,
        size: tuple[int, ...] = (),
    ) -> Floats:
        """Places within the limits of x, y, z ([-1, 1] m without), turned evenly over all rotations."""
        place = super().random(rng, lower, upper, size)[..., :3]
        return np.concatenate([place, random_quaternion(rng, size)], axis=-1)


def _quaternion_rates(quat: Array, turn: Array) -> Array:
    """d/dt of a quaternion xyzw whose frame has the angular velocity `turn`, in its own axes: quat (turn, 0) / 2."""
    x, y, z = (0.5 * turn[..., i] for i in range(3))
    return quat_multiply(quat, vector(x, y, z, 0.0))


def _join(a: Array, b: Array) -> Array:
    """Two arrays side by side along the last axis, their batches broadcast."""
    batch = np.broadcast_shapes(a.shape[:-1], b.shape[:-1])
    parts = [np.broadcast_to(x, (*batch, x.shape[-1])) for x in (a, b)]
    return np.concatenate(parts, axis=-1)
