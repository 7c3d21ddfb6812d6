"""Where Pinocchio crashes, or goes on with nonsense, Ulna's package says what is wrong; lists and mimic joints work."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError, ModelError, ShapeError, UnknownName

ARM = """
<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><mass value="2"/><origin xyz="0 0 0.2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.02"/></inertial></link>
  <link name="lower"><inertial><mass value="1"/><origin xyz="0 0 0.1"/>
    <inertia ixx="0.05" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.01"/></inertial></link>
  <link name="hand"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="50"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="50"/><mimic joint="shoulder" multiplier="-2" offset="0.1"/></joint>
  <joint name="wrist" type="fixed"><parent link="lower"/><child link="hand"/><origin xyz="0 0 0.3"/></joint>
</robot>"""


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _arm(pin: Any, mimic: bool = False) -> Any:
    return pin.buildModelFromXML(ARM, mimic=mimic)


def test_unknown_names_offer_the_nearest(pin: Any) -> None:
    model = _arm(pin)
    data, q = model.createData(), pin.neutral(model)
    joint, frame, body = model.getJointId("elbo"), model.getFrameId("hnad"), model.getBodyId("hnad")
    assert (joint, frame, body) == (model.njoints, model.nframes, model.nframes)  # as in Pinocchio
    assert not frame < model.nframes and not model.existFrame("hnad")
    pin.computeJointJacobians(model, data, q)
    uses = [
        ("elbow", lambda: pin.getJointJacobian(model, data, joint, pin.LOCAL)),
        ("elbow", lambda: pin.computeJointJacobian(model, data, q, joint)),
        ("elbow", lambda: model.addJoint(joint, pin.JointModelRX(), pin.SE3.Identity(), "more")),
        ("hand", lambda: pin.computeFrameJacobian(model, data, q, frame)),
        ("hand", lambda: pin.getFrameVelocity(model, data, body)),
        ("hand", lambda: pin.updateFramePlacement(model, data, frame)),
    ]
    for nearest, use in uses:
        with pytest.raises(UnknownName, match=f"Did you mean '{nearest}'") as caught:
            use()
        assert isinstance(caught.value, IndexError) and isinstance(caught.value, InputError)
    geometries = pin.GeometryModel()
    geometries.addGeometryObject(pin.GeometryObject("ball", 0, pin.SE3.Identity(), pin.coal.Sphere(0.1)))
    missing = geometries.getGeometryId("bal")
    assert missing == geometries.ngeoms == 1
    with pytest.raises(UnknownName, match="'ball'"):
        pin.CollisionPair(0, missing)


def test_a_name_that_a_body_and_a_joint_share_needs_the_type(pin: Any) -> None:
    """As in Pinocchio, which raises ValueError too."""
    model = _arm(pin)
    other = model.frames[model.getFrameId("hand")].copy()
    other.type = pin.FrameType.OP_FRAME
    added = model.addFrame(other)
    with pytest.raises(ValueError, match=r"2 frames are named 'hand'.*FrameType.BODY, FrameType.OP_FRAME"):
        model.getFrameId("hand")
    assert model.getFrameId("hand", pin.FrameType.OP_FRAME) == added


def test_indices_that_do_not_exist_are_refused(pin: Any) -> None:
    model = _arm(pin)
    data, q, v = model.createData(), [0.1, 0.2], [0.3, 0.4]
    pin.forwardKinematics(model, data, q, v, v)
    pin.computeJointJacobians(model, data, q)
    for call in (
        lambda: pin.updateFramePlacement(model, data, 999),
        lambda: pin.getVelocity(model, data, 10**7),
        lambda: pin.getFrameVelocity(model, data, model.nframes),
        lambda: pin.computeJointJacobian(model, data, q, -1),
        lambda: pin.getJointJacobian(model, data, 999, pin.LOCAL),
        lambda: pin.computeFrameJacobian(model, data, q, 999),
    ):
        with pytest.raises(InputError, match=r"expected 0 to .* returns one"):
            call()
    with pytest.raises(InputError, match="LOCAL, WORLD"):
        pin.getJointJacobian(model, data, 1, 0)


def test_data_made_before_the_model_grew_is_refused(pin: Any) -> None:
    model = _arm(pin)
    data = model.createData()
    model.addFrame(pin.Frame("grip", 2, 0, pin.SE3.Random(), pin.OP_FRAME))
    pin.forwardKinematics(model, data, [0.0, 0.0])  # knows nothing of frames
    with pytest.raises(InputError, match="createData"):
        pin.framesForwardKinematics(model, data, [0.0, 0.0])
    with pytest.raises(InputError, match="createData"):
        pin.updateFramePlacements(model, data)
    model.addJoint(2, pin.JointModelRX(), pin.SE3(), "thumb")
    with pytest.raises(InputError, match="createData"):
        pin.forwardKinematics(model, data, [0.0, 0.0, 0.0])


def test_what_was_never_computed_is_not_answered(pin: Any) -> None:
    model = _arm(pin)
    data = model.createData()
    with pytest.raises(InputError, match="computeJointJacobians"):
        pin.getFrameJacobian(model, data, 1, pin.LOCAL)
    with pytest.raises(InputError, match="forwardKinematics"):
        pin.getVelocity(model, data, 1)


def test_wrong_sizes_and_words_are_named(pin: Any) -> None:
    model = _arm(pin)
    data = model.createData()
    with pytest.raises(ShapeError, match=r"`q` has shape \(3,\); expected \(2,\)"):
        pin.forwardKinematics(model, data, np.zeros(3))
    with pytest.raises(InputError, match="one for each joint"):
        pin.rnea(model, data, [0, 0], [0, 0], [0, 0], [pin.Force()])
    with pytest.raises(ModelError, match="already"):
        model.addJoint(0, pin.JointModelRX(), pin.SE3(), "elbow")
    with pytest.raises(AttributeError, match="compile"):
        _ = pin.casadi


def test_lists_columns_and_integers_are_configurations(pin: Any) -> None:
    model = _arm(pin)
    data = model.createData()
    wanted = pin.rnea(model, data, np.array([1.0, 2.0]), np.zeros(2), np.ones(2))
    for q in ([1, 2], (1, 2), np.array([[1.0], [2.0]]), np.array([1, 2], dtype=np.float32)):
        np.testing.assert_array_equal(pin.rnea(model, data, q, [0, 0], [1, 1]), wanted)


def test_references_are_live(pin: Any) -> None:
    model = _arm(pin)
    data, q = model.createData(), [0.1, 0.2]
    tip, place = data.oMi[2], model.jointPlacements[2]
    pin.forwardKinematics(model, data, q)
    before = tip.copy()
    place.translation[2] += 0.1
    pin.forwardKinematics(model, data, q)
    assert tip is data.oMi[2]
    assert np.linalg.norm(tip.translation - before.translation) == pytest.approx(0.1)
    torque = pin.computeGeneralizedGravity(model, data, q)
    model.inertias[2].mass *= 2.0
    model.inertias[1].mass *= 2.0
    np.testing.assert_allclose(pin.computeGeneralizedGravity(model, data, q), 2.0 * torque, rtol=1e-12)
    model.gravity.linear = [0.0, 0.0, 0.0]
    np.testing.assert_array_equal(pin.computeGeneralizedGravity(model, data, q), 0.0)
    model.armature[:] = 0.5
    with_armature = pin.crba(model, data, q)
    model.armature = [0.0, 0.0]
    np.testing.assert_allclose(with_armature - pin.crba(model, data, q), 0.5 * np.eye(2), atol=1e-12)
    frame = model.frames[model.getFrameId("hand")]
    pin.framesForwardKinematics(model, data, q)
    was = data.oMf[-1].translation.copy()
    frame.placement.translation[2] += 0.2
    pin.framesForwardKinematics(model, data, q)
    assert np.linalg.norm(data.oMf[-1].translation - was) == pytest.approx(0.2)


def test_frames_can_be_appended_and_replaced(pin: Any) -> None:
    model = _arm(pin)
    pin.framesForwardKinematics(model, model.createData(), [0.1, 0.2])
    M = pin.SE3.Random()
    model.frames.append(pin.Frame("grip", 2, 0, M, pin.OP_FRAME))
    data = model.createData()
    pin.framesForwardKinematics(model, data, [0.1, 0.2])
    np.testing.assert_allclose(data.oMf[-1].homogeneous, (data.oMi[2] * M).homogeneous, atol=1e-12)
    model.frames[-1] = pin.Frame("grip", 1, 0, M, pin.OP_FRAME)
    pin.framesForwardKinematics(model, data, [0.1, 0.2])
    np.testing.assert_allclose(data.oMf[-1].homogeneous, (data.oMi[1] * M).homogeneous, atol=1e-12)


def test_copies_and_pickles_stand_alone(pin: Any) -> None:
    model = _arm(pin, mimic=True)
    for twin in (model.copy(), copy.deepcopy(model), pickle.loads(pickle.dumps(model)), pin.Model(model)):
        assert twin == model and list(twin.names) == list(model.names) and twin.njoints == model.njoints
        twin.inertias[1].mass = 9.0
        assert twin != model
    data = model.createData()
    pin.forwardKinematics(model, data, [0.3])
    twin_data = data.copy()
    pin.forwardKinematics(model, data, [0.6])
    assert twin_data.oMi[1] != data.oMi[1]


def test_mimic_joints_work_everywhere(pin: Any) -> None:
    free, tied = _arm(pin), _arm(pin, mimic=True)
    assert (tied.nq, tied.nv, tied.nvExtended) == (1, 1, 2)
    G = np.array([[1.0], [-2.0]])  # velocities of the free arm by that of the tied one
    q, v, tau = np.array([0.3]), np.array([0.7]), np.array([1.5])
    whole = np.array([0.3, -2 * 0.3 + 0.1])
    f, t = free.createData(), tied.createData()
    M = G.T @ pin.crba(free, f, whole) @ G
    nle = G.T @ pin.nle(free, f, whole, (G @ v))
    np.testing.assert_allclose(pin.crba(tied, t, q), M, rtol=1e-12)
    np.testing.assert_allclose(pin.nle(tied, t, q, v), nle, rtol=1e-12)
    np.testing.assert_allclose(pin.aba(tied, t, q, v, tau), np.linalg.solve(M, tau - nle), rtol=1e-10)
    np.testing.assert_allclose(pin.computeMinverse(tied, t, q), np.linalg.inv(M), rtol=1e-10)
    energy = pin.computeKineticEnergy(free, f, whole, G @ v)
    assert pin.computeKineticEnergy(tied, t, q, v) == pytest.approx(energy)
    pin.computeAllTerms(tied, t, q, v)
    np.testing.assert_allclose(t.J, pin.computeJointJacobians(free, f, whole) @ G, atol=1e-12)
    ahead, behind = (pin.rnea(tied, t, q + h, v, v) for h in (1e-6, -1e-6))
    dtau_dq, _, _ = pin.computeRNEADerivatives(tied, t, q, v, v)
    np.testing.assert_allclose(dtau_dq[:, 0], (ahead - behind) / 2e-6, rtol=1e-6)


def test_derivatives_of_universal_joints_agree_with_differences(pin: Any) -> None:
    model = pin.Model()
    kind = pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    joint = model.addJoint(0, kind, pin.SE3(pin.utils.rotate("x", 0.3), np.ones(3)), "hook")
    model.appendBodyToJoint(
        joint, pin.Inertia(2.0, np.array([0.1, 0.2, 0.3]), np.diag([1, 2, 2.5])), pin.SE3()
    )
    data, q, v = model.createData(), np.array([0.2, 0.8]), np.array([-1.0, 2.0])
    dtau_dq, _, _ = pin.computeRNEADerivatives(model, data, q, v, v)
    for k, e in enumerate(1e-6 * np.eye(2)):
        change = pin.rnea(model, data, q + e, v, v) - pin.rnea(model, data, q - e, v, v)
        np.testing.assert_allclose(dtau_dq[:, k], change / 2e-6, rtol=1e-6, atol=1e-8)
    bias = pin.computeCoriolisMatrix(model, data, q, v) @ v + pin.computeGeneralizedGravity(model, data, q)
    np.testing.assert_allclose(bias, pin.nle(model, data, q, v), rtol=1e-12)


def test_the_logarithm_of_a_number_is_refused(pin: Any) -> None:
    with pytest.raises(ShapeError, match="4, 4"):
        pin.log6(3)


def test_rotations_about_an_axis_are_named(pin: Any) -> None:
    c, s = np.cos(0.3), np.sin(0.3)
    np.testing.assert_allclose(pin.rpy.rotate("x", 0.3), [[1, 0, 0], [0, c, -s], [0, s, c]], atol=1e-15)
    np.testing.assert_allclose(pin.rpy.rotate("y", 0.3), [[c, 0, s], [0, 1, 0], [-s, 0, c]], atol=1e-15)
    np.testing.assert_allclose(pin.rpy.rotate("z", 0.3), [[c, -s, 0], [s, c, 0], [0, 0, 1]], atol=1e-15)
    for axis in ("w", "", "xy"):
        with pytest.raises(UnknownName, match="axis"):
            pin.rpy.rotate(axis, 0.3)


def test_motions_of_a_robot_wrapper_need_their_whole_state(pin: Any) -> None:
    """An acceleration alone would be taken as a velocity; Pinocchio answers with the motions of an earlier call."""
    robot = pin.RobotWrapper(_arm(pin))
    q, v = robot.q0, np.ones(robot.nv)
    with pytest.raises(InputError, match="`a` was passed without `v`"):
        robot.forwardKinematics(q, a=v)
    for call in (
        lambda: robot.velocity(q, None, 1),
        lambda: robot.acceleration(q, None, v, 1),
        lambda: robot.frameAcceleration(q, v, None, 1),
    ):
        with pytest.raises(InputError, match="is None; expected an array"):
            call()


def test_an_se3_acts_on_one_object(pin: Any) -> None:
    M = pin.SE3.Random()
    for act in (M.act, M.actInv):
        assert act(M=M) == act(M)
        with pytest.raises(TypeError, match="two arguments"):
            act(M, motion=M)
        with pytest.raises(TypeError, match="given nothing"):
            act()


def test_quaternions_of_another_length_and_numbers_are_no_placements(pin: Any) -> None:
    for w in (0.0, 1e-200, 0.989, -0.5, 1.011, 7.0, np.nan):
        values = np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0, w])
        for call in (pin.XYZQUATToSE3, lambda x: pin.XYZQUATToSE3(list(x)), pin.log6_quat):
            with pytest.raises(InputError, match=r"long; expected length 1.*np.linalg.norm"):
                call(values)
        for R in (values[3:], pin.Quaternion(values[3:])):
            with pytest.raises(InputError, match="expected length 1"):
                pin.log3(R)
    frame = pin.buildSampleModelManipulator().frames[1]
    with pytest.raises(TypeError, match="expected a pinocchio.SE3"):
        frame.placement = 3


def test_parts_of_parameters_are_not_taken_for_all_of_them(pin: Any) -> None:
    from pinocchio._model.bound_kernels import ParameterKernel, not_read

    whole = np.arange(12.0).reshape(4, 3)
    kernel = ParameterKernel(SimpleNamespace(function=None), (whole[:, 0], whole[2]))
    pairs = [(array, array.copy()) for array in (whole, whole[:, 1], whole[2], whole[2, 1:], whole[:, 0])]
    assert [p[0].tolist() for p in not_read(kernel, pairs)] == [p[0].tolist() for p in (*pairs[:2], pairs[4])]


def test_constraints_are_lists_and_arguments_are_checked_without_any(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q, v = model.createData(), pin.neutral(model), np.arange(6.0)
    contact = pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, model, 6, pin.SE3.Identity())
    for call in (
        lambda x: pin.initConstraintDynamics(model, data, x, x),
        lambda x: pin.constraintDynamics(model, data, q, v, v, x, x),
        lambda x: pin.computeJointMinimalOrdering(model, data, x),
    ):
        for wrong in (None, 5, [5]):
            with pytest.raises((InputError, TypeError), match="expected") as caught:
                call(wrong)
            assert isinstance(caught.value, InputError)
    pin.impulseDynamics(model, data, q, v, [contact], [contact.createData()], 0.3)
    assert data.impulse_c.shape == (6,)
    assert pin.impulseDynamics(model, data, q, v, [], [], 0.3).tolist() == v.tolist()
    assert data.impulse_c.shape == (0,)
    with pytest.raises(InputError, match="`q` has shape"):
        pin.impulseDynamics(model, data, q[:3], v, [], [], 0.3)
    with pytest.raises(InputError, match="restitution is 1.5"):
        pin.impulseDynamics(model, data, q, v, [], [], 1.5)


def test_joint_data_made_of_other_data_is_a_copy(pin: Any) -> None:
    joint = pin.JointModelRX()
    joint.setIndexes(1, 0, 0)
    data = joint.createData()
    joint.calc(data, np.array([0.3]), np.array([1.0]))
    copied = pin.JointDataRX(data)
    joint.calc(data, np.array([1.3]), np.array([2.0]))
    assert copied.M.rotation[2, 1] == pytest.approx(np.sin(0.3)) and copied.v.angular[0] == 1.0


def test_flags_of_parallel_collisions_and_joints_of_geometries(pin: Any) -> None:
    coal = pytest.importorskip("coal")
    model = pin.buildSampleModelManipulator()
    geometries = pin.GeometryModel()
    for joint in (1, 6):
        geometries.addGeometryObject(
            pin.GeometryObject(f"ball{joint}", joint, pin.SE3.Identity(), coal.Sphere(2.0))
        )
    geometries.addCollisionPair(pin.CollisionPair(0, 1))
    pool, q = pin.GeometryPool(model, geometries, 1), pin.neutral(model)
    assert pin.computeCollisionsInParallel(1, pool, q).tolist() == [True]  # one column
    columns = np.stack([q, q], axis=1)
    assert pin.computeCollisionsInParallel(1, pool, columns, True, True).tolist() == [True, False]
    for flags, message in (
        (("no",), "in_configuration` is 'no'"),
        ((True, "no"), "in_batch` is 'no'"),
        ((True, True, True), "after all its arguments"),
    ):
        with pytest.raises(InputError, match=message):
            pin.computeCollisionsInParallel(1, pool, columns, *flags)
    with pytest.raises(InputError, match="in_trajectory` is 2"):
        pin.computeCollisionsInParallel(1, pool, [columns], 2)
    with pytest.raises(InputError, match="needs a pool"):
        pin.computeCollisionsInParallel(1)
    with pytest.raises(InputError, match="'ball1' is on joint 1; the model has 1 joints"):
        pin.computeBodyRadius(pin.Model(), geometries, geometries.createData())


def test_entries_of_what_is_computed_cannot_be_changed(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, geometry = model.createData(), pin.buildSampleGeometryModelManipulator(model)
    pin.computeAllTerms(model, data, np.full(6, 0.3), np.zeros(6))
    constraint = pin.FrameAnchorConstraintModel(model, 3)
    anchor = constraint.createData()
    constraint.calc(model, data, anchor)
    planar = pin.JointModelPlanar().createData()
    found = [pin.Model.gravity981, geometry.collisionPairMapping, planar.S, planar.StU, planar.UDinv]
    found += [data.joints[2].S, data.joints[2].U, data.joints[2].Dinv, data.joints[2].UDinv, data.U]
    found += [getattr(anchor, f"A{k}_{axes}") for k in ("", 1, 2) for axes in ("local", "world")]
    found += [pin.JointModelRevoluteUnaligned(0, 1, 0).axis, pin.JointModelUniversal(1, 0, 0, 0, 1, 0).axis2]
    for array in found:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 7.5
    joint = pin.JointModelRevoluteUnaligned(0, 1, 0)
    joint.axis = np.array([0.0, 0.0, 1.0])
    np.testing.assert_array_equal(joint.axis, [0.0, 0.0, 1.0])


def test_sliding_joints_have_axes_of_unit_length(pin: Any) -> None:
    """In Pinocchio one of length 3 moves three metres a unit of q."""
    joint = pin.JointModelPrismaticUnaligned(0, 1, 0)
    for make in (
        lambda: pin.JointModelPrismaticUnaligned(np.array([0.0, 3.0, 0.0])),
        lambda: pin.JointModelPrismaticUnaligned(0.0, 1.0, 2.0),
        lambda: setattr(joint, "axis", np.array([0.0, 0.0, 0.5])),
    ):
        with pytest.raises(InputError, match=r"long; expected length 1.*limits by"):
            make()
    np.testing.assert_array_equal(joint.axis, [0.0, 1.0, 0.0])
    joint.axis = np.array([0.577, 0.577, 0.577])
    np.testing.assert_allclose(joint.axis, np.ones(3) / np.sqrt(3.0), rtol=1e-12)
    turning = pin.JointModelRevoluteUnaligned(np.array([0.0, 3.0, 0.0]))
    np.testing.assert_array_equal(turning.axis, [0.0, 1.0, 0.0])
