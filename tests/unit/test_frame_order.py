"""All that lists frames lists them in one order, also where links and joints share names."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna.model import attach
from ulna.spatial import SE3

URDF = """<robot name="twins">
  <link name="base"/>
  <link name="arm"/> <link name="hand"/> <link name="joint:hand"/>
  <joint name="arm" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="hand" type="prismatic"><parent link="arm"/><child link="hand"/><origin xyz="0.5 0 0"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="hand"/><child link="joint:hand"/><origin xyz="0 0.2 0"/></joint>
</robot>"""


@pytest.fixture(scope="module")
def robot() -> ulna.Robot:
    return ulna.load(URDF)


def test_names_places_and_poses_agree(robot: ulna.Robot) -> None:
    model, q = robot.model, np.array([0.3, 0.4])
    assert len(set(robot.frame_names)) == len(robot.frame_names) == len(model.frames)
    poses = robot.fk(q, "all")
    assert poses.shape == (len(model.frames), 4, 4)
    for i, (name, frame) in enumerate(zip(robot.frame_names, model.frames, strict=True)):
        assert model.frame_index(name) == i
        assert model.frame(name) is frame
        np.testing.assert_allclose(poses[i], robot.fk(q, name), atol=1e-15)
        moving = np.eye(4) if frame.joint < 0 else ulna.algorithms.joint_poses(model, q)[frame.joint].matrix()
        np.testing.assert_allclose(poses[i], moving @ frame.placement.matrix(), atol=1e-15)


def test_the_link_keeps_the_name(robot: ulna.Robot) -> None:
    assert robot.frame_names == (
        "base",
        "joint:arm",
        "arm",
        "joint:joint:hand",
        "hand",
        "mount",
        "joint:hand",
    )
    assert robot.model.frame("hand").kind == "link"
    assert robot.model.frame("joint:hand").kind == "link"
    assert robot.model.frame("joint:joint:hand").kind == "joint"


def test_a_tool_that_is_the_frame_of_a_joint_stays_so(robot: ulna.Robot) -> None:
    chosen = robot.with_tool("joint:arm")
    assert np.allclose(chosen.fk([0.3, 0.4]), robot.fk([0.3, 0.4], "joint:arm"))
    both = attach(robot.model, chosen.model, "hand", SE3.identity(), prefix="two_", tool=None)
    assert both.frame(both.tool).name == "two_arm" and both.frame(both.tool).kind == "joint"


def test_two_frames_of_one_name_are_two_goals(robot: ulna.Robot) -> None:
    q = np.array([0.3, 0.4])
    goals = {name: robot.fk(q, name) for name in ("arm", "joint:arm", "hand")}
    solution = robot.ik(goals, mask="pose")
    assert solution.success and np.allclose(solution.q, q, atol=1e-5)


def test_every_robot_of_the_catalogue_has_one_order() -> None:
    for name in ("panda", "panda_fingers", "ur5"):
        robot = ulna.load(name)
        q = robot.random_configuration(seed=2)
        poses = robot.fk(q, "all")
        for k, link in enumerate(robot.link_names):
            place = robot.model.frame_index(link)
            np.testing.assert_allclose(poses[place], robot.link_poses(q)[k], atol=1e-14)
