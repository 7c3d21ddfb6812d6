"""computeAllTerms: the terms of the equation of motion, Jacobians, momenta and energies at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.center_of_mass import about_origin, as_one_body
from pinocchio._algorithms.energy import energies
from pinocchio._algorithms.jacobians import JACOBIAN_RATES, rates
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import (
    ACCELERATIONS,
    BODY_FORCES,
    CENTERS_AND_VELOCITIES,
    JOINTS,
    SUBTREE_MOMENTA,
    VELOCITIES_IN_WORLD,
)
from pinocchio._data.functions import algorithm
from pinocchio._model.model import Model
from ulna import algorithms
from ulna.model import Model as CoreModel
from ulna.typing import Array

__all__ = ["computeAllTerms"]


def _all_terms(model: CoreModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Any, ...]:
        Ag, dAg = algorithms.centroidal_matrix(model, q), algorithms.centroidal_matrix_dot(model, q, v)
        weight = np.asarray(model.gravity) * algorithms.total_mass(model)
        hg, dhg = Ag @ v, dAg @ v - np.concatenate([weight, np.zeros(3)])
        return (
            algorithms.mass_matrix(model, q),
            algorithms.bias_forces(model, q, v),
            algorithms.gravity_forces(model, q),
            algorithms.center_of_mass_jacobian(model, q),
            Ag,
            hg,
            dhg,
            about_origin(model, q, hg),
            about_origin(model, q, dhg),
            algorithms.center_of_mass(model, q),
            algorithms.center_of_mass_velocity(model, q, v),
            *energies(model, q, v),
            dAg,
            as_one_body(model, q),
            *rates(model)(q, v),
        )

    return run


@algorithm(
    fills=(
        *("M", "nle", "g", "Jcom", "Ag", "hg", "dhg", "h[0]", "f[0]", "com[0]", "vcom[0]"),
        *("energy K", "energy P", "energy K + P", "dAg", "Ig", *JACOBIAN_RATES),
    ),
    kernel=_all_terms,
    deferred=JOINTS
    | VELOCITIES_IN_WORLD
    | BODY_FORCES
    | SUBTREE_MOMENTA
    | ACCELERATIONS
    | CENTERS_AND_VELOCITIES,
)
def computeAllTerms(model: Model, data: Data, q: Any, v: Any) -> None:
    """Fills M, nle, g, J, dJ, Jcom, Ag, dAg, hg, Ig, com, vcom, energies, placements, velocities; not C, not oMf."""
    ...
