"""Regressors: what dynamics are linear in."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from pinocchio._algorithms.frame_arguments import key_of
from pinocchio._containers.arguments import check_model_and_data, checks_itself
from pinocchio._containers.arrays import index, not_applicable
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import BODIES, JOINTS, VELOCITIES_IN_WORLD, rows, stacked
from pinocchio._data.functions import algorithm
from pinocchio._data.states import compiled_for
from pinocchio._model.model import Model
from pinocchio._spatial.bound_functions import BoundFunctions
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from pinocchio._spatial.small_kernels import pose
from ulna import algorithms, spatial
from ulna.compiler import compile as compile_function
from ulna.compiler.runtime.repeated_calls import CallCache, call_cache, repeated_calls
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


def _body_regressor_at(m: Array, v: Array, a: Array) -> Array:
    back = pose(m).inverse()
    return _body_regressor(*(back.act(spatial.Motion(x[:3], x[3:])) for x in (v, a)))


_AT_JOINT = SE3()
_REGRESSORS = BoundFunctions(
    {
        "body": (
            lambda *motions: _body_regressor(*(spatial.Motion(x[:3], x[3:]) for x in motions)),
            (6,),
            (6,),
        )
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


_joint_calls, _frame_calls = call_cache(3, weak=2), call_cache(3, weak=2)


@repeated_calls(_joint_calls)
@checks_itself
def jointBodyRegressor(model: Model, data: Data, joint_id: int) -> Floats:
    """The regressor of the body of a joint, in the frame of the joint.

    Args:
        data: Its data, after rnea.

    Returns:
        Matrix (6, 10).
    """
    regressor = _repeated(model, data, (joint_id, "joint body regressor"), _joint_calls)
    if regressor is not NotImplemented:
        return regressor
    check_model_and_data("jointBodyRegressor", model, data)
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _bound(model, data, (joint_id, "joint body regressor"), joint, _AT_JOINT._m, ("structure",))


@repeated_calls(_frame_calls)
@checks_itself
def frameBodyRegressor(model: Model, data: Data, frame_id: int) -> Floats:
    """The regressor of the body that a frame is on, in that frame.

    Args:
        data: Its data, after rnea.

    Returns:
        Matrix (6, 10).
    """
    regressor = _repeated(model, data, (frame_id, "frame body regressor"), _frame_calls)
    if regressor is not NotImplemented:
        return regressor
    check_model_and_data("frameBodyRegressor", model, data)
    key = index(frame_id, model.nframes, "frame", "model.getFrameId(name) returns one.")
    frame = model.frames[key]
    return _bound(
        model, data, (frame_id, "frame body regressor"), frame.parentJoint, frame.placement._m, ("frame", key)
    )


def _repeated(model: Model, data: Data, place: tuple[Any, str], calls: CallCache) -> Any:
    """The regressor by the kernel that is bound at `place`; NotImplemented where it does not apply."""
    try:
        step = data._bound_at[key_of(place[0]), place[1]]
        regressor = step() if data._model is model else NotImplemented
    except (KeyError, TypeError, AttributeError):  # not bound yet, or of no model or data
        return NotImplemented
    if regressor is not NotImplemented:
        calls.add(step, 0, model, data, place[0])
    return regressor


def _bound(
    model: Model, data: Data, place: tuple[Any, str], joint: int, placement: Floats, on: Any
) -> Floats:
    """The regressor in a frame on a joint, whose motion and weight rnea left; bound at `place` for the next time."""
    watch = model._watched(*on)
    compiled_for(model, data)
    data._require(data._qv, "rnea(model, data, q, v, a)")
    data._read("a_gf")
    step = data._bound_at.get(place, not_applicable) if data._model is model else not_applicable
    regressor = step()  # what was deferred may be there now
    if regressor is not NotImplemented:
        return regressor
    fields = ("v", "a_gf")
    watch += [(data._mark_of(field), np.zeros(())) for field in fields]
    read = [placement, *(data._arrays[field][joint] for field in fields)]

    def bind(otherwise: Any) -> Any:
        target = data._arrays["bodyRegressor"]
        return _regressor_kernel().into(
            target, returns=(0,), watch=watch, otherwise=otherwise, trailing_inputs=read
        )

    step = data._bound_after_reads(fields, bind)
    if data._model is model:
        data._bound_at[place] = step
    return step()


@cache
def _regressor_kernel() -> Any:
    """The compiled regressor of a body at a placement on a joint."""
    return compile_function(_body_regressor_at, m=(4, 4), v=(6,), a=(6,))
