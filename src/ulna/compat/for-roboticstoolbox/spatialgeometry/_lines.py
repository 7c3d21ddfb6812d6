"""Things to look at that nothing collides with: axes, arrows, lines."""

from __future__ import annotations

import warnings
from typing import Any, Self

import numpy as np

from spatialgeometry._shape import Length, Shape, positive
from ulna.checks.arrays import finite_array
from ulna.errors import InputError, ShapeError
from ulna.typing import Floats

__all__ = ["Arrow", "Axes", "Path", "Polyline"]

_PIXEL = 0.002  # m; how thick a line of one pixel is drawn


class Axes(Shape):
    """A frame: lines in red, green, blue along x, y, z.

    Args:
        length: How long they are [m].
        arrows: Whether they have tips. Ulna's always do.
        radius: Radius of their shafts [m]; Ulna's suit their length.
        linewidth: Width of their shafts in pixels, as `radius`.
        kwargs: As for `Shape`.
    """

    kind, lengths, _has_colours = "axes", ("length",), True
    length, radius, linewidth = Length(), Length(), Length()

    def __init__(
        self, length: float, arrows: bool = False, radius: float = 0.0, linewidth: float = 1.0, **kwargs: Any
    ) -> None:
        self.length, self.radius, self.linewidth = length, radius, linewidth
        self._arrows = bool(arrows)
        super().__init__(**kwargs)

    @property
    def arrows(self) -> bool:
        """Whether they were asked to have tips."""
        return self._arrows

    @arrows.setter
    def arrows(self, arrows: bool) -> None:
        self._arrows = bool(arrows)

    def _draw(self, viewer: Any, name: str) -> None:
        viewer.axes(self.length, name=name)


class Arrow(Shape):
    """An arrow along z from the origin of its frame.

    Args:
        length: From end to tip [m].
        radius: Radius of its shaft [m]; 0 for one of `linewidth` pixels.
        linewidth: Width of its shaft in pixels.
        head_length: Length of its head, as a fraction of `length`.
        head_radius: Radius of its head, as a fraction of the head's length.
        kwargs: As for `Shape`.
    """

    kind = "arrow"
    lengths = ("length", "radius", "linewidth", "head_length", "head_radius")
    length, radius, linewidth, head_length, head_radius = Length(), Length(), Length(), Length(), Length()

    def __init__(
        self,
        length: float,
        radius: float = 0.0,
        linewidth: float = 1.0,
        head_length: float = 0.2,
        head_radius: float = 0.2,
        **kwargs: Any,
    ) -> None:
        self.length, self.radius, self.linewidth = length, radius, linewidth
        self.head_length, self.head_radius = head_length, head_radius
        super().__init__(**kwargs)

    @classmethod
    def FromTo(cls, start: Any, end: Any, **kwargs: Any) -> Self:
        """An arrow from one point to another.

        Args:
            start: The start, (3,) [m].
            end: The end, (3,) [m].
            **kwargs: Other arguments of `Arrow`.

        Returns:
            The arrow.

        Raises:
            InputError: They are one point.
        """
        from ulna.viewer.graph.arrow import rotation_to

        a, b = (np.asarray(p, dtype=float).reshape(3) for p in (start, end))
        length = positive("distance from start to end", np.linalg.norm(b - a))
        if length == 0.0:
            raise InputError(f"`start` and `end` are both {a.tolist()}; an arrow needs a direction.")
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = rotation_to(b - a), a
        return cls(length, pose=pose, **kwargs)

    def _draw(self, viewer: Any, name: str) -> None:
        head = min(self.head_length, 1.0) * self.length
        shaft = max(self.length - head, 1e-6)
        viewer.group(name)
        rod, tip = np.eye(4), np.eye(4)
        rod[2, 3], tip[2, 3] = shaft / 2, self.length - head / 2
        viewer.cylinder(self.radius or self.linewidth * _PIXEL / 2, shaft, name=f"{name}/shaft", pose=rod)
        if head > 0.0:
            viewer.cone(max(head * self.head_radius, 1e-6), head, name=f"{name}/head", pose=tip)


class Polyline(Shape):
    """A line from point to point.

    Args:
        points: Its points as columns, (3, n) [m].
        radius: Its radius [m]; 0 for a line of `linewidth` pixels.
        linewidth: Its width in pixels.
        kwargs: As for `Shape`.
    """

    kind, lengths = "path", ("points", "radius", "linewidth")
    radius, linewidth = Length(), Length()

    def __init__(self, points: Any, radius: float = 0.0, linewidth: float = 1.0, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.points, self.radius, self.linewidth = points, radius, linewidth

    @property
    def points(self) -> Floats:
        """Its points as columns, (3, n) [m]."""
        return self._points.copy()

    @points.setter
    def points(self, points: Any) -> None:
        out = finite_array("points", points)
        if out.ndim != 2 or out.shape[0] != 3:
            raise ShapeError("points", out.shape, "(3, n), a point in each column")
        self._points = out
        self.changes += 1

    def _draw(self, viewer: Any, name: str) -> None:
        viewer.line(self._points.T, name=name, thickness=2 * self.radius or self.linewidth * _PIXEL)


class Path(Polyline):
    """An older name of `Polyline`."""

    def __init__(self, points: Any, radius: float = 0.0, linewidth: float = 1.0, **kwargs: Any) -> None:
        warnings.warn("Path is an older name; it is called Polyline now.", FutureWarning, stacklevel=2)
        super().__init__(points, radius, linewidth, **kwargs)
