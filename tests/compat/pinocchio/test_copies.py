"""Copies of models are independent of what they were made of, and that of them, whatever is changed and when."""

from __future__ import annotations

import copy
import gc
import importlib
import pickle
import threading
import weakref
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _model(pin: Any) -> Any:
    """A humanoid with a frame that has an inertia, a named configuration, and numbers that are not the usual ones."""
    model = pin.buildSampleModelHumanoidRandom()
    body = pin.Inertia(2.0, np.array([0.1, 0.0, 0.0]), np.eye(3))
    model.addFrame(pin.Frame("box", 3, 0, pin.SE3.Random(), pin.FrameType.BODY, body))
    model.referenceConfigurations["home"] = pin.randomConfiguration(model)
    model.armature[:] = np.linspace(0.1, 0.2, model.nv)
    model.name = "humanoid"
    return model


def _inertia(pin: Any, model: Any) -> None:
    model.inertias[2].mass = 7.0


def _assigned_inertia(pin: Any, model: Any) -> None:
    model.inertias[3] = pin.Inertia.Random()


def _placement(pin: Any, model: Any) -> None:
    model.jointPlacements[4].translation[1] = 5.0


def _joint_name(pin: Any, model: Any) -> None:
    model.names[5] = "another"


def _parent(pin: Any, model: Any) -> None:
    model.parents[9] = 1


def _frame_name(pin: Any, model: Any) -> None:
    model.frames[6].name = "another frame"


def _parent_frame(pin: Any, model: Any) -> None:
    model.frames[6].parentFrame = 2


def _frame_type(pin: Any, model: Any) -> None:
    model.frames[6].type = pin.FrameType.SENSOR


def _frame_placement(pin: Any, model: Any) -> None:
    model.frames[7].placement.translation[2] = 3.0


def _frame_inertia(pin: Any, model: Any) -> None:
    model.frames[model.getFrameId("box")].inertia.mass = 9.0


def _gravity(pin: Any, model: Any) -> None:
    model.gravity.linear[0] = 1.0


def _assigned_gravity(pin: Any, model: Any) -> None:
    model.gravity = pin.Motion(np.array([0.0, 0.0, -1.6]), np.zeros(3))


def _configuration(pin: Any, model: Any) -> None:
    model.referenceConfigurations["home"][8] = 0.5


def _more_configurations(pin: Any, model: Any) -> None:
    model.referenceConfigurations["other"] = pin.neutral(model)


def _armature(pin: Any, model: Any) -> None:
    model.armature[3] = 4.0


def _limit(pin: Any, model: Any) -> None:
    model.lowerPositionLimit = np.full(model.nq, -8.0)


def _friction(pin: Any, model: Any) -> None:
    model.upperDryFrictionLimit[2] = 6.0


def _model_name(pin: Any, model: Any) -> None:
    model.name = "another model"


def _joint(pin: Any, model: Any) -> None:
    model.joints[4].setIndexes(4, 20, 20)


def _other_joint(pin: Any, model: Any) -> None:
    model.joints[4] = pin.JointModelPX()


def _more_joints(pin: Any, model: Any) -> None:
    joint = model.addJoint(2, pin.JointModelRX(), pin.SE3.Random(), "one more")
    model.addJointFrame(joint)


def _more_frames(pin: Any, model: Any) -> None:
    model.addFrame(pin.Frame("one more", 1, 0, pin.SE3.Random(), pin.FrameType.OP_FRAME))


def _fewer_frames(pin: Any, model: Any) -> None:
    model.frames.pop()


CHANGES = (
    *(_inertia, _assigned_inertia, _placement, _joint_name, _parent, _frame_name, _parent_frame, _frame_type),
    *(_frame_placement, _frame_inertia, _gravity, _assigned_gravity, _configuration, _more_configurations),
    *(_armature, _limit, _friction, _model_name, _joint, _other_joint, _more_joints, _more_frames),
    _fewer_frames,
)
WAYS: dict[str, Callable[[Any, Any], Any]] = {
    "copy": lambda pin, model: model.copy(),
    "Model": lambda pin, model: pin.Model(model),
    "copy of a copy": lambda pin, model: model.copy().copy(),
    "pickle of a copy": lambda pin, model: pickle.loads(pickle.dumps(model.copy())),
}


def _state(model: Any) -> list[Any]:
    """All that a model says of itself, copied."""
    frames = [(f.name, int(f.type), f.parentJoint, f.parentFrame) for f in model.frames]
    arrays = (
        *("lowerPositionLimit", "upperPositionLimit", "positionLimitMargin", "armature", "damping"),
        *("lowerVelocityLimit", "upperVelocityLimit", "lowerEffortLimit", "upperEffortLimit"),
        *("lowerDryFrictionLimit", "upperDryFrictionLimit", "rotorInertia", "rotorGearRatio"),
    )
    return [
        *(model.name, list(model.names), list(model.parents), frames),
        *(model.nq, model.nv, model.nvExtended, model.nbodies, model.njoints, model.nframes),
        [(j.shortname(), j.id, j.idx_q, j.idx_v, j.nq, j.nv) for j in model.joints],
        [M.homogeneous.tolist() for M in model.jointPlacements],
        [Y.matrix().tolist() for Y in model.inertias],
        [f.placement.homogeneous.tolist() for f in model.frames],
        [f.inertia.matrix().tolist() for f in model.frames],
        model.gravity.vector.tolist(),
        {name: getattr(model, name).tolist() for name in arrays},
        {name: q.tolist() for name, q in model.referenceConfigurations.items()},
    ]


def _looked_at(model: Any) -> Any:
    """The model after all of its lists and arrays were made."""
    _state(model)
    return model


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__[1:])
def test_a_change_of_one_is_not_seen_in_the_other(pin: Any, way: str, change: Any) -> None:
    """Whether the lists of either were made before or after, and whichever of the two is changed."""
    for prepare in (lambda model: model, _looked_at, lambda model: model.copy()):
        for copied_again in (False, True):
            original = prepare(_model(pin))
            if copied_again:
                original.copy()  # what is remembered for the next copy
            before = _state(original.copy())
            other = WAYS[way](pin, original)
            change(pin, other)
            assert _state(original) == before
            later = original.copy()
            assert _state(later) == before and _state(other) != before
            other = WAYS[way](pin, original)
            change(pin, original)
            assert _state(other) == before and _state(original) != before
            assert _state(original.copy()) == _state(original)


def test_what_is_referred_to_stays_live_after_a_copy(pin: Any) -> None:
    for model in (_model(pin), _model(pin).copy()):
        inertia, place, frame = model.inertias[2], model.jointPlacements[3], model.frames[4]
        gravity, armature, limits = model.gravity, model.armature, model.upperPositionLimit
        for k in range(3):
            inertia.mass, place.translation[0], frame.placement.translation[1] = 1.0 + k, 2.0 + k, 3.0 + k
            gravity.linear[1], armature[2], limits[1] = 4.0 + k, 5.0 + k, 6.0 + k
            frame.inertia.mass, frame.name = 7.0 + k, f"frame {k}"
            copied = model.copy()
            assert copied.inertias[2].mass == 1.0 + k and copied.jointPlacements[3].translation[0] == 2.0 + k
            assert (
                copied.frames[4].placement.translation[1] == 3.0 + k and copied.gravity.linear[1] == 4.0 + k
            )
            assert copied.armature[2] == 5.0 + k and copied.upperPositionLimit[1] == 6.0 + k
            assert copied.frames[4].inertia.mass == 7.0 + k and copied.frames[4].name == f"frame {k}"
            assert copied.existFrame(f"frame {k}") and not copied.existFrame(f"frame {k + 1}")


def test_joints_that_are_added_to_a_copy_count_in_its_copies(pin: Any) -> None:
    model = _model(pin).copy()
    for k in range(70):  # more than a block of rows holds
        joint = model.addJoint(1, pin.JointModelRZ(), pin.SE3.Random(), f"new {k}")
        model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Random())
        model.addJointFrame(joint)
        if k % 30 == 0:
            assert _state(model.copy()) == _state(model)
    assert _state(model.copy()) == _state(model)
    q, copied = pin.neutral(model), model.copy()
    tau = [pin.rnea(m, m.createData(), q, np.ones(m.nv), np.ones(m.nv)) for m in (model, copied)]
    assert np.allclose(*tau, rtol=1e-12, atol=1e-12)


def test_mimic_joints_of_copies(pin: Any) -> None:
    model = pin.buildSampleModelManipulator(mimic=True)
    before = _state(model)
    other = pin.transformJointIntoMimic(model, 2, 4, 0.5, 0.1)
    assert _state(model) == before and other.nq == model.nq - 1
    assert _state(other.copy()) == _state(other) and other.copy().joints[4].mimic == (2, 0.5, 0.1)


def test_parts_of_composite_joints_belong_to_one_model(pin: Any) -> None:
    joint = pin.JointModelComposite(pin.JointModelRX()).addJoint(pin.JointModelPY())
    model = pin.Model()
    model.addJoint(0, joint, pin.SE3.Identity(), "composite")
    copies = model.copy(), model.copy().copy()
    copies[0].joints[1].joints[0].setIndexes(5, 6, 7)
    copies[0].joints[1].jointPlacements[1].translation[0] = 8.0
    for other in (model, copies[1], model.copy()):
        assert other.joints[1].joints[0].id != 5 and other.joints[1].jointPlacements[1].translation[0] == 0.0
    assert copies[0].copy().joints[1].joints[0].id == 5


def test_a_model_that_becomes_another_one_leaves_copies_as_they_are(pin: Any) -> None:
    model, other = _model(pin), pin.buildSampleModelManipulator()
    copied, before = model.copy(), _state(model)
    for target in (model, model.copy()):
        target.loadFromString(other.saveToString())
        assert _state(target) == _state(other) and _state(target.copy()) == _state(other)
    assert _state(copied) == before


def test_threads_copy_one_model(pin: Any) -> None:
    """While others look at it for the first time."""
    for _ in range(10):
        model, found = _model(pin).copy(), []
        wanted, start = _state(model.copy()), threading.Barrier(6)

        def look(model: Any = model, start: threading.Barrier = start, found: list[Any] = found) -> None:
            start.wait()
            found.append(_state(model))

        def copy(model: Any = model, start: threading.Barrier = start, found: list[Any] = found) -> None:
            start.wait()
            found.extend(_state(model.copy()) for _ in range(3))

        threads = [threading.Thread(target=task) for task in (look, copy) * 3]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(found) == 12 and all(state == wanted for state in found)


def test_reduced_models_are_independent(pin: Any) -> None:
    model = _model(pin)
    q, before = pin.neutral(model), _state(model)
    reduced = pin.buildReducedModel(model, [3, 5], q)
    assert _state(model) == before
    kept = _state(reduced)
    for change in (_inertia, _placement, _frame_name, _frame_inertia, _gravity, _armature, _configuration):
        change(pin, model)
    assert _state(reduced) == kept and _state(reduced.copy()) == kept
    before = _state(model)
    reduced.inertias[1].mass, reduced.frames[2].name, reduced.names[1] = 77.0, "changed", "changed"
    reduced.joints[1].setIndexes(9, 9, 9)
    assert _state(model) == before


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__[1:])
def test_reduced_models_follow_changes(pin: Any, change: Any) -> None:
    """What is kept of the structure for the next time is not that of another model."""
    model, fresh = pin.buildSampleModelHumanoid(), pin.buildSampleModelHumanoid()
    for one in (model, fresh):
        one.addFrame(pin.Frame("box", 3, 0, pin.SE3.Identity(), pin.FrameType.BODY, pin.Inertia.Identity()))
        one.referenceConfigurations["home"] = pin.neutral(one)
    q, locked = pin.neutral(model), [7, 8]
    first = _state(pin.buildReducedModel(model, locked, q))
    assert _state(pin.buildReducedModel(model, locked, q)) == first
    for one in (model, fresh):
        pin.seed(4)
        change(pin, one)
        if one.nq != len(one.referenceConfigurations["home"]):
            one.referenceConfigurations["home"] = q = pin.neutral(one)
    changed = _state(pin.buildReducedModel(model, locked, q))
    importlib.import_module("pinocchio._algorithms.reduced_model")._KNOWN.clear()
    assert changed == _state(pin.buildReducedModel(fresh, locked, q))
    assert changed != first or change is _joint  # joints are numbered anew


def test_frames_whose_inertias_were_read_are_copied_as_they_are(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()
    frame = model.frames[3]
    first = model.copy()
    frame.inertia.mass = 2.5
    second = model.copy()
    frame.inertia.mass = 4.0
    third = model.copy()
    assert [m.frames[3].inertia.mass for m in (first, second, third)] == [0.0, 2.5, 4.0]
    assert first != second != third and third == model and model.copy() == model
    assert pickle.loads(pickle.dumps(second)) == second


def test_names_are_found_after_every_change_of_the_list(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    names = list(model.names)
    assert [model.getJointId(name) for name in names] == list(range(model.njoints))
    model.names[2] = names[4]  # now two have it
    assert model.getJointId(names[4]) == 2 and not model.existJointName(names[2])
    model.names[2] = names[2]
    assert model.getJointId(names[4]) == 4 and model.getJointId(names[2]) == 2
    added = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "another")
    assert model.getJointId("another") == added and model.copy().getJointId("another") == added
    model.frames[1].name = "changed"
    assert model.existFrame("changed") and model.getFrameId("changed") == 1


def test_data_and_copies_that_nobody_reads_go_at_once(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.zeros(6)
    pin.computeAllTerms(model, data, q, np.ones(6))
    masses = list(data.mass)
    copied = data.copy()
    again = copied.copy()
    assert list(again.mass) == masses == list(copied.mass)
    gc.disable()
    try:
        for make in (model.createData, data.copy, lambda: data.copy().copy()):
            made = make()
            pin.forwardKinematics(model, made, q)
            assert made.oMi[2] is not None and made.v[1] is not None
            gone = weakref.ref(made)
            del made
            assert gone() is None
    finally:
        gc.enable()


def test_pairs_of_copied_geometry_models_are_their_own(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    geometries = pin.buildSampleGeometryModelManipulator(model)
    geometries.addAllCollisionPairs()
    pairs = [tuple(pair) for pair in geometries.collisionPairs]
    first, second, third = geometries.copy(), pin.GeometryModel(geometries), copy.copy(geometries)
    later = first.copy()  # of one whose pairs were not asked for
    geometries.collisionPairs[0].first = 7
    geometries.collisionPairs[1] = pin.CollisionPair(6, 7)
    changed = geometries.copy()
    geometries.removeAllCollisionPairs()
    assert [tuple(pair) for pair in changed.collisionPairs] == [(7, pairs[0][1]), (6, 7), *pairs[2:]]
    for one in (first, second, third, later, pickle.loads(pickle.dumps(first.copy()))):
        assert [tuple(pair) for pair in one.collisionPairs] == pairs
        assert one.collisionPairs is one.collisionPairs
    assert first == second != changed
    first.collisionPairs[0] = pin.CollisionPair(pairs[0][1], pairs[0][0])
    assert first == second
    first.removeCollisionPair(first.collisionPairs[2])
    assert first != second and len(first.createData().activeCollisionPairs) == len(pairs) - 1
