"""Accelerations under constraints in single precision: as wrong as the condition numbers of M and of J M^-1 J^T allow."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import KINDS, random_model
from ulna import algorithms
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
    known = kappa < 1e6  # beyond, nothing may be right
    assert (error / scale <= 15.0 * np.finfo(np.float32).eps / 2.0 * kappa)[known].all()
    assert known.sum() > 0.95 * SAMPLES
    assert np.median((error / scale)[known]) < 1e-4
