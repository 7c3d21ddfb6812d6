"""The robots written down in the package: their figures, shapes and configurations."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ulna.algorithms.kinematics.forward_kinematics import frame_pose
from ulna.errors import MissingExtra, UnknownName
from ulna.formats.urdf import model_from_urdf
from ulna.geometry import Mesh
from ulna.robots import catalogue, example_robot_data
from ulna.robots.catalogue import build_bundled
from ulna.robots.panda import FINGER_OPENING
from ulna.viewer.robot.link_surfaces import link_surfaces

OWN = tuple(catalogue.OWN)

needs_data = pytest.mark.skipif(example_robot_data.share_folder() is None, reason="example-robot-data")


def pose(model, q, frame):
    return frame_pose(
        model, np.asarray(model.configurations[q] if isinstance(q, str) else q), model.frame(frame)
    )


@pytest.mark.parametrize("name", ["panda", "panda_fingers"])
def test_panda_figures(name):
    panda = build_bundled(name, visuals="simple")
    assert panda.tool == "panda_hand_tcp"
    tool = pose(panda, "qr", "panda_hand_tcp")
    np.testing.assert_allclose(tool.translation, [0.48404681539304417, 0.0, 0.412629775462], atol=1e-12)
    # at zero the hand points down and its fingers stand across, an eighth turn from the base axes
    np.testing.assert_allclose(
        pose(panda, "qz", "panda_link8").rotation, np.diag([1.0, -1.0, -1.0]), atol=1e-15
    )
    np.testing.assert_allclose(pose(panda, "qz", "panda_link8").translation, [0.088, 0.0, 0.926], atol=1e-15)
    lower = [-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973]
    upper = [2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973]
    np.testing.assert_array_equal(panda.lower_position[:7], lower)
    np.testing.assert_array_equal(panda.upper_position[:7], upper)
    np.testing.assert_array_equal(panda.velocity_limit[:7], [2.175] * 4 + [2.61] * 3)
    np.testing.assert_array_equal(panda.effort_limit[:7], [87.0] * 4 + [12.0] * 3)
    assert panda.mass == pytest.approx(16.822132 + 0.629769, abs=1e-12)
    assert panda.link("panda_link0").inertia.mass == 0.629769


def test_panda_configurations():
    panda = build_bundled("panda", visuals="simple")
    np.testing.assert_array_equal(panda.configurations["qr"], [0, -0.3, 0, -2.2, 0, 2, math.pi / 4])
    np.testing.assert_array_equal(panda.configurations["qz"], np.zeros(7))
    ready = panda.configurations["ready"]
    assert np.all((panda.lower_position <= ready) & (ready <= panda.upper_position))


def test_rigid_and_moving_fingers_agree():
    rigid, moving = build_bundled("panda", visuals="simple"), build_bundled("panda_fingers", visuals="simple")
    assert (rigid.nq, moving.nq, moving.nv) == (7, 8, 8)
    assert moving.joint("panda_finger_joint2").mimic is not None
    for finger in ("panda_leftfinger", "panda_rightfinger"):
        assert pose(rigid, "qr", finger).is_close(pose(moving, "qr", finger), 1e-12)
    left, right = (pose(moving, "qr", f"panda_{side}finger").translation for side in ("left", "right"))
    assert np.linalg.norm(left - right) == pytest.approx(2 * FINGER_OPENING)
    assert rigid.frame_names == moving.frame_names


def test_ur5_figures():
    ur5 = build_bundled("ur5", visuals="simple")
    assert ur5.tool == "tool0"
    assert ur5.joint_names == (
        "shoulder_pan_joint",
        "shoulder_lift_joint",
        "elbow_joint",
        "wrist_1_joint",
        "wrist_2_joint",
        "wrist_3_joint",
    )
    assert ur5.mass == pytest.approx(4.0 + 16.9939)
    # stretched out: upper arm, forearm and last wrist joint in a row, shoulder and wrist offsets aside
    reach = pose(ur5, "qz", "tool0").translation
    np.testing.assert_allclose(
        reach, [0.425 + 0.39225, 0.13585 - 0.1197 + 0.093 + 0.0823, 0.089159 - 0.09465], atol=1e-15
    )
    # bent over the table, the tool looks straight down
    np.testing.assert_allclose(pose(ur5, "ready", "tool0").rotation[:, 2], [0.0, 0.0, -1.0], atol=1e-15)


@pytest.mark.parametrize("name", OWN)
def test_right_angles_are_exact(name):
    model = build_bundled(name, visuals="simple")
    for joint in model.joints[:7]:
        assert set(np.unique(joint.placement.rotation)) <= {-1.0, 0.0, 1.0}


@pytest.mark.parametrize("name", OWN)
def test_they_are_drawn_and_collide(name):
    model = build_bundled(name, visuals="simple")
    for link in model.links:
        if link.inertia.mass > 0:
            assert link.visuals
            assert link.collisions
            assert link.inertia.is_physical()
        assert not any(isinstance(g.shape, Mesh) for g in link.visuals + link.collisions)
        assert all(g.material is not None and g.material.rgba is not None for g in link.visuals)
        points = [s.vertices for s in link_surfaces(link.visuals) + link_surfaces(link.collisions)]
        if points:
            assert np.linalg.norm(np.concatenate(points), axis=1).max() < (0.5 if name == "ur5" else 0.28)
        names = [g.name for g in link.visuals]
        assert len(set(names)) == len(names)
    assert model.disabled_pairs


@pytest.mark.parametrize("name", OWN)
def test_roots(name):
    free = build_bundled(name, visuals="simple", root="free_flyer")
    fixed = build_bundled(name, visuals="simple")
    assert free.nq == fixed.nq + 7
    np.testing.assert_array_equal(
        free.configurations["qr"], [0, 0, 0, 0, 0, 0, 1, *fixed.configurations["qr"]]
    )
    with pytest.raises(UnknownName, match="free_flyer"):
        build_bundled(name, root="freeflyer")


@needs_data
@pytest.mark.parametrize("name", OWN)
def test_cad_visuals(name):
    cad, simple = build_bundled(name, visuals="cad"), build_bundled(name, visuals="simple")
    drawn = [g.shape for link in cad.links for g in link.visuals]
    assert sum(isinstance(s, Mesh) for s in drawn) >= 7
    assert not any(isinstance(s, Mesh) and s.missing for s in drawn)
    assert cad.frame_names == simple.frame_names
    for a, b in zip(cad.links, simple.links, strict=True):
        assert a.inertia.is_close(b.inertia)
        assert a.collisions == b.collisions
        assert bool(a.visuals) == bool(b.visuals)


def test_without_the_meshes(monkeypatch):
    monkeypatch.setattr(example_robot_data, "share_folder", lambda: None)
    assert build_bundled("panda") == build_bundled("panda", visuals="simple")
    with pytest.raises(
        MissingExtra, match=r"CAD meshes for 'ur5' needs .* pip install 'example-robot-data>="
    ):
        build_bundled("ur5", visuals="cad")


def test_unknown_words():
    with pytest.raises(UnknownName, match="Did you mean 'simple'"):
        build_bundled("panda", visuals="simpel")
    with pytest.raises(UnknownName, match="Did you mean 'panda'"):
        build_bundled("pandas")


@needs_data
@pytest.mark.parametrize(("own", "name"), [("panda_fingers", "panda"), ("ur5", "ur5")])
def test_they_agree_with_the_descriptions_in_common_use(own, name):
    file, _ = example_robot_data.files(name)
    ours, theirs = build_bundled(own, visuals="simple"), model_from_urdf(file)
    assert ours.joint_names == theirs.joint_names
    assert set(ours.frame_names) == set(theirs.frame_names)
    for link in ours.links:
        other = theirs.link(link.name)
        assert link.inertia.is_close(other.inertia, 1e-15)
        np.testing.assert_allclose(link.placement.matrix(), other.placement.matrix(), atol=1e-11)
    for joint in ours.joints:
        other = theirs.joint(joint.name)
        assert joint.kind == other.kind
        np.testing.assert_allclose(joint.placement.matrix(), other.placement.matrix(), atol=1e-11)
        for limit in ("lower", "upper", "velocity", "effort"):
            np.testing.assert_allclose(getattr(joint.limits, limit), getattr(other.limits, limit), rtol=1e-12)
        assert (joint.damping, joint.friction) == (other.damping, other.friction)
