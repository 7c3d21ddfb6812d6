"""Names that are imported when they are asked for, so that `import pinocchio` loads no viewer."""

from __future__ import annotations

import importlib
from typing import Any

_OF = {
    "_collisions": ("computeCollision", "computeCollisions", "computeDistance", "computeDistances"),
    "_geometry": (
        "CollisionPair",
        "GeometryData",
        "GeometryModel",
        "GeometryObject",
        "updateGeometryPlacements",
    ),
    "_geometry_urdf": ("buildGeomFromUrdf",),
    "_srdf": (
        "loadReferenceConfigurations",
        "loadReferenceConfigurationsFromXML",
        "loadRotorParameters",
        "removeCollisionPairs",
        "removeCollisionPairsFromXML",
    ),
    "_samples": ("buildSampleModelManipulator",),
    "_parallel": ("ModelPool", "abaInParallel", "rneaInParallel"),
    "liegroups": ("LieGroup", "lieGroup"),
    "robot_wrapper": ("RobotWrapper",),
    "shortcuts": ("buildModelsFromUrdf", "createDatas"),
    "visualize": ("GepettoVisualizer", "MeshcatVisualizer", "ViserVisualizer", "Visualizer"),
}
LATE: dict[str, str] = {name: module for module, names in _OF.items() for name in names}
"""The module of each of these names."""
MODULES = ("cholesky", "liegroups", "linalg", "robot_wrapper", "shortcuts", "visualize")


def late(name: str) -> Any:
    """What a name of `LATE`, or a module of `MODULES`, stands for."""
    if name in MODULES:
        return importlib.import_module(f"pinocchio.{name}")
    return getattr(importlib.import_module(f"pinocchio.{LATE[name]}"), name)
