"""Solids of a few dimensions: boxes, balls, cylinders, capsules, cones, ellipsoids."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from spatialgeometry._collision import CollisionShape
from spatialgeometry._shape import Length
from ulna import geometry
from ulna.typing import Floats

__all__ = ["Box", "Capsule", "Cone", "Cuboid", "Cylinder", "Ellipsoid", "Sphere"]


class Cuboid(CollisionShape):
    """A box, centred.

    Args:
        scale: Its edges along x, y, z [m].
        kwargs: As for `CollisionShape`.
    """

    kind, lengths = "cuboid", ("scale",)

    def __init__(self, scale: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.scale = scale

    @property
    def scale(self) -> Floats:
        """Its edges along x, y, z, shape (3,) [m]."""
        return np.array(self._solid.size)

    @scale.setter
    def scale(self, scale: Any) -> None:
        self._solid = geometry.Box(tuple(np.asarray(scale, dtype=float).reshape(-1)))  # type: ignore[arg-type]
        self.changes += 1

    @property
    def solid(self) -> geometry.Box:
        """The box it is."""
        return self._solid


class Box(Cuboid):
    """The former name of `Cuboid`."""

    def __init__(self, *arguments: Any, **more: Any) -> None:
        """A `Cuboid`; see there."""
        warnings.warn("Box is the former name of Cuboid", FutureWarning, stacklevel=2)
        super().__init__(*arguments, **more)


class Sphere(CollisionShape):
    """A ball, centred.

    Args:
        radius: Its radius [m].
        kwargs: As for `CollisionShape`.
    """

    kind, lengths = "sphere", ("radius",)
    radius = Length()

    def __init__(self, radius: float, **kwargs: Any) -> None:
        self.radius = radius
        super().__init__(**kwargs)

    @property
    def solid(self) -> geometry.Sphere:
        """The ball it is."""
        return geometry.Sphere(self.radius)


class _Round(CollisionShape):
    lengths = ("radius", "length")
    radius, length = Length(), Length()

    def __init__(self, radius: float, length: float, **kwargs: Any) -> None:
        self.radius, self.length = radius, length
        super().__init__(**kwargs)


class Cylinder(_Round):
    """A cylinder about z, centred.

    Args:
        radius: Its radius [m].
        length: Its height [m].
        kwargs: As for `CollisionShape`.
    """

    kind = "cylinder"

    @property
    def solid(self) -> geometry.Cylinder:
        """The cylinder it is."""
        return geometry.Cylinder(self.radius, self.length)


class Capsule(_Round):
    """A cylinder about z with half a ball on either end, centred; not in spatialgeometry itself.

    Args:
        radius: Radius of the cylinder and of the balls [m].
        length: Height of the cylinder without the balls [m].
        kwargs: As for `CollisionShape`.
    """

    kind = "capsule"

    @property
    def solid(self) -> geometry.Capsule:
        """The capsule it is."""
        return geometry.Capsule(self.radius, self.length)


class Cone(_Round):
    """A cone about z, its tip up, centred half way; not in spatialgeometry itself.

    Args:
        radius: Radius of its base [m].
        length: Its height [m].
        kwargs: As for `CollisionShape`.
    """

    kind = "cone"

    @property
    def solid(self) -> geometry.Cone:
        """The cone it is."""
        return geometry.Cone(self.radius, self.length)


class Ellipsoid(CollisionShape):
    """An ellipsoid, centred.

    Args:
        radii: Its half axes along x, y, z [m].
        kwargs: As for `CollisionShape`.
    """

    kind, lengths = "ellipsoid", ("radii",)

    def __init__(self, radii: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.radii = radii

    @property
    def radii(self) -> Floats:
        """Its half axes along x, y, z, shape (3,) [m]."""
        return np.array(self._solid.radii)

    @radii.setter
    def radii(self, radii: Any) -> None:
        self._solid = geometry.Ellipsoid(tuple(np.asarray(radii, dtype=float).reshape(-1)))  # type: ignore[arg-type]
        self.changes += 1

    @property
    def solid(self) -> geometry.Ellipsoid:
        """The ellipsoid it is."""
        return self._solid
