"""Robots that others describe: read from example-robot-data where it is installed, else fetched by robot_descriptions.

Parameters are those of the files. What scripts rely on is checked: how many joints there are, and the gripper's link.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np

from roboticstoolbox._robots.from_model import from_model, read_model
from roboticstoolbox._robots.robot import Robot
from roboticstoolbox.models.URDF.URDFRobot import URDFRobot
from ulna.errors import InputError, ModelError

_UP = (math.pi, 0.0, 0.0, 0.0, math.pi / 2, 0.0)
_READY = (0.0, -0.3, 0.0, -2.2, 0.0, 2.0, math.pi / 4)
_FLANGE = ("tool0", "ee_link", "flange")


@final
@dataclass(frozen=True)
class Described:
    """A description by others, and what is added to it.

    Attributes:
        name: What the catalogue calls it.
        maker: Who makes the robot.
        grippers: Names of the first link of its gripper, of which the first that there is counts.
        configs: Named configurations.
        carriers: Links to put between others and all that comes after them, by name: the link before, and the tool's
            distance along z [m].
    """

    name: str
    maker: str
    grippers: tuple[str, ...] = ()
    configs: Mapping[str, Sequence[float]] = field(default_factory=dict)
    carriers: Mapping[str, tuple[str, float]] = field(default_factory=dict)


ROBOTS = {
    "UR3": Described("ur3", "Universal Robotics", _FLANGE, {"qr": _UP, "qz": (0.0,) * 6}),
    "UR5": Described(
        "example-robot-data:ur5", "Universal Robotics", _FLANGE,
        {
            "qr": _UP, "qz": (0.0,) * 6, "qn": (-0.7052413, 0.3604328, -1.494176, 1.133744, -0.7052413, 0.0),
            "q1": (0.0, -math.pi / 2, math.pi / 2, 0.0, math.pi / 2, 0.0),
        },
    ),
    "UR10": Described("ur10", "Universal Robotics", _FLANGE, {"qr": _UP, "qz": (0.0,) * 6}),
    "PR2": Described("pr2", "Willow Garage"),
    "Jaco": Described(
        "j2n6s200", "Kinova", ("j2n6s200_end_effector",),
        {"qr": (0.0, math.pi / 4, math.pi / 3, *(0.0,) * 7), "qz": (0.0,) * 10},
    ),
    "KinovaGen3": Described(
        "gen3", "Kinova", ("end_effector_link",),
        {"qr": tuple(map(math.radians, (0, 15, 180, 230, 0, 55, 90))), "qz": (0.0,) * 7},
    ),
    "Fetch": Described(
        "fetch", "Fetch", ("gripper_link",),
        {"qr": (0.0, 0.0, 0.05, 1.32, 1.4, -0.2, 1.72, 0.0, 1.66, 0.0), "qz": (0.0,) * 10},
    ),
    "YuMi": Described(
        "yumi", "ABB", (),
        {"qr": (*_READY, *_READY), "qz": (0.0,) * 14, "q1": (0.0, -0.4, *(0.0,) * 6, -0.4, *(0.0,) * 5)},
        {"r_gripper": ("gripper_r_base", 0.13), "l_gripper": ("gripper_l_base", 0.13)},
    ),
    "Valkyrie": Described("valkyrie", "NASA"),
}  # fmt: skip
"""By the toolbox's names."""


def is_here(name: str) -> bool:
    """Whether a robot can be read without fetching anything."""
    from ulna.errors import UlnaError
    from ulna.robots.catalogue import find

    try:
        return find(ROBOTS[name].name).source != "robot_descriptions"
    except UlnaError:
        return False


def described_class(name: str, module: str) -> type:
    """The class of a robot.

    Args:
        name: Key of `ROBOTS`.
        module: Name of the module that the class is in.

    Returns:
        The class.
    """
    description = ROBOTS[name]

    def init(self: Any, variant: str = "A") -> None:
        if variant != "A":
            raise InputError(f"`variant` is {variant!r}; there is one description of {name}, variant 'A'.")
        model, path = read_model(description.name)
        gripper = next((link for link in description.grippers if link in model.link_names), None)
        if description.grippers and gripper is None:
            raise _changed(name, description, f"no link {' or '.join(description.grippers)}")
        carriers = {gripper: before for gripper, (before, _) in description.carriers.items()}
        like = from_model(
            Robot,
            model,
            gripper,
            carriers=carriers,
            manufacturer=description.maker,
            urdf_filepath=path,
        )
        self._filled(like)
        for gripper, (_, along) in zip(self.grippers, description.carriers.values(), strict=False):
            tool = gripper.tool.A.copy()
            tool[2, 3] = along
            gripper.tool = tool
        for key, q in ({"qr": np.zeros(self.n), "qz": np.zeros(self.n)} | dict(description.configs)).items():
            if len(q) != self.n:
                raise _changed(name, description, f"{self.n} joints, not {len(q)}")
            self.addconfiguration_attr(key, q)

    about = f"The description {description.name!r}, of a robot by {description.maker}."
    return type(name, (URDFRobot,), {"__init__": init, "__doc__": about, "__module__": module})


def _changed(name: str, description: Described, what: str) -> ModelError:
    return ModelError(
        f"The description {description.name!r} has {what}, so it is not that of models.URDF.{name}; use "
        f"models.URDF.URDFRobot({description.name!r}) as it is."
    )
