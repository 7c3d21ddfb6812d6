"""Collision-free inverse kinematics: what is returned is free by the exact check, and a refusal tells the truth."""

from types import SimpleNamespace

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.collision.touches import deepest_touch
from ulna.errors import InputError, ModelError, ShapeError, UnknownName
from ulna.geometry import Box, Sphere
from ulna.ik.free import FreeSolver
from ulna.model import ModelBuilder, Prismatic

HERE = np.array([0.3, -1.2, 1.4, -1.6, -1.5, 0.2])


@pytest.fixture(scope="module")
def ur5():
    return ulna.load("ur5")


@pytest.fixture(scope="module")
def panda():
    return ulna.load("panda")


@pytest.fixture(scope="module")
def shelf():
    world = World().add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])
    for name, size, place in (
        ("left", (0.4, 0.02, 0.8), (0.55, 0.3, 0.4)),
        ("right", (0.4, 0.02, 0.8), (0.55, -0.3, 0.4)),
        ("top", (0.4, 0.6, 0.02), (0.55, 0.0, 0.8)),
        ("middle", (0.4, 0.6, 0.02), (0.55, 0.0, 0.4)),
        ("back", (0.02, 0.6, 0.8), (0.75, 0.0, 0.4)),
    ):
        world = world.add(name, Box(size), place)
    return world


def is_answer(robot, solution, T, world=None, **options):
    assert np.abs(robot.fk(solution.q) - T).max() < 2e-6
    assert robot.limits.contains(solution.q, 1e-12)
    assert not robot.collides(solution.q, world, **options)
    return bool(solution)


def test_without_obstacles_in_the_way_an_arm_stays_where_it_is(ur5):
    solution = ur5.ik_free(ur5.fk(HERE), q0=HERE)
    assert is_answer(ur5, solution, ur5.fk(HERE))
    np.testing.assert_allclose(solution.q, HERE, atol=1e-6)
    assert solution.candidates == 8 and solution.reason == "" and np.isnan(solution.distance)


def test_a_six_joint_arm_takes_the_nearest_branch_that_is_free(ur5):
    T = ur5.fk(HERE)
    ways = ur5.ik_all(T, q0=HERE).q
    elbow = ur5.fk(HERE, "forearm_link")[
        :3, 3
    ]  # where the elbow would be: this branch and its wrist's twin go
    world = World().add("ball", Sphere(0.1), elbow)
    solution = ur5.ik_free(T, world, HERE)
    assert is_answer(ur5, solution, T, world)
    free = ways[~ur5.collides(ways, world)]
    assert 0 < len(free) < len(ways)
    np.testing.assert_allclose(solution.q, free[0], atol=1e-5)
    assert np.linalg.norm(solution.q - HERE) > 0.5


def test_all_branches_collide_and_that_is_said_with_the_pair_that_is_least_deep(ur5):
    T = ur5.fk(HERE)
    world = World().add("ball", Sphere(0.1), T[:3, 3])
    solution = ur5.ik_free(T, world, HERE)
    assert not solution and solution.candidates == 8
    ways = ur5.ik_all(T, q0=HERE).q
    assert solution.distance == pytest.approx(ur5.distance(ways, world).distance.max(), abs=1e-4)
    assert solution.distance == pytest.approx(float(ur5.distance(solution.q, world).distance), abs=1e-9)
    assert "8 configurations reach the goal (all there are), and all collide" in solution.reason
    assert "wrist_3_link and ball overlap by 100 mm" in solution.reason
    assert "no free solution" in repr(solution)


def test_a_margin_is_kept_or_its_lack_is_named(ur5):
    T = ur5.fk(HERE)
    gap = float(ur5.distance(ur5.ik_all(T).q).distance.max())
    assert is_answer(ur5, ur5.ik_free(T, margin=0.9 * gap), T, margin=0.9 * gap)
    refused = ur5.ik_free(T, margin=gap + 1e-3)
    assert not refused and refused.distance == pytest.approx(gap, abs=1e-5)
    assert f"mm apart, less than the margin of {1e3 * gap + 1:.3g} mm" in refused.reason


def test_goals_within_a_shelf_that_a_redundant_arm_can_reach_are_reached(panda, shelf):
    q = panda.random_configuration(6000, seed=3)
    q = q[~panda.collides(q, shelf, method="spheres")]
    T = panda.fk(q)
    x, y, z = np.moveaxis(T[:, :3, 3], -1, 0)
    T = T[(x > 0.35) & (x < 0.75) & (np.abs(y) < 0.3) & (z < 0.8)][:25]
    alone = panda.collides([panda.ik(goal).q for goal in T], shelf)
    assert alone.any()  # it matters
    found = panda.ik_free(T, shelf)
    assert found.success.all() and found.reason.tolist() == [""] * len(T)
    assert np.abs(panda.fk(found.q) - T).max() < 2e-6 and panda.limits.contains(found.q, 1e-12).all()
    assert not panda.collides(found.q, shelf).any()
    assert (found.candidates[alone] > 1).all()


def test_a_redundant_arm_gives_way_to_a_moving_obstacle_and_stays_near(panda):
    q = np.array(panda.configurations["qr"])
    T = panda.fk(q)
    world = World().add("ball", Sphere(0.06), (2.0, 0.0, 0.0), moving=True)
    elbow = panda.fk(q, "panda_link4")
    assert panda.collides(q, world, moving={"ball": elbow})
    solution = panda.ik_free(T, world, q, moving={"ball": elbow}, margin=0.01)
    assert is_answer(panda, solution, T, world, moving={"ball": elbow}, margin=0.01)
    far = panda.ik_free(T, world, q)
    np.testing.assert_allclose(far.q, q, atol=1e-5)
    again = panda.ik_free(T, world, q, moving={"ball": elbow}, margin=0.01)
    np.testing.assert_array_equal(solution.q, again.q)  # the same seed, the same answer
    ways = panda.ik_all(T, q0=q, samples=500).q
    free = ways[~panda.collides(ways, world, moving={"ball": elbow}, margin=0.01)]
    assert np.linalg.norm(solution.q - q) < 1.3 * np.linalg.norm(free[0] - q)


def test_what_cannot_be_reached_is_distinguished_from_what_collides(panda, ur5):
    for robot in (panda, ur5):
        T = np.eye(4)
        T[0, 3] = 3.0
        solution = robot.ik_free(T)
        assert not solution and solution.candidates == 0 and np.isnan(solution.distance)
        assert "no configuration was found that reaches the goal" in solution.reason
        assert robot.limits.contains(solution.q, 1e-12)


def test_a_redundant_arm_claims_no_more_than_it_looked_at(panda):
    T = panda.fk(panda.configurations["qr"])
    world = World().add("ball", Sphere(0.05), T[:3, 3])
    solution = panda.ik_free(T, world, attempts=20)
    assert not solution and 1 < solution.candidates <= 20
    assert "(as many as were found)" in solution.reason and " and ball overlap by " in solution.reason


def test_masks_frames_and_chosen_joints(panda, ur5):
    T = ur5.fk(HERE)
    world = World().add("ball", Sphere(0.05), ur5.fk(HERE, "forearm_link")[:3, 3])
    point = ur5.ik_free(T, world, mask="position")
    assert point and np.abs(ur5.fk(point.q)[:3, 3] - T[:3, 3]).max() < 2e-6
    hand = panda.ik_free({"panda_hand": panda.fk(panda.configurations["qr"], "panda_hand")})
    assert hand and hand.position_error < 1e-6
    q0 = np.array(panda.configurations["qr"])
    part = panda.ik_free(panda.fk(q0), None, q0 + [0, 0.1, 0.1, 0.1, 0, 0.1, 0], joints=panda.joint_names[1:])
    assert part and part.q[0] == q0[0]


def test_batches_take_a_start_for_each_goal(ur5):
    q = np.array([[HERE, HERE + 0.1]])
    T = ur5.fk(q)
    found = ur5.ik_free(T, q0=q)
    assert (
        found.q.shape == (1, 2, 6) and found.success.shape == (1, 2) and found.reason.tolist() == [["", ""]]
    )
    np.testing.assert_allclose(found.q, q, atol=1e-5)
    assert repr(found) == "<2 free IK solutions, 2 of them successful>"
    with pytest.raises(TypeError, match="no single truth"):
        bool(found)
    assert ur5.ik_free(np.zeros((0, 4, 4))).q.shape == (0, 6)


@pytest.mark.parametrize("is_fitted", [False, True])
def test_large_batches_answer_as_single_goals_do(shelf, is_fitted, monkeypatch):
    from ulna.collision import covering

    monkeypatch.setattr(covering, "is_fitted", lambda *_: is_fitted)
    robot = ulna.load("panda")
    world = shelf.add("wall", Box((2.0, 0.1, 2.0)), (0.0, -0.45, 0.5))
    T = robot.fk(robot.random_configuration(90, seed=5))
    answers = robot.ik_free(T, world, seed=2, attempts=60)
    assert 0.2 < answers.success.mean() < 0.95
    assert not robot.collides(answers.q[answers.success], world).any()
    assert np.abs(robot.fk(answers.q[answers.success]) - T[answers.success]).max() < 2e-6
    assert robot.limits.contains(answers.q, 1e-12).all()
    for k in range(0, 90, 9):
        single = robot.ik_free(T[k], world, seed=2, attempts=60)
        assert bool(single) == answers.success[k] and (single.reason == "") == (answers.reason[k] == "")
    refused = np.flatnonzero(~answers.success)
    assert all("collide" in answers.reason[k] or "reaches" in answers.reason[k] for k in refused)


def test_covering_spheres_decide_when_asked_to(panda, shelf):
    T = panda.fk(panda.random_configuration(40, seed=7))
    answers = panda.ik_free(T, shelf, method="spheres", attempts=40)
    assert 0.2 < answers.success.mean() < 0.95
    free = answers.q[answers.success]
    assert not panda.collides(free, shelf, method="spheres").any() and not panda.collides(free, shelf).any()
    assert np.abs(panda.fk(free) - T[answers.success]).max() < 2e-6
    checker = panda.collision.checker(shelf, method="spheres")
    for k in np.flatnonzero(~answers.success & (answers.distance < 0.0)):
        assert answers.distance[k] == pytest.approx(checker.clearance(answers.q[k]), abs=1e-9)
        assert "overlap by" in answers.reason[k]


def test_covering_spheres_see_a_moving_obstacle_and_name_it(panda):
    q = np.array(panda.configurations["qr"])
    world = World().add("ball", Sphere(0.3), (2.0, 0.0, 0.0), moving=True)
    at_hand = {"ball": panda.fk(q)}
    assert panda.ik_free(panda.fk(q), world, q, method="spheres")
    checker = panda.collision.checker(world, method="spheres")
    for row in (q, *panda.random_configuration(20, seed=3)):
        for moving in (None, at_hand):
            distance, *_ = deepest_touch(checker, row, moving)
            assert distance == pytest.approx(checker.clearance(row, moving), abs=1e-9)
    refused = panda.ik_free(panda.fk(q), world, q, method="spheres", moving=at_hand, attempts=8)
    assert not refused and "ball" in refused.reason
    with pytest.raises(UnknownName, match="spheres"):
        panda.ik_free(panda.fk(q), method="sphere")


def test_wrong_questions(ur5):
    T = ur5.fk(HERE)
    with pytest.raises(InputError, match="margin"):
        ur5.ik_free(T, margin=-0.1)
    with pytest.raises(InputError, match="attempts"):
        ur5.ik_free(T, attempts=0)
    with pytest.raises(ShapeError, match="T"):
        ur5.ik_free(np.eye(3))
    with pytest.raises(ShapeError, match="q0"):
        ur5.ik_free(T, q0=np.zeros(5))
    with pytest.raises(InputError, match="is not a rotation"):
        ur5.ik_free(2.0 * T)
    with pytest.raises(UnknownName, match="hand"):
        ur5.ik_free(T, frame="hand")
    with pytest.raises(UnknownName, match="boll"):
        ur5.ik_free(T, World().add("ball", Sphere(0.1)), moving={"boll": np.eye(4)})
    builder = ModelBuilder("bare")
    builder.add_link("rail")
    builder.add_link("cart")
    builder.add_joint("slide", Prismatic((1.0, 0.0, 0.0)), "rail", "cart", lower=-1.0, upper=1.0)
    with pytest.raises(ModelError, match="collision geometry"):
        ulna.Robot(builder.build()).ik_free(np.eye(4), mask="position")


def test_batches_of_several_axes_and_of_none_keep_their_shape(panda, shelf):
    T = panda.fk(panda.random_configuration(6, seed=3)).reshape(2, 3, 4, 4)
    answers = panda.ik_free(T, shelf, attempts=20)
    assert answers.q.shape == (2, 3, 7) and answers.success.shape == answers.reason.shape == (2, 3)
    flat = panda.ik_free(T.reshape(6, 4, 4), shelf, attempts=20)
    np.testing.assert_array_equal(answers.q.reshape(6, 7), flat.q)
    assert (answers.candidates[answers.success] > 0).all() and (answers.reason[answers.success] == "").all()
    none = panda.ik_free(T[:, :0], shelf)
    assert none.q.shape == (2, 0, 7) and none.success.dtype == bool


def test_configurations_found_twice_count_once(panda):
    _, solver = panda._solver(np.eye(4), None, None, None)
    search = FreeSolver(solver, SimpleNamespace(model=panda.model), panda._kernel("distance"))
    random = np.random.default_rng(0)
    for _ in range(20):
        home = panda.random_configuration(seed=random)
        points = panda.random_configuration(6, seed=random)
        q = points[random.integers(0, 6, 30)] + 4e-4 * random.uniform(-1.0, 1.0, (30, 7))
        known = points[:2] + 1e-4
        expected: list[int] = []
        for k in np.argsort(np.linalg.norm(q - home, axis=1)).tolist():
            others = np.concatenate([known, q[expected]])
            if (np.linalg.norm(others - q[k], axis=1) >= 1e-3).all():
                expected.append(k)
        assert search._distinct(q, known, home) == expected
        assert search._distinct(q[:0], known, home) == []
    assert (
        search._distinct(points, known[:0], home)
        == np.argsort(np.linalg.norm(points - home, axis=1)).tolist()
    )


def test_a_straight_wrist_turns_until_nothing_touches(ur5):
    """Two joints then share a turn: each of the branches stands for many configurations, and no "no" is final."""
    q = np.array([0.4, -1.3, 1.6, -0.5, 0.0, 0.3])
    T = ur5.fk(q)
    ways = ur5.ik_all(T).q
    world = World()
    for k, way in enumerate(ways):
        middle = 0.5 * (ur5.fk(way, "forearm_link") + ur5.fk(way, "wrist_1_link"))[:3, 3]
        world = world.add(f"ball{k}", Sphere(0.03), middle)
    assert ur5.collides(ways, world).all()
    assert is_answer(ur5, ur5.ik_free(T, world), T, world)
    around = World().add("ball", Sphere(0.1), T[:3, 3])
    assert "(as many as were found), and all collide" in ur5.ik_free(T, around).reason
