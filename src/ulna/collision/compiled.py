"""Collision checks by covering spheres, compiled: never "free" where the real shapes touch.

Pairs of links whose spheres touch unduly are looked up in tables of proved clearance first; see `pair_tables`.
One kernel places the spheres and checks them against each other, in SIMD lanes over configurations; one for each kind
of obstacle checks them against a row of numbers, in SIMD lanes over obstacles. Obstacles and the spheres of attached
objects are data: to move, add, remove or attach one compiles nothing.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any, final

import numpy as np

from ulna import kernels
from ulna.checks.attributes import FixedAttributes
from ulna.checks.quaternions import checked_configurations
from ulna.checks.values import count as check_count
from ulna.checks.values import flag, number, short_repr
from ulna.collision import clearance as gap
from ulna.collision import deferred, sphere_kernels
from ulna.collision.attached import carried
from ulna.collision.clouds import cloud_checks
from ulna.collision.covering import fit
from ulna.collision.groups import grouped, pairs_apart
from ulna.collision.lanes.batches import BatchCheck, batch_scene
from ulna.collision.lanes.single import DOUBTFUL, FREE, TOUCHING
from ulna.collision.lanes.tables import Scene
from ulna.collision.mask import check_touches
from ulna.collision.pair_tables import without_tables
from ulna.collision.pairs import LinkPair, checked_pairs, link_pairs
from ulna.collision.solids import Missing
from ulna.collision.sphere_kernels import What, outer_kernel, self_collision_kernel, sphere_kernel
from ulna.collision.spheres import Spheres
from ulna.collision.table_checks import TableChecks
from ulna.collision.table_choice import pair_tables
from ulna.collision.touches import deepest_touch
from ulna.collision.world import World
from ulna.errors import InputError
from ulna.model import Model
from ulna.model.of_robot import model_of
from ulna.spatial import SE3
from ulna.system.cached import cached_property
from ulna.system.helper_threads import cuts, results_in_threads
from ulna.typing import Array, ArrayLike, Floats

TOUCH = 1e-6
"""What is this near counts as touching [m]: the tolerance that coal's own distances have."""

_ONE_BY_ONE = 40
"""So many configurations take less time one by one than together, which binds many arrays first."""

_ARRAY = np.ndarray  # a name of the module is found faster than one of another

_COMPILED_FROM = 32
"""Configurations in doubt, of one checker, from which on a kernel is compiled for them."""

_LEAST_ROWS = 1024
"""Configurations of a part that a thread computes at least: some 0.2 ms, longer than waking it takes."""
_CHUNK = 512  # configurations whose spheres fit the second cache


@final
class SphereChecker(FixedAttributes):
    """Conservative collision checks of one robot, in one world, by spheres on its links.

    Links that never move take part by their real shapes; their spheres only serve against moving obstacles. Spheres
    that you give to a link without collision geometry are checked against the world, and with `pairs` against links.

    Args:
        model: The Model, or its Robot.
        world: Its obstacles; None for none.
        spheres: Spheres of the links; None for `fit(model)`.
        pairs: Pairs of links to check against each other; None for `link_pairs(model)`, () for none.
        missing: What to do about a mesh file that is not there: "error", or "skip" it with a warning.
        tables: Whether links that few joints lie between, and whose spheres touch unduly, are checked by tables of
            proved clearance of their real shapes; they take seconds, once, and are kept on disk. None where `spheres`
            is None, since spheres that you give are taken as they are.

    Raises:
        ModelError: If the robot has no collision geometry.
        InputError: If a link with collision geometry has no spheres.
        UnknownName: If spheres or pairs name no link.
    """

    model: Model
    world: World
    missing: Missing
    spheres: Spheres
    pairs: tuple[LinkPair, ...]
    attached: Mapping[str, Any]
    carriers: dict[str, str]
    attached_pairs: tuple[Any, ...]
    covering: Spheres
    """The spheres of the links, then those of attached objects."""
    tables: tuple[Any, ...]
    """Tables of proved clearance, by which some of the pairs are checked."""
    sphere_pairs: tuple[LinkPair, ...]
    """The pairs of links that are checked by spheres alone."""
    table_checks: TableChecks

    def __init__(
        self,
        model: Model | Any,
        world: World | None = None,
        *,
        spheres: Spheres | None = None,
        pairs: Iterable[LinkPair] | None = None,
        missing: Missing = "error",
        tables: bool | None = None,
    ) -> None:
        model = model_of(model, "model")
        pairs = pairs if pairs is None else tuple(pairs)
        self._options = {"spheres": spheres, "pairs": pairs, "missing": missing, "tables": tables}
        self.missing = missing
        self.model, self.world = model, World() if world is None else world
        self.spheres = _checked(fit(model, missing=missing) if spheres is None else spheres, model, missing)
        chosen = link_pairs(model) if pairs is None else checked_pairs(model, pairs)
        self.pairs = tuple(pair for pair in chosen if all(name in self.spheres.links for name in pair))
        check_touches(model, self.world)
        carried_bodies = carried(model, self.world, self.spheres, missing)
        self.attached, self.carriers = carried_bodies.spheres, carried_bodies.carriers
        self.attached_pairs = carried_bodies.pairs
        self.covering = Spheres({**self.spheres.links, **self.attached}) if self.attached else self.spheres
        self._places = _places(self.covering)
        with_tables = spheres is None if tables is None else flag("tables", tables)
        self.tables = pair_tables(model, self.spheres, self.pairs, missing) if with_tables else ()
        self.sphere_pairs = without_tables(self.pairs, self.tables)
        self.table_checks = TableChecks(model, self.world, self.spheres, self.tables, missing)
        self._apart = pairs_apart(model, self.world, self.covering, self.sphere_pairs, self.attached_pairs)
        checked = (*self.sphere_pairs, *self.attached_pairs)
        self._groups = grouped(model, self.world, self.covering, self.attached, checked, missing)
        self._clouds = cloud_checks(self.model, self.world, self.covering, self._chosen, self.missing)
        self._still = [self._rows(parts, {}) for _, _, parts in self._groups]
        self._kernels: dict[Any, Any] = {}
        self._batches: dict[float, BatchCheck] = {}
        self._asked, self._shape = 0, (model.nq,)
        self._scratch = threading.local()

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(SphereChecker, **self._options), (self.model, self.world)

    def __repr__(self) -> str:
        tables = f", {len(self.tables)} tables of pairs" if self.tables else ""
        count = len(self.world.names)
        return f"<check of {self.model.name!r} by {self.spheres!r}{tables}, {count} obstacles>"

    def collides(
        self,
        q: ArrayLike,
        moving: Mapping[str, ArrayLike] | None = None,
        *,
        margin: float = 0.0,
        threads: int | None = None,
    ) -> Any:
        """Whether any spheres come near each other: False means free, for sure.

        Args:
            q: Configuration, shape (..., nq) [rad, m].
            moving: Poses of moving obstacles by name, T_world_shape, shape (..., 4, 4) [m].
            margin: How near, not below 0 [m].
            threads: How many threads a large batch may use.

        Returns:
            Truth values, shape (...).

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` or a pose cannot be one.
            UnknownName: If `moving` names no obstacle.
            InputError: If `margin` is negative.
        """
        check = self._batches.get(margin) if type(margin) is float else None
        if (
            check is not None  # margins that were asked before are lengths
            and type(q) is _ARRAY
            and q.shape == self._shape
            and q.dtype.char == "d"
            and threads is moving is None
        ):
            answer = check.state(q)  # nan is in doubt
            if answer != DOUBTFUL:
                return answer == TOUCHING
        if type(margin) is not float or not 0.0 <= margin < np.inf:
            margin = number("margin", margin, "a finite length, not below 0 [m]", least=0.0)
        if threads is not None:
            check_count("threads", threads)
        if deferred.is_lazy_question(q, moving):
            options = {"margin": float(margin), "threads": threads}
            return deferred.ask(self, "collides", np.bool_, q, moving, options)
        margin = float(margin)
        reach = margin + TOUCH
        check = None if moving else self._batch_check(margin)
        if check is not None:
            q = checked_configurations("q", q, self.model)
            return self._collides_in_lanes(check, q, reach, threads)
        free = self._evaluate("free", q, moving, np.minimum, reach, threads)
        return free < 0.5 if np.ndim(free) else bool(free < 0.5)

    def clearance(
        self,
        q: ArrayLike,
        moving: Mapping[str, ArrayLike] | None = None,
        *,
        threads: int | None = None,
    ) -> Any:
        """How far the nearest spheres are, or what tables prove of two links.

        While it is positive, the real shapes are at least that far. Negative, it says how deep the spheres are, which
        is not how deep the shapes are.

        Args:
            q: Configuration, shape (..., nq) [rad, m].
            moving: Poses of moving obstacles by name, T_world_shape, shape (..., 4, 4) [m].
            threads: How many threads a large batch may use.

        Returns:
            Distance, shape (...) [m]; inf where nothing is checked.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` or a pose cannot be one.
            UnknownName: If `moving` names no obstacle.
        """
        if threads is not None:
            check_count("threads", threads)
        if deferred.is_lazy_question(q, moving):
            return deferred.ask(self, "clearance", np.float64, q, moving, {"threads": threads})
        return self._evaluate("signed", q, moving, np.minimum, 0.0, threads)

    def static_groups(
        self, moving: Mapping[str, ArrayLike] | None = None
    ) -> list[tuple[gap.Kind, tuple[str, ...], Floats, tuple[str, ...]]]:
        """What the spheres are checked against, where it stands: obstacles, and links that never move.

        Args:
            moving: Poses of moving obstacles by name, T_world_shape, shape (4, 4) [m].

        Returns:
            For each formula ("box", "cylinder" or "plane") and set of links: the links' names, the numbers of the
            parts, shape (parts, numbers) as `clearance.row` has them, and by part its obstacle's or link's name.
        """
        return [
            (kind, links, rows, tuple(part.owner for part, _, _ in parts))
            for (kind, links, parts), (*_, rows) in zip(
                self._groups, self._group_rows(self._poses(moving)), strict=True
            )
        ]

    def cloud_distances(
        self, link: str, centres: Floats, moving: Mapping[str, ArrayLike] | None = None
    ) -> list[tuple[str, float]]:
        """How far the spheres of a link are from obstacles that are points, where these stand.

        Args:
            link: Name of the link or attached object.
            centres: Centres of its spheres in the world, shape (n, 3) [m].
            moving: Poses of moving obstacles by name, T_world_shape, shape (4, 4) [m].

        Returns:
            By obstacle that is checked against the link its name and the distance, less the margin [m].
        """
        poses = {check.name: self.world[check.name].pose for check in self._clouds} | self._poses(moving)
        radii = self.covering.links[link].radii
        return [
            (check.name, check.link_distance(link, centres, radii, poses[check.name]))
            for check in self._clouds
            if link in check.margins
        ]

    def _batch_check(self, margin: float) -> BatchCheck | None:
        """The check in float32, with proof; None where that does not do."""
        check = self._batches.get(margin)
        if check is None and self._scene is not None:
            if len(self._batches) >= 8:
                self._batches.clear()
            check = self._batches[margin] = BatchCheck(self._scene, margin + TOUCH)
        return check

    @cached_property
    def _scene(self) -> Scene | None:
        """What checks in float32 share; None where they do not do."""
        return batch_scene(self.model, self.world, self.spheres, self.pairs, self.missing, self.tables)

    def _collides_in_lanes(self, check: BatchCheck, q: Floats, reach: float, threads: int | None) -> Any:
        """Which configurations touch: by float32 where that is certain, else by float64."""
        if q.ndim == 1:
            answer = check.state(q)
            return (
                self._touches_exactly(q[None], reach)[0].item() if answer == DOUBTFUL else answer == TOUCHING
            )
        flat = q.reshape(-1, self.model.nq)
        if len(flat) <= _ONE_BY_ONE:
            answers = np.array([check.state(row) for row in flat], dtype=int)
            touching, is_doubtful = answers != FREE, answers == DOUBTFUL
        elif threads is None or threads < 2 or len(flat) < 2 * _LEAST_ROWS:
            touching, is_doubtful = check.run(flat)
        else:
            ends = cuts(len(flat), threads, _LEAST_ROWS)
            parts = results_in_threads(
                lambda k: check.run(flat[ends[k] : ends[k + 1]]), len(ends) - 1, threads
            )
            touching, is_doubtful = (np.concatenate(part) for part in zip(*parts, strict=True))
        if is_doubtful.any():
            touching[is_doubtful] = self._touches_exactly(flat[is_doubtful], reach, threads)
        return touching.reshape(q.shape[:-1])

    @cached_property
    def _is_compilable(self) -> bool:
        """Whether few enough spheres are checked against each other for one kernel."""
        return len(gap.self_pairs(self.model, self.spheres, self.sphere_pairs)) <= sphere_kernels.MOST_COUPLES

    def _touches_exactly(self, q: Floats, reach: float, threads: int | None = None) -> Array:
        """Which configurations touch, in float64: one by one until so many were asked that a kernel is compiled."""
        self._asked += len(q)
        if self._asked > _COMPILED_FROM and self._is_compilable:
            return self._evaluate("free", q, None, np.minimum, reach, threads) < 0.5
        return np.array([deepest_touch(self, row)[0] <= reach for row in q])

    # evaluation --------------------------------------------------------------------------------------------

    def _cloud_rows(self, poses: Mapping[str, SE3]) -> list[Any]:
        """The checks of clouds of points, and the poses of these as rows (..., 1, 16)."""
        rows: list[Any] = []
        for check in self._clouds:
            pose = poses.get(check.name, self.world[check.name].pose).matrix()
            rows.append((None, check, pose.reshape(*pose.shape[:-2], 1, 16)))
        return rows

    def _evaluate(
        self,
        what: What,
        q: ArrayLike,
        moving: Mapping[str, ArrayLike] | None,
        join: Any,
        reach: float,
        threads: int | None,
    ) -> Any:
        poses = self._poses(moving)
        q = checked_configurations("q", q, self.model)
        batch = np.broadcast_shapes(q.shape[:-1], *(T.translation.shape[:-1] for T in poses.values()))
        rows = [*self._group_rows(poses), *self._cloud_rows(poses)]
        self_distance = self_collision_kernel(what, self.model, self.spheres, self.sphere_pairs)
        if not batch:
            placed = self._with_attached(q, self_distance(q, reach))
            return self._one(what, q, placed, rows, join, reach)[()]
        count = int(np.prod(batch))
        flat = np.broadcast_to(q, (*batch, self.model.nq)).reshape(count, self.model.nq)
        batched = [(kind, links, _of_each(x, batch, count)) for kind, links, x in rows]

        def run(k: int) -> Any:
            """Chunk k, in the thread's own buffer: fresh memory would cost as much as the kernels."""
            buffer = getattr(self._scratch, "buffer", None)
            if buffer is None:
                buffer = self._scratch.buffer = np.empty((_CHUNK, *self_distance.function.outputs[0].shape))
            part = slice(k * _CHUNK, min((k + 1) * _CHUNK, count))
            c = buffer[: part.stop - part.start]
            placed = self_distance(flat[part], reach, out=(c, np.empty(len(c))))
            placed = self._with_attached(flat[part], placed)
            here = [(kind, links, x[part]) for kind, links, x in batched]
            return self._one(what, flat[part], placed, here, join, reach)

        results = results_in_threads(run, -(-count // _CHUNK), threads or 1)
        return np.concatenate(results).reshape(batch) if results else np.empty(batch)

    def _one(self, what: What, q: Floats, placed: tuple[Any, Any], rows: Any, join: Any, reach: float) -> Any:
        """The answers of some configurations whose spheres are placed and checked against each other."""
        centres, result = placed
        for kind, links, numbers in rows:
            if kind is None:
                apart = links.distances(centres, numbers)
                result = join(result, apart > reach if what == "free" else apart)
                continue
            chosen = centres[..., self._chosen(links), :]
            if links[0] in self.attached:
                radii = self.attached[links[0]].radii
                ask = sphere_kernel(what, kind)
                distances = ask(chosen[..., None, :, :], radii, numbers[..., :, None, :], reach)
                distances = join.reduce(distances, axis=-1)
            else:
                distances = self._outer(what, kind, links)(chosen[..., None, :, :], numbers, reach)
            result = join(result, join.reduce(distances, axis=-1))
        for first, second, least in self._apart:
            a, b = (centres[..., self._chosen((name,)), :] for name in (first, second))
            apart = np.linalg.norm(a[..., :, None, :] - b[..., None, :, :], axis=-1) - least
            least_apart = apart.min(axis=(-2, -1))
            result = join(result, least_apart > reach if what == "free" else least_apart)
        return np.asarray(self._with_tables(what, q, centres, result, reach))

    def _with_tables(self, what: What, q: Floats, centres: Floats, result: Any, reach: float) -> Any:
        """The answers together with those of pairs that have tables."""
        if not len(self.table_checks):
            return result
        several, balls = np.atleast_2d(q), centres.reshape(-1, *centres.shape[-2:])
        placed = {
            name: balls[:, self._places[name].start : self._places[name].stop] for name in self.spheres.links
        }
        known = np.array(np.broadcast_to(result, q.shape[:-1]), dtype=float).reshape(-1)
        limit = np.where(known > 0.5, np.nextafter(reach, np.inf), -np.inf) if what == "free" else known
        least = self.table_checks.least(several, placed, limit)
        answer = (least > reach).astype(float) if what == "free" else least
        return answer.reshape(q.shape[:-1])

    def _poses(self, moving: Mapping[str, ArrayLike] | None) -> dict[str, SE3]:
        """Poses of moving obstacles, by name."""
        for name in moving or {}:
            self.world.moving(name)
        return {name: SE3.from_matrix(_matrix(T)) for name, T in (moving or {}).items()}

    def _group_rows(self, poses: Mapping[str, SE3]) -> list[tuple[gap.Kind, tuple[str, ...], Floats]]:
        """The numbers of all parts that spheres are checked against, by formula and links."""
        return [
            (kind, links, self._rows(parts, poses) if any(name in poses for *_, name in parts) else still)
            for (kind, links, parts), still in zip(self._groups, self._still, strict=True)
        ]

    def _with_attached(self, q: Floats, placed: tuple[Any, Any]) -> tuple[Any, Any]:
        """The centres of all spheres, after those of the links those of attached objects."""
        if not self.attached:
            return placed
        centres = [placed[0]]
        for name, balls in self.attached.items():
            T = kernels.kernel(self.model, "fk", frame=self.carriers[name])(q)
            turned = balls.centres @ np.swapaxes(T[..., :3, :3], -1, -2)
            centres.append(turned + T[..., None, :3, 3])
        return np.concatenate(centres, axis=-2), placed[1]

    def _rows(self, parts: Sequence[tuple[gap.Part, SE3, str]], poses: Mapping[str, SE3]) -> Floats:
        rows = [gap.row(part, poses.get(name, pose)) for part, pose, name in parts]
        batch = np.broadcast_shapes(*(x.shape[:-1] for x in rows))
        return np.stack([np.broadcast_to(x, (*batch, x.shape[-1])) for x in rows], axis=-2)

    def _chosen(self, links: tuple[str, ...]) -> Any:
        index = [k for link in links for k in self._places[link]]
        whole = index == list(range(index[0], index[-1] + 1))
        return slice(index[0], index[-1] + 1) if whole else index

    def _outer(self, what: What, kind: gap.Kind, links: tuple[str, ...]) -> Any:
        """The kernel of one kind of obstacle for the spheres of `links`."""
        key = what, kind, links
        if key not in self._kernels:
            radii = np.concatenate([self.spheres.links[link].radii for link in links])
            self._kernels[key] = outer_kernel(what, kind, tuple(radii.tolist()))
        return self._kernels[key]


def _matrix(pose: Any) -> Any:
    return pose.matrix() if isinstance(pose, SE3) else pose


def _checked(spheres: Spheres, model: Model, missing: Missing) -> Spheres:
    """The spheres, if they are those of the model's links.

    Raises:
        InputError: They are no Spheres, or a link with geometry has none.
    """
    if not isinstance(spheres, Spheres):
        raise InputError(
            f"`spheres` is {short_repr(spheres)}; expected Spheres, as `ulna.collision.fit(model)` makes."
        )
    for name in spheres.links:
        model.link_index(name)
    for link in model.links:
        if link.collisions and link.name not in spheres.links and missing != "skip":
            raise InputError(
                f"`spheres` has none for link {link.name!r}, whose geometry no check would include. "
                "Start from `fit(model)` and replace what you know better."
            )
    return spheres


def _places(spheres: Spheres) -> dict[str, range]:
    """For each link or object the numbers of its spheres among all."""
    starts = np.cumsum([0, *(len(s.radii) for s in spheres.links.values())])
    return {name: range(a, b) for name, a, b in zip(spheres.links, starts, starts[1:], strict=False)}


def _of_each(x: Array, batch: tuple[int, ...], count: int) -> Array:
    """Rows (..., m, k) for each of the `count` samples of a batch, (count, m, k)."""
    return np.broadcast_to(x, (*batch, *x.shape[-2:])).reshape(count, *x.shape[-2:])
