"""Mesh files (dae, stl, obj, glb ...) as surfaces: one for each colour, sharp edges kept sharp."""

from __future__ import annotations

import functools
import io
import os
from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.geometry.meshes import read_pieces
from ulna.typing import Array, Floats
from ulna.viewer import mesh_store
from ulna.viewer.surface import DEFAULT_COLOUR, RGBA, Surface, Texture, colour, unit

_LARGEST = 2048  # pixels along an edge of a texture; more cost time and are not seen

CREASE = np.deg2rad(38.0)
"""Edges that turn by more than this [rad] are drawn sharp."""


def load_mesh(path: str) -> tuple[Surface, ...]:
    """The surfaces of a mesh file, one for each colour, in the frame of the file, in metres.

    A COLLADA file's unit is applied and its up axis is not, as the robotics tools do. A surface with a texture has its
    mean colour besides. A surface whose file says nothing about colour gets `DEFAULT_COLOUR`. What was read is kept on
    disk by the content of the file, so that it is read faster the next time.

    Raises:
        MissingExtra: trimesh (or pycollada, for .dae) is not installed.
        InputError: The file cannot be read as a mesh.
    """
    try:
        stamp = os.stat(path).st_mtime_ns
    except OSError as error:
        raise InputError(f"Cannot open the mesh file {path!r}: {error.strerror or error}.") from error
    return _load(os.path.abspath(path), stamp)


@functools.lru_cache(maxsize=512)
def _load(path: str, stamp: int) -> tuple[Surface, ...]:
    entry = mesh_store.entry(path)
    kept = mesh_store.read(entry)
    if kept is not None:
        return kept
    surfaces = _parsed(path)
    mesh_store.write(entry, surfaces)
    return surfaces


def _parsed(path: str) -> tuple[Surface, ...]:
    pieces: dict[RGBA, list[tuple[Floats, Array]]] = {}
    surfaces = []
    for vertices, faces, mesh in read_pieces(path):
        picture = _picture(mesh)
        if picture is not None:
            uv, image = picture
            surfaces.append(
                smooth(vertices, faces, _material_colour(mesh.visual.material), uv=uv, image=image)
            )
            continue
        for rgba, chosen in _colours(mesh):
            pieces.setdefault(rgba, []).append((vertices, faces if chosen is None else faces[chosen]))
    for rgba, parts in pieces.items():
        offsets = np.cumsum([0, *(len(v) for v, _ in parts)])
        vertices = np.concatenate([v for v, _ in parts])
        faces = np.concatenate([f + o for (_, f), o in zip(parts, offsets, strict=False)])
        surface = smooth(vertices, faces, rgba)
        if len(surface.triangles):
            surfaces.append(surface)
    if not surfaces:
        raise InputError(f"The mesh file {path!r} holds no triangles.")
    return tuple(surfaces)


def smooth(
    vertices: Floats,
    triangles: Array,
    rgba: RGBA = DEFAULT_COLOUR,
    crease: float = CREASE,
    uv: Floats | None = None,
    image: bytes = b"",
) -> Surface:
    """Loose triangles as a surface whose vertices are shared exactly where it is smooth.

    Two triangles share a vertex when they meet at an edge that turns by less than `crease` [rad]; the normal
    of a vertex is the mean of its triangles' normals weighted by area, which is also what a browser computes
    from the shared indices. Triangles without area are dropped. With places `uv` (n, 2) in an `image`, vertices that
    lie at two places of it occur twice.
    """
    place, index = _weld(np.asarray(vertices, dtype=float))
    given = np.asarray(triangles, dtype=np.int64)
    corners = index[given]
    whole = (
        (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0])
    )
    corners, given = corners[whole], given[whole]
    a, b, c = (place[corners[:, k]] for k in range(3))
    weighted = np.cross(b - a, c - a)
    solid = np.linalg.norm(weighted, axis=1) > 1e-16
    corners, given, weighted = corners[solid], given[solid], weighted[solid]
    facing = unit(weighted)
    group = _join_corners(corners, facing, crease, len(place))
    _, first, vertex = np.unique(group, return_index=True, return_inverse=True)
    normals = np.zeros((len(first), 3))
    per_corner = np.repeat(weighted, 3, axis=0)
    for axis in range(3):
        normals[:, axis] = np.bincount(vertex, weights=per_corner[:, axis], minlength=len(first))
    if uv is None:
        return Surface(place[corners.reshape(-1)[first]], vertex.reshape(-1, 3), unit(normals), rgba)
    spot, where = np.unique(np.round(uv, 6), axis=0, return_inverse=True)
    pair = vertex * len(spot) + where.reshape(-1)[given.reshape(-1)]
    both, split = np.unique(pair, return_inverse=True)
    owner = both // len(spot)
    texture = Texture(spot[both % len(spot)], image)
    return Surface(
        place[corners.reshape(-1)[first[owner]]], split.reshape(-1, 3), unit(normals)[owner], rgba, texture
    )


def _weld(vertices: Floats) -> tuple[Floats, Array]:
    """Vertices that lie together become one: the distinct positions, and each vertex's index among them."""
    if not len(vertices):
        return vertices, np.zeros(0, dtype=np.int64)
    low = vertices.min(axis=0)
    extent = float((vertices.max(axis=0) - low).max()) or 1.0
    cell = np.round((vertices - low) * ((2**20) / extent)).astype(np.int64)
    key = (cell[:, 0] << 42) | (cell[:, 1] << 21) | cell[:, 2]
    _, first, index = np.unique(key, return_index=True, return_inverse=True)
    return vertices[first], index.reshape(-1)


def _join_corners(corners: Array, facing: Floats, crease: float, count: int) -> Array:
    """A label for every corner (3 m); corners with one label share a vertex."""
    m = len(corners)
    face = np.tile(np.arange(m), 3)
    start = np.concatenate([corners[:, 0], corners[:, 1], corners[:, 2]])
    end = np.concatenate([corners[:, 1], corners[:, 2], corners[:, 0]])
    side = np.repeat(np.arange(3), m)
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.argsort(low * count + high, kind="stable")
    low, high, face, side, start = low[order], high[order], face[order], side[order], start[order]
    # neighbours in this order that have the same two ends are two triangles at one edge
    same = (low[1:] == low[:-1]) & (high[1:] == high[:-1])
    one, two = np.flatnonzero(same), np.flatnonzero(same) + 1
    smooth_edge = np.einsum("ij,ij->i", facing[face[one]], facing[face[two]]) > np.cos(crease)
    one, two = one[smooth_edge], two[smooth_edge]
    first_one, second_one = face[one] * 3 + side[one], face[one] * 3 + (side[one] + 1) % 3
    first_two, second_two = face[two] * 3 + side[two], face[two] * 3 + (side[two] + 1) % 3
    turned = start[one] != start[two]  # the usual case: the edge runs the other way in the neighbour
    links = np.concatenate(
        [
            np.stack([first_one, np.where(turned, second_two, first_two)]),
            np.stack([second_one, np.where(turned, first_two, second_two)]),
        ],
        axis=1,
    )
    label = np.arange(3 * m)
    while True:
        low_label = np.minimum(label[links[0]], label[links[1]])
        new = label.copy()
        np.minimum.at(new, label[links[0]], low_label)
        np.minimum.at(new, label[links[1]], low_label)
        new = new[new]
        if np.array_equal(new, label):
            return label
        label = new


def _picture(mesh: Any) -> tuple[Floats, bytes] | None:
    """Where the vertices of a trimesh mesh lie in its texture, and the texture as a PNG file."""
    visual = getattr(mesh, "visual", None)
    uv = getattr(visual, "uv", None)
    material = getattr(visual, "material", None)
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if uv is None or image is None or len(uv) != len(mesh.vertices) or not np.isfinite(uv).all():
        return None
    try:
        largest = max(image.size)
        if largest > _LARGEST:
            image = image.resize(tuple(max(1, round(n * _LARGEST / largest)) for n in image.size))
        file = io.BytesIO()
        image.convert("RGB").save(file, "PNG")
    except Exception:  # an image that cannot be decoded is no reason to draw nothing
        return None
    return np.asarray(uv, dtype=float)[:, :2], file.getvalue()


def _colours(mesh: Any) -> list[tuple[RGBA, Array | None]]:
    """The colours of a trimesh mesh, each with the faces that have it (None: all of them)."""
    visual = getattr(mesh, "visual", None)
    if visual is None or not visual.defined:
        return [(DEFAULT_COLOUR, None)]
    if visual.kind == "texture":
        return [(_material_colour(visual.material), None)]
    face_colours = np.asarray(visual.face_colors, dtype=np.uint8).reshape(-1, 4)
    distinct, which = np.unique(face_colours, axis=0, return_inverse=True)
    if len(distinct) > 24:  # painted vertex by vertex; the mean does for a robot
        return [(colour(face_colours.mean(axis=0) / 255.0), None)]
    return [(colour(c / 255.0), np.flatnonzero(which.reshape(-1) == k)) for k, c in enumerate(distinct)]


def _material_colour(material: Any) -> RGBA:
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if image is not None:
        try:
            mean = np.asarray(image.convert("RGBA").resize((1, 1)), dtype=float).reshape(4) / 255.0
            return colour(mean)
        except Exception:  # an image that cannot be decoded is no reason to draw nothing
            return DEFAULT_COLOUR
    value = getattr(material, "baseColorFactor", None)
    if value is None:
        value = getattr(material, "diffuse", None)
    if value is None:
        return DEFAULT_COLOUR
    numbers = np.asarray(value, dtype=float).reshape(-1)
    rgba = colour(
        numbers / 255.0 if numbers.max(initial=0.0) > 1.0 or np.asarray(value).dtype.kind == "u" else numbers
    )
    # COLLADA writers disagree about which end of transparency is opaque; an invisible part is never meant
    return rgba if rgba[3] > 0.02 else (*rgba[:3], 1.0)
