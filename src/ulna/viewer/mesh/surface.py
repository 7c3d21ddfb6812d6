"""A surface: triangles of one colour, with the normals it is shaded by."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from ulna.checks.arrays import length_array
from ulna.checks.values import MAX_LENGTH, short_repr
from ulna.errors import InputError, ShapeError
from ulna.typing import Array, ArrayLike, Floats
from ulna.viewer.colours import RGBA, Colour, colour

DEFAULT_COLOUR: RGBA = (0.78, 0.80, 0.82, 1.0)
"""What a surface without a material is drawn in: a light, neutral grey."""


@dataclass(frozen=True, eq=False)
class Texture:
    """A picture on a surface.

    Args:
        uv: Where each vertex lies in the picture, from 0 to 1, the origin at its lower left, shape (n, 2).
        image: The content of a PNG or JPEG file.
    """

    uv: Floats
    image: bytes


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles of one colour.

    Args:
        vertices: Positions [m], shape (n, 3).
        triangles: Indices of vertices, anticlockwise seen from outside, shape (m, 3).
        normals: Unit normals of the vertices, shape (n, 3). Vertices on a sharp edge occur once for each
            side.
        rgba: The colour; with a texture, the mean colour of it.
        texture: A picture on it; a browser draws it, renderers without textures draw the mean colour.
    """

    vertices: Floats
    triangles: Array
    normals: Floats
    rgba: RGBA = DEFAULT_COLOUR
    texture: Texture | None = None

    def __post_init__(self) -> None:
        for name, kind in (("vertices", float), ("triangles", np.int64), ("normals", float)):
            raw = getattr(self, name)
            try:
                value = np.ascontiguousarray(raw, dtype=kind).reshape(-1, 3)
            except (TypeError, ValueError, OverflowError):
                raise InputError(
                    f"`{name}` is {short_repr(raw)}; expected numbers of shape (n, 3)."
                ) from None
            if kind is float and not np.vdot(value, value) <= MAX_LENGTH**2:  # a quick look first
                length_array(name, value, None, 3)
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        if self.normals.shape != self.vertices.shape:
            raise ShapeError("normals", self.normals.shape, f"one for each vertex, {self.vertices.shape}")
        count = len(self.vertices)
        if self.texture is not None and self.texture.uv.shape != (count, 2):
            raise ShapeError("uv", self.texture.uv.shape, f"({count}, 2), one for each vertex")
        if self.triangles.size and (self.triangles.min() < 0 or self.triangles.max() >= count):
            raise InputError(f"`triangles` points outside the {count} vertices of the surface.")
        object.__setattr__(self, "rgba", colour(self.rgba))

    def moved(self, pose: Array, scale: Iterable[float] = (1.0, 1.0, 1.0)) -> Surface:
        """The surface scaled along its axes, then moved; triangles are flipped where it is mirrored.

        Args:
            pose: T_target_surface, shape (4, 4).
            scale: A factor along each axis.

        Returns:
            The new surface.
        """
        factors = np.asarray(tuple(scale), dtype=float)
        rotation, translation = np.asarray(pose, dtype=float)[:3, :3], np.asarray(pose, dtype=float)[:3, 3]
        linear = rotation * factors
        mirrored = np.linalg.det(rotation) * np.prod(np.sign(factors)) < 0.0
        triangles = self.triangles[:, ::-1] if mirrored else self.triangles
        # normals go with the inverse transpose; a factor of 0 leaves any normal as good
        with np.errstate(divide="ignore"):
            inverse = np.where(factors != 0, 1.0 / factors, 0.0)
        normals = (self.normals * inverse) @ rotation.T
        return replace(
            self,
            vertices=self.vertices @ linear.T + translation,
            triangles=triangles,
            normals=normalized(normals),
        )

    def coloured(self, rgba: Colour) -> Surface:
        """The same triangles in another colour, without a texture."""
        return replace(self, rgba=colour(rgba), texture=None)


def normalized(vectors: Array) -> Array:
    """Vectors of length 1 along `vectors`; those too short to have a direction become +z."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    shortest = (
        1e-300 if length.dtype == np.float64 else float(np.finfo(length.dtype).tiny)
    )  # above 0 in its type
    return np.where(length > shortest, vectors / np.maximum(length, shortest), (0.0, 0.0, 1.0))


def albedo(rgb: Array) -> Floats:
    """The linear reflectance that colours (..., 3), as a model states them, are drawn with.

    White is reduced (lights would saturate it), and dark grey is raised (its shape would be
    lost).
    """
    linear = linear_from_srgb(rgb)
    bright, dull = linear.max(axis=-1, keepdims=True), linear.min(axis=-1, keepdims=True)
    return 0.74 * linear + 0.06 * (1 - bright) * (1 - (bright - dull) / np.maximum(bright, 1e-6))


def linear_from_srgb(encoded: ArrayLike) -> Floats:
    """Linear colours from those encoded for a screen (IEC 61966-2-1)."""
    x = np.asarray(encoded, dtype=float)
    return np.where(x <= 0.04045, x / 12.92, ((np.maximum(x, 0.0) + 0.055) / 1.055) ** 2.4)
