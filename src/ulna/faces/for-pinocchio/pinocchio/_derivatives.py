"""Derivatives of dynamics and of kinematics by configuration, velocity and acceleration."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._arrays import index, vector
from pinocchio._data import Data, engine_for
from pinocchio._dynamics import computeGeneralizedGravity, computeStaticTorque, external, under_forces
from pinocchio._enums import ReferenceFrame, reference_of
from pinocchio._jacobians import RATES, computeJointJacobians, computeJointJacobiansTimeVariation, rates
from pinocchio._kinematics import at_frame, at_joint, forwardKinematics, rows
from pinocchio._masses import ccrba, computeCentroidalMomentumTimeVariation
from pinocchio._model import Model
from pinocchio._runs import Algorithm, run
from pinocchio._states import NOT_MOTION, NOT_SPEED, OWN
from ulna import algorithms
from ulna.model import Frame
from ulna.model import Model as TowerModel
from ulna.recipes.base import with_mass
from ulna.typing import Array, Floats

__all__ = [
    "computeABADerivatives",
    "computeCentroidalDynamicsDerivatives",
    "computeForwardKinematicsDerivatives",
    "computeGeneralizedGravityDerivatives",
    "computeRNEADerivatives",
    "computeStaticTorqueDerivatives",
    "getCenterOfMassVelocityDerivatives",
    "getCentroidalDynamicsDerivatives",
    "getFrameAccelerationDerivatives",
    "getFrameVelocityDerivatives",
    "getJointAccelerationDerivatives",
    "getJointVelocityDerivatives",
    "getPointClassicAccelerationDerivatives",
    "getPointVelocityDerivatives",
]


def _inverse(model: TowerModel) -> Any:
    def run(q: Array, v: Array, a: Array) -> tuple[Array, ...]:
        found = algorithms.inverse_dynamics_derivatives(model, q, v, a)
        gains = rows(algorithms.joint_accelerations(model, q, v, a))
        state = (q, v, a, gains, q, v, a)
        return (*found, algorithms.inverse_dynamics(model, q, v, a), *state, *rates(model)(q, v))

    return run


def _forward(model: TowerModel) -> Any:
    def run(q: Array, v: Array, tau: Array) -> tuple[Array, ...]:
        by_q, by_v, by_tau = algorithms.forward_dynamics_derivatives(model, q, v, tau)
        ddq = algorithms.forward_dynamics(model, q, v, tau)
        return by_q, by_v, by_tau, by_tau, ddq, *rates(model)(q, v)

    return run


_STATE = ("derivatives q", "derivatives v", "derivatives a")
_RNEA = Algorithm(
    "rnea_derivatives",
    "qva",
    ("dtau_dq", "dtau_dv", "M", "tau", *_STATE, "a", "gains q", "gains v", "gains a", *RATES),
    _inverse,
    (0, 1, 2),
)
_ABA = Algorithm(
    "aba_derivatives",
    "qvt",
    ("ddq_dq", "ddq_dv", "ddq_dtau", "Minv", "ddq", *RATES),
    with_mass(_forward),
    (0, 1, 2),
)


def computeRNEADerivatives(
    model: Model, data: Data, q: Any, v: Any, a: Any, fext: Any = None
) -> tuple[Floats, Floats, Floats]:
    """Derivatives of the torques by q, v and a (the mass matrix), (nv, nv) each; kept in `data`."""
    if fext is None:
        step = data._run.rnea_derivatives
        found = step(q, v, a) if data._model is model else NotImplemented
        if found is NotImplemented:
            found = run(model, data, _RNEA, q, v, a)
        data._due = data._due & NOT_MOTION | OWN
        return found
    F, engine = external(fext, model.njoints), data.attach(model)
    state = vector(q, model.nq, "q"), vector(v, model.nv, "v"), vector(a, model.nv, "a")
    found = under_forces(engine, algorithms.inverse_dynamics_derivatives, *state, F)
    for name, block in zip(("dtau_dq", "dtau_dv", "M"), found, strict=True):
        data._blocks[name][:] = block
    data._of_derivatives = state
    forwardKinematics(model, data, *state)
    computeJointJacobiansTimeVariation(model, data, *state[:2])
    return found


def computeABADerivatives(
    model: Model, data: Data, q: Any, v: Any, tau: Any, fext: Any = None
) -> tuple[Floats, Floats, Floats]:
    """Derivatives of the accelerations by q, v and tau (the inverse mass matrix), (nv, nv) each; kept in `data`."""
    if fext is None:
        step = data._run.aba_derivatives
        found = step(q, v, tau) if data._model is model else NotImplemented
        if found is NotImplemented:
            found = run(model, data, _ABA, q, v, tau)
        data._due = data._due & NOT_SPEED | OWN
        return found
    F, engine = external(fext, model.njoints), data.attach(model)
    state = vector(q, model.nq, "q"), vector(v, model.nv, "v"), vector(tau, model.nv, "tau")
    found = under_forces(engine, algorithms.forward_dynamics_derivatives, *state, F)
    ddq = under_forces(engine, algorithms.forward_dynamics, *state, F)
    for name, block in zip(
        ("ddq_dq", "ddq_dv", "ddq_dtau", "Minv", "ddq"), (*found, found[2], ddq), strict=True
    ):
        data._blocks[name][:] = block
    computeJointJacobiansTimeVariation(model, data, *state[:2])
    return tuple(found)


def computeGeneralizedGravityDerivatives(model: Model, data: Data, q: Any) -> Floats:
    """The derivative (nv, nv) of the torques against gravity by q."""
    q, rest = vector(q, model.nq, "q"), np.zeros(model.nv)
    computeGeneralizedGravity(model, data, q)
    computeJointJacobians(model, data, q)
    return engine_for(model, data).kernel("inverse_dynamics_derivatives")(q, rest, rest)[0]


def computeStaticTorqueDerivatives(model: Model, data: Data, q: Any, fext: Any) -> Floats:
    """The derivative (nv, nv) of the torques against gravity and forces on the joints by q."""
    q, rest, F = vector(q, model.nq, "q"), np.zeros(model.nv), external(fext, model.njoints)
    computeStaticTorque(model, data, q, fext)
    computeJointJacobians(model, data, q)
    engine = engine_for(model, data)
    return under_forces(engine, algorithms.inverse_dynamics_derivatives, q, rest, rest, F)[0]


def computeForwardKinematicsDerivatives(model: Model, data: Data, q: Any, v: Any, a: Any = None) -> None:
    """Prepares the derivatives of velocities and accelerations of joints and frames."""
    a = np.zeros(model.nv) if a is None else a
    forwardKinematics(model, data, q, v, a)
    computeJointJacobiansTimeVariation(model, data, q, v)


def getJointVelocityDerivatives(
    model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame
) -> tuple[Floats, Floats]:
    """Derivatives of a joint's velocity by q and v, (6, nv) each."""
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) gives one.")
    return _motions(model, data, ("joint", joint), at_joint(joint), reference_frame, False)


def getFrameVelocityDerivatives(
    model: Model, data: Data, *place: Any, reference_frame: Any = None
) -> tuple[Floats, Floats]:
    """Derivatives of a frame's velocity (its index, or a joint's and a placement) by q and v, (6, nv) each."""
    *where, rf = place if reference_frame is None else (*place, reference_frame)
    key, given = at_frame(model, tuple(where))
    return _motions(model, data, key, given, rf, False)


def getJointAccelerationDerivatives(
    model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame
) -> tuple[Floats, ...]:
    """Derivatives of a joint's velocity by q, and of its acceleration by q, v and a, (6, nv) each."""
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) gives one.")
    return _motions(model, data, ("joint", joint), at_joint(joint), reference_frame, True)


def getFrameAccelerationDerivatives(
    model: Model, data: Data, *place: Any, reference_frame: Any = None
) -> tuple[Floats, ...]:
    """Derivatives of a frame's velocity by q, and of its acceleration by q, v and a, (6, nv) each."""
    *where, rf = place if reference_frame is None else (*place, reference_frame)
    key, given = at_frame(model, tuple(where))
    return _motions(model, data, key, given, rf, True)


def _motions(model: Model, data: Data, key: Any, given: Frame | None, rf: Any, with_a: bool) -> Any:
    reference = reference_of(rf)
    state = data.require(data._qva, "computeForwardKinematicsDerivatives(model, data, q, v, a)")

    def build(tower: TowerModel, frames: Sequence[Frame]) -> Any:
        frame = frames[key] if given is None else given

        return lambda q, v, a: algorithms.motion_derivatives(tower, q, v, a, frame, reference)

    shapes: dict[str, Any] = {"q": (model.nq,), "v": (model.nv,), "a": (model.nv,)}
    kernel = engine_for(model, data).of_frame(("derivatives", key, reference), build, **shapes)
    V_q, V_v, *of_a = kernel(*state)
    return (V_q, *of_a) if with_a else (V_q, V_v)


def getPointVelocityDerivatives(
    model: Model, data: Data, joint_id: int, placement: Any, reference_frame: ReferenceFrame
) -> tuple[Floats, Floats]:
    """Derivatives of the velocity of a point on a joint by q and v, (3, nv) each, in LOCAL or LOCAL_WORLD_ALIGNED."""
    return _point(model, data, joint_id, placement, reference_frame)[:2]


def getPointClassicAccelerationDerivatives(
    model: Model, data: Data, joint_id: int, placement: Any, reference_frame: ReferenceFrame
) -> tuple[Floats, Floats, Floats, Floats]:
    """Derivatives of that velocity by q, and of the point's acceleration by q, v and a, (3, nv) each."""
    u_q, _, *rest = _point(model, data, joint_id, placement, reference_frame)
    return (u_q, *rest)


def _point(model: Model, data: Data, joint_id: int, placement: Any, rf: Any) -> Any:
    key, frame = at_frame(model, (joint_id, placement))
    state = data.require(data._qva, "computeForwardKinematicsDerivatives(model, data, q, v, a)")
    reference: Any = reference_of(rf)

    def build(tower: TowerModel, frames: Sequence[Frame]) -> Any:
        return lambda q, v, a: algorithms.point_derivatives(tower, q, v, a, frame, reference)

    shapes: dict[str, Any] = {"q": (model.nq,), "v": (model.nv,), "a": (model.nv,)}
    return engine_for(model, data).of_frame(("point", key, reference), build, **shapes)(*state)


def computeCentroidalDynamicsDerivatives(
    model: Model, data: Data, q: Any, v: Any, a: Any
) -> tuple[Floats, ...]:
    """Derivatives of the centroidal momentum by q, and of its rate by q, v and a, (6, nv) each."""
    state = vector(q, model.nq, "q"), vector(v, model.nv, "v"), vector(a, model.nv, "a")
    found = engine_for(model, data).kernel("centroidal_derivatives")(*state)
    for name, block in zip(("dHdq", "dFdq", "dFdv", "dFda"), found, strict=True):
        data._blocks[name][:] = block
    computeCentroidalMomentumTimeVariation(model, data, *state)
    ccrba(model, data, *state[:2])
    computeJointJacobiansTimeVariation(model, data, *state[:2])
    return found


def getCentroidalDynamicsDerivatives(model: Model, data: Data) -> tuple[Floats, ...]:
    """The same at the state of the last computeRNEADerivatives."""
    state = data.require(data._of_derivatives, "computeRNEADerivatives(model, data, q, v, a)")
    return computeCentroidalDynamicsDerivatives(model, data, *state)


def getCenterOfMassVelocityDerivatives(model: Model, data: Data) -> Floats:
    """The derivative (3, nv) of the velocity of the centre of mass by q."""
    q, v = data.require(data._qv, "computeForwardKinematicsDerivatives(model, data, q, v)")
    return engine_for(model, data).kernel("com_velocity_derivatives")(q, v)[0]
