"""Where visualizers let the scene be looked at from."""

from __future__ import annotations

import abc
import dataclasses
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from pinocchio.visualize.base_visualizer import BaseVisualizer
from ulna.errors import UnknownName
from ulna.numeric.arrays import triple
from ulna.viewer.colours import colour


class CameraVisualizer(BaseVisualizer, abc.ABC):
    """A visualizer whose camera and background can be set.

    Attributes:
        CAMERA_PRESETS: For each name where the camera looks, and where it is [m].
    """

    CAMERA_PRESETS: ClassVar[dict[str, list[list[float]]]] = {
        "preset0": [[0.0, 0.0, 0.0], [3.0, 0.0, 1.0]],
        "preset1": [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]],
        "preset2": [[0.0, 0.0, 0.6], [0.8, 1.0, 1.2]],
        "acrobot": [[0.0, 0.1, 0.0], [0.5, 0.0, 0.2]],
        "cam_ur": [[0.4, 0.6, -0.2], [1.0, 0.4, 1.2]],
        "cam_ur2": [[0.4, 0.3, 0.0], [0.5, 0.1, 1.4]],
        "cam_ur3": [[0.4, 0.3, 0.0], [0.6, 1.3, 0.3]],
        "cam_ur4": [[-1.0, 0.3, 0.0], [1.3, 0.1, 1.2]],
        "cam_ur5": [[-1.0, 0.3, 0.0], [-0.05, 1.5, 1.2]],
        "talos": [[0.0, 1.2, 0.0], [1.5, 0.3, 1.5]],
        "talos2": [[0.0, 1.1, 0.0], [1.2, 0.6, 1.5]],
    }

    def _look(self, **news: Any) -> None:
        viewer = self._gui.viewer
        viewer.camera = dataclasses.replace(viewer.camera, **news)

    def setCameraTarget(self, target: Sequence[float]) -> None:
        """Has the camera look at a point [m]."""
        self._look(target=triple(target))

    def setCameraPosition(self, position: Sequence[float]) -> None:
        """Puts the camera at a point [m]."""
        self._look(position=triple(position))

    def setCameraZoom(self, zoom: float) -> None:
        """Makes things appear so many times as large as with the usual lens."""
        from ulna.viewer.graph.camera import Camera

        self._look(fov=float(2.0 * np.arctan(np.tan(Camera().fov / 2.0) / zoom)))

    def setCameraPose(self, pose: Any) -> None:
        """Places the camera; x is right, y up, z backwards of the picture."""
        M = np.asarray(getattr(pose, "homogeneous", pose), dtype=float)
        old = self._gui.viewer.camera
        away = float(np.linalg.norm(np.subtract(old.position, old.target)))
        self._look(position=triple(M[:3, 3]), target=triple(M[:3, 3] - away * M[:3, 2]), up=triple(M[:3, 1]))

    def setCameraPreset(self, preset_key: str) -> None:
        """Places the camera as one of `CAMERA_PRESETS` says: "preset1", "cam_ur", "talos", ..."""
        if preset_key not in self.CAMERA_PRESETS:
            raise UnknownName("camera preset", preset_key, self.CAMERA_PRESETS)
        target, position = self.CAMERA_PRESETS[preset_key]
        self._look(up=(0.0, 0.0, 1.0))
        self.setCameraTarget(target)
        self.setCameraPosition(position)

    def enableCameraControl(self) -> None:
        """Lets the mouse move the camera, as it always may."""

    def disableCameraControl(self) -> None:
        """Leaves the camera to calls; the mouse may still move it."""

    def setBackgroundColor(
        self,
        preset_name: str = "gray",
        col_top: Sequence[float] | None = None,
        col_bot: Sequence[float] | None = None,
    ) -> None:
        """Colours the sky.

        Args:
            preset_name: "white", "gray" or "black", where `col_top` is not passed.
            col_top: Red, green, blue from 0 to 1 above.
            col_bot: Red, green, blue from 0 to 1 at the horizon; `col_top` by default.

        Raises:
            UnknownName: Another preset.
        """
        named = {"white": (1.0,) * 3, "gray": (0.9,) * 3, "grey": (0.9,) * 3, "black": (0.0,) * 3}
        if col_top is None and preset_name not in named:
            raise UnknownName("background", preset_name, named)
        top = colour(named[preset_name] if col_top is None else col_top)
        low = top if col_bot is None else colour(col_bot)
        viewer = self._gui.viewer
        top8, low8 = (tuple(round(255 * c) for c in rgba[:3]) for rgba in (top, low))
        viewer.theme = dataclasses.replace(viewer.theme, top=top8, horizon=low8)
