"""Derivatives of dynamics by configuration, velocity and acceleration."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.center_of_mass import about_origin, as_one_body
from pinocchio._algorithms.dynamics import external, rnea, run_under, under_forces
from pinocchio._algorithms.jacobians import (
    COLUMNS,
    RATES,
    columns,
    computeJointJacobians,
    rates,
)
from pinocchio._containers.arrays import vector
from pinocchio._data.binding import Algorithm, refuse, run
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import (
    BODIES,
    CENTRES,
    IN_WORLD,
    OA,
    OV,
    OWN,
    SLOPES,
    SLOPES_UNDER_FORCES,
    UNDER_FORCES,
    Late,
    rows,
    split_forces,
)
from pinocchio._model.model import Model
from ulna import algorithms
from ulna.model import Model as TowerModel
from ulna.recipes.mass import with_mass
from ulna.typing import Array, Floats

__all__ = [
    "computeABADerivatives",
    "computeCentroidalDynamicsDerivatives",
    "computeGeneralizedGravityDerivatives",
    "computeRNEADerivatives",
    "computeStaticTorqueDerivatives",
    "getCentroidalDynamicsDerivatives",
]


def _inverse(model: TowerModel) -> Any:
    def run(q: Array, v: Array, a: Array, *F: Array) -> tuple[Array, ...]:
        forces = [split_forces(x) for x in F]
        found = algorithms.inverse_dynamics_derivatives(model, q, v, a, *forces)
        gains = rows(algorithms.joint_accelerations(model, q, v, a))
        return (
            *found,
            algorithms.inverse_dynamics(model, q, v, a, *forces),
            q,
            v,
            a,
            gains,
            q,
            v,
            a,
            *rates(model)(q, v),
        )

    return run


def _forward(model: TowerModel) -> Any:
    def run(q: Array, v: Array, tau: Array, *F: Array) -> tuple[Array, ...]:
        forces = [split_forces(x) for x in F]
        by_q, by_v, by_tau = algorithms.forward_dynamics_derivatives(model, q, v, tau, *forces)
        ddq = algorithms.forward_dynamics(model, q, v, tau, *forces)
        return by_q, by_v, by_tau, by_tau, ddq, ddq, *rates(model)(q, v)

    return run


def _weight(model: TowerModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        rest = np.zeros(model.nv)
        by_q, _, _ = algorithms.inverse_dynamics_derivatives(model, q, rest, rest)
        lift = np.concatenate([-np.asarray(model.gravity), np.zeros(3)])
        return by_q, algorithms.gravity_forces(model, q), lift, *columns(model)(q)

    return run


def _momenta(model: TowerModel) -> Any:
    def run(q: Array, v: Array, a: Array) -> tuple[Array, ...]:
        found = algorithms.centroidal_derivatives(model, q, v, a)
        Ag = algorithms.centroidal_matrix(model, q)
        hg, rate = Ag @ v, algorithms.centroidal_momentum_rate(model, q, v, a)
        gains = rows(algorithms.joint_accelerations(model, q, v, a))
        whole = about_origin(model, q, hg), about_origin(model, q, rate), as_one_body(model, q)
        com = algorithms.center_of_mass(model, q)
        return *found, Ag, hg, rate, *whole, com, gains, q, v, a, *rates(model)(q, v)

    return run


_STEPS = ("dFda", "dFdq", "dFdv")
_STATE = ("derivatives q", "derivatives v", "derivatives a")
_GAINED = ("a", "gains q", "gains v", "gains a")
_IN_WORLD = {name: late for name, late in BODIES.items() if name in ("oa_gf", "of", "oh")}
_UNDER = {name: UNDER_FORCES[name] for name in _IN_WORLD}


def _of_rnea(name: str, inputs: str, in_world: dict[str, Late]) -> Algorithm:
    return Algorithm(
        name,
        inputs,
        ("dtau_dq", "dtau_dv", "M", "tau", *_STATE, *_GAINED, *RATES),
        _inverse,
        (0, 1, 2),
        late=OWN | OV | OA | in_world,
        spoils=_STEPS,
        title="computeRNEADerivatives",
    )


def _of_aba(name: str, inputs: str, late: dict[str, Late]) -> Algorithm:
    return Algorithm(
        name,
        inputs,
        ("ddq_dq", "ddq_dv", "ddq_dtau", "Minv", "ddq", f"{name} a", *RATES),
        with_mass(_forward),
        (0, 1, 2),
        late=OWN | OV | OA | late,
        spoils=_STEPS,
        title="computeABADerivatives",
    )


_RNEA = _of_rnea("rnea_derivatives", "qva", _IN_WORLD)
_RNEA_UNDER = _of_rnea("rnea_derivatives_under", "qvaf", _UNDER)
_ABA = _of_aba("aba_derivatives", "qvt", _IN_WORLD | SLOPES)
_ABA_UNDER = _of_aba("aba_derivatives_under", "qvtf", _UNDER | SLOPES_UNDER_FORCES)
_WEIGHT = Algorithm(
    "gravity_derivatives",
    "q",
    ("gravity by q", "g", "oa_gf[0]", *COLUMNS),
    _weight,
    (0,),
    late=OWN | {"of": BODIES["of"]},
    spoils=("Ag", "dFdq"),
    title="derivatives of torques against gravity",
)
_MOMENTA = Algorithm(
    "centroidal_derivatives",
    "qva",
    (
        *("dHdq", "dFdq", "dFdv", "dFda", "Ag", "hg", "dhg", "oh[0]", "of[0]", "Ig", "com[0]"),
        *(*_GAINED, *RATES),
    ),
    _momenta,
    (0, 1, 2, 3),
    late=OWN | OV | OA | CENTRES | IN_WORLD,
    spoils=("tau",),
    title="computeCentroidalDynamicsDerivatives",
)

_LATER_MOMENTA = Algorithm(
    "later_momenta", "", (), refuse, spoils=("of",), title="getCentroidalDynamicsDerivatives"
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
        return found
    return run_under(model, data, _RNEA_UNDER, q, v, a, fext)


def computeABADerivatives(
    model: Model, data: Data, q: Any = None, v: Any = None, tau: Any = None, fext: Any = None
) -> tuple[Floats, Floats, Floats]:
    """Derivatives of the accelerations by q, v and tau (the inverse mass matrix), (nv, nv) each; kept in `data`.

    Without q, v and tau, those of the last aba; forces on the joints may stand in their place.
    """
    if v is None:
        fext = q if fext is None else fext
        q, v, ddq = (x.copy() for x in data.require(data._of_forward, "aba(model, data, q, v, tau)"))
        tau = rnea(model, data, q, v, ddq, fext)
    if fext is None:
        step = data._run.aba_derivatives
        found = step(q, v, tau) if data._model is model else NotImplemented
        if found is NotImplemented:
            found = run(model, data, _ABA, q, v, tau)
        return found
    return run_under(model, data, _ABA_UNDER, q, v, tau, fext)


def computeGeneralizedGravityDerivatives(model: Model, data: Data, q: Any) -> Floats:
    """The derivative (nv, nv) of the torques against gravity by q."""
    step = data._run.gravity_derivatives
    found = step(q) if data._model is model else NotImplemented
    return run(model, data, _WEIGHT, q) if found is NotImplemented else found


def computeStaticTorqueDerivatives(model: Model, data: Data, q: Any, fext: Any) -> Floats:
    """The derivative (nv, nv) of the torques against gravity and forces on the joints by q."""
    q, rest, F = vector(q, model.nq, "q"), np.zeros(model.nv), external(fext, model.njoints)
    computeJointJacobians(model, data, q)
    engine = data.attach(model)
    data.tau = under_forces(engine, algorithms.static_torque, q, F)
    data._blocks["oa_gf"][0] = -model.gravity.vector
    data.leave(BODIES["of"], ("of",), engine, q.copy(), rest, rest, F)
    data.spoil(_WEIGHT)
    return under_forces(engine, algorithms.inverse_dynamics_derivatives, q, rest, rest, F)[0]


def computeCentroidalDynamicsDerivatives(
    model: Model, data: Data, q: Any, v: Any, a: Any
) -> tuple[Floats, ...]:
    """Derivatives of the centroidal momentum by q, and of its rate by q, v and a, (6, nv) each."""
    step = data._run.centroidal_derivatives
    found = step(q, v, a) if data._model is model else NotImplemented
    return run(model, data, _MOMENTA, q, v, a) if found is NotImplemented else found


def getCentroidalDynamicsDerivatives(model: Model, data: Data) -> tuple[Floats, ...]:
    """The same at the state of the last computeRNEADerivatives."""
    state = data.require(data._of_derivatives, "computeRNEADerivatives(model, data, q, v, a)")
    found = computeCentroidalDynamicsDerivatives(model, data, *state)
    data.spoil(_LATER_MOMENTA)
    return found
