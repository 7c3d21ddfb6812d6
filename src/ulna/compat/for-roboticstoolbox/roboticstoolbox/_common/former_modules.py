"""Modules by the names they had before the package was divided into folders: pickles of those versions name them."""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import Any, final

FORMER = {
    "_et": "_ets.elementary_transform",
    "_sequence": "_ets.sequence",
    "_link": "_links.link",
    "_gripper": "_links.gripper",
    "_copies": "_mixins.copying",
    "_motion": "_dynamics.simulation",
    "_ellipses": "_plot.ellipsoids",
    "_solvers": "_ik.solvers",
    "_analytic": "_ik.analytic",
    "_robot": "_robots.robot",
    "_planar": "_robots.planar_robot",
    "_poe": "_robots.poe_robot",
}
"""The present module of each former one whose objects can be pickled."""
FORMER_PAIRS = {"_dh": ("_robots.dh_links", "_robots.dh_robot")}
"""Former modules that are two today."""
FORMER_CLASSES = {"_ets": ("_ets.ets", ("ETS", "ETS2")), "_ik": ("_ets.ik_solution", ("IKSolution",))}
"""Classes of former modules whose names are now those of folders, with their present modules."""


@final
class FormerModule(ModuleType):
    """Stands for a module under its former name; its names are those of the present module."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        former = self.__name__.partition(".")[2]
        places = FORMER_PAIRS[former] if former in FORMER_PAIRS else (FORMER[former],)
        modules = [_present(place) for place in places]
        module = next((one for one in modules if hasattr(one, name)), modules[0])
        return getattr(module, name)


def register_former_modules() -> None:
    """Lets pickle find classes by their former modules."""
    for name in (*FORMER, *FORMER_PAIRS):
        sys.modules.setdefault(f"roboticstoolbox.{name}", FormerModule(f"roboticstoolbox.{name}"))


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
    place, classes = FORMER_CLASSES[package.partition(".")[2]]
    if name not in classes:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    return getattr(_present(place), name)


def _present(module: str) -> ModuleType:
    return importlib.import_module(f"roboticstoolbox.{module}")
