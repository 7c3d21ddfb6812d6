"""Unique paths of nodes in the page of viser."""

from __future__ import annotations

from collections import Counter
from typing import final


@final
class ViserPaths:
    """Paths of the page, each with no other pose above it: groups are for display, poses are of the world."""

    def __init__(self) -> None:
        self._taken: set[str] = set()
        self._below: Counter[str] = Counter()

    def take(self, name: str) -> str:
        """An unused path for the node of that name."""
        group, _, rest = name.partition("/")
        if rest:
            while f"/{group}" in self._taken:  # a node stands there, and would carry the group along
                group += " ·"
            path = f"/{group}/{rest.replace('/', ' › ')}"
        else:
            path = f"/{group}"
            while self._below[path]:
                path += " ·"
        while path in self._taken:
            path += "'"
        self._taken.add(path)
        self._below[path.rpartition("/")[0]] += 1
        return path

    def free(self, path: str) -> None:
        """Give a path back."""
        self._taken.discard(path)
        self._below[path.rpartition("/")[0]] -= 1
