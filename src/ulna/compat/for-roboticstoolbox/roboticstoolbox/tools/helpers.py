"""Odds and ends: null spaces, singular Jacobians, numerical derivatives, a clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.typing import Floats


def null(A: Any, atol: float = 1e-13, rtol: float = 0.0) -> Floats:
    """Orthonormal columns that `A` maps to zero.

    Args:
        A: The matrix, (m, n).
        atol: Singular values below it count as zero [any].
        rtol: So do those below it times the largest [-].

    Returns:
        Orthonormal columns, (n, k).
    """
    matrix = np.atleast_2d(np.asarray(A, dtype=float))
    _, s, Vt = np.linalg.svd(matrix)
    rank = int((s >= max(atol, rtol * s[0])).sum())
    return Vt[rank:].T


def jsingu(J: Any) -> None:
    """Prints which columns of a Jacobian depend on earlier ones."""
    matrix = np.asarray(J, dtype=float)
    basis: list[int] = []
    for j in range(matrix.shape[1]):
        factors, *_ = np.linalg.lstsq(matrix[:, basis], matrix[:, j], rcond=None)
        if np.linalg.norm(matrix[:, basis] @ factors - matrix[:, j]) >= 1e-9:
            basis.append(j)
            continue
        terms = "".join(
            f"{' - ' if x < 0.0 else ' + ' if i else ''}{abs(x):.3g} column_{basis[i]}"
            for i, x in enumerate(factors)
            if abs(x) > 1e-9
        )
        print(f"column {j} ={terms or ' 0'}")


def jacobian_numerical(f: Callable[[Floats], Any], x: Any, dx: float = 1e-8, N: int = 0) -> Floats:
    """The Jacobian of a function by forward differences.

    Args:
        f: Function of (n,) that returns (m,), or with `N` a pose, (N + 1, N + 1).
        x: Where, (n,).
        dx: Step [rad, m].
        N: 0; for poses 3, or 2 in the plane: rows are then those of velocities and of angular velocities.

    Returns:
        Jacobian (m, n).

    Raises:
        InputError: `N` is another number.
    """
    if N not in (0, 2, 3):
        raise InputError(f"`N` is {N}; expected 0, or 2 or 3 for poses in the plane or in space.")
    at = np.ravel(np.asarray(x, dtype=float))
    before = np.asarray(f(at), dtype=float)
    changes = [(np.asarray(f(at + dx * e), dtype=float) - before) / dx for e in np.eye(at.size)]
    if not N:
        return np.column_stack([np.ravel(change) for change in changes])
    spins = [change[:N, :N] @ before[:N, :N].T for change in changes]
    return np.column_stack([np.r_[c[:N, N], _axial(spin)] for c, spin in zip(changes, spins, strict=True)])


def _axial(spin: Floats) -> Floats:
    """The vector of a skew-symmetric matrix."""
    skew = 0.5 * (spin - spin.T)
    return np.array([skew[1, 0]]) if len(skew) == 2 else np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


def hessian_numerical(J: Callable[[Floats], Any], x: Any, dx: float = 1e-8) -> Floats:
    """The derivative of a Jacobian function by forward differences.

    Args:
        J: Function of (n,) that returns (m, n).
        x: Where, (n,).
        dx: Step [rad, m].

    Returns:
        Array (m, n, n): [:, :, i] is the derivative by coordinate i.
    """
    at = np.ravel(np.asarray(x, dtype=float))
    before = np.asarray(J(at), dtype=float)
    changes = [(np.asarray(J(at + dx * e), dtype=float) - before) / dx for e in np.eye(at.size)]
    return np.stack(changes, axis=2)


class Ticker:
    """Goes round a loop every `period` seconds; `behind` says how late the last round was."""

    def __init__(self, period: float) -> None:
        self.period, self.behind, self.count = period, 0.0, 0

    def __iter__(self) -> Iterator[float]:
        begin, self.count = time.perf_counter(), 0
        while True:
            yield self.count * self.period
            self.count += 1
            wait = begin + self.count * self.period - time.perf_counter()
            self.behind = max(-wait, 0.0)
            if wait > 0.0:
                time.sleep(wait)
