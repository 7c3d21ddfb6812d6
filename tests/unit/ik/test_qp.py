"""Quadratic programs with rows, as handed to daqp."""

from __future__ import annotations

import numpy as np

from ulna.ik.qp import solve_rows

H, g = np.diag([1.0, 2.0]), np.array([-4.0, -4.0])
FAR = np.full(2, np.inf)


def test_rows_and_bounds_hold() -> None:
    """Of x^2 / 2 + y^2 - 4 x - 4 y below x + y = 3: x - 4 = 2 y - 4, so x = 2 and y = 1."""
    A = np.array([[1.0, 1.0]])
    x = solve_rows(H, g, A, np.append(-FAR, -np.inf), np.append(FAR, 3.0), 0)
    np.testing.assert_allclose(x, [2.0, 1.0], atol=1e-9)
    x = solve_rows(H, g, A, np.append(-FAR, -np.inf), np.array([1.5, np.inf, 3.0]), 0)
    np.testing.assert_allclose(x, [1.5, 1.5], atol=1e-9)


def test_the_last_rows_are_equalities() -> None:
    A = np.array([[1.0, 1.0], [1.0, -1.0]])
    x = solve_rows(H, g, A, np.append(-FAR, [-np.inf, 0.5]), np.append(FAR, [10.0, 0.5]), 1)
    assert x is not None
    np.testing.assert_allclose(x[0] - x[1], 0.5, atol=1e-9)
    np.testing.assert_allclose((H @ x + g).sum(), 0.0, atol=1e-8)


def test_none_where_nothing_lies_within() -> None:
    A = np.array([[1.0, 1.0]])
    assert solve_rows(H, g, A, np.array([0.0, 0.0, -np.inf]), np.array([1.0, 1.0, -1.0]), 0) is None
