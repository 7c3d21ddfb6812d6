"""Adding the worlds of collision checks and planning to a scene: obstacles, and the objects that links carry."""

from __future__ import annotations

from typing import Any

from ulna.checks.values import short_repr
from ulna.collision import World
from ulna.errors import InputError
from ulna.viewer.colours import Colour
from ulna.viewer.graph.handles import Handle
from ulna.viewer.graph.node import pose_or_position
from ulna.viewer.robot.robot_handle import RobotHandle
from ulna.viewer.scene.shapes import ShapeMethods


class WorldMethods(ShapeMethods):
    """Methods that add worlds to a scene."""

    def world(
        self,
        world: World,
        robot: RobotHandle | None = None,
        *,
        name: str = "world",
        pose: Any = None,
        color: Colour | None = None,
        opacity: float = 1.0,
    ) -> dict[str, Handle]:
        """Add the obstacles of a world, and the objects that the links of a robot here carry, which move along.

        Args:
            world: The world, as `ulna.collision.World().add(...)` makes it.
            robot: The handle of the robot that carries its attached objects; the only robot here when not given.
            name: Name of the group of the obstacles.
            pose: T_group_world, the pose of the world in its group; it stays the identity when not given.
            color: One colour for all.
            opacity: From 0 to 1 [-].

        Returns:
            Handles by the names of obstacles and attached objects; assign `pose` to move one.

        Raises:
            InputError: If it is no world, or objects are attached and `robot` is no handle of a robot here.
            UnknownName: If the robot has no link that carries an object.
        """
        if not isinstance(world, World):
            raise InputError(
                f"`world` is {short_repr(world)}; expected a World, as `World().add(...)` makes."
            )
        robots = [h for h in self._handles.values() if isinstance(h, RobotHandle)]
        if robot is None and len(robots) == 1:
            robot = robots[0]
        if world.attachments and not isinstance(robot, RobotHandle):
            carried = ", ".join(repr(item.name) for item in world.attachments)
            raise InputError(
                f"`robot` is {short_repr(robot)}, and links carry {carried}; expected the handle that "
                "viewer.add(robot) returned."
            )
        common: dict[str, Any] = {"color": color, "opacity": opacity}
        handles = {o.name: self.add(o.shape, name=f"{name}/{o.name}", pose=o.pose, **common) for o in world}
        if pose is not None and len(world):
            self.scene.set_pose(name, pose_or_position(pose))
        for item in world.attachments:
            assert robot is not None
            robot.robot.model.link_index(item.link)
            place = f"{robot.name}/{item.link}/{item.name}"
            handles[item.name] = self.add(item.shape, name=place, pose=item.pose, **common)
        return handles
