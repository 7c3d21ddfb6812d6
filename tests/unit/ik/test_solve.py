"""robot.ik: one goal, batches, masks, several frames, limits, wrong input."""

import pickle
from collections import OrderedDict
from types import MappingProxyType

import numpy as np
import pytest

import ulna
from ulna.compiler.runtime import jit
from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError, UnknownName
from ulna.ik.arguments import problem_of
from ulna.ik.goal import mask_of
from ulna.ik.problem import errors
from ulna.ik.result import IKSolution
from ulna.model import (
    Continuous,
    Fixed,
    FreeFlyer,
    ModelBuilder,
    Planar,
    Prismatic,
    Revolute,
    with_root_joint,
)
from ulna.spatial import SE3, so3_log

TIGHT = 1e-6


@pytest.fixture(scope="module")
def panda():
    return ulna.load("panda")


@pytest.fixture(scope="module")
def goals(panda):
    q = panda.random_configuration(300, seed=4)
    return q, panda.fk(q)


def _is_there(robot, solution, T, frame=None):
    pose = robot.fk(solution.q, frame)
    position = np.linalg.norm(pose[..., :3, 3] - T[..., :3, 3], axis=-1)
    rotation = np.linalg.norm(so3_log(np.swapaxes(pose[..., :3, :3], -1, -2) @ T[..., :3, :3]), axis=-1)
    # A turn is counted by its chord, which is shorter than its arc in the third order only.
    return (position <= TIGHT) & (rotation <= TIGHT * (1 + 1e-6)) & robot.limits.contains(solution.q)


def test_one_goal_after_the_other_is_reached_within_limits(panda, goals):
    for T in goals[1]:
        solution = panda.ik(T)
        assert solution.success and solution
        assert _is_there(panda, solution, T)
        assert solution.position_error <= TIGHT and solution.rotation_error <= TIGHT * (1 + 1e-6)
        assert solution.reason == ""


def test_a_batch_is_reached_like_its_goals_and_keeps_its_shape(panda, goals):
    batch = goals[1].reshape(3, 100, 4, 4)
    solution = panda.ik(batch)
    assert solution.q.shape == (3, 100, 7) and solution.success.shape == (3, 100)
    assert solution.success.all() and _is_there(panda, solution, batch).all()
    few = panda.ik(batch[:, :2])
    assert few.success.shape == (3, 2) and few.success.all()
    one = few[1, 0]
    assert isinstance(one, IKSolution) and one.q.shape == (7,) and len(few) == 3
    np.testing.assert_array_equal(one.q, few.q[1, 0])


def test_figures_are_the_attributes_one_by_one(panda, goals):
    T = goals[1][0]
    several = {"panda_hand": panda.fk(goals[0][0], frame="panda_hand"), "panda_link4": T}
    for solution in (panda.ik(T), panda.ik(goals[1][:3]), panda.ik(several, mask="position", attempts=8)):
        names = ("q", "success", "iterations", "restarts", "position_error", "rotation_error")
        for figure, name in zip(solution.figures(), names, strict=True):
            values = getattr(solution, name)
            assert type(figure) is type(values) and np.array_equal(figure, values)


def test_the_same_seed_gives_the_same_answer_and_another_seed_another(panda, goals):
    T = goals[1][:80]
    np.testing.assert_array_equal(panda.ik(T).q, panda.ik(T).q)
    np.testing.assert_array_equal(panda.ik(T[0], seed=3).q, panda.ik(T[0], seed=3).q)
    assert len({panda.ik(T[0], seed=k).q.tobytes() for k in range(12)}) > 1


def test_threads_do_not_change_the_answers(panda):
    T = panda.fk(panda.random_configuration(3000, seed=9))
    np.testing.assert_array_equal(panda.ik(T, threads=2).q, panda.ik(T).q)


def test_near_q0_the_answer_is_no_farther_than_a_solution_known_to_be_near(panda, goals):
    rng = np.random.default_rng(7)
    q, T = goals
    q0 = panda.limits.clip(q + rng.normal(0.0, 0.08, q.shape))
    solution = panda.ik(T, q0)
    assert solution.success.all() and _is_there(panda, solution, T).all()
    farther = np.linalg.norm(solution.q - q0, axis=1) / np.linalg.norm(q - q0, axis=1)
    assert np.median(farther) <= 1.0 and (farther < 1.1).mean() > 0.97 and farther.max() < 3.0
    np.testing.assert_array_equal(panda.ik(T[5], q0[5]).q, solution.q[5])


def test_following_a_line_the_arm_does_not_jump(panda):
    T = panda.fk(panda.configurations["qr"])
    q = panda.configurations["qr"]
    for k in range(200):
        T[0, 3] += 1e-3 * np.cos(k / 30)
        T[1, 3] += 1e-3 * np.sin(k / 30)
        solution = panda.ik(T, q)
        assert solution.success and np.abs(solution.q - q).max() < 0.02 and solution.iterations <= 4
        q = solution.q


def test_a_configuration_that_is_there_stays(panda, goals):
    q, T = goals
    np.testing.assert_array_equal(panda.ik(T[3], q[3]).q, q[3])


def test_tolerances_are_those_asked_for(panda, goals):
    T = goals[1][:100]
    fine = panda.ik(T, position_tolerance=1e-11, rotation_tolerance=1e-11)
    assert fine.success.all() and fine.position_error.max() <= 1e-11 and fine.rotation_error.max() <= 1.1e-11
    rough = panda.ik(T[0], position_tolerance=1e-2, rotation_tolerance=0.1)
    assert rough.success and rough.iterations < panda.ik(T[0]).iterations


@pytest.mark.parametrize("mask, rows", [("position", 3), ("rotation", 3), ("position+z", 5), ("x", 2)])
def test_masks_leave_free_what_does_not_count(panda, goals, mask, rows):
    far = goals[1][:120].copy()
    far[:, :3, 3] *= 10.0 if mask in ("rotation", "x") else 1.0
    solution = panda.ik(far, mask=mask)
    assert solution.success.all()
    pose = panda.fk(solution.q)
    if mask.startswith("position"):
        assert np.abs(pose[:, :3, 3] - far[:, :3, 3]).max() <= TIGHT
    if mask == "rotation":
        assert np.abs(pose[:, :3, :3] - far[:, :3, :3]).max() <= 2 * TIGHT
    if mask[-1] in "xz" and mask != "position":
        axis = "xyz".index(mask[-1])
        assert np.abs(pose[:, :3, axis] - far[:, :3, axis]).max() <= 2 * TIGHT
    assert mask_of(mask).rows == rows


@pytest.mark.parametrize(
    "mask", [(1, 1, 1, 1, 1, 0), (1, 1, 1, 0, 0, 1), (0, 0, 0, 1, 0, 0), (1, 1, 1, 2, 3, 0.1)]
)
def test_what_counts_of_a_turn_is_met_however_far_the_rest_is_turned(panda, goals, mask):
    T = goals[1]
    solution = panda.ik(T, panda.random_configuration(len(T), seed=9), mask=mask)
    turns = panda.fk(solution.q)[:, :3, :3] @ np.swapaxes(T[:, :3, :3], -1, -2)
    counting = so3_log(turns)[:, np.flatnonzero(mask[3:])]
    assert solution.success.all()
    np.testing.assert_allclose(solution.rotation_error, np.linalg.norm(counting, axis=1), rtol=0.0, atol=1e-9)
    assert solution.rotation_error.max() <= TIGHT * (1 + 1e-9)


@pytest.mark.parametrize("tolerance", [0.3, 1.0, 1.5, 2.5, 4.0])
def test_large_tolerances_are_met_by_the_angle(panda, goals, tolerance):
    q0 = panda.random_configuration(len(goals[1]), seed=3)
    solution = panda.ik(goals[1], q0, position_tolerance=tolerance, rotation_tolerance=tolerance)
    within = (solution.position_error <= tolerance) & (solution.rotation_error <= tolerance)
    assert solution.success.all() and within.all()
    assert tolerance < np.pi or solution.iterations.max() == 1


def test_of_weights_the_ratios_count(panda, goals):
    tiny, huge = (panda.ik(goals[1][0], mask=[k * 1e-12, *[k * 1e-11] * 5]) for k in (1.0, 1e24))
    assert tiny.success
    np.testing.assert_array_equal(tiny.q, huge.q)
    assert mask_of(np.full(6, 3)) == mask_of("pose")


def test_weights_free_directions_in_world_axes(panda, goals):
    T = goals[1][:100].copy()
    T[:, 2, 3] = 50.0  # far above, but height does not count
    solution = panda.ik(T, mask=[1, 1, 0, 0, 0, 0])
    assert solution.success.all()
    assert np.abs(panda.fk(solution.q)[:, :2, 3] - T[:, :2, 3]).max() <= TIGHT


def test_a_direction_turned_half_around_is_not_mistaken_for_met(panda):
    q = panda.configurations["qr"]
    T = panda.fk(q)
    T[:3, :3] = T[:3, :3] @ np.diag([1.0, -1.0, -1.0])
    for mask in ("pose", "position+z", (1, 1, 1, 1, 0, 0)):
        solution = panda.ik(T, q, mask=mask, attempts=80)
        assert not np.array_equal(solution.q, q)
        if solution.success and mask == "position+z":
            assert panda.fk(solution.q)[:3, 2] @ T[:3, 2] > 0.999


def test_an_arm_of_five_joints_asks_what_counts():
    arm = ulna.load("so101").with_tool("gripper_frame_link")
    T = arm.fk(arm.random_configuration(100, seed=2))
    with pytest.raises(InputError, match=r"5 joint coordinates.*position\+z"):
        arm.ik(T[0])
    for mask in ("position", "position+z", "pose"):  # the poses are known to be reachable
        assert arm.ik(T, mask=mask).success.all()


def test_joints_that_may_not_move_stay(panda, goals):
    q, T = goals
    moving = [name for name in panda.joint_names if name != "panda_joint3"]
    solution = panda.ik(T[:50], q[:50] + np.array([0.1, 0.1, 0.0, 0.1, 0.1, 0.1, 0.1]), joints=moving)
    np.testing.assert_array_equal(solution.q[:, 2], q[:50, 2])
    assert solution.success.mean() > 0.9


def test_out_of_reach_is_said_with_the_nearest_that_can_be_had(panda):
    T = np.eye(4)
    T[:3, 3] = 5.0, 0.0, 0.333
    solution = panda.ik(T, mask="position")
    assert not solution.success and not solution and "out of reach" not in solution.reason
    assert "panda_hand_tcp stays" in solution.reason
    # The shoulder stands at (0, 0, 0.333) and the stretched arm reaches less than 1.2 m from there.
    stretched = np.linalg.norm(panda.fk(solution.q)[:3, 3] - [0, 0, 0.333])
    best = max(
        np.linalg.norm(panda.fk(q)[:3, 3] - [0, 0, 0.333]) for q in panda.random_configuration(4000, seed=1)
    )
    assert stretched >= best - 1e-3
    assert solution.position_error == pytest.approx(5.0 - stretched, abs=1e-3)
    batch = panda.ik(np.stack([T, panda.fk(panda.configurations["qr"])]), mask="position")
    assert batch.success.tolist() == [False, True] and batch.reason[1] == ""
    assert batch.reason[~batch.success].tolist() == [batch.reason[0]]
    assert "1 of them successful" in repr(batch)


def test_a_solution_in_place_of_a_configuration_is_named(panda):
    solution = panda.ik(panda.fk(panda.configurations["qr"]))
    with pytest.raises(DtypeError, match=r"`q0` has dtype IKSolution; .*Pass its configuration, `.q`"):
        panda.plan(solution, solution.q)


def test_a_pose_turned_half_around_is_not_the_nearest():
    """In the plane y = 0 the tool of this arm can be at the goal, but turned by exactly half a turn about it."""
    revolute = '<joint name="j{0}" type="revolute"><parent link="l{0}"/><child link="l{1}"/>{2}</joint>'
    parts = [("0 0 0.1", "0 0 1", 2.9), ("0 0 0.2", "0 1 0", 1.9), ("0 0 0.4", "0 1 0", 2.4)]
    parts += [("0 0 0.3", "0 0 1", 2.9), ("0 0 0.1", "0 1 0", 2.1), ("0 0 0.08", "0 0 1", 3.1)]
    inner = '<origin xyz="{0}"/><axis xyz="{1}"/><limit lower="-{2}" upper="{2}" velocity="1" effort="1"/>'
    links = "".join(f'<link name="l{k}"/>' for k in range(7))
    joints = "".join(revolute.format(k, k + 1, inner.format(*part)) for k, part in enumerate(parts))
    arm = ulna.load(f'<robot name="arm">{links}{joints}</robot>')
    goal = ulna.SE3.pointing_down((0.5, 0.0, 0.2))
    assert arm.ik_all(goal, limits=False).count > 0 == arm.ik_all(goal).count
    answer, batch = arm.ik(goal), arm.ik(ulna.SE3.from_matrix(np.tile(goal.as_matrix(), (9, 1, 1))))
    assert not answer.success and answer.rotation_error < 0.1 and "j5 at the limit" in answer.reason
    assert not batch.success.any() and (batch.rotation_error < 0.1).all()


def test_many_goals_some_out_of_reach(panda, goals):
    T = goals[1][:200].copy()
    T[::10, :3, 3] += 3.0
    solution = panda.ik(T)
    assert not solution.success[::10].any() and np.delete(solution.success, np.s_[::10]).all()
    assert panda.limits.contains(solution.q).all()


def test_several_frames_of_a_floating_humanoid():
    body = ulna.load("g1").model
    robot = ulna.Robot(with_root_joint(body, FreeFlyer()))
    frames = ["left_rubber_hand", "right_rubber_hand", "left_ankle_roll_link"]
    q = robot.random_configuration(20, seed=5)
    T = robot.fk(q, frames)
    solution = robot.ik(T, frame=frames)
    assert solution.success.all() and solution.position_error.shape == (20, 3)
    np.testing.assert_allclose(np.linalg.norm(solution.q[:, 3:7], axis=1), 1.0, atol=1e-12)
    assert np.abs(robot.fk(solution.q, frames) - T).max() < 2e-6
    bent = q[0].copy()
    bent[3:7] *= 2.0
    with pytest.raises(InputError, match=r"unit quaternion"):
        robot.ik(T[0], bent, frames)
    named = robot.ik(dict(zip(frames, T[0], strict=True)))
    np.testing.assert_array_equal(named.q, robot.ik(T[0], frame=frames).q)
    hands = robot.ik({frames[0]: T[0, 0], frames[2]: T[0, 2]}, mask={frames[0]: "position"})
    assert hands.success


def _turret(kind):
    b = ModelBuilder("turret").add_link("base").add_link("a").add_link("b").add_link("c")
    b.add_joint("turn", kind((0, 0, 1)), "base", "a")
    b.add_joint("lift", Prismatic((0, 0, 1)), "a", "b", SE3.trans(0.2, 0.0, 0.0), lower=0.1, upper=0.6)
    b.add_joint("reach", Prismatic((1, 0, 0)), "b", "c", lower=0.0, upper=0.5, velocity=1.0)
    return ulna.Robot(b.set_tool("c").build())


def test_slides_and_turns_without_end():
    robot = _turret(Continuous)
    q = robot.random_configuration(200, seed=3)
    T = robot.fk(q)
    solution = robot.ik(T, mask="position")
    assert solution.success.all() and (np.abs(solution.q[:, 0]) <= np.pi).all()
    np.testing.assert_allclose(solution.q, q, atol=1e-5)
    wound = q + np.array([40 * np.pi, 0.0, 0.0])
    near = robot.ik(T, wound, mask="position")
    np.testing.assert_allclose(near.q, wound, atol=1e-5)


def test_limits_that_lie_beyond_half_a_turn_are_searched():
    b = ModelBuilder("wound").add_link("base").add_link("a").add_link("b")
    b.add_joint("turn", Revolute((0, 0, 1)), "base", "a", lower=4.0, upper=9.0)
    b.add_joint("reach", Prismatic((1, 0, 0)), "a", "b", lower=0.2, upper=0.5)
    robot = ulna.Robot(b.set_tool("b").build())
    T = robot.fk(robot.random_configuration(100, seed=3))
    solution = robot.ik(T, mask="position", attempts=800)
    assert robot.limits.contains(solution.q).all() and solution.success.all()


def test_a_mimic_joint_moves_with_its_source():
    robot = ulna.load("panda_fingers")
    frame = "panda_leftfinger"
    q = robot.random_configuration(100, seed=3)
    T = robot.fk(q, frame)
    solution = robot.ik(T, frame=frame)
    assert solution.success.all() and _is_there(robot, solution, T, frame).all()


def test_near_singular_poses_are_reached(panda):
    rng = np.random.default_rng(2)
    q = np.zeros((100, 7)) + rng.normal(0.0, 1e-4, (100, 7))
    q[:, 3] = -0.08
    q[:, 5] = np.abs(q[:, 5])
    T = panda.fk(panda.limits.clip(q))
    assert panda.ik(T).success.mean() > 0.95


def test_an_se3_and_a_list_are_goals_too(panda, goals):
    T = goals[1][0]
    expected = panda.ik(T).q
    np.testing.assert_array_equal(panda.ik(SE3.from_matrix(T)).q, expected)
    np.testing.assert_array_equal(panda.ik(T.tolist()).q, expected)


def test_an_invalid_pose_is_refused(panda, goals):
    T = goals[1][0]
    with pytest.raises(InputError, match="transposed"):
        panda.ik(T.T.copy())
    with pytest.raises(InputError, match="not a rotation"):
        panda.ik(T * 2.0)
    mirrored = T.copy()
    mirrored[:3, 0] *= -1
    with pytest.raises(InputError, match="reflection"):
        panda.ik(np.stack([T, mirrored]))
    with pytest.raises(NonFiniteError, match=r"T\[1, 0, 3\]"):
        bad = np.stack([T, T])
        bad[1, 0, 3] = np.nan
        panda.ik(bad)
    with pytest.raises(ShapeError, match="4, 4"):
        panda.ik(T[:3])
    with pytest.raises(ShapeError, match="4, 4"):
        panda.ik(np.zeros((200, 3, 3)))
    many = np.tile(T, (200, 1, 1))
    many[17, 0, 0] = np.inf
    with pytest.raises(InputError, match="T"):
        panda.ik(many)


def test_wrong_arguments_are_named(panda, goals):
    T = goals[1][0]
    with pytest.raises(ShapeError, match="q0"):
        panda.ik(T, np.zeros(6))
    with pytest.raises(UnknownName, match="panda_hand"):
        panda.ik(T, frame="panda_hnd")
    with pytest.raises(UnknownName, match="position"):
        panda.ik(T, mask="positon")
    with pytest.raises(InputError, match="six weights"):
        panda.ik(T, mask=[1, 1, 1])
    with pytest.raises(InputError, match="position_tolerance"):
        panda.ik(T, position_tolerance=0.0)
    with pytest.raises(InputError, match="attempts"):
        panda.ik(T, attempts=0)
    with pytest.raises(InputError, match="No movable joint"):
        panda.ik(T, frame="panda_link0")
    with pytest.raises(UnknownName, match="panda_joint1"):
        panda.ik(T, joints=["panda_joint_1"])
    with pytest.raises(InputError, match="frame"):
        panda.ik({"panda_hand": T}, frame="panda_hand")
    with pytest.raises(InputError, match="one goal only"):
        panda.ik(np.stack([T, T]), frame=["panda_hand", "panda_hand"])
    with pytest.raises(InputError, match="empty"):
        panda.ik({})
    with pytest.raises(InputError, match="2 entries for 1"):
        panda.ik(T, mask=["pose", "position"])


def test_an_answer_cannot_be_changed_and_says_what_it_is(panda, goals):
    solution = panda.ik(goals[1][0])
    with pytest.raises(AttributeError):
        solution.q = 0
    with pytest.raises(TypeError):
        len(solution)
    assert "IK solution" in repr(solution)
    batch = panda.ik(goals[1][:3])
    assert "3 IK solutions, 3" in repr(batch)
    with pytest.raises(TypeError, match="no single truth"):
        bool(batch)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(batch)).q, batch.q)


def _slide_and_turn(**limits):
    builder = ModelBuilder("slide and turn").add_link("base").add_link("cart").add_link("arm")
    builder.add_joint("slide", Planar((0, 0, 1)), "base", "cart", **limits)
    builder.add_joint("turn", Revolute((0, 1, 0)), "cart", "arm", lower=-1.0, upper=1.0)
    builder.add_frame("tip", "arm", SE3.trans(0.3, 0.0, 0.0)).set_tool("tip")
    return builder


def test_a_rest_configuration_beyond_the_limits_is_no_answer():
    builder = _slide_and_turn().add_configuration("rest", [0.0, 0.0, 0.0, 1.5])
    robot = ulna.Robot(builder.build())
    T = np.stack([robot.fk(robot.configurations["rest"])] * 100)
    for solution in (robot.ik(T, mask="position"), robot.ik(T[:2], mask="position")):
        assert not solution.success.any() and robot.limits.contains(solution.q).all()


def test_joints_of_several_coordinates_are_searched_within_their_limits():
    robot = ulna.Robot(_slide_and_turn(lower=[1.0, 1.0, -1.0], upper=[2.0, 2.0, 1.0]).build())
    solution = robot.ik(robot.fk(robot.random_configuration(300, seed=1)), mask="position")
    assert solution.success.all() and robot.limits.contains(solution.q).all()
    nowhere = robot.ik(np.stack([robot.fk(robot.model.neutral)] * 100), mask="position")
    assert not nowhere.success.any() and robot.limits.contains(nowhere.q).all()


def test_a_limit_without_another_is_searched_for_a_whole_turn():
    builder = ModelBuilder("one-sided").add_link("l0")
    for k in range(6):
        builder.add_link(f"l{k + 1}")
        axis = (0, 0, 1) if k % 2 else (0, 1, 0)
        builder.add_joint(f"j{k}", Revolute(axis), f"l{k}", f"l{k + 1}", SE3.trans(0.1, 0, 0.3), lower=0.5)
    robot = ulna.Robot(builder.build())
    q = np.random.default_rng(2).uniform(0.5, 0.5 + 2 * np.pi, (200, 6))
    solution = robot.ik(robot.fk(q))
    assert solution.success.mean() > 0.99 and (solution.q >= 0.5).all()


def test_without_q0_joints_that_do_not_move_stand_within_their_limits():
    robot = ulna.load("g1")
    solution = robot.ik(
        robot.fk(robot.random_configuration(seed=1), "left_rubber_hand"), frame="left_rubber_hand"
    )
    assert solution.success and robot.limits.contains(solution.q)


def test_new_seeds_and_tolerances_do_not_fill_the_memory(panda, goals):
    for k in range(1000):
        panda.ik(goals[1][0], seed=k, position_tolerance=1e-6 * (1 + 1e-3 * k))
    solver = panda._searches[False, None, None, None]
    assert len(solver._shifts) < 300 and len(solver._settings) < 300


def test_a_mapping_is_understood_whatever_was_asked_before(panda, goals):
    T = goals[1][0]
    tool = panda.ik(T)
    named = panda.ik(OrderedDict(panda_hand_tcp=T)), panda.ik(MappingProxyType({"panda_hand_tcp": T}))
    for solution in named:
        np.testing.assert_array_equal(solution.q, tool.q)
    by_name = panda.ik(T, mask={"panda_hand_tcp": "position"})
    np.testing.assert_array_equal(by_name.q, panda.ik(T, mask="position").q)


def test_goals_of_several_frames_broadcast(panda, goals):
    q, T = goals
    elbow = panda.fk(q[0], "panda_link4")
    masks = {"panda_hand_tcp": "position", "panda_link4": "position"}
    several = panda.ik({"panda_hand_tcp": T[:3], "panda_link4": elbow}, mask=masks)
    assert several.q.shape == (3, 7) and several[0].success
    with pytest.raises(InputError, match="do not broadcast.*panda_link4"):
        panda.ik({"panda_hand_tcp": T[:3], "panda_link4": T[:2]}, mask=masks)
    with pytest.raises(ShapeError, match="panda_link4"):
        panda.ik({"panda_hand_tcp": T[:3], "panda_link4": elbow[:3]}, mask=masks)


@pytest.mark.parametrize(
    "error, words, options",
    [
        (InputError, "`seed` is -1", {"seed": -1}),
        (InputError, "`seed` is None", {"seed": None}),
        (InputError, "`position_tolerance` is array", {"position_tolerance": np.array([1e-6])}),
        (InputError, "`position_tolerance` is \\[", {"position_tolerance": [1e-6]}),
        (InputError, "`mask` is {'z'}", {"mask": {"z"}}),
        (ShapeError, "`q0`.*`T` has shape \\(300, 4, 4\\)", {"q0": np.zeros((2, 7))}),
    ],
)
def test_what_means_nothing_is_refused_in_the_words_of_the_call(panda, goals, error, words, options):
    with pytest.raises(error, match=words):
        panda.ik(goals[1], **options)


@pytest.mark.parametrize("method", ["ik", "ik_classic"])
def test_goals_that_are_no_numbers_are_refused_in_batches_too(panda, goals, method):
    for T in (goals[1].astype(complex), goals[1].astype(str)):
        with pytest.raises(DtypeError, match="`T`"):
            getattr(panda, method)(T)
    with pytest.raises(InputError, match="different lengths"):
        getattr(panda, method)([[1.0, 2.0], [3.0]])


def test_a_goal_out_of_reach_is_answered_by_code_that_is_there(monkeypatch):
    """The first failure compiles nothing: neither of one goal, nor of a batch in which single goals race."""
    robot = ulna.load("ur5")
    T = robot.fk(robot.random_configuration(8, seed=5))
    robot.ik(T[0])
    robot.ik(T)  # the same kernel for rows of goals
    compiled: list[str] = []
    monkeypatch.setattr(jit, "load", lambda f, *rest: compiled.append(f.name))
    far = T + np.array([[0, 0, 0, 3.0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]])
    assert not robot.ik(far[0]).success
    assert not robot.ik(far).success.any()
    assert robot.ik(far[0]).reason
    assert compiled == []


@pytest.mark.parametrize("near", [False, True])
def test_goals_out_of_reach_take_no_longer_in_a_batch(near):
    robot = ulna.load("ur5")
    q = robot.random_configuration(80, seed=6)
    far = robot.fk(q)
    far[:, 2, 3] += 2.0
    q0 = q[0] if near else None
    one, all_ = robot.ik(far[3], q0), robot.ik(far, q0)
    assert not all_.success.any()
    assert (all_.iterations == one.iterations).all()
    assert all_.position_error[3] == pytest.approx(one.position_error, rel=1e-6)


def test_what_is_nearest_is_a_local_minimum_within_the_limits(panda):
    """No small step of a joint within its limits brings the frame nearer by a thousandth."""
    T = panda.fk(panda.random_configuration(20, seed=8))
    T[:, :3, 3] *= 2.0
    solution = panda.ik(T)
    problem = problem_of(panda.model, [panda.model.tool], None, None)

    def error(q, goal):
        return errors(problem, q, problem.goals(goal), np.zeros(2)).squared

    for goal, q in zip(T[~solution.success], solution.q[~solution.success], strict=True):
        here = error(q, goal)
        for k in range(7):
            for sign in (-1.0, 1.0):
                there = q.copy()
                there[k] += sign * 1e-3
                if panda.limits.contains(there):
                    assert error(there, goal) > here * (1.0 - 1e-3)


def test_a_robot_of_another_size_takes_the_same_steps() -> None:
    """Damping and the test of progress scale with the lengths; a factor of two to the third is exact in floating point."""
    axes = ((0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0), (0, 1, 0), (1, 0, 0))

    def arm(size: float) -> ulna.Robot:
        builder = ModelBuilder("arm").add_link("l0")
        for k, axis in enumerate(axes):
            place = SE3.trans(0.02 * size, 0.01 * size * k, 0.25 * size * bool(k))
            builder.add_link(f"l{k + 1}")
            builder.add_joint(f"j{k}", Revolute(axis), f"l{k}", f"l{k + 1}", place, lower=-3, upper=3)
        builder.add_link("tool").add_joint(
            "end", Fixed(), "l6", "tool", SE3.trans(0.05 * size, 0, 0.1 * size)
        )
        return ulna.Robot(builder.build())

    small, large = arm(1.0), arm(8.0)
    Q, starts = small.random_configuration(20, seed=1), small.random_configuration(20, seed=2)
    one = small.ik(small.fk(Q), starts, position_tolerance=1e-6)
    other = large.ik(large.fk(Q), starts, position_tolerance=8e-6)
    assert one.success.all()
    np.testing.assert_array_equal(other.iterations, one.iterations)
    np.testing.assert_array_equal(other.q, one.q)
