"""The robots of the package: models.Panda(), models.DH.Puma560(), models.ETS.Planar2() ..."""

from __future__ import annotations

import importlib
from typing import Any

_KINDS = ("DH", "ETS", "URDF")


def catalog(
    keywords: Any = None, dof: int | None = None, mtype: str | None = None, border: str = "thin", **_: Any
) -> None:
    """Prints a table of the robots.

    Args:
        keywords: Text that name, manufacturer or keywords must contain; None for any.
        dof: Number of joints; None for any.
        mtype: "DH", "ETS" or "URDF"; None for all.
        border: Accepted and ignored.
        **_: Accepted and ignored.
    """
    from roboticstoolbox._common.text_table import grid

    rows = []
    for kind in _KINDS if mtype is None else (mtype,):
        module = importlib.import_module(f"roboticstoolbox.models.{kind}")
        for name in sorted(n for n in module.__all__ if n != "URDFRobot" and _is_here(kind, n)):
            robot = getattr(module, name)()
            text = " ".join([name, robot.name, robot.manufacturer, *robot.keywords]).lower()
            if dof not in (None, robot.n) or (keywords and str(keywords).lower() not in text):
                continue
            yes = "X" if robot.hasdynamics else ""
            rows.append([name, robot.manufacturer, kind, str(robot.n), robot.structure, yes])
    header = ["class", "manufacturer", "type", "DoF", "structure", "dynamics"]
    print(grid(header, rows, [False, False, False, True, False, False]) if rows else "no such robots")


list = catalog


def _is_here(kind: str, name: str) -> bool:
    """Whether a robot can be made without fetching its description."""
    from roboticstoolbox.models.URDF import _external_descriptions

    return kind != "URDF" or name not in _external_descriptions.ROBOTS or _external_descriptions.is_here(name)


def __getattr__(name: str) -> Any:
    if name in _KINDS:
        return importlib.import_module(f"roboticstoolbox.models.{name}")
    if name.startswith("_"):
        raise AttributeError(name)
    urdf = importlib.import_module("roboticstoolbox.models.URDF")
    return getattr(urdf, name)
