"""What a robot carries and what drives it: a payload at a frame, motors behind gears."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError, ModelError
from ulna.model.builder import ModelBuilder
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
        InputError: the numbers are no inertia.
        ModelError: the link's name is taken.
    """
    spot = model.frame(model.tool if frame is None else frame)
    if name in model.frame_names:
        raise ModelError(
            f"{model.name!r} has a frame named {name!r} already; give the payload another `name`."
        )
    body = Inertia.from_com(mass, com, np.zeros((3, 3)) if inertia is None else inertia)
    load = ModelBuilder(name).add_link(name, body).build()
    return attach(model, load, spot.name, tool=model.tool)


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
        for name in ("inertia", "damping", "friction", "backward", "torque"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value >= 0.0):
                raise InputError(f"`{name}` of a drive is {value}; expected a finite number of zero or more.")
        if not np.isfinite(self.gear) or self.gear == 0.0:
            raise InputError(f"`gear` of a drive is {self.gear}; expected a finite number other than zero.")

    @property
    def both_ways(self) -> tuple[float, float]:
        """Tc of forward and of backward motion [N m]."""
        return self.friction, self.friction if self.backward is None else self.backward

    @property
    def at_joint(self) -> dict[str, float]:
        """Armature [kg m^2], damping [N m s/rad] and friction [N m] as they act at the joint."""
        square = self.gear**2
        return {
            "armature": self.inertia * square,
            "damping": self.damping * square,
            "friction": 0.5 * sum(self.both_ways) * abs(self.gear),
        }


def with_drives(model: Model, drives: Mapping[str, Drive]) -> Model:
    """The model with motors and gears.

    Args:
        model: The robot.
        drives: For names of joints with one velocity, what drives them.

    Returns:
        A new model.

    Raises:
        UnknownName: no movable joint of that name.
        InputError: a joint that has several velocities, or mimics another.
    """
    joints = list(model.joints)
    for name, drive in drives.items():
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
