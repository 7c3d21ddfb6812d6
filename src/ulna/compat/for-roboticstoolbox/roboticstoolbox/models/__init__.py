"""The robots of the package: models.Panda(), models.DH.Puma560(), models.ETS.Planar2() ..."""

from __future__ import annotations

import importlib
import warnings
from typing import Any

from roboticstoolbox._common.module_aliases import add_module_aliases

_KINDS = ("DH", "ETS", "URDF")


def catalog(
    keywords: Any = None,
    dof: int | None = None,
    mtype: str | None = None,
    sorton: str | None = None,
    border: str = "thin",
) -> None:
    """Prints a table of the robots.

    Args:
        keywords: Words of which name, manufacturer or keywords contain one; None for all.
        dof: Number of joints; None for any.
        mtype: "DH", "ETS" or "URDF"; None for all.
        sorton: What rows are sorted by: "name", "manufacturer" or "dof"; None for the kinds in turn.
        border: "thin", "thick", "double", "round" or "ascii".

    Raises:
        UnknownKey: There is no such kind.
        UnknownOption: There is no such column or border.
    """
    from roboticstoolbox._common.errors import UnknownKey, UnknownOption
    from roboticstoolbox._common.text_table import bordered, grid

    if mtype is not None and mtype not in _KINDS:
        raise UnknownKey("kind of model", mtype, _KINDS)
    columns: dict[str, Any] = {"name": 1, "manufacturer": 2, "dof": 4}
    if sorton is not None and sorton.lower() not in columns:
        raise UnknownOption("column", sorton, columns)
    words = (keywords,) if isinstance(keywords, str) else tuple(keywords or ())
    rows = []
    for kind in _KINDS if mtype is None else (mtype,):
        module = importlib.import_module(f"roboticstoolbox.models.{kind}")
        for name in (n for n in module.__all__ if n != "URDFRobot" and _is_here(kind, n)):
            robot = getattr(module, name)()
            text = " ".join([name, robot.name, robot.manufacturer, *robot.keywords]).lower()
            if dof not in (None, robot.n) or (words and not any(word.lower() in text for word in words)):
                continue
            rows.append([name, robot.name, robot.manufacturer, kind, *_figures(robot)])
    if sorton is not None:
        column = columns[sorton.lower()]
        rows.sort(key=lambda row: int(row[column]) if sorton.lower() == "dof" else row[column].lower())
    header = ["class", "robot name", "manufacturer", "model type", *_FIGURES]
    table = grid(header, rows, [False] * len(header)) if rows else "no such robots"
    print(bordered(table, border))


def list(
    keywords: Any = None,
    dof: int | None = None,
    mtype: str | None = None,
    sorton: str | None = None,
    border: str = "thin",
) -> None:
    """The former name of `catalog`.

    Args:
        keywords, dof, mtype, sorton, border: As for `catalog`.
    """
    warnings.warn("models.list is the former name of models.catalog", FutureWarning, stacklevel=2)
    catalog(keywords, dof, mtype, sorton, border)


_FIGURES = ("DoF", "dims", "structure", "dynamics", "geometry", "keywords")


def _figures(robot: Any) -> tuple[str, ...]:
    """The cells of a robot in the columns of `_FIGURES`."""
    has = ["Y" if there else "" for there in (robot.hasdynamics, robot.hasgeometry)]
    dimensions = "2d" if robot._size == 3 else "3d"
    return str(robot.n), dimensions, robot.structure, *has, ", ".join(robot.keywords)


def _is_here(kind: str, name: str) -> bool:
    """Whether a robot can be made without fetching its description."""
    from roboticstoolbox.models.URDF import _external_descriptions

    return kind != "URDF" or name not in _external_descriptions.ROBOTS or _external_descriptions.is_here(name)


add_module_aliases(__name__, ())


def __getattr__(name: str) -> Any:
    if name in _KINDS:
        return importlib.import_module(f"roboticstoolbox.models.{name}")
    if name.startswith("_"):
        raise AttributeError(name)
    urdf = importlib.import_module("roboticstoolbox.models.URDF")
    return getattr(urdf, name)
