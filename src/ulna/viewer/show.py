"""A robot in the browser with a slider for each joint, its tool's pose, and a target to drag."""

from __future__ import annotations

import os
import sys
import threading
import time
from typing import Any

import numpy as np

from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.ik import damped_step
from ulna.spatial import matrix_to_rpy
from ulna.typing import ArrayLike, Floats
from ulna.viewer.camera import Camera
from ulna.viewer.controls import Control, Gizmo
from ulna.viewer.page import Page
from ulna.viewer.scene import Scene
from ulna.viewer.screen import open_browser, somebody_can_look

_STEPS = 6  # of inverse kinematics in a tick: enough to follow a hand, a fraction of the time there is
_GLIDE = 0.6  # how long a move to a named configuration takes [s]


def show(
    robot: Any,
    q: ArrayLike | str | None = None,
    *,
    port: int = 8080,
    host: str = "127.0.0.1",
    browser: bool = True,
    scene: Scene | None = None,
    camera: Camera | None = None,
) -> Show:
    """Open a page that shows a robot, with sliders and a target to drag, and return at once.

    Args:
        robot: An `ulna.Robot`.
        q: Its configuration: an array (nq,), the name of one of `robot.configurations`, or None for the
            first of these ("qr" where there is one).
        port: Port of the page; the next free one is taken when it is in use, 0 takes any.
        host: Address to listen on. Beyond the loopback anyone who can reach it can look and drag.
        browser: Whether to open a browser window, where there is a screen.
        scene: A scene to show the robot in, with other things; an empty one when not given.
        camera: Where it is looked at from at first; from the front right when not given.

    Raises:
        MissingExtra: The package viser is not installed.
        ShapeError, NonFiniteError, UnknownName: `q` is not a configuration of the robot.
    """
    if not hasattr(robot, "link_poses"):
        raise InputError(f"`robot` is {robot!r}; expected a Robot, such as ulna.load(...) gives.")
    start = configuration(robot, q)
    out = Show(robot, start, scene if scene is not None else Scene(), port, host, camera)
    if browser:
        open_browser(out.url)
    return out


def configuration(robot: Any, q: ArrayLike | str | None) -> Floats:
    """A configuration (nq,) from an array, a name of `robot.configurations`, or None for the usual one.

    Raises:
        UnknownName: The robot has no configuration of that name.
        ShapeError, NonFiniteError: The array does not fit.
    """
    named = dict(robot.configurations)
    if q is None:
        usual = next((named[n] for n in ("qr", "ready", "home", *named) if n in named), None)
        return np.array(robot.model.neutral if usual is None else usual, dtype=float)
    if isinstance(q, str):
        if q not in named:
            raise UnknownName("configuration", q, named)
        return np.array(named[q], dtype=float)
    out = np.array(q, dtype=float)
    if out.shape != (robot.model.nq,):
        names = ", ".join(robot.joint_names[:8])
        raise ShapeError("q", out.shape, f"({robot.model.nq},)", f"One number for each of: {names}.")
    if not np.isfinite(out).all():
        where = int(np.argwhere(~np.isfinite(out))[0][0])
        raise NonFiniteError("q", (where,), float(out[where]))
    return out


class Show:
    """A robot in a page. `q` is where it stands; setting it moves the robot, the sliders and the target."""

    def __init__(
        self, robot: Any, q: Floats, scene: Scene, port: int, host: str, camera: Camera | None
    ) -> None:
        self.robot, self.scene = robot, scene
        self._q = np.array(q, dtype=float)
        self._lock = threading.RLock()
        self._goal: Floats | None = None  # where the tool shall go, while it is on its way
        self._glide: tuple[float, Floats, Floats] | None = None
        self._told = np.full_like(self._q, np.nan)
        self._told_at = 0.0
        self._in_scene = scene.add_robot(robot, self._q)
        try:
            self.page = Page(scene, title=robot.name, port=port, host=host, camera=camera)
        except BaseException:
            self._in_scene.remove()
            raise
        self._sliders: dict[int, Control] = {}
        self._build_panel()
        self.page.each_tick(self._tick)

    @property
    def url(self) -> str:
        """The address of the page."""
        return self.page.url

    @property
    def q(self) -> Floats:
        """The configuration, shape (nq,)."""
        with self._lock:
            return self._q.copy()

    @q.setter
    def q(self, q: ArrayLike | str) -> None:
        with self._lock:
            self._goal = self._glide = None
            self._move(configuration(self.robot, q))

    @property
    def tool(self) -> Floats:
        """Where the tool is, T_world_tool, shape (4, 4)."""
        return np.asarray(self.robot.fk(self.q))

    def aim(self, T_goal: ArrayLike) -> None:
        """Move the target, as dragging it does: the tool follows as far as the joints allow."""
        goal = np.array(T_goal, dtype=float)
        if goal.shape != (4, 4):
            raise ShapeError("T_goal", goal.shape, "(4, 4), a pose in the world")
        if not np.isfinite(goal).all():
            raise InputError("`T_goal` holds nan or inf; expected a pose.")
        with self._lock:
            self._glide, self._goal = None, goal
            self._gizmo.pose = goal

    def hold(self) -> None:
        """Keep the page open until Ctrl-C, until `close`, or until the last tab that looked at it is closed.

        Where nobody can look (no screen, no terminal) it says so and returns at once.
        """
        hold(self.page)

    def close(self) -> None:
        """Close the page."""
        self.page.close()

    def __enter__(self) -> Show:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str:
        return self.page._repr_html_()

    def __repr__(self) -> str:
        return f"<page of {self.robot.name!r} at {self.url}>"

    # the panel ----------------------------------------------------------------------------------------------

    def _build_panel(self) -> None:
        model, page = self.robot.model, self.page
        named = tuple(self.robot.configurations)
        with page.folder("Tool"):
            self._readout = page.text("")
        with page.folder("Joints"):
            for joint in model.joints:
                if joint.mimic is None and joint.kind.nq == 1:
                    self._sliders[joint.idx_q] = self._slider(joint)
            if not self._sliders:
                page.text("No joint of this robot moves along one coordinate.")
        if named:
            page.buttons("Go to", named, lambda name: self._glide_to(self.robot.configurations[name]))
        self._gizmo: Gizmo = page.gizmo("target", self.tool, self._dragged, size=self._gizmo_size())

    def _slider(self, joint: Any) -> Control:
        model, i = self.robot.model, joint.idx_q
        symbol, turning = joint.kind.symbol, joint.kind.symbol != "P"
        unit, free = ("rad", np.pi) if turning else ("m", 1.0)
        low, high = float(model.lower_position[i]), float(model.upper_position[i])
        bounded = np.isfinite(low) and np.isfinite(high)
        low, high = (low if np.isfinite(low) else -free), (high if np.isfinite(high) else free)
        if turning and bounded:
            span = f"{np.rad2deg(low):.0f}° to {np.rad2deg(high):.0f}°"
        else:
            span = f"{low:.3g} to {high:.3g} {unit}" if bounded else "no limits"
        step = 0.001 if high - low > 0.2 else max((high - low) / 500, 1e-6)
        if high - low < 1e-9:
            high = low + 1e-6

        def moved(value: float) -> None:
            with self._lock:
                self._goal = self._glide = None
                q = self._q.copy()
                # the slider's steps do not end on the limits; the robot's numbers do
                q[i] = np.clip(value, model.lower_position[i], model.upper_position[i])
                self._move(q)

        label = f"{_short(joint.name, self.robot.joint_names)} [{unit}]"
        hint = f"{joint.name} ({symbol}), {span}"
        return self.page.slider(label, low, high, round(float(self._q[i]), 3), moved, step=step, hint=hint)

    def _gizmo_size(self) -> float:
        points = self.scene.points(2000)
        extent = float(np.ptp(points, axis=0).max()) if len(points) else 1.0
        return float(np.clip(0.2 * extent, 0.05, 0.4))

    # what happens on the thread of the page -----------------------------------------------------------------

    def _dragged(self, event: tuple[Floats, str]) -> None:
        pose, _ = event
        with self._lock:
            self._glide, self._goal = None, pose

    def _glide_to(self, q: Floats) -> None:
        with self._lock:
            self._goal, self._glide = None, (time.monotonic(), self._q.copy(), np.array(q, dtype=float))

    def _tick(self) -> None:
        with self._lock:
            if self._goal is not None:
                self._follow(self._goal)
            elif self._glide is not None:
                began, start, end = self._glide
                t = min((time.monotonic() - began) / _GLIDE, 1.0)
                share = t * t * t * (10 + t * (6 * t - 15))
                self._move(start + share * (end - start) if t < 1 else end)
                if t >= 1:
                    self._glide = None
            self._tell()

    def _follow(self, goal: Floats) -> None:
        q = self._q
        for _ in range(_STEPS):
            step = damped_step(self.robot, q, goal)
            still = float(np.abs(step.q - q).max(initial=0.0)) < 1e-7
            q = step.q
            if still:
                if not self._gizmo.held:  # arrived, or as near as can be: the target returns to the tool
                    self._goal = None
                    self._told.fill(np.nan)
                break
        self._move(q)

    def _move(self, q: Floats) -> None:
        self._q = q
        self._in_scene.move(q)

    def _tell(self) -> None:
        """Sliders, the tool's pose and the target follow the robot, 15 times a second, at rest once more."""
        now = time.monotonic()
        if np.array_equal(self._told, self._q) or now - self._told_at < 1 / 15:
            return
        self._told, self._told_at = self._q.copy(), now
        for i, slider in self._sliders.items():
            slider.value = round(float(self._q[i]), 3)
        T = self.tool
        self._readout.value = _pose_text(self.robot.tool, T)
        if self._goal is None and not self._gizmo.held:
            self._gizmo.pose = T


def hold(page: Page) -> None:
    """Keep a page open until Ctrl-C, until it is closed, or until the last tab that looked at it has gone."""
    if page.closed:
        return
    if page.clients == 0 and not somebody_can_look():
        print(f"Nobody can look at {page.url} (no screen here), so it is not held open.", flush=True)
        return
    print(f"Look at {page.url}. Ctrl-C ends it.", flush=True)
    if "SSH_CONNECTION" in os.environ:
        print(
            f"From elsewhere: ssh -L {page.port}:localhost:{page.port} ... and open the same address there."
        )
    seen, gone = page.visited, 0.0
    try:
        while not page.closed:
            time.sleep(0.1)
            if page.clients:
                seen, gone = True, 0.0
            elif seen:
                gone += 0.1
                if gone > 3.0:  # longer than a reload takes
                    print("The page was closed.", flush=True)
                    return
    except KeyboardInterrupt:
        print("", file=sys.stderr)
    finally:
        page.close()


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
