"""Lists that are computed when they are read, so that a change of one would have no effect."""

from __future__ import annotations

from typing import Any

from pinocchio._containers.arrays import StdVec
from pinocchio._containers.attributes import ReadOnlyAttribute
from pinocchio._containers.watched_lists import before_changes


def _refuse(values: Any) -> None:
    raise ReadOnlyAttribute(
        f"{list(values)} is computed when it is read: a change of it would have no effect. Change a copy: list(values)."
    )


@before_changes(_refuse)
class ComputedList(StdVec[Any]):
    """A list of which only copies can be changed."""

    def _like(self, entries: list[Any]) -> StdVec[Any]:
        return StdVec(entries)

    def __reduce__(self) -> Any:
        return StdVec, (list(self),)
