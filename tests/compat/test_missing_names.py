"""Names that a compatibility package does not offer: their errors say what to use, also in `from` imports."""

from __future__ import annotations

import importlib
from typing import Any

import pytest

from support.compat_packages import using

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
