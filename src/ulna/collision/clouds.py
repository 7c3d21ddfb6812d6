"""Obstacles that are points, as collision checks by spheres take them: their grids, kept from world to world."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from hashlib import blake2b
from typing import Any, final

import numpy as np

from ulna.collision.clearance import checked_links
from ulna.collision.grids import grid_of, least_distances
from ulna.collision.point_grid import Clouds
from ulna.collision.point_sets import surface_points
from ulna.collision.solids import Missing, Solid, obstacle_solid
from ulna.collision.spheres import Spheres
from ulna.collision.world import World
from ulna.data_classes import dataclass
from ulna.geometry import HeightField, Mesh, PointCloud, Shape
from ulna.model import Model
from ulna.spatial import SE3
from ulna.system import forks
from ulna.typing import Floats

_CACHED_BYTES = 200_000_000  # of the grids used last; each takes 1 to 25 MB

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
        while len(_grids) > 1 and sum(map(_size, _grids.values())) > _CACHED_BYTES:
            _grids.popitem(last=False)
    return grid


def _size(grid: Clouds) -> int:
    """The memory that a grid takes [byte]."""
    return sum(array.nbytes for array in grid)


@final
@dataclass(frozen=True, eq=False)
class CloudCheck:
    """One such obstacle and the spheres that are checked against it.

    Attributes:
        name: The obstacle.
        grid: Its points, in its frame.
        chosen: Which of all spheres.
        radii: Their radii, larger by what they must stay apart, shape (spheres,) [m].
        margins: How far links and attached objects must stay apart from it, by name [m].
    """

    name: str
    grid: Clouds
    chosen: Any
    radii: Floats
    margins: Mapping[str, float]

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

    def link_distance(self, link: str, centres: Floats, radii: Floats, pose: SE3) -> float:
        """How far the nearest sphere of one link is, less the margin.

        Args:
            link: Its name, among `margins`.
            centres: Centres of its spheres in the world, shape (n, 3) [m].
            radii: Their radii, shape (n,) [m].
            pose: T_world_obstacle [m].

        Returns:
            The distance [m].
        """
        local = (centres - pose.translation) @ pose.rotation
        return float(least_distances(self.grid, local, radii + self.margins[link]))


def cloud_checks(
    model: Model, world: World, spheres: Spheres, chosen: Callable[[tuple[str, ...]], Any], missing: Missing
) -> list[CloudCheck]:
    """The obstacles of a world that are points, with the spheres that are checked against them.

    Args:
        model: The robot.
        world: The world.
        spheres: Spheres of the links and of attached objects.
        chosen: From names of links and objects to the numbers of their spheres among all.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The checks.
    """
    checks = []
    for obstacle in world:
        links = checked_links(model, spheres, obstacle, world) if is_points(obstacle.shape) else []
        solid = obstacle_solid(obstacle, missing) if links else None
        if solid is not None:
            margins = {link: world.margin(link, obstacle.name) for link in links}
            radii = np.concatenate([spheres.links[link].radii + margins[link] for link in links])
            checks.append(CloudCheck(obstacle.name, point_grid(solid), chosen(tuple(links)), radii, margins))
    return checks
