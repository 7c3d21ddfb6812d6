"""Adding frames, arrows, lines, points, text and grids to a scene, each under a name."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import length_array
from ulna.checks.former_names import former_keywords
from ulna.checks.values import count
from ulna.checks.values import length as checked_length
from ulna.errors import InputError
from ulna.idioms import check_keywords
from ulna.typing import ArrayLike, Floats
from ulna.viewer.colours import Colour, faded, faded_colours
from ulna.viewer.graph.arrow import Arrow, add_arrow
from ulna.viewer.graph.content import Lines, Points, Text, transforms
from ulna.viewer.graph.handles import Handle, Label, PointCloud, Polyline
from ulna.viewer.mesh.primitives import axes
from ulna.viewer.mesh.surface import RGBA
from ulna.viewer.scene.registry import HandleRegistry

DEFAULT_SHAPE_COLOUR: RGBA = (0.35, 0.52, 0.78, 1.0)
"""The colour of shapes and arrows that are given none."""

_MAX_GRID_LINES = 2000  # of a grid, each way
_LINE_COLOUR: RGBA = (0.32, 0.42, 0.56, 1.0)  # seen on a light floor and on a dark one


class AnnotationMethods(HandleRegistry):
    """Methods that add annotations to a scene."""

    @check_keywords
    def group(self, name: str, *, pose: Any = None) -> Handle:
        """Add a group: its pose, colour, opacity, scale and visibility hold for all nodes in it.

        Args:
            name: Its name.
            pose: T_group_thing, shape (4, 4), or a position (3,) [m].

        Returns:
            The handle.

        Raises:
            InputError, ShapeError, NonFiniteError: An argument is invalid.
        """
        return self._add_node(name, "group", pose=pose)

    @check_keywords
    def axes(
        self, length: float = 0.1, *, name: str | None = None, pose: Any = None, opacity: float = 1.0
    ) -> Handle:
        """Add a frame: arrows in red, green, blue along x, y, z.

        Args:
            length: Length of an arrow [m].
            name: Its name, with its groups; an unused one when not given.
            pose: T_group_thing, shape (4, 4), or a position (3,) [m].
            opacity: From 0 to 1 [-].

        Returns:
            The handle.

        Raises:
            InputError, ShapeError, NonFiniteError: An argument is invalid.
        """
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
        """Add an arrow, as of a displacement, a force or a velocity.

        Args:
            vector: The vector, shape (3,), in the axes of its group.
            start: Where it begins, shape (3,) [m].
            name: Its name, with its groups; an unused one when not given.
            color: The colour; a default when not given.
            opacity: From 0 to 1 [-].
            radius: Radius of its shaft [m].
            size: Length drawn for each unit of `vector` [m]: 1 for a displacement, 0.01 for a force of some newtons.

        Returns:
            The handle; `vector` and `size` can be assigned to.

        Raises:
            InputError, ShapeError, NonFiniteError: An argument is invalid.
        """
        origin = length_array("start", start, 3)
        node = self._name(name, "arrow")
        color, opacity = faded(color, opacity)
        out = add_arrow(
            self.scene, node, vector, DEFAULT_SHAPE_COLOUR if color is None else color, radius, size
        )
        matrix = np.array(out.pose)
        matrix[:3, 3] = origin
        out.pose = matrix
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
        """Add a line through points.

        Args:
            points: The points, shape (n, 3) [m].
            name: Its name, with its groups; an unused one when not given.
            pose: T_group_thing, shape (4, 4), or a position (3,) [m].
            color: The colour; a default when not given.
            opacity: From 0 to 1 [-].
            thickness: Its thickness [m].

        Returns:
            The handle; `points` can be assigned to.

        Raises:
            InputError, ShapeError, NonFiniteError: An argument is invalid.

        Example:
            >>> robot, viewer = ulna.load("panda"), ulna.Viewer(page=False)
            >>> named = robot.configurations
            >>> Q = robot.interpolate(named["qz"], named["ready"], np.linspace(0.0, 1.0, 50))
            >>> path = viewer.line(robot.fk(Q)[:, :3, 3], color="red")
            >>> path.points.shape
            (50, 3)
        """
        color, opacity = faded(color, opacity)
        content = Lines.through(points, _LINE_COLOUR if color is None else color, thickness)
        return self._add_node(
            name, "line", content=content, pose=pose, opacity=opacity, shadow=False, kind_of=Polyline
        )

    def curve(self, points: ArrayLike, *, steps: int = 12, **more: Any) -> Polyline:
        """Add a smooth curve through points: a uniform Catmull-Rom spline.

        Args:
            points: The points, shape (n, 3) [m].
            steps: Line segments between two points.
            more: As for `line`.

        Returns:
            The handle; `points` can be assigned to.

        Raises:
            InputError, ShapeError, NonFiniteError: An argument is invalid.
        """
        return self.line(
            _catmull_rom(length_array("points", points, None, 3), count("steps", steps, 1, 1000)), **more
        )

    @check_keywords
    def points(
        self,
        positions: ArrayLike,
        colors: ArrayLike | str = (0.2, 0.4, 0.75),
        size: float = 0.01,
        *,
        name: str | None = None,
        pose: Any = None,
        opacity: float = 1.0,
    ) -> PointCloud:
        """Add a point cloud.

        Args:
            positions: The points, shape (n, 3) [m].
            colors: Red, green, blue from 0 to 1, shape (n, 3); or one colour for all points, (3,) or a name.
            size: Diameter of a point [m].
            name: Its name, with its groups; an unused one when not given.
            pose: T_group_thing, shape (4, 4), or a position (3,) [m].
            opacity: From 0 to 1 [-].

        Returns:
            The handle; `points` and `colors` can be assigned to.

        Raises:
            InputError, ShapeError, NonFiniteError: An argument is invalid.
        """
        colors, opacity = faded_colours(colors, opacity)
        content = Points(length_array("positions", positions, None, 3), colors, size)
        return self._add_node(
            name, "points", content=content, pose=pose, opacity=opacity, shadow=False, kind_of=PointCloud
        )

    @former_keywords(words="text")
    @check_keywords
    def text(
        self,
        text: str,
        position: ArrayLike = (0.0, 0.0, 0.0),
        *,
        height: float = 0.05,
        name: str | None = None,
        color: Colour | None = None,
        opacity: float = 1.0,
    ) -> Label:
        """Add text that faces the camera.

        Args:
            text: The text.
            position: Where it begins, shape (3,) [m].
            height: Height of the letters [m].
            name: Its name, with its groups; an unused one when not given.
            color: The colour; the text colour of the theme when not given.
            opacity: From 0 to 1 [-].

        Returns:
            The handle; `text` can be assigned to.

        Raises:
            InputError, ShapeError, NonFiniteError: An argument is invalid.
        """
        origin = transforms([length_array("position", position, 3)])[0]
        color, opacity = faded(color, opacity)
        out = self._add_node(
            name, "text", content=Text(text, height), pose=origin, opacity=opacity, kind_of=Label
        )
        out.color = color
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
        """Add a grid of lines in the plane z = 0.

        Args:
            size: Width of the grid [m].
            cell: Width of a cell [m].
            name: Its name, with its groups; an unused one when not given.
            pose: T_group_thing, shape (4, 4), or a position (3,) [m].
            color: The colour; a default when not given.
            opacity: From 0 to 1 [-].

        Returns:
            The handle.

        Raises:
            InputError, ShapeError, NonFiniteError: An argument is invalid.
        """
        edge, each = checked_length("size", size), checked_length("cell", cell)
        lines = int(min(edge / each, 2.0 * _MAX_GRID_LINES) + 1e-9)
        if not 1 <= lines <= _MAX_GRID_LINES:
            raise InputError(
                f"A grid of `size` {edge} m has {edge / each:.3g} cells of {each} m along an edge; expected 1 to "
                f"{_MAX_GRID_LINES}."
            )
        ticks = (np.arange(lines + 1) - lines / 2) * each
        end = np.full_like(ticks, lines / 2 * each)
        flat = np.zeros_like(ticks)
        along = np.stack([np.stack([ticks, -end, flat], 1), np.stack([ticks, end, flat], 1)], 1)
        segments = np.concatenate([along, along[:, :, [1, 0, 2]]])
        color, opacity = faded(color, opacity)
        rgba = _LINE_COLOUR if color is None else (*color, 1.0)
        content = Lines(np.asarray(segments, dtype=float), rgba, 0.002)
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
