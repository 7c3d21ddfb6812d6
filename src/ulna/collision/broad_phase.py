"""The broad phase of collision checks: solids placed for a batch of configurations, and pairs that boxes rule out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, final

import numpy as np

from ulna import kernels
from ulna.checks.quaternions import checked_configurations
from ulna.collision import broad
from ulna.collision.narrow import Poses
from ulna.collision.solids import Solid
from ulna.collision.world import World
from ulna.geometry import Plane
from ulna.model import Model
from ulna.spatial import SE3
from ulna.typing import Array, ArrayLike, Floats

_CHUNK = 256  # configurations whose boxes are compared at once: what fits the second cache
_PLACED = (
    8192  # configurations whose solids are placed at once: some megabytes, and some hundredths of a second
)


@final
class BroadPhase:
    """Places the solids of links and obstacles, and compares their boxes.

    Args:
        model: The robot.
        world: Its obstacles.
        links: The solids of the links.
        attached: The solids of attached objects.
        obstacles: The solids of the obstacles.
        mask: Which solids that move with the robot are checked against which of all, shape (n links and attached, n).
        margins: How far these must stay apart, shape (n links and attached, n) [m].
    """

    def __init__(
        self,
        model: Model,
        world: World,
        links: Sequence[Solid],
        attached: Sequence[Solid],
        obstacles: Sequence[Solid],
        mask: Array,
        margins: Floats,
    ) -> None:
        self._model = model
        self._world, self._obstacles, self._mask, self._count = world, obstacles, mask, len(mask)
        self._margins = margins if margins.any() else None
        self._kernel = broad.pose_kernel(model, links)
        attached_solids = [(world.attached(solid.owner), solid) for solid in attached]
        self._attached = [
            (kernels.kernel(model, "fk", checked=True, frame=item.link), item.pose.matrix(), solid)
            for item, solid in attached_solids
        ]
        self._fixed = (
            np.stack([s.placement.rotation for s in obstacles]) if obstacles else np.zeros((0, 3, 3))
        )
        self._placed = (
            np.stack([s.placement.translation for s in obstacles]) if obstacles else np.zeros((0, 3))
        )
        self._boxes = broad.boxes_at(obstacles, self._fixed, self._placed)
        self._planes = [self._count + k for k, s in enumerate(obstacles) if isinstance(s.shape, Plane)]

    def chunks(
        self, q: ArrayLike, moving: Mapping[str, ArrayLike] | None
    ) -> tuple[tuple[int, ...], Iterator[tuple[int, Poses]]]:
        """Places the solids of a batch of configurations, some hundred at a time.

        Args:
            q: Configuration, shape (..., nq) [rad, m].
            moving: Poses of moving obstacles by name, T_world_shape, shape (..., 4, 4) [m]; None for none.

        Returns:
            The shape of the batch, (...), and the number of the first row of each part with the solids of its rows.
        """
        moving_poses = self._moved(moving or {})
        if getattr(q, "size", 0) > _PLACED * self._model.nq:
            return self._chunks_of_many(checked_configurations("q", q, self._model), moving_poses)
        placed = self._with_attached(q, *self._kernel(q))
        core = placed[1].ndim - 2
        batch = np.broadcast_shapes(placed[1].shape[:core], *(T.shape[:-2] for T in moving_poses.values()))
        total = int(np.prod(batch))
        flat = [np.broadcast_to(x, batch + x.shape[core:]).reshape(total, *x.shape[core:]) for x in placed]
        return batch, self._pieces(flat, self._rows(moving_poses, batch, total), total)

    def _chunks_of_many(
        self, q: Array, moving_poses: Mapping[int, Floats]
    ) -> tuple[tuple[int, ...], Iterator[tuple[int, Poses]]]:
        """As `chunks`: solids are placed part by part, so that they fit into memory, and Ctrl-C is heard in between."""
        batch = np.broadcast_shapes(q.shape[:-1], *(T.shape[:-2] for T in moving_poses.values()))
        total = int(np.prod(batch))
        rows = np.broadcast_to(q, (*batch, q.shape[-1])).reshape(total, -1)
        poses = self._rows(moving_poses, batch, total)

        def pieces() -> Iterator[tuple[int, Poses]]:
            for first in range(0, total, _PLACED):
                part = slice(first, min(first + _PLACED, total))
                placed = self._with_attached(rows[part], *self._kernel(rows[part]))
                count, of_part = part.stop - first, {k: T[part] for k, T in poses.items()}
                yield from ((first + start, piece) for start, piece in self._pieces(placed, of_part, count))

        return batch, pieces()

    def _rows(
        self, moving_poses: Mapping[int, Floats], batch: tuple[int, ...], total: int
    ) -> dict[int, Floats]:
        """Poses of moving obstacles, one for each row."""
        return {k: np.broadcast_to(T, (*batch, 4, 4)).reshape(total, 4, 4) for k, T in moving_poses.items()}

    def _with_attached(self, q: ArrayLike, *placed: Floats) -> tuple[Floats, ...]:
        """R, p, c, h of the links' solids, followed by those of attached objects."""
        for kernel, place, solid in self._attached:
            T: Any = kernel(q) @ place
            R, p = T[..., None, :3, :3], T[..., None, :3, 3]
            new = (R, p, *broad.boxes_at([solid], R, p))
            axes = (-3, -2, -2, -2)
            placed = tuple(
                np.concatenate(x, axis=k) for x, k in zip(zip(placed, new, strict=True), axes, strict=True)
            )
        return placed

    def _pieces(
        self, flat: Sequence[Floats], poses: Mapping[int, Floats], total: int
    ) -> Iterator[tuple[int, Poses]]:
        obstacles = self._obstacles
        for start in range(0, total, _CHUNK):
            part = slice(start, min(start + _CHUNK, total))
            rows = part.stop - start
            R, p = (np.broadcast_to(x, (rows, *x.shape)) for x in (self._fixed, self._placed))
            c, h = (np.broadcast_to(x, (rows, *x.shape)) for x in self._boxes)
            if poses:
                R, p = R.copy(), p.copy()
                for k, T in poses.items():
                    R[:, k], p[:, k] = T[part, :3, :3], T[part, :3, 3]
                c, h = broad.boxes_at(obstacles, R, p)
            pairs = zip(flat, (R, p, c, h), strict=True)
            yield (
                start,
                Poses(
                    *(
                        np.concatenate([of_links[part], of_obstacles], axis=1)
                        for of_links, of_obstacles in pairs
                    )
                ),
            )

    def _moved(self, moving: Mapping[str, ArrayLike]) -> dict[int, Floats]:
        """Poses of moving obstacles by their place among the obstacles."""
        owners = [s.owner for s in self._obstacles]
        poses = {}
        for name, pose in moving.items():
            self._world.moving(name)
            matrix = pose.matrix() if isinstance(pose, SE3) else pose
            if name in owners:  # else its mesh is missing and was skipped
                poses[owners.index(name)] = SE3.from_matrix(matrix).matrix()
        return poses

    def all_pairs(self, poses: Poses) -> Array:
        """Every pair that is checked, (n links, n, rows)."""
        return np.repeat(self._mask[..., None], len(poses.centre), axis=-1)

    def near(self, poses: Poses, margin: float) -> Array:
        """Which pairs boxes do not rule out.

        Args:
            poses: The placed solids.
            margin: Shapes that come as near as this count as touching [m].

        Returns:
            Truth values, shape (n links, n, rows).
        """
        margins = 0.0 if self._margins is None else self._margins[..., None]
        near = broad.overlaps(poses.centre, poses.half, self._count, margin + margins)
        near &= self._mask[..., None]
        for k in self._planes:
            over = self._over(poses, k)
            near[:, k] &= over <= (margin if self._margins is None else margin + self._margins[:, k, None])
        return near

    def bounds(self, poses: Poses, broad_phase: bool) -> Floats:
        """Lower bounds of the distances of pairs.

        Args:
            poses: The placed solids.
            broad_phase: Whether boxes are compared; without it the bounds are -inf.

        Returns:
            Bounds [m], inf where none is asked for, shape (n links, n, rows).
        """
        if not broad_phase:
            return np.where(self.all_pairs(poses), -np.inf, np.inf)
        bounds = broad.gaps(poses.centre, poses.half, self._count)
        for k in self._planes:
            bounds[:, k] = self._over(poses, k)
        if self._margins is not None:
            bounds -= self._margins[..., None]
        bounds[~self._mask] = np.inf
        return bounds

    def _over(self, poses: Poses, k: int) -> Floats:
        links = slice(0, self._count)
        R, p = poses.rotation[:, k], poses.translation[:, k]
        return broad.plane_gaps(poses.centre[:, links], poses.half[:, links], R, p)
