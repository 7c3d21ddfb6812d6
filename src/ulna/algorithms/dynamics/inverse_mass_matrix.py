"""The inverse of the joint-space mass matrix, in closed form.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| M | mass matrix, armature included | (nv, nv) | [kg], [kg m], [kg m^2] | see crba.py |
| M^-1 | its inverse: accelerations at rest, without gravity, by torques | (nv, nv) | | see mass_matrix_factors.py |

Carpentier, Analytical inverse of the joint space inertia matrix (2018), finds the same entries by passing articulated
inertias inward and one acceleration for every column outward, about 30 operations an entry. With the sparse factors an
entry costs two operations for each common ancestor of its joints (Featherstone 2008, section 6.5): less for
every robot that was tried.
"""

from __future__ import annotations

from ulna.algorithms.dynamics.crba import mass_matrix
from ulna.algorithms.dynamics.mass_matrix_factors import Factors, columns_of_inverse
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.compiler.forms.columns import Columns
from ulna.model import Model
from ulna.typing import Array


def inverse_mass_matrix(model: Model, q: Array) -> Array:
    """The inverse of the mass matrix with armature.

    Args:
        model: The robot; every motion must move some mass or have armature.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        M^-1, shape (..., nv, nv) [1/kg, 1/(kg m), 1/(kg m^2)].
    """
    inverse = Factors(mass_matrix(model, q)).inverse()
    return inverse if inverse.dtype == object else inverse + batch_zeros((model.nv, model.nv), q)


def columns_of_inverse_mass_matrix(model: Model, q: Array) -> Columns:
    """The inverse of the mass matrix as the solutions of M x = e, column by column, for one sample.

    Args:
        model: The robot; every motion must move some mass or have armature.
        q: Configuration, shape (nq,) [rad, m].

    Returns:
        The mass matrix and what is done with a column of the unit matrix.
    """
    return columns_of_inverse(mass_matrix(model, q))
