"""The path of a frame of a moving robot, as a line through its newest positions."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any, final

import numpy as np

from ulna.typing import Floats
from ulna.viewer.graph.content import Lines
from ulna.viewer.graph.scene_graph import SceneGraph

_MIN_DISTANCE = 1e-4  # m between two points


@final
class FramePath:
    """The path of the origin of a frame: its newest `most` positions, drawn in the style of `line`.

    Args:
        scene: The scene.
        name: The name of the line.
        robot: The robot.
        frame: The frame; None for the tool.
        line: How the line is drawn.
        most: The largest number of positions.
    """

    def __init__(
        self, scene: SceneGraph, name: str, robot: Any, frame: str | None, line: Lines, most: int
    ) -> None:
        self.scene, self.name, self._robot, self._frame, self._line = scene, name, robot, frame, line
        self._points: deque[Floats] = deque(maxlen=most)
        self._shown: Floats | None = None  # instead of the positions, while a motion is played
        scene.add(name, shadow=False, through=True, content=line)

    @property
    def points(self) -> list[Floats]:
        """Its positions [m]; assigning sets others, also none."""
        return list(self._points)

    @points.setter
    def points(self, points: Sequence[Floats]) -> None:
        self._points.clear()
        self._points.extend(points)
        self._shown = None
        self.scene.defer(self, self._update)

    def add(self, q: Floats) -> None:
        """The robot is at `q` (nq,) now."""
        point = np.asarray(self._robot.fk(q, self._frame))[:3, 3]
        if not self._points or np.abs(point - self._points[-1]).max() > _MIN_DISTANCE:
            self._points.append(point)
            self.scene.defer(self, self._update)
        if self._shown is not None:
            self._shown = None
            self.scene.defer(self, self._update)

    def show(self, q: Floats) -> None:
        """Draw the path through configurations (n, nq) instead, until a position is added."""
        most = self._points.maxlen or len(q)
        rows = q if len(q) <= most else q[np.linspace(0, len(q) - 1, most).round().astype(int)]
        self._shown = np.asarray(self._robot.fk(rows, self._frame))[:, :3, 3]
        self.scene.defer(self, self._update)

    def _update(self) -> None:
        if self.name in self.scene:
            line, points = self._line, list(self._points) if self._shown is None else self._shown
            points = np.reshape(points, (-1, 3))
            self.scene.set_content(self.name, Lines.through(points, line.rgba, line.thickness))
