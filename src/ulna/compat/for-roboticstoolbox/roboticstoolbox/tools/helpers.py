"""Odds and ends: null spaces, singular Jacobians, numerical derivatives, a clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

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
    """The Jacobian of a vector function by forward differences.

    Args:
        f: Function of (n,) that returns (m,).
        x: Where, (n,).
        dx: Step [rad, m].
        N: Accepted and ignored.

    Returns:
        Jacobian (m, n).
    """
    at = np.ravel(np.asarray(x, dtype=float))
    before = np.ravel(np.asarray(f(at), dtype=float))
    columns = [(np.ravel(np.asarray(f(at + dx * e), dtype=float)) - before) / dx for e in np.eye(at.size)]
    return np.column_stack(columns)


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
