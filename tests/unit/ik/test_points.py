"""Points and rotations alone as goals of inverse kinematics, and what is said of shapes that are no goals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.errors import InputError, NonFiniteError, ShapeError
from ulna.geometry import Box
from ulna.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return ulna.load("panda")


@pytest.fixture(scope="module")
def T(robot: Robot) -> Any:
    return robot.fk(robot.configurations["qr"])


def test_a_point_is_a_goal_where_positions_alone_count(robot: Robot, T: Any) -> None:
    p = T[:3, 3] + [0.05, 0.02, -0.03]
    found = robot.ik(p.tolist(), mask="position")
    assert found.success
    np.testing.assert_allclose(robot.fk(found.q)[:3, 3], p, atol=1e-6)
    goal = T.copy()
    goal[:3, 3] = p
    np.testing.assert_array_equal(found.q, robot.ik(goal, mask="position").q)
    near = robot.ik(p, robot.configurations["qz"], mask=[1, 1, 1, 0, 0, 0])
    np.testing.assert_allclose(robot.fk(near.q)[:3, 3], p, atol=1e-6)
    assert robot.ik_classic(p, mask="position").success


@pytest.mark.parametrize("batch", [(5,), (2, 3), (300,), (2, 300)])
def test_points_come_in_batches(robot: Robot, T: Any, batch: tuple[int, ...]) -> None:
    p = T[:3, 3] + np.random.default_rng(0).uniform(-0.05, 0.05, (*batch, 3))
    found = robot.ik(p, mask="position")
    assert found.q.shape == (*batch, 7) and found.success.all()
    np.testing.assert_allclose(robot.fk(found.q)[..., :3, 3], p, atol=2e-6)


def test_a_rotation_is_a_goal_where_it_alone_counts(robot: Robot, T: Any) -> None:
    found = robot.ik(T[:3, :3], mask="rotation")
    assert found.success
    np.testing.assert_allclose(robot.fk(found.q)[:3, :3], T[:3, :3], atol=1e-5)
    with pytest.raises(InputError, match="not a rotation"):
        robot.ik(2.0 * T[:3, :3], mask="rotation")


def test_several_frames_with_points(robot: Robot, T: Any) -> None:
    elbow = robot.fk(robot.configurations["qr"], "panda_link4")
    goals = {"panda_hand_tcp": T[:3, 3], "panda_link4": elbow[:3, 3]}
    for found in (
        robot.ik(goals, mask="position"),
        robot.ik(np.stack(list(goals.values())), frame=list(goals), mask="position"),
    ):
        assert found.success
        np.testing.assert_allclose(robot.fk(found.q)[:3, 3], T[:3, 3], atol=1e-6)
    mixed = robot.ik({"panda_hand_tcp": T, "panda_link4": elbow[:3, 3]}, mask={"panda_link4": "position"})
    assert mixed.success
    with pytest.raises(ShapeError, match=r"`T\['panda_link4'\]` has shape \(3,\).*mask=\"position\""):
        robot.ik({"panda_hand_tcp": T, "panda_link4": elbow[:3, 3]})


@pytest.mark.parametrize(
    ("goal", "advice"),
    [
        ([0.4, 0.0, 0.4], "SE3.from_translation"),
        ([[0.4, 0.0, 0.4]] * 5, "SE3.from_translation"),
        (np.eye(3), "SE3.from_rotation"),
        ([0.4, 0, 0.4, 0, 0, 0, 1], r"SE3.from_quat_xyzw\(T\[3:\], T\[:3\]\)"),
        ([0.4, 0, 0.4, 0, 0, 0], r"SE3.from_rpy\(T\[3:\], T\[:3\]\)"),
        ([1.0, 2.0], r"expected \(..., 4, 4\)."),
    ],
)
def test_shapes_that_are_no_goal_are_answered_with_a_way_to_make_one(
    robot: Robot, goal: Any, advice: str
) -> None:
    for call in (robot.ik, robot.ik_classic):
        with pytest.raises(ShapeError, match=advice):
            call(goal)
    with pytest.raises(ShapeError):
        robot.ik(goal, mask="position+z")


def test_points_are_checked(robot: Robot) -> None:
    with pytest.raises(NonFiniteError, match=r"`T\[0\]` is nan"):
        robot.ik([np.nan, 0.0, 0.5], mask="position")
    with pytest.raises(ShapeError, match="q0"):
        robot.ik([[0.4, 0.0, 0.4]] * 3, np.zeros((2, 7)), mask="position")


@pytest.mark.parametrize(
    ("pose", "advice"),
    [
        ([0, 0, 0, 0, 0, 0, 1], "SE3.from_quat_xyzw"),
        ([0, 0, 0, 0, 0, 0], "SE3.from_rpy"),
        (np.eye(3), "SE3.from_rotation"),
        ([1, 2], r"expected an SE3, \(4, 4\), or a position"),
    ],
)
def test_poses_of_obstacles_likewise(pose: Any, advice: str) -> None:
    with pytest.raises(ShapeError, match=f"pose of obstacle 'b'.*{advice}"):
        World().add("b", Box((1, 1, 1)), pose)
    with pytest.raises(ShapeError, match=advice):
        World().add("b", Box((1, 1, 1))).move("b", pose)


@pytest.mark.parametrize("second", ["position+z", "z", "rotation"])
def test_points_are_no_goals_where_a_rotation_of_one_frame_counts(robot: Robot, second: str) -> None:
    frames = ["panda_link5", "panda_hand"]
    p = np.stack([robot.fk(robot.configurations["qr"], frame)[:3, 3] for frame in frames])
    assert robot.ik(p, robot.configurations["qr"], frames, mask="position").success
    with pytest.raises(ShapeError, match=r"`T` has shape \(2, 3\); expected \(..., 2, 4, 4\)"):
        robot.ik(p, robot.configurations["qr"], frames, mask=["position", second])
