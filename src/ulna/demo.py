"""First motion: a Panda servos its tool to a goal, in the browser or, without a screen, into a picture."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ulna.control import p_servo
from ulna.errors import MissingExtra
from ulna.linalg import pseudoinverse
from ulna.robot import compile
from ulna.sim import Recording, kinematic_step
from ulna.spatial import SE3, matrix_to_rpy, so3_log
from ulna.typing import Floats

if TYPE_CHECKING:
    from ulna.viewer.graph.camera import Camera
    from ulna.viewer.scene import Scene

GAIN, THRESHOLD, DT = 1.0, 0.01, 0.01
_BROWSER_TIMEOUT = 15.0  # s for the browser
_MAX_MOTION_TIME = 60.0  # simulated seconds after which a goal counts as out of reach
_GHOST = (0.36, 0.47, 0.64, 0.26)
_PIECE = 15  # steps
_TRACE = (0.95, 0.45, 0.10, 1.0)


@dataclass(frozen=True, eq=False)
class Servoing:
    """What came of servoing a robot to a goal.

    Args:
        goal: T_world_goal, shape (4, 4).
        recording: Times, configurations ("q"), velocities ("v") and tool poses ("T"), one row a step; a
            step's row holds what it led to.
        arrived: Whether the goal was reached.
        error: What is left over, as `p_servo` measures it: sum of absolute errors [m and rad].
        seconds_a_step: How long computing a step took, on average and without compilation [s].
    """

    goal: Floats
    recording: Recording
    arrived: bool
    error: float
    seconds_a_step: float

    @property
    def steps(self) -> int:
        """How many steps it took."""
        return len(self.recording)

    @property
    def q(self) -> Floats:
        """The configuration at the end, shape (nq,)."""
        return self.recording.q[-1]


def servo(
    robot: Any,
    q: Floats,
    goal: Floats,
    *,
    gain: float = GAIN,
    threshold: float = THRESHOLD,
    dt: float = DT,
    each_step: Callable[[float, Floats], bool | None] | None = None,
) -> Servoing:
    """Servo a robot's tool to a goal: resolved-rate motion in the tool's own axes.

    In each step the error, as `p_servo` sees it, gives a twist, the pseudoinverse of the Jacobian turns it
    into joint velocities, and the robot moves at these for `dt`.

    Args:
        robot: An `ulna.Robot`.
        q: Configuration at the start, shape (nq,) [rad, m].
        goal: Goal of the tool, T_world_goal, shape (4, 4) [m].
        gain: Gain of the servo [1/s].
        threshold: The goal counts as reached below this sum of absolute errors [m and rad].
        dt: Duration of a step [s].
        each_step: Called with the time and the configuration after each step; it may return False to stop.

    Returns:
        Whether and how the goal was reached, with a recording of the motion.
    """
    recording, joint_velocity = Recording(), _resolved_rates(robot)
    _step(
        robot, joint_velocity, q, goal, gain, threshold, dt
    )  # compiles or loads the kernels, which is not counted
    arrived, spent = False, 0.0
    while not arrived and len(recording) * dt < _MAX_MOTION_TIME:
        began = time.perf_counter()
        q, velocity, arrived = _step(robot, joint_velocity, q, goal, gain, threshold, dt)
        spent += time.perf_counter() - began
        recording.add((len(recording) + 1) * dt, q, v=velocity, T=robot.fk(q))
        if each_step is not None and each_step(recording.t[-1], q) is False:
            break
    error = float(np.abs(p_servo(robot.fk(q), goal)[0]).sum())
    return Servoing(goal, recording, arrived, error, spent / max(len(recording), 1))


def _resolved_rates(robot: Any) -> Any:
    """The kernel of the joint velocities [rad/s, m/s] that move the tool with a twist in its axes."""

    def joint_velocity(q: Floats, twist: Floats) -> Floats:
        inverse, _ = pseudoinverse(robot.jacobian(q, None, "local"))
        return inverse @ twist

    return compile(joint_velocity, robot, twist=(6,))


def _step(
    robot: Any, joint_velocity: Any, q: Floats, goal: Floats, gain: float, threshold: float, dt: float
) -> tuple[Floats, Floats, bool]:
    """The configuration after a step, the velocity [rad/s, m/s], and whether the goal was reached before it."""
    v, arrived = p_servo(robot.fk(q), goal, gain, threshold)
    velocity = joint_velocity(q, v)
    return kinematic_step(robot, q, velocity, dt), velocity, arrived


def demo(
    headless: bool | None = None,
    output: str | None = None,
    port: int | None = None,
    size: tuple[int, int] = (1600, 1000),
) -> Servoing:
    """Show the Panda servoing to a goal.

    With a screen a page opens, the motion runs in real time, and the page stays open at the end for sliders
    and dragging. Without a screen, at a terminal, the page waits until somebody opens its address, such as through
    SSH. Without a screen the motion runs at once, its result is printed and a picture of it is written.

    Args:
        headless: Whether to do without a page; None decides by whether there is a screen or a terminal.
        output: File of the picture. Without a screen "ulna-demo.png" when not given; with one, none.
        port: Port of the page; None for that of `ULNA_PORT`, or 8080.
        size: Width and height of the picture [pixels].

    Returns:
        The result of `servo`.
    """
    from ulna.loading import load
    from ulna.viewer.page.browser import somebody_can_look
    from ulna.viewer.scene import Scene

    robot = load("panda")
    start = np.array(robot.configurations["qr"], dtype=float)
    goal = np.asarray(robot.fk(start)) @ np.asarray(SE3.trans(0.2, 0.2, 0.35).matrix(), dtype=float)
    headless = not somebody_can_look() if headless is None else headless
    if headless:
        result = servo(robot, start, goal)
        print(report(robot, result))
        _picture(robot, start, result, output or "ulna-demo.png", size)
        return result
    scene = Scene()
    _set_up(scene, robot, start, goal)
    try:
        from ulna.viewer.show import show

        page = show(robot, start, port=port, scene=scene, camera=_view(scene, 1.6, 0.06))
    except MissingExtra as error:
        print(f"{error} Going on without a page.")
        return demo(True, output, port, size)
    try:
        if not _wait_for_browser(page):
            return servo(robot, start, goal)
        result = _perform(robot, start, goal, page)
        print(report(robot, result))
        if output is not None:
            _picture(robot, start, result, output, size)
        page.hold()
    finally:
        page.close()
    return result


def report(robot: Any, result: Servoing) -> str:
    """The result in a few lines of text.

    Args:
        robot: The `ulna.Robot` that moved.
        result: What `servo` returned.

    Returns:
        The text.
    """
    T = np.asarray(robot.fk(result.q))
    millimetres = 1e3 * float(np.linalg.norm(T[:3, 3] - result.goal[:3, 3]))
    degrees = float(np.rad2deg(np.linalg.norm(so3_log(T[:3, :3].T @ result.goal[:3, :3]))))
    fastest = float(np.abs(result.recording["v"]).max())
    word = "reached" if result.arrived else "NOT reached"
    rows = (
        ("robot", f"{robot.name}, {len(robot.joint_names)} joints, tool {robot.tool}"),
        ("goal", _pose(result.goal)),
        ("tool", _pose(T)),
        ("outcome", f"{word} after {result.steps} steps of {DT:g} s: {result.steps * DT:.2f} s of motion"),
        (
            "left over",
            f"{millimetres:.2f} mm, {degrees:.2f} deg (the sum of errors fell below {THRESHOLD:g})",
        ),
        ("q", "[" + ", ".join(f"{x:.4f}" for x in result.q) + "] rad"),
        ("fastest", f"{fastest:.3f} rad/s"),
        (
            "cost",
            f"{1e6 * result.seconds_a_step:.0f} us a step, after compilation (kinematics, Jacobian, pseudoinverse)",
        ),
    )
    return "\n".join(f"  {name:<10} {text}" for name, text in rows)


def _perform(robot: Any, start: Floats, goal: Floats, page: Any) -> Servoing:
    """The motion in real time, with the trace of the tool growing behind it."""
    began = time.perf_counter()
    points, count = [np.asarray(robot.fk(start))[:3, 3]], itertools.count(1)

    def trace() -> None:  # in pieces: one that grows would be loaded, and flicker, again and again
        page.scene.add_path(f"trace/{next(count)}", points, _TRACE)
        del points[:-1]

    def each_step(t: float, q: Floats) -> bool:
        page.q = q
        points.append(np.asarray(robot.fk(q))[:3, 3])
        if len(points) > _PIECE:
            trace()
        time.sleep(max(0.0, began + t - time.perf_counter()))
        return not page.page.closed

    result = servo(robot, start, goal, each_step=each_step)
    trace()
    return result


def _wait_for_browser(page: Any) -> bool:
    """Waits until a browser shows the page, so that the motion is seen from its beginning.

    Returns:
        False where Ctrl-C ended it before.
    """
    from ulna.viewer.page.browser import has_screen
    from ulna.viewer.page.keep_open import print_address

    print_address(page.page)
    opened = has_screen()
    if not opened:
        print(
            "The motion begins when a browser shows the page. `ulna demo --headless` writes a picture instead."
        )
    due = time.monotonic() + (_BROWSER_TIMEOUT if opened else np.inf)
    try:
        while page.page.clients == 0 and time.monotonic() < due:
            time.sleep(0.05)
        time.sleep(1.5 if page.page.clients else 0.0)
    except KeyboardInterrupt:
        print()
        return False
    return True


def _set_up(scene: Scene, robot: Any, start: Floats, goal: Floats) -> None:
    scene.add_axes("goal", goal, 0.12)
    scene.add_robot(robot, start, name="start", rgba=_GHOST)


def _picture(robot: Any, start: Floats, result: Servoing, output: str, size: tuple[int, int]) -> Path:
    """The start as a ghost, the path of the tool, the goal and the robot at the end, into a PNG file."""
    from ulna.viewer.render.renderer import render, write_png
    from ulna.viewer.scene import Scene

    scene = Scene()
    _set_up(scene, robot, start, result.goal)
    scene.add_robot(robot, result.q)
    path_of_tool = np.concatenate([np.asarray(robot.fk(start))[None, :3, 3], result.recording["T"][:, :3, 3]])
    scene.add_path("trace", path_of_tool, _TRACE)
    path = write_png(output, render(scene, *size, camera=_view(scene, 1.25)))
    print(f"  {'picture':<10} {path}")
    return path


def _view(scene: Scene, margin: float, aside: float = 0.0) -> Camera:
    """From the side to which the path of the tool is open."""
    from ulna.viewer.graph.camera import camera_for

    return camera_for(scene, direction=(1.1, 2.0, 0.8), margin=margin, aside=aside)


def _pose(T: Floats) -> str:
    x, y, z = T[:3, 3]
    degrees = np.round(np.rad2deg(np.asarray(matrix_to_rpy(T[:3, :3]), dtype=float)), 1)
    roll, pitch, yaw = np.where(degrees == -180.0, 180.0, degrees + 0.0)
    return f"x {x:.4f}  y {y:.4f}  z {z:.4f} m, roll {roll:.1f}  pitch {pitch:.1f}  yaw {yaw:.1f} deg"
