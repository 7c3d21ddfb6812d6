"""From poses to joints, and from state to state."""

from types import SimpleNamespace

import numpy as np
import pytest

import ulna
from ulna import trajectory
from ulna.errors import InputError


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


def test_a_frame_follows_a_line(panda: ulna.Robot) -> None:
    q0 = panda.configurations["qr"]
    start = panda.fk(q0)
    line = trajectory.pose_line(start, ulna.SE3.from_matrix(start) @ ulna.SE3.trans(0.1, 0.15, -0.1), 2.0)
    joints = trajectory.follow(line, lambda T, q: panda.ik(T, q0=q), q0, samples=60)
    times = np.linspace(0.0, 2.0, 333)
    assert np.abs(panda.fk(joints(times)) - line(times)).max() < 1e-4
    twist = panda.frame_velocity(joints(times), joints.v(times))
    assert np.abs(twist - line.v(times)).max() < 2e-3
    np.testing.assert_allclose(joints.v([0.0, 2.0]), 0.0, atol=1e-12)


@pytest.mark.parametrize("jump", [np.nan, 0.0, -1.0, "far", None])
def test_a_jump_is_a_number(panda: ulna.Robot, jump: object) -> None:
    """With nan no jump would have been one."""
    q0 = panda.configurations["qr"]
    line = trajectory.pose_line(panda.fk(q0), panda.fk(q0 + 0.01), 1.0)
    with pytest.raises(InputError, match="`jump` is .*; expected a change above 0"):
        trajectory.follow(line, lambda T, q: panda.ik(T, q0=q), q0, 3, jump)  # type: ignore[arg-type]
    assert trajectory.follow(line, lambda T, q: panda.ik(T, q0=q), q0, 3, np.inf).duration == 1.0


def test_failures_name_the_time(panda: ulna.Robot) -> None:
    q0 = panda.configurations["qr"]
    start = panda.fk(q0)
    away = trajectory.pose_line(start, ulna.SE3.from_matrix(start) @ ulna.SE3.trans(0, 0, -3.0), 2.0)
    with pytest.raises(InputError, match=r"fails at \d\.\d+ s of 2 s, at \["):
        trajectory.follow(away, lambda T, q: panda.ik(T, q0=q), q0)
    calls = iter(range(1000))
    with pytest.raises(InputError, match="jumps at 0.06 s: joint 2 by 2"):
        trajectory.follow(
            away, lambda T, q: SimpleNamespace(q=q0 + 2.0 * (next(calls) > 2) * (np.arange(7) == 2)), q0
        )
    with pytest.raises(InputError, match="returns nan at 0 s"):
        trajectory.follow(away, lambda T, q: np.full(7, np.nan), q0)
    with pytest.raises(InputError, match="moves joints already"):
        trajectory.follow(trajectory.quintic(q0, q0, 1.0), lambda T, q: q, q0)


def test_jerk_limited_motion_between_states() -> None:
    pytest.importorskip("ruckig", reason="ruckig calculates jerk-limited motions")
    rng = np.random.default_rng(0)
    for _ in range(20):
        q0, q1 = rng.normal(size=(2, 4))
        v0, v1, a0 = rng.uniform(-0.5, 0.5, (3, 4))
        t = trajectory.jerk_limited(q0, v0, a0, q1, v1, None, 1.0, 2.0, 8.0)
        q, v, a = t.state([0.0, t.duration])
        np.testing.assert_allclose(q, [q0, q1], atol=1e-9)
        np.testing.assert_allclose(v, [v0, v1], atol=1e-9)
        np.testing.assert_allclose(a, [a0, np.zeros(4)], atol=1e-8)
        rows = t.sample(n=500, jerk=True)
        for row, limit in ((rows.v, 1.0), (rows.a, 2.0), (rows.jerk, 8.0)):
            assert np.abs(row).max() <= limit + 1e-8


def test_from_rest_to_rest_it_is_the_s_curve() -> None:
    pytest.importorskip("ruckig", reason="ruckig calculates jerk-limited motions")
    for d in (0.01, 0.3, 5.0):
        ours, theirs = (
            trajectory.s_curve(0.0, d, 1.0, 2.0, 8.0),
            trajectory.jerk_limited(0.0, None, None, d, None, None, 1.0, 2.0, 8.0),
        )
        assert ours.duration == pytest.approx(theirs.duration, rel=1e-9)
        times = np.linspace(0, ours.duration, 50)
        np.testing.assert_allclose(ours(times), theirs(times), atol=1e-9)
        slow = trajectory.jerk_limited(0.0, None, None, d, None, None, 1.0, 2.0, 8.0, duration=20.0)
        assert slow.duration == pytest.approx(20.0)


@pytest.mark.parametrize("length", [1e-8, 1.0, 1e3])
@pytest.mark.parametrize("time", [1e-4, 1.0, 1e4])
def test_tiny_and_huge_motions_end_where_they_should_within_limits(length: float, time: float) -> None:
    """Ruckig fails, or misses the end or the limits, in units in which numbers are very small or large."""
    pytest.importorskip("ruckig", reason="ruckig calculates jerk-limited motions")
    rng = np.random.default_rng(7)
    for _ in range(40):
        q0, q1 = length * rng.normal(size=(2, 3))
        v, a, j = (length / time**k * 10.0 ** rng.uniform(-1.0, 1.0, 3) for k in (1, 2, 3))
        v0, v1 = v * rng.uniform(-0.9, 0.9, (2, 3))
        t = trajectory.jerk_limited(q0, v0, None, q1, v1, None, v, a, j)
        q, speed, change = t.state(t.duration)
        assert (np.abs(q - q1) <= 1e-5 * length).all() and (np.abs(speed - v1) <= 1e-5 * v).all()
        assert (np.abs(change) <= 1e-5 * a).all()
        rows = t.sample(n=500, jerk=True)
        for row, limit in ((rows.v, v), (rows.a, a), (rows.jerk, j)):
            assert (np.abs(row).max(axis=0) <= (1.0 + 1e-5) * limit).all()


def test_states_that_limits_forbid_are_refused() -> None:
    pytest.importorskip("ruckig", reason="ruckig calculates jerk-limited motions")
    with pytest.raises(InputError, match="Ruckig refuses the motion"):
        trajectory.jerk_limited(0.0, None, None, 1.0, 5.0, None, 1.0, 2.0, 8.0)
    with pytest.raises(InputError, match="same state"):
        trajectory.jerk_limited(1.0, None, None, 1.0, None, None, 1.0, 2.0, 8.0)
