"""Laws of impulses in cones: what is sought is found, by hand where that can be, compiled, and from any guess."""

from __future__ import annotations

import numpy as np
import pytest

from ulna.algorithms.constraints import friction_cone
from ulna.algorithms.constraints.cone_complementarity import (
    Bilateral,
    Bounded,
    Frictional,
    Kind,
    Unilateral,
    gauss_seidel,
)
from ulna.algorithms.constraints.contact_forces import contact_forces
from ulna.compiler import compile as compile_function
from ulna.errors import InputError
from ulna.typing import Floats

KINDS: tuple[Kind, ...] = (
    Frictional(0.5),
    Bilateral(2),
    Unilateral(2),
    Bounded((-0.2, -1.0), (0.3, 1.0)),
    Frictional(0.0),
)


def problem(seed: int) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(seed)
    m = sum(kind.size for kind in KINDS)
    root = rng.normal(size=(m, m))
    return root @ root.T / m + 0.2 * np.eye(m), rng.normal(size=m)


@pytest.mark.parametrize("sliding", [True, False])
@pytest.mark.parametrize("seed", range(4))
def test_what_is_sought_is_found(seed: int, sliding: bool) -> None:
    G, g = problem(seed)
    found = gauss_seidel(G, g, KINDS, None, 1e-10, 1e-10, 20_000, 1.0, sliding)
    x, y = found.impulses, found.velocities
    np.testing.assert_allclose(y, G @ x + g, atol=1e-12)
    assert found.infeasibility <= 1e-10 and found.complementarity <= 1e-10
    for start, mu in ((0, 0.5), (9, 0.0)):
        f, v = x[start : start + 3], y[start : start + 3]
        shifted = v + friction_cone.sliding_shift(v, mu) if sliding else v
        assert friction_cone.excess(f, mu) < 1e-12 and f[2] >= 0.0
        assert mu * np.hypot(*shifted[:2]) - shifted[2] < 1e-9 and abs(f @ shifted) < 1e-9
    assert np.abs(y[3:5]).max() < 1e-9
    assert x[5:7].min() >= 0.0 and y[5:7].min() > -1e-9 and np.abs(x[5:7] * y[5:7]).max() < 1e-9
    for f, v, low, high in zip(x[7:9], y[7:9], (-0.2, -1.0), (0.3, 1.0), strict=True):
        assert low <= f <= high
        assert (f - low) * max(v, 0.0) < 1e-9 and (high - f) * max(-v, 0.0) < 1e-9


def test_the_same_from_another_start_with_relaxation_and_compiled() -> None:
    G, g = problem(0)
    found = gauss_seidel(G, g, KINDS, None, 1e-11, 1e-11, 20_000)
    other = gauss_seidel(G, g, KINDS, np.ones(len(g)), 1e-11, 1e-11, 20_000, 0.8)
    np.testing.assert_allclose(other.impulses, found.impulses, atol=1e-7)
    kernel = compile_function(
        lambda G, g: tuple(gauss_seidel(G, g, KINDS, None, 1e-11, 1e-11, 20_000)), G=G.shape, g=g.shape
    )
    np.testing.assert_allclose(kernel(G, g)[0], found.impulses, atol=1e-9)
    assert gauss_seidel(G, g, KINDS, found.impulses, 1e-9, 1e-9).rounds == 0


def test_a_block_on_the_ground_by_hand() -> None:
    """A mass of 2 kg falls onto the ground at 3 m/s, sideways at 1 m/s: 6 N s stop it, friction takes half of that."""
    found = gauss_seidel(0.5 * np.eye(3), np.array([1.0, 0.0, -3.0]), [Frictional(0.1)], None, 1e-12, 1e-12)
    np.testing.assert_allclose(found.impulses, [-0.6, 0.0, 6.0], atol=1e-12)
    np.testing.assert_allclose(found.velocities, [0.7, 0.0, 0.0], atol=1e-12)
    assert found.rounds <= 2
    convex = gauss_seidel(
        0.5 * np.eye(3), np.array([1.0, 0.0, -3.0]), [Frictional(0.1)], None, 1e-9, 1e-9, 1000, 1.0, False
    )
    assert convex.velocities[2] == pytest.approx(
        0.1 * convex.velocities[0], abs=1e-6
    )  # lifts off as it slides


def test_rows_must_fit() -> None:
    with pytest.raises(InputError, match="2 rows"):
        gauss_seidel(np.eye(3), np.zeros(3), [Bilateral(2)])


def test_forces_of_contacts_that_stick_slide_and_part() -> None:
    c = np.array([0.01, 0.0, -1.0, 3.0, 0.0, -1.0, 0.5, 0.5, 2.0])
    R = np.full(9, 0.1)
    found = contact_forces(c, [0.5] * 3, R, np.zeros(9), 1e-9, (1e-12, 0.0), 500)
    np.testing.assert_allclose(found.forces[:3], [-0.1, 0.0, 10.0], atol=1e-7)
    np.testing.assert_allclose(found.forces[6:], 0.0, atol=1e-12)
    f, y = found.forces[3:6], c[3:6] + R[3:6] * found.forces[3:6]
    assert np.hypot(*f[:2]) == pytest.approx(0.5 * f[2]) and abs(y[2]) < 1e-6 and y[0] > 0.0 > f[0]
    assert found.residual <= 1e-12
