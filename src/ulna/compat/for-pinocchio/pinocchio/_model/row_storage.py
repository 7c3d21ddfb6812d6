"""Where arrays of objects lie: in rows that do not move once there are two objects."""

from __future__ import annotations

from collections.abc import Callable
from operator import is_
from typing import Any, final

import numpy as np

from pinocchio._containers.arrays import StdVec
from pinocchio._containers.watched_lists import before_changes
from ulna.typing import Floats

_BLOCK_ROWS = 64


@before_changes(lambda owners: setattr(owners, "is_new", True), "__setitem__")
class OwnerList(StdVec[Any]):
    """Objects whose arrays lie in rows. `is_new` is set where others are put in, and reset once rows have theirs."""

    is_new = True

    def __reduce__(self) -> Any:
        return StdVec, (list(self),)


@final
class RowStorage:
    """Stores the arrays of objects as rows of blocks.

    Args:
        slot: The attribute in which an object holds its array.
        rows: Arrays (n, ...) whose objects are not made yet; they become the first block. See `objects`.
    """

    __slots__ = ("_blocks", "_owners", "_slot", "_used", "count")

    def __init__(self, slot: str, rows: Floats | None = None) -> None:
        self._slot = slot
        self._owners: list[Any] = []
        self._blocks: list[Floats] = [] if rows is None or not len(rows) else [rows]
        self._used = self.count = 0 if rows is None else len(rows)
        """How many rows of the last block, and of all, are in use."""

    def adopt(self, owners: list[Any]) -> bool:
        """Moves the arrays of new objects into rows; returns whether there were any."""
        known = len(self._owners)
        made = known == self.count  # else these are not the objects of a copied storage
        same = made and len(owners) >= known and all(map(is_, owners, self._owners))
        if same and len(owners) == known:
            return False
        if not same:
            self._owners, self._blocks, self.count = [], [], 0
        for owner in list(owners)[len(self._owners) :]:
            self._append(owner)
        return True

    def adopt_last(self, owner: Any, count: int) -> bool:
        """Moves the array of the last object into a row, where it alone is new.

        Args:
            owner: The last of the objects.
            count: How many there are.

        Returns:
            Whether it alone was new; else nothing has changed.
        """
        if count != self.count + 1:
            return False
        self._append(owner)
        return True

    def _append(self, owner: Any) -> None:
        values = getattr(owner, self._slot)
        if not self._blocks or self._used == len(self._blocks[-1]):
            self._begin_block(values.shape)
        row = self._blocks[-1][self._used]
        row[...] = values
        setattr(owner, self._slot, row)
        self._owners.append(owner)
        self._used, self.count = self._used + 1, self.count + 1

    def _begin_block(self, shape: tuple[int, ...]) -> None:
        block, self._used = np.zeros((_BLOCK_ROWS, *shape)), 0
        if self.count == 1:  # the universe of a new model moves: kernels read one block in less time than two
            block[:1], self._used = self._blocks.pop(), 1
            for owner in self._owners:
                setattr(owner, self._slot, block[0])
        self._blocks.append(block)

    def objects(self, make: Callable[[Floats], Any]) -> list[Any]:
        """The objects of the rows that the storage was made with, each made of its row by `make`."""
        self._owners = [make(row) for block in self.blocks() for row in block]
        return [*self._owners]

    def blocks(self) -> list[Floats]:
        """The rows in use."""
        return [*self._blocks[:-1], self._blocks[-1][: self._used]] if self._blocks else []
