"""Members of spatial classes, groups and geometries that Pinocchio lacks, or where it returns what was in memory."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError

DATA = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
MATRIX = np.array([[0.1, 0.2, 0.4], [0.2, 0.3, 0.5], [0.4, 0.5, 0.6]])
P, V = np.array([0.3, -0.5, 0.7]), np.array([[0, -0.7, -0.5], [0.7, 0, -0.3], [0.5, 0.3, 0]])  # V: skew(P)


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def test_symmetric_matrices(pin: Any) -> None:
    Z = pin.Symmetric3(DATA)
    np.testing.assert_array_equal(Z.matrix(), MATRIX)
    out = np.zeros((3, 3))
    Z.inverse(out)
    np.testing.assert_allclose(out @ MATRIX, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(pin.Symmetric3.vxs(P, Z), V @ MATRIX)
    np.testing.assert_allclose(pin.Symmetric3.svx(P, Z), MATRIX @ V)
    product = np.zeros(3)
    pin.Symmetric3.rhsMult(Z, P, product)
    np.testing.assert_allclose(product, MATRIX @ P)
    np.testing.assert_array_equal((-Z).matrix(), -MATRIX)
    for twin in (pickle.loads(pickle.dumps(Z)), copy.copy(Z), copy.deepcopy(Z)):
        assert twin == Z and twin is not Z
    inertia = pin.Symmetric3(np.diag([2.0, 3.0, 4.0]) + 0.1)
    root = inertia.decomposeltI()
    half = 0.5 * np.trace(inertia.matrix()) * np.eye(3) - inertia.matrix()
    np.testing.assert_allclose(np.linalg.eigvalsh(root @ root.T)[1:] > 0.0, True)
    assert np.linalg.matrix_rank(root) <= np.linalg.matrix_rank(half)


def test_inertias_of_matrices(pin: Any) -> None:
    I = pin.Inertia(2.5, P, np.diag([0.5, 0.6, 0.7]) + 0.01)
    twin = pin.Inertia(I.matrix())
    assert twin.isApprox(I)
    np.testing.assert_allclose(twin.lever, P)
    np.testing.assert_allclose(twin.inertia, I.inertia, atol=1e-12)
    massless = pin.Inertia(np.zeros((6, 6)))
    assert massless.isZero()
    np.testing.assert_array_equal(massless.lever, 0.0)
    assert np.array(I, dtype=np.float32).dtype == np.float32
    assert pin.Inertia(2.5, P, pin.Symmetric3(I.inertia)) == I
    assert not pin.Inertia(2.5, P + 1e-6, I.inertia).isApprox(I)
    assert pin.Inertia(2.5, P + 1e-6, I.inertia).isApprox(I, 1e-5)


def test_parameters_of_inertias_are_equal_by_value(pin: Any) -> None:
    I = pin.Inertia(2.5, P, np.diag([0.5, 0.6, 0.7]) + 0.01)
    pseudo = I.toPseudoInertia()
    assert pseudo == pin.PseudoInertia(pseudo.mass, pseudo.h, pseudo.sigma)
    assert pseudo != pin.PseudoInertia(pseudo.mass + 1, pseudo.h, pseudo.sigma)
    assert np.array(pseudo, dtype=np.float32).dtype == np.float32
    logarithms = (
        pin.LogCholeskyParameters.FromInertia(I)
        if hasattr(pin.LogCholeskyParameters, "FromInertia")
        else None
    )
    assert logarithms is not None
    assert logarithms.toInertia().isApprox(I)
    assert I.toLogCholeskyParameters() == logarithms
    np.testing.assert_allclose(pseudo.toLogCholeskyParameters().parameters, logarithms.parameters, atol=1e-12)
    for parameters in (pseudo, logarithms):
        for twin in (pickle.loads(pickle.dumps(parameters)), copy.copy(parameters)):
            assert twin == parameters and twin is not parameters
    logarithms.parameters = np.arange(10.0)
    np.testing.assert_array_equal(logarithms.parameters, np.arange(10.0))
    with pytest.raises(InputError, match="expected a pinocchio.Inertia"):
        pin.PseudoInertia.FromInertia(3)


def test_quaternions_and_displacements(pin: Any) -> None:
    Q = pin.Quaternion(pin.exp3(P))
    assert len(Q) == 4 and Q[-1] == Q.w == Q[3]
    with pytest.raises(IndexError):
        _ = Q[4]
    for twin in (pickle.loads(pickle.dumps(Q)), copy.copy(Q)):
        assert twin == Q and twin is not Q
    A, B = pin.SE3(pin.exp3(P), P), pin.SE3(pin.exp3(2 * P), -P)
    assert (A @ B).isApprox(A * B)
    np.testing.assert_allclose(A @ P, A.rotation @ P + P)
    np.testing.assert_allclose(A.act(P[:, None]), A.rotation @ P + P)
    np.testing.assert_allclose(A.actInv(A.act(P)), P)
    np.testing.assert_allclose(pin.utils.cross(P, [1, 2, 3]), np.cross(P, [1, 2, 3]))
    for several in (np.ones((3, 2)), np.ones((2, 2)), 1j * P):
        with pytest.raises(TypeError):
            A.act(several)


def test_groups_normalize_and_refuse_what_they_cannot_take(pin: Any) -> None:
    groups = pin.liegroups
    circle, free, column = np.array([3.0, 4.0]), np.arange(1, 8.0), np.array([[3.0], [4.0]])
    assert groups.SO2().normalize(circle) is None and groups.SE3().normalize(free) is None
    assert groups.SO2().normalize(column) is None and column.ravel().tolist() == [0.6, 0.8]
    np.testing.assert_allclose(circle, (0.6, 0.8))
    np.testing.assert_allclose(free[3:], np.arange(4, 8.0) / np.sqrt(126))
    np.testing.assert_array_equal(free[:3], (1, 2, 3))
    fixed = circle.copy()
    fixed.flags.writeable = False
    for wrong in ([3.0, 4.0], np.array([3, 4]), fixed):
        with pytest.raises(TypeError, match="be changed in place"):
            groups.SO2().normalize(wrong)
    G = groups.SE3() * groups.SO2()
    w, u, J = G.neutral, 0.1 * np.ones(7), np.ones((7, 7))
    for call in (
        lambda: G.dIntegrate_dq(w, u, J, J),
        lambda: G.dIntegrate_dq(w, u, 0, 0),
        lambda: G.dIntegrate_dq(w, u, 0, np.ones((3, 3))),
        lambda: G.dIntegrate_dv(w, u, np.ones((7, 3)), 0),
        lambda: G.dDifference(w, w, pin.ARG2),
        lambda: G.integrate(w, np.ones(3)),
        lambda: G.difference(w, np.ones(3)),
    ):
        with pytest.raises(InputError, match="expected"):
            call()
    wide, tall = np.ones((3, 7)), np.ones((7, 3))
    assert G.dIntegrate_dq(w, u, wide, 0).shape == (3, 7)
    assert G.dIntegrate_dq(w, u, 0, tall).shape == (7, 3)
    np.testing.assert_allclose(G.dIntegrate_dv(w, u, wide, 0), wide @ G.dIntegrate_dv(w, u))
    with pytest.raises(InputError, match="This Lie group is empty"):
        pin.LieGroup().normalize([])
    assert pickle.loads(pickle.dumps(G)) == G
    assert repr(groups.R3()).startswith("<LieGroup ")


def test_models_refuse_joints_and_indices_that_do_not_exist(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    q = np.zeros(6)
    for call in (
        lambda: pin.buildReducedModel(model, [0], q),
        lambda: pin.buildReducedModel(model, [99], q),
        lambda: pin.dDifference(model, q, q, pin.ARG2),
        lambda: pin.linalg.inv(np.ones((2, 3))),
        lambda: pin.computeSupportedForceByFrame(model, model.createData(), 999),
    ):
        with pytest.raises(InputError):
            call()
    assert copy.copy(model.frames[3]) == model.frames[3]
    assert model.joints[1].hasSameIndexes(model.joints[1])
    assert not model.joints[1].hasSameIndexes(model.joints[2])


def test_the_compact_tangent_map_has_room_for_joints_of_many_velocities(pin: Any) -> None:
    model, joint = pin.Model(), pin.JointModelComposite()
    for kind in [pin.JointModelRUBX] * 2 + [pin.JointModelRY] * 6:
        joint.addJoint(kind(), pin.SE3.Identity())
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "first")
    model.addJoint(1, joint, pin.SE3.Identity(), "many")
    q = pin.randomConfiguration(model)
    whole = pin.tangentMap(model, q)
    assert whole.shape == (11, 9)
    compact = pin.compactTangentMap(model, q)
    assert compact.shape == (11, 8) and compact[0].tolist() == [1.0] + [0.0] * 7
    np.testing.assert_array_equal(compact[1:], whole[1:, 1:])
