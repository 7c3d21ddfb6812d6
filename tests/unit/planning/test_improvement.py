"""Shorter paths: how near to the shortest they come, and that they stay proved and repeatable."""

from __future__ import annotations

from itertools import count, pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import LinkSpheres, Spheres, World
from ulna.errors import InputError
from ulna.geometry import Box, Geometry, Sphere
from ulna.model import ModelBuilder, Prismatic
from ulna.planning import Planner, bounded_rrt, plan, scene
from ulna.planning.rrt_connect import EVERYWHERE, FREE_PLACE, Growth
from ulna.planning.samples import informed_samples, samples
from ulna.planning.trees import Trees

RADIUS = 0.1
WALL = World().add("wall", Box((0.2, 1.0, 1.0)), (0.0, -0.5, 0.0))
A, B = np.array([-0.8, -0.4]), np.array([0.8, -0.4])


def ball_on_a_table() -> tuple[ulna.Robot, Spheres]:
    """A ball that slides in x and y."""
    b = ModelBuilder("ball").add_link("base").add_link("cart")
    b.add_link("ball", collisions=[Geometry("", Sphere(RADIUS))])
    for name, parent, child, axis in (("x", "base", "cart", (1, 0, 0)), ("y", "cart", "ball", (0, 1, 0))):
        b.add_joint(name, Prismatic(axis), parent, child, lower=-1.0, upper=1.0)
    return ulna.Robot(b.build()), Spheres({"ball": LinkSpheres(np.zeros((1, 3)), np.array([RADIUS]))})


def shortest_around_the_wall() -> float:
    """The length of the shortest path of the ball's centre from A to B: two tangents and an arc about each corner."""
    corner, start = np.array([-0.1, 0.0]), A
    way = start - corner
    tangent = np.sqrt(way @ way - RADIUS**2)
    turned = np.arctan2(way[1], way[0]) % (2 * np.pi) - np.arccos(RADIUS / np.linalg.norm(way))
    return 2.0 * (tangent + RADIUS * abs(turned - np.pi / 2) + 0.1)


def test_paths_approach_the_shortest_one() -> None:
    robot, spheres = ball_on_a_table()
    planner, shortest = Planner(robot, WALL, spheres=spheres, step=0.002), shortest_around_the_wall()
    lengths = []
    for improve in (0, 500, 4_000, 30_000):
        p = planner.plan(A, B, improve=improve)
        assert p and p.is_certified and p.cost > shortest - 1e-6
        lengths.append(p.cost)
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[-1] < 1.01 * shortest


def test_improvements_fall_and_the_path_is_the_last_one() -> None:
    robot, spheres = ball_on_a_table()
    planner = Planner(robot, WALL, spheres=spheres)
    p, again = (planner.plan(A, B, improve=2_000, seed=4) for _ in range(2))
    np.testing.assert_array_equal(p.points, again.points)
    times, costs = zip(*p.improvements, strict=True)
    assert list(times) == sorted(times) and p.seconds["improve"] > 0.0
    assert all(later < (1.0 - 1e-3) * before for before, later in pairwise(costs))
    assert p.cost == pytest.approx(costs[-1])
    assert p.iterations > 2_000 and planner.plan(A, B).improvements == ()


def test_the_nearest_goal_is_chosen_and_a_straight_way_needs_no_samples() -> None:
    robot, spheres = ball_on_a_table()
    planner = Planner(robot, WALL, spheres=spheres)
    behind, ahead = B, np.array([-0.8, 0.4])
    p = planner.plan(A, np.stack([behind, ahead]), improve=2_000)
    assert p.goal == 1 and len(p.points) == 2 and p.cost == pytest.approx(0.8) and p.iterations <= 2_000
    far_and_free, near_and_hidden = np.array([-0.8, 0.9]), np.array([0.2, 0.2])
    p = planner.plan(A, np.stack([far_and_free, near_and_hidden]), improve=20_000)
    assert p.goal == 1 and p.cost < 1.3


def test_time_limits_and_wrong_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    robot, spheres = ball_on_a_table()
    planner = Planner(robot, WALL, spheres=spheres)
    questions = count()
    clock = SimpleNamespace(
        perf_counter=lambda: 5e-3 * next(questions)
    )  # so that no load of the machine counts
    for module in ("run", "search", "improvement"):
        monkeypatch.setattr(f"ulna.planning.{module}.time", clock)
    p = planner.plan(A, B, improve=10_000_000, timeout=0.1)
    assert p and p.is_certified and p.iterations < 10_000_000 and sum(p.seconds.values()) < 0.5
    monkeypatch.undo()
    for wrong in (-1, 1.5, "many", None):
        with pytest.raises(InputError, match="improve"):
            plan(robot, A, B, WALL, spheres=spheres, improve=wrong)  # type: ignore[arg-type]


def test_joints_that_stay_stay() -> None:
    robot = ulna.load("panda")
    world = World().add("wall", Box((0.3, 0.02, 0.4)), (0.55, 0.0, 0.2))
    q0 = robot.configurations["ready"] + [-0.5, 0, 0, 0, 0, 0, 0]
    goal = q0 + [1.0, 0.4, 0, 0.1, 0, 0, 0]
    p = robot.plan(q0, goal, world, joints=robot.joint_names[:4], improve=500)
    assert p.is_certified and (p.points[:, 4:] == q0[4:]).all()


def test_samples_lie_where_shorter_paths_may_pass() -> None:
    random, low, high = np.random.default_rng(0), np.full(4, -2.0), np.array([2.0, 2.0, 0.5, 2.0])
    a, goals = np.zeros(4), np.array([[1.0, 0.5, 0.0, 0.0], [0.0, 0.0, 0.4, 1.0], [2.0, 2.0, 0.5, 2.0]])
    x = informed_samples(random, 4_000, a, goals, 1.5, low, high).astype(float)
    to_goals = np.linalg.norm(x[:, None] - goals[:2], axis=2).min(axis=1)
    assert (np.linalg.norm(x - a, axis=1) + to_goals < 1.5 + 1e-6).all()
    assert ((low <= x) & (x <= high)).all() and len(np.unique(x[:, 0])) > 3_990
    fixed = informed_samples(
        random, 100, a, goals[:1], 1.5, np.array([-2, -2, 0, -2]), np.array([2, 2, 0, 2])
    )
    assert (fixed[:, 2] == 0.0).all()


def test_samples_where_nothing_may_move() -> None:
    a = np.array([0.3, -0.7])
    x = informed_samples(np.random.default_rng(0), 20, a, np.array([a]), 0.5, a, a)
    assert (x == a.astype(np.float32)).all()


def test_samples_are_within_limits() -> None:
    """Rounding to float32 moves none out: not from the surface of a box, nor where it holds few such numbers."""
    low, high = np.array([0.1, -0.7, 1.0]), np.array([0.9, 0.7, 1.0 + 3e-7])
    drawn = samples(0, 4_000, 3, low, high)
    assert ((low <= drawn) & (drawn <= high)).all() and len(np.unique(drawn[:, 2])) > 2
    low, high = (
        np.array([0.1, 0.7, 1.0]),
        np.array([0.9, 1.1, 1.1]),
    )  # 0.7 is smaller in float32, 1.1 is greater
    far = informed_samples(np.random.default_rng(0), 4_000, low, np.array([high]), 40.0, low, high)
    assert ((low <= far) & (far <= high)).all() and np.isclose(far, high).any(axis=0).all()


@pytest.mark.parametrize("improve", [0, 500])
def test_a_path_is_within_limits_that_float32_cannot_tell(improve: int) -> None:
    """A slide that is fixed at 0.3 m by its limits stays there, to the last bit; float32 is 1.2e-8 m off."""
    b = ModelBuilder("ball").add_link("base").add_link("lift").add_link("cart")
    b.add_link("ball", collisions=[Geometry("", Sphere(RADIUS))])
    b.add_joint("z", Prismatic((0, 0, 1)), "base", "lift", lower=0.3, upper=0.3)
    for name, parent, child, axis in (("x", "lift", "cart", (1, 0, 0)), ("y", "cart", "ball", (0, 1, 0))):
        b.add_joint(name, Prismatic(axis), parent, child, lower=-1.0, upper=1.0)
    robot = ulna.Robot(b.build())
    spheres = Spheres({"ball": LinkSpheres(np.zeros((1, 3)), np.array([RADIUS]))})
    p = plan(robot, [0.3, *A], [0.3, *B], WALL, spheres=spheres, improve=improve)
    assert p.is_certified and len(p.points) > 2
    assert (p.points[:, 0] == 0.3).all()


def test_the_interpreter_grows_the_same_trees() -> None:
    robot, spheres = ball_on_a_table()
    place = scene(robot.collision_checker(WALL, method="spheres", spheres=spheres))
    lanes, results = place.lanes, []
    for how in ("__call__", "checked", "interpret"):
        trees = Trees(
            np.full((2, 2, 256), FREE_PLACE, np.float32), np.full((2, 256), EVERYWHERE, np.float32),
            np.zeros((2, 256), np.float32), np.full((2, 256), -1, np.int64), *np.zeros((2, 2), np.int64),
            *np.zeros((4, 2), np.float32),
        )  # fmt: skip
        random = np.random.default_rng(3)
        drawn = random.uniform(-1, 1, (60, 2)).astype(np.float32)
        arguments: tuple[Any, ...] = (
            place.robot.kernel, place.tables(0.001), Growth._make(map(np.float32, (0.02, 0.5, 1.0, 1.0, 0.0))), drawn,
            random.random(60).astype(np.float32), 0, 60, np.array([A, B], np.float32), np.zeros(2, np.float32), 2, 3.0,
            trees, place.moving.work(),
        )  # fmt: skip
        results.append((getattr(bounded_rrt.grow_below.specialized(W=lanes), how)(*arguments), trees))
    (result, trees), *others = results
    assert result < 0 and trees.counts.sum() > 4
    for other, same in others:
        assert other == result
        for name in ("nodes", "costs", "parents", "counts", "meeting"):
            np.testing.assert_array_equal(getattr(same, name), getattr(trees, name))
    for tree in range(2):  # a cost is the length of the way to the root
        for node in range(trees.counts[tree]):
            total, at = 0.0, node
            while trees.parents[tree, at] >= 0:
                up = trees.parents[tree, at]
                total += np.linalg.norm(trees.nodes[tree, :, at] - trees.nodes[tree, :, up])
                at = up
            assert trees.costs[tree, node] == pytest.approx(total, rel=1e-5)
