"""Inertias of links computed from their shapes, for descriptions whose inertias are missing or made up."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterable, Mapping
from functools import partial, reduce
from operator import add
from typing import Any, Literal

import numpy as np

from ulna.checks.values import number
from ulna.collision.solids import hull
from ulna.errors import InputError, ModelWarning, UnknownName
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Geometry, Mesh, Shape, Sphere
from ulna.geometry.meshes import merged, read_pieces
from ulna.model import Link, Model
from ulna.spatial import Inertia
from ulna.spatial.solid_moments import is_closed, solid_moments
from ulna.system.callers import level_of_caller
from ulna.typing import Array, Floats

_KINDS = ("collision", "visual")


def shape_inertias(
    robot: Any,
    links: Iterable[str] | None = None,
    *,
    masses: Mapping[str, float] | None = None,
    density: float | None = None,
    shapes: Literal["collision", "visual"] = "collision",
) -> dict[str, Inertia]:
    """Inertias of links as solids of one density that fill their shapes.

    The mass of a link is that in `masses`, else its own, else its volume times `density`. Where shapes of a link
    overlap, the common part counts twice. A mesh that is not closed counts as its convex hull, with a warning.

    Args:
        robot: A `Robot` or a `Model`.
        links: Names of links; by default all that have shapes.
        masses: For names of links, the mass [kg].
        density: Of links that have no mass [kg/m^3]: 2700 for aluminium, 1000 to 1250 for printed plastic.
        shapes: Which shapes are taken; a link that has none of these is computed from its others.

    Returns:
        For each link its inertia in the link's frame, for `robot.with_link_inertias`.

    Raises:
        UnknownName: There is no such link, or `shapes` is something else.
        InputError: A link has no shapes, no mass, or a shape without a volume.

    Example:
        >>> robot = ulna.load("panda")
        >>> inertias = ulna.diagnosis.shape_inertias(robot, ["panda_leftfinger"], density=2700.0)
        >>> solid = robot.with_link_inertias(inertias)
    """
    if shapes not in _KINDS:
        raise UnknownName("kind of shapes", shapes, _KINDS)
    model: Model = getattr(robot, "model", robot)
    if density is not None:
        density = number("density", density, "a density above 0 [kg/m^3]", above=0.0)
    expected = "a mass above 0 [kg]"
    masses = {name: number(f"masses[{name!r}]", m, expected, above=0.0) for name, m in (masses or {}).items()}
    names = [link.name for link in model.links if _shapes(link, shapes)] if links is None else list(links)
    chosen = [model.links[model.link_index(name)] for name in names]
    for name in masses:
        model.link_index(name)
        if name not in names:
            raise InputError(
                f"`masses` has {name!r}, which is none of the links: {', '.join(names) or 'none'}."
            )
    return {link.name: _inertia(link, shapes, masses.get(link.name), density) for link in chosen}


def _inertia(link: Link, kind: str, mass: float | None, density: float | None) -> Inertia:
    geometries = _shapes(link, kind)
    if not geometries:
        raise InputError(f"Link {link.name!r} has no shapes to compute an inertia from.")
    solids = [_solid(link.name, geometry) for geometry in geometries]
    combined = reduce(add, solids)  # of density 1, so that its mass is the volume
    if mass is None:
        link_mass = float(link.inertia.mass)
        if link_mass <= 0.0 and density is None:
            raise InputError(
                f"Link {link.name!r} has no mass. Pass density= [kg/m^3], or its mass: masses={{{link.name!r}: 1.0}}."
            )
        mass = link_mass if link_mass > 0.0 else float(combined.mass) * float(density or 0.0)
    return Inertia(mass, combined.com, combined.inertia * (mass / combined.mass))


def _shapes(link: Link, kind: str) -> tuple[Geometry, ...]:
    either = (link.collisions, link.visuals)
    first, second = either if kind == "collision" else either[::-1]
    return tuple(first) or tuple(second)


def _solid(link: str, geometry: Geometry) -> Inertia:
    """The inertia of a shape of density 1 in the frame of its link."""
    shape = geometry.shape
    if isinstance(shape, Mesh):
        return geometry.placement.act(_of_mesh(link, shape))
    volume, inertia_of = _primitive(shape)
    if volume <= 0.0:
        raise InputError(f"Link {link!r}: {shape.describe()} has no volume to compute an inertia from.")
    return geometry.placement.act(inertia_of(volume))


def _primitive(shape: Shape) -> tuple[float, Callable[[float], Inertia]]:
    """The volume of a shape [m^3], and what makes its inertia for a mass; no volume where it is no solid."""
    match shape:
        case Box(size=size):
            return math.prod(size), partial(Inertia.from_box, size=size)
        case Sphere(radius=r):
            return 4.0 / 3.0 * math.pi * r**3, partial(Inertia.from_sphere, radius=r)
        case Ellipsoid(radii=radii):
            return 4.0 / 3.0 * math.pi * math.prod(radii), partial(Inertia.from_ellipsoid, radii=radii)
        case Cylinder(radius=r, length=h):
            return math.pi * r**2 * h, partial(Inertia.from_cylinder, radius=r, length=h)
        case Capsule(radius=r, length=h):
            return math.pi * r**2 * (h + 4.0 / 3.0 * r), partial(Inertia.from_capsule, radius=r, length=h)
        case Cone(radius=r, length=h):
            return math.pi * r**2 * h / 3.0, partial(Inertia.from_cone, radius=r, length=h)
    return 0.0, lambda mass: Inertia.zero()


def _of_mesh(link: str, mesh: Mesh) -> Inertia:
    if mesh.path is None or mesh.missing:
        raise InputError(
            f"Link {link!r}: {mesh.describe()} cannot be read. Pass package_dirs=[folder of the packages] to `load`."
        )
    pieces = read_pieces(mesh.path)
    surfaces = [(piece.vertices * np.array(mesh.scale), piece.triangles) for piece in pieces]
    if not all(
        is_closed(*surface) for surface in surfaces
    ):  # a file may split one closed surface by material
        vertices, triangles = merged(pieces)
        surfaces = [_closed(link, mesh, vertices * np.array(mesh.scale), triangles)]
    volumes = [solid_moments(*surface)[0] for surface in surfaces]
    return reduce(add, (Inertia.from_mesh(v, *s) for v, s in zip(volumes, surfaces, strict=True)))


def _closed(link: str, mesh: Mesh, vertices: Floats, triangles: Array) -> tuple[Floats, Array]:
    if is_closed(vertices, triangles):
        return vertices, triangles
    warnings.warn(
        f"Link {link!r}: {mesh.describe()} is not closed; its inertia is that of its convex hull.",
        ModelWarning,
        stacklevel=level_of_caller(),
    )
    return hull(vertices)
