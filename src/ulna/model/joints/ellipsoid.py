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

from collections.abc import Iterator
from typing import ClassVar

from ulna.checks.values import number
from ulna.data_classes import dataclass
from ulna.model.joints.axes import rotation_about
from ulna.model.joints.joint_kind import Coordinate, angle
from ulna.model.joints.turn_chain import Turn, TurnChain
from ulna.model.joints.turning import Revolute
from ulna.numeric import vector
from ulna.spatial import SE3
from ulna.typing import Array

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Ellipsoid(TurnChain):
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
            object.__setattr__(self, name, number(name, getattr(self, name), "a finite number [m]"))

    @property
    def radii(self) -> tuple[float, float, float]:
        """The three radii [m]."""
        return self.radius_x, self.radius_y, self.radius_z

    def describe(self) -> str:
        """A short label for tables."""
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
