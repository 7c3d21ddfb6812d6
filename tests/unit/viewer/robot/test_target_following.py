"""A dragged target: the tool stays on it, never jumps, stretches where it is out of reach, and comes to rest."""

import numpy as np
import pytest

import ulna
from ulna.model import Fixed, ModelBuilder, Revolute
from ulna.spatial import SE3
from ulna.viewer.robot.target_following import TargetFollower

STRIDE = 0.5


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


def rest(robot: ulna.Robot, q: np.ndarray, goal: np.ndarray, most: int = 400) -> np.ndarray:
    follower = TargetFollower(robot)
    for _ in range(most):
        step = follower.step(q, goal)
        assert robot.limits.contains(step.q)
        assert np.abs(step.q - q).max() <= STRIDE + 1e-12
        q = step.q
        if step.converged:
            return q
    raise AssertionError(f"still moving after {most} steps")


def test_the_tool_is_on_a_slow_target_at_every_step(panda: ulna.Robot) -> None:
    q, follower = np.array(panda.configurations["qr"]), TargetFollower(panda)
    start = panda.fk(q)
    for t in np.linspace(0.0, 2 * np.pi, 120):
        goal = (
            start
            @ SE3.from_rpy((0.2 * np.sin(t), 0, 0), (0.1 * np.sin(t), 0.1 * (1 - np.cos(t)), 0)).matrix()
        )
        after = follower.step(q, goal).q
        assert np.abs(panda.fk(after) - goal).max() < 1e-8
        assert np.abs(after - q).max() < 0.1  # redundant, and yet no wandering
        q = after


def test_a_far_target_is_reached_in_strides(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    goal = SE3.rz(1.5).matrix() @ panda.fk(q)
    np.testing.assert_allclose(panda.fk(rest(panda, q, goal)), goal, atol=1e-8)


@pytest.mark.parametrize("place", [(3.0, 0.0, 0.5), (0.0, -2.0, 1.0), (-5.0, 5.0, 5.0), (0.0, 0.0, 0.0)])
def test_where_it_cannot_reach_it_comes_nearer_and_rests(panda: ulna.Robot, place: tuple[float, ...]) -> None:
    q = np.array(panda.configurations["qr"])
    goal = panda.fk(q)
    goal[:3, 3] = place
    end = rest(panda, q, goal)
    before, after = (np.linalg.norm(panda.fk(x)[:3, 3] - place) for x in (q, end))
    assert after < before
    np.testing.assert_allclose(TargetFollower(panda).step(end, goal).q, end, atol=1e-6)


def test_dragged_out_and_back_it_is_on_the_target_again(panda: ulna.Robot) -> None:
    q, follower = np.array(panda.configurations["qr"]), TargetFollower(panda)
    start = panda.fk(q)
    for t in np.linspace(0.0, np.pi, 200):
        goal = start.copy()
        goal[0, 3] += 0.8 * np.sin(t)
        after = follower.step(q, goal).q
        assert np.abs(after - q).max() <= STRIDE + 1e-12
        q = after
    np.testing.assert_allclose(panda.fk(rest(panda, q, start)), start, atol=1e-8)


def test_at_the_goal_it_stands_still(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    step = TargetFollower(panda).step(q, panda.fk(q))
    assert step.converged
    np.testing.assert_allclose(step.q, q, atol=1e-9)


def test_a_joint_at_its_limit_hands_over_to_the_others(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    q[0] = panda.limits.upper[0]
    goal = SE3.rz(0.1).matrix() @ panda.fk(q)  # the base joint alone would do it, and cannot
    np.testing.assert_allclose(panda.fk(rest(panda, q, goal)), goal, atol=1e-8)


def test_an_arm_of_two_joints_follows_as_far_as_it_can() -> None:
    builder = ModelBuilder("planar")
    for name in ("base", "upper", "fore", "tip"):
        builder.add_link(name)
    builder.add_joint("a", Revolute((0, 0, 1)), "base", "upper", lower=-3.0, upper=3.0)
    builder.add_joint("b", Revolute((0, 0, 1)), "upper", "fore", SE3.trans(1, 0, 0), lower=-3.0, upper=3.0)
    builder.add_joint("end", Fixed(), "fore", "tip", SE3.trans(1, 0, 0))
    robot = ulna.Robot(builder.build())
    goal = robot.fk([0.6, -0.9])
    end = rest(robot, np.array([0.3, -0.5]), goal)
    np.testing.assert_allclose(robot.fk(end), goal, atol=1e-6)
