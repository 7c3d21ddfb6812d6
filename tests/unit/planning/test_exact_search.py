"""Planning with method="exact": among the real shapes, for what passes closer than spheres allow."""

from __future__ import annotations

import itertools
import pickle
from functools import cache
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import Checker, World
from ulna.collision.segment import first_contact_along
from ulna.errors import InputError, UnknownName
from ulna.geometry import Box, Geometry, Sphere
from ulna.model import Continuous, FreeFlyer, ModelBuilder, Revolute
from ulna.planning import PathConstraint, Planner, Region, plan
from ulna.typing import Floats

pytest.importorskip("coal")

POST = World().add("post", Box((0.1, 0.1, 0.6)), (0.5, 0.1, 0.4))


@cache
def ur5() -> Any:
    return ulna.load("ur5")


def free(world: World | None, count: int, seed: int = 0) -> Floats:
    q = ur5().random_configuration(4 * count, seed=seed)
    return q[~np.asarray(ur5().collides(q, world))][:count]


def between(points: Floats) -> Floats:
    """States on the straight motions of a path, 0.02 rad apart at most."""
    parts = []
    for a, b in itertools.pairwise(points):
        parts.append(np.linspace(a, b, 2 + int(np.linalg.norm(b - a) / 0.02)))
    return np.concatenate(parts)


def check(p: Any, a: Floats, b: Floats, world: World | None) -> None:
    assert p and p.success and p.is_certified and p.certificate.unproved == ()
    assert (p.points[0] == a).all() and (p.points[-1] == b).all()
    states = between(p.points)
    assert not np.asarray(ur5().collides(states, world)).any()
    assert (states >= ur5().limits.lower).all() and (states <= ur5().limits.upper).all()


def test_links_that_pass_closer_than_their_spheres_are_planned_for() -> None:
    ends = free(None, 12)
    pairs = list(zip(ends[::2], ends[1::2], strict=True))
    spheres = ur5().collision.spheres()
    refused = [not plan(ur5(), a, b, spheres=spheres, timeout=2.0) for a, b in pairs]
    assert sum(refused) > 3 > sum(not plan(ur5(), a, b) for a, b in pairs)  # with tables fewer
    for a, b in pairs:
        check(plan(ur5(), a, b, method="exact", timeout=np.inf), a, b, None)


def test_the_message_of_spheres_names_the_method() -> None:
    ends = free(None, 12)
    spheres = ur5().collision.spheres()
    reasons = [plan(ur5(), a, b, spheres=spheres).reason for a, b in zip(ends[::2], ends[1::2], strict=True)]
    assert any('plan with method="exact"' in reason for reason in reasons)


@pytest.mark.parametrize("seed", range(3))
def test_paths_go_around_obstacles(seed: int) -> None:
    a, b = free(POST, 2, seed)
    p = ur5().plan(a, b, POST, method="exact", seed=seed, timeout=np.inf)
    check(p, a, b, POST)
    motion = p.trajectory(acceleration=5.0)
    states = motion.q(np.linspace(0.0, motion.duration, 1000))
    assert not np.asarray(ur5().collides(states, POST)).any()


def test_the_same_seed_returns_the_same_path() -> None:
    a, b = free(POST, 2, 1)
    planner = Planner(ur5(), POST, method="exact")
    first = planner.plan(a, b, timeout=np.inf, keep_tree=True)
    again = pickle.loads(pickle.dumps(planner)).plan(a, b, timeout=np.inf)
    assert (first.points == again.points).all()
    raw = planner.plan(a, b, timeout=np.inf, shorten=0)
    check(raw, a, b, POST)
    assert first.cost <= raw.cost + 1e-9
    assert first.tree is not None and len(first.tree) == first.nodes
    moved = np.abs(np.diff(first.tree.nodes[first.tree.edges], axis=1)).max()
    assert 0.0 < moved <= 1.0 + 1e-12


def test_the_margin_is_kept() -> None:
    a, b = np.array([0.3, -1.6, 1.6, -1.6, -1.6, 0.0]), np.array([-0.6, -1.6, 1.6, -1.6, -1.6, 0.0])
    for margin in (0.0, 0.01):
        p = plan(ur5(), a, b, POST, method="exact", margin=margin, timeout=np.inf)
        check(p, a, b, POST)
        assert np.asarray(ur5().distance(between(p.points), POST).distance).min() > margin
        assert p.certificate is not None and p.certificate.clearance == margin


def test_some_joints_stay_and_goals_are_of_every_kind() -> None:
    a = ur5().configurations["ready"]
    goals = a + np.array([[0.0] * 6, [0.0, 0.3, 0.0, 0.0, 0.0, 0.0]])[::-1] + [0.0, 0.0, 0.1, 0.0, 0.0, 0.0]
    p = plan(ur5(), a, goals, method="exact")
    assert p and (p.points[-1] == goals[p.goal]).all()
    T = ur5().fk(goals[0])
    reached = plan(ur5(), a, T, method="exact")
    np.testing.assert_allclose(ur5().fk(reached.points[-1]), T, atol=1e-5)
    names = ur5().joint_names
    still = plan(ur5(), a, Region(T[:3, 3], turns="any"), joints=names[:4], method="exact")
    assert still and (still.points[:, 4:] == a[4:]).all()
    same = plan(ur5(), a, a, method="exact")
    assert same and len(same.points) == 1


def test_failures_say_what_stands_in_the_way() -> None:
    a = ur5().configurations["ready"]
    around = World().add("ball", Sphere(0.1), ur5().fk(a)[:3, 3])
    p = plan(ur5(), a, a + 0.1, around, method="exact")
    assert not p and p.outcome == "start" and "overlaps 'ball' by" in p.reason and p.certificate is None
    p = plan(ur5(), a + 1.0, a, around, method="exact")
    assert p.outcome == "goal" and "at the goal" in p.reason
    p = plan(ur5(), a, np.full(6, 9.0), method="exact")
    assert p.outcome == "goal" and "'shoulder_pan_joint' is at 9" in p.reason
    assert plan(ur5(), a, Region((9.0, 0.0, 0.0), turns="any"), method="exact").outcome == "unreachable"
    b, c = free(POST, 2, 1)
    assert plan(ur5(), b, c, POST, method="exact", timeout=0.0).outcome == "time"
    assert (
        "within 1 samples"
        in plan(ur5(), b, c, POST, method="exact", iterations=1, seed=5, timeout=np.inf).reason
    )


def test_what_has_no_effect_is_refused() -> None:
    a = ur5().configurations["ready"]
    constraint = PathConstraint.pointing("tool0", (0, 0, -1))
    for options in (
        {"spheres": ur5().collision.spheres()},
        {"step": 0.02},
        {"improve": 10},
        {"constraints": constraint},
    ):
        with pytest.raises(InputError, match=f"takes no `{next(iter(options))}`"):
            plan(ur5(), a, a + 0.1, method="exact", **options)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="takes no `roadmap`"):
        Planner(ur5(), method="exact", roadmap=100)
    with pytest.raises(UnknownName, match="No method named 'exakt'. Did you mean 'exact'"):
        plan(ur5(), a, a + 0.1, method="exakt")  # type: ignore[arg-type]


def test_free_flyers_are_refused() -> None:
    builder = ModelBuilder("flying")
    cube = Geometry("cube", Box((0.1, 0.1, 0.1)))
    builder.add_link("body", collisions=[cube])
    builder.root_joint(FreeFlyer())
    builder.add_link("arm", collisions=[cube])
    builder.add_joint("turn", Revolute((0.0, 0.0, 1.0)), "body", "arm", lower=-1.0, upper=1.0)
    robot = ulna.Robot(builder.build())
    with pytest.raises(InputError, match="is FreeFlyer; planning takes joints whose positions are plain"):
        plan(robot, robot.random_configuration(seed=0), robot.random_configuration(seed=1), method="exact")


def turntable() -> Any:
    beam = Geometry("", Box((0.4, 0.05, 0.05)), ulna.SE3.trans(0.3, 0.0, 0.0))
    b = ModelBuilder("turntable").add_link("base").add_link("beam", collisions=[beam])
    return ulna.Robot(b.add_joint("turn", Continuous((0.0, 0.0, 1.0)), "base", "beam").build())


def test_a_continuous_joint_turns_the_way_that_is_checked() -> None:
    """The shorter way from 0 to 4 rad is free, the one that leads to exactly 4 rad is not."""
    ball = World().add("ball", Sphere(0.1), (0.5 * np.cos(2.0), 0.5 * np.sin(2.0), 0.0))
    assert not turntable().plan([0.0], [4.0], ball, method="exact", iterations=100)
    there = turntable().plan([0.0], [4.0 - 2.0 * np.pi], ball, method="exact")
    assert there.is_certified and there.points.shape == (2, 1)
    around = turntable().plan([0.0], [20.0], method="exact")
    assert around.is_certified and around.points[-1, 0] == 20.0


def test_a_long_motion_is_given_up_when_time_is_up() -> None:
    ball = World().add("ball", Sphere(0.1), (0.65, 0.0, 0.0))
    asked = iter([False] * 5 + [True] * 5)
    checker = Checker(turntable(), ball)
    time = first_contact_along(checker, np.zeros(1) + 1.0, np.array([5e4]), 0.0, lambda: next(asked))
    assert 0.0 < time < 1e-3 and next(asked)
