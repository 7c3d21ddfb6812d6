"""Laws of friction cones: what is nearest, Moreau's decomposition, batches, traces."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies
from hypothesis.extra import numpy as arrays

from ulna.algorithms.constraints import friction_cone
from ulna.compiler import compile as compile_function

NUMBERS = strategies.floats(-10.0, 10.0)
FORCES = arrays.arrays(float, 3, elements=NUMBERS)
FRICTION = strategies.floats(0.0, 3.0)
CLOSE = 1e-9


@given(FORCES, FRICTION)
def test_a_force_is_a_force_of_the_cone_less_a_velocity_of_its_dual(f: np.ndarray, mu: float) -> None:
    inside, polar = friction_cone.project(f, mu), friction_cone.project_dual(-f, mu)
    np.testing.assert_allclose(inside - polar, f, atol=CLOSE)
    assert abs(inside @ polar) < CLOSE * 100
    assert friction_cone.excess(inside, mu) < CLOSE
    assert mu * np.hypot(polar[0], polar[1]) - polar[2] < CLOSE
    np.testing.assert_allclose(friction_cone.project(inside, mu), inside, atol=CLOSE)


@given(FORCES, FRICTION, FORCES, strategies.floats(0.1, 5.0), strategies.floats(0.1, 5.0))
def test_nothing_of_the_cone_is_nearer(
    f: np.ndarray, mu: float, other: np.ndarray, r: float, s: float
) -> None:
    weights = np.array([r, r, s])
    other = friction_cone.project(other, mu)
    for found, metric in (
        (friction_cone.project(f, mu), np.ones(3)),
        (friction_cone.project_weighted(f, mu, weights), weights),
    ):
        assert friction_cone.excess(found, mu) < CLOSE * 10
        assert metric @ (f - found) ** 2 <= metric @ (f - other) ** 2 + 1e-8


@given(FORCES, FRICTION)
def test_radially_the_normal_force_stays(f: np.ndarray, mu: float) -> None:
    found = friction_cone.project_radially(f, mu)
    assert found[2] == max(f[2], 0.0)
    assert friction_cone.excess(found, mu) < CLOSE
    np.testing.assert_allclose(np.cross([*found[:2], 0.0], [*f[:2], 0.0]), 0.0, atol=CLOSE)


@given(FORCES, FRICTION)
def test_a_sliding_velocity_shifted_does_no_work_with_its_friction(v: np.ndarray, mu: float) -> None:
    """The force of a contact that slides without leaving: friction against the velocity, as much as it may be."""
    v[2] = 0.0
    speed = np.hypot(v[0], v[1])
    force = np.array([*(-mu * v[:2] / speed), 1.0]) if speed > 1e-3 else np.array([0.0, 0.0, 1.0])
    shifted = v + friction_cone.sliding_shift(v, mu)
    if speed > 1e-3:
        assert abs(shifted @ force) < CLOSE
    np.testing.assert_allclose(friction_cone.project_dual(shifted, mu), shifted, atol=CLOSE)


@pytest.mark.parametrize("name", ["project", "project_dual", "project_radially", "sliding_shift"])
def test_compiled_and_in_batches(name: str) -> None:
    function = getattr(friction_cone, name)
    forces = np.random.default_rng(1).normal(size=(40, 3))
    forces[0], forces[1], forces[2] = 0.0, (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
    singles = np.stack([function(f, 0.7) for f in forces])
    np.testing.assert_allclose(function(forces, 0.7), singles, atol=1e-15)
    kernel = compile_function(lambda f: function(f, 0.7), f=(3,))
    np.testing.assert_allclose(kernel(forces), singles, atol=1e-14)


def test_without_friction_a_pulling_force_is_projected_to_zero() -> None:
    for mu in (0.0, 0.5):
        np.testing.assert_array_equal(friction_cone.project(np.array([0.0, 0.0, -1.0]), mu), np.zeros(3))
        assert friction_cone.excess(np.array([0.0, 0.0, -1.0]), mu) == 1.0
