"""Calls for one frame are bound to a Data once, and see every change of the frame, the model and the Data's contents."""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using

pytestmark = pytest.mark.usefixtures("compiled_at_once")

REFERENCES = ("LOCAL", "WORLD", "LOCAL_WORLD_ALIGNED")


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


@pytest.fixture
def model(pin: Any) -> Any:
    return pin.buildSampleModelManipulator()


def _asked(pin: Any, model: Any, data: Any, q: Any) -> list[Any]:
    frame, joint = model.nframes - 1, model.njoints - 1
    found = []
    for name in REFERENCES:
        reference = getattr(pin, name)
        found += [pin.computeFrameJacobian(model, data, q, frame, reference)]
        pin.forwardKinematics(model, data, q, q, q)
        found += [
            ask(model, data, at, reference).vector
            for at, asks in (
                (frame, (pin.getFrameVelocity, pin.getFrameAcceleration, pin.getFrameClassicalAcceleration)),
                (joint, (pin.getVelocity, pin.getAcceleration, pin.getClassicalAcceleration)),
            )
            for ask in asks
        ]
    found += [pin.computeJointJacobian(model, data, q, joint)]
    found += [pin.updateFramePlacement(model, data, frame).homogeneous]
    pin.updateFramePlacements(model, data)
    return [*found, data.oMf[frame].homogeneous]


@pytest.mark.parametrize("change", ["placement", "parent", "joint", "nothing"])
def test_a_bound_call_sees_every_change(pin: Any, model: Any, change: str) -> None:
    data, q, frame = model.createData(), np.linspace(0.1, 0.6, 6), model.frames[model.nframes - 1]
    for k in range(4):
        found = _asked(pin, model, data, q + k)
        fresh = _asked(pin, model.copy(), model.createData(), q + k)
        for own, other in zip(found, fresh, strict=True):
            np.testing.assert_allclose(own, other, atol=1e-12)
        if change == "placement":
            frame.placement.translation[0] += 0.1
        elif change == "parent":
            frame.parentJoint = 1 + k
        elif change == "joint":
            model.jointPlacements[2].translation[1] += 0.1


def test_a_velocity_that_is_computed_late_is_that_of_the_last_call(pin: Any, model: Any) -> None:
    data, q, frame = model.createData(), np.linspace(0.1, 0.6, 6), model.nframes - 1
    for k in range(3):
        pin.rnea(model, data, q, k * q, q)
        pin.forwardKinematics(model, data, q)
        slow = pin.getFrameVelocity(model, data, frame, pin.LOCAL)
        pin.forwardKinematics(model, data, q, k * q)
        assert slow.isApprox(pin.getFrameVelocity(model, data, frame, pin.LOCAL))


def test_references_are_distinguished_by_their_names_when_bound_too(pin: Any, model: Any) -> None:
    data, q = model.createData(), np.zeros(6)
    for _ in range(2):
        pin.computeFrameJacobian(model, data, q, 3, pin.WORLD)
        with pytest.raises(Exception, match="reference frame is 0"):
            pin.computeFrameJacobian(model, data, q, 3, 0)


def test_copying_a_model_compiles_nothing(pin: Any, model: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    _asked(pin, model, data, q)
    model.copy()
    monkeypatch.setattr(pin._model.compiled_model, "compile_function", None)
    _asked(pin, model, data, q)


@pytest.mark.parametrize("robot", ["fixed", "floating"])
def test_forces_are_read_where_they_lie(pin: Any, robot: str) -> None:
    model = pin.buildSampleModelManipulator() if robot == "fixed" else pin.buildSampleModelHumanoid()
    data, q = model.createData(), pin.neutral(model)
    v, a = np.linspace(-1.0, 1.0, model.nv), np.linspace(2.0, 1.0, model.nv)
    forces = pin.StdVec_Force()
    forces.extend([pin.Force(np.arange(6.0) + k) for k in range(model.njoints)])
    for _ in range(3):
        tau = pin.rnea(model, data, q, v, a, forces)
        pin.computeJointJacobians(model, data, q)
        bare = pin.rnea(model, data, q, v, a)
        for k in range(1, model.njoints):
            bare -= pin.getJointJacobian(model, data, k, pin.LOCAL).T @ forces[k].vector
        np.testing.assert_allclose(tau, bare, atol=1e-9)
        np.testing.assert_allclose(pin.aba(model, data, q, v, tau, forces), a, atol=1e-8)
        np.testing.assert_allclose(
            pin.aba(model, data, list(q), v, tau, [f.vector for f in forces]), a, atol=1e-8
        )
        forces[1].linear[0] += 1.0
    with pytest.raises(Exception, match="expected"):
        pin.rnea(model, data, q, v, a, forces[:-1])


def test_random_configurations_lie_evenly_within_limits(pin: Any, model: Any) -> None:
    pin.seed(0)
    low, high = (
        np.array([0.0, -np.inf, -1.0, -np.inf, 2.0, 0.0]),
        np.array([1.0, 1.0, np.inf, np.inf, 2.0, 4.0]),
    )
    drawn = np.array([pin.randomConfiguration(model, low, high) for _ in range(2000)])
    first = np.array([0.0, 1.0 - 2.0 * np.pi, -1.0, -np.pi, 2.0, 0.0])
    last = np.array([1.0, 1.0, 2.0 * np.pi - 1.0, np.pi, 2.0, 4.0])
    assert (first <= drawn).all() and (drawn <= last).all()
    np.testing.assert_allclose(drawn.mean(axis=0), (first + last) / 2.0, atol=0.05 * (last - first).max())
    turned = pin.buildSampleModelHumanoid()
    quats = np.array(
        [
            pin.randomConfiguration(turned, np.full(turned.nq, -1.0), np.ones(turned.nq))[3:7]
            for _ in range(2000)
        ]
    )
    np.testing.assert_allclose(np.linalg.norm(quats, axis=1), 1.0, atol=1e-14)
    np.testing.assert_allclose(quats.T @ quats / 2000, np.eye(4) / 4.0, atol=0.02)
    for bad in (np.full(6, -1.0), np.full(6, np.nan)):
        with pytest.raises(Exception, match="lower limit is above"):
            pin.randomConfiguration(model, np.zeros(6), bad)


def test_a_reference_frame_by_name_counts(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    last = model.nframes - 1
    pin.computeJointJacobiansTimeVariation(model, data, q, q)
    pin.forwardKinematics(model, data, q, q)
    for ask in (pin.getFrameJacobian, pin.getFrameJacobianTimeVariation, pin.getFrameVelocity):
        local, world = ask(model, data, last, pin.LOCAL), ask(model, data, last, pin.WORLD)
        assert not np.allclose(local, world)
        for _ in range(2):
            assert np.array_equal(ask(model, data, last, reference_frame=pin.WORLD), world)
            assert np.array_equal(ask(model, data, frame_id=last, reference_frame=pin.WORLD), world)
    with pytest.raises(TypeError, match="reference_frame"):
        pin.getFrameJacobian(model, data, last)
    assert pin.getFrameVelocity(model, data, last) == pin.getFrameVelocity(model, data, last, pin.LOCAL)
    J = pin.getJointJacobian(model, data, 6, pin.WORLD)
    assert np.array_equal(pin.getJointJacobian(model, data, joint_id=6, reference_frame=pin.WORLD), J)


def test_what_was_bound_once_is_not_bound_again(
    pin: Any, model: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    _asked(pin, model, data, q)
    expected = _asked(pin, model, data, q + 0.1)
    monkeypatch.setattr(type(data), "_attach", None)  # which binding needs
    for found, wanted in zip(_asked(pin, model, data, q + 0.1), expected, strict=True):
        np.testing.assert_array_equal(found, wanted)


def test_a_change_of_a_frame_concerns_the_models_that_have_it(pin: Any, model: Any) -> None:
    data, other, at = model.createData(), model.copy(), model.nframes - 1
    pin.forwardKinematics(model, data, pin.neutral(model))
    pin.updateFramePlacement(model, data, at)
    bound = data._bound_at["frames", at]
    other.frames[at].name = "renamed"
    other.frames.append(model.frames[1].copy())
    pin.updateFramePlacement(model, data, at)
    assert data._bound_at["frames", at] is bound
    other.frames.append(model.frames[at])  # a copy, which is not watched
    model.frames[at].parentJoint = 1
    expected = data.oMi[1] * model.frames[at].placement
    assert np.allclose(pin.updateFramePlacement(model, data, at).homogeneous, expected.homogeneous)
    assert data._bound_at["frames", at] is not bound


@pytest.mark.parametrize("add", ["append", "insert", "extend", "+="])
def test_a_frame_is_watched_from_the_moment_it_is_added(pin: Any, model: Any, add: str) -> None:
    frame = model.frames[model.nframes - 1].copy()
    if add == "append":
        model.frames.append(frame)
    elif add == "insert":
        model.frames.insert(model.nframes, frame)
    elif add == "extend":
        model.frames.extend(f for f in [frame])
    else:
        model.frames += [frame]
    data, at = model.createData(), model.nframes - 1
    pin.forwardKinematics(model, data, pin.neutral(model))
    pin.updateFramePlacement(model, data, at)
    frame = model.frames[at]  # a copy of what was added
    frame.parentJoint = 1
    expected = data.oMi[1] * frame.placement
    assert np.allclose(pin.updateFramePlacement(model, data, at).homogeneous, expected.homogeneous)
    assert [f.name for f in pickle.loads(pickle.dumps(model.frames))] == [f.name for f in model.frames]


def test_derivatives_of_motions_are_read_again_after_changes(pin: Any, model: Any) -> None:
    data, rng = model.createData(), np.random.default_rng(4)
    q = pin.integrate(model, pin.neutral(model), rng.uniform(-1.0, 1.0, model.nv))
    v, a = rng.normal(size=(2, model.nv))
    frame = model.nframes - 1

    def derivatives(at: Any) -> list[Any]:
        velocity = pin.getFrameVelocityDerivatives(model, at, frame, pin.LOCAL)
        joint = pin.getJointVelocityDerivatives(model, at, model.njoints - 1, pin.WORLD)
        return [*velocity, *pin.getFrameAccelerationDerivatives(model, at, frame, pin.WORLD), *joint]

    for k in range(3):
        if k == 2:
            model.frames[frame].placement.translation[0] += 0.5
        moved = pin.integrate(model, q, 0.2 * k * v)
        pin.computeForwardKinematicsDerivatives(model, data, moved, v, a)
        fresh = model.createData()
        pin.computeForwardKinematicsDerivatives(model, fresh, moved, v, a)
        for own, wanted in zip(derivatives(data), derivatives(fresh), strict=True):
            np.testing.assert_allclose(own, wanted, atol=1e-12)
    pin.rnea(model, data, q, v, a)  # leaves the accelerations of the state before
    for own, wanted in zip(derivatives(data), derivatives(fresh), strict=True):
        np.testing.assert_allclose(own, wanted, atol=1e-12)
    with pytest.raises(TypeError):
        pin.getJointVelocityDerivatives(model, data, 1)


def test_motions_at_placements_follow_the_state(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, rng = model.createData(), np.random.default_rng(3)
    for _ in range(3):
        q, v, a = rng.standard_normal((3, 6))
        pin.forwardKinematics(model, data, q, v, a)
        for rf in (pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED):
            M = pin.SE3.Random()
            frame = model.addFrame(pin.Frame(f"{rng.random()}", 4, 0, M, pin.OP_FRAME))
            fresh = model.createData()
            pin.forwardKinematics(model, fresh, q, v, a)
            for ask in (pin.getFrameVelocity, pin.getFrameAcceleration, pin.getFrameClassicalAcceleration):
                wanted = ask(model, fresh, frame, rf)
                assert ask(model, data, 4, M, rf).isApprox(wanted, 1e-12)
                assert ask(model, data, 4, M, rf).isApprox(wanted, 1e-12)


def test_a_repeated_call_at_a_placement_follows_placement_state_and_reference(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, rng = model.createData(), np.random.default_rng(4)
    asks = (pin.getFrameVelocity, pin.getFrameAcceleration, pin.getFrameClassicalAcceleration)
    kept = []
    for _ in range(6):
        q, v, a = rng.standard_normal((3, 6))
        pin.forwardKinematics(model, data, q, v, a)
        pin.computeJointJacobians(model, data, q)
        for joint in (2, 5):
            M = pin.SE3.Random()
            for rf in (pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED):
                T = data.oMi[joint] * M
                R = {"LOCAL": np.eye(3), "WORLD": T.rotation, "LOCAL_WORLD_ALIGNED": T.rotation}[rf.name]
                for ask, motion in zip(asks, (data.v[joint], data.a[joint], None), strict=True):
                    found = ask(model, data, joint, M, rf)
                    assert found == ask(model, data, joint, M, rf)
                    if rf == pin.LOCAL:
                        assert found == ask(model, data, joint, M)
                    if motion is None:
                        continue
                    local = M.actInv(motion)
                    wanted = (
                        T.act(local) if rf == pin.WORLD else pin.Motion(R @ local.linear, R @ local.angular)
                    )
                    np.testing.assert_allclose(found.vector, wanted.vector, atol=1e-12)
                    kept.append((found, wanted))
                J = pin.getFrameJacobian(model, data, joint, M, rf)
                np.testing.assert_allclose(J @ v, asks[0](model, data, joint, M, rf).vector, atol=1e-12)
    for found, wanted in kept:
        np.testing.assert_allclose(found.vector, wanted.vector, atol=1e-12)
    with pytest.raises(TypeError):
        pin.getFrameVelocity(model, data, 2, np.eye(4), pin.LOCAL)
    with pytest.raises(TypeError):
        pin.getFrameVelocity(model, data, 2, M, 0)


def test_a_repeated_jacobian_at_q_follows_q_place_and_reference(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, rng = model.createData(), np.random.default_rng(5)
    for turn in range(5):
        q, v = rng.standard_normal((2, 6))
        fresh = model.createData()
        pin.forwardKinematics(model, fresh, q, v)
        for place in (3, 5):
            asked = [(), *((getattr(pin, name),) for name in REFERENCES)]
            for rf in asked:
                frame = model.getFrameId(model.names[place])
                J = pin.computeFrameJacobian(model, data, q if turn < 4 else list(q), frame, *rf)
                wanted = pin.getFrameVelocity(model, fresh, frame, *rf).vector
                np.testing.assert_allclose(J @ v, wanted, atol=1e-12)
            J = pin.computeJointJacobian(model, data, q, place)
            np.testing.assert_allclose(J @ v, fresh.v[place].vector, atol=1e-12)
    with pytest.raises(TypeError):
        pin.computeFrameJacobian(model, data, q, 3, 0)
    with pytest.raises(ValueError):
        pin.computeJointJacobian(model, data, q[:-1], 3)


def test_placements_of_all_frames_follow_frames_and_joints_that_change(pin: Any) -> None:
    """`updateFramePlacements` takes the joints' placements as forwardKinematics left them, and frames as they are."""
    model, q = pin.buildSampleModelManipulator(), np.linspace(-0.5, 0.5, 6)
    data = model.createData()

    def check() -> None:
        for _ in range(3):
            pin.updateFramePlacements(model, data)
            for frame, found in zip(model.frames, data.oMf, strict=True):
                wanted = data.oMi[frame.parentJoint] * frame.placement
                np.testing.assert_allclose(found.homogeneous, wanted.homogeneous, atol=1e-14)

    for k in range(6):
        pin.forwardKinematics(model, data, q)
        check()
        before = data.oMf[-1].homogeneous
        model.jointPlacements[2] = pin.SE3.Random()
        check()
        np.testing.assert_array_equal(data.oMf[-1].homogeneous, before)
        pin.forwardKinematics(model, data, q)
        check()
        assert not np.allclose(data.oMf[-1].homogeneous, before)
        model.frames[3 + k].placement = pin.SE3.Random()
        check()
        model.frames[4].parentJoint = 1 + k
        check()
