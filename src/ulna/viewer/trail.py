"""The way of a frame of a moving robot, as a line of its newest points."""

from __future__ import annotations

from collections import deque
from typing import Any, final

import numpy as np

from ulna.typing import Floats
from ulna.viewer.content import Lines
from ulna.viewer.scene import Scene
from ulna.viewer.surface import RGBA

_SEEN = 1e-4  # m between two points


@final
class Trail:
    """The way of a frame's origin, as a line of its newest points."""

    def __init__(
        self, scene: Scene, name: str, robot: Any, frame: str | None, rgba: RGBA, most: int, thickness: float
    ) -> None:
        self.scene, self.name, self._robot, self._frame = scene, name, robot, frame
        self._rgba, self._thickness = rgba, thickness
        self._points: deque[Floats] = deque(maxlen=max(int(most), 2))
        scene.add(name, shadow=False, through=True, content=Lines(np.zeros((0, 2, 3)), rgba, thickness))

    def add(self, q: Floats) -> None:
        """The robot is at `q` (nq,) now."""
        point = np.asarray(self._robot.fk(q, self._frame))[:3, 3]
        if not self._points or np.abs(point - self._points[-1]).max() > _SEEN:
            self._points.append(point)
            self.scene.later(self, self._bring)

    def _bring(self) -> None:
        if self.name in self.scene:
            self.scene.set_content(self.name, Lines.through(list(self._points), self._rgba, self._thickness))
