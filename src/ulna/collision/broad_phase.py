"""The broad phase of collision checks: solids placed for a batch of configurations, and pairs that boxes rule out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import final

import numpy as np

from ulna.collision import broad
from ulna.collision.narrow import Poses
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Solid
from ulna.collision.world import World
from ulna.geometry import Plane
from ulna.model import Model
from ulna.spatial import SE3
from ulna.typing import Array, ArrayLike, Floats

_CHUNK = 256  # configurations whose boxes are compared at once: what fits the second cache


@final
class BroadPhase:
    """Places the solids of links and obstacles, and compares their boxes.

    Args:
        model: The robot.
        world: Its obstacles.
        links: The solids of the links.
        obstacles: The solids of the obstacles.
        mask: Which solids of links are checked against which of all, shape (n links, n).
    """

    def __init__(
        self, model: Model, world: World, links: Sequence[Solid], obstacles: Sequence[Solid], mask: Array
    ) -> None:
        self._world, self._obstacles, self._mask, self._count = world, obstacles, mask, len(links)
        self._kernel = broad.pose_kernel(model, links)
        self._fixed = (
            np.stack([s.placement.rotation for s in obstacles]) if obstacles else np.zeros((0, 3, 3))
        )
        self._placed = (
            np.stack([s.placement.translation for s in obstacles]) if obstacles else np.zeros((0, 3))
        )
        self._boxes = broad.boxes_at(obstacles, self._fixed, self._placed)
        self._planes = [len(links) + k for k, s in enumerate(obstacles) if isinstance(s.shape, Plane)]

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
        R, p, c, h = self._kernel(q)
        stray = self._moved(moving or {})
        batch = np.broadcast_shapes(p.shape[:-2], *(T.shape[:-2] for T in stray.values()))
        total = int(np.prod(batch))
        flat = [
            np.broadcast_to(x, batch + x.shape[p.ndim - 2 :]).reshape(total, *x.shape[p.ndim - 2 :])
            for x in (R, p, c, h)
        ]
        poses = {k: np.broadcast_to(T, (*batch, 4, 4)).reshape(total, 4, 4) for k, T in stray.items()}
        return batch, self._pieces(flat, poses, total)

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
        near = broad.overlaps(poses.centre, poses.half, self._count, margin)
        near &= self._mask[..., None]
        for k in self._planes:
            near[:, k] &= self._over(poses, k) <= margin
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
        bounds[~self._mask] = np.inf
        return bounds

    def _over(self, poses: Poses, k: int) -> Floats:
        links = slice(0, self._count)
        R, p = poses.rotation[:, k], poses.translation[:, k]
        return broad.plane_gaps(poses.centre[:, links], poses.half[:, links], R, p)


def pair_mask(
    model: Model,
    world: World,
    solids: Sequence[Solid],
    count: int,
    pairs: Iterable[LinkPair],
    without: Iterable[LinkPair],
) -> Array:
    """Which solids of links are checked against which of all.

    Args:
        model: The robot.
        world: Its obstacles.
        solids: The solids of the links, then those of the obstacles.
        count: How many are of links.
        pairs: Pairs of links to check.
        without: Pairs of links and obstacles to leave out.

    Returns:
        Truth values, shape (count, n).

    Raises:
        UnknownName: An obstacle may touch a link that does not exist.
    """
    among, skip = ({frozenset(pair) for pair in chosen} for chosen in (pairs, without))
    mask = np.zeros((count, len(solids)), dtype=bool)
    for i, a in enumerate(solids[:count]):
        for j, b in enumerate(solids):
            if j < count:
                mask[i, j] = i < j and frozenset((a.owner, b.owner)) in among
            else:
                obstacle = world[b.owner]
                still = a.joint < 0 and not obstacle.moving
                mask[i, j] = not (
                    still or a.owner in obstacle.touches or frozenset((a.owner, b.owner)) in skip
                )
    for obstacle in world:
        for link in obstacle.touches:
            model.link_index(link)
    return mask
