"""CollisionPair: the indices of two geometries."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from operator import attrgetter, is_
from typing import Any, ClassVar, NamedTuple, final

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import NO_INDEX, index
from pinocchio._containers.attributes import AttributeKind, CheckedAttributes, whole
from pinocchio._containers.files import register
from ulna.errors import InputError, excerpt

_new = object.__new__
PAIR_CHANGES = [0]
"""How often an index of any pair was changed."""


@final
class CollisionPair(CheckedAttributes):
    """Indices of two geometries, in any order."""

    _kinds: ClassVar[Mapping[str, AttributeKind]] = {"first": whole, "second": whole}
    __slots__ = ("first", "second")
    first: int
    second: int

    def __init__(self, index1: int | None = None, index2: int | None = None) -> None:
        if (
            type(index1) is int
            and type(index2) is int
            and 0 <= index1 <= NO_INDEX
            and 0 <= index2 <= NO_INDEX
            and index1 != index2
        ):
            _set_first(self, index1)  # attributes that are set are checked
            _set_second(self, index2)
            return
        if (index1 is None) != (index2 is None):
            raise ArgumentError("CollisionPair was given one index; expected two, or none.")
        both = (NO_INDEX, NO_INDEX) if index1 is None else (index1, index2)
        self.first, self.second = (
            index(i, NO_INDEX + 1, "geometry", "getGeometryId(name) returns one.") for i in both
        )
        if self.first == self.second != NO_INDEX:
            raise InputError(f"The pair names geometry {self.first} twice; expected two of them.")

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)
        PAIR_CHANGES[0] += 1

    @staticmethod
    def _of_indices(first: int, second: int) -> CollisionPair:
        """The pair of two indices, which are not looked at."""
        out = _new(CollisionPair)
        _set_first(out, first)
        _set_second(out, second)
        return out

    def copy(self) -> CollisionPair:
        """A copy."""
        return CollisionPair._of_indices(self.first, self.second)

    __copy__ = copy

    def __getstate__(self) -> dict[str, int]:
        return {"first": self.first, "second": self.second}

    def __setstate__(self, state: dict[str, int]) -> None:
        self.first, self.second = state["first"], state["second"]

    def _assign(self, other: CollisionPair) -> None:
        """Takes over the indices of another one, as an entry of a list does."""
        if not isinstance(other, CollisionPair):
            raise ArgumentError(f"A pair was given {excerpt(repr(other))}; expected a CollisionPair.")
        self.first, self.second = other

    def __iter__(self) -> Iterator[int]:
        return iter((self.first, self.second))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, CollisionPair):
            return NotImplemented
        return (other.first, other.second) in ((self.first, self.second), (self.second, self.first))

    __hash__ = object.__hash__

    def __str__(self) -> str:
        return f"collision pair ({self.first},{self.second})\n"

    __repr__ = __str__


_set_first, _set_second = vars(CollisionPair)["first"].__set__, vars(CollisionPair)["second"].__set__

_indices_of = attrgetter("first", "second")


class KnownPairs(NamedTuple):
    """What the pairs of a geometry model were.

    Attributes:
        change: The count of changes of pairs then.
        pairs: The pairs.
        indices: The indices of each.
    """

    change: int
    pairs: list[CollisionPair]
    indices: tuple[tuple[int, int], ...]

    def is_of(self, pairs: Sequence[CollisionPair]) -> bool:
        """Whether these are the same pairs, and none has changed."""
        same = self.change == PAIR_CHANGES[0] and len(self.pairs) == len(pairs)
        return same and all(map(is_, self.pairs, pairs))


def known_pairs(pairs: Sequence[CollisionPair]) -> KnownPairs:
    """What pairs are now."""
    change, now = PAIR_CHANGES[0], list(pairs)
    return KnownPairs(change, now, tuple(map(_indices_of, now)))


register(CollisionPair)
