"""Geometries of a robot: what it looks like and what it collides with, placed on its joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, final

import numpy as np

from pinocchio._arrays import StdVec, index
from pinocchio._geometry_data import GeometryData, pair_map, updateGeometryPlacements
from pinocchio._geometry_object import GeometryObject
from pinocchio._saved import Saved
from ulna.errors import InputError, UnknownName

if TYPE_CHECKING:
    from pinocchio._model import Model

__all__ = ["CollisionPair", "GeometryData", "GeometryModel", "GeometryObject", "updateGeometryPlacements"]


class CollisionPair(NamedTuple):
    """Indices of two geometries."""

    first: int = 2**64 - 1
    second: int = 2**64 - 1

    def copy(self) -> CollisionPair:
        """The same pair."""
        return self

    def __str__(self) -> str:
        return f"collision pair ({self.first},{self.second})\n"


@final
class GeometryModel(Saved):
    """The geometries of a robot, of one kind, and the pairs of them to check for collisions."""

    def __init__(self) -> None:
        self.geometryObjects: StdVec[GeometryObject] = StdVec()
        """The geometries."""
        self.collisionPairs: StdVec[CollisionPair] = StdVec()
        """The pairs to check."""

    @property
    def ngeoms(self) -> int:
        """How many geometries there are."""
        return len(self.geometryObjects)

    def addGeometryObject(self, geometry_object: GeometryObject, model: Model | None = None) -> int:
        """Adds a geometry; returns its index. With a model, its joint is that of its frame."""
        if not isinstance(geometry_object, GeometryObject):
            raise InputError(f"Cannot add {geometry_object!r}; expected a GeometryObject.")
        if self.existGeometryName(geometry_object.name):
            raise InputError(
                f"There is a geometry named {geometry_object.name!r} already. Give another name."
            )
        added = geometry_object.copy()
        if model is not None and added.parentFrame >= 0:
            mend = "model.getFrameId(name) gives one."
            added.parentJoint = model.frames[
                index(added.parentFrame, model.nframes, "frame", mend)
            ].parentJoint
        self.geometryObjects.append(added)
        return self.ngeoms - 1

    def removeGeometryObject(self, name: str) -> None:
        """Removes the geometry of that name, and the pairs it is in."""
        gone = self.getGeometryId(name)
        del self.geometryObjects[gone]
        kept = [pair for pair in self.collisionPairs if gone not in pair]
        self.collisionPairs = StdVec(CollisionPair(*(i - (i > gone) for i in pair)) for pair in kept)

    def existGeometryName(self, name: str) -> bool:
        """Whether there is a geometry of that name."""
        return any(g.name == name for g in self.geometryObjects)

    def getGeometryId(self, name: str) -> int:
        """The index of the geometry of that name. Raises UnknownName with the nearest one."""
        for i, geometry in enumerate(self.geometryObjects):
            if geometry.name == name:
                return i
        raise UnknownName("geometry", name, [g.name for g in self.geometryObjects])

    def addCollisionPair(self, pair: CollisionPair) -> None:
        """Adds a pair to check."""
        first, second = (index(i, self.ngeoms, "geometry", "getGeometryId(name) gives one.") for i in pair)
        if first == second:
            raise InputError(f"The pair names geometry {first} twice; expected two of them.")
        if not self.existCollisionPair(pair):
            self.collisionPairs.append(CollisionPair(first, second))

    def addAllCollisionPairs(self) -> None:
        """Makes the pairs those of all geometries that are not on one joint."""
        parents = [g.parentJoint for g in self.geometryObjects]
        self.collisionPairs = StdVec(
            CollisionPair(i, j)
            for i in range(self.ngeoms)
            for j in range(i + 1, self.ngeoms)
            if parents[i] != parents[j]
        )

    def removeCollisionPair(self, pair: CollisionPair) -> None:
        """Removes a pair, if it is there."""
        self.collisionPairs = StdVec(p for p in self.collisionPairs if set(p) != set(pair))

    def removeAllCollisionPairs(self) -> None:
        """Removes all pairs."""
        self.collisionPairs = StdVec()

    def setCollisionPairs(self, collision_map: Any, upper: bool = True) -> None:
        """Makes the pairs those that a matrix (ngeoms, ngeoms) marks above its diagonal (or below it)."""
        places = np.argwhere(np.triu(pair_map(self, collision_map, upper).astype(bool), 1))
        self.collisionPairs = StdVec(CollisionPair(int(i), int(j)) for i, j in places)

    def existCollisionPair(self, pair: CollisionPair) -> bool:
        """Whether the pair is checked."""
        return self.findCollisionPair(pair) < len(self.collisionPairs)

    def findCollisionPair(self, pair: CollisionPair) -> int:
        """The index of a pair; as many as there are if there is no such pair."""
        found = (k for k, p in enumerate(self.collisionPairs) if set(p) == set(pair))
        return next(found, len(self.collisionPairs))

    @property
    def collisionPairMapping(self) -> Any:
        """For each two geometries the index of their pair, -1 for none: a symmetric matrix of integers."""
        out = np.full((self.ngeoms, self.ngeoms), -1, dtype=np.int32)
        for k, (i, j) in enumerate(self.collisionPairs):
            out[i, j] = out[j, i] = k
        return out

    def createData(self) -> GeometryData:
        """What placements and results are written into."""
        return GeometryData(self)

    def copy(self) -> GeometryModel:
        """One of its own; the shapes themselves are shared."""
        out = GeometryModel()
        out.geometryObjects = StdVec(g.copy() for g in self.geometryObjects)
        out.collisionPairs = StdVec(self.collisionPairs)
        return out

    __copy__ = clone = copy

    def __deepcopy__(self, memo: Any) -> GeometryModel:
        return self.copy()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryModel):
            return NotImplemented
        return self.geometryObjects == other.geometryObjects and self.collisionPairs == other.collisionPairs

    __hash__ = object.__hash__

    def __str__(self) -> str:
        told = "".join(f"{_described(g)}\n" for g in self.geometryObjects)
        return f"Nb geometry objects = {self.ngeoms}\n{told}"

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
