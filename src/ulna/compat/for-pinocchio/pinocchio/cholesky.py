"""The mass matrix of `data.M` as U diag(D) U^T, and what is solved with it."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._constraints.factorization import Factorization, kernels_for, no_factors_error
from pinocchio._containers.arguments import checked, checks_itself
from pinocchio._containers.arrays import not_applicable, numbers
from pinocchio._containers.keywords import by_name
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from ulna.compiler.runtime.repeated_calls import call_cache, repeated_calls
from ulna.system.cached import cached_property
from ulna.typing import Floats

__all__ = ["computeMinv", "decompose", "solve"]


_decompose_calls, _solve_calls = (call_cache(2, weak=2) for _ in range(2))


@repeated_calls(_decompose_calls)
@by_name("Model Data", "model data")
@checks_itself
def decompose(model: Model, data: Data) -> Floats:
    """The unit upper triangular factor U of `data.M` = U diag(D) U^T; after crba.

    Args:
        model: The model.
        data: Its data, with M from crba.

    Returns:
        U, (nv, nv).
    """
    factors = _known(model, data)
    if factors is not None:
        U = factors.decompose()
        if U is not NotImplemented:
            _decompose_calls.add(factors.decompose, 0, model, data)
            return U
    return _factored(model, data, anew=True).upper()


@repeated_calls(_solve_calls)
@by_name("Model Data v", "model data v")
@checks_itself
def solve(model: Model, data: Data, v: Any) -> Floats:
    """M^-1 v, v being (nv,) or (nv, n), with the M that was decomposed last; after crba.

    Args:
        model: The model.
        data: Its data, with M from crba.
        v: Right side, (nv,) or (nv, n).

    Returns:
        M^-1 v, (nv,) or (nv, n).
    """
    factors = _known(model, data)
    if factors is not None:
        x = factors.solve_vector(v)
        if x is not NotImplemented:
            _solve_calls.add(factors.solve_vector, 1, model, data)
            return x
    if type(v) is not np.ndarray:
        v = numbers(v, "v")
    return _factored(model, data).solve(v)


@by_name("Model Data", "model data")
@checks_itself
def computeMinv(model: Model, data: Data) -> Floats:
    """The inverse of the M that was decomposed last; kept in `data.Minv`. After crba.

    Args:
        model: The model.
        data: Its data, with M from crba.

    Returns:
        The inverse, (nv, nv).
    """
    factors = _known(model, data)
    if factors is None or factors.outdated[0]:
        factors = _factored(model, data)
    data._marks[_MINV] = 0.0
    return factors.fill_inverse()


_MINV = Data._slots["Minv"]


@final
class _BoundFactors(Factorization):
    """The factors of `data.M`, with functions that are bound to the arrays of a Data."""

    def __init__(self, model: Model, data: Data) -> None:
        super().__init__(
            kernels_for(data._attach(model), np.zeros((0, model.nv))), model._watched("structure")
        )
        self._M, self._Minv = data._arrays["M"], data._arrays["Minv"]

    @cached_property
    def decompose(self) -> Any:
        """A function without arguments that factors M, and returns U."""
        return not_applicable if self.kernels.is_large else self.factors_and_upper(self._M)

    @cached_property
    def fill_inverse(self) -> Any:
        """A function without arguments that fills Minv, and returns a copy."""
        trailing_inputs = self.entries, self.r
        return self.kernels.inverse.into(self._Minv, returns=(0,), trailing_inputs=trailing_inputs)


def _known(model: Model, data: Data) -> _BoundFactors | None:
    """The factors that are bound to the arrays of a Data, if there are any."""
    try:
        return data._bound_at["cholesky"] if data._model is model else None
    except (AttributeError, KeyError, TypeError):  # of what is no data, or for the first time
        return None


@checked
def _factored(model: Model, data: Data, anew: bool = False) -> _BoundFactors:
    factors = _known(model, data)
    if anew or factors is None or factors.outdated[0]:
        M = data._arrays["M"]
        if factors is None or factors.factor(M, *factors.no_rows) is NotImplemented:
            factors = data._bound_at["cholesky"] = _BoundFactors(model, data)
            factors.factor(M, *factors.no_rows)
        factors.outdated[0] = 0.0
        if not factors.unique:
            raise no_factors_error(M, factors.no_rows[0])
    return factors
