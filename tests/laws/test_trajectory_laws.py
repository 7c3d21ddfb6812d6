"""Laws of every kind of trajectory: rates are derivatives, copies under scaling, reversal, retiming, joining agree."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.random_models import random_model
from ulna import algorithms, trajectory
from ulna.errors import InputError
from ulna.spatial import SE3

Rng = np.random.Generator


def _states(rng: Rng, n: int = 3) -> np.ndarray:
    return rng.normal(size=(6, n))


def _poses(rng: Rng, count: int, angle: float = 0.8) -> list[SE3]:
    way = [SE3.exp(rng.normal(size=6))]
    for _ in range(count - 1):
        way.append(way[-1] @ SE3.exp(np.concatenate([rng.normal(size=3), angle * rng.normal(size=3) / 2])))
    return way


def _on_manifold(rng: Rng) -> trajectory.Trajectory:
    model = random_model(rng, ["revolute", "spherical", "continuous", "planar"], root="free_flyer")
    q = algorithms.normalize(model, algorithms.random(model, rng, (2,)))
    return trajectory.straight(model, q[0], q[1], duration=1.3)


def _there_and_back(t: trajectory.Trajectory) -> trajectory.Trajectory:
    return t + t.reversed()


def _time_optimal(rng: Rng) -> trajectory.Trajectory:
    return trajectory.time_optimal(rng.normal(size=(5, 3)), velocity=2.0, acceleration=5.0, grid=30)


KINDS: dict[str, Callable[[Rng], trajectory.Trajectory]] = {
    "cubic": lambda rng: trajectory.cubic(*_states(rng)[:2], 1.7, *_states(rng)[:2]),
    "quintic": lambda rng: trajectory.quintic(*_states(rng)[:2], 1.7, *_states(rng)[:4]),
    "trapezoidal": lambda rng: trajectory.trapezoidal(*_states(rng)[:2], 1.0, 2.0, synchronise="none"),
    "s-curve": lambda rng: trajectory.s_curve(*_states(rng)[:2], 1.0, 2.0, 9.0, synchronise="time"),
    "cubic spline": lambda rng: trajectory.cubic_spline(_states(rng), duration=3.0),
    "minimum jerk": lambda rng: trajectory.minimum_jerk(_states(rng), duration=3.0),
    "b-spline": lambda rng: trajectory.bspline(_states(rng), 3.0),
    "parabolic blends": lambda rng: trajectory.blended(_states(rng), 0.2, velocity=2.0),
    "quintic blends": lambda rng: trajectory.blended(_states(rng), 0.4, velocity=2.0, kind="quintic"),
    "straight": _on_manifold,
    "time-optimal": _time_optimal,
    "line": lambda rng: trajectory.pose_line(*_poses(rng, 2), 1.5),
    "screw": lambda rng: trajectory.pose_line(*_poses(rng, 2), 1.5, "screw"),
    "circle": lambda rng: trajectory.circle(
        _poses(rng, 1)[0], rng.normal(size=3), rng.normal(size=3), 4.0, 1.5
    ),
    "turning": lambda rng: trajectory.circle(
        _poses(rng, 1)[0], rng.normal(size=3), rng.normal(size=3), 4.0, 1.5, "turning"
    ),
    "pose spline": lambda rng: trajectory.pose_spline(_poses(rng, 5, 0.4), 2.0),
    "screw spline": lambda rng: trajectory.pose_spline(_poses(rng, 5, 0.4), 2.0, "screw", through=False),
    "reversed": lambda rng: trajectory.minimum_jerk(_states(rng), duration=3.0).reversed(),
    "chain": lambda rng: _there_and_back(_on_manifold(rng)),
    "retimed": lambda rng: trajectory.cubic_spline(_states(rng), duration=1.0).retimed(
        trajectory.s_curve(0.0, 1.0, 1.0, 2.0, 9.0)
    ),
}


def inner_times(t: trajectory.Trajectory, rng: Rng, h: float) -> np.ndarray:
    """Times at some distance from the knots."""
    times = rng.uniform(0.0, t.duration, 60)
    return times[np.abs(times[:, None] - t.knots).min(axis=1) > 3.0 * h]


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=5, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1))
def test_rates_are_derivatives(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    t = KINDS[kind](rng)
    h = 1e-5 * t.duration
    times = inner_times(t, rng, h)
    _, v, a = t.state(times)
    by_points = t.space.difference(t(times - h), t(times + h)) / (2.0 * h)
    by_rates = (t.v(times + h) - t.v(times - h)) / (2.0 * h)
    np.testing.assert_allclose(by_points, v, atol=1e-6 * (1.0 + np.abs(a).max()))
    np.testing.assert_allclose(by_rates, a, atol=1e-6 * (1.0 + np.abs(a).max()) / min(1.0, t.duration))
    if t.order == 3:
        by_rates = (t.a(times + h) - t.a(times - h)) / (2.0 * h)
        jerk = t.jerk(times)
        np.testing.assert_allclose(by_rates, jerk, atol=1e-5 * (1.0 + np.abs(jerk).max()))


@pytest.mark.parametrize("kind", KINDS)
def test_scaled_and_reversed_copies(kind: str) -> None:
    rng = np.random.default_rng(5)
    t = KINDS[kind](rng)
    times = inner_times(t, rng, 1e-9)
    slow, back = t.slowed(2.5), t.reversed()
    size = 1.0 + np.abs(t.a(times)).max()
    for power, (one, two, three) in enumerate(
        zip(t.state(times), slow.state(2.5 * times), back.state(t.duration - times), strict=True)
    ):
        np.testing.assert_allclose(two * 2.5**power, one, atol=1e-9 * size)
        np.testing.assert_allclose(three * (-1.0) ** power, one, atol=1e-9 * size)


@pytest.mark.parametrize("kind", KINDS)
def test_there_and_back_is_one_trajectory(kind: str) -> None:
    t = KINDS[kind](np.random.default_rng(6))
    if np.abs(t.v(t.duration)).max() > 1e-9:
        with pytest.raises(InputError, match="the velocity of"):
            t + t.reversed()
        return
    whole = t + t.reversed()
    assert whole.duration == pytest.approx(2.0 * t.duration)
    times = np.linspace(0.0, t.duration, 9)[:-1]
    np.testing.assert_allclose(whole(times), t(times), atol=1e-10)
    np.testing.assert_allclose(whole(2.0 * t.duration - times), t(times), atol=1e-10)
    assert (np.diff(whole.knots) > 0.0).all() and t.duration in whole.knots


@pytest.mark.parametrize("kind", KINDS)
def test_one_time_is_one_row_of_many(kind: str) -> None:
    rng = np.random.default_rng(7)
    t = KINDS[kind](rng)
    times = np.sort(rng.uniform(0.0, t.duration, 5))
    for many, k in ((t.state(times), k) for k in range(5)):
        for row, single in zip(many, t.state(times[k]), strict=True):
            np.testing.assert_allclose(row[k], single, rtol=1e-13, atol=1e-13)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 4),
    count=st.integers(2, 8),
    span=st.floats(1e-3, 1e3),
)
def test_splines_meet_their_way_points_on_any_scale(seed: int, n: int, count: int, span: float) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, n))
    times = span * np.concatenate([[0.0], np.cumsum(rng.uniform(0.2, 1.0, count - 1))])
    for t in (trajectory.cubic_spline(points, times), trajectory.minimum_jerk(points, times)):
        np.testing.assert_allclose(t(times), points, atol=1e-10)
        np.testing.assert_allclose(t.v(times[[0, -1]]) * span, 0.0, atol=1e-9)
