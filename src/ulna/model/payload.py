"""What a robot carries and what drives it: a payload at a frame, motors behind gears."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ulna.checks.arrays import real_array
from ulna.checks.values import number, short_repr
from ulna.data_classes import dataclass
from ulna.errors import InputError, ModelError
from ulna.model.builder import ModelBuilder
from ulna.model.check import checked_name
from ulna.model.merge import attach
from ulna.model.model import Model
from ulna.spatial import Inertia
from ulna.typing import ArrayLike


def with_payload(
    model: Model,
    frame: str | None = None,
    mass: float = 1.0,
    com: ArrayLike = (0.0, 0.0, 0.0),
    inertia: ArrayLike | None = None,
    *,
    name: str = "payload",
) -> Model:
    """The model carrying a body, as a further link fixed to one of its frames. The tool stays.

    Args:
        model: The model.
        frame: The frame it is fixed to; None for the tool.
        mass: Its mass [kg].
        com: Its centre of mass in the frame, shape (3,) [m].
        inertia: Its rotational inertia about the centre of mass along the frame's axes, shape (3, 3) or (6,): xx, xy,
            xz, yy, yz, zz [kg m^2]; None for a point mass.
        name: Name of the link.

    Returns:
        A new model.

    Raises:
        UnknownName: no frame of that name.
        InputError: mass, com and inertia are not those of a body.
        ShapeError, NonFiniteError: com or inertia has another shape, or holds nan.
        ModelError: the link's name is taken.
    """
    carrier = model.frame_name(model.frame(model.tool if frame is None else frame))
    checked_name("payload", name)
    if name in model.frame_names:
        raise ModelError(
            f"{model.name!r} has a frame named {name!r} already; give the payload another `name`."
        )
    mass = number("mass", mass, "a mass of zero or more [kg]", least=0.0)
    tensor = np.zeros((3, 3)) if inertia is None else real_array("inertia", inertia, "(3, 3) or (6,)")
    body = Inertia.from_com(mass, com, tensor)
    load = ModelBuilder(name).add_link(name, body).build()
    return attach(model, load, carrier, tool=model.tool)


@dataclass(frozen=True)
class Drive:
    """A motor behind a gear, in numbers of the motor, as data sheets and the Robotics Toolbox give them.

    Seen at the joint, its inertia is Jm G^2, its viscous friction B G^2, its Coulomb friction Tc |G|
    (Corke, Robotics, Vision and Control, 2023, section 9.1).

    Attributes:
        inertia: Jm, of the rotor [kg m^2].
        damping: B, viscous friction at the motor [N m s/rad].
        friction: Tc, Coulomb friction at the motor [N m], of forward motion of the joint if `backward` is given.
        backward: Tc of backward motion, as a number that is not negative; None for the same. A model keeps the mean;
            `ulna.algorithms.Friction.of_drives` keeps both.
        gear: G, turns of the motor per turn of the joint [1], or per metre of it [rad/m]; of either sign.
        torque: Greatest torque of the motor [N m]; None leaves the joint's limit.
    """

    inertia: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    backward: float | None = None
    gear: float = 1.0
    torque: float | None = None

    def __post_init__(self) -> None:
        for name in ("inertia", "damping", "friction"):
            self._check(name, "a finite number of zero or more")
        for name in ("backward", "torque"):
            if getattr(self, name) is not None:
                self._check(name, "a finite number of zero or more, or None")
        gear = number("gear", self.gear, "a finite number other than zero")
        if gear == 0.0:
            raise InputError("`gear` of a drive is 0; expected a finite number other than zero.")
        try:
            finite = all(map(math.isfinite, self.at_joint.values()))
        except OverflowError:
            finite = False
        if not finite:
            raise InputError(
                f"`gear` of a drive is {gear:g}: the inertia, damping or friction at the joint is no finite number. "
                "It is the number of turns of the motor per turn of the joint."
            )

    def _check(self, name: str, expected: str) -> None:
        number(name, getattr(self, name), expected, least=0.0)

    @property
    def both_ways(self) -> tuple[float, float]:
        """Tc of forward and of backward motion [N m]."""
        return self.friction, self.friction if self.backward is None else self.backward

    @property
    def at_joint(self) -> dict[str, float]:
        """Armature [kg m^2, kg], damping [N m s/rad, N s/m] and friction [N m, N] as they act at the joint."""
        square = self.gear**2
        return {
            "armature": self.inertia * square,
            "damping": self.damping * square,
            "friction": 0.5 * sum(self.both_ways) * abs(self.gear),
        }


def with_drives(model: Model, drives: Mapping[str, Drive]) -> Model:
    """The model with motors and gears: their armature, damping and friction replace those of the joints.

    Args:
        model: The robot.
        drives: The drives by name of the joint; each joint has one velocity.

    Returns:
        A new model.

    Raises:
        UnknownName: no movable joint of that name.
        InputError: a joint that has several velocities, or mimics another; or something else than drives by name.
    """
    if not isinstance(drives, Mapping):
        raise InputError(
            f"`drives` is {short_repr(drives)}; expected drives by name of the joint, as a dictionary."
        )
    joints = list(model.joints)
    for name, drive in drives.items():
        if not isinstance(drive, Drive):
            raise InputError(f"The drive of joint {name!r} is {short_repr(drive)}; expected a Drive.")
        k = model.joint_index(name)
        joint = joints[k]
        if joint.nv != 1:
            why = "mimics another" if joint.mimic is not None else f"has {joint.nv} velocities"
            raise InputError(f"Joint {name!r} {why}; a drive moves a joint with one independent velocity.")
        changes: dict[str, Any] = {key: (value,) for key, value in drive.at_joint.items()}
        if drive.torque is not None:
            changes["limits"] = replace(joint.limits, effort=(drive.torque * abs(drive.gear),))
        joints[k] = replace(joint, **changes)
    return replace(model, joints=tuple(joints))
