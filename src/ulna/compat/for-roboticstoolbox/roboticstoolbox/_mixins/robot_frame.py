"""A robot in the tree of frames: its base is a frame, which can be attached to another one."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.poses import pose, to_spatial
from roboticstoolbox._links.scene_frames import Node, scene_node
from roboticstoolbox._links.shapes import geometry
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.typing import Floats


class RobotNode(Node, RobotMixin):
    """A robot as a frame: that of its base."""

    _parent: Any

    @property
    def T(self) -> Floats:
        """The base in the frame that the robot is attached to, (4, 4); the same as `base`."""
        return np.eye(4) if self._base is None else to_spatial(self._base)

    @T.setter
    def T(self, T: Any) -> None:
        self.base = T

    _T = T

    @property
    def _wT(self) -> Floats:
        """T_world_base, (4, 4)."""
        return self.T if self._parent is None else self._parent._wT @ self.T

    def _where(self, link: Any) -> Floats:
        """T_world_link at the configuration of now, (4, 4)."""
        T = self._complete_robot().fk(self._complete_configuration(self.q), link.name)
        return T if self._parent is None else self._parent._wT @ T

    @property
    def scene_parent(self) -> Any:
        """What the robot is attached to; None for the world."""
        return self._parent

    @scene_parent.setter
    def scene_parent(self, parent: Any) -> None:
        self._detach()
        if parent is not None:
            self.attach_to(parent)

    def attach_to(self, object: Any) -> None:
        """Hangs the robot on a frame: a link of another robot, a shape, a SceneNode. `base` is then seen from there.

        `fkine` keeps telling poses in the axes of that frame.
        """
        scene_node().attach_to(self, object)

    def _detach(self) -> None:
        scene_node()._detach(self)

    @property
    def scene_children(self) -> list[Any]:
        """The first link, and what was attached to the base."""
        return [*(link for link in self._links if link.parent is None), *self._children]

    def fkine_geometry(self, q: Any, robot_alpha: float = 1.0, collision_alpha: float = 0.0) -> list[Any]:
        """Where each shape of the links is in the world, an SE3 each, those of grippers last.

        Args:
            q: Configuration, (n,) [rad or m].
            robot_alpha: Shapes to draw are counted if this is above zero [-].
            collision_alpha: Shapes to check are counted if this is above zero [-].

        Returns:
            One SE3 for each shape.
        """
        out = []
        links = self.link_dict
        poses = self._complete_robot().fk(self._complete_configuration(q), list(links))
        for T, link in zip(poses, links.values(), strict=True):
            shapes = [
                *(link._drawn if robot_alpha > 0 else ()),
                *(link._solids if collision_alpha > 0 else ()),
            ]
            out += [pose(T @ geometry(shape, "").placement.matrix()) for shape in shapes]
        return out
