"""Clients of the one viewer of this process, which is opened when the first of them wants it."""

from __future__ import annotations

import atexit
import sys
import warnings
from typing import Any, NoReturn, final

import ulna
from gepetto.corbaserver.gui import Gui
from ulna.errors import MissingExtra, UlnaWarning, ViewerError
from ulna.viewer.page.browser import open_browser, somebody_can_look

_shared: list[Gui] = []


def opened(**options: Any) -> Gui:
    """A new viewer, and the calls that draw into it; without viser, one without a page, with a warning.

    A script that ends while somebody can look keeps the page open until Ctrl-C or until its tab is closed, as the
    external viewer stayed; where nobody can, it ends.
    """
    try:
        viewer = ulna.Viewer(**options)
    except MissingExtra as error:
        warnings.warn(f"{error} Going on without a page; pictures can be written.", UlnaWarning, stacklevel=3)
        viewer = ulna.Viewer(page=False)
    if viewer.url and somebody_can_look():
        print(f"Look at {viewer.url}", flush=True)
        if not hasattr(sys, "ps1"):  # at a prompt the user says when it ends
            atexit.register(viewer.hold)
    return Gui(viewer)


def shared_gui() -> Gui:
    """The calls that draw into the viewer all clients share."""
    if not _shared or (_shared[0].viewer.closed and _shared[0].had_page):
        _shared[:] = [opened()]
    return _shared[0]


def shared_viewer() -> Any:
    """The `ulna.Viewer` that all clients share; calls that Gepetto does not have are made on it directly."""
    return shared_gui().viewer


@final
class Client:
    """`Client().gui` has the calls of the viewer. Addresses of servers play no part: the viewer is in this process.

    Args:
        clients, host, port, url: Accepted and ignored.
        gui: What to draw with; None for the viewer that all clients share.
    """

    def __init__(
        self, clients: Any = None, host: Any = None, port: Any = None, url: Any = None, gui: Any = None
    ) -> None:
        self.gui: Gui = gui or shared_gui()
        """Everything that can be drawn."""

    @property
    def viewer(self) -> Any:
        """The `ulna.Viewer` behind it."""
        return self.gui.viewer

    def open(self) -> None:
        """Opens a browser window, where there is a screen."""
        open_browser(self.viewer.url)

    def url(self) -> str:
        """The address of the page; empty without one."""
        return self.viewer.url

    def jupyter_cell(self) -> Any:
        """The page, for the end of a notebook's cell."""
        return self.viewer

    def __getitem__(self, name: str) -> NoReturn:
        """Not offered."""
        raise ViewerError(
            f"This client has no tree of MeshCat's objects: a MeshcatVisualizer's `viewer[{name!r}]` is one of them; "
            "`.gui` adds, places and removes nodes."
        )

    def __repr__(self) -> str:
        return f"<client of {self.viewer!r}>"


def gui_client(window_name: str | None = None, *_: Any, **__: Any) -> Gui:
    """The calls of the viewer.

    Args:
        window_name: Name of a window to create, or None.
        *_: Accepted and ignored.
        **__: Accepted and ignored.

    Returns:
        The calls.
    """
    gui = shared_gui()
    if window_name is not None:
        gui.createWindow(window_name)
    return gui


def start_server(*_: Any, **__: Any) -> None:
    """Opens the viewer, which needs no server.

    Args:
        *_: Accepted and ignored.
        **__: Accepted and ignored.
    """
    shared_gui()
