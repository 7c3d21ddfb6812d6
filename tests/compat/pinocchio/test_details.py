"""Details of Pinocchio's behaviour: signs, joint 0, frames added twice, loaders of robots, names of older versions."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import both
from ulna.errors import InputError, ModelError, ModelWarning, UnknownName
from ulna.robots.example_robot_data import files, share_folder

needs_robots = pytest.mark.skipif(share_folder() is None, reason="example-robot-data is not installed")


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


@needs_robots
def test_details_are_as_in_pinocchio(tmp_path: Path) -> None:
    pytest.importorskip("pinocchio")
    urdf, srdf = files("talos")
    script = Path(__file__).with_name("asked_details.py")
    own, wanted = both(script, tmp_path, str(urdf), str(srdf), "half_sitting")
    for name in ("integrate", "rpy", "transforms"):
        for mine, theirs in zip(own[name], wanted[name], strict=True):
            np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-9, err_msg=name)
    assert own["joints and frames"] == wanted["joints and frames"]
    for mine, theirs in zip(own["loaded"], wanted["loaded"], strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-12, atol=1e-15)


def test_angles_survive_where_pitch_is_a_right_angle(pin: Any) -> None:
    for rpy in ([0.3, np.pi / 2, 0.5], [-1.2, -np.pi / 2, 2.9], [3.0, np.pi / 2, -3.0]):
        np.testing.assert_allclose(pin.rpy.matrixToRpy(pin.rpy.rpyToMatrix(*rpy)), rpy, atol=1e-9)


def test_another_frame_of_the_same_name_warns(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    at = pin.SE3(np.eye(3), np.array([0.1, 0.0, 0.0]))
    with pytest.warns(ModelWarning, match="'shoulder1_joint' already"):
        assert model.addFrame(pin.Frame("shoulder1_joint", 1, 0, at, pin.FrameType.JOINT)) == 1
    np.testing.assert_array_equal(model.frames[1].placement.translation, 0.0)


def test_a_body_cannot_follow_the_frame_of_a_joint_that_has_none(pin: Any) -> None:
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "hip")
    with pytest.raises(ModelError, match="'hip' has no frame that 'leg' could follow.*addJointFrame"):
        model.addBodyFrame("leg", joint, pin.SE3.Identity(), -1)
    model.addJointFrame(joint)
    assert model.addBodyFrame("leg", joint, pin.SE3.Identity(), -1) == 2


def test_a_constraint_is_placed_after_the_first_call_of_a_model(pin: Any) -> None:
    at = pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3]))
    for call in (pin.forwardKinematics, pin.computeJointJacobians):
        model = pin.buildSampleModelManipulator()
        data = model.createData()
        constraint = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 3, at)
        placed = constraint.createData()
        with pytest.raises(InputError, match="forwardKinematics"):
            constraint.calc(model, data, placed)
        call(model, data, np.linspace(0.1, 0.6, 6))
        constraint.calc(model, data, placed)
        np.testing.assert_allclose(placed.oMc1.homogeneous, (data.oMi[3] * at).homogeneous, atol=1e-15)


def test_wrong_arguments_are_refused_before_anything_else(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    geometries = pin.buildSampleGeometryModelManipulator(model)
    here, six, R = pin.SE3.Identity(), np.arange(6.0), np.eye(3)
    data, places = model.createData(), geometries.createData()
    joint = (2, pin.JointModelRX(), here, "shoulder2_joint")
    cases = (
        lambda: model.addJoint(*joint, six, "a", six, six),
        lambda: model.addJoint(*joint, six, None, six, six),
        lambda: model.addJoint(*joint, R, R, R, R),
        lambda: pin.appendModel(model, model, 2),
        lambda: pin.appendModel(model, model, 3, geometries, 2, here),
        lambda: pin.rpy.rotate("tool", 1j),
        lambda: pin.rpy.rpyToMatrix(np.ones(3), 3),
        lambda: pin.log3(R, 3),
        lambda: pin.log3(R, six),
        lambda: pin.removeCollisionPairs(model, geometries, None),
        lambda: pin.Force(six).isApprox(None, 0.4),
        lambda: pin.Motion(six).isApprox(3),
        lambda: pin.Frame("tool", 2, 1, 3, pin.FrameType.BODY),
        lambda: pin.JointModelPrismaticUnaligned(np.ones(3), 3),
        lambda: pin.JointModelHelicalUnaligned(1.0, 0.0, 0.0, "a"),
        lambda: pin.computeCollisions(model, data, geometries, places, six, True, 3),
        lambda: places.setActiveCollisionPairs(geometries, np.eye(geometries.ngeoms)),
        lambda: pin.printVersion(3),
    )
    for call in cases:
        with pytest.raises(TypeError):
            call()
    with pytest.raises(ValueError, match="'tool'"):
        pin.rpy.rotate("tool", 0.4)
    with pytest.raises(InputError, match="come first"):
        pin.transformJointIntoMimic(model, 2, 2, 1.0, 0.0)
    theta = np.zeros(1)
    pin.log3(pin.exp3(np.array([0.0, 0.3, 0.4])), theta)
    np.testing.assert_allclose(theta, 0.5)


def test_names_that_are_imported_when_first_used_stay_the_same(pin: Any) -> None:
    assert pin.computeCollisions is pin.computeCollisions
    assert vars(pin)["computeCollisions"] is pin.computeCollisions


@needs_robots
def test_robots_with_their_files_and_postures(pin: Any) -> None:
    import example_robot_data as robots
    from example_robot_data.robots_loader import PandaLoader, RobotLoader, TalosLegsLoader, TalosLoader

    robot, q0, urdf, srdf = robots.load_full("talos")
    assert urdf.endswith("talos_reduced.urdf") and srdf is not None and srdf.endswith("talos.srdf")
    posture = robot.model.referenceConfigurations["half_sitting"]
    np.testing.assert_allclose(q0, posture, atol=1e-12)
    assert robot.model.armature[6:].max() > 0.0
    np.testing.assert_array_equal(robot.model.upperPositionLimit[:7], 1.0)
    np.testing.assert_array_equal(robot.model.lowerPositionLimit[:7], -1.0)
    assert robots.load_full("ur3")[3] is None
    legs = TalosLegsLoader().robot
    assert legs.model.njoints == 14 and legs.model.names[13] == robot.model.names[13]
    assert TalosLoader is robots.ROBOTS["talos"] and issubclass(PandaLoader, RobotLoader)
    panda = PandaLoader().robot
    n = panda.collision_model.ngeoms
    assert 0 < len(panda.collision_model.collisionPairs) < n * (n - 1) // 2

    class Own(RobotLoader):
        path, urdf_subpath, urdf_filename = "panda_description", "urdf", "panda.urdf"

    np.testing.assert_array_equal(Own().robot.q0, pin.neutral(Own().robot.model))
    with pytest.raises(UnknownName, match="'solo12'"):
        robots.load("solo_12")
    with pytest.raises(InputError, match="SDF"):
        robots.load("cassie")
    with pytest.raises(UnknownName, match="half_sitting"):
        robots.readParamsFromSrdf(robot.model, srdf, False, False, "half_siting")


@needs_robots
def test_names_of_older_versions_say_what_to_use(pin: Any) -> None:
    import example_robot_data

    robot = example_robot_data.load("ur5")
    cases = (
        (lambda: pin.jacobian, "computeJointJacobian"),
        (lambda: pin.getNeutralConfigurationFromSrdf, "referenceConfigurations"),
        (lambda: pin.se3ToXYZQUATtuple, "SE3ToXYZQUATtuple"),
        (lambda: robot.increment, "pinocchio.integrate"),
        (lambda: robot.Jf, "computeFrameJacobian"),
        (lambda: robot.geometryObject, "visual_model.geometryObjects"),
        (lambda: robot.visual_model.geometryObject, "geometryObjects"),
        (lambda: robot.visual_model.geometryObjects[0].parent, "parentJoint"),
    )
    for use, replacement in cases:
        with pytest.raises(AttributeError, match="older version") as caught:
            use()
        assert replacement in str(caught.value)
    assert pin.utils.se3ToXYZQUATtuple(pin.SE3.Identity()) == (0, 0, 0, 0, 0, 0, 1)


def test_objects_can_be_keys_of_dictionaries_as_there(pin: Any) -> None:
    classes = [getattr(pin, name) for name in dir(pin) if isinstance(getattr(pin, name), type)]
    assert len(classes) > 100
    assert [cls for cls in classes if cls.__hash__ is None] == []
    model = pin.buildSampleModelManipulator()
    contact = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 1, pin.SE3.Identity())
    assert {contact: 1, model: 2}[contact] == 1
