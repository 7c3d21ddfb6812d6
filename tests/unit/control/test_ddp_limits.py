"""DDP with limits of the controls: the best controls within them, beside solvers of bounded least squares."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from ulna import control
from ulna.control.backward import backward
from ulna.errors import InputError, ShapeError

optimize = pytest.importorskip("scipy.optimize")


def one_knot(H: Any, g: Any, m: int) -> tuple[Any, Any]:
    """Derivatives of a last step that changes nothing, so that Q is the Hessian of its cost."""
    n = len(g) - m
    knots = control.StageDerivatives(
        g[None, :n], np.zeros((1, n, n)), np.zeros((1, n, m)), g[:1], g[None, :n], g[None, n:],
        H[None, :n, :n], H[None, n:, :n], H[None, n:, n:],
    )  # fmt: skip
    return knots, control.TerminalDerivatives(0.0, np.zeros(n), np.zeros((n, n)))


@pytest.mark.parametrize("seed", range(60))
def test_the_best_change_within_limits(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 6)), int(rng.integers(1, 12))
    half = rng.normal(size=(n + m, n + m)) * 10.0 ** rng.uniform(-2.0, 2.0, n + m)
    H, g, mu = (
        half @ half.T + 1e-3 * np.eye(n + m),
        10.0 * rng.normal(size=n + m),
        float(rng.choice([0.0, 0.3])),
    )
    size = 10.0 ** rng.uniform(-3.0, 0.0, (2, m))
    size[rng.random((2, m)) < 0.2] = np.inf
    size[rng.random((2, m)) < 0.1] = 0.0
    limits = np.stack([-size[0], size[1]])
    knots, end = one_knot(H, g, m)
    gains = backward(knots, end, mu, limits[:, None])
    assert gains is not None
    k, K = gains.k[0], gains.K[0]
    assert (limits[0] <= k).all() and (k <= limits[1]).all()
    Quu = H[n:, n:] + mu * np.eye(m)
    root = np.linalg.cholesky(Quu).T
    away = limits[1] > limits[0]  # the other solver has no entries without room
    if away.any():
        room = limits[:, away]
        target = np.linalg.solve(root.T, -g[n:])
        best = optimize.lsq_linear(root[:, away], target, room, method="bvls", tol=1e-15, max_iter=500).x
        value = [0.5 * x @ Quu[np.ix_(away, away)] @ x + g[n:][away] @ x for x in (k[away], best)]
        assert value[0] <= value[1] + 1e-9 * abs(value[1])
    slope = g[n:] + Quu @ k
    held = ((k <= limits[0]) & (slope >= 0.0)) | ((k >= limits[1]) & (slope <= 0.0))
    assert (K[held] == 0.0).all()
    scale = np.abs(Quu) @ np.abs(k) + np.abs(g[n:])
    assert (np.abs(slope[~held]) <= 1e-9 * scale[~held]).all()
    if not held.all():
        free = np.linalg.solve(Quu[np.ix_(~held, ~held)], -H[n:, :n][~held])
        np.testing.assert_allclose(K[~held], free, rtol=1e-6, atol=1e-9 * np.abs(free).max())
    np.testing.assert_allclose(gains.first, g[n:] @ k, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(gains.second, 0.5 * k @ H[n:, n:] @ k, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_a_linear_problem_with_limits(seed: int) -> None:
    rng, n, m, N = np.random.default_rng(seed), 4, 2, 12
    A = 0.95 * np.linalg.qr(rng.normal(size=(n, n)))[0]
    B, goal, x0 = rng.normal(size=(n, m)), 2.0 * rng.normal(size=n), rng.normal(size=n)
    low, high = -rng.uniform(0.1, 0.5, m), rng.uniform(0.1, 0.5, m)
    stage = control.custom_stage(
        lambda x, u: A @ x + B @ u, lambda x, u: np.concatenate([x - goal, 0.3 * u]), nx=n, nu=m
    )
    end = stage.terminal(lambda x: 3.0 * (x - goal))

    def residuals(U: Any) -> Any:
        x, rows = x0, []
        for u in U.reshape(N, m):
            rows += [x - goal, 0.3 * u]
            x = A @ x + B @ u
        return np.concatenate([*rows, 3.0 * (x - goal)])

    zero = residuals(np.zeros(N * m))
    J = np.stack([residuals(e) - zero for e in np.eye(N * m)], axis=-1)
    box = np.tile(low, N), np.tile(high, N)
    best = optimize.lsq_linear(J, -zero, box, method="bvls", tol=1e-14, max_iter=1000).x
    found = control.ddp(stage, end, x0, np.zeros((N, m)), limits=[low, high], tolerance=1e-14)
    assert found.is_converged
    assert (found.controls >= low).all() and (found.controls <= high).all()
    assert ((found.controls == low) | (found.controls == high)).any()
    np.testing.assert_allclose(found.controls.ravel(), best, atol=1e-6)
    assert found.cost == pytest.approx(0.5 * (residuals(best) ** 2).sum(), rel=1e-12)
    free = control.ddp(stage, end, x0, np.zeros((N, m)))
    assert abs(free.controls).max() > 0.5 and free.cost < found.cost


def test_a_pendulum_that_is_too_weak_to_lift_itself_swings_up() -> None:
    def step(x: Any, u: Any) -> Any:  # angle from the top
        v = x[1] + 0.05 * (9.81 * np.sin(x[0]) - 0.1 * x[1] + u[0])
        return np.array([x[0] + 0.05 * v, v])

    stage = control.custom_stage(step, lambda x, u: 0.05 * u, nx=2, nu=1)
    end = stage.terminal(lambda x: 20.0 * x)
    start = 0.5 * np.sin(np.arange(100) / 6.0)[:, None]
    found = control.ddp(stage, end, [np.pi, 0.0], start, limits=3.0, iterations=500)
    assert found.is_converged, found
    assert abs(found.controls).max() == 3.0 and abs(found.states[-1]).max() < 0.05
    at_limit = abs(found.controls[:, 0]) == 3.0
    assert (
        at_limit.sum() > 5 and (found.gains[at_limit] == 0.0).all() and (found.gains[~at_limit] != 0.0).any()
    )

    def whole(u: Any) -> float:
        x, total = np.array([np.pi, 0.0]), 0.0
        for control_ in u:
            x, cost = stage.calc(x, control_)
            total += cost
        return float(total + end(x).cost)

    rng = np.random.default_rng(4100)
    for _ in range(200):  # nothing near and within the limits is better
        near = np.clip(found.controls + 10.0 ** rng.uniform(-5, -2) * rng.normal(size=(100, 1)), -3.0, 3.0)
        assert whole(near) >= found.cost * (1.0 - 1e-9)


def test_torques_of_a_robot_keep_its_effort_limits() -> None:
    robot = ulna.load("panda")
    q = robot.configurations["ready"]
    stage = control.stage(robot, lambda q, v, u: np.concatenate([0.1 * v, 1e-3 * u]), dt=0.01)
    end = stage.terminal(lambda q, v, goal: 100.0 * (q - goal), goal=(7,))
    hold, x0 = np.tile(robot.gravity_forces(q), (15, 1)), np.concatenate([q, np.zeros(7)])
    goal = q + [0.5, -0.3, 0.4, 0.3, 0.5, 0.3, 0.6]
    found = control.ddp(stage, end, x0, hold, terminal_parameters=(goal,))
    limit = robot.model.effort_limit
    assert (np.abs(found.controls) <= limit).all() and (np.abs(found.controls) == limit).any()
    free = control.ddp(stage, end, x0, hold, terminal_parameters=(goal,), limits=np.inf)
    assert (np.abs(free.controls) > limit).any() and free.cost < found.cost
    small = control.ddp(stage, end, x0, 1e3 * hold, terminal_parameters=(goal,), limits=20.0)
    assert abs(small.controls).max() <= 20.0


def test_limits_that_make_no_sense_are_refused() -> None:
    stage = control.custom_stage(lambda x, u: x + u, lambda x, u: u, nx=2, nu=2)
    end, start = stage.terminal(lambda x: x), np.zeros((3, 2))
    with pytest.raises(
        ShapeError, match=r"`limits` has shape \(3,\); expected one number, \(2,\), or \(2, 2\)"
    ):
        control.ddp(stage, end, np.ones(2), start, limits=[1.0, 2.0, 3.0])
    for wrong in (np.nan, [1.0, -1.0], [[0.0, 2.0], [1.0, 1.0]]):
        with pytest.raises(InputError, match="Entry . of `limits` is from"):
            control.ddp(stage, end, np.ones(2), start, limits=wrong)
    fixed = control.ddp(stage, end, np.ones(2), start, limits=[[0.0, -1.0], [0.0, 1.0]])
    assert (fixed.controls[:, 0] == 0.0).all() and fixed.is_converged
