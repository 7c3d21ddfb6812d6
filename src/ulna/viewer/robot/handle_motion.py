"""What can be played: recordings, trajectories, plans and rows of configurations, as motions of handles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import short_repr
from ulna.errors import InputError, ShapeError
from ulna.sim import Recording
from ulna.trajectory import Samples, Trajectory
from ulna.trajectory.space import Poses, require_configurations
from ulna.trajectory.trajectory import SamplesWithJerk
from ulna.typing import Floats
from ulna.viewer.graph.handles import Handle
from ulna.viewer.robot.robot_handle import RobotHandle

SPEED = 1.0
"""Speed of the fastest joint along a path without times [rad/s, m/s]."""

_TRACE_RATE = 60.0  # points of traces for each second of a trajectory [1/s]
_PLAYABLE = "a trajectory, a recording, a plan, configurations (n, nq), or {handle: one of these}"


@final
@dataclass(frozen=True, eq=False)
class HandleMotion:
    """A handle, and its configuration or pose over time.

    Args:
        handle: What moves.
        end: Returns the last time [s]; a recording may grow.
        at: Returns the configuration (nq,) [rad, m] of a robot, or the pose (4, 4) of anything else, at a time [s].
        rows: Returns times (n,) [s] and configurations (n, nq) between which paths of frames are drawn.
    """

    handle: Handle
    end: Callable[[], float]
    at: Callable[[float], Floats]
    rows: Callable[[], tuple[Floats, Floats]]

    def show(self, t: float) -> None:
        """Move the handle to its state at time `t` [s], with the paths of its frames up to there."""
        if isinstance(self.handle, RobotHandle):
            if self.handle.has_traces and np.isfinite(self.end()):
                times, rows = self.rows()
                rows = rows[: int(np.searchsorted(times, t))]
                self.handle.show_traces(np.concatenate([rows, self.at(t)[None]]))
            self.handle.display(self.at(t))
        elif self.handle.name in self.handle.scene:
            self.handle.pose = self.at(t)


def recorded_motion(handle: RobotHandle, recording: Callable[[], Recording]) -> HandleMotion:
    """The motion of a robot in a recording that may grow.

    Args:
        handle: The robot.
        recording: Returns the recording.

    Returns:
        The motion.
    """

    def at(t: float) -> Floats:
        rows = recording()
        return rows.at(t, handle.robot) if len(rows) else handle.q

    return HandleMotion(
        handle,
        lambda: float(r.t[-1]) if len(r := recording()) else 0.0,
        at,
        lambda: (recording().t, recording().q),
    )


def handle_motions(played: Any, robots: Sequence[RobotHandle]) -> list[HandleMotion]:
    """The motions that something to be played means.

    Args:
        played: A recording, a trajectory, a plan, samples, or configurations (n, nq) [rad, m] for the only robot; or
            one of these, or a trajectory of poses, for each handle.
        robots: The robots of the scene.

    Returns:
        The motions.

    Raises:
        InputError: It cannot be played, or it is not clear by which robot.
        ShapeError: Its configurations are not those of the robot.
    """
    if isinstance(played, Mapping):
        wrong = next((h for h in played if not isinstance(h, Handle)), None)
        if wrong is not None or not played:
            what = "an empty dictionary" if not played else f"a motion of {short_repr(wrong)}"
            raise InputError(
                f"Cannot play {what}; expected {{handle: motion}}, with what viewer.add returned."
            )
        return [_motion(handle, one) for handle, one in played.items()]
    if len(robots) != 1:
        _check_playable(played)
        raise InputError(
            f"There are {len(robots)} robots here; expected {{handle: motion}}, so that each is named."
        )
    return [_motion(robots[0], played)]


def _motion(handle: Handle, played: Any) -> HandleMotion:
    _check_playable(played)
    if isinstance(played, Trajectory) and isinstance(played.space, Poses):
        return _pose_motion(handle, played)
    if not isinstance(handle, RobotHandle):
        raise InputError(
            f"Cannot play {short_repr(played)} with {handle!r}; expected a trajectory of poses, such as "
            "ulna.trajectory.pose_line(T0, T1, 2.0): configurations are for robots."
        )
    if isinstance(played, Trajectory):
        return _joint_motion(handle, played)
    recording = _recording(handle, played)
    if len(recording) and recording.q.shape[1:] != (handle.robot.nq,):
        raise ShapeError(
            "configurations", recording.q.shape, f"(n, {handle.robot.nq}), those of {handle.robot.name!r}"
        )
    return recorded_motion(handle, lambda: recording)


def _check_playable(played: Any) -> None:
    known = (Recording, Trajectory, Samples, SamplesWithJerk, list, tuple, np.ndarray)
    if not isinstance(played, known) and not _is_plan(played):
        raise InputError(f"Cannot play {short_repr(played)}; expected {_PLAYABLE}.")


def _joint_motion(handle: RobotHandle, trajectory: Trajectory) -> HandleMotion:
    require_configurations("trajectory", trajectory.space, handle.robot.model)
    count = int(np.ceil(trajectory.duration * _TRACE_RATE)) + 1
    times = np.union1d(np.linspace(0.0, trajectory.duration, min(count, 10_000)), trajectory.knots)
    rows = np.asarray(trajectory.q(times))
    return HandleMotion(
        handle, lambda: trajectory.duration, lambda t: np.asarray(trajectory.q(t)), lambda: (times, rows)
    )


def _pose_motion(handle: Handle, trajectory: Trajectory) -> HandleMotion:
    if isinstance(handle, RobotHandle):
        raise InputError(
            f"{trajectory!r} moves a pose, not the joints of {handle.robot.name!r}. "
            "follow(robot, trajectory, q0) converts it to joint motion; {handle: trajectory} moves other objects."
        )
    none = np.zeros(0), np.zeros((0, 0))
    return HandleMotion(
        handle, lambda: trajectory.duration, lambda t: np.asarray(trajectory.T(t)), lambda: none
    )


def _recording(handle: RobotHandle, played: Any) -> Recording:
    if isinstance(played, Recording):
        return played
    recording = Recording()
    if isinstance(played, Samples | SamplesWithJerk):
        for t, q in zip(played.t, played.q, strict=True):
            recording.add(float(t), q)
        return recording
    plan: Any = None if isinstance(played, list | tuple | np.ndarray) else played
    if plan is not None and not plan:
        raise InputError(f"There is no path to play: {plan.reason}")
    robot, t = handle.robot, 0.0
    points = finite_array("configurations", played if plan is None else plan.points, "numbers")
    if points.ndim != 2 or points.shape[1] != robot.nq or not len(points):
        raise ShapeError("configurations", points.shape, f"(n, {robot.nq}), those of {robot.name!r}")
    for k, q in enumerate(points):
        if k:
            t += float(np.abs(robot.difference(points[k - 1], q)).max(initial=0.0)) / SPEED
        recording.add(t, q)
    return recording


def _is_plan(played: Any) -> bool:
    from ulna.planning import Plan  # here, because it takes a tenth of a second

    return isinstance(played, Plan)
