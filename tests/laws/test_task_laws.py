"""Laws of tasks and limits: J is how the error shrinks, targets are reached, limits hold, and the optimum is one."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from support.derivatives import by_configuration
from support.random_models import random_model
from ulna import algorithms as alg
from ulna.compiler import compile, trace
from ulna.ik.differential import (
    AccelerationLimit,
    AxisTask,
    ComTask,
    DifferentialIK,
    FrameTask,
    JointCouplingTask,
    LinearTask,
    ManipulabilityTask,
    OrientationTask,
    PlaneLimit,
    PositionLimit,
    PositionTask,
    PostureTask,
    RelativeFrameTask,
    Task,
    VelocityLimit,
)
from ulna.ik.qp import solve_box
from ulna.model import Model

MODELS = {
    "fixed": {"kinds": ("revolute", "continuous", "prismatic", "universal"), "joints": 8, "mimics": 2},
    "floating": {"root": "free_flyer", "kinds": ("revolute", "spherical"), "joints": 6, "mimics": 1},
    "sliding": {"root": "planar", "kinds": ("helical", "translation", "composite"), "joints": 5},
}


def tasks_of(model: Model, rng: np.random.Generator) -> dict[str, Task]:
    scalar = [j.name for j in model.joints if j.kind.nq == 1 and j.kind.nv == 1]
    return {
        "frame": FrameTask("tip"),
        "frame, world": FrameTask("tip", axes="world"),
        "relative": RelativeFrameTask("tip", "side"),
        "position": PositionTask("tip"),
        "position, frame": PositionTask("tip", axes="frame"),
        "orientation": OrientationTask("tip"),
        "orientation, world": OrientationTask("tip", axes="world"),
        "axis": AxisTask("tip", (0.3, -0.2, 1.0)),
        "posture": PostureTask(1.0),
        "linear": LinearTask(rng.standard_normal((2, model.nv))),
        "coupling": JointCouplingTask({scalar[0]: 1.0, scalar[-1]: -0.5}, offset=0.2),
        "com": ComTask(),
    }


@pytest.fixture(scope="module", params=MODELS)
def model(request: pytest.FixtureRequest) -> Model:
    seed = list(MODELS).index(request.param)
    return random_model(np.random.default_rng(seed), **MODELS[request.param])


@pytest.mark.parametrize("name", tasks_of(random_model(np.random.default_rng(0)), np.random.default_rng(0)))
def test_jacobian_is_how_the_error_shrinks(model: Model, name: str) -> None:
    rng = np.random.default_rng(1)
    task = tasks_of(model, rng)[name]
    for _ in range(3):
        q = alg.random(model, rng)
        # far from the target, but not half a turn away, where the error of a rotation jumps
        away = alg.integrate(model, q, 0.4 * rng.standard_normal(model.nv))
        reached = task.reached_by(model, away).values()
        rows = task.rows(model, q, *reached)
        assert rows.J.shape == (len(task.costs(model)), model.nv)
        shrinks = -by_configuration(model, q, lambda x, reached=reached: task.rows(model, x, *reached).e)
        np.testing.assert_allclose(
            rows.J, np.moveaxis(shrinks, 0, -1), atol=2e-8 * max(1.0, np.abs(rows.J).max())
        )


def test_no_error_where_the_target_is_reached(model: Model) -> None:
    rng = np.random.default_rng(2)
    q = alg.random(model, rng)
    for task in tasks_of(model, rng).values():
        if task.inputs(model):
            np.testing.assert_allclose(
                task.rows(model, q, *task.reached_by(model, q).values()).e, 0.0, atol=1e-12
            )


def test_manipulability_grows(panda: ulna.Robot) -> None:
    ik = DifferentialIK(panda, [ManipulabilityTask("panda_hand", rate=1e-4)], [], damping=1e-4)
    q = np.array([0.1, 0.3, -0.2, -0.5, 0.2, 0.6, 0.1])
    before = panda.manipulability(q, frame="panda_hand")
    for _ in range(20):
        q = ik.step(q, 0.1)
    assert panda.manipulability(q, frame="panda_hand") > before + 15e-4


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.fixture(scope="module")
def box() -> dict[int, object]:
    def solve(H, g, lower, upper):
        return tuple(solve_box(H, g, lower, upper))

    return {n: compile(trace(solve, H=(n, n), g=(n,), l=(n,), u=(n,))) for n in (1, 3, 7, 12)}


@pytest.mark.parametrize("n", [1, 3, 7, 12])
def test_the_compiled_optimum_is_that_of_daqp(box: dict, n: int) -> None:
    """Redundant tasks, weights that differ by 1e2, hardly any damping, bounds without room, and bounds at 0."""
    daqp = pytest.importorskip("daqp")
    rng = np.random.default_rng(n)
    for _ in range(300):
        J = rng.standard_normal((rng.integers(1, n + 1), n)) * 10 ** rng.uniform(-1, 1, n)
        H = J.T @ J + 10 ** rng.uniform(-6, 0) * np.eye(n)
        g = rng.standard_normal(n) * 10 ** rng.uniform(-2, 2)
        lower = -rng.exponential(1, n) * rng.integers(0, 2, n)
        upper = rng.exponential(1, n) * rng.integers(0, 2, n)
        x, solved = box[n](H, g, lower, upper)
        assert solved == 1.0
        assert ((x >= lower) & (x <= upper)).all()
        y = daqp.solve(H, g, np.zeros((0, n)), upper, lower, np.zeros(n, np.int32), primal_tol=1e-11)[0]
        ours, theirs = (0.5 * z @ H @ z + g @ z for z in (x, y))
        assert ours <= theirs + 1e-9 * (1.0 + abs(theirs))
        if n == 3:
            np.testing.assert_allclose(np.stack(solve_box(H, g, lower, upper).x), x, atol=1e-9)


def test_where_bounds_do_not_matter_the_optimum_solves_the_system(box: dict) -> None:
    H, g = np.diag([1.0, 2.0, 4.0]), np.array([1.0, -2.0, 2.0])
    far = np.full(3, np.inf)
    np.testing.assert_allclose(box[3](H, g, -far, far)[0], [-1.0, 1.0, -0.5], rtol=1e-15)


def test_what_has_no_optimum_is_called_so(box: dict) -> None:
    one = np.ones(3)
    for H in (np.zeros((3, 3)), np.diag([1.0, 0.0, 1.0]), np.full((3, 3), np.nan)):
        assert box[3](H, one, -np.inf * one, np.inf * one)[1] == 0.0


@pytest.mark.parametrize("recover", [False, True])
def test_limits_hold_over_thousands_of_steps_beside_them(panda: ulna.Robot, recover: bool) -> None:
    """Targets jump about, most of them out of reach; joints run into every limit."""
    rng = np.random.default_rng(5)
    dt, a = 0.01, 8.0
    limits = [AccelerationLimit(a), VelocityLimit(), PositionLimit()]
    ik = DifferentialIK(
        panda, [FrameTask("panda_hand", 1.0, 0.3), PostureTask(1e-2)], limits, recover=recover
    )
    q, v = panda.random_configuration(seed=rng), np.zeros(7)
    lower, upper, fastest = panda.limits.lower, panda.limits.upper, panda.limits.velocity
    touched = np.zeros(7, dtype=bool)
    for k in range(3000):
        if k % 100 == 0:
            T = panda.fk(panda.random_configuration(seed=rng), "panda_hand")
            T[:3, 3] *= rng.uniform(0.5, 2.0)
            posture = rng.uniform(2.0 * lower, 2.0 * upper)
        before, v = v, ik.velocity(q, dt, T, posture, v)
        assert (np.abs(v) <= fastest + 1e-9).all()
        assert (np.abs(v - before) <= a * dt + 2e-9).all()
        q = q + v * dt
        assert ((q >= lower - 1e-10) & (q <= upper + 1e-10)).all()
        touched |= (q < lower + 1e-3) | (q > upper - 1e-3)
    assert touched.sum() >= 4


def test_a_plane_is_never_crossed(panda: ulna.Robot) -> None:
    ik = DifferentialIK(
        panda,
        [FrameTask("panda_hand", 1.0, 0.1), PostureTask(1e-3, target="qr")],
        [VelocityLimit(), PositionLimit(), PlaneLimit("panda_hand", (0.0, 0.0, 1.0), 0.3, gain=0.3)],
    )
    q = np.array(panda.configurations["qr"])
    T = panda.fk(q, "panda_hand")
    T[2, 3] = 0.0
    heights = []
    for _ in range(300):
        q = ik.step(q, 0.01, T)
        heights.append(panda.fk(q, "panda_hand")[2, 3])
    assert min(heights) > 0.3 - 1e-3  # the row is linear: it leaves the square of a step
    assert heights[-1] < 0.301


def test_errors_fall_to_zero(panda: ulna.Robot) -> None:
    rng = np.random.default_rng(3)
    ik = DifferentialIK(panda, [FrameTask("panda_hand", 1.0, 0.5, gain=0.5)])
    for _ in range(10):
        goal_q = 0.8 * panda.random_configuration(seed=rng)
        goal = panda.fk(goal_q, "panda_hand")
        q = panda.limits.clip(goal_q + rng.uniform(-0.3, 0.3, 7))
        sizes = []
        for _ in range(120):
            sizes.append(np.linalg.norm(ik.errors(q, goal)["panda_hand"] * [1, 1, 1, 0.5, 0.5, 0.5]))
            q = ik.step(q, 0.05, goal)
        assert (np.diff(sizes) <= 1e-9).all()
        assert sizes[-1] < 1e-8


def test_an_arm_that_cannot_reach_comes_to_rest(panda: ulna.Robot) -> None:
    ik = DifferentialIK(panda, [FrameTask("panda_hand", 1.0, 0.5), PostureTask(1e-3, target="ready")])
    q = np.array(panda.configurations["ready"])
    T = panda.fk(q, "panda_hand")
    T[:3, 3] = [2.0, 0.3, 0.5]
    for _ in range(1500):
        v = ik.velocity(q, 0.002, T)
        q = q + 0.002 * v
    assert np.abs(v).max() < 0.05
    assert (
        np.linalg.norm(T[:3, 3] - panda.fk(q, "panda_hand")[:3, 3]) < 1.21
    )  # the best there is, to a few mm


def test_constraints_are_met_exactly(panda: ulna.Robot) -> None:
    gear = JointCouplingTask({"panda_joint1": 1.0, "panda_joint3": 2.0}, name="gear")
    ik = DifferentialIK(panda, [FrameTask("panda_hand")], constraints=[gear])
    q = np.array(panda.configurations["qr"])
    T = panda.fk(q, "panda_hand")
    T[:3, 3] += [-0.05, 0.1, 0.1]
    for _ in range(100):
        q = ik.step(q, 0.02, T)
        assert abs(q[0] + 2.0 * q[2]) < 1e-8
    assert np.abs(ik.errors(q, T)["panda_hand"]).max() < 1e-6


def test_locked_joints_stand_still(model: Model) -> None:
    rng = np.random.default_rng(4)
    name = model.joints[-1].name if model.joints[-1].mimic is None else model.joints[-2].name
    ik = DifferentialIK(model, [FrameTask("tip"), PostureTask(1e-2)], [], locked=[name])
    q, other = alg.random(model, rng), alg.random(model, rng)
    v = ik.velocity(q, 0.1, alg.frame_pose(model, other, model.frame("tip")).matrix(), other)
    joint = model.joint(name)
    assert (joint.v_of(v) == 0.0).all()
    assert np.abs(v).max() > 0.0


def test_a_batch_is_its_samples(panda: ulna.Robot) -> None:
    ik = DifferentialIK(panda, [FrameTask("panda_hand"), PostureTask(1e-3, target="qr")])
    q = panda.random_configuration(64, seed=6)
    T = panda.fk(panda.random_configuration(64, seed=7), "panda_hand")
    v = ik.velocity(q, 0.01, T)
    np.testing.assert_allclose(v, [ik.velocity(a, 0.01, b) for a, b in zip(q, T, strict=True)], atol=1e-9)
    np.testing.assert_allclose(ik.step(q, 0.01, T), q + 0.01 * v, atol=1e-12)
