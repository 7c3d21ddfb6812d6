"""Checks against a robot's limits name the joint, the quantity, the time and the excess."""

import numpy as np
import pytest

import ulna
from ulna import trajectory
from ulna.errors import InputError, ShapeError


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
