"""Rows of obstacles: the published damper, and loops that pass by what is in the way without touching it."""

import numpy as np
import pytest

import ulna
from ulna import control
from ulna.collision import World
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.geometry import Box, Sphere
from ulna.ik import DifferentialIK, FrameTask, LinearLimit, PositionLimit, PostureTask, VelocityLimit

BALL = World().add("ball", Sphere(0.1), (0.4, 0.2, 0.4))


@pytest.fixture(scope="module")
def panda():
    return ulna.load("panda")


@pytest.fixture(scope="module")
def q(panda):
    return np.array(panda.configurations["qr"])


@pytest.mark.parametrize("gain", [np.nan, np.inf, -1.0, "slow", None])
def test_a_gain_is_a_finite_speed(panda, q, gain):
    """With nan the rows had bounds of nan."""
    with pytest.raises(InputError, match="`gain` is .*; expected a finite speed, not below 0"):
        control.obstacle_rows(panda, q, BALL, gain=gain)


def test_rows_are_the_velocity_dampers_of_the_near_pairs(panda, q):
    A, b = control.obstacle_rows(panda, q, BALL, influence=0.3, stop=0.05, gain=0.5, own=None)
    near = panda.collision_checker(BALL, pairs=()).nearest(q, within=0.3)
    assert len(near) == len(b) > 3 and A.shape == (len(b), 7)
    for item, row, bound in zip(near, A, b, strict=True):
        assert item.names[1] == "ball"
        np.testing.assert_allclose(row, -item.gradient, atol=1e-12)
        assert bound == pytest.approx(0.5 * max(item.distance - 0.05, 0.0) / 0.25, abs=1e-12)
    v = np.array([0.3, -0.2, 0.1, 0.4, -0.3, 0.2, 0.1])  # rows bound the rate of the true distance
    step = 1e-4
    rate = (float(panda.distance(q + step * v, BALL, pairs=())) - near[0].distance) / step
    assert A[0] @ v == pytest.approx(-rate, abs=1e-3)


def test_rows_of_the_robot_itself_use_their_distances(panda):
    folded = np.array([0.0, -1.0, 0.0, -3.0, 0.0, 3.5, 0.8])
    found = panda.collision_checker().nearest(folded, within=0.1)
    A, b = control.obstacle_rows(panda, folded, own=(0.1, 0.02))
    np.testing.assert_allclose(A, [-item.gradient for item in found], atol=1e-12)
    np.testing.assert_allclose(b, [max(item.distance - 0.02, 0.0) / 0.08 for item in found], atol=1e-12)
    assert len(b) and control.obstacle_rows(panda, folded, own=None)[0].shape == (0, 7)
    less = [item.names for item in found[1:]]
    assert (
        len(control.obstacle_rows(panda, folded, BALL, own=(0.1, 0.02), without=less, influence=0.06)[1]) == 1
    )


def test_standing_still_keeps_every_row_however_near_obstacles_are(panda, q):
    inside = World().add("ball", Sphere(0.1), panda.fk(q, "panda_link5")[:3, 3])
    assert panda.collides(q, inside)
    assert (control.obstacle_rows(panda, q, inside)[1] >= 0.0).all()
    reactive = control.Reactive(panda)
    v = reactive(q, [0.1, 0, 0, 0, 0, 0], rows=control.obstacle_rows(panda, q, inside))
    A, b = control.obstacle_rows(panda, q, inside)
    assert (A @ v <= b + 1e-9).all()


def test_an_obstacle_that_comes_asks_for_retreat(panda, q):
    world = World().add("ball", Sphere(0.1), (0.4, 0.2, 0.4), moving=True)
    pose = ulna.SE3.trans(0.42, 0.22, 0.4)
    still = control.obstacle_rows(panda, q, world, moving={"ball": pose}, own=None)
    twist = np.array([0.1, -0.3, 0.05, 0.4, 0.2, -0.1])
    A, b = control.obstacle_rows(panda, q, world, moving={"ball": pose}, twists={"ball": twist}, own=None)
    np.testing.assert_array_equal(A, still[0])
    step = 1e-6
    after = ulna.SE3.trans(*(np.array([0.42, 0.22, 0.4]) + step * twist[:3]))
    checker = panda.collision_checker(world, pairs=())
    d = [float(checker.distance(q, {"ball": T}).distance) for T in (pose, after)]
    assert b[0] - still[1][0] == pytest.approx(
        (d[1] - d[0]) / step, abs=1e-3
    )  # a turning ball is the same ball


def test_rows_of_a_given_number(panda, q):
    A, b = control.obstacle_rows(panda, q, BALL)
    padded = control.obstacle_rows(panda, q, BALL, count=20)
    assert padded[0].shape == (20, 7) and padded[1].shape == (20,)
    np.testing.assert_array_equal(padded[0][: len(b)], A)
    assert not padded[0][len(b) :].any() and not padded[1][len(b) :].any()
    with pytest.raises(InputError, match=f"at least {len(b)}"):
        control.obstacle_rows(panda, q, BALL, count=2)


@pytest.mark.parametrize("beside", [(0.0, 0.0, 0.08), (0.02, 0.0, 0.15)])
def test_a_panda_servos_past_a_ball_without_touching_it(panda, q, beside):
    start, goal = panda.fk(q), panda.fk(q)
    start[1, 3], goal[1, 3] = -0.3, 0.3
    world = World().add("ball", Sphere(0.05), 0.5 * (start + goal)[:3, 3] + beside)
    least = {}
    for aware in (False, True):
        at, distances = panda.ik(start, q).q, []
        reactive = control.Reactive(panda)
        for _ in range(600):
            twist, arrived = control.p_servo(panda.fk(at), goal, 1.0, 0.01, "angle-axis")
            if arrived:
                break
            rows = None
            if aware:
                rows = control.obstacle_rows(panda, at, world, influence=0.25, stop=0.02)
            at = at + 0.02 * reactive(at, twist, 1.0 / np.abs(twist).sum(), rows)
            distances.append(float(panda.distance(at, world).distance))
        assert arrived and panda.limits.contains(at)
        least[aware] = min(distances)
    assert least[False] < -0.05  # without the rows it goes right through
    assert least[True] > 0.0195  # with them it stops coming nearer at 20 mm, all links, itself included


def test_differential_ik_keeps_links_apart(panda, q):
    """A goal close to the base folds the arm into itself unless the rows forbid it."""
    goal = panda.fk(q)
    goal[:3, 3] = 0.0, 0.1, 0.3
    limits = [VelocityLimit(), PositionLimit(), LinearLimit(20, name="near")]
    ik = DifferentialIK(panda, [FrameTask(panda.tool, gain=0.05), PostureTask(1e-3, target=q)], limits)
    least = {}
    for aware in (False, True):
        at, distances = q, []
        for _ in range(250):
            A, b = control.obstacle_rows(panda, at, own=(0.1, 0.02), count=20)
            at = ik.step(at, 0.01, goal, A, b) if aware else ik.step(at, 0.01, goal, 0.0 * A, b)
            distances.append(float(panda.distance(at).distance))
        least[aware] = min(distances)
    assert least[False] < -0.01 and least[True] > 0.0195


def test_wrong_input(panda, q):
    with pytest.raises(InputError, match="stops at 0.3 m"):
        control.obstacle_rows(panda, q, BALL, influence=0.3, stop=0.3)
    with pytest.raises(InputError, match="`own`"):
        control.obstacle_rows(panda, q, own=(0.01, 0.05))
    with pytest.raises(UnknownName, match="bal"):
        control.obstacle_rows(panda, q, BALL, twists={"bal": np.zeros(6)})
    with pytest.raises(ShapeError, match="twists"):
        control.obstacle_rows(panda, q, BALL, twists={"ball": np.zeros((2, 6))})
    with pytest.raises(ShapeError, match="q"):
        control.obstacle_rows(panda, np.stack([q, q]), BALL)


def test_boxes_work_as_well(panda, q):
    """A table under the arm: rows of every link that is near it, none of the base that stands on it."""
    world = World().add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])
    A, b = control.obstacle_rows(panda, q, world, own=None, influence=0.5)
    assert len(b) >= 3 and (b >= 0.0).all() and np.abs(A).max() > 0.1
