"""The teach panel of a robot: sliders for joints, the tool pose, named configurations, a target to drag."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from typing import Any, Protocol, final

import numpy as np

from ulna.spatial import SE3, matrix_to_rpy
from ulna.typing import ArrayLike, Floats
from ulna.viewer.graph.node import checked_pose
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.page import Page
from ulna.viewer.page.gizmo import Gizmo
from ulna.viewer.panel import Panel
from ulna.viewer.panel.sliders import Slider
from ulna.viewer.robot.slider_coordinates import SliderCoordinate, slider_coordinates
from ulna.viewer.robot.target_following import TargetFollower

_MOVE_DURATION = 0.6  # how long a move to a named configuration takes [s]
_UPDATE_INTERVAL = 1 / 15  # s between two updates of sliders and texts


class MovableRobot(Protocol):
    """What a teach panel moves: a robot with a configuration, in a scene."""

    @property
    def robot(self) -> Any:
        """The robot."""
        ...

    @property
    def name(self) -> str:
        """The name of the group of its links in the scene."""
        ...

    @property
    def scene(self) -> SceneGraph:
        """The scene that contains it."""
        ...

    @property
    def lock(self) -> threading.RLock:
        """Held while its configuration changes."""
        ...

    @property
    def moves(self) -> int:
        """How often it was moved."""
        ...

    @property
    def q(self) -> Floats:
        """The configuration."""
        ...

    @q.setter
    def q(self, q: Any) -> None: ...


@final
class TeachPanel:
    """The teach panel of a robot; it is removed with the robot, or by `remove`.

    Args:
        page: The page.
        target: What it moves.
        base: T_world_base of the robot, asked when it is needed.
        heading: The name of its folder in the panel; no folder when empty.
    """

    def __init__(
        self, page: Page, target: MovableRobot, base: Callable[[], Floats] | None = None, heading: str = ""
    ) -> None:
        self._target, self.robot, self._panel = target, target.robot, Panel(page)
        self._base = base or (lambda: np.eye(4))
        self._last, self._moves = target.q, target.moves
        self._follower = TargetFollower(self.robot)
        self.goal: Floats | None = None
        """Where the tool shall go in the robot's world, while it is on its way."""
        self._motion: tuple[float, Floats, Floats] | None = None
        self._shown_q = np.full_like(self._last, np.nan)
        self._updated_at = 0.0
        self.coordinates = slider_coordinates(self.robot)
        self.sliders: list[Slider] = []
        self._parts: list[Any] = []
        with self._panel.folder(heading) if heading else contextlib.nullcontext() as folder:
            self._build()
        if folder is not None:
            self._parts.append(folder)
        self._page = page
        page.add_tick(self._tick)

    def remove(self) -> None:
        """Take it out of the panel, and the target out of the scene. May be called twice."""
        with self._target.lock:
            self._page.remove_tick(self._tick)
            parts, self._parts = self._parts, []
            for part in parts:
                part.remove()

    def set_target(self, T_goal: ArrayLike) -> None:
        """Move the target to T_world_goal, as dragging it does: the tool follows as far as the joints allow.

        Raises:
            ShapeError, NonFiniteError, InputError: It is no pose.
        """
        goal = checked_pose(T_goal, "T_goal")
        with self._target.lock:
            self._accept_program_motion()
            self._motion, self.goal = None, self._in_base(goal)
            self.gizmo.pose = goal

    def move_to(self, q: Floats) -> None:
        """Move smoothly to a configuration."""
        with self._target.lock:
            self._accept_program_motion()
            self.goal, self._motion = None, (time.monotonic(), self._last, np.array(q, dtype=float))

    aim, glide_to = set_target, move_to
    """Old names."""

    def _build(self) -> None:
        panel, q = self._panel, self._last
        with panel.folder("Tool") as tools:
            self.readout = panel.text("")
        with panel.folder("Joints") as joints:
            for dial in self.coordinates:
                value = round(dial.read(q), 3)
                self.sliders.append(
                    panel.slider(
                        dial.label,
                        dial.low,
                        dial.high,
                        value,
                        self._slider_callback(dial),
                        step=dial.step,
                        hint=dial.hint,
                    )
                )
            if not self.coordinates:
                panel.text("This robot has no joint to move.")
        names = tuple(self.robot.configurations)
        if names:
            configurations = self.robot.configurations
            self._parts.append(panel.buttons("Go to", names, lambda name: self.move_to(configurations[name])))
        tool = self._base() @ np.asarray(self.robot.fk(q))
        name = f"target of {self._target.name}"
        self.gizmo: Gizmo = panel.gizmo(name, tool, self._dragged, size=self._gizmo_size())
        self._parts += [tools, joints, self.gizmo]

    def _gizmo_size(self) -> float:
        points = self._target.scene.points(2000)
        extent = float(np.ptp(points, axis=0).max()) if len(points) else 1.0
        return float(np.clip(0.2 * extent, 0.05, 0.4))

    def _slider_callback(self, dial: SliderCoordinate) -> Callable[[float], None]:
        def moved(value: float) -> None:
            with self._target.lock:
                self.goal = self._motion = None
                self._move(dial.write(self._target.q, value))

        return moved

    # what happens on the thread of the page -----------------------------------------------------------------

    def _dragged(self, event: tuple[Floats, str]) -> None:
        pose, _ = event
        with self._target.lock:
            if self._target.name not in self._target.scene:
                return
            self._accept_program_motion()
            self._motion, self.goal = None, self._in_base(pose)

    def _in_base(self, T: Floats) -> Floats:
        return SE3.project(np.linalg.inv(self._base()) @ T).matrix()

    def _accept_program_motion(self) -> None:
        """Accept a motion of the robot by the program, which cancels a motion of the panel."""
        if self._target.moves != self._moves:
            self._last, self._moves = self._target.q, self._target.moves
            self.goal = self._motion = None

    def _tick(self) -> None:
        with self._target.lock:
            if self._target.name not in self._target.scene:
                self.remove()
            if not self._parts:
                return
            self._accept_program_motion()
            if self.goal is not None:
                self._step_to_goal(self.goal)
            elif self._motion is not None:
                began, start, end = self._motion
                t = min((time.monotonic() - began) / _MOVE_DURATION, 1.0)
                share = t * t * t * (10 + t * (6 * t - 15))
                self._move(self.robot.interpolate(start, end, share) if t < 1 else end)
                if t >= 1:
                    self._motion = None
            self._update_panel()

    def _step_to_goal(self, goal: Floats) -> None:
        step = self._follower.step(self._last, goal)
        if step.converged and not self.gizmo.is_dragged:  # as near as can be: the target returns to the tool
            self.goal = None
            self._shown_q = np.full_like(self._last, np.nan)
        self._move(step.q)

    def _move(self, q: Floats) -> None:
        self._target.q = q
        self._last, self._moves = self._target.q, self._target.moves

    def _update_panel(self) -> None:
        """Sliders, the tool's pose and the target follow the robot, 15 times a second, at rest once more."""
        now = time.monotonic()
        q = self._last
        if np.array_equal(self._shown_q, q) or now - self._updated_at < _UPDATE_INTERVAL:
            return
        self._shown_q, self._updated_at = q, now
        for dial, slider in zip(self.coordinates, self.sliders, strict=True):
            slider.value = round(dial.read(q), 3)
        T = self._base() @ np.asarray(self.robot.fk(q))
        self.readout.value = _pose_text(self.robot.tool, T)
        if self.goal is None and not self.gizmo.is_dragged:
            self.gizmo.pose = T


def _pose_text(frame: str, T: Floats) -> str:
    x, y, z = T[:3, 3]
    degrees = np.round(np.rad2deg(np.asarray(matrix_to_rpy(T[:3, :3]), dtype=float)), 1)
    roll, pitch, yaw = np.where(degrees == -180.0, 180.0, degrees + 0.0)
    return (
        f"`{frame}`\n\n| | | |\n|---|---|---|\n"
        f"| **x** {x:.3f} m | **y** {y:.3f} m | **z** {z:.3f} m |\n"
        f"| **roll** {roll:.1f}° | **pitch** {pitch:.1f}° | **yaw** {yaw:.1f}° |\n"
    )
