"""Laws of the log-Cholesky parameters of a body."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import random_inertia
from ulna.errors import InputError
from ulna.identification import from_log_cholesky, log_cholesky, nearest_physical
from ulna.identification.physical import log_cholesky_jacobian, parameters_of, pseudo_inertia
from ulna.spatial import Inertia


def test_any_ten_numbers_are_a_body() -> None:
    t = np.random.default_rng(0).standard_normal((50, 10))
    p = from_log_cholesky(t)
    assert Inertia.from_parameters(p).is_physical().all()
    np.testing.assert_allclose(log_cholesky(p), t, atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_any_body_is_ten_numbers(seed: int) -> None:
    p = random_inertia(np.random.default_rng(seed)).parameters()
    np.testing.assert_allclose(from_log_cholesky(log_cholesky(p)), p, atol=1e-12)
    np.testing.assert_allclose(parameters_of(pseudo_inertia(p)), p, atol=1e-14)
    np.testing.assert_array_equal(nearest_physical(p), p)


def test_the_jacobian_is_the_derivative() -> None:
    t = np.random.default_rng(1).standard_normal((3, 10))
    J = log_cholesky_jacobian(t)
    h = 1e-6
    for k in range(10):
        step = h * np.eye(10)[k]
        slope = (from_log_cholesky(t + step) - from_log_cholesky(t - step)) / (2 * h)
        np.testing.assert_allclose(J[..., k], slope, rtol=1e-6, atol=1e-6)


def test_flat_bodies_are_refused_with_the_nearest_body() -> None:
    point = Inertia.from_point(1.0, (0.1, 0.2, 0.3)).parameters()
    with pytest.raises(InputError, match="nearest_physical"):
        log_cholesky(point)
    nearest = nearest_physical(point)
    assert np.abs(nearest - point).max() < 1e-5
    assert np.isfinite(log_cholesky(nearest)).all()
    impossible = np.array([1.0, 0, 0, 0, 1.0, 0, 1.0, 0, 0, -3.0])
    assert Inertia.from_parameters(nearest_physical(impossible)).is_physical()


def test_pinocchio_means_the_same() -> None:
    pin = pytest.importorskip("pinocchio")
    t = np.random.default_rng(2).standard_normal(10)
    theirs = pin.LogCholeskyParameters(t)
    np.testing.assert_allclose(from_log_cholesky(t), theirs.toDynamicParameters(), rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(log_cholesky_jacobian(t), theirs.calculateJacobian(), rtol=1e-10, atol=1e-10)
