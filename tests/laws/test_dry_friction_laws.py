"""Laws of dry friction over a step of time, on random mass matrices."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna.algorithms import Friction
from ulna.algorithms.constraints.dry_friction import velocity_after_friction
from ulna.typing import Floats

LAW = Friction([0.5, 0.0, 0.1, 0.0, 1.0], [1.0, 2.0, 0.0, 0.0, 0.5], [0.5, 2.0, 0.0, 0.0, 1.0])


def problem(seed: int) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((5, 5))
    return A @ A.T + 0.1 * np.eye(5), 3.0 * rng.standard_normal(5)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("h", [1e-3, 0.1, 1.0])
def test_the_impulses_are_those_of_the_law(seed: int, h: float) -> None:
    G, u = problem(seed)
    v = velocity_after_friction(G, u, u, h, LAW)
    impulse = np.linalg.solve(G, v - u)
    dry = -(impulse / h + LAW.viscous * v)
    slack = 1e-7 * (1.0 + np.abs(u).max() / h)
    assert (dry <= LAW.coulomb + slack).all()
    assert (dry >= -LAW.backward - slack).all()
    for k in range(5):
        if abs(v[k]) > 1e-9:
            full = LAW.coulomb[k] if v[k] > 0.0 else -LAW.backward[k]
            assert dry[k] == pytest.approx(full, abs=slack)


@pytest.mark.parametrize("seed", range(3))
def test_friction_takes_energy_and_more_of_it_takes_more(seed: int) -> None:
    G, u = problem(seed)
    M = np.linalg.inv(G)
    before = u @ M @ u
    for factor in (0.5, 1.0, 2.0):
        law = Friction(LAW.viscous * factor, LAW.coulomb * factor)
        v = velocity_after_friction(G, u, u, 0.1, law)
        assert v @ M @ v <= before + 1e-9
        before = v @ M @ v
    np.testing.assert_array_equal(velocity_after_friction(G, u, u, 0.1, Friction()), u)


def test_compiled_and_batched_are_the_same() -> None:
    kernel = ulna.compile(lambda G, u, h: velocity_after_friction(G, u, u, h, LAW), G=(5, 5), u=(5,), h=())
    G, u = (np.stack(x) for x in zip(*(problem(k) for k in range(9)), strict=True))
    np.testing.assert_allclose(kernel(G, u, 0.1), velocity_after_friction(G, u, u, 0.1, LAW), atol=1e-10)
