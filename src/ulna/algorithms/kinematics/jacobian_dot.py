"""The time derivative of a frame's Jacobian, in closed form.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| J_j | column of the Jacobian | Motion | | see jacobian.py |
| V_j | twist of the body behind step j | Motion | [m/s, rad/s] | V_j = sum of J_k v_k over steps k <= j |
| dJ_j | its derivative: world | Motion | per s | dJ_j = V_j x J_j |
| | local | Motion | per s | dJ_j = J_j x (sum of J_k v_k over k > j) |
| | local_world_aligned: w_j | (3) | per s | dw_j = W_j x w_j |
| | local_world_aligned: l_j | (3) | per s | dl_j = W_j x l_j + w_j x (sum of l_k v_k over k > j) |

Source: Featherstone, section 2.10. In the last lines W_j is the angular part of V_j: the column turns rigidly
with its body, except that the frame's origin also moves relative to it. Every S is constant in its moving
frame (tree.py), so no other term exists.
"""

from __future__ import annotations

from functools import reduce
from operator import add

from ulna.algorithms.kinematics.jacobian import Column, by_step, frame_columns, world_columns
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.references import Reference
from ulna.algorithms.multibody.tree import chain, steps
from ulna.model import Frame, Model
from ulna.numeric import cross
from ulna.spatial import Motion
from ulna.typing import Array


def frame_jacobian_dot(
    model: Model, q: Array, v: Array, frame: Frame, reference: Reference = "local_world_aligned"
) -> Array:
    """The time derivative of the Jacobian of a frame along `v`.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        frame: A frame of the model.
        reference: "world", "local" or "local_world_aligned".

    Returns:
        Shape (..., 6, nv).
    """
    groups = by_step(frame_columns(chain(model, frame), q, frame.placement, reference))
    upto, beyond = partial_twists(groups, v)
    dJ = batch_zeros((6, model.nv), q, v)
    for group, V, rest in zip(groups, upto, beyond, strict=True):
        for column in group:
            change = rate_of_column(column.motion, V, rest, reference)
            dJ[..., :3, column.index] += change.linear
            dJ[..., 3:, column.index] += change.angular
    return dJ


def joint_jacobians_dot(model: Model, q: Array, v: Array) -> Array:
    """The time derivative of `joint_jacobians` along `v`.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        Shape (..., 6, nv).
    """
    tree = steps(model)
    dJ = batch_zeros((6, model.nv), q, v)
    twists: list[Motion] = []
    groups = by_step(world_columns(tree, q))
    for step, group in zip(tree, groups, strict=True):
        before = twists[step.parent] if step.parent >= 0 else Motion.zero()
        twists.append(before + step_twist(group, v))
        for column in group:
            change = twists[-1].cross(column.motion)
            dJ[..., :3, column.index] += change.linear
            dJ[..., 3:, column.index] += change.angular
    return dJ


def partial_twists(groups: list[list[Column]], v: Array) -> tuple[list[Motion], list[Motion]]:
    """For each step, the sum of J_k v_k over the steps up to and with it, and over the steps beyond it.

    Args:
        groups: The columns of a chain, one list a step, root first.
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        The two sums, one twist a step each [m/s, rad/s].
    """
    upto: list[Motion] = []
    beyond: list[Motion] = []
    total = Motion.zero()
    for group in groups:
        total = total + step_twist(group, v)
        upto.append(total)
    total = Motion.zero()
    for group in reversed(groups):
        beyond.append(total)
        total = total + step_twist(group, v)
    return upto, beyond[::-1]


def step_twist(group: list[Column], v: Array) -> Motion:
    """The sum of J_k v_k over the columns of one step.

    Args:
        group: The columns of the step.
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        The twist that the step adds [m/s, rad/s].
    """
    terms = [column.motion * v[..., column.index] for column in group]
    return reduce(add, terms)


def rate_of_column(J: Motion, V: Motion, rest: Motion, reference: Reference) -> Motion:
    """How a column of the Jacobian changes with time; see the table of the module.

    Args:
        J: The column, or a batch of columns.
        V: The twist of the body behind its step [m/s, rad/s].
        rest: What the steps beyond it add to the twist of the frame [m/s, rad/s].
        reference: As for `frame_jacobian_dot`.

    Returns:
        The rate of the column.
    """
    if reference == "world":
        return V.cross(J)
    if reference == "local":
        return J.cross(rest)
    W, w = V.angular, J.angular
    return Motion(cross(W, J.linear) + cross(w, rest.linear), cross(W, w))
