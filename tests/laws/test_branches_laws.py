"""Laws of all solutions: the configuration a pose came from is among them, and they are as many for every way to ask."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

import ulna
from support.random_arms import CLOSED, GENERAL, model_of
from ulna.formats.dh import model_from_dh, revolute
from ulna.ik.analytic.chain import arm_of, movable
from ulna.ik.analytic.closed import branch_numbers, branch_of
from ulna.ik.analytic.geometry import arm_geometries
from ulna.model import Model
from ulna.spatial import SE3
from ulna.typing import Floats


def _missing(model: Model, Q: Floats) -> Floats:
    """How far the nearest solution is from each configuration that a pose was made from, turns apart."""
    robot = ulna.Robot(model)
    found = robot.ik_all(robot.fk(Q))
    assert found.complete
    assert np.nanmax(found.position_error) < 1e-9 and np.nanmax(found.rotation_error) < 1e-9
    assert np.allclose(robot.fk(found.q[0][: found.count[0]]), robot.fk(Q[0]), atol=1e-9)
    gap = np.abs(found.q - Q[:, None])
    gap = np.minimum(gap, np.abs(2.0 * np.pi - gap)).max(axis=-1)
    return np.where(np.isnan(gap), np.inf, gap).min(axis=-1)


@pytest.mark.parametrize("name", CLOSED)
def test_closed_forms_recover_the_configuration(name: str) -> None:
    rng = np.random.default_rng(10)
    model = model_of(CLOSED[name](rng), rng)
    assert _missing(model, rng.uniform(-np.pi, np.pi, (200, 6))).max() < 1e-6


@pytest.mark.parametrize("name", GENERAL)
def test_elimination_recovers_the_configuration(name: str) -> None:
    rng = np.random.default_rng(11)
    model = model_of(GENERAL[name](rng), rng)
    assert _missing(model, rng.uniform(-np.pi, np.pi, (5, 6))).max() < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", [*CLOSED, *GENERAL])
def test_many_arms_of_each_kind_recover_the_configuration(name: str) -> None:
    """One more arm at many configurations, since making the solver of an arm costs more than its calls."""
    make, rng = {**CLOSED, **GENERAL}[name], np.random.default_rng(0)
    model = model_of(make(rng), rng)
    assert _missing(model, rng.uniform(-np.pi, np.pi, (210, 6))).max() < 1e-5


def test_ten_thousand_poses_of_a_ur5() -> None:
    ur5 = ulna.load("ur5")
    Q = np.random.default_rng(12).uniform(-np.pi, np.pi, (10_000, 6))
    gap = _missing(ur5.model, Q)
    singular = np.linalg.svd(ur5.jacobian(Q), compute_uv=False)[:, -1]
    assert gap[singular > 1e-3].max() < 1e-9
    assert gap.max() < 1e-6


@pytest.mark.parametrize("joint", [2, 4], ids=["elbow", "wrist"])
def test_near_singular_poses_keep_a_solution_within_tolerance(joint: int) -> None:
    """Down to the singularity itself; how far the joints are off is bounded by what the pose can tell of them."""
    ur5 = ulna.load("ur5")
    rng = np.random.default_rng(13)
    Q = rng.uniform(-2.0, 2.0, (80, 6))
    Q[:, joint] = np.repeat([0.0, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2], 10)
    found = ur5.ik_all(ur5.fk(Q), q0=Q)
    assert (found.count > 0).all()
    assert np.nanmax(found.position_error) <= 1e-9 and np.nanmax(found.rotation_error) <= 1e-9
    least = np.linalg.svd(ur5.jacobian(Q), compute_uv=False)[:, -1]
    gap = np.abs(found.q[:, 0] - Q).max(axis=-1)
    assert (gap * np.maximum(least, 1e-12) < 1e-9).all()


def test_a_batch_is_the_stack_of_its_poses() -> None:
    panda = ulna.load("panda")
    Q = panda.random_configuration(6, seed=14)
    T = panda.fk(Q)
    found = panda.ik_all(T, q0=Q, samples=5)
    for i in range(6):
        one = panda.ik_all(T[i], q0=Q[i], samples=np.linspace(*_range(panda), 7)[1:-1])
        assert np.allclose(found[i].q, one.q, atol=1e-12)


def _range(panda: ulna.Robot) -> tuple[float, float]:
    return float(panda.limits.lower[6]), float(panda.limits.upper[6])


def test_compiled_equals_plain() -> None:
    """The same source on plain numbers gives what the kernel gives."""
    ur5 = ulna.load("ur5")
    model = ur5.model
    end = model.frame(model.tool)
    arm = arm_of(model, end, movable(model, end), model.neutral)
    plan = arm_geometries(arm)[0]
    q = ur5.random_configuration(seed=15)
    T = SE3.from_matrix(ur5.fk(q))
    local = arm.base(q).inverse() @ T
    plain = [branch_of(plan, arm, local, 0.0, number, np.zeros(6)) for number in branch_numbers(plan)]
    found = ur5.ik_all(T.matrix(), limits=False).q
    assert len(found) in (2, 4, 6, 8)
    for row in found:
        gap = np.abs((np.array(plain, dtype=float) - row + np.pi) % (2.0 * np.pi) - np.pi).max(axis=-1)
        assert gap.min() < 1e-9


def test_every_joint_of_a_panda_may_be_the_free_one_that_has_a_closed_form() -> None:
    panda = ulna.load("panda")
    q = panda.random_configuration(seed=16)
    T = panda.fk(q)
    for free in (4, 5, 6, 7):
        found = panda.ik_all(T, q0=q, free=f"panda_joint{free}", samples=1)
        assert np.abs(found.q[0] - q).max() < 1e-6
        assert "intersecting axes" in found.method


def _quarter_turns(seed: int) -> ulna.Robot:
    rng = np.random.default_rng(seed)
    return ulna.Robot(model_of(GENERAL["quarter turns"](rng), rng))


def _quarters() -> Floats:
    """All configurations of quarter turns."""
    return 0.5 * np.pi * np.array(list(product((-1.0, 0.0, 1.0), repeat=6)))


@pytest.mark.parametrize("seed", [4611, 4614, 4620])
def test_solutions_that_share_an_angle_are_all_found(seed: int) -> None:
    """Eigenvalues of such solutions coincide; some were lost, though `complete` said that all were there."""
    robot, rng = _quarter_turns(seed), np.random.default_rng(seed)
    Q = rng.permutation(_quarters())[:100]
    for q in Q:
        q[rng.choice(6, 2, replace=False)] = rng.uniform(-3.0, 3.0, 2)
    Q = Q[np.linalg.svd(robot.jacobian(Q), compute_uv=False)[:, -1] > 1e-2]
    found = robot.ik_all(robot.fk(Q))
    gap = np.abs(found.q - Q[:, None])
    gap = np.minimum(gap, np.abs(2.0 * np.pi - gap)).max(axis=-1)
    assert "general" in found.method and len(Q) > 10
    assert np.nanmin(gap, axis=-1).max() < 1e-6


@pytest.mark.parametrize("seed", [None, 4600, 4612, 4617])
def test_poses_in_which_a_joint_is_free_have_a_solution(seed: int | None) -> None:
    """Also where the value of that joint in `q0`, by default 0, leads nowhere."""
    robot = ulna.load("ur5") if seed is None else _quarter_turns(seed)
    found = robot.ik_all(robot.fk(_quarters()))
    assert "parallel" in found.method and (found.count > 0).all()
    assert np.nanmax(found.position_error) <= 1e-9 and np.nanmax(found.rotation_error) <= 1e-9


def test_a_general_arm_in_a_singular_pose_does_not_claim_all_solutions() -> None:
    robot, Q = _quarter_turns(4614), _quarters()
    least = np.linalg.svd(robot.jacobian(Q), compute_uv=False)[:, -1]
    singular = Q[np.flatnonzero(least < 1e-9)[0]]
    assert not robot.ik_all(robot.fk(singular), q0=singular).complete
    assert robot.ik_all(robot.fk(np.linspace(0.2, 1.1, 6))).complete


def test_where_elimination_is_singular_random_starts_find_what_it_loses() -> None:
    """A Kinova Jaco, whose equations are singular wherever its fifth joint is at 0: random starts find what is left."""
    d, a = [0.2755, 0.0, -0.0098, -0.2502, -0.08579, -0.2116], [0.0, 0.41, 0.0, 0.0, 0.0, 0.0]
    alpha = np.deg2rad([90.0, 180.0, 90.0, 60.0, 60.0, 180.0])
    rows = [revolute(d=x, a=y, alpha=z) for x, y, z in zip(d, a, alpha, strict=True)]
    robot = ulna.Robot(model_from_dh(rows, name="jaco"))
    Q = np.random.default_rng(4900).integers(-1, 2, (200, 6)) * 0.5 * np.pi
    Q[:, 4], Q[:, 5] = -np.pi, Q[:, 5] + np.deg2rad(100.0)
    values = np.linalg.svd(robot.jacobian(Q), compute_uv=False)
    Q = Q[values[:, -1] > 1e-5 * values[:, 0]]
    found = robot.ik_all(robot.fk(Q), limits=False)
    gap = np.abs(found.q - Q[:, None])
    gap = np.minimum(gap, np.abs(2.0 * np.pi - gap)).max(axis=-1)
    assert len(Q) > 20 and not found.complete
    assert (np.where(np.isnan(gap), np.inf, gap).min(axis=-1) > 1e-5).sum() <= 1
