"""Time-optimal parameterisation: limits kept and used, exact cases, the sets against linear programs, clear refusals."""

import numpy as np
import pytest

import ulna
from ulna import trajectory
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.trajectory import constraint_rows, reach

LINE = trajectory.Polynomial.of(
    [0.0, 1.0], [[[0.0, 0.0], [1.0, -0.5]]]
)  # straight, by one and by minus a half


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


def wander(robot: ulna.Robot, seed: int, count: int = 5) -> trajectory.Polynomial:
    rng = np.random.default_rng(seed)
    low, high = robot.limits.lower, robot.limits.upper
    points = low + (high - low) * rng.uniform(0.2, 0.8, (count, robot.nq))
    return trajectory.cubic_spline(points, duration=1.0, v0=points[1] - points[0], v1=points[-1] - points[-2])


@pytest.mark.parametrize("scheme", ["interpolation", "collocation"])
def test_a_straight_line_is_the_trapezoid(scheme: str) -> None:
    best = trajectory.time_optimal(LINE, velocity=0.5, acceleration=2.0, grid=400, scheme=scheme)  # type: ignore[arg-type]
    assert best.duration == pytest.approx(trajectory.trapezoidal(0.0, 1.0, 0.5, 2.0).duration, rel=1e-4)
    bang = trajectory.time_optimal(LINE, acceleration=2.0, grid=100)
    assert bang.duration == pytest.approx(2.0 * np.sqrt(0.5), rel=1e-9)
    assert np.abs(bang.sample(n=999).a[:, 0]).max() == pytest.approx(2.0)


def test_limits_may_differ_by_direction() -> None:
    best = trajectory.time_optimal(LINE, acceleration=[[-1.0, -9.0], [4.0, 9.0]], grid=200)
    a = best.sample(n=999).a[:, 0]
    assert a.max() == pytest.approx(4.0) and a.min() == pytest.approx(-1.0)


def test_rates_at_the_ends() -> None:
    best = trajectory.time_optimal(LINE, velocity=2.0, acceleration=1.0, start_rate=0.5, end_rate=0.25)
    np.testing.assert_allclose(best.v([0.0, best.duration])[:, 0], [0.5, 0.25], atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_limits_are_used_and_kept(panda: ulna.Robot, seed: int) -> None:
    path = wander(panda, seed)
    best = trajectory.time_optimal(path, panda, acceleration=12.0, grid=400)
    report = trajectory.check(panda, best, acceleration=12.0)
    assert report, str(report)
    used = max(report.use[name] for name in ("velocity", "acceleration", "torque"))
    assert used > 0.999
    np.testing.assert_allclose(best.end, path.end, atol=1e-12)
    np.testing.assert_allclose(best.v([0.0, best.duration]), 0.0, atol=1e-9)


def test_a_coarse_grid_costs_time_and_no_limit(panda: ulna.Robot) -> None:
    path = wander(panda, 7)
    durations = []
    for grid in (10, 50, 200, 800):
        best = trajectory.time_optimal(path, panda, acceleration=12.0, grid=grid)
        assert trajectory.check(panda, best, acceleration=12.0)
        durations.append(best.duration)
    assert (np.diff(durations) < 0.0).all() and durations[1] < 1.03 * durations[-1]


def test_knots_of_the_path_are_grid_points(panda: ulna.Robot) -> None:
    path = wander(panda, 2)
    best = trajectory.time_optimal(path, panda, acceleration=12.0, grid=100)
    assert set(path.knots) <= {0.0, 1.0, *best.law.coefficients[:, 0, 0]}
    assert trajectory.check(panda, best, acceleration=12.0).use["acceleration"] <= 1.0 + 1e-6


@pytest.mark.parametrize("grid", [7, 100, 113])
def test_the_sets_are_those_of_linear_programs(panda: ulna.Robot, grid: int) -> None:
    """Each pass on random rows against SciPy's solver, also where grids do not fill the kernels' blocks."""
    linprog = pytest.importorskip("scipy.optimize").linprog
    path = wander(panda, 3)
    s = np.linspace(0.0, 1.0, grid + 1)
    D = 2.0 * np.diff(s)
    q, a, b = path._at(s, 2)
    limits = constraint_rows.bounds_of("torque", 0.6 * panda.limits.effort, 7)
    rows = constraint_rows.torque_rows(panda.model, q, a, b, limits)
    cap = ((panda.limits.velocity / np.abs(a)) ** 2).min(axis=1)
    back, ahead = reach.reachable(D, [row[:-1] for row in rows.arrays])
    K = reach.controllable(back, cap, 0.0)
    x = reach.fastest(ahead, K, 0.0)
    for k in np.linspace(0, grid - 1, 7).astype(int):
        sides = np.concatenate([np.stack([rows.b[k], rows.a[k]], 1), [[1.0, D[k]]]])
        high = np.append(rows.high[k], K[k + 1, 1])
        low = np.append(rows.low[k], K[k + 1, 0])
        for sign, found in ((1.0, K[k, 0]), (-1.0, K[k, 1])):
            program = linprog(
                [sign, 0.0],
                A_ub=np.concatenate([sides, -sides]),
                b_ub=np.concatenate([high, -low]),
                bounds=[(0.0, cap[k]), (None, None)],
            )
            assert program.success
            assert found == pytest.approx(sign * program.fun, rel=1e-6, abs=1e-7)
        step = linprog(
            [-1.0],
            A_ub=np.concatenate([sides[:, 1:], -sides[:, 1:]]),
            b_ub=np.concatenate([high - sides[:, 0] * x[k], sides[:, 0] * x[k] - low]) + 1e-9,
            bounds=[(None, None)],
        )
        assert x[k + 1] == pytest.approx(x[k] - D[k] * step.fun, rel=1e-5, abs=1e-6)


def test_points_of_zero_inertia() -> None:
    """Joint 0 turns back half way: there its limit bounds the rate, though its acceleration does not depend on u."""
    s = np.linspace(0.0, 1.0, 9)
    path = trajectory.cubic_spline(
        np.stack([(s - 0.5) ** 2, s], axis=1), times=s, v0=[-1.0, 1.0], v1=[1.0, 1.0]
    )
    best = trajectory.time_optimal(path, acceleration=[1.0, 100.0], velocity=10.0, grid=200)
    middle = best.law.times[np.argmin(np.abs(best.law.coefficients[:, 0, 0] - 0.5))]
    assert best.law._at(np.array([middle]), 1)[1][0, 0] == pytest.approx(np.sqrt(0.5), rel=1e-2)  # 2 x <= 1
    assert np.abs(best.sample(n=2000).a[:, 0]).max() < 1.0 + 1e-6


def test_a_joint_that_rests_does_not_matter() -> None:
    path = trajectory.Polynomial.of([0.0, 1.0], [[[0.0, 3.0], [1.0, 0.0]]])
    best = trajectory.time_optimal(path, velocity=[1.0, 1e-3], acceleration=[2.0, 1e-3])
    assert best.duration == pytest.approx(
        trajectory.time_optimal(LINE, velocity=1.0, acceleration=2.0).duration
    )


def test_a_path_that_rests_at_its_ends_is_no_obstacle() -> None:
    """There p' is zero, and no limit bounds the rate: what one would call a bad parameter still has an answer."""
    path = trajectory.quintic([0.0, 0.0], [1.0, -0.5], 1.0)
    best = trajectory.time_optimal(path, velocity=10.0, acceleration=2.0, grid=400)
    assert best.duration == pytest.approx(2.0 * np.sqrt(0.5), rel=0.01)


def test_way_points_and_grids(panda: ulna.Robot) -> None:
    points = wander(panda, 1)([0.0, 0.3, 0.6, 1.0])
    free = np.full(7, np.inf)
    free[2] = 5.0
    best = trajectory.time_optimal(
        points, panda, acceleration=free, torque=np.inf, grid=np.linspace(0, 1, 30) ** 1.2
    )
    np.testing.assert_allclose(best.end, points[-1], atol=1e-12)
    given = np.linspace(0, 1, 30) ** 1.2
    assert set(given[1:-1]) < set(best.law.coefficients[:, 0, 0])  # the path's knots come on top
    assert best.kind == "time-optimal"


def test_no_motion_is_explained(panda: ulna.Robot) -> None:
    path = wander(panda, 5)
    with pytest.raises(InputError, match=r"at s = .* of 1 \(grid point \d+\): the torque of 'panda_joint\d'"):
        trajectory.time_optimal(path, panda, torque=0.05 * panda.limits.effort)
    with pytest.raises(InputError, match=r"`start_rate` is 50 1/s.*the speed of 'panda_joint\d' exceeds"):
        trajectory.time_optimal(path, panda, start_rate=50.0)
    with pytest.raises(InputError, match=r"`end_rate` is 50 1/s.*grid point 100"):
        trajectory.time_optimal(path, panda, end_rate=50.0)
    with pytest.raises(InputError, match=r"`start_rate` is 4 1/s.*acceleration of 'q0'"):
        trajectory.time_optimal(LINE, acceleration=1.0, start_rate=4.0)
    with pytest.raises(InputError, match="zero or above"):
        trajectory.time_optimal(LINE, acceleration=1.0, start_rate=np.nan)


def test_mistakes_are_named(panda: ulna.Robot) -> None:
    with pytest.raises(InputError, match="zero between them"):
        trajectory.time_optimal(LINE, acceleration=[1.0, 0.0])
    with pytest.raises(InputError, match="zero between them"):
        trajectory.time_optimal(LINE, acceleration=[[0.1, -1.0], [1.0, 1.0]])
    with pytest.raises(InputError, match="No limit of acceleration or torque"):
        trajectory.time_optimal(LINE, velocity=1.0)
    with pytest.raises(InputError, match="without `robot`"):
        trajectory.time_optimal(LINE, torque=1.0)
    with pytest.raises(InputError, match=r"expected \(7,\), configurations of 'panda'"):
        trajectory.time_optimal(LINE, panda)
    with pytest.raises(ShapeError, match="acceleration"):
        trajectory.time_optimal(LINE, acceleration=[1.0, 2.0, 3.0])
    with pytest.raises(InputError, match="at least 2 segments"):
        trajectory.time_optimal(LINE, acceleration=1.0, grid=1)
    with pytest.raises(InputError, match="does not increase from 0 to 1"):
        trajectory.time_optimal(LINE, acceleration=1.0, grid=[0.0, 0.5, 0.9])
    with pytest.raises(UnknownName, match="'collocation'"):
        trajectory.time_optimal(LINE, acceleration=1.0, scheme="colocation")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="poses"):
        trajectory.time_optimal(
            trajectory.pose_line(ulna.SE3.identity(), ulna.SE3.rx(1.0), 1.0), acceleration=1.0
        )


def test_the_joint_that_is_too_fast_at_the_start_is_named() -> None:
    """q = (s, 1000 s^2): at s = 0 the first joint alone moves, at the next grid point the second one is faster."""
    path = trajectory.Polynomial.of([0.0, 1.0], [[[0.0, 0.0], [1.0, 0.0], [0.0, 1000.0]]])
    with pytest.raises(InputError, match=r"`start_rate` is 3 1/s.*the speed of 'q0' exceeds"):
        trajectory.time_optimal(path, velocity=1.0, acceleration=1e5, start_rate=3.0)
    with pytest.raises(InputError, match=r"`end_rate` is 3 1/s.*the speed of 'q1' exceeds"):
        trajectory.time_optimal(path, velocity=1.0, acceleration=1e5, end_rate=3.0)
