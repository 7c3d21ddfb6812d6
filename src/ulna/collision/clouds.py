"""Obstacles that are points, as collision checks by spheres take them: their grids, kept from world to world."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from hashlib import blake2b
from typing import Any, final

import numpy as np

from ulna.collision.point_grid import Clouds, grid_of, least_distances
from ulna.collision.point_sets import surface_points
from ulna.collision.solids import Solid
from ulna.geometry import HeightField, Mesh, PointCloud, Shape
from ulna.system import forks
from ulna.typing import Floats

_KEPT = 16  # grids used last; each takes some megabytes

_grids: OrderedDict[bytes, Clouds] = OrderedDict()
_lock = forks.lock()


def is_points(shape: Shape) -> bool:
    """Whether a shape is taken by points instead of by formulas."""
    return isinstance(shape, PointCloud | HeightField | Mesh)


def point_grid(solid: Solid) -> Clouds:
    """The grid of a solid that is points or a surface, in the solid's frame.

    Args:
        solid: A cloud, a height field or a mesh.

    Returns:
        A single cloud.
    """
    parts = (solid.vertices, solid.triangles, np.array(solid.rounding))
    key = blake2b(b"".join(np.ascontiguousarray(x).tobytes() for x in parts)).digest()
    with _lock:
        if key in _grids:
            _grids.move_to_end(key)
            return _grids[key]
    points, radius = solid.vertices, solid.rounding
    if len(solid.triangles):
        points, radius = surface_points(solid.vertices, solid.triangles)
    grid = grid_of(points, radius)
    with _lock:
        _grids[key] = grid
        while len(_grids) > _KEPT:
            _grids.popitem(last=False)
    return grid


@final
@dataclass(frozen=True, eq=False)
class CloudCheck:
    """One such obstacle and the spheres that are checked against it.

    Attributes:
        name: The obstacle.
        grid: Its points, in its frame.
        chosen: Which of all spheres.
        radii: Their radii, larger by what they must stay apart, shape (spheres,) [m].
    """

    name: str
    grid: Clouds
    chosen: Any
    radii: Floats

    def distances(self, centres: Floats, poses: Floats) -> Floats:
        """How far the nearest sphere is.

        Args:
            centres: Centres of all spheres in the world, shape (..., all, 3) [m].
            poses: T_world_obstacle, shape (..., 1, 16) [m].

        Returns:
            Distances, shape (...) [m]; beyond some 0.1 m a lower bound.
        """
        T = poses.reshape(*poses.shape[:-2], 4, 4)
        local = (centres[..., self.chosen, :] - T[..., None, :3, 3]) @ T[..., :3, :3]
        return least_distances(self.grid, local, self.radii)
