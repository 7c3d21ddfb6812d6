"""Checks in float32 lanes: the same answers as float64, whatever the world, the robot and the threads."""

from __future__ import annotations

import pickle
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import SphereChecker, World
from ulna.collision.compiled import TOUCH
from ulna.collision.lanes.batches import which_touch
from ulna.collision.lanes.moving import links_of
from ulna.collision.lanes.single import DOUBTFUL, FREE, TOUCHING
from ulna.collision.lanes.tables import Scene
from ulna.collision.spheres import LinkSpheres, Spheres
from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError
from ulna.geometry import Box, Capsule, Cylinder, Plane, PointCloud, Sphere
from ulna.spatial import SE3
from ulna.typing import Floats


def cluttered(seed: int, count: int = 8, cloud: bool = True) -> World:
    """Obstacles of all kinds at random places."""
    rng = np.random.default_rng(seed)
    shapes: list[Any] = [Box((0.2, 0.1, 0.3)), Sphere(0.12), Cylinder(0.05, 0.3), Capsule(0.05, 0.3)]
    if cloud:
        shapes.append(PointCloud(rng.uniform(-0.1, 0.1, (300, 3)), 0.01))
    world = World().add("floor", Plane(), (0.0, 0.0, -0.7))
    for k in range(count):
        angle, height = rng.uniform(-np.pi, np.pi), rng.uniform(-0.2, 1.0)
        place = rng.uniform(0.5, 0.9) * np.array([np.cos(angle), np.sin(angle), 0.0]) + (0.0, 0.0, height)
        pose = SE3.from_translation(place) @ SE3.from_rpy(rng.uniform(-2.0, 2.0, 3))
        world = world.add(f"obstacle {k}", shapes[k % len(shapes)], pose)
    return world


def by_float64(checker: SphereChecker, q: Floats, margin: float = 0.0) -> Any:
    return checker._evaluate("free", q, None, np.minimum, margin + TOUCH, None) < 0.5


def within_limits(robot: ulna.Robot, count: int, seed: int) -> Floats:
    return robot.random_configuration(count, seed=seed)


@pytest.mark.parametrize("margin", [0.0, 0.03])
@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_batches_say_what_float64_says(name: str, margin: float) -> None:
    robot = ulna.load(name)
    checker = SphereChecker(robot.model, cluttered(1))
    q = within_limits(robot, 1500, 2)
    answer = checker.collides(q, margin=margin)
    assert checker._batches  # float32 was asked
    np.testing.assert_array_equal(answer, by_float64(checker, q, margin))
    assert answer.mean() > 0.05 and (margin or answer.mean() < 0.95)
    twice = checker.collides(np.tile(q, (2, 1)), margin=margin, threads=3)  # so many that threads share them
    np.testing.assert_array_equal(twice, np.tile(answer, 2))
    np.testing.assert_array_equal(
        checker.collides(q.reshape(5, 300, -1), margin=margin), answer.reshape(5, 300)
    )
    assert [checker.collides(row, margin=margin) for row in q[:300]] == answer[:300].tolist()
    assert type(checker.collides(q[0])) is bool


def test_what_is_carried_and_margins_of_pairs_count() -> None:
    robot = ulna.load("panda")
    world = cluttered(3, cloud=False)
    world = world.set_margin("panda_hand", "obstacle 0", 0.2)
    held = world.attach("ball", "panda_hand", (0.0, 0.0, 0.3), shape=Sphere(0.15), touches=["panda_hand"])

    q = within_limits(robot, 800, 4)
    answers = []
    for each in (world, held):
        checker = SphereChecker(robot.model, each)
        answers.append(checker.collides(q))
        np.testing.assert_array_equal(answers[-1], by_float64(checker, q))
    assert (answers[0] != answers[1]).any()


def test_out_of_limits_and_many_turns_are_left_to_float64() -> None:
    robot = ulna.load("panda")
    checker = SphereChecker(robot.model, cluttered(5))
    q = within_limits(robot, 200, 6)
    q[::3] *= 3.0
    q[1::3, 0] += 2.0e5 * np.pi  # float32 would place the hand centimetres off
    expected = by_float64(checker, q)
    assert [checker.collides(row) for row in q] == expected.tolist()
    np.testing.assert_array_equal(checker.collides(q), expected)


def test_on_the_very_edge_float64_decides() -> None:
    """Balls that the nearest sphere of the hand touches, or misses, by less than float32 can tell."""
    robot = ulna.load("panda")
    q = np.repeat(robot.configurations["qr"][None], 64, axis=0)
    centre = robot.fk(q[0], "panda_hand")[:3, 3] + (0.4, 0.3, 0.5)
    bare = SphereChecker(robot.model, World().add("ball", Sphere(0.01), centre), pairs=())
    gap = float(bare.clearance(q[0]))
    for change, expected in ((2e-6, True), (-2e-6, False)):
        near = SphereChecker(
            robot.model, World().add("ball", Sphere(0.01 + gap + change - TOUCH), centre), pairs=()
        )
        assert near.collides(q[0]) is expected  # one by one, without a kernel
        assert near.collides(q).tolist() == [expected] * 64


def test_worlds_that_float32_cannot_hold_are_still_checked() -> None:
    robot = ulna.load("panda")
    far = cluttered(8).add("moon", Sphere(10.0), (500.0, 0.0, 0.0))
    checker = SphereChecker(robot.model, far)
    q = within_limits(robot, 64, 9)
    np.testing.assert_array_equal(checker.collides(q), SphereChecker(robot.model, cluttered(8)).collides(q))
    assert checker._scene is None


def test_nan_is_refused_or_touches_as_in_small_batches() -> None:
    robot = ulna.load("panda")
    checker = SphereChecker(robot.model, cluttered(10))
    q = within_limits(robot, 64, 11)
    q[5, 2] = np.nan
    results = []
    for rows in (q, q[:6]):
        try:
            results.append(checker.collides(rows)[5])
        except ulna.errors.UlnaError as error:
            results.append(type(error))
    assert results[0] == results[1]


def test_what_float32_cannot_hold_is_left_to_float64_without_a_warning() -> None:
    robot = ulna.load("panda")
    checker, q = SphereChecker(robot.model, cluttered(4)), within_limits(robot, 64, 7)
    q[::2, 3], q[1::2, 5] = 1e308, -1e39
    expected = by_float64(checker, q)
    assert checker.collides(q).tolist() == expected.tolist() == [checker.collides(row) for row in q]
    for margin in (1e39, 1e308):
        assert checker.collides(q[0], margin=margin) is True
        assert checker.collides(q, margin=margin).all()


def test_a_single_array_is_checked_as_any_configuration_is() -> None:
    robot = ulna.load("panda")
    checker, rows = SphereChecker(robot.model, cluttered(4)), within_limits(robot, 60, 5)
    answers = checker.collides(rows)
    for q, answer in zip(rows, answers, strict=True):
        for given in (q, q.tolist(), q.astype(">f8"), np.stack([q, q], axis=1)[:, 0]):
            assert checker.collides(given) is bool(answer)
    for wrong, error in ((np.append(rows[0, :6], np.nan), NonFiniteError), (rows[0, :6], ShapeError)):
        with pytest.raises(error):
            checker.collides(wrong)
    with pytest.raises(DtypeError):
        checker.collides(rows[0].astype(complex))
    with pytest.raises(InputError, match="margin"):
        checker.collides(rows[0], margin=-0.1)


def test_interpreter_and_checked_code_agree_with_machine_code() -> None:
    robot = ulna.load("panda")
    checker = SphereChecker(robot.model, cluttered(12))
    model, spheres, pairs = checker.model, checker.spheres, checker.pairs
    place = Scene(links_of(model, spheres, pairs, "error"), spheres, pairs, checker.world, "error")
    q = np.concatenate([within_limits(robot, 30, 13), np.tile(robot.configurations["qr"], (14, 1))])
    q[3, 2], q[7, 0], q[9, 6] = 1e308, np.nan, -1e39
    results = []
    for how in ("__call__", "checked", "interpret"):
        answers = np.full(-(-len(q) // place.lanes) * place.lanes, 7.0, np.float32)
        call = getattr(which_touch.specialized(W=place.lanes), how)
        less, ends = np.float32(2.0 * place.moving.rounding), place.robot.range
        call(place.robot.kernel, place.check_tables(0.0, 1.0), less, *ends, q, answers, place.moving.work())
        results.append(answers[: len(q)])
    np.testing.assert_array_equal(results[0], results[1])
    np.testing.assert_array_equal(results[0], results[2])
    assert (results[0][[3, 7, 9]] == DOUBTFUL).all()
    assert {FREE, TOUCHING} < set(results[0].tolist()) <= {FREE, TOUCHING, DOUBTFUL}


def test_spheres_too_small_for_float32_are_left_to_float64() -> None:
    robot = ulna.load("panda")
    world = World().add("ball", Sphere(0.05), (0.4, 0.1, 0.5))
    covering = SphereChecker(robot.model).spheres
    dots = {
        name: LinkSpheres(balls.centres, np.full(len(balls.radii), 1e-5))
        for name, balls in covering.links.items()
    }
    checker = SphereChecker(robot.model, world, spheres=Spheres(dots), pairs=())
    q = within_limits(robot, 400, 3)
    answer = checker.collides(q)
    np.testing.assert_array_equal(answer, by_float64(checker, q))
    assert answer.any() and not answer.all()


def test_spheres_that_can_meet_are_read_from_the_disk(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from ulna.collision.lanes import sphere_pairs

    checker = SphereChecker(ulna.load("ur5").model)
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))
    robot = links_of(checker.model, checker.spheres, checker.pairs, "error")
    numbers = tuple(pair[:2] for pair in robot.pairs)
    arguments = robot.model, robot.groups, numbers, robot.bounds_of_motion[1]
    first = sphere_pairs.meeting_spheres(*arguments)
    expected = [
        sphere_pairs.can_meet(robot.model, robot.groups[a], robot.groups[b], row)
        for (a, b), row in zip(numbers, robot.bounds_of_motion[1], strict=True)
    ]
    with monkeypatch.context() as patch:
        patch.setattr(sphere_pairs, "can_meet", None)  # not called again
        second = sphere_pairs.meeting_spheres(*arguments)
    for masks in (first, second):
        assert len(masks) == len(expected)
        for mask, right in zip(masks, expected, strict=True):
            np.testing.assert_array_equal(mask, right)
    monkeypatch.setenv("ULNA_CACHE", "0")
    assert len(sphere_pairs.meeting_spheres(*arguments)) == len(expected)
    assert sphere_pairs.meeting_spheres(robot.model, robot.groups, (), robot.bounds_of_motion[1][:0]) == []


def test_threads_and_copies_of_a_checker_agree() -> None:
    robot = ulna.load("ur5")
    checker = SphereChecker(robot.model, cluttered(14))
    q = within_limits(robot, 2000, 15)
    expected = by_float64(checker, q)
    barrier = threading.Barrier(4)

    def ask(_: int) -> Any:
        barrier.wait(30.0)
        answers = []
        for k in range(12):  # more margins than the checker keeps
            checker.collides(q[:64], margin=1e-3 * k)
            answers.append(checker.collides(q))
        return answers

    with ThreadPoolExecutor(4) as pool:
        for answers in pool.map(ask, range(4)):
            for answer in answers:
                np.testing.assert_array_equal(answer, expected)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(checker)).collides(q), expected)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_many_random_worlds(seed: int) -> None:
    robot = ulna.load(["panda", "ur5"][seed % 2])
    for k in range(6):
        world = cluttered(100 * seed + k, count=4 + 6 * k)
        if k % 2:
            world = world.set_margin(robot.model.links[-1].name, "obstacle 0", 0.05)
        checker = SphereChecker(robot.model, world)
        q = within_limits(robot, 4000, k)
        np.testing.assert_array_equal(checker.collides(q), by_float64(checker, q))
