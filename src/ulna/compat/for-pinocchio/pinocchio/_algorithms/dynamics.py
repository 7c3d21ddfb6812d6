"""Inverse and forward dynamics, the mass matrix and its kin, and all of them at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pinocchio._algorithms.jacobians import JACOBIAN_RATES, JACOBIANS, columns, rates
from pinocchio._algorithms.stored_derivatives import CORIOLIS
from pinocchio._algorithms.stored_dynamics import inverse_of_fields
from pinocchio._containers.arguments import check_model_and_data, checked, checks_itself
from pinocchio._containers.arrays import not_applicable
from pinocchio._containers.enums import Convention
from pinocchio._containers.keywords import overloads
from pinocchio._data.algorithm import Algorithm
from pinocchio._data.binding import run
from pinocchio._data.compiled_fields import split_forces
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import (
    ACCELERATIONS,
    BODIES,
    BODIES_AND_BASE,
    BODIES_AND_BASE_UNDER_FORCES,
    BODIES_UNDER_FORCES,
    BODY_FORCES,
    BODY_FORCES_AT_REST,
    BODY_MOMENTA_IN_WORLD,
    CENTERS,
    JOINTS,
    VELOCITIES_IN_WORLD,
)
from pinocchio._data.derivative_columns import COMPOSITE_FORCES, CORIOLIS_COLUMNS
from pinocchio._data.evaluated_model import EvaluatedModel
from pinocchio._data.functions import algorithm, fast_path
from pinocchio._model.compiled_model import CompiledModel
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import checked_forces
from ulna import algorithms
from ulna.compiler.runtime.repeated_calls import call_cache, repeated_calls
from ulna.model import Model as CoreModel
from ulna.quantities.mass import with_mass
from ulna.typing import Array, Floats

_WORLD = Convention.WORLD  # looking a member up costs as much as a small robot's placements

__all__ = [
    "aba",
    "computeCoriolisMatrix",
    "computeGeneralizedGravity",
    "computeMinverse",
    "computeStaticTorque",
    "crba",
    "getCoriolisMatrix",
    "nle",
    "nonLinearEffects",
    "rnea",
]


def external(fext: Any, count: int) -> Floats:
    """Forces on the joints, the universe left out, as one array (njoints - 1, 6).

    Args:
        fext: For each joint, the universe included, the force (6,) on its body in its frame.
        count: Number of joints, the universe included.

    Returns:
        Forces (njoints - 1, 6) [N, N m].
    """
    return np.array(checked_forces(fext, count)[1:], dtype=float).reshape(count - 1, 6)


def under_forces(
    compiled: CompiledModel | EvaluatedModel, function: Callable[..., Any], *arrays: Floats
) -> Any:
    """One of Ulna's algorithms for a state and, the last of the arrays, forces on the joints; compiled once.

    Args:
        function: An algorithm of `ulna.algorithms` whose last argument is forces.
        *arrays: Its arguments, the last being forces (njoints - 1, 6).

    Returns:
        The result of the algorithm.
    """

    def build(core: CoreModel) -> Any:
        return lambda *args: function(core, *args[:-1], split_forces(args[-1]))

    shapes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(arrays)}
    return compiled.compile((function, "under forces"), build, **shapes)(*arrays)


def _inverse(model: CoreModel) -> Any:
    return lambda q, v, a, *F: algorithms.inverse_dynamics(model, q, v, a, *map(split_forces, F))


def _bias(model: CoreModel) -> Any:
    return lambda q, v: algorithms.bias_forces(model, q, v)


def _gravity(model: CoreModel) -> Any:
    return lambda q: algorithms.gravity_forces(model, q)


def _forward(model: CoreModel) -> Any:
    def run(q: Array, v: Array, tau: Array, *F: Array) -> tuple[Array, ...]:
        ddq = algorithms.forward_dynamics(model, q, v, tau, *map(split_forces, F))
        return ddq, ddq, ddq

    return run


def _forward_in_world(model: CoreModel) -> Any:
    forward, own_columns = _forward(model), columns(model)
    return lambda q, v, tau, *F: (*forward(q, v, tau, *F), *own_columns(q))


def _mass(model: CoreModel) -> Any:
    return lambda q: algorithms.mass_matrix(model, q)


def _mass_in_world(model: CoreModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        com, Ag = algorithms.center_of_mass(model, q), algorithms.centroidal_matrix(model, q)
        return algorithms.mass_matrix(model, q), Ag, com, *columns(model)(q)

    return run


def _inverse_mass(model: CoreModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        return (algorithms.inverse_mass_matrix(model, q), *columns(model)(q))

    return run


def _coriolis(model: CoreModel) -> Any:
    return lambda q, v: (algorithms.coriolis_matrix(model, q, v), *rates(model)(q, v))


_RNEA_UNDER_FORCES = Algorithm(
    "rnea_under_forces", "qvaf", ("tau",), _inverse, (0,), deferred=JOINTS | BODIES_UNDER_FORCES
)


@algorithm(fills=("tau",), kernel=_inverse, returns=(0,), deferred=JOINTS | BODIES, forces=_RNEA_UNDER_FORCES)
def rnea(model: Model, data: Data, q: Any, v: Any, a: Any, fext: Any = None) -> Floats:
    """The joint torques of a motion, (nv,); kept in `data.tau`.

    Returns:
        Torques (nv,) [N m or N].
    """
    ...


@algorithm(fills=("nle",), kernel=_bias, returns=(0,), deferred=JOINTS | BODIES)
def nonLinearEffects(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """Coriolis, centrifugal and gravity torques (nv,); kept in `data.nle`.

    Returns:
        Torques (nv,) [N m or N].
    """
    ...


nle = nonLinearEffects


@algorithm(fills=("g",), kernel=_gravity, returns=(0,), deferred=JOINTS | BODY_FORCES)
def computeGeneralizedGravity(model: Model, data: Data, q: Any) -> Floats:
    """The torques that hold the robot against gravity (nv,); kept in `data.g`.

    Returns:
        Torques (nv,) [N m or N].
    """
    ...


def _statics(model: CoreModel) -> Any:
    return lambda q, F: algorithms.static_torque(model, q, split_forces(F))


_STATIC_TORQUE = Algorithm(
    "static_torque", "qf", ("tau",), _statics, (0,), deferred=JOINTS | BODY_FORCES_AT_REST
)


@checks_itself
def computeStaticTorque(model: Model, data: Data, q: Any, fext: Any) -> Floats:
    """The torques that hold the robot against gravity and forces on its joints (nv,); kept in `data.tau`.

    Returns:
        Torques (nv,) [N m or N].
    """
    try:
        tau = data._bound.static_torque(q, *[f._v for f in fext]) if data._model is model else NotImplemented
    except (AttributeError, TypeError):  # of what is no model, no data, or no list of forces
        tau = NotImplemented
    if tau is not NotImplemented:
        return tau
    check_model_and_data("computeStaticTorque", model, data)
    return run(model, data, _STATIC_TORQUE, q, *checked_forces(fext, model.njoints))


def _forward_dynamics(name: str, under_forces: bool, in_world: bool) -> Algorithm:
    """The record of `aba` with or without forces on the joints, in one of the conventions."""
    bodies = BODIES_AND_BASE_UNDER_FORCES if under_forces else BODIES_AND_BASE
    return Algorithm(
        name,
        "qvtf" if under_forces else "qvt",
        ("ddq", f"{name} a", "forward_dynamics a", *(JACOBIANS if in_world else ())),
        with_mass(_forward_in_world if in_world else _forward),
        (0,),
        deferred=JOINTS | bodies | ACCELERATIONS,
        states=("forward_dynamics", "articulated"),
        title="aba",
    )


_ABA = _forward_dynamics("aba", False, False)
_ABA_UNDER_FORCES = _forward_dynamics("aba_under_forces", True, False)
_ABA_IN_WORLD = _forward_dynamics("aba_in_world", False, True)
_ABA_UNDER_FORCES_IN_WORLD = _forward_dynamics("aba_under_forces_in_world", True, True)
_aba_calls = call_cache(3, weak=2, kernel_argument=2, kernel_arguments=3)


@fast_path(
    _ABA,
    forces=_ABA_UNDER_FORCES,
    alternative=("convention", _WORLD, _ABA_IN_WORLD),
    other_calls=_aba_calls,
)
@overloads("model data q v tau convention:Convention?", "model data q v tau fext convention:Convention?")
def aba(
    model: Model,
    data: Data,
    q: Any,
    v: Any,
    tau: Any,
    fext: Any = None,
    convention: Convention = Convention.LOCAL,
) -> Floats:
    """The accelerations that torques cause (nv,); kept in `data.ddq`.

    Args:
        convention: LOCAL or WORLD; the result is the same, and WORLD fills `data.J`, too.

    Returns:
        Accelerations (nv,) [rad/s^2 or m/s^2].
    """
    in_world = convention is _WORLD
    if fext is not None:
        algorithm_ = _ABA_UNDER_FORCES_IN_WORLD if in_world else _ABA_UNDER_FORCES
        return run(model, data, algorithm_, q, v, tau, *checked_forces(fext, model.njoints))
    algorithm_ = _ABA_IN_WORLD if in_world else _ABA
    ddq = run(model, data, algorithm_, q, v, tau)
    _aba_calls.add(getattr(data._bound, algorithm_.name), 3, model, data, convention)
    return ddq


_CRBA = Algorithm("crba", "q", ("M",), _mass, (0,), deferred=JOINTS | COMPOSITE_FORCES, depends_on="masses")
_CRBA_IN_WORLD = Algorithm(
    "crba_in_world",
    "q",
    ("M", "Ag", "com[0]", *JACOBIANS),
    _mass_in_world,
    (0,),
    deferred=JOINTS | CENTERS,
    depends_on="masses",
)


_crba_calls = call_cache(3, weak=2, kernel_argument=2)


@fast_path(_CRBA, alternative=("convention", _WORLD, _CRBA_IN_WORLD), other_calls=_crba_calls)
def crba(model: Model, data: Data, q: Any, convention: Convention = Convention.LOCAL) -> Floats:
    """The mass matrix (nv, nv), both triangles; kept in `data.M`.

    Args:
        q: Configuration (nq,).
        convention: LOCAL or WORLD; WORLD fills `data.J`, too.

    Returns:
        Matrix (nv, nv).
    """
    algorithm_ = _CRBA_IN_WORLD if convention == _WORLD else _CRBA
    M = run(model, data, algorithm_, q)
    _crba_calls.add(getattr(data._bound, algorithm_.name), 1, model, data, convention)
    return M


@algorithm(
    fills=("Minv", *JACOBIANS),
    kernel=with_mass(_inverse_mass),
    returns=(0,),
    deferred=JOINTS,
    depends_on="masses",
    invalidates=("Fcrb",),
    states=("articulated",),
    default_state=("_q_of_articulated", "aba(model, data, q, v, tau)"),
    of_fields=inverse_of_fields,
)
def computeMinverse(model: Model, data: Data, q: Any = None) -> Floats:
    """The inverse of the mass matrix (nv, nv); kept in `data.Minv`.

    Args:
        q: Configuration (nq,) [rad or m]; None for that of the last aba, of derivatives of it, or of this function,
            whatever ran since, with `data.J` as it is where it is of that configuration.

    Returns:
        Matrix (nv, nv).
    """
    ...


@algorithm(
    fills=("C", *JACOBIAN_RATES),
    kernel=_coriolis,
    returns=(0,),
    deferred=JOINTS | VELOCITIES_IN_WORLD | BODY_MOMENTA_IN_WORLD | CORIOLIS_COLUMNS,
    depends_on="masses",
    invalidates=("Ag",),
)
def computeCoriolisMatrix(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The Coriolis matrix (nv, nv) of the Christoffel symbols; kept in `data.C`.

    Returns:
        Matrix (nv, nv).
    """
    ...


_CORIOLIS_AFTER_DERIVATIVES = Algorithm(
    "coriolis_after_derivatives", "", (), not_applicable, invalidates=("dFdv",), title="getCoriolisMatrix"
)


_coriolis_calls = call_cache(2, weak=2)


@repeated_calls(_coriolis_calls)
@checked
def getCoriolisMatrix(model: Model, data: Data) -> Floats:
    """The Coriolis matrix of the last derivatives of inverse dynamics.

    Returns:
        Matrix (nv, nv).
    """
    state = data._require(data._state_of_derivatives, "computeRNEADerivatives(model, data, q, v, a)")
    if model.nvExtended == model.nv:
        C = CORIOLIS.run(model, data, _coriolis_calls)
        if C is not NotImplemented:
            return C
    C = computeCoriolisMatrix(model, data, *state[:2])
    data._invalidate(_CORIOLIS_AFTER_DERIVATIVES)
    return C
