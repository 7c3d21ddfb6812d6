"""Kinematics of constraints: error, velocity, Jacobian, and acceleration without acceleration of the joints.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| a, b | first frame; second frame, or anchor in the world, at rest | | | |
| p, R | origin and rotation of a frame in the world | (3), (3, 3) | [m] | |
| u, w | velocity of its origin, its angular velocity | (3) | [m/s], [rad/s] | |
| d | from b to a | (3) | [m] | d = p_a - p_b |
| e | error of a point; of a frame | (3); (6) | [m], [rad] | d; (d, log R_a R_b^T) |
| c | velocity of a point; of a frame | (3); (6) | [m/s], [rad/s] | u_a - u_b; (u_a - u_b - w_b x d, w_a - w_b) |
| J | constraint Jacobian | (m, nv) | | c = J v |
| k | bias | (m) | [m/s^2], [rad/s^2] | k = dJ/dt v |

c of a frame is its twist beside b, so that forces along the rows of J are opposite and meet at the origin of a.
Everything is found along the axes of the world; "local" axes turn the three rows of a part by R_a^T, k included, so
that they choose how forces are written and nothing else. The moving frames are those of link_frames.py, and the
accelerations
those of rnea.py, with which bias forces are computed: a constraint adds little to them. Source: Featherstone 2008,
sections 3.3 and 8.1; Carpentier, Budhiraja & Mansard 2021, section III.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ulna.algorithms.dynamics.rnea_point_accelerations import point_motions
from ulna.algorithms.kinematics.jacobian import Column, aligned_columns
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.prepared_model import PreparedModel, prepare
from ulna.algorithms.multibody.tree import Step, poses
from ulna.model import Model
from ulna.model.constraint import End, FramePair
from ulna.numeric import apply, cross
from ulna.spatial import SE3
from ulna.spatial.exponential import so3_log
from ulna.typing import Array


class Side(NamedTuple):
    """One frame of a pair, at a configuration."""

    step: int
    """The step that carries it, between optimised frames; -1 for the world."""
    placement: SE3
    """Its pose in the moving frame of that step."""
    carrier: SE3
    """The pose of that moving frame in the world."""
    columns: list[Column]
    """Those of its Jacobian, along the world's axes."""

    @property
    def pose(self) -> SE3:
        """Its pose in the world."""
        return self.carrier @ self.placement


def constraint_jacobian(
    model: Model, q: Array, frame_pairs: Sequence[FramePair], local_axes: bool = True
) -> Array:
    """The Jacobian of constraints.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        frame_pairs: The constraints.
        local_axes: Whether rows of "local" constraints are written along the axes of their first frame.

    Returns:
        J, shape (..., m, nv).
    """
    prepared = prepare(model)
    J = batch_zeros((sum(frame_pair.size for frame_pair in frame_pairs), model.nv), q)
    start = 0
    for frame_pair in frame_pairs:
        first, second = _sides(model, prepared, q, frame_pair)
        for sign, columns in ((1.0, first.columns), (-1.0, second.columns if second else [])):
            for column in columns:
                linear, angular = column.motion.linear, column.motion.angular
                if frame_pair.size == 6 and second is not None and sign < 0.0:
                    linear = linear + cross(angular, first.pose.translation - second.pose.translation)
                J[..., start : start + 3, column.index] += sign * linear
                if frame_pair.size == 6:
                    J[..., start + 3 : start + 6, column.index] += sign * angular
        start += frame_pair.size
    return along_axes(model, q, J, frame_pairs) if local_axes else J


def constraint_velocity(model: Model, q: Array, v: Array, frame_pairs: Sequence[FramePair]) -> Array:
    """The velocity of constraints.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        frame_pairs: The constraints.

    Returns:
        c, shape (..., m) [m/s, rad/s].
    """
    return apply(constraint_jacobian(model, q, frame_pairs), v)


def constraint_error(
    model: Model, q: Array, anchors: Array | None, frame_pairs: Sequence[FramePair], local_axes: bool = True
) -> Array:
    """The error of constraints: how far their frames are from where they should be.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        anchors: Where the contacts hold, in their order, as poses of shape (..., contacts, 4, 4) [m]; of a point only
            the position is read. None without contacts.
        frame_pairs: The constraints.
        local_axes: Whether rows of "local" constraints are written along the axes of their first frame.

    Returns:
        e, shape (..., m) [m, rad].
    """
    prepared = prepare(model)
    inputs = (q,) if anchors is None else (q, anchors[..., 0, 0])
    e = batch_zeros((sum(frame_pair.size for frame_pair in frame_pairs),), *inputs)
    start = contacts = 0
    for frame_pair in frame_pairs:
        first, second = _sides(model, prepared, q, frame_pair)
        if second is not None:
            to = second.pose
        else:
            assert anchors is not None, "contacts have anchors"
            to = SE3(anchors[..., contacts, :3, :3], anchors[..., contacts, :3, 3])
            contacts += 1
        e[..., start : start + 3] = first.pose.translation - to.translation
        if frame_pair.size == 6:
            turn = first.pose.rotation @ np.swapaxes(to.rotation, -1, -2)
            e[..., start + 3 : start + 6] = so3_log(turn)
        start += frame_pair.size
    return along_axes(model, q, e[..., None], frame_pairs)[..., 0] if local_axes else e


def constraint_bias(
    model: Model, q: Array, v: Array, frame_pairs: Sequence[FramePair], local_axes: bool = True
) -> Array:
    """The acceleration of constraints at zero joint acceleration, dJ/dt v.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        frame_pairs: The constraints.
        local_axes: Whether rows of "local" constraints are written along the axes of their first frame.

    Returns:
        k, shape (..., m) [m/s^2, rad/s^2].
    """
    prepared = prepare(model)
    moving = point_motions(prepared.tree, q, v, None, -np.asarray(model.gravity))

    def motion(side: Side) -> tuple[Array, Array, Array, Array]:
        """u, w and their derivatives."""
        if side.step < 0:
            return np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
        R, rate = side.carrier.rotation, moving[side.step]
        linear = apply(R, rate.b + apply(rate.U, side.placement.translation)) + np.asarray(model.gravity)
        velocity = sum((c.motion.linear * v[..., c.index, None] for c in side.columns), np.zeros(3))
        return velocity, apply(R, rate.w), linear, apply(R, rate.e)

    k = batch_zeros((sum(frame_pair.size for frame_pair in frame_pairs),), q, v)
    start = 0
    for frame_pair in frame_pairs:
        first, second = _sides(model, prepared, q, frame_pair)
        u, _, linear, angular = motion(first)
        if second is not None:
            u_b, w_b, linear_b, angular_b = motion(second)
            linear, angular = linear - linear_b, angular - angular_b
            if frame_pair.size == 6:
                d = first.pose.translation - second.pose.translation
                linear = linear - cross(angular_b, d) - cross(w_b, u - u_b)
        k[..., start : start + 3] = linear
        if frame_pair.size == 6:
            k[..., start + 3 : start + 6] = angular
        start += frame_pair.size
    return along_axes(model, q, k[..., None], frame_pairs)[..., 0] if local_axes else k


def along_axes(model: Model, q: Array, rows: Array, frame_pairs: Sequence[FramePair]) -> Array:
    """Rows along the world's axes, written along the axes of their constraints.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        rows: What is rewritten, shape (..., m, n).
        frame_pairs: The constraints.

    Returns:
        The same rows, those of "local" constraints along the axes of their first frames, shape (..., m, n).
    """
    if not any(frame_pair.local for frame_pair in frame_pairs):
        return rows
    prepared = prepare(model)
    parts, start = [], 0
    for frame_pair in frame_pairs:
        for first_row in range(start, start + frame_pair.size, 3):
            part = rows[..., first_row : first_row + 3, :]
            if frame_pair.local:
                R = _sides(model, prepared, q, frame_pair)[0].pose.rotation
                part = np.swapaxes(R, -1, -2) @ part
            parts.append(part)
        start += frame_pair.size
    return np.concatenate(parts, axis=-2)


def _sides(
    model: Model, prepared: PreparedModel, q: Array, frame_pair: FramePair
) -> tuple[Side, Side | None]:
    return _side(model, prepared, q, frame_pair.first), _side(
        model, prepared, q, frame_pair.second
    ) if frame_pair.second else None


def _side(model: Model, prepared: PreparedModel, q: Array, end: End) -> Side:
    if end.joint < 0:
        return Side(-1, end.placement, SE3.identity(), [])
    last = next(
        i for i, step in enumerate(prepared.tree) if step.is_last and step.joint is model.joints[end.joint]
    )
    placement = prepared.frames[last].inverse() @ end.placement
    chain = _chain(prepared.tree, last)
    return Side(last, placement, poses(chain, q)[-1], aligned_columns(chain, q, placement))


def _chain(tree: Sequence[Step], last: int) -> tuple[Step, ...]:
    """The steps from the world out to `last`, each standing on the one before it."""
    path = [last]
    while tree[path[-1]].parent >= 0:
        path.append(tree[path[-1]].parent)
    return tuple(replace(tree[i], parent=k - 1) for k, i in enumerate(reversed(path)))
