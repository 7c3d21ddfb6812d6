"""Adding shapes, lines, meshes and robots."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from typing import Any

import numpy as np

from gepetto.corbaserver.placement import pose_of
from gepetto.corbaserver.tree import PARTS, Tree
from ulna.errors import InputError, UnknownName
from ulna.geometry import Box, Capsule, Cone, Cylinder, Shape, Sphere
from ulna.viewer.colours import colour
from ulna.viewer.graph.content import Lines
from ulna.viewer.graph.handles import Polyline
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.mesh.surface import Surface

Rgba = Sequence[float]
_PIXEL = 0.002  # how thick a line of one pixel is [m]


class Shapes(Tree, abc.ABC):
    """Calls that add. A node of a name that is taken is replaced; groups appear by themselves."""

    def __init__(self, viewer: Any) -> None:
        super().__init__(viewer)
        self._made: dict[str, tuple[Shape, Rgba]] = {}
        self._curves: dict[str, Any] = {}
        self._roadmaps: dict[str, tuple[Rgba, float, float, Rgba]] = {}

    def _new(self, name: str) -> str:
        place = self.at(name)
        for poses in (self._placed, self._static, self._waiting):
            poses.pop(place, None)
        return place

    def _add(self, name: str, thing: Any, rgba: Rgba) -> bool:
        red, green, blue, opacity = colour(rgba)
        self.viewer.add(thing, name=self._new(name), color=(red, green, blue), opacity=opacity)
        if isinstance(thing, Shape):
            self._made[self.at(name)] = (thing, rgba)
        return True

    def addSphere(self, sphereName: str, radius: float, RGBAcolor: Rgba) -> bool:
        """Adds a sphere.

        Args:
            sphereName: Name of the node.
            radius: Radius [m].
            RGBAcolor: Red, green, blue, opacity from 0 to 1.

        Returns:
            True.
        """
        return self._add(sphereName, Sphere(radius), RGBAcolor)

    def addBox(
        self, boxName: str, boxSize1: float, boxSize2: float, boxSize3: float, RGBAcolor: Rgba
    ) -> bool:
        """Adds a box, centred.

        Args:
            boxName: Name of the node.
            boxSize1: Edge along x [m].
            boxSize2: Edge along y [m].
            boxSize3: Edge along z [m].
            RGBAcolor: Red, green, blue, opacity from 0 to 1.

        Returns:
            True.
        """
        return self._add(boxName, Box((boxSize1, boxSize2, boxSize3)), RGBAcolor)

    def addCylinder(self, cylinderName: str, radius: float, height: float, RGBAcolor: Rgba) -> bool:
        """Adds a cylinder about z, centred.

        Args:
            cylinderName: Name of the node.
            radius: Radius [m].
            height: Height [m].
            RGBAcolor: Red, green, blue, opacity from 0 to 1.

        Returns:
            True.
        """
        return self._add(cylinderName, Cylinder(radius, height), RGBAcolor)

    def addCapsule(self, name: str, radius: float, height: float, RGBAcolor: Rgba) -> bool:
        """Adds a cylinder about z with a half sphere on either end, centred.

        Args:
            name: Name of the node.
            radius: Radius [m].
            height: Height of the cylinder [m].
            RGBAcolor: Red, green, blue, opacity from 0 to 1.

        Returns:
            True.
        """
        return self._add(name, Capsule(radius, height), RGBAcolor)

    def addCone(self, name: str, radius: float, height: float, RGBAcolor: Rgba) -> bool:
        """Adds a cone about z, its tip up, centred.

        Args:
            name: Name of the node.
            radius: Radius [m].
            height: Height [m].
            RGBAcolor: Red, green, blue, opacity from 0 to 1.

        Returns:
            True.
        """
        return self._add(name, Cone(radius, height), RGBAcolor)

    def resizeCapsule(self, capsuleName: str, height: float) -> bool:
        """Changes the height of a capsule.

        Args:
            capsuleName: Name of the node.
            height: Height of its cylinder [m].

        Returns:
            True.

        Raises:
            UnknownName: There is no such capsule.
        """
        place = self.known(capsuleName)
        shape, rgba = self._made.get(place, (None, ()))
        if not isinstance(shape, Capsule):
            raise UnknownName(
                "capsule", capsuleName, [n for n, (s, _) in self._made.items() if isinstance(s, Capsule)]
            )
        shape = Capsule(shape.radius, height)
        self._made[place] = (shape, rgba)
        self.scene.set_surfaces(place, [tessellate(shape, colour((*rgba[:3], 1.0)))])
        return True

    def addArrow(self, name: str, radius: float, length: float, RGBAcolor: Rgba) -> bool:
        """Adds an arrow from the node's origin along its x axis.

        Args:
            name: Name of the node.
            radius: Radius of the shaft [m].
            length: Length [m].
            RGBAcolor: Red, green, blue, opacity from 0 to 1.

        Returns:
            True.
        """
        place = self._new(name)
        if place in self.scene:
            self.viewer.remove(place)
        self.viewer.group(place).opacity = colour(RGBAcolor)[3]
        self._made[place] = (Cylinder(radius, length), RGBAcolor)
        self.viewer.arrow((length, 0, 0), name=f"{place}/{PARTS}arrow", color=RGBAcolor[:3], radius=radius)
        return True

    def resizeArrow(self, capsuleName: str, radius: float, length: float) -> bool:
        """Changes the size of an arrow.

        Args:
            capsuleName: Name of the node.
            radius: Radius of the shaft [m].
            length: Length [m].

        Returns:
            True.

        Raises:
            UnknownName: There is no such arrow.
        """
        place = self.known(capsuleName)
        arrow = f"{place}/{PARTS}arrow"
        if arrow not in self.scene:
            raise UnknownName(
                "arrow", capsuleName, [n for n in self.getNodeList() if f"{n}/{PARTS}arrow" in self.scene]
            )
        self.viewer.remove(arrow)
        self.viewer.arrow((length, 0, 0), name=arrow, color=self._made[place][1][:3], radius=radius)
        return True

    def addXYZaxis(self, nodeName: str, RGBAcolor: Rgba, radius: float, sizeAxis: float) -> bool:
        """Adds a sphere with arrows in red, green, blue along x, y, z.

        Args:
            nodeName: Name of the node.
            RGBAcolor: Red, green, blue, opacity from 0 to 1 of the sphere.
            radius: Radius of the sphere [m].
            sizeAxis: Length of the arrows [m].

        Returns:
            True.
        """
        place = self._new(nodeName)
        self.viewer.group(place).opacity = colour(RGBAcolor)[3]
        self.viewer.sphere(radius, name=f"{place}/{PARTS}ball", color=RGBAcolor[:3])
        self.viewer.axes(sizeAxis, name=f"{place}/{PARTS}axes")
        return True

    def addLandmark(self, nodeName: str, size: float) -> bool:
        """Shows the axes of a node.

        Args:
            nodeName: Name of the node.
            size: Length of an axis [m].

        Returns:
            True.
        """
        self.viewer.axes(size, name=f"{self.known(nodeName)}/{PARTS}landmark")
        return True

    def deleteLandmark(self, nodeName: str) -> bool:
        """Shows the frame of a node no longer; False if it was not shown."""
        place = f"{self.known(nodeName)}/{PARTS}landmark"
        if place not in self.scene:
            return False
        self.viewer.remove(place)
        return True

    def addFloor(self, floorName: str) -> bool:
        """A grid in the plane z = 0."""
        self.viewer.grid(10.0, 0.5, name=self._new(floorName))
        return True

    def createSceneWithFloor(self, sceneName: str) -> bool:
        """A scene with a grid in the plane z = 0."""
        return self.createScene(sceneName) and self.addFloor(f"{sceneName}/floor")

    # files ----------------------------------------------------------------------------------------------

    def addMesh(self, meshName: str, meshPath: str) -> bool:
        """Adds a mesh file: dae, stl, obj, glb ...

        Args:
            meshName: Name of the node.
            meshPath: The file; it may begin with "file://".

        Returns:
            True.
        """
        self.viewer.mesh(str(meshPath).removeprefix("file://"), name=self._new(meshName))
        return True

    def addURDF(self, robotName: str, urdfFilePath: str, packagePath: str | None = None) -> bool:
        """Adds the visual geometries of a robot in its usual configuration, as nodes `robotName/link`.

        Args:
            robotName: Name of the group.
            urdfFilePath: The file.
            packagePath: Folder to look for packages in, or None.

        Returns:
            True.
        """
        return self.addUrdfObjects(robotName, urdfFilePath, True, packagePath)

    def addUrdfCollision(self, robotName: str, urdfFilePath: str, packagePath: str | None = None) -> bool:
        """Adds the collision geometries of a robot, as nodes `robotName/link`.

        Args:
            robotName: Name of the group.
            urdfFilePath: The file.
            packagePath: Folder to look for packages in, or None.

        Returns:
            True.
        """
        return self.addUrdfObjects(robotName, urdfFilePath, False, packagePath)

    def addUrdfObjects(
        self, nodeName: str, urdfFilePath: str, visual: bool = True, packagePath: str | None = None
    ) -> bool:
        """Adds the links of a robot, with their visual or collision geometries.

        Args:
            nodeName: Name of the node.
            urdfFilePath: The file.
            visual: Whether to show the visual geometries.
            packagePath: Folder to look for packages in, or None.

        Returns:
            True.
        """
        import ulna

        robot = ulna.load(str(urdfFilePath), package_dirs=[packagePath] if packagePath else ())
        self.viewer.add(robot, name=self._new(nodeName), show="visual" if visual else "collision")
        return True

    # lines and faces ------------------------------------------------------------------------------------

    def addLine(self, lineName: str, pos1: Sequence[float], pos2: Sequence[float], RGBAcolor: Rgba) -> bool:
        """Adds a line between two points.

        Args:
            lineName: Name of the line.
            pos1: The start, (3,) [m].
            pos2: The end, (3,) [m].
            RGBAcolor: Red, green, blue, opacity from 0 to 1.

        Returns:
            True.
        """
        return self.addCurve(lineName, [pos1, pos2], RGBAcolor)

    def addCurve(self, curveName: str, pos: Any, RGBAcolor: Rgba) -> bool:
        """Adds a line from point to point.

        Args:
            curveName: Name of the curve.
            pos: Points, (n, 3) [m].
            RGBAcolor: Red, green, blue, opacity from 0 to 1.

        Returns:
            True.
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
        """Moves the start of a line.

        Args:
            lineName: Name of the line.
            pos1: The start, (3,) [m].

        Returns:
            True.
        """
        return self.setCurvePoints(lineName, [pos1, self._curves[self._curve(lineName)][-1]])

    def setLineEndPoint(self, lineName: str, pos2: Sequence[float]) -> bool:
        """Moves the end of a line.

        Args:
            lineName: Name of the line.
            pos2: The end, (3,) [m].

        Returns:
            True.
        """
        return self.setCurvePoints(lineName, [self._curves[self._curve(lineName)][0], pos2])

    def setLineExtremalPoints(self, lineName: str, pos1: Sequence[float], pos2: Sequence[float]) -> bool:
        """Moves both ends of a line.

        Args:
            lineName: Name of the line.
            pos1: The start, (3,) [m].
            pos2: The end, (3,) [m].

        Returns:
            True.
        """
        return self.setCurvePoints(lineName, [pos1, pos2])

    def setCurvePoints(self, curveName: str, pos: Any) -> bool:
        """Replaces the points of a curve.

        Args:
            curveName: Name of the curve.
            pos: Points, (n, 3) [m].

        Returns:
            True.
        """
        place = self._curve(curveName)
        points = np.array(pos, dtype=float)
        Polyline(self.scene, place).points = points
        self._curves[place] = points
        return True

    def setCurvePointsSubset(self, curveName: str, first: int, count: int) -> bool:
        """Shows only some points of a curve.

        Args:
            curveName: Name of the curve.
            first: Number of the first point.
            count: Number of points, 2 or more.

        Returns:
            True.

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
            curveName: Name of the curve.
            width: Thickness [pixels].

        Returns:
            True.
        """
        place = self._curve(curveName)
        old = self.scene.node(place).content
        self.scene.set_content(place, Lines(old.segments, old.rgba, max(float(width), 0.1) * _PIXEL))
        return True

    def addTriangleFace(self, faceName: str, pos1: Any, pos2: Any, pos3: Any, RGBAcolor: Rgba) -> bool:
        """Adds a triangle that is seen from both sides.

        Args:
            faceName: Name of the node.
            pos1: A corner, (3,) [m].
            pos2: A corner, (3,) [m].
            pos3: A corner, (3,) [m].
            RGBAcolor: Red, green, blue, opacity from 0 to 1.

        Returns:
            True.
        """
        return self._add(faceName, _face([pos1, pos2, pos3]), RGBAcolor)

    def addSquareFace(
        self, faceName: str, pos1: Any, pos2: Any, pos3: Any, pos4: Any, RGBAcolor: Rgba
    ) -> bool:
        """Adds a plane face with four corners, in their order around it, that is seen from both sides.

        Args:
            faceName: Name of the node.
            pos1: A corner, (3,) [m].
            pos2: A corner, (3,) [m].
            pos3: A corner, (3,) [m].
            pos4: A corner, (3,) [m].
            RGBAcolor: Red, green, blue, opacity from 0 to 1.

        Returns:
            True.
        """
        return self._add(faceName, _face([pos1, pos2, pos3, pos4]), RGBAcolor)

    # roadmaps -------------------------------------------------------------------------------------------

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

        Returns:
            True.
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

        Returns:
            True.
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

        Returns:
            True.
        """
        rgba = self._roadmap(nameRoadmap)[3]
        return self.addLine(
            f"{nameRoadmap}/edge{len(self.getGroupNodeList(nameRoadmap))}", posFrom, posTo, rgba
        )


def _face(corners: Sequence[Any]) -> Surface:
    points = np.array(corners, dtype=float)
    if points.shape != (len(corners), 3):
        raise InputError(f"The corners are {corners}; expected points of three numbers [m].")
    normal = np.cross(points[1] - points[0], points[-1] - points[0])
    length = float(np.linalg.norm(normal))
    if length < 1e-12:
        raise InputError("The corners of the face lie on a line.")
    normal /= length
    fan = np.array([[0, k, k + 1] for k in range(1, len(points) - 1)])
    normals = np.tile(normal, (len(points), 1))
    both = np.concatenate([fan, fan[:, ::-1] + len(points)])
    return Surface(np.concatenate([points, points]), both, np.concatenate([normals, -normals]))
