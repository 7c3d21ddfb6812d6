"""Ten numbers without bounds for any body that can exist: the log-Cholesky parameters of its pseudo-inertia.

| symbol | meaning | shape | equation |
|---|---|---|---|
| p | m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz | (10) | |
| S | second moments of mass about the origin | (3, 3) | S = tr(I)/2 1 - I |
| P | pseudo-inertia, positive definite for every body with volume | (4, 4) | P = [[S, m c], [m c^T, m]] |
| U | its upper triangular factor | (4, 4) | P = U U^T |
| t | alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3 | (10) | U = e^alpha [[e^d1, s12, s13, t1], ..., [0, 0, 0, 1]] |

Source: Rucker & Wensing, Smooth parameterization of rigid-body inertia (2022), section III.
"""

from __future__ import annotations

import numpy as np

from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.checks.arrays import finite_array
from ulna.errors import InputError, ShapeError
from ulna.typing import Array, ArrayLike, Floats

_PLACES = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
_OFF = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
"""Where s12, s23, s13, t1, t2, t3 stand in U."""


def pseudo_inertia(parameters: ArrayLike) -> Floats:
    """P, (..., 4, 4), of the ten parameters (..., 10)."""
    return pseudo_inertia_of(_checked_parameters("parameters", parameters))


def pseudo_inertia_of(p: Array) -> Array:
    """P, (..., 4, 4), of the ten parameters (..., 10), which are not checked."""
    tensor = batch_zeros((3, 3), p)
    for k, (i, j) in enumerate(_PLACES):
        tensor[..., i, j] = tensor[..., j, i] = p[..., 4 + k]
    P = batch_zeros((4, 4), p)
    half = 0.5 * np.trace(tensor, axis1=-2, axis2=-1)
    P[..., :3, :3] = np.asarray(half)[..., None, None] * np.eye(3) - tensor
    P[..., :3, 3] = P[..., 3, :3] = p[..., 1:4]
    P[..., 3, 3] = p[..., 0]
    return P


def parameters_of(P: Array) -> Array:
    """The ten parameters (..., 10) of a pseudo-inertia (..., 4, 4)."""
    S = P[..., :3, :3]
    tensor = np.asarray(np.trace(S, axis1=-2, axis2=-1))[..., None, None] * np.eye(3) - S
    entries = [tensor[..., i, j] for i, j in _PLACES]
    return np.stack([P[..., 3, 3], P[..., 0, 3], P[..., 1, 3], P[..., 2, 3], *entries], axis=-1)


def log_cholesky(parameters: ArrayLike) -> Floats:
    """t, (..., 10), of bodies that have volume.

    Raises:
        InputError: a body cannot exist, or is flat: a point, a line or a sheet; `nearest_physical` fixes that.
    """
    P = pseudo_inertia(parameters)
    try:
        lower = np.linalg.cholesky(P[..., ::-1, ::-1])
    except np.linalg.LinAlgError:
        least = float(np.linalg.eigvalsh(P).min())
        raise InputError(
            f"The parameters are not those of a body with volume: the least eigenvalue of the pseudo-inertia is "
            f"{least:.3g}; expected more than zero. `nearest_physical` computes the nearest possible body."
        ) from None
    U = lower[..., ::-1, ::-1]
    corner = U[..., 3, 3]
    diagonal = [np.log(U[..., i, i] / corner) for i in range(3)]
    off = [U[..., i, j] / corner for i, j in _OFF]
    return np.stack([np.log(corner), *diagonal, *off], axis=-1)


def from_log_cholesky(t: ArrayLike) -> Floats:
    """The ten parameters (..., 10) of any t, (..., 10); always those of a body that can exist."""
    return parameters_of(pseudo_inertia_of_factor(_checked_parameters("t", t)))


def pseudo_inertia_of_factor(t: Array) -> Array:
    """P, (..., 4, 4), of t, (..., 10), which is not checked."""
    U = _factor(t)
    return U @ np.swapaxes(U, -1, -2)


def log_cholesky_jacobian(t: ArrayLike) -> Floats:
    """The derivative (..., 10, 10) of the parameters by t."""
    return jacobian_of_factor(_checked_parameters("t", t))


def jacobian_of_factor(t: Array) -> Array:
    """The derivative (..., 10, 10) of the parameters by t, (..., 10), which is not checked."""
    U = _factor(t)
    scale = np.exp(t[..., 0])
    columns = []
    for k in range(10):
        dU = batch_zeros((4, 4), t)
        if k == 0:
            dU = U
        elif k < 4:
            dU[..., k - 1, k - 1] = U[..., k - 1, k - 1]
        else:
            i, j = _OFF[k - 4]
            dU[..., i, j] = scale
        half = dU @ np.swapaxes(U, -1, -2)
        columns.append(parameters_of(half + np.swapaxes(half, -1, -2)))
    return np.stack(columns, axis=-1)


def nearest_physical(parameters: ArrayLike, least: float = 1e-6) -> Floats:
    """Parameters of bodies with volume, near the ones that are passed.

    The eigenvalues of the pseudo-inertia are raised to at least `least` times the greatest of any body.

    Args:
        parameters: Dynamic parameters of bodies, shape (..., 10) [kg, kg m, kg m^2].
        least: That fraction [-].

    Returns:
        Parameters, shape (..., 10) [kg, kg m, kg m^2]; those that are consistent already are unchanged.
    """
    P = pseudo_inertia(parameters)
    values, vectors = np.linalg.eigh(P)
    floor = least * max(float(values.max(initial=0.0)), 1e-9)
    raised = np.maximum(values, floor)
    changed = parameters_of((vectors * raised[..., None, :]) @ np.swapaxes(vectors, -1, -2))
    fine = np.asarray((values >= floor).all(axis=-1))
    return np.where(fine[..., None], _checked_parameters("parameters", parameters), changed)


def _factor(t: Array) -> Array:
    U = batch_zeros((4, 4), t)
    for i in range(3):
        U[..., i, i] = np.exp(t[..., 1 + i])
    for k, (i, j) in enumerate(_OFF):
        U[..., i, j] = t[..., 4 + k]
    U[..., 3, 3] = 1.0
    return np.asarray(np.exp(t[..., 0]))[..., None, None] * U


def _checked_parameters(name: str, parameters: ArrayLike) -> Floats:
    array = finite_array(name, parameters)
    if array.shape[-1:] != (10,):
        raise ShapeError(name, array.shape, "(..., 10)")
    return array
