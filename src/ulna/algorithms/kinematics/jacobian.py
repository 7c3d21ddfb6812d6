"""The Jacobian of a frame: what each joint velocity adds to the frame's twist.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| S_j | column of the motion subspace in the moving frame of its step | Motion | [1] or [m/rad] | constant |
| T_j, R_j, p_j | pose of that moving frame in the world | SE3 | [m] | |
| p | origin of the frame in the world | (3) | [m] | |
| w_j, l_j | column in local_world_aligned | (3) | | w = R_j S.angular, l = R_j S.linear + w x (p - p_j) |
| J | frame Jacobian, twist = J v, linear rows first | (6, nv) | | sum over columns |

In "world" a column is T_j S_j (the space Jacobian of Lynch & Park, definition 5.1), in "local" it is
T_frame_j S_j (their body Jacobian, definition 5.2), passed inward from the tip so that no pose in the world
is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np

from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.link_frames import frame_chain
from ulna.algorithms.multibody.references import Reference, check_reference
from ulna.algorithms.multibody.tree import Step, chain, poses, steps
from ulna.model import Frame, Model
from ulna.numeric import apply, cross, skew
from ulna.spatial import SE3, Motion
from ulna.typing import Array


class Column(NamedTuple):
    """What one column of one step's S, times the multiplier of a mimic joint, adds to the Jacobian."""

    order: int
    """Position of the step in its chain: a step moves all that have an equal or a larger order."""
    index: int
    """The column of the Jacobian it is added to."""
    motion: Motion


def frame_jacobian(
    model: Model, q: Array, frame: Frame, reference: Reference = "local_world_aligned"
) -> Array:
    """The Jacobian of a frame: `J @ v` is its twist, linear part first.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        frame: A frame of the model.
        reference: "world", "local" or "local_world_aligned".

    Returns:
        J, shape (..., 6, nv), rows linear [m/rad, -] and angular [-, rad/m].
    """
    J = batch_zeros((6, model.nv), q)
    tree, placement = frame_chain(model, frame, q)
    for column in frame_columns(tree, q, placement, reference):
        J[..., :3, column.index] += column.motion.linear
        J[..., 3:, column.index] += column.motion.angular
    return J


def joint_jacobians(model: Model, q: Array) -> Array:
    """The columns of all joints in the reference "world".

    With the columns of joints that do not move a frame set to zero, it is the frame's Jacobian in that reference. The
    columns of a mimic joint are added to those of its source, so that this does not hold for models with mimic joints.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        J, shape (..., 6, nv).
    """
    J = batch_zeros((6, model.nv), q)
    for column in world_columns(steps(model), q):
        J[..., :3, column.index] += column.motion.linear
        J[..., 3:, column.index] += column.motion.angular
    return J


def frame_jacobian_of(
    model: Model, J: Array, T_world_body: SE3, frame: Frame, reference: Reference = "local_world_aligned"
) -> Array:
    """The Jacobian of a frame from the columns of all joints and the pose of its body, without forward kinematics.

    Args:
        model: The robot, without mimic joints: `joint_jacobians` adds their columns to those of other joints.
        J: What `joint_jacobians` returns, shape (..., 6, nv).
        T_world_body: Pose in the world of the moving frame of the joint that `frame` is fixed to, at the same
            configuration [m].
        frame: A frame of the model.
        reference: "world", "local" or "local_world_aligned".

    Returns:
        J of the frame, shape (..., 6, nv).
    """
    check_reference(reference)
    supports = np.zeros(model.nv)
    for step in chain(model, frame):
        supports[list(step.indices)] = 1.0
    linear, angular = J[..., :3, :] * supports, J[..., 3:, :] * supports
    if reference != "world":
        pose = T_world_body @ frame.placement
        linear = linear - skew(pose.translation) @ angular
        if reference == "local":
            R_frame_world = np.swapaxes(pose.rotation, -1, -2)
            linear, angular = R_frame_world @ linear, R_frame_world @ angular
    return np.concatenate([linear, angular], axis=-2)


def frame_columns(tree: Sequence[Step], q: Array, placement: SE3, reference: Reference) -> list[Column]:
    """The Jacobian of a frame on the last body of a chain, column by column.

    Args:
        tree: The steps, parents first.
        q: Configuration, shape (..., nq) [rad, m].
        placement: Pose of the frame in the last moving frame [m].
        reference: "world", "local" or "local_world_aligned".

    Returns:
        The columns, root first; those of a mimic joint times its multiplier.
    """
    check_reference(reference)
    if reference == "world":
        return world_columns(tree, q)
    return local_columns(tree, q, placement) if reference == "local" else aligned_columns(tree, q, placement)


def world_columns(tree: Sequence[Step], q: Array) -> list[Column]:
    """The columns T_j S_j of a chain or of a whole tree, in the reference "world".

    Args:
        tree: The steps, parents first.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        The columns, in the order of the steps.
    """
    return [
        Column(order, index, T.act(S) * step.multiplier)
        for order, (step, T) in enumerate(zip(tree, poses(tree, q), strict=True))
        for index, S in zip(step.indices, step.subspace(), strict=True)
    ]


def local_columns(tree: Sequence[Step], q: Array, placement: SE3) -> list[Column]:
    """The columns T_frame_j S_j of a chain, in the reference "local".

    Args:
        tree: The steps, parents first.
        q: Configuration, shape (..., nq) [rad, m].
        placement: Pose of the frame in the last moving frame [m].

    Returns:
        The columns, root first.
    """
    columns: list[Column] = []
    T_step_frame = placement
    for order, step in reversed(list(enumerate(tree))):
        columns += [
            Column(order, index, T_step_frame.act_inverse(S) * step.multiplier)
            for index, S in zip(step.indices, step.subspace(), strict=True)
        ]
        if step.parent >= 0:
            T_step_frame = step.pose_in_parent(T_step_frame, q)
    return sorted(columns, key=lambda column: column.order)


def by_step(columns: Sequence[Column]) -> list[list[Column]]:
    """The columns of a chain, those of each step together."""
    return [list(group) for _, group in groupby(columns, key=lambda column: column.order)]


def aligned_columns(tree: Sequence[Step], q: Array, placement: SE3) -> list[Column]:
    """The columns (l_j, w_j) of a chain, in the reference "local_world_aligned".

    Args:
        tree: The steps, parents first.
        q: Configuration, shape (..., nq) [rad, m].
        placement: Pose of the frame in the last moving frame [m].

    Returns:
        The columns, root first.
    """
    world = poses(tree, q)
    columns: list[Column] = []
    for order, (step, T) in enumerate(zip(tree, world, strict=True)):
        arm = world[-1] @ placement.translation - T.translation
        for index, S in zip(step.indices, step.subspace(), strict=True):
            w = apply(T.rotation, S.angular)
            motion = Motion(apply(T.rotation, S.linear) + cross(w, arm), w)
            columns.append(Column(order, index, motion * step.multiplier))
    return columns
