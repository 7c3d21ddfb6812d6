"""How far spheres on a robot's links are from each other and from a world, in the scalar's own algebra.

| symbol | meaning | shape | unit |
|---|---|---|---|
| c, r | centre in the world and radius of a sphere | (3,), () | [m] |
| p | centre in an obstacle's frame, p = R^T (c - t) | (3,) | [m] |
| h, m | half edges of a box, and how far it is rounded: m alone is a ball, h_z and m a capsule | (3,), () | [m] |
| g | p beyond the faces, g = abs(p) - h | (3,) | [m] |
| rho, z | distance of c from a cylinder's axis, and its height along the axis | (), () | [m] |
| d | signed distance: of a box min(max(g), 0) + abs(max(g, 0)) - m - r | () | [m] |

Source: Ericson, Real-Time Collision Detection (2005), section 5.1, on nearest points of boxes and cylinders. A
covering sphere is never farther than what it covers, so that d is no more than the distance of the real shapes while
that is positive. These functions run on floats, on symbols and on traces; what is compiled from them is
`ulna.collision.compiled`, and whatever calls `sphere_clearance`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from ulna import disk_cache
from ulna.collision.cover import cover
from ulna.collision.objects import Obstacle
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Missing, Solid, link_solids, obstacle_solids
from ulna.collision.spheres import Spheres
from ulna.collision.world import World
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.geometry import Box, Capsule, Cone, Cylinder, HeightField, Plane, PointCloud, Sphere
from ulna.model import Model
from ulna.model.content import fingerprint
from ulna.numeric import maximum, minimum, sqrt
from ulna.spatial import SE3
from ulna.typing import Array, Floats

Kind = Literal["box", "cylinder", "plane"]

_VERSION = "balls of parts 1"
_COVER_TOLERANCE = 0.01  # [m] tolerance of spheres that stand for meshes and ellipsoids of the world
_STEP = 0.004  # [m] by which the cylinders that stand for a cone differ
_MAX_COVER_SOLIDS = 24  # of such spheres or cylinders


@dataclass(frozen=True, eq=False)
class Part:
    """A piece of an obstacle that a formula knows: a rounded box, a cylinder or a half space.

    Attributes:
        owner: Name of the obstacle.
        kind: Which formula.
        placement: T_obstacle_part.
        sizes: h and m of a box, (4,); radius and half length of a cylinder, (2,); nothing of a plane, (0,).
    """

    owner: str
    kind: Kind
    placement: SE3
    sizes: Floats

    def grown(self, by: float) -> Part:
        """The part made larger.

        Args:
            by: By how much at least [m]; a cylinder stays one, so that its rims grow by more.

        Returns:
            A part.
        """
        if not by:
            return self
        if self.kind == "plane":
            lifted = self.placement @ SE3.from_translation([0.0, 0.0, by])
            return Part(self.owner, self.kind, lifted, self.sizes)
        more = [0.0, 0.0, 0.0, by] if self.kind == "box" else [by, by]
        return Part(self.owner, self.kind, self.placement, self.sizes + np.array(more))


def parts(world: World, missing: Missing = "error") -> tuple[Part, ...]:
    """The parts of a world's obstacles; cones become cylinders, meshes (by convex hulls) and ellipsoids spheres.

    Args:
        world: The obstacles.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The parts, in the order of the obstacles.
    """
    return tuple(part for solid in obstacle_solids(world, missing) for part in _parts(solid))


def _parts(solid: Solid) -> list[Part]:
    place, name = SE3.identity(), solid.owner
    match solid.shape:
        case Box(size=(x, y, z)):
            return [Part(name, "box", place, np.array([x / 2.0, y / 2.0, z / 2.0, 0.0]))]
        case Sphere(radius=r):
            return [Part(name, "box", place, np.array([0.0, 0.0, 0.0, r]))]
        case Capsule(radius=r, length=length):
            return [Part(name, "box", place, np.array([0.0, 0.0, length / 2.0, r]))]
        case Cylinder(radius=r, length=length):
            return [Part(name, "cylinder", place, np.array([r, length / 2.0]))]
        case Plane():
            return [Part(name, "plane", place, np.zeros(0))]
        case Cone(radius=r, length=length):
            return _slices(name, r, length)
        case PointCloud() | HeightField():
            raise InputError(
                f"Obstacle {name!r} is a {solid.shape.describe()}, which has no formula that can be compiled; expected "
                "a body. Ask robot.collides, robot.distance, or a SphereChecker."
            )
    return [
        Part(name, "box", SE3.from_translation(ball[:3]), np.append(np.zeros(3), ball[3]))
        for ball in _balls(solid)
    ]


def _balls(solid: Solid) -> Floats:
    """Centres and radii of balls that contain a solid, shape (n, 4) [m]; from the disk where they were made before."""
    content = fingerprint([solid.shape, solid.vertices[solid.triangles] if len(solid.triangles) else None])
    name = disk_cache.key(_VERSION, content)
    stored = disk_cache.read(name)
    if stored is not None:
        return np.frombuffer(stored).reshape(-1, 4)
    centres, radii, _ = cover([solid], [SE3.identity()], _COVER_TOLERANCE, _MAX_COVER_SOLIDS)
    balls = np.column_stack([centres, radii])
    disk_cache.write(name, balls.tobytes())
    return balls


def _slices(name: str, radius: float, length: float) -> list[Part]:
    """A cone as a stack of cylinders, none of which sticks out by more than the step from one to the next."""
    n = int(np.clip(np.ceil(radius / _STEP), 4, _MAX_COVER_SOLIDS))
    return [
        Part(
            name,
            "cylinder",
            SE3.from_translation([0.0, 0.0, ((k + 0.5) / n - 0.5) * length]),
            np.array([radius * (1.0 - k / n), length / (2.0 * n)]),
        )
        for k in range(n)
    ]


def fixed_parts(
    model: Model, pairs: Sequence[LinkPair], missing: Missing = "error"
) -> list[tuple[Part, tuple[str, ...]]]:
    """The parts of links that never move, placed in the world.

    They need no spheres: the spheres of the others are checked against their real shapes.

    Args:
        model: The robot.
        pairs: Pairs of links, or of a link and an attached object.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        Each part with the names of the links and objects that it is checked against.
    """
    partners: dict[str, list[str]] = {}
    still = {link.name for link in model.links if link.joint < 0}
    for a, b in pairs:
        for one, other in ((a, b), (b, a)):
            if one in still:
                partners.setdefault(one, []).append(other)
    return [
        (
            Part(part.owner, part.kind, solid.placement @ part.placement, part.sizes),
            tuple(partners[solid.owner]),
        )
        for solid in link_solids(model, missing)
        if solid.owner in partners
        for part in _parts(solid)
    ]


def row(part: Part, pose: SE3) -> Floats:
    """The numbers that describe a placed part.

    Of a box R, t, h, m; of a cylinder its axis, t, radius and half length; of a plane its normal and a point.

    Args:
        part: The part.
        pose: Pose of its obstacle, T_world_obstacle [m].

    Returns:
        The numbers, shape (..., n).
    """
    T = pose @ part.placement
    batch = T.translation.shape[:-1]
    sizes = np.broadcast_to(part.sizes, (*batch, len(part.sizes)))
    if part.kind == "box":
        return np.concatenate([T.rotation.reshape(*batch, 9), T.translation, sizes], axis=-1)
    return np.concatenate([T.rotation[..., :, 2], T.translation, sizes], axis=-1)


WIDTH: Mapping[Kind, int] = {"box": 16, "cylinder": 8, "plane": 6}
"""How many numbers a row of each kind has."""


def squared(kind: Kind, c: Array, numbers: Array) -> tuple[Any, Any]:
    """The squared distance of a point from a part before rounding, and how far the part is rounded: no roots where
    none are needed.

    Args:
        kind: Its kind: "box", "cylinder" or "plane".
        c: The point, shape (3,) [m].
        numbers: What `row` returns for it, shape (..., n).

    Returns:
        The squared distance [m^2], zero inside, and the radius of the rounding [m].
    """
    g = _beyond(kind, c, numbers)
    outside = [maximum(x, 0.0) for x in g]
    total = outside[0] * outside[0]
    for x in outside[1:]:
        total = total + x * x
    return total, (numbers[15] if kind == "box" else 0.0)


def signed(kind: Kind, c: Array, numbers: Array) -> Any:
    """The signed distance of a point from a part.

    Args:
        kind: Its kind: "box", "cylinder" or "plane".
        c: The point, shape (3,) [m].
        numbers: What `row` returns for it, shape (..., n).

    Returns:
        The distance [m], negative inside.
    """
    g = _beyond(kind, c, numbers)
    if kind == "plane":
        return g[0]
    deepest = g[0]
    for x in g[1:]:
        deepest = maximum(deepest, x)
    inside = minimum(deepest, 0.0)
    total, m = squared(kind, c, numbers)
    return inside + root(total) - m


def root(x: Any) -> Any:
    """The square root, with a derivative at 0 as well."""
    return sqrt(x + 2e-38)  # above zero in single precision, too


def _beyond(kind: Kind, c: Array, numbers: Array) -> list[Any]:
    if kind == "plane":
        v = c - numbers[3:6]
        return [numbers[:3] @ v]
    if kind == "box":
        p = (c - numbers[9:12]) @ numbers[:9].reshape(3, 3)
        return [abs(p[k]) - numbers[12 + k] for k in range(3)]
    v = c - numbers[3:6]
    z = numbers[:3] @ v
    across = v - numbers[:3] * z
    return [root(across @ across) - numbers[6], abs(z) - numbers[7]]


def self_pairs(model: Model, spheres: Spheres, pairs: Sequence[LinkPair]) -> list[tuple[str, int, str, int]]:
    """Every two spheres that move and are checked against each other.

    Args:
        model: The robot.
        spheres: Spheres of the links and of attached objects.
        pairs: Pairs of links and attached objects.

    Returns:
        Name and number of the first, name and number of the second sphere.
    """
    still = {link.name for link in model.links if link.joint < 0}
    return [
        (a, i, b, j)
        for a, b in pairs
        if a not in still and b not in still
        for i in range(len(spheres.links[a].radii))
        for j in range(len(spheres.links[b].radii))
    ]


def checked_links(model: Model, spheres: Spheres, obstacle: Obstacle, world: World) -> list[str]:
    """The links and attached objects that an obstacle is checked against.

    Args:
        model: The robot.
        spheres: Spheres of the links and of attached objects.
        obstacle: The obstacle.
        world: Its world.

    Returns:
        Their names, in the order of `model.links`, then of the world's attachments.
    """
    links = [
        link.name
        for link in model.links
        if link.name in spheres.links
        and link.name not in obstacle.touches
        and (link.joint >= 0 or obstacle.moving)
    ]
    return links + [
        item.name
        for item in world.attachments
        if item.name in spheres.links
        and item.name not in obstacle.touches
        and obstacle.name not in item.touches
    ]
