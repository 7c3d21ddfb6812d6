"""Inverse dynamics with contacts: the forces of contacts whose velocities are given, and the torques besides."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.dynamics import rnea
from pinocchio._algorithms.kinematics import forwardKinematics
from pinocchio._constraints.anchors import PointContactConstraintModel
from pinocchio._constraints.proximal_settings import ProximalSettings, settings_of
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import vector
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from ulna.algorithms.constraints.contact_forces import contact_forces
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["computeInverseDynamicsConstraintForces", "contactInverseDynamics"]


def computeInverseDynamicsConstraintForces(
    c_ref: Any,
    contact_models: Any,
    contact_datas: Any,
    lambda_guess: Any = None,
    settings: Any = None,
    solve_ncp: bool = True,
) -> tuple[bool, Floats]:
    """Whether forces of contacts were found, and the forces (3 contacts,) [N].

    Args:
        c_ref: Velocities of the contacts over a time step (3 contacts,) [m/s^2].
        contact_models: PointContactConstraintModels; their compliance, or `settings.mu`, is above zero.
        lambda_guess: Forces to start from; None for zero.
        settings: Damping, accuracy and rounds; it receives the figures.
        solve_ncp: Whether contacts slide as Coulomb says; else a convex problem is solved.

    Returns:
        Whether forces were found, and the forces (3 c,) [N] of c contacts.

    Raises:
        InputError: A contact has no compliance, and `settings.mu` is zero.
    """
    models = _contacts(contact_models, contact_datas)
    settings = settings_of(settings)
    m = 3 * len(models)
    c = vector(c_ref, m, "c_ref")
    guess = np.zeros(m) if lambda_guess is None else vector(lambda_guess, m, "lambda_guess")
    if not models:
        return True, np.zeros(0)
    compliance = np.concatenate([one.retrieveCompliance() for one in models])
    if not (compliance + settings.mu > 0.0).all():
        raise InputError(
            "Contacts without compliance give way nowhere, so that their forces are not unique; give settings with "
            "mu > 0, such as ProximalSettings(1e-9, 1e-9, 1e-3, 100), or contact.setCompliance(...)."
        )
    if not np.array_equal(compliance[::3], compliance[1::3]):
        raise InputError(
            "The compliance of a contact is not the same along both tangents; make its first two equal."
        )
    solution = contact_forces(
        c,
        [one.getFriction() for one in models],
        compliance,
        guess,
        settings.mu,
        (settings.absolute_accuracy, settings.relative_accuracy),
        settings.max_iter,
        bool(solve_ncp),
    )
    settings._report(solution.rounds, solution.change, solution.residual)
    accurate = solution.residual <= settings.absolute_accuracy
    return bool(accurate or solution.change <= settings.relative_accuracy * solution.size), solution.forces


def contactInverseDynamics(
    model: Model,
    data: Data,
    q: Any,
    v: Any,
    a: Any,
    dt: float,
    contact_models: Any,
    contact_datas: Any,
    constraint_correction: Any,
    settings: ProximalSettings,
    lambda_guess: Any = None,
    solve_ncp: bool = True,
) -> tuple[bool, Floats, Floats]:
    """Whether forces were found, the torques (nv,) of a motion, kept in `data.tau`, and the forces (3 contacts,) [N].

    Args:
        dt: Time step, after which the contacts have the velocities of v + dt a [s].
        contact_models: PointContactConstraintModels.
        constraint_correction: What is added to these velocities (3 contacts,) [m/s].
        settings: See `computeInverseDynamicsConstraintForces`.
        lambda_guess: Forces to start from; None for zero.
        solve_ncp: Whether contacts slide as Coulomb says.

    Returns:
        Whether forces were found, torques (nv,) [N m or N], forces (3 c,) [N] of c contacts.

    Raises:
        InputError: The time step is not above zero.
    """
    models = _contacts(contact_models, contact_datas)
    if not float(dt) > 0.0:
        raise InputError(f"The time step is {dt!r}; expected seconds above zero.")
    v, a = vector(v, model.nv, "v"), vector(a, model.nv, "a")
    correction = vector(constraint_correction, 3 * len(models), "constraint_correction")
    forwardKinematics(model, data, q, v, a)
    J = np.zeros((0, model.nv))
    for one, known in zip(models, contact_datas, strict=True):
        one.calc(model, data, known)
        J = np.vstack([J, one.jacobian(model, data, known)])
    c = (J @ (v + dt * a) + correction) / dt
    done, forces = computeInverseDynamicsConstraintForces(
        c, models, contact_datas, lambda_guess, settings, solve_ncp
    )
    tau = rnea(model, data, q, v, a) - J.T @ forces
    data._arrays["tau"][:] = tau
    return done, tau, forces


def _contacts(models: Any, datas: Any) -> list[PointContactConstraintModel]:
    if len(models) != len(datas):
        raise InputError(
            f"There are {len(models)} contacts and {len(datas)} data of contacts; expected as many."
        )
    for one in models:
        if not isinstance(one, PointContactConstraintModel):
            raise ArgumentError(f"The contact is {one!r}; expected a PointContactConstraintModel.")
    return list(models)
