"""The names of joints, which are found without going through all of them."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from pinocchio._containers.arrays import StdVec
from pinocchio._containers.watched_lists import before_changes


@before_changes(lambda names: names.__dict__.pop("_places", None), "append")
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
