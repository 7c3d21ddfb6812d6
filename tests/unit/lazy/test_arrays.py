"""Arrays of Dask and xarray in place of NumPy's: lazy, of known shape and type, and equal to NumPy's results."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import trajectory
from ulna.collision import World
from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError, UnknownName
from ulna.geometry import Box
from ulna.planning import Planner

dask = pytest.importorskip("dask")
da = pytest.importorskip("dask.array")


@pytest.fixture(scope="module")
def robot() -> ulna.Robot:
    return ulna.load("panda")


@pytest.fixture(scope="module")
def world() -> World:
    return World().add("post", Box((0.1, 0.1, 1.0)), (0.5, 0.0, 0.3))


@pytest.fixture(scope="module")
def Q(robot: ulna.Robot) -> Any:
    return robot.random_configuration(40, seed=0)


@pytest.fixture(scope="module")
def lazy(Q: Any) -> Any:
    return da.from_array(Q, chunks=(15, 4))  # cut along the joints, too


def height(q: Any) -> Any:
    return np.stack([q[0] * q[1], np.sin(q[2])])


def same(got: Any, expected: Any) -> None:
    got, expected = (x if isinstance(x, tuple) else (x,) for x in (got, expected))
    assert len(got) == len(expected)
    for a, b in zip(got, expected, strict=True):
        assert isinstance(a, da.Array)
        assert a.shape == b.shape and a.dtype == b.dtype
        np.testing.assert_array_equal(a.compute(scheduler="sync"), b)


def test_quantities_are_lazy_and_equal(robot: ulna.Robot, Q: Any, lazy: Any) -> None:
    v, a = np.full(7, 0.1), np.ones((40, 7))
    same(robot.fk(lazy), robot.fk(Q))
    same(robot.fk(lazy, "all"), robot.fk(Q, "all"))
    same(robot.fk(lazy, threads=2), robot.fk(Q))
    same(robot.jacobian(lazy, "panda_hand", "local"), robot.jacobian(Q, "panda_hand", "local"))
    same(robot.inverse_dynamics(lazy, v, a), robot.inverse_dynamics(Q, v, a))
    same(robot.inverse_dynamics(Q, v, da.ones((40, 7), chunks=(11, 7))), robot.inverse_dynamics(Q, v, a))
    same(robot.kinetic_energy(lazy, v), robot.kinetic_energy(Q, v))
    same(robot.derivatives.inverse_dynamics(lazy, v, a[:1]), robot.derivatives.inverse_dynamics(Q, v, a[:1]))
    force = {"panda_hand": da.ones((40, 6), chunks=(15, 6)), "panda_link4": np.ones(6)}
    plain = {"panda_hand": np.ones((40, 6)), "panda_link4": np.ones(6)}
    same(robot.static_torque(lazy, force), robot.static_torque(Q, plain))
    same(robot.limits.contains(lazy), robot.limits.contains(Q))
    same(robot.limits.clip(2 * lazy), robot.limits.clip(2 * Q))


def test_clipping_lazy_configurations_refuses_nan_when_computed(robot: ulna.Robot, lazy: Any) -> None:
    clipped = robot.limits.clip(lazy + np.nan)
    with pytest.raises(NonFiniteError, match="`q"):
        clipped.compute(scheduler="sync")


def test_limits_take_labels_in_any_order(robot: ulna.Robot, Q: Any) -> None:
    xarray = pytest.importorskip("xarray")
    labels = list(robot.joint_names)
    table = xarray.DataArray(2.0 * Q, dims=("time", "joint"), coords={"joint": labels})
    turned = table.isel(joint=slice(None, None, -1))
    inside = robot.limits.contains(turned)
    assert inside.dims == ("time",) and not inside.values.all()
    np.testing.assert_array_equal(inside.values, robot.limits.contains(2.0 * Q))
    clipped = robot.limits.clip(turned)
    assert clipped.dims == ("time", "joint")
    np.testing.assert_array_equal(clipped.sel(joint=labels).values, robot.limits.clip(2.0 * Q))
    with pytest.raises(InputError, match="joint"):
        robot.limits.contains(table.assign_coords(joint=["a", *labels[1:]]))


def test_kernels_and_own_functions(robot: ulna.Robot, Q: Any, lazy: Any) -> None:
    same(robot.kernel("fk", dtype="float32")(lazy), robot.kernel("fk", dtype="float32")(Q))
    same(ulna.compile(height, robot)(lazy), ulna.compile(height, robot)(Q))
    same(ulna.compile(height, robot).jacobian()(q=lazy), ulna.compile(height, robot).jacobian()(Q))
    same(robot.kernel("fk").dask(Q), robot.fk(Q))
    same(robot.fk(lazy[0]), robot.fk(Q[0]))
    grid = da.from_array(Q.reshape(4, 10, 7), chunks=(2, 5, 7))
    same(robot.fk(grid), robot.fk(Q.reshape(4, 10, 7)))
    assert robot.fk(grid).numblocks == (2, 2, 1, 1)


def test_lengths_that_are_not_known_yet(robot: ulna.Robot, Q: Any, lazy: Any) -> None:
    got = robot.fk(lazy[lazy[:, 0] > 0.0])
    np.testing.assert_array_equal(got.compute(scheduler="sync"), robot.fk(Q[Q[:, 0] > 0.0]))


def test_the_function_is_not_called_before_compute(robot: ulna.Robot) -> None:
    def explode(block: Any) -> Any:
        raise RuntimeError("computed")

    rows = da.map_blocks(explode, da.zeros((10**9, 7), chunks=(10**6, 7)), dtype=float)
    poses = robot.fk(rows)
    assert poses.shape == (10**9, 4, 4) and poses.numblocks == (1000, 1, 1)
    solution = robot.ik(poses)
    assert solution.q.shape == (10**9, 7) and solution.success.dtype == bool and solution.is_lazy


def test_wrong_arrays_are_refused_at_once(robot: ulna.Robot, lazy: Any) -> None:
    with pytest.raises(ShapeError, match=r"`q` has shape \(3, 6\); expected \(..., 7\)"):
        robot.fk(da.ones((3, 6)))
    with pytest.raises(DtypeError, match="`q` has dtype complex128"):
        robot.fk(da.ones((3, 7), dtype=complex))
    with pytest.raises(
        ShapeError, match=r"leading axes that broadcast. Together: `q` \(40, 7\), `v` \(3, 7\)"
    ):
        robot.inverse_dynamics(lazy, np.ones((3, 7)), np.ones(7))
    with pytest.raises(InputError, match="`out` is given"):
        robot.fk(lazy, out=np.empty((40, 4, 4)))
    with pytest.raises(ulna.errors.NonFiniteError, match="`q"):
        robot.fk(da.full((3, 7), np.nan)).compute(scheduler="sync")


def test_inverse_kinematics(robot: ulna.Robot, Q: Any, lazy: Any) -> None:
    T, poses = robot.fk(lazy), robot.fk(Q)
    solution = robot.ik(T, lazy)
    assert solution.is_lazy and repr(solution).startswith("<lazy IK solutions (40,)")
    (done,) = dask.compute(solution, scheduler="sync")
    expected = robot.ik(poses, Q)
    for name in ("q", "success", "iterations", "restarts", "position_error", "rotation_error"):
        same(getattr(solution, name), getattr(expected, name))
        np.testing.assert_array_equal(getattr(done, name), getattr(expected, name))
    assert (done.reason == expected.reason).all() and not done.is_lazy
    with pytest.raises(InputError, match=r"result.compute\(\).reason"):
        _ = solution.reason
    assert robot.ik(T[..., :3, 3], mask="position").compute(scheduler="sync").success.all()
    two = {name: robot.fk(lazy, name) for name in ("panda_link4", "panda_hand")}
    assert robot.ik(two, lazy, mask="position").compute(scheduler="sync").success.all()
    assert robot.ik_classic(T[:5]).compute(scheduler="sync").success.all()
    assert robot.ik(poses[0], lazy[:3]).compute(scheduler="sync").success.all()


def test_all_solutions(robot: ulna.Robot) -> None:
    ur5 = ulna.load("ur5")
    q = ur5.random_configuration(12, seed=1)
    lazy = ur5.ik_all(ur5.fk(da.from_array(q, chunks=(5, 6))))
    expected = ur5.ik_all(ur5.fk(q))
    done = lazy.compute(scheduler="sync")
    assert lazy.q.shape == (12, 8, 6) and done.complete is True
    np.testing.assert_array_equal(done.count, expected.count)
    np.testing.assert_array_equal(done[3].q, expected[3].q)
    turned = ur5.ik_all(ur5.fk(da.from_array(q[:2], chunks=(1, 6))), turns=True)
    np.testing.assert_array_equal(
        turned.compute(scheduler="sync").count, ur5.ik_all(ur5.fk(q[:2]), turns=True).count
    )
    few = robot.ik_all(robot.fk(da.from_array(np.zeros((1, 7)) + 0.3)), samples=4)
    assert few.q.shape == (1, 32, 7)


@pytest.mark.parametrize("method", ["exact", "spheres"])
def test_collisions(robot: ulna.Robot, world: World, Q: Any, lazy: Any, method: Any) -> None:
    same(robot.collides(lazy, world, method=method), robot.collides(Q, world, method=method))
    checker = robot.collision.checker(world, method=method)
    same(checker.collides(lazy, margin=0.1), checker.collides(Q, margin=0.1))
    moved = world.add("box", Box((0.1, 0.1, 0.1)), moving=True)
    poses = np.broadcast_to(np.eye(4), (40, 4, 4)).copy()
    poses[:, 0, 3] = np.linspace(0.2, 0.8, 40)
    some = da.from_array(poses, chunks=(9, 4, 4))
    same(
        robot.collides(lazy, moved, moving={"box": some}, method=method),
        robot.collides(Q, moved, moving={"box": poses}, method=method),
    )
    with pytest.raises(UnknownName, match="bax"):
        robot.collides(lazy, moved, moving={"bax": some}, method=method)


def test_distances(robot: ulna.Robot, world: World, Q: Any, lazy: Any) -> None:
    got, expected = robot.distance(lazy, world), robot.distance(Q, world)
    for name in ("distance", "points", "normal", "names"):
        same(getattr(got, name), getattr(expected, name))
    assert got.compute(scheduler="sync").names.tolist() == expected.names.tolist()
    for ask in (robot.distance, robot.collision.distance_gradient):
        with pytest.raises(InputError, match="takes no method='spheres'; `robot.collides` does"):
            ask(lazy, world, method="spheres")
    with pytest.raises(InputError, match="lazy"):
        robot.collision.distance_gradient(lazy, world)
    with pytest.raises(InputError, match="lazy"):
        robot.collision.first_contact(lazy, Q, world)


def test_plans_and_their_trajectories(robot: ulna.Robot, Q: Any) -> None:
    free = Q[~robot.collides(Q, method="spheres")][:5]
    plans = robot.plan(da.from_array(free[:4], chunks=(2, 7)), free[4])
    assert plans.shape == (4,) and plans.dtype == object
    found = plans.compute(scheduler="sync")
    one = robot.plan(free[2], free[4])
    np.testing.assert_array_equal(found[2].points, one.points)
    goals = robot.plan(free[0], da.from_array(free[1:3], chunks=(1, 7))).compute(scheduler="sync")
    assert [bool(plan) for plan in goals] == [True, True]
    timed = da.map_blocks(
        np.vectorize(lambda plan: plan.trajectory(acceleration=5.0), otypes=[object]), plans, dtype=object
    )
    reports = trajectory.check(robot, timed, acceleration=5.0)
    assert reports.shape == (4,)
    assert all(reports.compute(scheduler="sync"))
    for wrong in (
        {"torque": "no"},
        {"tolerance": -1.0},
        {"samples": 1},
        {"acceleration": 0.0},
        {"jerk": [1.0, 2.0]},
    ):
        with pytest.raises(InputError, match=next(iter(wrong))):  # at once, not when reports are computed
            trajectory.check(robot, timed, **wrong)
    with pytest.raises(InputError, match=r"`goal` is lazy, with shape \(4, 3\)"):
        robot.plan(free[0], da.ones((4, 3)))


def test_xarray_keeps_dimensions_and_coordinates(robot: ulna.Robot, world: World, Q: Any) -> None:
    xr = pytest.importorskip("xarray")
    names = list(robot.joint_names)
    x = xr.DataArray(Q, dims=("time", "joint"), coords={"time": np.arange(40) * 0.1, "joint": names})
    T = robot.fk(x)
    assert T.dims == ("time", "row", "column")
    np.testing.assert_array_equal(T.time, x.time)
    np.testing.assert_array_equal(T.values, robot.fk(Q))
    np.testing.assert_array_equal(robot.fk(x[:, ::-1]).values, robot.fk(Q))  # labels, not places
    tau = robot.gravity_forces(x[:, ::-1])
    np.testing.assert_array_equal(tau.sel(joint="panda_joint3").values, robot.gravity_forces(Q)[:, 2])
    np.testing.assert_array_equal(robot.fk(x.chunk(time=7)).compute().values, robot.fk(Q))
    assert robot.ik(T).success.dims == ("time",) and robot.collides(x, world).dims == ("time",)
    assert repr(robot.distance(x, world)) == repr(robot.distance(Q, world))
    with pytest.raises(InputError, match=r"labels.*along 'joint'; expected \['panda_joint1'"):
        robot.fk(x.assign_coords(joint=[*names[:-1], "elbow"]))
    stiffness = robot.kernel("gravity_forces").jacobian()
    np.testing.assert_array_equal(stiffness(x[:, ::-1]).values, stiffness(Q))
    with pytest.raises(InputError, match=r"q.drop_vars\('joint'\)"):
        ulna.compile(height, q=(7,))(x)


def test_labels_count_wherever_numbers_of_joints_are_taken(robot: ulna.Robot, Q: Any) -> None:
    xr = pytest.importorskip("xarray")

    def turned(x: Any) -> Any:
        """The same numbers by name, in another order."""
        dims = ("time", "joint")[-np.ndim(x) :]
        return xr.DataArray(x, dims=dims, coords={"joint": list(robot.joint_names)})[..., ::-1]

    q, v, tau, strong = Q[0], Q[1], 10.0 * Q[2], np.full(7, 80.0)
    quick = trajectory.quintic(q, v, 0.1)
    uses: list[Any] = [
        lambda of: robot.with_configuration("here", of(q)).configurations["here"],
        lambda of: robot.lock(["panda_joint2"], of(q)).fk(np.delete(q, 1)),
        lambda of: robot.ik(robot.fk(v), q0=of(q)).q,
        lambda of: ulna.sim.simulate(robot, of(q), of(v), of(tau), duration=0.01, external=of(tau)).q[-1],
        lambda of: ulna.sim.Body(robot, of(q)).q,
        lambda of: ulna.sim.Body(robot, qd=of(v)).qd,
        lambda of: ulna.sim.kinematic_step(robot, of(q), of(v), 0.1),
        lambda of: np.stack(ulna.sim.dynamic_step(robot, of(q), of(v), of(tau), 0.01)),
        lambda of: ulna.identification.identify(robot, of(Q), of(Q), of(Q), of(Q), ridge=1.0).fitted,
        lambda of: ulna.identification.identify(robot, Q, Q, Q, Q, noise=of(np.exp(q)), ridge=1.0).fitted,
        lambda of: ulna.model.with_joint_dynamics(robot.model, damping=of(np.abs(q))).damping,
        lambda of: trajectory.straight(robot, of(q), of(v), velocity=of(np.exp(q)), acceleration=2.0)(0.3),
        lambda of: trajectory.straight_through(robot, of(Q[:3]), 1.0)(0.3),
        lambda of: trajectory.time_optimal(of(Q[:3]), robot, acceleration=of(np.exp(q)))(0.1),
        lambda of: trajectory.time_optimal(Q[:3], robot, velocity=of(np.exp(v)), torque=of(strong))(0.1),
        lambda of: [b.limit for b in trajectory.check(robot, quick, acceleration=of(np.exp(q))).breaches],
    ]
    for use in uses:
        np.testing.assert_array_equal(use(turned), use(lambda x: x))
    with pytest.raises(InputError, match="`v` has labels"):
        ulna.sim.simulate(robot, q, turned(v).assign_coords(joint=list("abcdefg")), duration=0.01)


def test_tables_are_put_in_order_by_the_names_of_their_columns(robot: ulna.Robot, Q: Any) -> None:
    pd = pytest.importorskip("pandas")
    names = list(robot.joint_names)
    table = pd.DataFrame(Q, columns=names)[names[::-1]]
    q = table.iloc[0]
    pairs: list[tuple[Any, Any]] = [
        (robot.with_configuration("here", q).configurations["here"], Q[0]),
        (ulna.sim.Body(robot, q).q, Q[0]),
        (
            trajectory.straight_through(robot, table[:3], 1.0)(0.3),
            trajectory.straight_through(robot, Q[:3], 1.0)(0.3),
        ),
        (robot.plan(q, Q[0] + 1e-3).points, robot.plan(Q[0], Q[0] + 1e-3).points),
    ]
    for named, plain in pairs:
        np.testing.assert_array_equal(named, plain)
    with pytest.raises(InputError, match=r"`q` has labels \['panda_joint7'.*q.to_numpy\(\) leaves them out"):
        ulna.sim.Body(robot, q[:6])
    np.testing.assert_array_equal(ulna.sim.Body(robot, pd.Series(Q[0])).q, Q[0])


def test_without_a_robot_labels_are_refused_since_their_order_is_not_known(robot: ulna.Robot, Q: Any) -> None:
    xr, pd = pytest.importorskip("xarray"), pytest.importorskip("pandas")
    names = list(robot.joint_names)
    points = xr.DataArray(Q[:3], dims=("point", "joint"), coords={"joint": names})
    table = pd.DataFrame(Q[:3], columns=names)
    for labelled, fix in ((points, r"drop_vars\('joint'\)"), (table, r"to_numpy\(\)")):
        first, last = (labelled[0], labelled[2]) if labelled is points else (table.iloc[0], table.iloc[2])
        uses: list[Any] = [
            lambda x=labelled: trajectory.cubic_spline(x, duration=1.0),
            lambda x=labelled: trajectory.minimum_jerk(x, duration=1.0),
            lambda x=labelled: trajectory.bspline(x, 1.0),
            lambda x=labelled: trajectory.blended(x, 0.1, velocity=1.0),
            lambda x=labelled: trajectory.time_optimal(x, velocity=1.0, acceleration=1.0),
            lambda x=[first, last]: trajectory.cubic_spline(x, duration=1.0),
            lambda a=first, b=last: trajectory.quintic(a, b, 1.0),
            lambda a=first, b=last: trajectory.cubic(a, b, 1.0),
            lambda a=first, b=last: trajectory.trapezoidal(a, b, velocity=1.0, acceleration=1.0),
            lambda a=first, b=last: trajectory.s_curve(a, b, velocity=1.0, acceleration=1.0, jerk=1.0),
            lambda a=first, b=last: trajectory.jerk_limited(a, 0, 0, b, 0, 0, 1.0, 1.0, 1.0),
            lambda a=first: trajectory.jerk_limited(Q[0], 0, 0, Q[1], 0, 0, abs(a), 1.0, 1.0),
        ]
        for use in uses:
            with pytest.raises(
                InputError, match=rf"has labels.*the order of its numbers is not known.*{fix}"
            ):
                use()
    plain = points.drop_vars("joint")
    np.testing.assert_array_equal(
        trajectory.cubic_spline(plain, duration=1.0)(0.3), trajectory.cubic_spline(Q[:3], duration=1.0)(0.3)
    )


def test_a_twist_of_a_robot_with_six_joints_has_no_names_of_joints() -> None:
    xr = pytest.importorskip("xarray")
    robot = ulna.load("ur5")
    q = xr.DataArray(np.full((3, 6), 0.3), dims=("time", "joint"), coords={"joint": list(robot.joint_names)})
    assert robot.frame_velocity(q, q).dims == ("time", "component")
    assert "joint" not in robot.frame_velocity(q, q).coords
    torques = robot.inverse_dynamics(q, q, q)
    assert torques.dims == ("time", "joint") and list(torques.joint.values) == list(robot.joint_names)
    assert ulna.compile(lambda q: 2.0 * q, robot)(q).dims == ("time", "joint")
    pickled = pickle.loads(pickle.dumps(robot.kernel("frame_velocity")))
    assert pickled(q, q).dims == ("time", "component")


def test_joints_along_another_dimension_are_refused() -> None:
    xr = pytest.importorskip("xarray")
    robot = ulna.load("ur5")
    q = xr.DataArray(np.eye(6), dims=("joint", "time"), coords={"joint": list(robot.joint_names)})
    with pytest.raises(InputError, match=r"q.transpose\(\.\.\., 'joint'\)"):
        robot.gravity_forces(q)
    np.testing.assert_array_equal(
        robot.gravity_forces(q.transpose(..., "joint")).values, robot.gravity_forces(np.eye(6))
    )


def test_everything_that_travels_takes_kilobytes(robot: ulna.Robot, world: World, Q: Any) -> None:
    solution = robot.ik(robot.fk(Q[0]))
    things = {
        "kernel": robot.kernel("inverse_dynamics"),
        "own": ulna.compile(height, robot),
        "robot": robot,
        "world": world,
        "solver": robot._solver(robot.fk(Q[0]), None, None, None)[1],
        "solution": solution,
        "branches": robot.ik_all(robot.fk(Q[0])),
        "distance": robot.distance(Q[0], world),
        "plan": robot.plan(robot.configurations["qr"], robot.configurations["qr"] + 0.1),
        "checker": robot.collision.checker(world),
        "spheres": robot.collision.checker(world, method="spheres"),
        "planner": Planner(robot, world),
    }
    for name, thing in things.items():
        size = len(pickle.dumps(thing))
        assert size < 50_000, f"{name} takes {size} bytes"
        assert type(pickle.loads(pickle.dumps(thing))) is type(thing)
    again = pickle.loads(pickle.dumps(things["checker"]))
    np.testing.assert_array_equal(again.collides(Q), things["checker"].collides(Q))


@pytest.mark.parametrize(
    "error",
    [
        ShapeError("q", (3,), "(7,)", "Fix it."),
        UnknownName("joint", "elbw", ["elbow"]),
        ulna.errors.NonFiniteError("q", (1,), float("nan")),
        ulna.errors.FormatError("broken", file="a.urdf", line=3),
        ulna.errors.JobStopped("It ended.", 3, 5, "store"),
        ulna.errors.MissingExtra("dask", "cluster", "This"),
    ],
)
def test_errors_travel(error: Exception) -> None:
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error) and str(again) == str(error)
    assert repr(vars(again)) == repr(vars(error))


def test_a_process_keeps_a_bounded_number_of_functions() -> None:
    from functools import partial

    from ulna.lazy import Portable, portable

    for k in range(2 * portable._MAX_CACHED_FUNCTIONS):
        assert Portable(partial(np.add, k))(1) == k + 1
        assert len(portable._known) <= portable._MAX_CACHED_FUNCTIONS


def test_lengths_that_are_not_known_are_found_before_arrays_are_put_together(
    robot: ulna.Robot, Q: Any, lazy: Any
) -> None:
    some, rows = lazy[lazy[:, 0] > 0.0], Q[Q[:, 0] > 0.0]
    for v in (np.zeros((len(rows), 7)), da.zeros((len(rows), 7), chunks=(3, 7)), 0.1 * some):
        with pytest.raises(InputError, match=r"`q` has blocks of unknown lengths.*q.compute_chunk_sizes\(\)"):
            robot.inverse_dynamics(some, v, np.ones(7))
    some.compute_chunk_sizes()
    tau = robot.inverse_dynamics(some, 0.1 * some, np.ones(7)).compute(scheduler="sync")
    np.testing.assert_allclose(tau, robot.inverse_dynamics(rows, 0.1 * rows, np.ones(7)), rtol=1e-12)


def test_the_argument_that_does_not_broadcast_is_named(robot: ulna.Robot, lazy: Any) -> None:
    with pytest.raises(ShapeError, match=r"`v` has shape \(3, 7\); expected leading axes that broadcast"):
        robot.inverse_dynamics(lazy, np.zeros((3, 7)), np.zeros(7))


def test_normalized_configurations_are_lazy() -> None:
    """They were computed at once, to look for quaternions of length zero."""
    flying = ulna.load("panda", root="free_flyer")
    q = np.stack([2.0 * flying.neutral] * 7)
    space = flying.configuration_space
    same(space.normalize(da.from_array(q, chunks=(3, 5))), space.normalize(q))
    q[5, 3:7] = 0.0
    later = space.normalize(da.from_array(q, chunks=(3, -1)))
    with pytest.raises(InputError, match="quaternion of length 0"):
        later.compute(scheduler="sync")
