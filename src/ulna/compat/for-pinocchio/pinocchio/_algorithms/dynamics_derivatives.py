"""Derivatives of dynamics by configuration, velocity and acceleration."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.center_of_mass import about_origin, as_one_body
from pinocchio._algorithms.dynamics import external, rnea, under_forces
from pinocchio._algorithms.jacobians import (
    JACOBIAN_RATES,
    JACOBIANS,
    columns,
    computeJointJacobians,
    rates,
)
from pinocchio._algorithms.stored_derivatives import CENTROIDAL
from pinocchio._algorithms.stored_dynamics import derivative_calls, derivatives_of_fields
from pinocchio._containers.arguments import checked
from pinocchio._containers.arrays import not_applicable, vector
from pinocchio._containers.keywords import overloads
from pinocchio._data.algorithm import Algorithm
from pinocchio._data.binding import run
from pinocchio._data.compiled_fields import split_forces
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import (
    ACCELERATIONS_IN_WORLD,
    BODIES,
    BODIES_UNDER_FORCES,
    CENTERS,
    JOINTS,
    SUBTREE_MOMENTA_IN_WORLD,
    TORQUE_DERIVATIVES,
    TORQUE_DERIVATIVES_UNDER_FORCES,
    VELOCITIES_IN_WORLD,
    rows,
)
from pinocchio._data.derivative_columns import (
    ACCELERATION_COLUMNS,
    DERIVATIVE_COLUMNS,
    DERIVATIVE_COLUMNS_UNDER_FORCES,
)
from pinocchio._data.evaluated_model import EvaluatedModel
from pinocchio._data.first_evaluation import loaded_evaluator
from pinocchio._data.functions import algorithm, fast_path
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import checked_forces
from pinocchio._tables.recursions import DYNAMICS
from pinocchio._tables.world_derivatives import WorldDerivatives
from ulna import algorithms
from ulna.compiler.runtime.repeated_calls import call_cache, repeated_calls
from ulna.model import Model as CoreModel
from ulna.quantities.mass import with_mass
from ulna.typing import Array, Floats

__all__ = [
    "computeABADerivatives",
    "computeCentroidalDynamicsDerivatives",
    "computeGeneralizedGravityDerivatives",
    "computeRNEADerivatives",
    "computeStaticTorqueDerivatives",
    "getCentroidalDynamicsDerivatives",
]


def _inverse(model: CoreModel) -> Any:
    def run(q: Array, v: Array, a: Array, *F: Array) -> tuple[Array, ...]:
        forces = [split_forces(x) for x in F]
        derivatives = algorithms.inverse_dynamics_derivatives(model, q, v, a, *forces)
        tau = algorithms.inverse_dynamics(model, q, v, a, *forces)
        accelerations = rows(algorithms.joint_accelerations(model, q, v, a))
        return *derivatives, tau, accelerations, *rates(model)(q, v)

    return run


def _forward(model: CoreModel) -> Any:
    def run(q: Array, v: Array, tau: Array, *F: Array) -> tuple[Array, ...]:
        forces = [split_forces(x) for x in F]
        by_q, by_v, by_tau = algorithms.forward_dynamics_derivatives(model, q, v, tau, *forces)
        ddq = algorithms.forward_dynamics(model, q, v, tau, *forces)
        return by_q, by_v, by_tau, by_tau, ddq, ddq, ddq, *rates(model)(q, v)

    return run


def _gravity(model: CoreModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        zero = np.zeros(model.nv)
        by_q, _, _ = algorithms.inverse_dynamics_derivatives(model, q, zero, zero)
        base_acceleration = np.concatenate([-np.asarray(model.gravity), np.zeros(3)])
        return by_q, algorithms.gravity_forces(model, q), base_acceleration, *columns(model)(q)

    return run


def _centroidal(model: CoreModel) -> Any:
    def run(q: Array, v: Array, a: Array) -> tuple[Array, ...]:
        derivatives = algorithms.centroidal_derivatives(model, q, v, a)
        Ag = algorithms.centroidal_matrix(model, q)
        hg, rate = Ag @ v, algorithms.centroidal_momentum_rate(model, q, v, a)
        accelerations = rows(algorithms.joint_accelerations(model, q, v, a))
        totals = about_origin(model, q, hg), about_origin(model, q, rate), as_one_body(model, q)
        com = algorithms.center_of_mass(model, q)
        return *derivatives, Ag, hg, rate, *totals, com, accelerations, *rates(model)(q, v)

    return run


_MOTION = JOINTS | VELOCITIES_IN_WORLD | ACCELERATIONS_IN_WORLD
_WORLD_FIELDS = ("oa_gf", "of", "oh")
_IN_WORLD = {name: BODIES[name] for name in _WORLD_FIELDS}
_IN_WORLD_UNDER_FORCES = {name: BODIES_UNDER_FORCES[name] for name in _WORLD_FIELDS}
_RNEA: dict[str, Any] = {
    "fills": ("dtau_dq", "dtau_dv", "M", "tau", "a", *JACOBIAN_RATES),
    "kernel": _inverse,
    "returns": (0, 1, 2),
    "states": ("derivatives",),
}
_ABA_FIELDS = ("ddq_dq", "ddq_dv", "ddq_dtau", "Minv", "ddq", "forward_dynamics a")
_ABA: dict[str, Any] = {
    "kernel": with_mass(_forward),
    "returns": (0, 1, 2),
    "invalidates": ("Fcrb",),
    "states": ("forward_dynamics", "articulated"),
    "title": "computeABADerivatives",
}
_RNEA_UNDER_FORCES = Algorithm(
    "rnea_derivatives_under_forces",
    "qvaf",
    **_RNEA,
    deferred=_MOTION | _IN_WORLD_UNDER_FORCES | DERIVATIVE_COLUMNS_UNDER_FORCES,
    title="computeRNEADerivatives",
)
_ABA_ALONE = Algorithm(
    "aba_derivatives",
    "qvt",
    (*_ABA_FIELDS, "aba_derivatives a", *JACOBIAN_RATES),
    **_ABA,
    deferred=_MOTION | _IN_WORLD | TORQUE_DERIVATIVES | DERIVATIVE_COLUMNS,
)
_ABA_UNDER_FORCES = Algorithm(
    "aba_derivatives_under_forces",
    "qvtf",
    (*_ABA_FIELDS, "aba_derivatives_under_forces a", *JACOBIAN_RATES),
    **_ABA,
    deferred=_MOTION
    | _IN_WORLD_UNDER_FORCES
    | TORQUE_DERIVATIVES_UNDER_FORCES
    | DERIVATIVE_COLUMNS_UNDER_FORCES,
)


@algorithm(**_RNEA, deferred=_MOTION | _IN_WORLD | DERIVATIVE_COLUMNS, forces=_RNEA_UNDER_FORCES)
def computeRNEADerivatives(
    model: Model, data: Data, q: Any, v: Any, a: Any, fext: Any = None
) -> tuple[Floats, Floats, Floats]:
    """Derivatives of the torques by q, v and a (the mass matrix), (nv, nv) each; kept in `data`.

    Returns:
        Three matrices (nv, nv).
    """
    ...


@fast_path(_ABA_ALONE, forces=_ABA_UNDER_FORCES, calls=derivative_calls)
@overloads("model data fext:list?", "model data q v tau fext?")
def computeABADerivatives(
    model: Model, data: Data, q: Any = None, v: Any = None, tau: Any = None, fext: Any = None
) -> tuple[Floats, Floats, Floats]:
    """Derivatives of the accelerations by q, v and tau (the inverse mass matrix), (nv, nv) each; kept in `data`.

    Without q, v and tau, those of the last aba, or of this function, whatever ran since; forces on the joints may stand
    in their place.

    Args:
        q: Configuration (nq,) [rad or m]; None for the state of the last aba, or of this function.

    Returns:
        Three matrices (nv, nv).
    """
    if q is None:
        stored = data._require(data._state_of_forward_dynamics, "aba(model, data, q, v, tau)")
        derivatives = derivatives_of_fields(model, data, fext)
        if derivatives is not NotImplemented:
            return derivatives
        q, v, ddq = (x.copy() for x in stored)
        tau = rnea(model, data, q, v, ddq) if fext is None else rnea(model, data, q, v, ddq, fext)
    if fext is None:
        return run(model, data, _ABA_ALONE, q, v, tau)
    return run(model, data, _ABA_UNDER_FORCES, q, v, tau, *checked_forces(fext, model.njoints))


@algorithm(
    fills=("gravity by q", "g", "oa_gf[0]", *JACOBIANS),
    kernel=_gravity,
    returns=(0,),
    deferred=JOINTS | {"of": BODIES["of"]},
    invalidates=("Ag", "dFdq"),
)
def computeGeneralizedGravityDerivatives(model: Model, data: Data, q: Any) -> Floats:
    """The derivative (nv, nv) of the torques against gravity by q.

    Returns:
        Matrix (nv, nv).
    """
    ...


_STATIC = Algorithm(
    "static_torque_derivatives",
    "",
    (),
    not_applicable,
    invalidates=("Ag", "dFdq"),
    title="computeStaticTorqueDerivatives",
)


def computeStaticTorqueDerivatives(model: Model, data: Data, q: Any, fext: Any) -> Floats:
    """The derivative (nv, nv) of the torques against gravity and forces on the joints by q.

    Returns:
        Matrix (nv, nv).
    """
    q, rest, F = vector(q, model.nq, "q"), np.zeros(model.nv), external(fext, model.njoints)
    model._check_gravity()
    computeJointJacobians(model, data, q)
    evaluator = loaded_evaluator(model, data, "static torque derivatives")
    compiled: Any = EvaluatedModel(model) if evaluator else data._attach(model)
    if evaluator:
        data.tau = evaluator.run(DYNAMICS, q, None, None, F).tau
    else:
        data.tau = under_forces(compiled, algorithms.static_torque, q, F)
    data._arrays["oa_gf"][0] = -model.gravity.vector
    data._defer(BODIES["of"], ("of",), compiled, q.copy(), rest, rest, F)
    data._invalidate(_STATIC)
    if evaluator:
        return WorldDerivatives(evaluator, q, F=F).torques_by_configuration()
    return under_forces(compiled, algorithms.inverse_dynamics_derivatives, q, rest, rest, F)[0]


@algorithm(
    fills=(
        *("dHdq", "dFdq", "dFdv", "dFda", "Ag", "hg", "dhg", "oh[0]", "of[0]", "Ig", "com[0]", "a"),
        *JACOBIAN_RATES,
    ),
    kernel=_centroidal,
    returns=(0, 1, 2, 3),
    deferred=_MOTION | CENTERS | SUBTREE_MOMENTA_IN_WORLD | ACCELERATION_COLUMNS,
    invalidates=("tau",),
    states=("center_columns",),
)
def computeCentroidalDynamicsDerivatives(
    model: Model, data: Data, q: Any, v: Any, a: Any
) -> tuple[Floats, ...]:
    """Derivatives of the centroidal momentum by q, and of its rate by q, v and a, (6, nv) each.

    Returns:
        Four matrices (6, nv).
    """
    ...


_CENTROIDAL_AFTER_RNEA = Algorithm(
    "centroidal_derivatives_after_rnea",
    "",
    (),
    not_applicable,
    invalidates=("of",),
    title="getCentroidalDynamicsDerivatives",
)


_centroidal_calls = call_cache(2, weak=2)


@repeated_calls(_centroidal_calls)
@checked
def getCentroidalDynamicsDerivatives(model: Model, data: Data) -> tuple[Floats, ...]:
    """Derivatives of the centroidal momentum at the state of the last computeRNEADerivatives.

    Returns:
        Four matrices (6, nv).
    """
    call = "computeRNEADerivatives(model, data, q, v, a)"
    state = data._require(data._state_of_derivatives, call)
    if model.nvExtended == model.nv:
        derivatives = CENTROIDAL.run(model, data, _centroidal_calls)
        if derivatives is not NotImplemented:
            return derivatives
    derivatives = computeCentroidalDynamicsDerivatives(model, data, *state)
    data._invalidate(_CENTROIDAL_AFTER_RNEA)
    return derivatives
