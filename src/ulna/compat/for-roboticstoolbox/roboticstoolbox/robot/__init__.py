"""Robots, links and solvers where scripts import them from: roboticstoolbox.robot and its modules, one for a class."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.module_aliases import add_module_aliases, public_name

_MODULES = (
    "BaseRobot", "DHLink", "DHRobot", "ELink", "ERobot", "ET", "ETS", "Gripper", "IK", "Link", "PoERobot", "Robot",
)  # fmt: skip
_NAMES = (
    "ET", "ET2", "ETS", "ETS2", "BaseRobot", "DHLink", "DHRobot", "ELink", "ELink2", "ERobot", "ERobot2", "Gripper",
    "IKSolution", "IKSolver", "IK_GN", "IK_LM", "IK_NR", "IK_QP", "Link", "Link2", "PoELink", "PoEPrismatic",
    "PoERevolute", "PoERobot", "PrismaticDH", "PrismaticMDH", "RevoluteDH", "RevoluteMDH", "Robot", "Robot2",
    "SerialLink",
)  # fmt: skip
__all__ = list(_NAMES)
add_module_aliases(__name__, _MODULES)


def __getattr__(name: str) -> Any:
    return public_name(__name__, name)
