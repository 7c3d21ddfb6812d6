"""Geometries of a robot: what it looks like and what it collides with, placed on its joints."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, NamedTuple, final

import numpy as np

from pinocchio._arrays import StdVec, index, vector, views
from pinocchio._se3 import SE3
from ulna.errors import InputError, UnknownName
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Mesh, Shape, Sphere
from ulna.spatial import SE3 as Pose
from ulna.typing import Floats

if TYPE_CHECKING:
    from pinocchio._data import Data
    from pinocchio._model import Model

_GREY = (0.9, 0.9, 0.9, 1.0)
_WORDS = ("BOX", "SPHERE", "CYLINDER", "CAPSULE")
_NAMES = ("mesh_path", "mesh_scale", "override_material", "mesh_color", "mesh_texture_path", "mesh_material")


@final
class GeometryObject:
    """One geometry on a joint.

    `GeometryObject(name, parent_joint, [parent_frame,] placement, geometry, mesh_path, mesh_scale,
    override_material, mesh_color, mesh_texture_path)`. Placement and geometry may change places, as they did.
    """

    def __init__(self, *parts: Any, **named: Any) -> None:
        if len(parts) == 1 and isinstance(parts[0], GeometryObject):
            self.__dict__.update(parts[0].copy().__dict__)
            return
        told = dict(named)
        rest = list(parts)
        self.name = str(told.pop("name") if "name" in told else rest.pop(0) if rest else "")
        ints = [told.pop(key) for key in ("parent_joint", "parent_frame") if key in told]
        while rest and hasattr(rest[0], "__index__"):
            ints.append(rest.pop(0))
        pair = [rest.pop(0) for _ in range(min(2, len(rest)))]
        placement = told.pop("placement", next((x for x in pair if isinstance(x, SE3)), None))
        geometry = told.pop("collision_geometry", next((x for x in pair if not isinstance(x, SE3)), None))
        told |= dict(zip(_NAMES, rest, strict=False))
        if not 1 <= len(ints) <= 2 or placement is None or geometry is None or set(told) - set(_NAMES):
            raise InputError(
                f"GeometryObject was given {parts}, {named}; expected a name, the index of a joint, that of a frame "
                "(or none), a placement SE3, a geometry, and " + ", ".join(_NAMES) + "."
            )
        self.parentJoint = int(ints[0])
        """The index of the joint it moves with."""
        self.parentFrame = int(ints[1]) if len(ints) == 2 else -1
        """The index of the frame it belongs to; -1 for none."""
        self._placement = SE3(placement)
        self._geometry = geometry
        self.meshPath = str(told.get("mesh_path", ""))
        """The file of the mesh; "BOX", "SPHERE", ... for other shapes of a URDF file; else empty."""
        self._scale = np.array(vector(told.get("mesh_scale", np.ones(3)), 3, "meshScale"))
        self.overrideMaterial = bool(told.get("override_material", False))
        """Whether `meshColor` hides the mesh's own colours."""
        self._color = np.array(vector(told.get("mesh_color", _GREY), 4, "meshColor"))
        self.meshTexturePath = str(told.get("mesh_texture_path", ""))
        """The file of a texture; empty for none."""
        self.meshMaterial = told.get("mesh_material")
        """What else was said of its material."""
        self.disableCollision = False
        """Whether pairs of it are left out when collisions are computed."""

    @property
    def placement(self) -> SE3:
        """Where it is in the frame of its joint, a live reference."""
        return self._placement

    @placement.setter
    def placement(self, M: SE3) -> None:
        self._placement._assign(M)

    @property
    def meshScale(self) -> Floats:
        """Factors of the mesh along x, y, z, live."""
        return self._scale

    @meshScale.setter
    def meshScale(self, value: Any) -> None:
        self._scale[:] = vector(value, 3, "meshScale")

    @property
    def meshColor(self) -> Floats:
        """Red, green, blue, opacity from 0 to 1, live."""
        return self._color

    @meshColor.setter
    def meshColor(self, value: Any) -> None:
        self._color[:] = vector(value, 4, "meshColor")

    @property
    def geometry(self) -> Any:
        """Its shape, as an object of coal, made when it is asked for; where coal is missing, a shape of Ulna."""
        if isinstance(self._geometry, Shape):
            from ulna.collision import Obstacle, World
            from ulna.collision.narrow import geometry_of
            from ulna.collision.solids import obstacle_solids
            from ulna.errors import MissingExtra

            world = World((Obstacle(self.name, self._geometry, Pose.identity()),))
            try:
                self._geometry = geometry_of(obstacle_solids(world)[0], False)
            except MissingExtra:
                return self._geometry
        return self._geometry

    @geometry.setter
    def geometry(self, geometry: Any) -> None:
        self._geometry = geometry
        self.meshPath = ""

    @property
    def shape(self) -> Shape | None:
        """Its shape as Ulna says it; None for a mesh that was made in memory."""
        if self.meshPath and self.meshPath not in _WORDS:
            return Mesh(self.meshPath, tuple(self._scale.tolist()), missing=not os.path.isfile(self.meshPath))
        return self._geometry if isinstance(self._geometry, Shape) else _shape_of(self._geometry)

    def copy(self) -> GeometryObject:
        """One of its own; the geometry itself is shared."""
        out = object.__new__(GeometryObject)
        out.__dict__.update(self.__dict__)
        out._placement, out._scale, out._color = (
            self._placement.copy(),
            self._scale.copy(),
            self._color.copy(),
        )
        return out

    __copy__ = clone = copy

    @staticmethod
    def CreateCapsule(radius: float, length: float) -> GeometryObject:
        """A capsule about z at the universe; `length` without its ends."""
        return GeometryObject("", 0, SE3(), Capsule(radius, length))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryObject):
            return NotImplemented
        keys = ("name", "parentJoint", "parentFrame", "_placement", "meshPath", "shape", "overrideMaterial")
        return all(getattr(self, k) == getattr(other, k) for k in keys) and bool(
            (self._color == other._color).all()
        )

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        what = self.shape
        words = type(self._geometry).__name__ if what is None else what.describe()
        return f"<{words} {self.name!r} on joint {self.parentJoint}>"


def _shape_of(geometry: Any) -> Shape | None:
    """A primitive of coal as a shape of Ulna; None for others."""
    match type(geometry).__name__:
        case "Box":
            x, y, z = (2.0 * float(half) for half in geometry.halfSide)
            return Box((x, y, z))
        case "Sphere":
            return Sphere(geometry.radius)
        case "Capsule":
            return Capsule(geometry.radius, 2.0 * geometry.halfLength)
        case "Cylinder":
            return Cylinder(geometry.radius, 2.0 * geometry.halfLength)
        case "Cone":
            return Cone(geometry.radius, 2.0 * geometry.halfLength)
        case "Ellipsoid":
            a, b, c = (float(r) for r in geometry.radii)
            return Ellipsoid((a, b, c))
    return None


class CollisionPair(NamedTuple):
    """Indices of two geometries."""

    first: int = 0
    second: int = 0


@final
class GeometryModel:
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
        marks = np.asarray(collision_map, dtype=bool)
        if marks.shape != (self.ngeoms, self.ngeoms):
            raise InputError(f"The map has shape {marks.shape}; expected {(self.ngeoms, self.ngeoms)}.")
        places = np.argwhere(np.triu(marks if upper else marks.T, 1))
        self.collisionPairs = StdVec(CollisionPair(int(i), int(j)) for i, j in places)

    def existCollisionPair(self, pair: CollisionPair) -> bool:
        """Whether the pair is checked."""
        return self.findCollisionPair(pair) < len(self.collisionPairs)

    def findCollisionPair(self, pair: CollisionPair) -> int:
        """The index of a pair; as many as there are if there is no such pair."""
        found = (k for k, p in enumerate(self.collisionPairs) if set(p) == set(pair))
        return next(found, len(self.collisionPairs))

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

    def __repr__(self) -> str:
        return f"<{self.ngeoms} geometries, {len(self.collisionPairs)} pairs to check>"


@final
class GeometryData:
    """Where the geometries are, and what was found about pairs of them: `geometry_model.createData()`."""

    def __init__(self, geometry_model: GeometryModel) -> None:
        self._block = np.tile(np.eye(4), (geometry_model.ngeoms, 1, 1))
        self.oMg: StdVec[SE3] = views(SE3, self._block)
        """Where each geometry is in the world, live references."""
        count = len(geometry_model.collisionPairs)
        self.activeCollisionPairs: list[bool] = [True] * count
        """Whether each pair is checked."""
        self.collisionResults: list[Any] = [None] * count
        """What coal found about each pair that was checked."""
        self.distanceResults: list[Any] = [None] * count
        """The distance of each pair that was measured, as coal has it."""

    def activateCollisionPair(self, pair_id: int) -> None:
        """Has a pair checked."""
        self.activeCollisionPairs[self._pair(pair_id)] = True

    def deactivateCollisionPair(self, pair_id: int) -> None:
        """Has a pair not checked."""
        self.activeCollisionPairs[self._pair(pair_id)] = False

    def deactivateAllCollisionPairs(self) -> None:
        """Has no pair checked."""
        self.activeCollisionPairs = [False] * len(self.activeCollisionPairs)

    def _pair(self, pair_id: int) -> int:
        return index(
            pair_id, len(self.activeCollisionPairs), "collision pair", "Make new data after adding pairs."
        )

    def __repr__(self) -> str:
        return f"<places of {len(self.oMg)} geometries, results of {len(self.collisionResults)} pairs>"


def updateGeometryPlacements(
    model: Model, data: Data, geometry_model: GeometryModel, geometry_data: GeometryData, q: Any = None
) -> None:
    """Fills `geometry_data.oMg` from `data.oMi`; with q, forwardKinematics comes first."""
    if len(geometry_data.oMg) != geometry_model.ngeoms:
        raise InputError(
            f"This GeometryData was made for {len(geometry_data.oMg)} geometries; now there are "
            f"{geometry_model.ngeoms}. Make a new one: geometry_model.createData()."
        )
    if q is not None:
        from pinocchio._kinematics import forwardKinematics

        forwardKinematics(model, data, q)
    objects = geometry_model.geometryObjects
    joints = [g.parentJoint for g in objects]
    own = np.array([g._placement._m for g in objects]).reshape(-1, 4, 4)
    np.matmul(data._blocks["oMi"][joints], own, out=geometry_data._block)
