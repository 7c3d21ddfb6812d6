"""Projected Gauss-Seidel and ADMM take as many iterations as Pinocchio's, with the same residuals and the same results."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import both
from ulna.errors import InputError

KINDS = 7
"""So many kinds of problems come in turn."""


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def differences(own: Any, real: Any) -> list[str]:
    """The paths at which answers differ by more than rounding, which iterations multiply."""
    if isinstance(real, dict):
        return [f"{name}.{path}" for name in real for path in differences(own[name], real[name])]
    a, b = np.asarray(own, float), np.asarray(real, float)
    if a.shape == b.shape and np.allclose(
        a, b, rtol=1e-3, atol=1e-5 * max(np.abs(b).max(initial=0.0), 1.0), equal_nan=True
    ):
        return []
    return [f"{own} / {real}"]


@pytest.mark.parametrize("solver", ["PGS", "ADMM"])
@pytest.mark.parametrize(("first", "count"), [(0, 56), pytest.param(56, 504, marks=pytest.mark.slow)])
def test_random_problems(solver: str, first: int, count: int, tmp_path: Path) -> None:
    """Rounding decides in extrapolations of many iterates that nearly depend on each other; elsewhere nowhere."""
    pytest.importorskip("pinocchio")
    script = Path(__file__).with_name("asked_solvers.py")
    wrong, other_counts, asked = [], np.zeros(KINDS), np.zeros(KINDS)
    answers = zip(*both(script, tmp_path, solver, str(first), str(count)), strict=True)
    for seed, (own, real) in enumerate(answers, first):
        for time, (mine, its) in enumerate(zip(own, real, strict=True)):
            asked[seed % KINDS] += 1
            grown = mine.get("primal_feasibility", 0.0)  # of iterates that grow without end
            size = max(1.0, np.abs(mine["impulses"]).max(), grown)
            assert mine.pop("noise", 0.0) < 1e-3 * size, seed
            its.pop("noise", None)
            same = mine["iterations"] == its["iterations"] and mine["converged"] == its["converged"]
            other_counts[seed % KINDS] += not same
            found = differences(mine, its) if same and its["converged"] else []
            wrong += [(seed, time, found)] if found else []
            assert (same and not found) or its["capacity"] > 1, (seed, time, found)
    assert other_counts.sum() <= 0.02 * asked.sum() and (other_counts <= 0.02 * asked + 2).all()
    assert len(wrong) <= 0.03 * asked.sum(), wrong
    assert solver == "ADMM" or not (wrong or other_counts.any())


@pytest.mark.parametrize("solver", ["PGS", "ADMM"])
def test_problems_in_which_much_is_zero(solver: str, tmp_path: Path) -> None:
    pytest.importorskip("pinocchio")
    own, real = both(Path(__file__).with_name("asked_solvers.py"), tmp_path, solver)
    assert len(real) == (24 if solver == "PGS" else 30)
    for case, its in real.items():
        its.pop("noise", None)
        assert own[case]["iterations"] == its["iterations"] and own[case]["converged"] == its["converged"], (
            case
        )
        assert not differences(own[case], its), case


def _block(pin: Any) -> tuple[Any, ...]:
    """A mass of 2 kg falls onto the ground at 3 m/s, sideways at 1 m/s; friction 0.1."""
    model = pin.buildSampleModelManipulator()
    data, ground = model.createData(), pin.PointContactConstraintModel(model, 6)
    ground.setFriction(0.1)
    known = ground.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    ground.calc(model, data, known)
    return 0.5 * np.eye(3), np.array([1.0, 0.0, -3.0]), [ground], [known]


@pytest.mark.parametrize("name", ["PGS", "ADMM"])
def test_a_block_on_the_ground_by_hand(pin: Any, name: str) -> None:
    """6 N s stop it, friction takes a tenth of that; where it slides as a convex problem says, ADMM lets it lift off."""
    problem = _block(pin)
    settings, result = getattr(pin, f"{name}SolverSettings")(), getattr(pin, f"{name}SolverResult")()
    solver = getattr(pin, f"{name}ConstraintSolver")(3)
    settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = 1e-10
    settings.relative_feasibility_tol = 0.0
    assert np.isnan(result.complementarity) and not result.isValid()
    assert solver.solve(*problem, settings, result) and result.isValid()
    np.testing.assert_allclose(result.retrieveConstraintImpulses(), [-0.6, 0.0, 6.0], atol=1e-8)
    np.testing.assert_allclose(result.retrieveConstraintVelocities(), [0.7, 0.0, 0.0], atol=1e-8)
    settings.solve_ncp = False
    assert solver.solve(*problem, settings, result)
    lift = 0.1 * result.retrieveConstraintVelocities()[0] if name == "ADMM" else 0.0
    assert result.retrieveConstraintVelocities()[2] == pytest.approx(lift, abs=1e-8)


@pytest.mark.parametrize("name", ["PGS", "ADMM"])
def test_guesses_serve_one_search_and_must_fit(pin: Any, name: str) -> None:
    problem = _block(pin)
    settings, result = getattr(pin, f"{name}SolverSettings")(), getattr(pin, f"{name}SolverResult")()
    solver = getattr(pin, f"{name}ConstraintSolver")(3)
    counts = []
    for guess in (None, [-0.6, 0.0, 6.0], None):
        if guess is not None:
            result.setConstraintImpulseGuess(guess)
        assert solver.solve(*problem, settings, result)
        counts.append(result.iterations)
    assert counts[1] == 0 and counts[2] == counts[0] > (0 if name == "ADMM" else -1)
    result.setConstraintImpulseGuess(np.zeros(2))
    with pytest.raises(InputError, match=r"guess of the impulse.*\(2,\)"):
        solver.solve(*problem, settings, result)


@pytest.mark.parametrize("name", ["PGS", "ADMM"])
def test_nan_is_no_solution(pin: Any, name: str) -> None:
    """Pinocchio's PGS says that it has converged."""
    G, g, models, datas = _block(pin)
    for row in range(12):
        velocities = np.tile(g, 4)
        velocities[row] = np.nan
        settings, result = getattr(pin, f"{name}SolverSettings")(), getattr(pin, f"{name}SolverResult")()
        settings.max_iterations = 5
        solver = getattr(pin, f"{name}ConstraintSolver")(12)
        assert not solver.solve(np.kron(np.eye(4), G), velocities, models * 4, datas * 4, settings, result)
        assert result.iterations == 6 and not result.converged


@pytest.mark.parametrize("name", ["PGS", "ADMM"])
def test_many_iterations_are_made_in_several_calls(pin: Any, name: str) -> None:
    G, g, models, datas = _block(pin)
    settings, result = getattr(pin, f"{name}SolverSettings")(), getattr(pin, f"{name}SolverResult")()
    settings.absolute_feasibility_tol = settings.relative_feasibility_tol = 0.0
    settings.absolute_complementarity_tol = 0.0
    settings.max_iterations, settings.stat_record = 2500, True
    solver = getattr(pin, f"{name}ConstraintSolver")(3)
    G = G + 0.2 + np.diag([0.0, 0.1, 0.3])
    solver.solve(G, g, models, datas, settings, result)
    assert solver.stats.size() == result.iterations + result.converged
    once = result.retrieveConstraintImpulses()
    solver.solve(G, g, models, datas, settings, result)
    np.testing.assert_array_equal(result.retrieveConstraintImpulses(), once)


@pytest.mark.parametrize("name", ["PGS", "ADMM"])
def test_without_constraints_nothing_is_to_do(pin: Any, name: str) -> None:
    settings, result = getattr(pin, f"{name}SolverSettings")(), getattr(pin, f"{name}SolverResult")()
    solver = getattr(pin, f"{name}ConstraintSolver")(0)
    assert solver.solve(np.zeros((0, 0)), np.zeros(0), [], [], settings, result)
    assert result.iterations == 0 and result.constraintSize() == 0


def test_a_solver_takes_problems_and_settings_in_turn(pin: Any) -> None:
    """Nothing of one search is left for the next: neither sizes, nor sets, nor De Saxce's shift."""
    G, g, models, datas = _block(pin)
    slides = g + np.array([0.0, 0.0, 1.0])
    shared = pin.ADMMConstraintSolver(3)
    for sliding, times, velocities in ((True, 1, g), (False, 2, g), (False, 1, slides), (True, 2, slides)):
        size, found = 3 * times, []
        for solver in (shared, pin.ADMMConstraintSolver(size)):
            settings, result = pin.ADMMSolverSettings(), pin.ADMMSolverResult()
            settings.solve_ncp = sliding
            matrix = np.kron(np.eye(times), G)
            solver.solve(matrix, np.tile(velocities, times), models * times, datas * times, settings, result)
            found.append((result.iterations, result.retrieveConstraintImpulses().tolist()))
            result.retrieveDesaxceTerm(shift := np.zeros(size))
            assert shift.any() == sliding
        assert found[0] == found[1]


def test_the_rule_spectral_needs_eigenvalues_apart(pin: Any) -> None:
    _, g, models, datas = _block(pin)
    settings = pin.ADMMSolverSettings()
    settings.admm_update_rule = pin.ADMMUpdateRule.SPECTRAL
    with pytest.raises(InputError, match="apart"):
        pin.ADMMConstraintSolver(3).solve(
            np.zeros((3, 3)), g, models, datas, settings, pin.ADMMSolverResult()
        )
