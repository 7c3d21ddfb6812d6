"""Plans that move some joints only: links that stay as they are count by their real shapes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.geometry import Box, Sphere
from ulna.planning import PathConstraint, Planner, Region
from ulna.planning.still_links import divided_pairs
from ulna.spatial import SE3

LINK = (
    '<link name="{0}"><collision><origin xyz="{1}"/><geometry><box size="{2}"/></geometry></collision></link>'
)
JOINT = (
    '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="{3}"/><axis xyz="{4}"/>'
    '<limit lower="-2" upper="2" effort="1" velocity="1"/>{5}</joint>'
)


def robot(gap: float = 0.004, follower: str = "") -> Any:
    """Two plates that hang side by side, each on three joints, and an arm above; `follower` has a joint follow the arm."""
    parts = [LINK.format("base", "0 0 0.5", "0.05 0.05 0.05")]
    for name, side in (("left", 1.0), ("right", -1.0)):
        parents = ["base", f"{name}_1", f"{name}_2", f"{name}_plate"]
        parts += [f'<link name="{n}"/>' for n in parents[1:3]]
        parts += [LINK.format(parents[3], f"0 {side * (gap / 2 + 0.01)} -0.2", "0.3 0.02 0.3")]
        for k, axis in enumerate(("1 0 0", "0 1 0", "0 0 1")):
            mimic = follower if (name, k) == ("right", 0) else ""
            parts += [JOINT.format(f"{name}_joint_{k}", parents[k], parents[k + 1], "0 0 0", axis, mimic)]
    parts += [LINK.format("arm", "0.2 0 0", "0.4 0.04 0.04")]
    parts += [JOINT.format("turn", "base", "arm", "0 0 0.6", "0 0 1", "")]
    return ulna.load(f'<robot name="plates">{"".join(parts)}</robot>')


def goal_of(arm: Any, angle: float = 1.2) -> Any:
    q = np.zeros(arm.model.nq)
    q[arm.model.joint("turn").idx_q] = angle
    return q


def test_links_that_only_seem_to_touch_do_not_stop_the_arm() -> None:
    arm = robot()
    q0, goal = np.zeros(arm.model.nq), goal_of(arm)
    refused = arm.plan(q0, goal, method="spheres")
    assert refused.outcome == "start" and "plate" in refused.reason
    plan = arm.plan(q0, goal, joints=["turn"])
    assert plan and plan.is_certified
    assert not arm.collides(np.linspace(q0, goal, 50)).any()
    constraint = PathConstraint("arm", Region(np.eye(4), (np.inf, np.inf, np.inf), "z"))
    assert arm.plan(q0, goal, joints=["turn"], constraints=constraint).is_certified


def test_obstacles_count_as_before() -> None:
    arm = robot()
    q0, goal = np.zeros(arm.model.nq), goal_of(arm)
    world = World().add("ball", Sphere(0.05), (0.3, 0.2, 0.6))
    plan = arm.plan(q0, goal, world, joints=["turn"], iterations=300)
    assert plan.outcome == "iterations"  # one joint cannot go around it
    blocked = arm.plan(q0, goal, World().add("box", Box((0.1, 0.1, 0.1)), (0.3, 0.0, 0.6)), joints=["turn"])
    assert blocked.outcome == "start" and "'arm'" in blocked.reason and "'box'" in blocked.reason


@pytest.mark.parametrize(("gap", "margin"), [(-0.002, 0.0), (0.004, 0.006), (0.0, 0.0)])
def test_links_that_do_touch_or_are_nearer_than_the_margin_are_refused(gap: float, margin: float) -> None:
    arm = robot(gap)
    plan = arm.plan(np.zeros(arm.model.nq), goal_of(arm), joints=["turn"], margin=margin)
    assert plan.outcome == "start" and "plate" in plan.reason


def test_links_that_follow_the_joints_count_by_their_spheres() -> None:
    arm = robot(follower='<mimic joint="turn" multiplier="0.1"/>')
    plan = arm.plan(np.zeros(arm.model.nq), goal_of(arm), joints=["turn"], method="spheres")
    assert plan.outcome == "start" and "plate" in plan.reason
    still = np.ones(arm.model.nq, dtype=bool)
    still[arm.model.joint("turn").idx_q] = False
    pairs = (("left_plate", "right_plate"), ("left_plate", "base"), ("right_plate", "arm"))
    assert divided_pairs(arm.model, pairs, tuple(still.tolist())) == (pairs[1:2], (pairs[0], pairs[2]))


def test_attached_objects_that_stay_count_by_their_real_shapes() -> None:
    arm = robot()
    q0, goal = np.zeros(arm.model.nq), goal_of(arm)
    far = World().add("ball", Sphere(0.02), (3.0, 0.0, 0.0))
    on_arm = far.attach("can", "arm", SE3.from_translation((0.45, 0.0, 0.0)), shape=Sphere(0.02))
    assert arm.plan(q0, goal, on_arm, joints=["turn"]).is_certified

    for y, is_free in (
        (0.01, True),
        (0.006, False),
    ):  # a board on one plate, 2 mm from the other one, or in it
        pose = SE3.from_translation((0.0, y, -0.2))
        board = on_arm.attach(
            "board", "left_plate", pose, shape=Box((0.2, 0.02, 0.2)), touches=["left_plate"]
        )
        plan = arm.plan(q0, goal, board, joints=["turn"])
        assert bool(plan) is is_free
        assert is_free or plan.outcome == "start"


def test_attached_objects_are_checked_against_what_moves() -> None:
    arm = robot()
    q0 = np.zeros(arm.model.nq)
    post = World().attach(
        "post", "left_plate", (0.25, 0.25, 0.3), shape=Box((0.04, 0.04, 0.8)), touches=["left_plate"]
    )
    plan = arm.plan(q0, goal_of(arm), post, joints=["turn"], iterations=300)
    assert plan.outcome == "iterations"  # the arm cannot turn past the post
    assert arm.plan(q0, goal_of(arm, -1.2), post, joints=["turn"]).is_certified


@pytest.mark.parametrize(("distance", "is_free"), [(0.001, True), (0.01, False)])
def test_margins_of_pairs_that_stay_are_kept_by_their_real_shapes(distance: float, is_free: bool) -> None:
    arm = robot()
    world = World().set_margin("left_plate", "right_plate", distance)
    plan = arm.plan(np.zeros(arm.model.nq), goal_of(arm), world, joints=["turn"])
    assert bool(plan) is is_free and (is_free or (plan.outcome == "start" and "plate" in plan.reason))


def test_a_planner_finds_the_same_path_each_time() -> None:
    arm = robot()
    planner = Planner(arm)
    q0, goal = np.zeros(arm.model.nq), goal_of(arm)
    first, again = (planner.plan(q0, goal, joints=["turn"]) for _ in range(2))
    np.testing.assert_array_equal(first.points, again.points)
    both = planner.plan_all(q0, [goal, goal_of(arm, -1.0)], joints=["turn"], threads=2)
    assert all(plan.is_certified for plan in both)
