"""The viewer that a visualizer draws into: a new one, or one that it is given."""

from __future__ import annotations

import abc
from typing import Any

from gepetto.corbaserver.client import Client, opened
from gepetto.corbaserver.gui import Gui

from ulna.errors import InputError, UnknownName
from ulna.viewer.viewer import Viewer


class Attachment(abc.ABC):
    """The part of a visualizer that is about its viewer."""

    _EXPECTED = "an ulna.Viewer, or the `viewer` of another visualizer"

    def __init__(self) -> None:
        self._gui_or_none: Gui | None = None
        self._viewer: Any = None

    @abc.abstractmethod
    def loadViewerModel(self) -> None:
        """Loads the geometries into the viewer."""

    def initViewer(
        self,
        viewer: Any = None,
        *named: Any,
        loadModel: bool = False,
        open: bool = False,
        **more: Any,
    ) -> None:
        """Opens the viewer; returns at once.

        Args:
            viewer: An `ulna.Viewer`, or a client, to draw into; a new viewer when not given.
            named: Where some visualizers have `open` and `loadModel`.
            loadModel: Whether to load the geometries, too.
            open: Whether to open a browser window, where there is a screen.
            more: `host`, `port` of the page.
        """
        positional = dict(zip(("open", "loadModel"), named, strict=False))
        self._attach(viewer, {"browser": bool(positional.get("open", open)), **_options(more)})
        if positional.get("loadModel", loadModel):
            self.loadViewerModel()

    def _attach(self, viewer: Any, options: dict[str, Any]) -> None:
        self._draw_into(self._opened(options) if viewer is None else self._gui_of(viewer))

    def _gui_of(self, viewer: Any) -> Gui:
        gui = getattr(viewer, "gui", viewer)
        if isinstance(gui, Viewer):
            gui = Gui(gui)
        if not isinstance(gui, Gui):
            raise InputError(f"`viewer` is {viewer!r}; expected None, {self._EXPECTED}.")
        return gui

    def _draw_into(self, gui: Gui) -> None:
        self._gui_or_none = gui
        self._viewer = Client(gui=gui)

    def _opened(self, options: dict[str, Any]) -> Gui:
        return opened(**options)

    @property
    def _gui(self) -> Gui:
        """The calls that draw."""
        if self._gui_or_none is None:
            raise InputError("There is no viewer yet. Call initViewer(loadModel=True) first.")
        return self._gui_or_none

    @property
    def viewer(self) -> Any:
        """The client: `viewer.gui` has the calls that draw, `viewer.viewer` is the `ulna.Viewer`.

        In a class of your own with its own `initViewer` it is what that assigned to it.
        """
        return self._viewer if self._opens_its_own or self._gui is not None else None

    @viewer.setter
    def viewer(self, viewer: Any) -> None:
        try:
            self._attach(viewer, {})
        except InputError:
            if not self._opens_its_own:
                raise
            self._viewer = viewer

    @property
    def _opens_its_own(self) -> bool:
        """Whether another program's subclass draws in its own way."""
        return type(self).initViewer.__module__.partition(".")[0] != Attachment.__module__.partition(".")[0]

    @property
    def _scene(self) -> Any:
        return self._gui.scene


def _options(more: dict[str, Any]) -> dict[str, Any]:
    """Options of a new viewer's page."""
    for name in more:
        if name not in ("host", "port"):
            raise UnknownName("argument of initViewer", name, ("viewer", "open", "loadModel", "host", "port"))
    return {key: value for key, value in more.items() if value is not None}
