"""Differential IK as it is called: what it is passed and how, what it refuses, and what it says when nothing can be done."""

from __future__ import annotations

import pickle
import sys
import threading

import numpy as np
import pytest

import ulna
from ulna.errors import (
    DtypeError,
    InfeasibleError,
    InputError,
    MissingExtra,
    NonFiniteError,
    ShapeError,
    UnknownName,
)
from ulna.ik import (
    AccelerationLimit,
    AxisTask,
    DampingTask,
    DifferentialIK,
    FrameTask,
    JointCouplingTask,
    LinearLimit,
    LinearTask,
    ManipulabilityTask,
    OrientationTask,
    PlaneLimit,
    PositionLimit,
    PositionTask,
    PostureTask,
    VelocityLimit,
)
from ulna.model import FreeFlyer, ModelBuilder, Revolute
from ulna.spatial import SE3, SO3, Inertia

HAND = "panda_hand"
DT = 0.01


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.fixture(scope="module")
def q(panda: ulna.Robot) -> np.ndarray:
    return np.array(panda.configurations["qr"])


@pytest.fixture(scope="module")
def goal(panda: ulna.Robot, q: np.ndarray) -> np.ndarray:
    return panda.fk(q, HAND) @ SE3.from_rpy((0.1, 0.0, -0.1), (0.02, 0.01, 0.03)).matrix()


@pytest.fixture(scope="module")
def ik(panda: ulna.Robot) -> DifferentialIK:
    return DifferentialIK(panda, [FrameTask(HAND), PostureTask(1e-3, target="qr")])


# ---------------------------------------------------------------------------------------------------- telling


def test_targets_go_by_place_or_by_name(ik: DifferentialIK, q, goal) -> None:
    assert ik.inputs == (HAND, "posture")
    v = ik.velocity(q, DT, goal)
    for same in (
        ik.velocity(q, DT, panda_hand=goal),
        ik.velocity(q, DT, goal, q),
        ik.velocity(q, DT, goal, posture=q),
        ik.velocity(list(q), DT, goal.tolist()),
        ik.velocity(q, DT, SE3.from_matrix(goal)),
        ik.velocity(q, np.float64(DT), goal),
    ):
        np.testing.assert_array_equal(v, same)
    assert not np.allclose(v, ik.velocity(q, DT, goal, posture=q + 1.0))
    np.testing.assert_array_equal(ik.step(q, DT, goal), q + DT * v)


def test_defaults_are_the_last_passed(panda: ulna.Robot, q, goal) -> None:
    ik = DifferentialIK(
        panda,
        [PostureTask(1e-3, target=dict.fromkeys(panda.joint_names, 0.1)), FrameTask(HAND)],
        [AccelerationLimit(5.0)],
    )
    assert ik.inputs == (HAND, "v", "posture")
    ik.velocity(q, DT, goal, np.zeros(7))
    assert repr(ik) == (
        "<differential IK of 'panda': posture, panda_hand, AccelerationLimit; inputs panda_hand, v, posture>"
    )


def test_a_default_stays_when_the_array_it_was_made_of_changes(panda: ulna.Robot, q, goal) -> None:
    T = np.array(goal)
    ik = DifferentialIK(panda, [FrameTask("panda_hand", target=T)])
    before = ik.velocity(q, 1e-2)
    T[:3, 3] += 1.0
    np.testing.assert_array_equal(ik.velocity(q, 1e-2), before)


def test_costs_can_be_faded(panda: ulna.Robot, q, goal) -> None:
    tasks = [FrameTask(HAND, adjustable=True), PostureTask(1e-2)]
    ik = DifferentialIK(panda, tasks)
    assert ik.inputs == (HAND, "posture", "panda_hand_scale")
    other = q + 0.01
    for scale in (0.0, 0.3, 1.0):
        reaching = [FrameTask(HAND, scale, scale, target=goal)] if scale else []
        fixed = DifferentialIK(panda, [*reaching, PostureTask(1e-2, target=other)])
        v = ik.velocity(q, DT, goal, other, panda_hand_scale=scale)
        np.testing.assert_allclose(v, fixed.velocity(q, DT), atol=1e-9)
    np.testing.assert_array_equal(ik.velocity(q, DT, goal, other), v)


def test_wrong_targets_are_refused(ik: DifferentialIK, q, goal) -> None:
    with pytest.raises(InputError, match="Missing targets: 'panda_hand'"):
        ik.velocity(q, DT)
    with pytest.raises(UnknownName, match="Did you mean 'panda_hand'"):
        ik.velocity(q, DT, panda_hend=goal)
    with pytest.raises(InputError, match="passed twice"):
        ik.velocity(q, DT, goal, panda_hand=goal)
    with pytest.raises(InputError, match="3 targets are passed; expected at most 2"):
        ik.velocity(q, DT, goal, q, q)
    with pytest.raises(ShapeError, match="panda_hand"):
        ik.velocity(q, DT, goal[:3])
    with pytest.raises(NonFiniteError, match="panda_hand"):
        ik.velocity(q, DT, np.full((4, 4), np.nan))
    with pytest.raises(NonFiniteError, match="`q"):
        ik.velocity(q + np.inf, DT, goal)
    for values in ("here", None):
        with pytest.raises(DtypeError, match="panda_hand"):
            ik.velocity(q, DT, values)
    for dt in (0.0, -1.0, np.nan, "soon", None):
        with pytest.raises(InputError, match="duration above 0"):
            ik.velocity(q, dt, goal)  # type: ignore[arg-type]


def test_a_target_that_is_no_rotation_is_refused(panda: ulna.Robot, ik: DifferentialIK, q, goal) -> None:
    scaled = goal.copy()
    scaled[:3, :3] *= 1.001
    with pytest.raises(InputError, match=r"`panda_hand` is not a rotation: R\^T R differs from 1 by 0.002"):
        ik.velocity(q, DT, scaled)
    with pytest.raises(InputError, match=r"`panda_hand` at index \(1,\) is not a rotation"):
        ik.velocity(q, DT, np.stack([goal, scaled]))
    turn = DifferentialIK(panda, [ulna.ik.OrientationTask(HAND)])
    R = SO3.from_matrix(goal[:3, :3])
    np.testing.assert_array_equal(turn.velocity(q, DT, R), turn.velocity(q, DT, R.matrix))
    with pytest.raises(InputError, match="not a rotation"):
        turn.velocity(q, DT, np.zeros((3, 3)))


def test_what_is_made_wrongly_is_refused(panda: ulna.Robot) -> None:
    made = lambda *tasks, **options: DifferentialIK(panda, tasks, **options)  # noqa: E731
    with pytest.raises(UnknownName, match="Did you mean 'panda_hand'"):
        made(FrameTask("panda_hend"))
    with pytest.raises(InputError, match="no task"):
        made()
    with pytest.raises(InputError, match="belongs to two tasks"):
        made(FrameTask(HAND), PositionTask(HAND))
    made(FrameTask(HAND), PositionTask(HAND, name="point"))
    with pytest.raises(InputError, match="'damping' belongs to two"):
        made(FrameTask(HAND), DampingTask(), DampingTask())
    with pytest.raises(InputError, match="met exactly"):
        made(PostureTask(), constraints=[FrameTask(HAND, adjustable=True)])
    with pytest.raises(InputError, match="is reserved"):
        made(FrameTask(HAND, name="q"))
    with pytest.raises(InputError, match="`tasks` holds 'panda_hand'"):
        made(HAND)
    for tasks in (None, FrameTask(HAND), iter([FrameTask(HAND)])):
        with pytest.raises(InputError, match="expected a list"):
            DifferentialIK(panda, tasks)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="`position_cost` is 'much'"):
        made(FrameTask(HAND, position_cost="much"))  # type: ignore[arg-type]
    for cost in (-1.0, np.inf, [1.0, np.nan, 1.0]):
        with pytest.raises(InputError, match="`position_cost` is .* expected finite numbers not below 0"):
            made(FrameTask(HAND, position_cost=cost))
    with pytest.raises(InputError, match=r"`position_cost` has shape \(2,\); expected a number or 3 numbers"):
        made(FrameTask(HAND, position_cost=[1.0, 2.0]))
    with pytest.raises(InputError, match="kind Limit"):
        made(FrameTask(HAND), limits=[FrameTask(HAND)])
    with pytest.raises(InputError, match="`damping` is 0"):
        made(FrameTask(HAND), damping=0.0)
    with pytest.raises(InputError, match="locked"):
        made(FrameTask(HAND), locked=panda.joint_names)
    with pytest.raises(UnknownName, match="panda_joint1"):
        made(FrameTask(HAND), locked="panda_joint_1")
    with pytest.raises(InputError, match="or a Model"):
        DifferentialIK("panda", [FrameTask(HAND)])
    with pytest.raises(InputError, match="`gain` is 1.5"):
        FrameTask(HAND, gain=1.5)
    with pytest.raises(InputError, match="`damping` is -1"):
        FrameTask(HAND, damping=-1.0)
    for cost in (-1.0, [1.0, 2.0], np.nan):
        with pytest.raises(InputError, match="`position_cost`"):
            made(FrameTask(HAND, cost))
    with pytest.raises(UnknownName, match="axes"):
        made(FrameTask(HAND, axes="tool"))


def test_targets_at_and_errors(panda: ulna.Robot, ik: DifferentialIK, q, goal) -> None:
    values = ik.targets_at(q)
    assert set(values) == {HAND, "posture"}
    assert np.abs(ik.velocity(q, DT, **values)).max() < 1e-12
    errors = ik.errors(q, goal)
    np.testing.assert_allclose(
        errors[HAND], SE3.from_rpy((0.1, 0.0, -0.1), (0.02, 0.01, 0.03)).log().vector(), atol=1e-12
    )
    np.testing.assert_array_equal(errors["posture"], np.zeros(7))


def test_problem_is_what_is_solved(panda: ulna.Robot, q, goal) -> None:
    free = DifferentialIK(panda, [FrameTask(HAND), DampingTask(0.1)], [], damping=1e-4)
    p = free.problem(q, DT, goal)
    np.testing.assert_allclose(free.velocity(q, DT, goal), -np.linalg.solve(p.H, p.g), atol=1e-10)
    assert np.isinf(p.lower).all()
    J = panda.jacobian(q, HAND, "local")
    np.testing.assert_allclose(
        free.problem(q, DT, panda.fk(q, HAND)).H, J.T @ J + (1e-4 + 1e-2) * np.eye(7), atol=1e-12
    )


def test_pickled_it_is_the_same(ik: DifferentialIK, q, goal) -> None:
    again = pickle.loads(pickle.dumps(ik))
    np.testing.assert_array_equal(again.velocity(q, DT, goal), ik.velocity(q, DT, goal))


def test_threads_do_not_mix_durations_up(ik: DifferentialIK, q, goal) -> None:
    wrong: list[float] = []

    def run(dt: float) -> None:
        expected = ik.velocity(q, dt, goal)
        for _ in range(300):
            if not np.array_equal(ik.velocity(q, dt, goal), expected):
                wrong.append(dt)

    threads = [threading.Thread(target=run, args=(dt,)) for dt in (0.01, 0.1, 1.0)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_an_empty_batch_is_empty(ik: DifferentialIK, goal) -> None:
    assert ik.velocity(np.zeros((0, 7)), DT, goal).shape == (0, 7)


# -------------------------------------------------------------------------------------------- nothing can be done


def test_limits_without_room_name_joint_and_limits(panda: ulna.Robot, ik: DifferentialIK, q, goal) -> None:
    out = q.copy()
    out[3] = -3.3  # its limit is -3.0718; at 2.175 rad/s it needs ten steps to come back
    with pytest.raises(
        InfeasibleError, match=r"'panda_joint4' \(at -3.3, limits -3.0718 .. -0.0698\)"
    ) as caught:
        ik.velocity(out, DT, goal)
    assert caught.value.parts == ("PositionLimit", "VelocityLimit")
    assert "at least 22.82" in str(caught.value)
    assert "at most 2.175" in str(caught.value)
    with pytest.raises(InfeasibleError, match=r"at index \(1,\)"):
        ik.velocity(np.stack([q, out]), DT, goal)


def test_a_little_beyond_a_limit_it_comes_back(panda: ulna.Robot, ik: DifferentialIK, q, goal) -> None:
    out = q.copy()
    out[3] = panda.limits.lower[3] - 1e-3
    assert ik.step(out, DT, goal)[3] >= panda.limits.lower[3]


def test_recovering_comes_back_as_fast_as_allowed(panda: ulna.Robot, q, goal) -> None:
    ik = DifferentialIK(panda, [FrameTask(HAND)], recover=True)
    out = q.copy()
    out[3] = -3.3
    for k in range(12):
        v = ik.velocity(out, DT, goal)
        assert (np.abs(v) <= panda.limits.velocity).all()
        if k < 10:
            assert v[3] == panda.limits.velocity[3]
        out = out + DT * v
    assert panda.limits.contains(out)


def test_rows_without_room_are_named(panda: ulna.Robot, q, goal) -> None:
    above, below = (
        PlaneLimit(HAND, (0, 0, 1), 2.0, name="floor"),
        PlaneLimit(HAND, (0, 0, -1), 1.0, name="ceiling"),
    )
    ik = DifferentialIK(panda, [FrameTask(HAND)], [VelocityLimit(), above])
    with pytest.raises(
        InfeasibleError, match="without any one of these there is: VelocityLimit, floor"
    ) as caught:
        ik.velocity(q, DT, goal)
    assert caught.value.parts == ("VelocityLimit", "floor")
    both = DifferentialIK(panda, [FrameTask(HAND)], [above, below])
    with pytest.raises(InfeasibleError, match="floor, ceiling"):
        both.velocity(q, DT, goal)


def test_constraints_that_contradict_each_other_are_named(panda: ulna.Robot, q) -> None:
    here, there = (PositionTask(HAND, name=name) for name in ("here", "there"))
    ik = DifferentialIK(panda, [PostureTask(target="qr")], constraints=[here, there])
    p = panda.fk(q, HAND)[:3, 3]
    with pytest.raises(InfeasibleError, match="here, there"):
        ik.velocity(q, DT, p, p + 1e-4)


def test_rows_need_daqp_only_where_they_matter(panda: ulna.Robot, q, goal, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "daqp", None)
    height = panda.fk(q, HAND)[2, 3]
    ik = DifferentialIK(panda, [FrameTask(HAND)], [VelocityLimit(), PlaneLimit(HAND, height=height - 0.5)])
    ik.velocity(q, DT, goal)
    low = goal.copy()
    low[2, 3] -= 1.0
    with pytest.raises(MissingExtra, match=r"pip install .*'daqp>="):
        ik.velocity(q, DT, low, panda_hand_plane=[0.0, 0.0, 1.0, height])


# ------------------------------------------------------------------------------------------------ rows, batches, kinds


def test_a_matrix_that_is_passed_need_not_be_a_rotation(panda: ulna.Robot, q) -> None:
    ik = DifferentialIK(panda, [PostureTask()], [LinearLimit(4)], locked=panda.joint_names[4:])
    problem = ik.problem(q, DT, q, np.ones((4, 7)), np.ones(4))
    assert problem.status == problem.verdict == 0.0  # `verdict` is the former name
    short = ulna.Robot(ulna.model.lock_joints(panda.model, panda.joint_names[4:]))
    four = DifferentialIK(short, [PostureTask()], [LinearLimit(4)])
    assert np.abs(four.velocity(q[:4], DT, q[:4], 2.0 * np.ones((4, 4)), np.ones(4))).max() < 1e-12


def test_rows_are_kept(panda: ulna.Robot, q, goal) -> None:
    rng = np.random.default_rng(0)
    ik = DifferentialIK(panda, [FrameTask(HAND)], [VelocityLimit(), LinearLimit(2, name="near")])
    assert ik.inputs == (HAND, "near_matrix", "near_bound")
    A = rng.standard_normal((2, 7))
    free = ik.velocity(q, DT, goal, np.zeros((2, 7)), np.zeros(2))
    b = A @ free - 0.3
    v = ik.velocity(q, DT, goal, A, b)
    np.testing.assert_allclose(A @ v, b, atol=1e-9)
    np.testing.assert_allclose(ik.velocity(q, DT, goal, A, b + 0.4), free, atol=1e-9)
    np.testing.assert_allclose(ik.step(q, DT, goal, A, b), q + DT * v)


def test_a_batch_is_solved_again_sample_by_sample(panda: ulna.Robot, q, goal) -> None:
    ik = DifferentialIK(
        panda, [FrameTask(HAND)], [VelocityLimit(), PlaneLimit(HAND, height=0.2)], constraints=[]
    )
    heights = panda.fk(q, HAND)[2, 3] - np.array([0.0, 0.3, 0.001])
    planes = np.stack([np.array([0.0, 0.0, 1.0, h]) for h in heights])
    low = goal.copy()
    low[2, 3] -= 0.1
    v = ik.velocity(q, DT, low, panda_hand_plane=planes)
    np.testing.assert_allclose(
        v, [ik.velocity(q, DT, low, panda_hand_plane=plane) for plane in planes], atol=1e-9
    )
    assert not np.allclose(v[0], v[1])
    rigid = DifferentialIK(panda, [PostureTask(target="qr")], constraints=[PositionTask(HAND)])
    points = panda.fk(q, HAND)[:3, 3] + np.array([[1e-3, 0, 0], [0, -1e-3, 0]])
    batch = rigid.velocity(q, DT, points)
    np.testing.assert_allclose(batch, [rigid.velocity(q, DT, point) for point in points], atol=1e-12)
    J = panda.jacobian(q, HAND)[:3]
    np.testing.assert_allclose(batch @ J.T * DT, [[1e-3, 0, 0], [0, -1e-3, 0]], atol=1e-9)


def test_a_floating_base_moves_on_its_group() -> None:
    b = (
        ModelBuilder("walker")
        .add_link("body", Inertia.from_box(3.0, (0.2, 0.2, 0.2)))
        .root_joint(FreeFlyer())
    )
    for k, y in enumerate((0.1, -0.1)):
        b.add_link(f"leg{k}", Inertia.from_point(0.5, (0.0, 0.0, -0.1)))
        b.add_joint(f"hip{k}", Revolute((1, 0, 0)), "body", f"leg{k}", SE3.trans(0, y, 0), velocity=3.0)
        b.add_frame(f"foot{k}", f"leg{k}", SE3.trans(0, 0, -0.3))
    model = b.build()
    feet = [FrameTask(f"foot{k}", name=f"foot{k}") for k in range(2)]
    ik = DifferentialIK(model, [*feet, PostureTask(1e-2)], damping=1e-6)
    q = np.array([0.0, 0.0, 0.5, *SO3.rx(0.3).quat_xyzw(), 0.2, -0.1])
    aim = np.array([0.1, 0.2, 0.4, *SO3.rz(0.4).quat_xyzw(), 0.0, 0.3])
    values = ik.targets_at(aim)
    for _ in range(60):
        q = ik.step(q, 0.1, **values)
        np.testing.assert_allclose(np.linalg.norm(q[3:7]), 1.0, atol=1e-12)
    np.testing.assert_allclose(q[:3], aim[:3], atol=1e-6)
    assert all(np.abs(e).max() < 1e-6 for e in ik.errors(q, **values).values() if len(e) == 6)
    long = q.copy()
    long[3:7] *= 1.1
    with pytest.raises(InputError, match="unit"):
        ik.step(long, 0.1, **values)


def test_position_limit_holds_by_default(panda: ulna.Robot, q) -> None:
    ik = DifferentialIK(panda, [PostureTask(1.0)], [PositionLimit(gain=0.5, margin=0.1)])
    target = panda.limits.upper + 1.0
    at = panda.limits.upper - 0.3
    np.testing.assert_allclose(ik.step(at, DT, target), at + 0.5 * 0.2, atol=1e-12)


@pytest.mark.parametrize("angle", [1e-3, 0.3, 1.2, 2.4])
def test_an_axis_can_be_a_constraint(panda: ulna.Robot, q, angle: float) -> None:
    """Of the chord to the target only the part across the axis can be met; all of it asked for the impossible."""
    ik = DifferentialIK(panda, [PostureTask(target=q)], constraints=[AxisTask(HAND, gain=0.3, name="axis")])
    R = panda.fk(q, HAND)[:3, :3]
    for turn in (SO3.rx(angle), SO3.ry(-angle)):
        target, x = R @ turn.matrix[:, 2], q
        for _ in range(60):
            x = ik.step(x, 0.5, target)
        assert np.abs(panda.fk(x, HAND)[:3, 2] - target).max() < 1e-6
    with pytest.raises(InfeasibleError):
        ik.velocity(q, DT, -R[:, 2])  # any way would do, so none is chosen


@pytest.mark.parametrize("as_constraint", [False, True])
def test_a_direction_of_zeros_is_named(panda: ulna.Robot, q, as_constraint: bool) -> None:
    axis, rest = AxisTask(HAND, name="axis"), PostureTask(target=q)
    ik = (
        DifferentialIK(panda, [rest], constraints=[axis])
        if as_constraint
        else DifferentialIK(panda, [axis, rest])
    )
    with pytest.raises(InputError, match=r"^`axis` holds only zeros; expected a direction"):
        ik.velocity(q, DT, np.zeros(3))
    here = panda.fk(q, HAND)[:3, 2]
    with pytest.raises(InputError, match=r"^`axis` at index \(1,\) holds only zeros"):
        ik.velocity(q, DT, np.stack([here, np.zeros(3)]))


def test_a_transposed_pose_and_a_reflection_are_refused(panda: ulna.Robot, q) -> None:
    """Their three by three entries are orthogonal, so that they were taken for the pose of another place."""
    T = panda.fk(q, HAND)
    for frame in (FrameTask(HAND), FrameTask(HAND, axes="world")):
        with pytest.raises(InputError, match=rf"^`{HAND}` has the last row .* Is it transposed"):
            DifferentialIK(panda, [frame]).velocity(q, DT, T.T)
        with pytest.raises(InputError, match=rf"^`{HAND}` is not a rotation but a reflection"):
            DifferentialIK(panda, [frame]).velocity(q, DT, T @ np.diag([1.0, 1.0, -1.0, 1.0]))
    mirror = OrientationTask(HAND, target=np.diag([1.0, -1.0, 1.0]))
    with pytest.raises(InputError, match="reflection"):
        DifferentialIK(panda, [mirror]).velocity(q, DT)


def test_a_duration_of_zero_is_refused_by_the_first_step_too(panda: ulna.Robot, q) -> None:
    with pytest.raises(InputError, match=r"^`dt` is 0\.0; expected a duration above 0 s"):
        DifferentialIK(panda, [FrameTask(HAND)]).step(q, 0.0, panda.fk(q, HAND))


@pytest.mark.parametrize(
    ("task", "named"),
    [
        (JointCouplingTask({}), "`ratios` is empty"),
        (JointCouplingTask({"panda_joint1": np.nan}), "`ratios` are"),
        (JointCouplingTask({"panda_joint1": 1.0}, offset=np.inf), "`offset` is inf"),
        (ManipulabilityTask(HAND, rate=np.nan), "rate` is nan"),
        (LinearTask(np.full((1, 7), np.nan), target=[0.0]), "`A` holds nan"),
    ],
    ids=["empty", "ratio", "offset", "rate", "matrix"],
)
def test_constants_of_tasks_that_are_no_numbers_are_refused(panda: ulna.Robot, task, named: str) -> None:
    with pytest.raises(InputError, match=named):
        DifferentialIK(panda, [task])


def test_recover_is_true_or_false(panda: ulna.Robot) -> None:
    with pytest.raises(InputError, match="`recover` is 'no'"):
        DifferentialIK(panda, [FrameTask(HAND)], recover="no")  # pyright: ignore[reportArgumentType]


def test_a_task_of_no_cost_is_refused(panda: ulna.Robot) -> None:
    with pytest.raises(
        InputError, match=r"panda_hand: all costs are 0, .* or leave it out\. One that is `adjustable`"
    ):
        DifferentialIK(panda, [FrameTask("panda_hand", position_cost=0.0, orientation_cost=0.0)])
    with pytest.raises(InputError, match="all costs are 0"):
        DifferentialIK(panda, [FrameTask("panda_hand"), PostureTask(np.zeros(7), target="ready")])
    DifferentialIK(panda, [FrameTask("panda_hand", position_cost=0.0)])
