"""Accelerations and forces of a robot that constraints bind."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.dynamics import aba, crba, nonLinearEffects
from pinocchio._constraints.bound_dynamics import defer_after_elimination, solve, solve_directly
from pinocchio._constraints.jacobian_dynamics import impact_directly, impact_with_jacobian
from pinocchio._constraints.proximal_settings import ProximalSettings, settings_of
from pinocchio._constraints.rigid_constraint import RigidConstraint, checked_constraints
from pinocchio._containers.arrays import vector
from pinocchio._containers.enums import Convention
from pinocchio._containers.keywords import overloads, without_overloads
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
    """Allocates the forces of constraints in `data`, all zero; checks constraints and their data."""
    models = checked_constraints(model, contact_models, contact_datas)
    compiled_for(model, data)
    m, nv = sum(one.residualSize() for one in models), model.nv
    shapes: dict[str, Any] = dict.fromkeys(
        ("lambda_c", "impulse_c", "lambda_c_prox", "primal_rhs_contact"), m
    )
    shapes |= {"primal_dual_contact_solution": m + nv, "osim": (m, m)}
    shapes |= dict.fromkeys(("dlambda_dq", "dlambda_dv", "dlambda_dtau"), (m, nv))
    shapes |= dict.fromkeys(("dac_da", "dac_dq", "dac_dv", "dvc_dq"), (m, nv))
    for name, shape in shapes.items():
        data._arrays[name] = np.zeros(shape)
    data._mark_filled(*shapes)


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
        contact_models: Constraints.
        prox_settings: How the forces are found; it receives the figures of that. One round without damping when
            left out.

    Returns:
        Accelerations (nv,) [rad/s^2 or m/s^2].
    """
    if not _has_constraints(model, contact_models, contact_datas):
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


def _has_constraints(model: Model, models: Any, datas: Any) -> bool:
    """Whether there are constraints; those that are there are checked where they are used."""
    if isinstance(models, (list, tuple)) and models:
        return True
    return bool(checked_constraints(model, models, datas))


_ONE_ROUND = ProximalSettings()
"""The settings that hold when none are given."""


def computeJointMinimalOrdering(model: Model, data: Data, constraint_models: Any) -> None:
    """Checks the constraints; `lcaba` needs no ordering here."""
    compiled_for(model, data)
    models = constraint_models if isinstance(constraint_models, (list, tuple)) else None
    datas = [one.createData() if isinstance(one, RigidConstraint) else None for one in models or ()]
    checked_constraints(model, constraint_models, datas)


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
    """The accelerations that torques cause under constraints; as constraintDynamics.

    Args:
        prox_settings: Accuracy and damping of the forces; it receives the figures of the search.

    Returns:
        Accelerations (nv,) [rad/s^2 or m/s^2].
    """
    ddq = constraintDynamics(
        model, data, q, v, tau, constraint_models, constraint_datas, settings_of(prox_settings)
    )
    if len(constraint_models):
        defer_after_elimination(model, data)
    return ddq


def _impact_directly(model: Any, data: Any, *args: Any) -> Any:
    """impulseDynamics of arrays and constraints that are bound, or a Jacobian that is known; else NotImplemented."""
    if len(args) < 4:
        return impact_directly(model, data, *args)
    q, v, models, datas, *rest = args
    settings, part = _ONE_ROUND, 0.0
    if rest:
        part = rest[0]
        if len(rest) == 2:
            settings = rest[1]
        if type(part) is not float or not 0.0 <= part <= 1.0 or type(settings) is not ProximalSettings:
            return NotImplemented
        if len(rest) > 2:
            return NotImplemented
    solved = solve_directly(model, data, models, datas, 0, q, v, settings._numbers, part)
    if solved is NotImplemented:
        return NotImplemented
    data._arrays["impulse_c"] = solved[0].forces
    return solved[1]


@without_overloads(_impact_directly)
@overloads(
    "model data q v contact_models:list contact_datas:list r_coeff? prox_settings:ProximalSettings?",
    "model data v_before constraint_jacobian:matrix restitution_coefficient? damping?",
    "model data q v_before constraint_jacobian:matrix restitution_coefficient? damping?",
)
def impulseDynamics(
    model: Model,
    data: Data,
    q: Any = None,
    v: Any = None,
    contact_models: Any = None,
    contact_datas: Any = None,
    r_coeff: float = 0.0,
    prox_settings: Any = None,
    v_before: Any = None,
    constraint_jacobian: Any = None,
    restitution_coefficient: float = 0.0,
    damping: float = 0.0,
) -> Floats:
    """The velocity after an impact (nv,); kept in `data.dq_after`, the impulses in `data.impulse_c`.

    Each impulse is also in `contact_force` of the data of its constraint; both ends of a constraint count.

    Args:
        q: Configuration (nq,); with a Jacobian it may be left out after crba.
        v: Velocity before the impact (nv,), with constraints.
        contact_models: Constraints.
        r_coeff: The coefficient of restitution, from 0 to 1 [-].
        prox_settings: How the impulses are found.
        v_before: Velocity before the impact (nv,), with a Jacobian.
        constraint_jacobian: The Jacobian of what is hit, (m, nv).
        restitution_coefficient: That of an impact with a Jacobian [-].
        damping: What is taken off the diagonal of the constraints [1/kg].

    Returns:
        Velocity (nv,) [rad/s or m/s].
    """
    if constraint_jacobian is not None:
        return impact_with_jacobian(
            model, data, q, v_before, constraint_jacobian, restitution_coefficient, damping
        )
    return _impact(model, data, q, v, contact_models, contact_datas, r_coeff, prox_settings)


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
    part = restitution(r_coeff)
    if not _has_constraints(model, contact_models, contact_datas):
        vector(q, model.nq, "q")
        data._arrays["dq_after"][:] = after = vector(v, model.nv, "v")
        data._arrays["impulse_c"] = np.zeros(0)
        return after.copy()
    session, after = solve(model, data, contact_models, contact_datas, 0, q, v, settings._numbers, part)
    data._arrays["impulse_c"] = session.forces
    return after


def restitution(value: Any) -> float:
    part = float(value)
    if not 0.0 <= part <= 1.0:
        raise InputError(f"The coefficient of restitution is {value!r}; expected a number from 0 to 1.")
    return part
