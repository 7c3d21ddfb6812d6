"""Mass matrix and constraints as one matrix K = [[-mu, J], [J^T, M]] = U D U^T: factored and solved by native calls."""

from __future__ import annotations

from array import array
from functools import lru_cache
from typing import Any, final

import numpy as np

from pinocchio._constraints.delassus import with_added_diagonal
from pinocchio._containers.arrays import not_applicable
from pinocchio._model.bound_kernels import BoundKernel
from pinocchio._model.compiled_model import CompiledModel
from ulna import linalg
from ulna.algorithms.constraints import kkt_factors as constrained_factors
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.compiler import compile as compile_function
from ulna.errors import InputError
from ulna.numeric import vector
from ulna.system.cached import cached_property
from ulna.typing import Array, Floats

_OPERATIONS = 30_000
"""Factors that take more are not compiled as a whole; 12 dense rows on a humanoid take 20,000, and a second."""
_ROWS = 24
"""The dense inverse of more rows is left to LAPACK."""
_INVERTED_AS_A_WHOLE = 32
"""The inverse of a larger K is made of products by BLAS; compiling 32 rows takes half a second."""


def kernels_for(compiled: CompiledModel, rows: Array) -> FactorKernels:
    """What is compiled for a model, and for Jacobians with entries where `rows` (m, nv) is true.

    Args:
        rows: Which entries of the Jacobian may differ from zero, (m, nv) of bool.

    Returns:
        The kernels, compiled once.
    """
    return _kernels(rows.shape[1], compiled.mass_pattern, rows.astype(bool).tobytes())


@lru_cache(64)
def _kernels(size: int, mass: bytes, rows: bytes) -> FactorKernels:
    return FactorKernels(*(np.frombuffer(x, bool).reshape(-1, size).astype(float) for x in (mass, rows)))


@final
class FactorKernels:
    """What is compiled for a pattern of M and J, each when it is first used.

    Attributes:
        mass: 1 where M may have entries, else 0 (nv, nv).
        rows: The same of J (m, nv).
        filled: The same of U (m + nv, m + nv).
        places: Rows and columns of U's entries above the diagonal, row by row; those of M's U are the last.
    """

    def __init__(self, mass: Floats, rows: Floats) -> None:
        self.mass, self.rows, self.filled = mass, rows, constrained_factors.filled(mass, rows)
        self.places = np.nonzero(np.triu(self.filled, 1))
        self._input_sizes: dict[str, Any] = {"entries": len(self.places[0]), "r": len(self.filled)}

    @cached_property
    def of_mass(self) -> FactorKernels:
        """Those for M alone."""
        return _kernels(len(self.mass), self.mass.astype(bool).tobytes(), b"")

    @cached_property
    def is_large(self) -> bool:
        """Whether U has more entries than are worth compiling."""
        above = self.filled.sum(axis=0) - 1.0
        return bool((above * (above + 2.0)).sum() > _OPERATIONS)

    @cached_property
    def factor(self) -> Any:
        """M, J, mu (m,): entries of U, D, 1/D, the Delassus matrix, and what is above zero where they are unique."""
        return compile_function(self._factor, M=self.mass.shape, J=self.rows.shape, mu=len(self.rows))

    def _factor(self, M: Array, J: Array, mu: Array) -> tuple[Any, ...]:
        factors, G, unique = constrained_factors.constrained_factors(M * self.mass, J * self.rows, mu)
        entries = [factors.lower[k].get(j, 0.0) for j, k in zip(*self.places, strict=True)]
        return vector(*entries), vector(*factors.pivots), vector(*factors.reciprocals), G, unique

    @cached_property
    def factor_and_upper(self) -> Any:
        """What `factor` makes of M, J and mu, and U, and that they are not outdated."""

        def run(M: Array, J: Array, mu: Array) -> tuple[Any, ...]:
            entries, *others = self._factor(M, J, mu)
            return entries, *others, self._upper(entries), np.zeros(1)

        return compile_function(run, M=self.mass.shape, J=self.rows.shape, mu=len(self.rows))

    @cached_property
    def upper(self) -> Any:
        """Entries of U: U."""
        return compile_function(self._upper, entries=self._input_sizes["entries"])

    def _upper(self, entries: Array) -> Array:
        out = np.eye(len(self.filled)).astype(object)
        out[self.places] = entries
        return out

    @cached_property
    def row_of_upper(self) -> Any:
        """Entries and 1/D of M, and a row of J: that row of the U of both."""

        def run(entries: Array, r: Array, row: Array) -> Array:
            entries_of_row = self._factors(entries, r).inward(row)
            return vector(*(x * reciprocal for x, reciprocal in zip(entries_of_row, r, strict=True)))

        return compile_function(run, **self._input_sizes, row=len(self.mass))

    @cached_property
    def solve(self) -> Any:
        """b, entries, 1/D: x with K x = b."""

        def run(b: Array, entries: Array, r: Array) -> Array:
            return vector(*self._factors(entries, r).solve(list(b)))

        return compile_function(run, b=len(self.filled), **self._input_sizes)

    @cached_property
    def motion(self) -> Any:
        """Entries, 1/D, torques, those that give no acceleration, and the drift: accelerations and forces."""

        def run(entries: Array, r: Array, tau: Array, nle: Array, drift: Array) -> tuple[Array, Array]:
            return constrained_factors.constrained_motion(self._factors(entries, r), tau - nle, drift)

        m, n = self.rows.shape
        return compile_function(run, **self._input_sizes, tau=n, nle=n, drift=m)

    @cached_property
    def impact(self) -> Any:
        """Entries, 1/D, J, a velocity, and the coefficient of restitution: the velocity after it, and impulses."""

        def run(entries: Array, r: Array, J: Array, v: Array, part: Any) -> tuple[Array, Array]:
            factors = self._factors(entries, r)
            return constrained_factors.constrained_impact(factors, J * self.rows, v, part)

        return compile_function(run, **self._input_sizes, J=self.rows.shape, v=len(self.mass), part=())

    @cached_property
    def inverse(self) -> Any:
        """Entries and 1/D: the inverse of K, or of M where there are no constraints."""
        return compile_function(lambda entries, r: self._factors(entries, r).inverse(), **self._input_sizes)

    @cached_property
    def inverse_joints_first(self) -> Any:
        """Entries and 1/D: the inverse of [[M, J^T], [J, -mu]]."""
        m, n = self.rows.shape
        order = [*range(m, m + n), *range(m)]

        def run(entries: Array, r: Array) -> Array:
            return self._factors(entries, r).inverse()[order][:, order]

        return compile_function(run, **self._input_sizes)

    @cached_property
    def minus_inverse_delassus(self) -> Any:
        """Entries, 1/D: the first corner of K^-1, the opposite of the inverse of the damped Delassus matrix."""
        m = len(self.rows)

        def run(entries: Array, r: Array) -> Array:
            factors = self._factors(entries, r)
            return Factors.of(factors.lower[:m], factors.reciprocals[:m]).inverse()

        return compile_function(run, **self._input_sizes)

    def _factors(self, entries: Array, r: Array) -> Factors:
        lower: list[dict[int, Any]] = [{} for _ in r]
        for j, k, entry in zip(*self.places, entries, strict=True):
            lower[k][j] = entry
        return Factors.of(lower, list(r))


class Factorization:
    """The factors of one K, in arrays of this object.

    Attributes:
        kernels: What is compiled for its pattern.
        entries: Of the unit upper triangle U, as `FactorKernels.places` says.
        D: The diagonal (m + nv,), below zero for constraints.
        r: 1 / D.
        G: The Delassus matrix, without damping (m, m).
        unique: Above zero when K has been factored, and its factors are unique ().
        flag: The same number, read more quickly.
        factor: Called with M, J and mu (m,), it fills them; NotImplemented where these are not exactly such arrays,
            or what is watched has changed.
        outdated: Not zero when it must be called before the factors are used again (1,).
        no_rows: J and mu where there are none.
    """

    def __init__(self, kernels: FactorKernels, watch: Any = ()) -> None:
        m, n = kernels.rows.shape
        self.kernels, self.no_rows, self.outdated = kernels, (np.zeros((0, n)), np.zeros(0)), np.zeros(1)
        self.entries, self.D, self.r = np.zeros(len(kernels.places[0])), np.zeros(m + n), np.zeros(m + n)
        self.flag = array("d", [0.0])
        self.G, self.unique = np.zeros((m, m)), np.frombuffer(self.flag).reshape(())
        self.factor: Any = self._factor_rows
        if not kernels.is_large:
            targets = self.entries, self.D, self.r, self.G, self.unique
            self.factor = kernels.factor.into(*targets, watch=watch, otherwise=not_applicable)
        self._watch = watch

    def _factor_rows(self, M: Floats, J: Floats, mu: Floats) -> Any:
        """The same for many rows, each seen by a native call, and the Delassus matrix by LAPACK."""
        m, kernels = len(J), self.kernels.of_mass
        mass = Factorization(kernels)
        if np.shape(J) != self.kernels.rows.shape or mass.factor(M, *mass.no_rows) is NotImplemented:
            return NotImplemented
        self.unique[...] = 0.0
        W = np.array([kernels.row_of_upper(mass.entries, mass.r, row) for row in J])
        self.G[...] = (W * mass.D) @ W.T
        try:
            lower, d = linalg.ldl(with_added_diagonal(self.G, mu)[::-1, ::-1])
        except np.linalg.LinAlgError:
            return None
        self.D[:] = np.concatenate([-d[::-1], mass.D])
        self.r[:] = 1.0 / self.D
        U = np.hstack([lower[::-1, ::-1], W])
        above = self.kernels.places[0] < m
        self.entries[above], self.entries[~above] = (
            U[tuple(x[above] for x in self.kernels.places)],
            mass.entries,
        )
        self.unique[...] = mass.unique and ((mu > 0.0) | (d[::-1] > 1e-12 * self.G.diagonal())).all()
        return None

    @cached_property
    def upper(self) -> Any:
        """A function without arguments: U (m + nv, m + nv)."""
        return BoundKernel(self.kernels.upper, trailing_inputs=(self.entries,)).call

    @cached_property
    def solve_vector(self) -> Any:
        """A function of b (m + nv,): x with K x = b; NotImplemented where b is not exactly such an array.

        So it is where the factors are outdated, too.
        """
        watch = [(self.outdated, np.zeros(1))]
        return BoundKernel(self.kernels.solve, watch, trailing_inputs=(self.entries, self.r)).call

    def solve(self, b: Floats) -> Floats:
        """x with K x = b, (m + nv,) or (m + nv, k)."""
        solve = self.kernels.solve
        if b.ndim == 1:
            return solve(b, self.entries, self.r)
        columns = [solve(column, self.entries, self.r) for column in np.ascontiguousarray(b.T)]
        return np.array(columns).reshape(b.T.shape).T.copy()

    def factors_and_upper(self, M: Floats) -> Any:
        """A function without arguments that factors M, where there are no constraints, and returns U.

        Args:
            M: The array (nv, nv) that is read at every call.

        Returns:
            The function; NotImplemented comes of it where what is watched has changed, or M has no factors.
        """
        U = np.zeros(M.shape)
        targets = self.entries, self.D, self.r, self.G, self.unique, U, self.outdated
        return self.kernels.factor_and_upper.into(
            *targets,
            returns=(5,),
            condition=4,
            watch=self._watch,
            otherwise=not_applicable,
            trailing_inputs=(M, *self.no_rows),
        )

    def inverse_mass(self) -> Floats:
        """M^-1 (nv, nv)."""
        kernels = self.kernels.of_mass
        first = len(self.entries) - len(kernels.places[0])
        return kernels.inverse(self.entries[first:], self.r[len(self.G) :])

    def mass(self) -> Floats:
        """M (nv, nv), as it was when K was factored."""
        m, U = len(self.G), np.eye(len(self.D))
        U[self.kernels.places] = self.entries
        joints = U[m:, m:]
        return (joints * self.D[m:]).dot(joints.T)

    def minus_inverse_delassus(self, mu: Floats) -> Floats:
        """The opposite of the inverse of the Delassus matrix with the damping mu that was factored (m, m)."""
        if len(mu) > _ROWS:
            return -linalg.inverse(with_added_diagonal(self.G, mu))
        return self.kernels.minus_inverse_delassus(self.entries, self.r)

    def inverse(self, J: Floats, mu: Floats, joints_first: bool = False) -> Floats:
        """The inverse of K.

        Args:
            mu: Damping (m,).
            joints_first: Whether rows and columns are in the order of [[M, J^T], [J, -mu]].

        Returns:
            Matrix (m + nv, m + nv).
        """
        if len(self.r) <= _INVERTED_AS_A_WHOLE:
            kernels = self.kernels
            inverse = kernels.inverse_joints_first if joints_first else kernels.inverse
            return inverse(self.entries, self.r)
        (m, n), M = self.kernels.rows.shape, self.inverse_mass()
        out = np.empty((m + n, m + n))
        joints, rows = (slice(0, n), slice(n, None)) if joints_first else (slice(m, None), slice(0, m))
        JM = J.dot(M)
        S = self.minus_inverse_delassus(mu)
        SJM = S.dot(JM)
        out[rows, rows] = S
        np.negative(SJM, out[rows, joints])
        np.negative(SJM.T, out[joints, rows])
        np.add(JM.T.dot(SJM), M, out[joints, joints])
        return out


def no_factors_error(M: Floats, J: Floats) -> InputError:
    """The reason why K has no factors.

    Args:
        M: Mass matrix (nv, nv).

    Returns:
        The error to raise.
    """
    if not (np.isfinite(M).all() and np.isfinite(J).all()):
        return InputError(
            "The mass matrix or the Jacobian of the constraints holds numbers that are not finite."
        )
    if not M.any():
        return InputError("`data.M` holds no mass matrix yet. Call crba(model, data, q) first, or give q.")
    if not np.linalg.eigvalsh(M)[0] > 0.0:
        return InputError(
            "The mass matrix in `data.M` is not positive definite; crba(model, data, q) makes it."
        )
    return InputError(
        f"The {len(J)} rows of the constraints depend on each other (rank {np.linalg.matrix_rank(J)}), so that their "
        "forces are not unique. Leave some out, or give a damping mu such as 1e-8."
    )
