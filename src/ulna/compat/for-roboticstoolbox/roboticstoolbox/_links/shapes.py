"""Shapes of Ulna from those of spatialgeometry or of Ulna."""

from __future__ import annotations

import copy
import os
from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.geometry import Box, Capsule, Cylinder, Geometry, Material, Mesh, Shape, Sphere
from ulna.spatial import SE3


def obstacle(shape: Any) -> tuple[Shape, SE3]:
    """A shape, and the pose of its frame in the world.

    Raises:
        InputError: It is none that can be touched.
    """
    T = getattr(shape, "_wT", getattr(shape, "T", np.eye(4)))
    return _solid(shape), SE3.from_matrix(np.asarray(T, dtype=float))


def _solid(shape: Any) -> Shape:
    solid = getattr(shape, "solid", shape)
    if not isinstance(solid, Shape):
        raise InputError(f"{shape!r} cannot be touched; expected a shape such as spatialgeometry.Sphere.")
    return solid


def geometry(shape: Any, name: str) -> Geometry:
    """A shape of a link, with its pose in the link.

    Args:
        shape: A shape of Ulna or of spatialgeometry.
        name: Name of the result.

    Returns:
        The geometry.
    """
    if isinstance(shape, Geometry):
        return shape
    solid, T = (_solid(shape), SE3.from_matrix(shape.T)) if _hangs_on_link(shape) else obstacle(shape)
    paint = getattr(shape, "color", None)
    material = None if paint is None else Material(rgba=tuple(float(x) for x in paint))  # type: ignore[arg-type]
    return Geometry(name, solid, T, material)


def as_shapes(shapes: list[Any], link: Any) -> list[Any]:
    """The same list, with shapes of a model converted to shapes of spatialgeometry attached to the link.

    Meshes without a file are not converted.

    Args:
        shapes: Shapes of Ulna or of spatialgeometry; the list is changed.
        link: The link.

    Returns:
        The list.
    """
    for i, item in enumerate(shapes):
        if isinstance(item, Geometry):
            shapes[i] = _shape(item)
    return carried(shapes, link)


def carried(shapes: list[Any], link: Any) -> list[Any]:
    """Shapes as parts of a link: their poses are relative to it, and they are not nodes of its tree.

    Args:
        shapes: The shapes.
        link: The link.

    Returns:
        The list.
    """
    for shape in shapes:
        if getattr(shape, "_parent", link) is None:
            shape._parent = link
    return shapes


def copied(shape: Any) -> Any:
    """A copy of a shape for another link; shapes of a model are immutable and shared."""
    if isinstance(shape, Geometry) or not _hangs_on_link(shape):
        return shape
    out = copy.copy(shape)
    out._parent, out._children = None, []
    return out


def _hangs_on_link(shape: Any) -> bool:
    return hasattr(getattr(shape, "_parent", None), "_solids")


def _shape(item: Geometry) -> Any:
    import spatialgeometry as sg

    paint = None if item.material is None else item.material.rgba
    more = {"pose": item.placement.matrix(), "color": paint}
    match item.shape:
        case Box(size):
            return sg.Cuboid(size, **more)
        case Sphere(radius):
            return sg.Sphere(radius, **more)
        case Cylinder(radius, length):
            return sg.Cylinder(radius, length, **more)
        case Capsule(radius, length):
            return sg.Capsule(radius, length, **more)
        case Mesh(path, scale) if path is not None and os.path.isfile(path):
            return sg.Mesh(path, scale, **more)
    return item
