"""Lets coal take an SE3 wherever it takes a Transform3s, as it does beside Pinocchio, whose binding converts them.

coal is imported when a program asks for it; then the functions in `FUNCTIONS` and the methods in `METHODS` are wrapped.
"""

from __future__ import annotations

import functools
import sys
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import Any

import numpy as np

FUNCTIONS = ("collide", "computeContactPatch", "distance")
METHODS = {
    "CollisionObject": ("__init__", "setTransform"),
    "ComputeCollision": ("__call__",),
    "ComputeContactPatch": ("__call__",),
    "ComputeDistance": ("__call__",),
    "MinkowskiDiff": ("set",),
    "Transform3s": ("__eq__", "__imul__", "__init__", "__mul__", "__ne__", "inverseTimes"),
}


class CoalFinder:
    """Finds coal as Python does, and wraps what takes poses after it is imported."""

    @staticmethod
    def find_spec(name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """Where coal is; None for other modules.

        Args:
            name: Name of the module.
            path: Where to search; None for `sys.path`.
            target: The module that is loaded again; None for none.

        Returns:
            What Python imports it by.
        """
        spec = PathFinder.find_spec(name, path, target) if name == "coal" else None
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def exec_module(module: ModuleType) -> None:
                execute(module)
                take_poses(module)

            spec.loader.exec_module = exec_module
        return spec


def watch_coal() -> None:
    """Has coal take poses: at once where it is imported, else when it is."""
    if "coal" in sys.modules:
        take_poses(sys.modules["coal"])
    elif not any(getattr(finder, "__name__", "") == "CoalFinder" for finder in sys.meta_path):
        sys.meta_path.insert(0, CoalFinder)


def take_poses(coal: Any) -> None:
    """Wraps the functions and methods of coal that take a Transform3s; does nothing the second time."""
    if hasattr(coal.collide, "__wrapped__"):
        return

    def converted(argument: Any) -> Any:
        rotation = getattr(argument, "rotation", None)
        if isinstance(rotation, np.ndarray) and hasattr(argument, "homogeneous"):
            return coal.Transform3s(np.array(rotation), np.array(argument.translation))
        return argument

    def wrapped(function: Any) -> Any:
        @functools.wraps(function)
        def call(*args: Any, **named: Any) -> Any:
            places = [converted(value) for value in args]
            return function(*places, **{name: converted(value) for name, value in named.items()})

        call.__wrapped__ = function  # pyright: ignore
        return call

    for name in FUNCTIONS:
        setattr(coal, name, wrapped(getattr(coal, name)))
    for cls, methods in METHODS.items():
        owner = getattr(coal, cls, None)
        for name in methods if owner is not None else ():
            setattr(owner, name, wrapped(getattr(owner, name)))
