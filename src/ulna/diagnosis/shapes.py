"""Checks of meshes: missing or unreadable files, millimetres for metres, collision meshes that are not convex."""

from __future__ import annotations

import importlib.util
import itertools
import math
from collections.abc import Iterator

import numpy as np

from ulna.diagnosis.finding import Finding
from ulna.errors import InputError, MissingExtra
from ulna.geometry import Geometry, Mesh
from ulna.geometry.meshes import merged, read_pieces
from ulna.geometry.shapes import half_edges
from ulna.model import Model
from ulna.typing import Array, Floats

_HUGE = 30.0
"""No link is larger; in millimetres nearly all are [m]."""

_CONVEX = 0.8
"""A mesh fills at least this part of its convex hull, or it is not nearly convex."""


class Shapes:
    """The geometry of a model, each file read once: points for sizes, and what is wrong with the files."""

    def __init__(self, model: Model) -> None:
        self.findings: list[Finding] = []
        self._read: dict[str, tuple[Floats, Array] | None] = {}
        self.points: dict[str, Floats] = {}
        for link in model.links:
            points = [self._points(link.name, g, "visual") for g in link.visuals]
            points += [self._points(link.name, g, "collision") for g in link.collisions]
            known = [p for p in points if p is not None]
            if known and len(known) == len(points):
                self.points[link.name] = np.concatenate(known)

    def _points(self, link: str, geometry: Geometry, role: str) -> Floats | None:
        shape = geometry.shape
        if isinstance(shape, Mesh):
            read = self._mesh(link, shape, role)
            if read is None:
                return None
            corners = read[0] * np.array(shape.scale)
            size = float(np.ptp(corners, axis=0).max())
            if size > _HUGE:
                self.findings.append(
                    Finding(
                        "warning",
                        "huge-mesh",
                        f"link {link!r}",
                        f"its {role} mesh {shape.file_name!r} is {size:.3g} m large",
                        'If it is in millimetres, write scale="0.001 0.001 0.001".',
                    )
                )
            if role == "collision":
                self.findings += _convexity(link, shape, *read)
        else:
            half = half_edges(shape)
            if half is None or math.isinf(half[0]):
                return None
            corners = np.array(list(itertools.product(*((-h, h) for h in half))))
        T = geometry.placement
        return corners @ np.asarray(T.rotation).T + np.asarray(T.translation)

    def _mesh(self, link: str, shape: Mesh, role: str) -> tuple[Floats, Array] | None:
        subject = f"link {link!r}"
        if shape.path is None or shape.missing:
            self.findings.append(
                Finding(
                    "error",
                    "missing-mesh",
                    subject,
                    f"the file of its {role} mesh {shape.file_name!r} is not there",
                    "Pass package_dirs=[folder of the packages] (--package-dirs), or set ROS_PACKAGE_PATH.",
                )
            )
            return None
        if shape.path not in self._read:
            try:
                pieces = read_pieces(shape.path)
            except MissingExtra:
                pieces = ()
            except InputError as error:
                pieces = ()
                self.findings.append(
                    Finding(
                        "error", "bad-mesh", subject, f"its {role} mesh: {error}", "Export the file anew."
                    )
                )
            self._read[shape.path] = merged(pieces) if pieces else None
        return self._read[shape.path]


def _convexity(link: str, shape: Mesh, vertices: Floats, triangles: Array) -> Iterator[Finding]:
    """Whether a mesh fills its convex hull; nothing is said where it is open or flat, or without SciPy."""
    if importlib.util.find_spec("scipy") is None:
        return
    from scipy.spatial import ConvexHull, QhullError

    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)
    if np.linalg.norm(areas.sum(axis=0)) > 1e-6 * np.linalg.norm(areas, axis=1).sum():
        return  # an open surface has no inside
    volume = abs(float((a * np.cross(b, c)).sum())) / 6.0
    try:
        hull = float(ConvexHull(vertices).volume)
    except (QhullError, ValueError):
        return
    if hull > 0.0 and volume < _CONVEX * hull:
        yield Finding(
            "note",
            "not-convex",
            f"link {link!r}",
            f"its collision mesh {shape.file_name!r} is not convex: it fills {100 * volume / hull:.0f} % of its hull",
            "Checks by convex hulls find contacts too early; split it into convex parts, or see docs/collision.md.",
        )
