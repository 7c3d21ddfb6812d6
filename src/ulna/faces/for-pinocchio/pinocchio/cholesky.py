"""The mass matrix M = U D U^T of `data.M`, and what is solved with it."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._arrays import numbers
from pinocchio._data import Data
from pinocchio._dynamics import crba
from pinocchio._model import Model
from ulna.typing import Floats

__all__ = ["computeMinv", "decompose", "solve"]


def decompose(model: Model, data: Data) -> Floats:
    """The lower triangular factor L of `data.M` = L L^T; after crba."""
    return np.asarray(np.linalg.cholesky(data._blocks["M"]), dtype=float)


def solve(model: Model, data: Data, v: Any) -> Floats:
    """M^-1 v, v being (nv,) or (nv, n); after crba."""
    return np.asarray(np.linalg.solve(data._blocks["M"], numbers(v, "v")), dtype=float)


def computeMinv(model: Model, data: Data) -> Floats:
    """The inverse of `data.M`; kept in `data.Minv`."""
    if not data._blocks["M"].any():
        crba(model, data, data.require(data._q, "crba(model, data, q)"))
    data._blocks["Minv"][...] = np.linalg.inv(data._blocks["M"])
    return data._blocks["Minv"].copy()
