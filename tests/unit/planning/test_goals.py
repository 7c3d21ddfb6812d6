"""Goals of planning: poses, regions, several frames, and subsets of joints."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.geometry import Box, Geometry, Sphere
from ulna.model import ModelBuilder, Prismatic, Revolute
from ulna.planning import Region, plan, planner
from ulna.planning.goals import goal_configurations
from ulna.spatial import SE3


@cache
def panda() -> Any:
    return ulna.load("panda")


def down(x: float, y: float, z: float) -> Any:
    T = np.diag([1.0, -1.0, -1.0, 1.0])
    T[:3, 3] = x, y, z
    return T


def ready() -> Any:
    return panda().configurations["ready"]


def test_regions_hold_the_frame_where_it_ends() -> None:
    robot, q0 = panda(), ready()
    point = Region((0.4, 0.2, 0.5), turns="any")
    for frame in (None, "panda_link7"):
        p = plan(robot, q0, point, frame=frame)
        assert p and p.is_certified
        np.testing.assert_allclose(robot.fk(p.points[-1], frame)[:3, 3], [0.4, 0.2, 0.5], atol=2e-6)
    tilted = SE3.from_matrix(down(0.45, 0.1, 0.4)) @ SE3.from_rpy([0.2, 0.1, 0.3])
    box = Region(tilted, (0.2, 0.1, 0.0), "z")
    found = goal_configurations(robot, box, None, q0, 0).configurations
    local = tilted.inverse().matrix() @ robot.fk(found)
    assert len(found) > 5 and (np.abs(local[:, :3, 3]) <= np.array([0.1, 0.05, 0.0]) + 2e-6).all()
    assert np.ptp(local[:, 0, 3]) > 0.05  # they fill the box
    np.testing.assert_allclose(local[:, :3, 2], np.tile([0.0, 0.0, 1.0], (len(found), 1)), atol=1e-5)
    assert np.ptp(local[:, 0, 0]) > 0.1  # and turn
    still = goal_configurations(robot, Region(tilted, (0.2, 0.1, 0.1)), None, q0, 0).configurations
    turned = (tilted.inverse().matrix() @ robot.fk(still))[:, :3, :3]
    np.testing.assert_allclose(turned, np.tile(np.eye(3), (len(still), 1, 1)), atol=1e-5)
    order = np.linalg.norm(found - q0, axis=1)
    assert (np.diff(order) >= 0.0).all()


def test_one_of_several_goals_is_reached_and_named() -> None:
    robot, q0 = panda(), ready()
    p = plan(robot, q0, [SE3.from_matrix(down(5.0, 0.0, 0.0)), Region(down(0.5, 0.2, 0.4), turns="z")])
    assert p and p.goal == 1
    p = plan(robot, q0, np.stack([down(0.5, 0.3, 0.4), down(9.0, 0.0, 0.0)]))
    assert p and p.goal == 0
    p = plan(robot, q0, [down(0.4, 0.1, 0.5), SE3.from_matrix(down(9.0, 0.0, 0.0))])
    assert p and p.goal == 0
    assert plan(robot, q0, Region((9.0, 0.0, 0.0), turns="any")).outcome == "unreachable"


def test_joints_that_may_not_move_stay() -> None:
    robot, q0 = panda(), ready() + 0.01
    moving = ["panda_joint1", "panda_joint4", "panda_joint6"]
    still = [1, 2, 4, 6]
    p = plan(robot, q0, Region(robot.fk(q0)[:3, 3] + [0.0, 0.05, 0.1], turns="any"), joints=moving)
    assert p and p.is_certified and (p.points[:, still] == q0[still]).all()
    goal = q0.copy()
    goal[[0, 3]] += [1.4, 0.3]
    from ulna.collision import World

    world = World().add("post", Box((0.04, 0.04, 0.65)), (0.34, 0.23, 0.32))
    p = plan(robot, q0, goal, world, joints=moving)
    assert p.outcome in ("solved", "time") and (p.points[:, still] == q0[still]).all()
    with pytest.raises(InputError, match="for joint 'panda_joint2', which is at .* not among `joints`"):
        plan(robot, q0, q0 + 0.1, joints=moving)
    with pytest.raises(UnknownName, match="panda_joint1"):
        plan(robot, q0, q0, joints=["panda_joint11"])
    with pytest.raises(InputError, match="expected a list of names"):
        plan(robot, q0, q0, joints="panda_joint1")


def two_arms() -> Any:
    """Two arms of four joints side by side on a sliding base; a finger follows another."""
    b = (
        ModelBuilder("two arms")
        .add_link("floor")
        .add_link("base", collisions=[Geometry("", Box((0.2, 0.6, 0.1)))])
    )
    b.add_joint("slide", Prismatic((1.0, 0.0, 0.0)), "floor", "base", lower=-1.0, upper=1.0)
    for side, y in (("left", 0.25), ("right", -0.25)):
        parent, place = "base", SE3.from_translation([0.0, y, 0.1])
        for k, axis in enumerate([(0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)]):
            link = f"{side}{k}"
            shape = Geometry("", Box((0.04, 0.04, 0.2)), SE3.from_translation([0.0, 0.0, 0.14]))
            b.add_link(link, collisions=[shape])
            b.add_joint(f"{side}_j{k}", Revolute(axis), parent, link, place, lower=-2.5, upper=2.5)
            parent, place = link, SE3.from_translation([0.0, 0.0, 0.28])
    tip = Geometry("", Sphere(0.02), SE3.from_translation([0.0, 0.0, 0.03]))
    for name, y in (("thumb", 0.03), ("finger", -0.03)):
        b.add_link(name, collisions=[tip])
        where = SE3.from_translation([0.0, y, 0.27])
        mimic = {} if name == "thumb" else {"mimic": ("thumb_j", -1.0, 0.0)}
        b.add_joint(
            f"{name}_j", Revolute((1.0, 0.0, 0.0)), "left3", name, where, lower=-0.5, upper=0.5, **mimic
        )
    return ulna.Robot(b.build())


def test_two_arms_on_a_sliding_base_reach_two_poses() -> None:
    robot = two_arms()
    q0 = np.zeros(robot.nq)
    reached = robot.random_configuration(seed=3)
    goal = {name: robot.fk(reached, name)[:3, 3] for name in ("left3", "right3")}
    poses = {name: Region(robot.fk(reached, name), turns="x") for name in goal}
    p = plan(robot, q0, reached) if not robot.collides(reached) else None
    assert p is None or p.is_certified
    found = goal_configurations(robot, poses, None, q0, 0).configurations
    for q in found:
        for name, T in poses.items():
            np.testing.assert_allclose(robot.fk(q, name)[:3, [0, 3]], T.pose.matrix()[:3, [0, 3]], atol=1e-5)
    assert len(found)
    # a goal for one arm leaves the other where it is
    one = goal_configurations(robot, Region(goal["left3"], turns="any"), "left3", q0, 0).configurations
    right = [j.idx_q for j in robot.model.joints if j.name.startswith("right")]
    assert len(one) and (one[:, right] == 0.0).all()
    with pytest.raises(InputError, match="expected one of them"):
        plan(robot, q0, poses, frame="left3")


def test_many_joints_are_planned_for() -> None:
    b = ModelBuilder("snake").add_link("l0")
    for k in range(60):
        shape = Geometry("", Box((0.02, 0.02, 0.06)), SE3.from_translation([0.0, 0.0, 0.05]))
        b.add_link(f"l{k + 1}", collisions=[shape] if k % 3 == 0 else [])
        axis = (1.0, 0.0, 0.0) if k % 2 else (0.0, 1.0, 0.0)
        b.add_joint(
            f"j{k}",
            Revolute(axis),
            f"l{k}",
            f"l{k + 1}",
            SE3.from_translation([0, 0, 0.1]),
            lower=-1,
            upper=1,
        )
    robot = ulna.Robot(b.build())
    from ulna.collision import World

    goal = np.full(60, 0.02)
    world = World().add("ball", Sphere(0.05), robot.fk(goal / 2.0, "l40")[:3, 3])
    p = plan(robot, np.zeros(60), goal, world, timeout=600)
    assert p and p.is_certified
    t = np.linspace(0.0, 1.0, 30)[:, None]
    for x, y in zip(p.points, p.points[1:], strict=False):
        assert not robot.collides(x + t * (y - x), world).any()


def test_the_limit_of_time_ends_inverse_kinematics_too() -> None:
    robot = ulna.load("panda")
    q, far = robot.configurations["ready"], [Region((3.0 + k, 0.0, 0.0), turns="any") for k in range(50)]
    p = plan(robot, q, far, timeout=0.0)
    assert p.outcome == "time" and "no configuration was found for the pose within 0 s" in p.reason
    assert plan(robot, q, far[:1], timeout=np.inf).outcome == "unreachable"
    near = [SE3.from_matrix(robot.fk(q)) @ SE3.trans(0.0, 0.0, 0.001 * k) for k in range(50)]
    assert plan(robot, q, near, timeout=0.0).goal in (0, 1)  # those for which there was time
    every, some = (goal_configurations(robot, near, None, q, 0, None, seconds) for seconds in (np.inf, 0.0))
    assert len(some.numbers) < 10 < len(every.numbers) and some.is_late and not every.is_late


def test_arrays_of_the_caller_may_change_meanwhile(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = panda()
    start = ready() + 0.01
    given = start.copy()

    def slow(*arguments: Any) -> Any:
        given[:] += 0.1  # as a control loop does that writes the newest state into one array
        return goal_configurations(*arguments)

    monkeypatch.setattr(planner, "goal_configurations", slow)
    p = plan(robot, given, Region((0.4, 0.2, 0.5), turns="any"))
    assert p.is_certified and (p.points[0] == start).all()


def test_regions_do_not_change_with_the_matrix_they_were_made_of() -> None:
    T, pose, size = down(0.4, 0.1, 0.5), SE3.from_matrix(down(0.4, 0.1, 0.5)), np.ones(3)
    regions = Region(T, size), Region(pose, size)
    T[:3, 3], size[:] = 9.0, 9.0
    pose.translation[:] = 9.0
    for region in regions:
        assert region.pose.translation.tolist() == [0.4, 0.1, 0.5] and (region.size == 1.0).all()


def test_invalid_goals_are_refused() -> None:
    robot, q0 = panda(), ready()
    for make, error, text in [
        (lambda: Region(np.zeros(7)), ShapeError, "SE3"),
        (lambda: Region((0, 0, 0), (1, -1, 0)), InputError, "three edges"),
        (lambda: Region((0, 0, 0), turns="w"), UnknownName, "'any'"),  # type: ignore[arg-type]
        (lambda: plan(robot, q0, [SE3.identity(), np.zeros(3)]), ShapeError, r"is Region\(position, turns"),
        (lambda: plan(robot, q0, {"panda_hand": np.zeros(3)}), ShapeError, r"is Region\(position, turns"),
        (lambda: plan(robot, q0, np.zeros(3)), ShapeError, r"is Region\(position, turns"),
        (lambda: plan(robot, q0, np.diag([2.0, 2, 2, 1])), InputError, "`goal` is not a rotation"),
        (
            lambda: plan(robot, q0, [np.diag([1.0, 1, -1, 1]), SE3.identity()]),
            InputError,
            "`goal` .* reflection",
        ),
        (
            lambda: plan(robot, q0, {"panda_hand": np.diag([1.0, 1, 1, 2])}),
            InputError,
            "`goal` has the last row",
        ),
        (lambda: plan(robot, q0, Region((0, 0, 0)), frame="panda_hnd"), UnknownName, "panda_hand"),
        (lambda: plan(robot, q0, {"panda_hnd": np.eye(4)}), UnknownName, "panda_hand"),
        (lambda: plan(robot, q0, np.zeros((0, 7))), ShapeError, "goal"),
        (lambda: plan(robot, q0, q0, seed=-1), InputError, "`seed` is -1"),
        (lambda: plan(robot, q0, q0, iterations=2.5), InputError, "`iterations` is 2.5"),  # type: ignore[arg-type]
        (lambda: plan(robot, q0, q0, shorten=1.5), InputError, "`shorten` is 1.5"),  # type: ignore[arg-type]
    ]:
        with pytest.raises(error, match=text):
            make()
