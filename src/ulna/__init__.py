"""Ulna compiles your robot: kinematics of articulated robots, traced from the textbook into machine code.

>>> import ulna
>>> robot = ulna.load("panda")
>>> T = robot.fk(robot.configurations["qr"])
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from ulna import errors as errors
    from ulna import numeric as numeric
    from ulna.load import load as load
    from ulna.load import load_model as load_model
    from ulna.model import Model as Model
    from ulna.model import ModelBuilder as ModelBuilder
    from ulna.robot import Robot as Robot
    from ulna.robot import compile as compile
    from ulna.spatial import SE3 as SE3
    from ulna.spatial import SO3 as SO3
    from ulna.spatial import Force as Force
    from ulna.spatial import Inertia as Inertia
    from ulna.spatial import Motion as Motion
    from ulna.trace import trace as trace

_HOME = {
    "SE3": "ulna.spatial",
    "SO3": "ulna.spatial",
    "Force": "ulna.spatial",
    "Inertia": "ulna.spatial",
    "Motion": "ulna.spatial",
    "Model": "ulna.model",
    "ModelBuilder": "ulna.model",
    "Robot": "ulna.robot",
    "compile": "ulna.robot",
    "load": "ulna.load",
    "load_model": "ulna.load",
    "trace": "ulna.trace",
    "errors": "",
    "numeric": "",
}

__all__ = [*_HOME, "__version__"]  # pyright: ignore[reportUnsupportedDunderAll]
