"""Windows, cameras and pictures: every window is a name for the one page."""

from __future__ import annotations

import abc
import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gepetto.corbaserver.documentation import describe_arguments
from gepetto.corbaserver.placement import configuration_of, pose_of
from gepetto.corbaserver.tree import Tree
from ulna.errors import InputError, UnknownName
from ulna.numeric.arrays import triple
from ulna.viewer.colours import colour
from ulna.viewer.graph.camera import Camera

_SIZE = (960, 600)  # of pictures [pixels]


@describe_arguments
class Windows(Tree, abc.ABC):
    """Calls about windows."""

    def __init__(self, viewer: Any) -> None:
        super().__init__(viewer)
        self._windows: list[str] = []
        self._capture: tuple[str, str] | None = None
        self._captured = 0

    def createWindow(self, name: str) -> str:
        """A window, by whose name it is meant in other calls."""
        if name not in self._windows:
            self._windows.append(name)
        return name

    def getWindowID(self, name: str) -> str:
        """The window of that name. Raises UnknownName with the nearest one if there is none."""
        return self._window(name)

    def getWindowList(self) -> list[str]:
        """The names of the windows."""
        return list(self._windows)

    def addSceneToWindow(self, sceneName: str, wid: str) -> bool:
        """Shows a scene in a window; all scenes are in one page anyway.

        Args:
            sceneName: Name of the scene.
        """
        self.known(sceneName)
        self._window(wid)
        return True

    def _window(self, wid: str) -> str:
        if wid not in self._windows:
            raise UnknownName("window", wid, self._windows, "createWindow(name) makes one.")
        return wid

    def setBackgroundColor1(self, wid: str, RGBAcolor: Sequence[float]) -> bool:
        """Colours the upper sky.

        Args:
            RGBAcolor: Red, green, blue, opacity from 0 to 1; the opacity is ignored.
        """
        return self._set_background(wid, "top", RGBAcolor)

    def setBackgroundColor2(self, wid: str, RGBAcolor: Sequence[float]) -> bool:
        """Colours the sky at the horizon.

        Args:
            RGBAcolor: Red, green, blue, opacity from 0 to 1; the opacity is ignored.
        """
        return self._set_background(wid, "horizon", RGBAcolor)

    def _set_background(self, wid: str, field: str, rgba: Sequence[float]) -> bool:
        self._window(wid)
        red, green, blue = (round(255 * c) for c in colour(rgba)[:3])
        self.viewer.theme = dataclasses.replace(self.viewer.theme, **{field: (red, green, blue)})
        return True

    # camera ---------------------------------------------------------------------------------------------

    def getCameraTransform(self, wid: str) -> list[float]:
        """Where the camera is, as seven numbers; its axes are right, up and backwards of the picture."""
        self._window(wid)
        camera, pose = self.viewer.camera, np.eye(4)
        pose[:3, :3], pose[:3, 3] = camera.axes(), camera.position
        return configuration_of(pose)

    def setCameraTransform(self, wid: str, configuration: Sequence[float]) -> bool:
        """Places the camera; its axes are right, up and backwards of the picture."""
        self._window(wid)
        pose, old = pose_of(configuration), self.viewer.camera
        away = max(float(np.linalg.norm(np.subtract(old.position, old.target))), 0.1)
        eye, up, target = pose[:3, 3], pose[:3, 1], pose[:3, 3] - away * pose[:3, 2]
        self.viewer.camera = Camera(triple(eye), triple(target), old.fov, triple(up))
        return True

    def setCameraToBestFit(self, wid: str) -> bool:
        """Moves the camera so that everything is in view."""
        self._window(wid)
        self.viewer.camera = None
        return True

    def detachCamera(self, wid: str) -> bool:
        """Lets the camera follow no node; it never does."""
        self._window(wid)
        return True

    # pictures -------------------------------------------------------------------------------------------

    def captureFrame(self, wid: str, imageFilename: str) -> bool:
        """Writes a picture, drawn without a browser.

        Args:
            imageFilename: Name of the file, .png.

        Raises:
            InputError: Another kind of file.
        """
        self._window(wid)
        if Path(imageFilename).suffix.lower() != ".png":
            raise InputError(f"Pictures are written as .png here; {imageFilename!r} is none.")
        self.viewer.picture(imageFilename, *_SIZE)
        return True

    def startCapture(self, wid: str, filename: str, extension: str) -> bool:
        """Writes a picture filename_0_0.png, filename_0_1.png, ... at every `refresh` from now on.

        Args:
            filename: How the names begin.
            extension: "png".

        Raises:
            InputError: Another kind of file.
        """
        self._window(wid)
        if extension.lower().lstrip(".") != "png":
            raise InputError(
                f"Pictures are written as png here; {extension!r} is none. viewer.film writes .mp4, .gif."
            )
        self._capture, self._captured = (filename, "png"), 0
        return True

    def stopCapture(self, wid: str) -> bool:
        """Writes no more pictures at `refresh`."""
        self._window(wid)
        self._capture = None
        return True

    def refreshed(self) -> None:
        """Has the page show what is new, and a capture take it."""
        if self._capture is not None:
            name, ending = self._capture
            self.viewer.picture(f"{name}_0_{self._captured}.{ending}", *_SIZE)
            self._captured += 1

    def writeNodeFile(self, nodeName: str, filename: str) -> bool:
        """Writes the whole scene as one HTML file that can be viewed offline.

        Args:
            nodeName: Name of a node, which is checked only.
            filename: Name of the file.
        """
        self.known(nodeName)
        return self._html(filename)

    def writeWindowFile(self, wid: str, filename: str) -> bool:
        """Writes the scene as one HTML file that can be viewed offline.

        Args:
            filename: Name of the file.
        """
        self._window(wid)
        return self._html(filename)

    def _html(self, filename: str) -> bool:
        if Path(filename).suffix.lower() not in (".html", ".htm"):
            raise InputError(f"Scenes are written as .html here; {filename!r} is none.")
        self.viewer.html(filename)
        return True
