"""Limits hold at every time, not only at grid points: random paths of all kinds, looked at densely; and `check` agrees."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ulna
from support.limited_paths import PATHS, cornered, dense_times, dense_use, part, way_points
from ulna import trajectory
from ulna.errors import InputError
from ulna.model import FreeFlyer
from ulna.trajectory import solver
from ulna.trajectory.certificate import Bound
from ulna.trajectory.peaks import greatest
from ulna.trajectory.solver import TOLERANCE

SCHEMES = ("interpolation", "collocation")
HARD = np.stack([np.full(7, -10.0), np.full(7, 10.0)])


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


def require_limits(
    robot: ulna.Robot, best: trajectory.Retimed, hard: np.ndarray = HARD, **limits: Any
) -> None:
    """Limits hold by dense samples, and the use that the result states bounds them."""
    found = dense_use(robot, best, hard, **limits)
    for name in ("velocity", "acceleration", "torque"):
        assert found[name] <= 1.0 + TOLERANCE, (name, found)
        assert found[name] <= best.use[name] + TOLERANCE, (name, found, best.use)
    assert found["acceleration by points"] <= 1.0 + 1e-4  # the rounding of second differences
    assert max(best.use.values()) > 0.97  # a limit is used


def solve(robot: ulna.Robot, kind: str, seed: int, scheme: str, **options: Any) -> trajectory.Retimed:
    rng = np.random.default_rng(seed)
    path = PATHS[kind](robot, way_points(robot, rng), rng)
    return trajectory.time_optimal(path, robot, acceleration=10.0, scheme=scheme, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("kind", PATHS)
def test_limits_hold_between_grid_points(panda: ulna.Robot, kind: str, scheme: str) -> None:
    best = solve(panda, kind, 1, scheme)
    require_limits(panda, best)
    report = trajectory.check(panda, best, acceleration=10.0)
    assert report or {b.quantity for b in report} == {"position"}, str(report)  # positions are the path's


@pytest.mark.slow
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("kind", PATHS)
def test_limits_hold_between_grid_points_in_hundreds_of_cases(
    panda: ulna.Robot, kind: str, scheme: str
) -> None:
    for seed in range(2, 12):
        grid = (5, 40, 100, 200)[seed % 4]
        best = solve(panda, kind, seed, scheme, grid=grid)
        require_limits(panda, best)
        report = trajectory.check(panda, best, acceleration=10.0)
        assert report or {b.quantity for b in report} == {"position"}, (seed, str(report))


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("seed", range(4))
def test_blends_as_reported(panda: ulna.Robot, seed: int, scheme: str) -> None:
    """Accelerations were up to 17 times the limit here: blends were shorter than segments of the grid."""
    path = trajectory.blended(way_points(panda, np.random.default_rng(seed), 5), blend=0.1, velocity=0.8)
    require_limits(panda, trajectory.time_optimal(path, panda, acceleration=10.0, scheme=scheme))  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(3))
def test_limits_that_differ_by_direction(panda: ulna.Robot, seed: int) -> None:
    rng = np.random.default_rng(seed)
    speed = np.stack([-rng.uniform(0.2, 2.0, 7), rng.uniform(0.2, 2.0, 7)])
    hard = np.stack([-rng.uniform(1.0, 9.0, 7), rng.uniform(1.0, 9.0, 7)])
    points = way_points(panda, rng, 5)
    for path in (points, trajectory.blended(points, 0.1, velocity=0.8), cornered(points, rng)):
        best = trajectory.time_optimal(path, panda, velocity=speed, acceleration=hard)
        require_limits(panda, best, hard, velocity=speed)


def test_torques_near_those_at_rest(panda: ulna.Robot) -> None:
    path = trajectory.cubic_spline(way_points(panda, np.random.default_rng(0), 5), duration=1.0)
    at_rest = np.abs(panda.gravity_forces(path(np.linspace(0.0, 1.0, 999)))).max(axis=0)
    effort = np.maximum(1.01 * at_rest, 1.0)
    best = trajectory.time_optimal(path, panda, torque=effort)
    both = np.stack([-effort, effort])
    assert dense_use(panda, best, HARD, torque=both)["torque"] <= 1.0 + TOLERANCE
    with pytest.raises(
        InputError, match=r"At rest at s = 0\.\d+ the torque of 'panda_joint\d' is .* beyond its limit"
    ):
        trajectory.time_optimal(path, panda, torque=np.maximum(0.9 * at_rest, 1.0))


def test_rates_at_the_ends_are_kept_with_the_limits(panda: ulna.Robot) -> None:
    points = way_points(panda, np.random.default_rng(0), 5)
    best = trajectory.time_optimal(points, panda, acceleration=10.0, start_rate=0.2, end_rate=0.1)
    np.testing.assert_allclose(best.law.v([0.0, best.duration])[:, 0], [0.2, 0.1], atol=1e-9)
    require_limits(panda, best)


def test_corners_are_stops() -> None:
    path = cornered(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]]), np.random.default_rng(0))
    best = trajectory.time_optimal(path, velocity=1.0, acceleration=2.0, grid=400)
    assert best.duration == pytest.approx(1.5 + 2.5, rel=1e-3)  # two trapezoids
    corner = best.knots[np.argmin(np.abs(best(best.knots) - [1.0, 0.0]).max(axis=1))]
    np.testing.assert_allclose(best.v(corner), 0.0, atol=1e-7)
    assert np.abs(best.a(dense_times(best))).max() <= 2.0 * (1.0 + TOLERANCE)
    back = trajectory.time_optimal(
        cornered(np.array([[0.0], [1.0], [0.0]]), np.random.default_rng(0)), acceleration=2.0
    )
    assert back.duration == pytest.approx(4.0 * np.sqrt(0.5), rel=1e-3)


def test_paths_that_stand_still_for_a_while() -> None:
    wait = trajectory.Polynomial.of([0.0, 1.0], [[[1.0]]])
    path = trajectory.quintic(0.0, 1.0, 1.0) + wait + trajectory.quintic(1.0, 2.0, 1.0)
    repeated = trajectory.cubic_spline([[0.0], [1.0], [1.0], [2.0]], times=[0.0, 1.0, 2.0, 3.0])
    for curve in (path, repeated):
        best = trajectory.time_optimal(curve, velocity=1.0, acceleration=1.0)
        assert np.isfinite(best.duration) and best.duration > 3.0
        assert np.abs(best.a(dense_times(best))).max() <= 1.0 + TOLERANCE
        assert np.abs(best.v(dense_times(best))).max() <= 1.0 + TOLERANCE
        np.testing.assert_allclose(best.end, [2.0], atol=1e-9)


@pytest.mark.parametrize("size", [1e-9, 1e-3, 1e6])
@pytest.mark.parametrize("length", [1e-6, 1.0, 1e6])
def test_paths_of_any_size_and_any_parameter(size: float, length: float) -> None:
    points = size * np.random.default_rng(3).normal(size=(5, 3))
    best = trajectory.time_optimal(
        trajectory.cubic_spline(points, duration=length), velocity=2.0, acceleration=10.0
    )
    t = dense_times(best)
    use = max(np.abs(best.a(t)).max() / 10.0, np.abs(best.v(t)).max() / 2.0)
    assert 0.99 < use <= 1.0 + TOLERANCE


def test_what_does_not_move_or_jumps_is_refused(panda: ulna.Robot) -> None:
    rest = trajectory.Polynomial.of([0.0, 1.0], [[panda.configurations["qr"]]])
    for options in ({"robot": panda}, {"acceleration": 1.0}, {"acceleration": 1.0, "velocity": 1.0}):
        with pytest.raises(InputError, match="does not move"):
            trajectory.time_optimal(rest, **options)
    gap = trajectory.Polynomial.of([0.0, 1.0, 2.0], [[[0.0], [1.0]], [[1.1], [1.0]]])
    with pytest.raises(InputError, match=r"jumps by 0\.1 at s = 1 of 2"):
        trajectory.time_optimal(gap, acceleration=1.0)
    with pytest.raises(InputError, match="the same point"):
        trajectory.time_optimal([[0.0], [1.0], [1.0]], acceleration=1.0)
    with pytest.raises(InputError, match="on both sides"):
        trajectory.time_optimal([[0.0], [1.0]], acceleration=[[-1.0], [np.inf]])


def test_knots_of_a_path_near_each_other() -> None:
    for gap in (1e-14, 1e-9):
        line = trajectory.Polynomial.of(
            [0.0, 1.0, 1.0 + gap, 2.0], [[[0.0], [1.0]], [[1.0], [1.0]], [[1.0], [1.0]]]
        )
        best = trajectory.time_optimal(line, velocity=1.0, acceleration=1.0)
        assert best.duration == pytest.approx(3.0, rel=1e-6)


def test_a_law_and_its_path_are_of_one_piece_at_knots(panda: ulna.Robot) -> None:
    """Rounding must not pair the acceleration of one piece of the law with the curvature of another one's path."""
    path = trajectory.blended(way_points(panda, np.random.default_rng(2), 6), blend=0.05, velocity=0.8)
    best = trajectory.time_optimal(path, panda, acceleration=10.0)
    for t in (
        best,
        best.reversed(),
        best.slowed(1.0 + 1e-9),
        path.retimed(trajectory.quintic(0.0, path.duration, 9.0)),
    ):
        knots = t.knots[1:-1]
        step = 1e-7 * np.diff(t.knots).min()
        for near, at in ((knots + step, knots), (knots - step, np.nextafter(knots, 0.0))):
            np.testing.assert_allclose(t.a(at), t.a(near), atol=1e-4)


def test_check_looks_between_its_samples(panda: ulna.Robot) -> None:
    rng = np.random.default_rng(4)
    for _ in range(4):
        t = trajectory.quintic(*way_points(panda, rng, 2), 1.0, v0=rng.normal(size=7), v1=rng.normal(size=7))
        report = trajectory.check(panda, t, acceleration=10.0, samples=2)
        found = dense_use(panda, t, HARD)
        for name in ("velocity", "acceleration", "torque"):
            assert report.use[name] == pytest.approx(found[name], rel=1e-5)


def test_a_peak_between_coarse_samples_is_found(panda: ulna.Robot) -> None:
    """One thousandth of the motion is too fast, and no even sample falls into it."""
    q = panda.configurations["qr"]
    times = np.array([0.0, 5.0, 5.005, 10.0])
    jump = trajectory.cubic_spline(q + np.array([0.0, 0.0, 0.02, 0.0])[:, None], times)
    report = trajectory.check(panda, jump, samples=2, torque=False)
    fast = [b for b in report if b.quantity == "velocity"]
    assert fast
    truth = np.abs(jump.v(np.linspace(4.9, 5.1, 200_001))).max(axis=0)
    for breach in fast:
        k = panda.model.velocity_names.index(breach.joint)
        assert abs(breach.value) == pytest.approx(truth[k], rel=1e-6)


def test_greatest_values_of_polynomials_are_exact() -> None:
    rng = np.random.default_rng(6)
    t = trajectory.minimum_jerk(rng.normal(size=(40, 3)), duration=3.0)
    peaks = greatest(lambda at: np.concatenate(t._at(at, 3)[1:], axis=1), t.knots, 10, np.full(9, 1e-9))
    dense = np.concatenate(t._at(np.linspace(0.0, 3.0, 400_001), 3)[1:], axis=1).max(axis=0)
    assert (peaks.bound >= dense * (1.0 - 1e-8)).all()  # the ends of intervals are sampled from inside
    np.testing.assert_allclose(peaks.bound, dense, rtol=1e-6)
    np.testing.assert_allclose(peaks.value, peaks.bound, atol=1e-8)


def generators(
    rng: np.random.Generator, robot: ulna.Robot
) -> dict[str, tuple[trajectory.Trajectory, list[Any]]]:
    """Motions that promise limits of velocity, acceleration and jerk, and these limits."""
    p = way_points(robot, rng, 5)
    v, a, j = rng.uniform(0.5, 2.0, 7), rng.uniform(1.0, 9.0, 7), rng.uniform(5.0, 90.0, 7)
    slow = v * rng.uniform(-0.5, 0.5, (2, 7))
    T = [ulna.SE3.from_matrix(robot.fk(q)) for q in p[:2]]
    pose = [[0.5] * 3 + [1.0] * 3, [2.0] * 3 + [3.0] * 3]
    spline = trajectory.cubic_spline(p, duration=3.0)
    return {
        "trapezoidal": (trajectory.trapezoidal(p[0], p[1], v, a), [v, a]),
        "trapezoidal, time": (trajectory.trapezoidal(p[0], p[1], v, a, synchronise="time"), [v, a]),
        "trapezoidal, none": (trajectory.trapezoidal(p[0], p[1], v, a, 30.0, synchronise="none"), [v, a]),
        "s-curve": (trajectory.s_curve(p[0], p[1], v, a, j), [v, a, j]),
        "s-curve, time": (trajectory.s_curve(p[0], p[1], v, a, j, synchronise="time"), [v, a, j]),
        "s-curve, none": (trajectory.s_curve(p[0], p[1], v, a, j, synchronise="none"), [v, a, j]),
        "straight": (trajectory.straight(robot, p[0], p[1], None, v, a), [v, a]),
        "straight, jerk": (trajectory.straight(robot, p[0], p[1], None, v, a, j), [v, a, j]),
        "parabolic blends": (trajectory.blended(p, 0.2, velocity=v), [v]),
        "quintic blends": (trajectory.blended(p, 0.2, velocity=v, kind="quintic"), [v]),
        "jerk-limited": (
            trajectory.jerk_limited(p[0], slow[0], None, p[1], slow[1], None, v, a, j),
            [v, a, j],
        ),
        "within": (spline.within(v, a, j), [v, a, j]),
        "blends within": (trajectory.blended(p, 0.2, velocity=v).within(v, a), [v, a]),
        "pose line": (trajectory.pose_line(*T, velocity=(0.5, 1.0), acceleration=(2.0, 3.0)), pose),
    }


def require_promises(rng: np.random.Generator, robot: ulna.Robot) -> None:
    for name, (t, limits) in generators(rng, robot).items():
        rates = t._at(dense_times(t), len(limits))[1:]
        for order, (rate, limit) in enumerate(zip(rates, limits, strict=True), start=1):
            high = np.asarray(limit, dtype=float)
            assert part(rate, -high, high) <= 1.0 + 1e-9, (name, order)


def test_other_motions_keep_the_limits_they_promise(panda: ulna.Robot) -> None:
    pytest.importorskip("ruckig")
    for seed in range(3):
        require_promises(np.random.default_rng(seed), panda)


@pytest.mark.slow
def test_other_motions_keep_the_limits_they_promise_in_hundreds_of_cases(panda: ulna.Robot) -> None:
    pytest.importorskip("ruckig")
    for seed in range(3, 60):
        require_promises(np.random.default_rng(seed), panda)


@pytest.mark.parametrize("degree", [7, 12])
def test_polynomials_of_high_degree(degree: int) -> None:
    """Their constraints are no quartics: segments are halved until quartics are close enough."""
    c = np.random.default_rng(degree).normal(size=(1, degree + 1, 3)) * 3.0
    best = trajectory.time_optimal(
        trajectory.Polynomial.of([0.0, 1.0], c), velocity=2.0, acceleration=10.0, grid=4
    )
    t = dense_times(best)
    use = max(np.abs(best.a(t)).max() / 10.0, np.abs(best.v(t)).max() / 2.0)
    assert 0.97 < use <= 1.0 + TOLERANCE


def test_paths_on_the_manifold_of_configurations() -> None:
    flyer = ulna.load("ur5", root=FreeFlyer())
    q0, q1 = flyer.random_configuration(2, seed=1)
    best = trajectory.time_optimal(
        trajectory.straight(flyer, q0, q1, 1.0), flyer, velocity=2.0, acceleration=3.0, torque=np.inf
    )
    t = dense_times(best)
    assert np.abs(best.v(t)).max() <= 2.0 * (1.0 + TOLERANCE)
    assert 2.9 < np.abs(best.a(t)).max() <= 3.0 * (1.0 + TOLERANCE)
    np.testing.assert_allclose(flyer.difference(best.end, q1), 0.0, atol=1e-9)


def test_an_invalid_robot_is_named() -> None:
    """It was "'NoneType' object has no attribute 'nq'"."""
    move = trajectory.quintic([0.0], [1.0], duration=1.0)
    with pytest.raises(InputError, match="`robot` is None; expected a Robot"):
        trajectory.check(None, move)
    with pytest.raises(InputError, match="`robot` is 'panda'; expected a Robot"):
        trajectory.straight("panda", [0.0], [1.0], duration=1.0)


def test_only_rows_that_leave_nothing_at_rest_lose_a_part_of_their_limits() -> None:
    """Others are slowed down instead; row 0 holds at rest, row 1 is above its greatest value there."""
    low, high = np.full((3, 4, 2), -1.0), np.stack([np.full((3, 4), 1.0), np.full((3, 4), -0.5)], axis=-1)
    grid: Any = SimpleNamespace(rows=SimpleNamespace(low=low, high=high))
    over = np.full((3, 2), 0.25)
    bound = Bound(
        below=-over, above=over, less_low=np.ones((3, 2)), less_high=np.ones((3, 2)), worst=np.ones(3)
    )
    usable = solver._UsableLimits(1.0, 1.0, 1.0, 0.0, np.zeros(3), np.ones(4))
    lowered = solver._lowered(grid, usable, bound, np.ones(3))
    np.testing.assert_array_equal(lowered.less[0], 0.0)
    np.testing.assert_array_equal(lowered.less[1, :, 0], 0.0)
    assert (lowered.less[1, :, 1] >= 0.25).all()
