"""Products and sums of placements, motions, forces, inertias and quaternions are those of `ulna.spatial`."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import printed
from ulna import spatial


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _value(body: Any) -> spatial.Inertia:
    return spatial.Inertia(body.mass, body.lever, body.inertia)


def _same(body: Any, wanted: spatial.Inertia) -> None:
    assert body.mass == pytest.approx(wanted.mass, rel=1e-14)
    np.testing.assert_allclose(body.lever, wanted.com, atol=1e-14)
    np.testing.assert_allclose(body.inertia, wanted.inertia, atol=1e-14)


def test_inertias(pin: Any) -> None:
    pin.seed(1)
    a, b, M, v = pin.Inertia.Random(), pin.Inertia.Random(), pin.SE3.Random(), pin.Motion.Random()
    one, other, twist = _value(a), _value(b), spatial.Motion(v.linear, v.angular)
    _same(a + b, one + other)
    _same(M.act(a), M._pose().act(one))
    _same(M.actInv(a), M._pose().act_inverse(one))
    _same((a + b) - b, one)
    _same(pin.Inertia.FromDynamicParameters(a.toDynamicParameters()), one)
    np.testing.assert_allclose(a.matrix(), one.matrix(), atol=1e-15)
    np.testing.assert_allclose(a.inverse() @ a.matrix(), np.eye(6), atol=1e-11)
    np.testing.assert_allclose((a * v).vector, one.apply(twist).vector(), atol=1e-14)
    np.testing.assert_allclose(a.vxiv(v).vector, twist.cross(one.apply(twist)).vector(), atol=1e-14)
    np.testing.assert_allclose(a.variation(v), v.dualAction @ a.matrix() - a.matrix() @ v.action, atol=1e-14)
    assert a.vtiv(v) == pytest.approx(2.0 * one.kinetic_energy(twist), rel=1e-13)
    assert one.is_physical()


def test_sums_and_differences_without_mass(pin: Any) -> None:
    nothing, body = pin.Inertia.Zero(), pin.Inertia(2.0, np.ones(3), np.eye(3))
    assert (nothing + nothing).isZero() and (body - body).isZero()
    _same(nothing + body, _value(body))
    _same(body + nothing, _value(body))


def test_solid_bodies(pin: Any) -> None:
    _same(pin.Inertia.FromSphere(2.0, 0.3), spatial.Inertia.from_sphere(2.0, 0.3))
    _same(pin.Inertia.FromBox(2.0, 0.3, 0.4, 0.5), spatial.Inertia.from_box(2.0, (0.3, 0.4, 0.5)))
    _same(pin.Inertia.FromEllipsoid(2.0, 0.3, 0.4, 0.5), spatial.Inertia.from_ellipsoid(2.0, (0.3, 0.4, 0.5)))


def test_solid_bodies_of_small_whole_numbers(pin: Any) -> None:
    sizes = np.array([20, 200, 2], np.uint8)
    for make in (pin.Inertia.FromBox, pin.Inertia.FromEllipsoid):
        assert make(np.uint8(2), *sizes) == make(2.0, *sizes.astype(float))
    assert pin.Inertia.FromCylinder(np.uint8(2), *sizes[:2]) == pin.Inertia.FromCylinder(2.0, 20.0, 200.0)


def test_motions_and_quaternions(pin: Any) -> None:
    v, w, f = pin.Motion.Random(), pin.Motion.Random(), pin.Force.Random()
    np.testing.assert_allclose((v ^ w).vector, v.action @ w.vector, atol=1e-15)
    np.testing.assert_allclose(v.cross(f).vector, v.dualAction @ f.vector, atol=1e-15)
    A, B = pin.SE3.Random(), pin.SE3.Random()
    p, r = pin.Quaternion(A.rotation), pin.Quaternion(B.rotation)
    np.testing.assert_allclose((p * r).matrix(), A.rotation @ B.rotation, atol=1e-15)
    np.testing.assert_allclose(p * np.arange(3.0), A.rotation @ np.arange(3.0), atol=1e-14)
    np.testing.assert_allclose((p.inverse() * p).coeffs(), [0, 0, 0, 1], atol=1e-15)
    half = p.slerp(0.5, r)
    assert half.angularDistance(p) == pytest.approx(half.angularDistance(r), abs=1e-12)
    np.testing.assert_allclose(A * np.ones(3), A.rotation @ np.ones(3) + A.translation, atol=1e-15)


def test_nearly_equal_objects_differ_in_each_part(pin: Any) -> None:
    A = pin.SE3.Random()
    B = A.copy()
    assert A.isApprox(B) and A == B
    B.translation[2] += 1e-9
    assert not A.isApprox(B) and A.isApprox(B, 1e-6) and A != B
    v = pin.Motion(np.zeros(3), np.ones(3))
    w = v.copy()
    w.linear[0] = 1e-9
    assert v.isApprox(v.copy()) and not v.isApprox(w) and not w.isApprox(v)


def test_a_copied_model_shares_nothing(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()
    other = model.copy()
    assert other == model
    other.inertias[3].mass += 1.0
    other.jointPlacements[2].translation[0] += 1.0
    other.frames[-1].placement.translation[1] += 1.0
    other.gravity.linear[0], other.armature[3], other.lowerPositionLimit[0] = 1.0, 2.0, 3.0
    fresh = pin.buildSampleModelHumanoid()
    assert model == fresh and other != model
    assert model.inertias[3] == fresh.inertias[3] and model.frames[-1].placement == fresh.frames[-1].placement
    other.addFrame(pin.Frame("new", 1, 0, pin.SE3.Random(), pin.OP_FRAME))
    assert other.nframes == model.nframes + 1


def test_a_copied_model_is_of_the_moment_it_was_made(pin: Any) -> None:
    """Its placements, inertias and frames are objects only when they are first asked for."""
    model, fresh = pin.buildSampleModelHumanoid(), pin.buildSampleModelHumanoid()
    copies = [model.copy(), pin.Model(model), model.copy().copy()]
    for frame in model.frames:
        frame.name, frame.type, frame.parentJoint = "other", pin.FrameType.SENSOR, 0
        frame.placement, frame.inertia = pin.SE3.Random(), pin.Inertia.Random()
    for i in range(model.njoints):
        model.inertias[i], model.jointPlacements[i] = pin.Inertia.Random(), pin.SE3.Random()
    for copy in copies:
        assert copy.nframes == fresh.nframes and copy == fresh and copy != model
        q, last = pin.neutral(copy), copy.nframes - 1
        placement = copy.frames[last].placement
        assert placement is copy.frames[last].placement
        placement.translation[0] += 1.0  # a live reference, as in any other model
        moved, unmoved = (one.createData() for one in (copy, fresh))
        pin.framesForwardKinematics(copy, moved, q)
        pin.framesForwardKinematics(fresh, unmoved, q)
        assert np.isclose(moved.oMf[last].translation, unmoved.oMf[last].translation).sum() < 3
        assert copy.addJoint(1, pin.JointModelRX(), pin.SE3.Identity(), "new") == fresh.njoints
        assert copy.addJointFrame(fresh.njoints) == fresh.nframes
    with pytest.raises(AttributeError, match="no attribute 'unknown'"):
        _ = copies[0].unknown


def test_threads_that_ask_a_copy_for_its_frames_get_the_same_ones(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()
    for _ in range(20):
        copy, start, found = model.copy(), threading.Barrier(4), []

        def ask(copy: Any = copy, start: threading.Barrier = start, found: list[Any] = found) -> None:
            start.wait()
            found.append((copy.frames, copy.inertias, copy.jointPlacements))

        threads = [threading.Thread(target=ask) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(found) == 4 and all(a is b for each in found for a, b in zip(each, found[0], strict=True))


def test_random_configurations_follow_limits_that_change(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    for low, high in ((-0.2, 0.2), (1.0, 1.5)):
        model.lowerPositionLimit[:], model.upperPositionLimit = low, np.full(model.nq, high)
        drawn = np.array([pin.randomConfiguration(model) for _ in range(100)])
        assert drawn.min() >= low and drawn.max() <= high and np.ptp(drawn) > 0.8 * (high - low)
    model.lowerPositionLimit[2] = 2.0
    with pytest.raises(ValueError, match="a lower limit is above the upper one"):
        pin.randomConfiguration(model)
    model.addJoint(6, pin.JointModelRX(), pin.SE3.Identity(), "one more")
    model.lowerPositionLimit[2] = 1.0
    assert pin.randomConfiguration(model).shape == (7,)


def test_random_configurations_follow_the_seed(pin: Any) -> None:
    """Numbers are drawn for many configurations at once; a seed starts them anew for every model."""
    model, other = pin.buildSampleModelHumanoid(), pin.buildSampleModelManipulator()
    low, high = np.full(model.nq, -2.0), np.full(model.nq, 2.0)

    def drawn() -> tuple[np.ndarray, np.ndarray]:
        pairs = [
            (pin.randomConfiguration(model, low, high), pin.randomConfiguration(other)) for _ in range(150)
        ]
        return np.array([a for a, _ in pairs]), np.array([b for _, b in pairs])

    pin.seed(7)
    first = drawn()
    pin.seed(7)
    again = drawn()
    pin.seed(8)
    third = drawn()
    for a, b, c in zip(first, again, third, strict=True):
        assert np.array_equal(a, b) and not np.isclose(a, c).all()
        assert len({row.tobytes() for row in a}) == len(a)  # no configuration comes twice
    assert len({row.tobytes() for row in (pin.randomConfiguration(m) for m in (other, other.copy()))}) == 2
    assert np.allclose(np.linalg.norm(first[0][:, 3:7], axis=1), 1.0)
    assert abs(first[0][:, 7:]).max() <= 2.0 and np.allclose(first[0][:, 7:].mean(), 0.0, atol=0.1)


def test_copies_of_frames_have_independent_inertias(pin: Any) -> None:
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "joint")
    body = pin.Inertia(2.0, np.array([0.1, 0.0, 0.0]), np.eye(3))
    place = model.addFrame(pin.Frame("body", joint, 0, pin.SE3.Identity(), pin.FrameType.BODY, body))
    copies = [model.copy() for _ in range(2)]
    copies.append(copies[0].copy())
    copies[0].frames[place].inertia.mass = 5.0
    copies[1].frames[place].inertia = pin.Inertia.Zero()
    assert [m.frames[place].inertia.mass for m in (model, *copies)] == [2.0, 5.0, 0.0, 2.0]
    kept = copies[0].frames[place].inertia
    assert copies[0].copy().frames[place].inertia.mass == 5.0 and copies[0].frames[place].inertia is kept
    count = copies[0]._frame_changes[0]
    copies[0].frames[place].name = "renamed"
    assert (
        copies[0]._frame_changes[0] > count and copies[0].existFrame("renamed") and model.existFrame("body")
    )


def test_overloads_that_are_known_choose_as_at_first(pin: Any) -> None:
    """Calls with arguments of the same types, but other dimensions or values, lead to their own overloads."""
    from pinocchio._containers.keywords import overloads

    @overloads("a:matrix b?", "a:list c:bool?", "a d:int e?>b")
    def called(a: Any = None, b: Any = "no b", c: Any = "no c", d: Any = "no d") -> Any:
        return np.ndim(a), b, c, d

    line, square = np.ones(3), np.eye(3)
    cases = (
        ((square,), (2, "no b", "no c", "no d")),
        ((square, 2.0), (2, 2.0, "no c", "no d")),
        (([1.0], True), (1, "no b", True, "no d")),
        (([1.0], 1), (1, "no b", 1, "no d")),
        (([[1.0]], 1), (2, 1, "no c", "no d")),
        (([1.0], 3), (1, "no b", "no c", 3)),
        ((line, 3), (1, "no b", "no c", 3)),
        ((line, 3, 4.0), (1, 4.0, "no c", 3)),
        ((line, 3, None), (1, "no b", "no c", 3)),
    )
    for _ in range(3):
        for arguments, wanted in cases:
            assert called(*arguments) == wanted
            assert called(*arguments) == wanted
        with pytest.raises(TypeError, match="expected .*called"):
            called(line)
        with pytest.raises(TypeError, match="expected .*called"):
            called(line, 0.5)
        assert called(square, b=5) == (2, 5, "no c", "no d") and called(line, e=4, d=2) == (1, 4, "no c", 2)


def test_overloads_of_functions_that_take_names_alone(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), pin.neutral(model)
    J = [pin.jacobianCenterOfMass(model, data, q, False) for _ in range(3)]
    assert J[0].shape == (3, 6) and np.array_equal(J[0], J[2])
    assert np.array_equal(pin.jacobianCenterOfMass(model, data, q), pin.jacobianCenterOfMass(model, data, q))


def test_checks_of_arguments_look_at_values_that_types_do_not_decide(pin: Any) -> None:
    from pinocchio._containers.arguments import ArgumentError, checked

    def plain(flag: bool, size: float, name: str = "", place: Any = None) -> Any:
        return flag, size, name, place

    called: Any = checked(plain)

    for _ in range(2):
        assert called(1, np.float64(2.0)) == (1, 2.0, "", None) and called(True, 2, "a") == (
            True,
            2,
            "a",
            None,
        )
        for wrong in ((2, 1.0), (True, "1"), (True, np.ones(2)), (True, 1.0, 3), (0.5, 1.0), ("", 1.0)):
            with pytest.raises(ArgumentError):
                called(*wrong)
        assert called(0, 1.0) == (0, 1.0, "", None) and called(True, size=np.array(1.5))[1] == 1.5


def test_views_lists_and_exact_arrays_make_the_same_objects(pin: Any) -> None:
    pin.seed(3)
    M = pin.SE3.Random()
    R, p = M.rotation, M.translation  # views with gaps
    forms = [(R, p), (R.copy(), p.copy()), (R.tolist(), p.tolist()), (np.asfortranarray(R), p[:, None])]
    for rotation, translation in forms:
        assert pin.SE3(rotation, translation) == M
        np.testing.assert_array_equal(pin.Motion(translation, translation).vector, np.tile(p, 2))
        np.testing.assert_array_equal(pin.log3(rotation), pin.log3(R.copy()))
        np.testing.assert_array_equal(pin.rpy.matrixToRpy(rotation), pin.rpy.matrixToRpy(R.copy()))
        np.testing.assert_array_equal(pin.Quaternion(rotation).coeffs(), pin.Quaternion(R.copy()).coeffs())
        np.testing.assert_array_equal(pin.skew(translation), pin.skew(p.copy()))
    S = np.eye(4)[:3, :3] + 0.1  # symmetric, a view with gaps
    for moments, lever in ((S, p), (S.copy(), p.copy()), (S.tolist(), p.tolist()), (np.asfortranarray(S), p)):
        assert pin.Inertia(2.0, lever, moments) == pin.Inertia(2, p.copy(), S.copy())
    made = pin.SE3(forms[1][0], forms[1][1])
    made.rotation[0, 0] = 7.0
    assert forms[1][0][0, 0] == M.rotation[0, 0]  # a copy
    assert pin.XYZQUATToSE3(pin.SE3ToXYZQUAT(M)).isApprox(M)
    assert pin.XYZQUATToSE3(list(pin.SE3ToXYZQUATtuple(M))).isApprox(M)
    for wrong in (np.eye(2), np.eye(3)[None], np.zeros(3), "a"):
        with pytest.raises((ValueError, TypeError)):
            pin.SE3(wrong, p)


def test_nearness_is_relative_and_nan_is_near_nothing(pin: Any) -> None:
    a = pin.Motion(np.array([1.0, 0.0, 0.0]), np.array([0.0, 2.0, 0.0]))
    assert a.isApprox(-a, 2.0) and not a.isApprox(-a, 1.999)
    assert pin.Motion.Zero().isApprox(pin.Motion.Zero(), 0) and not a.isApprox(pin.Motion.Zero())
    b = a.copy()
    b.linear[0] = np.nan
    assert not b.isApprox(b, 1e300) and not a.isApprox(b, 1e300)
    M, N = pin.SE3.Identity(), pin.SE3.Identity()
    N.translation = np.array([0.0, 0.0, 1e-13])
    assert M.isApprox(M) and not M.isApprox(N) and N.isApprox(N)
    assert type(M.isApprox(N)) is bool


def test_random_objects_are_independent(pin: Any) -> None:
    for make in (pin.SE3.Random, pin.Motion.Random, pin.Inertia.Random):
        pin.seed(5)
        first = [make() for _ in range(200)]
        pin.seed(5)
        assert [make() for _ in range(200)] == first
        assert len({str(x) for x in first}) == 200
        kept = str(first[1])
        first[0].setZero() if hasattr(first[0], "setZero") else first[0].setIdentity()
        assert str(first[1]) == kept
    draws = np.array([pin.Motion.Random().vector for _ in range(400)])
    assert np.abs(draws).max() < 1.0 and np.abs(draws.mean(axis=0)).max() < 0.2


def test_joints_and_frames_are_added_to_a_model_that_changes(pin: Any) -> None:
    model = pin.Model()
    for k in range(3):
        low = np.array([-1.0 - k])
        joint = model.addJoint(k, pin.JointModelRX(), pin.SE3.Random(), f"j{k}", low + 9.0, -low, low, -low)
        low[0] = 100.0  # what was given was copied
        frame = model.addJointFrame(joint, -1)
        assert model.frames[frame].parentFrame == (0 if k == 0 else model.getFrameId(f"j{k - 1}"))
        model.addBodyFrame(f"b{k}", joint, pin.SE3.Identity(), -1)
        if k == 1:
            model.lowerPositionLimit[0] = -7.0
    np.testing.assert_array_equal(model.lowerPositionLimit, [-7.0, -2.0, -3.0])
    np.testing.assert_array_equal(model.upperEffortLimit, [8.0, 7.0, 6.0])
    np.testing.assert_array_equal(model.lowerEffortLimit, [-8.0, -7.0, -6.0])
    assert model.armature.tolist() == [0.0] * 3 and model.rotorGearRatio.tolist() == [1.0] * 3
    with pytest.raises(ValueError, match="lowerPositionLimit"):
        model.addJoint(3, pin.JointModelRX(), pin.SE3(), "j3", *([np.ones(1)] * 2), np.ones(2), np.ones(1))
    assert (model.nq, model.njoints, len(model.lowerPositionLimit)) == (3, 4, 3)
    model.frames[2].name = "renamed"
    assert model.getFrameId("renamed") == 2 and not model.existFrame("b0")
    model.frames[3].type = pin.FrameType.OP_FRAME
    assert model.existFrame("j1", pin.FrameType.OP_FRAME) and not model.existFrame("j1", pin.FrameType.JOINT)
    assert len({id(model.frames[k].inertia) for k in range(1, 7)}) == 6


def test_enumerations_have_names_and_values(pin: Any) -> None:
    assert pin.ReferenceFrame.names["LOCAL"] is pin.LOCAL is pin.ReferenceFrame.values[1]
    assert sorted(pin.FrameType.values) == [1, 2, 4, 8, 16]
    assert pin.ContactType.names["CONTACT_6D"] is pin.ContactType.CONTACT_6D


@pytest.mark.parametrize("mass", [1.0, 1])
def test_what_is_no_inertia_is_refused(pin: Any, mass: float) -> None:
    for wrong in (
        np.diag([1.0, -1.0, 1.0]),
        np.array([[1.0, 0.2, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        np.full((3, 3), np.nan),
    ):
        with pytest.raises(RuntimeError, match="symmetric matrix"):
            pin.Inertia(mass, np.zeros(3), wrong)
    tilted = np.array([[1.0, 0.2, 0.0], [0.2 + 1e-16, 1.0, 0.0], [0.0, 0.0, 0.0]])
    for right in (np.zeros((3, 3)), tilted, 1e-9 * tilted, [[1, 0, 0], [0, 1, 0], [0, 0, 1]]):
        np.testing.assert_array_equal(pin.Inertia(mass, np.zeros(3), right).inertia, right)


WRONG_OPERANDS = (
    *(
        "inertia - motion",
        "inertia - None",
        "motion / 'a'",
        "force / force",
    ),
    *("quaternion + np.eye(4)", "np.float64(0.5) * quaternion", "np.eye(4) @ quaternion", "quaternion / 2.0"),
    *("symmetric + np.ones(6)", "symmetric - 'a'", "placement + np.ones(3)", "motion * 1j", "symmetric * 1j"),
)


@pytest.mark.parametrize("text", WRONG_OPERANDS)
def test_operators_refuse_what_pinocchio_refuses(pin: Any, text: str) -> None:
    names = {
        "inertia": pin.Inertia.Random(),
        "motion": pin.Motion.Random(),
        "force": pin.Force.Random(),
        "np": np,
    }
    names |= {"quaternion": pin.Quaternion(pin.SE3.Random().rotation), "placement": pin.SE3.Random()}
    names["symmetric"] = pin.Symmetric3(np.eye(3))
    with pytest.raises((TypeError, ValueError)):
        eval(text, names)


def test_lists_copy_what_is_added(pin: Any) -> None:
    for kind, entry in ((pin.StdVec_SE3, pin.SE3.Random()), (pin.StdVec_Force, pin.Force.Random())):
        entries = kind()
        entries.append(entry)
        entries.extend([entry])
        assert entries[0] == entries[1] == entry
        assert entries[0] is not entry and entries[1] is not entry
    arrays = pin.StdVec_Vector3()
    row = np.ones(3)
    arrays.append(row)
    row[:] = 0.0
    assert np.array_equal(arrays[0], np.ones(3))
    model = pin.buildSampleModelManipulator()
    frame = pin.Frame("added", 1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)
    model.frames.append(frame)
    frame.name = "changed"
    assert model.frames[-1].name == "added" and model.existFrame("added")


def test_names_that_are_appended_are_no_joints(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()

    def lists() -> list[list[list[int]]]:
        return [[list(row) for row in rows] for rows in (model.children, model.subtrees, model.supports)]

    before = lists()
    model.names.append("more")
    assert model.njoints == 7
    assert lists() == before


def test_configurations_without_length_stay_as_they_are(pin: Any) -> None:
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "free")
    model.addJoint(joint, pin.JointModelRUBX(), pin.SE3.Identity(), "turn")
    q = np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 3.0, 4.0])
    assert np.allclose(pin.normalize(model, q), [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.6, 0.8], atol=1e-15)
    q[3:7] = 0.0, 0.0, 0.0, -2.0
    assert np.allclose(pin.normalize(model, q)[3:7], [0.0, 0.0, 0.0, -1.0], atol=1e-15)


@pytest.mark.parametrize("position", [True, False, 0, 1, 1.0, None, "ARG0"])
def test_numbers_are_no_positions_of_arguments(pin: Any, position: Any) -> None:
    model = pin.buildSampleModelManipulator()
    q, v = pin.neutral(model), np.ones(6)
    group = pin.liegroups.SE3()
    for call in (
        lambda: pin.dIntegrate(model, q, v, position),
        lambda: pin.dDifference(model, q, q, position),
        lambda: pin.dIntegrateTransport(model, q, v, np.eye(6), position),
        lambda: group.dDifference(group.neutral, group.neutral, position),
    ):
        with pytest.raises(TypeError, match="ARG0|argument"):
            call()


def test_lists_of_one_kind_take_no_other(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    for entries, wrong in (
        (data.oMi, pin.Motion.Random()),
        (data.v, 3),
        (model.names, 3),
        (model.frames, pin.SE3()),
    ):
        count = len(entries)
        with pytest.raises(TypeError):
            entries.append(wrong)
        with pytest.raises(TypeError):
            entries.extend([wrong])
        assert len(entries) == count


def test_direct_calls_are_those_of_the_methods(pin: Any) -> None:
    A, B, x, y, Y = (
        pin.SE3.Random(),
        pin.SE3.Random(),
        pin.Motion.Random(),
        pin.Force.Random(),
        pin.Inertia.Random(),
    )
    point, turn = np.array([0.1, 0.2, 0.3]), pin.Quaternion(A.rotation)
    for _ in range(2):  # the second time without Python
        pairs = [
            (A * B, A.act(M=B)), (A * point, A.act(point=point)), (A.act(x), A.act(motion=x)),
            (A.act(Y), A.act(inertia=Y)), (A.actInv(y), A.actInv(force=y)), (x.cross(y), x.cross(f=y)),
            (x.dot(y), y.dot(x)), (x * 2.0, x * 2), (Y * x, pin.Force(Y.matrix() @ x.vector)),
            (turn * point, A.rotation @ point), (pin.skew(point), pin.skew([0.1, 0.2, 0.3])),
            (pin.log3(A.rotation), pin.log3(A.rotation.copy())), (pin.exp6(x), pin.exp6(x.vector)),
            (pin.rpy.rpyToMatrix(0.1, 0.2, 0.3), pin.rpy.rpyToMatrix(point)),
        ]  # fmt: skip
        for found, wanted in pairs:
            assert type(found) is type(wanted)
            np.testing.assert_allclose(*[_numbers_of(item) for item in (found, wanted)], atol=1e-13)


def _numbers_of(item: Any) -> Any:
    return next((getattr(item, slot) for slot in ("_m", "_v", "_p") if hasattr(item, slot)), item)


def test_equality_is_that_of_all_numbers(pin: Any) -> None:
    for kind in (pin.SE3, pin.Motion, pin.Force, pin.Inertia):
        a = kind.Random()
        for _ in range(2):
            assert a == a.copy() and a != kind.Random() and a != "text"
        values = _numbers_of(a)
        values.flat[3] = np.inf
        assert a == a.copy()
        values.flat[3] = np.nan
        assert a != a.copy()
    tiny = pin.Motion(np.array([5e-324, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert tiny != pin.Motion.Zero() and tiny == tiny.copy()


def test_copies_and_constants_are_new(pin: Any) -> None:
    for make in (pin.SE3.Identity, pin.Motion.Zero, pin.Force.Zero, pin.Inertia.Zero, pin.SE3.Random):
        one, other = make(), make()
        copied = one.copy()
        changed = [x for x in (one, copied, other) if x is not one]
        one.setRandom()
        assert all(x != one for x in changed)
    M = pin.SE3.Random()
    block = M.homogeneous
    block[:] = 0.0
    assert pin.SE3(block) != M


def test_places_far_away_are_subtracted_before_they_are_turned(pin: Any) -> None:
    R = pin.exp3(np.array([0.3, -0.2, 0.5]))
    at, other = np.array([1e6, -2e6, 3e6]), np.array([1e6 + 0.125, -2e6, 3e6 + 0.25])
    A, B = pin.SE3(R, at), pin.SE3(R, other)
    wanted = R.T @ (other - at)
    np.testing.assert_allclose(A.actInv(B).translation, wanted, rtol=0, atol=1e-15)
    np.testing.assert_allclose(A.actInv(other), wanted, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(A.actInv(A).translation, 0.0)


_WITH_ARRAYS = """
import json, operator, numpy as np, pinocchio as pin
model = pin.buildSampleModelManipulator()
turn = pin.AngleAxis(0.3, np.array([0.0, 0.0, 1.0]))
objects = pin.Symmetric3(np.eye(3)), turn, pin.Quaternion(turn.matrix())
found = [str(one * np.zeros(0)) for one in objects] + [str(operator.imul(turn, np.zeros(0)))]
named = model.referenceConfigurations
texts = ("np.asarray(named)", "named + np.float64(2.0)", "np.float64(2.0) - named", "named == np.float64(2.0)",
         "np.array([named, named])", "np.zeros(0) + named", "np.arange(3) + named", "named + 1.0", "len(named)")
for postures in ({}, {"b": np.arange(6.0), "a": np.ones((6, 1))}):
    for name, q in postures.items():
        named[name] = q
    for text in texts:
        try:
            value = eval(text)
            found.append([str(np.shape(value)), str(getattr(value, "dtype", "")), str(value)])
        except Exception as error:
            found.append(type(error).__name__)
    found += [named[name].tolist() for name in postures]
print(json.dumps(found))
"""


def test_arrays_and_objects_meet_as_in_pinocchio() -> None:
    """A product with an array without entries is empty; named configurations are a sequence of pairs for NumPy."""
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_WITH_ARRAYS))
    assert len(own) == len(wanted) == 4 + 2 * 9 + 2
    assert own == wanted


def test_checks_of_arguments_look_for_no_names_in_a_data(pin: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """That search, for the message of a name that is missing, takes milliseconds."""
    from pinocchio._data import data as module

    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    pin.forwardKinematics(model, data, q, q)
    searched: list[str] = []
    monkeypatch.setattr(module, "missing_field_message", lambda name, _: searched.append(name) or name)
    for call in (
        pin.computeKineticEnergy,
        pin.computePotentialEnergy,
        pin.centerOfMass,
        pin.computeJointJacobians,
    ):
        call(model, data)
    assert not searched
    assert not hasattr(data, "oMj")
    assert searched == ["oMj"]
