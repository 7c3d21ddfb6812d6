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
    views: list[dict[str, Any]] = []
    accessors: list[dict[str, Any]] = []
    primitives: list[dict[str, Any]] = []
    materials: list[dict[str, Any]] = []
    images: list[dict[str, Any]] = []
    data = bytearray()

    def accessor(values: Array, component: int, target: int, **more: Any) -> int:
        content = np.ascontiguousarray(values).tobytes()
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(content), "target": target})
        data.extend(content + b"\0" * (-len(content) % 4))  # so that all views are aligned
        kind = "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}"
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(values)})
        accessors[-1].update(type=kind, **more)
        return len(accessors) - 1

    def nothing(count: int) -> int:
        accessors.append({"componentType": _FLOAT, "count": count, "type": "VEC3"})
        return len(accessors) - 1

    for surface, level in _levels(surfaces, ours):
        vertices = surface.vertices.astype("<f4")
        if surface.rgba[3] < 0.999:
            vertices = (surface.vertices - TRANSLUCENT_INSET * surface.normals).astype("<f4")
        bounds = {"min": vertices.min(axis=0).tolist(), "max": vertices.max(axis=0).tolist()}
        attributes = {
            "POSITION": accessor(vertices, _FLOAT, _VERTICES, **bounds),
            "NORMAL": accessor(surface.normals.astype("<f4"), _FLOAT, _VERTICES)
            if not ours
            else nothing(len(vertices)),
        }
        if surface.texture is not None:
            # glTF counts from the upper left
            uv = surface.texture.uv * (1.0, -1.0) + (0.0, 1.0)
            attributes["TEXCOORD_0"] = accessor(uv.astype("<f4"), _FLOAT, _VERTICES)
        short = len(vertices) < 2**16
        corners = surface.triangles.astype("<u2" if short else "<u4").reshape(-1)
        indices = accessor(corners, _UINT16 if short else _UINT32, _INDICES)
        primitives.append({"attributes": attributes, "indices": indices, "material": len(materials)})
        if level:
            primitives[-1]["extras"] = {"level": level}
        materials.append(_material(surface, len(images)))
        if surface.texture is not None:
            image = surface.texture.image
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(image)})
            data.extend(image + b"\0" * (-len(image) % 4))
            kind = "image/png" if image.startswith(b"\x89PNG") else "image/jpeg"
            images.append({"bufferView": len(views) - 1, "mimeType": kind})
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "ulna"},
        "scene": 0,
        "scenes": [{"nodes": []}],
    }
    if primitives:
        document |= {
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": primitives, "extras": extras or {}}],
            "materials": materials,
            "accessors": accessors,
            "bufferViews": views,
            "buffers": [{"byteLength": len(data)}],
        }
    if extras:
        document["extensionsUsed"] = ["KHR_materials_unlit"]
        materials[0] |= {"extensions": {"KHR_materials_unlit": {}}, "alphaMode": "BLEND"}
    if images:
        document |= {
            "images": images,
            "samplers": [{}],
            "textures": [{"source": k, "sampler": 0} for k in range(len(images))],
        }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if primitives:
        chunks += struct.pack("<II", len(data), 0x004E4942) + bytes(data)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


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
