"""Splines and blends: through their points, smooth where they say so, and of least cost."""

import numpy as np
import pytest

from ulna import trajectory
from ulna.errors import InputError, ShapeError, UnknownName

POINTS = np.random.default_rng(1).normal(size=(6, 3))
TIMES = np.array([0.0, 1.0, 1.7, 3.0, 3.4, 5.0])


def jumps(t: trajectory.Polynomial, order: int) -> float:
    """The greatest jump of a derivative at an inner knot."""
    c, h = t.coefficients, np.diff(t.times)
    powers = np.arange(order, c.shape[1])
    factor = np.array([np.prod(np.arange(p - order + 1, p + 1)) for p in powers])
    end = (c[:, order:] * (factor * h[:, None] ** (powers - order))[..., None]).sum(axis=1)
    return float(np.abs(end[:-1] - factor[0] * c[1:, order]).max())


def test_a_cubic_spline_has_continuous_acceleration() -> None:
    t = trajectory.cubic_spline(POINTS, TIMES, v0=0.5, v1=[0.1, 0.2, 0.3])
    np.testing.assert_allclose(t(TIMES), POINTS, atol=1e-12)
    np.testing.assert_allclose(t.v([0.0, 5.0]), [[0.5] * 3, [0.1, 0.2, 0.3]], atol=1e-12)
    assert jumps(t, 2) < 1e-10 < jumps(t, 3)


def test_minimum_jerk_has_continuous_snap_and_less_jerk_than_others() -> None:
    t = trajectory.minimum_jerk(POINTS, TIMES)
    np.testing.assert_allclose(t(TIMES), POINTS, atol=1e-12)
    assert max(jumps(t, 3), jumps(t, 4)) < 1e-8
    q, v, a = t.state(TIMES)

    def cost(x: trajectory.Polynomial) -> float:
        rows = x.sample(n=20001, jerk=True)
        return float((rows.jerk**2).sum() * rows.t[1])

    best = cost(t)
    rng = np.random.default_rng(0)
    for _ in range(10):  # any other quintics through the same points
        dv, da = 0.1 * rng.normal(size=(2, *v.shape))
        dv[[0, -1]] = da[[0, -1]] = 0.0
        assert cost(trajectory.hermite(TIMES, q, v + dv, a + da)) > best


def test_between_two_points_minimum_jerk_is_the_quintic() -> None:
    t = trajectory.minimum_jerk(POINTS[:2], duration=2.0)
    np.testing.assert_allclose(t.coefficients, trajectory.quintic(*POINTS[:2], 2.0).coefficients, atol=1e-13)


@pytest.mark.parametrize("degree", [3, 5])
def test_b_splines_run_through_or_stay_in_the_hull(degree: int) -> None:
    through = trajectory.bspline(POINTS, 5.0, degree, through=True, times=TIMES)
    np.testing.assert_allclose(through(TIMES), POINTS, atol=1e-10)
    np.testing.assert_allclose(through.v([0.0, 5.0]), 0.0, atol=1e-10)
    drawn = trajectory.bspline(POINTS, 4.0, degree)
    assert drawn.duration == 4.0
    np.testing.assert_allclose(drawn([0.0, 4.0]), POINTS[[0, -1]], atol=1e-12)
    np.testing.assert_allclose(drawn.v([0.0, 4.0]), 0.0, atol=1e-10)
    rows = drawn.sample(n=200).q
    assert (rows <= POINTS.max(axis=0) + 1e-12).all() and (rows >= POINTS.min(axis=0) - 1e-12).all()
    assert jumps(drawn, degree - 1) < 1e-6


def test_parabolic_blends_by_hand() -> None:
    t = trajectory.blended([[0.0], [2.0], [2.0 + 3.0]], 0.4, segment_times=[2.2, 1.7])
    assert t.duration == pytest.approx(3.9)
    np.testing.assert_allclose(t.v([1.0, 2.5]), [[1.0], [2.0]])  # 2 / (2.2 - 0.2), 3 / (1.7 - 0.2)
    np.testing.assert_allclose(t.a([0.1, 2.2, 3.8]), [[2.5], [2.5], [-5.0]])
    np.testing.assert_allclose(t(2.2), 2.0 + 1.0 * 0.4 / 8)  # cuts the corner at dv tau / 8
    np.testing.assert_allclose([t.start, t.end], [[0.0], [5.0]], atol=1e-14)


def test_one_segment_with_parabolic_blends_is_a_trapezoid() -> None:
    t = trajectory.blended(POINTS[:2], 0.5, segment_times=[2.0])
    np.testing.assert_allclose(
        t(np.linspace(0, 2, 30)),
        trajectory.trapezoidal(*POINTS[:2], velocity=np.abs(POINTS[1] - POINTS[0]) / 1.5, duration=2.0)(
            np.linspace(0, 2, 30)
        ),
        atol=1e-13,
    )


@pytest.mark.parametrize("kind", ["parabolic", "quintic"])
def test_blends_keep_speeds_and_are_smooth(kind: str) -> None:
    t = trajectory.blended(POINTS, 0.3, velocity=1.5, kind=kind)  # type: ignore[arg-type]
    assert jumps(t, 1 if kind == "parabolic" else 2) < 1e-9
    assert np.abs(t.sample(n=3000).v).max() == pytest.approx(1.5, rel=1e-9)
    np.testing.assert_allclose(t.v([0.0, t.duration]), 0.0, atol=1e-12)
    np.testing.assert_allclose(t.end, POINTS[-1], atol=1e-12)


def test_half_blends_catch_up_with_the_line() -> None:
    t = trajectory.blended([[0.0], [2.0], [0.0]], 0.4, segment_times=[1.0, 1.0], kind="quintic", ends="half")
    np.testing.assert_allclose(t([0.2, 0.5, 0.8]), [[0.4], [1.0], [1.6]])
    assert t.sample(n=1000).v.max() == pytest.approx(1.512 * 2.0, rel=1e-3)


def test_segments_that_are_only_blends() -> None:
    t = trajectory.blended([[0.0], [1.0], [0.0], [1.0]], 1.0, segment_times=[1.5, 1.0, 1.5])
    assert jumps(t, 1) < 1e-12
    assert len(t.knots) == 5


def test_mistakes_are_named() -> None:
    with pytest.raises(InputError, match=r"points\[2\]` and `points\[3\]` are the same"):
        trajectory.cubic_spline(POINTS[[0, 1, 2, 2, 3]], duration=1.0)
    trajectory.cubic_spline(POINTS[[0, 1, 2, 2, 3]], times=[0, 1, 2, 3, 4])  # waiting is meant
    with pytest.raises(InputError, match="neither was given"):
        trajectory.minimum_jerk(POINTS)
    with pytest.raises(InputError, match="both was given"):
        trajectory.minimum_jerk(POINTS, TIMES, 3.0)
    with pytest.raises(InputError, match=r"1.0 s is followed by 0.5 s"):
        trajectory.minimum_jerk(POINTS[:3], [0, 1, 0.5])
    with pytest.raises(InputError, match="starts at time 0"):
        trajectory.minimum_jerk(POINTS[:3], [1, 2, 3])
    with pytest.raises(ShapeError, match="times"):
        trajectory.minimum_jerk(POINTS, [0, 1, 2])
    with pytest.raises(ShapeError, match="at least 2 points"):
        trajectory.cubic_spline(POINTS[:1], duration=1.0)
    with pytest.raises(InputError, match="degree"):
        trajectory.bspline(POINTS, 1.0, 4)
    with pytest.raises(InputError, match="Segment 1, from point 1 to point 2, lasts 0.2 s"):
        trajectory.blended(POINTS[:4], 0.4, segment_times=[1, 0.2, 1])
    with pytest.raises(UnknownName, match="quintic"):
        trajectory.blended(POINTS, 0.4, velocity=1.0, kind="quintik")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="both or neither"):
        trajectory.blended(POINTS, 0.4)
    with pytest.raises(InputError, match="half the length"):
        trajectory.blended(POINTS, 0.4, velocity=1.0, ends="half")
