"""The default arguments of the compatibility packages are those of the packages that they stand for."""

from __future__ import annotations

import importlib
import inspect
from typing import Any

import pytest

from support.compat_packages import using

MODULES = {
    "roboticstoolbox": ("roboticstoolbox", "roboticstoolbox.tools", "spatialgeometry", "spatialmath"),
    "pinocchio": (
        "pinocchio",
        "pinocchio.visualize",
        "pinocchio.utils",
        "pinocchio.shortcuts",
        "pinocchio.robot_wrapper",
    ),
}
LEAST = {"roboticstoolbox": 1800, "pinocchio": 150}  # how many are compared at least
OTHERS = {
    ("URDF", "manufacturer"),  # none is an empty text
    ("jacob0_analytical", "representation"),  # None there, which no class but one takes
    ("A", "q"),  # None tells a constant transform from a joint at zero
    ("__init__", "name"),  # solvers of inverse kinematics: their own name
    ("drawFrameVelocities", "color"),  # the viewer's own
    ("initViewer", "host"),  # of the loopback
    ("initViewer", "port"),  # one that is free
}
"""Methods and arguments with another default."""
REFUSED = ("Panda3dVisualizer",)
"""Classes that are refused as they are made."""


def defaults(modules: tuple[str, ...]) -> dict[tuple[str, str], Any]:
    """The default of each argument of the public functions and methods, by the name of the function and its own."""
    roots = tuple({name.split(".", maxsplit=1)[0] for name in modules})
    found = {}

    def note(name: str, function: Any) -> None:
        try:
            parameters = inspect.signature(function).parameters.values()
        except (TypeError, ValueError):  # of C++, without a signature
            return
        found.update({(name, p.name): p.default for p in parameters if p.default is not p.empty})

    for module in map(importlib.import_module, modules):
        for name in dir(module):
            thing = getattr(module, name)
            if name.startswith("_") or not str(getattr(thing, "__module__", "")).startswith(roots):
                continue
            members = (
                [m for m in dir(thing) if m == "__init__" or m[0] != "_"] if inspect.isclass(thing) else []
            )
            for member in members:
                method = inspect.getattr_static(thing, member)
                note(f"{name}.{member}", getattr(method, "__func__", method))
            if inspect.isroutine(thing):
                note(name, thing)
    return found


@pytest.mark.parametrize("package", MODULES)
def test_defaults_are_those_of_the_original(package: str) -> None:
    for module in MODULES[package]:
        pytest.importorskip(module)
    theirs = defaults(MODULES[package])
    with using(package):
        ours = defaults(MODULES[package])
    plain = (int, float, str, type(None))
    compared = {
        key: (ours[key], default)
        for key, default in theirs.items()
        if key in ours and isinstance(default, plain) and isinstance(ours[key], plain)
    }
    assert len(compared) > LEAST[package]
    wrong = {key: both for key, both in compared.items() if both[0] != both[1]}
    wrong = {key: both for key, both in wrong.items() if (key[0].split(".")[-1], key[1]) not in OTHERS}
    assert not {key: both for key, both in wrong.items() if key[0].split(".")[0] not in REFUSED}
