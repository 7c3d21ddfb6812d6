"""Mesh files (dae, stl, obj, glb ...) as plain triangles, in the frame of the file, in metres."""

from __future__ import annotations

import functools
import importlib
import math
import os
import re
import sys
import warnings
from collections.abc import Sequence
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from ulna.errors import InputError, needed
from ulna.files import open_regular, reject_special_files
from ulna.system import ctrl_c
from ulna.typing import Array, Floats

FARTHEST = 1e15
"""How far a vertex may be from the origin [m]; beyond it squares of distances leave the range of single precision."""


class Piece(NamedTuple):
    """One part of a mesh file, placed where the file puts it."""

    vertices: Floats
    """Positions [m], shape (n, 3)."""
    triangles: Array
    """Indices of vertices, anticlockwise seen from outside, shape (m, 3)."""
    source: Any
    """The trimesh object it came from, which knows its colours."""


def read_pieces(path: str) -> tuple[Piece, ...]:
    """The parts of a mesh file; a COLLADA file's unit is applied and its up axis is not, as the robotics tools do.

    Raises:
        MissingExtra: trimesh (or pycollada, for .dae) is not installed.
        InputError: The file cannot be opened, cannot be read as a mesh, or holds no triangles.
    """
    try:
        file = open_regular(path)
    except OSError as error:
        raise InputError(f"Cannot open the mesh file {path!r}: {error.strerror or error}.") from error
    with file:
        scene = _scene(file, path)
    pieces = []
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not hasattr(mesh, "faces") or len(mesh.faces) == 0:
            continue
        factor = _metres(mesh.metadata.get("units"))
        vertices = np.asarray(mesh.vertices, dtype=float)
        if factor != 1.0 or not np.array_equal(transform, np.eye(4)):
            vertices = (vertices @ transform[:3, :3].T + transform[:3, 3]) * factor
        triangles = np.asarray(mesh.faces, dtype=np.int64)
        _check_mesh_data(path, vertices, triangles)
        if np.linalg.det(transform[:3, :3]) < 0:
            triangles = triangles[:, ::-1]
        pieces.append(Piece(vertices, triangles, mesh))
    if not pieces:
        raise InputError(f"The mesh file {path!r} holds no triangles.")
    return tuple(pieces)


def merged(pieces: Sequence[Piece]) -> tuple[Floats, Array]:
    """Vertices (n, 3) [m] and triangles (m, 3) of all parts of a mesh."""
    offsets = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    triangles = [piece.triangles + offset for piece, offset in zip(pieces, offsets, strict=False)]
    return np.concatenate([piece.vertices for piece in pieces]), np.concatenate(triangles)


def _check_mesh_data(path: str, vertices: Floats, triangles: Array) -> None:
    """Refuse what no sound file holds; the parsers let it pass."""
    wrong = ""
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        wrong = f"its vertices have the shape {vertices.shape}; expected (n, 3)"
    elif triangles.ndim != 2 or triangles.shape[1] != 3:
        wrong = f"its faces have the shape {triangles.shape}; expected (m, 3)"
    elif not np.isfinite(vertices).all():
        wrong = f"vertex {int(np.argwhere(~np.isfinite(vertices))[0][0])} is not finite"
    elif np.abs(vertices).max(initial=0.0) > FARTHEST:
        wrong = f"a vertex is {np.abs(vertices).max():.3g} m from the origin; expected at most {FARTHEST:g} m"
    elif triangles.min() < 0 or triangles.max() >= len(vertices):
        number = int(triangles.min() if triangles.min() < 0 else triangles.max())
        wrong = f"a face names vertex {number}, and there are {len(vertices)}"
    if wrong:
        raise InputError(f"The mesh file {path!r} is damaged: {wrong}.")


def _scene(file: BinaryIO, path: str) -> Any:
    """What trimesh makes of an open mesh file."""
    with needed("trimesh", "mesh", "Reading mesh files"):
        library = _trimesh()
    ending = os.path.splitext(path)[1].lower()
    if ending == ".dae":
        with needed("pycollada", "mesh", "Reading mesh files"):
            import collada  # noqa: F401
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # trimesh and pycollada warn about numpy and about odd files
            resolver = _referenced_files(library.resolvers.FilePathResolver)(path)
            return library.load(file, file_type=ending[1:], resolver=resolver, force="scene", process=False)
    except Exception as error:  # any of a dozen parsers underneath
        raise InputError(f"Cannot read the mesh file {path!r}: {type(error).__name__}: {error}") from error


def _trimesh() -> Any:
    """The module trimesh.

    As it is imported it catches every exception of what it imports in turn, KeyboardInterrupt too, and goes on without
    SciPy. So Ctrl-C waits until it is imported.
    """
    if "trimesh" not in sys.modules:
        with ctrl_c.later():
            importlib.import_module("trimesh")
    return importlib.import_module("trimesh")


@functools.cache
def _referenced_files(base: Any) -> Any:
    """The class that reads the files a mesh file names (materials, textures), regular files only."""

    class ReferencedFiles(base):
        def get(self, name: str) -> bytes:
            for candidate in (name.strip(), name.strip().lstrip("/"), os.path.split(name)[-1]):
                reject_special_files(os.path.join(self.parent, candidate))
            return super().get(name)

        def namespaced(self, namespace: str) -> ReferencedFiles:
            return ReferencedFiles(os.path.join(self.parent, namespace))

    return ReferencedFiles


def _metres(text: object) -> float:
    """Metres in one unit of length of the file."""
    match = re.fullmatch(r"\s*([0-9.eE+-]+)\s*\*\s*meters\s*", str(text)) if text else None
    try:
        factor = float(match.group(1)) if match else 1.0
    except ValueError:  # such as "1e"
        return 1.0
    return factor if math.isfinite(factor) and factor > 0.0 else 1.0
