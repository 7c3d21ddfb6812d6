"""What geometries look like."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._geometry.geometry_object import GeometryObject
from ulna.errors import InputError, MissingExtra, ModelWarning
from ulna.geometry import Mesh
from ulna.viewer.colours import colour
from ulna.viewer.mesh.mesh_files import load_mesh
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.mesh.surface import Surface
from ulna.viewer.mesh.vertex_normals import surface_with_normals


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
    rgb = geometry.meshColor if color is None else color
    rgba = colour(float(c) for c in rgb)
    if shape is None:
        return [_of_triangles(geometry.geometry, rgba)]
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


def _of_triangles(geometry: Any, rgba: Any) -> Surface:
    """A mesh of coal."""
    vertices = np.array([geometry.vertices(i) for i in range(geometry.num_vertices)])
    triangles = [
        [int(t[k]) for k in range(3)] for t in (geometry.tri_indices(i) for i in range(geometry.num_tris))
    ]
    return surface_with_normals(vertices, np.array(triangles), rgba)
