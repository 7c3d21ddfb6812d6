"""Accelerations and forces of a robot that constraints bind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._arrays import exact
from pinocchio._constraint_kernels import bonds_of, paired, shapes_of
from pinocchio._constraint_session import Session, Solved
from pinocchio._constraint_state import bound, leave
from pinocchio._constraints import RigidConstraintData, RigidConstraintModel
from pinocchio._data import Data, engine_for
from pinocchio._dynamics import aba
from pinocchio._jacobian_dynamics import impact_with_jacobian
from pinocchio._kinematics import stacked
from pinocchio._model import Model
from pinocchio._proximal import ProximalSettings, settings_of
from pinocchio._states import OWN
from ulna import algorithms
from ulna.algorithms.constrained_dynamics_damped import Damped, damped_impact
from ulna.errors import InputError
from ulna.model import Model as TowerModel
from ulna.recipes.base import with_mass
from ulna.typing import Array, Floats

__all__ = [
    "computeJointMinimalOrdering",
    "constraintDynamics",
    "impulseDynamics",
    "initConstraintDynamics",
    "lcaba",
]


def initConstraintDynamics(model: Model, data: Data, contact_models: Any, contact_datas: Any) -> None:
    """Makes room in `data` for the forces of constraints, all zero; checks constraints and their data."""
    models = paired(model, contact_models, contact_datas)
    engine_for(model, data)
    m, nv = sum(one.residualSize() for one in models), model.nv
    blocks = data._blocks
    for name in ("lambda_c", "impulse_c"):
        blocks[name] = np.zeros(m)
    for name in ("dlambda_dq", "dlambda_dv", "dlambda_dtau", "dac_da"):
        blocks[name] = np.zeros((m, nv))
    blocks["osim"] = np.zeros((m, m))


def share(forces: Floats, datas: Sequence[RigidConstraintData]) -> None:
    """Writes the forces (m,) into the data of their constraints."""
    start = 0
    for known in datas:
        known._views["contact_force"]._v[: known._size] = forces[start : start + known._size]
        start += known._size


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
    """The accelerations that torques give under constraints (nv,); kept in `data.ddq`, the forces in `data.lambda_c`.

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
        prox_settings: How the forces are found; it is told how that went. None for one round without damping.
    """
    settings = _ONE_ROUND if prox_settings is None else settings_of(prox_settings)
    session = data._session
    if session is None or not session.serves(model, data, contact_models, contact_datas, settings.max_iter):
        if not len(contact_models):
            paired(model, contact_models, contact_datas)
            return aba(model, data, q, v, tau)
        session = data._session = Session(model, data, contact_models, contact_datas, settings.max_iter)
    a = session.solve(contact_models, settings, q, v, tau)
    if a is NotImplemented:
        q, v, tau = exact(q, model.nq, "q"), exact(v, model.nv, "v"), exact(tau, model.nv, "tau")
        session = data._session = Session(model, data, contact_models, contact_datas, settings.max_iter)
        a = session.solve(contact_models, settings, q, v, tau)
    if prox_settings is not None:
        settings._report(*session.report)
    data._blocks["lambda_c"] = session.forces
    data._known.update(("places", "own", "jacobians"))
    data._due |= OWN
    data._bound = session
    return a


_ONE_ROUND = ProximalSettings()
"""The settings that hold when none are given."""


def computeJointMinimalOrdering(model: Model, data: Data, constraint_models: Any) -> None:
    """Checks the constraints; `lcaba` needs no ordering here."""
    engine_for(model, data)
    paired(model, constraint_models, [one.createData() for one in constraint_models])


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
    return constraintDynamics(
        model, data, q, v, tau, constraint_models, constraint_datas, settings_of(prox_settings)
    )


def impulseDynamics(model: Model, data: Data, *state: Any, **named: Any) -> Floats:
    """The velocity after an impact (nv,); kept in `data.dq_after`, the impulses in `data.impulse_c`.

    `impulseDynamics(model, data, q, v, constraints, datas[, r_coeff[, settings]])`, or with a Jacobian,
    `impulseDynamics(model, data, [q,] v, J[, restitution_coefficient[, damping]])`; without q after crba.
    Each impulse is also in `contact_force` of the data of its constraint; both ends of a constraint count.
    """
    told = list(state)
    for name in ("q", "v_before", "v", "constraint_jacobian", "contact_models", "contact_datas"):
        if name in named:
            told.append(named.pop(name))
    if len(told) < 4 or not _are_constraints(told[2]):
        return impact_with_jacobian(model, data, *told, **named)
    return _impact(model, data, *told, **named)


def _are_constraints(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and all(isinstance(x, RigidConstraintModel) for x in value)


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
    state = bound(model, contact_models, contact_datas, q, v)
    settings = settings_of(prox_settings)
    engine = engine_for(model, data)
    blocks = data._blocks
    if not state.models:
        blocks["dq_after"][:] = state.v
        return state.v.copy()
    shapes = shapes_of(state.models)
    numbers = np.array([settings.mu, restitution(r_coeff)])
    given = (state.q, state.v, state.places, numbers)
    sizes: dict[str, Any] = dict(zip(("q", "v", "places", "numbers"), (x.shape for x in given), strict=True))
    found = engine.made(("impact", shapes), with_mass(_impact_of(shapes)), **sizes)(*given)
    blocks["ddq"][:], impulses, blocks["M"][:], blocks["J"][:], data._tails["oMi"][...] = found
    blocks["dq_after"][:] = after = state.v + found[0]
    blocks["impulse_c"] = impulses
    q = data.keep(engine, state.q)
    data._q_of_jacobians = q
    share(impulses, state.datas)
    leave(engine, state)
    data._bound = Solved(
        state._replace(q=q, v=state.v.copy()), found[0], impulses, 0.0 * impulses, settings, True
    )
    return after


def restitution(value: Any) -> float:
    part = float(value)
    if not 0.0 <= part <= 1.0:
        raise InputError(f"The coefficient of restitution is {value!r}; expected a number from 0 to 1.")
    return part


def _impact_of(shapes: Any) -> Any:
    def build(tower: TowerModel) -> Any:
        def run(q: Array, v: Array, places: Array, numbers: Array) -> tuple[Any, ...]:
            bonds = bonds_of(shapes, places)
            J = algorithms.constraint_jacobian(tower, q, bonds)
            jump = (1.0 + numbers[1]) * algorithms.constraint_velocity(tower, q, v, bonds)
            found = damped_impact(tower, q, J, jump, Damped(numbers[0], 0.0, 0.0, 1))
            return (
                found.a,
                found.forces,
                algorithms.mass_matrix(tower, q),
                algorithms.joint_jacobians(tower, q),
                stacked(algorithms.joint_poses(tower, q)),
            )

        return run

    return build
