"""The shelves that faces lie on, and how they get onto the path."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

from ulna.errors import InputError, UnknownName

_HERE = Path(__file__).parent

SHELVES: dict[str, Path] = {
    "roboticstoolbox": _HERE / "for-roboticstoolbox",
    "pinocchio": _HERE / "for-pinocchio",
}
"""Folders that hold faces, by the package they are for."""


def modules(shelf: str) -> tuple[str, ...]:
    """Names of the packages on a shelf."""
    folder = SHELVES[shelf]
    found = (p for p in folder.iterdir() if (p / "__init__.py").is_file()) if folder.is_dir() else ()
    return tuple(sorted(p.name for p in found))


def shelf_of(name: str) -> str:
    """The shelf that a package lies on: that of its own name, or of the package it comes with.

    Raises:
        UnknownName: If there is no face of that name.
    """
    if name in SHELVES:
        return name
    for shelf in SHELVES:
        if name in modules(shelf):
            return shelf
    raise UnknownName("face", name, [*SHELVES, *(m for s in SHELVES for m in modules(s))])


def environment(shelves: Iterable[str], base: Mapping[str, str] | None = None) -> dict[str, str]:
    """The variables of a process whose Python finds the faces before the packages they stand for."""
    variables = dict(os.environ if base is None else base)
    rest = [p for p in variables.get("PYTHONPATH", "").split(os.pathsep) if p]
    variables["PYTHONPATH"] = os.pathsep.join([*(str(SHELVES[s]) for s in shelves), *rest])
    return variables


def wear(*names: str) -> None:
    """Puts faces on the path of this process, for notebooks: `ulna.faces.wear("pinocchio")`, then `import pinocchio`.

    Args:
        *names: Names of faces; each brings the others on its shelf along.

    Raises:
        UnknownName: If there is no face of that name.
        InputError: If the package itself is imported already: its names are taken, and two of them would mix.
    """
    chosen = [shelf_of(name) for name in names]
    for shelf in chosen:
        for module in modules(shelf):
            loaded = sys.modules.get(module)
            place = getattr(loaded, "__file__", None) if loaded is not None else None
            if loaded is not None and not str(place).startswith(str(SHELVES[shelf])):
                raise InputError(
                    f"`{module}` is imported already, from {place}. Restart Python and call ulna.faces.wear first."
                )
    for shelf in reversed(chosen):
        folder = str(SHELVES[shelf])
        if folder not in sys.path:
            sys.path.insert(0, folder)
