"""Rounded bodies between points, from which the robots written down here are drawn."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ulna.formats.poses import pose, snapped
from ulna.formats.root import root_kind
from ulna.geometry import Box, Capsule, Cylinder, Geometry, Material, Shape, Sphere
from ulna.model import JointKind, ModelBuilder
from ulna.spatial import SE3, Inertia

WHITE = Material("white", (0.93, 0.94, 0.95, 1.0))
GREY = Material("grey", (0.36, 0.38, 0.41, 1.0))
DARK = Material("dark", (0.16, 0.17, 0.19, 1.0))
SILVER = Material("silver", (0.72, 0.74, 0.76, 1.0))
BLUE = Material("blue", (0.42, 0.65, 0.80, 1.0))

Point = Sequence[float]


def rod(a: Point, b: Point, radius: float, material: Material | None = None) -> Geometry:
    """A capsule between two points.

    Args:
        a, b: Centres of its end balls [m].
        radius: Radius [m].
        material: How it looks; None for the default.

    Returns:
        The geometry; a ball where both points are the same.
    """
    start, end = np.array(a, dtype=float), np.array(b, dtype=float)
    length = float(np.linalg.norm(end - start))
    if length == 0.0:
        return Geometry("", Sphere(radius), pose(a), material)
    return Geometry("", Capsule(radius, length), _between(start, end), material)


def tube(a: Point, b: Point, radius: float, material: Material | None = None) -> Geometry:
    """A cylinder between two points.

    Args:
        a, b: Centres of its ends [m].
        radius: Radius [m].
        material: How it looks; None for the default.

    Returns:
        The geometry.
    """
    start, end = np.array(a, dtype=float), np.array(b, dtype=float)
    return Geometry("", Cylinder(radius, float(np.linalg.norm(end - start))), _between(start, end), material)


def block(
    centre: Point, size: Point, material: Material | None = None, rpy: Point = (0.0, 0.0, 0.0)
) -> Geometry:
    """A box.

    Args:
        centre: Its centre [m].
        size: Its full lengths along its axes [m].
        material: How it looks; None for the default.
        rpy: Roll, pitch, yaw of its axes [rad].

    Returns:
        The geometry.
    """
    shape: Shape = Box((size[0], size[1], size[2]))
    return Geometry("", shape, pose(centre, rpy), material)


def named(link: str, what: str, geometries: Sequence[Geometry]) -> tuple[Geometry, ...]:
    """The same geometries with names made of their link.

    Args:
        link: The name of the link.
        what: What they are for: "visual" or "collision".
        geometries: The geometries.

    Returns:
        Copies, named by link, purpose and number.
    """
    return tuple(
        Geometry(f"{link}_{what}{i}", g.shape, g.placement, g.material) for i, g in enumerate(geometries)
    )


def _between(a: np.ndarray, b: np.ndarray) -> SE3:
    """The pose half way from `a` to `b` with z along the way."""
    z = (b - a) / math.sqrt(float((b - a) @ (b - a)))
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= math.sqrt(float(x @ x))
    return SE3(snapped(np.stack([x, np.cross(z, x), z], axis=-1)), (a + b) / 2.0)


def add_root_and_links(
    builder: ModelBuilder,
    root: str | JointKind | None,
    bodies: Mapping[str, Sequence[Geometry]],
    inertia: Callable[[str], Inertia | None],
    visuals: Mapping[str, tuple[Geometry, ...]] | None,
) -> None:
    """Adds the joint of the root, and links that are drawn as simple shapes.

    Args:
        builder: What they are added to.
        root: How the base hangs in the world: None fixed, "free_flyer", or a joint kind.
        bodies: The shapes of each link, in link coordinates [m]; the links in order.
        inertia: The inertia of a link of that name; None where it has no mass.
        visuals: Geometries to draw instead of the simple shapes, by link name.
    """
    kind = root_kind(root)
    if kind is not None:
        builder.root_joint(kind)
    for link, shapes in bodies.items():
        drawn = (visuals or {}).get(link) or named(link, "visual", shapes)
        plain = tuple(Geometry(g.name, g.shape, g.placement) for g in named(link, "collision", shapes))
        builder.add_link(link, inertia=inertia(link), visuals=drawn, collisions=plain)
