"""Adding primitive shapes to a scene: boxes, spheres, ellipsoids, cylinders, capsules and cones."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from typing import Any

from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Sphere
from ulna.viewer.graph.handles import Handle
from ulna.viewer.scene.annotations import AnnotationMethods


class ShapeMethods(AnnotationMethods):
    """Methods that add primitive shapes to a scene."""

    @abc.abstractmethod
    def add(self, thing: Any, **more: Any) -> Any:
        """Add an object; see `SceneMethods.add`.

        Args:
            thing: What to add.
            **more: Arguments of `SceneMethods.add`.

        Returns:
            Its handle.
        """

    def box(self, size: Sequence[float], **more: Any) -> Handle:
        """Add a box, centred at its origin.

        Args:
            size: Edge lengths along x, y, z [m].
            more: Name, pose, colour and opacity, as for `add`.

        Returns:
            The handle.

        Raises:
            InputError: A length is not above zero.

        Example:
            >>> viewer = ulna.Viewer(page=False)
            >>> box = viewer.box((0.4, 0.4, 0.2), pose=(0.5, 0.0, 0.1), color="orange")
            >>> box.pose = ulna.SE3(0.5, 0.2, 0.1)  # moves it
            >>> box.pose[:3, 3]
            array([0.5, 0.2, 0.1])
        """
        return self.add(Box(size), **more)  # type: ignore[arg-type]

    def sphere(self, radius: float, **more: Any) -> Handle:
        """Add a sphere, centred at its origin.

        Args:
            radius: Its radius [m].
            more: Name, pose, colour and opacity, as for `add`.

        Returns:
            The handle.

        Raises:
            InputError: A length is not above zero.

        Example:
            >>> viewer = ulna.Viewer(page=False)
            >>> ball = viewer.sphere(0.05, pose=(0.4, 0.1, 0.3), color="tomato")
            >>> ball.position
            array([0.4, 0.1, 0.3])
        """
        return self.add(Sphere(radius), **more)

    def ellipsoid(self, radii: Sequence[float], **more: Any) -> Handle:
        """Add an ellipsoid, centred at its origin.

        Args:
            radii: Its semi-axes along x, y, z [m].
            more: Name, pose, colour and opacity, as for `add`.

        Returns:
            The handle.

        Raises:
            InputError: A length is not above zero.
        """
        return self.add(Ellipsoid(radii), **more)  # type: ignore[arg-type]

    def cylinder(self, radius: float, length: float, **more: Any) -> Handle:
        """Add a cylinder about z, centred at its origin.

        Args:
            radius: Its radius [m].
            length: Its length [m].
            more: Name, pose, colour and opacity, as for `add`.

        Returns:
            The handle.

        Raises:
            InputError: A length is not above zero.
        """
        return self.add(Cylinder(radius, length), **more)

    def capsule(self, radius: float, length: float, **more: Any) -> Handle:
        """Add a capsule about z, centred at its origin.

        Args:
            radius: Its radius [m].
            length: Length of the cylinder without the half spheres [m].
            more: Name, pose, colour and opacity, as for `add`.

        Returns:
            The handle.

        Raises:
            InputError: A length is not above zero.
        """
        return self.add(Capsule(radius, length), **more)

    def cone(self, radius: float, length: float, **more: Any) -> Handle:
        """Add a cone about z with its tip up, centred at its origin.

        Args:
            radius: Radius of its base [m].
            length: Its height [m].
            more: Name, pose, colour and opacity, as for `add`.

        Returns:
            The handle.

        Raises:
            InputError: A length is not above zero.
        """
        return self.add(Cone(radius, length), **more)
