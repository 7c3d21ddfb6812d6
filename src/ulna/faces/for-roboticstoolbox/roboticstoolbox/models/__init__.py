"""The robots that come with the face: models.Panda(), models.DH.Puma560(), models.ETS.Planar2() ..."""

from __future__ import annotations

import importlib
from typing import Any

_ROOMS = ("DH", "ETS", "URDF")


def catalog(
    keywords: Any = None, dof: int | None = None, mtype: str | None = None, border: str = "thin", **_: Any
) -> None:
    """Prints which robots there are: all, or those with `dof` joints, or of the kind "DH", "ETS" or "URDF"."""
    from roboticstoolbox._common.text_table import grid

    rows = []
    for room in _ROOMS if mtype is None else (mtype,):
        module = importlib.import_module(f"roboticstoolbox.models.{room}")
        for name in sorted(n for n in module.__all__ if n != "URDFRobot" and _is_here(room, n)):
            robot = getattr(module, name)()
            words = " ".join([name, robot.name, robot.manufacturer, *robot.keywords]).lower()
            if dof not in (None, robot.n) or (keywords and str(keywords).lower() not in words):
                continue
            yes = "X" if robot.hasdynamics else ""
            rows.append([name, robot.manufacturer, room, str(robot.n), robot.structure, yes])
    header = ["class", "manufacturer", "type", "DoF", "structure", "dynamics"]
    print(grid(header, rows, [False, False, False, True, False, False]) if rows else "no such robots")


list = catalog


def _is_here(room: str, name: str) -> bool:
    """Whether a robot can be made without fetching its description."""
    from roboticstoolbox.models.URDF import _described

    return room != "URDF" or name not in _described.ROBOTS or _described.is_here(name)


def __getattr__(name: str) -> Any:
    if name in _ROOMS:
        return importlib.import_module(f"roboticstoolbox.models.{name}")
    if name.startswith("_"):
        raise AttributeError(name)
    urdf = importlib.import_module("roboticstoolbox.models.URDF")
    return getattr(urdf, name)
