"""Damped steps that follow a target: they arrive, stay within limits, and stay calm where nothing helps."""

import numpy as np
import pytest

import ulna
from ulna.errors import ShapeError
from ulna.ik import damped_step
from ulna.spatial import SE3


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


def follow(robot: ulna.Robot, q: np.ndarray, goal: np.ndarray, steps: int):
    for _ in range(steps):
        step = damped_step(robot, q, goal)
        assert robot.limits.contains(step.q)
        assert np.abs(step.q - q).max() <= 0.25 + 1e-12
        q = step.q
    return damped_step(robot, q, goal)


def test_it_arrives(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    goal = panda.fk(q) @ SE3.from_rpy((0.2, -0.3, 0.4), (0.1, 0.15, 0.1)).matrix()
    end = follow(panda, q, goal, 40)
    assert end.position_error < 1e-9
    assert end.rotation_error < 1e-9


def test_at_the_goal_it_stands_still(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    np.testing.assert_allclose(damped_step(panda, q, panda.fk(q)).q, q, atol=1e-12)


def test_near_goals_are_reached_from_many_places(panda: ulna.Robot) -> None:
    rng = np.random.default_rng(1)
    arrived = 0
    for q in panda.random_configuration(40, seed=2):
        goal = panda.fk(panda.limits.clip(q + rng.uniform(-0.15, 0.15, 7)))
        arrived += follow(panda, q, goal, 60).position_error < 1e-4
    assert arrived >= 38  # a path straight at the goal may end at a limit


def test_out_of_reach_it_stretches_and_rests(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    goal = panda.fk(q)
    goal[:3, 3] = (3.0, 0.0, 0.5)
    for _ in range(300):
        q = damped_step(panda, q, goal).q
    assert panda.fk(q)[0, 3] > 0.7
    assert np.abs(damped_step(panda, q, goal).q - q).max() < 1e-3
    assert panda.limits.contains(q)


def test_a_step_never_leads_away(panda: ulna.Robot) -> None:
    rng = np.random.default_rng(3)
    for q in panda.random_configuration(30, seed=4):
        goal = SE3.exp(rng.normal(size=6)).matrix()
        first = damped_step(panda, q, goal)
        second = damped_step(panda, first.q, goal)
        before, after = (np.hypot(s.position_error, 0.3 * s.rotation_error) for s in (first, second))
        assert after <= before


def test_a_joint_at_its_limit_hands_over_to_the_others(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    q[0] = panda.limits.upper[0]
    goal = SE3.rz(0.1).matrix() @ panda.fk(q)  # the base joint alone would do it, and cannot
    end = follow(panda, q, goal, 80)
    assert end.q[0] <= panda.limits.upper[0]
    assert end.position_error < 1e-6


def test_another_frame_can_be_asked_for(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    goal = panda.fk(q + (0.1, -0.1, 0.2, -0.1, 0, 0, 0), "panda_link4")
    for _ in range(30):
        q = damped_step(panda, q, goal, "panda_link4").q
    np.testing.assert_allclose(panda.fk(q, "panda_link4"), goal, atol=1e-8)


def test_a_goal_that_is_no_pose_is_refused(panda: ulna.Robot) -> None:
    with pytest.raises(ShapeError, match="T_goal"):
        damped_step(panda, panda.configurations["qr"], np.zeros(3))
