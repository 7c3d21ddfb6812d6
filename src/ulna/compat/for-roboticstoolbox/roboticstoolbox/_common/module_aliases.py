"""Modules of the toolbox from which scripts import: their names are those of `roboticstoolbox`."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from types import ModuleType
from typing import Any


class _AliasModule(ModuleType):
    """A module whose names are those of `roboticstoolbox`."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return public_name(self.__name__, name)


def add_module_aliases(package: str, names: Iterable[str]) -> None:
    """Makes modules of these names importable from a package.

    Args:
        package: Name of the package.
        names: Names of the modules.
    """
    for name in names:
        place = f"{package}.{name}"
        sys.modules.setdefault(place, _AliasModule(place, f"Names of `roboticstoolbox`, as {place}."))


def public_name(place: str, name: str) -> Any:
    """The object of that name in `roboticstoolbox`.

    Args:
        place: Name of the module, for the message.
        name: Name of the object.

    Returns:
        The object.

    Raises:
        AttributeError: There is no such name.
    """
    import roboticstoolbox

    if name not in roboticstoolbox.__all__:
        raise AttributeError(f"module {place!r} has no attribute {name!r}")
    return getattr(roboticstoolbox, name)
