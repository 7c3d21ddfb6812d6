"""A joint whose moving frame rolls over an ellipsoid: three angles, and a place on the surface.

| symbol | meaning | unit | equation |
|---|---|---|---|
| q1, q2, q3 | angles about x, then the y so turned, then the z so turned | [rad] | R = Rx(q1) Ry(q2) Rz(q3) |
| a, b, c | radii of the ellipsoid along x, y and z of the fixed frame | [m] | |
| p | place of the moving frame in the fixed frame | [m] | p = (a, b, c) * R e_z, entry by entry |

The moving frame's z axis is (sin q2, -sin q1 cos q2, cos q1 cos q2), so that p lies on the ellipsoid; for a sphere
it is the normal. With s = q1 + q2, d = q1 - q2 and u(x) = Rx(x) e_z, p is a sum of turned constant vectors:

    p = c R e_z + (a - c) sin(q2) e_x + (b - c)/4 (u(s) + u(d) - u(-s) - u(-d))

Likewise (a - c) sin(q2) e_x = Ry(q2) h - Ry(-q2) h with h = (a - c)/2 e_z. Hence the joint is a chain of turns, each by
a whole multiple of one of the angles, with constant slides between them (`turns`): every motion subspace is constant
in its own frame, as algorithms want it.

Source: Seth, Sherman, Eastman & Delp, Minimal formulation of joint motion for biomechanisms, Nonlinear Dynamics (2010).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import ClassVar, NamedTuple

from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.model.joints.axes import ZERO, rotation_about, unit
from ulna.model.joints.base import Coordinate, ElementaryJoint, VectorKind, angle
from ulna.model.joints.turning import Revolute
from ulna.numeric import vector
from ulna.spatial import SE3, Motion
from ulna.spatial.batched import column
from ulna.typing import Array

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


class Turn(NamedTuple):
    """A turn of the chain: by a multiple of one of the joint's angles, after a slide along z."""

    slide: float
    """How far its fixed frame lies along the z axis of the frame before [m]."""
    kind: Revolute
    """The axis."""
    coordinate: int
    """Which of the joint's angles turns it."""
    ratio: float
    """By how many times that angle it turns."""


@dataclass(frozen=True)
class Ellipsoid(VectorKind):
    """Rolls and spins on an ellipsoid; q is three angles, x then y then z [rad].

    Args:
        radius_x: Radius along x of the fixed frame [m].
        radius_y: Radius along y [m].
        radius_z: Radius along z [m].
    """

    radius_x: float = 0.0
    radius_y: float = 0.0
    radius_z: float = 0.0
    name: ClassVar[str] = "ellipsoid"
    symbol: ClassVar[str] = "E"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (angle("x"), angle("y"), angle("z"))

    def __post_init__(self) -> None:
        for name in ("radius_x", "radius_y", "radius_z"):
            value = float(getattr(self, name))
            if not math.isfinite(value):
                raise InputError(f"Ellipsoid: `{name}` is {value}; expected a finite number [m].")
            object.__setattr__(self, name, value)

    @property
    def radii(self) -> tuple[float, float, float]:
        """The three radii [m]."""
        return self.radius_x, self.radius_y, self.radius_z

    def describe(self) -> str:
        """A few words for tables."""
        return "ellipsoid {:g} x {:g} x {:g} m".format(*self.radii)

    @property
    def turns(self) -> tuple[Turn, ...]:
        """The chain of turns between slides along z whose end is the moving frame."""
        return tuple(_chain(*self.radii))

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: R = Rx Ry Rz, and the radii times its third column."""
        x, y, z = (rotation_about(axis, q[..., k]) for k, axis in enumerate((_X, _Y, _Z)))
        R = x @ y @ z
        return SE3(R, vector(*(radius * R[..., k, 2] for k, radius in enumerate(self.radii))))

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The sums of the turns' columns by angle, in the moving frame."""
        columns = [Motion.zero()] * 3
        for turn, T in zip(self.turns, self._poses(q), strict=True):
            columns = [T.act_inverse(c) for c in columns]
            columns[turn.coordinate] = columns[turn.coordinate] + _column(turn)
        return tuple(columns)

    def bias(self, q: Array, v: Array) -> Motion:
        """(dS/dt) v, by the recursion a' = X a + V x (S v) along the turns (Featherstone, eq. 5.8)."""
        velocity, total = Motion.zero(), Motion.zero()
        for turn, T in zip(self.turns, self._poses(q), strict=True):
            rate, s = column(v[..., turn.coordinate]), _column(turn)
            twist = Motion(rate * s.linear, rate * s.angular)
            velocity = T.act_inverse(velocity) + twist
            total = T.act_inverse(total) + velocity.cross(twist)
        return total

    def elementary_joints(self, placement: SE3) -> tuple[ElementaryJoint, ...]:
        """The turns."""
        parts = []
        for turn in self.turns:
            place, placement = placement @ SE3.trans(0.0, 0.0, turn.slide), SE3.identity()
            parts.append(ElementaryJoint(place, turn.kind, turn.coordinate, turn.coordinate, turn.ratio))
        return tuple(parts)

    def _poses(self, q: Array) -> Iterator[SE3]:
        """The pose of the moving frame of each turn in that of the turn before."""
        for turn in self.turns:
            R = rotation_about(turn.kind.axis, turn.ratio * q[..., turn.coordinate])
            yield SE3(R, vector(0.0, 0.0, turn.slide))


def _column(turn: Turn) -> Motion:
    return Motion(ZERO, turn.ratio * unit(turn.kind.axis))


def _chain(a: float, b: float, c: float) -> Iterator[Turn]:
    """The turns for three radii; those that a sphere or a spheroid does not need are left out."""
    x, y = Revolute(_X), Revolute(_Y)
    if a != c:
        half = 0.5 * (a - c)
        yield from (Turn(0.0, y, 1, 1.0), Turn(half, y, 1, -2.0), Turn(-half, y, 1, 1.0))
    if b == c:
        yield Turn(0.0, x, 0, 1.0)
    else:
        k = 0.25 * (b - c)
        yield from (Turn(0.0, x, 0, 1.0), Turn(0.0, x, 1, 1.0))  # s
        yield from (Turn(k, x, 1, -2.0), Turn(k, x, 0, -2.0), Turn(-k, x, 1, 2.0))  # d, -s, -d
        yield from (Turn(-k, x, 0, 2.0), Turn(0.0, x, 1, -1.0))  # q1
    yield Turn(0.0, y, 1, 1.0)
    yield Turn(c, Revolute(_Z), 2, 1.0)
