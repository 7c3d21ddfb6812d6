"""The wrench that the base of an arm exerts on it, from the rate of its momentum.

| symbol | meaning | unit |
|---|---|---|
| c, p, L | centre of mass, linear momentum, angular momentum about c | [m], [N s], [N m s] |
| f, n | force and moment about the base's origin: f = dp/dt - m g, n = dL/dt + c x f | [N], [N m] |

Source: Featherstone, Rigid Body Dynamics Algorithms (2008), equation 2.70.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.typing import Floats


def wrench_on_base(body: Any, base: Floats, q: Floats, v: Floats, a: Floats) -> Floats:
    """The wrench that a motion needs at the base.

    Args:
        body: The `ulna.Robot`.
        base: Pose of the base in the world, (4, 4).
        q: Configuration, (..., n) [rad or m].
        v: Velocity, (..., n) [rad/s or m/s].
        a: Acceleration, (..., n) [rad/s^2 or m/s^2].

    Returns:
        Force and moment about the base's origin in its axes, (..., 6) [N, N m].
    """
    q, v, a = np.broadcast_arrays(q, v, a)
    rate = body.centroidal.momentum_rate(q, v, a)
    force = rate[..., :3] - body.total_mass() * np.asarray(body.model.gravity)
    moment = rate[..., 3:] + np.cross(body.center_of_mass(q) - base[:3, 3], force)
    return np.concatenate([force @ base[:3, :3], moment @ base[:3, :3]], -1)


def moved_wrench(wrench: Any, T: Floats) -> Floats:
    """A wrench at a frame, about the origin and in the axes of another.

    Args:
        wrench: Force and moment in the axes of the frame, (6,) [N, N m].
        T: Poses of the frame in the other, (..., 4, 4).

    Returns:
        The wrench, (..., 6) [N, N m].
    """
    force, moment = np.split(np.asarray(wrench, dtype=float), 2)
    f = T[..., :3, :3] @ force
    return np.concatenate([f, T[..., :3, :3] @ moment + np.cross(T[..., :3, 3], f)], -1)
