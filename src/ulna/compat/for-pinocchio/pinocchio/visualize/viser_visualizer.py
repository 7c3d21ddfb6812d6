"""The visualizer of viser's spelling."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

from gepetto.corbaserver.gui import Gui

from pinocchio.visualize.camera import CameraVisualizer
from ulna.viewer.viewer import Viewer


@final
class ViserVisualizer(CameraVisualizer):
    """Draws into a new viewer, or into the one passed to it. `viewer` is its viser server: `viz.viewer.scene`, ..."""

    _EXPECTED = "a viser.ViserServer, an ulna.Viewer, or the `viewer` of another visualizer"

    def initViewer(
        self,
        viewer: Any = None,
        open: bool = False,
        loadModel: bool = False,
        host: Any = None,
        port: Any = None,
        **more: Any,
    ) -> None:
        """Opens the viewer; returns at once.

        Args:
            viewer: A `viser.ViserServer`, or an `ulna.Viewer`, to draw into; a new viewer when not given.
            open: Whether to open a browser window, where there is a screen.
            loadModel: Whether to load the geometries, too.
            host: Address of the page of a new viewer.
            port: Its port, a number or its digits [-].
            more: None is offered.
        """
        options = {"host": host, "port": None if port is None else int(port)}
        super().initViewer(viewer, open, loadModel, **options, **more)

    def _gui_of(self, viewer: Any) -> Gui:
        if hasattr(viewer, "scene") and hasattr(viewer, "get_clients"):
            return Gui(Viewer(server=viewer, browser=False))
        return super()._gui_of(viewer)

    @property
    def viewer(self) -> Any:
        """The viser server; without a page, the client that draws."""
        page = self._gui.viewer._page
        return self._viewer if page is None else page.server

    @viewer.setter
    def viewer(self, viewer: Any) -> None:
        self._attach(viewer, {})

    def loadViewerModel(
        self,
        rootNodeName: str = "pinocchio",
        collision_color: Sequence[float] | None = None,
        visual_color: Sequence[float] | None = None,
        frame_axis_length: float = 0.2,
        frame_axis_radius: float = 0.01,
    ) -> None:
        """Loads the geometries into the viewer, below a node of that name.

        Args:
            rootNodeName: The node; what was there before is replaced.
            collision_color: Red, green, blue, opacity of the collision geometries; their own when not given.
            visual_color: Those of the visual geometries.
            frame_axis_length: Length of the axes that `displayFrames` shows [m].
            frame_axis_radius: Radius of their shafts [m].
        """
        self._axes = (frame_axis_length, 80 * frame_axis_radius / frame_axis_length)
        super().loadViewerModel(rootNodeName, None, collision_color, visual_color)

    _axes = (0.2, 4.0)

    def displayFrames(
        self,
        visibility: bool,
        frame_ids: Sequence[int] | None = None,
        axis_length: float | None = None,
        axis_width: float | None = None,
    ) -> None:
        """Shows or hides the axes of frames.

        Args:
            visibility: Whether to show them.
            frame_ids: Indices of the frames; all by default.
            axis_length: Length of an axis [m]; that of loadViewerModel by default.
            axis_width: Thickness of the axes [-]; that of loadViewerModel by default.
        """
        length, width = self._axes
        super().displayFrames(visibility, frame_ids, axis_length or length, axis_width or width)
