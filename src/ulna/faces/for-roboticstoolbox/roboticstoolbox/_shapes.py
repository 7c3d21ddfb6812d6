"""Shapes as Ulna has them, out of those of spatialgeometry or Ulna's own."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.geometry import Geometry, Material, Shape
from ulna.spatial import SE3


def obstacle(shape: Any) -> tuple[Shape, SE3]:
    """A shape in its own frame, and where that is in the world.

    Raises:
        InputError: It is none that can be touched.
    """
    solid = getattr(shape, "solid", shape)
    if not isinstance(solid, Shape):
        raise InputError(f"{shape!r} cannot be touched; expected a shape such as spatialgeometry.Sphere.")
    T = getattr(shape, "_wT", getattr(shape, "T", np.eye(4)))
    return solid, SE3.from_matrix(np.asarray(T, dtype=float))


def geometry(shape: Any, name: str) -> Geometry:
    """A shape of a link."""
    if isinstance(shape, Geometry):
        return shape
    solid, T = obstacle(shape)
    paint = getattr(shape, "color", None)
    material = None if paint is None else Material(rgba=tuple(float(x) for x in paint))  # type: ignore[arg-type]
    return Geometry(name, solid, T, material)
