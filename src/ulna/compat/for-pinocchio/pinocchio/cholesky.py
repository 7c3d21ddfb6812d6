"""The mass matrix of `data.M` as U diag(D) U^T, and what is solved with it."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._constraints.factorization import Factorization, kernels_for, no_factors_error
from pinocchio._containers.arguments import checked
from pinocchio._containers.arrays import numbers
from pinocchio._containers.keywords import by_name
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from ulna.typing import Floats

__all__ = ["computeMinv", "decompose", "solve"]


@by_name("Model Data", "model data")
@checked
def decompose(model: Model, data: Data) -> Floats:
    """The unit upper triangular factor U of `data.M` = U diag(D) U^T; after crba.

    Args:
        model: The model.
        data: Its data, with M from crba.

    Returns:
        U, (nv, nv).
    """
    return _factored(model, data, anew=True).upper()


@by_name("Model Data v", "model data v")
@checked
def solve(model: Model, data: Data, v: Any) -> Floats:
    """M^-1 v, v being (nv,) or (nv, n), with the M that was decomposed last; after crba.

    Args:
        model: The model.
        data: Its data, with M from crba.
        v: Right side, (nv,) or (nv, n).

    Returns:
        M^-1 v, (nv,) or (nv, n).
    """
    if type(v) is not np.ndarray:
        v = numbers(v, "v")
    return _factored(model, data).solve(v)


@by_name("Model Data", "model data")
@checked
def computeMinv(model: Model, data: Data) -> Floats:
    """The inverse of the M that was decomposed last; kept in `data.Minv`. After crba.

    Args:
        model: The model.
        data: Its data, with M from crba.

    Returns:
        The inverse, (nv, nv).
    """
    data._arrays["Minv"][...] = Minv = _factored(model, data).inverse_mass()
    data.mark_filled("Minv")
    return Minv


def _factored(model: Model, data: Data, anew: bool = False) -> Factorization:
    factors = data._bound_at.get("cholesky") if data._model is model else None
    if anew or factors is None or factors.outdated:
        M = data._arrays["M"]
        if factors is None or factors.factor(M, *factors.no_rows) is NotImplemented:
            kernels = kernels_for(data.attach(model), np.zeros((0, model.nv)))
            factors = data._bound_at["cholesky"] = Factorization(kernels, model.watched("structure"))
            factors.factor(M, *factors.no_rows)
        factors.outdated = False
        if not factors.unique:
            raise no_factors_error(M, factors.no_rows[0])
    return factors
