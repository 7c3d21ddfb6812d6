"""What is solid: the shapes of a robot's links and of a world's obstacles, with their meshes read and bounded."""

from __future__ import annotations

import functools
import os
import warnings
from typing import Any, Literal, final

import numpy as np

from ulna.collision.objects import Obstacle
from ulna.collision.point_sets import thinned
from ulna.collision.world import World
from ulna.data_classes import dataclass
from ulna.errors import InputError, ModelError, ModelWarning, needed
from ulna.geometry import Capsule, Ellipsoid, HeightField, Mesh, Plane, PointCloud, Shape, Sphere
from ulna.geometry.meshes import merged, read_pieces
from ulna.geometry.shapes import half_edges
from ulna.model import Model
from ulna.spatial import SE3
from ulna.system.cached import cached_property
from ulna.system.callers import level_of_caller
from ulna.typing import Array, Floats

Missing = Literal["error", "skip"]


@final
@dataclass(frozen=True, eq=False)
class Solid:
    """One solid shape on a link or in the world.

    Attributes:
        owner: Name of the link or of the obstacle.
        shape: The shape in its own frame.
        joint: Index of the joint that carries it; -1 where nothing moves it.
        placement: T_joint_shape; T_world_shape for -1.
        vertices: Of a mesh, height field or cloud, its points in the shape's frame, (n, 3) [m]; else empty.
        triangles: Of a mesh or height field, its triangles, (m, 3); else empty.
        rounding: How far the solid reaches beyond these points [m].
    """

    owner: str
    shape: Shape
    joint: int
    placement: SE3
    vertices: Floats
    triangles: Array
    rounding: float = 0.0

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Centre and half edges of the box around it in its own frame, (3,) each [m]; infinite for a plane."""
        if len(self.vertices):
            low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
            return (low + high) / 2.0, (high - low) / 2.0 + self.rounding
        return np.zeros(3), np.array(_half_edges(self.shape))

    @property
    def radius(self) -> float:
        """Radius of the ball around the centre of `bounds` that holds it [m]."""
        centre, half = self.bounds
        if len(self.vertices):
            return float(np.sqrt(((self.vertices - centre) ** 2).sum(axis=1).max())) + self.rounding
        if isinstance(self.shape, (Sphere, Capsule, Ellipsoid)):
            return float(half.max())
        return float(np.sqrt((half**2).sum()))


def link_solids(model: Model, missing: Missing = "error") -> tuple[Solid, ...]:
    """The collision geometry of a model's links.

    Warns (ModelWarning), once for a model, of links that are drawn and have no collision geometry.

    Args:
        model: The robot.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The solids, in the order of the links.

    Raises:
        ModelError: If no link has collision geometry, a mesh file is missing, or a plane moves.
        MissingExtra: If there are meshes and trimesh is not installed.
        InputError: `missing` is neither "error" nor "skip".
    """
    if missing not in ("error", "skip"):
        raise InputError(f"missing={missing!r}; expected 'error' or 'skip'.")
    modification_times = _modification_times(model)
    # of a file that is missing each call says so
    solids = (_link_solids.__wrapped__ if None in modification_times else _link_solids)(
        model, missing, modification_times
    )
    if not solids:
        raise ModelError(
            f"Robot {model.name!r} has no collision geometry, so nothing can be said about its collisions. "
            "Give its links <collision> elements, or `collisions=` of ModelBuilder.add_link."
        )
    _warn_of_unseen(model)
    return solids


@functools.lru_cache(maxsize=64)
def _warn_of_unseen(model: Model) -> None:
    """Warns once of links that are drawn and have no collision geometry."""
    unseen = [repr(link.name) for link in model.links if link.visuals and not link.collisions]
    if unseen:
        warnings.warn(
            f"Robot {model.name!r} has links that can be seen and have no collision geometry: {', '.join(unseen)}. "
            "No check includes them; give them <collision> elements.",
            ModelWarning,
            stacklevel=level_of_caller(),
        )


def _modification_times(model: Model) -> tuple[Any, ...]:
    """The mesh files of a model's links and when they were changed; None for one that is missing."""
    shapes = (geometry.shape for link in model.links for geometry in link.collisions)
    return tuple(_modification_time(shape) for shape in shapes if isinstance(shape, Mesh))


def _modification_time(mesh: Mesh) -> tuple[str, int] | None:
    if mesh.path is None or mesh.missing or not os.path.isfile(mesh.path):
        return None
    return mesh.path, os.stat(mesh.path).st_mtime_ns


@functools.lru_cache(maxsize=8)
def _link_solids(model: Model, missing: Missing, modification_times: tuple[Any, ...]) -> tuple[Solid, ...]:
    """The solids of a model's links; cached, since a plan asks for them several times."""
    solids = []
    for link in model.links:
        for geometry in link.collisions:
            if isinstance(geometry.shape, PointCloud | HeightField):
                raise ModelError(
                    f"Link {link.name!r} of robot {model.name!r} is a {geometry.shape.describe()}; expected a body. "
                    "Put it into the world."
                )
            if isinstance(geometry.shape, Plane) and link.joint >= 0:
                raise ModelError(
                    f"Link {link.name!r} of robot {model.name!r} moves, and a plane on it would fill half of space. "
                    "Give it a Box."
                )
            solid = solid_of(
                f"link {link.name!r} of robot {model.name!r}",
                link.name,
                geometry.shape,
                link.joint,
                link.placement @ geometry.placement,
                missing,
            )
            if solid is not None:
                solids.append(solid)
    return tuple(solids)


def obstacle_solids(world: World, missing: Missing = "error") -> tuple[Solid, ...]:
    """The obstacles of a world; see `link_solids`.

    Args:
        world: The obstacles.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The solids, in the order of the obstacles.
    """
    solids = (obstacle_solid(obstacle, missing) for obstacle in world)
    return tuple(solid for solid in solids if solid is not None)


def obstacle_solid(obstacle: Obstacle, missing: Missing) -> Solid | None:
    """An obstacle as a solid; see `solid_of`.

    Args:
        obstacle: The obstacle.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The solid; None where there is nothing to check.
    """
    name = obstacle.name
    return solid_of(f"obstacle {name!r}", name, obstacle.shape, -1, obstacle.pose, missing)


def solid_of(
    place: str, owner: str, shape: Shape, joint: int, placement: SE3, missing: Missing
) -> Solid | None:
    """A shape as a solid, with its mesh read.

    Args:
        place: What it is, for messages.
        owner: Name of the link or object.
        shape: The shape.
        joint: Index of the joint that carries it; -1 where nothing moves it.
        placement: T_joint_shape; T_world_shape for -1 [m].
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The solid; None where its mesh is missing and skipped, or a cloud is empty.

    Raises:
        ModelError: If the mesh is missing, or the shape has no volume.
    """
    vertices, triangles = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    if isinstance(shape, Mesh):
        if shape.path is None or shape.missing or not os.path.isfile(shape.path):
            text = f"The collision mesh {shape.path or '(no file named)'} of {place} was not found"
            if missing == "error":
                raise ModelError(
                    f"{text}. Put the file there, or pass missing='skip' to go without that shape."
                )
            warnings.warn(
                f"{text}; its collisions are not checked.", ModelWarning, stacklevel=level_of_caller()
            )
            return None
        vertices, triangles = _read(shape.path, os.stat(shape.path).st_mtime_ns)
        vertices = vertices * np.array(shape.scale)
        if np.prod(shape.scale) < 0:
            triangles = triangles[:, ::-1]
    elif isinstance(shape, HeightField):
        vertices, triangles = shape.triangles()
    elif isinstance(shape, PointCloud):
        vertices, rounding = thinned(shape)
        return Solid(owner, shape, joint, placement, vertices, triangles, rounding) if len(vertices) else None
    elif not isinstance(shape, Plane) and min(_half_edges(shape)) <= 0.0:
        raise ModelError(f"The {shape.describe()} of {place} has no volume. Give it lengths above 0.")
    return Solid(owner, shape, joint, placement, vertices, triangles)


@functools.lru_cache(maxsize=256)
def _read(path: str, stamp: int) -> tuple[Floats, Array]:
    """Vertices and triangles of a file that was changed at `stamp`, read once."""
    return merged(read_pieces(path))


def _half_edges(shape: Shape) -> tuple[float, float, float]:
    half = half_edges(shape)
    if half is None:
        raise InputError(f"{shape.describe()} takes no part in collisions.")
    return half


def qhull_of(vertices: Floats) -> Any:
    """What Qhull finds of the convex hull of points (n, 3): a `scipy.spatial.ConvexHull`.

    Raises:
        MissingExtra: If scipy is not installed.
        InputError: If the points lie in a plane.
    """
    with needed("scipy", "collision", "Taking convex hulls"):
        from scipy.spatial import ConvexHull, QhullError
    try:
        return ConvexHull(vertices)
    except QhullError as error:
        raise InputError(
            "The points of a mesh lie in a plane and have no convex hull with a volume. "
            "Put a thin Box in its place, or use exact checks with convex=False."
        ) from error


def hull(vertices: Floats) -> tuple[Floats, Array]:
    """The convex hull of points (n, 3): its corners and its triangles, anticlockwise seen from outside.

    Raises:
        MissingExtra: If scipy is not installed.
        InputError: If the points lie in a plane.
    """
    qhull = qhull_of(vertices)
    corners = qhull.vertices
    place = np.full(len(vertices), -1)
    place[corners] = np.arange(len(corners))
    triangles = qhull.simplices.copy()
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    inward = (np.cross(b - a, c - a) * qhull.equations[:, :3]).sum(axis=1) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return vertices[corners], place[triangles]
