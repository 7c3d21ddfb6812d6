"""Regressors: what dynamics are linear in."""

from __future__ import annotations

from typing import Any

from pinocchio._containers.arrays import index
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import BODIES, JOINTS, VELOCITIES_IN_WORLD, rows, stacked
from pinocchio._data.functions import algorithm
from pinocchio._model.model import Model
from pinocchio._spatial.bound_functions import BoundFunctions
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from pinocchio._spatial.small_kernels import pose
from ulna import algorithms, spatial
from ulna.model import Model as CoreModel
from ulna.typing import Array, Floats

__all__ = [
    "bodyRegressor",
    "computeJointTorqueRegressor",
    "computeKineticEnergyRegressor",
    "computePotentialEnergyRegressor",
    "computeStaticRegressor",
    "frameBodyRegressor",
    "jointBodyRegressor",
]


def _torque_regressor(model: CoreModel) -> Any:
    return lambda q, v, a: algorithms.joint_torque_regressor(model, q, v, a)


def _static_regressor(model: CoreModel) -> Any:
    return lambda q: (algorithms.static_regressor(model, q), stacked(algorithms.joint_poses(model, q)))


def _kinetic_regressor(model: CoreModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        row = algorithms.kinetic_energy_regressor(model, q, v)
        return row, stacked(algorithms.joint_poses(model, q)), rows(algorithms.joint_velocities(model, q, v))

    return run


def _potential_regressor(model: CoreModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        return algorithms.potential_energy_regressor(model, q), stacked(algorithms.joint_poses(model, q))

    return run


@algorithm(
    fills=("jointTorqueRegressor",),
    kernel=_torque_regressor,
    returns=(0,),
    deferred=JOINTS | {name: BODIES[name] for name in ("v", "ov", "a_gf", "oa_gf")},
)
def computeJointTorqueRegressor(model: Model, data: Data, q: Any, v: Any, a: Any) -> Floats:
    """The matrix that multiplies the dynamic parameters of all bodies in the torques; kept in
    `data.jointTorqueRegressor`.

    Returns:
        Matrix (nv, 10 k), k = njoints - 1.
    """
    ...


@algorithm(fills=("staticRegressor", "oMi"), kernel=_static_regressor, returns=(0,), deferred=JOINTS)
def computeStaticRegressor(model: Model, data: Data, q: Any) -> Floats:
    """The matrix that multiplies masses and first moments of all bodies in the centre of mass.

    Returns:
        Matrix (3, 4 k), k = njoints - 1.
    """
    ...


@algorithm(
    fills=("kineticEnergyRegressor", "oMi", "v"),
    kernel=_kinetic_regressor,
    returns=(0,),
    deferred=JOINTS | VELOCITIES_IN_WORLD,
)
def computeKineticEnergyRegressor(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The vector that multiplies the dynamic parameters of all bodies in the kinetic energy.

    Returns:
        Vector (10 k,), k = njoints - 1.
    """
    ...


@algorithm(
    fills=("potentialEnergyRegressor", "oMi"), kernel=_potential_regressor, returns=(0,), deferred=JOINTS
)
def computePotentialEnergyRegressor(model: Model, data: Data, q: Any) -> Floats:
    """The vector that multiplies the dynamic parameters of all bodies in the potential energy.

    Returns:
        Vector (10 k,), k = njoints - 1.
    """
    ...


def _body_regressor(*motions: spatial.Motion) -> Array:
    return algorithms.body_regressor(*motions)


def _body_regressor_at(m: Array, *motions: Array) -> Array:
    back = pose(m).inverse()
    return _body_regressor(*(back.act(spatial.Motion(x[:3], x[3:])) for x in motions))


_AT_JOINT = SE3()
_REGRESSORS = BoundFunctions(
    {
        "body": (
            lambda *motions: _body_regressor(*(spatial.Motion(x[:3], x[3:]) for x in motions)),
            (6,),
            (6,),
        ),
        "placed": (_body_regressor_at, (4, 4), (6,), (6,)),
    }
)


def bodyRegressor(velocity: Motion, acceleration: Motion) -> Floats:
    """The matrix that multiplies the dynamic parameters of a body in the force on it.

    Args:
        velocity: Spatial velocity of the body.
        acceleration: Spatial acceleration of the body, gravity subtracted.

    Returns:
        Matrix (6, 10).
    """
    return _REGRESSORS["body"](velocity._v, acceleration._v)


def jointBodyRegressor(model: Model, data: Data, joint_id: int) -> Floats:
    """The regressor of the body of a joint, in the frame of the joint.

    Args:
        data: Its data, after rnea.

    Returns:
        Matrix (6, 10).
    """
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _body(model, data, joint, _AT_JOINT)


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
    data.require(data._qv, "rnea(model, data, q, v, a)")
    moves = (motion[joint]._v for motion in (data.v, data.a_gf))
    return _stored(data, "bodyRegressor", _REGRESSORS["placed"](placement._m, *moves))


def _stored(data: Data, name: str, regressor: Floats) -> Floats:
    data._arrays[name][:] = regressor
    return regressor
