"""Surfaces as binary glTF, which a browser draws directly: exact normals, a material for each colour."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from ulna.typing import Array
from ulna.viewer.mesh.surface import Surface, Texture, albedo
from ulna.viewer.mesh.vertex_clustering import CLUSTERING_THRESHOLD, clustered
from ulna.viewer.output.png import encode_png

_FLOAT, _UINT16, _UINT32 = 5126, 5123, 5125
_VERTICES, _INDICES = 34962, 34963
TRANSLUCENT_INSET = 0.0007
"""How far within itself a translucent thing is drawn [m]: it does not flicker on a solid one where it coincides."""


def label_glb(height: float) -> bytes:
    """A square for words that the page draws in letters of `height` [m]; it lights itself."""
    corners = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)])
    up, image = np.tile((0.0, 0.0, 1.0), (4, 1)), encode_png(np.full((1, 1, 3), 255, dtype=np.uint8))
    square = Surface(corners, np.array([(0, 1, 2), (0, 2, 3)]), up, texture=Texture(corners[:, :2], image))
    return glb([square], {"words": height})


def glb(surfaces: Iterable[Surface], extras: dict[str, Any] | None = None, ours: bool = False) -> bytes:
    """A binary glTF 2.0 file with one mesh, one primitive for each surface; of a label where `extras` are given.

    For a page that is `ours` the file declares normals without data: the page computes them from shared vertices.
    There, a heavy surface without a texture comes twice, and the page shows one: `level` "few" or "all" triangles.

    Args:
        surfaces: The surfaces.
        extras: Data of the mesh for the page; None for none.
        ours: Whether the file is for Ulna's page.

    Returns:
        The content of the file.
    """
    parts = _Parts()
    for surface, level in _levels(surfaces, ours):
        _add_surface(parts, surface, level, ours)
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "ulna"},
        "scene": 0,
        "scenes": [{"nodes": []}],
    }
    if parts.primitives:
        document |= {
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": parts.primitives, "extras": extras or {}}],
            "materials": parts.materials,
            "accessors": parts.accessors,
            "bufferViews": parts.views,
            "buffers": [{"byteLength": len(parts.data)}],
        }
    if extras:
        document["extensionsUsed"] = ["KHR_materials_unlit"]
        parts.materials[0] |= {"extensions": {"KHR_materials_unlit": {}}, "alphaMode": "BLEND"}
    if parts.images:
        document |= {
            "images": parts.images,
            "samplers": [{}],
            "textures": [{"source": k, "sampler": 0} for k in range(len(parts.images))],
        }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if parts.primitives:
        chunks += struct.pack("<II", len(parts.data), 0x004E4942) + bytes(parts.data)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


class _Parts:
    """The lists of a document, and the bytes that they refer to."""

    def __init__(self) -> None:
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.primitives: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self.images: list[dict[str, Any]] = []
        self.data = bytearray()

    def view(self, content: bytes, **more: Any) -> int:
        """Appends bytes; the number of their view."""
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(content), **more})
        self.data.extend(content + b"\0" * (-len(content) % 4))  # so that all views are aligned
        return len(self.views) - 1

    def accessor(self, values: Array, component: int, target: int, **more: Any) -> int:
        """Appends numbers; the number of their accessor."""
        view = self.view(np.ascontiguousarray(values).tobytes(), target=target)
        kind = "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}"
        self.accessors.append({"bufferView": view, "componentType": component, "count": len(values)})
        self.accessors[-1].update(type=kind, **more)
        return len(self.accessors) - 1

    def undefined_vectors(self, count: int) -> int:
        """Declares vectors without data; the number of their accessor."""
        self.accessors.append({"componentType": _FLOAT, "count": count, "type": "VEC3"})
        return len(self.accessors) - 1


def _add_surface(parts: _Parts, surface: Surface, level: str, ours: bool) -> None:
    """Appends a surface as one primitive, with its material and texture."""
    vertices = surface.vertices.astype("<f4")
    if surface.rgba[3] < 0.999:
        vertices = (surface.vertices - TRANSLUCENT_INSET * surface.normals).astype("<f4")
    bounds = {"min": vertices.min(axis=0).tolist(), "max": vertices.max(axis=0).tolist()}
    attributes = {
        "POSITION": parts.accessor(vertices, _FLOAT, _VERTICES, **bounds),
        "NORMAL": parts.accessor(surface.normals.astype("<f4"), _FLOAT, _VERTICES)
        if not ours
        else parts.undefined_vectors(len(vertices)),
    }
    if surface.texture is not None:
        # glTF counts from the upper left
        uv = surface.texture.uv * (1.0, -1.0) + (0.0, 1.0)
        attributes["TEXCOORD_0"] = parts.accessor(uv.astype("<f4"), _FLOAT, _VERTICES)
    short = len(vertices) < 2**16
    corners = surface.triangles.astype("<u2" if short else "<u4").reshape(-1)
    indices = parts.accessor(corners, _UINT16 if short else _UINT32, _INDICES)
    primitive = {"attributes": attributes, "indices": indices, "material": len(parts.materials)}
    parts.primitives.append(primitive | ({"extras": {"level": level}} if level else {}))
    parts.materials.append(_material(surface, len(parts.images)))
    if surface.texture is not None:
        image = surface.texture.image
        kind = "image/png" if image.startswith(b"\x89PNG") else "image/jpeg"
        parts.images.append({"bufferView": parts.view(image), "mimeType": kind})


def _levels(surfaces: Iterable[Surface], ours: bool) -> Iterator[tuple[Surface, str]]:
    """Surfaces that are not empty, and how many of their triangles are shown."""
    for surface in surfaces:
        if ours and surface.texture is None and len(surface.triangles) >= CLUSTERING_THRESHOLD:
            yield clustered(surface), "few"
            yield surface, "all"
        elif len(surface.triangles):
            yield surface, ""


def _material(surface: Surface, texture: int) -> dict[str, Any]:
    opacity = surface.rgba[3]
    factor = [*(float(c) for c in albedo(np.asarray(surface.rgba[:3]))), opacity]
    shine: dict[str, Any] = {"baseColorFactor": factor, "metallicFactor": 0.0, "roughnessFactor": 0.5}
    if surface.texture is not None:
        shine |= {"baseColorFactor": [0.8, 0.8, 0.8, opacity], "baseColorTexture": {"index": texture}}
    out: dict[str, Any] = {"pbrMetallicRoughness": shine, "doubleSided": opacity >= 0.999}
    if opacity < 0.999:
        out["alphaMode"] = "BLEND"
    return out
