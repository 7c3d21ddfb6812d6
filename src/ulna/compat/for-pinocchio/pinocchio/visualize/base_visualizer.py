"""A robot in the viewer: its geometries as nodes, moved by one configuration."""

from __future__ import annotations

import abc
import copy
from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._algorithms.configurations import neutral
from pinocchio._algorithms.kinematics import forwardKinematics
from pinocchio._containers.enums import GeometryType
from pinocchio._containers.unknown_ids import known
from pinocchio._geometry.geometry_data import GeometryData
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._geometry.geometry_object import GeometryObject
from pinocchio._geometry.placements import updateGeometryPlacements
from pinocchio._model.model import Model
from pinocchio.visualize.attachment import Attachment
from pinocchio.visualize.figures import figure_of
from pinocchio.visualize.motion_pictures import MotionPictures
from ulna.errors import InputError, UnknownName


class BaseVisualizer(Attachment, MotionPictures, abc.ABC):
    """Shows a robot's geometries: `initViewer(loadModel=True)`, then `display(q)`.

    Args:
        model: The model; or a RobotWrapper, which brings the rest.
        collision_model: What it collides with.
        visual_model: What it looks like.
        copy_models: Whether models are copied, so that later changes to them are not seen.
        data: Its working memory; a new one when not given.
        collision_data: That of the collision geometries.
        visual_data: That of the visual geometries.
    """

    def __init__(
        self,
        model: Any = None,
        collision_model: GeometryModel | None = None,
        visual_model: GeometryModel | None = None,
        copy_models: bool = False,
        data: Any = None,
        collision_data: GeometryData | None = None,
        visual_data: GeometryData | None = None,
    ) -> None:
        if hasattr(model, "visual_model"):
            model, collision_model, visual_model = model.model, model.collision_model, model.visual_model
        self.model: Model = Model() if model is None else model
        self.collision_model, self.visual_model = collision_model, visual_model
        if copy_models:
            self.model, self.collision_model, self.visual_model = copy.deepcopy(
                (self.model, collision_model, visual_model)
            )
        self.rebuildData()
        self.data = self.data if data is None else data
        self.collision_data = self.collision_data if collision_data is None else collision_data
        self.visual_data = self.visual_data if visual_data is None else visual_data
        super().__init__()
        self.sceneName = ""
        """The group that the robot's nodes are in; empty for none."""
        self._root = ""
        self._shown = {GeometryType.VISUAL: True, GeometryType.COLLISION: False}
        self._rows: tuple[Any, ...] = ()
        self._q: Any = None
        self._frames: list[int] = []
        self._film: list[Any] | None = None

    def rebuildData(self) -> None:
        """Makes new data, after frames, joints or geometries were added."""
        self.data: Any = self.model.createData()
        self.collision_data = None if self.collision_model is None else self.collision_model.createData()
        self.visual_data = None if self.visual_model is None else self.visual_model.createData()
        self._rows = ()

    def loadViewerModel(
        self,
        rootNodeName: str = "pinocchio",
        color: Sequence[float] | None = None,
        collision_color: Sequence[float] | None = None,
        visual_color: Sequence[float] | None = None,
    ) -> None:
        """Loads the geometries into the viewer, below a node of that name.

        Args:
            rootNodeName: The node; what was there before is replaced.
            color: Red, green, blue, opacity of all; their own when not given.
            collision_color: Those of the collision geometries.
            visual_color: Those of the visual geometries.
        """
        gui = self._gui
        self._root = f"{self.sceneName}/{rootNodeName}".lstrip("/")
        looks = {
            f"{self._group(kind)}/{g.name}": figure_of(g, kind_color or color)
            for kind, kind_color in (
                (GeometryType.VISUAL, visual_color),
                (GeometryType.COLLISION, collision_color),
            )
            for g in self._objects(kind)
        }
        with self._scene.atomic():
            gui.deleteNode(self._root, True)
            for kind in (GeometryType.VISUAL, GeometryType.COLLISION):
                gui.createGroup(self._group(kind))
                gui.setVisibility(self._group(kind), "ON" if self._shown[kind] else "OFF")
            for name, (surfaces, content) in looks.items():
                self._scene.add(name, surfaces, content=content)
            self._rows = ()
            self.display(np.array(self._neutral()) if self._q is None else self._q)

    def _neutral(self) -> Any:
        return neutral(self.model)

    def _group(self, kind: GeometryType) -> str:
        return f"{self._root}/{'visuals' if kind == GeometryType.VISUAL else 'collisions'}"

    def _objects(self, kind: GeometryType) -> Sequence[GeometryObject]:
        model = self.visual_model if kind == GeometryType.VISUAL else self.collision_model
        return () if model is None else model.geometryObjects

    def getViewerNodeName(self, geometry_object: GeometryObject, geometry_type: GeometryType) -> str:
        """The name of a geometry's node in the viewer.

        Args:
            geometry_object: The geometry.
            geometry_type: GeometryType.VISUAL or COLLISION.

        Returns:
            The name.

        Raises:
            InputError: No model is loaded.
            UnknownName: The model has no such geometry.
        """
        if not self._root:
            raise InputError("No model is loaded yet. Call initViewer(loadModel=True) first.")
        names = [g.name for g in self._objects(geometry_type)]
        if geometry_object.name not in names:
            raise UnknownName(f"geometry in {self._group(geometry_type)}", geometry_object.name, names)
        return f"{self._group(geometry_type)}/{geometry_object.name}"

    def addGeometryObject(self, obj: GeometryObject, color: Sequence[float] | None = None) -> None:
        """Adds a geometry to the visual model, and shows it.

        Args:
            obj: The geometry.
            color: Red, green, blue, opacity; its own by default.
        """
        if self.visual_model is None:
            self.visual_model = GeometryModel()
        self.visual_model.addGeometryObject(obj)
        self.visual_data = self.visual_model.createData()
        self.loadViewerGeometryObject(obj, GeometryType.VISUAL, color)
        self.display()

    def loadViewerGeometryObject(
        self,
        geometry_object: GeometryObject,
        geometry_type: GeometryType,
        color: Sequence[float] | None = None,
    ) -> None:
        """Replaces the surfaces of a geometry of the model in the viewer.

        Args:
            geometry_object: The geometry.
            geometry_type: GeometryType.VISUAL or COLLISION.
            color: Red, green, blue, opacity; its own by default.
        """
        surfaces, content = figure_of(geometry_object, color)
        self._scene.add(self.getViewerNodeName(geometry_object, geometry_type), surfaces, content=content)
        self._rows = ()

    # showing --------------------------------------------------------------------------------------------

    def display(self, q: Any = None) -> None:
        """Shows configuration q, or the data's present placements without one."""
        if not self._root:
            raise InputError("No model is loaded yet. Call initViewer(loadModel=True) first.")
        if q is not None:
            forwardKinematics(self.model, self.data, q)
            self._q = q
        scene, gui = self._scene, self._gui
        with scene.atomic():
            gui.settle()
            for kind, shown in self._shown.items():
                if shown:
                    self.updatePlacements(kind)
            self.updateFrames()
        gui.refreshed()

    def updatePlacements(self, geometry_type: GeometryType) -> None:
        """Moves the geometries of a kind to where the data has them; nodes that were deleted are left out."""
        chosen, rows = self._current_rows()[list(self._shown).index(geometry_type)]
        if rows is not None:
            model, data = self._pair(geometry_type)
            updateGeometryPlacements(self.model, self.data, model, data)
            self._scene.set_poses(data._block if chosen is None else data._block[chosen], rows)

    def _pair(self, kind: GeometryType) -> tuple[Any, Any]:
        if kind == GeometryType.VISUAL:
            return self.visual_model, self.visual_data
        return self.collision_model, self.collision_data

    def _current_rows(self) -> tuple[Any, ...]:
        """For visuals and for collisions: which geometries have nodes (None for all), and their rows in the scene."""
        scene = self._scene
        structure = scene.version[0]
        if not self._rows or self._rows[0] != structure:
            rows: list[Any] = []
            for kind in self._shown:
                names = [self._gui.at(f"{self._group(kind)}/{g.name}") for g in self._objects(kind)]
                chosen = [i for i, name in enumerate(names) if name in scene]
                present = scene.rows([names[i] for i in chosen]) if chosen else None
                rows.append((None if len(chosen) == len(names) else chosen, present))
            self._rows = (structure, *rows)
        return self._rows[1:]

    def displayVisuals(self, visibility: bool) -> None:
        """Shows or hides what the robot looks like."""
        self._show(GeometryType.VISUAL, visibility)

    def displayCollisions(self, visibility: bool) -> None:
        """Shows or hides what the robot collides with."""
        self._show(GeometryType.COLLISION, visibility)

    def _show(self, kind: GeometryType, visibility: bool) -> None:
        self._shown[kind] = bool(visibility)
        self._gui.setVisibility(self._group(kind), "ON" if visibility else "OFF")
        if visibility and self._q is not None:
            self.display(self._q)

    def clean(self) -> None:
        """Takes the robot out of the viewer."""
        self._gui.deleteNode(self._root, True)
        self._root, self._frames = "", []

    def reload(self, new_geometry_object: GeometryObject, geometry_type: Any = None) -> None:
        """Replaces the geometry of the same name.

        Args:
            new_geometry_object: The geometry.
            geometry_type: GeometryType.VISUAL (default) or COLLISION.
        """
        kind = GeometryType.VISUAL if geometry_type is None else geometry_type
        model = self._pair(kind)[0]
        model.geometryObjects.pop(place := known(model.getGeometryId(new_geometry_object.name)))
        model.geometryObjects.insert(place, new_geometry_object.copy())
        self.loadViewerGeometryObject(new_geometry_object, kind)
        self.display(self._q)

    def reset(self) -> None:
        """Empties the viewer."""
        self._gui.viewer.clear()
        self._root, self._frames = "", []

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.model.name!r}>"
