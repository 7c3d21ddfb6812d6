"""Nodes of MeshCat's tree that are no objects of the user: "/Cameras", "/Background", "/Grid", "/Axes", "/Lights"."""

from __future__ import annotations

import dataclasses
from typing import Any, final

import numpy as np
from gepetto.corbaserver.gui import Gui
from gepetto.corbaserver.tree import PARTS, without

from ulna.checks.arrays import shaped_array
from ulna.errors import InputError, UnknownName
from ulna.viewer.colours import colour
from ulna.viewer.graph.camera import Camera

NAMES = ("Cameras", "Background", "Grid", "Axes", "Lights")
"""The names at the root that are no objects of the user."""
_AXES = f"{PARTS}axes"
_WHITE = (255, 255, 255)


@final
class Surroundings:
    """Camera, background and axes of a viewer.

    Args:
        gui: The calls of the viewer.
    """

    def __init__(self, gui: Gui) -> None:
        self._viewer = gui.viewer
        self._covered: dict[str, Any] = {}  # colours of the theme that are hidden, by their names
        self._frame = np.eye(4)
        self._position, self._target = np.zeros(3), np.zeros(3)
        self._fov, self._zoom = 0.0, 1.0
        self._camera: Camera | None = None  # as it was set here last; others set it, too

    # the camera -----------------------------------------------------------------------------------------

    def look(self, position: Any = None, target: Any = None, frame: Any = None) -> None:
        """Places the camera.

        Args:
            position: Where it stands in its frame, (3,) [m]; as before when not given.
            target: What it looks at in its frame, (3,) [m]; as before when not given.
            frame: Its frame in the world, (4, 4); as before when not given.
        """
        old = self._present_camera()
        self._position = self._position if position is None else shaped_array("position", position, 3)
        self._target = self._target if target is None else shaped_array("target", target, 3)
        if frame is not None:
            self._frame, self._target = shaped_array("matrix", frame, 4, 4), np.zeros(3)
        rotation, origin = self._frame[:3, :3], self._frame[:3, 3]
        points = {"position": self._position, "target": self._target}
        in_world = {key: tuple((rotation @ value + origin).tolist()) for key, value in points.items()}
        up = tuple((rotation @ (0.0, 0.0, 1.0)).tolist())
        self._camera = self._viewer.camera = dataclasses.replace(old, up=up, **in_world)

    def set_lens(self, fov: float | None = None, zoom: float | None = None) -> None:
        """Changes how much the camera sees.

        Args:
            fov: Vertical field of view without zoom [degrees]; as before when not given.
            zoom: Magnification [-]; as before when not given.
        """
        old = self._present_camera()
        self._fov = self._fov if fov is None else float(np.deg2rad(float(fov)))
        self._zoom = self._zoom if zoom is None else float(zoom)
        field_of_view = float(2.0 * np.arctan(np.tan(self._fov / 2.0) / self._zoom))
        self._camera = self._viewer.camera = dataclasses.replace(old, fov=field_of_view)

    def _present_camera(self) -> Camera:
        """The viewer's camera; what was set elsewhere since is taken over."""
        new, old = self._viewer.camera, self._camera
        if old is None or (new.position, new.target) != (old.position, old.target):
            rotation, origin = self._frame[:3, :3], self._frame[:3, 3]
            self._position, self._target = (
                rotation.T @ (np.array(point) - origin) for point in (new.position, new.target)
            )
        if old is None or new.fov != old.fov:
            self._fov, self._zoom = new.fov, 1.0
        return new

    # what MeshCat calls properties and objects ----------------------------------------------------------

    def set_property(self, entries: tuple[str, ...], key: str, value: Any) -> None:
        """Changes a property.

        Args:
            entries: Names from the root.
            key: Name of the property.
            value: The new value.

        Raises:
            UnknownName: There is no such property.
        """
        if entries[0] == "Lights":
            without(
                f"/{'/'.join(entries)}: set_property({key!r})", "the lights are those of the viewer's theme."
            )
            return
        setters = {
            "Cameras": {
                # three.js has y up
                "position": lambda p: self.look(position=[p[0], -p[2], p[1]]),
                "zoom": lambda zoom: self.set_lens(zoom=zoom),
                "fov": lambda fov: self.set_lens(fov=fov),
            },
            "Background": {
                "top_color": lambda rgb: self._colour_sky("top", rgb),
                "bottom_color": lambda rgb: self._colour_sky("horizon", rgb),
                "visible": self._show_sky,
            },
            "Grid": {"visible": self._show_grid},
            "Axes": {"visible": self._show_axes},
        }[entries[0]]
        if key not in setters:
            raise UnknownName(f"property of /{entries[0]}", key, setters)
        setters[key](value)

    def set_object(self, entries: tuple[str, ...], value: Any) -> None:
        """Replaces the lens of the camera.

        Args:
            entries: Names from the root.
            value: A `PerspectiveCamera`.

        Raises:
            InputError: Anything else.
        """
        if entries[0] != "Cameras" or type(value).__name__ != "PerspectiveCamera":
            raise InputError(
                f"/{'/'.join(entries)} was given {value!r}; expected a PerspectiveCamera at '/Cameras/default/rotated'."
            )
        self.set_lens(value.fov, value.zoom)

    def set_transform(self, entries: tuple[str, ...], matrix: Any) -> None:
        """Places the camera's frame.

        Args:
            entries: Names from the root.
            matrix: The frame in the world, (4, 4).

        Raises:
            InputError: Something other than a camera.
        """
        if entries[0] != "Cameras":
            raise InputError(f"/{'/'.join(entries)} cannot be placed; '/Cameras/default' can.")
        self.look(frame=matrix)

    def _colour_sky(self, part: str, rgb: Any) -> None:
        values = tuple(round(255 * c) for c in colour(rgb)[:3])
        if part in self._covered and getattr(self._viewer.theme, part) == _WHITE:
            self._covered[part] = values
        else:
            self._viewer.theme = dataclasses.replace(self._viewer.theme, **{part: values})

    def _show_sky(self, visible: bool) -> None:
        self._show(visible, {"top": _WHITE, "horizon": _WHITE})

    def _show_grid(self, visible: bool) -> None:
        """Lines of the floor are hidden by the colour of the floor."""
        floor = self._viewer.theme.floor
        self._show(visible, {"section": floor, "cell": floor})

    def _show(self, visible: bool, covers: dict[str, Any]) -> None:
        """Shows colours of the theme as they were, or others in their place; what was set since stays."""
        theme = self._viewer.theme
        news = {}
        for part, cover in covers.items():
            now = getattr(theme, part)
            if visible and part in self._covered:
                before = self._covered.pop(part)
                news[part] = before if now == cover else now
            elif not visible and now != cover:
                self._covered[part], news[part] = now, cover
        self._viewer.theme = dataclasses.replace(theme, **news)

    def _show_axes(self, visible: bool) -> None:
        if _AXES in self._viewer.scene:
            self._viewer.remove(_AXES)
        if visible:
            self._viewer.axes(0.5, name=_AXES)
