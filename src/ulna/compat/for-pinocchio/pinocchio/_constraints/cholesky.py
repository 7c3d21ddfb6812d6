"""The decomposition of mass matrix and constraints: K = [[-mu, J], [J^T, M]] = U D U^T."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._constraints.constraint_set import cached_constraint_set
from pinocchio._constraints.delassus import diagonal, with_added_diagonal
from pinocchio._constraints.delassus_of_cholesky import DelassusOperatorCholeskyExpression
from pinocchio._constraints.factorization import Factorization, FactorKernels, kernels_for, no_factors_error
from pinocchio._constraints.jacobians import check_constraints, getConstraintsJacobian, jacobian_here
from pinocchio._constraints.kernels import factor_kernels, jacobian_kernel
from pinocchio._containers.arguments import OMITTED, WrongShape
from pinocchio._containers.arrays import numbers
from pinocchio._containers.keywords import by_name
from pinocchio._data.data import Data
from pinocchio._data.states import compiled_for
from pinocchio._model.model import Model
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["ConstraintCholeskyDecomposition", "ContactCholeskyDecomposition"]


class ConstraintCholeskyDecomposition:
    """`ConstraintCholeskyDecomposition([model, data[, constraints, datas]])`, filled by `compute`."""

    __slots__ = ("_J", "_M", "_U", "_constraint_set", "_factored", "_is_new", "_mu")

    @by_name("model data contact_models contact_datas", "model data constraint_models constraint_datas")
    def __init__(self, model: Any = OMITTED, data: Any = None, models: Any = (), datas: Any = ()) -> None:
        self._make_room(0, 0)
        if model is not OMITTED:
            self.rebuild(model, data, models, datas)

    def _make_room(self, m: int, n: int) -> None:
        self._M, self._J, self._mu = np.zeros((n, n)), np.zeros((m, n)), np.zeros(m)
        self._factored: Factorization | None = None
        self._is_new = True  # the factors, since U was read
        self._U: Floats | None = None
        self._constraint_set: Any = None

    def _hold(self, kernels: FactorKernels, M: Floats, J: Floats, mu: Any) -> ConstraintCholeskyDecomposition:
        """Decomposes these matrices, of which M is copied."""
        factored = self._factored
        if factored is None or factored.kernels is not kernels:
            self._make_room(*J.shape)
            self._factored = factored = Factorization(kernels)
        self._M[...], self._J = M, J
        self.updateDamping(mu)
        return self

    def rebuild(self, model: Model, data: Data, constraint_models: Any, constraint_datas: Any) -> None:
        """Allocates the matrices of constraints, which are zero until `compute`."""
        compiled_for(model, data)
        check_constraints(constraint_models)
        self._make_room(sum(one.residualSize() for one in constraint_models), model.nv)

    @by_name(
        "model data contact_models contact_datas mu",
        "model data contact_models contact_datas mus",
        "model data constraint_models constraint_datas mu",
        "model data constraint_models constraint_datas mus",
    )
    def compute(
        self, model: Model, data: Data, contact_models: Any, contact_datas: Any, mu: Any = 0.0
    ) -> None:
        """Decomposes, with `data.M` of crba, and the Jacobians at the last configuration.

        Args:
            data: Its data, after crba and kinematics.
            mu: Damping: one number, or one for each row.
        """
        M = data._arrays["M"]
        constraint_set = cached_constraint_set(model, data, contact_models, contact_datas)
        if (
            constraint_set is not None
            and constraint_set is self._constraint_set
            and self._factored is not None
        ):
            self._hold(self._factored.kernels, M, jacobian_here(model, data, constraint_set), mu)
        else:
            J = getConstraintsJacobian(model, data, contact_models, contact_datas)
            constraint_set = cached_constraint_set(model, data, contact_models, contact_datas)
            compiled = compiled_for(model, data)
            kernels = (
                kernels_for(compiled, np.ones(J.shape))
                if constraint_set is None
                else factor_kernels(compiled, constraint_set.shapes)
            )
            self._hold(kernels, M, J, mu)
            self._constraint_set = constraint_set
        if not self._filled().flag[0] and not M.any():
            raise no_factors_error(M, self._J)

    def size(self) -> int:
        """Rows of K: those of the constraints, and nv."""
        return len(self._J) + len(self._M)

    def constraintDim(self) -> int:
        """How many rows belong to constraints."""
        return len(self._J)

    def matrix(self) -> Floats:
        """K, constraints first."""
        m, size = self._J.shape[0], self.size()
        out = np.zeros((size, size))
        out[:m, m:], out[m:, :m], out[m:, m:] = self._J, self._J.T, self._M
        out.reshape(-1)[: m * size : size + 1] = -self._mu
        return out

    def _filled(self) -> Factorization:
        """The factors.

        Raises:
            InputError: nothing has been decomposed yet.
        """
        if self._factored is None:
            raise InputError(
                "The decomposition is empty; call compute(model, data, constraints, datas) first."
            )
        return self._factored

    def _decomposed(self) -> Factorization:
        """The factors, when they are unique.

        Raises:
            InputError: there is nothing to decompose yet, or the constraints depend on each other.
        """
        factored = self._factored
        if factored is None or not factored.flag[0]:
            self._filled()
            raise no_factors_error(self._M, self._J)
        return factored

    @property
    def U(self) -> Floats:
        """The unit upper triangular factor; the same array at every reading."""
        U = self._U
        if U is None:
            U = self._U = self._decomposed().upper()
        elif self._is_new:
            U[...] = self._decomposed().upper()
        self._is_new = False
        return U

    @property
    def D(self) -> Floats:
        """The diagonal; below zero for constraints. A live reference."""
        return self._decomposed().D

    @property
    def Dinv(self) -> Floats:
        """1 / D."""
        return self._decomposed().r.copy()

    def inverse(self) -> Floats:
        """The inverse of K."""
        return self._decomposed().inverse(self._J, self._mu)

    def solve(self, matrix: Any) -> Floats:
        """x with K x = matrix, which is (size,) or (size, k)."""
        factored = self._factored
        if factored is None or not factored.flag[0]:
            self._decomposed()  # raises
        assert factored is not None
        x = factored.solve_vector(matrix)
        if x is not NotImplemented:
            return x
        right = numbers(matrix, "matrix")
        if right.ndim not in (1, 2) or len(right) != self.size():
            raise WrongShape("matrix", right.shape, f"({self.size()},) or ({self.size()}, k)")
        return self._decomposed().solve(right)

    def getDamping(self) -> Floats:
        """The damping, a diagonal matrix."""
        return np.diag(self._mu)

    @by_name("mu", "mus")
    def updateDamping(self, mu: Any) -> None:
        """Sets the damping: one number, or one for each row of the constraints."""
        if type(mu) is float and mu >= 0.0:
            self._mu.fill(mu)
        else:
            self._mu[...] = diagonal(mu, len(self._mu), "mu")
        if self._factored is not None:
            self._factored.factor(self._M, self._J, self._mu)
            self._is_new = True

    def getInverseMassMatrix(self) -> Floats:
        """M^-1."""
        return self._filled().inverse_mass()

    def getMassMatrixChoeslkyDecomposition(self, model: Any = None, data: Any = None) -> Any:
        """The decomposition of the mass matrix alone.

        Args:
            model, data: Accepted and ignored.

        Returns:
            The decomposition of M.
        """
        kernels = self._filled().kernels.of_mass
        return ConstraintCholeskyDecomposition()._hold(kernels, self._M, self._J[:0], 0.0)

    def getInverseOperationalSpaceInertiaMatrix(self, enforce_symmetry: bool = False) -> Floats:
        """J M^-1 J^T + mu."""
        return with_added_diagonal(self._filled().G, self._mu)

    def getOperationalSpaceInertiaMatrix(self) -> Floats:
        """The inverse of the same."""
        return -self._decomposed().minus_inverse_delassus(self._mu)

    def getDelassusOperatorCholeskyExpression(self) -> DelassusOperatorCholeskyExpression:
        """The Delassus operator of the constraints."""
        return DelassusOperatorCholeskyExpression(self)

    getDelassusCholeskyExpression = getDelassusOperatorCholeskyExpression

    def copy(self) -> ConstraintCholeskyDecomposition:
        """A copy."""
        twin = ConstraintCholeskyDecomposition()
        if self._factored is not None:
            return twin._hold(self._factored.kernels, self._M, self._J.copy(), self._mu)
        twin._make_room(*self._J.shape)
        return twin

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> ConstraintCholeskyDecomposition:
        return self.copy()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ConstraintCholeskyDecomposition) and np.array_equal(
            self.matrix(), other.matrix()
        )

    __hash__ = object.__hash__


ContactCholeskyDecomposition = ConstraintCholeskyDecomposition


def cholesky_of(data: Data) -> ConstraintCholeskyDecomposition:
    """That of the last constraintDynamics or impulseDynamics with constraints; empty when there was none."""
    solved, compiled = data._constraint_solution, data._attach(data._model)
    decomposition = data._bound_at.setdefault("constraints", ConstraintCholeskyDecomposition())
    if solved is None:
        return decomposition
    q, _, placements, _, _ = solved.state
    M, J = (
        compiled.core_kernel("mass_matrix")(q),
        jacobian_kernel(compiled, solved.shapes, len(q))(q, *placements),
    )
    return decomposition._hold(factor_kernels(compiled, solved.shapes), M, J, float(solved.settings[0]))


Data.constraint_chol = Data.contact_chol = property(
    cholesky_of,
    doc="The decomposition of mass matrix and constraints of the last constraintDynamics or impulseDynamics.",
)
