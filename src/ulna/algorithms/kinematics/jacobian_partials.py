"""Derivatives of a serial chain's pose by its coordinates, of any order, in closed form.

| symbol | meaning | shape |
|---|---|---|
| v_j, w_j | halves of the Jacobian's column j, "local_world_aligned": see jacobian.py | (3) |
| k | the coordinates that are derived by, as many as `order` - 1 | |
| linear | w_a x (w_b x ... (w_y x v_z)), where a <= b <= ... <= y <= z are those k and j in order | (3) |
| angular | w_a x (w_b x ... (w_y x w_j)), where a <= b <= ... <= y are those k in order; 0 unless y <= j | (3) |

A joint turns or shifts all that comes after it: dv_j / dq_k = w_k x v_j where k <= j, and dw_j / dq_k = w_k x w_j. The
derivative by the first joint of all is therefore the outermost product; that partial derivatives of the position may be
taken in any order gives the rest. Order 1 is the Jacobian, order 2 the Hessian.

Source: Haviland & Corke, Manipulator Differential Kinematics part 2 (2023), section II, where j and k are in order.
"""

from __future__ import annotations

import numpy as np

from ulna.errors import InputError
from ulna.numeric import cross
from ulna.typing import Array


def jacobian_partials(J: Array, order: int) -> Array:
    """The derivatives of a serial chain's pose of some order: [l, k, :, j] is d2 J_j / dq_k dq_l.

    Args:
        J: The Jacobian of a serial chain, columns in order along it, "local_world_aligned", shape (6, n).
        order: Of the derivative of the pose, at least 1.

    Returns:
        The derivatives, shape (n, ..., n, 6, n) with n `order` times.

    Raises:
        InputError: `order` is below 1, or no whole number.
    """
    if order != int(order) or order < 1:
        raise InputError(f"`order` is {order}; expected a whole number of at least 1.")
    n = J.shape[-1]
    v, w = J[:3].T, J[3:].T
    which = np.indices((n,) * int(order)).reshape(int(order), -1)  # k_1 ... k_r, then j, of each derivative
    ordered = np.sort(which, axis=0)
    before, j = np.sort(which[:-1], axis=0), which[-1]
    linear, angular = v[ordered[-1]], w[j]
    for a in ordered[-2::-1]:
        linear = cross(w[a], linear)
    for a in before[::-1]:
        angular = cross(w[a], angular)
    if order > 1:
        angular = angular * (before[-1] <= j)[:, None]
    shape = (n,) * int(order)
    both = np.concatenate([linear.reshape(*shape, 3), angular.reshape(*shape, 3)], axis=-1)
    return np.swapaxes(both, -1, -2)
