"""The camera, and cameras that show a whole scene."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ulna.checks.arrays import length_array
from ulna.checks.values import number, short_repr
from ulna.errors import InputError
from ulna.numeric.arrays import triple
from ulna.typing import Floats
from ulna.viewer.graph.scene_graph import SceneGraph

DIRECTION = (1.55, -1.75, 0.70)
"""From the thing looked at towards the camera: from the front right, a little above."""


@dataclass(frozen=True)
class Camera:
    """A pinhole camera.

    Args:
        position: Where it stands, in the world [m].
        target: The point it is directed at, in the world [m].
        fov: Vertical field of view [rad].
        up: The direction that is up in the picture.

    Raises:
        ShapeError, NonFiniteError, InputError: It looks nowhere.

    Example:
        >>> viewer = ulna.Viewer(page=False)
        >>> arm = viewer.add(ulna.load("panda"), "ready")
        >>> above = ulna.viewer.Camera(position=(0.0, 0.0, 3.0), target=(0.0, 0.0, 0.0), up=(1.0, 0.0, 0.0))
        >>> viewer.picture(width=320, height=200, camera=above).shape
        (200, 320, 3)
    """

    position: tuple[float, float, float] = (1.75, -1.75, 1.05)
    target: tuple[float, float, float] = (0.22, 0.0, 0.37)
    fov: float = float(np.deg2rad(27.0))
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        for name in ("position", "target", "up"):
            object.__setattr__(self, name, triple(length_array(name, getattr(self, name), 3)))
        fov = number("fov", self.fov, "an angle above 0 and below pi [rad]", above=0.0, most=np.pi - 1e-6)
        object.__setattr__(self, "fov", fov)
        if not np.any(self.up):
            raise InputError("`up` is (0, 0, 0); expected the direction that is up in the picture.")
        if not np.any(np.subtract(self.position, self.target)):
            raise InputError(
                f"`position` and `target` of the camera are both {self.target}; expected different points."
            )

    def axes(self) -> Floats:
        """R_world_camera, shape (3, 3): right, up and backwards of the picture as columns."""
        back = np.subtract(self.position, self.target)
        back = back / max(float(np.linalg.norm(back)), 1e-12)
        right = np.cross(self.up, back)
        if np.linalg.norm(right) < 1e-6:  # straight up or down: any direction serves
            right = np.cross((0.0, 1.0, 0.0), back)
        right = right / np.linalg.norm(right)
        return np.stack([right, np.cross(back, right), back], axis=1)


def checked_camera(camera: Camera | None) -> Camera | None:
    """A camera, or None.

    Raises:
        InputError: It is neither.
    """
    if camera is not None and not isinstance(camera, Camera):
        raise InputError(
            f"`camera` is {short_repr(camera)}; expected an ulna.viewer.Camera, or None to see everything."
        )
    return camera


def camera_for(
    scene: SceneGraph,
    aspect: float = 1.6,
    direction: tuple[float, float, float] = DIRECTION,
    margin: float = 1.3,
    aside: float = 0.0,
    also: Floats | None = None,
) -> Camera:
    """A camera that shows the whole scene.

    Args:
        scene: The scene.
        aspect: Width over height of the picture [-].
        direction: From the scene towards the camera.
        margin: How much larger than the scene the picture is [-].
        aside: How far to the left of the middle the scene stands, as a share of the picture's width [-].
        also: More points to show [m], shape (n, 3).

    Returns:
        The camera.
    """
    points = scene.points() if also is None else np.concatenate([scene.points(), also])
    if not len(points):
        return Camera()
    target = (points.min(axis=0) + points.max(axis=0)) / 2
    rotation = Camera(tuple(np.add(target, direction)), tuple(target)).axes()
    fov = Camera().fov
    slope = np.tan(fov / 2) / margin
    distance = 0.2
    for _ in range(4):  # perspective moves the middle of the picture a little; a few rounds settle it
        x, y, z = ((points - target) @ rotation).T
        distance = max(float(np.max(z + np.maximum(np.abs(y) / slope, np.abs(x) / (slope * aspect)))), 0.2)
        screen_x, screen_y = x / (distance - z), y / (distance - z)
        middle = np.array([screen_x.min() + screen_x.max(), screen_y.min() + screen_y.max(), 0.0]) / 2
        target = target + rotation @ (middle * distance)
    target = target + rotation[:, 0] * (aside * 2 * np.tan(fov / 2) * aspect * distance)
    position = target + distance * rotation[:, 2]
    return Camera(triple(position), triple(target), fov)
