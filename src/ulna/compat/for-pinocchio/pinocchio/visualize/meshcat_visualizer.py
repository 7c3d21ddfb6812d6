"""The visualizer of MeshCat's spelling, with the calls for shapes that courses add to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from pinocchio._spatial.rotations import Quaternion
from pinocchio.visualize.camera import CameraVisualizer
from ulna.errors import ShapeError
from ulna.geometry import Box, Cylinder, Ellipsoid, Shape, Sphere
from ulna.viewer.colours import colour

_GREY = (0.6, 0.6, 0.65, 1.0)


@final
class MeshcatVisualizer(CameraVisualizer):
    """Draws into a new viewer, or into the one passed to it. What is added here is placed at once, without refresh."""

    def addSphere(self, name: str, radius: float, color: Sequence[float] = _GREY) -> None:
        """A ball [m]."""
        self._add(name, Sphere(radius), color)

    def addBox(self, name: str, dims: Sequence[float], color: Sequence[float] = _GREY) -> None:
        """A box by its edges [m]."""
        x, y, z = dims
        self._add(name, Box((x, y, z)), color)

    def addCylinder(self, name: str, length: float, radius: float, color: Sequence[float] = _GREY) -> None:
        """A cylinder about z [m]."""
        self._add(name, Cylinder(radius, length), color)

    def addEllipsoid(self, name: str, dims: Sequence[float], color: Sequence[float] = _GREY) -> None:
        """An ellipsoid by its half axes [m]."""
        a, b, c = dims
        self._add(name, Ellipsoid((a, b, c)), color)

    def addLine(
        self, name: str, point1: Any, point2: Any, linewidth: float = 2.0, color: Sequence[float] = _GREY
    ) -> None:
        """A line between two points [m], some pixels thick."""
        self.viewer.gui.addLine(name, point1, point2, colour(color))
        self.viewer.gui.setCurveLineWidth(name, linewidth)

    def _add(self, name: str, shape: Shape, color: Sequence[float]) -> None:
        red, green, blue, opacity = colour(color)
        self.viewer.viewer.add(
            shape, name=self.viewer.gui.at(name), color=(red, green, blue), opacity=opacity
        )

    def applyConfiguration(self, name: str, placement: Any) -> None:
        """Places a node: an SE3, a matrix (4, 4), or x, y, z and a quaternion xyzw."""
        gui = self.viewer.gui
        values = np.asarray(getattr(placement, "homogeneous", placement), dtype=float)
        if values.shape == (7,):
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = Quaternion(values[3:]).normalized().matrix(), values[:3]
            values = pose
        if values.shape != (4, 4):
            raise ShapeError("placement", values.shape, "(7,) or (4, 4), or an SE3")
        gui.scene.set_pose(gui.known(name), values)

    def delete(self, name: str) -> None:
        """Removes a node, with all that is in it."""
        self.viewer.gui.deleteNode(name, True)
