"""From a path of poses to a path of joints, through an inverse kinematics that the caller chooses."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ulna.checks.values import number, short_repr
from ulna.errors import InputError, NonFiniteError
from ulna.trajectory.inputs import vector
from ulna.trajectory.polynomial import Polynomial
from ulna.trajectory.space import Poses
from ulna.trajectory.trajectory import Trajectory
from ulna.trajectory.waypoints import cubic_spline
from ulna.typing import ArrayLike, Floats


def follow(
    trajectory: Trajectory,
    ik: Callable[[Any, Any], Any],
    q0: ArrayLike,
    samples: int = 100,
    jump: float = 0.5,
) -> Polynomial:
    """The joint trajectory that makes a frame follow a trajectory of poses, for joints that are plain numbers.

    Inverse kinematics is asked at even times, each from the last answer; a cubic spline joins the answers, at
    rest where the trajectory is at rest. Between the samples the frame leaves its path by an error of fourth
    order in their distance.

    Args:
        trajectory: Poses of the frame over time.
        ik: Called as `ik(T, q)`, with the goal T_world_frame (4, 4) and a guess (n,); returns a configuration
            (n,), or a result with `.q` and `.success`, such as `lambda T, q: robot.ik(T, q0=q)` returns.
        q0: Guess for the first pose, (n,) [rad or m].
        samples: How many segments.
        jump: By how much a joint may change from one sample to the next before it counts as a jump to another branch
            [rad or m]; inf for any.

    Returns:
        The joint trajectory.

    Raises:
        InputError: `trajectory` is none of poses; inverse kinematics fails, or jumps to another branch; names the time.
            Or `samples` or `jump` is no such number.

    Example:
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> T = ulna.SE3(robot.fk(q))
        >>> line = ulna.trajectory.pose_line(T, ulna.SE3(0.0, 0.1, 0.0) @ T, duration=1.0)  # 10 cm to the left
        >>> move = ulna.trajectory.follow(line, lambda T, q: robot.ik(T, q0=q), q)
        >>> (robot.fk(move(1.0))[:3, 3] - T.translation).round(4)
        array([-0. ,  0.1, -0. ])
    """
    _check(trajectory, samples)
    if not (isinstance(jump, float) and jump == np.inf):
        jump = number("jump", jump, "a change above 0 [rad or m]", above=0.0)
    t, T, V, _ = trajectory.sample(n=int(samples) + 1)
    q, configurations = vector("q0", q0), []
    for time, goal in zip(t, T, strict=True):
        new = _solved(ik, goal, q, f"{time:.6g} s of {t[-1]:.6g} s")
        step = np.abs(new - q)
        if configurations and step.max() > jump:
            k = int(np.argmax(step))
            raise InputError(
                f"Inverse kinematics jumps at {time:.6g} s: joint {k} by {step[k]:.4g}, more than jump={jump:g}. "
                "Pass a nearer guess, take more samples, or look for a singular point on the path."
            )
        configurations.append(new)
        q = new
    rows = np.array(configurations)
    start = None if not V[0].any() else _slope(rows[:4], t[:4])
    end = None if np.abs(V[-1]).max() < 1e-9 else _slope(rows[:-5:-1], t[:-5:-1])
    spline = cubic_spline(rows, times=t, v0=start, v1=end)
    return Polynomial(spline.times, spline.coefficients, spline.space, "followed path")


def _check(trajectory: Any, samples: Any) -> None:
    if not isinstance(trajectory, Trajectory):
        raise InputError(
            f"`trajectory` is {short_repr(trajectory)}; expected one of poses, such as pose_line(...)."
        )
    if not isinstance(trajectory.space, Poses):
        raise InputError("`trajectory` moves joints already; expected one of poses, such as pose_line(...).")
    if not isinstance(samples, (int, np.integer)) or samples < 3:
        raise InputError(f"`samples` is {samples!r}; expected a count of at least 3.")


def _solved(ik: Callable[[Any, Any], Any], goal: Floats, q: Floats, time: str) -> Floats:
    """The configuration (n,) that inverse kinematics finds for a goal from q; errors name the time."""
    answer = ik(goal, q)
    if not bool(getattr(answer, "success", True)):
        raise InputError(f"Inverse kinematics fails at {time}, at {goal[:3, 3].round(4)} m.")
    try:
        return vector("q", getattr(answer, "q", answer), q.size)
    except NonFiniteError:
        raise InputError(f"Inverse kinematics returns nan at {time}.") from None


def _slope(q: Any, t: Any) -> Any:
    """Velocity at the first of four even samples, of third order."""
    return (-11.0 * q[0] + 18.0 * q[1] - 9.0 * q[2] + 2.0 * q[3]) / (6.0 * (t[1] - t[0]))
