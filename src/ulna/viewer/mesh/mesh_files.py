"""Mesh files (dae, stl, obj, glb ...) as surfaces: one for each colour, sharp edges kept sharp."""

from __future__ import annotations

import functools
import io
import os
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from ulna.checks.values import one_of
from ulna.errors import InputError
from ulna.files import reject_special_files
from ulna.geometry.meshes import read_pieces
from ulna.typing import Array, Floats
from ulna.viewer.mesh import mesh_cache as mesh_store
from ulna.viewer.mesh.decimation import can_decimate
from ulna.viewer.mesh.surface import DEFAULT_COLOUR, RGBA, Surface, colour
from ulna.viewer.mesh.vertex_normals import surface_with_normals

_MAX_TEXTURE_SIZE = 2048  # pixels along an edge of a texture; more cost time and are not seen

MAX_DEVIATION = 3e-4
"""How far a surface may be from the mesh of the file [m]: a quarter of a pixel where a whole robot fills the screen."""
_MAX_RELATIVE_DEVIATION = (
    1e-3  # and of the size of the file's content: less than a pixel where it fills the screen
)

Detail = Literal["seen", "full"]
DETAILS: tuple[str, ...] = ("seen", "full")


def load_mesh(
    path: str, scale: Sequence[float] = (1.0, 1.0, 1.0), detail: Detail = "seen"
) -> tuple[Surface, ...]:
    """The surfaces of a mesh file, one for each colour, in the frame of the file, in metres.

    A COLLADA file's unit is applied and its up axis is not, as the robotics tools do. A surface with a texture has its
    mean colour besides. A surface without a material gets `DEFAULT_COLOUR`. Surfaces are cached on
    disk by the content of the file, so that it is read faster the next time.

    Args:
        path: The file.
        scale: A factor along each axis; negative ones mirror.
        detail: "full" for all triangles of the file. "seen" simplifies it within the bound below, where the package
            fast-simplification is installed: no vertex of the file is then farther than 0.3 mm from the surface, and
            none farther than a thousandth of the size of the whole. Surfaces with textures stay whole.

    Returns:
        The surfaces.

    Raises:
        MissingExtra: trimesh (or pycollada, for .dae) is not installed.
        InputError: The file cannot be read as a mesh.
        UnknownName: There is no such detail.
    """
    check_detail(detail)
    try:
        reject_special_files(path)
        stamp = os.stat(path).st_mtime_ns
    except OSError as error:
        raise InputError(f"Cannot open the mesh file {path!r}: {error.strerror or error}.") from error
    if os.path.isdir(path):
        raise InputError(f"Cannot open the mesh file {path!r}: it is a folder.")
    factors = (float(scale[0]), float(scale[1]), float(scale[2]))
    return _load_cached(os.path.abspath(path), stamp, factors, detail)


def check_detail(detail: str) -> None:
    """Refuse a detail that there is not.

    Raises:
        UnknownName: It is none.
    """
    one_of("detail of a mesh", detail, DETAILS)


@functools.lru_cache(maxsize=512)
def _load_cached(
    path: str, stamp: int, factors: tuple[float, float, float], detail: Detail
) -> tuple[Surface, ...]:
    largest = max(abs(f) for f in factors)
    bound = MAX_DEVIATION / largest if detail == "seen" and largest > 0.0 and can_decimate() else 0.0
    entry = mesh_store.cache_key(path, bound)
    surfaces = mesh_store.read_cached(entry)
    if surfaces is None:
        surfaces = _read_surfaces(path, bound)
        mesh_store.write_cached(entry, surfaces)
    return surfaces if factors == (1.0, 1.0, 1.0) else tuple(s.moved(np.eye(4), factors) for s in surfaces)


def _read_surfaces(path: str, bound: float) -> tuple[Surface, ...]:
    pieces: dict[RGBA, list[tuple[Floats, Array]]] = {}
    surfaces, meshes = [], read_pieces(path)
    everything = np.concatenate([piece.vertices for piece in meshes])
    bound = min(bound, _MAX_RELATIVE_DEVIATION * float(np.ptp(everything, axis=0).max()))
    for vertices, faces, mesh in meshes:
        picture = _texture_of(mesh)
        if picture is not None:
            uv, image = picture
            surfaces.append(
                surface_with_normals(
                    vertices, faces, _material_colour(mesh.visual.material), uv=uv, image=image
                )
            )
            continue
        for rgba, chosen in _colours(mesh):
            pieces.setdefault(rgba, []).append((vertices, faces if chosen is None else faces[chosen]))
    for rgba, parts in pieces.items():
        offsets = np.cumsum([0, *(len(v) for v, _ in parts)])
        vertices = np.concatenate([v for v, _ in parts])
        faces = np.concatenate([f + o for (_, f), o in zip(parts, offsets, strict=False)])
        surface = surface_with_normals(vertices, faces, rgba, bound=bound)
        if len(surface.triangles):
            surfaces.append(surface)
    if not surfaces:
        raise InputError(f"The mesh file {path!r} holds no triangles.")
    return tuple(surfaces)


def _texture_of(mesh: Any) -> tuple[Floats, bytes] | None:
    """Where the vertices of a trimesh mesh lie in its texture, and the texture as a PNG file."""
    visual = getattr(mesh, "visual", None)
    uv = getattr(visual, "uv", None)
    material = getattr(visual, "material", None)
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if uv is None or image is None or len(uv) != len(mesh.vertices) or not np.isfinite(uv).all():
        return None
    try:
        largest = max(image.size)
        if largest > _MAX_TEXTURE_SIZE:
            image = image.resize(tuple(max(1, round(n * _MAX_TEXTURE_SIZE / largest)) for n in image.size))
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
    is_8bit = numbers.max(initial=0.0) > 1.0 or np.asarray(value).dtype.kind == "u"
    rgba = colour(np.clip(numbers / 255.0 if is_8bit else numbers, 0.0, 1.0))
    # COLLADA writers disagree about which end of transparency is opaque; an invisible part is never meant
    return rgba if rgba[3] > 0.02 else (*rgba[:3], 1.0)
