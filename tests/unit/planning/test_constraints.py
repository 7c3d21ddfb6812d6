"""Constraints on the way: kept between the points too, proved, repeatable, and named where they cannot be kept."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.errors import DtypeError, InputError, UnknownName
from ulna.geometry import Box, Sphere
from ulna.planning import PathConstraint, Planner, Region, plan, projected_rrt, scene
from ulna.planning.constrained import ConstrainedSearch
from ulna.planning.path_constraints import Constraints, _rotation_error
from ulna.planning.workspace import thread_storage
from ulna.spatial import SE3, so3_exp

ANYWHERE = (np.inf, np.inf, np.inf)


@cache
def panda() -> Any:
    return ulna.load("panda")


@cache
def planner() -> Planner:
    world = World().add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])
    world = world.add("wall", Box((0.3, 0.02, 0.4)), (0.55, 0.0, 0.2)).add(
        "ball", Sphere(0.1), (0.3, -0.5, 0.6)
    )
    return Planner(panda(), world)


def pose(y: float, z: float = 0.35) -> Any:
    T = np.diag([1.0, -1.0, -1.0, 1.0])
    T[:3, 3] = (0.5, y, z)
    return T


@cache
def right() -> Any:
    return panda().ik(pose(-0.25), panda().configurations["ready"], seed=1).q


def upright(**tolerances: float) -> PathConstraint:
    return PathConstraint(panda().model.tool, Region(pose(0.0), size=ANYWHERE, turns="z"), **tolerances)


def between(points: Any, count: int = 300) -> Any:
    t = np.linspace(0.0, 1.0, count)[:, None]
    return np.concatenate([a + t * (b - a) for a, b in pairwise(points)])


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_an_axis_points_in_a_direction(axis: Literal["x", "y", "z"]) -> None:
    constraint = PathConstraint.pointing("panda_hand", (0.3, -2.0, 0.5), axis, 0.1)
    R, region = np.asarray(constraint.region.pose.rotation), constraint.region
    unit = np.array([0.3, -2.0, 0.5]) / np.linalg.norm([0.3, -2.0, 0.5])
    np.testing.assert_allclose(R[:, "xyz".index(axis)], unit, atol=1e-12)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) > 0.0 and region.turns == axis and np.isinf(region.size).all()
    assert constraint.rotation_tolerance == 0.1


def test_pointing_down_is_the_upright_cup() -> None:
    path = planner().plan(
        right(), pose(0.25), constraints=PathConstraint.pointing(panda().model.tool), seed=3
    )
    assert path.is_certified
    z = panda().fk(between(path.points))[:, :3, 2]
    assert (z[:, 2] <= -np.cos(0.02)).all()


def test_wrong_directions_are_refused() -> None:
    for arguments in (("hand", (0, 0, 0)), ("hand", (0, 0, 1), "w"), ("hand", (0, 0, 1), "z", -1.0)):
        with pytest.raises((InputError, UnknownName)):
            PathConstraint.pointing(*arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(4))
def test_a_cup_stays_upright_between_the_points_too(seed: int) -> None:
    p = planner().plan(right(), pose(0.25), constraints=upright(rotation_tolerance=0.005), seed=seed)
    assert p and p.is_certified and len(p.points) > 3
    states = between(p.points)
    axis = panda().fk(states)[:, :3, 2]
    assert np.arccos(np.clip(-axis[:, 2], -1.0, 1.0)).max() < 0.005
    assert not panda().collides(states, planner().scene.world).any()
    np.testing.assert_array_equal(p.points[0], right())
    without = planner().plan(right(), pose(0.25), seed=seed)
    assert np.arccos(np.clip(-panda().fk(between(without.points))[:, 2, 2], -1.0, 1.0)).max() > 0.05


def test_the_same_seed_returns_the_same_path() -> None:
    a, b = (
        Planner(panda(), planner().scene.world).plan(right(), pose(0.25), constraints=upright())
        for _ in range(2)
    )
    np.testing.assert_array_equal(a.points, b.points)


def test_points_and_planes_that_the_tool_keeps() -> None:
    robot, tool = panda(), panda().model.tool
    plane = PathConstraint(
        tool, Region(pose(0.0), size=(np.inf, np.inf, 0.1), turns="any"), position_tolerance=0.002
    )
    p = planner().plan(right(), pose(0.25), constraints=plane)
    assert p and p.is_certified
    z = robot.fk(between(p.points))[:, 2, 3]
    assert (np.abs(z - 0.35) < 0.052).all() and np.ptp(z) > 0.01
    line = PathConstraint(tool, Region(pose(0.0, 0.6), size=(0.0, np.inf, 0.0), turns="none"), 0.002, 0.01)
    start = robot.ik(pose(-0.25, 0.6), right(), seed=1).q
    p = robot.plan(start, pose(0.25, 0.6), constraints=[line])
    assert p and p.is_certified
    T = robot.fk(between(p.points))
    assert np.hypot(T[:, 0, 3] - 0.5, T[:, 2, 3] - 0.6).max() < 0.002
    turned = np.einsum("nij,ij->n", T[:, :3, :3], pose(0.0)[:3, :3])
    assert np.arccos(np.clip((turned - 1.0) / 2.0, -1.0, 1.0)).max() < 0.01


def test_joints_that_stay_and_two_constraints_at_once() -> None:
    robot, tool = panda(), panda().model.tool
    ends = {
        "elbow": PathConstraint(
            "panda_link4", Region(robot.fk(right(), "panda_link4"), (2.0, 2.0, 0.5), "any")
        )
    }
    p = planner().plan(
        right(), pose(0.25), constraints=[upright(), *ends.values()], joints=robot.joint_names[:7]
    )
    assert p and p.is_certified and (p.points[:, 7:] == right()[7:]).all()
    height = robot.fk(between(p.points), "panda_link4")[:, 2, 3]
    assert np.abs(height - robot.fk(right(), "panda_link4")[2, 3]).max() < 0.25 + 0.005
    still = [name for name in robot.joint_names if name != "panda_joint3"]
    level = PathConstraint(tool, Region(pose(0.0), size=ANYWHERE, turns="z"))
    p = planner().plan(right(), right() + [0.9, 0, 0, 0, 0, 0, 0], constraints=level, joints=still)
    assert p and (p.points[:, 2] == right()[2]).all()


def test_starts_and_goals_that_violate_are_named() -> None:
    tilted = SE3.from_matrix(pose(0.25)) @ SE3.from_rpy([0.3, 0.0, 0.0])
    p = planner().plan(right(), tilted, constraints=upright())
    assert (
        not p and not p.success and p.outcome == "goal" and "violates the constraints: 15 times" in p.reason
    )
    q = panda().ik(tilted, right(), seed=1).q
    p = planner().plan(q, pose(0.25), constraints=upright())
    assert p.outcome == "start" and "violates" in p.reason
    p = planner().plan(right(), [pose(0.25), tilted.matrix(), tilted], constraints=upright())
    assert p and p.goal == 0
    p = planner().plan(
        right(), [SE3.from_matrix(tilted.matrix()), SE3.from_matrix(pose(0.25))], constraints=upright()
    )
    assert p and p.goal == 1
    assert len(planner().plan(right(), right(), constraints=upright()).points) == 1


def test_wrong_constraints_are_refused() -> None:
    region = Region(pose(0.0), size=ANYWHERE, turns="z")
    with pytest.raises(InputError, match="leaves position and rotation free"):
        PathConstraint("panda_hand", Region(pose(0.0), size=ANYWHERE, turns="any"))
    with pytest.raises(InputError, match="expected a Region"):
        PathConstraint("panda_hand", pose(0.0))  # type: ignore[arg-type]
    for name, value in (
        ("position_tolerance", 0.0),
        ("rotation_tolerance", np.nan),
        ("rotation_tolerance", -1.0),
    ):
        with pytest.raises(InputError, match=name):
            PathConstraint("panda_hand", region, **{name: value})
    with pytest.raises(UnknownName, match="panda_hand"):
        plan(panda(), right(), pose(0.25), constraints=PathConstraint("panda_hnd", region))
    with pytest.raises(InputError, match="does not move"):
        plan(panda(), right(), pose(0.25), constraints=PathConstraint("panda_link0", region))
    with pytest.raises(InputError, match="holds"):
        plan(panda(), right(), pose(0.25), constraints=[region])  # type: ignore[list-item]
    for wrong in ("upright", 5):
        with pytest.raises(InputError, match="`constraints` is"):
            plan(panda(), right(), pose(0.25), constraints=wrong)  # type: ignore[arg-type]
    assert plan(panda(), right(), right(), constraints=None)
    with pytest.raises(InputError, match="finite edges"):
        plan(panda(), right(), Region(pose(0.0), size=ANYWHERE))
    with pytest.raises(InputError, match="edges of a box"):
        Region(pose(0.0), size=(np.nan, 0.0, 0.0))
    with pytest.raises(DtypeError, match="`size`"):
        Region(pose(0.0), size="large")  # type: ignore[arg-type]


def test_tolerances_and_edges_beyond_float32_are_as_good_as_infinite() -> None:
    loose = PathConstraint(panda().model.tool, Region(pose(0.0), size=(1e300,) * 3, turns="z"), 1e300, 1e300)
    path = planner().plan(right(), pose(0.25), constraints=loose)
    assert path.is_certified


def test_paths_along_constraints_become_shorter_and_stay_proved() -> None:
    first = [planner().plan(right(), pose(0.25), constraints=upright(), seed=seed) for seed in range(3)]
    better = [
        planner().plan(right(), pose(0.25), constraints=upright(), improve=1_000, seed=seed)
        for seed in range(3)
    ]
    assert all(p.is_certified for p in (*first, *better)) and all(p.seconds["improve"] > 0.0 for p in better)
    assert all(b.cost <= a.cost + 1e-6 for a, b in zip(first, better, strict=True))
    assert sum(b.cost for b in better) < 0.97 * sum(a.cost for a in first)
    along = Constraints(panda().model, (upright(),))
    for p in better:
        lengths = [length for _, length in p.improvements]
        assert lengths == sorted(lengths, reverse=True) and p.cost <= lengths[-1] * 1.01
        assert along.violations(between(p.points)).max() <= 1.0
    again = planner().plan(right(), pose(0.25), constraints=upright(), improve=1_000, seed=2)
    np.testing.assert_array_equal(again.points, better[2].points)
    still = planner().plan(
        right(), pose(0.25), constraints=upright(), improve=300, joints=panda().joint_names[:7]
    )
    assert still.is_certified


def test_violations_grow_no_faster_than_their_rates() -> None:
    robot, random = panda(), np.random.default_rng(0)
    for size, turns in ((ANYWHERE, "x"), ((np.inf, 0.2, 0.0), "none"), ((0.1, np.inf, np.inf), "any")):
        region = Region(pose(0.2), size=size, turns=turns)  # type: ignore[arg-type]
        constraints = Constraints(robot.model, (PathConstraint("panda_link6", region),))
        q = random.uniform(robot.limits.lower, robot.limits.upper, (2_000, 7))
        change = random.normal(size=q.shape) * 10.0 ** random.uniform(-5, -1, (2_000, 1))
        grown = np.abs(constraints.violations(q + change) - constraints.violations(q))
        assert (grown <= constraints.lipschitz_bounds(change) * (1 + 1e-9)).all()
        assert (grown > 0.2 * constraints.lipschitz_bounds(change)).any()


def test_the_interpreter_grows_the_same_trees() -> None:
    robot = panda()
    place = scene(robot.collision_checker(World(), method="spheres"))
    constraints = Constraints(robot.model, (upright(),))
    search, results = ConstrainedSearch(place, 0.0, 0.01, constraints), []
    goal = robot.ik(pose(-0.15), right(), seed=1).q
    random = np.random.default_rng(2)
    samples = (right() + random.normal(size=(6, 7)) * 0.2).astype(np.float32)
    for how in ("__call__", "checked", "interpret"):
        storage = thread_storage(robot.nq)
        storage.make_trees(256)
        workspace: Any = search._workspace(8.0)
        points = np.array([right(), goal], np.float32)
        arguments: tuple[Any, ...] = (
            place.robot.kernel, workspace._tables, workspace._growth, samples, 0, 6, points, np.zeros(2, np.float32), 2,
            storage.trees, constraints.step_kernel, workspace.projection, workspace._work,
        )  # fmt: skip
        done = getattr(projected_rrt.grow_along.specialized(W=place.lanes), how)(*arguments)
        results.append((done, storage.trees))
    (done, trees), *others = results
    assert trees.counts.sum() > 4
    for other, same in others:
        assert other == done
        np.testing.assert_array_equal(same.counts, trees.counts)
        np.testing.assert_array_equal(same.parents, trees.parents)
        np.testing.assert_allclose(same.nodes, trees.nodes, atol=2e-5)


def test_a_motion_that_cuts_corners_keeps_constraints_and_touches_nothing() -> None:
    robot = panda()
    p = planner_with_margin().plan(right(), pose(0.25), constraints=upright())
    assert p.is_certified
    resting, flowing = p.trajectory(acceleration=8.0), p.trajectory(acceleration=8.0, blend=True)
    assert flowing.duration < 0.5 * resting.duration
    states, v = flowing.state(np.linspace(0.0, flowing.duration, 20_000))[:2]
    assert np.arccos(np.clip(-robot.fk(states)[:, 2, 2], -1.0, 1.0)).max() < 0.02
    assert not robot.collides(states, planner().scene.world, method="spheres").any()
    assert np.linalg.norm(v[500:-500], axis=1).min() > 0.01  # it does not stop on the way
    np.testing.assert_allclose(states[[0, -1]], p.points[[0, -1]], atol=1e-9)
    with pytest.raises(InputError, match="plan with margin"):
        planner().plan(right(), pose(0.25)).trajectory(blend=True)


@cache
def planner_with_margin() -> Planner:
    return Planner(panda(), planner().scene.world, margin=0.005)


def test_constraints_that_contradict_each_other_end_at_once_with_a_reason() -> None:
    q = panda().configurations["ready"]
    tool = panda().model.tool
    up, down = (PathConstraint.pointing(tool, (0.0, 0.0, z)) for z in (1.0, -1.0))
    for goal in (q + 0.1, pose(0.2)):
        p = planner().plan(q, goal, constraints=[up, down])
        assert not p and p.outcome == "start" and "violates the constraints" in p.reason and not len(p.points)
    walls = [
        PathConstraint(tool, Region((x, 0.0, 0.3), size=(0.0, np.inf, np.inf), turns="any"))
        for x in (0.2, 0.8)
    ]
    assert planner().plan(q, q, constraints=walls).outcome == "start"


@pytest.mark.parametrize("number", [np.nan, np.inf])
def test_motions_without_a_finite_rate_are_not_proved(number: float) -> None:
    constraints = Constraints(panda().model, (upright(),))
    points = np.array([right(), right(), right()])
    assert constraints.unproved_edges(points) == []
    points[2, 3] = number
    with np.errstate(invalid="ignore"):
        assert constraints.unproved_edges(points) == [1]


@pytest.mark.parametrize("turns", ["none", "x", "y", "z"])
def test_the_rotation_error_leads_back_from_any_rotation(turns: Any) -> None:
    """Half turns and rotations next to them, too, where a cross product has no direction or a small one."""
    vectors = np.random.default_rng(0).normal(size=(50, 3)) * 2.0
    near = np.array([[np.pi - 1e-9, 0.0, 1e-10], [0.0, 1e-10, 3.14], [0.0, 0.0, 1e-13]])
    half_turns = [np.diag(signs) for signs in ([1.0, -1, -1], [-1.0, 1, -1], [-1.0, -1, 1])]
    R = np.concatenate([so3_exp(vectors), so3_exp(near), half_turns, np.eye(3)[None]])
    phi, angle = _rotation_error(R, turns)
    back = so3_exp(phi) @ R
    columns = range(3) if turns == "none" else ["xyz".index(turns)]
    for k in columns:
        np.testing.assert_allclose(back[..., k], np.broadcast_to(np.eye(3)[k], (len(R), 3)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(phi, axis=-1), angle, atol=1e-12)
