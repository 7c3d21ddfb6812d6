"""Content of nodes besides surfaces: points, lines, text, and instances of a surface."""

from __future__ import annotations

import abc
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from ulna.checks.arrays import length_array, read_only, scale_factors
from ulna.checks.former_names import former_fields
from ulna.checks.values import length, text
from ulna.errors import ShapeError
from ulna.spatial import quat_xyzw_to_matrix
from ulna.system.cached import cached_property
from ulna.typing import Array, ArrayLike, Floats
from ulna.viewer.colours import Colour, colour_values
from ulna.viewer.mesh.surface import RGBA, Surface, colour, normalized

_MAX_BALLS = 20_000  # points that a picture draws as balls; more are thinned out


class Content(abc.ABC):
    """Something to see that is not given as surfaces."""

    @property
    @abc.abstractmethod
    def bounding_points(self) -> Floats:
        """Points that bound it [m], shape (n, 3)."""

    @property
    @abc.abstractmethod
    def surfaces(self) -> tuple[Surface, ...]:
        """The same content as triangles, for renderers that draw triangles only."""


@final
@dataclass(frozen=True, eq=False)
class Points(Content):
    """Points.

    Args:
        positions: Where [m], shape (n, 3).
        colours: Red, green, blue from 0 to 1, shape (n, 3) or (3,).
        size: Diameter of a point [m].
    """

    positions: Floats
    colours: Any
    size: float = 0.01

    def __post_init__(self) -> None:
        positions = _read_only("points", self.positions, None, 3)
        object.__setattr__(self, "positions", positions)
        object.__setattr__(self, "colours", _colours(self.colours, len(positions)))
        object.__setattr__(self, "size", length("size", self.size))

    @property
    def bounding_points(self) -> Floats:
        """The points."""
        return self.positions

    @cached_property
    def surfaces(self) -> tuple[Surface, ...]:
        """An octahedron with the normals of a ball for each point, one surface for each of few colours."""
        step = max(len(self.positions) // _MAX_BALLS, 1)
        return _repeated_by_colour(
            _BALL.moved(np.eye(4), (self.size / 2,) * 3), self.positions[::step], self.colours[::step]
        )

    @property
    def as_balls(self) -> Copies:
        """A small ball for each point, drawn at once."""
        ball = _BALL.moved(np.eye(4), (self.size / 2,) * 3)
        return Copies((ball,), transforms(self.positions), self.colours)


@final
@dataclass(frozen=True, eq=False)
class Lines(Content):
    """Straight lines, each from one point to another.

    Args:
        segments: Both ends of each [m], shape (n, 2, 3).
        rgba: Their colour.
        thickness: How thick [m].
    """

    segments: Floats
    rgba: RGBA
    thickness: float = 0.004

    def __post_init__(self) -> None:
        object.__setattr__(self, "segments", _read_only("segments", self.segments, None, 2, 3))
        object.__setattr__(self, "rgba", colour(self.rgba))
        object.__setattr__(self, "thickness", length("thickness", self.thickness))

    @classmethod
    def through(cls, points: ArrayLike, rgba: Colour, thickness: float = 0.004) -> Lines:
        """A line from point to point.

        Args:
            points: The points, (n, 3) [m].
            rgba: Its colour.
            thickness: How thick it is [m].

        Returns:
            The n - 1 lines.
        """
        polyline = _read_only("points", points, None, 3)
        return cls(np.stack([polyline[:-1], polyline[1:]], axis=1), colour(rgba), thickness)

    @property
    def bounding_points(self) -> Floats:
        """The ends."""
        return self.segments.reshape(-1, 3)

    @cached_property
    def surfaces(self) -> tuple[Surface, ...]:
        """A prism with six sides for each line."""
        return self.as_prisms(np.full((len(self.segments), 2), self.thickness / 2))

    def as_prisms(self, radii: Floats) -> tuple[Surface, ...]:
        """The lines as prisms with six sides that have a radius at each end, shape (n, 2) [m]."""
        start, end = self.segments[:, 0], self.segments[:, 1]
        along = normalized(end - start)
        helper = np.where(np.abs(along[:, 2:]) < 0.9, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
        side = normalized(np.cross(along, helper))
        other = np.cross(along, side)
        angle = np.linspace(0, 2 * np.pi, 6, endpoint=False)
        ring = (
            np.cos(angle)[:, None] * side[:, None, :] + np.sin(angle)[:, None] * other[:, None, :]
        )  # (n, 6, 3)
        vertices = self.segments[:, :, None] + radii[:, :, None, None] * ring[:, None]
        j, k = np.arange(6), (np.arange(6) + 1) % 6
        prism = np.concatenate([np.stack([j, k, 6 + k], 1), np.stack([j, 6 + k, 6 + j], 1)])
        triangles = 12 * np.arange(len(start))[:, None, None] + prism
        normals = np.broadcast_to(ring[:, None], (len(start), 2, 6, 3))
        return (Surface(vertices, triangles, normals, self.rgba),)


@final
@former_fields(words="text")
@dataclass(frozen=True)
class Text(Content):
    """Text that faces the camera.

    Args:
        text: The text.
        height: Height of the letters [m].
    """

    text: str
    height: float = 0.05

    def __post_init__(self) -> None:
        object.__setattr__(self, "text", text("text", self.text))
        object.__setattr__(self, "height", length("height", self.height))

    @property
    def bounding_points(self) -> Floats:
        """Where the text begins."""
        return np.zeros((1, 3))

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """None: pictures draw the text themselves, or leave them out."""
        return ()


@final
@dataclass(frozen=True, eq=False)
class Copies(Content):
    """One thing at many places, which costs a screen little more than the thing once.

    Args:
        original: The surfaces of the thing.
        poses: T_node_copy, shape (n, 4, 4).
        colours: Red, green, blue from 0 to 1, shape (n, 3); None for the surfaces' own.
        scales: A factor along each axis, shape (n, 3); ones when not given.
        opacity: From 0 to 1, for all of them.
    """

    original: tuple[Surface, ...]
    poses: Floats
    colours: Any = None
    scales: Any = None
    opacity: float = 1.0

    def __post_init__(self) -> None:
        poses = _read_only("poses", self.poses, None, 4, 4)
        object.__setattr__(self, "poses", poses)
        if self.colours is not None:
            object.__setattr__(self, "colours", _colours(self.colours, len(poses)))
        scales = scale_factors("scales", 1.0 if self.scales is None else self.scales, len(poses))
        object.__setattr__(self, "scales", read_only(scales))

    @property
    def bounding_points(self) -> Floats:
        """The corners of each copy's box."""
        corners = [s.vertices for s in self.original if len(s.vertices)]
        if not corners or not len(self.poses):
            return np.zeros((0, 3))
        low, high = (
            np.min([c.min(axis=0) for c in corners], axis=0),
            np.max([c.max(axis=0) for c in corners], axis=0),
        )
        box = np.stack(np.meshgrid(*zip(low, high, strict=True)), -1).reshape(-1, 3)
        assert self.scales is not None
        return (box * self.scales[:, None] @ self.poses[:, :3, :3].mT + self.poses[:, None, :3, 3]).reshape(
            -1, 3
        )

    @cached_property
    def surfaces(self) -> tuple[Surface, ...]:
        """All copies as triangles, one surface for each colour."""
        assert self.scales is not None
        pieces = []
        for surface in self.original:
            colours = (
                self.colours if self.colours is not None else np.tile(surface.rgba[:3], (len(self.poses), 1))
            )
            alpha = surface.rgba[3] * self.opacity
            pieces += _repeated_by_colour(
                surface, self.poses[:, :3, 3], colours, self.poses[:, :3, :3], self.scales, alpha
            )
        return tuple(pieces)


def _octahedron() -> Surface:
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    faces = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
    return Surface(corners, np.array(faces), corners)


_BALL = _octahedron()


def _repeated_by_colour(
    surface: Surface,
    positions: Floats,
    colours: Floats,
    rotations: Floats | None = None,
    scales: Floats | None = None,
    opacity: float = 1.0,
) -> tuple[Surface, ...]:
    """Copies of a surface, joined by colour; more than 16 colours are rounded to 4 steps of each."""
    if len(np.unique(colours, axis=0)) > 16:
        colours = np.round(colours * 3) / 3
    distinct, which = np.unique(colours, axis=0, return_inverse=True)
    out = []
    for k, rgb in enumerate(distinct):
        chosen = np.flatnonzero(which.reshape(-1) == k)
        vertices = np.broadcast_to(surface.vertices, (len(chosen), *surface.vertices.shape))
        normals = np.broadcast_to(surface.normals, vertices.shape)
        if scales is not None:
            factors = scales[chosen, None]
            vertices, normals = (
                vertices * factors,
                normalized(normals / np.where(factors != 0.0, factors, 1.0)),
            )
        if rotations is not None:
            turn = rotations[chosen].mT
            vertices, normals = vertices @ turn, normals @ turn
        vertices = vertices + positions[chosen, None]
        triangles = surface.triangles + len(surface.vertices) * np.arange(len(chosen))[:, None, None]
        out.append(Surface(vertices, triangles, normals, colour((*rgb, opacity))))
    return tuple(out)


def transforms(positions: ArrayLike, quat_xyzw: ArrayLike | None = None) -> Floats:
    """Poses from positions and rotations.

    Args:
        positions: Positions, (n, 3) [m].
        quat_xyzw: Rotations as quaternions x y z w, (n, 4); None for none.

    Returns:
        Poses, (n, 4, 4).
    """
    translations = _read_only("positions", positions, None, 3)
    out = np.tile(np.eye(4), (len(translations), 1, 1))
    out[:, :3, 3] = translations
    if quat_xyzw is not None:
        out[:, :3, :3] = quat_xyzw_to_matrix(_read_only("quat_xyzw", quat_xyzw, len(translations), 4))
    return out


def _read_only(name: str, value: ArrayLike, *shape: int | None) -> Floats:
    """A read-only copy of lengths of that shape [m], None for any length."""
    return read_only(length_array(name, value, *shape))


def _colours(value: Any, count: int) -> Array:
    value = colour(value)[:3] if isinstance(value, str) else value
    out = colour_values("colors", value)
    if out.shape not in ((3,), (4,), (count, 3)):
        raise ShapeError("colors", out.shape, f"({count}, 3) or (3,), from 0 to 1")
    return _read_only("colors", np.broadcast_to(out[..., :3], (count, 3)), count, 3)
