"""Geometries of a graph's bodies: boxes, spheres, cylinders, capsules and meshes."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import real, vector
from pinocchio._containers.enums import _Named
from pinocchio._spatial.se3 import SE3
from ulna.geometry import Box as BoxShape
from ulna.geometry import Capsule as CapsuleShape
from ulna.geometry import Cylinder as CylinderShape
from ulna.geometry import Shape
from ulna.geometry import Sphere as SphereShape

__all__ = [
    "BOTH",
    "COLLISION",
    "VISUAL",
    "Box",
    "Capsule",
    "Cylinder",
    "GeomType",
    "Geometry",
    "Mesh",
    "Sphere",
]


class GeomType(_Named):
    """What a geometry is for; the values are those of Pinocchio."""

    VISUAL = 0
    COLLISION = 1
    BOTH = 2


VISUAL, COLLISION, BOTH = GeomType


class Box:
    """A box of three side lengths [m]."""

    def __init__(self, size: Any = (1.0, 1.0, 1.0)) -> None:
        self.size = vector(size, 3, "size").copy()
        """Side lengths (3,) [m]."""

    def shape(self) -> Shape:
        """The shape."""
        x, y, z = self.size.tolist()
        return BoxShape((x, y, z))


class Sphere:
    """A sphere of a radius [m]."""

    def __init__(self, radius: float = 1.0) -> None:
        self.radius = real(radius, "radius")
        """Radius [m]."""

    def shape(self) -> Shape:
        """The shape."""
        return SphereShape(self.radius)


class Cylinder:
    """A cylinder: radius and height [m]."""

    def __init__(self, size: Any = (1.0, 1.0)) -> None:
        self.size = vector(size, 2, "size").copy()
        """Radius and height (2,) [m]."""

    def shape(self) -> Shape:
        """The shape."""
        return CylinderShape(*self.size.tolist())


class Capsule:
    """A capsule: radius, and length of its cylinder [m]."""

    def __init__(self, size: Any = (1.0, 1.0)) -> None:
        self.size = vector(size, 2, "size").copy()
        """Radius and length (2,) [m]."""

    def shape(self) -> Shape:
        """The shape."""
        return CapsuleShape(*self.size.tolist())


class Mesh:
    """A mesh in a file."""

    def __init__(self, path: str = "") -> None:
        self.path = str(path)
        """The file."""


class Geometry:
    """One geometry of a body.

    Args:
        name: Its name.
        placement: Its pose in the body; the identity by default.
        type: Whether it is seen, collides, or both.
        scale: Factors along x, y, z, (3,).
        color: Red, green, blue, opacity from 0 to 1, (4,).
        geometry: Box, Sphere, Cylinder, Capsule or Mesh.
    """

    def __init__(
        self,
        name: str = "",
        placement: SE3 | None = None,
        type: GeomType = BOTH,
        scale: Any = (1.0, 1.0, 1.0),
        color: Any = (1.0, 1.0, 1.0, 1.0),
        geometry: Any = None,
    ) -> None:
        self.name = name
        """Its name."""
        self.placement = SE3() if placement is None else SE3(placement)
        """Its pose in the body."""
        self.type = GeomType(type)
        """Whether it is seen, collides, or both."""
        self.scale = np.array(vector(scale, 3, "scale"))
        """Factors along x, y, z, (3,)."""
        self.color = np.array(vector(color, 4, "color"))
        """Red, green, blue, opacity (4,)."""
        self.geometry = Box() if geometry is None else checked_shape(geometry)
        """Box, Sphere, Cylinder, Capsule or Mesh."""


def checked_shape(value: Any) -> Any:
    """A shape of this module; raises ArgumentError for another thing."""
    if not isinstance(value, (Box, Sphere, Cylinder, Capsule, Mesh)):
        raise ArgumentError(
            f"The geometry is {value!r}; expected a Box, Sphere, Cylinder, Capsule or Mesh of pinocchio.graph."
        )
    return value
