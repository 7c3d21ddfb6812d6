"""Differential dynamic programming: exact on linear problems, stationary on others; what ends a search."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from ulna import control
from ulna.control.backward import backward
from ulna.errors import InputError, ModelError, NonFiniteError, ShapeError, UnknownName
from ulna.model import ModelBuilder, Revolute
from ulna.spatial import SE3, Inertia


def linear(n, m, seed):
    """A random stable linear system and a quadratic cost with coupled terms."""
    rng = np.random.default_rng(seed)
    A = 0.9 * np.linalg.qr(rng.normal(size=(n, n)))[0]
    B, goal = rng.normal(size=(n, m)), rng.normal(size=n)

    def cost(x, u):
        return np.concatenate([x - goal, 0.5 * u, np.array([0.3 * x[0] * 1.0 + u[0]])])

    stage = control.custom_stage(lambda x, u: A @ x + B @ u, cost, nx=n, nu=m)
    return stage, stage.terminal(lambda x: 2.0 * (x - goal)), A, B, goal, cost


def test_a_linear_problem_is_solved_in_one_iteration():
    n, m = 3, 2
    stage, end, A, B, goal, cost = linear(n, m, n)
    N, x0 = 4, np.linspace(-1.0, 1.0, n)

    def residuals(U):
        x, rows = x0, []
        for u in U.reshape(N, m):
            rows.append(cost(x, u))
            x = A @ x + B @ u
        return np.concatenate([*rows, 2.0 * (x - goal)])

    zero = residuals(np.zeros(N * m))
    J = np.stack([residuals(e) - zero for e in np.eye(N * m)], axis=-1)
    best = np.linalg.lstsq(J, -zero, rcond=None)[0]
    solution = control.ddp(stage, end, x0, np.zeros((N, m)))
    assert solution.is_converged and len(solution.iterations) == 1
    np.testing.assert_allclose(solution.controls.ravel(), best, atol=1e-9)
    assert solution.cost == pytest.approx(0.5 * (residuals(best) ** 2).sum(), rel=1e-12)
    # the gains are the best answer to another first state
    other = control.ddp(stage, end, x0 + 0.1, np.zeros((N, m)))
    np.testing.assert_allclose(
        other.controls[0], solution.controls[0] + solution.gains[0] @ np.full(n, 0.1), atol=1e-9
    )


def riccati(fx, fu, lx, lu, lxx, lux, luu, Vx, Vxx, mu):
    """One step backwards as in the paper (Tassa, Erez & Todorov 2012, equations 5, 10 and 11)."""
    Qx, Qu = lx + fx.T @ Vx, lu + fu.T @ Vx
    Qxx, Qux, Quu = lxx + fx.T @ Vxx @ fx, lux + fu.T @ Vxx @ fx, luu + fu.T @ Vxx @ fu
    held = Quu + mu * np.eye(len(lu))
    k, K = -np.linalg.solve(held, Qu), -np.linalg.solve(held, Qux)
    Vx, Vxx = Qx + K.T @ Quu @ k + K.T @ Qu + Qux.T @ k, Qxx + K.T @ Quu @ K + K.T @ Qux + Qux.T @ K
    return k, K, Vx, Vxx, np.array([k @ Qu, 0.5 * k @ Quu @ k])


@pytest.mark.parametrize(("n", "m"), [(1, 1), (3, 2), (6, 2), (7, 1), (9, 8), (14, 7), (20, 13)])
def test_the_backward_sweep_is_that_of_the_paper(n, m):
    rng = np.random.default_rng(n)
    half = rng.normal(size=(5, n + m, n + m))
    H = half @ half.transpose(0, 2, 1) + np.eye(n + m)
    fx, fu, g = rng.normal(size=(5, n, n)) / n, rng.normal(size=(5, n, m)), rng.normal(size=(5, n + m))
    knots = control.StageDerivatives(
        fx[:, 0], fx, fu, g[:, 0], g[:, :n], g[:, n:], H[:, :n, :n], H[:, n:, :n], H[:, n:, n:]
    )
    last = control.TerminalDerivatives(0.0, g[0, :n], H[0, :n, :n])
    gains = backward(knots, last, 0.5)
    assert gains is not None
    Vx, Vxx, change = last.lx, last.lxx, np.zeros(2)
    for i in range(4, -1, -1):
        parts: Any = [part[i] for part in (fx, fu, *knots[4:])]
        k, K, Vx, Vxx, more = riccati(*parts, Vx, Vxx, 0.5)
        np.testing.assert_allclose(gains.k[i], k, rtol=1e-8, atol=1e-10)
        np.testing.assert_allclose(gains.K[i], K, rtol=1e-8, atol=1e-10)
        change += more
    np.testing.assert_allclose([gains.first, gains.second], change, rtol=1e-9)
    assert backward(knots._replace(luu=knots.luu - 1e6 * np.eye(m)), last) is None
    assert backward(knots._replace(luu=knots.luu + np.nan), last) is None


def pendulum():
    def step(x, u):  # angle from the top
        v = x[1] + 0.05 * (9.81 * np.sin(x[0]) - 0.1 * x[1] + u[0])
        return np.array([x[0] + 0.05 * v, v])

    stage = control.custom_stage(step, lambda x, u: 0.05 * u, nx=2, nu=1)
    return stage, stage.terminal(lambda x: 20.0 * x)


def test_a_pendulum_swings_up_and_nothing_near_is_better():
    stage, end = pendulum()
    seen = []
    solution = control.ddp(stage, end, [np.pi, 0.0], np.zeros((60, 1)), progress=seen.append, tolerance=1e-12)
    assert solution.is_converged, solution
    assert abs(solution.states[-1]).max() < 0.05
    assert abs(solution.controls).max() < 9.81  # it has to swing
    assert tuple(seen) == solution.iterations
    costs = [iteration.cost for iteration in seen]
    assert costs == sorted(costs, reverse=True) and costs[-1] == solution.cost
    x, total = solution.states[0], 0.0
    for u, after in zip(solution.controls, solution.states[1:], strict=True):
        x, cost = stage.calc(x, u)
        np.testing.assert_array_equal(x, after)
        total += cost
    assert solution.cost == pytest.approx(total + end(x).cost, rel=1e-14)

    def whole(u):
        x, total = np.array([np.pi, 0.0]), 0.0
        for k in range(60):
            x, cost = stage.calc.function(x, u[k : k + 1])
            total = total + cost
        return total + 200.0 * (x @ x)

    gradient = ulna.compile(whole, u=(60,)).function.jacobian()(solution.controls[:, 0])
    np.testing.assert_allclose(gradient, 0.0, atol=1e-3)
    assert "converged after" in repr(solution)


def test_a_concave_cost_is_held_by_regularisation():
    stage = control.custom_stage(
        lambda x, u: x + 0.1 * u, lambda x, u: np.cos(3.0 * u[0]) + x @ x, nx=1, nu=1
    )
    end = stage.terminal(lambda x: x @ x)
    solution = control.ddp(stage, end, [0.5], np.full((5, 1), 0.1))
    assert solution.is_converged, solution
    assert max(iteration.mu for iteration in solution.iterations) > 1.0
    np.testing.assert_allclose(np.cos(3.0 * solution.controls), -1.0, atol=0.05)


def test_short_steps_alone_are_no_convergence():
    """At the edges of a cost that is not smooth, regularisation grows until no step could gain anything."""
    stage = control.custom_stage(
        lambda x, u: x + u, lambda x, u: abs(x[0] - 1.0) + 5e-4 * u[0] * u[0], nx=1, nu=1
    )
    found = control.ddp(stage, stage.terminal(lambda x: 100.0 * abs(x[0] - 1.0)), [0.0], np.zeros((5, 1)))
    at_once = 1.0 + 5e-4  # one step to the goal, and rest
    assert found.cost > 2.0 * at_once
    assert not found.is_converged and found.reason == "no step decreases the cost"


def test_a_robot_reaches_a_point():
    b = ulna.ModelBuilder("arm")
    for name in ("base", "upper", "lower"):
        b.add_link(name, ulna.Inertia.from_cylinder(1.0, radius=0.05, length=0.4))
    b.add_joint("shoulder", Revolute([0, 1, 0]), "base", "upper")
    b.add_joint("elbow", Revolute([0, 1, 0]), "upper", "lower", ulna.SE3.trans(0, 0, 0.4))
    b.add_frame("hand", "lower", ulna.SE3.trans(0, 0, 0.4))
    robot = ulna.Robot(b.build())
    stage = control.stage(robot, lambda q, v, u: np.concatenate([0.1 * v, 0.01 * u]), dt=0.05)
    end = stage.terminal(
        lambda q, v, target: np.concatenate([100.0 * (robot.fk(q, "hand")[:3, 3] - target), 10.0 * v]),
        target=(3,),
    )
    q = np.array([0.4, 1.2])
    target = robot.fk(q + [0.5, -0.8], "hand")[:3, 3]
    hold = np.tile(robot.gravity_forces(q), (20, 1))
    solution = control.ddp(stage, end, np.concatenate([q, 0 * q]), hold, terminal_parameters=(target,))
    assert solution.is_converged, solution
    np.testing.assert_allclose(robot.fk(solution.states[-1, :2], "hand")[:3, 3], target, atol=3e-3)
    assert np.linalg.norm(solution.states[-1, 2:]) < 0.1


def test_parameters_of_each_knot():
    stage = control.custom_stage(
        lambda x, u: x + u, lambda x, u, goal: np.array([x[0] - goal, 1e-3 * u[0]]), nx=1, nu=1, goal=()
    )
    end = stage.terminal(lambda x, goal: x - goal, goal=())
    goals = np.array([0.0, 1.0, -1.0, 2.0])
    solution = control.ddp(
        stage, end, [0.0], np.zeros((4, 1)), parameters=(goals,), terminal_parameters=(5.0,)
    )
    np.testing.assert_allclose(solution.states[:, 0], [0.0, 1.0, -1.0, 2.0, 5.0], atol=1e-4)
    with pytest.raises(InputError, match="`parameters` has 0 entries; expected 1: goal"):
        control.ddp(stage, end, [0.0], np.zeros((4, 1)), terminal_parameters=(5.0,))
    plain = control.custom_stage(lambda x, u: x + u, lambda x, u: np.array([x[0], u[0]]), nx=1, nu=1)
    with pytest.raises(InputError, match="`parameters` has 1 entries; expected 0: nothing\\.$"):
        control.ddp(plain, plain.terminal(lambda x: x), [0.0], np.zeros((4, 1)), parameters=(1.0,))
    with pytest.raises(ShapeError, match=r"`goal` has shape \(3,\); expected \(\) or \(4,\)"):
        control.ddp(stage, end, [0.0], np.zeros((4, 1)), parameters=(goals[:3],), terminal_parameters=(5.0,))


def test_what_ends_a_search():
    stage, end = pendulum()
    x0, controls = [np.pi, 0.0], np.zeros((60, 1))
    short = control.ddp(stage, end, x0, controls, iterations=2)
    assert (
        not short.is_converged
        and short.reason == "2 iterations were not enough"
        and len(short.iterations) == 2
    )
    asked = control.ddp(stage, end, x0, controls, progress=lambda i: i.number == 3)
    assert len(asked.iterations) == 3 and asked.reason == "`progress` asked to stop"
    none = control.ddp(stage, end, x0, controls, iterations=0)
    assert none.states.shape == (61, 2) and none.gains.shape == (60, 1, 2)
    assert (controls == 0).all()
    with pytest.raises(ShapeError, match=r"`x0` has shape \(3,\); expected \(2,\)"):
        control.ddp(stage, end, np.zeros(3), controls)
    with pytest.raises(ShapeError, match=r"`controls` has shape \(60,\); expected \(N, 1\)"):
        control.ddp(stage, end, x0, np.zeros(60))
    with pytest.raises(NonFiniteError, match=r"`x0\[0\]` is nan"):
        control.ddp(stage, end, [np.nan, 0.0], controls)
    with pytest.raises(InputError, match="`controls` lead to a cost that is not finite"):
        control.ddp(stage, end, x0, np.full((60, 1), 1e200))
    with pytest.raises(ShapeError, match=r"`controls` has shape \(0, 1\); expected one row"):
        control.ddp(stage, end, x0, np.zeros((0, 1)))
    with pytest.raises(InputError, match="`controls` is a masked array"):
        control.ddp(stage, end, x0, np.ma.masked_greater(np.full((60, 1), 2.0), 1.0))


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"iterations": -1}, "`iterations` is -1"),
        ({"iterations": 2.5}, "`iterations` is 2.5"),
        ({"tolerance": np.nan}, "`tolerance` is nan"),
        ({"tolerance": -1e-9}, "`tolerance` is -1e-09"),
        ({"progress": 3}, "`progress` is 3; expected a function"),
        ({"stage": None}, "`stage` is None; expected a Stage"),
        ({"terminal": None}, "`terminal` is None; expected the end"),
    ],
)
def test_arguments_that_make_no_sense_are_refused(options, text):
    stage, end = pendulum()
    problem = {"stage": stage, "terminal": end, "x0": [0.1, 0.0], "controls": np.zeros((3, 1))}
    with pytest.raises(InputError, match=text):
        control.ddp(**(problem | options))


def test_stage_and_end_are_of_one_system():
    stage, _ = pendulum()
    other = control.custom_stage(lambda x, u: x + u, lambda x, u: u, nx=1, nu=1)
    with pytest.raises(InputError, match="`terminal` takes states of 1 numbers, and `stage` makes 2"):
        control.ddp(stage, other.terminal(lambda x: x), [0.1, 0.0], np.zeros((3, 1)))
    with pytest.raises(InputError, match="`dt` is 'fast'"):
        control.stage(ulna.load("panda"), lambda q, v, u: u, dt="fast")
    with pytest.raises(InputError, match="`robot` is 'panda'; expected a Robot"):
        control.stage("panda", lambda q, v, u: u, dt=0.1)


def two_joints_and_a_follower(inertia):
    """Joints a and c, and b, which follows a."""
    builder = ModelBuilder("follower").add_link("base")
    for parent, name, mimic in (("base", "a", None), ("a", "b", ("a", -2.0, 0.1)), ("b", "c", None)):
        builder.add_link(name, inertia if name == "c" else Inertia.from_box(1.0, (0.1, 0.2, 0.3)))
        builder.add_joint(
            name, Revolute((0.0, 0.6, 0.8)), parent, name, SE3.trans(0.1, 0.0, 0.2), mimic=mimic
        )
    return ulna.Robot(builder.build())


def test_followers_have_no_control():
    """Joint b had one, which replaced that of a."""
    robot = two_joints_and_a_follower(Inertia.from_box(1.0, (0.1, 0.2, 0.3)))
    stage = control.stage(robot, lambda q, v, u: u, dt=0.01)
    q, v, u = np.array([0.1, 0.2]), np.array([0.3, -0.4]), np.array([1.0, 2.0])
    after = v + 0.01 * robot.forward_dynamics(q, v, u)
    np.testing.assert_allclose(stage.calc([*q, *v], u)[0], [*(q + 0.01 * after), *after], atol=1e-12)
    with pytest.raises(UnknownName, match="There are: 'a', 'c'"):
        control.stage(robot, lambda q, v, u: u, dt=0.01, actuated=["b"])


def test_joints_that_move_no_inertia_are_named():
    robot = two_joints_and_a_follower(Inertia.from_point(1.0, (0.0, 0.06, 0.08)))
    with pytest.raises(ModelError, match="accelerate 'c' of 'follower' without bound"):
        control.stage(robot, lambda q, v, u: u, dt=0.01)


def test_ctrl_c_ends_a_search():
    stage, end = pendulum()
    x0, controls = [np.pi, 0.0], np.zeros((60, 1))

    def interrupt(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        control.ddp(stage, end, x0, controls, progress=interrupt)
