"""A scene that robots can be added to."""

from __future__ import annotations

from typing import Any, final

from ulna.typing import ArrayLike
from ulna.viewer.colours import Colour
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.robot.robot_visual import RobotVisual


@final
class Scene(SceneGraph):
    """A tree of named nodes, see `SceneGraph`, with robots among them."""

    __slots__ = ()

    def add_robot(
        self, robot: Any, q: ArrayLike, name: str | None = None, rgba: Colour | None = None
    ) -> RobotVisual:
        """Add the links of a robot as nodes that move together.

        Args:
            robot: An `ulna.Robot`.
            q: Its configuration, shape (nq,) [rad or m].
            name: The group of its nodes; the name of the robot when not given.
            rgba: One colour for all links; those of the materials when not given.

        Returns:
            The links; `Figure.move` sets another configuration.

        Raises:
            ShapeError, NonFiniteError: `q` is no configuration of the robot.
        """
        return RobotVisual(self, robot, q, name, rgba)
