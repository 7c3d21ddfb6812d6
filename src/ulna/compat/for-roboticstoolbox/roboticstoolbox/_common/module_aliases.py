"""Modules of the toolbox from which scripts import: their names are those of `roboticstoolbox`."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterable
from functools import reduce
from types import ModuleType
from typing import Any

from roboticstoolbox._common.module_names import PLACES, advice_on, is_closed
from ulna.compat.missing_names import REFUSAL, missing_name


class _AliasModule(ModuleType):
    """A module whose names are those of `roboticstoolbox`, or those that a table lists for it."""

    def __getattr__(self, name: str) -> Any:
        if name == "__all__":
            last = self.__name__.rpartition(".")[2]
            return sorted(
                PLACES.get(_below(self.__name__), () if is_closed(_below(self.__name__)) else (last,))
            )
        if name.startswith("__"):
            raise AttributeError(name)
        try:
            return name_in(self.__name__, name)
        except AttributeError as error:
            raise missing_name(self.__name__, name, str(error)) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.__getattr__("__all__")]


def _below(place: str) -> str:
    return place.partition(".")[2]


def add_module_aliases(package: str, names: Iterable[str]) -> None:
    """Makes modules importable from a package: those of these names, and those that the table has for it.

    Args:
        package: Name of the package.
        names: Names of the modules; those below them in the table are added, too.
    """
    places = [f"{package}.{name}" for name in names]
    above = tuple(f"{_below(place)}." for place in [package, *places])
    listed = [f"roboticstoolbox.{key}" for key in PLACES if key.startswith(above)]
    for place in [*places, *listed]:
        if place in sys.modules:
            continue
        module = _AliasModule(place, f"Names of `roboticstoolbox`, as {place}.")
        if any(key.startswith(f"{_below(place)}.") for key in PLACES):
            module.__path__ = []
        if is_closed(_below(place)):
            setattr(module, REFUSAL, advice_on(_below(place)))
        sys.modules[place] = module


def name_in(place: str, name: str) -> Any:
    """What a module of the toolbox has under a name.

    Args:
        place: Name of the module.
        name: Name of the object.

    Returns:
        The object.

    Raises:
        AttributeError: There is no such name; says what to use.
    """
    where = PLACES.get(_below(place), {}).get(name)
    if where:
        module, _, path = where.partition(":")
        return reduce(getattr, path.split("."), importlib.import_module(f"roboticstoolbox.{module}"))
    return public_name(place, name)


def public_name(place: str, name: str) -> Any:
    """The object of that name in `roboticstoolbox`, or the module of that name below a package.

    Args:
        place: Name of the module, for the message.
        name: Name of the object.

    Returns:
        The object.

    Raises:
        AttributeError: There is no such name; says what to use.
    """
    toolbox = sys.modules["roboticstoolbox"]
    is_open = not is_closed(_below(place))
    if name in toolbox.__all__ and is_open:
        return getattr(toolbox, name)
    module = sys.modules.get(f"{place}.{name}") if is_open else None  # those are called as their classes
    if module is not None:
        return module
    package, _, last = place.rpartition(".")
    if (
        is_open and name == last and package.startswith("roboticstoolbox.models")
    ):  # the class that the module is for
        return getattr(sys.modules[package], name)
    advice = advice_on(_below(place))
    raise AttributeError(f"module {place!r} has no attribute {name!r}{f': {advice}' if advice else ''}")
