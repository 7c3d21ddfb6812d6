"""Fields of a Data that follow from the tree, from the last configuration, and from the mass matrix."""

from __future__ import annotations

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
    for i in range(2, model.njoints):
        joint = data.joints[i]
        assert joint.Dinv[0] == pytest.approx(1.0 / data.D[model.joints[i].idx_v])
        np.testing.assert_allclose(joint.UDinv, joint.U * joint.Dinv)
    pin.forwardKinematics(model, data, q)
    placed = data.oMi[1]
    np.testing.assert_allclose(
        placed.toDualActionMatrix() @ data.Yaba[1], data.oYaba[1] @ placed.action, atol=1e-9
    )
    again = pickle.loads(pickle.dumps(data.joints[3]))
    np.testing.assert_array_equal(again.U, data.joints[3].U)


def test_factors_of_the_mass_matrix(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()
    data = model.createData()
    with pytest.raises(InputError, match="crba"):
        _ = data.U
    M = pin.crba(model, data, pin.neutral(model))
    np.testing.assert_allclose(data.U @ np.diag(data.D) @ data.U.T, M, atol=1e-12)
    np.testing.assert_allclose(pin.cholesky.decompose(model, data), data.U, atol=1e-11)
    assert np.array_equal(data.U, np.triu(data.U)) and (np.diag(data.U) == 1.0).all()
