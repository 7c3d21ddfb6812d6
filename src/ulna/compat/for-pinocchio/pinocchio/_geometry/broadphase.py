"""Broad phases: boxes around geometries are compared before the geometries themselves.

All managers of Pinocchio answer alike; here they are one, which compares the boxes of all pairs at once. coal's own
manager of the same name, with the geometries in it, is at `getManager()`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import NO_INDEX, StdVec
from pinocchio._containers.keywords import by_name
from pinocchio._geometry.collision_callbacks import CollisionCallBackBase, CollisionCallBackDefault
from pinocchio._geometry.collisions import CollisionManager, box_corners
from pinocchio._geometry.geometry_data import GeometryData
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._geometry.geometry_pool import GeometryPool
from pinocchio._geometry.placements import updateGeometryPlacements
from pinocchio._model.model import Model
from ulna.collision.narrow import coal
from ulna.typing import Floats


class CollisionObject(coal().CollisionObject):
    """coal's object of a geometry: `CollisionObject(geometry, Transform3s)`; `geometryObjectIndex` says which it is."""

    geometryObjectIndex = NO_INDEX


class BroadPhaseManager(CollisionManager):
    """The boxes of a robot's geometries: `(model, geometry_model, geometry_data)`, or a copy of another manager.

    After `updateGeometryPlacements`, `update()` moves the boxes; `collide(callback)` compares them.
    """

    coal_class = "DynamicAABBTreeCollisionManager"

    @by_name("model geometry_model geometry_data", "other")
    def __init__(self, *parts: Any) -> None:
        if len(parts) == 1:
            parts = parts[0]._model, parts[0]._geometry, parts[0]._data
        if len(parts) != 3 or not isinstance(parts[2], GeometryData):
            raise ArgumentError(
                f"{type(self).__name__} was given {parts}; expected a model, a GeometryModel, its data."
            )
        self._model, self._geometry, self._data = parts
        self._manager: Any = None
        self.update(True)

    @by_name("compute_local_aabb", "geom_data_new")
    def update(self, what: Any = False) -> None:
        """Moves the boxes to where the geometries are now.

        Args:
            what: Whether to measure the geometries anew, or the GeometryData to work on from now on.
        """
        if isinstance(what, GeometryData):
            self._data = what
        if what is True or len(self._corners) != self._geometry.ngeoms:
            self._corners = [box_corners(g.geometry) for g in self._geometry.geometryObjects]
        self._objects = StdVec(self._object(i) for i in range(self._geometry.ngeoms))
        places = [M._pose() @ c for M, c in zip(self._data.oMg, self._corners, strict=True)]
        margin = self.getCollisionObjectInflation()[:, None]
        self._low = np.array([p.min(axis=0) for p in places]).reshape(-1, 3) - margin
        self._high = np.array([p.max(axis=0) for p in places]).reshape(-1, 3) + margin
        self._manager = None

    _corners: Any = ()

    def _object(self, i: int) -> CollisionObject:
        M = self._data.oMg[i]
        place = coal().Transform3s(M.rotation, M.translation)
        out = CollisionObject(self._geometry.geometryObjects[i].geometry, place)
        out.geometryObjectIndex = i
        return out

    @by_name("callback", "other_manager callback", "collision_object callback")
    def collide(self, *parts: Any) -> bool:
        """Calls back for all geometries whose boxes overlap: `(callback)`, `(object, callback)`, `(manager, callback)`.

        Returns:
            Whether the callback found a collision.
        """
        *with_, callback = parts
        callback.init()
        for first, second in self._near(*with_):
            if callback.collide(first, second):
                break
        callback.done()
        return bool(callback.collision)

    def _near(self, other: Any = None) -> list[tuple[Any, Any]]:
        if other is None:
            marks = np.triu(_overlap((self._low, self._high), (self._low, self._high)), 1)
            return [(self._objects[i], self._objects[j]) for i, j in np.argwhere(marks)]
        if isinstance(other, BroadPhaseManager):
            marks, objects = _overlap((self._low, self._high), (other._low, other._high)), other._objects
        else:
            other.computeAABB()
            box = other.getAABB()
            ends = np.array([box.min_]).reshape(1, 3), np.array([box.max_]).reshape(1, 3)
            marks, objects = _overlap((self._low, self._high), ends), [other]
        return [(self._objects[i], objects[j]) for i, j in np.argwhere(marks)]

    def check(self, callback: Any = None) -> bool:
        """Whether it (and a callback) is of the geometries as they are."""
        fits = len(self._objects) == self._geometry.ngeoms == len(self._data.oMg)
        return fits and (callback is None or callback.getGeometryModel() is self._geometry)

    def getModel(self) -> Model:
        """The model."""
        return self._model

    def getGeometryModel(self) -> GeometryModel:
        """The geometries."""
        return self._geometry

    def getGeometryData(self) -> GeometryData:
        """Where they are."""
        return self._data

    def getCollisionObjects(self) -> StdVec[CollisionObject]:
        """The objects of the geometries, in their order."""
        return self._objects

    def getCollisionObjectStatus(self) -> StdVec[bool]:
        """For each geometry, whether it takes part."""
        return StdVec(not g.disableCollision for g in self._geometry.geometryObjects)

    def getCollisionObjectInflation(self) -> Floats:
        """For each geometry, by how much its box is widened [m]: half of the greatest margin of its pairs."""
        out = np.zeros(self._geometry.ngeoms)
        if "collisionRequests" in self._data._of_coal:
            for request, pair in zip(
                self._data.collisionRequests, self._geometry.collisionPairs, strict=True
            ):
                for i in pair:
                    out[i] = max(out[i], 0.5 * request.security_margin)
        return out

    def getManager(self) -> Any:
        """coal's manager of this name, with the geometries in it."""
        if self._manager is None:
            self._manager = getattr(coal(), self.coal_class)()
            for each in self._objects:
                self._manager.registerObject(each)
            self._manager.setup()
        return self._manager

    def compute_collisions(self, *parts: Any) -> bool:
        """`computeCollisions` with this manager: (manager, ...), or (model, data, manager, [callback,] q, ...)."""
        rest = list(parts[1:])
        if parts[0] is not self:
            model, data, _, *rest = parts
            q = rest.pop(1 if isinstance(rest[0], CollisionCallBackBase) else 0)
            updateGeometryPlacements(model, data, self._geometry, self._data, q)
            self.update()
        callback = rest[0] if rest else False
        if not isinstance(callback, CollisionCallBackBase):
            callback = CollisionCallBackDefault(self._geometry, self._data, bool(callback))
        return self.collide(callback)


class BroadPhaseManagerPool(GeometryPool):
    """Several data of a robot's geometries, with a broad phase for each."""

    _make: type[BroadPhaseManager] = BroadPhaseManager

    def getBroadPhaseManager(self, index: int) -> BroadPhaseManager:
        """The manager of an index."""
        return self.getBroadPhaseManagers()[self._place(index)]

    def getBroadPhaseManagers(self) -> StdVec[BroadPhaseManager]:
        """The managers."""
        if not hasattr(self, "_managers") or len(self._managers) != self.size():
            self._managers = StdVec(self._make(self._model, self._geometry, d) for d in self._geometry_datas)
        return self._managers

    @by_name("data", "geometry_data")
    def update(self, data: Any) -> None:
        """Makes all data of geometries (or all Data) like one."""
        super().update(data)
        self.__dict__.pop("_managers", None)

    def asGeometryPool(self) -> GeometryPool:
        """Itself."""
        return self

    def check(self) -> bool:
        """Whether all managers fit their geometries."""
        return all(manager.check() for manager in self.getBroadPhaseManagers())

    def collision_arguments(self) -> tuple[Any, ...]:
        """What `computeCollisions` is given before q."""
        return self._model, self.getData(0), self.getBroadPhaseManager(0)


def _overlap(first: tuple[Floats, Floats], second: tuple[Floats, Floats]) -> Any:
    """For each box of the first and of the second (n, m), whether they overlap."""
    (low, high), (others_low, others_high) = first, second
    return ((low[:, None] <= others_high) & (others_low <= high[:, None])).all(axis=-1)


_SEARCHES = ("DynamicAABBTree", "DynamicAABBTreeArray", "IntervalTree", "Naive", "SSaP", "SaP")
_DOC = "See `BroadPhaseManager`; coal's {} is at `getManager()`."
CLASSES: dict[str, type] = {
    f"{tree}BroadPhaseManager_{search}CollisionManager": type(
        f"{tree}BroadPhaseManager_{search}CollisionManager",
        (BroadPhaseManager,),
        {
            "coal_class": f"{search}CollisionManager",
            "__doc__": _DOC.format(f"{search}CollisionManager"),
            "__module__": __name__,
        },
    )
    for tree in ("", "Tree")
    for search in _SEARCHES
}
"""The managers by their names."""
for _tree in ("", "Tree"):
    _word = f"{_tree}BroadPhaseManagerPool_DynamicAABBTreeCollisionManager"
    _manager = CLASSES[f"{_tree}BroadPhaseManager_DynamicAABBTreeCollisionManager"]
    _members = {"_make": _manager, "__doc__": BroadPhaseManagerPool.__doc__, "__module__": __name__}
    CLASSES[_word] = type(_word, (BroadPhaseManagerPool,), _members)
globals().update(CLASSES)
