"""Small linear algebra: on floats as LAPACK, on symbols exactly, traced as on floats."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ulna import linalg
from ulna.compiler import compile, trace


def matrices(n: int) -> list[np.ndarray]:
    rng = np.random.default_rng(n)
    a = rng.standard_normal((n, n))
    spiked = a.copy()
    spiked[0, 0] = 0.0  # without pivoting this divides by zero
    return [a, spiked, a[::-1], np.eye(n)[::-1] + 1e-3 * a]


@pytest.mark.parametrize("n", [1, 2, 3, 4, 6])
def test_solve_inverse_and_determinant_traced(n: int) -> None:
    b = np.random.default_rng(0).standard_normal((n, 2))
    solve = trace(linalg.solve, a=(n, n), b=(n, 2))
    solve_vector = trace(linalg.solve, a=(n, n), b=(n,))
    inverse, determinant = trace(linalg.inverse, a=(n, n)), trace(linalg.determinant, a=(n, n))
    for a in matrices(n):
        if abs(np.linalg.det(a)) < 1e-9:
            continue
        np.testing.assert_allclose(solve(a, b), np.linalg.solve(a, b), rtol=1e-10, atol=1e-10)
        np.testing.assert_allclose(
            solve_vector(a, b[:, 0]), np.linalg.solve(a, b[:, 0]), rtol=1e-10, atol=1e-10
        )
        np.testing.assert_allclose(inverse(a), np.linalg.inv(a), rtol=1e-10, atol=1e-10)
        np.testing.assert_allclose(determinant(a), np.linalg.det(a), rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize("n", [1, 2, 3, 6])
def test_definite_matrices_traced(n: int) -> None:
    root = np.random.default_rng(n).standard_normal((n, n + 1))
    a, b = root @ root.T, np.arange(1.0, n + 1)
    lower, d = trace(linalg.ldl, a=(n, n))(a)
    np.testing.assert_allclose(lower @ np.diag(d) @ lower.T, a, atol=1e-12)
    assert (np.diag(lower) == 1.0).all()
    assert not np.triu(lower, 1).any()
    np.testing.assert_allclose(trace(linalg.cholesky, a=(n, n))(a), np.linalg.cholesky(a), atol=1e-12)
    solve = trace(linalg.solve_spd, a=(n, n), b=(n,))
    np.testing.assert_allclose(solve(a, b), np.linalg.solve(a, b), rtol=1e-8)
    many = trace(linalg.solve_spd, a=(n, n), b=(n, 3))
    right = np.arange(3.0 * n).reshape(n, 3)
    np.testing.assert_allclose(many(a, right), np.linalg.solve(a, right), rtol=1e-8, atol=1e-10)


def test_only_the_lower_triangle_of_a_definite_matrix_is_read() -> None:
    a = np.array([[4.0, np.nan], [1.0, 3.0]])
    whole = np.array([[4.0, 1.0], [1.0, 3.0]])
    solve = trace(linalg.solve_spd, a=(2, 2), b=(2,))
    np.testing.assert_allclose(solve(a, np.ones(2)), np.linalg.solve(whole, np.ones(2)), rtol=1e-14)


def test_floats_in_batches() -> None:
    rng = np.random.default_rng(1)
    root = rng.standard_normal((2, 5, 4, 6))
    a, b = root @ np.swapaxes(root, -1, -2), rng.standard_normal((2, 5, 4))
    for solve in (linalg.solve, linalg.solve_spd):
        x = solve(a, b)
        assert x.shape == (2, 5, 4)
        np.testing.assert_allclose((a @ x[..., None])[..., 0], b, atol=1e-9)
    lower, d = linalg.ldl(a)
    np.testing.assert_allclose((lower * d[..., None, :]) @ np.swapaxes(lower, -1, -2), a, atol=1e-12)
    np.testing.assert_allclose(linalg.volume(root), np.sqrt(np.linalg.det(a)), rtol=1e-10)
    np.testing.assert_allclose(linalg.inverse(a) @ a, np.broadcast_to(np.eye(4), a.shape), atol=1e-8)
    np.testing.assert_allclose(linalg.determinant(a), np.linalg.det(a))
    np.testing.assert_allclose(linalg.cholesky(a), np.linalg.cholesky(a))


@pytest.mark.parametrize("n", [2, 4])
def test_symbols_are_solved_exactly(n: int) -> None:
    sympy = pytest.importorskip("sympy")
    x = sympy.symbols(f"x:{n}")
    a = np.array([[sympy.Integer(1) / (i + j + 1) for j in range(n)] for i in range(n)], dtype=object)
    a[0, 0] = sympy.Integer(0)  # a structural zero is stepped over
    b = np.array(x, dtype=object)
    expected = sympy.Matrix(a).LUsolve(sympy.Matrix(x))
    for got, want in zip(linalg.solve(a, b), expected, strict=True):
        assert sympy.simplify(got - want) == 0
    assert sympy.simplify(linalg.determinant(a) - sympy.Matrix(a).det()) == 0


@pytest.mark.parametrize("shape", [(1, 3), (3, 3), (3, 7), (6, 7), (4, 2)])
def test_rows_are_made_orthogonal(shape: tuple[int, int]) -> None:
    a = np.random.default_rng(3).standard_normal(shape)
    m = shape[0]
    functions: list[Callable] = [linalg.orthogonalise, trace(linalg.orthogonalise, a=shape)]
    for f in functions:
        lower, rows, squares, reciprocals = f(a)
        np.testing.assert_allclose(lower @ rows, a, atol=1e-13)
        gram = rows @ rows.T
        if m <= shape[1]:
            np.testing.assert_allclose(gram, np.diag(squares), atol=1e-13)
            np.testing.assert_allclose(squares * reciprocals, np.ones(m), rtol=1e-14)


def of_condition(condition: float, m: int, n: int, rng: np.random.Generator) -> np.ndarray:
    """A random matrix with singular values from 1 to 1 / condition."""
    u, v = np.linalg.qr(rng.standard_normal((m, m)))[0], np.linalg.qr(rng.standard_normal((n, n)))[0]
    return (u * np.geomspace(1.0, 1.0 / condition, m)) @ v[:m]


@pytest.mark.parametrize("shape", [(1, 1), (1, 3), (3, 3), (3, 7), (6, 7), (6, 4), (4, 1)])
def test_pseudoinverse_of_floats_batches_and_traces(shape: tuple[int, int]) -> None:
    a = np.random.default_rng(4).standard_normal((5, *shape))
    kernel = compile(linalg.pseudoinverse, a=shape)
    for inverse, condition in (linalg.pseudoinverse(a), kernel(a)):
        np.testing.assert_allclose(inverse, np.linalg.pinv(a), rtol=0.0, atol=1e-12)
        estimate = np.linalg.norm(a, axis=(-2, -1)) * np.linalg.norm(inverse, axis=(-2, -1))
        np.testing.assert_allclose(condition, estimate, rtol=1e-12)
        assert (condition >= np.linalg.cond(a) * (1.0 - 1e-12)).all()


@pytest.mark.parametrize("condition", [1.0, 1e2, 1e4, 1e6, 1e8, 1e10])
def test_pseudoinverse_is_as_good_as_by_singular_values(condition: float) -> None:
    """Against 60 digits: the error is that of the numbers themselves, the condition times the rounding unit."""
    mpmath = pytest.importorskip("mpmath")
    rng, kernel = np.random.default_rng(7), compile(linalg.pseudoinverse, a=(6, 7))
    for _ in range(4):
        a = of_condition(condition, 6, 7, rng)
        with mpmath.workdps(60):
            wide = mpmath.matrix(a.tolist())
            exact = wide.T * (wide * wide.T) ** -1
            inverse, estimate = kernel(a)
            error = mpmath.norm(mpmath.matrix(inverse.tolist()) - exact) / mpmath.norm(exact)
        assert error < 4.0 * np.finfo(float).eps * condition
        assert condition <= estimate <= 6.0 * condition * (1.0 + 1e-3)


def test_pseudoinverse_reports_where_the_rank_is_lost() -> None:
    rng, kernel = np.random.default_rng(8), compile(linalg.pseudoinverse, a=(6, 7))
    whole = rng.standard_normal((6, 7))
    poor = [
        rng.standard_normal((6, r)) @ rng.standard_normal((r, 7)) for r in range(1, 6) for _ in range(200)
    ]
    for i, j in ((0, 1), (2, 5), (4, 3)):
        a = whole.copy()
        a[i] = -0.3 * a[j]
        poor.append(a)
    poor += [np.zeros((6, 7)), whole * (np.arange(7) > 1), whole * (np.arange(6) != 2)[:, None]]
    assert (kernel(np.array(poor))[1] > 1e15).all()
    for wrong in (whole * 1e-160, whole * 1e160, np.where(whole == whole[2, 3], np.nan, whole)):
        assert kernel(wrong)[1] == np.inf
    np.testing.assert_allclose(kernel(whole * 1e-140)[0] * 1e-140, np.linalg.pinv(whole), rtol=1e-12)


def test_volume_keeps_its_digits_beside_a_singularity() -> None:
    """Where det(a a^T) is lost to rounding, at 1e-16 of its terms, its root is still good to 1e-9."""
    a = np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0 + 1e-10], [0.0, 1.0, 0.0]])
    assert abs(linalg.volume(a) - 1e-10) < 1e-15
    assert linalg.volume(np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0]])) == 0.0
    assert linalg.volume(np.zeros((2, 3))) == 0.0


def test_dependent_rows_are_left_out() -> None:
    a = np.array([[0.1, 0.2, 0.3], [0.3, 0.6, 0.9], [1.0, 0.0, 0.0]])
    lower, rows, _, reciprocals = linalg.orthogonalise(a, noise=1e-14)
    assert reciprocals[1] == 0.0
    assert not lower[2, 1]
    np.testing.assert_allclose(lower @ rows, a, atol=1e-15)


@pytest.mark.parametrize("shape", [(6, 7), (6, 6), (6, 4)])
def test_damped_solutions_are_those_of_the_stacked_least_squares(shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(4)
    J, b, damping = rng.standard_normal(shape), rng.standard_normal(shape[0]), 0.03
    stacked = np.vstack([J, np.sqrt(damping) * np.eye(shape[1])])
    expected = np.linalg.lstsq(stacked, np.concatenate([b, np.zeros(shape[1])]), rcond=None)[0]
    np.testing.assert_allclose(linalg.solve_damped(J, b, damping), expected, rtol=1e-10)
    kernel = compile(lambda J, b: linalg.solve_damped(J, b, damping), J=shape, b=(shape[0],))
    np.testing.assert_allclose(kernel(J, b), expected, rtol=1e-10)
