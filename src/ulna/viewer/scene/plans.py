"""Adding what a planner found to a scene: the path of the tool, and the trees of the search."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ulna.checks.values import short_repr
from ulna.errors import InputError
from ulna.typing import Floats
from ulna.viewer.colours import Colour
from ulna.viewer.graph.content import Lines
from ulna.viewer.graph.handles import Handle
from ulna.viewer.robot.robot_handle import RobotHandle
from ulna.viewer.scene.worlds import WorldMethods

if TYPE_CHECKING:
    from ulna.planning import Plan

_PATH, _FROM_START, _FROM_GOAL = "royalblue", "seagreen", "darkorange"
_STEP = 0.05  # between points of the path [rad, m]
_PARTS = 4  # pieces in which an edge of a tree is drawn, since the tool does not move straight
_MAX_EDGES = 20_000  # edges


class PlanMethods(WorldMethods):
    """Methods that add plans to a scene."""

    def plan(
        self,
        plan: Plan,
        robot: RobotHandle | None = None,
        *,
        frame: str | None = None,
        name: str = "plan",
        color: Colour | None = None,
        thickness: float = 0.006,
    ) -> dict[str, Handle]:
        """Add the path on which a plan moves a frame and, with `keep_tree=True`, where the search has been.

        `play(plan)` moves the robot along it.

        Args:
            plan: What `robot.plan(...)` returned; of one without a path only the trees are drawn.
            robot: The handle of the robot that it is for; the only robot here when not given.
            frame: The frame; the tool when not given.
            name: Name of the group, in that of the robot.
            color: Colour of the path.
            thickness: Thickness of the path [m]; the edges of the trees have half of it.

        Returns:
            Handles by name: "path", and "from start" and "from goal" for the trees.

        Raises:
            InputError: If it is no plan, `robot` is no handle of its robot, or there is nothing to draw.
            UnknownName: If the robot has no such frame.

        Example:
            >>> robot, viewer = ulna.load("panda"), ulna.Viewer(page=False)
            >>> arm = viewer.add(robot, "ready")
            >>> plan = robot.plan(arm.q, arm.q + 0.3)
            >>> list(viewer.plan(plan))
            ['path']
        """
        from ulna.planning import Plan  # here, because it takes a tenth of a second

        if not isinstance(plan, Plan):
            raise InputError(f"`plan` is {short_repr(plan)}; expected a Plan, as robot.plan(...) returns.")
        robot = self._robot_of(plan, robot)
        lines: dict[str, tuple[Floats, Any, float]] = {}
        if len(plan.points) > 1:
            line = _positions(robot, frame, _dense(plan.points))
            lines["path"] = np.stack([line[:-1], line[1:]], axis=1), color or _PATH, thickness
        if plan.tree is not None:
            edges = plan.tree.edges[:_MAX_EDGES]
            is_first = plan.tree.is_from_start[edges[:, 1]]
            for place, rows, hue in (
                ("from start", edges[is_first], _FROM_START),
                ("from goal", edges[~is_first], _FROM_GOAL),
            ):
                if len(rows):
                    lines[place] = _drawn(robot, frame, plan.tree.nodes[rows]), hue, thickness / 2.0
        if not lines:
            reason = plan.reason or "the start is the goal."
            raise InputError(
                f"There is no path and no tree to draw: {reason} robot.plan(..., keep_tree=True) keeps the trees."
            )
        return {
            key: self._add_node(
                f"{robot.name}/{name}/{key}", "line", content=Lines(segments, hue, size), shadow=False
            )
            for key, (segments, hue, size) in lines.items()
        }

    def _robot_of(self, plan: Plan, robot: RobotHandle | None) -> RobotHandle:
        """The handle of the robot that a plan is for."""
        robots = [h for h in self._handles.values() if isinstance(h, RobotHandle)]
        if robot is None and len(robots) == 1:
            robot = robots[0]
        if not isinstance(robot, RobotHandle):
            raise InputError(
                f"`robot` is {short_repr(robot)}, and there are {len(robots)} robots here; expected the handle that "
                "viewer.add(robot) returned."
            )
        if robot.robot.model.joint_names != plan.model.joint_names:
            raise InputError(
                f"The plan is for {plan.model.name!r}, whose joints are not those of {robot.robot.model.name!r}."
            )
        return robot


def _positions(robot: RobotHandle, frame: str | None, q: Floats) -> Floats:
    """Where a frame is in the robot's frame, shape (..., 3) [m]."""
    T = robot.robot.fk(q) if frame is None else robot.robot.fk(q, frame)
    return T[..., :3, 3]


def _dense(points: Floats) -> Floats:
    """A path with points so near to each other that straight lines between them follow the path of the frame."""
    pieces = [points[:1]]
    for a, b in pairwise(points):
        count = int(np.ceil(np.abs(b - a).max() / _STEP)) + 1
        pieces.append(a + np.linspace(0.0, 1.0, count + 1)[1:, None] * (b - a))
    return np.concatenate(pieces)


def _drawn(robot: RobotHandle, frame: str | None, ends: Floats) -> Floats:
    """The motions from one configuration to another, ends of shape (n, 2, nq), as lines (m, 2, 3) [m]."""
    t = np.linspace(0.0, 1.0, _PARTS + 1)[:, None]
    q = ends[:, :1] + t * (ends[:, 1:] - ends[:, :1])
    line = _positions(robot, frame, q)
    return np.stack([line[:, :-1], line[:, 1:]], axis=2).reshape(-1, 2, 3)
