"""What is done with two geometries whose boxes overlap: they are looked at closely, or noted."""

from __future__ import annotations

from typing import Any

from pinocchio._containers.arrays import NO_INDEX, StdVec
from pinocchio._geometry.collision_pair import CollisionPair
from pinocchio._geometry.collisions import computeCollision
from pinocchio._geometry.geometry_data import GeometryData
from pinocchio._geometry.geometry_model import GeometryModel


class CollisionCallBackBase:
    """What is done with two geometries whose boxes overlap: `collide(first, second)` of a class made from this one."""

    def __init__(self, geometry_model: GeometryModel, geometry_data: GeometryData) -> None:
        self._model, self._data = geometry_model, geometry_data
        self.collision = False
        """Whether two geometries touch."""
        self.accumulate = False
        """Whether findings of several calls are kept together."""

    def getGeometryModel(self) -> GeometryModel:
        """The geometries."""
        return self._model

    def getGeometryData(self) -> GeometryData:
        """Where they are."""
        return self._data

    def init(self) -> None:
        """Called before a search: forgets what was found, unless it is to accumulate."""
        if not self.accumulate:
            self.collision = False

    def collide(self, first: Any, second: Any) -> bool:
        """Called for two objects whose boxes overlap.

        Args:
            first: A CollisionObject.
            second: Another CollisionObject.

        Returns:
            Whether to stop.
        """
        raise NotImplementedError

    def done(self) -> None:
        """Called after a search."""

    def stop(self) -> bool:
        """Whether there is nothing more to find."""
        return False

    def _pair(self, first: Any, second: Any) -> int | None:
        """The index of the pair of two objects, if it is to be checked."""
        i, j = first.geometryObjectIndex, second.geometryObjectIndex
        k = len(self._model.collisionPairs) if i == j else self._model.findCollisionPair(CollisionPair(i, j))
        if k == len(self._model.collisionPairs) or not self._data.activeCollisionPairs[k]:
            return None
        objects = self._model.geometryObjects
        return None if objects[i].disableCollision or objects[j].disableCollision else k


class CollisionCallBackDefault(CollisionCallBackBase):
    """Asks coal about every pair whose boxes overlap; may stop at the first that touches."""

    def __init__(
        self, geometry_model: GeometryModel, geometry_data: GeometryData, stopAtFirstCollision: bool = False
    ) -> None:
        super().__init__(geometry_model, geometry_data)
        self.stopAtFirstCollision = stopAtFirstCollision
        """Whether to stop there."""
        self.collisionPairIndex = NO_INDEX
        """The last pair that was found to touch."""
        self.count = 0
        """How many pairs were looked at."""

    def init(self) -> None:
        """Called before a search: forgets what was found, unless it is to accumulate."""
        super().init()
        if not self.accumulate:
            self.count, self.collisionPairIndex = 0, NO_INDEX

    def collide(self, first: Any, second: Any) -> bool:
        """Asks coal about two objects.

        Args:
            first: A CollisionObject.
            second: Another CollisionObject.

        Returns:
            Whether to stop.
        """
        k = self._pair(first, second)
        if k is None:
            return False
        self.count += 1
        if computeCollision(self._model, self._data, k):
            self.collision, self.collisionPairIndex = True, k
        return self.stop()

    def stop(self) -> bool:
        """Whether a pair touches and that is enough."""
        return self.stopAtFirstCollision and self.collision


class CollisionCallBackCollect(CollisionCallBackBase):
    """Collects the pairs whose boxes overlap."""

    def __init__(self, geometry_model: GeometryModel, geometry_data: GeometryData) -> None:
        super().__init__(geometry_model, geometry_data)
        self.pair_indexes: StdVec[int] = StdVec()
        """The pairs whose boxes overlap."""

    def init(self) -> None:
        """Called before a search: forgets what was found, unless it is to accumulate."""
        super().init()
        if not self.accumulate:
            self.pair_indexes = StdVec()

    def collide(self, first: Any, second: Any) -> bool:
        """Records the pair.

        Args:
            first: A CollisionObject.
            second: Another CollisionObject.

        Returns:
            False.
        """
        k = self._pair(first, second)
        if k is not None:
            self.pair_indexes.append(k)
        return False
