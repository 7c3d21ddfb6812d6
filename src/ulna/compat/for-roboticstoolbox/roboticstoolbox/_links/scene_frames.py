"""Robots and links in the tree of frames: what is attached to them goes where they go.

Where a link is follows from its robot's `q`, whenever it is asked for; `update` has nothing to do.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from ulna.errors import InputError
from ulna.typing import Floats

_OF_LINKS = {"actuator": "`G`, `Jm`, `B` and `Tc`", "id": "`number`"}


def scene_node() -> Any:
    from spatialgeometry import SceneNode

    return SceneNode


class Node:
    """A frame that shapes and robots can be attached to."""

    _children: list[Any]

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    def attach(self, object: Any) -> None:
        """Hangs a shape, a frame or a robot on it: its pose is from now on seen from here."""
        object.attach_to(self)

    def update(self) -> None:
        """Nothing is to be done: where a frame is in the world is computed when it is asked for."""

    def tree(self) -> str:
        """The whole tree it is in, a line for each frame, this one marked."""
        return scene_node().tree(self)

    def tree_children(self) -> str:
        """This frame and what is attached to it, a line for each."""
        return scene_node().tree_children(self)


class LinkNode(Node):
    """A link as a frame: it is attached to the link before it, the first one on the robot."""

    robot: Any

    @property
    def _wT(self) -> Floats:
        """T_world_link at the robot's `q`, (4, 4); the identity of a link without a robot."""
        return np.eye(4) if self.robot is None else self.robot._where(self)

    @property
    def T(self) -> Floats:
        """T_parent_link at the robot's `q`, (4, 4)."""
        above = self.scene_parent
        return self._wT if above is None else np.linalg.solve(above._wT, self._wT)

    @T.setter
    def T(self, pose: Any) -> None:
        raise InputError(f"Where link {self.name!r} is follows from the configuration; set the robot's `q`.")

    _T = T

    def __getattr__(self, name: str) -> Any:
        if name == "attach_to":
            raise AttributeError(
                "A link is attached to the link before it; attach its robot: robot.attach_to(frame)."
            )
        if name in _OF_LINKS:
            raise AttributeError(f"`{name}` of a link is not offered; use {_OF_LINKS[name]}.")
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    @property
    def scene_parent(self) -> Any:
        """The link before it; the robot for the first one."""
        return self.robot if self.parent is None else self.parent

    @property
    def scene_children(self) -> list[Any]:
        """The links after it, and what was attached to it."""
        return [*self.children, *self._children]

    def _within(self, shape: Any, within: float) -> list[Any]:
        if self.robot is None:
            raise InputError(
                f"Link {self.name!r} belongs to no robot, so it has no pose; make a Robot of it."
            )
        return self.robot._nearby_links(self.robot.q, shape, within, [self.name]) if self._solids else []

    def closest_point(
        self, shape: Any, inf_dist: float = 1.0, skip: bool = False
    ) -> tuple[float | None, Floats | None, Floats | None]:
        """The points of the link and of a shape that are nearest to each other.

        Args:
            shape: A shape of spatialgeometry.
            inf_dist: Greatest distance that counts [m].
            skip: Plays no part: links are always where the robot's configuration puts them.

        Returns:
            Distance [m], point of the link (3,) [m], point of the shape (3,) [m]; or None, None, None.
        """
        for pair in self._within(shape, inf_dist):
            return pair.distance, pair.points[0], pair.points[1]
        return None, None, None

    def iscollided(self, shape: Any, skip: bool = False) -> bool:
        """Whether it touches a shape, at the robot's `q`.

        Args:
            shape: A shape of spatialgeometry.
            skip: Plays no part: links are always where the robot's configuration puts them.

        Returns:
            Whether they touch.
        """
        return any(pair.distance <= 0.0 for pair in self._within(shape, 0.01))

    def collided(self, shape: Any, skip: bool = False) -> bool:
        """The former name of `iscollided`.

        Args:
            shape: A shape of spatialgeometry.
            skip: Plays no part: links are always where the robot's configuration puts them.

        Returns:
            Whether they touch.
        """
        warnings.warn("collided is the former name of iscollided", FutureWarning, stacklevel=2)
        return self.iscollided(shape, skip)
