"""The Delassus operator of a decomposition of mass matrix and constraints."""

from __future__ import annotations

from typing import Any, final

from pinocchio._constraints.delassus import DelassusOperator
from pinocchio._containers.keywords import by_name

__all__ = ["DelassusCholeskyExpression", "DelassusOperatorCholeskyExpression"]


@final
class DelassusOperatorCholeskyExpression(DelassusOperator):
    """`DelassusOperatorCholeskyExpression(decomposition)`: of its constraints, with its damping."""

    __slots__ = ("_of",)

    def __init__(self, cholesky_decomposition: Any) -> None:
        self._of = cholesky_decomposition
        self._hold(cholesky_decomposition._filled().G)
        self._damping = cholesky_decomposition._mu

    def cholesky(self) -> Any:
        """The decomposition."""
        return self._of

    @by_name("mu", "mus")
    def updateDamping(self, mu: Any) -> None:
        """Sets the damping, that of the decomposition, too."""
        self._of.updateDamping(mu)

    _damp = updateDamping


DelassusCholeskyExpression = DelassusOperatorCholeskyExpression
