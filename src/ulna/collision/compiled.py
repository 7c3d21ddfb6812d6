"""Collision checks by covering spheres, compiled: never "free" where the real shapes touch.

One kernel places the spheres and checks them against each other, in SIMD lanes over configurations; one for each kind
of obstacle checks them against a row of numbers, in SIMD lanes over obstacles. Obstacles are data: to move, add or
remove one compiles nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, final

import numpy as np

from ulna.collision import clearance as gap
from ulna.collision.pairs import LinkPair, checked_pairs, link_pairs
from ulna.collision.spheres import Spheres, fit
from ulna.collision.world import World
from ulna.errors import InputError, UnknownName
from ulna.model import Model
from ulna.numeric import minimum, where
from ulna.spatial import SE3
from ulna.trace import compile, trace
from ulna.typing import Array, ArrayLike, Floats

TOUCH = 1e-6
"""What is this near counts as touching [m]: the tolerance that coal's own distances have."""

_CHUNK = 512  # configurations whose spheres fit the second cache


@final
class SphereChecker:
    """Conservative collision checks of one robot, in one world, by spheres on its links.

    Args:
        model: The robot.
        world: Its obstacles; None for none.
        spheres: Spheres of the links; None for `fit(model)`.
        pairs: Pairs of links to check against each other; None for `link_pairs(model)`, () for none.

    Raises:
        ModelError: If the robot has no collision geometry.
        UnknownName: If spheres or pairs name no link.
    """

    def __init__(
        self,
        model: Model,
        world: World | None = None,
        *,
        spheres: Spheres | None = None,
        pairs: Iterable[LinkPair] | None = None,
    ) -> None:
        self.model, self.world = model, World() if world is None else world
        self.spheres = fit(model) if spheres is None else spheres
        for name in self.spheres.links:
            model.link_index(name)
        self.pairs = link_pairs(model) if pairs is None else checked_pairs(model, pairs)
        starts = np.cumsum([0, *(len(s.radii) for s in self.spheres.links.values())])
        self._places = {
            k: range(a, b) for k, a, b in zip(self.spheres.links, starts, starts[1:], strict=False)
        }
        self._radii = np.concatenate([s.radii for s in self.spheres.links.values()])
        self._groups = self._grouped()
        self._kernels: dict[Any, Any] = {}

    def collides(
        self,
        q: ArrayLike,
        moving: Mapping[str, ArrayLike] | None = None,
        *,
        margin: float = 0.0,
        threads: int | None = None,
    ) -> Any:
        """Whether any spheres come as near as `margin` [m], (...): False means free, for sure.

        Args:
            q: Configuration, (..., nq) [rad or m].
            moving: Poses of moving obstacles by name, T_world_shape (..., 4, 4).
            margin: Not below 0 [m].
            threads: How many threads a large batch may use.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` or a pose cannot be one.
            UnknownName: If `moving` names no obstacle.
            InputError: If `margin` is negative.
        """
        if not (np.isfinite(margin) and margin >= 0.0):
            raise InputError(f"`margin` is {margin!r}; expected a finite length, not below 0 [m].")
        free = self._evaluate("free", q, moving, np.minimum, float(margin) + TOUCH, threads)
        return free < 0.5 if np.ndim(free) else bool(free < 0.5)

    def clearance(
        self,
        q: ArrayLike,
        moving: Mapping[str, ArrayLike] | None = None,
        *,
        threads: int | None = None,
    ) -> Any:
        """How far the nearest spheres are, (...) [m]; arguments as for `collides`.

        While it is positive, the real shapes are at least that far. Negative, it says how deep the spheres are, which
        is not how deep the shapes are. inf where nothing is checked.
        """
        return self._evaluate("signed", q, moving, np.minimum, 0.0, threads)

    # evaluation --------------------------------------------------------------------------------------------

    def _evaluate(
        self,
        what: str,
        q: ArrayLike,
        moving: Mapping[str, ArrayLike] | None,
        join: Any,
        reach: float,
        threads: int | None,
    ) -> Any:
        poses = {name: SE3.from_matrix(_matrix(T)) for name, T in (moving or {}).items()}
        self._check_moving(poses)
        q = np.asarray(q, dtype=float)
        batch = np.broadcast_shapes(q.shape[:-1], *(T.translation.shape[:-1] for T in poses.values()))
        rows = [(kind, links, self._rows(parts, poses)) for kind, links, parts in self._groups]
        own = self._own(what)
        if not batch:
            return self._one(what, own(q, reach), rows, join, reach)[()]
        own(q.reshape(-1, *q.shape[-1:])[:1], reach)  # a wrong shape is named as it was given
        count = int(np.prod(batch))
        flat = np.broadcast_to(q, (*batch, q.shape[-1])).reshape(count, -1)
        spread = [
            (kind, links, np.broadcast_to(x, (*batch, *x.shape[-2:])).reshape(count, *x.shape[-2:]))
            for kind, links, x in rows
        ]

        def run(starts: Sequence[int]) -> list[Any]:
            """Chunk after chunk in one buffer: fresh memory for each would cost more than the kernels."""
            buffer = np.empty((min(_CHUNK, count), *own.function.outputs[0].shape))
            found = []
            for start in starts:
                part = slice(start, min(start + _CHUNK, count))
                c = buffer[: part.stop - part.start]
                placed = own(flat[part], reach, out=(c, np.empty(len(c))))
                here = [(kind, links, x[part]) for kind, links, x in spread]
                found.append(self._one(what, placed, here, join, reach))
            return found

        starts = range(0, count, _CHUNK)
        if threads is None or threads < 2 or len(starts) < 2:
            found = run(starts)
        else:
            from concurrent.futures import ThreadPoolExecutor

            shares = [
                starts[k * len(starts) // threads : (k + 1) * len(starts) // threads] for k in range(threads)
            ]
            with ThreadPoolExecutor(threads) as pool:  # kernels let go of the interpreter's lock
                found = [piece for share in pool.map(run, shares) for piece in share]
        return np.concatenate(found).reshape(batch) if found else np.empty(batch)

    def _one(self, what: str, placed: tuple[Any, Any], rows: Any, join: Any, reach: float) -> Any:
        """The verdicts of some configurations whose spheres are placed and checked against each other."""
        centres, result = placed
        for kind, links, numbers in rows:
            chosen = centres[..., self._chosen(links), :][..., None, :, :]
            found = self._outer(what, kind, links)(chosen, numbers, reach)
            result = join(result, join.reduce(found, axis=-1))
        return np.asarray(result)

    def _check_moving(self, poses: Mapping[str, SE3]) -> None:
        for name in poses:
            if name not in self.world:
                raise UnknownName("obstacle", name, self.world.names)
            if not self.world[name].moving:
                raise InputError(
                    f"Obstacle {name!r} does not move, and a pose was given for it. "
                    "Add it with moving=True, or make another world with `world.move(name, pose)`."
                )

    def _grouped(self) -> list[tuple[gap.Kind, tuple[str, ...], list[gap.Part]]]:
        """The world's parts by formula and by the links they are checked against."""
        groups: dict[tuple[gap.Kind, tuple[str, ...]], list[gap.Part]] = {}
        for part in gap.parts(self.world):
            links = [
                k for k in gap.checked_links(self.model, self.world, part.owner) if k in self.spheres.links
            ]
            if links:
                groups.setdefault((part.kind, tuple(links)), []).append(part)
        return [(kind, links, found) for (kind, links), found in groups.items()]

    def _rows(self, parts: Sequence[gap.Part], poses: Mapping[str, SE3]) -> Floats:
        found = [gap.row(part, poses.get(part.owner, self.world[part.owner].pose)) for part in parts]
        batch = np.broadcast_shapes(*(x.shape[:-1] for x in found))
        return np.stack([np.broadcast_to(x, (*batch, x.shape[-1])) for x in found], axis=-2)

    def _chosen(self, links: tuple[str, ...]) -> Any:
        index = [k for link in links for k in self._places[link]]
        whole = index == list(range(index[0], index[-1] + 1))
        return slice(index[0], index[-1] + 1) if whole else index

    # kernels -----------------------------------------------------------------------------------------------

    def _own(self, what: str) -> Any:
        """The kernel from q and a reach to the centres and the verdict of spheres on spheres."""
        if what in self._kernels:
            return self._kernels[what]
        spheres, couples = self.spheres, gap.self_pairs(self.spheres, self.pairs)

        def check(q: Array, reach: Any) -> tuple[Any, Any]:
            c = gap.centres(self.model, q, spheres)
            result: Any = True if what == "free" else np.inf
            for a, i, b, j in couples:
                v = c[a][i] - c[b][j]
                sum_of_radii = spheres.links[a].radii[i] + spheres.links[b].radii[j]
                result = _join(what, result, v @ v, sum_of_radii, 0.0, reach)
            every = np.concatenate([np.asarray(x, dtype=object) for x in c.values()])
            return every, _number(what, result)

        traced = trace(check, name=f"spheres_{what}", q=(self.model.nq,), reach=())
        return self._kernels.setdefault(what, compile(traced, checked=True))

    def _outer(self, what: str, kind: gap.Kind, links: tuple[str, ...]) -> Any:
        """The kernel from centres and a row of an obstacle to the verdict of the spheres of `links`."""
        key = what, kind, links
        if key in self._kernels:
            return self._kernels[key]
        radii = self._radii[[k for link in links for k in self._places[link]]]

        def check(c: Array, numbers: Array, reach: Any) -> Any:
            result: Any = True if what == "free" else np.inf
            for k, radius in enumerate(radii):
                if what == "free":
                    total, m = gap.squared(kind, c[k], numbers)
                    result = _join(what, result, total, radius, m, reach)
                else:
                    result = minimum(result, gap.signed(kind, c[k], numbers) - radius)
            return _number(what, result)

        shapes = {"c": (len(radii), 3), "numbers": (gap.WIDTH[kind],), "reach": ()}
        traced = trace(check, name=f"spheres_{kind}_{what}", **shapes)
        return self._kernels.setdefault(key, compile(traced))


def _join(what: str, result: Any, squared: Any, radius: Any, rounding: Any, reach: Any) -> Any:
    """The verdict so far, with that of one more squared distance."""
    if what == "free":
        beyond = radius + rounding + reach
        return (beyond * beyond < squared) & result  # nan is not free
    return minimum(result, np.sqrt(squared + 1e-300) - radius)


def _number(what: str, result: Any) -> Any:
    return where(result, 1.0, 0.0) if what == "free" else result


def _matrix(pose: Any) -> Any:
    return pose.matrix() if isinstance(pose, SE3) else pose
