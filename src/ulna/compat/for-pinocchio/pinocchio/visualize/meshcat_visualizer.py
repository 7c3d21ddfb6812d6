"""The visualizer of MeshCat's spelling: its tree of objects, and the calls for shapes that courses add to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np
from gepetto.corbaserver.gui import Gui
from meshcat.visualizer import Visualizer
from meshcat.window import ViewerWindow

from pinocchio._containers.arguments import WrongShape
from pinocchio._containers.enums import GeometryType
from pinocchio._spatial.rotations import Quaternion
from pinocchio.visualize.camera import CameraVisualizer
from ulna.geometry import Box, Cylinder, Ellipsoid, Shape, Sphere
from ulna.viewer.colours import colour

_GREY = (0.6, 0.6, 0.65, 1.0)


@final
class MeshcatVisualizer(CameraVisualizer):
    """Draws into a new viewer, or into the one passed to it. What is added here is placed at once, without refresh.

    `viewer` is MeshCat's tree: `viz.viewer["goal"].set_object(...)`.
    """

    _EXPECTED = "a meshcat.Visualizer, an ulna.Viewer, or the `viewer` of another visualizer"

    def initViewer(
        self,
        viewer: Any = None,
        open: bool = False,
        loadModel: bool = False,
        zmq_url: Any = None,
        **more: Any,
    ) -> None:
        """Opens the viewer; returns at once.

        Args:
            viewer: A `meshcat.Visualizer`, or an `ulna.Viewer`, to draw into; a new viewer when not given.
            open: Whether to open a browser window, where there is a screen.
            loadModel: Whether to load the geometries, too.
            zmq_url: Accepted and ignored: the viewer is in this process.
            more: `host`, `port` of the page.
        """
        super().initViewer(viewer, open, loadModel, **more)

    def _attach(self, viewer: Any, options: dict[str, Any]) -> None:
        if isinstance(viewer, Visualizer):
            self._gui_or_none, self._viewer = viewer.gui, viewer
        else:
            super()._attach(viewer, options)

    def _draw_into(self, gui: Gui) -> None:
        self._gui_or_none, self._viewer = gui, Visualizer(window=ViewerWindow(gui))

    def setCameraTarget(self, target: Sequence[float]) -> None:
        """Has the camera look at a point of its frame, "/Cameras/default" [m]."""
        self.viewer.set_cam_target(target)

    def setCameraPosition(self, position: Sequence[float]) -> None:
        """Puts the camera at a point of its frame, "/Cameras/default" [m]."""
        self.viewer.set_cam_pos(position)

    def setCameraZoom(self, zoom: float) -> None:
        """Makes things appear so many times as large as with the camera's field of view."""
        self.viewer["/Cameras/default"].set_property("zoom", zoom)

    @property
    def viewerRootNodeName(self) -> str:
        """The path of the robot."""
        return self._root

    @property
    def viewerVisualGroupName(self) -> str:
        """The path of what it looks like."""
        return self._group(GeometryType.VISUAL)

    @property
    def viewerCollisionGroupName(self) -> str:
        """The path of what it collides with."""
        return self._group(GeometryType.COLLISION)

    @property
    def viewerFramesGroupName(self) -> str:
        """The path of the axes of frames."""
        return f"{self._root}/frames"

    def addSphere(self, name: str, radius: float, color: Sequence[float] = _GREY) -> None:
        """Adds a sphere.

        Args:
            name: Name of the node.
            radius: Radius [m].
            color: Red, green, blue, opacity from 0 to 1.
        """
        self._add(name, Sphere(radius), color)

    def addBox(self, name: str, dims: Sequence[float], color: Sequence[float] = _GREY) -> None:
        """Adds a box.

        Args:
            name: Name of the node.
            dims: Edges along x, y, z [m].
            color: Red, green, blue, opacity from 0 to 1.
        """
        x, y, z = dims
        self._add(name, Box((x, y, z)), color)

    def addCylinder(self, name: str, length: float, radius: float, color: Sequence[float] = _GREY) -> None:
        """Adds a cylinder about z.

        Args:
            name: Name of the node.
            length: Length [m].
            radius: Radius [m].
            color: Red, green, blue, opacity from 0 to 1.
        """
        self._add(name, Cylinder(radius, length), color)

    def addEllipsoid(self, name: str, dims: Sequence[float], color: Sequence[float] = _GREY) -> None:
        """Adds an ellipsoid.

        Args:
            name: Name of the node.
            dims: Half axes along x, y, z [m].
            color: Red, green, blue, opacity from 0 to 1.
        """
        a, b, c = dims
        self._add(name, Ellipsoid((a, b, c)), color)

    def addLine(
        self, name: str, point1: Any, point2: Any, linewidth: float = 2.0, color: Sequence[float] = _GREY
    ) -> None:
        """Adds a line between two points.

        Args:
            name: Name of the node.
            point1: The start, (3,) [m].
            point2: The end, (3,) [m].
            linewidth: Thickness [pixels].
            color: Red, green, blue, opacity from 0 to 1.
        """
        self._gui.addLine(name, point1, point2, colour(color))
        self._gui.setCurveLineWidth(name, linewidth)

    def _add(self, name: str, shape: Shape, color: Sequence[float]) -> None:
        red, green, blue, opacity = colour(color)
        self._gui.viewer.add(shape, name=self._gui.at(name), color=(red, green, blue), opacity=opacity)

    def applyConfiguration(self, name: str, placement: Any) -> None:
        """Places a node, at once.

        Args:
            name: Name of the node.
            placement: An SE3, a matrix (4, 4), or x, y, z [m] and a quaternion xyzw, (7,).

        Raises:
            WrongShape: Another shape.
        """
        gui = self._gui
        values = np.asarray(getattr(placement, "homogeneous", placement), dtype=float)
        if values.shape == (7,):
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = Quaternion(values[3:]).normalized().matrix(), values[:3]
            values = pose
        if values.shape != (4, 4):
            raise WrongShape("placement", values.shape, "(7,) or (4, 4), or an SE3")
        gui.scene.set_pose(gui.known(name), values)

    def delete(self, name: str) -> None:
        """Removes a node, with all that is in it."""
        self._gui.deleteNode(name, True)
