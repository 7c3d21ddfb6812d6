"""Collisions, distances and patches of contact of pairs of geometries, asked of coal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pinocchio._arrays import StdVec, index
from pinocchio._geometry import GeometryData, GeometryModel, GeometryObject, updateGeometryPlacements
from pinocchio._parallel import GeometryPool
from ulna.collision.narrow import coal
from ulna.errors import InputError

if TYPE_CHECKING:
    from pinocchio._data import Data
    from pinocchio._model import Model

__all__ = [
    "ComputeCollision",
    "ComputeDistance",
    "computeBodyRadius",
    "computeCollision",
    "computeCollisions",
    "computeCollisionsInParallel",
    "computeContactPatch",
    "computeContactPatches",
    "computeDistance",
    "computeDistances",
]


class _OfTwo:
    """What coal is asked about two geometries."""

    def __init__(self, geometry_object1: GeometryObject, geometry_object2: GeometryObject) -> None:
        self._objects = geometry_object1, geometry_object2

    def getGeometryObject1(self) -> GeometryObject:
        """The first geometry."""
        return self._objects[0]

    def getGeometryObject2(self) -> GeometryObject:
        """The second geometry."""
        return self._objects[1]

    def run(self, tf1: Any, tf2: Any, request: Any, result: Any) -> Any:
        """Asks coal, the geometries being at two Transform3s; fills `result`."""
        raise NotImplementedError

    def __call__(self, tf1: Any, tf2: Any, request: Any, result: Any) -> Any:
        """See `run`."""
        return self.run(tf1, tf2, request, result)

    def _apart(self, tf1: Any, tf2: Any) -> tuple[Any, ...]:
        first, second = (g.geometry for g in self._objects)
        return first, tf1, second, tf2


class ComputeCollision(_OfTwo):
    """A function that asks coal whether two geometries touch; answers how many contacts there are."""

    def run(self, tf1: Any, tf2: Any, request: Any, result: Any) -> int:
        """Asks coal, the geometries being at two Transform3s; fills a CollisionResult."""
        result.clear()
        return int(coal().collide(*self._apart(tf1, tf2), request, result))


class ComputeDistance(_OfTwo):
    """A function that asks coal for the distance of two geometries [m]."""

    def run(self, tf1: Any, tf2: Any, request: Any, result: Any) -> float:
        """Asks coal, the geometries being at two Transform3s; fills a DistanceResult."""
        result.clear()
        return float(coal().distance(*self._apart(tf1, tf2), request, result))


def computeCollision(
    geometry_model: GeometryModel, geometry_data: GeometryData, pair_id: int, collision_request: Any = None
) -> bool:
    """Whether the geometries of a pair touch, where `geometry_data.oMg` has them.

    Raises:
        MissingExtra: coal is not installed. `ulna.Robot.collides` answers for a whole robot, batches included.
    """
    first, second = posed(geometry_model, geometry_data, pair_id)
    request = geometry_data.collisionRequests[pair_id] if collision_request is None else collision_request
    result = geometry_data.collisionResults[pair_id]
    result.clear()
    return bool(coal().collide(*first, *second, request, result))


def computeDistance(geometry_model: GeometryModel, geometry_data: GeometryData, pair_id: int) -> Any:
    """The distance of the geometries of a pair, as coal's DistanceResult; see `computeCollision`."""
    first, second = posed(geometry_model, geometry_data, pair_id)
    result = geometry_data.distanceResults[pair_id]
    result.clear()
    coal().distance(*first, *second, geometry_data.distanceRequests[pair_id], result)
    return result


def computeCollisions(*parts: Any) -> bool:
    """Whether any active pair touches.

    `(model, data, geometry_model, geometry_data, q, stop_at_first=False)`; without model, data and q placements stay as
    they are. A broad-phase manager may stand for the geometries, `(model, data, manager, [callback,] q,
    stop_at_first=False)` or `(manager, [callback, or stop_at_first=False])`: boxes are compared first.
    """
    from pinocchio._broadphase import BroadPhaseManager, by_manager

    if any(isinstance(part, BroadPhaseManager) for part in parts[:3]):
        return by_manager(*parts)
    geometry_model, geometry_data, rest = _placed(parts)
    hit = False
    for k in _checked(geometry_model, geometry_data):
        hit |= computeCollision(geometry_model, geometry_data, k)
        if hit and rest and rest[0]:
            break
    return hit


def computeDistances(*parts: Any) -> int:
    """The pair that is nearest of the active ones: `(model, data, geometry_model, geometry_data, q)`, or without q.

    With `(geometry_model, geometry_data)`, placements stay as they are. Without any pair it is their number.
    """
    geometry_model, geometry_data, _ = _placed(parts)
    found = {
        k: computeDistance(geometry_model, geometry_data, k).min_distance
        for k in _checked(geometry_model, geometry_data)
    }
    return min(found, key=found.__getitem__, default=len(geometry_model.collisionPairs))


def computeContactPatch(geometry_model: GeometryModel, geometry_data: GeometryData, pair_index: int) -> None:
    """Fills `geometry_data.contactPatchResults` for a pair that touches; after `computeCollisions`."""
    first, second = posed(geometry_model, geometry_data, pair_index)
    found, result = geometry_data.collisionResults[pair_index], geometry_data.contactPatchResults[pair_index]
    result.clear()
    if found.isCollision():
        coal().computeContactPatch(
            *first, *second, found, geometry_data.contactPatchRequests[pair_index], result
        )


def computeContactPatches(geometry_model: GeometryModel, geometry_data: GeometryData) -> None:
    """`computeContactPatch` of every active pair."""
    for k in _checked(geometry_model, geometry_data):
        computeContactPatch(geometry_model, geometry_data, k)


def computeBodyRadius(model: Model, geometry_model: GeometryModel, geometry_data: GeometryData) -> None:
    """Fills `geometry_data.radius`: how far the boxes around a joint's geometries reach from it [m]."""
    radius = [0.0] * model.njoints
    for g in geometry_model.geometryObjects:
        corners = g.placement.act(box_corners(g.geometry).T)
        radius[g.parentJoint] = max(radius[g.parentJoint], float(np.linalg.norm(corners, axis=0).max()))
    geometry_data.radius = StdVec(radius)


def box_corners(geometry: Any) -> Any:
    """The corners (8, 3) of the box around a geometry of coal, along the axes of its own frame [m]."""
    geometry.computeLocalAABB()
    ends = np.array([geometry.aabb_local.min_, geometry.aabb_local.max_]).reshape(2, 3)
    return np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def computeCollisionsInParallel(num_thread: int, *parts: Any) -> Any:
    """Collisions of one or many configurations.

    Args:
        num_thread: Not needed: coal answers Python one pair at a time. `ulna.Robot.collides` has kernels with threads.
        parts: What `computeCollisions` takes; or a pool, and configurations in the columns of a matrix (nq, n), which
            gives an array (n,) of answers; or a list of such matrices, which gives a list. Then whether to stop at the
            first collision of a configuration, and of all (the rest is said not to collide).
    """
    pool = parts[0]
    if not isinstance(pool, GeometryPool):
        return computeCollisions(*parts)
    if len(parts) < 2:
        raise InputError(
            "computeCollisionsInParallel needs configurations, in the columns of a matrix (nq, n)."
        )
    if isinstance(parts[1], (list, tuple)):
        stop = bool(parts[2]) if len(parts) > 2 else False
        return StdVec(_each(pool, columns, True, stop) for columns in parts[1])
    stops = [*(bool(p) for p in parts[2:]), False, False]
    return _each(pool, parts[1], stops[0], stops[1])


def _each(pool: GeometryPool, columns: Any, stop_in_configuration: bool, stop_in_batch: bool) -> Any:
    given = np.asarray(columns, dtype=float)
    if given.ndim != 2 or given.shape[0] != pool.getModel(0).nq:
        raise InputError(f"Configurations have shape {given.shape}; expected ({pool.getModel(0).nq}, n).")
    hit = np.zeros(given.shape[1], dtype=bool)
    for k, q in enumerate(given.T):
        hit[k] = computeCollisions(*pool.asked(), q, stop_in_configuration)
        if hit[k] and stop_in_batch:
            break
    return hit


def _placed(parts: Any) -> tuple[GeometryModel, GeometryData, tuple[Any, ...]]:
    if isinstance(parts[0], GeometryModel):
        return parts[0], parts[1], parts[2:]
    model: Model = parts[0]
    data: Data = parts[1]
    updateGeometryPlacements(model, data, parts[2], parts[3], parts[4] if len(parts) > 4 else None)
    return parts[2], parts[3], parts[5:]


def _checked(geometry_model: GeometryModel, geometry_data: GeometryData) -> list[int]:
    objects, pairs = geometry_model.geometryObjects, geometry_model.collisionPairs
    return [
        k
        for k, active in enumerate(geometry_data.activeCollisionPairs)
        if active and not any(objects[i].disableCollision for i in pairs[k])
    ]


def posed(geometry_model: GeometryModel, geometry_data: GeometryData, pair_id: int) -> list[tuple[Any, Any]]:
    """The two geometries of a pair, each with its Transform3s."""
    count = len(geometry_data.activeCollisionPairs)
    pair = geometry_model.collisionPairs[
        index(pair_id, count, "collision pair", "Make new data after adding pairs.")
    ]
    out = []
    for i in pair:
        M = geometry_data.oMg[i]
        out.append(
            (geometry_model.geometryObjects[i].geometry, coal().Transform3s(M.rotation, M.translation))
        )
    return out
