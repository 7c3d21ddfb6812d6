"""robot.ik_all: what it accepts, what it says, how it orders and wraps."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import ulna
from support.random_arms import redundant
from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.model import Continuous, ModelBuilder, Prismatic, Revolute
from ulna.spatial import SE3


@pytest.fixture(scope="module")
def ur5() -> ulna.Robot:
    return ulna.load("ur5")


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


def test_the_eight_solutions_of_a_ur5(ur5: ulna.Robot) -> None:
    q = np.array([0.3, -1.2, 1.4, -0.6, 0.9, 0.2])
    T = ur5.fk(q)
    found = ur5.ik_all(T)
    assert found.q.shape == (8, 6) and len(found) == found.count == found.total == found.found == 8
    assert found.complete and "parallel" in found.method and found.reason == ""
    assert np.allclose(ur5.fk(found.q), T, atol=1e-12)
    assert found.position_error.max() < 1e-12 and found.rotation_error.max() < 1e-12
    gaps = np.abs(found.q[:, None] - found.q[None]).max(axis=-1) + 9.0 * np.eye(8)
    assert gaps.min() > 1e-3


def test_the_nearest_comes_first_and_angles_lie_next_to_q0(ur5: ulna.Robot) -> None:
    q = np.array([4.0, -5.0, 1.4, -0.6, 3.9, 6.0])
    found = ur5.ik_all(ur5.fk(q), q0=q)
    assert np.abs(found.q[0] - q).max() < 1e-9
    distance = np.linalg.norm(found.q - q, axis=1)
    assert (np.diff(distance) >= 0.0).all()


def test_without_q0_angles_are_within_half_a_turn(ur5: ulna.Robot) -> None:
    found = ur5.ik_all(ur5.fk([4.0, -5.0, 1.4, -0.6, 3.9, 6.0]))
    assert np.abs(found.q).max() <= np.pi + 1e-12


def test_every_turn_on_request(ur5: ulna.Robot) -> None:
    T = ur5.fk([0.3, -1.2, 1.4, -0.6, 0.9, 0.2])
    found = ur5.ik_all(T, turns=True)
    assert (
        len(found) == 8 * 2**5
    )  # joints between -2 pi and 2 pi have two places each; the elbow's limits are +-pi
    assert ur5.limits.contains(found.q).all()
    assert np.allclose(ur5.fk(found.q), T, atol=1e-12)


def test_solutions_outside_the_limits_are_left_out_unless_asked_for(panda: ulna.Robot) -> None:
    T = panda.fk(
        panda.configurations["qr"] if "qr" in panda.configurations else panda.random_configuration(seed=0)
    )
    inside, all_of_them = panda.ik_all(T), panda.ik_all(T, limits=False)
    assert 0 < len(inside) < len(all_of_them)
    assert panda.limits.contains(inside.q).all()
    assert not panda.limits.contains(all_of_them.q).all()
    assert not inside.complete


def test_a_redundant_arm_is_sampled_over_the_joint_one_says(panda: ulna.Robot) -> None:
    q = panda.random_configuration(seed=5)
    T = panda.fk(q)
    for free in (None, "panda_joint4", "panda_joint6"):
        found = panda.ik_all(T, q0=q, free=free, samples=8)
        assert np.abs(found.q[0] - q).max() < 1e-7  # the value in q0 is among the samples
        assert np.allclose(panda.fk(found.q), T, atol=1e-8)
        assert "at 9 values" in found.method
    at = panda.ik_all(T, free="panda_joint7", samples=[q[6]], limits=False)
    assert len(at) % 2 == 0 and (at.q[:, 6] == q[6]).all()


def test_batches_have_room_for_the_most_and_each_pose_its_own(ur5: ulna.Robot) -> None:
    Q = ur5.random_configuration((3, 4), seed=1)
    T = ur5.fk(Q)
    T[2, 3, :3, 3] = 9.0
    found = ur5.ik_all(T, q0=Q)
    assert found.q.shape[:2] == (3, 4) and found.count.shape == (3, 4)
    assert found.count[2, 3] == 0 and "misses it by" in found[2][3].reason
    for i, j in ((0, 0), (1, 2)):
        one = ur5.ik_all(T[i, j], q0=Q[i, j])
        assert np.array_equal(found[i][j].q, one.q) and found[i, j].found == one.found
        assert np.isnan(found.q[i, j, len(one) :]).all()
    assert len(found) == 3 and [len(row) for row in found] == [4, 4, 4]
    assert "12 poses" in repr(found) and "8 branches" in repr(
        ur5.ik_all(ur5.fk([0.3, -1.2, 1.4, -0.6, 0.9, 0.2]))
    )
    empty = ur5.ik_all(np.zeros((0, 4, 4)))
    assert empty.q.shape == (0, 0, 6)


def test_unreachable_poses_give_nothing_and_the_reason(ur5: ulna.Robot) -> None:
    T = np.eye(4)
    T[:3, 3] = 5.0
    found = ur5.ik_all(T)
    assert len(found) == 0 and found.found == 0 and found.q.shape == (0, 6)
    assert "no configuration reaches the pose" in found.reason


def test_poses_reached_only_outside_the_limits_say_so() -> None:
    robot = ulna.Robot(_six(-0.1, 0.1))
    found = robot.ik_all(robot.fk([0.5, -1.0, 0.7, 0.4, 1.0, -0.3]))
    assert len(found) == 0 and found.found > 0 and "outside its limits" in found.reason


def test_an_invalid_pose_is_refused(ur5: ulna.Robot) -> None:
    T = ur5.fk(np.zeros(6))
    with pytest.raises(NonFiniteError):
        ur5.ik_all(np.where(np.eye(4) > 0, np.nan, T))
    with pytest.raises(InputError, match="not a rotation"):
        ur5.ik_all(np.diag([1.0, 2.0, 1.0, 1.0]))
    with pytest.raises(InputError, match="reflection"):
        ur5.ik_all(np.diag([1.0, 1.0, -1.0, 1.0]))
    with pytest.raises(ShapeError):
        ur5.ik_all(np.eye(3))
    with pytest.raises(ShapeError, match="q0"):
        ur5.ik_all(T, q0=np.zeros(5))
    with pytest.raises(ShapeError, match="the batch of the poses"):
        ur5.ik_all(T, q0=np.zeros((3, 6)))
    with pytest.raises(UnknownName, match="tool0"):
        ur5.ik_all(T, frame="tool")


def test_loose_tolerances_do_not_let_pass_what_is_no_pose(ur5: ulna.Robot) -> None:
    T = ur5.fk(np.ones(6))
    T[:3, :3] *= 1.001
    with pytest.raises(InputError, match="not a rotation"):
        ur5.ik_all(T, position_tolerance=1.0, rotation_tolerance=1.0)


def test_poses_of_few_digits_are_solved_for_the_nearest_rotation(ur5: ulna.Robot) -> None:
    q = np.array([0.3, -1.2, 1.4, -0.6, 0.9, 0.2])
    T = ur5.fk(q)
    for rounded in (T.astype(np.float32), np.round(T, 8), np.round(T, 8).tolist()):
        found = ur5.ik_all(rounded, q0=q)
        assert len(found) == 8 and np.abs(found.q[0] - q).max() < 1e-6
        assert np.abs(ur5.fk(found.q) - np.asarray(rounded)).max() < 1e-6


def test_options_that_do_not_fit_are_refused(ur5: ulna.Robot, panda: ulna.Robot) -> None:
    with pytest.raises(InputError, match="6 joints"):
        ur5.ik_all(np.eye(4), free="elbow_joint")
    with pytest.raises(UnknownName, match="panda_joint7"):
        panda.ik_all(np.eye(4), free="joint7")
    with pytest.raises(InputError, match="samples"):
        panda.ik_all(np.eye(4), samples=0)


def test_the_answer_cannot_be_changed(ur5: ulna.Robot) -> None:
    found = ur5.ik_all(ur5.fk(np.ones(6)))
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.method = "guess"  # type: ignore[misc]


def test_a_wrist_that_is_straight_gives_the_member_of_the_continuum_next_to_q0() -> None:
    robot = ulna.Robot(_six())
    q = np.array([0.4, -0.7, 0.9, 1.1, 0.0, -0.5])
    found = robot.ik_all(robot.fk(q), q0=q)
    assert np.abs(found.q[0] - q).max() < 1e-6
    assert found.position_error.max() < 1e-9


def test_a_straight_elbow_gives_the_double_solution_once() -> None:
    robot = ulna.Robot(_six())
    q = np.array([0.4, -0.7, 0.0, 1.1, 0.6, -0.5])
    found = robot.ik_all(robot.fk(q))
    close = [row for row in found.q if np.abs(row - q).max() < 1e-5]
    assert len(close) == 1


def test_just_out_of_reach_is_out_of_reach() -> None:
    robot = ulna.Robot(_six())
    T = robot.fk([0.4, -0.7, 0.0, 0.0, 0.0, 0.0])
    out = T.copy()
    out[:3, 3] += 1e-6 * (T[:3, 3] - [0.0, 0.0, 0.5]) / np.linalg.norm(T[:3, 3] - [0.0, 0.0, 0.5])
    assert len(robot.ik_all(T)) and not len(robot.ik_all(out))


def test_continuous_joints_do_not_mind_turns() -> None:
    robot = ulna.Robot(_six(kind=Continuous))
    q = np.array([0.3, 9.0, 2.0 * np.pi + 0.8, 20.0, -31.0, np.pi])
    found = robot.ik_all(robot.fk(q), q0=q)
    assert np.abs(found.q[0] - q).max() < 1e-8
    assert np.abs(robot.ik_all(robot.fk(q)).q).max() <= np.pi + 1e-12


@pytest.mark.parametrize("kinds", ["RRP", "RRRRR", "RRPR", "PRPRRR"])
def test_arms_without_a_closed_form_are_searched(kinds: str) -> None:
    robot = ulna.Robot(redundant(kinds, np.random.default_rng(1)))
    q = robot.random_configuration(seed=2)
    found = robot.ik_all(robot.fk(q))
    assert not found.complete and "random starts" in found.method
    gap = np.abs(found.q - q)
    assert np.minimum(gap, np.abs(2.0 * np.pi - gap)).max(axis=-1).min() < 1e-6
    again = robot.ik_all(robot.fk(q))
    assert np.array_equal(found.q, again.q)


def test_a_slide_under_an_arm_is_sampled() -> None:
    robot = ulna.Robot(redundant("PRRRRRR", np.random.default_rng(3)))
    q = robot.random_configuration(seed=4)
    found = robot.ik_all(robot.fk(q), q0=q, samples=5)
    assert np.abs(found.q[0] - q).max() < 1e-6 and "joint1 at 6 values" in found.method
    assert len(np.unique(found.q[:, 0])) >= 2


def test_joints_that_follow_others_are_searched() -> None:
    b = ModelBuilder("m")
    for name in "abcd":
        b.add_link(name)
    b.add_joint("j1", Revolute((0, 0, 1)), "a", "b", SE3.trans(0, 0, 1), lower=-3, upper=3)
    b.add_joint("j2", Revolute((0, 1, 0)), "b", "c", SE3.trans(1, 0, 0), lower=-3, upper=3)
    b.add_joint("j3", Revolute((0, 1, 0)), "c", "d", SE3.trans(1, 0, 0), mimic=("j2", 1.0, 0.0))
    robot = ulna.Robot(b.add_frame("t", "d", SE3.trans(0.3, 0.0, 0.1)).set_tool("t").build())
    q = np.array([0.5, 0.8])
    found = robot.ik_all(robot.fk(q))
    assert np.abs(found.q - q).max(axis=-1).min() < 1e-6


def test_the_bare_kernel_gives_every_branch_with_its_evaluation(ur5: ulna.Robot, panda: ulna.Robot) -> None:
    kernel = ur5.branch_kernel()
    Q = ur5.random_configuration(5, seed=8)
    T = ur5.fk(Q)
    q, evaluation = kernel(T, Q)
    assert q.shape == (5, 8, 6) and evaluation.shape == (5, 8, 3) and kernel.free is None
    assert (np.abs(q - Q[:, None]).max(axis=-1).min(axis=-1) < 1e-9).all()
    at = evaluation[..., 0] < 1e-9
    assert (at.sum(axis=-1) == ur5.ik_all(T, limits=False).count).all()
    assert np.array_equal(kernel(T[0])[0].shape, (8, 6))
    kernel = panda.branch_kernel(free="panda_joint7")
    Q = panda.random_configuration(5, seed=8)
    q, evaluation = kernel(panda.fk(Q), Q, Q[:, 6])
    assert kernel.free == "panda_joint7"
    assert (np.abs(q - Q[:, None]).max(axis=-1).min(axis=-1) < 1e-8).all()
    with pytest.raises(InputError, match="no closed form"):
        ulna.Robot(redundant("RRPR", np.random.default_rng(1))).branch_kernel()


def test_joints_outside_the_arm_stay_where_q0_has_them() -> None:
    legs = ulna.Robot(redundant("RRRRRRRRR", np.random.default_rng(6)))
    q = legs.random_configuration(seed=7)
    T = legs.fk(q)
    found = legs.ik_all(T, q0=q, samples=3)
    assert np.abs(found.q[0] - q).max() < 1e-6
    assert (found.q[:, :2] == q[:2]).all()
    six = [f"joint{i}" for i in (3, 4, 5, 7, 8, 9)]
    found = legs.ik_all(T, q0=q, joints=six)
    assert np.abs(found.q[0] - q).max() < 1e-6 and found.complete
    assert (found.q[:, [0, 1, 5]] == q[[0, 1, 5]]).all()
    with pytest.raises(InputError, match="pose by pose"):
        legs.ik_all(np.stack([T, T]), q0=np.stack([q, q + 0.1]), joints=six)


def _six(lower: float = -np.pi, upper: float = np.pi, kind: type[Revolute] = Revolute) -> ulna.Model:
    """A spherical-wrist arm with an offset shoulder."""
    b = ModelBuilder("six")
    b.add_link("l0")
    axes = [(0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0), (0, 1, 0), (1, 0, 0)]
    places = [(0, 0, 0.3), (0.0, 0, 0.2), (0.6, 0, 0), (0.2, 0, 0), (0.4, 0, 0), (0, 0, 0)]
    bounds = {} if kind is Continuous else {"lower": lower, "upper": upper}
    for i, (axis, place) in enumerate(zip(axes, places, strict=True)):
        b.add_link(f"l{i + 1}")
        b.add_joint(f"j{i + 1}", kind(axis), f"l{i}", f"l{i + 1}", SE3.trans(*place), **bounds)
    b.add_frame("flange", "l6", SE3.trans(0.1, 0.0, 0.0)).set_tool("flange")
    return b.build()


@pytest.mark.parametrize(("prismatic", "free"), [((0,), "j3"), ((0, 3), "j1"), ((0, 3), "j2")])
def test_a_joint_that_cannot_be_held_is_refused(prismatic: tuple[int, ...], free: str) -> None:
    """Random starts would move it, too."""
    rng = np.random.default_rng(4)
    builder = ModelBuilder("seven").add_link("l0")
    for i in range(7):
        axis = rng.standard_normal(3)
        kind = (Prismatic if i in prismatic else Revolute)(axis / np.linalg.norm(axis))
        builder.add_link(f"l{i + 1}")
        place = SE3.trans(*rng.uniform(-0.4, 0.4, 3))
        builder.add_joint(f"j{i + 1}", kind, f"l{i}", f"l{i + 1}", place, lower=-2.0, upper=2.0)
    robot = ulna.Robot(builder.build())
    q = robot.random_configuration(seed=0)
    assert robot.ik_all(robot.fk(q), q0=q).count
    with pytest.raises(InputError, match=f"`free` is '{free}', which cannot be held"):
        robot.ik_all(robot.fk(q), q0=q, free=free, samples=[0.3])
