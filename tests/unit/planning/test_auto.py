"""The method "auto": plans by covering spheres, and among the real shapes where spheres refuse the start or every goal."""

from __future__ import annotations

import itertools
import pickle
from functools import cache
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.errors import MissingExtra
from ulna.geometry import Box, PointCloud
from ulna.planning import PathConstraint, Planner, Region
from ulna.planning import exact_search as exact
from ulna.spatial import SE3

pytest.importorskip("coal")

TABLE = (
    World()
    .add("table", Box((1.2, 1.2, 0.04)), (0.6, 0.0, -0.02))
    .add("wall", Box((0.3, 0.02, 0.3)), (0.5, 0.0, 0.15))
)
START = np.array([0.0, -1.4, 1.6, -1.77, -1.57, 0.0])


@cache
def arm() -> Any:
    """It stands on the table, 2 mm nearer than the spheres of its shoulder allow."""
    return ulna.load("ur5")


def goal() -> Any:
    return SE3.pointing_down((0.5, 0.2, 0.25))


def test_an_arm_that_stands_on_a_table_is_planned_for() -> None:
    refused = arm().plan(START, goal(), TABLE, method="spheres")
    assert refused.outcome == "start" and refused.touching == ("shoulder_link", "table")
    assert refused.reason.endswith(
        'Where they are apart, plan with method="exact", or give finer spheres (ulna.collision.refine).'
    )
    p = arm().plan(START, goal(), TABLE)
    assert p.is_certified and p.method == "exact" and p.touching is None
    np.testing.assert_allclose(arm().fk(p.points[-1]), goal().matrix(), atol=1e-5)
    states = np.concatenate([np.linspace(a, b, 200) for a, b in itertools.pairwise(p.points)])
    assert not np.asarray(arm().collides(states, TABLE)).any()
    again = pickle.loads(pickle.dumps(Planner(arm(), TABLE))).plan(START, p.points[-1])
    assert again.method == "exact" and (again.points == arm().plan(START, p.points[-1], TABLE).points).all()


def test_spheres_decide_where_they_can() -> None:
    q = arm().configurations["ready"]
    assert arm().plan(q, q + [1, 0, 0, 0, 0, 0]).method == "spheres"
    far = arm().plan(q, np.full(6, 9.0), TABLE)
    assert far.outcome == "goal" and "'shoulder_pan_joint' is at 9" in far.reason and far.touching is None


@pytest.mark.parametrize(
    "options",
    [
        {"step": 0.005},
        {"improve": 100},
        {"constraints": PathConstraint("tool0", Region(np.eye(4), (np.inf, np.inf, 4.0), "any"))},
        {"method": "spheres"},
    ],
    ids=lambda options: next(iter(options)),
)
def test_what_only_spheres_take_is_planned_by_spheres(options: dict[str, Any]) -> None:
    p = arm().plan(START, START + 0.1, TABLE, **options)
    assert p.outcome == "start" and p.method == "spheres" and "by their covering spheres" in p.reason
    spheres = arm().collision.spheres()
    assert arm().plan(START, START + 0.1, TABLE, spheres=spheres).method == "spheres"


def test_without_coal_the_refusal_of_the_spheres_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(*_: Any) -> None:
        raise MissingExtra("coal", "collision", "real shapes")

    monkeypatch.setattr(exact, "ExactSearch", missing)
    p = Planner(arm(), TABLE).plan(START, START + 0.1)
    assert p.outcome == "start" and p.method == "spheres"


def test_a_start_that_does_touch_is_refused_by_its_real_depth() -> None:
    low = World().add("table", Box((1.2, 1.2, 0.04)), (0.6, 0.0, 0.03))
    p = arm().plan(START, START + 0.1, low)
    assert p.outcome == "start" and p.method == "exact" and p.touching == ("shoulder_link", "table")
    real = -float(arm().distance(START, low).distance)
    assert f"by {1e3 * real:.3g} mm" in p.reason


def test_where_the_time_is_up_the_reason_names_both() -> None:
    side = arm().ik(SE3.pointing_down((0.5, -0.2, 0.1)), START).q
    other = arm().ik(SE3.pointing_down((0.5, 0.2, 0.1)), START).q
    p = arm().plan(side, other, TABLE, iterations=1)
    assert p.outcome == "iterations" and "within 1 samples" in p.reason
    assert "By covering spheres there is none: at the start 'shoulder_link' overlaps 'table'" in p.reason


def test_goals_keep_their_numbers_and_joints_their_places() -> None:
    inside = arm().ik(SE3.pointing_down((0.5, 0.2, -0.1)), START).q
    p = arm().plan(START, np.stack([inside, START + [0.3, 0, 0, 0, 0, 0]]), TABLE)
    assert p.method == "exact" and p.goal == 1
    still = arm().plan(START, START + [0.3, 0, 0, 0, 0, 0], TABLE, joints=["shoulder_pan_joint"])
    assert still.method == "exact" and (still.points[:, 1:] == START[1:]).all()


def test_corners_are_cut_by_what_the_margin_allows() -> None:
    margin = 0.004
    side = arm().ik(SE3.pointing_down((0.5, -0.2, 0.1)), START).q
    other = arm().ik(SE3.pointing_down((0.5, 0.2, 0.1)), START).q
    p = arm().plan(side, other, TABLE, margin=margin)
    assert p.method == "exact" and len(p.points) > 2
    motion = p.trajectory(acceleration=8.0, blend=True)
    assert motion.duration < p.trajectory(acceleration=8.0).duration
    states = motion.q(np.linspace(0.0, motion.duration, 2000))
    assert not np.asarray(arm().collides(states, TABLE)).any()
    bounds = p.deviation_bounds
    corner = p.points[1]
    rng = np.random.default_rng(4000)
    for direction in rng.normal(size=(50, 6)):  # as far as is allowed, nothing touches
        step = direction / (bounds @ np.abs(direction)).max()
        assert not arm().collides(corner + step, TABLE)


def test_threads_find_the_same_paths() -> None:
    planner = Planner(arm(), TABLE)
    goals = [START + [turn, 0, 0, 0, 0, 0] for turn in (0.2, 0.4, -0.3)]
    one, two = (planner.plan_all(START, goals, threads=threads) for threads in (None, 2))
    assert all(p.method == "exact" and p.is_certified for p in one)
    assert all((a.points == b.points).all() for a, b in zip(one, two, strict=True))


def test_paths_among_points_keep_clear_of_them() -> None:
    robot, rng = ulna.load("panda"), np.random.default_rng(4300)
    direction = rng.normal(size=(400, 3))
    direction *= rng.uniform(0.55, 0.9, (400, 1)) / np.linalg.norm(direction, axis=1)[:, None]
    world = World().add("scan", PointCloud(direction + [0.0, 0.0, 0.4], 0.01), touches=["panda_link0"])
    q = robot.random_configuration(300, seed=4300)
    q = q[~np.asarray(robot.collides(q, world))]
    refused = [x for x in q if robot.plan(x, x, world, method="spheres").touching]
    found = 0
    for a in refused[:12]:
        p = robot.plan(a, a + 0.1 * rng.normal(size=7), world, timeout=1.0)
        if p:
            found += 1
            assert p.method == "exact" and p.is_certified
            states = np.concatenate([np.linspace(a, b, 300) for a, b in itertools.pairwise(p.points)])
            assert np.asarray(robot.distance(states, world).distance).min() > 0.0
    assert found > 2
