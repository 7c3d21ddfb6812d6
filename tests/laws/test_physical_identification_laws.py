"""Laws of physically consistent identification: its cost is proven least by a dual certificate, whatever the log.

The gradient g of the cost at the parameters p is, body by body, g . x = tr(Z P(x)) for exactly one symmetric Z. With
Z positive semidefinite, convexity gives cost(x) >= cost(p) - tr(Z P(p)) for every physically consistent x.
"""

from __future__ import annotations

import signal
import threading
import time
from typing import Any

import numpy as np
import pytest

import ulna
from support.random_models import random_model
from ulna.errors import InputError
from ulna.identification import Progress, identify
from ulna.identification.identifiable_parameters import extended_regressor
from ulna.identification.physical import pseudo_inertia
from ulna.model import dynamic_parameters, perturbed, with_joint_dynamics
from ulna.robot import Robot
from ulna.typing import Floats

ALL = {"armature": True, "damping": True, "friction": True}
BASIS = pseudo_inertia(np.eye(10))


@pytest.fixture(scope="module")
def ur5() -> Robot:
    return ulna.load("ur5")


@pytest.fixture(scope="module")
def true(ur5: Robot) -> Robot:
    model = perturbed(ur5.model, 0.3, seed=1, com=0.01)
    return Robot(with_joint_dynamics(model, armature=0.1, damping=1.0, friction=0.5))


def log(robot: Robot, noise: float, rows: int, size: float = 1.0) -> tuple[Floats, ...]:
    rng = np.random.default_rng(3)
    q = robot.random_configuration(rows, rng)
    v, a = size * rng.standard_normal((2, rows, robot.nv))
    m = robot.model
    tau = robot.joint_torque_regressor(q, v, a) @ dynamic_parameters(m)
    tau += m.armature * a + m.damping * v + m.friction * np.tanh(v / 1e-2)
    return q, v, a, tau + rng.normal(0.0, noise, tau.shape)


def certified(robot: Robot, data: tuple[Floats, ...], found: Any, ridge: float, **options: Any) -> float:
    """The cost found, after a proof that none is lower by more than 1e-6 of it."""
    q, v, a, tau = data
    m = robot.model
    prior = np.asarray(options.pop("prior", dynamic_parameters(m)))
    sigma = np.asarray(options.pop("noise", np.ones(robot.nv)))
    sought = {k: True for k in ALL if options.get(k)}
    W = extended_regressor(robot, q, v, a, **sought) / sigma[:, None]
    known = np.zeros_like(tau)
    for name, value in (("armature", a), ("damping", v), ("friction", np.tanh(v / 1e-2))):
        known += 0.0 if name in sought else getattr(m, name) * value
    y, n = (tau - known) / sigma, W.shape[-1]
    W, y = W.reshape(-1, n) / np.sqrt(y.size), y.ravel() / np.sqrt(y.size)
    weight = ridge * float(y @ y) if ridge < 0.1 else ridge
    p = np.concatenate([found.parameters, *(getattr(found, k) for k in sought)])
    count = 10 * len(m.joints)
    mass = prior.reshape(-1, 10)[:, 0]
    mass = np.maximum(mass, 0.1 * mass.mean())
    moments = np.abs(np.trace(pseudo_inertia(prior.reshape(-1, 10))[:, :3, :3], axis1=1, axis2=2))
    square = np.maximum(moments / mass, 0.01)
    D = np.stack([mass, *[mass * np.sqrt(square)] * 3, *[mass * square] * 6], axis=-1).ravel()
    change = (p[:count] - prior) / D
    cost = float(((W @ p - y) ** 2).sum() + weight * (change @ change))
    gradient = 2.0 * W.T @ (W @ p - y)
    gradient[:count] += 2.0 * weight * change / D
    P = pseudo_inertia(found.parameters.reshape(-1, 10))
    assert np.linalg.eigvalsh(P).min() > 0.0
    assert (p[count:] >= 0.0).all()
    slack = cost * 1e-6 + 1e-12 * float(y @ y)
    total = 0.0
    units = np.stack([np.sqrt(square), np.sqrt(square), np.sqrt(square), np.ones_like(square)], axis=-1)
    units *= np.sqrt(mass)[:, None]  # in these units every pseudo-inertia is of order one
    rows, columns = np.triu_indices(4)
    for k, body in enumerate(P):
        twice = np.where(rows == columns, 1.0, 2.0)
        coefficients = BASIS[:, rows, columns] * twice
        Z = np.zeros((4, 4))
        Z[rows, columns] = np.linalg.solve(coefficients, gradient[10 * k : 10 * k + 10])
        Z = Z + np.triu(Z, 1).T
        assert np.linalg.eigvalsh(Z * np.outer(units[k], units[k])).min() > -slack
        total += float(np.trace(Z @ body))
    total += float(gradient[count:] @ p[count:])
    assert abs(total) < slack
    return cost


@pytest.mark.parametrize("options", [{}, ALL, {"damping": True}])
@pytest.mark.parametrize(("noise", "rows", "size"), [(0.0, 200, 1.0), (0.1, 200, 1.0), (0.1, 3, 0.01)])
def test_no_physical_bodies_explain_a_log_better(
    ur5: Robot, true: Robot, options: dict[str, bool], noise: float, rows: int, size: float
) -> None:
    data = log(true, noise, rows, size)
    found = identify(ur5, *data, physical=True, **options)
    certified(ur5, data, found, 1e-6, **options)
    assert found.physical and 1 < found.iterations < 100
    assert all(body.is_physical() for body in found.new_model.inertias)


def test_weights_and_priors_are_part_of_the_cost(ur5: Robot, true: Robot) -> None:
    data = log(true, 0.1, 100)
    sigma = np.array([1.0, 2.0, 0.5, 0.1, 0.1, 0.2])
    prior = 1.2 * dynamic_parameters(true.model)
    options: dict[str, Any] = {**ALL, "noise": sigma, "prior": prior}
    for ridge in (0.5, 100.0):
        found = identify(ur5, *data, physical=True, ridge=ridge, **options)
        certified(ur5, data, found, ridge, **options)
    impossible = prior.copy()
    impossible[4:10] = -1.0  # a prior need not be physically consistent
    found = identify(ur5, *data, physical=True, ridge=1.0, noise=sigma, prior=impossible, **ALL)
    certified(ur5, data, found, 1.0, **{**options, "prior": impossible})


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_trees_of_every_joint(seed: int) -> None:
    robot = Robot(random_model(np.random.default_rng(seed)))
    other = Robot(perturbed(robot.model, 0.5, seed=seed, com=0.05))
    data = log(other, 0.05, 60)
    certified(robot, data, identify(robot, *data, physical=True), 1e-6)


def test_true_parameters_are_found_as_far_as_the_log_shows_them(ur5: Robot, true: Robot) -> None:
    data = log(true, 0.0, 200)
    found = identify(ur5, *data, physical=True, ridge=0.0, **ALL)
    assert found.rms.max() < 1e-5 * found.rms_before.max()
    m = true.model
    p = np.concatenate([dynamic_parameters(m), m.armature, m.damping, m.friction])
    np.testing.assert_allclose(found.base_values, found.base.of(p), atol=1e-4)
    np.testing.assert_allclose(found.damping, 1.0, atol=1e-5)
    np.testing.assert_allclose(found.friction, 0.5, atol=1e-5)


def test_what_the_log_does_not_move_stays_at_the_prior(ur5: Robot) -> None:
    start = Robot(with_joint_dynamics(ur5.model, damping=0.7, friction=0.3))
    q, v, a, tau = log(start, 0.0, 1)
    found = identify(start, q, 0.0 * v, 0.0 * a, 1.1 * tau, physical=True, damping=True, friction=True)
    np.testing.assert_array_equal(found.damping, 0.7)
    np.testing.assert_array_equal(found.friction, 0.3)
    still = identify(start, q, v, a, 0.0 * tau, physical=True, **ALL)
    assert np.isfinite(still.parameters).all()


def test_scipy_finds_no_lower_cost(ur5: Robot, true: Robot) -> None:
    optimize = pytest.importorskip("scipy.optimize")
    from ulna.identification import from_log_cholesky, log_cholesky
    from ulna.identification.physical import log_cholesky_jacobian

    data = log(true, 0.1, 60)
    ridge = 1.0
    found = identify(true, *data, physical=True, ridge=ridge)
    cost = certified(true, data, found, ridge)
    q, v, a, tau = data
    m = true.model
    rows = tau.size
    W = true.joint_torque_regressor(q, v, a).reshape(rows, -1) / np.sqrt(rows)
    y = (tau - m.armature * a - m.damping * v - m.friction * np.tanh(v / 1e-2)).ravel() / np.sqrt(rows)
    p0 = dynamic_parameters(m)
    P0 = pseudo_inertia(p0.reshape(-1, 10))
    mass = np.maximum(P0[:, 3, 3], 0.1 * P0[:, 3, 3].mean())
    square = np.maximum(np.trace(P0[:, :3, :3], axis1=1, axis2=2) / mass, 0.01)
    D = np.stack([mass, *[mass * np.sqrt(square)] * 3, *[mass * square] * 6], axis=-1).ravel()

    def residual(t: Floats) -> Floats:
        p = from_log_cholesky(t.reshape(-1, 10)).ravel()
        return np.concatenate([W @ p - y, np.sqrt(ridge) * (p - p0) / D])

    def jacobian(t: Floats) -> Floats:
        inner = np.zeros((len(t), len(t)))
        for k, block in enumerate(log_cholesky_jacobian(t.reshape(-1, 10))):
            inner[10 * k : 10 * k + 10, 10 * k : 10 * k + 10] = block
        return np.concatenate([W @ inner, np.sqrt(ridge) * inner / D[:, None]])

    theirs = optimize.least_squares(residual, log_cholesky(p0.reshape(-1, 10)).ravel(), jacobian)
    assert cost <= 2.0 * theirs.cost * (1.0 + 1e-5)


def test_progress_is_reported_and_may_end_the_search(ur5: Robot, true: Robot) -> None:
    data = log(true, 0.1, 50)
    seen: list[Progress] = []
    found = identify(ur5, *data, physical=True, progress=seen.append)
    assert [p.step for p in seen] == list(range(1, found.iterations + 1))
    assert seen[-1].gap <= 1e-8 * seen[-1].cost < seen[0].cost

    def enough(progress: Progress) -> None:
        if progress.step == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        identify(ur5, *data, physical=True, progress=enough)
    with pytest.raises(InputError, match="physical=True"):
        identify(ur5, *data, progress=seen.append)


def test_ctrl_c_ends_the_search(ur5: Robot, true: Robot) -> None:
    data = log(true, 0.1, 50)
    main = threading.get_ident()

    sent = threading.Event()

    def interrupt() -> None:
        time.sleep(0.05)
        signal.pthread_kill(main, signal.SIGINT)
        sent.set()

    def slow(progress: Progress) -> None:  # every step lasts, as on a robot of many joints
        if progress.step == 1:
            threading.Thread(target=interrupt).start()
        time.sleep(0.02)
        if progress.step == 4:  # the search must not end before the signal comes
            sent.wait(600.0)

    with pytest.raises(KeyboardInterrupt):
        identify(ur5, *data, physical=True, progress=slow)


@pytest.mark.parametrize("noise", [0.0, -1.0, np.inf, np.nan, [1.0, 1.0, 0.0, 1.0, 1.0, 1.0]])
@pytest.mark.parametrize("physical", [False, True])
def test_invalid_noise_is_refused(ur5: Robot, noise: Any, physical: bool) -> None:
    with pytest.raises(InputError, match=r"`noise` is .*; expected finite numbers above zero"):
        identify(ur5, *log(ur5, 0.0, 5), noise=noise, physical=physical)


@pytest.mark.parametrize("seed", [5000, 5009, 5011, 5015])
def test_exact_torques_are_met_exactly(seed: int) -> None:
    """The true bodies can exist, so the physical fit without a prior meets torques that include friction."""
    rng = np.random.default_rng(seed)
    robot = Robot(random_model(rng, joints=4, mimics=seed % 2))
    q, v, a = robot.random_configuration(200, rng), *rng.uniform(-1.0, 1.0, (2, 200, robot.nv))
    tau = robot.perturbed(0.3, seed=seed).inverse_dynamics(q, v, a, friction=True)
    fit = identify(robot, q, v, a, tau, physical=True, ridge=0.0)
    assert np.abs(fit.residuals).max() < 1e-5 * np.abs(tau).max()
    again = Robot(fit.new_model).inverse_dynamics(q, v, a, friction=True)
    np.testing.assert_allclose(again, tau, atol=1e-5 * np.abs(tau).max())
