"""Adding lines, curves and roadmaps."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from typing import Any

import numpy as np

from gepetto.corbaserver.documentation import describe_arguments
from gepetto.corbaserver.placement import pose_of
from gepetto.corbaserver.shapes import Rgba, Shapes
from ulna.errors import InputError, UnknownName
from ulna.viewer.colours import colour
from ulna.viewer.graph.content import Lines
from ulna.viewer.graph.handles import Polyline

_PIXEL = 0.002  # how thick a line of one pixel is [m]


@describe_arguments
class Curves(Shapes, abc.ABC):
    """Calls that add lines, and change them."""

    def __init__(self, viewer: Any) -> None:
        super().__init__(viewer)
        self._curves: dict[str, Any] = {}
        self._roadmaps: dict[str, tuple[Rgba, float, float, Rgba]] = {}

    def addLine(self, lineName: str, pos1: Sequence[float], pos2: Sequence[float], RGBAcolor: Rgba) -> bool:
        """Adds a line between two points."""
        return self.addCurve(lineName, [pos1, pos2], RGBAcolor)

    def addCurve(self, curveName: str, pos: Any, RGBAcolor: Rgba) -> bool:
        """Adds a line from point to point.

        Args:
            pos: Points, (n, 3) [m].
        """
        points, rgba = np.array(pos, dtype=float), colour(RGBAcolor)
        place = self._new(curveName)
        self.viewer.line(points, name=place, color=rgba[:3], opacity=rgba[3], thickness=2 * _PIXEL)
        self._curves[place] = points
        return True

    def _curve(self, name: str) -> str:
        place = self.known(name)
        if not isinstance(self.scene.node(place).content, Lines):
            raise InputError(f"{name!r} is no line or curve; addLine and addCurve add one.")
        return place

    def setLineStartPoint(self, lineName: str, pos1: Sequence[float]) -> bool:
        """Moves the start of a line."""
        return self.setCurvePoints(lineName, [pos1, self._curves[self._curve(lineName)][-1]])

    def setLineEndPoint(self, lineName: str, pos2: Sequence[float]) -> bool:
        """Moves the end of a line."""
        return self.setCurvePoints(lineName, [self._curves[self._curve(lineName)][0], pos2])

    def setLineExtremalPoints(self, lineName: str, pos1: Sequence[float], pos2: Sequence[float]) -> bool:
        """Moves both ends of a line."""
        return self.setCurvePoints(lineName, [pos1, pos2])

    def setCurvePoints(self, curveName: str, pos: Any) -> bool:
        """Replaces the points of a curve.

        Args:
            pos: Points, (n, 3) [m].
        """
        place = self._curve(curveName)
        points = np.array(pos, dtype=float)
        Polyline(self.scene, place).points = points
        self._curves[place] = points
        return True

    def setCurvePointsSubset(self, curveName: str, first: int, count: int) -> bool:
        """Shows only some points of a curve.

        Args:
            first: Number of the first point.
            count: Number of points, 2 or more.

        Raises:
            InputError: The curve has no such points.
        """
        place = self._curve(curveName)
        points = self._curves[place]
        if not 0 <= first < first + count <= len(points) or count < 2:
            raise InputError(
                f"{count} points from {first} on of {len(points)}; expected two of them or more."
            )
        Polyline(self.scene, place).points = points[first : first + count]
        return True

    def setCurveLineWidth(self, curveName: str, width: float) -> bool:
        """Changes the thickness of a curve.

        Args:
            width: Thickness [pixels].
        """
        place = self._curve(curveName)
        old = self.scene.node(place).content
        self.scene.set_content(place, Lines(old.segments, old.rgba, max(float(width), 0.1) * _PIXEL))
        return True

    def createRoadmap(
        self, name: str, RGBAcolorNode: Rgba, radius: float, sizeAxis: float, RGBAcolorEdge: Rgba
    ) -> bool:
        """Adds an empty group for nodes and edges.

        Args:
            name: Name of the group.
            RGBAcolorNode: Colour of the nodes.
            radius: Radius of the nodes [m].
            sizeAxis: Length of their axes [m].
            RGBAcolorEdge: Colour of the edges.
        """
        self._roadmaps[self._new(name)] = (RGBAcolorNode, radius, sizeAxis, RGBAcolorEdge)
        return self.createGroup(name)

    def _roadmap(self, name: str) -> tuple[Rgba, float, float, Rgba]:
        if self.at(name) not in self._roadmaps:
            raise UnknownName("roadmap", name, self._roadmaps, "createRoadmap makes one.")
        return self._roadmaps[self.at(name)]

    def addNodeToRoadmap(self, nameRoadmap: str, configuration: Sequence[float]) -> bool:
        """Adds a sphere with its axes to a roadmap.

        Args:
            nameRoadmap: Name of the roadmap.
            configuration: x, y, z [m] and a quaternion, (7,); see `applyConfiguration`.
        """
        rgba, radius, size, _ = self._roadmap(nameRoadmap)
        pose, name = pose_of(configuration), f"{nameRoadmap}/node{len(self.getGroupNodeList(nameRoadmap))}"
        self.addXYZaxis(name, rgba, radius, size)
        self.scene.set_pose(self.at(name), pose)
        return True

    def addEdgeToRoadmap(self, nameRoadmap: str, posFrom: Sequence[float], posTo: Sequence[float]) -> bool:
        """Adds a line between two points to a roadmap.

        Args:
            nameRoadmap: Name of the roadmap.
            posFrom: A point, (3,) [m].
            posTo: Another point, (3,) [m].
        """
        rgba = self._roadmap(nameRoadmap)[3]
        return self.addLine(
            f"{nameRoadmap}/edge{len(self.getGroupNodeList(nameRoadmap))}", posFrom, posTo, rgba
        )
