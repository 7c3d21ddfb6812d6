"""What a RobotWrapper shows: its geometries, through a visualizer."""

from __future__ import annotations

from typing import Any

from pinocchio._geometry.geometry_data import GeometryData
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._geometry.geometry_object import GeometryObject
from pinocchio._geometry.placements import updateGeometryPlacements
from pinocchio._model.model import Model
from ulna.errors import InputError


class Viewed:
    """The calls of a RobotWrapper that open a viewer and draw."""

    model: Model
    data: Any
    collision_model: GeometryModel | None
    visual_model: GeometryModel | None
    collision_data: GeometryData | None
    visual_data: GeometryData | None
    viz: Any

    def updateGeometryPlacements(self, q: Any = None, visual: bool = False) -> None:
        """Fills `visual_data.oMg` or `collision_data.oMg`.

        Args:
            q: Configuration (nq,) [rad or m]; None for that of `data`.
            visual: Whether those of the visual model.

        Raises:
            InputError: The robot has no such model.
        """
        model, data = (
            (self.visual_model, self.visual_data) if visual else (self.collision_model, self.collision_data)
        )
        if model is None or data is None:
            raise InputError(f"This robot has no {'visual' if visual else 'collision'} model.")
        updateGeometryPlacements(self.model, self.data, model, data, q)

    def setVisualizer(self, visualizer: Any, init: bool = True, copy_models: bool = False) -> None:
        """Has a visualizer show this robot.

        Args:
            visualizer: The visualizer.
            init: Whether to initialise it with the models of this robot.
            copy_models: Whether it copies them.
        """
        if init:
            visualizer.__init__(self.model, self.collision_model, self.visual_model, copy_models)
        self.viz = visualizer

    def initViewer(self, share_data: Any = True, *parts: Any, **named: Any) -> None:
        """Opens the viewer: `initViewer(loadModel=True)`. It returns at once, and never waits for a browser.

        Args:
            share_data: Whether the visualizer works in this robot's data.
            parts: See `GepettoVisualizer.initViewer`.
            named: `windowName`, `sceneName`, `loadModel`.
        """
        if not isinstance(share_data, bool):
            share_data, parts = True, (share_data, *parts)
        if self.viz is None:
            from pinocchio.visualize import Visualizer

            data = (self.data, self.collision_data, self.visual_data) if share_data else (None, None, None)
            models = (self.model, self.collision_model, self.visual_model)
            self.viz = Visualizer.default()(*models, False, *data)
        self.viz.initViewer(*parts, **named)

    def _visualizer(self) -> Any:
        if self.viz is None:
            raise InputError("There is no viewer yet. Call robot.initViewer(loadModel=True) first.")
        return self.viz

    @property
    def viewer(self) -> Any:
        """The viewer: `robot.viewer.gui.addSphere(...)`."""
        return self._visualizer().viewer

    def loadViewerModel(self, *parts: Any, **named: Any) -> None:
        """Loads the geometries into the viewer.

        Args:
            *parts: Arguments of the visualizer's method.
            **named: Its keywords.
        """
        self._visualizer().loadViewerModel(*parts, **named)

    def initDisplay(self, *parts: Any, **named: Any) -> None:
        """The historic name of `initViewer`: (windowName, sceneName, loadModel).

        Args:
            *parts: Window name, scene name, whether to load the model.
            **named: The same by name.
        """
        self.initViewer(True, None, *parts, **named)

    loadDisplayModel = loadViewerModel
    """The historic name of `loadViewerModel`."""

    def getViewerNodeName(self, geometry_object: GeometryObject, geometry_type: Any) -> str:
        """The name of a geometry's node in the viewer.

        Returns:
            The name.
        """
        return self._visualizer().getViewerNodeName(geometry_object, geometry_type)

    viewerNodeNames = getViewerNodeName
    """The historic name of `getViewerNodeName`."""

    def display(self, q: Any) -> None:
        """Shows a configuration."""
        self._visualizer().display(q)

    def displayCollisions(self, visibility: bool) -> None:
        """Shows or hides what it collides with."""
        self._visualizer().displayCollisions(visibility)

    def displayVisuals(self, visibility: bool) -> None:
        """Shows or hides what it looks like."""
        self._visualizer().displayVisuals(visibility)

    def play(self, q_trajectory: Any, dt: float) -> None:
        """Shows configurations one after the other, `dt` seconds each; without a screen, without waiting.

        Args:
            q_trajectory: Configurations, (N, nq) or a list.
            dt: How long each stays [s].
        """
        self._visualizer().play(q_trajectory, dt)
