"""MeshCat's tree: objects by paths, placed and changed one by one."""

from __future__ import annotations

import os
import tempfile
import time
from dataclasses import dataclass
from html import escape
from typing import Any, NoReturn, final

import numpy as np
from gepetto.corbaserver.client import opened
from gepetto.corbaserver.gui import Gui

from meshcat.drawing import drawn
from meshcat.path import Path
from meshcat.surroundings import NAMES
from meshcat.window import ViewerWindow
from ulna.checks.arrays import shaped_array
from ulna.checks.values import flag
from ulna.errors import InputError, MissingExtra, UnknownName, ViewerError
from ulna.spatial import quat_xyzw_to_matrix
from ulna.viewer.colours import colour
from ulna.viewer.page.browser import open_browser, somebody_can_look

_PROPERTIES = ("visible", "color", "opacity", "modulated_opacity", "position", "quaternion", "scale")
_ROOT = ("meshcat",)


@final
@dataclass(frozen=True)
class NotebookCell:
    """A page in the cell of a notebook.

    Attributes:
        url: Address of the page; empty where the page itself is given.
        height: Height [pixels].
        page: The page as HTML, or nothing.
    """

    url: str
    height: int
    page: str = ""

    def _repr_html_(self) -> str:
        source = f'srcdoc="{escape(self.page)}"' if self.page else f'src="{self.url}"'
        return f'<iframe {source} width="100%" height="{self.height:d}" style="border:0"></iframe>'


@final
class Visualizer:
    """A place in MeshCat's tree: `viz["goal/tip"]` is one further down, "/" at the beginning starts from the root.

    Args:
        zmq_url: Accepted and ignored: the viewer is in this process.
        window: The viewer to draw into; a new one when not given.
        server_args: Accepted and ignored.
    """

    __slots__ = ("path", "window")

    def __init__(
        self, zmq_url: Any = None, window: ViewerWindow | None = None, server_args: Any = ()
    ) -> None:
        self.window = ViewerWindow(opened(browser=False)) if window is None else window
        self.path = Path(_ROOT)

    @staticmethod
    def view_into(window: ViewerWindow, path: Path) -> Visualizer:
        """A place in the tree of a window.

        Args:
            window: The window.
            path: The place.

        Returns:
            The place, to be drawn at.
        """
        out = Visualizer(window=window)
        out.path = path
        return out

    def __getitem__(self, path: str) -> Visualizer:
        return Visualizer.view_into(self.window, self.path.append(path))

    @property
    def gui(self) -> Gui:
        """The calls of Gepetto's viewer on the same nodes."""
        return self.window.gui

    @property
    def viewer(self) -> Any:
        """The `ulna.Viewer` behind it."""
        return self.window.gui.viewer

    def _is_surroundings(self) -> bool:
        """Whether it is the camera, the background, ..., not an object."""
        return self.path.entries[:1] != () and self.path.entries[0] in NAMES

    def _node(self) -> str:
        """The name of the node in the viewer; empty for the root."""
        entries = self.path.entries
        entries = entries[1:] if entries[:1] == _ROOT else entries
        if entries[-1:] == ("<object>",):
            entries = entries[:-1]
        return self.window.gui.at("/".join(entries)) if entries else ""

    def _named_node(self, call: str) -> str:
        node = self._node()
        if not node:
            raise InputError(f"{call} needs the path of an object: `viewer['name'].{call}(...)`.")
        return node

    def set_object(self, geometry: Any, material: Any = None) -> None:
        """Replaces what is seen here.

        Args:
            geometry: A geometry, or an object with its material, of `meshcat.geometry`.
            material: The material of a geometry; white when not given.

        Raises:
            InputError: Anything else.
        """
        if self._is_surroundings():
            self.window.surroundings.set_object(self.path.entries, geometry)
            return
        self.window.show(self._named_node("set_object"), drawn(geometry, material))

    def set_transform(self, matrix: Any = None) -> None:
        """Places what is here, and all below it.

        Args:
            matrix: The place in the group above, (4, 4); the identity when not given. It may stretch objects.

        Raises:
            ShapeError, InputError: It is no such matrix.
        """
        if self._is_surroundings():
            self.window.surroundings.set_transform(self.path.entries, np.eye(4) if matrix is None else matrix)
            return
        values = np.eye(4) if matrix is None else shaped_array("matrix", matrix, 4, 4)
        if not np.allclose(values[3], (0.0, 0.0, 0.0, 1.0)):
            raise InputError(f"The last row of `matrix` is {values[3].tolist()}; expected [0, 0, 0, 1].")
        self.window.place(self._named_node("set_transform"), values)

    def set_property(self, key: str, value: Any) -> None:
        """Changes one property of what is here, for all below it.

        Args:
            key: "visible", "color", "opacity", "modulated_opacity", "position", "quaternion" or "scale"; for
                "/Background" "top_color", "bottom_color" and "visible", for "/Cameras/default" "position", "zoom" and
                "fov", for "/Grid" and "/Axes" "visible".
            value: The new value.

        Raises:
            UnknownName: There is no such property.
        """
        if self._is_surroundings():
            self.window.surroundings.set_property(self.path.entries, key, value)
            return
        if key not in _PROPERTIES:
            raise UnknownName("property of an object", key, _PROPERTIES)
        node = self._named_node("set_property")
        self.window.gui.createGroup(node)
        handle = self.viewer[node]
        match key:
            case "visible":
                handle.visible = flag("visible", bool(value))
            case "color":
                rgba = colour(value)
                handle.color, handle.opacity = rgba[:3], rgba[3]
            case "opacity" | "modulated_opacity":
                handle.opacity = value
            case _:
                self._move(node, key, value)

    def _move(self, node: str, key: str, value: Any) -> None:
        matrix = self.window.gui.scene.pose(node)
        stretch = self.window.stretched.get(node, np.eye(3))
        if key == "position":
            matrix[:3, 3] = shaped_array("position", value, 3)
        elif key == "quaternion":
            quat = shaped_array("quaternion", value, 4)
            matrix[:3, :3] = quat_xyzw_to_matrix(quat / np.linalg.norm(quat))
        else:
            stretch = np.diag(np.broadcast_to(np.asarray(value, dtype=float), 3))
        matrix[:3, :3] = matrix[:3, :3] @ stretch
        self.window.place(node, matrix)

    def delete(self) -> None:
        """Removes what is here, and all below it; nothing happens where there is nothing."""
        if self._is_surroundings():
            raise InputError(
                f"{self.path.lower()} cannot be deleted; set_property('visible', False) hides it."
            )
        self.window.remove(self._node())

    def set_animation(self, animation: Any, play: bool = True, repetitions: int = 1) -> NoReturn:
        """Not offered.

        Args:
            animation: Accepted and ignored.
            play: Accepted and ignored.
            repetitions: Accepted and ignored [-].

        Raises:
            ViewerError: Always.
        """
        raise ViewerError(
            "MeshCat's animations are not offered: `viz.play(q_trajectory, dt)` moves a robot, set_transform an object."
        )

    # the camera -----------------------------------------------------------------------------------------

    def set_cam_pos(self, value: Any) -> None:
        """Puts the camera at a point (3,) [m]."""
        self.window.surroundings.look(position=value)

    def set_cam_target(self, value: Any) -> None:
        """Has the camera look at a point (3,) [m]."""
        self.window.surroundings.look(target=value)

    # the page -------------------------------------------------------------------------------------------

    def open(self) -> Visualizer:
        """Opens a browser window, where there is a screen."""
        open_browser(self.viewer.url)
        return self

    def url(self) -> str:
        """The address of the page; empty without one."""
        return self.viewer.url

    def wait(self) -> None:
        """Waits for a browser to look; returns at once where there is no screen."""
        while somebody_can_look() and not self.viewer.closed and self.viewer.clients == 0:
            time.sleep(0.05)

    def close(self) -> None:
        """Closes the page."""
        self.viewer.close()

    def jupyter_cell(self, height: int = 400) -> Any:
        """The page, for the end of a notebook's cell.

        Args:
            height: Height of the page [pixels].

        Returns:
            What a notebook shows; None without a page.
        """
        return NotebookCell(self.url(), height) if self.url() else None

    def render_static(self, height: int = 400) -> NotebookCell:
        """The scene as it is now, for the end of a notebook's cell; later changes do not reach it.

        Args:
            height: Height of the page [pixels].

        Returns:
            What a notebook shows.
        """
        return NotebookCell("", height, self.static_html())

    def static_html(self) -> str:
        """The scene as one HTML file that can be viewed offline."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "scene.html")
            self.viewer.html(path)
            with open(path, encoding="utf-8") as file:
                return file.read()

    def get_image(self, w: int | None = None, h: int | None = None) -> Any:
        """A picture of the scene, drawn without a browser.

        Args:
            w: Width [pixels]; 960 by default.
            h: Height [pixels]; 600 by default.

        Returns:
            A picture of the package pillow.

        Raises:
            MissingExtra: pillow is not installed.
        """
        try:
            from PIL import Image
        except ImportError as error:
            raise MissingExtra("pillow", "film", "A picture as an object of pillow") from error
        return Image.fromarray(self.viewer.picture(None, w or 960, h or 600))

    def __repr__(self) -> str:
        return f"<{self.path.lower()} of {self.viewer!r}>"
