"""Exact collision checks and distances of a robot, against itself and a world, through coal.

A compiled kernel places every solid of a batch, boxes around them show which pairs can touch, and coal computes only
those. Pairs are ruled out by lower bounds alone, so that the answers are those of asking coal for every pair.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from typing import Any, final

import numpy as np

from ulna import kernels
from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import flag
from ulna.collision import deferred, narrow
from ulna.collision.attached import attached_solids
from ulna.collision.broad_phase import BroadPhase
from ulna.collision.mask import pair_margins, pair_mask
from ulna.collision.narrow import Narrow, NearestPoints, PosedSolids, Poses
from ulna.collision.pairs import LinkPair, checked_pairs, link_pairs
from ulna.collision.result import Distance, Proximity
from ulna.collision.solids import Missing, Solid, link_solids, obstacle_solids
from ulna.collision.world import World
from ulna.errors import InputError, ShapeError
from ulna.model import Model
from ulna.model.of_robot import model_of
from ulna.system import forks
from ulna.typing import Array, ArrayLike, Floats


@final
class Checker(FixedAttributes):
    """Collision checks of one robot, in one world, through coal.

    It keeps coal's objects between calls; a lock lets one thread in at a time. For more threads make more checkers.

    Args:
        model: The Model, or its Robot.
        world: Its obstacles; None for none.
        pairs: Pairs of links to check against each other; None for `link_pairs(model)`, () for none.
        without: Pairs of links, obstacles and attached objects to leave out.
        convex: Whether meshes are taken by their convex hulls; faster, and larger.
        missing: What to do about a mesh file that is not there: "error", or "skip" it with a warning.

    Raises:
        InputError: If `model` is neither.
        MissingExtra: If coal is not installed.
        ModelError: If the robot has no collision geometry, or a mesh is missing.
        UnknownName: If a pair names no link.
    """

    model: Model
    world: World
    solids: tuple[Solid, ...]
    """The solids of the links, then those of attached objects, then those of the obstacles."""
    pairs: tuple[LinkPair, ...]
    mask: Array
    """Which solids that move with the robot are checked against which of all, (n links and attached, n)."""
    lock: Any

    def __init__(
        self,
        model: Model | Any,
        world: World | None = None,
        *,
        pairs: Iterable[LinkPair] | None = None,
        without: Iterable[LinkPair] = (),
        convex: bool = False,
        missing: Missing = "error",
    ) -> None:
        narrow.coal()
        flag("convex", convex)
        model = model_of(model, "model")
        pairs, without = pairs if pairs is None else tuple(pairs), tuple(without)
        self._options = {"pairs": pairs, "without": without, "convex": convex, "missing": missing}
        self.model, self.world = model, World() if world is None else world
        links, obstacles = link_solids(model, missing), obstacle_solids(self.world, missing)
        attached = attached_solids(model, self.world, missing)
        self.solids, count = (*links, *attached, *obstacles), len(links) + len(attached)
        self.pairs = _link_pairs(model, self.world, pairs, without)
        self.mask = pair_mask(model, self.world, self.solids, count, self.pairs, without)
        rounding = np.array([solid.rounding for solid in self.solids])
        margins = pair_margins(self.world, self.solids, count) + rounding[:count, None] + rounding
        self._broad = BroadPhase(model, self.world, links, attached, obstacles, self.mask, margins)
        self._narrow = Narrow([narrow.geometry_of(s, convex) for s in self.solids], margins)
        self._carriers = {item.name: item.link for item in self.world.attachments}
        self._jacobians: dict[str, Any] = {}
        self.lock = forks.lock()

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(Checker, **self._options), (self.model, self.world)

    # questions ---------------------------------------------------------------------------------------------

    def collides(
        self,
        q: ArrayLike,
        moving: Mapping[str, ArrayLike] | None = None,
        *,
        margin: float = 0.0,
        broad_phase: bool = True,
    ) -> Any:
        """Whether anything touches.

        Args:
            q: Configuration, shape (..., nq) [rad, m].
            moving: Poses of moving obstacles by name, T_world_shape, shape (..., 4, 4) [m].
            margin: Shapes that come as near as this count as touching [m]; negative lets them overlap that deep.
            broad_phase: Whether boxes rule out pairs before coal checks them.

        Returns:
            Truth values, shape (...).

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` or a pose cannot be one.
            UnknownName: If `moving` names no obstacle.
        """
        margin, broad_phase = _number("margin", margin), flag("broad_phase", broad_phase)
        if deferred.is_lazy_question(q, moving):
            options = {"margin": margin, "broad_phase": broad_phase}
            return deferred.ask(self, "collides", np.bool_, q, moving, options)
        with self.lock:
            batch, chunks = self._broad.chunks(q, moving)
            out = np.zeros(int(np.prod(batch)), dtype=bool)
            for start, poses in chunks:
                near = self._broad.near(poses, margin) if broad_phase else self._broad.all_pairs(poses)
                self._touch(poses, near, margin, out[start:])
        return out.reshape(batch) if batch else bool(out[0])

    def distance(
        self,
        q: ArrayLike,
        moving: Mapping[str, ArrayLike] | None = None,
        *,
        stop_below: float | None = None,
        broad_phase: bool = True,
    ) -> Distance:
        """The least signed distance of all pairs, with witness points, normal and names; see `Distance`.

        Args:
            q: Configuration, shape (..., nq) [rad, m].
            moving: Poses of moving obstacles by name, T_world_shape, shape (..., 4, 4) [m].
            stop_below: The first pair this near ends the search [m]; there may be nearer ones then.
            broad_phase: Whether boxes rule out pairs before coal checks them.

        Returns:
            The distances, with their batch shape.
        """
        flag("broad_phase", broad_phase)
        if deferred.is_lazy_question(q, moving):
            options = {"stop_below": stop_below, "broad_phase": broad_phase}
            return deferred.distances(self, q, moving, options)
        enough = -np.inf if stop_below is None else _number("stop_below", stop_below)
        with self.lock:
            batch, chunks = self._broad.chunks(q, moving)
            nearest = [
                self._nearest(poses, row, bounds, enough)
                for _, poses in chunks
                for row, bounds in enumerate(np.moveaxis(self._broad.bounds(poses, broad_phase), -1, 0))
            ]
        return Distance.of([self._proximity(item) for item in nearest], batch)

    @property
    def owners(self) -> tuple[tuple[str, str], ...]:
        """Every two owners of solids that are checked: two links, or a link and an obstacle."""
        names = [solid.owner for solid in self.solids]
        return tuple(dict.fromkeys((names[i], names[j]) for i, j in np.argwhere(self.mask)))

    def touching(
        self, q: ArrayLike, moving: Mapping[str, ArrayLike] | None = None, *, margin: float = 0.0
    ) -> Array:
        """Which of `owners` touch.

        Args:
            q: Configuration, shape (..., nq) [rad, m].
            moving: Poses of moving obstacles by name, T_world_shape, shape (..., 4, 4) [m].
            margin: Shapes that come as near as this count as touching [m]; negative lets them overlap that deep.

        Returns:
            Truth values, shape (..., n) with one entry for each of `owners`.
        """
        margin = _number("margin", margin)
        column = {pair: k for k, pair in enumerate(self.owners)}
        with self.lock:
            batch, chunks = self._broad.chunks(q, moving)
            out = np.zeros((int(np.prod(batch)), len(column)), dtype=bool)
            ask = self._narrow.collision(margin)
            for start, poses in chunks:
                for i, j, row in np.argwhere(self._broad.near(poses, margin)).tolist():
                    k = column[self.solids[i].owner, self.solids[j].owner]
                    if not out[start + row, k]:
                        out[start + row, k] = ask(poses, row, i, j)
        return out.reshape(*batch, len(column))

    def nearest(
        self,
        q: ArrayLike,
        moving: Mapping[str, ArrayLike] | None = None,
        *,
        within: float = np.inf,
    ) -> tuple[Proximity, ...]:
        """Every two owners of solids that are near each other at one configuration, nearest first.

        Two links, or a link and an obstacle, appear once, at their nearest solids, with the gradient of their
        distance: the rows that dampers of a controller need.

        Args:
            q: Configuration, shape (nq,) [rad, m].
            moving: Poses of moving obstacles by name, T_world_shape, shape (4, 4) [m].
            within: Only those nearer than this [m].

        Returns:
            One proximity a pair.

        Raises:
            ShapeError: `q` is a batch.
        """
        if np.ndim(q) != 1:
            raise ShapeError("q", np.shape(q), f"({self.model.nq},)", "Ask for one configuration at a time.")
        best: dict[tuple[str, str], NearestPoints] = {}
        with self.lock:
            _, chunks = self._broad.chunks(q, moving)
            for _, poses in chunks:
                bounds = self._broad.bounds(poses, True)[..., 0]
                for i, j in zip(*np.nonzero((bounds < np.inf) & (bounds <= within)), strict=True):
                    key = self.solids[i].owner, self.solids[j].owner
                    if key in best and bounds[i, j] >= best[key].distance:
                        continue
                    item = self._narrow.distance(poses, 0, int(i), int(j))
                    if item.distance <= within and (key not in best or item.distance < best[key].distance):
                        best[key] = item
        ordered = sorted(best.values(), key=lambda item: item.distance)
        return tuple(self._proximity(item, np.asarray(q, dtype=float)) for item in ordered)

    def gradient(self, q: ArrayLike, moving: Mapping[str, ArrayLike] | None = None) -> Floats:
        """The gradient of the least distance by the configuration's tangent.

        Where two pairs are equally near, or the nearest points jump, the distance has no gradient; this is that of
        one of the pairs.

        Args:
            q: Configuration, shape (..., nq) [rad, m].
            moving: Poses of moving obstacles by name, T_world_shape, shape (..., 4, 4) [m].

        Returns:
            Gradient, shape (..., nv) [m/rad, -]; 0 without pairs.

        Raises:
            InputError: `q` or a pose is a Dask array.
        """
        if deferred.is_lazy_question(q, moving):
            raise InputError(
                "`q` or a pose is lazy; gradients of distances take NumPy arrays: pass q.compute(), or use "
                "dask.array.map_blocks(checker.gradient, q, dtype=float)."
            )
        nearest = self.distance(q, moving)
        batch = nearest.distance.shape
        rows = np.broadcast_to(np.asarray(q, dtype=float), (*batch, self.model.nq)).reshape(-1, self.model.nq)
        items = nearest.flat()
        out = [self._gradient(item, row) for item, row in zip(items, rows, strict=True)]
        return np.array(out).reshape(*batch, self.model.nv)

    def posed(self, q: Floats, moving: Mapping[str, ArrayLike] | None = None) -> PosedSolids:
        """The solids at one configuration, for algorithms that ask for pairs themselves; hold `lock`.

        Args:
            q: Configuration, shape (nq,) [rad, m].
            moving: Poses of moving obstacles by name, T_world_shape, shape (4, 4) [m].

        Returns:
            The placed solids.
        """
        _, chunks = self._broad.chunks(q, moving)
        _, poses = next(chunks)
        return PosedSolids(self._broad.bounds(poses, True)[..., 0], poses, self._narrow)

    look = posed
    """The former name of `posed`."""

    # one configuration ---------------------------------------------------------------------------------------

    def _touch(self, poses: Poses, near: Array, margin: float, out: Array) -> None:
        """Sets `out` where one of the near pairs touches; a row is done with its first contact."""
        first, second, rows = np.nonzero(near)
        order = np.argsort(rows, kind="stable")  # one configuration after the other
        ask = self._narrow.collision(margin)
        indices = (index[order].tolist() for index in (rows, first, second))
        for row, i, j in zip(*indices, strict=True):
            if not out[row] and ask(poses, row, i, j):
                out[row] = True

    def _nearest(self, poses: Poses, row: int, bounds: Floats, enough: float) -> NearestPoints | None:
        """The nearest pair of one configuration: pairs in the order of their bounds, until none can be nearer."""
        flat = bounds.reshape(-1)
        candidates = np.flatnonzero(flat < np.inf)
        candidates = candidates[np.argsort(flat[candidates])]
        best: NearestPoints | None = None
        width = len(self.solids)
        for index, bound in zip(candidates.tolist(), flat[candidates].tolist(), strict=True):
            if best is not None and (bound >= best.distance or best.distance <= enough):
                break
            best = self._narrow.distance(poses, row, index // width, index % width, best)
        return best

    # gradients ---------------------------------------------------------------------------------------------

    def _proximity(self, item: NearestPoints | None, q: Floats | None = None) -> Proximity:
        if item is None:
            nowhere = np.full((2, 3), np.nan)
            return Proximity(np.inf, nowhere, np.full(3, np.nan), ("", ""), np.zeros(self.model.nv))
        names = (self.solids[item.first].owner, self.solids[item.second].owner)
        bare = Proximity(item.distance, item.points, item.normal, names, np.zeros(self.model.nv))
        return bare if q is None else bare.with_gradient(self._gradient(bare, q))

    def _gradient(self, item: Proximity, q: Floats) -> Floats:
        """d' = n . (velocity of the second point - velocity of the first), both fixed to their bodies."""
        total = np.zeros(self.model.nv)
        for name, point, sign in zip(item.names, item.points, (-1.0, 1.0), strict=True):
            if not name or name in self.world:
                continue
            J = self._jacobian(self._carriers.get(name, name))(q)
            total += sign * (item.normal @ J[:3] + np.cross(point, item.normal) @ J[3:])
        return total

    def _jacobian(self, link: str) -> Any:
        if link not in self._jacobians:
            self._jacobians[link] = kernels.kernel(self.model, "jacobian", frame=link, reference="world")
        return self._jacobians[link]


def _link_pairs(
    model: Model, world: World, pairs: Iterable[LinkPair] | None, without: Iterable[LinkPair]
) -> tuple[LinkPair, ...]:
    objects = {*world.names, *(item.name for item in world.attachments)}
    gone = [pair for pair in without if not any(name in objects for name in pair)]
    if pairs is None:
        return link_pairs(model, without=gone)
    skip = {frozenset(pair) for pair in checked_pairs(model, gone)}
    return tuple(pair for pair in checked_pairs(model, pairs) if frozenset(pair) not in skip)


def _number(name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = np.nan
    if not np.isfinite(number):
        raise InputError(f"`{name}` is {value!r}; expected a finite length [m].")
    return number
