"""Names that a compatibility package does not offer: their errors say what to use, also in `from` imports."""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from support.compat_packages import using
from ulna.compat.missing_names import REFUSAL
from ulna.compat.packages import environment

CASES = {
    "swift": ("Light", "The lights are those of the viewer's theme"),
    "spatialgeometry": ("SceneObject", "Use SceneNode."),
    "roboticstoolbox": ("EKF", "for mobile robots, maps, filters and block diagrams use the toolbox itself"),
}


@pytest.mark.parametrize("module", CASES)
def test_both_spellings_of_an_import_say_what_to_use(module: str) -> None:
    name, advice = CASES[module]
    with using("roboticstoolbox"):
        package: Any = importlib.import_module(module)
        with pytest.raises(AttributeError, match=advice):
            getattr(package, name)
        with pytest.raises(ImportError, match=advice):
            exec(f"from {module} import {name}", {})
        assert not hasattr(package, name) and getattr(package, name, 3) == 3


def test_modules_within_a_package_are_still_imported() -> None:
    with using("roboticstoolbox"):
        scope: dict[str, Any] = {}
        exec("from roboticstoolbox.backends import swift\nfrom spatialgeometry import tools", scope)
        assert {"swift", "tools"} <= scope.keys()


MODULES = {
    "swift.phys": "env.step",
    "swift.SwiftRoute": "env.viewer.url",
    "swift.Light": "env.viewer.theme",
    "spatialgeometry.scene": "SceneNode",
}


@pytest.mark.parametrize("module", MODULES)
def test_modules_that_are_not_offered_say_what_to_use(module: str) -> None:
    package, _, name = module.rpartition(".")
    with using("roboticstoolbox"):
        for statement in (f"import {module}", f"import {module} as m", f"from {module} import step"):
            with pytest.raises(ModuleNotFoundError, match=MODULES[module]):
                exec(statement, {})
        with pytest.raises(ImportError, match=MODULES[module]):
            exec(f"from {package} import {name}", {})


def test_names_of_modules_without_any_say_what_to_use() -> None:
    statements = {
        "from roboticstoolbox.mobile.drivers import RandomPath": "for robot arms",
        "from roboticstoolbox.mobile import EKF": "for robot arms",
        "from roboticstoolbox.backends.swift import SwiftServer": "env.viewer.url",
        "from roboticstoolbox.tools.urdf.urdf import Joint": "ulna.load",
        "from roboticstoolbox.models.ETS.Omni import Omni": "FrankieOmni",
        "from roboticstoolbox.robot.symbolic_ik import _solve": "analytic_ik",
    }
    with using("roboticstoolbox"):
        for statement, advice in statements.items():
            with pytest.raises(ImportError, match=advice):
                exec(statement, {})
        module = importlib.import_module("roboticstoolbox.mobile.EKF")
        assert "for robot arms" in getattr(module, REFUSAL)


def _modules_of(package: str) -> list[str]:
    """The modules that lie in the folder of an installed package, without importing them."""
    spec = importlib.util.find_spec(package)
    if spec is None or not spec.submodule_search_locations:
        return []
    found, folders = [package], [(package, list(spec.submodule_search_locations))]
    for name, places in folders:
        for module in pkgutil.iter_modules(places):
            found.append(f"{name}.{module.name}")
            if module.ispkg:
                folders.append((found[-1], [str(Path(place) / module.name) for place in places]))
    return found


def test_all_modules_of_the_installed_packages_are_there_or_say_what_to_use() -> None:
    """As the packages are installed; Swift, which is not needed, only where it is."""
    pytest.importorskip("roboticstoolbox")
    modules = [
        name for package in ("roboticstoolbox", "spatialgeometry", "swift") for name in _modules_of(package)
    ]
    assert len(modules) > 100
    script = """
import importlib, sys
for name in sys.argv[1:]:
    try:
        importlib.import_module(name)
    except ImportError as error:
        print(name, error)
"""
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", script, *modules],
        env=environment(["roboticstoolbox"]), capture_output=True, text=True, timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    refused = done.stdout.splitlines()
    assert all(line.split()[0] in MODULES and MODULES[line.split()[0]] in line for line in refused), (
        done.stdout
    )
