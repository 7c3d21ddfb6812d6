"""The visualizer of viser's spelling."""

from __future__ import annotations

from typing import final

from pinocchio.visualize.camera import CameraVisualizer


@final
class ViserVisualizer(CameraVisualizer):
    """Draws into a new viewer, or into the one passed to it; `host` and `port` are those of its page."""
