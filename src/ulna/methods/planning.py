"""Collision-free motions, as a method of the robot."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ulna.methods.traced import only_numbers
from ulna.quantities.part import Part
from ulna.typing import ArrayLike

if TYPE_CHECKING:
    from ulna.collision import World
    from ulna.planning import Plan

_TRACED = "Call it outside, and pass what it finds as an argument."


@cache
def _planner_function() -> Any:
    """What plans; imported with the first plan, at once, since a collection of garbage would find none."""
    from ulna.system.collector import paused_collection

    with paused_collection():
        from ulna.planning.planner import plan
    return plan


class MotionPlanning(Part):
    """How to get there without touching anything."""

    __slots__ = ()

    def plan(
        self,
        q0: ArrayLike,
        goal: Any,
        world: World | None = None,
        frame: str | None = None,
        **options: Any,
    ) -> Plan:
        """A path from a configuration to a goal on which the robot touches neither itself nor the world.

        Args:
            q0: Where the robot is, (nq,) [rad or m].
            goal: A configuration, a pose, several of either, or a region; see `ulna.planning.plan`.
            world: Obstacles, and objects that links carry; None for none.
            frame: Whose pose the goal is; None for the tool.
            **options: Of `ulna.planning.plan`, such as `margin`, `timeout` and `seed`.

        Returns:
            An `ulna.planning.Plan`: `.points`, `.is_certified`, `.trajectory()`; false, with `.reason`, where there is
            no path.

        Raises:
            ShapeError, NonFiniteError, InputError, ModelError, UnknownName: As from `ulna.planning.plan`.

        Example:
            >>> from ulna.collision import World
            >>> from ulna.geometry import Box
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> world = World().add("post", Box((0.1, 0.1, 1.0)), (0.5, 0.0, 0.3))
            >>> path = robot.plan(q + [-0.6, 0, 0, 0, 0, 0, 0], q + [0.6, 0, 0, 0, 0, 0, 0], world)
            >>> bool(path), path.is_certified
            (True, True)
        """
        if type(q0) is not np.ndarray or q0.dtype.char != "d":
            only_numbers("robot.plan", _TRACED, q0)
        plan = _planner_function()
        return plan(self, q0, goal, world, frame=frame, **options)
