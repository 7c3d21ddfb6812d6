"""Where the frames of a robot are, how fast they move, and how they accelerate.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| q, v, a | position, velocity, acceleration | (nq), (nv), (nv) | [rad] or [m], per s, per s^2 | |
| T_i | pose of the moving frame of step i in the world | SE3 | [m] | T_i = T_p P_i J_i(q) |
| V_i | twist of body i in its own frame | Motion | [m/s, rad/s] | V_i = X_i^-1 V_p + S_i v_i |
| A_i | its spatial acceleration | Motion | [m/s^2, rad/s^2] | A_i = X_i^-1 A_p + S_i a_i + V_i x S_i v_i |
| F | constant pose of the frame on body i | SE3 | [m] | T_f = T_i F, V_f = F^-1 V_i, A_f = F^-1 A_i |
| A' | classical acceleration (of the point) | Motion | [m/s^2, rad/s^2] | A' = A + (w x V.linear; 0) |

Source: Featherstone, sections 2.11 (classical and spatial acceleration) and 5.3 (the recursions, with S
constant). The acceleration of gravity is not in A. Twists are passed outward in body coordinates: their
recursion needs no pose of any body.
"""

from __future__ import annotations

from collections.abc import Sequence

from ulna.algorithms.multibody.batch_shapes import broadcast_motion, broadcast_pose
from ulna.algorithms.multibody.body_motions import body_accelerations, body_velocities
from ulna.algorithms.multibody.link_frames import frame_chain
from ulna.algorithms.multibody.references import Reference, check_reference, in_reference, relevant_placement
from ulna.algorithms.multibody.tree import (
    chain,
    poses,
    steps,
    tip_pose,
)
from ulna.model import Frame, Model
from ulna.numeric import cross
from ulna.spatial import SE3, Motion
from ulna.typing import Array


def joint_poses(model: Model, q: Array) -> list[SE3]:
    """T_world_joint of every movable joint, in the order of `model.joints`.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        The poses of the joints' moving frames in the world [m], with the batch axes of `q`.
    """
    tree = steps(model)
    return [broadcast_pose(T, q) for T, step in zip(poses(tree, q), tree, strict=True) if step.is_last]


def frame_pose(model: Model, q: Array, frame: Frame) -> SE3:
    """T_world_frame of one frame; only its ancestors are visited.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        frame: A frame of the model.

    Returns:
        The pose, with the batch axes of `q` [m].
    """
    tree, placement = frame_chain(model, frame, q)
    return broadcast_pose(tip_pose(tree, q, placement), q)


def frame_poses(model: Model, q: Array, frames: Sequence[Frame]) -> list[SE3]:
    """T_world_frame of several frames; each of their ancestors is visited once.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        frames: Frames of the model (links will do: all that is read is `joint` and `placement`).

    Returns:
        One pose a frame, with the batch axes of `q` [m].
    """
    needed = sorted({i for frame in frames if frame.joint >= 0 for i in model.support(frame.joint)})
    tree = steps(model, needed)
    last = [T for T, step in zip(poses(tree, q), tree, strict=True) if step.is_last]
    of_joint = dict(zip(needed, last, strict=True))
    return [
        broadcast_pose(of_joint[f.joint] @ f.placement if f.joint >= 0 else f.placement, q) for f in frames
    ]


def joint_velocities(model: Model, q: Array, v: Array) -> list[Motion]:
    """V of the moving frame of every joint in its own coordinates [m/s, rad/s].

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        One twist a joint, with the batch axes of `q` and `v` [m/s, rad/s].
    """
    tree = steps(model)
    velocities = body_velocities(tree, q, v)
    return [broadcast_motion(V, q, v) for V, step in zip(velocities, tree, strict=True) if step.is_last]


def joint_accelerations(model: Model, q: Array, v: Array, a: Array | None) -> list[Motion]:
    """A of the moving frame of every joint in its own coordinates [m/s^2, rad/s^2], without gravity.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2]; None for zero.

    Returns:
        One spatial acceleration a joint, with the batch axes of the inputs [m/s^2, rad/s^2].
    """
    tree = steps(model)
    inputs = (q, v) if a is None else (q, v, a)
    motions = body_accelerations(tree, q, v, a)
    return [broadcast_motion(A, *inputs) for (_, A), step in zip(motions, tree, strict=True) if step.is_last]


def frame_velocity(
    model: Model, q: Array, v: Array, frame: Frame, reference: Reference = "local_world_aligned"
) -> Motion:
    """The twist of a frame.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        frame: A frame of the model.
        reference: "world", "local" or "local_world_aligned".

    Returns:
        The twist in `reference`, with the batch axes of `q` and `v` [m/s, rad/s].
    """
    check_reference(reference)
    tree = chain(model, frame)
    if not tree:
        return broadcast_motion(Motion.zero(), q, v)
    placement = relevant_placement(frame.placement, reference)
    V = placement.act_inverse(body_velocities(tree, q, v)[-1])
    return broadcast_motion(in_reference(V, tip_pose(tree, q, placement), reference), q, v)


def frame_acceleration(
    model: Model,
    q: Array,
    v: Array,
    a: Array | None,
    frame: Frame,
    reference: Reference = "local_world_aligned",
    classical: bool = False,
) -> Motion:
    """The acceleration of a frame [m/s^2, rad/s^2], without gravity.

    With the Jacobian of the same reference, J a + (dJ/dt) v is the spatial acceleration in "world" and
    "local", and the classical one in "local_world_aligned".

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2]; None for zero.
        frame: A frame of the model.
        reference: "world", "local" or "local_world_aligned".
        classical: Whether the linear part is the acceleration of the body's point at the origin, instead of the
            spatial one.

    Returns:
        The acceleration in `reference`, with the batch axes of the inputs [m/s^2, rad/s^2].
    """
    check_reference(reference)
    inputs = (q, v) if a is None else (q, v, a)
    tree = chain(model, frame)
    if not tree:
        return broadcast_motion(Motion.zero(), *inputs)

    V, A = body_accelerations(tree, q, v, a)[-1]
    placement = relevant_placement(frame.placement, reference)
    V, A = placement.act_inverse(V), placement.act_inverse(A)
    T = tip_pose(tree, q, placement)
    if classical and reference != "world":  # the frame's axes do as well as the world's, and cost less
        A = Motion(A.linear + cross(V.angular, V.linear), A.angular)
    A = in_reference(A, T, reference)
    if classical and reference == "world":
        V = in_reference(V, T, reference)
        A = Motion(A.linear + cross(V.angular, V.linear), A.angular)
    return broadcast_motion(A, *inputs)
