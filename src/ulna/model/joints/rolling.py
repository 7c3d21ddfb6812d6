"""A joint whose moving cylinder rolls on a fixed one without slip: knees, fingers and planet gears.

| symbol | meaning | unit | equation |
|---|---|---|---|
| q | angle by which the moving frame turns about y | [rad] | |
| r, s | radii of the fixed and of the moving cylinder, whose axes are y | [m] | |
| a, b | angles of the line of centres against the fixed and the moving frame | [rad] | q = a + b, r a = s b |
| T | pose of the moving frame in the fixed frame | [m, 1] | T = Ry(a) Tz(r + s) Ry(b) |

Equal lengths of arc roll off on both cylinders, r a = s b; hence a = q s / (r + s) and b = q r / (r + s).

Source: Hillberry & Hall, Rolling contact joint, US patent 3932045 (1976), for equal radii.
"""

from __future__ import annotations

import math
from typing import ClassVar

from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.model.joints.joint_kind import Coordinate, angle
from ulna.model.joints.turn_chain import Turn, TurnChain
from ulna.model.joints.turning import Revolute

_Y = Revolute((0.0, 1.0, 0.0))


@dataclass(frozen=True)
class Rolling(TurnChain):
    """A cylinder that rolls on another one without slip; q is the angle by which it turns [rad].

    Both axes are y of their frames, which lie on them. At q = 0 the moving frame is above the fixed one along z.

    Args:
        radius_fixed: Radius of the fixed cylinder [m]; negative for a hollow one, inside which the other one rolls.
        radius_moving: Radius of the moving cylinder [m]; negative for a hollow one. The sum of both is not zero.

    Example:
        >>> from ulna.model import Rolling
        >>> builder = ulna.ModelBuilder("finger").add_link("palm").add_link("phalanx")
        >>> finger = builder.add_joint("knuckle", Rolling(0.01, 0.01), "palm", "phalanx").build()
        >>> T = ulna.Robot(finger).fk([np.pi / 2])
        >>> T[:3, 2].round(3) + 0.0, T[:3, 3].round(4) + 0.0
        (array([1., 0., 0.]), array([0.0141, 0.    , 0.0141]))
    """

    radius_fixed: float
    radius_moving: float
    name: ClassVar[str] = "rolling"
    symbol: ClassVar[str] = "O"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (angle(),)

    def __post_init__(self) -> None:
        for name in ("radius_fixed", "radius_moving"):
            value = float(getattr(self, name))
            if not math.isfinite(value):
                raise InputError(f"Rolling: `{name}` is {value}; expected a finite number [m].")
            object.__setattr__(self, name, value)
        if self.radius_fixed + self.radius_moving == 0.0:
            raise InputError(
                f"Rolling: `radius_fixed` {self.radius_fixed:g} and `radius_moving` {self.radius_moving:g} add up to "
                "zero; expected centres that are apart. Where one cylinder fits into the other use Revolute."
            )

    @property
    def distance(self) -> float:
        """From the fixed axis to the moving one [m]."""
        return self.radius_fixed + self.radius_moving

    def describe(self) -> str:
        """A short label for tables."""
        return f"rolling {self.radius_moving:g} m on {self.radius_fixed:g} m"

    @property
    def turns(self) -> tuple[Turn, ...]:
        """The line of centres turns about the fixed axis, the body about its own."""
        d = self.distance
        return Turn(0.0, _Y, 0, self.radius_moving / d), Turn(d, _Y, 0, self.radius_fixed / d)
