"""How constraints move, seen from their first frame: errors on SE(3), and what the spatial accelerations add.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| a, b | first and second frame; a frame of the world is the second one at joint -1 | | | |
| J, c, k | Jacobian, velocity and bias of kinematics.py, along the world's axes | | | k = dJ/dt v |
| e | error of a point; of a frame | (3); (6) | [m], [rad] | p_a - p_b; log6(T_b^-1 T_a) |
| u, w | velocity of the origin of a, its angular velocity | (3) | [m/s], [rad/s] | |
| l, d | linear and angular part of c | (3) | | |
| k' | bias of a frame in "local" axes, which turn with it | (6) | [m/s^2], ... | k + (l x w, d x w) |
| k'' | bias of a frame in the world's axes: of the difference of spatial accelerations | (6) | | k - (d x u, 0) |

| y | place of b seen from a; of a frame its logarithm | (3); (6) | [m], [rad] | T_a^-1 p_b; -e |
| S | its Jacobian, of a frame that of its twist | (3, nv); (6, nv) | | -(J + e x W); -J |
| z | rate of S v | (3); (6) | [m/s^2], ... | -(J a + k) - 2 w x S v - alpha x y - w x (w x y); -(J a + k') |

W is how a turns, (3, nv), alpha its angular acceleration, both in its axes. A point moves as in kinematics.py. With
J a + k' = 0 the components of c in the axes of a stay what they are; with J a + k'' = 0 both bodies have one spatial
acceleration. Both say the same as k where c = 0. The error of a frame is driven by its own axes: de/dt = J_r(e)^-1 c.
Source: Featherstone 2008, sections 2.10 and 8.1; Lynch & Park, section 8.6.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ulna.algorithms.constraints.kinematics import (
    along_axes,
    constraint_bias,
    constraint_error,
    constraint_jacobian,
    constraint_velocity,
)
from ulna.algorithms.kinematics.forward_kinematics import frame_acceleration, frame_pose
from ulna.algorithms.kinematics.jacobian import frame_jacobian
from ulna.model import Frame, Model
from ulna.model.constraint import End, FramePair
from ulna.numeric import apply, cross, skew
from ulna.spatial import SE3
from ulna.spatial.exponential import log_parts
from ulna.typing import Array


class Twists(NamedTuple):
    """How constraints move, each along its own axes."""

    J: Array
    """The Jacobian, (..., m, nv)."""
    velocity: Array
    """c = J v, (..., m) [m/s, rad/s]."""
    bias: Array
    """k' or k'', (..., m) [m/s^2, rad/s^2]."""
    error: Array
    """e, (..., m) [m, rad]."""


def constraint_twists(model: Model, q: Array, v: Array, frame_pairs: Sequence[FramePair]) -> Twists:
    """Jacobian, velocity, bias and error of constraints, the frames' on SE(3).

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        frame_pairs: The constraints, all with a second frame.

    Returns:
        All of them along the axes of the constraints.
    """
    J = constraint_jacobian(model, q, frame_pairs, local_axes=False)
    c = apply(J, v)
    k, e = [], []
    bias = constraint_bias(model, q, v, frame_pairs, local_axes=False)
    points = constraint_error(model, q, None, frame_pairs, local_axes=False)
    start = 0
    for frame_pair in frame_pairs:
        rows = slice(start, start + frame_pair.size)
        k.append(bias[..., rows])
        if frame_pair.size == 3:
            e.append(points[..., rows])
        else:
            k[-1] = k[-1] + _added(model, q, v, c[..., rows], frame_pair)
            e.append(_log(model, q, frame_pair))
        start += frame_pair.size
    parts = np.broadcast_arrays(c, np.concatenate(k, axis=-1), np.concatenate(e, axis=-1))
    columns = np.stack(parts, axis=-1)
    turned = along_axes(model, q, columns, frame_pairs)
    return Twists(along_axes(model, q, J, frame_pairs), turned[..., 0], turned[..., 1], turned[..., 2])


class RelativeMotion(NamedTuple):
    """The motion of the second frame in the first one."""

    place: Array
    """y, (..., m) [m, rad]."""
    J: Array
    """S, (..., m, nv)."""
    velocity: Array
    """S v, (..., m) [m/s, rad/s]."""
    acceleration: Array
    """z, (..., m) [m/s^2, rad/s^2]."""


def relative_motion(model: Model, q: Array, v: Array, a: Array, frame_pair: FramePair) -> RelativeMotion:
    """The motion of the second frame of a constraint in the first one.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        frame_pair: The constraint, with a second frame.

    Returns:
        Position, Jacobian, velocity and acceleration along the axes of the first frame.
    """
    twists = constraint_twists(model, q, v, [frame_pair._replace(local=True)])
    y = -twists.error
    acceleration = -(apply(twists.J, a) + twists.bias)
    if frame_pair.size == 6:
        return RelativeMotion(y, -twists.J, -twists.velocity, acceleration)
    first = frame_of(frame_pair.first)
    turns = frame_jacobian(model, q, first, "local")[..., 3:, :]
    w = apply(turns, v)
    S = -(twists.J - skew(y) @ turns)
    velocity = apply(S, v)
    alpha = frame_acceleration(model, q, v, a, first, "local").angular
    return RelativeMotion(
        y, S, velocity, acceleration - 2.0 * cross(w, velocity) - cross(alpha, y) - cross(w, cross(w, y))
    )


def frame_of(end: End) -> Frame:
    """An end as a frame of the model; its placement may be traced."""
    return Frame("", end.joint, end.placement, "user", "", SE3.identity())


def relative_log(model: Model, q: Array, frame_pair: FramePair) -> Array:
    """The error of a frame on SE(3): log6(T_b^-1 T_a).

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        frame_pair: The constraint, with a second frame.

    Returns:
        The error, shape (..., 6) [m, rad].
    """
    assert frame_pair.second is not None, "the frame that holds it"
    T = frame_pose(model, q, frame_of(frame_pair.second)).inverse() @ frame_pose(
        model, q, frame_of(frame_pair.first)
    )
    return np.concatenate(log_parts(T.rotation, T.translation), axis=-1)


def _log(model: Model, q: Array, frame_pair: FramePair) -> Array:
    """The same along the world's axes."""
    R, log = frame_pose(model, q, frame_of(frame_pair.first)).rotation, relative_log(model, q, frame_pair)
    return np.concatenate([apply(R, log[..., :3]), apply(R, log[..., 3:])], axis=-1)


def _added(model: Model, q: Array, v: Array, c: Array, frame_pair: FramePair) -> Array:
    """k' - k, or k'' - k, along the world's axes."""
    first_twist = constraint_velocity(model, q, v, [FramePair(frame_pair.first, None, 6, local=False)])
    l, d = c[..., :3], c[..., 3:]
    if frame_pair.local:
        w = first_twist[..., 3:]
        return np.concatenate([cross(l, w), cross(d, w)], axis=-1)
    return np.concatenate([-cross(d, first_twist[..., :3]), 0.0 * d], axis=-1)
