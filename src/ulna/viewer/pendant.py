"""A robot's part of the panel: its joints as sliders, its tool's pose, named configurations, a target to drag."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, final

import numpy as np

from ulna.spatial import SE3, matrix_to_rpy, quat_xyzw_to_matrix
from ulna.typing import ArrayLike, Floats
from ulna.viewer.controls import Control, Gizmo
from ulna.viewer.follow import Follower
from ulna.viewer.node import checked_pose
from ulna.viewer.page import Page
from ulna.viewer.panel import Panel
from ulna.viewer.scene import Scene

_GLIDE = 0.6  # how long a move to a named configuration takes [s]
_CALM = 1 / 15  # s between two updates of sliders and words


class Moved(Protocol):
    """What a pendant moves: a robot with a configuration, in a scene."""

    @property
    def robot(self) -> Any:
        """The robot."""
        ...

    @property
    def scene(self) -> Scene:
        """The scene it stands in."""
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
@dataclass(frozen=True)
class Dial:
    """One number of a configuration that a slider sets.

    `read` gives it from a configuration; `write` gives the configuration with another value of it.
    """

    label: str
    hint: str
    low: float
    high: float
    step: float
    read: Callable[[Floats], float]
    write: Callable[[Floats, float], Floats]


@final
class Pendant:
    """A robot's part of the panel.

    Args:
        page: The page.
        target: What it moves.
        base: T_world_base of the robot, asked when it is needed.
    """

    def __init__(self, page: Page, target: Moved, base: Callable[[], Floats] | None = None) -> None:
        self._target, self.robot, self._panel = target, target.robot, Panel(page)
        self._base = base or (lambda: np.eye(4))
        self._last, self._moves = target.q, target.moves
        self._follower = Follower(self.robot)
        self.goal: Floats | None = None
        """Where the tool shall go in the robot's world, while it is on its way."""
        self._glide: tuple[float, Floats, Floats] | None = None
        self._told = np.full_like(self._last, np.nan)
        self._told_at = 0.0
        self.dials = dials(self.robot)
        self.sliders: list[Control] = []
        self._build(page)
        page.each_tick(self._tick)

    def aim(self, T_goal: ArrayLike) -> None:
        """Move the target to T_world_goal, as dragging it does: the tool follows as far as the joints allow.

        Raises:
            ShapeError, NonFiniteError, InputError: It is no pose.
        """
        goal = checked_pose(T_goal, "T_goal")
        with self._target.lock:
            self._adopt()
            self._glide, self.goal = None, self._in_base(goal)
            self.gizmo.pose = goal

    def glide_to(self, q: Floats) -> None:
        """Move smoothly to a configuration."""
        with self._target.lock:
            self._adopt()
            self.goal, self._glide = None, (time.monotonic(), self._last, np.array(q, dtype=float))

    def _build(self, page: Page) -> None:
        panel, q = self._panel, self._last
        with panel.folder("Tool"):
            self.readout = panel.text("")
        with panel.folder("Joints"):
            for dial in self.dials:
                value = round(dial.read(q), 3)
                self.sliders.append(
                    panel.slider(
                        dial.label,
                        dial.low,
                        dial.high,
                        value,
                        self._turner(dial),
                        step=dial.step,
                        hint=dial.hint,
                    )
                )
            if not self.dials:
                panel.text("This robot has no joint to move.")
        named = tuple(self.robot.configurations)
        if named:
            panel.buttons("Go to", named, lambda name: self.glide_to(self.robot.configurations[name]))
        tool = self._base() @ np.asarray(self.robot.fk(q))
        name = f"target of {getattr(self._target, 'name', self.robot.name)}"
        self.gizmo: Gizmo = panel.gizmo(name, tool, self._dragged, size=self._gizmo_size())

    def _gizmo_size(self) -> float:
        points = self._target.scene.points(2000)
        extent = float(np.ptp(points, axis=0).max()) if len(points) else 1.0
        return float(np.clip(0.2 * extent, 0.05, 0.4))

    def _turner(self, dial: Dial) -> Callable[[float], None]:
        def moved(value: float) -> None:
            with self._target.lock:
                self.goal = self._glide = None
                self._move(dial.write(self._target.q, value))

        return moved

    # what happens on the thread of the page -----------------------------------------------------------------

    def _dragged(self, event: tuple[Floats, str]) -> None:
        pose, _ = event
        with self._target.lock:
            self._adopt()
            self._glide, self.goal = None, self._in_base(pose)

    def _in_base(self, T: Floats) -> Floats:
        return SE3.project(np.linalg.inv(self._base()) @ T).matrix()

    def _adopt(self) -> None:
        """Take over what the program did with the robot meanwhile, which ends a way of ours."""
        if self._target.moves != self._moves:
            self._last, self._moves = self._target.q, self._target.moves
            self.goal = self._glide = None

    def _tick(self) -> None:
        with self._target.lock:
            self._adopt()
            if self.goal is not None:
                self._follow(self.goal)
            elif self._glide is not None:
                began, start, end = self._glide
                t = min((time.monotonic() - began) / _GLIDE, 1.0)
                share = t * t * t * (10 + t * (6 * t - 15))
                self._move(self.robot.interpolate(start, end, share) if t < 1 else end)
                if t >= 1:
                    self._glide = None
            self._tell()

    def _follow(self, goal: Floats) -> None:
        step = self._follower.step(self._last, goal)
        if step.rests and not self.gizmo.held:  # as near as can be: the target returns to the tool
            self.goal = None
            self._told.fill(np.nan)
        self._move(step.q)

    def _move(self, q: Floats) -> None:
        self._target.q = q
        self._last, self._moves = self._target.q, self._target.moves

    def _tell(self) -> None:
        """Sliders, the tool's pose and the target follow the robot, 15 times a second, at rest once more."""
        now = time.monotonic()
        q = self._last
        if np.array_equal(self._told, q) or now - self._told_at < _CALM:
            return
        self._told, self._told_at = q, now
        for dial, slider in zip(self.dials, self.sliders, strict=True):
            slider.value = round(dial.read(q), 3)
        T = self._base() @ np.asarray(self.robot.fk(q))
        self.readout.value = _pose_text(self.robot.tool, T)
        if self.goal is None and not self.gizmo.held:
            self.gizmo.pose = T


def dials(robot: Any) -> list[Dial]:
    """The numbers of a robot's configuration that sliders can set: coordinates, and angles for rotations."""
    out, model = [], robot.model
    for joint in model.joints:
        if joint.mimic is not None:
            continue
        short, entries = _short(joint.name, robot.joint_names), joint.kind.coordinates
        k = 0
        while k < len(entries):
            i = joint.idx_q + k
            if entries[k].unit == "":  # a quaternion, four entries
                out += [_angle(short, joint, i, axis) for axis in range(3)]
                k += 4
            else:
                label = short if len(entries) == 1 else f"{short} {entries[k].name}"
                out.append(_coordinate(label, joint, i, entries[k].unit, model))
                k += 1
    return out


def _coordinate(label: str, joint: Any, i: int, unit: str, model: Any) -> Dial:
    turning = unit == "rad"
    free = np.pi if turning else 1.0
    lower, upper = float(model.lower_position[i]), float(model.upper_position[i])
    bounded = np.isfinite(lower) and np.isfinite(upper)
    low, high = (lower if np.isfinite(lower) else -free), (upper if np.isfinite(upper) else free)
    if turning and bounded:
        span = f"{np.rad2deg(low):.0f}° to {np.rad2deg(high):.0f}°"
    else:
        span = f"{low:.3g} to {high:.3g} {unit}" if bounded else "no limits"
    step = 0.001 if high - low > 0.2 else max((high - low) / 500, 1e-6)
    if high - low < 1e-9:
        high = low + 1e-6

    def write(q: Floats, value: float) -> Floats:
        q = q.copy()
        q[i] = np.clip(
            value, lower, upper
        )  # the slider's steps do not end on the limits; the robot's numbers do
        return q

    hint = f"{joint.name} ({joint.kind.describe()}), {span}"
    return Dial(f"{label} [{unit}]", hint, low, high, step, lambda q: float(q[i]), write)


def _angle(label: str, joint: Any, i: int, axis: int) -> Dial:
    name = ("roll", "pitch", "yaw")[axis]
    reach = np.pi / 2 if axis == 1 else np.pi

    def rpy(q: Floats) -> Floats:
        return np.asarray(matrix_to_rpy(quat_xyzw_to_matrix(q[i : i + 4])), dtype=float)

    def write(q: Floats, value: float) -> Floats:
        q, angles = q.copy(), rpy(q)
        angles[axis] = value
        q[i : i + 4] = SE3.from_rpy(angles).quat_xyzw()
        return q

    hint = f"{joint.name} ({joint.kind.describe()}), {name} of its rotation"
    return Dial(f"{label} {name} [rad]", hint, -reach, reach, 0.001, lambda q: float(rpy(q)[axis]), write)


def _short(name: str, names: tuple[str, ...]) -> str:
    """A joint's name without what all joints' names begin with."""
    if len(names) < 2:
        return name
    first, last = min(names), max(names)
    common = 0
    while common < min(len(first), len(last)) and first[common] == last[common]:
        common += 1
    cut = name.rfind("_", 0, common) + 1  # whole words only
    return name[cut:] or name


def _pose_text(frame: str, T: Floats) -> str:
    x, y, z = T[:3, 3]
    degrees = np.round(np.rad2deg(np.asarray(matrix_to_rpy(T[:3, :3]), dtype=float)), 1)
    roll, pitch, yaw = np.where(degrees == -180.0, 180.0, degrees + 0.0)
    return (
        f"`{frame}`\n\n| | | |\n|---|---|---|\n"
        f"| **x** {x:.3f} m | **y** {y:.3f} m | **z** {z:.3f} m |\n"
        f"| **roll** {roll:.1f}° | **pitch** {pitch:.1f}° | **yaw** {yaw:.1f}° |\n"
    )
