"""Geometries on the joints of a robot, and the pairs of them to check for collisions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, ClassVar, Self

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import NO_INDEX, StdVec, alike, copies, fixed, index
from pinocchio._containers.attributes import AttributeKind, CheckedAttributes, read_only
from pinocchio._containers.files import Saved
from pinocchio._containers.unknown_ids import UnknownId, known
from pinocchio._containers.watched_lists import before_changes
from pinocchio._geometry.collision_pair import CollisionPair, known_pairs
from pinocchio._geometry.geometry_object import GeometryObject
from pinocchio._model.building import KinematicTree
from ulna.errors import excerpt
from ulna.system import forks
from ulna.typing import Array, Floats

_new = object.__new__
_MAKING = forks.lock(forks.KERNEL)
"""Held while the pairs of a copy are made, of which all threads are to see the same."""


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


class PairList(StdVec[CollisionPair]):
    """The pairs of geometries that are checked."""

    def _checked(self, entry: Any) -> CollisionPair:
        if not isinstance(entry, CollisionPair):
            raise ArgumentError(
                f"A list of pairs was given {excerpt(repr(entry))}; expected a CollisionPair."
            )
        return entry.copy()


PairList.__name__ = "StdVec_CollisionPair"  # as scripts see it


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
        self._keep(geometryObjects=GeometryList(() if other is None else copies(other.geometryObjects)))
        if other is None:
            self._keep(collisionPairs=PairList())
        else:
            self.__dict__["_unmade_pairs"] = other._pairs_now()

    def _pairs_now(self) -> tuple[tuple[int, int], ...]:
        """The indices of each pair, of which a copy makes its own when it is asked for them."""
        own = self.__dict__
        found = own.get("_unmade_pairs")
        if found is not None:
            return found
        pairs, known = own["collisionPairs"], own.get("_known_pairs")
        if known is None or not known.is_of(pairs):
            known = own["_known_pairs"] = known_pairs(pairs)
        return known.indices

    def _make_pairs(self) -> None:
        """Makes the pairs of a copy."""
        with _MAKING:
            found = self.__dict__.get("_unmade_pairs")
            if found is not None:  # another thread may have made them meanwhile
                self._keep(collisionPairs=PairList([CollisionPair._of_indices(*pair) for pair in found]))
                del self.__dict__["_unmade_pairs"]

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
        self._make_pairs()
        return {name: x for name, x in self.__dict__.items() if name not in ("_pair_calls", "_known_pairs")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name in ("_pair_calls", "_known_pairs", "_unmade_pairs"):
            self.__dict__.pop(name, None)
        self.__dict__.update(state)
        objects, pairs = state["geometryObjects"], state["collisionPairs"]
        self._keep(geometryObjects=GeometryList(objects), collisionPairs=PairList(pairs))

    def copy(self) -> Self:
        """A copy that shares the shapes."""
        return self._copied(GeometryObject.copy)

    __copy__ = copy

    def clone(self) -> Self:
        """A copy, shapes included."""
        return self._copied(GeometryObject.clone)

    def _copied(self, copied: Callable[[GeometryObject], GeometryObject]) -> Self:
        out = _new(type(self))
        objects = GeometryList([copied(g) for g in self.geometryObjects])
        out.__dict__.update(geometryObjects=objects, _unmade_pairs=self._pairs_now())
        return out

    def __deepcopy__(self, memo: Any) -> Self:
        return self.clone()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryCollection):
            return NotImplemented
        if not alike(self.geometryObjects, other.geometryObjects):
            return False
        same = self._pairs_now() == other._pairs_now()
        return same or alike(self.collisionPairs, other.collisionPairs)  # whose indices may change places

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
