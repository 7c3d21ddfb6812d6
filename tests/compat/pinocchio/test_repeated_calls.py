"""Calls that run without Python follow the model and the Data as all others do."""

from __future__ import annotations

import copy
import gc
import random
import sys
import weakref
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


@pytest.fixture
def arm(pin: Any) -> tuple[Any, Any, Any]:
    model = pin.buildSampleModelManipulator()
    data, rng = model.createData(), np.random.default_rng(3)
    states = rng.uniform(-1.0, 1.0, (4, 3, 6))
    for q, v, a in np.tile(states, (10, 1, 1)):
        pin.forwardKinematics(model, data, q, v, a)
        pin.rnea(model, data, q, v, a)
        pin.getVelocity(model, data, 3, pin.LOCAL)
        pin.getFrameVelocity(model, data, 4, pin.WORLD)
    return model, data, states


def test_numbers_are_those_of_the_last_call(pin: Any, arm: Any) -> None:
    model, data, states = arm
    for q, v, a in states:
        other = model.createData()
        pin.forwardKinematics(model, data, q, v, a)
        pin.forwardKinematics(model, other, q, v, a)
        assert pin.getFrameVelocity(model, data, 4, pin.WORLD) == pin.getFrameVelocity(
            model, other, 4, pin.WORLD
        )
        model.inertias[2].mass += 0.5
        np.testing.assert_allclose(pin.rnea(model, data, q, v, a), pin.rnea(model, other, q, v, a))


def test_calls_that_name_a_convention_follow_the_model_and_the_data(pin: Any, arm: Any) -> None:
    model, data, states = arm
    for convention in (pin.Convention.LOCAL, pin.Convention.WORLD):
        for q, v, tau in np.tile(states, (5, 1, 1)):
            model.inertias[2].mass += 0.1
            fresh, new = model.createData(), model.createData()
            ddq, M = pin.aba(model, data, q, v, tau, convention), pin.crba(model, data, q, convention)
            np.testing.assert_allclose(pin.rnea(model, fresh, q, v, ddq), tau, atol=1e-9)
            np.testing.assert_allclose(M, pin.crba(model, new, q), atol=1e-12)
            named = pin.aba(model, data, q, v, tau, convention=convention)
            np.testing.assert_array_equal(ddq, named)
            if convention is pin.Convention.WORLD:
                np.testing.assert_allclose(data.J, pin.computeJointJacobians(model, fresh, q), atol=1e-12)
    with pytest.raises(TypeError):
        pin.aba(model, data, q, v, tau, 3.0)


def test_a_data_may_change_its_model(pin: Any, arm: Any) -> None:
    model, data, (state, *_) = arm
    heavy = model.copy()
    heavy.inertias[3].mass = 20.0
    wanted = pin.rnea(model, model.createData(), *state), pin.rnea(heavy, heavy.createData(), *state)
    for _ in range(15):
        np.testing.assert_allclose(pin.rnea(model, data, *state), wanted[0])
        np.testing.assert_allclose(pin.rnea(heavy, data, *state), wanted[1])
        pin.computeSubtreeMasses(model, data)
        light = data.mass[0]
        pin.computeSubtreeMasses(heavy, data)
        assert data.mass[0] > light + 10.0


def test_calls_without_a_reference_frame_are_repeated_without_python(pin: Any, arm: Any) -> None:
    from ulna.compiler.runtime.repeated_calls import RepeatedCalls

    if not isinstance(pin.getVelocity, RepeatedCalls):
        pytest.skip("machine code cannot be called in this way here")
    model, data, (state, *_) = arm
    pin.forwardKinematics(model, data, *state)
    for f in (pin.getVelocity, pin.getAcceleration, pin.getClassicalAcceleration, pin.getFrameVelocity):
        first = f(model, data, 3)
        for _ in range(16):  # a row that was replaced keeps others out for a while
            f(model, data, 3)
        names: list[str] = []
        sys.setprofile(
            lambda frame, event, _, names=names: (
                names.append(frame.f_code.co_name) if event == "call" else None
            )
        )
        try:
            again = f(model, data, 3)
        finally:
            sys.setprofile(None)
        assert names == [] and again == first == f(model, data, 3, pin.LOCAL)


def test_arguments_are_checked_as_before(pin: Any, arm: Any) -> None:
    model, data, (state, *_) = arm
    q, v, a = state
    for _ in range(3):
        assert pin.rnea(model, data, list(q), v, a).shape == (6,)
        with pytest.raises(ValueError, match="shape"):
            pin.rnea(model, data, q[:5], v, a)
        with pytest.raises(TypeError, match="`data` is None"):
            pin.rnea(model, None, q, v, a)
        with pytest.raises(TypeError):
            pin.getVelocity(model, data, 3, 0)
        with pytest.raises(IndexError):
            pin.getVelocity(model, data, 300, pin.LOCAL)
        assert pin.getVelocity(model, data, joint_id=3, reference_frame=pin.LOCAL) == pin.getVelocity(
            model, data, 3
        )
    model.addJoint(6, pin.JointModelRX(), pin.SE3.Identity(), "another")
    with pytest.raises(InputError):
        pin.rnea(model, data, q, v, a)
    with pytest.raises(InputError):
        pin.getVelocity(model, data, 3, pin.LOCAL)


def test_a_data_that_is_loaded_is_written_to_by_the_next_calls(pin: Any, arm: Any) -> None:
    model, data, (_, state, *_) = arm
    text, pose = data.saveToString(), data.oMi[6].copy()
    pin.forwardKinematics(model, data, *state)
    assert data.oMi[6] != pose
    data.loadFromString(text)
    assert data.oMi[6] == pose
    other = model.createData()
    for each in (data, other):
        pin.forwardKinematics(model, each, *state)
        pin.rnea(model, each, *state)
    np.testing.assert_allclose(data.tau, other.tau)
    assert data.oMi[6].isApprox(other.oMi[6])
    velocities = [pin.getFrameVelocity(model, each, 4, pin.WORLD) for each in (data, other)]
    assert velocities[0].isApprox(velocities[1])


def test_composite_inertias_are_those_of_the_last_configuration(pin: Any, arm: Any) -> None:
    model, data, states = arm
    for k, (q, _, _) in enumerate(np.tile(states, (8, 1, 1))):
        if k % 5 == 4:
            model.inertias[4].mass = 1.0 + k
        other = model.createData()
        pin.crba(model, data, q)
        pin.crba(model, other, q)
        for _ in range(2):
            np.testing.assert_allclose(data.Ycrb[2].matrix(), other.Ycrb[2].matrix(), atol=1e-12)
    assert data == data.copy()


def test_jacobians_at_placements_compile_nothing_anew(pin: Any, arm: Any) -> None:
    model, data, (state, *_) = arm
    pin.computeJointJacobians(model, data, state[0])
    rng = np.random.default_rng(1)
    frame = model.addFrame(pin.Frame("tool", 5, 0, pin.SE3.Identity(), pin.OP_FRAME))
    data = model.createData()
    for _ in range(40):
        M = pin.SE3.Random()
        model.frames[frame].placement = M
        q = rng.uniform(-1.0, 1.0, 6)
        for reference in (pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED):
            pin.computeJointJacobians(model, data, q)
            np.testing.assert_allclose(
                pin.getFrameJacobian(model, data, 5, M, reference),
                pin.computeFrameJacobian(model, data, q, frame, reference),
                atol=1e-12,
            )


def test_derivatives_at_placements_compile_nothing_anew(pin: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ULNA_COMPILE", "first")
    model = pin.buildSampleModelManipulator()
    frame = model.addFrame(pin.Frame("tool", 5, 0, pin.SE3.Random(), pin.OP_FRAME))
    data, rng, numbers_of_kernels = model.createData(), np.random.default_rng(1), []

    def asked(M: Any, *at: Any) -> list[Any]:
        found = []
        for reference in (pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED):
            found += pin.getFrameVelocityDerivatives(model, data, *at, reference)
            found += pin.getFrameAccelerationDerivatives(model, data, *at, reference)
            found.append(pin.getFrameKinematicHessian(model, data, *at, reference))
        return found

    for _ in range(6):
        M = pin.SE3.Random()
        model.frames[frame].placement = M
        q, v, a = rng.uniform(-1.0, 1.0, (3, 6))
        pin.computeForwardKinematicsDerivatives(model, data, q, v, a)
        pin.computeJointKinematicHessians(model, data, q)
        of_frame = asked(M, frame)
        for own, other in zip(asked(M, 5, M), of_frame, strict=True):
            np.testing.assert_allclose(own, other, atol=1e-12)
        local = pin.LOCAL
        for own, other in zip(
            pin.getPointVelocityDerivatives(model, data, 5, M, local),
            pin.getFrameVelocityDerivatives(model, data, 5, M, local),
            strict=True,
        ):
            np.testing.assert_allclose(own, other[:3], atol=1e-12)
        numbers_of_kernels.append(len(data._compiled.cache))
    assert numbers_of_kernels[-1] == numbers_of_kernels[-2]


def test_models_and_data_that_change_at_random_answer_as_fresh_ones(
    pin: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ULNA_COMPILE", "first")
    draws, rng = random.Random(4), np.random.default_rng(4)
    models = [pin.buildSampleModelManipulator() for _ in range(2)]
    pairs = [[model, model.createData()] for model in models]

    def new_mass() -> None:
        draws.choice(models).inertias[2].mass = draws.uniform(0.5, 2.0)

    changes = [
        new_mass,
        lambda: pairs.append([models[0], models[0].createData()]),
        lambda: pairs.pop(draws.randrange(1, len(pairs))) if len(pairs) > 2 else None,
        lambda: models.__setitem__(draws.randrange(2), draws.choice(models).copy()),
        lambda: draws.choice(pairs).__setitem__(0, draws.choice(models)),
        lambda: pairs.append([pairs[0][0], copy.copy(pairs[0][1])]),
        gc.collect,
    ]
    for step in range(240):
        if step % 6 == 5:
            draws.choice(changes)()
        model, data = draws.choice(pairs)
        q, v = rng.normal(size=(2, 6))
        tau, bias = pin.rnea(model, data, q, v, v), pin.nonLinearEffects(model, data, q, v)
        np.testing.assert_allclose(tau, pin.crba(model, data, q) @ v + bias, atol=1e-9)
        pin.forwardKinematics(model, data, q, v)
        pin.computeJointJacobians(model, data, q)
        for at, velocity, jacobian in (
            (6, pin.getVelocity, pin.getJointJacobian),
            (model.nframes - 1, pin.getFrameVelocity, pin.getFrameJacobian),
        ):
            J = jacobian(model, data, at, pin.LOCAL)
            np.testing.assert_allclose(velocity(model, data, at, pin.LOCAL).vector, J @ v, atol=1e-10)


def test_data_go_when_nothing_else_refers_to_them(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    for _ in range(30):
        pin.rnea(model, data, *np.zeros((3, 6)))
        pin.getVelocity(model, data, 2, pin.LOCAL)
        pin.randomConfiguration(model)
        pin.computeTotalMass(model)
    gone = weakref.ref(data)
    del data
    gc.collect()
    assert gone() is None


def test_functions_look_like_functions(pin: Any) -> None:
    import inspect
    import pickle

    assert list(inspect.signature(pin.rnea).parameters)[:5] == ["model", "data", "q", "v", "a"]
    assert "Returns:" in (pin.getVelocity.__doc__ or "") and pin.getVelocity.__name__ == "getVelocity"
    assert pickle.loads(pickle.dumps(pin.rnea)) is pin.rnea


def test_a_copy_is_independent(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()
    model.referenceConfigurations["here"] = pin.neutral(model)
    twin = model.copy().copy()
    assert twin == model and str(twin) == str(model)
    twin.joints[2].setIndexes(7, 8, 9)
    twin.armature[0], twin.lowerPositionLimit[3] = 3.0, -7.0
    twin.names[1], twin.gravity.linear = "other", np.zeros(3)
    twin.inertias[1].mass, twin.frames[3].name = 99.0, "renamed"
    twin.referenceConfigurations["here"][0] = 4.0
    assert model.joints[2].id == 2 and model.armature[0] == 0.0 and model.lowerPositionLimit[3] != -7.0
    assert model.names[1] != "other" and model.gravity.linear[2] == -9.81
    assert model.inertias[1].mass != 99.0 and not model.existFrame("renamed")
    assert model.referenceConfigurations["here"][0] == 0.0
    model.jointPlacements[1].translation = np.ones(3)
    assert not np.allclose(twin.jointPlacements[1].translation, 1.0)


OF_INDICES = (
    "pin.getFrameJacobian(m, d, {}, pin.LOCAL)",
    "pin.getFrameJacobian(m, d, {}, M, pin.LOCAL)",
    "pin.getFrameVelocity(m, d, {}, pin.LOCAL)",
    "pin.getJointJacobian(m, d, {}, pin.LOCAL)",
    "pin.getVelocity(m, d, {}, pin.LOCAL)",
    "pin.computeJointJacobian(m, d, q, {})",
    "pin.computeFrameJacobian(m, d, q, {}, pin.LOCAL)",
    "pin.getFrameAccelerationDerivatives(m, d, {}, pin.LOCAL)",
    "pin.updateFramePlacement(m, d, {})",
    "pin.jointBodyRegressor(m, d, {})",
)


@pytest.mark.parametrize("call", OF_INDICES)
def test_numbers_of_other_types_are_no_indices_after_equal_ones(call: str) -> None:
    with using("pinocchio"):
        import pinocchio as pin

        m = pin.buildSampleModelManipulator()
        q, v = np.full(m.nq, 0.1), np.ones(m.nv)
        d = m.createData()
        pin.computeForwardKinematicsDerivatives(m, d, q, v, v)
        pin.computeJointJacobians(m, d, q)
        pin.rnea(m, d, q, v, v)
        names = {"pin": pin, "m": m, "d": d, "q": q, "M": pin.SE3.Random(), "np": np}
        for _ in range(12):  # bound, and in the table of repeated calls
            first = eval(call.format("1"), names)
        assert np.array_equal(np.array(eval(call.format("np.int64(1)"), names)), np.array(first))
        for wrong in ("1.0", "np.float64(1.0)", "np.True_", "np.array([1])", "1 + 0j"):
            with pytest.raises(TypeError):
                eval(call.format(wrong), names)


def _called_in_python(call: Any) -> list[str]:
    """The names of the functions of Python that run in a call."""
    names: list[str] = []
    sys.setprofile(lambda frame, event, _: names.append(frame.f_code.co_name) if event == "call" else None)
    try:
        call()
    finally:
        sys.setprofile(None)
    return names[1:]


@pytest.fixture
def bound_arm(pin: Any, compiled_at_once: None) -> tuple[Any, ...]:
    """An arm with three contacts, whose Jacobian is bound."""
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.random.default_rng(5).uniform(-1.0, 1.0, 6)
    pin.seed(5)
    models = pin.StdVec_RigidConstraintModel()
    models.extend(
        pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, k, pin.SE3.Random(), pin.LOCAL)
        for k in (3, 5, 6)
    )
    datas = pin.StdVec_RigidConstraintData()
    datas.extend(one.createData() for one in models)
    pin.forwardKinematics(model, data, q)
    for _ in range(20):
        pin.getConstraintsJacobian(model, data, models, datas)
        pin.getConstraintJacobian(model, data, models[0], datas[0])
    return model, data, q, models, datas


def _jacobian_of(pin: Any, model: Any, q: Any, models: Any) -> Any:
    """The same Jacobian from a Data that nothing is bound to."""
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    return np.vstack([pin.getConstraintJacobian(model, data, one, one.createData()) for one in models])


def test_jacobians_of_constraints_are_repeated_without_python(pin: Any, bound_arm: Any) -> None:
    from ulna.compiler.runtime.repeated_calls import RepeatedCalls

    if not isinstance(pin.getConstraintsJacobian, RepeatedCalls):
        pytest.skip("machine code cannot be called in this way here")
    model, data, _, models, datas = bound_arm
    assert not _called_in_python(lambda: pin.getConstraintsJacobian(model, data, models, datas))
    one, known = models[0], datas[0]
    assert not _called_in_python(lambda: pin.getConstraintJacobian(model, data, one, known))


def _replaced(pin: Any, model: Any, models: Any, datas: Any) -> None:
    list.__setitem__(models, 1, pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, model, 4, pin.LOCAL))
    list.__setitem__(datas, 1, models[1].createData())


def _removed(pin: Any, model: Any, models: Any, datas: Any) -> None:
    del models[0], datas[0]


def _exchanged(pin: Any, model: Any, models: Any, datas: Any) -> None:
    for entries in (models, datas):
        entries.reverse()


def _appended(pin: Any, model: Any, models: Any, datas: Any) -> None:
    models.append(pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 2, pin.LOCAL))
    datas.append(models[-1].createData())


def _moved(pin: Any, model: Any, models: Any, datas: Any) -> None:
    models[1].joint1_placement.translation[:] = 0.5, 0.25, 0.125


def _placed(pin: Any, model: Any, models: Any, datas: Any) -> None:
    models[0].joint1_placement = pin.SE3.Random()


def _turned(pin: Any, model: Any, models: Any, datas: Any) -> None:
    models[0].reference_frame = pin.LOCAL_WORLD_ALIGNED


def _carried_by_another(pin: Any, model: Any, models: Any, datas: Any) -> None:
    models[0].joint1_id = 2


def _longer(pin: Any, model: Any, models: Any, datas: Any) -> None:
    model.jointPlacements[3].translation[:] = 0.5, 0.0, 0.25


@pytest.mark.parametrize(
    "change",
    [_replaced, _removed, _exchanged, _appended, _moved, _placed, _turned, _carried_by_another, _longer],
)
def test_jacobians_of_constraints_follow_all_changes(pin: Any, bound_arm: Any, change: Any) -> None:
    model, data, q, models, datas = bound_arm
    before = pin.getConstraintsJacobian(model, data, models, datas)
    change(pin, model, models, datas)
    pin.forwardKinematics(model, data, q)
    for _ in range(20):
        wanted = _jacobian_of(pin, model, q, models)
        np.testing.assert_allclose(pin.getConstraintsJacobian(model, data, models, datas), wanted, atol=1e-12)
        first = pin.getConstraintJacobian(model, data, models[0], datas[0])
        np.testing.assert_allclose(first, wanted[: len(first)], atol=1e-12)
        q = q + 0.01
        pin.forwardKinematics(model, data, q)
    assert before.shape != wanted.shape or not np.allclose(before, wanted, atol=0.05)


def test_jacobians_of_constraints_of_a_data_of_another_model(pin: Any, bound_arm: Any) -> None:
    model, data, q, models, datas = bound_arm
    other = model.copy()
    other.jointPlacements[2].translation[:] = 0.0, 0.5, 0.0
    for m in (other, model, other):
        pin.forwardKinematics(m, data, q)
        wanted = _jacobian_of(pin, m, q, models)
        for _ in range(3):
            np.testing.assert_allclose(pin.getConstraintsJacobian(m, data, models, datas), wanted)
    with pytest.raises(InputError):
        pin.getConstraintsJacobian(model, data, models, datas[:1])


def test_lists_that_are_made_for_each_call_are_not_kept(pin: Any, bound_arm: Any) -> None:
    model, data, _, models, datas = bound_arm
    kept = []
    for _ in range(40):
        own = pin.StdVec_RigidConstraintModel()
        list.extend(own, models)
        pin.getConstraintsJacobian(model, data, own, list(datas))
        kept.append(sys.getrefcount(own))
        del own
    assert max(kept) <= 3  # the name, the argument, and the set that compares it with the next one
