"""Reverse derivatives of forward dynamics in closed form equal those of the sweep over its operations, and are shorter."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from support.random_models import KINDS, random_model
from ulna import algorithms, numeric
from ulna.algorithms.dynamics.aba_relative_accelerations import articulated_body_dynamics
from ulna.algorithms.dynamics.forward_dynamics import by_mass_matrix, prefers_mass_matrix
from ulna.compiler import Function, compile, trace
from ulna.model import Model, dynamic_parameters, with_parameters
from ulna.robots.panda import panda
from ulna.typing import Array

ROOTS = (None, "free_flyer", "planar", "spherical")


def swept(model: Model, q: Array, v: Array, tau: Array) -> Array:
    """Forward dynamics without the closed form of its reverse derivative."""
    solve = by_mass_matrix if prefers_mass_matrix(model) else articulated_body_dynamics
    return solve(model, q, v, tau)


def both(model: Model, f) -> tuple[Function, Function]:
    """Reverse derivatives of f(accelerations, q, v, tau), in closed form and by the sweep."""
    shapes = {"q": (model.nq,), "v": (model.nv,), "tau": (model.nv,)}

    def of(dynamics) -> Function:
        return trace(lambda q, v, tau: f(dynamics, q, v, tau), **shapes)

    closed = of(lambda q, v, tau: algorithms.forward_dynamics(model, q, v, tau))
    return closed, of(lambda q, v, tau: swept(model, q, v, tau))


def square_of_accelerations(dynamics, q: Array, v: Array, tau: Array) -> Array:
    a = dynamics(q, v, tau)
    return a @ a


def agree(closed: Function, sweep: Function, args: list[Array], tolerance: float = 1e-10) -> None:
    for got, expected in zip(closed(*args), sweep(*args), strict=True):
        np.testing.assert_allclose(got, expected, rtol=0.0, atol=tolerance * (1.0 + np.abs(expected).max()))


def state(model: Model, seed: int) -> list[Array]:
    """Arguments, whose quaternions are not of unit length."""
    rng = np.random.default_rng(seed)
    return [1.1 * algorithms.random(model, rng), *rng.standard_normal((2, model.nv))]


@pytest.mark.parametrize("root", ROOTS)
@pytest.mark.parametrize("mimics", [0, 1])
@pytest.mark.parametrize("kinds", [sorted(KINDS)[::2], sorted(KINDS)[1::2], ["revolute", "prismatic"]])
def test_cotangents_are_those_of_the_sweep(root: str | None, mimics: int, kinds: list[str]) -> None:
    model = random_model(np.random.default_rng(5), kinds, root=root, mimics=mimics)
    weights = np.random.default_rng(6).standard_normal((2, model.nv))

    def cost(dynamics, q, v, tau):
        a = dynamics(q, v, tau)
        return weights[0] @ a + (weights[1] @ a) * (v @ v) + q @ q

    closed, sweep = (f.vjp() for f in both(model, cost))
    agree(closed, sweep, [*state(model, 7), np.array(1.3)])
    assert closed.operations <= 1.05 * sweep.operations


def test_several_accelerations_that_depend_on_one_another() -> None:
    def cost(dynamics, q, v, tau):
        a = dynamics(q, v, tau)
        b = dynamics(q + 0.1 * v, v + 0.1 * a, tau - a)
        return a @ b + dynamics(q, v, tau)[2]

    closed, sweep = (f.vjp() for f in both(panda(), cost))
    agree(closed, sweep, [*state(panda(), 1), np.array(1.0)])
    agree(
        pickle.loads(pickle.dumps(both(panda(), cost)[0])).vjp(), sweep, [*state(panda(), 1), np.array(1.0)]
    )


def test_cotangents_count_only_on_the_side_of_a_where_that_is_taken() -> None:
    def cost(dynamics, q, v, tau):
        return numeric.where(
            q[0] > 0.0, np.sqrt(dynamics(q, v, tau) @ dynamics(q, v, tau) + 1e12 * q[0]), q[1]
        )

    closed, sweep = (compile(f.value_and_gradient("q")) for f in both(panda(), cost))
    q, v, tau = state(panda(), 2)
    for sign in (1.0, -1.0):
        q[0] = sign * abs(q[0])
        agree(closed, sweep, [q, v, tau])
        assert np.isfinite(closed(q, v, tau)[1]).all()


def test_hessians_and_jacobians() -> None:
    closed, sweep = both(panda(), square_of_accelerations)
    args = state(panda(), 3)
    for derivative in ("hvp", "jacobian", "hessian"):
        got, expected = (getattr(f, derivative)("q") for f in (closed, sweep))
        rest = [np.ones(7)] if derivative == "hvp" else []
        scale = np.abs(expected(*args, *rest)).max()
        np.testing.assert_allclose(got(*args, *rest), expected(*args, *rest), rtol=0.0, atol=1e-10 * scale)


def test_parameters_have_gradients() -> None:
    def torque(mass, q, v, tau):
        model = panda()
        inertia = numeric.vector(*[mass * x for x in dynamic_parameters(model)])
        return np.sum(algorithms.forward_dynamics(with_parameters(model, {"inertia": inertia}), q, v, tau))

    f = trace(torque, mass=(), q=(7,), v=(7,), tau=(7,))
    args = state(panda(), 4)
    slope = (f(1.0 + 1e-6, *args) - f(1.0 - 1e-6, *args)) / 2e-6
    assert abs(slope) > 1.0
    np.testing.assert_allclose(f.value_and_gradient("mass")(1.0, *args)[1], slope, rtol=1e-7)


def test_through_loops() -> None:
    def steps(dynamics, q, v, tau):
        def step(k, *state):
            q, v = np.array(state[:7]), np.array(state[7:])
            v = v + 1e-2 * dynamics(q, v, tau)
            return (k + 1.0, *(q + 1e-2 * v), *v)

        end = numeric.loop(lambda k, *_: k < 5.0, step, (0.0, *q, *v), limit=5)
        return np.array(end[8:]) @ np.array(end[8:])

    closed, sweep = (compile(f.vjp()) for f in both(panda(), steps))
    agree(closed, sweep, [*state(panda(), 8), np.array(1.0)])
    assert closed.function.operations < sweep.function.operations


@pytest.mark.parametrize("name", ["chain", "panda"])
def test_gradients_take_few_operations(name: str) -> None:
    rng = np.random.default_rng(0)
    model = panda() if name == "panda" else random_model(rng, ["revolute"], 30, mimics=0, branching=0.0)
    closed, sweep = both(model, square_of_accelerations)
    few = closed.value_and_gradient("q").operations / closed.operations
    assert few < 2.2 < sweep.value_and_gradient("q").operations / sweep.operations
