"""Parts of solvers: tridiagonal matrices, the decomposition of Lanczos, and what projected Gauss-Seidel records."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _symmetric(n: int, seed: int = 0) -> np.ndarray:
    A = np.random.default_rng(seed).normal(size=(n, n))
    return A + A.T


@pytest.mark.parametrize(("n", "k"), [(6, 6), (9, 4), (1, 1)])
def test_a_symmetric_matrix_is_decomposed(pin: Any, n: int, k: int) -> None:
    A = _symmetric(n)
    parts = pin.LanczosDecomposition(A, k)
    Q, T = parts.Qs(), parts.Ts().matrix()
    assert np.allclose(Q.T @ Q, np.eye(k), atol=1e-13) and np.allclose(Q.T @ A @ Q, T, atol=1e-12)
    assert np.allclose(parts.computeDecompositionResidual(A), 0.0, atol=1e-12)
    other = pin.LanczosDecomposition(n, k)
    other.compute(A)
    assert other == parts and copy.deepcopy(parts) == parts and parts != pin.LanczosDecomposition(2.0 * A, k)


def test_where_the_krylov_space_ends_another_axis_continues(pin: Any) -> None:
    A = np.diag([1.0, 2.0, 3.0, 4.0])
    A[0, 2] = A[2, 0] = 0.5
    parts = pin.LanczosDecomposition(A, 4)
    Q = parts.Qs()
    assert np.allclose(Q.T @ Q, np.eye(4)) and np.allclose(Q @ parts.Ts().matrix() @ Q.T, A, atol=1e-13)


def test_eigenvalues_of_a_tridiagonal_matrix_are_numpys(pin: Any) -> None:
    T = pin.LanczosDecomposition(_symmetric(7, 3), 7).Ts()
    wanted = np.linalg.eigvalsh(T.matrix())
    assert np.allclose(T.computeSpectrum(1e-12), wanted, atol=1e-11)
    assert abs(T.computeEigenvalue(2, 0.2) - wanted[2]) <= 0.1 and T.computeEigenvalue(2, 0.2) != wanted[2]
    T.setIdentity()
    assert T.isIdentity() and T.isDiagonal() and not T.isZero() and np.allclose(T.computeSpectrum(), 1.0)
    T.subDiagonal()[0] = 0.5
    assert (
        not T.isDiagonal()
        and T.isDiagonal(0.6)
        and np.allclose(T * np.arange(7.0), T.matrix() @ np.arange(7.0))
    )
    T.setZero()
    assert T.isZero() and pin.TridiagonalSymmetricMatrix(7) == T


def test_what_cannot_be_decomposed_is_refused(pin: Any) -> None:
    T = pin.TridiagonalSymmetricMatrix(3)
    for wrong in (
        lambda: T.computeEigenvalue(3),
        lambda: T.computeEigenvalue(0, 0.0),
        lambda: T.setDiagonal(np.ones(2)),
        lambda: pin.TridiagonalSymmetricMatrix(-1),
        lambda: pin.LanczosDecomposition(np.eye(3), 4),
        lambda: pin.LanczosDecomposition(np.eye(3), 0),
        lambda: pin.LanczosDecomposition(np.ones((2, 3)), 1),
        lambda: pin.LanczosDecomposition(3, 2).compute(np.eye(2)),
    ):
        with pytest.raises(InputError):
            wrong()


def _contacts(pin: Any, count: int) -> tuple[Any, ...]:
    rng = np.random.default_rng(count)
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    J = rng.normal(size=(3 * count, 20))
    models = [pin.PointContactConstraintModel(model, 3) for _ in range(count)]
    for one in models:
        one.setFriction(0.5)
    datas = [one.createData() for one in models]
    pin.forwardKinematics(model, data, pin.neutral(model))
    for one, known in zip(models, datas, strict=True):
        one.calc(model, data, known)
    return J @ J.T + 0.01 * np.eye(3 * count), rng.normal(size=3 * count), models, datas


def test_rounds_are_recorded_and_change_nothing(pin: Any) -> None:
    G, g, models, datas = _contacts(pin, 2)
    found = []
    for record in (False, True):
        settings, result, solver = pin.PGSSolverSettings(), pin.PGSSolverResult(), pin.PGSConstraintSolver(6)
        settings.stat_record = settings.measure_timings = record
        assert solver.solve(pin.DelassusOperatorDense(G), g, models, datas, settings, result)
        assert (solver.getElapsedTime() > 0.0) == record
        stats = solver.stats
        found.append((result.iterations, result.retrieveConstraintImpulses()))
        assert stats.size() == (result.iterations + 1 if record else 0)
        assert stats.iterations == (result.iterations if record else 0)
        if record:
            assert stats.dual_feasibility_ncp[-1] < 1e-4 < stats.dual_feasibility_ncp[0]
            assert stats.dual_feasibility[-1] == result.dual_feasibility
            assert stats.complementarity[-1] == result.complementarity and set(stats.primal_feasibility) == {
                0.0
            }
        stats.reset()
        assert stats.size() == stats.iterations == 0
    assert found[0][0] == found[1][0] > 1 and np.allclose(found[0][1], found[1][1], atol=1e-14)


def test_solutions_satisfy_coulombs_law(pin: Any) -> None:
    """Impulses lie in their cones, and velocities, corrected for sliding, in the dual cones, at right angles."""
    for count in (1, 2, 4):
        G, g, models, datas = _contacts(pin, count)
        for kind in ("PGS", "ADMM"):
            result = getattr(pin, f"{kind}SolverResult")()
            settings = getattr(pin, f"{kind}SolverSettings")()
            solver = getattr(pin, f"{kind}ConstraintSolver")(len(g))
            if kind == "PGS":
                settings.over_relaxation = 0.3  # whole steps overshoot where tangential entries differ much
            assert solver.solve(pin.DelassusOperatorDense(G), g, models, datas, settings, result)
            impulses = result.retrieveConstraintImpulses()
            velocities = G @ impulses + g
            for f, v in zip(impulses.reshape(-1, 3), velocities.reshape(-1, 3), strict=True):
                slide = np.linalg.norm(v[:2])
                dual = v + np.array([0.0, 0.0, 0.5 * slide])
                assert np.linalg.norm(f[:2]) <= 0.5 * f[2] + 1e-5
                assert slide * 0.5 <= dual[2] + 1e-4 and abs(f @ dual) < 1e-4


def test_friction_of_pairs_of_materials(pin: Any) -> None:
    table = pin.getFrictionCoefficientMatrix()
    assert isinstance(table, pin.FrictionCoefficientMatrix)
    kinds = (pin.ICE, pin.METAL, pin.PLASTIC, pin.WOOD, pin.CONCRETE)
    values = np.array([[table.getFrictionFromMaterialPair(a, b) for b in kinds] for a in kinds])
    assert np.array_equal(values, values.T) and values[4, 1] == 0.85 and values[0, 2] == 0.0
