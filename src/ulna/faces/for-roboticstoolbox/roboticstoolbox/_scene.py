"""Robots and links in the tree of frames: what hangs on them goes where they go.

Where a link is follows from its robot's `q`, whenever it is asked for; `update` has nothing to do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from roboticstoolbox._part import Part
from roboticstoolbox._poses import pose
from ulna.errors import InputError
from ulna.typing import Floats

_OF_LINKS = {"actuator": "`G`, `Jm`, `B` and `Tc`", "mesh": "`geometry`", "id": "`number`"}


def _node() -> Any:
    from spatialgeometry import SceneNode

    return SceneNode


class Node:
    """A frame that shapes and robots can hang on."""

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
        return _node().tree(self)

    def tree_children(self) -> str:
        """This frame and what hangs on it, a line for each."""
        return _node().tree_children(self)


class LinkNode(Node):
    """A link as a frame: it hangs on the link before it, the first one on the robot."""

    robot: Any

    @property
    def _wT(self) -> Floats:
        """T_world_link at the robot's `q`, (4, 4); of a link without a robot at zero."""
        if self.robot is not None:
            return self.robot._where(self)
        T = lifted(self.A(0.0).A)
        return T if self.parent is None else self.parent._wT @ T

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
                "A link hangs on the link before it; attach its robot: robot.attach_to(frame)."
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
            raise InputError(f"Link {self.name!r} belongs to no robot, so it is nowhere; make a Robot of it.")
        return self.robot._near(self.robot.q, shape, within, [self.name]) if self._solids else []

    def closest_point(
        self, shape: Any, inf_dist: float = 1.0, skip: bool = False
    ) -> tuple[float | None, Floats | None, Floats | None]:
        """Distance from a shape, the nearest point of the link and that of the shape; None beyond `inf_dist`."""
        for found in self._within(shape, inf_dist):
            return found.distance, found.points[0], found.points[1]
        return None, None, None

    def iscollided(self, shape: Any, skip: bool = False) -> bool:
        """Whether it touches a shape, at the robot's `q`."""
        return any(found.distance <= 0.0 for found in self._within(shape, 0.01))

    collided = iscollided


class RobotNode(Node, Part):
    """A robot as a frame: that of its base."""

    _parent: Any

    @property
    def T(self) -> Floats:
        """The base in the frame that the robot hangs on, (4, 4); the same as `base`."""
        return np.eye(4) if self._base is None else lifted(self._base)

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
        T = self._everything().fk(self._configuration(self.q), link.name)
        return T if self._parent is None else self._parent._wT @ T

    @property
    def scene_parent(self) -> Any:
        """What the robot hangs on; None for the world."""
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
        _node().attach_to(self, object)

    def _detach(self) -> None:
        _node()._detach(self)

    @property
    def scene_children(self) -> list[Any]:
        """The first link, and what was attached to the base."""
        return [*(link for link in self._links if link.parent is None), *self._children]

    def fkine_geometry(self, q: Any, robot_alpha: float = 1.0, collision_alpha: float = 0.0) -> list[Any]:
        """Where each shape of the links is in the world, an SE3 each, those of grippers last.

        Args:
            q: Configuration, (n,) [rad or m].
            robot_alpha: Shapes to draw are counted if this is above zero.
            collision_alpha: Shapes to check are counted if this is above zero.
        """
        from roboticstoolbox._shapes import geometry

        out = []
        links = self.link_dict
        poses = self._everything().fk(self._configuration(q), list(links))
        for T, link in zip(poses, links.values(), strict=True):
            shapes = [
                *(link._drawn if robot_alpha > 0 else ()),
                *(link._solids if collision_alpha > 0 else ()),
            ]
            out += [pose(T @ geometry(shape, "").placement.matrix()) for shape in shapes]
        return out


def lifted(T: Floats) -> Floats:
    """A pose in the plane (3, 3) as one in space (4, 4); those in space as they are."""
    if T.shape == (4, 4):
        return T
    out = np.eye(4)
    out[:2, :2], out[:2, 3] = T[:2, :2], T[:2, 2]
    return out
