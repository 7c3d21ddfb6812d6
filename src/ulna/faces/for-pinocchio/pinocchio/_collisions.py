"""Collisions and distances of pairs of geometries, asked of coal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pinocchio._arrays import index
from pinocchio._geometry import GeometryData, GeometryModel, updateGeometryPlacements
from ulna.collision.narrow import coal

if TYPE_CHECKING:
    from pinocchio._data import Data
    from pinocchio._model import Model


def computeCollision(geometry_model: GeometryModel, geometry_data: GeometryData, pair_id: int) -> bool:
    """Whether the geometries of a pair touch, where `geometry_data.oMg` has them.

    Raises:
        MissingExtra: coal is not installed. `ulna.Robot.collides` answers for a whole robot, batches included.
    """
    c, result = coal(), coal().CollisionResult()
    hit = bool(c.collide(*_posed(geometry_model, geometry_data, pair_id), c.CollisionRequest(), result))
    geometry_data.collisionResults[pair_id] = result
    return hit


def computeDistance(geometry_model: GeometryModel, geometry_data: GeometryData, pair_id: int) -> Any:
    """The distance of the geometries of a pair, as coal's DistanceResult; see `computeCollision`."""
    c, result = coal(), coal().DistanceResult()
    request = c.DistanceRequest()
    c.distance(*_posed(geometry_model, geometry_data, pair_id), request, result)
    geometry_data.distanceResults[pair_id] = result
    return result


def computeCollisions(*parts: Any) -> bool:
    """Whether any active pair touches: `(model, data, geometry_model, geometry_data, q, stop_at_first=False)`.

    Without model, data and q, `(geometry_model, geometry_data, stop_at_first=False)`, placements stay as they are.
    """
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


def _posed(geometry_model: GeometryModel, geometry_data: GeometryData, pair_id: int) -> tuple[Any, ...]:
    count = len(geometry_data.activeCollisionPairs)
    pair = geometry_model.collisionPairs[
        index(pair_id, count, "collision pair", "Make new data after adding pairs.")
    ]
    out: list[Any] = []
    for i in pair:
        M = geometry_data.oMg[i]
        out += [geometry_model.geometryObjects[i].geometry, coal().Transform3s(M.rotation, M.translation)]
    return tuple(out)
