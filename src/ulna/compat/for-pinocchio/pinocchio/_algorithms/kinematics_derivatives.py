"""Derivatives of velocities and accelerations of joints, frames, points and the centre of mass."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._algorithms.frame_arguments import at_frame, at_frame_or_joint, at_joint
from pinocchio._algorithms.jacobians import computeJointJacobiansTimeVariation
from pinocchio._algorithms.kinematics import forwardKinematics, updateFramePlacement
from pinocchio._containers.arrays import index
from pinocchio._containers.enums import ReferenceFrame, reference_of
from pinocchio._data.data import Data
from pinocchio._data.evaluated_model import kernels_for
from pinocchio._model.model import Model
from ulna import algorithms
from ulna.model import Frame
from ulna.model import Model as CoreModel
from ulna.typing import Floats

__all__ = [
    "computeForwardKinematicsDerivatives",
    "getCenterOfMassVelocityDerivatives",
    "getFrameAccelerationDerivatives",
    "getFrameVelocityDerivatives",
    "getJointAccelerationDerivatives",
    "getJointVelocityDerivatives",
    "getPointClassicAccelerationDerivatives",
    "getPointVelocityDerivatives",
]


def computeForwardKinematicsDerivatives(model: Model, data: Data, q: Any, v: Any, a: Any = None) -> None:
    """Prepares the derivatives of velocities and accelerations of joints and frames.

    Args:
        a: Acceleration (nv,) [rad/s^2 or m/s^2]; zero by default.
    """
    a = np.zeros(model.nv) if a is None else a
    forwardKinematics(model, data, q, v, a)
    computeJointJacobiansTimeVariation(model, data, q, v)


def getJointVelocityDerivatives(
    model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame
) -> tuple[Floats, Floats]:
    """Derivatives of a joint's velocity by q and v, (6, nv) each.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.

    Returns:
        Two matrices (6, nv).
    """
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _motions(model, data, ("joint", joint), at_joint(joint), reference_frame, False)


@at_frame_or_joint
def getFrameVelocityDerivatives(
    model: Model,
    data: Data,
    frame_id: int | None = None,
    placement: Any = None,
    reference_frame: Any = None,
    joint_id: int | None = None,
) -> tuple[Floats, Floats]:
    """Derivatives of a frame's velocity (its index, or a joint's and a placement) by q and v, (6, nv) each.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.
        placement: Pose of the frame in the frame of the joint `joint_id`, an SE3.

    Returns:
        Two matrices (6, nv).
    """
    key, fixed_frame = at_frame(model, frame_id, joint_id, placement)
    return _motions(model, data, key, fixed_frame, reference_frame, False)


def getJointAccelerationDerivatives(
    model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame
) -> tuple[Floats, ...]:
    """Derivatives of a joint's velocity by q, and of its acceleration by q, v and a, (6, nv) each.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.

    Returns:
        Four matrices (6, nv).
    """
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _motions(model, data, ("joint", joint), at_joint(joint), reference_frame, True)


@at_frame_or_joint
def getFrameAccelerationDerivatives(
    model: Model,
    data: Data,
    frame_id: int | None = None,
    placement: Any = None,
    reference_frame: Any = None,
    joint_id: int | None = None,
) -> tuple[Floats, ...]:
    """Derivatives of a frame's velocity by q, and of its acceleration by q, v and a, (6, nv) each.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.
        placement: Pose of the frame in the frame of the joint `joint_id`, an SE3.

    Returns:
        Four matrices (6, nv).
    """
    key, fixed_frame = at_frame(model, frame_id, joint_id, placement)
    return _motions(model, data, key, fixed_frame, reference_frame, True)


def _motions(model: Model, data: Data, key: Any, fixed_frame: Frame | None, rf: Any, with_a: bool) -> Any:
    reference = reference_of(rf)
    state = data.require(data._qva, "computeForwardKinematicsDerivatives(model, data, q, v, a)")

    def build(core: CoreModel, frames: Sequence[Frame]) -> Any:
        frame = frames[key] if fixed_frame is None else fixed_frame

        return lambda q, v, a: algorithms.motion_derivatives(core, q, v, a, frame, reference)

    shapes: dict[str, Any] = {"q": (model.nq,), "v": (model.nv,), "a": (model.nv,)}
    kernel = kernels_for(model, data, "motion derivatives").compile_at_frames(
        ("derivatives", key, reference), build, **shapes
    )
    V_q, V_v, *of_a = kernel(*state)
    if fixed_frame is None:
        updateFramePlacement(model, data, key)
    return (V_q, *of_a) if with_a else (V_q, V_v)


def getPointVelocityDerivatives(
    model: Model, data: Data, joint_id: int, placement: Any, reference_frame: ReferenceFrame
) -> tuple[Floats, Floats]:
    """Derivatives of the velocity of a point on a joint by q and v, (3, nv) each, in LOCAL or LOCAL_WORLD_ALIGNED.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.
        placement: Pose in the frame of the joint, an SE3; its origin is the point.
        reference_frame: LOCAL or LOCAL_WORLD_ALIGNED.

    Returns:
        Two matrices (3, nv).
    """
    return _point(model, data, joint_id, placement, reference_frame)[:2]


def getPointClassicAccelerationDerivatives(
    model: Model, data: Data, joint_id: int, placement: Any, reference_frame: ReferenceFrame
) -> tuple[Floats, Floats, Floats, Floats]:
    """Derivatives of that velocity by q, and of the point's acceleration by q, v and a, (3, nv) each.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.
        placement: Pose in the frame of the joint, an SE3; its origin is the point.
        reference_frame: LOCAL or LOCAL_WORLD_ALIGNED.

    Returns:
        Four matrices (3, nv).
    """
    u_q, _, *rest = _point(model, data, joint_id, placement, reference_frame)
    return (u_q, *rest)


def _point(model: Model, data: Data, joint_id: int, placement: Any, rf: Any) -> Any:
    key, frame = at_frame(model, None, joint_id, placement)
    state = data.require(data._qva, "computeForwardKinematicsDerivatives(model, data, q, v, a)")
    reference: Any = reference_of(rf)

    def build(core: CoreModel, frames: Sequence[Frame]) -> Any:
        return lambda q, v, a: algorithms.point_derivatives(core, q, v, a, frame, reference)

    shapes: dict[str, Any] = {"q": (model.nq,), "v": (model.nv,), "a": (model.nv,)}
    return kernels_for(model, data, "point derivatives").compile_at_frames(
        ("point", key, reference), build, **shapes
    )(*state)


def getCenterOfMassVelocityDerivatives(model: Model, data: Data) -> Floats:
    """The derivative (3, nv) of the velocity of the centre of mass by q.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.

    Returns:
        Matrix (3, nv).
    """
    q, v = data.require(data._qv, "computeForwardKinematicsDerivatives(model, data, q, v)")
    return kernels_for(model, data, "com derivatives").kernel("com_velocity_derivatives")(q, v)[0]
