"""Accelerations and forces of a robot that constraints bind."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.dynamics import aba, crba, nonLinearEffects
from pinocchio._constraints.bound_dynamics import defer_after_elimination, solve
from pinocchio._constraints.jacobian_dynamics import impact_with_jacobian
from pinocchio._constraints.proximal_settings import ProximalSettings, settings_of
from pinocchio._constraints.rigid_constraint import RigidConstraint, checked_constraints
from pinocchio._containers.arrays import vector
from pinocchio._containers.enums import Convention
from pinocchio._data.data import Data
from pinocchio._data.states import compiled_for
from pinocchio._model.model import Model
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = [
    "computeJointMinimalOrdering",
    "constraintDynamics",
    "impulseDynamics",
    "initConstraintDynamics",
    "lcaba",
]


def initConstraintDynamics(model: Model, data: Data, contact_models: Any, contact_datas: Any) -> None:
    """Makes room in `data` for the forces of constraints, all zero; checks constraints and their data."""
    models = checked_constraints(model, contact_models, contact_datas)
    compiled_for(model, data)
    m, nv = sum(one.residualSize() for one in models), model.nv
    blocks = data._arrays
    for name in ("lambda_c", "impulse_c"):
        blocks[name] = np.zeros(m)
    for name in ("dlambda_dq", "dlambda_dv", "dlambda_dtau", "dac_da"):
        blocks[name] = np.zeros((m, nv))
    blocks["osim"] = np.zeros((m, m))


def constraintDynamics(
    model: Model,
    data: Data,
    q: Any,
    v: Any,
    tau: Any,
    contact_models: Any,
    contact_datas: Any,
    prox_settings: Any = None,
) -> Floats:
    """The accelerations that torques cause under constraints (nv,); kept in `data.ddq`, the forces in `data.lambda_c`.

    Each force is also in `contact_force` of the data of its constraint. Fills `data.M`, `data.nle`, `data.J` and
    `data.oMi`, too.

    Args:
        model: The model.
        data: Its data.
        q: Configuration (nq,).
        v: Velocity (nv,).
        tau: Torques (nv,).
        contact_models: Constraints.
        contact_datas: Their data.
        prox_settings: How the forces are found; it receives the figures of that. None for one round without damping.
    """
    if not len(contact_models):
        checked_constraints(model, contact_models, contact_datas)
        crba(model, data, q, Convention.WORLD)
        nonLinearEffects(model, data, q, v)
        data._arrays["lambda_c"] = np.zeros(0)
        return aba(model, data, q, v, tau)
    settings = _ONE_ROUND if prox_settings is None else settings_of(prox_settings)
    session, a = solve(
        model, data, contact_models, contact_datas, settings.max_iter, q, v, tau, settings._numbers
    )
    if prox_settings is not None:
        settings._report(*session.report.tolist())
    data._arrays["lambda_c"] = session.forces
    return a


_ONE_ROUND = ProximalSettings()
"""The settings that hold when none are given."""


def computeJointMinimalOrdering(model: Model, data: Data, constraint_models: Any) -> None:
    """Checks the constraints; `lcaba` needs no ordering here."""
    compiled_for(model, data)
    checked_constraints(model, constraint_models, [one.createData() for one in constraint_models])


def lcaba(
    model: Model,
    data: Data,
    q: Any,
    v: Any,
    tau: Any,
    constraint_models: Any,
    constraint_datas: Any,
    prox_settings: Any,
) -> Floats:
    """The same as constraintDynamics; how closed loops are eliminated is decided inside."""
    ddq = constraintDynamics(
        model, data, q, v, tau, constraint_models, constraint_datas, settings_of(prox_settings)
    )
    if len(constraint_models):
        defer_after_elimination(model, data)
    return ddq


def impulseDynamics(model: Model, data: Data, *state: Any, **named: Any) -> Floats:
    """The velocity after an impact (nv,); kept in `data.dq_after`, the impulses in `data.impulse_c`.

    `impulseDynamics(model, data, q, v, constraints, datas[, r_coeff[, settings]])`, or with a Jacobian,
    `impulseDynamics(model, data, [q,] v, J[, restitution_coefficient[, damping]])`; without q after crba.
    Each impulse is also in `contact_force` of the data of its constraint; both ends of a constraint count.
    """
    if named:
        names = ("q", "v_before", "v", "constraint_jacobian", "contact_models", "contact_datas")
        state += tuple(named.pop(name) for name in names if name in named)
    if len(state) < 4 or not _are_constraints(state[2]):
        return impact_with_jacobian(model, data, *state, **named)
    return _impact(model, data, *state, **named)


def _are_constraints(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and all(isinstance(x, RigidConstraint) for x in value)


def _impact(
    model: Model,
    data: Data,
    q: Any,
    v: Any,
    contact_models: Any,
    contact_datas: Any,
    r_coeff: float = 0.0,
    prox_settings: Any = None,
) -> Floats:
    settings = _ONE_ROUND if prox_settings is None else settings_of(prox_settings)
    if not len(contact_models):
        checked_constraints(model, contact_models, contact_datas)
        data._arrays["dq_after"][:] = after = vector(v, model.nv, "v")
        return after.copy()
    part = np.array([restitution(r_coeff)])
    session, after = solve(model, data, contact_models, contact_datas, 0, q, v, settings._numbers, part)
    data._arrays["impulse_c"] = session.forces
    return after


def restitution(value: Any) -> float:
    part = float(value)
    if not 0.0 <= part <= 1.0:
        raise InputError(f"The coefficient of restitution is {value!r}; expected a number from 0 to 1.")
    return part
