"""Collisions, distances and patches of contact of pairs of geometries, asked of coal."""

from __future__ import annotations

import abc
from typing import TYPE_CHECKING, Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError, check_size, is_flag
from pinocchio._containers.arrays import StdVec, index, numbers
from pinocchio._containers.keywords import by_name
from pinocchio._geometry.collision_pair import CollisionPair
from pinocchio._geometry.geometry_data import GeometryData
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._geometry.geometry_pool import GeometryPool
from pinocchio._geometry.pair_calls import calls_of
from pinocchio._geometry.placements import check_geometries, updateGeometryPlacements
from ulna.collision.narrow import coal
from ulna.errors import InputError

if TYPE_CHECKING:
    from pinocchio._data.data import Data
    from pinocchio._model.model import Model


class CollisionManager(abc.ABC):
    """What `computeCollisions` takes in place of geometries: a broad phase."""

    @abc.abstractmethod
    def compute_collisions(self, *parts: Any) -> bool:
        """`computeCollisions` with this manager among its arguments."""


def computeCollision(
    geometry_model: GeometryModel, geometry_data: GeometryData, pair_index: int, collision_request: Any = None
) -> bool:
    """Whether the geometries of a pair touch.

    Args:
        geometry_model: The geometries and pairs.
        geometry_data: Their data, after updateGeometryPlacements.
        collision_request: Options of coal; those of `geometry_data` by default.

    Returns:
        Whether they do.

    Raises:
        MissingExtra: coal is not installed. `ulna.Robot.collides` answers for a whole robot, batches included.
    """
    return bool(_answer(geometry_model, geometry_data, "collision", pair_index, collision_request))


def computeDistance(geometry_model: GeometryModel, geometry_data: GeometryData, pair_index: int) -> Any:
    """The distance of the geometries of a pair; see `computeCollision`.

    Args:
        geometry_model: The geometries and pairs.
        geometry_data: Their data, after updateGeometryPlacements.

    Returns:
        Coal's DistanceResult.
    """
    _answer(geometry_model, geometry_data, "distance", pair_index)
    return geometry_data.distanceResults[pair_index]


def _answer(
    geometry_model: GeometryModel, geometry_data: GeometryData, what: str, pair_id: int, request: Any = None
) -> Any:
    """What coal answers about a pair."""
    objects, pair = geometry_model.geometryObjects, _pair(geometry_model, geometry_data, pair_id)
    at = geometry_data._placed(pair)
    functions, requests, results = (
        getattr(geometry_data, name) for name in (f"{what}_functors", f"{what}Requests", f"{what}Results")
    )
    i, j = pair.first, pair.second
    one, two = functions[pair_id].of
    if one is not objects[i] or two is not objects[j]:
        functions[pair_id] = type(functions[pair_id])(objects[i], objects[j])
    query = requests[pair_id] if request is None else request
    return functions[pair_id].run(at[i], at[j], query, results[pair_id])


def _answers(
    geometry_model: GeometryModel, geometry_data: GeometryData, what: str, stop: bool = False
) -> tuple[list[int], list[Any]]:
    """The active pairs, and what coal answers about them; `stop` ends after the first answer above zero."""
    chosen, at = _checked(geometry_model, geometry_data), list(geometry_data._placed())
    known = calls_of(geometry_model, f"Compute{what.capitalize()}")
    calls, first, second = known.of(chosen), known.first, known.second
    requests, results = (list(getattr(geometry_data, f"{what}{name}")) for name in ("Requests", "Results"))
    answers = []
    for k in chosen:
        result = results[k]
        result.clear()
        answers.append(calls[k](at[first[k]], at[second[k]], requests[k], result))
        if stop and answers[-1] > 0:
            break
    return chosen, answers


@by_name(
    "geometry_model geometry_data stop_at_first_collision",
    "model data geometry_model geometry_data q stop_at_first_collision",
    "broadphase_manager callback",
    "broadphase_manager stop_at_first_collision",
    "manager callback",
    "manager stop_at_first_collision",
    "model data broadphase_manager q stop_at_first_collision",
    "model data broadphase_manager callback q",
)
def computeCollisions(*parts: Any) -> bool:
    """Whether any active pair touches.

    `(model, data, geometry_model, geometry_data, q, stop_at_first=False)`; without model, data and q placements stay as
    they are. A broad-phase manager may stand for the geometries, `(model, data, manager, [callback,] q,
    stop_at_first=False)` or `(manager, [callback, or stop_at_first=False])`: boxes are compared first.
    """
    manager = next((part for part in parts[:3] if isinstance(part, CollisionManager)), None)
    if manager is not None:
        return manager.compute_collisions(*parts)
    geometry_model, geometry_data, rest = _placed(parts)
    if len(rest) > 1:
        raise ArgumentError(
            f"computeCollisions was given {rest[1:]!r} after stop_at_first; nothing more is expected."
        )
    stop = bool(rest) and _flag("computeCollisions", "stop_at_first_collision", rest[0])
    _, contacts = _answers(geometry_model, geometry_data, "collision", stop)
    return any(contacts)


@by_name("geometry_model geometry_data", "model data geometry_model geometry_data q")
def computeDistances(*parts: Any) -> int:
    """The pair that is nearest of the active ones: `(model, data, geometry_model, geometry_data, q)`, or without q.

    With `(geometry_model, geometry_data)`, placements stay as they are. Without any pair it is their number.
    """
    geometry_model, geometry_data, rest = _placed(parts)
    if rest:
        raise ArgumentError(
            f"computeDistances was given {rest!r} after the configuration or the data; nothing more is expected."
        )
    pairs, distances = _answers(geometry_model, geometry_data, "distance")
    return pairs[distances.index(min(distances))] if pairs else len(geometry_model.collisionPairs)


def computeContactPatch(geometry_model: GeometryModel, geometry_data: GeometryData, pair_index: int) -> None:
    """Fills `geometry_data.contactPatchResults` for a pair that touches; after `computeCollisions`.

    Args:
        geometry_data: Their data, after updateGeometryPlacements.
    """
    i, j = _pair(geometry_model, geometry_data, pair_index)
    at, objects = geometry_data._placed((i, j)), geometry_model.geometryObjects
    collision, result = (
        geometry_data.collisionResults[pair_index],
        geometry_data.contactPatchResults[pair_index],
    )
    result.clear()
    if collision.isCollision():
        request = geometry_data.contactPatchRequests[pair_index]
        coal().computeContactPatch(
            objects[i].geometry, at[i], objects[j].geometry, at[j], collision, request, result
        )


def computeContactPatches(geometry_model: GeometryModel, geometry_data: GeometryData) -> None:
    """Computes the contact patch of every active pair; see `computeContactPatch`.

    Args:
        geometry_model: The geometries and pairs.
        geometry_data: Their data, after updateGeometryPlacements.
    """
    for k in _checked(geometry_model, geometry_data):
        computeContactPatch(geometry_model, geometry_data, k)


def computeBodyRadius(model: Model, geometry_model: GeometryModel, geometry_data: GeometryData) -> None:
    """Fills `geometry_data.radius`: how far the boxes of each joint's geometries reach from its origin [m].

    Args:
        geometry_model: The geometries and pairs.
        geometry_data: Their data, which is filled.

    Raises:
        InputError: A geometry is on a joint that the model has not.
    """
    radius = [0.0] * model.njoints
    for g in geometry_model.geometryObjects:
        if not 0 <= g.parentJoint < model.njoints:
            raise InputError(
                f"The geometry {g.name!r} is on joint {g.parentJoint}; the model has {model.njoints} joints. "
                "Pass the model of the geometries."
            )
        corners = g.placement._pose() @ box_corners(g.geometry)
        radius[g.parentJoint] = max(radius[g.parentJoint], float(np.linalg.norm(corners, axis=1).max()))
    geometry_data.radius = StdVec(radius)


def box_corners(geometry: Any) -> Any:
    """The corners (8, 3) of the box around a geometry of coal, along the axes of its frame [m]."""
    geometry.computeLocalAABB()
    ends = np.array([geometry.aabb_local.min_, geometry.aabb_local.max_]).reshape(2, 3)
    return np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


@by_name(
    "num_thread geometry_model geometry_data stop_at_first_collision",
    "num_thread model data geometry_model geometry_data q stop_at_first_collision",
    "num_thread pool q stop_at_first_collision_in_configuration stop_at_first_collision_in_batch",
    "num_thread pool trajectories stop_at_first_collision_in_trajectory",
)
def computeCollisionsInParallel(num_thread: int, *parts: Any) -> Any:
    """Collisions of one or many configurations.

    Args:
        num_thread: Not needed: coal answers Python one pair at a time. `ulna.Robot.collides` has kernels with
            threads.
        *parts: What `computeCollisions` takes; or a pool, and configurations in the columns of a matrix (nq, n), which
            gives an array (n,) of answers; or a list of such matrices, which gives a list. Then whether to stop at the
            first collision of a configuration, and of all (the rest is said not to collide).

    Returns:
        Whether there is a collision, or an array (n,), or a list of arrays.

    Raises:
        InputError: A pool without configurations; or `num_thread` is below zero.
        ArgumentError: There are no arguments, or more than these, or one of the last is no flag.
    """
    check_size(num_thread, "num_thread")
    if not parts:
        raise ArgumentError("computeCollisionsInParallel needs a pool, or what computeCollisions takes.")
    pool = parts[0]
    if not isinstance(pool, GeometryPool):
        return computeCollisions(*parts)
    if len(parts) < 2:
        raise InputError(
            "computeCollisionsInParallel needs configurations, in the columns of a matrix (nq, n)."
        )
    of_trajectories = isinstance(parts[1], (list, tuple))
    names = ("trajectory",) if of_trajectories else ("configuration", "batch")
    flags = parts[2:]
    if len(flags) > len(names):
        raise ArgumentError(
            f"computeCollisionsInParallel was given {flags[len(names) :]!r} after all its arguments."
        )
    stops = [
        _flag("computeCollisionsInParallel", f"stop_at_first_collision_in_{name}", value)
        for name, value in zip(names, flags, strict=False)
    ]
    stops += [False] * (len(names) - len(stops))
    if of_trajectories:
        return StdVec(_each(pool, columns, True, stops[0]) for columns in parts[1])
    return _each(pool, parts[1], stops[0], stops[1])


def _flag(function: str, name: str, value: Any) -> bool:
    if not is_flag(value):
        raise ArgumentError(f"{function}: `{name}` is {value!r}; expected True or False.")
    return bool(value)


def _each(pool: GeometryPool, columns: Any, stop_in_configuration: bool, stop_in_batch: bool) -> Any:
    configurations = numbers(columns, "q")
    if configurations.ndim == 1:  # one column
        configurations = configurations[:, None]
    if configurations.ndim != 2 or configurations.shape[0] != pool.getModel(0).nq:
        raise ArgumentError(
            f"Configurations have shape {configurations.shape}; expected ({pool.getModel(0).nq}, n)."
        )
    hit = np.zeros(configurations.shape[1], dtype=bool)
    for k, q in enumerate(configurations.T):
        hit[k] = computeCollisions(*pool.collision_arguments(), q, stop_in_configuration)
        if hit[k] and stop_in_batch:
            break
    return hit


def _placed(parts: Any) -> tuple[GeometryModel, GeometryData, tuple[Any, ...]]:
    if len(parts) >= 2 and isinstance(parts[0], GeometryModel) and isinstance(parts[1], GeometryData):
        return parts[0], parts[1], parts[2:]
    kinds = [type(part).__name__ for part in parts]
    if len(parts) < 5 or kinds[:4] != ["Model", "Data", "GeometryModel", "GeometryData"]:
        raise ArgumentError(
            f"Expected (geometry_model, geometry_data), or (model, data, geometry_model, geometry_data, q), before "
            f"anything else; got ({', '.join(kinds)})."
        )
    model: Model = parts[0]
    data: Data = parts[1]
    if parts[4] is None:
        raise ArgumentError("`q` is None; expected a configuration (nq,).")
    updateGeometryPlacements(model, data, parts[2], parts[3], parts[4])
    return parts[2], parts[3], parts[5:]


def _checked(geometry_model: GeometryModel, geometry_data: GeometryData) -> list[int]:
    objects, pairs = geometry_model.geometryObjects, geometry_model.collisionPairs
    check_geometries(geometry_model, geometry_data)
    if len(pairs) != len(geometry_data.activeCollisionPairs):
        raise InputError(
            f"This GeometryData was made for {len(geometry_data.activeCollisionPairs)} pairs; now there are "
            f"{len(pairs)}. Make a new one: geometry_model.createData()."
        )
    left_out = {i for i, g in enumerate(objects) if g.disableCollision}
    active = [k for k, is_active in enumerate(geometry_data.activeCollisionPairs) if is_active]
    return [k for k in active if left_out.isdisjoint(pairs[k])] if left_out else active


def _pair(geometry_model: GeometryModel, geometry_data: GeometryData, pair_index: int) -> CollisionPair:
    check_geometries(geometry_model, geometry_data)
    count = min(len(geometry_data.activeCollisionPairs), len(geometry_model.collisionPairs))
    k = index(pair_index, count, "collision pair", "Make new data after adding pairs.")
    return geometry_model.collisionPairs[k]
