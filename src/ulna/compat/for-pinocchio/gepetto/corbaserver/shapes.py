"""Adding shapes, faces, meshes and robots."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from typing import Any

import numpy as np

from gepetto.corbaserver.documentation import describe_arguments
from gepetto.corbaserver.tree import PARTS, Tree
from ulna.errors import InputError, UnknownName
from ulna.geometry import Box, Capsule, Cone, Cylinder, Shape, Sphere
from ulna.viewer.colours import colour
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.mesh.surface import Surface

Rgba = Sequence[float]


@describe_arguments
class Shapes(Tree, abc.ABC):
    """Calls that add. A node of a name that is taken is replaced; groups appear by themselves."""

    def __init__(self, viewer: Any) -> None:
        super().__init__(viewer)
        self._made: dict[str, tuple[Shape, Rgba]] = {}

    def _new(self, name: str) -> str:
        place = self.at(name)
        for poses in (self._placed, self._static, self._waiting):
            poses.pop(place, None)
        return place

    def _add(self, name: str, content: Any, rgba: Rgba) -> bool:
        red, green, blue, opacity = colour(rgba)
        self.viewer.add(content, name=self._new(name), color=(red, green, blue), opacity=opacity)
        if isinstance(content, Shape):
            self._made[self.at(name)] = (content, rgba)
        return True

    def addSphere(self, sphereName: str, radius: float, RGBAcolor: Rgba) -> bool:
        """Adds a sphere."""
        return self._add(sphereName, Sphere(radius), RGBAcolor)

    def addBox(
        self, boxName: str, boxSize1: float, boxSize2: float, boxSize3: float, RGBAcolor: Rgba
    ) -> bool:
        """Adds a box, centred.

        Args:
            boxSize1: Edge along x [m].
            boxSize2: Edge along y [m].
            boxSize3: Edge along z [m].
        """
        return self._add(boxName, Box((boxSize1, boxSize2, boxSize3)), RGBAcolor)

    def addCylinder(self, cylinderName: str, radius: float, height: float, RGBAcolor: Rgba) -> bool:
        """Adds a cylinder about z, centred.

        Args:
            height: Height [m].
        """
        return self._add(cylinderName, Cylinder(radius, height), RGBAcolor)

    def addCapsule(self, name: str, radius: float, height: float, RGBAcolor: Rgba) -> bool:
        """Adds a cylinder about z with a half sphere on either end, centred.

        Args:
            name: Name of the node.
            height: Height of the cylinder [m].
        """
        return self._add(name, Capsule(radius, height), RGBAcolor)

    def addCone(self, name: str, radius: float, height: float, RGBAcolor: Rgba) -> bool:
        """Adds a cone about z, its tip up, centred.

        Args:
            name: Name of the node.
            height: Height [m].
        """
        return self._add(name, Cone(radius, height), RGBAcolor)

    def resizeCapsule(self, capsuleName: str, height: float) -> bool:
        """Changes the height of a capsule.

        Args:
            height: Height of its cylinder [m].

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
            radius: Radius of the shaft [m].

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
            RGBAcolor: Red, green, blue, opacity from 0 to 1 of the sphere.
            radius: Radius of the sphere [m].
            sizeAxis: Length of the arrows [m].
        """
        place = self._new(nodeName)
        self.viewer.group(place).opacity = colour(RGBAcolor)[3]
        self.viewer.sphere(radius, name=f"{place}/{PARTS}ball", color=RGBAcolor[:3])
        self.viewer.axes(sizeAxis, name=f"{place}/{PARTS}axes")
        return True

    def addLandmark(self, nodeName: str, size: float) -> bool:
        """Shows the axes of a node.

        Args:
            size: Length of an axis [m].
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
            meshPath: The file; it may begin with "file://".
        """
        self.viewer.mesh(str(meshPath).removeprefix("file://"), name=self._new(meshName))
        return True

    def addURDF(self, robotName: str, urdfFilePath: str, packagePath: str | None = None) -> bool:
        """Adds the visual geometries of a robot in its usual configuration, as nodes `robotName/link`."""
        return self.addUrdfObjects(robotName, urdfFilePath, True, packagePath)

    def addUrdfCollision(self, robotName: str, urdfFilePath: str, packagePath: str | None = None) -> bool:
        """Adds the collision geometries of a robot, as nodes `robotName/link`."""
        return self.addUrdfObjects(robotName, urdfFilePath, False, packagePath)

    def addUrdfObjects(
        self, nodeName: str, urdfFilePath: str, visual: bool = True, packagePath: str | None = None
    ) -> bool:
        """Adds the links of a robot, with their visual or collision geometries.

        Args:
            visual: Whether to show the visual geometries.
        """
        import ulna

        robot = ulna.load(str(urdfFilePath), package_dirs=[packagePath] if packagePath else ())
        self.viewer.add(robot, name=self._new(nodeName), show="visual" if visual else "collision")
        return True

    # lines and faces ------------------------------------------------------------------------------------

    def addTriangleFace(self, faceName: str, pos1: Any, pos2: Any, pos3: Any, RGBAcolor: Rgba) -> bool:
        """Adds a triangle that is seen from both sides.

        Args:
            pos1: A corner, (3,) [m].
            pos2: A corner, (3,) [m].
            pos3: A corner, (3,) [m].
        """
        return self._add(faceName, _face([pos1, pos2, pos3]), RGBAcolor)

    def addSquareFace(
        self, faceName: str, pos1: Any, pos2: Any, pos3: Any, pos4: Any, RGBAcolor: Rgba
    ) -> bool:
        """Adds a plane face with four corners, in their order around it, that is seen from both sides.

        Args:
            pos1: A corner, (3,) [m].
            pos2: A corner, (3,) [m].
            pos3: A corner, (3,) [m].
            pos4: A corner, (3,) [m].
        """
        return self._add(faceName, _face([pos1, pos2, pos3, pos4]), RGBAcolor)

    # roadmaps -------------------------------------------------------------------------------------------


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
