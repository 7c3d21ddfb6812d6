"""Regressors: what dynamics are linear in."""

from __future__ import annotations

from typing import Any

from pinocchio._algorithms.kinematics import forwardKinematics
from pinocchio._containers.arrays import index, vector
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import BODIES, defer_joint_placements
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
    """The matrix (nv, 10 (njoints - 1)) that makes torques of dynamic parameters."""
    state = vector(q, model.nq, "q"), vector(v, model.nv, "v"), vector(a, model.nv, "a")
    compiled = data.attach(model)
    regressor = compiled.kernel("joint_torque_regressor")(*state)
    defer_joint_placements(data, compiled, *state[:2])
    data.defer(BODIES["f"], ("v", "ov", "a_gf", "oa_gf"), compiled, *(x.copy() for x in state))
    return _stored(data, "jointTorqueRegressor", regressor)


def computeStaticRegressor(model: Model, data: Data, q: Any) -> Floats:
    """The matrix (3, 4 (njoints - 1)) that makes the centre of mass of masses and first moments."""
    forwardKinematics(model, data, q)
    kernel = compiled_for(model, data).kernel("static_regressor")
    return _stored(data, "staticRegressor", kernel(vector(q, model.nq, "q")))


def computeKineticEnergyRegressor(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The vector (10 (njoints - 1),) that makes kinetic energy of dynamic parameters."""
    forwardKinematics(model, data, q, v)
    kernel = compiled_for(model, data).kernel("kinetic_energy_regressor")
    return _stored(data, "kineticEnergyRegressor", kernel(vector(q, model.nq, "q"), vector(v, model.nv, "v")))


def computePotentialEnergyRegressor(model: Model, data: Data, q: Any) -> Floats:
    """The same of potential energy."""
    forwardKinematics(model, data, q)
    kernel = compiled_for(model, data).kernel("potential_energy_regressor")
    return _stored(data, "potentialEnergyRegressor", kernel(vector(q, model.nq, "q")))


def bodyRegressor(velocity: Motion, acceleration: Motion) -> Floats:
    """The matrix (6, 10) that makes the force on a body of its dynamic parameters."""
    value = algorithms.body_regressor(velocity._value(), acceleration._value())
    return value


def jointBodyRegressor(model: Model, data: Data, joint_id: int) -> Floats:
    """The regressor (6, 10) of the body of a joint, after rnea."""
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _body(model, data, joint, SE3())


def frameBodyRegressor(model: Model, data: Data, frame_id: int) -> Floats:
    """The same in a frame of the body."""
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
