"""MeshCat's objects as what Ulna's viewer draws."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from ulna.checks.arrays import shaped_array
from ulna.errors import InputError
from ulna.geometry import Box, Cylinder, Ellipsoid, Sphere
from ulna.typing import Array, Floats
from ulna.viewer.colours import RGBA, colour
from ulna.viewer.graph.content import Content, Lines, Points
from ulna.viewer.mesh.mesh_files import load_mesh
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.mesh.surface import Surface, normalized
from ulna.viewer.mesh.vertex_normals import surface_with_normals

PIXEL = 0.002
"""How thick a line of one pixel is drawn [m]."""
_COLOUR_STEPS = 15.0  # of each of red, green, blue, where vertices or points have colours
_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""From Ulna's cylinders about z to MeshCat's about y."""


@final
@dataclass(frozen=True, eq=False)
class Drawn:
    """What is seen of an object, in its own frame.

    Args:
        surfaces: Surfaces.
        contents: Lines or points.
    """

    surfaces: tuple[Surface, ...] = ()
    contents: tuple[Content, ...] = ()

    def stretched(self, linear: Floats) -> Drawn:
        """The same after a linear map (3, 3)."""
        return Drawn(
            tuple(_surface_mapped(s, linear) for s in self.surfaces),
            tuple(_content_mapped(c, linear) for c in self.contents),
        )


def drawn(source: Any, material: Any = None) -> Drawn:
    """What is seen of an object, or of a geometry with a material.

    Args:
        source: A geometry or an object of `meshcat.geometry`.
        material: The material of a geometry; white when not given.

    Returns:
        Surfaces, lines and points.

    Raises:
        InputError: It is neither, or an object comes with a second material.
    """
    from meshcat.geometry import MeshPhongMaterial

    as_object = hasattr(source, "geometry") and hasattr(source, "material")
    if as_object and material is not None:
        raise InputError(
            "set_object takes an object, or a geometry and a material; an object has a material."
        )
    geometry, look = (
        (source.geometry, source.material) if as_object else (source, material or MeshPhongMaterial())
    )
    kind = type(source).__name__ if as_object else ("Points" if _is(look, "PointsMaterial") else "Mesh")
    maker = next((m for name, m in _MAKERS.items() if _is(geometry, name)), None)
    if maker is None:
        raise InputError(
            f"set_object was given {source!r}; expected a geometry of meshcat.geometry: {', '.join(_MAKERS)}."
        )
    return maker(geometry, look, kind).stretched(
        np.asarray(geometry.intrinsic_transform(), dtype=float)[:3, :3]
    )


def _is(value: Any, name: str) -> bool:
    return any(cls.__name__ == name for cls in type(value).__mro__)


def rgba_of(material: Any) -> RGBA:
    """The colour of a material, red, green, blue and opacity from 0 to 1."""
    value = material.color
    if isinstance(value, (int, np.integer)):
        value = [((int(value) >> shift) & 255) / 255 for shift in (16, 8, 0)]
    red, green, blue = colour(value)[:3]
    opaque = getattr(material, "transparent", None) is False
    return red, green, blue, 1.0 if opaque else float(getattr(material, "opacity", 1.0))


def _solid(make: Callable[[Any], Surface]) -> Callable[[Any, Any, str], Drawn]:
    """Draws triangles in the colour of the material, or their edges."""

    def draw(geometry: Any, material: Any, _: str) -> Drawn:
        surface = make(geometry).coloured(rgba_of(material))
        return _edges(surface, material) if getattr(material, "wireframe", False) else Drawn((surface,))

    return draw


def _edges(surface: Surface, material: Any) -> Drawn:
    pairs = np.sort(surface.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    segments = surface.vertices[np.unique(pairs, axis=0)]
    return Drawn((), (Lines(segments, rgba_of(material), PIXEL * float(material.wireframeLinewidth)),))


def _cylinder(geometry: Any) -> Surface:
    top, bottom, height = (float(x) for x in (geometry.radiusTop, geometry.radiusBottom, geometry.height))
    if top == bottom:
        return _surface_mapped(tessellate(Cylinder(top, height)), _Y_UP)
    angle = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    ring = np.stack([np.cos(angle), np.zeros_like(angle), -np.sin(angle)], axis=1)
    up = np.array([0.0, height / 2.0, 0.0])
    vertices = np.concatenate([bottom * ring - up, top * ring + up, [-up, up]])
    i, k = np.arange(48), (np.arange(48) + 1) % 48
    low, high = np.full(48, 96), np.full(48, 97)
    faces = [(i, k, 48 + k), (i, 48 + k, 48 + i), (low, k, i), (high, 48 + i, 48 + k)]
    return surface_with_normals(vertices, np.concatenate([np.stack(f, axis=1) for f in faces]))


def _triangles(geometry: Any, material: Any, kind: str) -> Drawn:
    vertices, faces = np.asarray(geometry.vertices, dtype=float), np.asarray(geometry.faces, dtype=np.int64)
    colours = geometry.color if getattr(material, "vertexColors", False) else None
    if colours is None:
        return _solid(lambda _: surface_with_normals(vertices, faces))(geometry, material, kind)
    alpha = rgba_of(material)[3]
    by_face = np.asarray(colours, dtype=float)[faces].mean(axis=1)
    return Drawn(
        tuple(
            surface_with_normals(vertices, faces[chosen], (*rgb, alpha))
            for rgb, chosen in _by_colour(by_face)
        )
    )


def _by_colour(colours: Array) -> list[tuple[tuple[float, float, float], Array]]:
    """Colours (n, 3), rounded, and the rows that have each."""
    rounded = np.round(np.clip(colours, 0.0, 1.0) * _COLOUR_STEPS) / _COLOUR_STEPS
    unique, index = np.unique(rounded, axis=0, return_inverse=True)
    return [
        ((float(r), float(g), float(b)), np.flatnonzero(index.reshape(-1) == i))
        for i, (r, g, b) in enumerate(unique)
    ]


def _columns(name: str, values: Any, count: int | None) -> Floats:
    """Three rows of numbers; an empty array of any shape is none of them."""
    array = np.array(values, dtype=float)
    return shaped_array(name, array.reshape(3, 0) if array.size == 0 else array, 3, count)


def _points(geometry: Any, material: Any, kind: str) -> Drawn:
    """Points, or the lines that join them, as the kind of the object says."""
    positions = _columns("position", geometry.position, None).T
    colours = None if geometry.color is None else _columns("color", geometry.color, len(positions)).T
    rgba = rgba_of(material)
    if kind == "Points":
        shown = np.tile(rgba[:3], (len(positions), 1)) if colours is None else colours
        return Drawn((), (Points(positions, shown, float(getattr(material, "size", PIXEL))),))
    first = np.arange(0, len(positions) - 1, 2 if kind == "LineSegments" else 1)
    second = first + 1
    if kind == "LineLoop":
        first, second = np.append(first, len(positions) - 1), np.append(second, 0)
    segments = np.stack([positions[first], positions[second]], axis=1)
    thickness = PIXEL * float(getattr(material, "linewidth", 1.0))
    if colours is None or not getattr(material, "vertexColors", False):
        return Drawn((), (Lines(segments, rgba, thickness),))
    means = (colours[first] + colours[second]) / 2.0
    return Drawn(
        (), tuple(Lines(segments[rows], (*rgb, rgba[3]), thickness) for rgb, rows in _by_colour(means))
    )


def _file(geometry: Any, material: Any, _: str) -> Drawn:
    contents = getattr(geometry.contents, "data", geometry.contents)
    data = contents.encode() if isinstance(contents, str) else bytes(contents)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, f"mesh.{geometry.mesh_format}")
        with open(path, "wb") as out:
            out.write(data)
        surfaces = load_mesh(path)
    if geometry.mesh_format == "dae":  # it has colours
        return Drawn(tuple(surfaces))
    return Drawn(tuple(s.coloured(rgba_of(material)) for s in surfaces))


_MAKERS: dict[str, Callable[[Any, Any, str], Drawn]] = {
    "Box": _solid(lambda g: tessellate(Box(tuple(float(x) for x in g.lengths)))),  # type: ignore[arg-type]
    "Ellipsoid": _solid(lambda g: tessellate(Ellipsoid((1.0, 1.0, 1.0)))),
    "Sphere": _solid(lambda g: tessellate(Sphere(float(g.radius)))),
    "Cylinder": _solid(_cylinder),
    "TriangularMeshGeometry": _triangles,
    "PointsGeometry": _points,
    "MeshGeometry": _file,
}
"""How each geometry is drawn; derived classes stand before those that they derive from."""


def _surface_mapped(surface: Surface, linear: Floats) -> Surface:
    if np.array_equal(linear, np.eye(3)):
        return surface
    mirrored = np.linalg.det(linear) < 0.0
    return replace(
        surface,
        vertices=surface.vertices @ linear.T,
        triangles=surface.triangles[:, ::-1] if mirrored else surface.triangles,
        normals=normalized(surface.normals @ np.linalg.pinv(linear)),
    )


def _content_mapped(content: Content, linear: Floats) -> Content:
    if isinstance(content, Lines):
        return replace(content, segments=content.segments @ linear.T)
    assert isinstance(content, Points)
    return replace(content, positions=content.positions @ linear.T)
