"""Which joints planning takes, and how far it lets them move things."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from ulna.algorithms import joint_poses
from ulna.collision import World
from ulna.collision.lanes.motion_bounds import Group, motion_bounds
from ulna.errors import InputError
from ulna.geometry import Box, Cylinder, Geometry
from ulna.model import (
    Continuous,
    Cylindrical,
    Helical,
    ModelBuilder,
    Planar,
    Prismatic,
    Rolling,
    Translation,
    Universal,
)
from ulna.model.joints.joint_kind import JointKind
from ulna.planning import plan
from ulna.spatial import SE3


def robot_of(first: JointKind, second: JointKind, **limits: Any) -> ulna.Robot:
    """A cart on the first joint, and a beam on the second."""
    beam = Geometry("", Box((0.4, 0.1, 0.1)), SE3.from_translation([0.2, 0.0, 0.2]))
    b = ModelBuilder("two").add_link("base").add_link("cart", collisions=[Geometry("", Box((0.1, 0.1, 0.1)))])
    b.add_link("beam", collisions=[beam])
    b.add_joint("first", first, "base", "cart", **limits)
    b.add_joint("second", second, "cart", "beam", **limits)
    return ulna.Robot(b.build())


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (Helical((0.0, 0.0, 1.0), 0.1), Continuous((0.0, 0.0, 1.0))),
        (Universal((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), Helical((0.0, 1.0, 0.0), -0.2)),
        (Continuous((0.0, 1.0, 0.0)), Translation()),
        (Translation(), Universal((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))),
        (Cylindrical((0.0, 1.0, 0.0)), Cylindrical((1.0, 0.0, 0.0))),
        (Rolling(0.2, 0.1), Rolling(-0.3, 0.1)),
    ],
)
def test_nothing_moves_or_approaches_faster_than_its_bound(first: JointKind, second: JointKind) -> None:
    b = ModelBuilder("two").add_link("base").add_link("a").add_link("b")
    for name, kind, parent, child in (("j1", first, "base", "a"), ("j2", second, "a", "b")):
        one = 1.0 if kind.nq == 1 else np.ones(kind.nq)
        b.add_joint(name, kind, parent, child, SE3.from_translation([0.1, 0.2, 0.3]), lower=-one, upper=one)
    model = b.build()
    random = np.random.default_rng(0)
    groups = [Group(name, k, random.normal(size=(5, 3)), np.full(5, 0.1)) for k, name in enumerate("ab")]
    moves, approaches = motion_bounds(model, groups, [(0, 1)])
    q = random.uniform(-1.0, 1.0, (2000, model.nq))
    r = np.clip(q + random.normal(scale=0.3, size=q.shape), -1.0, 1.0)
    centres = []
    for x in (q, r):
        poses = joint_poses(model, x)
        centres.append([poses[g.joint].matrix()[:, None, :3, :3] @ g.centres[..., None] for g in groups])
        centres[-1] = [
            c[..., 0] + poses[g.joint].translation[:, None] for c, g in zip(centres[-1], groups, strict=True)
        ]
    for k in range(2):
        moved = np.linalg.norm(centres[1][k] - centres[0][k], axis=2).max(axis=1)
        allowed = np.abs(r - q) @ moves[k]
        assert (moved <= allowed + 1e-12).all() and moved.max() > 0.1 * allowed.max()
    apart = [np.linalg.norm(a[:, :, None] - b[:, None], axis=3) for a, b in centres]
    approached = np.abs(apart[1] - apart[0]).max(axis=(1, 2))
    assert (approached <= np.abs(r - q) @ approaches[0] + 1e-12).all()


@pytest.mark.parametrize(
    ("kind", "start", "goal"),
    [
        (Helical((0.0, 0.0, 1.0), 0.05), [-1.0, 0.5], [1.0, -0.5]),
        (Universal((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), [0.0, 0.0, 0.5], [0.4, 0.4, -0.5]),
        (Cylindrical((0.0, 0.0, 1.0)), [0.1, -1.0, 0.5], [-0.1, 1.0, -0.5]),
        (Rolling(0.1, 0.05), [0.2, -1.0], [-0.2, 0.5]),
        (Translation(), [-0.6, 0.0, 0.0, 1.57], [0.6, 0.0, 0.0, 1.57]),
    ],
)
def test_joints_of_plain_numbers_are_planned_for(
    kind: JointKind, start: list[float], goal: list[float]
) -> None:
    robot = robot_of(kind, Continuous((0.0, 0.0, 1.0)))
    world = World().add(
        "post", Cylinder(0.03, 1.0), (0.0, 0.35, 0.0) if len(start) == 4 else (0.35, 0.0, 0.6)
    )
    p = plan(robot, start, goal, world)
    assert p and p.is_certified
    t = np.linspace(0.0, 1.0, 200)[:, None]
    for x, y in zip(p.points, p.points[1:], strict=False):
        assert not robot.collides(x + t * (y - x), world).any()


def test_joints_that_nothing_bounds_are_refused() -> None:
    robot = robot_of(Continuous((0.0, 0.0, 1.0)), Prismatic((1.0, 0.0, 0.0)))
    with pytest.raises(
        InputError, match="'first' turns what slides without limits, so nothing bounds how far 'beam'"
    ):
        plan(robot, [0.0, 0.0], [3.0, 0.0])
    with pytest.raises(InputError, match="planar base of two prismatic joints and a continuous one"):
        plan(robot_of(Planar(), Continuous((0.0, 0.0, 1.0))), np.zeros(4), np.ones(4))
    sliding = robot_of(Prismatic((1.0, 0.0, 0.0)), Continuous((0.0, 0.0, 1.0)))
    assert plan(sliding, [-1.0, 1.57], [1.0, 1.57])  # a sliding base may be without limits
    out = robot_of(Translation(), Continuous((0.0, 0.0, 1.0)))
    limited = (
        ModelBuilder("one").add_link("base").add_link("body", collisions=[Geometry("", Box((0.1, 0.1, 0.1)))])
    )
    limited.add_joint("slide", Translation(), "base", "body", lower=-np.ones(3), upper=np.ones(3))
    p = plan(ulna.Robot(limited.build()), np.zeros(3), [0.0, 0.0, 2.0])
    assert out.nq == 4 and p.outcome == "goal" and "joint 'slide' is at 2, its limits are [-1, 1]" in p.reason


def test_joints_turn_the_whole_way_and_float64_proves_what_float32_cannot_tell() -> None:
    robot = robot_of(Prismatic((1.0, 0.0, 0.0)), Continuous((0.0, 0.0, 1.0)))
    start, goal = (
        np.array([0.0, 1e7]),
        np.array([0.0, 1e7 + 0.9]),
    )  # of float32 numbers there are two between these
    middle = 0.5 * (start + goal)[1]
    post = World().add("post", Cylinder(0.02, 1.0), (0.35 * np.cos(middle), 0.35 * np.sin(middle), 0.0))
    for ends in ((start, goal), (goal, start)):
        assert not plan(robot, *ends, post, iterations=200).is_certified
        assert plan(robot, *ends).is_certified


def test_goals_so_far_away_that_no_motion_can_be_checked_are_left_out() -> None:
    robot = robot_of(Prismatic((1.0, 0.0, 0.0)), Continuous((0.0, 0.0, 1.0)))
    p = plan(robot, [0.0, 0.0], [0.0, 1e9])
    assert p.outcome == "goal" and "joint 'second' is to move by 1e+09, from 0 to 1e+09: too far" in p.reason
    p = plan(robot, [0.0, 0.0], [[1e12, 0.0], [0.0, 2e9], [0.1, 20.0]])
    assert p.is_certified and p.goal == 2 and p.points[-1].tolist() == [0.1, 20.0]
