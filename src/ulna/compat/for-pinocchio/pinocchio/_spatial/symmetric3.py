"""Symmetric3: a symmetric 3x3 matrix in six numbers."""

from __future__ import annotations

from typing import Any, Self, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError, is_number
from pinocchio._containers.arrays import is_empty, matrix, real, text, vector
from pinocchio._containers.keywords import by_name
from pinocchio._spatial.bound_functions import BoundFunctions
from pinocchio._spatial.motion_force import skew
from pinocchio._spatial.random_numbers import generator
from pinocchio._spatial.small_kernels import SIX_NUMBERS, rotated
from ulna.typing import Floats


@final
class Symmetric3:
    """A symmetric 3x3 matrix, stored as xx, xy, yy, xz, yz, zz: `Symmetric3(matrix)`, or those six numbers."""

    __slots__ = ("_d",)

    _made: BoundFunctions

    @by_name("I", "a0 a1 a2 a3 a4 a5", "other", "clone")
    def __init__(self, *parts: Any) -> None:
        self._d = np.zeros(6)
        if len(parts) == 1:
            one = parts[0]
            if isinstance(one, Symmetric3):
                self._d[:] = one._d
            elif np.shape(one) == (6,):
                self._d[:] = vector(one, 6, "data")
            else:
                self._d[:] = _packed(matrix(one, (3, 3), "matrix"))
        elif len(parts) == 6:
            self._d[:] = vector(parts, 6, "data")
        elif parts:
            raise ArgumentError(
                f"Symmetric3 was given {len(parts)} arguments; expected a matrix, six numbers, or an array of them."
            )

    @staticmethod
    def Zero() -> Symmetric3:
        """All zero."""
        return Symmetric3()

    @staticmethod
    def Identity() -> Symmetric3:
        """The identity."""
        return Symmetric3(np.eye(3))

    @staticmethod
    def Random() -> Symmetric3:
        """Entries drawn evenly from [-1, 1]."""
        return Symmetric3(generator().uniform(-1.0, 1.0, 6))

    @property
    def data(self) -> Floats:
        """xx, xy, yy, xz, yz, zz, a view."""
        return self._d

    @data.setter
    def data(self, value: Any) -> None:
        self._d[:] = vector(value, 6, "data")

    def matrix(self) -> Floats:
        """The 3x3 matrix."""
        xx, xy, yy, xz, yz, zz = self._d
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def inverse(self, res: Floats) -> None:
        """Writes the inverse matrix (3, 3) into `res`."""
        matrix(res, (3, 3), "res")
        res[:] = np.linalg.inv(self.matrix())

    def rotate(self, R: Any) -> Symmetric3:
        """R S R^T."""
        turn = matrix(R, (3, 3), "R")
        return Symmetric3(turn @ self.matrix() @ turn.T)

    def vtiv(self, v: Any) -> float:
        """v^T S v."""
        return float(vector(v, 3, "v") @ self.matrix() @ vector(v, 3, "v"))

    @staticmethod
    def vxs(v: Any, S3: Symmetric3) -> Floats:
        """[v]x S3.

        Args:
            v: Vector (3,), in any unit [-].
            S3: Symmetric matrix.

        Returns:
            Matrix (3, 3).
        """
        return skew(v) @ S3.matrix()

    @staticmethod
    def svx(v: Any, S3: Symmetric3) -> Floats:
        """S3 [v]x.

        Args:
            v: Vector (3,), in any unit [-].
            S3: Symmetric matrix.

        Returns:
            Matrix (3, 3).
        """
        return S3.matrix() @ skew(v)

    @staticmethod
    def rhsMult(S: Symmetric3, v: Any, out: Floats) -> None:
        """Writes S v into an array.

        Args:
            S: Symmetric matrix.
            v: Vector (3,), in any unit [-].
            out: Array (3,), which is changed.
        """
        out[:] = S.matrix() @ vector(v, 3, "v")

    def decomposeltI(self) -> Floats:
        """A (3, 2) with S - lambda I = A A^T, lambda being the least eigenvalue."""
        values, vectors = np.linalg.eigh(self.matrix())
        return np.asarray(vectors[:, 1:] * np.sqrt(values[1:] - values[0]), dtype=float)

    def fill(self, value: float) -> None:
        """Makes all entries `value`."""
        self._d[:] = value

    def setDiagonal(self, diag: Any) -> None:
        """Changes the diagonal."""
        self._d[[0, 2, 5]] = vector(diag, 3, "diag")

    def setZero(self) -> None:
        """Makes it zero."""
        self._d[:] = 0.0

    def setIdentity(self) -> None:
        """Makes it the identity."""
        self._d[:] = 1.0, 0.0, 1.0, 0.0, 0.0, 1.0

    def setRandom(self) -> None:
        """Draws it anew; see `Random`."""
        self._d[:] = Symmetric3.Random()._d

    def isZero(self, prec: float = 1e-12) -> bool:
        """Whether all entries are at most `prec`."""
        return bool(np.abs(self._d).max() <= prec)

    def isApprox(self, other: Symmetric3, prec: float = 1e-12) -> bool:
        """Whether the entries agree.

        Args:
            other: Another matrix.
            prec: Largest norm of their difference, relative to the norm where that is above 1 [-].

        Returns:
            Whether they do.
        """
        return bool(np.linalg.norm(self._d - other._d) <= prec * max(1.0, float(np.linalg.norm(self._d))))

    def copy(self) -> Symmetric3:
        """A copy."""
        return Symmetric3(self)

    __copy__ = cast = copy

    def _assign(self, other: Any) -> None:
        self._d[...] = _summand(other)._d

    def __add__(self, other: Any) -> Symmetric3:
        return Symmetric3(self._d + _summand(other)._d)

    def __sub__(self, other: Any) -> Symmetric3:
        return Symmetric3(self._d - _summand(other)._d)

    def __neg__(self) -> Symmetric3:
        return Symmetric3(-self._d)

    def __mul__(self, other: Any) -> Any:
        if is_number(other):
            return Symmetric3(self._d * other)
        if np.ndim(other) == 0 or is_empty(other):
            return NotImplemented
        return self.matrix() @ vector(other, 3, "v")

    def __imul__(self, factor: Any) -> Self:
        self._d[...] *= real(factor, "factor")
        return self

    def __iadd__(self, other: Any) -> Self:
        self._d[...] += _summand(other)._d
        return self

    def __isub__(self, other: Any) -> Self:
        self._d[...] -= _summand(other)._d
        return self

    def __eq__(self, other: object) -> bool:
        return bool((self._d == other._d).all()) if isinstance(other, Symmetric3) else NotImplemented

    __hash__ = object.__hash__

    def __deepcopy__(self, memo: Any) -> Symmetric3:
        return self.copy()

    def __reduce__(self) -> Any:
        return Symmetric3, (self._d.copy(),)

    def __str__(self) -> str:
        return f"m_data: {text(self._d)}\n"

    __repr__ = __str__


def _packed(full: Floats) -> list[float]:
    """The lower triangle, which counts in Pinocchio where a matrix is not symmetric."""
    return [full[i, j] for i, j in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2))]


def _summand(other: Any) -> Symmetric3:
    """What may be added: a Symmetric3, or a matrix (3, 3)."""
    return other if isinstance(other, Symmetric3) else Symmetric3(matrix(other, (3, 3), "summand"))


Symmetric3._made = BoundFunctions({**SIX_NUMBERS, "rotated": (rotated, (6,), (3, 3))}, holder=Symmetric3)
