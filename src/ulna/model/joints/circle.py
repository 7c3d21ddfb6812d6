"""Joints whose angle is written as cosine and sine: a turn without end, and a motion in the plane with one.

| symbol | meaning | shape | unit |
|---|---|---|---|
| (c, s) | cosine and sine of the angle | (2) | [1], c^2 + s^2 = 1 |
| v | rate of the angle | () | [rad/s] |

The angle has no cut in these coordinates, at the price of one number more. Source: Sola, Deray and Atchuthan, A micro
Lie theory (2018), examples 1 (S^1) and 6 (SE(2)).
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ulna.data_classes import dataclass
from ulna.model.joints.axes import ZERO, Axis, axis_name, rotation_of, unit, unit_axis
from ulna.model.joints.joint_kind import Coordinate, JointKind, angle, identity, length
from ulna.model.joints.planar import Planar
from ulna.numeric import arctan2, sincos, sqrt, vector
from ulna.spatial import SE3, Motion
from ulna.typing import Array, Floats

_PAIR = (Coordinate("cos", ""), Coordinate("sin", ""))


@dataclass(frozen=True)
class Circle(JointKind):
    """Turns about an axis without end; q is (cosine, sine) of the angle.

    Args:
        axis: Axis in the fixed frame; scaled to length 1.
    """

    axis: Axis = (0.0, 0.0, 1.0)
    name: ClassVar[str] = "circle"
    symbol: ClassVar[str] = "R"
    coordinates: ClassVar[tuple[Coordinate, ...]] = _PAIR
    rates: ClassVar[tuple[Coordinate, ...]] = (angle(),)

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", unit_axis(self.axis))

    def describe(self) -> str:
        """A short label for tables."""
        return f"continuous {axis_name(self.axis)} (cos, sin)"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: the rotation about the axis."""
        return SE3(rotation_of(self.axis, q[..., 1], q[..., 0]), ZERO)

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """(0; axis)."""
        return (Motion(ZERO, unit(self.axis)),)

    def integrate(self, q: Array, v: Array) -> Array:
        """`q` turned on by `v`."""
        s, c = sincos(v[..., 0])
        x, y = q[..., 0], q[..., 1]
        return vector(c * x - s * y, s * x + c * y)

    def difference(self, q0: Array, q1: Array) -> Array:
        """The shorter way round, in (-pi, pi]."""
        return vector(_angle_between(q0, q1))

    def coordinate_rates(self, q: Array, v: Array) -> Array:
        """(-sine, cosine) times `v`."""
        return vector(-q[..., 1] * v[..., 0], q[..., 0] * v[..., 0])

    def integrate_derivatives(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The identity, twice."""
        one = identity(1, q, v)
        return one, one

    def difference_derivatives(self, q0: Array, q1: Array) -> tuple[Array, Array]:
        """Minus the identity, and the identity."""
        one = identity(1, q0, q1)
        return -one, one

    def neutral(self) -> Floats:
        """(1, 0)."""
        return np.array([1.0, 0.0])

    def normalize(self, q: Array) -> Array:
        """The same angle with (cosine, sine) of length 1."""
        r = sqrt(q[..., 0] * q[..., 0] + q[..., 1] * q[..., 1])
        return vector(q[..., 0] / r, q[..., 1] / r)

    def random(
        self,
        rng: np.random.Generator,
        lower: Array | None = None,
        upper: Array | None = None,
        size: tuple[int, ...] = (),
    ) -> Floats:
        """Angles drawn evenly from the whole circle; limits of cosine and sine play no part."""
        turn = rng.uniform(-np.pi, np.pi, size)
        return np.stack([np.cos(turn), np.sin(turn)], axis=-1)


@dataclass(frozen=True)
class PlanarCircle(JointKind):
    """Slides and turns in a plane; q is (x, y, cosine, sine) [m, m, 1, 1], v is (vx, vy, w) in the moving frame.

    Args:
        normal: Normal of the plane in the fixed frame; the plane's axes are those of `Planar`.
    """

    normal: Axis = (0.0, 0.0, 1.0)
    name: ClassVar[str] = "planar circle"
    symbol: ClassVar[str] = "E"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (length("x"), length("y"), *_PAIR)
    rates: ClassVar[tuple[Coordinate, ...]] = Planar.rates

    def __post_init__(self) -> None:
        object.__setattr__(self, "normal", unit_axis(self.normal))

    @property
    def _planar(self) -> Planar:
        return Planar(self.normal)

    def describe(self) -> str:
        """A short label for tables."""
        return f"{self._planar.describe()} (cos, sin)"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: a translation in the plane, then a rotation about the normal."""
        first, second = self._planar.axes
        place = vector(*(first[i] * q[..., 0] + second[i] * q[..., 1] for i in range(3)))
        return SE3(rotation_of(self.normal, q[..., 3], q[..., 2]), place)

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The two linear unit motions in the plane and the rotation about its normal."""
        return self._planar.motion_subspace(q)

    def integrate(self, q: Array, v: Array) -> Array:
        """`q` followed by the exponential of the body twist `v`: an arc of a circle."""
        step = self._planar.integrate(vector(0.0, 0.0, 0.0), v)  # from the origin, where it needs no angle
        s, c = sincos(v[..., 2])
        a, b = q[..., 2], q[..., 3]
        x, y = step[..., 0], step[..., 1]
        return vector(q[..., 0] + a * x - b * y, q[..., 1] + b * x + a * y, c * a - s * b, s * a + c * b)

    def difference(self, q0: Array, q1: Array) -> Array:
        """The logarithm of the motion from `q0` to `q1`; turns the shorter way."""
        return self._planar.difference(vector(0.0, 0.0, 0.0), self._relative_to(q0, q1))

    def coordinate_rates(self, q: Array, v: Array) -> Array:
        """The linear velocity in the plane's axes, and (-sine, cosine) times the angle's rate."""
        c, s, x, y, w = q[..., 2], q[..., 3], v[..., 0], v[..., 1], v[..., 2]
        return vector(c * x - s * y, s * x + c * y, -s * w, c * w)

    def integrate_derivatives(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Those of `Planar`: they depend on `v` alone."""
        return self._planar.integrate_derivatives(q, v)

    def difference_derivatives(self, q0: Array, q1: Array) -> tuple[Array, Array]:
        """Those of `Planar`: they depend on the difference alone."""
        return self._planar.difference_derivatives(vector(0.0, 0.0, 0.0), self._relative_to(q0, q1))

    def neutral(self) -> Floats:
        """(0, 0, 1, 0)."""
        return np.array([0.0, 0.0, 1.0, 0.0])

    def normalize(self, q: Array) -> Array:
        """The same place with (cosine, sine) of length 1."""
        r = sqrt(q[..., 2] * q[..., 2] + q[..., 3] * q[..., 3])
        return vector(q[..., 0], q[..., 1], q[..., 2] / r, q[..., 3] / r)

    def random(
        self,
        rng: np.random.Generator,
        lower: Array | None = None,
        upper: Array | None = None,
        size: tuple[int, ...] = (),
    ) -> Floats:
        """Places within the limits of x and y ([-1, 1] m without), angles from the whole circle."""
        place = super().random(rng, lower, upper, size)[..., :2]
        turn = rng.uniform(-np.pi, np.pi, size)
        return np.concatenate([place, np.stack([np.cos(turn), np.sin(turn)], axis=-1)], axis=-1)

    def _relative_to(self, q0: Array, q1: Array) -> Array:
        """(x, y, angle) of `q1` as seen from `q0`."""
        dx, dy = q1[..., 0] - q0[..., 0], q1[..., 1] - q0[..., 1]
        c, s = q0[..., 2], q0[..., 3]
        return vector(c * dx + s * dy, c * dy - s * dx, _angle_between(q0[..., 2:], q1[..., 2:]))


def _angle_between(a: Array, b: Array) -> Array:
    """The angle from the direction a to the direction b, in (-pi, pi]."""
    return arctan2(
        a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]
    )
