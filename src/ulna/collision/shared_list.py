"""A list that worlds made of each other share, so that thousands of obstacles can be added one by one."""

from __future__ import annotations

from collections.abc import Iterable
from typing import final

from ulna.collision.objects import Obstacle
from ulna.system import forks

_lock = forks.lock(forks.LIBRARY)


@final
class SharedList:
    """Obstacles, of which each world has the first few; what was added stays where it is.

    Args:
        items: The obstacles, whose names differ.
    """

    def __init__(self, items: Iterable[Obstacle]) -> None:
        self._items = list(items)
        self._places = {item.name: place for place, item in enumerate(self._items)}

    def has(self, name: str, count: int) -> bool:
        """Whether one of the first obstacles has a name.

        Args:
            name: The name.
            count: How many obstacles are looked at.

        Returns:
            The truth value.
        """
        return self._places.get(name, count) < count

    def first(self, count: int) -> tuple[Obstacle, ...]:
        """The first obstacles.

        Args:
            count: How many.

        Returns:
            The obstacles.
        """
        return tuple(self._items[:count])

    def with_item(self, count: int, item: Obstacle) -> SharedList:
        """A list of the first obstacles and one more: this one, where there are no others.

        Args:
            count: How many are kept.
            item: The one more, whose name none of them has.

        Returns:
            The list.
        """
        with _lock:
            if count == len(self._items):
                self._items.append(item)
                self._places[item.name] = count
                return self
        return SharedList((*self._items[:count], item))
