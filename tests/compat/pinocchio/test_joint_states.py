"""The data of joints: what `calc` leaves, with and without Python, against the kinds themselves."""

from __future__ import annotations

import copy
import pickle
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


def _parts(pin: Any) -> list[Any]:
    """A joint of every kind, one composite and one that mimics another."""
    axis = np.array([0.6, 0.0, 0.8])
    plain = [
        *(getattr(pin, f"JointModel{kind}{x}")() for kind in ("R", "P", "RUB") for x in "XYZ"),
        *(
            getattr(pin, f"JointModel{kind}")()
            for kind in ("FreeFlyer", "Planar", "Spherical", "SphericalZYX")
        ),
        *(pin.JointModelTranslation(), pin.JointModelEllipsoid(0.1, 0.2, 0.3), pin.JointModelHX(0.2)),
        *(pin.JointModelRevoluteUnaligned(axis), pin.JointModelPrismaticUnaligned(axis)),
        *(
            pin.JointModelHelicalUnaligned(axis, 0.1),
            pin.JointModelUniversal(axis, np.array([0.0, 1.0, 0.0])),
        ),
    ]
    place = pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3]))
    composite = pin.JointModelComposite(pin.JointModelRX(), place)
    composite.addJoint(pin.JointModelSpherical(), place)
    return [*plain, composite]


def _chain(pin: Any) -> Any:
    model, parent = pin.Model(), 0
    for k, joint in enumerate(_parts(pin)):
        parent = model.addJoint(parent, joint, pin.SE3.Identity(), f"joint {k}")
    model.addJoint(parent, pin.JointModelMimic(model.joints[1], 2.0, 0.3), pin.SE3.Identity(), "mimic")
    return model


def _drawn(pin: Any, model: Any, rng: np.random.Generator) -> tuple[Any, Any]:
    q = pin.integrate(model, pin.neutral(model), rng.uniform(-1.0, 1.0, model.nv))
    return q, rng.normal(size=model.nv)


def _check(joint: Any, data: Any, q: Any, v: Any) -> None:
    kind, (first, start) = joint.kind, (max(joint.idx_q, 0), max(joint.idx_v, 0))
    _, ratio, offset = joint.mimic or (0, 1.0, 0.0)
    own, rate = q[first : first + kind.nq], v[start : start + kind.nv]
    at = ratio * own + offset if joint.mimic else own
    S = ratio * np.stack([s.vector() for s in kind.motion_subspace(at)], axis=1)
    np.testing.assert_allclose(data.M.homogeneous, kind.transform(at).matrix(), atol=1e-14)
    np.testing.assert_allclose(data.S, S[:, 0] if S.shape[1] == 1 else S, atol=1e-14)
    np.testing.assert_allclose(data.v.vector, S @ rate, atol=1e-14)
    np.testing.assert_allclose(data.c.vector, kind.bias(at, ratio * rate).vector(), atol=1e-13)
    np.testing.assert_array_equal(data.joint_q, own)
    np.testing.assert_array_equal(data.joint_v, rate)


def test_states_of_all_kinds_whether_or_not_python_runs(pin: Any) -> None:
    model, rng = _chain(pin), np.random.default_rng(7001)
    for joint in list(model.joints)[1:]:
        data = joint.createData()
        for _ in range(4):
            q, v = _drawn(pin, model, rng)
            assert joint.calc(data, q, v) is None
            _check(joint, data, q, v)
            velocity, (other, _) = data.v.vector.copy(), _drawn(pin, model, rng)
            assert joint.calc(data, other) is None
            assert (data.v.vector == velocity).all()
            np.testing.assert_array_equal(data.joint_q, other[joint.idx_q :][: joint.kind.nq])
            joint.calc(data, q, v)
            _check(joint, data, q, v)
        assert data == data.copy() == copy.copy(data) == pickle.loads(pickle.dumps(data))


def test_a_joint_that_changes_its_place_reads_other_entries(pin: Any) -> None:
    joint, q = pin.JointModelRX(), np.arange(4.0)
    joint.setIndexes(1, 2, 2)
    data = joint.createData()
    for _ in range(4):
        joint.calc(data, q, q)
    assert data.joint_q == [2.0]
    joint.setIndexes(1, 0, 1)
    for _ in range(4):
        joint.calc(data, q, q)
        assert (data.joint_q, data.joint_v) == ([0.0], [1.0])
    joint.calc(data, q[:1], np.array([5.0, 6.0]))
    assert data.joint_v == [6.0]
    with pytest.raises(InputError):
        joint.calc(data, q[:0], q)


def test_data_of_other_kinds_take_the_state_of_the_joint(pin: Any) -> None:
    joint, data = pin.JointModelSpherical(), pin.JointDataRX()
    q, v = np.array([0.0, 0.6, 0.0, 0.8]), np.ones(3)
    for _ in range(4):
        joint.calc(data, q, v)
        assert data.S.shape == (6, 3)
        _check(joint, data, q, v)


def test_what_is_read_is_a_copy_and_data_are_made_apart(pin: Any) -> None:
    joint = pin.JointModelRX()
    first, second = joint.createData(), joint.createData()
    joint.calc(first, np.array([0.5]), np.array([1.0]))
    place = first.M
    place.translation = np.ones(3)
    assert (first.M.translation == 0.0).all()
    assert second.M.isIdentity()
    assert joint.createData().M.isIdentity()


def test_live_data_are_made_once_and_show_the_last_state(pin: Any) -> None:
    model, rng = _chain(pin), np.random.default_rng(7002)
    data = model.createData()
    assert data.joints is data.joints
    for _ in range(3):
        q, v = _drawn(pin, model, rng)
        pin.forwardKinematics(model, data, q, v)
        for joint, state in zip(list(model.joints)[1:], list(data.joints)[1:], strict=True):
            _check(joint, state, q, v)
    copied, before = data.copy(), data.joints[3].M
    pin.forwardKinematics(model, data, pin.neutral(model))
    assert copied.joints is not data.joints
    assert copied.joints[3].M == before != data.joints[3].M
    data.joints[1] = copied.joints[1]
    assert data.joints[1] == copied.joints[1]
    pin.forwardKinematics(model, data, q, 2.0 * v)
    _check(model.joints[1], data.joints[1], q, 2.0 * v)
