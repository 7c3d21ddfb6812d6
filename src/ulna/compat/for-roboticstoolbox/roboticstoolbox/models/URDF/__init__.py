"""Robots described by frames of their links, as in URDF files."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.module_aliases import add_module_aliases
from roboticstoolbox._robots.from_model import from_model
from roboticstoolbox._robots.robot import Robot
from roboticstoolbox.models._from_tables import table, tree_class
from roboticstoolbox.models.URDF._external_descriptions import ROBOTS, described_class
from roboticstoolbox.models.URDF.URDFRobot import URDFRobot
from ulna.robots.panda import panda

_FINGER_SPEEDS = (3.0, 3.0)  # [m/s], which the toolbox appends to `qdlim` of the Panda


class Panda(URDFRobot):
    """The Franka Emika Panda with its hand, and with the masses that Gaz and others identified in 2019."""

    def __init__(self) -> None:
        model = panda(fingers=True)
        tool = model.link("panda_hand_tcp").origin.matrix()
        like = from_model(Robot, model, "panda_hand", tool, ("panda_hand_tcp",), manufacturer="Franka Emika")
        like.name = "panda"
        self._filled(like)
        self.qdlim = np.append(self.qdlim, _FINGER_SPEEDS)
        for name in ("qr", "qz"):
            self.addconfiguration_attr(name, model.configurations[name][:7])


class Frankie(Panda):
    """The arm of Frankie: a Panda; its base that drives is in `FrankieOmni`."""


_TABULATED = [name for name in table("urdf") if name != "Panda"]

__all__ = list(dict.fromkeys(["Panda", "Frankie", "URDFRobot", *_TABULATED, *ROBOTS]))

_SHAPES: dict[str, tuple[str, ...]] = {
    "LBR": ("kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.xacro",),
    "Puma560": ("unimation_puma560_description/urdf/puma560_robot.urdf.xacro",),
    "AL5D": ("lynxmotion_al5d_description/urdf/al5d_robot.urdf",),
    "FrankieOmni": (
        "clearpath_ridgeback_description/urdf/ridgeback.urdf.xacro",
        "qut_frankie_description/robots/panda_arm_hand.urdf.xacro",
    ),
    **{
        name: (f"trossen_descriptions/urdf/{name}.urdf.xacro",)
        for name in ("px100", "px150", "rx150", "rx200", "vx300", "vx300s", "wx200", "wx250", "wx250s")
    },
}
"""Descriptions in the package `rtb-data` with the shapes of robots."""
_PACKAGES = {"LBR": {"kuka_lbr_iiwa_support": "kuka_description/kuka_lbr_iiwa"}}
"""Folders of ROS packages that lie under other names there."""

for _each in _TABULATED:
    globals()[_each] = tree_class(
        "urdf", _each, URDFRobot, __name__, _SHAPES.get(_each, ()), _PACKAGES.get(_each, {})
    )

for _each in ROBOTS:
    globals()[_each] = described_class(_each, __name__)

add_module_aliases(__name__, (name for name in __all__ if name != "URDFRobot"))


def __getattr__(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    raise AttributeError(f"There is no models.URDF.{name}; there are {', '.join(__all__)}.")
