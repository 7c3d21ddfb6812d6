"""The Robotics Toolbox's names for robot arms, over Ulna: `import roboticstoolbox as rtb`."""

from __future__ import annotations

import importlib
from typing import Any

from roboticstoolbox._common.former_modules import register_former_modules
from roboticstoolbox._ets.elementary_transform import ET as ET
from roboticstoolbox._ets.elementary_transform import ET2 as ET2
from roboticstoolbox._ets.ets import ETS as ETS
from roboticstoolbox._ets.ets import ETS2 as ETS2
from roboticstoolbox._ets.inverse_kinematics import IKSolution as IKSolution
from roboticstoolbox._ik.solvers import IK_GN as IK_GN
from roboticstoolbox._ik.solvers import IK_LM as IK_LM
from roboticstoolbox._ik.solvers import IK_NR as IK_NR
from roboticstoolbox._ik.solvers import IK_QP as IK_QP
from roboticstoolbox._ik.solvers import IKSolver as IKSolver
from roboticstoolbox._links.gripper import Gripper as Gripper
from roboticstoolbox._links.link import ELink as ELink
from roboticstoolbox._links.link import ELink2 as ELink2
from roboticstoolbox._links.link import Link as Link
from roboticstoolbox._links.link import Link2 as Link2
from roboticstoolbox._robots.dh_links import DHLink as DHLink
from roboticstoolbox._robots.dh_links import PrismaticDH as PrismaticDH
from roboticstoolbox._robots.dh_links import PrismaticMDH as PrismaticMDH
from roboticstoolbox._robots.dh_links import RevoluteDH as RevoluteDH
from roboticstoolbox._robots.dh_links import RevoluteMDH as RevoluteMDH
from roboticstoolbox._robots.dh_robot import DHRobot as DHRobot
from roboticstoolbox._robots.dh_robot import SerialLink as SerialLink
from roboticstoolbox._robots.planar_robot import ERobot2 as ERobot2
from roboticstoolbox._robots.planar_robot import Robot2 as Robot2
from roboticstoolbox._robots.poe_robot import PoELink as PoELink
from roboticstoolbox._robots.poe_robot import PoEPrismatic as PoEPrismatic
from roboticstoolbox._robots.poe_robot import PoERevolute as PoERevolute
from roboticstoolbox._robots.poe_robot import PoERobot as PoERobot
from roboticstoolbox._robots.robot import BaseRobot as BaseRobot
from roboticstoolbox._robots.robot import ERobot as ERobot
from roboticstoolbox._robots.robot import Robot as Robot

_CLASSES = (
    "ET", "ET2", "ETS", "ETS2", "Link", "Link2", "ELink", "ELink2", "Gripper", "BaseRobot", "Robot", "ERobot",
    "Robot2", "ERobot2", "IKSolution", "IKSolver", "IK_LM", "IK_NR", "IK_GN", "IK_QP", "DHLink", "DHRobot",
    "SerialLink", "RevoluteDH", "PrismaticDH", "RevoluteMDH", "PrismaticMDH", "PoELink", "PoERevolute",
    "PoEPrismatic", "PoERobot",
)  # fmt: skip
_MODULE_NAMES = {
    "roboticstoolbox.tools.trajectory": (
        "Trajectory", "jtraj", "ctraj", "mtraj", "mstraj", "quintic", "quintic_func", "trapezoidal",
        "trapezoidal_func", "lspb", "xplot",
    ),
    "roboticstoolbox.tools.servo": ("p_servo", "angle_axis", "angle_axis_python"),
    "roboticstoolbox.tools.chains": ("TrChainToken", "trchain", "trchain2"),
    "roboticstoolbox.tools.data": (
        "rtb_get_param", "rtb_load_data", "rtb_load_jsonfile", "rtb_load_matfile", "rtb_path_to_datafile",
        "rtb_set_param",
    ),
    "roboticstoolbox.tools.helpers": ("null", "jsingu", "jacobian_numerical", "hessian_numerical", "Ticker"),
}  # fmt: skip
_MODULE_OF = {name: module for module, names in _MODULE_NAMES.items() for name in names}
_MODULES = ("backends", "ets", "models", "robot", "tools")
_MOBILE = {
    "Bicycle", "BinaryOccupancyGrid", "Bug2", "CurvaturePolyPlanner", "DiffSteer", "DistanceTransformPlanner",
    "DstarPlanner", "DubinsPlanner", "EKF", "LandmarkMap", "LatticePlanner", "NoPathError", "OccupancyGrid",
    "PRMPlanner", "ParticleFilter", "PlannerBase", "PolygonMap", "PoseGraph", "PurePursuit", "QuinticPolyPlanner",
    "RRTPlanner", "RandomPath", "RangeBearingSensor", "ReedsSheppPlanner", "SensorBase", "Unicycle",
    "VehicleAnimationBase", "VehicleBase", "VehicleDriverBase", "VehicleIcon", "VehicleMarker", "VehiclePolygon",
    "mobile", "blocks",
}  # fmt: skip
__all__ = list(_CLASSES)
__all__ += list(_MODULE_OF)
__all__ += ["backends", "models"]
__version__ = "1.5.0"  # whose names these are
register_former_modules()


def __getattr__(name: str) -> Any:
    if name in _MODULE_OF:
        value = getattr(importlib.import_module(_MODULE_OF[name]), name)
        globals()[name] = value
        return value
    if name in _MODULES:
        return importlib.import_module(f"roboticstoolbox.{name}")
    if name in _MOBILE:
        raise AttributeError(
            f"roboticstoolbox.{name} is not offered: Ulna is for robot arms; for mobile robots, maps, filters and "
            "block diagrams use the toolbox itself, without `ulna run`."
        )
    raise AttributeError(f"module 'roboticstoolbox' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, *_MODULES})
