"""Laws of dry friction over a step of time, on random mass matrices."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna.algorithms import Friction
from ulna.algorithms.constraints import dry_friction
from ulna.algorithms.constraints.dry_friction import velocity_after_friction
from ulna.typing import Floats

LAW = Friction([0.5, 0.0, 0.1, 0.0, 1.0], [1.0, 2.0, 0.0, 0.0, 0.5], [0.5, 2.0, 0.0, 0.0, 1.0])


def problem(seed: int) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((5, 5))
    return A @ A.T + 0.1 * np.eye(5), 3.0 * rng.standard_normal(5)


def chain_problem(seed: int, n: int = 20) -> tuple[Floats, Floats, Floats]:
    """The inverse mass matrix of n links in a plane, of 1 kg and 0.2 m each, a velocity, and friction of any size."""
    rng = np.random.default_rng(seed)
    q, u = rng.uniform(-0.3, 0.3, n), rng.standard_normal(n)
    direction = np.stack(
        [-np.sin(np.cumsum(q)), np.cos(np.cumsum(q))]
    )  # of the velocity, where the link turns
    M = np.zeros((n, n))
    for k in range(n):
        reach = np.where(np.arange(n) < k, 0.2, 0.1) * (np.arange(n) <= k)
        turns = np.tri(n)  # which joints turn a link
        J = direction * reach @ turns
        M += J.T @ J + 0.2**2 / 12.0 * np.outer(turns[k], turns[k])
    return (
        np.array(np.linalg.inv(M), dtype=np.float64),
        u,
        rng.uniform(0.0, 1.0, n) * 10.0 ** rng.integers(-1, 3),
    )


def check_law(G: Floats, u: Floats, v: Floats, h: float, law: Friction) -> None:
    """The impulses from u to v are those of the law."""
    impulse = np.linalg.solve(G, v - u)
    dry = -(impulse / h + law.viscous * v)
    forward, backward = law.dry_bounds(u)
    slack = 1e-7 * (1.0 + np.abs(u).max() / h)
    assert (dry <= forward + slack).all()
    assert (dry >= -backward - slack).all()
    full = np.where(v > 0.0, forward, -backward)
    slides = np.abs(v) > 1e-9
    np.testing.assert_allclose(dry[slides], full[slides], atol=slack)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("h", [1e-3, 0.1, 1.0])
def test_the_impulses_are_those_of_the_law(seed: int, h: float) -> None:
    G, u = problem(seed)
    check_law(G, u, velocity_after_friction(G, u, u, h, LAW), h, LAW)


@pytest.mark.parametrize("viscous", [0.0, 0.01, 10.0])
def test_long_chains_come_to_the_velocity_of_the_law(viscous: float) -> None:
    """Joints that are solved for in turns take thousands of rounds here."""
    for seed in range(6):
        G, u, coulomb = chain_problem(seed)
        law = Friction(viscous, coulomb)
        check_law(G, u, velocity_after_friction(G, u, u, 0.01, law), 0.01, law)


def test_what_does_not_converge_is_nan(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dry_friction, "ROUNDS", 1)
    G, u, coulomb = chain_problem(1)
    assert np.isnan(velocity_after_friction(G, u, u, 0.01, Friction(0.0, coulomb))).all()


def test_without_friction_the_velocity_is_a_copy() -> None:
    G, u = problem(0)
    v = velocity_after_friction(G, u, u, 0.1, Friction())
    assert not np.shares_memory(u, v)


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
