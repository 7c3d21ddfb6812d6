"""The visualizer of Gepetto: nodes below a scene, `viewer.gui` with all calls."""

from __future__ import annotations

from typing import Any, final

from gepetto.corbaserver.client import shared_gui
from gepetto.corbaserver.gui import Gui

from pinocchio.visualize.camera import CameraVisualizer


@final
class GepettoVisualizer(CameraVisualizer):
    """Draws into the viewer that all clients of Gepetto share in this process."""

    def initViewer(
        self,
        viewer: Any = None,
        windowName: Any = "python-pinocchio",
        sceneName: Any = "world",
        loadModel: bool = False,
        open: bool = False,
        **more: Any,
    ) -> None:
        """Opens the viewer; returns at once.

        Args:
            viewer: A client, or an `ulna.Viewer`; the one that all clients share when not given.
            windowName: The window.
            sceneName: The scene, below which the robot's nodes are.
            loadModel: Whether to load the geometries, too.
            open: Plays no part: the viewer opens a browser window where there is a screen.
            more: Plays no part.
        """
        self._attach(viewer, {})
        gui = self._gui
        gui.createWindow(windowName)
        gui.createScene(sceneName)
        gui.addSceneToWindow(sceneName, windowName)
        self.sceneName = sceneName
        self.windowID = windowName
        if loadModel:
            self.loadViewerModel()

    def _opened(self, options: dict[str, Any]) -> Gui:
        return shared_gui()
