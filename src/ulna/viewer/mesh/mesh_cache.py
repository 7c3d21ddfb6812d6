"""Disk cache of mesh files, by the hash of their content: reading them again takes milliseconds."""

from __future__ import annotations

import io
import os
import re

import numpy as np

from ulna import disk_cache as cache
from ulna.files import read_regular
from ulna.viewer.mesh.surface import Surface, Texture

_FORMAT_VERSION = "ulna mesh 2"
# other files that a mesh file names: materials, textures, buffers
_FILE_ENDING = re.compile(rb"\.(?:png|jpe?g|tga|bmp|tiff?|gif|mtl|bin)\b", re.IGNORECASE)
_DELIMITER = re.compile(rb"[\"'<>\r\n\t]")


def cache_key(path: str, bound: float = 0.0) -> str:
    """The cache key of a mesh file: it changes with the content of all files that it references, and
    with how far surfaces may be from it, in its own units.

    Args:
        path: Path of the mesh file.
        bound: How far surfaces may be from it, in its own units [any].

    Returns:
        The key.
    """
    content = read_regular(path)
    parts: list[str | bytes] = [_FORMAT_VERSION, f"{bound:.6g}", os.path.splitext(path)[1].lower(), content]
    _append_referenced_files(os.path.dirname(path), content, parts, set())
    return cache.key(*parts)


def _append_referenced_files(
    folder: str, content: bytes, parts: list[str | bytes], visited: set[str], depth: int = 0
) -> None:
    """Append what the files hold that a text file names, and those that they name; each file once."""
    names: set[bytes] = set()
    for match in _FILE_ENDING.finditer(content):
        before = _DELIMITER.split(content[max(0, match.start() - 300) : match.end()])[-1].strip()
        names |= {before, before.split()[-1]}  # alone, or after a keyword
    for name in sorted(names):
        other = os.path.join(folder, os.fsdecode(name).replace("\\", "/"))
        if os.path.isfile(other) and os.path.realpath(other) not in visited:
            visited.add(os.path.realpath(other))
            content = read_regular(other)
            parts += [name, content]
            if depth == 0 and other.lower().endswith(".mtl"):
                _append_referenced_files(folder, content, parts, visited, 1)


def read_cached(name: str) -> tuple[Surface, ...] | None:
    """The cached surfaces of a key; None where there are none, or damaged ones."""
    data = cache.read(name)
    if data is None:
        return None
    with np.load(io.BytesIO(data), allow_pickle=False) as stored:
        out = []
        for k in range(int(stored["count"])):
            vertices, triangles, normals, rgba = (stored[f"{part}{k}"] for part in "vtnc")
            texture = (
                Texture(stored[f"u{k}"].astype(float), stored[f"i{k}"].tobytes())
                if f"u{k}" in stored
                else None
            )
            out.append(Surface(vertices, triangles, normals, tuple(rgba.tolist()), texture))
    return tuple(out)


def write_cached(name: str, surfaces: tuple[Surface, ...]) -> None:
    """Cache surfaces under a key; where the disk cannot be written they are read again the next time.

    Args:
        name: The key.
        surfaces: The surfaces.
    """
    parts: dict[str, np.ndarray] = {"count": np.array(len(surfaces))}
    for k, s in enumerate(surfaces):
        parts |= {f"v{k}": s.vertices.astype(np.float32), f"n{k}": s.normals.astype(np.float32)}
        parts |= {f"t{k}": s.triangles.astype(np.uint32), f"c{k}": np.array(s.rgba)}
        if s.texture is not None:
            parts |= {f"u{k}": s.texture.uv.astype(np.float32)}
            parts |= {f"i{k}": np.frombuffer(s.texture.image, dtype=np.uint8)}
    file = io.BytesIO()
    np.savez(file, **parts)  # type: ignore[arg-type]
    cache.write(name, file.getvalue())
