"""Checks against a robot's limits name the joint, the quantity, the time and the excess."""

import numpy as np
import pytest

import ulna
from ulna import trajectory
from ulna.errors import DtypeError, InputError, ShapeError
from ulna.model import FreeFlyer


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


def test_a_gentle_motion_is_within(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    report = trajectory.check(panda, trajectory.quintic(q, q + 0.1, 2.0), acceleration=5.0, jerk=50.0)
    assert report and not report.breaches
    assert set(report.use) == {"position", "velocity", "acceleration", "jerk", "torque"}
    assert "Within the limits of 'panda'" in str(report)
    report.require()


def test_the_worst_is_found_between_samples(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    step = np.zeros(7)
    step[3] = 1.0
    t = trajectory.quintic(q, q + step, 0.5)
    report = trajectory.check(panda, t, torque=False, samples=5)
    (breach,) = report
    assert (breach.joint, breach.quantity) == ("panda_joint4", "velocity")
    assert breach.time == pytest.approx(0.25, abs=1e-3)
    assert breach.value == pytest.approx(15 / 8 / 0.5, rel=1e-6)
    assert breach.limit == panda.limits.velocity[3]
    with pytest.raises(
        InputError, match=r"panda_joint4: velocity 3\.75 exceeds 2\.175 by 1\.5[78] rad/s at 0\.25 s"
    ):
        report.require()


def test_positions_and_torques(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    below = q.copy()
    below[3] = panda.limits.lower[3] - 0.25
    report = trajectory.check(panda, trajectory.quintic(q, below, 3.0))
    assert [(b.joint, b.quantity) for b in report] == [("panda_joint4", "position")]
    assert report.breaches[0].excess == pytest.approx(0.25) and report.breaches[0].time == pytest.approx(
        3.0, abs=1e-2
    )
    heavy = panda.with_payload(mass=30.0)
    broken = trajectory.check(heavy, trajectory.quintic(q, q + 0.1, 2.0))
    assert {b.quantity for b in broken} == {"torque"}


def test_jumps_at_knots_are_seen_from_both_sides(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    t = trajectory.trapezoidal(q, q + 0.3, 1.0, [5.0] * 7)
    assert trajectory.check(panda, t, acceleration=5.0, torque=False, samples=2)
    report = trajectory.check(panda, t, acceleration=[5.0] * 6 + [4.9], torque=False, samples=2)
    assert [b.joint for b in report] == ["panda_joint7"]


def test_it_must_be_that_robots_motion(panda: ulna.Robot) -> None:
    with pytest.raises(ShapeError, match="configurations of 'panda'"):
        trajectory.check(panda, trajectory.quintic(0.0, 1.0, 1.0))
    with pytest.raises(InputError, match="pose"):
        trajectory.check(panda, trajectory.pose_line(ulna.SE3.identity(), ulna.SE3.rx(1.0), 1.0))
    with pytest.raises(InputError, match=r"acceleration\[0\]"):
        trajectory.check(panda, trajectory.quintic(np.zeros(7), np.ones(7), 1.0), acceleration=-1.0)


def test_corners_of_a_path_under_another_law_are_seen(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    step = np.zeros(7)
    step[0] = 0.5
    path = trajectory.blended([q, q + step, q + 2.0 * step[::-1]], blend=1e-3, segment_times=[5, 5])
    slow = path.retimed(trajectory.cubic(0.0, 10.0, 10.0))
    assert isinstance(slow, trajectory.Retimed)
    inner = path.knots[1:-1]
    times = slow.knots[1:-1]
    np.testing.assert_allclose(slow.law(times)[:, 0], inner, atol=1e-12)
    peak = np.abs(slow.a(np.linspace(4.99, 5.01, 2001))).max()
    assert trajectory.check(panda, slow, acceleration=50.0, torque=False).use["acceleration"] >= peak / 50.0
    back = slow.reversed()
    np.testing.assert_allclose(back.knots, (10.0 - slow.knots)[::-1], atol=1e-9)


def test_short_pieces_between_knots_are_seen(panda: ulna.Robot) -> None:
    rng = np.random.default_rng(5)
    points = panda.configurations["qr"] + rng.uniform(-0.1, 0.1, (400, 7))
    spline = trajectory.cubic_spline(points, times=np.arange(400) * 0.05)
    truth = (np.abs(spline.v(np.linspace(0.0, spline.duration, 200_001))) / panda.limits.velocity).max()
    assert trajectory.check(panda, spline, torque=False).use["velocity"] == pytest.approx(truth, rel=1e-4)
    even = spline.within(velocity=1.0, acceleration=10.0)
    assert np.abs(even.v(np.linspace(0.0, even.duration, 200_001))).max() < 1.0 + 1e-6
    assert trajectory.check(panda, even, acceleration=10.0, torque=False, tolerance=1e-5)


def test_an_invalid_query_is_refused(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    fast = trajectory.quintic(q, q + 1.0, 0.1)
    for tolerance in (np.nan, np.inf, -1.0):
        with pytest.raises(InputError, match="tolerance"):
            trajectory.check(panda, fast, tolerance=tolerance)
    with pytest.raises(InputError, match="samples"):
        trajectory.check(panda, fast, samples=0)
    with pytest.raises(InputError, match="expected one such as quintic"):
        trajectory.check(panda, q)  # pyright: ignore[reportArgumentType]
    assert not trajectory.check(panda, fast, samples=2, torque=False)
    with pytest.raises(InputError, match="Part 1"):
        trajectory.concatenate(fast, q)  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="too fast"):
        trajectory.quintic(q, q + 1.0, 1e-120)
    with pytest.raises(DtypeError, match="complex"):
        trajectory.quintic(q + 1j, q, 1.0)


def test_quaternions_moved_as_numbers_are_refused() -> None:
    flyer = ulna.load("ur5", root=FreeFlyer())
    q0, q1 = flyer.random_configuration(2, seed=1)
    with pytest.raises(InputError, match="straight"):
        trajectory.check(flyer, trajectory.quintic(q0, q1, 1.0))
    with pytest.raises(InputError, match="straight"):
        trajectory.time_optimal([q0, q1], flyer, acceleration=1.0)
    with pytest.raises(ShapeError, match="path"):
        trajectory.time_optimal(np.zeros((2, flyer.nv)) + [[0.0], [0.1]], flyer, acceleration=1.0)
    assert "position" in trajectory.check(flyer, trajectory.straight(flyer, q0, q1, 9.0)).use


def test_options_are_checked(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    motion = trajectory.quintic(q, q + 0.1, 2.0)
    for wrong in (
        {"torque": "no"},
        {"torque": None},
        {"tolerance": True},
        {"tolerance": -1.0},
        {"samples": True},
    ):
        with pytest.raises(InputError, match=f"`{next(iter(wrong))}`"):
            trajectory.check(panda, motion, **wrong)
    expected = trajectory.check(panda, motion, tolerance=1e-3)
    assert trajectory.check(panda, motion, tolerance=np.float32(1e-3), torque=np.True_) == expected


def test_the_number_of_limits_is_said() -> None:
    breach = trajectory.Breach("a", "velocity", 0.5, 2.0, 1.0, "rad/s")
    assert str(trajectory.Report((breach,), {"velocity": 2.0}, "arm")).startswith(
        "1 limit of 'arm' is exceeded"
    )
    assert str(trajectory.Report((breach,) * 2, {}, "arm")).startswith("2 limits of 'arm' are exceeded")


def test_motions_that_take_too_long_to_be_computed_are_refused() -> None:
    """The fifth power of 1e62 s is no float: the motion would end at another point."""
    for make in (trajectory.quintic, trajectory.cubic):
        motion = make([1.0], [2.0], duration=1e30)
        np.testing.assert_allclose(motion(1e30), [2.0], rtol=1e-12)
        for duration in (1e62, 1e200):
            with pytest.raises(InputError, match="at most 1e\\+30 s"):
                make([1.0], [2.0], duration=duration)
