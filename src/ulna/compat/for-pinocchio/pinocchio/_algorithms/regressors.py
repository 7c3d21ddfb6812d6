"""Regressors: what dynamics are linear in."""

from __future__ import annotations

from typing import Any

from pinocchio._algorithms.kinematics import forwardKinematics
from pinocchio._containers.arrays import index, vector
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import BODIES, defer_joint_placements
from pinocchio._data.evaluated_model import kernels_for
from pinocchio._data.states import compiled_for
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from ulna import algorithms
from ulna.typing import Floats

__all__ = [
    "bodyRegressor",
    "computeJointTorqueRegressor",
    "computeKineticEnergyRegressor",
    "computePotentialEnergyRegressor",
    "computeStaticRegressor",
    "frameBodyRegressor",
    "jointBodyRegressor",
]


def computeJointTorqueRegressor(model: Model, data: Data, q: Any, v: Any, a: Any) -> Floats:
    """The matrix that multiplies the dynamic parameters of all bodies in the torques; kept in
    `data.jointTorqueRegressor`.

    Returns:
        Matrix (nv, 10 k), k = njoints - 1.
    """
    state = vector(q, model.nq, "q"), vector(v, model.nv, "v"), vector(a, model.nv, "a")
    compiled = kernels_for(model, data, "torque regressor")
    regressor = compiled.kernel("joint_torque_regressor")(*state)
    defer_joint_placements(data, compiled, *state[:2])
    data.defer(BODIES["f"], ("v", "ov", "a_gf", "oa_gf"), compiled, *(x.copy() for x in state))
    return _stored(data, "jointTorqueRegressor", regressor)


def computeStaticRegressor(model: Model, data: Data, q: Any) -> Floats:
    """The matrix that multiplies masses and first moments of all bodies in the centre of mass.

    Returns:
        Matrix (3, 4 k), k = njoints - 1.
    """
    forwardKinematics(model, data, q)
    kernel = kernels_for(model, data, "static").kernel("static_regressor")
    return _stored(data, "staticRegressor", kernel(vector(q, model.nq, "q")))


def computeKineticEnergyRegressor(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The vector that multiplies the dynamic parameters of all bodies in the kinetic energy.

    Returns:
        Vector (10 k,), k = njoints - 1.
    """
    forwardKinematics(model, data, q, v)
    kernel = kernels_for(model, data, "kinetic").kernel("kinetic_energy_regressor")
    return _stored(data, "kineticEnergyRegressor", kernel(vector(q, model.nq, "q"), vector(v, model.nv, "v")))


def computePotentialEnergyRegressor(model: Model, data: Data, q: Any) -> Floats:
    """The vector that multiplies the dynamic parameters of all bodies in the potential energy.

    Returns:
        Vector (10 k,), k = njoints - 1.
    """
    forwardKinematics(model, data, q)
    kernel = kernels_for(model, data, "potential").kernel("potential_energy_regressor")
    return _stored(data, "potentialEnergyRegressor", kernel(vector(q, model.nq, "q")))


def bodyRegressor(velocity: Motion, acceleration: Motion) -> Floats:
    """The matrix that multiplies the dynamic parameters of a body in the force on it.

    Args:
        velocity: Spatial velocity of the body.
        acceleration: Spatial acceleration of the body, gravity subtracted.

    Returns:
        Matrix (6, 10).
    """
    value = algorithms.body_regressor(velocity._value(), acceleration._value())
    return value


def jointBodyRegressor(model: Model, data: Data, joint_id: int) -> Floats:
    """The regressor of the body of a joint, in the frame of the joint.

    Args:
        data: Its data, after rnea.

    Returns:
        Matrix (6, 10).
    """
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _body(model, data, joint, SE3())


def frameBodyRegressor(model: Model, data: Data, frame_id: int) -> Floats:
    """The regressor of the body that a frame is on, in that frame.

    Args:
        data: Its data, after rnea.

    Returns:
        Matrix (6, 10).
    """
    frame = model.frames[index(frame_id, model.nframes, "frame", "model.getFrameId(name) returns one.")]
    return _body(model, data, frame.parentJoint, frame.placement)


def _body(model: Model, data: Data, joint: int, placement: SE3) -> Floats:
    """The regressor in a frame at a placement on a joint, whose motion and weight rnea left."""
    compiled_for(model, data)
    data.require(data._qv, "rnea(model, data, q, v, a)")
    moves = (placement.actInv(motion[joint]) for motion in (data.v, data.a_gf))
    return _stored(data, "bodyRegressor", bodyRegressor(*moves))


def _stored(data: Data, name: str, regressor: Floats) -> Floats:
    data._arrays[name][:] = regressor
    return regressor
