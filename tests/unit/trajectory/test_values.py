"""Trajectories as values: asking at any time, sampling, joining, stretching, and what they say when misused."""

import dataclasses
import pickle

import numpy as np
import pytest

from ulna import trajectory
from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError
from ulna.spatial import SE3

A, B, C = np.array([0.0, 1.0, -2.0]), np.array([1.0, 1.5, 0.5]), np.array([-0.5, 2.0, 0.0])


def test_a_quintic_is_where_it_should_be() -> None:
    t = trajectory.quintic(A, B, 2.0)
    np.testing.assert_allclose(t(0.0), A)
    np.testing.assert_allclose(t(2.0), B, atol=1e-14)
    np.testing.assert_allclose(t.q(1.0), 0.5 * (A + B))
    np.testing.assert_allclose(t.v(1.0), 15 / 8 * (B - A) / 2.0)  # the peak of 30 u^2 (1 - u)^2
    np.testing.assert_allclose(t.a([0.0, 1.0, 2.0]), np.zeros((3, 3)), atol=1e-12)
    np.testing.assert_allclose(t.jerk(0.0), 60.0 * (B - A) / 2.0**3)


def test_states_of_a_quintic_are_those_of_the_trajectory() -> None:
    """Before and after it, in any order, from lists; it says what is wrong as that does."""
    t = np.array([-1.0, 0.0, 2.0 + 1e-12, 0.3, 1.7, 2.0, 2.1])
    for ends in ((None, None), (C, None), (C, 0.3 * A)):
        expected = trajectory.quintic(A, B, 2.0, *ends).state(t)
        for got in (
            trajectory.quintic_states(A, B, 2.0, t, *ends),
            trajectory.quintic_states([0, 1, -2], B, 2, t, *ends),
        ):
            for rows, wanted in zip(got, expected, strict=True):
                np.testing.assert_allclose(rows, wanted, rtol=1e-13, atol=1e-13)
    assert trajectory.quintic_states(A, B, 2.0, 0.5)[0].shape == (3,)
    for wrong in (
        (A, B[:2], 2.0, t),
        (A, B, 0.0, t),
        (A + 1j, B, 1.0, t),
        (A[:0], B[:0], 1.0, t),
        (A, B, 1.0, t + 1j),
    ):
        with pytest.raises(InputError):
            trajectory.quintic_states(*wrong)
    for wrong in (
        (A * np.nan, B, 2.0, t),
        (A, B, 2.0, t * np.nan),
        (A, np.array([1.0, 0.0, np.inf]), 2.0, t),
    ):
        with pytest.raises(NonFiniteError):
            trajectory.quintic_states(*wrong)


def test_times_may_have_any_shape() -> None:
    t = trajectory.quintic(A, B, 2.0)
    times = np.linspace(0, 2, 6).reshape(2, 3)
    assert t(times).shape == (2, 3, 3)
    np.testing.assert_array_equal(t(times)[1, 2], t(times[1, 2]))
    q, v, a = t.state(0.7)
    np.testing.assert_array_equal(np.stack([q, v, a]), np.stack([t.q(0.7), t.v(0.7), t.a(0.7)]))
    assert t([]).shape == (0, 3)


def test_outside_its_time_a_trajectory_holds() -> None:
    t = trajectory.cubic(A, B, 2.0, v0=1.0, v1=-1.0)
    for time, point in ((-5.0, A), (7.0, B)):
        np.testing.assert_allclose(t(time), point, atol=1e-14)
        np.testing.assert_array_equal(t.v(time), np.zeros(3))
        np.testing.assert_array_equal(t.a(time), np.zeros(3))
    np.testing.assert_allclose(
        t.v(2.0 * (1 + 1e-12)), -np.ones(3)
    )  # what summing time steps loses is still the end


def test_samples_end_at_the_end() -> None:
    t = trajectory.quintic(A, B, 1.0005)
    rows = t.sample(rate=100)
    assert rows.t[-1] == 1.0005 and rows.t[-2] == pytest.approx(1.0)
    assert len(trajectory.quintic(A, B, 1.0).sample(rate=1000).t) == 1001
    n = t.sample(n=11, jerk=True)
    assert n.jerk.shape == (11, 3)
    np.testing.assert_allclose(np.diff(n.t), 0.10005)


def test_any_trajectory_can_be_pickled() -> None:
    for t in (
        trajectory.quintic(A, B, 1.0),
        trajectory.pose_line(SE3.identity(), SE3.rx(1.0), 1.0),
        trajectory.time_optimal([A, B, C], acceleration=1.0),
    ):
        back = pickle.loads(pickle.dumps(t))
        np.testing.assert_array_equal(back(0.3), t(0.3))
        assert repr(back) == repr(t)


def test_joining_checks_continuity() -> None:
    whole = trajectory.quintic(A, B, 1.0) + trajectory.cubic(B, C, 2.0) + trajectory.quintic(C, A, 0.5)
    assert whole.duration == 3.5
    np.testing.assert_allclose(whole([1.0, 3.0, 3.5]), [B, C, A], atol=1e-14)
    assert isinstance(whole, trajectory.Polynomial)
    with pytest.raises(InputError, match=r"at 1 s, the position of 'q0' jumps by 0\.5"):
        trajectory.quintic(A, B, 1.0) + trajectory.quintic(B + [0.5, 0, 0], C, 1.0)
    with pytest.raises(InputError, match=r"velocity of 'q1' jumps by -2"):
        trajectory.quintic(A, B, 1.0, v1=[0, 2, 0]) + trajectory.quintic(B, C, 1.0)
    with pytest.raises(InputError, match="expected the same robot"):
        trajectory.quintic(A, B, 1.0) + trajectory.quintic(0.0, 1.0, 1.0)
    with pytest.raises(InputError, match="expected at least one"):
        trajectory.concatenate()
    assert trajectory.concatenate(whole) == whole


def test_equal_polynomials_are_equal_values() -> None:
    one, two = trajectory.quintic(A, B, 1.0), trajectory.quintic(A, B, 1.0)
    assert one == two and hash(one) == hash(two) and len({one, two}) == 1
    assert one != trajectory.quintic(A, C, 1.0)
    with pytest.raises(dataclasses.FrozenInstanceError):
        one.kind = "x"  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        one.coefficients[0] = 0.0


def test_stretching_reversing_fitting() -> None:
    t = trajectory.trapezoidal(A, B, 1.0, 2.0)
    assert t.with_duration(5.0).duration == pytest.approx(5.0)
    back = t.slowed(2.0).reversed()
    assert back.duration == pytest.approx(2 * t.duration)
    np.testing.assert_allclose(back(0.4), t(t.duration - 0.2))
    fitted = t.within(velocity=[0.3, 10.0, 10.0])
    assert np.abs(fitted.sample(n=500).v[:, 0]).max() == pytest.approx(0.3)
    quick = trajectory.quintic(A, B, 100.0).within(acceleration=3.0, jerk=1000.0)
    assert np.abs(quick.sample(n=2001).a).max() == pytest.approx(3.0, rel=1e-5)
    with pytest.raises(InputError, match="nothing moves"):
        trajectory.quintic(A, A, 1.0).within(velocity=1.0)


def test_another_law_of_time() -> None:
    path = trajectory.cubic(A, B, 1.0, v0=1.0, v1=1.0)
    t = path.retimed(trajectory.quintic(0.0, 1.0, 3.0))
    assert t.duration == 3.0
    np.testing.assert_allclose(t(3.0), B)
    np.testing.assert_allclose(t.v([0.0, 3.0]), np.zeros((2, 3)), atol=1e-12)
    with pytest.raises(InputError, match="runs from 0 to 2"):
        path.retimed(trajectory.quintic(0.0, 2.0, 3.0))
    with pytest.raises(InputError, match="one number"):
        path.retimed(path)


def test_words() -> None:
    assert repr(trajectory.quintic(A, B, 2.0)) == "<quintic: 3 joints, 2 s, 1 segment>"
    line = trajectory.pose_line(SE3.identity(), SE3.trans(1, 0, 0), 1.5)
    assert repr(line) == "<pose line: a pose, 1.5 s, 1 segment>"
    with pytest.raises(InputError, match=r"use T\(t\)"):
        line.q(0.0)
    with pytest.raises(InputError, match=r"use q\(t\)"):
        trajectory.quintic(A, B, 2.0).T(0.0)
    with pytest.raises(InputError, match="no jerk"):
        line.jerk(0.0)


@pytest.mark.parametrize("duration", [0.0, -1.0, np.nan, np.inf, "soon", None])
def test_durations_are_above_zero(duration: object) -> None:
    with pytest.raises(InputError, match="above zero"):
        trajectory.quintic(A, B, duration)  # type: ignore[arg-type]


def test_mistakes_are_named() -> None:
    with pytest.raises(ShapeError, match="q1"):
        trajectory.quintic(A, B[:2], 1.0)
    with pytest.raises(NonFiniteError, match=r"q0\[1\]"):
        trajectory.quintic([0.0, np.nan, 1.0], B, 1.0)
    with pytest.raises(DtypeError, match="q0"):
        trajectory.quintic("abc", B, 1.0)  # type: ignore[arg-type]
    with pytest.raises(NonFiniteError, match="`t"):
        trajectory.quintic(A, B, 1.0)(np.nan)
    with pytest.raises(InputError, match="one of both"):
        trajectory.quintic(A, B, 1.0).sample()
    with pytest.raises(NonFiniteError, match="`t"):
        trajectory.quintic_states(A, B, 1.0, np.array([0.0, np.inf]))
    with pytest.raises(InputError, match="`jerk` is 'no'; expected True or False"):
        trajectory.quintic(A, B, 1.0).sample(n=2, jerk="no")  # type: ignore[arg-type]
    times, rows = np.array([0.0, 1.0]), np.array([A, B])
    for name in ("q", "v", "a"):
        given = {"q": rows, "v": rows, "a": rows} | {name: rows + [0.0, np.nan, 0.0]}
        with pytest.raises(NonFiniteError, match=rf"`{name}\[0, 1\]` is nan"):
            trajectory.hermite(times, **given)
    with pytest.raises(NonFiniteError, match=r"`times\[1\]` is nan"):
        trajectory.hermite(times + [0.0, np.nan], rows, rows)
    with pytest.raises(InputError, match="rows a second"):
        trajectory.quintic(A, B, 1.0).sample(rate=0)
    with pytest.raises(InputError, match="factor above zero"):
        trajectory.quintic(A, B, 1.0).slowed(-1)
    with pytest.raises(InputError, match="at least 2"):
        trajectory.quintic(A, B, 1.0).sample(n=1)
    with pytest.raises(InputError, match="do not increase"):
        trajectory.Polynomial.of([0.0, 1.0, 1.0], np.zeros((2, 3, 1)))
    with pytest.raises(ShapeError, match="coefficients"):
        trajectory.Polynomial.of([0.0, 1.0], np.zeros((2, 3, 1)))


def test_pictures(tmp_path) -> None:  # type: ignore[no-untyped-def]
    pytest.importorskip("matplotlib", reason="matplotlib draws trajectories")
    for number, t in enumerate(
        [
            trajectory.s_curve(A, B, 1.0, 2.0, 8.0),
            trajectory.circle(SE3.trans(1, 0, 0), [0, 0, 0], [0, 0, 1], duration=2.0),
        ]
    ):
        figure = t.plot(tmp_path / f"{number}.png")
        assert len(figure.axes) == 3 and (tmp_path / f"{number}.png").stat().st_size > 5000


def test_a_motion_that_is_just_within_limits_stays_as_it_is() -> None:
    """Even times may miss a knot, where the acceleration jumps, by the last bit; a step in so short an interval is none."""
    rng = np.random.default_rng(1)
    for _ in range(300):
        d, v, a = rng.uniform(0.1, 3.0, 3)
        t = trajectory.trapezoidal([0.0], [d], v, a)
        assert t.within(acceleration=a).duration == pytest.approx(t.duration, rel=1e-8)
        both = trajectory.concatenate(t, t.reversed())
        assert both.within(velocity=v, acceleration=a).duration == pytest.approx(both.duration, rel=1e-8)
