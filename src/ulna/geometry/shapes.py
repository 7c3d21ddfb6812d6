"""Shapes as frozen data: what a link looks like and what it can collide with, without any triangles loaded.

Every shape states its own frame; lengths are in metres. A shape is a value: equal content compares equal and
hashes equal, so shapes can be dictionary keys and cross process borders.
"""

from __future__ import annotations

import abc
import math
from collections.abc import Iterable
from pathlib import PurePosixPath

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError
from ulna.typing import Array, ArrayLike, Floats


def _lengths(shape: str, name: str, values: Iterable[float], count: int) -> tuple[float, ...]:
    """`values` as `count` finite, non-negative floats; a mesh-less model file may well say 0."""
    try:
        lengths = tuple(values)
        out = tuple(float(v) for v in lengths)
        if any(isinstance(v, bool | str | bytes) for v in lengths):
            raise TypeError
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{shape}: `{name}` is {values!r}; expected {count} lengths [m].") from error
    if len(out) != count:
        raise InputError(f"{shape}: `{name}` has {len(out)} numbers; expected {count} lengths [m].")
    if not all(math.isfinite(v) and v >= 0.0 for v in out):
        raise InputError(f"{shape}: `{name}` is {out}; expected finite lengths [m] that are not negative.")
    return out


def _length(shape: str, name: str, value: float) -> float:
    return _lengths(shape, name, (value,), 1)[0]


@dataclass(frozen=True)
class Shape(abc.ABC):
    """A shape in its own frame."""

    @abc.abstractmethod
    def describe(self) -> str:
        """A short label for tables and messages, such as ``"box 0.1 x 0.2 x 0.3 m"``."""


@dataclass(frozen=True)
class Box(Shape):
    """A box with its centre at the origin and edges along the axes.

    Args:
        size: Full edge lengths along x, y, z [m].

    Example:
        >>> from ulna.collision import World
        >>> from ulna.geometry import Box
        >>> World().add("table", Box((1.2, 0.8, 0.04)), (0.5, 0.0, -0.02)).names
        ('table',)
    """

    size: tuple[float, float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", _lengths("Box", "size", self.size, 3))

    def describe(self) -> str:
        """A short label for tables and messages."""
        return "box " + " x ".join(f"{s:g}" for s in self.size) + " m"


@dataclass(frozen=True)
class Sphere(Shape):
    """A ball with its centre at the origin.

    Args:
        radius: Radius [m].

    Example:
        >>> from ulna.geometry import Sphere
        >>> Sphere(0.1).radius
        0.1
    """

    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", _length("Sphere", "radius", self.radius))

    def describe(self) -> str:
        """A short label for tables and messages."""
        return f"sphere r {self.radius:g} m"


@dataclass(frozen=True)
class _Round(Shape):
    """A shape of revolution about z, given by a radius and a length along z."""

    radius: float
    length: float

    def __post_init__(self) -> None:
        kind = type(self).__name__
        object.__setattr__(self, "radius", _length(kind, "radius", self.radius))
        object.__setattr__(self, "length", _length(kind, "length", self.length))

    def describe(self) -> str:
        """A short label for tables and messages."""
        return f"{type(self).__name__.lower()} r {self.radius:g} m, length {self.length:g} m"


@dataclass(frozen=True)
class Cylinder(_Round):
    """A cylinder about z, centred at the origin.

    Args:
        radius: Radius [m].
        length: Height along z [m].
    """


@dataclass(frozen=True)
class Capsule(_Round):
    """A cylinder about z with a half ball on either end, centred at the origin.

    Args:
        radius: Radius of the cylinder and of the balls [m].
        length: Height of the cylindrical part [m]; the whole is `length + 2 * radius` high.
    """


@dataclass(frozen=True)
class Cone(_Round):
    """A cone about z, its tip up, centred half way: the base lies at `-length / 2`, the tip at `+length / 2`.

    Args:
        radius: Radius of the base [m].
        length: Height along z [m].
    """


@dataclass(frozen=True)
class Ellipsoid(Shape):
    """An ellipsoid with its centre at the origin and its axes along x, y, z.

    Args:
        radii: Half axes [m].
    """

    radii: tuple[float, float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "radii", _lengths("Ellipsoid", "radii", self.radii, 3))

    def describe(self) -> str:
        """A short label for tables and messages."""
        return "ellipsoid " + " x ".join(f"{r:g}" for r in self.radii) + " m"


@dataclass(frozen=True)
class Plane(Shape):
    """The plane z = 0 of its frame; solid below when it takes part in collisions.

    Args:
        size: Full edge lengths along x and y to draw [m]; 0 means without end.
    """

    size: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", _lengths("Plane", "size", self.size, 2))

    def describe(self) -> str:
        """A short label for tables and messages."""
        return "plane " + " x ".join(f"{s:g}" if s else "inf" for s in self.size) + " m"


@dataclass(frozen=True)
class Mesh(Shape):
    """A triangle mesh in a file, named but not read here.

    A model's fingerprint takes in the file's name and the scale only: the folder a file lies in is a fact
    about one machine, and so is whether it was found.

    Args:
        path: The file, or None when a model named none.
        scale: Factors along x, y, z; negative ones mirror.
        missing: Whether the file was looked for and not found. Viewers draw nothing for it.
    """

    path: str | None
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    missing: bool = False

    def __post_init__(self) -> None:
        try:
            scale = tuple(float(s) for s in self.scale)
        except (TypeError, ValueError) as error:
            raise InputError(f"Mesh: `scale` is {self.scale!r}; expected 3 factors.") from error
        if len(scale) != 3 or not all(map(math.isfinite, scale)):
            raise InputError(f"Mesh: `scale` is {scale}; expected 3 finite factors.")
        object.__setattr__(self, "scale", scale)
        object.__setattr__(self, "path", None if self.path is None else str(self.path))

    @property
    def file_name(self) -> str:
        """The file's name without its folder; empty when there is none."""
        return PurePosixPath(self.path.replace("\\", "/")).name if self.path else ""

    def describe(self) -> str:
        """A short label for tables and messages."""
        return f"mesh {self.file_name or '(no file)'}" + (" (missing)" if self.missing else "")


@dataclass(frozen=True, eq=False)
class _Sampled(Shape):
    """A shape given by an array; compared by content."""

    def __eq__(self, other: object) -> bool:
        return (
            type(other) is type(self)
            and vars(other).keys() == vars(self).keys()
            and all(np.array_equal(value, vars(other)[name]) for name, value in vars(self).items())
        )

    def __hash__(self) -> int:
        return hash((type(self).__name__, *(np.asarray(value).tobytes() for value in vars(self).values())))


def _numbers(shape: str, name: str, values: ArrayLike, form: str) -> Floats:
    """`values` as a read-only array of finite numbers."""
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{shape}: `{name}` is no array of numbers; expected {form}.") from error
    bad = ~np.isfinite(array)
    if bad.any():
        row = int(np.argwhere(bad)[0][0])
        raise InputError(
            f"{shape}: `{name}` holds {int(bad.sum())} numbers that are nan or inf, the first in row {row}; expected "
            f"finite numbers. Leave such rows out: x[np.isfinite(x).all(axis=1)]."
        )
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class PointCloud(_Sampled):
    """Points with a ball about each, as a depth camera or a scanner sees a scene.

    Args:
        points: Positions in its own frame, shape (n, 3) [m]; none is a cloud that nothing touches.
        radius: Radius of the balls [m].
    """

    points: Floats
    radius: float = 0.01

    def __post_init__(self) -> None:
        points = _numbers("PointCloud", "points", self.points, "shape (n, 3)")
        if points.size == 0:
            points = points.reshape(0, 3)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ShapeError("points", points.shape, "(n, 3)")
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "radius", _length("PointCloud", "radius", self.radius))

    def describe(self) -> str:
        """A short label for tables and messages."""
        return f"cloud of {len(self.points)} points r {self.radius:g} m"

    def __repr__(self) -> str:
        return f"<{self.describe()}>"


@dataclass(frozen=True, eq=False)
class HeightField(_Sampled):
    """A surface over a rectangle, as terrain: heights at the nodes of a regular grid, flat triangles between them.

    Args:
        heights: z at the nodes, shape (nx, ny), at least (2, 2) [m].
        size: Full edge lengths of the rectangle along x and y [m]; its middle is the origin.
    """

    heights: Floats
    size: tuple[float, float]

    def __post_init__(self) -> None:
        heights = _numbers("HeightField", "heights", self.heights, "shape (nx, ny)")
        if heights.ndim != 2 or min(heights.shape) < 2:
            raise ShapeError("heights", heights.shape, "(nx, ny), at least (2, 2)")
        size = _lengths("HeightField", "size", self.size, 2)
        if min(size) <= 0.0:
            raise InputError(f"HeightField: `size` is {size}; expected lengths above 0 [m].")
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "size", size)

    def triangles(self) -> tuple[Floats, Array]:
        """The surface: vertices, shape (nx ny, 3) [m], and triangles, shape (2 (nx - 1) (ny - 1), 3)."""
        nx, ny = self.heights.shape
        x, y = (np.linspace(-edge / 2.0, edge / 2.0, n) for edge, n in zip(self.size, (nx, ny), strict=True))
        vertices = np.stack([*np.meshgrid(x, y, indexing="ij"), self.heights], axis=-1).reshape(-1, 3)
        corner = (np.arange(nx - 1)[:, None] * ny + np.arange(ny - 1)).ravel()
        a, b, c, d = corner, corner + ny, corner + ny + 1, corner + 1
        return vertices, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])

    def describe(self) -> str:
        """A short label for tables and messages."""
        nx, ny = self.heights.shape
        return f"height field {nx} x {ny}, {self.size[0]:g} x {self.size[1]:g} m"

    def __repr__(self) -> str:
        return f"<{self.describe()}>"


def half_edges(shape: Shape) -> tuple[float, float, float] | None:
    """Half the edges of the box around a shape, in its frame [m].

    Args:
        shape: The shape.

    Returns:
        Half the edges along x, y and z, infinite for a plane; None for a mesh, a cloud and a height field.
    """
    match shape:
        case Box(size=(x, y, z)):
            return x / 2.0, y / 2.0, z / 2.0
        case Sphere(radius=r):
            return r, r, r
        case Capsule(radius=r, length=h):
            return r, r, h / 2.0 + r
        case Cylinder(radius=r, length=h) | Cone(radius=r, length=h):
            return r, r, h / 2.0
        case Ellipsoid(radii=(x, y, z)):
            return x, y, z
        case Plane():
            return math.inf, math.inf, math.inf
    return None
