"""Fields of a Data that follow from the tree, from the last configuration, and from the mass matrix."""

from __future__ import annotations

import copy
import json
import pickle
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import both, printed
from ulna.errors import InputError


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _inertia(pin: Any, model: Any, data: Any, joints: Any, at: Any) -> Any:
    total = pin.Inertia.Zero()
    for i in joints:
        total += at.actInv(data.oMi[i]).act(model.inertias[i])
    return total.matrix()


def test_inertias_of_what_joints_move(pin: Any) -> None:
    model = pin.buildSampleModelHumanoidRandom()
    data, q = model.createData(), pin.neutral(model)
    with pytest.raises(InputError, match="crba"):
        _ = data.Ycrb
    pin.crba(model, data, q)
    local, world = data.Ycrb, data.oYcrb
    pin.forwardKinematics(model, data, q)
    for i, moved in enumerate(model.subtrees):
        if i:
            np.testing.assert_allclose(
                local[i].matrix(), _inertia(pin, model, data, moved, data.oMi[i]), atol=1e-11
            )
        wanted = _inertia(pin, model, data, moved if i else range(1, model.njoints), pin.SE3.Identity())
        np.testing.assert_allclose(world[i].matrix(), wanted, atol=1e-11)
    assert local[0].isZero() and world[0].mass == pytest.approx(pin.computeTotalMass(model))


def test_composite_inertias_are_those_of_the_last_call(pin: Any) -> None:
    model = pin.buildSampleModelHumanoidRandom()
    data, rng = model.createData(), np.random.default_rng(8)
    for k in range(14):  # the table, and the compiled kernel
        q = pin.integrate(model, pin.neutral(model), rng.standard_normal(model.nv))
        if k == 12:
            model.inertias[20] = pin.Inertia.FromBox(3.0, 0.1, 0.2, 0.3)
        pin.crba(model, data, q)
        local = data.Ycrb
        pin.forwardKinematics(model, data, q)
        for i in (1, 15, 20):
            wanted = _inertia(pin, model, data, model.subtrees[i], data.oMi[i])
            np.testing.assert_allclose(local[i].matrix(), wanted, atol=1e-10)
        kept = local[1].copy()
        pin.crba(model, data, pin.neutral(model))
        assert local[1] == kept and local[0].isZero()


def test_rows_follow_each_other_as_joints_do(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()
    data = model.createData()
    assert list(data.lastChild) == [max(moved, default=29) for moved in [[29], *list(model.subtrees)[1:]]]
    M = pin.crba(model, data, pin.neutral(model) + 0.01)
    for row, support in enumerate(data.supports_fromRow):
        assert support[-1] == row and set(np.flatnonzero(M[row, : row + 1])) <= set(support)
        assert list(support[:-1]) == (list(data.supports_fromRow[data.parents_fromRow[row]]) if row else [])
        assert data.start_idx_v_fromRow[row] <= row <= data.end_idx_v_fromRow[row]
        assert data.nvSubtree_fromRow[row] == sum(row in other for other in data.supports_fromRow)
    assert data.nvSubtree[0] == data.nvSubtree[1] == model.nv
    assert (
        list(model.span_indexes_vector[0]) == []
        and min(min(s) for s in list(model.span_indexes_vector)[1:]) == 0
    )
    with pytest.raises(Exception, match="one coordinate"):
        pin.transformJointIntoMimic(model, 0, 3, 2.0, 0.1)


def test_rows_of_mimic_joints_count(pin: Any) -> None:
    model = pin.transformJointIntoMimic(pin.buildSampleModelManipulator(), 2, 4, 1.5, 0.1)
    data = model.createData()
    assert list(data.parents_fromRow) == [-1, 0, 1, 2, 3, 4]
    assert list(data.mimic_parents_fromRow) == [-1, -1, -1, -1, 3, 3]
    assert list(data.non_mimic_parents_fromRow) == [-1, 0, 1, 2, 2, 4]
    assert list(data.idx_vExtended_to_idx_v_fromRow) == [0, 1, 2, 1, 3, 4]
    assert list(data.mimic_subtree_joint) == [5]
    pin.crba(model, data, pin.neutral(model))
    with pytest.raises(InputError, match="mimic"):
        _ = data.Yaba


def test_terms_of_the_articulated_bodies_make_accelerations(pin: Any) -> None:
    """The diagonal of the inverse mass matrix's factors: of the last joint, the first pivot of U D U^T is 1 / Dinv."""
    model = pin.buildSampleModelHumanoidRandom()
    model.armature[6:] = 0.3
    data, rng = model.createData(), np.random.default_rng(5)
    q = pin.integrate(model, pin.neutral(model), rng.standard_normal(model.nv))
    pin.crba(model, data, q)
    pin.cholesky.decompose(model, data)
    for i in range(2, model.njoints):
        joint = data.joints[i]
        assert joint.Dinv[0] == pytest.approx(1.0 / data.D[model.joints[i].idx_v])
        np.testing.assert_allclose(joint.UDinv, joint.U * joint.Dinv[0])
    pin.forwardKinematics(model, data, q)
    placed = data.oMi[1]
    np.testing.assert_allclose(
        placed.toDualActionMatrix() @ data.Yaba[1], data.oYaba[1] @ placed.action, atol=1e-9
    )
    again = pickle.loads(pickle.dumps(data.joints[3]))
    np.testing.assert_array_equal(again.U, data.joints[3].U)


@pytest.mark.parametrize("compiled", ["first", "frequent"])
def test_joints_and_their_terms_are_of_the_last_call(
    compiled: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Objects that were taken earlier show the present state, and changes of the model count from the next call on."""
    pytest.importorskip("pinocchio")
    monkeypatch.setenv("ULNA_COMPILE", compiled)
    own, wanted = both(Path(__file__).with_name("asked_live.py"), tmp_path, "15")
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-11)


def test_copies_of_joints_stay_as_they_are(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    pin.aba(model, data, q, q, q)
    joint = data.joints[3]
    held, stored, placement = joint.copy(), pickle.loads(pickle.dumps(joint)), joint.M.copy()
    other = data.copy()
    inverse = joint.Dinv.copy()
    model.inertias[4] = pin.Inertia.Random()
    pin.aba(model, data, -q, q, q)
    assert placement != joint.M and joint.Dinv != inverse
    for one in (held, stored, other.joints[3]):
        assert placement == one.M and one.Dinv == inverse
    model.joints[3].calc(joint, q)
    assert placement == joint.M


def test_data_of_joints_that_move_no_mass_are_copied(pin: Any) -> None:
    """Their terms are infinite, or nan, as there; nothing else is touched by that."""
    model = pin.Model()
    arm = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "arm")
    model.appendBodyToJoint(arm, pin.Inertia(1.0, np.full(3, 0.1), np.eye(3)), pin.SE3.Identity())
    model.addJoint(arm, pin.JointModelRY(), pin.SE3.Identity(), "massless")
    data, q = model.createData(), np.array([0.3, 0.2])
    for call in (pin.rnea, pin.forwardKinematics):
        call(model, data, q, q, q)
        for twin in (data.copy(), pickle.loads(pickle.dumps(data))):
            np.testing.assert_array_equal(twin.oMi[2].homogeneous, data.oMi[2].homogeneous)
            assert twin == data and data == twin
        assert np.isinf(data.joints[2].copy().Dinv)


def test_data_of_mimic_joints_are_copied(pin: Any) -> None:
    whole = pin.buildSampleModelManipulator()
    model = pin.transformJointIntoMimic(whole, 1, 2, 2.0, 0.1)
    data, q = model.createData(), np.linspace(0.1, 0.5, model.nq)
    pin.forwardKinematics(model, data, q, q)
    joint = data.joints[2]
    for twin in (
        joint.copy(),
        copy.deepcopy(joint),
        data.joints.copy()[2],
        pickle.loads(pickle.dumps(joint)),
    ):
        assert twin.M == joint.M and twin.v == joint.v
    with pytest.raises(InputError, match="mimic"):
        _ = joint.U


def test_copies_of_data_have_the_articulated_bodies_of_the_last_call(pin: Any) -> None:
    """Also where these are computed in the copy, after the model was changed."""
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, model.nq)
    for _ in range(3):
        pin.rnea(model, data, q, q, q)
        first = data.copy()
        second = first.copy()
        model.inertias[5] = pin.Inertia.Random()
        wanted = np.array(data.Yaba)
        pin.rnea(model, data, -q, q, q)
        for twin in (first, second):
            np.testing.assert_array_equal(np.array(twin.Yaba), wanted)


def test_pickled_data_know_the_state_of_the_last_call(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, model.nq)
    pin.forwardKinematics(model, data, q, 2.0 * q, q)
    twin = pickle.loads(pickle.dumps(data))
    for read in (pin.getFrameVelocity, pin.getFrameAcceleration):
        assert read(model, twin, 3, pin.LOCAL) == read(model, data, 3, pin.LOCAL)
    np.testing.assert_array_equal(twin.joints[2].U, data.joints[2].U)
    assert twin.joints[2].M == data.joints[2].M
    np.testing.assert_array_equal(
        pin.computeJointJacobians(model, twin), pin.computeJointJacobians(model, data)
    )


def test_pickles_of_joints_of_former_versions_are_read(pin: Any) -> None:
    joint = pin.JointModelRX()
    made = joint.createData()
    joint.calc(made, np.array([0.3]), np.array([0.4]))
    names = {
        "_M": "M",
        "_v": "v",
        "_c": "c",
        "_joint_q": "joint_q",
        "_joint_v": "joint_v",
        "_joints": "joints",
    }
    former = {names.get(name, name): value for name, value in made.__getstate__().items() if name != "_live"}
    again = object.__new__(type(made))
    again.__setstate__(former)
    assert again == made and again.M == made.M
    np.testing.assert_array_equal(again.joint_q, [0.3])


def test_factors_of_the_mass_matrix(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()
    data = model.createData()
    np.testing.assert_array_equal(data.U, np.eye(model.nv))
    assert not data.D.any()
    q = pin.neutral(model)
    M = pin.crba(model, data, q)
    assert not data.D.any()
    np.testing.assert_array_equal(pin.cholesky.decompose(model, data), data.U)
    np.testing.assert_allclose(data.U @ np.diag(data.D) @ data.U.T, M, atol=1e-12)
    assert np.array_equal(data.U, np.triu(data.U)) and (np.diag(data.U) == 1.0).all()


def test_factors_stay_until_the_next_decomposition(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, model.nq)
    M = pin.crba(model, data, q)
    pin.cholesky.decompose(model, data)
    U, D = data.U.copy(), data.D.copy()
    data.M *= 2.0
    pin.crba(model, data, 2.0 * q)
    for one in (data, data.copy(), pickle.loads(pickle.dumps(data))):
        np.testing.assert_array_equal(one.U, U)
        np.testing.assert_array_equal(one.D, D)
    with pytest.raises(AttributeError, match="U"):
        data.U = np.eye(model.nv)
    with pytest.raises(ValueError, match="read-only"):
        data.U[0, 1] = 3.0
    data.D = np.arange(6.0)
    data.D[0] = 7.0
    np.testing.assert_array_equal(data.D, [7.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    v = np.ones(model.nv)
    np.testing.assert_allclose(pin.cholesky.solve(model, data, v), np.linalg.solve(M, v), rtol=1e-9)
    pin.forwardDynamics(model, data, q, v, v, np.eye(3, model.nv), np.zeros(3), 0.0)
    np.testing.assert_allclose(data.U @ np.diag(data.D) @ data.U.T, M, atol=1e-12)
    data.D[:] = 1.0
    assert (data.D == 1.0).all()


def test_columns_of_derivatives_add_those_of_mimic_joints(pin: Any) -> None:
    def chain(coupled: bool) -> Any:
        model = pin.Model()
        first = model.addJoint(0, pin.JointModelRX(), pin.SE3(np.eye(3), np.ones(3)), "first")
        leader = model.joints[first]
        kind = pin.JointModelMimic(pin.JointModelRX(), leader, 2.0, 0.0) if coupled else pin.JointModelRX()
        second = model.addJoint(first, kind, pin.SE3(np.eye(3), np.array([0.0, 0.2, 0.1])), "second")
        for joint in (first, second):
            model.appendBodyToJoint(joint, pin.Inertia.FromSphere(1.0, 0.1), pin.SE3(np.eye(3), P))
        return model

    P, names = np.array([0.1, 0.2, -0.3]), ("dAdq", "dAdv", "dFda", "dFdq", "dFdv")
    both, one = chain(False), chain(True)
    whole, part = both.createData(), one.createData()
    q, v, a = (np.array([x]) for x in (0.3, 0.7, -0.4))
    pin.computeRNEADerivatives(one, part, q, v, a)
    pin.computeRNEADerivatives(both, whole, *(np.array([x[0], 2.0 * x[0]]) for x in (q, v, a)))
    for name in names:
        np.testing.assert_allclose(getattr(part, name), getattr(whole, name) @ [[1.0], [2.0]], atol=1e-12)
    pin.crba(one, part, q)
    pin.crba(both, whole, np.array([q[0], 2.0 * q[0]]))
    for here, there in zip(part.Fcrb, whole.Fcrb, strict=True):
        np.testing.assert_allclose(here, there @ [[1.0], [2.0]], atol=1e-12)


_DATA_OF_JOINTS = """
import json, numpy as np, pinocchio as pin
model = pin.buildSampleModelHumanoid()
data, own = model.createData(), pin.JointModelRX()
pin.aba(model, data, pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv))
composite = pin.JointModelComposite(pin.JointModelRX(), pin.SE3.Identity())
composite.addJoint(pin.JointModelRY())
found = []
for one in (own.createData(), pin.JointModel(own).createData(), model.joints[0].createData(), model.joints[2].createData(),
            model.joints[1].createData(), model.joints[2].extract().createData(), data.joints[2], data.joints[2].extract(),
            data.joints[1].extract(), composite.createData(), composite.createData().joints[1]):
    found += [type(one).__name__, one.shortname()]
    found += [list(np.shape(getattr(one, name))) for name in ("S", "U", "Dinv", "UDinv")]
print(json.dumps(found))
"""


def test_data_of_joints_of_a_model_are_of_one_class() -> None:
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_DATA_OF_JOINTS))
    assert own == wanted and len(own) == 66
