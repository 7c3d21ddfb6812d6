"""Profiles under limits: kept everywhere, reached somewhere, and as long as the books say."""

import numpy as np
import pytest

from ulna import trajectory
from ulna.errors import InputError, ShapeError, UnknownName

A, B = np.array([0.0, 1.0, -2.0, 0.3]), np.array([1.0, 0.5, 2.5, 0.3])
V, ACC, J = np.array([1.0, 0.5, 2.0, 1.0]), np.array([2.0, 3.0, 4.0, 1.0]), np.array([20.0, 10.0, 9.0, 5.0])


def peaks(t: trajectory.Trajectory) -> list[np.ndarray]:
    rows = t._at(t.instants(2000), t.order)
    return [np.abs(row).max(axis=0) for row in rows[1:]]


@pytest.mark.parametrize("synchronise", ["phase", "time", "none"])
@pytest.mark.parametrize("kind", ["trapezoidal", "s_curve"])
def test_limits_are_kept_and_reached(kind: str, synchronise: str) -> None:
    limits = [V, ACC, J][: 2 if kind == "trapezoidal" else 3]
    t = getattr(trajectory, kind)(A, B, *limits, synchronise=synchronise)
    np.testing.assert_allclose(t.start, A)
    np.testing.assert_allclose(t.end, B, atol=1e-13)
    np.testing.assert_allclose(t.v([0.0, t.duration]), 0.0, atol=1e-13)
    use = np.stack([peak / limit for peak, limit in zip(peaks(t), limits, strict=False)])
    assert use.max() <= 1.0 + 1e-9
    assert use.max() == pytest.approx(1.0)


def test_the_way_is_straight_when_the_phase_is_shared() -> None:
    t = trajectory.s_curve(A, B, V, ACC, J)
    part = (t.sample(n=50).q - A)[:, :3] / (B - A)[:3]
    np.testing.assert_allclose(part, part[:, :1] * np.ones(3), atol=1e-13)


def test_each_as_fast_as_it_can_is_each_alone() -> None:
    whole = trajectory.s_curve(A, B, V, ACC, J, synchronise="none")
    for k in range(3):
        alone = trajectory.s_curve(A[k], B[k], V[k], ACC[k], J[k])
        assert alone.duration <= whole.duration + 1e-12
        times = np.linspace(0.0, whole.duration, 40)
        np.testing.assert_allclose(whole(times)[:, k], alone(times)[:, 0], atol=1e-12)


@pytest.mark.parametrize(
    ("d", "v", "a", "duration"),
    [
        (2.0, 1.0, 2.0, 2.0 + 0.5),
        (0.5, 10.0, 2.0, 1.0),
        (0.125, 0.5, 2.0, 0.5),
    ],  # full speed, triangle, just between
)
def test_trapezoids_by_hand(d: float, v: float, a: float, duration: float) -> None:
    assert trajectory.trapezoidal(0.0, d, v, a).duration == pytest.approx(duration)


@pytest.mark.parametrize(
    ("d", "v", "a", "j", "duration"),
    [
        (10.0, 5.0, 15.0, 30.0, 10.0 / 5 + 2 * np.sqrt(5 / 30)),  # full speed, but not full acceleration
        (10.0, 1.0, 10.0, 1000.0, 10.0 + 1 / 10 + 10 / 1000),  # both
        (10.0, 100.0, 10.0, 30.0, 1 / 3 + np.sqrt(1 / 9 + 4.0)),  # full acceleration only
        (0.1, 100.0, 10.0, 30.0, 4.0 * np.cbrt(0.1 / 60.0)),  # neither
    ],
)
def test_s_curves_by_hand(d: float, v: float, a: float, j: float, duration: float) -> None:
    t = trajectory.s_curve(0.0, d, v, a, j)
    assert t.duration == pytest.approx(duration)
    np.testing.assert_allclose(t.end, d)
    for peak, limit in zip(peaks(t), (v, a, j), strict=True):
        assert peak[0] <= limit * (1 + 1e-9)


def test_a_duration_alone_cruises_for_a_third() -> None:
    t = trajectory.trapezoidal(A, B, duration=3.0)
    np.testing.assert_allclose(t.knots, [0.0, 1.0, 2.0, 3.0])
    np.testing.assert_allclose(t.v(1.5), 1.5 * (B - A) / 3.0)


def test_a_longer_duration_slows_down() -> None:
    t = trajectory.trapezoidal(A, B, V, ACC, duration=50.0)
    assert t.duration == pytest.approx(50.0)
    with pytest.raises(InputError, match="at least"):
        trajectory.trapezoidal(A, B, V, ACC, duration=0.1)


def test_equal_end_points_make_a_constant_trajectory() -> None:
    t = trajectory.s_curve(A, A, 1.0, 1.0, 1.0, duration=2.0)
    np.testing.assert_array_equal(t(1.0), A)
    assert trajectory.trapezoidal(A, A, duration=2.0).duration == 2.0
    with pytest.raises(InputError, match="same point"):
        trajectory.trapezoidal(A, A, 1.0, 1.0)


def test_mistakes_are_named() -> None:
    with pytest.raises(InputError, match="neither was given"):
        trajectory.trapezoidal(A, B)
    with pytest.raises(InputError, match=r"`velocity\[0\]` is 0"):
        trajectory.trapezoidal(A, B, 0.0, 1.0)
    with pytest.raises(InputError, match="without `velocity`"):
        trajectory.trapezoidal(A, B, acceleration=1.0)
    with pytest.raises(InputError, match=r"`jerk\[2\]`"):
        trajectory.s_curve(A, B, 1.0, 1.0, [1.0, 1.0, np.nan, 1.0])
    with pytest.raises(InputError, match="must be above 0.5 and at most 1"):
        trajectory.trapezoidal(0.0, 1.0, velocity=0.4, duration=2.0)
    with pytest.raises(UnknownName, match="'phase'"):
        trajectory.trapezoidal(A, B, V, ACC, synchronise="phases")  # type: ignore[arg-type]
    for start, end, said in (
        ([A, B], B, "`q0`.*one point"),
        ([], B, "`q0`.*one point"),
        (A, B[:2], r"`q1`.*\(4,\)"),
    ):
        with pytest.raises(ShapeError, match=said):
            trajectory.trapezoidal(start, end, V, ACC)
