"""The handle of a robot in the viewer: its state, its display, and the simulation that moves it."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np

from ulna.checks.arrays import read_only, shaped_array
from ulna.checks.values import one_of
from ulna.sim import Body
from ulna.system import forks
from ulna.typing import ArrayLike, Floats
from ulna.viewer.robot.configuration import checked_configuration
from ulna.viewer.robot.link_surfaces import RobotDisplay
from ulna.viewer.robot.overlays import RobotOverlays
from ulna.viewer.robot.robot_visual import RobotVisual


@final
class RobotHandle(RobotOverlays):
    """A robot in the viewer. `q` and `qd` are its state; `pose` is where its base stands.

    While a simulation moves it they are the simulation's, before and after alike.
    """

    __slots__ = ("_body", "_lock", "_qd")

    def __init__(self, figure: RobotVisual) -> None:
        super().__init__(figure)
        self._lock = forks.lock()
        self._body: Body | None = None
        self._qd = np.zeros(figure.robot.nv)

    @property
    def lock(self) -> threading.RLock:
        """Held while its configuration changes."""
        return self._lock

    @property
    def moves(self) -> int:
        """How often it was moved."""
        return self._visual.moves

    @property
    def body(self) -> Body | None:
        """What a simulation moves of it; None without one."""
        return self._body

    @property
    def q(self) -> Floats:
        """The configuration, shape (nq,), read-only: assign all of it, or the name of one of the robot's own."""
        return self._visual.q if self._body is None else self._body.q

    @q.setter
    def q(self, q: ArrayLike | str) -> None:
        robot = self._visual.robot
        self.set_checked_q(_named(robot, q) if isinstance(q, str) else checked_configuration(robot, q))

    def set_checked_q(self, q: Floats | Callable[[], Floats]) -> None:
        """As assigning to `q`, for an array that is a valid configuration and that is not modified later.

        Or for a function that returns such an array; it is called before the next snapshot, on any thread.
        """
        lock = self._lock
        lock.acquire()  # half the time of `with`
        try:
            if self._body is None and not self._paths:
                self._visual.set_checked_q(q)
                return
            now = q() if callable(q) else q
            if self._body is not None:
                self._body.set_checked_q(now)
            self._move(now)
        finally:
            lock.release()

    put = set_checked_q
    """Old name."""

    @property
    def qd(self) -> Floats:
        """The velocity, shape (nv,) [rad/s or m/s], read-only, as `q`."""
        return read_only(self._qd.copy()) if self._body is None else self._body.qd

    @qd.setter
    def qd(self, qd: ArrayLike) -> None:
        with self._lock:
            if self._body is None:
                self._qd = shaped_array("qd", qd, self.robot.nv, labels=self.robot.model.velocity_names)
            else:
                self._body.qd = qd
            self._visual.request_update()

    @property
    def show(self) -> RobotDisplay:
        """What of it is shown: "visual", "collision", "both" or "skeleton"."""
        return self._visual.show

    @show.setter
    def show(self, show: RobotDisplay) -> None:
        self._visual.set_display(show)

    @property
    def tool(self) -> Floats:
        """Where its tool is, T_world_tool, shape (4, 4)."""
        return self.world_pose @ np.asarray(self.robot.fk(self.q))

    @property
    def has_traces(self) -> bool:
        """Whether paths of its frames are drawn."""
        return bool(self._paths)

    @property
    def traces(self) -> list[list[Floats]]:
        """The positions [m] of each path that is drawn; assigning sets others."""
        return [path.points for path in self._paths]

    @traces.setter
    def traces(self, traces: Sequence[Sequence[Floats]]) -> None:
        for path, points in zip(self._paths, traces, strict=True):
            path.points = points

    def show_traces(self, q: Floats) -> None:
        """Draw its paths through configurations (n, nq), until it moves on."""
        for path in self._paths:
            path.show(q)

    def set_body(self, body: Body | None) -> None:
        """Have its state be that of a simulated body, or its own again."""
        with self._lock:
            if body is None and self._body is not None:
                self._qd = self._body.qd
            self._body = body

    def display(self, q: Floats) -> None:
        """Show a configuration of the past, unless it was removed; where a simulation has it stays as it is."""
        if self._name in self._scene:
            self._visual.move(q)

    def show_body_state(self) -> None:
        """Show where the simulation has it now, unless it was removed."""
        if self._body is not None and self._name in self._scene:
            self._move(self._body.q)

    def _move(self, q: Floats) -> None:
        self._visual.set_checked_q(q)
        for trace in self._paths:
            trace.add(q)

    def remove(self) -> None:
        """Take it out of the scene, with all that follows it."""
        self._paths.clear()
        self._visual.remove()


def _named(robot: Any, name: str) -> Floats:
    return np.array(robot.configurations[one_of("configuration", name, robot.configurations)], dtype=float)
