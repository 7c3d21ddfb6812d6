"""How much a robot can hold: the multiple of a load at which each joint reaches its greatest torque.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| q | configuration at which the robot stands still | (nq) | [rad] or [m] | |
| g | torques that hold the robot itself | (nv) | [N m] or [N] | see rnea.py |
| w | wrench of the load on the frame, in a reference | (6) | [N, N m] | weight of 1 kg: m g |
| J | Jacobian of the frame in that reference | (6, nv) | | |
| t | further torques for one such load | (nv) | [N m] or [N] | t = -J^T w |
| c | multiples that the joints can hold | (nv) | [1] | g + c t within -limit and limit |

Source: Siciliano, section 3.8 (statics). A joint the load does not burden, but for
rounding, holds any multiple: inf. Where a joint cannot
even hold the robot the answer is nan.
"""

from __future__ import annotations

import numpy as np

from ulna.algorithms.dynamics.rnea_point_accelerations import gravity_forces
from ulna.algorithms.kinematics.jacobian import frame_jacobian
from ulna.algorithms.multibody.references import Reference
from ulna.model import Frame, Model
from ulna.numeric import apply, by_precision, less, where
from ulna.typing import Array


def payload_multiples(
    model: Model,
    q: Array,
    wrench: Array,
    limit: Array,
    frame: Frame,
    reference: Reference = "local_world_aligned",
) -> Array:
    """How many times a wrench at a frame each joint can hold, standing still.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        wrench: What the load exerts on the frame, shape (..., 6) [N, N m], linear part first.
        limit: Greatest torque of each joint in both directions, shape (..., nv) [N m, N]; may be inf.
        frame: Where the load acts.
        reference: In whose axes and about which point the wrench is written: "world", "local" or
            "local_world_aligned".

    Returns:
        c, shape (..., nv) [-]; inf for joints that the load does not burden, nan for those that cannot hold the robot
        itself.
    """
    g = gravity_forces(model, q)
    J = frame_jacobian(model, q, frame, reference)
    t = -apply(np.swapaxes(J, -1, -2), wrench)
    backward = less(t, 0.0)
    size = where(backward, -t, t)
    margin = limit - where(backward, -g, g)  # in the direction of the load
    scale = np.sum(size, axis=-1, keepdims=True) + np.sum(abs(wrench), axis=-1, keepdims=True)
    least = by_precision(scale, 1e-12, 2.0**-18) * scale  # what rounding makes of no torque
    is_loaded = less(least, size)
    multiple = where(is_loaded, margin / where(is_loaded, size, 1.0), np.inf)
    return where(less(limit, where(less(g, 0.0), -g, g)), np.nan, multiple)
