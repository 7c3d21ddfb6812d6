"""Continuous check of a joint-space segment by conservative advancement: no contact on the way is missed.

| symbol | meaning | shape | unit |
|---|---|---|---|
| t | time on the segment, q(t) = integrate(q0, t v) | () | 0 to 1 |
| V_k | twist of step k in its moving frame, constant on the segment | Motion | [m, rad] |
| l_k | longest way from the origin of step k's frame to that of the next, on the segment | () | [m] |
| R_k | longest way from the origin of step k to any point of the solid | () | [m] |
| mu | bound of the speed of two solids towards each other | () | [m] |
| d | distance of the two at t; they cannot touch before t + d / mu | () | [m] |

mu is the sum of abs(V_k linear) + abs(V_k angular) R_k over the steps that carry one of the two and not the other.
Source: Mirtich, Impulse-based dynamic simulation of rigid body systems (1996), chapter 2; Schwarzer, Saha and Latombe,
Adaptive dynamic collision checking, IEEE Transactions on Robotics 21 (2005), for the bounds of motion.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ulna import algorithms, kernels
from ulna.algorithms.multibody.tree import steps
from ulna.collision.exact import Checker
from ulna.collision.solids import Solid
from ulna.errors import InputError
from ulna.lazy import is_deferred
from ulna.model import Model
from ulna.typing import ArrayLike, Floats

NEAR = 1e-4
"""How near two solids are when advancement stops and calls it contact [m]."""

_MAX_LENGTH = 1e5
"""A motion beyond this would take hours to check [m]."""

_SOON, _STRIDE = 0.01, 0.1
"""Pairs that are safe for less than the first are looked at; where boxes alone keep them safe for less than the
second, they are asked for their real distance."""


def first_contact(
    checker: Checker,
    q0: ArrayLike,
    q1: ArrayLike,
    margin: float = 0.0,
    moving: Mapping[str, ArrayLike] | None = None,
) -> Any:
    """When a motion from `q0` to `q1` at constant velocity first comes as near as `margin`; inf where it never does.

    Continuous joints take the shorter way, as in `robot.difference(q0, q1)`. "Near" is within `NEAR` above the margin,
    so that a time is never late and a contact never missed; a motion that passes by within a tenth of a millimetre
    counts as one that touches.

    Args:
        checker: The robot and its world.
        q0: Configurations, (..., nq) [rad or m].
        q1: Configurations, (..., nq) [rad or m].
        margin: Not below 0 [m].
        moving: Where moving obstacles stand meanwhile, by name, T_world_shape (4, 4).

    Returns:
        Times in [0, 1], or inf, (...).

    Raises:
        ShapeError, DtypeError, NonFiniteError: If `q0` or `q1` cannot be configurations.
        InputError: If `margin` is negative, the checker is none of `coal`, or the motion is absurdly long.

    Example:
        >>> from ulna.collision import Checker, World, first_contact
        >>> from ulna.geometry import Sphere
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> checker = Checker(robot, World().add("ball", Sphere(0.1), (0.0, 0.3, 0.5)))
        >>> round(float(first_contact(checker, q, q + [np.pi / 2, 0, 0, 0, 0, 0, 0])), 2)  # after this part of the way
        0.57
    """
    if not isinstance(checker, Checker):
        raise InputError(
            f"first_contact uses coal; expected a Checker, but {type(checker).__name__} was given."
        )
    if not (np.isfinite(margin) and margin >= 0.0):
        raise InputError(f"`margin` is {margin!r}; expected a finite length, not below 0 [m].")
    if is_deferred(q0) or is_deferred(q1):
        raise InputError("`q0` or `q1` is lazy; first contacts are found of NumPy arrays: pass q0.compute().")
    model = checker.model
    v = kernels.kernel(model, "difference", checked=True)(q0, q1)
    start = np.broadcast_to(np.asarray(q0, dtype=float), (*v.shape[:-1], model.nq))
    rows = zip(start.reshape(-1, model.nq), v.reshape(-1, model.nv), strict=True)
    with checker.lock:
        times = np.array([_advance(checker, q, step, float(margin), moving) for q, step in rows])
    return times.reshape(v.shape[:-1])[()]


def first_contact_along(
    checker: Checker, q0: Floats, change: Floats, margin: float, should_stop: Callable[[], bool]
) -> float:
    """As `first_contact`, of one motion along a given change: whole turns of continuous joints count, too.

    Args:
        checker: The robot and its world.
        q0: Where it begins, shape (nq,) [rad or m].
        change: By how much coordinates of the tangent space change, shape (nv,) [rad or m].
        margin: Not below 0 [m].
        should_stop: Asked at each step, whether to give up.

    Returns:
        The time in [0, 1], or inf; where it gave up the time up to which nothing is touched.

    Raises:
        InputError: If the motion is absurdly long.
    """
    with checker.lock:
        return _advance(checker, q0, change, margin, None, should_stop)


def _never() -> bool:
    return False


def _advance(
    checker: Checker,
    q0: Floats,
    v: Floats,
    margin: float,
    moving: Mapping[str, ArrayLike] | None,
    should_stop: Callable[[], bool] = _never,
) -> float:
    """Each pair is safe until some time; the least of them is where all is looked at again."""
    model = checker.model
    speed = _speeds(model, checker.solids, q0, v)[: len(checker.mask)]
    longest = float(speed[checker.mask].max(initial=0.0))
    if longest > _MAX_LENGTH:
        raise InputError(
            f"From q0 to q1 the robot moves up to {longest:.3g} m; expected at most {_MAX_LENGTH:g} m. "
            "Check the units."
        )
    safe = np.zeros(speed.shape)
    safe[~checker.mask] = np.inf
    with np.errstate(divide="ignore", invalid="ignore"):
        while (t := float(safe.min(initial=np.inf))) <= 1.0:
            if should_stop():
                return t
            solids = checker.posed(algorithms.integrate(model, q0, t * v), moving)
            due = safe <= t + _SOON
            ahead = np.where(solids.bounds > margin, (solids.bounds - margin) / speed, 0.0)
            safe = np.maximum(safe, t + ahead)
            # a distance here takes far less time than the bounds of all pairs at another step
            for i, j in np.argwhere(due & (safe < t + _STRIDE)).tolist():
                d = solids.distance(i, j) - margin
                if d <= NEAR:
                    return t
                step = (d - NEAR / 10.0) / speed[i, j] if speed[i, j] > 0.0 else np.inf
                safe[i, j] = max(safe[i, j], t + step)
    return np.inf


def _speeds(model: Model, solids: tuple[Solid, ...], q0: Floats, v: Floats) -> Floats:
    """mu of every two solids, (n, n)."""
    tree = steps(model)
    twists = [step.motion(v) for step in tree]
    turning = np.array([float(np.linalg.norm(V.angular)) for V in twists])
    sliding = np.array([float(np.linalg.norm(V.linear)) for V in twists])
    # how far a step's own motion carries its moving frame from its fixed one, anywhere on the segment
    travel = [
        float(np.linalg.norm(step.transform(q0).translation)) + slide
        for step, slide in zip(tree, sliding, strict=True)
    ]
    last = {id(step.joint): k for k, step in enumerate(tree) if step.is_last}
    speeds = np.zeros((len(solids), len(tree)))
    for n, solid in enumerate(solids):
        if solid.joint < 0:
            continue
        reach = float(np.linalg.norm(solid.placement @ solid.bounds[0])) + solid.radius
        k = last[id(model.joints[solid.joint])]
        while k >= 0:
            speeds[n, k] = sliding[k] + turning[k] * reach
            reach += travel[k] + float(np.linalg.norm(tree[k].placement.translation))
            k = tree[k].parent
    on = speeds > 0.0
    apart = np.zeros((len(solids), len(solids)))
    for k in range(len(tree)):  # a step that carries both moves neither towards the other
        carries = on[:, k]
        differ = carries[:, None] != carries[None, :]
        apart += np.where(differ, speeds[:, None, k] + speeds[None, :, k], 0.0)
    return apart
