"""What a motion conserves: energy without friction, momentum in free flight, the sphere of quaternions; and how fast errors fall."""

from __future__ import annotations

import math

import numpy as np
import pytest

import ulna
from support.random_models import random_model
from ulna import algorithms as alg
from ulna.algorithms import Friction
from ulna.model import (
    FreeFlyer,
    ModelBuilder,
    Revolute,
    dynamic_parameters,
    with_gravity,
    with_joint_dynamics,
)
from ulna.robot import Robot
from ulna.sim import simulate
from ulna.spatial import SE3, Inertia
from ulna.typing import Floats


def energy(robot: Robot, recording) -> Floats:
    """Kinetic and potential energy, row by row [J]."""
    model, q, v = robot.model, recording["q"], recording["v"]
    p = dynamic_parameters(model)
    bodies = (alg.kinetic_energy_regressor(model, q, v) + alg.potential_energy_regressor(model, q)) @ p
    return bodies + 0.5 * (model.armature * v * v).sum(axis=-1)


def pendulum() -> Robot:
    builder = (
        ModelBuilder("pendulum").add_link("base").add_link("rod", Inertia.from_point(1.0, (0.0, 0.0, -0.5)))
    )
    builder.add_joint("hinge", Revolute((0, 1, 0)), "base", "rod")
    return Robot(builder.build())


def chain() -> Robot:
    """Three turned boxes in free flight."""
    builder = ModelBuilder("chain")
    for k in range(3):
        builder.add_link(f"box{k}", Inertia.from_box(1.0 + k, (0.1, 0.2, 0.4)))
    for k, axis in enumerate(((1, 0, 0), (0, 1, 0))):
        place = SE3.from_rpy((0.3, 0.2, 0.1), (0.0, 0.1, 0.3))
        builder.add_joint(f"joint{k}", Revolute(axis), f"box{k}", f"box{k + 1}", place)
    builder.root_joint(FreeFlyer())
    return Robot(with_gravity(builder.build(), (0.0, 0.0, 0.0)))


def test_a_pendulum_swings_with_its_period() -> None:
    robot = pendulum()
    # by the arithmetic-geometric mean: T = 2 pi sqrt(l/g) / agm(1, cos(a/2))
    a = 1.0
    x, y = 1.0, math.cos(a / 2)
    for _ in range(5):
        x, y = (x + y) / 2, math.sqrt(x * y)
    period = 2 * math.pi * math.sqrt(0.5 / 9.81) / x
    for method, error in (("euler", 2e-3), ("rk4", 1e-9)):
        out = simulate(robot, [a], duration=period, dt=period / 2000, method=method)
        assert out["q"][-1, 0] == pytest.approx(a, abs=error)


@pytest.mark.parametrize(
    ("method", "dt", "drift"), [("euler", 1e-3, 5e-2), ("rk4", 1e-3, 1e-9), ("adaptive", 1e-2, 1e-6)]
)
def test_energy_of_a_pendulum(method, dt: float, drift: float) -> None:
    if method == "adaptive":
        pytest.importorskip("scipy")
    robot = pendulum()
    e = energy(robot, simulate(robot, [2.0], duration=10.0, dt=dt, method=method))
    assert np.ptp(e) < drift
    late, early = e[len(e) // 2 :], e[: len(e) // 2]
    assert np.ptp(late) < 1.2 * np.ptp(early) + drift / 10  # in bounds, not growing


@pytest.mark.parametrize(("method", "order"), [("euler", 1), ("rk4", 4)])
def test_errors_fall_with_the_order(method, order: int) -> None:
    model = random_model(
        np.random.default_rng(1), ["revolute", "spherical", "planar", "universal"], root="free_flyer"
    )
    robot = Robot(model)
    q = robot.random_configuration(seed=0)
    v = np.random.default_rng(0).standard_normal(model.nv)
    step = 0.01 if method == "rk4" else 0.002

    def end(dt: float) -> Floats:
        return simulate(robot, q, v, duration=0.2, dt=dt, method=method, friction=None)["q"][-1]

    exact = simulate(robot, q, v, duration=0.2, dt=1e-3, method="rk4", friction=None)["q"][-1]
    errors = [float(np.abs(robot.difference(exact, end(dt))).max()) for dt in (step, step / 2)]
    assert errors[0] / errors[1] == pytest.approx(2**order, rel=0.15)


@pytest.mark.parametrize("method", ["rk4", "adaptive"])
def test_free_flight_conserves_energy_and_momentum(method) -> None:
    if method == "adaptive":
        pytest.importorskip("scipy")
    robot = chain()
    v = np.array([0.1, -0.2, 0.3, 1.0, 2.0, -1.0, 3.0, -2.0])
    out = simulate(robot, robot.neutral, v, duration=5.0, dt=5e-3, method=method)
    assert np.ptp(energy(robot, out)) < 1e-6
    np.testing.assert_allclose(np.linalg.norm(out["q"][:, 3:7], axis=1), 1.0, atol=1e-12)
    com = np.array([_com(robot, q) for q in out["q"]])
    line = np.polynomial.polynomial.polyfit(out["t"], com, 1)
    np.testing.assert_allclose(com, line[0] + np.outer(out["t"], line[1]), atol=1e-7)


def _com(robot: Robot, q: Floats) -> Floats:
    return robot.static_regressor(q) @ dynamic_parameters(robot.model).reshape(-1, 10)[:, :4].ravel()


def test_adaptive_passes_many_turns_of_a_free_body() -> None:
    pytest.importorskip("scipy")
    robot = chain()
    v = np.array([0.0, 0.0, 0.0, 1.0, 8.0, -1.0, 1.0, 1.0])  # it turns a dozen times
    ends = [
        simulate(robot, robot.neutral, v, duration=5.0, dt=dt, method=method)["q"][-1]
        for method, dt in (("adaptive", 0.5), ("rk4", 1e-3))
    ]
    assert np.abs(robot.difference(*ends)).max() < 1e-5


def test_what_friction_takes_leaves_the_energy() -> None:
    robot = Robot(with_joint_dynamics(ulna.load("ur5").model, damping=0.5, friction=2.0))
    q = np.array([0.0, -1.0, 1.0, 0.0, 0.5, 0.0])
    law = Friction.of(robot.model, width=0.05)
    out = simulate(robot, q, duration=1.0, dt=2e-4, method="rk4", friction=law)
    power = (law.torque(out["v"]) * out["v"]).sum(axis=1)
    lost = np.concatenate([[0.0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(out["t"]))])
    np.testing.assert_allclose(energy(robot, out) - energy(robot, out)[0], lost, atol=1e-3)
    assert lost[-1] < -0.1


def test_exact_and_smooth_friction_agree_in_the_limit() -> None:
    robot = Robot(with_joint_dynamics(ulna.load("ur5").model, friction=[5.0, 5.0, 5.0, 1.0, 1.0, 1.0]))
    q = np.array([0.0, -1.0, 1.0, 0.0, 0.5, 0.0])
    exact = simulate(robot, q, duration=0.3, dt=1e-4)["q"][-1]
    errors = []
    for width in (0.08, 0.02):
        law = Friction.of(robot.model, width=width)
        smooth = simulate(robot, q, duration=0.3, dt=1e-4, method="rk4", friction=law)["q"][-1]
        errors.append(float(np.abs(exact - smooth).max()))
    assert errors[1] < 0.5 * errors[0]
    assert errors[1] < 5e-3
