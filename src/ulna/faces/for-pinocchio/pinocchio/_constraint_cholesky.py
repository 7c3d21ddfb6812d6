"""The decomposition of mass matrix and constraints: K = [[-mu, J], [J^T, M]] = U D U^T."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._arrays import numbers
from pinocchio._constraint_jacobians import getConstraintsJacobian
from pinocchio._constraint_kernels import jacobian_kernel
from pinocchio._data import Data, engine_for
from pinocchio._delassus import DelassusOperatorCholeskyExpression, diagonal
from pinocchio._model import Model
from ulna import linalg
from ulna.errors import InputError, ShapeError
from ulna.typing import Floats

__all__ = ["ConstraintCholeskyDecomposition", "ContactCholeskyDecomposition"]


class ConstraintCholeskyDecomposition:
    """`ConstraintCholeskyDecomposition([model, data[, constraints, datas]])`, filled by `compute`."""

    __slots__ = ("_J", "_M", "_mu", "_parts")

    def __init__(self, model: Any = None, data: Any = None, models: Any = (), datas: Any = ()) -> None:
        self._parts: tuple[Floats, ...] | None = None
        if model is None:
            self._hold(np.zeros((0, 0)), np.zeros((0, 0)))
        else:
            self.rebuild(model, data, models, datas)

    def _hold(self, M: Floats, J: Floats, mu: Any = 0.0) -> ConstraintCholeskyDecomposition:
        self._M, self._J, self._parts = M, J, None
        self._mu = diagonal(mu, len(J), "mu")
        return self

    def rebuild(self, model: Model, data: Data, constraint_models: Any, constraint_datas: Any) -> None:
        """Makes room for constraints; the matrices are zero until `compute`."""
        engine_for(model, data)
        rows = sum(one.residualSize() for one in constraint_models)
        self._hold(np.zeros((model.nv, model.nv)), np.zeros((rows, model.nv)))

    def compute(
        self, model: Model, data: Data, contact_models: Any, contact_datas: Any, mu: Any = 0.0
    ) -> None:
        """Decomposes, with `data.M` of crba, and the Jacobians at the last configuration.

        Args:
            model: The model.
            data: Its data, after crba and kinematics.
            contact_models: The constraints.
            contact_datas: Their data.
            mu: Damping: one number, or one for each row.
        """
        M = data._blocks["M"]
        if not M[:1, :1].any() and not M.any():
            raise InputError("`data.M` holds no mass matrix yet. Call crba(model, data, q) first.")
        self._hold(M.copy(), getConstraintsJacobian(model, data, contact_models, contact_datas), mu)

    def size(self) -> int:
        """Rows of K: those of the constraints, and nv."""
        return len(self._J) + len(self._M)

    def constraintDim(self) -> int:
        """How many rows belong to constraints."""
        return len(self._J)

    def matrix(self) -> Floats:
        """K, constraints first."""
        return np.block([[-np.diag(self._mu), self._J], [self._J.T, self._M]])

    def _decomposed(self) -> tuple[Floats, ...]:
        """U and D.

        Raises:
            InputError: there is nothing to decompose yet, or the constraints depend on each other.
        """
        if self._parts is None:
            if not self._M.any():
                raise InputError(
                    "The decomposition is empty; call compute(model, data, constraints, datas) first."
                )
            m = len(self._J)
            U, D = np.eye(self.size()), np.zeros(self.size())
            U[m:, m:], D[m:] = _from_below(self._M)
            U[:m, m:] = np.linalg.solve(U[m:, m:], self._J.T).T / D[m:]
            G = (U[:m, m:] * D[m:]) @ U[:m, m:].T + np.diag(self._mu)
            try:
                U[:m, :m], outer = _from_below(G)
            except np.linalg.LinAlgError:
                raise InputError(
                    f"The {m} rows of the constraints depend on each other (rank {np.linalg.matrix_rank(self._J)}); "
                    "leave some out, or give a damping mu such as 1e-8."
                ) from None
            D[:m] = -outer
            self._parts = U, D
        return self._parts

    @property
    def U(self) -> Floats:
        """The unit upper triangular factor."""
        return self._decomposed()[0].copy()

    @property
    def D(self) -> Floats:
        """The diagonal; below zero for constraints."""
        return self._decomposed()[1].copy()

    @property
    def Dinv(self) -> Floats:
        """1 / D."""
        return 1.0 / self._decomposed()[1]

    def inverse(self) -> Floats:
        """The inverse of K."""
        return self.solve(np.eye(self.size()))

    def solve(self, matrix: Any) -> Floats:
        """x with K x = matrix, which is (size,) or (size, k)."""
        given = numbers(matrix, "matrix")
        if given.ndim not in (1, 2) or len(given) != self.size():
            raise ShapeError("matrix", given.shape, f"({self.size()},) or ({self.size()}, k)")
        U, D = self._decomposed()
        y = np.linalg.solve(U, given)
        return np.asarray(np.linalg.solve(U.T, (y.T / D).T), dtype=float)

    def getDamping(self) -> Floats:
        """The damping, a diagonal matrix."""
        return np.diag(self._mu)

    def updateDamping(self, mu: Any) -> None:
        """Sets the damping: one number, or one for each row of the constraints."""
        self._mu, self._parts = diagonal(mu, len(self._J), "mu"), None

    def getInverseMassMatrix(self) -> Floats:
        """M^-1."""
        return np.asarray(linalg.inverse(self._M), dtype=float)

    def getMassMatrixChoeslkyDecomposition(self, model: Any = None, data: Any = None) -> Any:
        """The decomposition of the mass matrix alone."""
        return ConstraintCholeskyDecomposition()._hold(self._M.copy(), np.zeros((0, len(self._M))))

    def _delassus(self) -> Floats:
        return self._J @ np.linalg.solve(self._M, self._J.T) if len(self._J) else np.zeros((0, 0))

    def getInverseOperationalSpaceInertiaMatrix(self, enforce_symmetry: bool = False) -> Floats:
        """J M^-1 J^T + mu."""
        return self._delassus() + np.diag(self._mu)

    def getOperationalSpaceInertiaMatrix(self) -> Floats:
        """The inverse of the same."""
        m = len(self._J)
        return -self.inverse()[:m, :m]

    def getDelassusOperatorCholeskyExpression(self) -> DelassusOperatorCholeskyExpression:
        """The Delassus operator of the constraints."""
        return DelassusOperatorCholeskyExpression(self)

    getDelassusCholeskyExpression = getDelassusOperatorCholeskyExpression

    def copy(self) -> ConstraintCholeskyDecomposition:
        """One of its own, with the same numbers."""
        return ConstraintCholeskyDecomposition()._hold(self._M.copy(), self._J.copy(), self._mu)

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> ConstraintCholeskyDecomposition:
        return self.copy()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ConstraintCholeskyDecomposition) and np.array_equal(
            self.matrix(), other.matrix()
        )

    __hash__ = None  # type: ignore[assignment]


ContactCholeskyDecomposition = ConstraintCholeskyDecomposition


def _from_below(A: Floats) -> tuple[Floats, Floats]:
    """u and d with A = u diag(d) u^T, u unit upper triangular."""
    lower, d = linalg.ldl(A[::-1, ::-1])
    return lower[::-1, ::-1], d[::-1]


def cholesky_of(data: Data) -> ConstraintCholeskyDecomposition:
    """That of the last constraintDynamics or impulseDynamics with constraints; empty when there was none."""
    found = ConstraintCholeskyDecomposition()
    if data._bound is None:
        return found
    solved, engine = data._bound, engine_for(data._model, data)
    q, _, places, _, _ = solved.kept
    J = jacobian_kernel(engine, solved.shapes, len(q))(q, *places)
    return found._hold(engine.plain("mass_matrix")(q), J, solved.numbers[0])
