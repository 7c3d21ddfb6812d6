"""Projection of points to the samples of a picture."""

from __future__ import annotations

from typing import final

import numpy as np

from ulna.typing import Array, Floats
from ulna.viewer.graph.camera import Camera


@final
class Projection:
    """A camera and the samples of a picture.

    Args:
        camera: The camera.
        width: Samples across.
        height: Samples down.
    """

    def __init__(self, camera: Camera, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.eye, self.axes = np.asarray(camera.position, dtype=float), camera.axes()
        self.focus = height / (2 * np.tan(camera.fov / 2))

    def local(self, points: Floats) -> Floats:
        """Points in the camera's frame, z the distance along the view."""
        return ((points - self.eye) @ self.axes) * (1.0, 1.0, -1.0)

    def screen(self, local: Floats) -> Floats:
        """Where points in the camera's frame are seen [samples]."""
        x = self.width / 2 + self.focus * local[..., 0] / local[..., 2]
        y = self.height / 2 - self.focus * local[..., 1] / local[..., 2]
        return np.stack([x, y], axis=-1)

    def rays(self, column: Array, row: Array) -> Array:
        """Directions in the world from the eye through the middle of samples, of length 1 along the view.

        Args:
            column: Columns, (n,).
            row: Rows, (n,).

        Returns:
            Directions, (n, 3) float32.
        """
        axes = self.axes.astype(np.float32)
        x = ((column + 0.5 - self.width / 2) / self.focus).astype(np.float32)
        y = ((self.height / 2 - row - 0.5) / self.focus).astype(np.float32)
        return x[:, None] * axes[:, 0] + y[:, None] * axes[:, 1] - axes[:, 2]
