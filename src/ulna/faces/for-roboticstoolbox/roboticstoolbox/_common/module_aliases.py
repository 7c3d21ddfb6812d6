"""Modules that the toolbox keeps its names in, for scripts that import from there: all lead to `roboticstoolbox`."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from types import ModuleType
from typing import Any


class _Room(ModuleType):
    """A module whose names are those of `roboticstoolbox`."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return offered(self.__name__, name)


def furnish(package: str, names: Iterable[str]) -> None:
    """Makes modules of these names importable from a package."""
    for name in names:
        place = f"{package}.{name}"
        sys.modules.setdefault(place, _Room(place, f"Names of `roboticstoolbox`, as {place}."))


def offered(place: str, name: str) -> Any:
    """What `roboticstoolbox` has by that name.

    Raises:
        AttributeError: Nothing.
    """
    import roboticstoolbox

    if name not in roboticstoolbox.__all__:
        raise AttributeError(f"module {place!r} has no attribute {name!r}")
    return getattr(roboticstoolbox, name)
