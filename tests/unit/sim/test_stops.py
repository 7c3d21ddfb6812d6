"""Position limits under torques are inelastic stops: their impulses act on all joints, as those of friction do."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna.algorithms import Friction
from ulna.algorithms.constraints.dry_friction import velocity_after_friction
from ulna.model import Composite, ModelBuilder, Prismatic, Revolute, Spherical
from ulna.sim import Simulation, simulate
from ulna.spatial import SE3, Inertia
from ulna.typing import Floats

BAR = Inertia(1.0, (0.5, 0.0, 0.0), 0.01 * np.eye(3))


def double_pendulum(friction: float = 0.0) -> ulna.Robot:
    """Two bars of 1 kg that turn about y; the first has a stop at 0.5 rad."""
    builder = ModelBuilder("double pendulum").add_link("base").add_link("upper", BAR).add_link("lower", BAR)
    builder.add_joint("first", Revolute((0, 1, 0)), "base", "upper", lower=-3.0, upper=0.5)
    builder.add_joint(
        "second", Revolute((0, 1, 0)), "upper", "lower", SE3.trans(1, 0, 0), lower=-2.5, friction=friction
    )
    return ulna.Robot(builder.build())


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_joint_pressed_on_its_stop_is_as_good_as_locked(friction: float) -> None:
    robot = double_pendulum(friction)
    body = (sim := Simulation()).add(robot, q=[0.5, 0.6], control="torque")
    body.tau = np.array([60.0, 0.0])
    sim.run(1.0, dt=0.01)
    locked = simulate(robot.lock({"first": 0.5}), [0.6], duration=1.0)
    assert body.q[0] == 0.5 and body.qd[0] == 0.0
    assert body.q[1] == pytest.approx(locked.q[-1, 0], abs=1e-9)


def test_an_impact_changes_the_velocities_of_other_joints_and_brings_no_energy() -> None:
    robot = double_pendulum()
    q, qd = np.array([0.4999, -0.5]), np.array([0.3, -3.0])
    body = (sim := Simulation()).add(robot, q=q, qd=qd, control="torque")
    sim.step(1e-3)
    G = robot.inverse_mass_matrix(q)
    free = qd + 1e-3 * robot.forward_dynamics(q, qd, np.zeros(2))
    np.testing.assert_allclose(body.qd, free - G[:, 0] * free[0] / G[0, 0], atol=1e-12)
    assert body.q[0] == 0.5
    assert robot.kinetic_energy(body.q, body.qd) < robot.kinetic_energy(q, qd)


def test_a_joint_leaves_its_stop_when_it_is_pulled_away() -> None:
    robot = double_pendulum()
    body = (sim := Simulation()).add(robot, q=[0.5, 0.0], control="torque")
    body.tau = np.array([-60.0, 0.0])
    sim.step(1e-3)
    free = simulate(robot, [0.5, 0.0], torque=body.tau, duration=1e-3)
    np.testing.assert_allclose(body.q, free.q[-1], atol=1e-15)


def test_an_impact_that_throws_another_joint_on_its_stop_ends_both() -> None:
    robot = double_pendulum()
    body = (sim := Simulation()).add(robot, q=[0.4999, -2.4999], qd=[3.0, 0.0], control="torque")
    sim.step(1e-3)
    np.testing.assert_array_equal(body.q, [0.5, -2.5])
    np.testing.assert_array_equal(body.qd, [0.0, 0.0])


def test_joints_inside_of_a_composite_have_stops() -> None:
    builder = ModelBuilder("crane").add_link("base").add_link("hook", BAR)
    kind = Composite((Spherical(), Prismatic((0, 0, 1))))
    low, high = [-np.inf] * 4 + [-0.1], [np.inf] * 4 + [0.1]
    builder.add_joint("boom", kind, "base", "hook", lower=low, upper=high)
    body = (sim := Simulation()).add(ulna.Robot(builder.build()), control="torque")
    sim.run(0.5, dt=0.01)
    assert body.q[4] == -0.1 and body.qd[3] == 0.0


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_stops_push_only_away_from_limits_and_only_where_they_hold(seed: int, friction: float) -> None:
    rng = np.random.default_rng(seed)
    A: Floats = rng.standard_normal((6, 6))
    G, u = A @ A.T + 0.1 * np.eye(6), 3.0 * rng.standard_normal(6)
    forward = np.where(rng.random(6) < 0.4, np.inf, 0.0)
    backward = np.where((rng.random(6) < 0.4) & (forward == 0.0), np.inf, 0.0)
    v = velocity_after_friction(G, u, u, 0.1, Friction(friction, friction), (forward, backward))
    impulse = np.linalg.solve(G, v - u) + 0.1 * friction * v  # without that of dampers
    dry, slack = 0.1 * friction, 1e-9
    low, high = forward > 0.0, backward > 0.0
    assert (v[low] >= 0.0).all() and (v[high] <= 0.0).all()
    assert (impulse[~low] <= dry + slack).all() and (impulse[~high] >= -dry - slack).all()
    moves = np.abs(v) > 1e-12
    np.testing.assert_allclose(impulse[moves], -dry * np.sign(v[moves]), atol=slack)
