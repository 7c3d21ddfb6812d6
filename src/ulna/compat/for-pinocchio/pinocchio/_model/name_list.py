"""The names of joints, which are found without going through all of them."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from pinocchio._containers.arrays import StdVec


class NameList(StdVec[str]):
    """Names that know their places, until one of them changes."""

    @cached_property
    def _places(self) -> dict[str, int]:
        """The first place of each name."""
        return {name: len(self) - 1 - k for k, name in enumerate(reversed(self))}

    def append(self, entry: Any) -> None:
        """Adds a name at the end."""
        super().append(entry)
        if "_places" in self.__dict__:
            self._places.setdefault(entry, len(self) - 1)

    def __reduce__(self) -> Any:
        return StdVec, (list(self),)


NameList.__name__ = "StdVec"  # as scripts see it


def _noted(name: str) -> Any:
    change = getattr(StdVec, name)

    def method(self: NameList, *args: Any, **options: Any) -> Any:
        self.__dict__.pop("_places", None)
        return change(self, *args, **options)

    method.__name__, method.__doc__ = name, change.__doc__
    return method


for _name in ("extend", "insert", "pop", "remove", "clear", "reverse", "sort"):
    setattr(NameList, _name, _noted(_name))
for _name in ("__setitem__", "__delitem__", "__iadd__", "__imul__"):
    setattr(NameList, _name, _noted(_name))
