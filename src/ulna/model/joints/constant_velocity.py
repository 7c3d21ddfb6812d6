"""A joint that bends a shaft in any direction and passes its rotation on evenly: a double universal joint.

| symbol | meaning | unit | equation |
|---|---|---|---|
| q1, q2 | angles by which the shaft bends about x and y | [rad] | |
| d | distance of the centres of the two universal joints | [m] | |
| T | pose of the moving frame in the fixed frame | [m, 1] | T = Rx(q1/2) Ry(q2/2) Tz(d) Ry(q2/2) Rx(q1/2) |

Each universal joint bends by half of the angles, in opposite order of the axes: the two halves are mirror images. The
unit quaternion of the rotation is

    (x, y, z, w) = (sin(q1/2) cos(q2/2), sin(q2/2), 0, cos(q1/2) cos(q2/2))

Since z = 0, the moving shaft turns about its axis exactly as fast as the fixed one, at every bend. Wrists and necks of
humanoids, segments of continuum robots and drive shafts are such joints.

Source: Hunt, Constant-velocity shaft couplings: a general theory, Journal of Engineering for Industry 95 (1973).
"""

from __future__ import annotations

from typing import ClassVar

from ulna.checks.values import number
from ulna.data_classes import dataclass
from ulna.model.joints.joint_kind import Coordinate, angle
from ulna.model.joints.turn_chain import Turn, TurnChain
from ulna.model.joints.turning import Revolute

_X, _Y = Revolute((1.0, 0.0, 0.0)), Revolute((0.0, 1.0, 0.0))


@dataclass(frozen=True)
class ConstantVelocity(TurnChain):
    """Bends the z axis about x and y without twist; q is both angles [rad].

    Args:
        distance: Between the centres of the two universal joints that it consists of, along z [m]. The moving frame is
            at the second centre.

    Example:
        >>> from ulna.model import ConstantVelocity
        >>> builder = ulna.ModelBuilder("neck").add_link("trunk").add_link("head")
        >>> neck = builder.add_joint("neck", ConstantVelocity(0.04), "trunk", "head").build()
        >>> T = ulna.Robot(neck).fk([np.pi / 2, 0.0])
        >>> T[:3, 2].round(3) + 0.0, T[:3, 3].round(3) + 0.0
        (array([ 0., -1.,  0.]), array([ 0.   , -0.028,  0.028]))
    """

    distance: float = 0.0
    name: ClassVar[str] = "constant velocity"
    symbol: ClassVar[str] = "K"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (angle("x"), angle("y"))

    def __post_init__(self) -> None:
        object.__setattr__(self, "distance", number("distance", self.distance, "a finite number [m]"))

    def describe(self) -> str:
        """A short label for tables."""
        return f"constant velocity, {self.distance:g} m" if self.distance else "constant velocity"

    @property
    def turns(self) -> tuple[Turn, ...]:
        """Half of the angles on each side of the middle; without a distance the two turns there are one."""
        first, last = Turn(0.0, _X, 0, 0.5), Turn(0.0, _X, 0, 0.5)
        if self.distance == 0.0:
            return first, Turn(0.0, _Y, 1, 1.0), last
        return first, Turn(0.0, _Y, 1, 0.5), Turn(self.distance, _Y, 1, 0.5), last
