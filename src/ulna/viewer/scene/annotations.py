"""Putting frames, arrows, lines, points, words and grids into a scene, each under a name of its own."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import length_array
from ulna.checks.values import count, fraction
from ulna.checks.values import length as checked_length
from ulna.errors import InputError
from ulna.idioms import check_keywords
from ulna.typing import ArrayLike, Floats
from ulna.viewer.colours import Colour
from ulna.viewer.graph.arrow import Arrow, add_arrow
from ulna.viewer.graph.content import Lines, Points, Text, transforms
from ulna.viewer.graph.handles import Handle, Label, PointCloud, Polyline
from ulna.viewer.mesh.primitives import axes
from ulna.viewer.mesh.surface import RGBA, colour
from ulna.viewer.scene.registry import HandleRegistry

DEFAULT_SHAPE_COLOUR: RGBA = (0.35, 0.52, 0.78, 1.0)
"""The colour of shapes and arrows that are given none."""

_MAX_GRID_LINES = 2000  # of a grid, each way
_LINE_COLOUR: RGBA = (0.32, 0.42, 0.56, 1.0)  # seen on a light floor and on a dark one


class AnnotationMethods(HandleRegistry):
    """A scene to draw into."""

    @check_keywords
    def group(self, name: str, *, pose: Any = None) -> Handle:
        """A group of its own, to move, tint, fade, scale and hide what is added under its name."""
        return self._add_node(name, "group", pose=pose)

    @check_keywords
    def axes(
        self, length: float = 0.1, *, name: str | None = None, pose: Any = None, opacity: float = 1.0
    ) -> Handle:
        """A frame: arrows in red, green, blue along x, y, z."""
        return self._add_node(
            name,
            "axes",
            axes(checked_length("length", length)),
            pose=pose,
            opacity=opacity,
            shadow=False,
            through=True,
        )

    @check_keywords
    def arrow(
        self,
        vector: ArrayLike,
        start: ArrayLike = (0.0, 0.0, 0.0),
        *,
        name: str | None = None,
        color: Colour | None = None,
        opacity: float = 1.0,
        radius: float = 0.008,
        size: float = 1.0,
    ) -> Arrow:
        """An arrow along `vector` (3,) from `start` (3,) [m], as of a force or a velocity.

        It is drawn `size` [m] long for each unit of `vector`: 1 for a way in metres, 0.01 for a force of some newtons.
        """
        place = length_array("start", start, 3)
        node = self._name(name, "arrow")
        fraction("opacity", opacity)
        out = add_arrow(
            self.scene, node, vector, DEFAULT_SHAPE_COLOUR if color is None else color, radius, size
        )
        turn = out.pose
        turn[:3, 3] = place
        out.pose = turn
        self._register(out, opacity)
        return out

    @check_keywords
    def line(
        self,
        points: ArrayLike,
        *,
        name: str | None = None,
        pose: Any = None,
        color: Colour | None = None,
        opacity: float = 1.0,
        thickness: float = 0.004,
    ) -> Polyline:
        """A line from point to point, (n, 3) [m]."""
        content = Lines.through(points, _LINE_COLOUR if color is None else color, thickness)
        return self._add_node(
            name, "line", content=content, pose=pose, opacity=opacity, shadow=False, kind_of=Polyline
        )

    def curve(self, points: ArrayLike, *, steps: int = 12, **more: Any) -> Polyline:
        """A smooth curve through points (n, 3) [m]: a Catmull-Rom spline with `steps` pieces between two of them."""
        return self.line(
            _catmull_rom(length_array("points", points, None, 3), count("steps", steps, 1, 1000)), **more
        )

    @check_keywords
    def points(
        self,
        positions: ArrayLike,
        colors: ArrayLike = (0.2, 0.4, 0.75),
        size: float = 0.01,
        *,
        name: str | None = None,
        pose: Any = None,
        opacity: float = 1.0,
    ) -> PointCloud:
        """A cloud of points (n, 3) [m], of one colour (3,) or one for each (n, 3); `size` is their diameter [m]."""
        content = Points(length_array("positions", positions, None, 3), colors, size)
        return self._add_node(
            name, "points", content=content, pose=pose, opacity=opacity, shadow=False, kind_of=PointCloud
        )

    @check_keywords
    def text(
        self,
        words: str,
        position: ArrayLike = (0.0, 0.0, 0.0),
        *,
        height: float = 0.05,
        name: str | None = None,
        color: Colour | None = None,
        opacity: float = 1.0,
    ) -> Label:
        """Words that face whoever looks, dark or light as suits the theme; `height` of the letters in metres."""
        place = transforms([length_array("position", position, 3)])[0]
        rgba = None if color is None else colour(color)
        out = self._add_node(
            name, "text", content=Text(words, height), pose=place, opacity=opacity, kind_of=Label
        )
        out.color = rgba
        return out

    @check_keywords
    def grid(
        self,
        size: float = 2.0,
        cell: float = 0.1,
        *,
        name: str | None = None,
        pose: Any = None,
        color: Colour | None = None,
        opacity: float = 1.0,
    ) -> Handle:
        """A grid of lines in the plane z = 0, `size` [m] wide with cells of `cell` [m]."""
        whole, each = checked_length("size", size), checked_length("cell", cell)
        lines = int(min(whole / each, 2.0 * _MAX_GRID_LINES) + 1e-9)
        if not 1 <= lines <= _MAX_GRID_LINES:
            raise InputError(
                f"A grid of `size` {whole} m has {whole / each:.3g} cells of {each} m along an edge; expected 1 to "
                f"{_MAX_GRID_LINES}."
            )
        ticks = (np.arange(lines + 1) - lines / 2) * each
        end = np.full_like(ticks, lines / 2 * each)
        flat = np.zeros_like(ticks)
        along = np.stack([np.stack([ticks, -end, flat], 1), np.stack([ticks, end, flat], 1)], 1)
        segments = np.concatenate([along, along[:, :, [1, 0, 2]]])
        content = Lines(
            np.asarray(segments, dtype=float), _LINE_COLOUR if color is None else colour(color), 0.002
        )
        return self._add_node(name, "grid", content=content, pose=pose, opacity=opacity, shadow=False)


def _catmull_rom(points: Floats, steps: int) -> Floats:
    """Points on the uniform Catmull-Rom spline through points (n, 3)."""
    if len(points) < 3:
        return points
    padded = np.concatenate([2 * points[:1] - points[1:2], points, 2 * points[-1:] - points[-2:-1]])
    t = (np.arange(steps) / steps)[:, None]
    a, b, c, d = (padded[k : len(padded) - 3 + k, None] for k in range(4))
    curve = 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
    return np.concatenate([curve.reshape(-1, 3), points[-1:]])
