"""GeometryData: where geometries are, and what coal found about pairs of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, ClassVar, NamedTuple, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError, is_flag, is_index
from pinocchio._containers.arrays import StdVec, alike, index, not_applicable, views
from pinocchio._containers.attributes import (
    AttributeKind,
    CheckedAttributes,
    assigned_entries,
    computed,
    list_of,
)
from pinocchio._containers.files import Saved, register
from pinocchio._geometry.geometry_collection import GeometryCollection, pair_map
from pinocchio._geometry.geometry_object import GeometryObject
from pinocchio._geometry.pair_functors import ComputeCollision, ComputeDistance
from pinocchio._spatial.se3 import SE3
from ulna.compiler.runtime.repeated_calls import forget
from ulna.errors import InputError, excerpt


class Placing(NamedTuple):
    """What places geometries without looking at them again.

    Attributes:
        objects: The geometries.
        oMi: The placements of joints (n, 4, 4).
        call: The bound kernel; it answers NotImplemented where a geometry was changed.
    """

    objects: Any = None
    oMi: Any = None
    call: Callable[[], Any] = not_applicable


class FlagList(StdVec[bool]):
    """For each pair whether it is checked."""

    def _checked(self, entry: Any) -> bool:
        if not (is_flag(entry) or is_index(entry)):
            raise ArgumentError(f"A list of flags was given {excerpt(repr(entry))}; expected True or False.")
        return bool(entry)


FlagList.__name__ = "StdVec_Bool"  # as scripts see it


@final
class GeometryData(CheckedAttributes, Saved):
    """Where the geometries are, and what was found about pairs of them: `geometry_model.createData()`.

    Requests and results are objects of coal, created when they are read.
    """

    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        "oMg": assigned_entries(SE3, "a list of SE3, one for each geometry"),
        "activeCollisionPairs": list_of(
            (bool, np.bool_), "a list of True or False, one for each pair", FlagList
        ),
        "radius": list_of((float, int), "a list of numbers"),
        **dict.fromkeys(("collisionRequests", "distanceRequests", "contactPatchRequests"), computed),
        **dict.fromkeys(("collisionResults", "distanceResults", "contactPatchResults"), computed),
        **dict.fromkeys(("collision_functors", "distance_functors", "contact_patch_functors"), computed),
    }
    _placing = Placing()
    oMg: StdVec[SE3]
    """Where each geometry is in the world, live references."""

    def __init__(self, geometry_model: GeometryCollection) -> None:
        self._block = np.tile(np.eye(4), (geometry_model.ngeoms, 1, 1))
        self._keep(oMg=views(SE3, self._block))
        pairs = geometry_model.collisionPairs
        self._objects = geometry_model.geometryObjects
        self._pairs = StdVec(pairs)
        self.activeCollisionPairs: StdVec[bool] = FlagList([True] * len(pairs))
        """Whether each pair is checked."""
        self.radius: StdVec[float] = StdVec()
        """For each joint, how far its geometries reach from it [m]; after `computeBodyRadius`."""
        self._of_coal: dict[str, StdVec[Any]] = {}

    def _made(self, name: str, make: Callable[[Any, int], Any]) -> StdVec[Any]:
        if name not in self._of_coal:
            from ulna.collision.narrow import coal

            package = coal()
            self._of_coal[name] = StdVec([make(package, k) for k in range(len(self._pairs))])
        return self._of_coal[name]

    def _requests(self, kind: str) -> StdVec[Any]:
        """Requests whose search begins where the last one ended."""
        name = f"{kind[0].lower()}{kind[1:]}s"
        if name not in self._of_coal:
            from ulna.collision.narrow import coal

            make, guess = getattr(coal(), kind), coal().GJKInitialGuess.CachedGuess
            self._of_coal[name] = StdVec([make() for _ in self._pairs])
            for request in self._of_coal[name]:
                request.gjk_initial_guess = guess
        return self._of_coal[name]

    @property
    def collisionRequests(self) -> StdVec[Any]:
        """For each pair what coal is asked about collisions; `security_margin` widens the pair [m]."""
        return self._requests("CollisionRequest")

    @property
    def distanceRequests(self) -> StdVec[Any]:
        """For each pair what coal is asked about distances."""
        return self._requests("DistanceRequest")

    @property
    def contactPatchRequests(self) -> StdVec[Any]:
        """For each pair what coal is asked about patches of contact."""
        return self._made("contactPatchRequests", lambda c, k: c.ContactPatchRequest())

    @property
    def collisionResults(self) -> StdVec[Any]:
        """What coal found about each pair that was checked."""
        return self._made("collisionResults", lambda c, k: c.CollisionResult())

    @property
    def distanceResults(self) -> StdVec[Any]:
        """The distance of each pair that was measured, as coal has it."""
        return self._made("distanceResults", lambda c, k: c.DistanceResult())

    @property
    def contactPatchResults(self) -> StdVec[Any]:
        """The patch of contact of each pair that was asked about."""
        return self._made("contactPatchResults", lambda c, k: c.ContactPatchResult())

    @property
    def collision_functors(self) -> StdVec[Any]:
        """For each pair a function that asks coal whether it touches."""
        return self._made("collision_functors", lambda c, k: ComputeCollision(*self._two(k)))

    @property
    def distance_functors(self) -> StdVec[Any]:
        """For each pair a function that asks coal for its distance."""
        return self._made("distance_functors", lambda c, k: ComputeDistance(*self._two(k)))

    def _placed(self, geometries: Iterable[int] | None = None) -> StdVec[Any]:
        """coal's transforms, those of all or of some geometries moved to where `oMg` has them now."""
        if "transforms" not in self._of_coal:
            from ulna.collision.narrow import coal

            self._of_coal["transforms"] = StdVec(coal().Transform3s() for _ in self.oMg)
        transforms = self._of_coal["transforms"]
        for i in range(len(transforms)) if geometries is None else geometries:
            transforms[i].setTransform(self._block[i, :3, :3], self._block[i, :3, 3])
        return transforms

    def _two(self, pair_id: int) -> list[GeometryObject]:
        return [self._objects[i] for i in self._pairs[pair_id]]

    def activateCollisionPair(self, pair_id: int) -> None:
        """Has a pair checked."""
        self.activeCollisionPairs[self._pair(pair_id)] = True

    def deactivateCollisionPair(self, pair_id: int) -> None:
        """Has a pair not checked."""
        self.activeCollisionPairs[self._pair(pair_id)] = False

    def activateAllCollisionPairs(self) -> None:
        """Has every pair checked."""
        self.activeCollisionPairs = FlagList([True] * len(self._pairs))

    def deactivateAllCollisionPairs(self) -> None:
        """Has no pair checked."""
        self.activeCollisionPairs = FlagList([False] * len(self._pairs))

    def fillInnerOuterObjectMaps(self, geometry_model: GeometryCollection) -> None:
        """Does nothing: the geometries of each joint are looked up in the model when they are needed.

        Raises:
            InputError: The geometries are not those that this data was made for.
        """
        if geometry_model.ngeoms != len(self.oMg):
            raise InputError(
                f"This GeometryData was made for {len(self.oMg)} geometries; the model has {geometry_model.ngeoms}. "
                "Make a new one: data = geometry_model.createData()."
            )

    def setActiveCollisionPairs(
        self, geometry_model: GeometryCollection, collision_map: Any, upper: bool = True
    ) -> None:
        """Sets which pairs are checked, by a matrix.

        Args:
            collision_map: Truth values (n, n) for n geometries.
            upper: Whether entries above the diagonal count, else those below it.
        """
        marks = pair_map(geometry_model, collision_map, upper)
        self.activeCollisionPairs = FlagList(bool(marks[min(p), max(p)]) for p in self._pairs)

    def setGeometryCollisionStatus(
        self, geom_model: GeometryCollection, geom_id: int, enable_collision: bool
    ) -> None:
        """Sets whether all pairs of a geometry are checked.

        Args:
            geom_model: The geometries.
            geom_id: Index of the geometry.
            enable_collision: Whether they are.
        """
        index(geom_id, geom_model.ngeoms, "geometry", "getGeometryId(name) returns one.")
        for k, pair in enumerate(self._pairs):
            if geom_id in pair:
                self.activeCollisionPairs[k] = bool(enable_collision)

    def setSecurityMargins(
        self,
        geometry_model: GeometryCollection,
        security_margin_map: Any,
        upper: bool = True,
        sync_distance_upper_bound: bool = True,
    ) -> None:
        """Sets the distances at which pairs count as touching.

        Args:
            security_margin_map: Distances (n, n) for n geometries [m].
            upper: Whether entries above the diagonal count, else those below it.
            sync_distance_upper_bound: Whether distances beyond it are not computed.
        """
        margins = pair_map(geometry_model, security_margin_map, upper, float)
        for request, pair in zip(self.collisionRequests, self._pairs, strict=True):
            request.security_margin = float(margins[min(pair), max(pair)])
            if sync_distance_upper_bound:
                request.distance_upper_bound = request.security_margin

    def copy(self) -> GeometryData:
        """A copy with the same placements and active pairs, and new requests and results."""
        out = object.__new__(GeometryData)
        out.__setstate__(self.__getstate__())
        return out

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> GeometryData:
        return self.copy()

    def __getstate__(self) -> dict[str, Any]:
        state = {"_block": self._block.copy(), "_objects": self._objects, "_pairs": StdVec(self._pairs)}
        return state | {
            "activeCollisionPairs": FlagList(self.activeCollisionPairs),
            "radius": StdVec(self.radius),
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        forget(self)  # kernels that are bound to the array before
        self.__dict__.pop("_placing", None)
        self.__dict__.update(state)
        self._keep(oMg=views(SE3, self._block))
        self._of_coal = {}

    def _pair(self, pair_id: int) -> int:
        return index(pair_id, len(self._pairs), "collision pair", "Make new data after adding pairs.")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryData):
            return NotImplemented
        same = np.array_equal(self._block, other._block)
        return same and alike(self.activeCollisionPairs, other.activeCollisionPairs)

    __hash__ = object.__hash__

    def __str__(self) -> str:
        states = ("inactive", "active")
        pairs = "".join(f"Pairs {k} {states[active]}\n" for k, active in enumerate(self.activeCollisionPairs))
        head = f"Number of collision pairs = {len(self._pairs)}\n"
        return f"{head}{pairs}Number of geometry objects = {len(self.oMg)}\n"

    def __repr__(self) -> str:
        return f"<places of {len(self.oMg)} geometries, results of {len(self._pairs)} pairs>"


register(GeometryData)
