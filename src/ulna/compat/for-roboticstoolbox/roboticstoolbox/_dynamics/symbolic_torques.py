"""The torques of a motion by recursion over the links, for symbols in the motion or in the parameters of links.

| symbol | meaning | unit |
|---|---|---|
| w, wd | angular velocity and acceleration of a link, in its axes | [rad/s], [rad/s^2] |
| a | acceleration of its frame less that of free fall, in its axes | [m/s^2] |
| z, d | axis of the joint, and the way from the joint to the frame of the link, in its axes | [1], [m] |
| b, s | way from the frame before to the joint, and to the frame of the link | [m] |
| F, N | force and moment that move the link | [N], [N m] |

Source: Luh, Walker & Paul 1980, On-line computational scheme for mechanical manipulators.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from roboticstoolbox._common.symbols import has_symbols
from ulna.typing import Floats


def symbolic_torques(links: Sequence[Any], base: Floats, gravity: Any, q: Any, qd: Any, qdd: Any) -> Floats:
    """Torques (n,) of a serial arm, motors and viscous friction included.

    Args:
        links: Links along the arm, a joint each.
        base: T_world_base, (4, 4).
        gravity: Acceleration of free fall in the world, (3,) [m/s^2].
        q: Configuration, (n,), of symbols or numbers.
        qd: Velocity, (n,).
        qdd: Acceleration, (n,).

    Returns:
        Torques (n,) [N m or N].
    """
    w = wd = np.zeros(3, dtype=object)
    a = base[:3, :3].T @ -np.asarray(gravity, dtype=object)
    steps = []
    for link, x, v, rate in zip(links, q, qd, qdd, strict=True):
        R, z, b, d, s = _joint_geometry(link, x)
        w, wd, a = R.T @ w, R.T @ wd, R.T @ a
        if link.isrevolute:
            a = a + np.cross(wd, b) + np.cross(w, np.cross(w, b))
            wd = wd + z * rate + np.cross(w, z * v)
            w = w + z * v
            a = a + np.cross(wd, d) + np.cross(w, np.cross(w, d))
        else:
            a = a + np.cross(wd, s) + np.cross(w, np.cross(w, s)) + 2 * np.cross(w, z * v) + z * rate
        r, I = link.r, link.I
        F = link.m * (a + np.cross(wd, r) + np.cross(w, np.cross(w, r)))
        N = I @ wd + np.cross(w, I @ w)
        steps.append((R, z, d, s, F, N + np.cross(r, F)))
    return _backward(links, steps, qd, qdd)


def _joint_geometry(link: Any, x: Any) -> tuple[Floats, ...]:
    """R of the link in the one before, and z, b, d, s in the link's axes."""
    before, after, T = np.eye(4), np.eye(4), np.eye(4)
    joint: Any = None
    for et in link.ets:
        A = et.A(x) if et.isjoint else et.A()
        T = T @ A
        if et.isjoint:
            joint = et
        elif joint is None:
            before = before @ A
        else:
            after = after @ A
    assert joint is not None, "every link has a joint"
    R = T[:3, :3]
    axis = np.eye(3, dtype=int)["xyz".index(joint.ax)] * (-1 if joint.isflip else 1)
    z, d = after[:3, :3].T @ axis, after[:3, :3].T @ after[:3, 3]
    return R, z, R.T @ before[:3, 3], d, R.T @ T[:3, 3]


def _backward(links: Sequence[Any], steps: list[Any], qd: Any, qdd: Any) -> Floats:
    f, n, tau = np.zeros(3, dtype=object), np.zeros(3, dtype=object), []
    for link, (R, z, d, s, F, N), v, rate in zip(
        reversed(links), reversed(steps), qd[::-1], qdd[::-1], strict=True
    ):
        f, n = F + f, N + n
        load = z @ (n + np.cross(d, f)) if link.isrevolute else z @ f
        tau.append(load + link.G**2 * link.Jm * rate - link.friction(v, coulomb=not has_symbols(qd)))
        n = R @ (n + np.cross(s, f))
        f = R @ f
    return np.array(tau[::-1], dtype=object)
