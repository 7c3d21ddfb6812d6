"""Constraints in single precision: errors are those of the condition numbers, also where rows depend on each other."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from support.random_models import KINDS, random_model
from ulna import algorithms, compiler
from ulna.algorithms import Proximal
from ulna.model import PointContact
from ulna.robot import Robot
from ulna.typing import Floats

SAMPLES = 256
NAME = "forward_dynamics_with_jacobian"


def condition_number(matrix: Floats) -> float:
    """That of the matrix with a diagonal of ones."""
    scale = np.sqrt(np.diag(matrix))
    return float(np.linalg.cond(matrix / np.outer(scale, scale)))


@pytest.mark.parametrize(
    ("seed", "kinds", "root", "rows"),
    [
        (4, ["revolute", "universal"], None, 3),  # as many rows as velocities: an error of 100 %
        (40, ["planar", "revolute"], None, 4),
        (6, ["helical", "spherical"], "planar", 3),
        (7, ["composite", "prismatic"], "spherical", 6),
    ],
)
def test_the_error_is_that_of_the_condition_numbers(
    seed: int, kinds: list[str], root: str | None, rows: int
) -> None:
    assert set(kinds) <= set(KINDS)
    rng = np.random.default_rng(seed)
    model = random_model(rng, kinds, root=root, mimics=0)
    robot = Robot(model)
    q = algorithms.random(model, rng, (SAMPLES,))
    v, tau = rng.standard_normal((2, SAMPLES, model.nv))
    J, drift = rng.standard_normal((SAMPLES, rows, model.nv)), rng.standard_normal((SAMPLES, rows))
    single = [x.astype(np.float32) for x in (q, v, tau, J, drift)]
    q, v, tau, J, drift = exact = [x.astype(float) for x in single]
    a = robot.kernel(NAME, rows=rows)(*exact)[0]
    error = np.abs(robot.kernel(NAME, rows=rows, dtype="float32")(*single)[0] - a).max(axis=-1)
    free = robot.forward_dynamics(q, v, tau)
    scale = np.maximum(np.abs(a), np.abs(free)).max(axis=-1)
    M, M_inv = robot.mass_matrix(q), robot.inverse_mass_matrix(q)
    D = J @ M_inv @ np.swapaxes(J, -1, -2)
    kappa = np.array([max(condition_number(m), condition_number(d)) for m, d in zip(M, D, strict=True)])
    assert np.isfinite(error).all()
    known = kappa < 1e6  # beyond, nothing may be right
    assert (error / scale <= 15.0 * np.finfo(np.float32).eps / 2.0 * kappa)[known].all()
    assert known.sum() > 0.95 * SAMPLES
    assert np.median((error / scale)[known]) < 1e-4


TWO_BODIES = (40, ["planar", "revolute"], None)
A_TREE = (5002, ["revolute", "spherical"], "planar")


class Case(NamedTuple):
    """States of a robot and rows that bind it, in numbers that single precision has."""

    robot: Robot
    inputs: list[Floats]  # q, v, tau, J and drift


def rows_of(kind: str, seed: int, kinds: list[str], root: str | None) -> Case:
    """Rows that are independent, as many as velocities, twice the same, combinations, more than velocities ..."""
    rng = np.random.default_rng(seed)
    model = random_model(rng, kinds, root=root, mimics=0)
    q = algorithms.random(model, rng, (SAMPLES,))
    v, tau, a = rng.standard_normal((3, SAMPLES, model.nv))
    count = {"superfluous": model.nv + 2, "independent": 3, "scaled": 3, "square": model.nv}.get(kind, 4)
    J, drift = rng.standard_normal((SAMPLES, count, model.nv)), rng.standard_normal((SAMPLES, count))
    if kind in ("twice", "contradictory"):
        J[:, 2:] = J[:, :2]
    if kind == "twice":
        drift[:, 2:] = drift[:, :2]
    elif kind == "combinations":
        C = rng.standard_normal((SAMPLES, 1, 2))
        J[:, 2:3], drift[:, 2:3] = C @ J[:, :2], (C @ drift[:, :2, None])[..., 0]
        J[:, 3], drift[:, 3] = 0.0, 0.0
    elif kind == "superfluous":
        drift = -(J @ a[..., None])[..., 0]
    elif kind == "scaled":
        scale = 10.0 ** rng.uniform(-4.0, 0.0, (SAMPLES, count))
        J, drift = J * scale[..., None], drift * scale
    return Case(Robot(model), [x.astype(np.float32).astype(float) for x in (q, v, tau, J, drift)])


def bound_motion(case: Case, least: float = 1e-5) -> tuple[Floats, Floats]:
    """Accelerations, and the size that errors are compared with; singular values below `least` are zero."""
    q, v, tau, J, drift = case.inputs
    W = np.linalg.inv(np.linalg.cholesky(case.robot.mass_matrix(q)))
    free = case.robot.forward_dynamics(q, v, tau)
    A = J @ np.swapaxes(W, -1, -2)
    length = np.linalg.norm(A, axis=-1)
    length = np.where(length > 0.0, length, 1.0)
    missing = -(drift + (J @ free[..., None])[..., 0]) / length
    gain = np.linalg.pinv(A / length[..., None], rcond=least) @ missing[..., None]
    a = free + (np.swapaxes(W, -1, -2) @ gain)[..., 0]
    return a, np.maximum(np.abs(a), np.abs(free)).max(axis=-1)


def single(case: Case, **options: Any) -> tuple[Floats, ...]:
    kernel = case.robot.kernel(NAME, rows=case.inputs[3].shape[1], dtype="float32", **options)
    return kernel(*(x.astype(np.float32) for x in case.inputs))


@pytest.mark.parametrize(("seed", "kinds", "root"), [TWO_BODIES, A_TREE])
@pytest.mark.parametrize("kind", ["independent", "twice", "combinations", "superfluous", "scaled"])
def test_accelerations_are_exact_for_rows_of_all_kinds(
    kind: str, seed: int, kinds: list[str], root: str | None
) -> None:
    case = rows_of(kind, seed, kinds, root)
    a, scale = bound_motion(case)
    found, forces, residual, rounds = single(case)
    error = np.abs(found - a).max(axis=-1) / scale
    assert np.isfinite(forces).all() and np.isfinite(residual).all()
    assert error.max() < 1e-3 and np.median(error) < 3e-6
    assert (rounds < 50.0).all()


def test_where_accelerations_are_wrong_the_residual_says_so() -> None:
    case = rows_of("square", *TWO_BODIES)
    a, scale = bound_motion(case, 1e-12)
    found, _, residual, _ = single(case)
    wrong = np.abs(found - a).max(axis=-1) > 1e-3 * scale
    assert 1 <= wrong.sum() < 0.03 * SAMPLES  # with condition numbers above 1e6
    size = np.abs(case.inputs[4]).max(axis=-1)
    assert (residual[wrong] > 1e-3 * size[wrong]).all()
    assert np.median(residual[~wrong] / size[~wrong]) < 1e-4


@pytest.mark.parametrize("kind", ["twice", "combinations"])
def test_forces_of_dependent_rows_are_those_of_least_sum_of_squares(kind: str) -> None:
    case = rows_of(kind, *A_TREE)
    expected = case.robot.kernel(NAME, rows=4)(*case.inputs)[1]
    forces = single(case)[1]
    error = np.abs(forces - expected).max(axis=-1) / np.abs(expected).max(axis=-1)
    assert np.median(error) < 5e-3 and np.quantile(error, 0.95) < 5e-2


def test_rows_that_contradict_each_other_are_kept_in_the_sense_of_least_squares() -> None:
    case = rows_of("contradictory", *A_TREE)
    a, _, left, _ = case.robot.kernel(NAME, rows=4)(*case.inputs)
    found, forces, residual, _ = single(case)
    scale = np.maximum(np.abs(a).max(axis=-1), bound_motion(case)[1])
    assert np.isfinite(forces).all()
    assert (np.abs(found - a).max(axis=-1) / scale).max() < 0.05
    np.testing.assert_allclose(residual, left, rtol=0.1)  # it says that they contradict each other


def test_without_damping_a_row_that_depends_on_rows_after_it_gets_no_force() -> None:
    case = rows_of("twice", *A_TREE)
    a, scale = bound_motion(case)
    found, forces, *_ = single(case, solver=Proximal(mu=0.0))
    assert (forces[:, :2] == 0.0).all() and (forces[:, 2:] != 0.0).all()
    assert (np.abs(found - a).max(axis=-1) / scale).max() < 1e-3


def test_damping_that_is_asked_for_is_kept() -> None:
    case = rows_of("independent", *A_TREE)
    soft = Proximal(mu=1e-2, iterations=1)
    a, *_ = case.robot.kernel(NAME, rows=3, solver=soft)(*case.inputs)
    found, *_ = single(case, solver=soft)
    assert (np.abs(found - a).max(axis=-1) / bound_motion(case)[1]).max() < 1e-4


def test_nan_in_the_drift_is_nan_in_the_results() -> None:
    case = rows_of("independent", *A_TREE)
    case.inputs[4][0, 0] = np.nan
    found, forces, residual, _ = single(case)
    assert all(np.isnan(x[0]).all() and np.isfinite(x[1:]).all() for x in (found, forces, residual))


def test_derivatives_are_nan_where_forces_are_not_unique() -> None:
    rng = np.random.default_rng(3)
    robot = Robot(random_model(rng, ["revolute"] * 6, root="free_flyer", mimics=0))
    last = robot.model.links[-1].name
    q = algorithms.random(robot.model, rng, (64,)).astype(np.float32)
    v, tau = rng.standard_normal((2, 64, robot.nv)).astype(np.float32)
    points = tuple(
        PointContact(last, p) for p in ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0))
    )  # their distance never changes
    for constraints, unique in ((points[:1], True), (points, False)):
        kernels = [
            robot.kernel("constrained_dynamics_derivatives", constraints=constraints, dtype=dtype)
            for dtype in ("float64", "float32")
        ]
        by_tau, found = kernels[0](*(x.astype(float) for x in (q, v, tau)))[2], kernels[1](q, v, tau)[2]
        assert (np.isnan(found[:, -1]).any(axis=-1) != unique).all()
        if unique:
            assert np.abs(found - by_tau).max() < 1e-3 * np.abs(by_tau).max()


@pytest.mark.parametrize(("refine", "bound"), [(False, 1e-2), (True, 1e-4)])
def test_functions_that_are_compiled_by_oneself_are_right_too(refine: bool, bound: float) -> None:
    case = rows_of("twice", *A_TREE)
    a, scale = bound_motion(case)
    function = case.robot.function(NAME, rows=4, solver=Proximal(refine=refine))
    inputs = [x.astype(np.float32) for x in case.inputs]
    found, forces, *_ = compiler.compile(function, "float32")(*inputs)
    assert np.isfinite(forces).all()
    assert (np.abs(found - a).max(axis=-1) / scale).max() < bound
