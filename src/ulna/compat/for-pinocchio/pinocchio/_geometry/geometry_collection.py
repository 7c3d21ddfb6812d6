"""Geometries on the joints of a robot, and the pairs of them to check for collisions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, ClassVar, Self, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import NO_INDEX, StdVec, alike, fixed, index
from pinocchio._containers.attributes import AttributeKind, CheckedAttributes, read_only, whole
from pinocchio._containers.files import Saved, register
from pinocchio._containers.unknown_ids import UnknownId, known
from pinocchio._containers.watched_lists import before_changes
from pinocchio._geometry.geometry_object import GeometryObject
from pinocchio._model.building import KinematicTree
from ulna.errors import InputError, excerpt
from ulna.typing import Array, Floats

_new = object.__new__


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

    def copy(self) -> CollisionPair:
        """A copy."""
        out = _new(CollisionPair)
        _set_first(out, self.first)
        _set_second(out, self.second)
        return out

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


def _count(objects: GeometryList) -> None:
    objects.changes[0] += 1


@before_changes(_count)
class GeometryList(StdVec[GeometryObject]):
    """Geometries; `changes` counts how often one was added, removed or replaced."""

    def __init__(self, objects: Iterable[GeometryObject] = ()) -> None:
        super().__init__(objects)
        self.changes: Array = np.zeros(1, np.int64)

    def __reduce__(self) -> Any:
        return GeometryList, (list(self),)


class GeometryCollection(CheckedAttributes, Saved):
    """The geometries of a robot, of one kind, and the pairs of them to check for collisions."""

    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        "geometryObjects": read_only,
        "collisionPairs": read_only,
    }
    geometryObjects: GeometryList
    """The geometries."""
    collisionPairs: StdVec[CollisionPair]
    """The pairs to check."""

    def __init__(self, other: GeometryCollection | None = None) -> None:
        source: Any = ((), ()) if other is None else (other.geometryObjects, other.collisionPairs)
        self._take(*([one.copy() for one in part] for part in source))

    def _take(self, objects: list[GeometryObject], pairs: list[CollisionPair]) -> None:
        """Makes the geometries and pairs these, and no copies of them."""
        self._keep(geometryObjects=GeometryList(objects), collisionPairs=StdVec(pairs))

    @property
    def ngeoms(self) -> int:
        """How many geometries there are."""
        return len(self.geometryObjects)

    def addGeometryObject(self, geometry_object: GeometryObject, model: KinematicTree | None = None) -> int:
        """Adds a geometry; returns its index. With a model, its joint is that of its frame.

        Args:
            model: The model of its frame, whose joint it takes; None keeps its joint.

        Returns:
            Its index.

        Raises:
            ArgumentError: It is no geometry.
        """
        if not isinstance(geometry_object, GeometryObject):
            raise ArgumentError(f"Cannot add {geometry_object!r}; expected a GeometryObject.")
        added = geometry_object.copy()
        if model is not None and added.parentFrame != NO_INDEX:
            fix = "model.getFrameId(name) returns one."
            added.parentJoint = model.frames[
                index(added.parentFrame, model.nframes, "frame", fix)
            ].parentJoint
        self.geometryObjects.append(added)
        return self.ngeoms - 1

    def removeGeometryObject(self, name: str) -> None:
        """Removes the geometry of that name, and the pairs it is in."""
        gone = known(self.getGeometryId(name))
        del self.geometryObjects[gone]
        remaining = [pair for pair in self.collisionPairs if gone not in pair]
        self._pair_up(CollisionPair(*(i - (i > gone) for i in pair)) for pair in remaining)

    def existGeometryName(self, name: str) -> bool:
        """Whether there is a geometry of that name."""
        return any(g.name == name for g in self.geometryObjects)

    def getGeometryId(self, name: str) -> int:
        """The index of the geometry of that name; where there is none, `ngeoms`, whose use as an index raises."""
        names = [geometry.name for geometry in self.geometryObjects]
        if name in names:
            return names.index(name)
        return UnknownId.of(
            self.ngeoms, "geometry", name, names, "Ask existGeometryName(name) where it may be missing."
        )

    def addCollisionPair(self, collision_pair: CollisionPair) -> None:
        """Adds a pair to check."""
        first, second = (
            index(i, self.ngeoms, "geometry", "getGeometryId(name) returns one.") for i in collision_pair
        )
        if not self.existCollisionPair(collision_pair):
            self.collisionPairs.append(CollisionPair(first, second))

    def addAllCollisionPairs(self) -> None:
        """Makes the pairs those of all geometries that are not on one joint."""
        parents = [g.parentJoint for g in self.geometryObjects]
        count = range(self.ngeoms)
        self._pair_up(CollisionPair(i, j) for i in count for j in count[i + 1 :] if parents[i] != parents[j])

    def removeCollisionPair(self, collision_pair: CollisionPair) -> None:
        """Removes a pair, if it is there."""
        self._pair_up([p for p in self.collisionPairs if p != collision_pair])

    def removeAllCollisionPairs(self) -> None:
        """Removes all pairs."""
        self.collisionPairs.clear()

    def setCollisionPairs(self, collision_map: Any, upper: bool = True) -> None:
        """Sets the pairs by a matrix.

        Args:
            collision_map: Truth values (n, n) for n geometries.
            upper: Whether those above the diagonal count, else those below it.
        """
        places = np.argwhere(np.triu(pair_map(self, collision_map, upper).astype(bool), 1))
        self._pair_up(CollisionPair(int(i), int(j)) for i, j in places)

    def _pair_up(self, pairs: Iterable[CollisionPair]) -> None:
        self.collisionPairs.clear()
        self.collisionPairs.extend(pairs)

    def existCollisionPair(self, collision_pair: CollisionPair) -> bool:
        """Whether the pair is checked."""
        return self.findCollisionPair(collision_pair) < len(self.collisionPairs)

    def findCollisionPair(self, collision_pair: CollisionPair) -> int:
        """The index of a pair; as many as there are if there is no such pair."""
        indices = (k for k, p in enumerate(self.collisionPairs) if p == collision_pair)
        return next(indices, len(self.collisionPairs))

    @property
    def collisionPairMapping(self) -> Any:
        """For each two geometries the index of their pair, -1 for none: a symmetric matrix of integers."""
        out = np.full((self.ngeoms, self.ngeoms), -1, dtype=np.int32)
        for k, (i, j) in enumerate(self.collisionPairs):
            out[i, j] = out[j, i] = k
        return fixed(out)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_pair_calls"}

    def copy(self) -> Self:
        """A copy that shares the shapes."""
        return self._copied(GeometryObject.copy)

    __copy__ = copy

    def clone(self) -> Self:
        """A copy, shapes included."""
        return self._copied(GeometryObject.clone)

    def _copied(self, copied: Callable[[GeometryObject], GeometryObject]) -> Self:
        out = _new(type(self))
        out._take([copied(g) for g in self.geometryObjects], [p.copy() for p in self.collisionPairs])
        return out

    def __deepcopy__(self, memo: Any) -> Self:
        return self.clone()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryCollection):
            return NotImplemented
        names = ("geometryObjects", "collisionPairs")
        return all(alike(getattr(self, name), getattr(other, name)) for name in names)

    __hash__ = object.__hash__

    def __str__(self) -> str:
        lines = "".join(f"{_described(g)}\n" for g in self.geometryObjects)
        return f"Nb geometry objects = {self.ngeoms}\n{lines}"

    def __repr__(self) -> str:
        return f"<{self.ngeoms} geometries, {len(self.collisionPairs)} pairs to check>"


def _described(g: GeometryObject) -> str:
    parts = {
        "Name": g.name,
        "Parent frame ID": g.parentFrame,
        "Parent joint ID": g.parentJoint,
        "Position in parent frame": g.placement,
        "Absolute path to mesh file": g.meshPath,
        "Scale for transformation of the mesh": " ".join(f"{x:.6g}" for x in g.meshScale),
        "Disable collision": int(g.disableCollision),
    }
    return "".join(f"{key}: \t \n{value}\n" for key, value in parts.items()) + "\n"


def pair_map(
    geometry_model: GeometryCollection, values: Any, upper: bool, kind: type[bool | float] = bool
) -> Floats:
    """A matrix of pairs whose upper half counts.

    Args:
        values: Matrix (n, n) for n geometries.
        upper: Whether its upper half counts, else the lower one.
        kind: What an entry is.

    Returns:
        Matrix (n, n).

    Raises:
        ArgumentError: It has another shape or other entries.
    """
    matrix, count = np.asarray(values), geometry_model.ngeoms
    if matrix.shape != (count, count) or not np.can_cast(matrix.dtype, kind):
        raise ArgumentError(
            f"The map has shape {matrix.shape} and dtype {matrix.dtype}; expected {(count, count)} and {kind.__name__}."
        )
    return matrix if upper else matrix.T


register(CollisionPair)
