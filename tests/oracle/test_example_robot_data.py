"""Every URDF of example-robot-data loads, and says the same as Pinocchio's own reader."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import numpy as np
import pytest

from ulna.errors import FormatError, ModelWarning
from ulna.formats.urdf import model_from_urdf
from ulna.loading import load_model
from ulna.model import Continuous
from ulna.robots import example_robot_data

pin = pytest.importorskip("pinocchio")

if example_robot_data.share_folder() is None:
    pytest.skip("example-robot-data is not installed", allow_module_level=True)

REFUSED = {"ur3_empty": "the robot has no links"}
"""What cannot be loaded, and why. Pinocchio refuses it too."""

WARNED = {
    "alex_psyonic_hands": "mimics 'index_q1', and there is no such joint; did you mean 'Left_index_q1'",
    "centauro": "neither lower nor upper is given",
    "quadruped": "neither lower nor upper is given",
    "romeo_laas_small": "Torso.mesh' and 19 more were not found",
    "talos_corrected": "no material 'FlatBlack' is defined",
    "tiago": "negative",
    "tiago_dual": "negative",
    "tiago_no_hand": "negative",
}
"""What is odd about the others: a part of the warning each gives."""

NAMES = sorted(set(example_robot_data.DESCRIPTIONS) - set(REFUSED))


@pytest.fixture
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        yield


@pytest.mark.parametrize("name", NAMES)
def test_same_as_pinocchio(name, quiet):
    file, _ = example_robot_data.files(name)
    ours = model_from_urdf(file, mimic=False)
    theirs = pin.buildModelFromUrdf(str(file))
    circles = sum(isinstance(joint.kind, Continuous) for joint in ours.joints)
    assert (ours.nq + circles, ours.nv) == (theirs.nq, theirs.nv)  # theirs has a cosine and a sine for each
    assert set(ours.joint_names) == set(list(theirs.names)[1:])
    assert {f.name for f in ours.frames} == {f.name for f in theirs.frames} - {"universe"}
    assert ours.mass == pytest.approx(sum(i.mass for i in theirs.inertias), abs=1e-11)
    for joint, inertia in zip(ours.joints, ours.inertias, strict=True):
        i = theirs.getJointId(joint.name)
        above = ours.joints[joint.parent].name if joint.parent >= 0 else "universe"
        assert above == theirs.names[theirs.parents[i]]
        placement = theirs.jointPlacements[i]
        np.testing.assert_allclose(joint.placement.rotation, placement.rotation, rtol=0, atol=1e-12)
        np.testing.assert_allclose(joint.placement.translation, placement.translation, rtol=0, atol=1e-12)
        _same_inertia(inertia, theirs.inertias[i])
        q, v = theirs.idx_qs[i], theirs.idx_vs[i]
        if theirs.nqs[i] == 1:
            assert joint.limits.lower == (theirs.lowerPositionLimit[q],)
            assert joint.limits.upper == (theirs.upperPositionLimit[q],)
        assert joint.limits.velocity == (theirs.velocityLimit[v],)
        assert joint.limits.effort == (theirs.effortLimit[v],)
        assert joint.damping == (theirs.damping[v],)
        assert joint.friction == (theirs.upperDryFrictionLimit[v],)
    _same_inertia(ours.base_inertia, theirs.inertias[0])


def _same_inertia(ours, theirs):
    assert ours.mass == pytest.approx(theirs.mass, rel=1e-13, abs=1e-13)
    if theirs.mass > 0:
        np.testing.assert_allclose(ours.com, theirs.lever, rtol=0, atol=1e-12)
    np.testing.assert_allclose(ours.inertia, theirs.inertia, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_frames_are_where_pinocchio_has_them(name, quiet):
    from ulna.algorithms.kinematics.forward_kinematics import frame_poses

    file, _ = example_robot_data.files(name)
    ours = model_from_urdf(file, mimic=False)
    theirs = pin.buildModelFromUrdf(str(file))
    data = theirs.createData()
    values = np.random.default_rng(0).uniform(-1, 1, size=ours.nq)
    q = np.zeros(theirs.nq)
    for joint in ours.joints:
        i = theirs.getJointId(joint.name)
        value = values[joint.idx_q]
        two = theirs.nqs[i] == 2
        q[theirs.idx_qs[i] : theirs.idx_qs[i] + theirs.nqs[i]] = (
            (math.cos(value), math.sin(value)) if two else value
        )
    pin.framesForwardKinematics(theirs, data, q)
    by_name = {(f.name, f.type == pin.FrameType.BODY): data.oMf[i] for i, f in enumerate(theirs.frames)}
    for frame, pose in zip(ours.frames, frame_poses(ours, values, ours.frames), strict=True):
        expected = by_name[frame.name, frame.kind == "link"]
        np.testing.assert_allclose(pose.matrix(), expected.homogeneous, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", REFUSED)
def test_refused_by_both(name):
    file, _ = example_robot_data.files(name)
    with pytest.raises(FormatError, match=REFUSED[name]):
        model_from_urdf(file)
    with pytest.raises(Exception, match=Path(file).name):
        pin.buildModelFromUrdf(str(file))


def test_warnings_name_unusual_values():
    for name in NAMES:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            load_model(f"example-robot-data:{name}")
        texts = [str(w.message) for w in caught if issubclass(w.category, ModelWarning)]
        if name in WARNED:
            assert any(WARNED[name] in text for text in texts), (name, texts)
        assert sum("not found" in text for text in texts) <= 1
        if name in ("panda", "ur5", "solo12", "talos", "g1", "xarm7", "anymal"):
            assert texts == [], name


def test_postures_are_there(quiet):
    for name, description in example_robot_data.DESCRIPTIONS.items():
        if description.posture is not None:
            model = load_model(f"example-robot-data:{name}", root="auto")
            assert description.posture in model.configurations, name


def test_ur5_as_recorded():
    """The own UR5 against Pinocchio's reading of the description in common use."""
    ours = load_model("ur5", visuals="simple")
    theirs = pin.buildModelFromUrdf(str(example_robot_data.files("ur5")[0]))
    data = theirs.createData()
    from ulna.algorithms.kinematics.forward_kinematics import frame_pose

    for q in (np.zeros(6), np.array([-2.5, -0.7, -1.3, 2.2, -0.9, 3.0])):
        pin.framesForwardKinematics(theirs, data, q)
        expected = data.oMf[theirs.getFrameId("tool0")].homogeneous
        np.testing.assert_allclose(frame_pose(ours, q, ours.frame("tool0")).matrix(), expected, atol=1e-10)
    assert tuple(theirs.names)[1:] == ours.joint_names
