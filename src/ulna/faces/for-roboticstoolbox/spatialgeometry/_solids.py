"""Solids: what is drawn as a surface and can be collided with, through `ulna.collision`."""

from __future__ import annotations

import abc
import functools
import os
import threading
from collections.abc import Iterable
from typing import Any

import numpy as np

from spatialgeometry._node import Members
from spatialgeometry._shape import Length, Shape, box_corners
from ulna import geometry
from ulna.errors import InputError, ShapeError
from ulna.typing import Floats

__all__ = [
    "Box",
    "Capsule",
    "CollisionShape",
    "CollisionShapeGroup",
    "Cone",
    "Cuboid",
    "Cylinder",
    "Ellipsoid",
    "Mesh",
    "Sphere",
]

_LOCK = threading.Lock()  # coal's requests and results are not for two threads at once


class CollisionShape(Shape):
    """A solid.

    Args:
        collision: Whether it can be collided with.
        kwargs: As for `Shape`.
    """

    def __init__(self, collision: bool = True, **kwargs: Any) -> None:
        self._collision = bool(collision)
        super().__init__(**kwargs)

    @property
    def collision(self) -> bool:
        """Whether it can be collided with."""
        return self._collision

    @property
    @abc.abstractmethod
    def solid(self) -> Any:
        """The shape of `ulna.geometry` that it is."""

    def _draw(self, viewer: Any, name: str) -> None:
        viewer.add(self.solid, name=name)

    def _box(self) -> Floats:
        centre, half = _solid(self.solid).bounds
        return box_corners(np.stack([centre - half, centre + half], axis=1))

    def _parts(self) -> list[CollisionShape]:
        if not self._collision:
            raise InputError(f"{self!r} was made with collision=False; it cannot be collided with.")
        return [self]

    def closest_point(
        self, shape: CollisionShape, inf_dist: float = 1.0
    ) -> tuple[float | None, Floats | None, Floats | None]:
        """How near another solid is.

        Args:
            shape: The other.
            inf_dist: What is farther than this is not looked at [m].

        Returns:
            The distance [m], negative where they overlap, and the nearest points on this and on the other in the
            world, (3,); three times None where it is farther.

        Raises:
            InputError: One of them cannot be collided with.
            MissingExtra: coal is not installed.
        """
        if not isinstance(shape, CollisionShape):
            raise InputError(
                f"Cannot measure how near {shape!r} is; expected a solid: Cuboid, Sphere, Mesh ..."
            )
        found = [_distance(a, b) for a in self._parts() for b in shape._parts()]
        nearest = min(found, key=lambda f: f.distance, default=None)
        if nearest is None or nearest.distance > inf_dist:
            return None, None, None
        return nearest.distance, nearest.points[0], nearest.points[1]

    def iscollided(self, shape: CollisionShape) -> bool:
        """Whether it touches another solid."""
        distance = self.closest_point(shape, np.inf)[0]
        return distance is not None and distance <= 0.0

    collided = iscollided


@functools.lru_cache(maxsize=1024)
def _solid(shape: geometry.Shape) -> Any:
    from ulna.collision.solids import obstacle_solids
    from ulna.collision.world import World

    return obstacle_solids(World().add("shape", shape))[0]


@functools.lru_cache(maxsize=1024)
def _narrow(first: geometry.Shape, second: geometry.Shape) -> Any:
    from ulna.collision.narrow import Narrow, geometry_of

    return Narrow([geometry_of(_solid(s), convex=False) for s in (first, second)])


def _distance(first: CollisionShape, second: CollisionShape) -> Any:
    from ulna.collision.narrow import Poses

    poses = np.stack([first._wT, second._wT])[None]
    nothing = np.zeros((1, 2, 3))
    with _LOCK:
        placed = Poses(poses[..., :3, :3], poses[..., :3, 3], nothing, nothing)
        return _narrow(first.solid, second.solid).distance(placed, 0, 0, 1)


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
    """A box: another name of `Cuboid`."""


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
    """A cylinder about z with half a ball on either end, centred; one of Ulna's own.

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
    """A cone about z, its tip up, centred half way; one of Ulna's own.

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


class Mesh(CollisionShape):
    """A mesh file: dae, stl, obj, glb ...

    Args:
        filename: The file.
        scale: A factor for its lengths, or one along each axis.
        color: One colour for all of it; its own when not given.
        y_up: Whether its y is up; it is turned so that z is.
        kwargs: As for `CollisionShape`.

    Raises:
        FileNotFoundError: There is no such file.
    """

    kind, lengths = "mesh", ("scale",)

    def __init__(
        self,
        filename: str | os.PathLike[str] | None = None,
        scale: Any = (1.0, 1.0, 1.0),
        color: Any = None,
        y_up: bool = False,
        **kwargs: Any,
    ) -> None:
        if filename is not None and not os.path.isfile(filename):
            raise FileNotFoundError(f"There is no mesh file {os.fspath(filename)!r}.")
        super().__init__(color=color, **kwargs)
        self._path, self._y_up = None if filename is None else os.path.abspath(filename), bool(y_up)
        self.scale = scale

    @property
    def filename(self) -> str | None:
        """The file."""
        return self._path

    @property
    def y_up(self) -> bool:
        """Whether its y is up in the file."""
        return self._y_up

    @property
    def scale(self) -> Floats:
        """Factors along x, y, z, shape (3,); one number can be assigned for all three."""
        return self._scale.copy()

    @scale.setter
    def scale(self, scale: Any) -> None:
        out = np.asarray(scale, dtype=float).reshape(-1)
        if out.shape not in ((1,), (3,)):
            raise ShapeError("scale", out.shape, "one number, or (3,)")
        self._scale = np.broadcast_to(out, 3).copy()
        self.changes += 1

    @property
    def solid(self) -> geometry.Mesh:
        """The mesh it is."""
        if self._path is None:
            raise InputError("This mesh has no file. Give it one: Mesh('part.stl').")
        if self._y_up:
            raise InputError("Collisions of meshes whose y is up are not offered; export the file with z up.")
        return geometry.Mesh(self._path, tuple(self._scale.tolist()))

    def _draw(self, viewer: Any, name: str) -> None:
        viewer.group(name)
        if self._path is not None:
            upright = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
            turn = upright if self._y_up else np.eye(4)
            viewer.mesh(self._path, self._scale, name=f"{name}/mesh", pose=turn)

    def dress(self, handle: Any) -> None:
        """Give a handle of the viewer this mesh's colour, or leave it its own, and its opacity."""
        handle.color, handle.opacity = self._rgba[:3] if self._coloured else None, self.opacity


class CollisionShapeGroup(CollisionShape, Members):
    """Solids that move together and are collided with as one: a list of them, with a pose of its own."""

    kind = "group"

    def __init__(self, initlist: Iterable[CollisionShape] | None = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.extend(initlist or ())

    def _fit(self, item: Any) -> CollisionShape:
        if not isinstance(item, CollisionShape):
            raise TypeError(f"A CollisionShapeGroup holds solids; got {item!r}.")
        return item

    @property
    def solid(self) -> Any:
        """A group is no single solid."""
        raise InputError("A CollisionShapeGroup is no single solid; take its members.")

    def _parts(self) -> list[CollisionShape]:
        return [part for member in self._children for part in member._parts()]

    def _box(self) -> Floats:
        if not self._children:
            raise InputError("An empty CollisionShapeGroup has no box around it.")
        return np.concatenate(
            [member.T[:3, :3] @ member._box() + member.T[:3, 3:] for member in self._children], 1
        )

    def _draw(self, viewer: Any, name: str) -> None:
        viewer.group(name)
        for k, member in enumerate(self._children):
            member.draw(viewer, f"{name}/{k}")
            viewer[f"{name}/{k}"].pose = member.T

    def dress(self, handle: Any) -> None:
        """Members have colours of their own."""

    def to_dict(self) -> dict[str, Any]:
        """What it is and where, and its members."""
        return {**super().to_dict(), "shapes": [member.to_dict() for member in self._children]}

    def __repr__(self) -> str:
        return Members.__repr__(self)
