"""Small objects answer by machine code what their Python methods answer, and take the same arguments in all forms."""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna import spatial
from ulna.errors import InputError


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _numbers(one: Any) -> Any:
    """The array that an object holds."""
    return next(getattr(one, name) for name in ("_m", "_v", "_p", "_c", "_d") if hasattr(one, name))


PARTS = {
    "SE3": {"translation": 3, "rotation": (3, 3)},
    "Motion": {"linear": 3, "angular": 3, "vector": 6},
    "Force": {"linear": 3, "angular": 3, "vector": 6},
    "Inertia": {"lever": 3, "inertia": (3, 3)},
}


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind, parts in PARTS.items() for name in parts])
def test_parts_take_arrays_of_all_layouts_and_types(pin: Any, kind: str, name: str) -> None:
    make, shape = getattr(pin, kind).Random, PARTS[kind][name]
    x = np.random.default_rng(0).normal(size=shape)
    wide = np.repeat(x, 2, axis=0)[::2]
    whole = np.arange(float(x.size)).reshape(shape)
    for value in (x, wide, np.asfortranarray(x), x[::-1].copy()[::-1], x.tolist(), np.asarray(x, ">f8")):
        one, rest = make(), None
        rest = _numbers(one).copy()
        setattr(one, name, value)
        np.testing.assert_array_equal(getattr(one, name), x)
        changed = int((_numbers(one) != rest).sum())
        assert changed == x.size  # and nothing else
    for value in (whole.astype(int), whole.astype(np.float32)):
        one = make()
        setattr(one, name, value)
        np.testing.assert_array_equal(getattr(one, name), whole)
    for wrong in (np.zeros(4), np.zeros((3, 3, 1)), "text", None, 1j * x, {}):
        before = _numbers(one).copy()
        with pytest.raises((ValueError, TypeError)):
            setattr(one, name, wrong)
        np.testing.assert_array_equal(_numbers(one), before)
    with pytest.raises(AttributeError):
        delattr(one, name)
    setattr(one, name, np.full(shape, np.nan))
    assert np.isnan(getattr(one, name)).all()


def test_parts_are_views_of_live_objects(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    at, velocity = data.oMi[3], data.v[2]
    at.translation = np.array([1.0, 2.0, 3.0])
    at.rotation = pin.exp3(np.array([0.1, 0.2, 0.3]))
    velocity.linear = data.oMi[3].translation
    assert data.oMi[3].homogeneous[:3, 3].tolist() == data.v[2].linear.tolist() == [1.0, 2.0, 3.0]
    model.inertias[2].mass = 4.0
    model.inertias[2].lever = at.translation
    assert pin.computeTotalMass(model) == pytest.approx(sum(body.mass for body in model.inertias))
    assert model.inertias[2].mass == 4.0 and type(model.inertias[2].mass) is float
    at.translation[1] = 7.0
    assert data.oMi[3].translation[1] == 7.0


def test_masses_and_coefficients_are_numbers(pin: Any) -> None:
    body, turn = pin.Inertia.Random(), pin.Quaternion(0.1, 0.2, 0.3, 0.4)
    for value in (2.0, np.float64(3.5), np.float32(1.5), 4, np.int64(7), np.array(2.5)):
        body.mass = turn.w = value
        assert body.mass == turn.w == float(value) and type(turn.w) is float
    assert [turn.x, turn.y, turn.z] == [0.2, 0.3, 0.4]
    for wrong in ("a", None, np.zeros(2), 1j):
        with pytest.raises((TypeError, ValueError)):
            body.mass = wrong
        with pytest.raises((TypeError, ValueError)):
            turn.x = wrong


def test_nearly_nothing_is_told_from_more_than_that(pin: Any) -> None:
    for name, ask in (
        ("Motion", "isZero"),
        ("Force", "isZero"),
        ("Inertia", "isZero"),
        ("SE3", "isIdentity"),
    ):
        kind = getattr(pin, name)
        one = kind.Identity() if name == "SE3" else kind.Zero()
        is_nothing = getattr(one, ask)
        assert is_nothing() is True and is_nothing(0.0) is True and is_nothing(0) is True
        numbers = _numbers(one).reshape(-1)
        for k in range(12 if name == "SE3" else numbers.size):
            kept = numbers[k]
            numbers[k] = kept - 1e-9
            assert is_nothing() is False and is_nothing(2e-9) is True and is_nothing(np.float64(2e-9)) is True
            numbers[k] = np.nan
            assert is_nothing() is False and is_nothing(1e300) is False and is_nothing(np.inf) is False
            numbers[k] = kept
        assert is_nothing() is True


def test_inertias_are_near_each_other_relative_to_their_size(pin: Any) -> None:
    one = pin.Inertia(4.0, np.array([1.0, 2.0, 3.0]), np.eye(3))
    size = math.sqrt(16.0 + 14.0 + 3.0)
    other = one.copy()
    other.mass += 1e-3
    assert one.isApprox(one) is True and one.isApprox(other) is False
    assert one.isApprox(other, 1.001e-3 / size) is True and one.isApprox(other, 0.999e-3 / size) is False
    other.mass = math.nan
    assert one.isApprox(other, 1e300) is False and other.isApprox(other) is False


def test_quotients_and_products_with_all_kinds_of_numbers(pin: Any) -> None:
    for kind in (pin.Motion, pin.Force):
        one = kind(np.arange(6.0) + 0.1)
        for factor in (3.0, 3, np.float64(3.0), np.int32(3), np.float32(3.0)):
            np.testing.assert_array_equal((one / factor).vector, (np.arange(6.0) + 0.1) / 3.0)
            np.testing.assert_array_equal((one * factor).vector, (np.arange(6.0) + 0.1) * 3.0)
            assert type(one / factor) is kind and type(one * factor) is kind
        assert np.isinf((one / 0.0).vector).all()
        total = one.copy()
        same = total
        total += one
        total -= 3.0 * one
        assert total is same and total.isApprox(-one)
        with pytest.raises((TypeError, ValueError)):
            total += np.ones(6)
        for M in (pin.SE3.Random(), pin.SE3.Identity()):
            assert one.se3Action(M) == M.act(one) and one.se3ActionInverse(M) == M.actInv(one)


def test_points_and_their_views_are_moved_and_moved_back(pin: Any) -> None:
    M, N = pin.SE3.Random(), pin.SE3.Random()
    p = N.translation
    wanted = M.rotation @ p + M.translation
    for point in (p, p.copy(), p[::-1].copy()[::-1], p.tolist(), p[:, None]):
        np.testing.assert_allclose(np.ravel(M.act(point)), wanted, rtol=1e-15, atol=1e-15)
        np.testing.assert_allclose(np.ravel(M.actInv(M.act(point))), p, rtol=1e-14, atol=1e-15)
    for wrong in (np.zeros(4), "a", 3.0):
        with pytest.raises((ValueError, TypeError)):
            M.actInv(wrong)


def test_constructors_take_the_same_in_all_forms(pin: Any) -> None:
    M = pin.SE3.Random()
    turn = pin.Quaternion(M.rotation)
    for made in (
        pin.SE3(M.homogeneous),
        pin.SE3(np.asfortranarray(M.homogeneous)),
        pin.SE3(M.homogeneous.tolist()),
        pin.SE3(turn, M.translation),
        pin.SE3(quat=turn, translation=M.translation.copy()),
        pin.SE3(turn, M.translation.tolist()),
    ):
        assert made.isApprox(M, 1e-14)
        made.translation[0] += 1.0
        assert made.homogeneous[3].tolist() == [0.0, 0.0, 0.0, 1.0]
    other = M.homogeneous
    other[3] = 7.0
    assert pin.SE3(other) == M
    assert pin.SE3() == pin.SE3.Identity() and pin.Motion() == pin.Motion.Zero() and pin.Inertia().isZero()
    for one in (pin.Motion.Random(), pin.Force.Random(), pin.Inertia.Random()):
        again = type(one)(one)
        assert again == one and not np.shares_memory(_numbers(again), _numbers(one))
    with pytest.raises((TypeError, ValueError)):
        pin.Motion(pin.Force.Random())


def test_quaternions_of_all_forms(pin: Any) -> None:
    M = pin.SE3.Random()
    turn = pin.Quaternion(M.rotation)
    x, y, z, w = turn.coeffs()
    for made in (
        pin.Quaternion(w, x, y, z),
        pin.Quaternion(turn.coeffs()),
        pin.Quaternion(turn.coeffs().tolist()),
        pin.Quaternion(turn),
        pin.Quaternion(M.rotation.copy()),
        pin.Quaternion(M.rotation.tolist()),
        pin.Quaternion(R=M.rotation),
        pin.Quaternion(pin.AngleAxis(M.rotation)),
    ):
        np.testing.assert_allclose(made.coeffs(), turn.coeffs(), atol=1e-15)
        made.x = 9.0
    assert turn.x == x and pin.Quaternion().coeffs().tolist() == [0.0, 0.0, 0.0, 1.0]
    for wrong in ("a", np.zeros(5), (1.0, 2.0)):
        with pytest.raises((ValueError, TypeError)):
            pin.Quaternion(wrong)


def test_quaternions_are_scaled_turned_back_and_compared(pin: Any) -> None:
    q, r = pin.Quaternion(1.0, 2.0, 3.0, 4.0), pin.Quaternion(pin.SE3.Random().rotation)
    assert q.norm() == pytest.approx(math.sqrt(30.0), rel=1e-15) and type(q.norm()) is float
    np.testing.assert_allclose(q.normalized().coeffs(), q.coeffs() / math.sqrt(30.0), rtol=1e-15)
    np.testing.assert_array_equal(q.conjugate().coeffs(), [-2.0, -3.0, -4.0, 1.0])
    np.testing.assert_allclose((q * q.inverse()).coeffs(), [0.0, 0.0, 0.0, 1.0], atol=1e-15)
    assert q.dot(r) == pytest.approx(float(q.coeffs() @ r.coeffs()), rel=1e-14)
    assert r.isApprox(pin.Quaternion(r)) is True and q.isApprox(r) is False and q.isApprox(r, 100.0) is True
    near = pin.Quaternion(r)
    near.w += 1e-9
    assert not r.isApprox(near) and r.isApprox(near, 1e-8)
    near.w = math.nan
    assert not near.isApprox(near)
    s = pin.Quaternion(pin.SE3.Random().rotation)
    for t in (0.25, 0, 1, np.float64(0.25)):
        np.testing.assert_allclose(
            r.slerp(t, s).coeffs(), spatial.quat_slerp(r.coeffs(), s.coeffs(), float(t)), atol=1e-15
        )


def test_angles_and_axes_of_rotations(pin: Any) -> None:
    axis = np.array([0.36, 0.48, 0.8])
    for angle in (0.0, 1e-9, 0.7, 3.1):
        R = spatial.angle_axis_to_matrix(angle, axis)
        for form in (R, np.asfortranarray(R), R.tolist()):
            turn = pin.AngleAxis(form)
            assert turn.angle == pytest.approx(angle, rel=1e-7, abs=1e-15) and type(turn.angle) is float
            np.testing.assert_allclose(turn.matrix(), R, atol=1e-14)
            assert turn.axis.flags.owndata


def test_exponentials_and_logarithms_of_quaternions_and_matrices(pin: Any) -> None:
    v = np.array([0.3, -0.2, 0.1, 0.5, 0.4, -0.7])
    M = pin.exp6(v)
    for form in (v, v.tolist(), pin.Motion(v), np.repeat(v, 2)[::2]):
        np.testing.assert_allclose(pin.exp6_quat(form), pin.SE3ToXYZQUAT(M), atol=1e-15)
    np.testing.assert_allclose(pin.exp3_quat(v[3:]), pin.Quaternion(M.rotation).coeffs(), atol=1e-15)
    for form in (M, M.homogeneous, np.asfortranarray(M.homogeneous), M.homogeneous.tolist()):
        np.testing.assert_allclose(pin.log6(form).vector, v, atol=1e-14)
    for wrong in (np.eye(3), np.zeros(6), "a"):
        with pytest.raises((ValueError, TypeError)):
            pin.log6(wrong)


def test_frames_are_made_of_all_that_they_were_made_of(pin: Any) -> None:
    M, body, kind = pin.SE3.Random(), pin.Inertia.Random(), pin.FrameType.OP_FRAME
    plain = pin.Frame("a", 1, M, kind)
    for made in (
        pin.Frame("a", 1, 0, M, kind),
        pin.Frame("a", 1, 0, M, kind, pin.Inertia.Zero()),
        pin.Frame(name="a", parent_joint=1, parent_frame=0, placement=M, type=kind),
        pin.Frame("a", np.int64(1), 0, M, kind),
        pin.Frame(plain),
        plain.copy(),
        copy.deepcopy(plain),
        pickle.loads(pickle.dumps(plain)),
    ):
        assert made == plain and made.placement is not M and made.inertia.isZero()
        made.placement.translation[0] += 1.0
        made.inertia.mass = 3.0
    assert plain.placement == M and plain.inertia.mass == 0.0
    assert pin.Frame("b", 1, M, kind).inertia.mass == 0.0  # what frames without inertia share did not change
    heavy = pin.Frame("c", 2, 3, M, kind, body)
    again = pin.Frame(heavy)
    again.inertia.mass += 1.0
    assert heavy.inertia == body and (again.parentJoint, again.parentFrame) == (2, 3)
    for wrong in (-1, 2**64, 0.5, "a", None):
        with pytest.raises((ValueError, TypeError, OverflowError)):
            pin.Frame("a", wrong, 0, M, kind)
        with pytest.raises((ValueError, TypeError, OverflowError)):
            pin.Frame("a", 1, wrong, M, kind) if wrong is not None else pin.Frame(None, 1, 0, M, kind)


def test_entries_of_lists_take_over_what_is_assigned(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    forces = pin.StdVec_Force(model.njoints, pin.Force.Zero())
    assert len({id(one) for one in forces}) == model.njoints
    one, kept = pin.Force.Random(), forces[2]
    forces[2] = one
    assert forces[2] is kept and kept == one and kept is not one
    forces[-1] = one
    one.linear = np.zeros(3)
    assert forces[-1] != one and forces[2] != one and forces[0] == pin.Force.Zero()
    forces[np.int64(1)] = kept
    assert forces[1] == kept and forces[1] is not kept
    M = pin.SE3.Random()
    data.oMi[1] = M
    data.v[1] = pin.Motion(np.arange(6.0))
    assert data.oMi[1] == M and data.oMi[1] is not M and data.v[1].vector.tolist() == list(range(6))
    for target, wrong in ((forces, pin.Motion.Random()), (forces, 3), (data.oMi, one), (data.v, one)):
        with pytest.raises((TypeError, ValueError)):
            target[1] = wrong
    for index in (100, -100):
        with pytest.raises(IndexError):
            forces[index] = one
    part = forces[1:3]
    part[0] = pin.Force.Zero()
    assert (
        type(part) is type(forces) and forces[1] == kept and part[1] is not forces[2] and part[1] == forces[2]
    )
    again = forces.copy()
    again[2] = pin.Force.Zero()
    assert forces[2] == kept and type(again) is type(forces) and len(again) == len(forces)


def test_copies_of_data_compute_what_waits(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    q, v, a = pin.neutral(model), np.ones(model.nv), np.ones(model.nv)
    pin.rnea(model, data, q, v, a)
    copies = [data.copy(), copy.copy(data), copy.deepcopy(data), data.copy().copy()]
    wanted = data.f[3].vector.copy()
    pin.rnea(model, data, q, 2.0 * v, a)
    for one in copies:
        np.testing.assert_array_equal(one.f[3].vector, wanted)
        assert not np.shares_memory(one.tau, data.tau) and type(one.M) is np.ndarray
    assert not np.allclose(data.f[3].vector, wanted)


def test_parameters_and_matrices_of_small_objects(pin: Any) -> None:
    body, v, M = pin.Inertia.Random(), pin.Motion.Random(), pin.SE3.Random()
    parameters = body.toDynamicParameters()
    I = body.matrix()[3:, 3:]
    moments = [I[0, 0], I[0, 1], I[1, 1], I[0, 2], I[1, 2], I[2, 2]]
    np.testing.assert_allclose(parameters, [body.mass, *(body.mass * body.lever), *moments], atol=1e-14)
    for form in (parameters, parameters.tolist(), np.repeat(parameters, 2)[::2]):
        assert pin.Inertia.FromDynamicParameters(form).isApprox(body, 1e-12)
    with pytest.raises(ValueError):
        pin.Inertia.FromDynamicParameters(parameters[:9])
    turn = pin.skew(v.angular)
    np.testing.assert_array_equal(v.homogeneous, np.block([[turn, v.linear[:, None]], [np.zeros((1, 4))]]))
    N = M * pin.exp6(v)
    for part in (0.25, np.float64(0.25)):
        between = pin.SE3.Interpolate(M, N, part)
        assert between.isApprox(M * pin.exp6(0.25 * pin.log6(M.inverse() * N)), 1e-10)
    assert pin.SE3.Interpolate(M, N, 0).isApprox(M, 1e-12) and pin.SE3.Interpolate(M, N, 1).isApprox(N, 1e-12)
    with pytest.raises((ValueError, TypeError)):
        pin.SE3.Interpolate(M, N, "a")


def test_lists_of_numbers_texts_and_arrays_are_copied(pin: Any) -> None:
    for entries, kind in ((["a", "b", "c"], pin.StdVec_StdString), ([1, 2, 3], pin.StdVec_Index)):
        values = kind(entries)
        assert list(values.copy()) == list(values[:]) == entries and list(values[1:]) == entries[1:]
        assert type(values.copy()) is kind
    vectors = pin.StdVec_Vector3([np.zeros(3), np.ones(3)])
    again = vectors.copy()
    again[0][:] = 7.0
    assert vectors[0].tolist() == [0.0] * 3 and again[0].tolist() == [7.0] * 3


def test_solids_are_those_that_python_makes_of_other_numbers(pin: Any) -> None:
    rng = np.random.default_rng(7004)
    for name, count in {
        "FromBox": 4,
        "FromEllipsoid": 4,
        "FromSphere": 2,
        "FromCylinder": 3,
        "FromCapsule": 3,
    }.items():
        make = getattr(pin.Inertia, name)
        for _ in range(3):
            numbers = rng.uniform(0.1, 2.0, count)
            native, plain = make(*numbers.tolist()), make(*numbers)  # numbers of NumPy
            np.testing.assert_allclose(_numbers(native), _numbers(plain), rtol=1e-14)
            assert (native.mass, native.lever.tolist()) == (numbers[0], [0.0, 0.0, 0.0])
    for name in ("FromCylinder", "FromCapsule"):
        with pytest.raises(InputError, match="radius"):
            getattr(pin.Inertia, name)(1.0, -0.1, 0.2)
        with pytest.raises(InputError):
            getattr(pin.Inertia, name)(1.0, math.nan, 0.2)
    with pytest.raises(OverflowError):
        pin.Inertia.FromBox(1.0, 1e200, 0.1, 0.1)


def test_least_rotations_between_vectors_at_all_angles(pin: Any) -> None:
    rng = np.random.default_rng(7005)
    for angle in (0.0, 1e-9, 1.0, 3.0, math.pi - 1e-3, math.pi - 1e-6, math.pi - 1e-9, math.pi):
        u, w = rng.normal(size=(2, 3))
        u /= np.linalg.norm(u)
        axis = np.cross(u, w) / np.linalg.norm(np.cross(u, w))
        v = spatial.angle_axis_to_matrix(angle, axis) @ u
        for scale in (1.0, 7.0):
            turn = pin.Quaternion.FromTwoVectors(scale * u, v)
            assert turn.norm() == pytest.approx(1.0, abs=1e-15)
            np.testing.assert_allclose(turn * u, v, atol=1e-8 if angle > 3.14 else 1e-15)
            same = pin.Quaternion().setFromTwoVectors(scale * u, v)
            np.testing.assert_allclose(turn.coeffs(), same.coeffs(), atol=1e-15)
    assert pin.Quaternion.FromTwoVectors(u, u.copy()).coeffs().tolist() == [0.0, 0.0, 0.0, 1.0]


def test_rates_of_roll_pitch_and_yaw_in_both_frames(pin: Any) -> None:
    rng = np.random.default_rng(7006)
    for _ in range(4):
        angles, rates = rng.uniform(-1.4, 1.4, 3), rng.normal(size=3)
        R, E = spatial.rpy_to_matrix(angles), spatial.rpy_rate_matrix(angles)
        for frame, wanted in (((), R.T @ E), ((pin.LOCAL,), R.T @ E), ((pin.WORLD,), E)):
            for form in (angles, angles.tolist(), np.repeat(angles, 2)[::2]):
                np.testing.assert_allclose(pin.rpy.computeRpyJacobian(form, *frame), wanted, atol=1e-15)
                inverse = pin.rpy.computeRpyJacobianInverse(form, *frame)
                np.testing.assert_allclose(inverse @ wanted, np.eye(3), atol=1e-14)
            change = pin.rpy.computeRpyJacobianTimeDerivative(angles, rates, *frame)
            ahead, back = (pin.rpy.computeRpyJacobian(angles + h * rates, *frame) for h in (1e-6, -1e-6))
            np.testing.assert_allclose(change, (ahead - back) / 2e-6, atol=1e-8)
    with pytest.raises(InputError, match="rpydot"):
        pin.rpy.computeRpyJacobianTimeDerivative(angles, rates[:2])


def test_classic_accelerations_and_logarithms_of_seven_numbers(pin: Any) -> None:
    v, a, M = pin.Motion.Random(), pin.Motion.Random(), pin.SE3.Random()
    wanted = a.linear + np.cross(v.angular, v.linear)
    np.testing.assert_allclose(pin.classicAcceleration(v, a), wanted, atol=1e-15)
    moved = pin.classicAcceleration(M.actInv(v), M.actInv(a))
    np.testing.assert_allclose(pin.classicAcceleration(v, a, M), moved, atol=1e-14)
    seven = pin.SE3ToXYZQUAT(M)
    for form in (seven, seven.tolist(), seven * [1, 1, 1, 1.005, 1.005, 1.005, 1.005]):
        np.testing.assert_allclose(pin.log6_quat(form).vector, pin.log6(M).vector, atol=1e-13)
    with pytest.raises(InputError, match="length 1"):
        pin.log6_quat(1.1 * seven)


def test_new_models_have_nothing_in_common(pin: Any) -> None:
    one, other = pin.Model(), pin.Model()
    assert one == other == pin.Model(one)
    joint = one.addJoint(0, pin.JointModelRX(), pin.SE3.Random(), "a")
    one.gravity.linear = np.ones(3)
    one.name = "changed"
    assert (joint, one.njoints, other.njoints, pin.Model().njoints) == (1, 2, 1, 1)
    assert pin.Model().gravity.linear.tolist() == other.gravity.linear.tolist() == [0.0, 0.0, -9.81]
    assert (pin.Model().name, pin.Model().nframes, len(pin.Model().referenceConfigurations)) == ("", 1, 0)


def test_geometries_made_and_copied_share_their_shape_alone(pin: Any) -> None:
    coal = pytest.importorskip("coal")
    M, ball = pin.SE3.Random(), coal.Sphere(0.1)
    quick, named = pin.GeometryObject("a", 1, M, ball), pin.GeometryObject("a", 1, ball, M)
    assert (
        quick
        == named
        == quick.copy()
        == pickle.loads(pickle.dumps(quick))
        != pin.GeometryObject("a", 2, M, ball)
    )
    assert (
        quick
        == pin.GeometryObject("a", 1, M, coal.Sphere(0.1))
        != pin.GeometryObject("a", 1, M, coal.Sphere(0.2))
    )
    assert quick.parentFrame == 2**64 - 1
    assert pin.GeometryObject("a", 1, 3, M, ball).parentFrame == 3
    copied = quick.copy()
    copied.meshColor[0], copied.physicsMaterial.elasticity = 0.5, 0.25
    copied.meshScale = np.full(3, 2.0)
    copied.placement.translation = np.zeros(3)
    assert (quick.meshColor[0], quick.physicsMaterial.elasticity, quick.meshScale.tolist()) == (
        0.9,
        0.0,
        [1.0] * 3,
    )
    assert quick.placement == M
    assert quick != copied
    assert copied.geometry is quick.geometry
    again = pickle.loads(pickle.dumps(copied))
    assert (again.meshColor[0], again.physicsMaterial.elasticity, again.meshScale.tolist()) == (
        0.5,
        0.25,
        [2.0] * 3,
    )


def test_pairs_of_geometries_are_kept_by_pickles_and_copies(pin: Any) -> None:
    pair = pin.CollisionPair(2, 5)
    assert pickle.loads(pickle.dumps(pair)) == copy.copy(pair) == pair.copy() == pin.CollisionPair(5, 2)
    pair.copy().first = 7
    assert (pair.first, pair.second) == (2, 5)
    with pytest.raises(InputError):
        pin.CollisionPair(3, 3)
    with pytest.raises(InputError):
        pair.first = -1


@pytest.mark.parametrize("name", ["Motion", "Force", "Inertia", "Symmetric3"])
def test_sums_change_the_object_itself(pin: Any, name: str) -> None:
    kind = getattr(pin, name)
    for _ in range(3):  # the first call of each makes the code
        one, other = kind.Random(), kind.Random()
        more, less, same, array = one + other, one - other, one, _numbers(one)
        one += other
        assert one is same and _numbers(one) is array and one == more
        one -= other
        assert one.isApprox(more - other) and same is one
        one = kind(less)
        one += one
        assert one.isApprox(less + less)
        one -= one
        assert one.isZero(1e-9)
    with pytest.raises(TypeError):
        one += "text"
    array.flags.writeable = False
    for _ in range(2):
        with pytest.raises(ValueError, match="read-only"):
            same += other
    nothing = kind.Zero()
    assert nothing.isZero(0.0) and nothing is not kind.Zero()


def test_factors_may_be_whole_numbers(pin: Any) -> None:
    for name in ("Motion", "Force", "Symmetric3"):
        one = getattr(pin, name).Random()
        for factor in (0, 3, -2, 10**30, 2.5, np.float64(2.5), np.int64(3), np.float32(0.5)):
            for _ in range(2):
                np.testing.assert_array_equal(_numbers(one * factor), _numbers(one) * float(factor))
                if name != "Symmetric3" and factor:
                    np.testing.assert_array_equal(np.array(factor * one), _numbers(one) * float(factor))
                    np.testing.assert_array_equal(_numbers(one / factor), _numbers(one) / float(factor))
        with pytest.raises(OverflowError):
            one * 10**400
        kept, same = getattr(pin, name)(one), one
        one *= 2
        assert one.isApprox(kept + kept) and (one is same) == (name == "Symmetric3")


def test_symmetric_matrices_are_those_of_numpy(pin: Any) -> None:
    for _ in range(3):
        S, R, v = (
            pin.Symmetric3.Random(),
            pin.SE3.Random().rotation,
            np.random.default_rng(7000).normal(size=3),
        )
        full = S.matrix()
        xx, xy, yy, xz, yz, zz = S.data
        assert full.tolist() == [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
        np.testing.assert_allclose(S * v, full @ v, rtol=1e-14, atol=1e-15)
        np.testing.assert_allclose(S * R[0], full @ R[0], rtol=1e-14, atol=1e-15)  # a view with gaps
        assert S.vtiv(v) == pytest.approx(v @ full @ v, rel=1e-13) and type(S.vtiv(v)) is float
        np.testing.assert_allclose(S.rotate(R).matrix(), R @ full @ R.T, rtol=1e-13, atol=1e-14)
        assert pin.Symmetric3(full) == S and S.isApprox(pin.Symmetric3(full)) and (-S) == S * -1.0
        assert pin.Symmetric3.Identity().matrix().tolist() == np.eye(3).tolist()
        assert copy.copy(S) == S == copy.deepcopy(S) and copy.copy(S) is not S
        assert not S.isApprox(S + pin.Symmetric3.Identity(), 1e-6) and S != S + S


def test_quaternions_change_themselves(pin: Any) -> None:
    for _ in range(3):
        one, other = pin.Quaternion(0.1, 0.2, 0.3, 0.4), pin.Quaternion(pin.SE3.Random().rotation)
        product, same = one * other, one
        one *= other
        assert one is same and one.isApprox(product)
        assert one.squaredNorm() == pytest.approx(one.norm() ** 2)
        assert one.normalize() is one and one.norm() == pytest.approx(1.0)
        assert one.assign(other) is one and one == other and one is not other
        np.testing.assert_allclose(one._transformVector(np.ones(3)), one.matrix() @ np.ones(3), rtol=1e-14)
        assert pin.Quaternion.Identity() == pin.Quaternion(1.0, 0.0, 0.0, 0.0)


def test_rotations_about_axes_are_those_of_roll_pitch_and_yaw(pin: Any) -> None:
    for k, axis in enumerate("xyz"):
        for angle in (0.3, -2, np.float64(1.5), np.float32(0.5)):
            rpy = np.zeros(3)
            rpy[k] = angle
            np.testing.assert_allclose(pin.rpy.rotate(axis, angle), pin.rpy.rpyToMatrix(rpy), atol=1e-15)
        first = pin.rpy.rotate(axis, 0.3)
        first[0, 0] = 7.0
        assert pin.rpy.rotate(axis, 0.3)[0, 0] != 7.0
