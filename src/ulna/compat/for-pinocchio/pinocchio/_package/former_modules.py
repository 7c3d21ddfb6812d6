"""Modules by the names they had before the package was divided into folders: pickles of those versions name them."""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import Any, final

FORMER = {
    "_arrays": "_containers.arrays",
    "_enums": "_containers.enums",
    "_postures": "_containers.named_configurations",
    "_se3": "_spatial.se3",
    "_vectors": "_spatial.motion_force",
    "_inertia": "_spatial.inertia",
    "_symmetric": "_spatial.symmetric3",
    "_rotations": "_spatial.rotations",
    "_pseudo": "_spatial.pseudo_inertia",
    "_frame": "_model.frame",
    "_joints": "_model.joint_kinds",
    "_joint_data": "_model.joint_data",
    "_joint_model": "_model.joint_model",
    "_blocks": "_data.storage",
    "_parallel": "_algorithms.parallel",
    "_anchors": "_constraints.anchors",
    "_cones": "_constraints.cones",
    "_constraint_cholesky": "_constraints.cholesky",
    "_constraint_pair": "_constraints.frame_pair",
    "_delassus": "_constraints.delassus",
    "_joint_constraints": "_constraints.joint_constraints",
    "_proximal": "_constraints.proximal_settings",
    "_solvers": "_constraints.gauss_seidel",
    "_broadphase": "_geometry.broadphase",
    "_callbacks": "_geometry.collision_callbacks",
    "_collisions": "_geometry.collisions",
    "_geometry_data": "_geometry.geometry_data",
    "_geometry_object": "_geometry.geometry_object",
    "_materials": "_geometry.materials",
}
"""The present module of each former one whose classes can be pickled."""
FORMER_CLASSES = {
    "_constraints": ("RigidConstraintModel", "RigidConstraintData"),
    "_data": ("Data",),
    "_geometry": ("GeometryModel", "CollisionPair"),
    "_model": ("Model",),
    "_package": ("LogLevel",),
}
"""The classes of former modules whose names are now those of folders."""


@final
class FormerModule(ModuleType):
    """Stands for a module under its former name; its classes are those of the present module."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        package = sys.modules["pinocchio"]
        if name in dir(package):
            return getattr(package, name)
        return getattr(_present(FORMER[self.__name__.partition(".")[2]]), name)


def register_former_modules() -> None:
    """Lets pickle find classes by their former modules."""
    for name in FORMER:
        sys.modules.setdefault(f"pinocchio.{name}", FormerModule(f"pinocchio.{name}"))


def former_class(package: str, name: str) -> Any:
    """A class that had its place in a module named as a package is today.

    Args:
        package: Name of the package.
        name: Name of the class.

    Returns:
        The class.

    Raises:
        AttributeError: There was no such class there.
    """
    if name not in FORMER_CLASSES[package.partition(".")[2]]:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    return getattr(sys.modules["pinocchio"], name)


def _present(module: str) -> ModuleType:
    return importlib.import_module(f"pinocchio.{module}")
