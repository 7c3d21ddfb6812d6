"""Straight lines between configurations stay on the manifold."""

from itertools import pairwise

import numpy as np
import pytest

from ulna import trajectory
from ulna.errors import InputError
from ulna.model import Circle, Continuous, FreeFlyer, Model, ModelBuilder, Revolute, Spherical
from ulna.robot import Robot
from ulna.spatial import SE3, SO3, Inertia, quat_exp


@pytest.fixture(scope="module")
def robot() -> Robot:
    """A free flyer with a joint with limits and a continuous one."""
    b = ModelBuilder("flyer")
    b.add_link("world")
    b.add_link("body", Inertia.from_box(2.0, (0.2, 0.3, 0.4)))
    b.add_joint("base", FreeFlyer(), "world", "body")
    for k in range(2):
        b.add_link(f"link{k}", Inertia.from_com(1.0, (0.1, 0.0, 0.2), (0.1, 0, 0, 0.1, 0, 0.1)))
        parent = "body" if k == 0 else "link0"
        limits = {"lower": -2.0, "upper": 2.0} if k == 0 else {}
        b.add_joint(f"j{k}", Revolute((0, 1, k)), parent, f"link{k}", SE3.trans(0, 0, 0.3), **limits)
    model: Model = b.build()
    return Robot(model)


@pytest.fixture
def ends() -> tuple[np.ndarray, np.ndarray]:
    q0 = np.concatenate([[0, 1, 2], quat_exp(np.array([0.3, -0.2, 0.1])), [0.5, 1.0]])
    q1 = np.concatenate([[1, -1, 0], quat_exp(np.array([-1.3, 0.9, 1.1])), [-0.7, 2.0]])
    return q0, q1


def test_quaternions_stay_unit_and_rates_are_right(robot: Robot, ends: tuple[np.ndarray, np.ndarray]) -> None:
    t = trajectory.straight(robot, *ends, duration=2.0)
    times = np.linspace(0.0, 2.0, 41)
    q, v, a = t.state(times)
    np.testing.assert_allclose(np.linalg.norm(q[:, 3:7], axis=1), 1.0, atol=1e-14)
    assert robot.is_same_configuration(t.end, ends[1], 1e-12)
    h = 1e-6
    inner = times[1:-1]
    np.testing.assert_allclose(robot.difference(t(inner - h), t(inner + h)) / (2 * h), v[1:-1], atol=1e-8)
    np.testing.assert_allclose((t.v(inner + h) - t.v(inner - h)) / (2 * h), a[1:-1], atol=1e-7)
    assert t.space.columns == tuple(robot.model.position_names)


def test_limits_make_the_law(robot: Robot, ends: tuple[np.ndarray, np.ndarray]) -> None:
    for jerk in (None, 8.0):
        t = trajectory.straight(robot, *ends, velocity=1.0, acceleration=2.0, jerk=jerk)
        rows = t.sample(n=2000)
        assert np.abs(rows.v).max() == pytest.approx(1.0)
        assert np.abs(rows.a).max() <= 2.0 + 1e-9
        assert robot.is_same_configuration(t.end, ends[1], 1e-12)


def test_several_lines(robot: Robot, ends: tuple[np.ndarray, np.ndarray]) -> None:
    q0, q1 = ends
    t = trajectory.straight_through(robot, [q0, q1, q0], [1.0, 2.0])
    assert t.duration == 3.0 and len(t.knots) == 3
    assert robot.is_same_configuration(t(1.0), q1, 1e-12)
    np.testing.assert_allclose(t.v([0.0, 1.0, 3.0]), 0.0, atol=1e-12)
    np.testing.assert_allclose(t.reversed()(0.5), t(2.5), atol=1e-14)
    joined = trajectory.straight(robot, q0, q1, 1.0) + trajectory.straight(robot, q1, q0, 2.0)
    np.testing.assert_allclose(joined([0.3, 2.2]), t([0.3, 2.2]))
    with pytest.raises(InputError, match="jumps"):
        trajectory.straight(robot, q0, q1, 1.0) + trajectory.straight(robot, q0, q1, 1.0)


def test_it_can_be_time_optimal_under_torques(robot: Robot, ends: tuple[np.ndarray, np.ndarray]) -> None:
    path = trajectory.straight(robot, *ends, duration=1.0)
    best = trajectory.time_optimal(
        path.path, robot, torque=[50.0] * 3 + [20.0] * 3 + [15.0] * 2, velocity=4.0, grid=200
    )
    rows = best.sample(n=500)
    tau = robot.inverse_dynamics(rows.q, rows.v, rows.a) / np.array([50.0] * 3 + [20.0] * 3 + [15.0] * 2)
    assert 0.99 < np.abs(tau).max() < 1.02


def test_mistakes_are_named(robot: Robot, ends: tuple[np.ndarray, np.ndarray]) -> None:
    q0, q1 = ends
    with pytest.raises(InputError, match="length is not 1"):
        trajectory.straight(robot, q0, 1.1 * q1, duration=1.0)
    for k in range(3, 7):  # also where the others are 0
        doubled = q1.copy()
        doubled[3:7] = 2.0 * np.eye(4)[k - 3]
        name = robot.model.position_names[k]
        with pytest.raises(
            InputError, match=rf"`q1\[{k}\]`, '{name}', belongs to a quaternion whose length is not 1"
        ):
            trajectory.straight(robot, q0, doubled, duration=1.0)
    with pytest.raises(InputError, match="neither was given"):
        trajectory.straight(robot, q0, q1)
    with pytest.raises(InputError, match="both"):
        trajectory.straight(robot, q0, q1, velocity=1.0)
    with pytest.raises(InputError, match="the same point"):
        trajectory.straight_through(robot, [q0, q0], 1.0)
    with pytest.raises(InputError, match="expected one time or"):
        trajectory.straight_through(robot, [q0, q1, q0], [1.0, 1.0, 1.0])


def test_several_lines_do_not_jump_by_turns_or_signs() -> None:
    """A continuous joint that went on past half a turn came back by a whole one at the way-point."""
    b = ModelBuilder("ball").add_link("base").add_link("arm").add_link("end")
    b.add_joint("wheel", Continuous((0.0, 0.0, 1.0)), "base", "arm").add_joint(
        "ball", Spherical(), "arm", "end"
    )
    robot = Robot(b.build())
    quats = [SO3.rz(angle).quat_xyzw() for angle in (0.0, 2.0, 4.0, 6.0, 8.0)]
    points = np.array([[3.0 * k - 6.3 * (k > 1), *quat] for k, quat in enumerate(quats)])
    t = trajectory.straight_through(robot, points, 1.0)
    rows = t.sample(n=4001)
    assert np.abs(np.diff(rows.q, axis=0)).max() < 0.01
    for k, point in enumerate(points):
        assert robot.is_same_configuration(t(float(k)), point, 1e-12)
    lines = [trajectory.straight(robot, one, two, 1.0) for one, two in pairwise(points)]
    chain = sum(lines[1:], start=lines[0])  # the same points, with other numbers
    for path in (t, chain):
        best = trajectory.time_optimal(path, robot, velocity=1.0, acceleration=2.0)
        assert best.duration == pytest.approx(4.0 * (3.0 / 1.0 + 1.0 / 2.0), rel=0.02)


def test_units_are_known_by_joints_not_by_names() -> None:
    """A joint may be called "aqx"; cosine and sine of an angle have length one, too."""
    b = ModelBuilder("odd").add_link("base").add_link("arm").add_link("end")
    b.add_joint("aqx", Continuous((0.0, 0.0, 1.0)), "base", "arm").add_joint(
        "turn", Circle((0.0, 0.0, 1.0)), "arm", "end"
    )
    robot = Robot(b.build())
    line = trajectory.straight(robot, [0.0, 1.0, 0.0], [7.0, 0.0, 1.0], duration=1.0)
    np.testing.assert_allclose(line.end[1:], [0.0, 1.0], atol=1e-12)
    with pytest.raises(
        InputError, match=r"`q1\[1\]`, 'turn.*', belongs to cosine and sine of an angle whose"
    ):
        trajectory.straight(robot, [0.0, 1.0, 0.0], [0.0, 2.0, 0.0], duration=1.0)
