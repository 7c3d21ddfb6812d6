"""The Robotics Toolbox's names for robot arms, over Ulna: `import roboticstoolbox as rtb`."""

from __future__ import annotations

import importlib
from functools import partial
from typing import Any

from roboticstoolbox._common.class_registry import register_class
from roboticstoolbox._common.former_modules import register_former_modules
from roboticstoolbox._common.module_aliases import add_module_aliases
from ulna.compat.missing_names import missing_name as _missing_name

_MODULE_NAMES = {
    "roboticstoolbox._ets.elementary_transform": ("ET", "ET2"),
    "roboticstoolbox._ets.ets": ("ETS", "ETS2"),
    "roboticstoolbox._links.link": ("Link", "Link2", "ELink", "ELink2"),
    "roboticstoolbox._links.gripper": ("Gripper",),
    "roboticstoolbox._robots.robot": ("BaseRobot", "Robot", "ERobot"),
    "roboticstoolbox._robots.planar_robot": ("Robot2", "ERobot2"),
    "roboticstoolbox._ets.ik_solution": ("IKSolution",),
    "roboticstoolbox._ik.solvers": ("IKSolver", "IK_LM", "IK_NR", "IK_GN", "IK_QP"),
    "roboticstoolbox._robots.dh_links": ("DHLink", "RevoluteDH", "PrismaticDH", "RevoluteMDH", "PrismaticMDH"),
    "roboticstoolbox._robots.dh_robot": ("DHRobot", "SerialLink"),
    "roboticstoolbox._robots.poe_robot": ("PoELink", "PoERevolute", "PoEPrismatic", "PoERobot"),
    "roboticstoolbox.tools.trajectory": (
        "Trajectory", "jtraj", "ctraj", "mtraj", "mstraj", "quintic", "quintic_func", "trapezoidal",
        "trapezoidal_func", "lspb",
    ),
    "roboticstoolbox._plot.curves": ("xplot",),
    "roboticstoolbox.tools.servo": ("p_servo", "angle_axis", "angle_axis_python"),
    "roboticstoolbox.tools.chains": ("TrChainToken", "trchain", "trchain2"),
    "roboticstoolbox.tools.data": (
        "rtb_get_param", "rtb_load_data", "rtb_load_jsonfile", "rtb_load_matfile", "rtb_path_to_datafile",
        "rtb_set_param",
    ),
    "roboticstoolbox.tools.helpers": ("null", "jsingu", "jacobian_numerical", "hessian_numerical", "Ticker"),
}  # fmt: skip
_MODULE_OF = {name: module for module, names in _MODULE_NAMES.items() for name in names}
_MODULES = ("backends", "bin", "ets", "models", "robot", "tools")
_MOBILE = {
    "Bicycle", "BinaryOccupancyGrid", "Bug2", "CurvaturePolyPlanner", "DiffSteer", "DistanceTransformPlanner",
    "DstarPlanner", "DubinsPlanner", "EKF", "LandmarkMap", "LatticePlanner", "NoPathError", "OccupancyGrid",
    "PRMPlanner", "ParticleFilter", "PlannerBase", "PolygonMap", "PoseGraph", "PurePursuit", "QuinticPolyPlanner",
    "RRTPlanner", "RandomPath", "RangeBearingSensor", "ReedsSheppPlanner", "SensorBase", "Unicycle",
    "VehicleAnimationBase", "VehicleBase", "VehicleDriverBase", "VehicleIcon", "VehicleMarker", "VehiclePolygon",
    "mobile", "blocks",
}  # fmt: skip
__all__ = list(_MODULE_OF)
__all__ += ["backends", "models"]
__version__ = "1.5.0"  # whose names these are
register_former_modules()
add_module_aliases(__name__, ("mobile", "blocks", "demo", "_fknm_c", "_frne_c"))


def __getattr__(name: str) -> Any:
    if name in _MODULE_OF:
        value = getattr(importlib.import_module(_MODULE_OF[name]), name)
        globals()[name] = value
        return value
    if name in _MODULES:
        return importlib.import_module(f"roboticstoolbox.{name}")
    if name in _MOBILE:
        text = (
            f"roboticstoolbox.{name} is not offered: Ulna is for robot arms; for mobile robots, maps, filters and "
            "block diagrams use the toolbox itself, without `ulna run`."
        )
        raise _missing_name(__name__, name, text)
    raise _missing_name(__name__, name, f"module 'roboticstoolbox' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, *_MODULES})


for _name in ("DHRobot", "Robot", "Robot2"):
    register_class(_name, partial(__getattr__, _name))
