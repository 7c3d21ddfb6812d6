"""What geometries look like."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence

from pinocchio._geometry.geometry_object import GeometryObject
from pinocchio.visualize.coal_figures import content_of, triangles_of
from ulna.errors import InputError, MissingExtra, ModelWarning
from ulna.geometry import Mesh
from ulna.viewer.colours import RGBA, colour
from ulna.viewer.graph.content import Content
from ulna.viewer.mesh.mesh_files import load_mesh
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.mesh.surface import Surface
from ulna.viewer.mesh.vertex_normals import surface_with_normals


def figure_of(
    geometry: GeometryObject, color: Sequence[float] | None = None
) -> tuple[Sequence[Surface], Content | None]:
    """What a geometry looks like in its own frame.

    Args:
        geometry: The geometry.
        color: Red, green, blue, opacity; its own by default.

    Returns:
        The surfaces, and the points or boxes of a node.
    """
    content = content_of(geometry.geometry, _rgba(geometry, color)) if geometry.shape is None else None
    return (surfaces_of(geometry, color) if content is None else ()), content


def _rgba(geometry: GeometryObject, color: Sequence[float] | None) -> RGBA:
    return colour(float(c) for c in (geometry.meshColor if color is None else color))


def surfaces_of(geometry: GeometryObject, color: Sequence[float] | None = None) -> list[Surface]:
    """The surfaces of a geometry in its own frame.

    A mesh file that is missing or cannot be read is left out, with a warning.

    Args:
        geometry: The geometry.
        color: Red, green, blue, opacity; its own by default.

    Returns:
        The surfaces.
    """
    shape = geometry.shape
    rgba = _rgba(geometry, color)
    if shape is None:
        return [surface_with_normals(*triangles_of(geometry.geometry), rgba)]
    if not isinstance(shape, Mesh):
        return [tessellate(shape, rgba)]
    if shape.path is None or not os.path.isfile(shape.path):
        warnings.warn(
            f"The mesh {shape.path!r} of {geometry.name!r} was not found.", ModelWarning, stacklevel=3
        )
        return []
    try:
        surfaces = list(load_mesh(shape.path, shape.scale))
    except (InputError, MissingExtra) as error:
        warnings.warn(f"{geometry.name!r} is not shown: {error}", ModelWarning, stacklevel=3)
        return []
    return (
        [s.coloured(rgba) for s in surfaces] if geometry.overrideMaterial or color is not None else surfaces
    )
