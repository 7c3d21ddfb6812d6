"""Planning: what it returns, why it fails, and what its certificate says."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.patience import patient
from ulna.collision import LinkSpheres, Spheres, World
from ulna.collision.touches import deepest_touch
from ulna.errors import InputError, ModelError, NonFiniteError, ShapeError
from ulna.geometry import Box, Cylinder, Geometry, Plane, Sphere
from ulna.model import Composite, Continuous, ModelBuilder, Prismatic, Revolute, Spherical
from ulna.planning import Planner, certify, edges, plan, scene
from ulna.planning.run import Run
from ulna.planning.search import Search
from ulna.planning.workspace import Storage
from ulna.spatial import SE3

DOWN = np.array([[1.0, 0, 0, 0.5], [0, -1.0, 0, 0.25], [0, 0, -1.0, 0.35], [0, 0, 0, 1.0]])


@cache
def panda() -> Any:
    return ulna.load("panda")


@cache
def shelf() -> World:
    world = World().add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])
    world = world.add("wall", Box((0.3, 0.02, 0.4)), (0.55, 0.0, 0.2))
    return world.add("ball", Sphere(0.1), (0.3, -0.5, 0.6)).add(
        "post", Cylinder(0.04, 0.5), (0.35, 0.45, 0.25)
    )


def left_and_right() -> tuple[Any, Any]:
    """Configurations on both sides of the wall."""
    robot = panda()
    q = [
        robot.ik(T, robot.configurations["ready"], seed=1).q
        for T in (DOWN, SE3.from_translation([0, -0.5, 0]).matrix() @ DOWN)
    ]
    return q[0], q[1]


def test_a_path_around_a_wall_is_certified_and_free_when_sampled_densely() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    p = plan(robot, a, b, world)
    assert p and p.success and p.is_certified and p.outcome == "solved" and p.goal == 0 and p.iterations >= 1
    np.testing.assert_array_equal(p.points[[0, -1]], [a, b])
    t = np.linspace(0.0, 1.0, 400)[:, None]
    for x, y in zip(p.points, p.points[1:], strict=False):
        assert not robot.collides(x + t * (y - x), world).any()
    straight = a + t * (b - a)
    assert robot.collides(straight, world).any()  # or there was nothing to plan
    assert p.cost == pytest.approx(np.linalg.norm(np.diff(p.points, axis=0), axis=1).sum())
    assert set(p.seconds) == {"prepare", "search", "shorten", "improve", "certify"} and "certified" in repr(p)


@pytest.mark.slow
def test_the_same_seed_returns_the_same_path_also_in_another_process() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    p, again, other = (plan(robot, a, b, world, seed=s) for s in (3, 3, 4))
    np.testing.assert_array_equal(p.points, again.points)
    assert p.points.shape != other.points.shape or not np.array_equal(p.points, other.points)
    code = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parents[2])!r}); "
        "from unit.planning.test_plan import *; a, b = left_and_right(); "
        "print(plan(panda(), a, b, shelf(), seed=3).points.tobytes().hex())"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600
    )
    assert run.stdout.strip() == p.points.tobytes().hex()


def test_goals_may_be_several_configurations_and_poses() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    blocked = np.zeros(7)
    blocked[3] = -0.1
    p = plan(robot, a, np.stack([blocked + 99.0, b]), world)
    assert p and p.goal == 1
    np.testing.assert_array_equal(p.points[-1], b)
    for goal in (DOWN, SE3.from_matrix(DOWN), DOWN[None]):
        p = plan(robot, b, goal, world)
        assert p and p.is_certified
        np.testing.assert_allclose(robot.fk(p.points[-1]), DOWN, atol=2e-6)
    p = plan(robot, b, DOWN, world, frame="panda_link8")
    np.testing.assert_allclose(robot.fk(p.points[-1], "panda_link8"), DOWN, atol=2e-6)


def test_the_trajectory_follows_the_path_within_its_limits() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    p = plan(robot, a, b, world)
    t = p.trajectory(acceleration=5.0)
    np.testing.assert_allclose([t.start, t.end], [a, b], atol=1e-9)
    samples = t.sample(n=500)
    assert np.abs(samples.a).max() <= 5.0 * (1 + 1e-6)
    assert (np.abs(samples.v) <= robot.limits.velocity * (1 + 1e-6)).all()
    # each sample lies on an edge of the certified path
    d = np.full(len(samples.q), np.inf)
    for x, y in zip(p.points, p.points[1:], strict=False):
        s = np.clip(((samples.q - x) @ (y - x)) / ((y - x) @ (y - x)), 0.0, 1.0)[:, None]
        d = np.minimum(d, np.linalg.norm(samples.q - (x + s * (y - x)), axis=1))
    assert d.max() < 1e-9


def test_a_motion_under_limits_of_jerk_follows_the_path_and_rests_at_its_corners() -> None:
    robot, world = panda(), shelf()
    p = plan(robot, *left_and_right(), world)
    t = p.trajectory(acceleration=5.0, jerk=60.0)
    report = ulna.trajectory.check(
        robot, t, acceleration=5.0 * (1 + 1e-6), jerk=60.0 * (1 + 1e-6), torque=False
    )
    assert report, report
    q = t.sample(n=400).q
    d = np.full(len(q), np.inf)
    for x, y in pairwise(p.points):
        s = np.clip(((q - x) @ (y - x)) / ((y - x) @ (y - x)), 0.0, 1.0)[:, None]
        d = np.minimum(d, np.linalg.norm(q - (x + s * (y - x)), axis=1))
    assert d.max() < 1e-9 and p.trajectory(acceleration=5.0, torque=np.inf).duration < t.duration
    slow = p.trajectory(velocity=0.5, acceleration=5.0, jerk=60.0)
    assert np.abs(slow.sample(n=400).v).max() <= 0.5 * (1 + 1e-9)
    for wrong in ({}, {"acceleration": 5.0, "torque": 10.0}, {"acceleration": 5.0, "blend": True}):
        with pytest.raises(InputError, match="`jerk` needs `acceleration`"):
            p.trajectory(jerk=60.0, **wrong)
    with pytest.raises(InputError, match="limit above zero"):
        p.trajectory(acceleration=5.0, jerk=0.0)


@pytest.mark.parametrize("limits", [{}, {"jerk": 60.0}], ids=["time-optimal", "jerk"])
def test_points_that_repeat_do_not_change_a_motion(limits: dict[str, Any]) -> None:
    q = panda().configurations["ready"]
    goal = q + 0.2 * np.eye(len(q))[0]
    p = plan(panda(), q, goal)
    duration = p.trajectory(acceleration=5.0, **limits).duration
    repeated = replace(p, points=np.array([q, q, goal, goal]))
    assert repeated.trajectory(acceleration=5.0, **limits).duration == pytest.approx(duration)
    with pytest.raises(InputError, match="nothing to move"):
        replace(p, points=np.array([q, q])).trajectory(acceleration=5.0, **limits)


# why there is no path -------------------------------------------------------------------------------------


def test_a_start_or_goal_that_touches_names_both_and_the_depth() -> None:
    robot = panda()
    ready = robot.configurations["ready"]
    low = robot.ik(SE3.from_translation([0, 0, -0.42]).matrix() @ robot.fk(ready), ready).q
    table = World().add(
        "table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, 0.1), touches=["panda_link0", "panda_link1"]
    )
    p = plan(robot, low, ready, table)
    assert not p and p.outcome == "start" and not p.is_certified and p.points.shape == (0, 7)
    assert "at the start 'panda_" in p.reason and "overlaps 'table' by" in p.reason and "mm" in p.reason
    p = plan(robot, ready, low, table)
    assert p.outcome == "goal" and "at the goal 'panda_" in p.reason
    with pytest.raises(InputError, match="There is no path to move along: at the goal"):
        p.trajectory()
    folded = np.array([0.0, 1.7, 0.0, -3.0, 0.0, 0.0, 0.0])
    p = plan(robot, folded, ready, method="spheres")
    assert p.outcome == "start" and "panda_" in p.reason.split("overlaps")[1] and "finer spheres" in p.reason
    assert p.touching == ("panda_link1", "panda_link7") and p.method == "spheres"
    p = plan(robot, folded, ready)
    assert p.reason.startswith("at the start 'panda_link1' overlaps 'panda_link7' by") and p.method == "exact"


def test_the_reason_names_what_the_margin_forbids_and_not_what_is_nearest() -> None:
    robot = panda()
    q = robot.configurations["ready"]
    alone = Planner(robot).scene.checker
    apart, *links = deepest_touch(alone, q)
    margin = 0.6 * apart  # counts for each of two links, and once for an obstacle
    for height in np.linspace(1.5, 0.9, 61):  # a ball comes down until it is nearer than the links are
        world = World().add("ball", Sphere(0.1), (0.0, 0.0, height))
        distance, _, near = deepest_touch(Planner(robot, world).scene.checker, q)
        if near == "ball":
            break
    assert near == "ball" and margin < distance < apart
    p = plan(robot, q, q + 0.1, world, margin=margin, method="spheres")
    assert p.outcome == "start" and all(repr(link) in p.reason for link in links) and "ball" not in p.reason
    assert (
        f"comes within {1e3 * apart:.3g} mm" in p.reason and f"`margin` is {1e3 * margin:.3g} mm" in p.reason
    )
    assert plan(robot, q, q + 0.1, world, margin=0.3 * apart)


def test_limits_unreachable_poses_and_exhausted_searches_are_named() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    out = a.copy()
    out[3] = 1.0
    p = plan(robot, out, b, world)
    assert p.outcome == "start" and "joint 'panda_joint4' is at 1, its limits are [-3.072, -0.06" in p.reason
    assert plan(robot, a, out, world).outcome == "goal"
    far = DOWN.copy()
    far[0, 3] = 5.0
    p = plan(robot, a, far, world)
    assert p.outcome == "unreachable" and "no configuration within the limits" in p.reason
    assert "panda_hand_tcp stays 4." in p.reason and "m from its goal" in p.reason.replace(
        "rad from", "m from"
    )
    apart = World().add("lid", Plane(), (0.0, 0.0, -2.0))
    assert plan(robot, a, b, apart)


def test_limits_of_iterations_and_time() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    p = plan(robot, a, b, world, iterations=1, seed=1)
    assert p.outcome in ("iterations", "solved")
    p = plan(robot, a, b, world, timeout=0.0)
    assert p.outcome == "time" and "no path was found within 0 s" in p.reason


def test_start_equal_to_goal_is_a_path_of_one_point() -> None:
    a, _ = left_and_right()
    p = plan(panda(), a, a, shelf())
    assert p and p.is_certified and p.points.shape == (1, 7) and p.cost == 0.0
    with pytest.raises(InputError, match="The start is the goal"):
        p.trajectory()


def test_wrong_input_is_refused() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    cases: list[tuple[type[Exception], str, tuple[Any, ...], dict[str, Any]]] = [
        (ShapeError, "`q0` has shape", (a[:5], b), {}),
        (NonFiniteError, "q0", (a * np.nan, b), {}),
        (ShapeError, "`goal` has shape", (a, b[:5]), {}),
        (InputError, r"`goal\[0\]` is nan", (a, b * np.nan), {}),
        (InputError, "`frame` says whose pose", (a, b), {"frame": "panda_link8"}),
        (InputError, "`step` is 0", (a, b), {"step": 0.0}),
        (InputError, "`margin` is -1", (a, b), {"margin": -1.0}),
        (InputError, "`margin` is 'wide'", (a, b), {"margin": "wide"}),
        (InputError, "`margin` is None", (a, b), {"margin": None}),
        (InputError, "`longest` is 1e\\+300", (a, b), {"longest": 1e300}),
        (InputError, "5 is no list of pairs", (a, b), {"pairs": 5}),
        (InputError, "5 is no pair of links", (a, b), {"pairs": [5]}),
        (InputError, "`spheres` is 3; expected Spheres", (a, b), {"spheres": 3}),
        (InputError, "`keep_tree` is", (a, b), {"keep_tree": np.ones(2)}),
        (InputError, "`timeout` is nan", (a, b), {"timeout": np.nan}),
    ]
    for kind, text, (start, goal), options in cases:
        with pytest.raises(kind, match=text):
            plan(robot, start, goal, world, **options)
    with pytest.raises(InputError, match="expected a World"):
        plan(robot, a, b, "table")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="`robot` is a Model; expected a Robot"):
        plan(robot.model, a, b)
    with pytest.raises(InputError, match="`robot` is a str; expected a Robot"):
        Planner("panda")
    assert Planner(robot, pairs=[["panda_link1", "panda_link4"]]).plan(a, a)
    far = World().add("far", Sphere(0.1), (1e4, 0.0, 0.0))
    with pytest.raises(InputError, match=r"1e\+04 m from the origin"):
        plan(robot, a, b, far)


def test_robots_that_cannot_be_planned_for_are_refused() -> None:
    b = ModelBuilder("bare")
    b.add_link("base").add_link("arm")
    b.add_joint("turn", Continuous((0.0, 0.0, 1.0)), "base", "arm")
    with pytest.raises(ModelError):
        plan(ulna.Robot(b.build()), [0.0], [1.0])
    b = ModelBuilder("ball")
    b.add_link("base").add_link("arm", collisions=[Geometry("", Box((0.1, 0.1, 0.1)))])
    b.add_joint("shoulder", Spherical(), "base", "arm")
    with pytest.raises(InputError, match=r"Joint 'shoulder' is Spherical; planning takes joints whose"):
        plan(ulna.Robot(b.build()), [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0])


@pytest.mark.parametrize("method", ["spheres", "exact"])
def test_composite_joints_of_plain_numbers_are_planned_for(method: Any) -> None:
    robot = _arm_of_composites()
    posts = [(0.35, 0.0, 0.5), (0.0, 0.4, 0.6), (-0.35, -0.1, 0.5)]
    world = World()
    for k, place in enumerate(posts):
        world = world.add(f"post {k}", Sphere(0.12), place)
    checker = robot.collision_checker(world)
    free = robot.random_configuration(200, seed=1)
    free = free[robot.collision_checker(world, method="spheres").clearance(free) > 0.0]
    t = np.linspace(0.0, 1.0, 200)[:, None]
    a, b = next((a, b) for a, b in pairwise(free) if checker.collides(a + t * (b - a)).any())
    p = robot.plan(a, b, world, method=method)
    assert p and p.is_certified
    assert not any(checker.collides(x + t * (y - x)).any() for x, y in pairwise(p.points))
    assert ulna.trajectory.check(robot, p.trajectory(acceleration=5.0), acceleration=5.0, torque=False)


def _arm_of_composites() -> Any:
    """Two joints, each made of a turn and a slide or of two turns, one of these without limits."""
    b = ModelBuilder("composites").add_link("base")
    kinds = (
        Composite((Revolute((0.0, 1.0, 0.0)), Prismatic((0.0, 0.0, 1.0)))),
        Composite(
            (Continuous((0.0, 0.0, 1.0)), Revolute((1.0, 0.0, 0.0))),
            (SE3.from_translation((0.02, 0.0, 0.0)),) * 2,
        ),
    )
    parent = "base"
    for name, kind, lower, upper in zip(
        ("upper", "fore"), kinds, ((-2.5, -0.1), (-np.inf, -2.5)), ((2.5, 0.1), (np.inf, 2.5)), strict=True
    ):
        solid = Geometry("", Cylinder(0.04, 0.25), SE3.from_translation((0.0, 0.0, 0.16)))
        b.add_link(name, collisions=[solid])
        b.add_joint(
            name, kind, parent, name, SE3.from_translation((0.0, 0.0, 0.32)),
            lower=lower, upper=upper, velocity=(2.0, 2.0),
        )  # fmt: skip
        parent = name
    return ulna.Robot(b.build())


def test_margins_are_kept() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    p = plan(robot, a, b, world, margin=0.02)
    assert p and p.is_certified
    checker = robot.collision_checker(world, method="spheres")
    t = np.linspace(0.0, 1.0, 200)[:, None]
    for x, y in zip(p.points, p.points[1:], strict=False):
        assert (checker.clearance(x + t * (y - x)) > 0.02 - 1e-9).all()


def test_spheres_that_the_user_passes_are_used() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    fitted = robot.collision_spheres()
    huge = fitted.replace("panda_hand", np.zeros((1, 3)), np.array([0.6]))
    p = plan(robot, a, b, world, spheres=huge)
    assert p.outcome == "start" and "'panda_hand' overlaps" in p.reason


def test_joints_without_limits_sliding_joints_and_followers() -> None:
    b = ModelBuilder("gantry")
    b.add_link("rail")
    b.add_link("cart", collisions=[Geometry("", Box((0.1, 0.1, 0.1)), SE3.identity())])
    b.add_link(
        "arm", collisions=[Geometry("", Box((0.5, 0.05, 0.05)), SE3.from_translation([0.25, 0.0, 0.2]))]
    )
    b.add_joint("slide", Prismatic((1.0, 0.0, 0.0)), "rail", "cart", lower=-1.0, upper=1.0)
    b.add_joint("turn", Continuous((0.0, 0.0, 1.0)), "cart", "arm")
    robot = ulna.Robot(b.build())
    world = World().add("post", Cylinder(0.05, 1.0), (0.0, 0.35, 0.0))
    p = plan(robot, [-0.6, np.pi / 2], [0.6, np.pi / 2], world)
    assert p and p.is_certified
    t = np.linspace(0.0, 1.0, 300)[:, None]
    for x, y in zip(p.points, p.points[1:], strict=False):
        assert not robot.collides(x + t * (y - x), world).any()


# soundness of the check -----------------------------------------------------------------------------------


def checked_states(world: World, count: int = 600) -> tuple[Any, Any, Any]:
    """Random configurations, whether the machine code says touching, and their clearance in float64."""
    robot = panda()
    q = np.random.default_rng(7).uniform(robot.limits.lower, robot.limits.upper, size=(count, 7))
    place = scene(robot.collision_checker(world, method="spheres"))
    return q, which_touch(place, q), place.checker.clearance(q)


def which_touch(place: Any, q: Any, how: str = "__call__", margin: float = 0.0) -> Any:
    """Which configurations touch, by machine code, by machine code with checks, or by the interpreter."""
    touching = np.zeros(len(q), np.float32)
    call = getattr(edges.first_direct_goal.specialized(W=place.lanes), how)
    tables, step = place.tables(margin), np.float32(1.0)
    call(place.robot.kernel, tables, step, q.astype(np.float32), touching, len(q), place.moving.work())
    return touching > 0


def test_machine_code_never_says_free_where_spheres_touch() -> None:
    world = (
        shelf()
        .add("floor", Plane(), (0.0, 0.0, -0.3))
        .add(
            "tilted",
            Box((0.2, 0.3, 0.1)),
            SE3.from_translation([-0.4, 0.3, 0.5]) @ SE3.from_rpy([0.3, 0.5, -0.8]),
        )
    )
    _, touching, clearance = checked_states(world)
    assert 0.1 < touching.mean() < 0.9
    assert touching[clearance <= 0.0].all()
    assert not touching[clearance > 3e-4].any()  # the margin for rounding, twice for two links


def test_interpreter_and_checked_code_agree_with_machine_code() -> None:
    robot = panda()
    place = scene(robot.collision_checker(shelf(), method="spheres"))
    q = (
        np.random.default_rng(2)
        .uniform(robot.limits.lower, robot.limits.upper, size=(4, 7))
        .astype(np.float32)
    )
    results = [which_touch(place, q, how) for how in ("__call__", "checked", "interpret")]
    np.testing.assert_array_equal(results[0], results[1])
    np.testing.assert_array_equal(results[0], results[2])


def test_no_table_holds_subnormal_numbers_which_make_edges_slow() -> None:
    tables = scene(panda().collision_checker(shelf(), method="spheres")).tables(0.01)
    least = np.finfo(np.float32).tiny
    for name, values in tables._asdict().items():
        if isinstance(values, np.ndarray) and values.dtype == np.float32:
            assert not ((values != 0.0) & (np.abs(values) < least)).any(), name
    assert (tables.reach == 0.0).any()  # the last joints do not move the first links


def test_bounds_of_motion_hold() -> None:
    """No sphere moves farther than the bound, and no two approach faster."""
    robot = panda()
    place = scene(robot.collision_checker(method="spheres"))
    spheres: Spheres = place.checker.spheres
    random = np.random.default_rng(4)
    from ulna.collision.spheres import sphere_centres

    for _ in range(200):
        a = random.uniform(robot.limits.lower, robot.limits.upper)
        b = a + random.normal(scale=0.3, size=7)
        one, two = (sphere_centres(robot.model, q, spheres) for q in (a, b))
        allowed = place.moving.bounds_of_motion[0] @ np.abs(b - a)
        for group, most in zip(place.moving.groups, allowed, strict=True):
            assert np.linalg.norm(two[group.name] - one[group.name], axis=1).max() <= most + 1e-12


def test_certificates_find_what_touches_between_free_points() -> None:
    robot = panda()
    a, b = left_and_right()
    place = scene(robot.collision_checker(shelf(), method="spheres"))
    certificate = certify(place, np.stack([a, b, b + 0.01]))
    assert certificate.unproved == (0,) and not certificate
    touching = robot.ik(SE3.from_translation([0.0, -0.25, -0.1]).matrix() @ DOWN, a, seed=1).q  # in the wall
    assert certify(place, touching[None]).unproved == (0,)
    assert certify(place, a[None])
    thin = World().add("needle", Cylinder(0.002, 0.05), robot.fk(0.5 * (a + b))[:3, 3])
    place = scene(robot.collision_checker(thin, method="spheres"))
    assert certify(place, np.stack([a, b])).unproved == (0,)
    assert certify(place, np.stack([a, a + 0.05]), margin=0.01)


def test_certificates_refuse_what_is_no_path() -> None:
    robot = Planner(panda()).scene
    q = panda().configurations["ready"]
    for kind, points, margin in (
        (NonFiniteError, [q, q * np.nan], 0.0),
        (ShapeError, np.zeros((2, 3)), 0.0),
        (ShapeError, np.zeros((0, 7)), 0.0),
        (ShapeError, q, 0.0),
        (InputError, [q, q], -1.0),
    ):
        with pytest.raises(kind):
            certify(robot, points, margin)  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_random_problems_are_free_by_coal_between_samples(seed: int) -> None:
    robot = panda()
    random = np.random.default_rng(seed)
    world = World()
    for k in range(12):
        T = SE3.from_translation(random.uniform([-0.8, -0.8, 0.0], [0.8, 0.8, 1.0])) @ SE3.from_rpy(
            random.normal(size=3)
        )
        if np.linalg.norm(T.translation[:2]) > 0.3:
            shape = [Box((0.1, 0.2, 0.05)), Sphere(0.08), Cylinder(0.04, 0.4)][k % 3]
            world = world.add(f"o{k}", shape, T)
    solved = 0
    for k in range(12):
        q = random.uniform(robot.limits.lower, robot.limits.upper, size=(2, 7))
        p = plan(robot, q[0], q[1], world, seed=k, timeout=5.0)
        if not p:
            assert p.reason
            continue
        solved += 1
        assert p.is_certified
        t = np.linspace(0.0, 1.0, 150)[:, None]
        for x, y in zip(p.points, p.points[1:], strict=False):
            assert not robot.collides(x + t * (y - x), world).any()
    assert solved >= 1
    assert isinstance(robot.collision_spheres().links["panda_hand"], LinkSpheres)


# the tables -----------------------------------------------------------------------------------------------


def random_world(random: Any, count: int = 20) -> World:
    """Boxes, balls and cylinders about the robot."""
    world = World()
    for k in range(count):
        T = SE3.from_translation(random.uniform([-0.9, -0.9, 0.0], [0.9, 0.9, 1.2])) @ SE3.from_rpy(
            random.normal(size=3)
        )
        shape = [Box((0.1, 0.2, 0.05)), Sphere(0.08), Cylinder(0.04, 0.4)][k % 3]
        world = world.add(f"o{k}", shape, T, touches=["panda_link1"] if k % 4 == 0 else ())
    return world


@pytest.mark.parametrize("seed", range(3))
def test_what_links_carry_and_margins_of_pairs_count(seed: int) -> None:
    random = np.random.default_rng(seed)
    world = random_world(random).attach(
        "can", "panda_hand", (0.0, 0.0, 0.15), shape=Cylinder(0.03, 0.12),
        touches=["panda_hand", "panda_leftfinger", "panda_rightfinger", "o1"],
    )  # fmt: skip
    world = world.set_margin("panda_link4", "o2", 0.05).set_margin("panda_link5", "panda_link1", 0.04)
    world = world.set_margin("can", "o3", 0.1)
    q, touching, clearance = checked_states(world, 400)
    assert touching[clearance <= 0.0].all()
    assert not touching[clearance > 3e-4].any()
    bare = scene(panda().collision_checker(world.remove("can"), method="spheres"))
    assert (which_touch(bare, q) != touching).any()  # or the can would make no difference


def test_a_thousand_obstacles_are_checked_like_few() -> None:
    random = np.random.default_rng(5)
    world = World()
    for k in range(1000):
        place = random.uniform([-1.2, -1.2, 0.0], [1.2, 1.2, 1.5])
        world = world.add(f"o{k}", Box((0.02, 0.02, 0.02)), place)
    _, touching, clearance = checked_states(world, 60)
    assert touching[clearance <= 0.0].all() and not touching[clearance > 3e-4].any()


def test_spheres_that_are_left_out_never_meet() -> None:
    """By thousands of configurations; and far more pairs than these can never be left out by luck."""
    place = scene(panda().collision_checker(method="spheres"))
    moving, random = place.moving, np.random.default_rng(1)
    kept, every = (len(moving.pair_tables(margin)["partners"]) for margin in (0.0, 1.0))
    assert 0 < kept < every
    q = random.uniform(panda().limits.lower, panda().limits.upper, size=(3000, 7))
    from ulna.algorithms import joint_poses
    from ulna.collision.lanes.sphere_pairs import RESERVE, can_meet

    poses = joint_poses(panda().model, q)
    for (a, b, _), bounds in zip(moving.pairs, moving.bounds_of_motion[1], strict=True):
        one, two = moving.groups[a], moving.groups[b]
        x, y = (
            g.centres @ np.swapaxes(poses[g.joint].rotation, -1, -2) + poses[g.joint].translation[:, None]
            for g in (one, two)
        )
        apart = np.linalg.norm(x[:, :, None] - y[:, None], axis=-1).min(axis=0)
        meets = apart < one.radii[:, None] + two.radii + RESERVE
        assert can_meet(panda().model, one, two, bounds)[meets].all()


def test_paths_that_touch_between_the_steps_of_the_search_are_repaired(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Grains that long steps jump over: every path is proved, by detours where the first one was not."""
    robot, random = panda(), np.random.default_rng(3)
    a, b = left_and_right()
    world = World()
    for k in range(120):
        world = world.add(f"grain{k}", Sphere(0.002), random.uniform([0.1, -0.1, 0.2], [0.8, 0.1, 1.0]))
    detours, detour = [], Search._detour

    def counted(*arguments: Any) -> Any:
        detours.append(arguments)
        return detour(*arguments)

    monkeypatch.setattr(Search, "_detour", counted)
    t = np.linspace(0.0, 1.0, 400)[:, None]
    for seed in (1, 10, 15):
        p = plan(robot, a, b, world, seed=seed)
        assert p and p.is_certified
        for x, y in pairwise(p.points):
            assert not robot.collides(x + t * (y - x), world, method="spheres").any()
    assert detours


def test_a_planner_is_the_same_as_the_function_and_serves_threads() -> None:
    from concurrent.futures import ThreadPoolExecutor

    robot, world = panda(), shelf()
    a, b = left_and_right()
    planner = Planner(robot, world)
    one = plan(robot, a, b, world, seed=3)
    with ThreadPoolExecutor(4) as pool:
        plans = list(pool.map(lambda _: planner.plan(a, b, seed=3), range(16)))
    for p in plans:
        np.testing.assert_array_equal(p.points, one.points)
    with pytest.raises(InputError, match=r"`iterations` is 1\.5; expected an integer of at least 1"):
        planner.plan(a, b, iterations=1.5)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="`seed` is -1; expected an integer of at least 0"):
        planner.plan(a, b, seed=-1)


def test_ctrl_c_ends_the_plans_of_all_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    builder = ModelBuilder("cart").add_link("rail").add_link("slide")
    builder.add_link("cart", collisions=[Geometry("", Sphere(0.1))])
    for name, axis, parent, child in (("x", (1, 0, 0), "rail", "slide"), ("y", (0, 1, 0), "slide", "cart")):
        builder.add_joint(name, Prismatic(axis), parent, child, lower=-1.0, upper=1.0)
    world = World().add("wall", Box((0.1, 3.0, 1.0)))  # no way around it
    under_way, is_known, should_stop = threading.Barrier(3), threading.local(), Run.should_stop

    def noted(run: Run) -> bool:
        if not hasattr(is_known, "value"):
            is_known.value = True
            under_way.wait()
        return should_stop(run)

    def interrupt() -> None:
        under_way.wait()
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(Run, "should_stop", noted)
    other = threading.Thread(target=interrupt)
    other.start()
    before = set(threading.enumerate())
    starts, goals = np.tile([-0.5, 0.0], (6, 1)), np.tile([0.5, 0.0], (6, 1))
    with pytest.raises(KeyboardInterrupt):
        Planner(ulna.Robot(builder.build()), world).plan_all(
            starts, goals, threads=2, timeout=500.0, iterations=10**9
        )
    other.join()
    # a thread that was just being started is not in its pool yet, which then does not wait for it
    assert patient(0.001)(lambda: not set(threading.enumerate()) - before, 60.0)


def test_many_problems_have_the_same_plans_in_any_number_of_threads() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    planner, random = Planner(robot, world), np.random.default_rng(2)
    goals = b + random.normal(scale=0.05, size=(12, 7))
    goals[3] = 99.0
    one = planner.plan_all(a, goals, seed=4)
    for plans in (
        planner.plan_all(np.tile(a, (12, 1)), goals, threads=3, seed=4),
        [planner.plan(a, g, seed=4) for g in goals],
    ):
        assert [p.outcome for p in plans] == [p.outcome for p in one]
        for p, q in zip(plans, one, strict=True):
            np.testing.assert_array_equal(p.points, q.points)
    assert one[3].outcome == "goal" and sum(map(bool, one)) >= 8
    assert planner.plan_all(a, []) == []
    poses = planner.plan_all(b, [DOWN, b], threads=2)
    assert all(poses) and len(poses[1].points) == 1
    with pytest.raises(ShapeError, match=r"`starts` has shape \(5, 7\)"):
        planner.plan_all(np.tile(a, (5, 1)), goals)
    with pytest.raises(InputError, match="`threads` is 0"):
        planner.plan_all(a, goals, threads=0)
    with pytest.raises(ShapeError, match="`goal` has shape"):
        planner.plan_all(a, [b, b[:3]], threads=2)


def test_more_goals_than_there_is_room_for() -> None:
    robot, world = panda(), shelf()
    a, b = left_and_right()
    goals = np.repeat(b[None], 3000, axis=0) + np.linspace(0.0, 1e-3, 3000)[:, None]
    p = plan(robot, a, goals, world)
    assert p and p.is_certified
    np.testing.assert_array_equal(p.points[-1], goals[p.goal])


def test_calls_that_follow_each_other_take_what_each_asks_for() -> None:
    robot, q = panda(), panda().configurations["ready"]
    near = q + 0.01
    free, full = World(), World().add("room", Box((3.0, 3.0, 3.0)))
    for _ in range(2):
        assert robot.plan(q, near, free) and robot.plan(q, near)
        assert robot.plan(q, near, full).outcome == "start"
        assert robot.plan(q, near, free, margin=10.0).outcome == "start"
        other = ulna.load("ur5")
        assert other.plan(np.zeros(6), np.zeros(6)).model == other.model
    a, b = left_and_right()
    paths = [robot.plan(a, b, shelf(), seed=seed) for seed in (0, 700, 0, 700)]
    np.testing.assert_array_equal(paths[0].points, paths[2].points)
    np.testing.assert_array_equal(paths[1].points, paths[3].points)
    assert not np.array_equal(paths[0].points, paths[1].points)
    assert robot.plan(a, b, shelf(), iterations=1, seed=0).iterations <= 1
    assert robot.plan(a, b, shelf(), keep_tree=True).tree and not robot.plan(a, b, shelf()).tree
    pairs = [("panda_link1", "panda_link4")]
    assert robot.plan(q, near, pairs=pairs)
    pairs[0] = ("panda_link1", "nothing")
    with pytest.raises(ulna.errors.UnknownName):
        robot.plan(q, near, pairs=pairs)
    with pytest.raises(InputError, match="seed"):
        robot.plan(q, near, seed=0.5)


def test_samples_that_are_held_are_those_that_are_drawn() -> None:
    """Whatever was held before: other sequences, samples of none, and more than there is room for."""
    storage = Storage(2)
    drawn: list[int] = []

    def rows(sequence: Any, number: int, count: int) -> Any:
        def draw() -> Any:
            drawn.append(number)
            return np.arange(number, number + count)[:, None] + np.array(
                [0.0, {"a": 0.25, "b": 0.5}.get(sequence, 0)]
            )

        first = storage.hold_samples(sequence, number, count, draw)
        return storage.samples[first : first + count]

    for sequence, extra in (("a", 0.25), ("b", 0.5), ("a", 0.25), (None, 0.0)):
        for number in (0, 512, 0, 1024, 1536, 512, 2048, 2560, 0):
            held = rows(sequence, number, 512)
            np.testing.assert_array_equal(
                held, np.arange(number, number + 512)[:, None] + np.array([0.0, extra])
            )
    drawn.clear()
    for number in (0, 512, 0, 512):
        rows("a", number, 512)
    assert drawn == [0, 512]
    rows("a", 0, 60)
    rows("a", 512, 60)
    assert drawn == [0, 512]


def test_worlds_share_what_only_the_robot_decides() -> None:
    one, two = (
        scene(panda().collision_checker(world, method="spheres")).tables(0.01) for world in (shelf(), World())
    )
    assert one.spheres is two.spheres and one.boxes is not two.boxes
    assert scene(panda().collision_checker(World(), method="spheres")).tables(0.02).spheres is not two.spheres


@pytest.mark.parametrize("at_once", [True, False])
def test_trees_that_grow_at_once_find_the_same_path(at_once: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    a, b = left_and_right()
    expected = plan(panda(), a, [b + 9.0, b], shelf())
    monkeypatch.setattr(Search, "_starts_at_once", at_once)
    for goals in (b, [b], [b + 9.0, b]):  # a goal out of limits is looked at apart
        p = plan(panda(), a, goals, shelf())
        np.testing.assert_array_equal(p.points, expected.points)
        assert (p.iterations, p.nodes) == (expected.iterations, expected.nodes)


def test_what_a_plan_holds_is_its_own() -> None:
    planner = Planner(panda())
    q = panda().configurations["ready"].copy()
    for goal in (q.copy(), q + 0.01):
        before, after = q.copy(), goal.copy()
        p = planner.plan(q, goal)
        q[:], goal[:] = 0.0, 0.0
        np.testing.assert_array_equal(p.points[[0, -1]], [before, after])
        q[:] = before


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_arrays_with_one_wrong_number_are_refused_wherever_it_stands(wrong: float) -> None:
    table = ModelBuilder("turntable")
    table.add_link("base")
    table.add_link("plate", collisions=[Geometry("", Box((0.2, 0.1, 0.1)), SE3.identity())])
    table.add_joint("turn", Continuous((0.0, 0.0, 1.0)), "base", "plate")
    for robot in (panda(), ulna.Robot(table.build())):
        q = np.array(robot.configurations["ready"]) if robot.nq == 7 else np.zeros(1)
        planner = Planner(robot)
        assert planner.plan(q, q)
        for k in range(robot.nq):
            for pair in ((0, 1), (1, 0)):
                ends = np.array([q, q])
                ends[pair[0], k], ends[pair[1], k] = wrong, 0.0
                with pytest.raises(NonFiniteError):
                    planner.plan(*ends)
