"""Arrows: a shaft and a tip along a vector that can be assigned to."""

from __future__ import annotations

import numpy as np

from ulna.checks.arrays import length_array, read_only
from ulna.checks.values import MAX_LENGTH, length, number
from ulna.typing import ArrayLike, Floats
from ulna.viewer.colours import Colour, colour
from ulna.viewer.graph.handles import Handle
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.mesh.primitives import arrow
from ulna.viewer.mesh.surface import normalized


class Arrow(Handle):
    """An arrow from its origin along a vector; `vector` and `size` can be assigned to.

    Args:
        scene: The scene.
        name: Its name.
        vector: From its origin to its tip at size 1, shape (3,).
        radius: Radius of its shaft [m].
        size: Length of the arrow for a vector of length 1 [m].
    """

    __slots__ = ("_radius", "_size", "_vector")

    def __init__(
        self, scene: SceneGraph, name: str, vector: ArrayLike, radius: float, size: float = 1.0
    ) -> None:
        super().__init__(scene, name)
        self._radius, self._vector = length("radius", radius), np.zeros(3)
        self.size = size
        self.vector = vector

    @property
    def vector(self) -> Floats:
        """The vector it shows, in the axes of its group, shape (3,), read-only: a displacement [m] or a force [N]."""
        return read_only(self._vector.copy())

    @vector.setter
    def vector(self, vector: ArrayLike) -> None:
        self._vector = length_array("vector", vector, 3)
        self._draw()

    @property
    def size(self) -> float:
        """How long it is drawn for each unit of `vector` [m]."""
        return self._size

    @size.setter
    def size(self, size: float) -> None:
        self._size = number("size", size, "metres for each unit, above zero", above=0.0, most=MAX_LENGTH)
        self._draw()

    def _draw(self) -> None:
        length_drawn = self._size * float(np.linalg.norm(self._vector))
        tip = min(5.0 * self._radius, 0.5 * length_drawn)
        pose, top = np.array(self.pose), np.eye(4)
        pose[:3, :3] = rotation_to(self._vector)
        top[2, 3] = length_drawn - tip
        least = 1e-9  # nothing has no direction
        with self._scene.atomic():
            self._scene.set_pose(self._name, pose)
            self._scene.set_pose(f"{self._name}/tip", top)
            thin = self._radius if length_drawn > least else least
            self._scene.set_appearance(
                f"{self._name}/shaft", "scale", (thin, thin, max(length_drawn - tip, least))
            )
            self._scene.set_appearance(
                f"{self._name}/tip", "scale", (2.4 * thin, 2.4 * thin, max(tip, least))
            )


def add_arrow(
    scene: SceneGraph, name: str, vector: ArrayLike, color: Colour, radius: float, size: float = 1.0
) -> Arrow:
    """Add an arrow from the origin of its group along a vector.

    Args:
        scene: The scene.
        name: Name of the arrow.
        vector: The vector, (3,), in the axes of the group.
        color: Its colour.
        radius: Radius of the shaft [m].
        size: Length for each unit of the vector [m].

    Returns:
        The arrow, whose `vector` can be assigned to.
    """
    shaft, tip = arrow(colour(color))
    scene.add(f"{name}/shaft", [shaft], shadow=False, through=True)  # it may well reach into the floor
    scene.add(f"{name}/tip", [tip], shadow=False, through=True)
    try:
        return Arrow(scene, name, vector, radius, size)
    except BaseException:
        scene.remove(name)
        raise


def rotation_to(vector: Floats) -> Floats:
    """A rotation (3, 3) that takes z to the direction of a vector."""
    z = normalized(vector)
    helper = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = normalized(np.cross(helper, z))
    return np.stack([x, np.cross(z, x), z], axis=1)
