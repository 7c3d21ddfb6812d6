"""Robots described by frames of their links, as in URDF files."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._load import from_model, read
from roboticstoolbox._robot import Robot
from roboticstoolbox.models._made import table, tree_class
from ulna.robots.panda import panda


class URDFRobot(Robot):
    """A robot read from a URDF or xacro file, or by a name that Ulna knows."""

    def __init__(self, file_path: Any, manufacturer: str = "", **options: Any) -> None:
        """`file_path` is a path or a name such as "ur5"; `gripper_link_name` is the first link of its gripper."""
        gripper = options.pop("gripper_link_name", None)
        model, path = read(file_path)
        self._filled(from_model(Robot, model, gripper, manufacturer=manufacturer, urdf_filepath=path))

    def _filled(self, like: Robot) -> None:
        self.__dict__.update(like.__dict__)
        for link in self.link_dict.values():
            link.robot = self


class Panda(URDFRobot):
    """The Franka Emika Panda with its hand, and with the masses that Gaz and others identified in 2019."""

    def __init__(self) -> None:
        model = panda(fingers=True)
        tool = model.link("panda_hand_tcp").origin.matrix()
        like = from_model(Robot, model, "panda_hand", tool, ("panda_hand_tcp",), manufacturer="Franka Emika")
        like.name = "panda"
        self._filled(like)
        for name in ("qr", "qz"):
            self.addconfiguration_attr(name, model.configurations[name][:7])


_DESCRIBED = {
    "UR3": "ur3", "UR5": "ur5", "UR10": "ur10", "Fetch": "fetch", "KinovaGen3": "kinova", "Valkyrie": "valkyrie",
    "PR2": "pr2", "YuMi": "yumi", "Jaco": "j2n6s200", "Frankie": "panda",
}  # fmt: skip
_OWN = [name for name in table("urdf") if name != "Panda"]

__all__ = list(dict.fromkeys(["Panda", "URDFRobot", *_OWN]))

for _each in _OWN:
    globals()[_each] = tree_class("urdf", _each, URDFRobot, __name__)


def __getattr__(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    if name in _DESCRIBED:
        raise AttributeError(
            f"models.URDF.{name} is downloaded by the toolbox and not offered here; "
            f"use models.URDF.URDFRobot({_DESCRIBED[name]!r}), or the path of a URDF file."
        )
    raise AttributeError(f"There is no models.URDF.{name}; there are {', '.join(__all__)}.")
