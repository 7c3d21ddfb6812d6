"""The kinematic Hessian of a frame: the derivative of its Jacobian with respect to each coordinate.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| J_j | column of the Jacobian of step j | Motion | | see jacobian.py |
| H | Hessian, H[k, :, j] = dJ_j / dq_k | (nv, 6, nv) | | |
| H_kj | world: | Motion | | J_k x J_j where k <= j, else 0 |
| | local: | Motion | | J_j x J_k where k > j, else 0 |
| | local_world_aligned, angular part | (3) | | w_k x w_j where k <= j, else 0 |
| | local_world_aligned, linear part | (3) | | w_k x l_j where k <= j, else w_j x l_k |

Source: the derivative of Ad_T along a twist (Featherstone, section 2.10); for "local_world_aligned", whose
linear part is symmetric in j and k where they belong to different steps, Haviland & Corke, Manipulator
Differential Kinematics part 2 (2023). Columns of one step satisfy k <= j in both orders. A coordinate of a
spherical joint, free flyer or planar joint is a direction of its tangent space: dJ / dq_k is the derivative
of J(integrate(q, t e_k)) with respect to t at 0. The columns of a mimic joint add to those of its source in
both places.
"""

from __future__ import annotations

from collections.abc import Sequence

from ulna.algorithms.kinematics.jacobian import Column, frame_columns
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.references import Reference
from ulna.algorithms.multibody.tree import chain
from ulna.model import Frame, Model
from ulna.numeric import cross
from ulna.spatial import Motion
from ulna.typing import Array


def frame_hessian(
    model: Model, q: Array, frame: Frame, reference: Reference = "local_world_aligned"
) -> Array:
    """The derivative of the Jacobian of a frame with respect to q: `H[k, i, j] = dJ[i, j] / dq_k`.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        frame: A frame of the model.
        reference: "world", "local" or "local_world_aligned".

    Returns:
        H, shape (..., nv, 6, nv), rows linear and angular.
    """
    columns = frame_columns(chain(model, frame), q, frame.placement, reference)
    return hessian_of_columns(columns, batch_zeros((model.nv, 6, model.nv), q), reference)


def hessian_of_columns(columns: Sequence[Column], zeros: Array, reference: Reference) -> Array:
    """The derivative of a Jacobian with these columns; see `frame_hessian`.

    Args:
        columns: The columns of a chain in the reference.
        zeros: Zeros, which are filled, shape (..., nv, 6, nv).
        reference: "world", "local" or "local_world_aligned".

    Returns:
        H, shape (..., nv, 6, nv).
    """
    H = zeros
    for k in columns:
        for j in columns:
            change = _change(k, j, reference)
            if change is not None:
                H[..., k.index, :3, j.index] += change.linear
                H[..., k.index, 3:, j.index] += change.angular
    return H


def _change(k: Column, j: Column, reference: Reference) -> Motion | None:
    """dJ_j / dq_k, or None where it is zero."""
    moves = k.order <= j.order
    if reference == "world":
        return k.motion.cross(j.motion) if moves else None
    if reference == "local":
        return None if moves else j.motion.cross(k.motion)
    if moves:
        w = k.motion.angular
        return Motion(cross(w, j.motion.linear), cross(w, j.motion.angular))
    linear = cross(j.motion.angular, k.motion.linear)
    return Motion(linear, 0.0 * linear)
