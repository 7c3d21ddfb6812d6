"""Inverse kinematics: from poses of a frame to configurations."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ulna.ik.differential import AccelerationLimit as AccelerationLimit
    from ulna.ik.differential import AxisTask as AxisTask
    from ulna.ik.differential import ComTask as ComTask
    from ulna.ik.differential import DampingTask as DampingTask
    from ulna.ik.differential import DifferentialIK as DifferentialIK
    from ulna.ik.differential import FrameTask as FrameTask
    from ulna.ik.differential import Interval as Interval
    from ulna.ik.differential import JointCouplingTask as JointCouplingTask
    from ulna.ik.differential import Limit as Limit
    from ulna.ik.differential import LinearLimit as LinearLimit
    from ulna.ik.differential import LinearTask as LinearTask
    from ulna.ik.differential import ManipulabilityTask as ManipulabilityTask
    from ulna.ik.differential import OrientationTask as OrientationTask
    from ulna.ik.differential import PlaneLimit as PlaneLimit
    from ulna.ik.differential import PositionLimit as PositionLimit
    from ulna.ik.differential import PositionTask as PositionTask
    from ulna.ik.differential import PostureTask as PostureTask
    from ulna.ik.differential import Problem as Problem
    from ulna.ik.differential import RelativeFrameTask as RelativeFrameTask
    from ulna.ik.differential import Rows as Rows
    from ulna.ik.differential import Strip as Strip
    from ulna.ik.differential import Task as Task
    from ulna.ik.differential import VelocityLimit as VelocityLimit

__all__ = [
    "AccelerationLimit",
    "AxisTask",
    "ComTask",
    "DampingTask",
    "DifferentialIK",
    "FrameTask",
    "Interval",
    "JointCouplingTask",
    "Limit",
    "LinearLimit",
    "LinearTask",
    "ManipulabilityTask",
    "OrientationTask",
    "PlaneLimit",
    "PositionLimit",
    "PositionTask",
    "PostureTask",
    "Problem",
    "RelativeFrameTask",
    "Rows",
    "Strip",
    "Task",
    "VelocityLimit",
]


def __getattr__(name: str) -> Any:
    """Tasks and limits are loaded when first named: `robot.ik` does without them."""
    if name in __all__ or name == "differential":
        package = importlib.import_module("ulna.ik.differential")
        return package if name == "differential" else getattr(package, name)
    raise AttributeError(f"module 'ulna.ik' has no attribute {name!r}")


def __dir__() -> list[str]:
    return list(__all__)
