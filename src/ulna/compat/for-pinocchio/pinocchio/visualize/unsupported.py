"""Visualizers of other programs: they can be imported, and say at their construction what to use."""

from __future__ import annotations

from typing import Any, final

from pinocchio.visualize.base_visualizer import BaseVisualizer
from ulna.errors import ViewerError


class UnsupportedVisualizer(BaseVisualizer):
    """A visualizer that needs a separate program.

    Args:
        *_: Accepted and ignored.
        **__: Accepted and ignored.

    Raises:
        ViewerError: Always.
    """

    def __init__(self, *_: Any, **__: Any) -> None:
        raise ViewerError(
            f"{type(self).__name__} is not offered: it draws into another program. MeshcatVisualizer, ViserVisualizer "
            "and GepettoVisualizer take the same arguments and draw into Ulna's viewer."
        )


@final
class RVizVisualizer(UnsupportedVisualizer):
    """RViz of ROS; not offered."""


@final
class Panda3dVisualizer(UnsupportedVisualizer):
    """The viewer of panda3d; not offered."""
