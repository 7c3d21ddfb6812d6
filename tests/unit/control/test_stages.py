"""Stages of optimal control: derivatives against differences on the manifold, costs of both kinds, messages."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna import control
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.model import FreeFlyer, Prismatic, Revolute, Spherical


@pytest.fixture(scope="module")
def flyer() -> ulna.Robot:
    b = ulna.ModelBuilder("flyer")
    for name, size in (("world", None), ("body", 0.3), ("ball", 0.15)):
        b.add_link(name, None if size is None else ulna.Inertia.from_box(2.0, (size, 0.5 * size, 2 * size)))
    b.add_joint("free", FreeFlyer(), "world", "body")
    b.add_joint("wrist", Spherical(), "body", "ball", ulna.SE3.trans(0.1, 0, 0.3))
    return ulna.Robot(b.build())


def residuals(q, v, u, target):
    return np.concatenate([3.0 * (q[:3] - target), q[3:6] * q[6], 0.1 * v, 0.05 * u])


def number(q, v, u, target):
    r = residuals(q, v, u, target)
    return np.sqrt(1.0 + r @ r) + np.sin(u[0] * v[1] + q[0])


def differences(f, n, step=1e-6):
    return np.stack([(f(step * e) - f(-step * e)) / (2 * step) for e in np.eye(n)], axis=-1)


def test_derivatives_of_a_floating_robot_against_differences(flyer):
    stage = control.stage(flyer, number, dt=0.05, target=(3,))
    assert (stage.nx, stage.ndx, stage.nu) == (flyer.nq + flyer.nv, 2 * flyer.nv, flyer.nv - 6)
    rng = np.random.default_rng(0)
    q, v, target = flyer.random_configuration(seed=1), rng.normal(size=flyer.nv), rng.normal(size=3)
    x, u, nv, n = np.concatenate([q, v]), rng.normal(size=stage.nu), flyer.nv, stage.ndx
    d = stage(x, u, target)

    def moved(dx):
        return np.concatenate([flyer.integrate(q, dx[:nv]), v + dx[nv:]])

    def beyond(after):
        return np.concatenate(
            [
                flyer.difference(d.x_next[: flyer.nq], after[: flyer.nq]),
                after[flyer.nq :] - d.x_next[flyer.nq :],
            ]
        )

    fx = differences(lambda dx: beyond(stage.calc(moved(dx), u, target)[0]), n)
    fu = differences(lambda du: beyond(stage.calc(x, u + du, target)[0]), stage.nu)
    np.testing.assert_allclose(d.fx, fx, atol=2e-7)
    np.testing.assert_allclose(d.fu, fu, atol=2e-7)
    gradient = differences(lambda z: stage.calc(moved(z[:n]), u + z[n:], target)[1], n + stage.nu)
    np.testing.assert_allclose(np.concatenate([d.lx, d.lu]), gradient, atol=1e-7)
    assert float(stage.calc(x, u, target)[1]) == pytest.approx(float(d.cost), rel=1e-14)

    def slope(z):  # second differences of the cost along two directions at once
        return stage.calc(moved(z[:n]), u + z[n:], target)[1]

    h, steps = 1e-4, np.eye(n + stage.nu)
    for a, b in ((0, 4), (3, 3), (5, n + 1), (n, n), (nv + 1, n)):
        second = sum(s * t * slope(h * (s * steps[a] + t * steps[b])) for s in (1, -1) for t in (1, -1)) / (
            4 * h * h
        )
        whole = np.block([[d.lxx, d.lux.T], [d.lux, d.luu]])
        assert whole[a, b] == pytest.approx(second, abs=2e-5)
        assert whole[a, b] == whole[b, a]


def test_the_step_is_that_of_the_robot():
    b = ulna.ModelBuilder("cart")
    for name in ("rail", "cart", "rod", "tip"):
        b.add_link(name, ulna.Inertia.from_box(2.0, (0.1, 0.2, 0.3)))
    b.add_joint("slider", Prismatic([1, 0, 0]), "rail", "cart")
    b.add_joint("hinge", Revolute([0, 1, 0]), "cart", "rod", damping=0.1)
    b.add_joint("elbow", Revolute([0, 1, 0]), "rod", "tip", ulna.SE3.trans(0.1, 0, 0.2))
    robot = ulna.Robot(b.build())
    stage = control.stage(
        robot, lambda q, v, u: np.concatenate([q, v, u]), dt=0.05, actuated=["elbow", "slider"]
    )
    q, v, u = np.array([0.1, -0.4, 0.9]), np.array([0.3, 1.0, -2.0]), np.array([2.0, -3.0])
    after, cost = stage.calc(np.concatenate([q, v]), u)
    w = v + 0.05 * robot.forward_dynamics(q, v, [2.0, 0.0, -3.0])  # in the order of the model
    np.testing.assert_allclose(after, np.concatenate([robot.integrate(q, 0.05 * w), w]), rtol=1e-12)
    assert float(cost) == pytest.approx(0.5 * (q @ q + v @ v + u @ u), rel=1e-13)


def test_residuals_have_the_hessian_of_gauss_and_newton_and_knots_come_in_batches():
    def r(x, u, goal, weight):
        return np.array([np.sin(x[0]) - goal, weight * x[1] * u[0]])

    stage = control.custom_stage(lambda x, u: np.array([x[1], u[0]]), r, nx=2, nu=1, goal=(), weight=())
    rng = np.random.default_rng(5)
    X, U, goals = rng.normal(size=(9, 2)), rng.normal(size=(9, 1)), rng.normal(size=9)
    d = stage(X, U, goals, 2.0)
    assert [part.shape for part in d] == [
        (9, 2),
        (9, 2, 2),
        (9, 2, 1),
        (9,),
        (9, 2),
        (9, 1),
        (9, 2, 2),
        (9, 1, 2),
        (9, 1, 1),
    ]
    for k in range(9):
        (a, b), c = X[k], U[k, 0]
        J = np.array([[np.cos(a), 0, 0], [0, 2 * c, 2 * b]])
        value = np.array([np.sin(a) - goals[k], 2 * b * c])
        H = J.T @ J
        np.testing.assert_allclose(d.cost[k], 0.5 * value @ value, rtol=1e-14)
        np.testing.assert_allclose(np.append(d.lx[k], d.lu[k]), J.T @ value, rtol=1e-13, atol=1e-15)
        np.testing.assert_allclose(d.lxx[k], H[:2, :2], rtol=1e-13, atol=1e-15)
        np.testing.assert_allclose(d.lux[k], H[2:, :2], rtol=1e-13, atol=1e-15)
        np.testing.assert_allclose(d.luu[k], H[2:, 2:], rtol=1e-13, atol=1e-15)
    end = stage.terminal(lambda x, weight: weight * (x[0] ** 4 + x[0] * x[1]), weight=())
    t = end(X, 3.0)
    np.testing.assert_allclose(t.lxx[:, 0, 0], 36 * X[:, 0] ** 2, rtol=1e-14)
    np.testing.assert_allclose(t.lx[:, 1], 3 * X[:, 0], rtol=1e-14)


def test_arguments_of_a_cost_behind_one_that_keeps_its_default_have_their_own_values():
    def step(x, u):
        return np.array([x[1], u[0]])

    def between(x, u, weight=3.0, goal=0.0):
        return weight * (x[0] - goal) ** 2 + u @ u

    def by_name(x, u, *, goal, weight=3.0):
        return between(x, u, weight, goal)

    def at_the_end(x, weight=3.0, goal=0.0):
        return weight * (x[0] - goal) ** 2

    x, u = np.array([1.0, 2.0]), np.array([0.5])
    for cost in (between, by_name):
        stage = control.custom_stage(step, cost, nx=2, nu=1, goal=())
        assert stage(x, u, 5.0).cost == pytest.approx(3.0 * 16.0 + 0.25)
    end = stage.terminal(at_the_end, goal=())
    assert end(x, 5.0).cost == pytest.approx(3.0 * 16.0)


def test_messages():
    def step(x, u):
        return x + u[0]

    def cost(x, u):
        return x @ x

    robot = ulna.load("panda")
    with pytest.raises(InputError, match=r"`dt` is 0; expected a number above zero"):
        control.stage(robot, lambda q, v, u: u @ u, dt=0)
    with pytest.raises(UnknownName, match="No joint named 'panda_joint8'. Did you mean 'panda_joint"):
        control.stage(robot, lambda q, v, u: u @ u, dt=0.1, actuated=["panda_joint8"])
    with pytest.raises(InputError, match="No joint is driven"):
        control.stage(robot, lambda q, v, u: u @ u, dt=0.1, actuated=[])
    with pytest.raises(InputError, match=r"`cost` takes 2 arguments, q, u; expected cost\(q, v, u, \.\.\.\)"):
        control.stage(robot, lambda q, u: u @ u, dt=0.1)
    with pytest.raises(UnknownName, match=r"shape of argument named 'goal'.*Give it: goal=\(3,\)"):
        control.custom_stage(step, lambda x, u, goal: x @ x, nx=2, nu=1)
    with pytest.raises(
        UnknownName, match=r"further argument of the cost named 'goal'.*called as cost\(x, u, \.\.\.\)"
    ):
        control.custom_stage(step, cost, nx=2, nu=1, goal=(3,))
    with pytest.raises(InputError, match=r"`step` returns the shape \(1,\); expected \(2,\), the next state"):
        control.custom_stage(lambda x, u: x[:1], cost, nx=2, nu=1)
    with pytest.raises(
        InputError, match=r"`cost` returns the shape \(2, 1\); expected a number, or one vector"
    ):
        control.custom_stage(step, lambda x, u: x[:, None], nx=2, nu=1)
    with pytest.raises(InputError, match="has an argument 'z_'; expected another name"):
        control.custom_stage(step, lambda x, u, z_: x @ x, nx=2, nu=1, z_=())
    with pytest.raises(ShapeError, match=r"`u` has shape \(3,\)"):
        control.custom_stage(step, cost, nx=2, nu=1)(np.zeros(2), np.zeros(3))
