"""A robot of the toolbox in the environment: its `q` and `qd` are moved by each step, within its limits."""

from __future__ import annotations

from math import isfinite
from types import SimpleNamespace
from typing import Any

import numpy as np

from swift._handles import AssemblyHandle
from swift._scene_items import pose_of
from ulna.errors import InputError, ShapeError
from ulna.sim.kinematic import limited_step
from ulna.typing import Floats


class RobotHandle(AssemblyHandle):
    """A robot in the environment. Its state is `q` and `qd` of the robot, and assigning to either changes both.

    Args:
        viewer: The `ulna.Viewer`.
        robot: A robot of the toolbox; whatever has `q`, `qd` and an `ulna.Robot` in `ulna` serves.
        alphas: Opacity of what it looks like and of what it collides with.
        readonly: Whether it is shown only, never moved.
        separate_state: Whether its state is separate from the robot's, as for a robot added a second time.
        more: As for `Item`.
    """

    def __init__(
        self,
        viewer: Any,
        robot: Any,
        alphas: tuple[float, float],
        readonly: bool,
        separate_state: bool,
        **more: Any,
    ) -> None:
        state = SimpleNamespace(q=np.array(robot.q), qd=np.array(robot.qd)) if separate_state else robot
        super().__init__(state, readonly, **more)
        self._viewer, self.robot, self._model = viewer, robot, robot.ulna
        self._complete = getattr(robot, "_complete_configuration", np.copy)
        self._low, self._high = _limits_of(robot)
        start = self._configuration()
        self._limited_step = limited_step(len(self._low))
        base_pose = np.asarray(self._model.link_poses(self._model.neutral))[0]
        self._base, self._to_place, self._unread = self._base_pose(), False, False
        is_checked = {"_q", "_qd", "_control_mode"} <= vars(state).keys()  # as by robots of the toolbox
        self._checked: dict[str, Any] | None = vars(state) if is_checked else None
        self._moved: Floats | None = None
        self._shown, self._read_shown = start, self._shown_configuration
        # a model may have the base built in
        self._model_offset = np.linalg.inv(base_pose) if np.allclose(base_pose, self._base) else np.eye(4)
        pose = self._base @ self._model_offset
        drawn = any(link.visuals for link in self._model.model.links)
        self.figures = tuple(
            viewer.add(self._model, start, pose=pose, opacity=alpha, show=what)
            for alpha, what in zip(alphas, ("visual" if drawn else "skeleton", "collision"), strict=True)
            if alpha > 0.0
        )

    @property
    def thing(self) -> Any:
        """The robot."""
        return self.robot

    def _joints(self) -> Floats:
        q = np.asarray(self._state.q, dtype=float)
        if q.shape != self._low.shape:
            raise ShapeError(
                "q", q.shape, f"({len(self._low)},), a number for each joint of {self._model.name!r}"
            )
        return q

    def _configuration(self) -> Floats:
        """The configuration of the model: the joints, and those of grippers where it has them."""
        return self._complete(self._joints())

    def _base_pose(self) -> Floats:
        if hasattr(self.robot, "_wT"):  # it may be attached to another robot's link
            return self.robot._wT
        return pose_of(getattr(self.robot, "base", np.eye(4)))

    def advance(self, t: float, dt: float, values: dict[str, Any]) -> None:
        """Advances the robot by one step, within its limits.

        Args:
            t: Time at the end of the step [s].
            dt: Length of the step [s].
            values: Values of named controls.

        Raises:
            InputError: `q` or `qd` is not as many finite numbers as there are joints.
        """
        state, checked = self._state, self._checked
        if checked and self.callback is None and not self.readonly and checked["_control_mode"] == "v":
            state_q, moved, sound = self._limited_step(
                checked["_q"], checked["_qd"], dt, self._low, self._high
            )
            if isfinite(sound):
                checked["_q"], self._moved = state_q, moved  # a script may write to the first
                return
        self._moved = None
        if not self._moves(t, values):
            return
        q, qd = self._joints(), np.asarray(state.qd, dtype=float)
        if qd.shape == q.shape:
            state_q, moved, sound = self._limited_step(q, qd, dt, self._low, self._high)
            if isfinite(sound):
                state.q, self._moved = state_q, moved
                return
        raise InputError(
            f"{self._model.name!r} is at q = {q.tolist()} with qd = {qd.tolist()}; expected {len(q)} finite "
            "numbers for each."
        )

    def show(self) -> None:
        """Show where it is."""
        q, self._moved = self._moved, None
        if q is None:  # a script may have set the configuration
            for figure in self.figures:
                figure.q = self._configuration()
        else:
            self._shown = q
            if self._unread:  # nobody has looked since the last step: whoever does reads the newest
                return
            for figure in self.figures:
                figure.set_checked_q(self._read_shown)
            self._unread = all(f.body is None and not f.has_traces for f in self.figures)
        if not self._to_place:  # a base seldom moves, and asking for it takes time: not before somebody looks
            self._to_place = True
            self._viewer.scene.later(self, self._place)

    def _shown_configuration(self) -> Floats:
        """The configuration of the model at the last step; figures ask for it when somebody looks."""
        self._unread = False  # before the newest is read, so that nothing that comes meanwhile is missed
        return self._complete(self._shown)

    def _place(self) -> None:
        self._to_place, base = False, self._base_pose()
        if not np.array_equal(base, self._base):
            self._base = base
            for figure in self.figures:
                figure.pose = base @ self._model_offset

    def remove(self) -> None:
        """Take it out of the scene."""
        for figure in self.figures:
            self._viewer.remove(figure)
        self.figures = ()

    def part_poses(self) -> list[Any]:
        """Where its links are in the world, an SE3 each."""
        from spatialmath import SE3  # pyright: ignore[reportMissingImports]

        poses = self._base_pose() @ self._model_offset @ self._model.link_poses(self._configuration())
        return [SE3(T, check=False) for T in poses]


def _limits_of(robot: Any) -> Floats:
    """Least and greatest joint coordinates, (2, n); a joint without limits is not held, as in Swift."""
    if not hasattr(robot, "links"):
        return np.array([robot.ulna.limits.lower, robot.ulna.limits.upper])
    joints = sorted((link for link in robot.links if link.isjoint), key=lambda link: link.jindex)
    rows = [(-np.inf, np.inf) if link.qlim is None else link.qlim for link in joints]
    return np.array(rows, dtype=float).reshape(-1, 2).T.copy()
