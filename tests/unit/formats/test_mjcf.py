"""MJCF files: what of them gets into a model, what is left out with a word, and how broken ones are refused."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import FormatError, MissingExtra, ModelWarning
from ulna.formats.mjcf_loops import loops_from_mjcf
from ulna.geometry import Box, Capsule, Mesh, Plane, Sphere
from ulna.model import FrameLoop, FreeFlyer, PointLoop, Revolute

mj: Any = pytest.importorskip("mujoco")

ARM = """
<mujoco model="two_link">
  <compiler angle="degree"/>
  <default><joint damping="0.5" frictionloss="0.1" armature="0.01"/></default>
  <asset><material name="red" rgba="1 0 0 0.5"/></asset>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <body name="upper" pos="0 0 0.4">
      <joint name="shoulder" axis="0 1 0" range="-90 90" actuatorfrcrange="-40 40"/>
      <geom name="look" type="box" size="0.1 0.2 0.3" material="red" contype="0" conaffinity="0" group="2" mass="1"/>
      <geom name="hull" type="capsule" fromto="0 0 0 0 0 0.3" size="0.05" group="3" mass="2"/>
      <body name="fore" pos="0 0 0.3">
        <joint name="elbow" axis="0 1 0"/>
        <joint name="reach" type="slide" axis="0 0 1" range="0 0.2"/>
        <geom type="sphere" size="0.1" mass="1"/>
        <site name="tip" pos="0 0 0.2" euler="0 90 0"/>
        <site name="fore"/>
      </body>
    </body>
  </worldbody>
  <contact><exclude body1="upper" body2="fore"/></contact>
  <actuator>
    <motor joint="elbow" gear="50" forcelimited="true" forcerange="-2 2"/>
  </actuator>
  <keyframe><key name="home" qpos="0.1 0.2 0.05"/></keyframe>
</mujoco>
"""


def test_an_arm_becomes_a_model() -> None:
    robot = ulna.load(ARM)
    model = robot.model
    assert model.name == "two_link"
    assert robot.joint_names == ("shoulder", "elbow", "reach")
    assert robot.link_names == ("world", "upper", "fore_before_reach", "fore")
    shoulder, elbow, reach = model.joints
    np.testing.assert_allclose((*shoulder.limits.lower, *shoulder.limits.upper), (-np.pi / 2, np.pi / 2))
    assert shoulder.limits.effort == (40.0,)
    assert isinstance(elbow.kind, Revolute)
    assert elbow.limits.lower == (-np.inf,)
    assert elbow.limits.effort == (100.0,)
    assert reach.limits.upper == (0.2,)
    assert (shoulder.damping, shoulder.friction, shoulder.armature) == ((0.5,), (0.1,), (0.01,))
    np.testing.assert_array_equal(model.configurations["home"], (0.1, 0.2, 0.05))
    assert ("fore", "upper") in model.disabled_pairs
    np.testing.assert_allclose(
        robot.fk(robot.configurations["home"], "tip")[:3, 3], _tip((0.1, 0.2, 0.05)), atol=1e-15
    )
    assert "fore_site" in robot.model.frame_names, "a site whose name a body has keeps a separate name"


def _tip(q: tuple[float, ...]) -> Any:
    m = mj.MjModel.from_xml_string(ARM)
    d = mj.MjData(m)
    d.qpos = q
    mj.mj_forward(m, d)
    return d.site("tip").xpos


def test_what_is_drawn_and_what_collides() -> None:
    upper = ulna.load(ARM).model.links[1]
    assert [type(g.shape) for g in upper.visuals] == [Box]
    assert [type(g.shape) for g in upper.collisions] == [Capsule]
    assert upper.visuals[0].material is not None
    assert upper.visuals[0].material.rgba == (1.0, 0.0, 0.0, 0.5)
    assert upper.visuals[0].shape == Box((0.2, 0.4, 0.6))
    assert upper.collisions[0].placement.translation[2] == pytest.approx(0.15)
    assert ulna.load(ARM).model.links[0].visuals[0].shape == Plane((0.0, 0.0))
    simple = ulna.load(ARM, visuals="simple").model.links
    assert [type(g.shape) for g in simple[1].visuals] == [Capsule]
    assert [type(g.shape) for g in simple[3].visuals] == [Sphere]


def test_files_and_their_includes(tmp_path: Path) -> None:
    (tmp_path / "parts.xml").write_text('<mujocoinclude><geom type="sphere" size="0.2"/></mujocoinclude>')
    file = tmp_path / "arm.xml"
    file.write_text(
        '<?xml version="1.0"?><!-- no <robot> --><mujoco><worldbody><body name="b"><joint name="j"/>'
        '<include file="parts.xml"/></body></worldbody></mujoco>'
    )
    robot = ulna.load(file)
    assert robot.joint_names == ("j",)
    assert robot.model.source == str(file)
    assert robot.total_mass() == pytest.approx(1000.0 * 4.0 / 3.0 * np.pi * 0.2**3)


def test_urdf_in_an_xml_file_is_still_urdf(tmp_path: Path) -> None:
    file = tmp_path / "arm.xml"
    file.write_text('<robot name="r"><link name="a"/></robot>')
    assert ulna.load(file).link_names == ("a",)


def test_meshes_lie_where_mujoco_puts_them(tmp_path: Path) -> None:
    """MuJoCo turns a mesh into its principal axes; we draw the file itself, in the same place."""
    rng = np.random.default_rng(3)
    corners = rng.uniform(-1.0, 1.0, (4, 3))
    (tmp_path / "assets").mkdir()
    lines = [*(f"v {x} {y} {z}" for x, y, z in corners), "f 1 2 3", "f 1 4 2", "f 1 3 4", "f 2 4 3"]
    (tmp_path / "assets" / "tetra.obj").write_text("\n".join(lines))
    file = tmp_path / "arm.xml"
    file.write_text(
        '<mujoco><compiler meshdir="assets"/><asset><mesh name="t" file="tetra.obj" scale="0.5 1 2" inertia="shell"/></asset>'
        '<worldbody><body name="b" pos="1 2 3" euler="10 20 30"><joint name="j"/>'
        '<geom type="mesh" mesh="t" pos="0.1 0.2 0.3" euler="40 50 60"/></body></worldbody></mujoco>'
    )
    robot = ulna.load(file)
    drawn = robot.model.links[1].visuals[0]
    assert isinstance(drawn.shape, Mesh)
    assert not drawn.shape.missing
    T = robot.fk(np.zeros(1), "b") @ drawn.placement.matrix()
    ours = (corners * drawn.shape.scale) @ T[:3, :3].T + T[:3, 3]
    m = mj.MjModel.from_xml_path(str(file))
    d = mj.MjData(m)
    mj.mj_forward(m, d)
    theirs = m.mesh_vert @ d.geom_xmat[0].reshape(3, 3).T + d.geom_xpos[0]
    np.testing.assert_allclose(np.sort(ours, axis=0), np.sort(theirs, axis=0), atol=1e-6)


def test_coupled_joints_follow() -> None:
    text = """
    <mujoco><worldbody><body name="a"><joint name="lead" ref="10"/><geom size="0.1"/></body>
    <body name="b"><joint name="follow" ref="20"/><geom size="0.1"/></body></worldbody>
    <equality><joint joint1="follow" joint2="lead" polycoef="0.3 -2 0 0 0"/></equality></mujoco>"""
    robot = ulna.load(text)
    assert robot.nq == 1
    follow = robot.model.joints[1].mimic
    assert follow is not None
    # follow - 20 deg = 0.3 - 2 (lead - 10 deg)
    assert (follow.multiplier, follow.offset) == (-2.0, pytest.approx(0.3 + np.radians(20 + 2 * 10)))
    with pytest.warns(ModelWarning, match="no file|equalit"):
        assert ulna.load(text.replace("-2 0 0 0", "-2 1 0 0")).nq == 2
    assert ulna.load(text, mimic=False).nq == 2


def test_a_free_joint_is_a_free_flyer() -> None:
    robot = ulna.load(
        '<mujoco><worldbody><body name="b" pos="1 2 3"><freejoint name="base"/><geom size="0.1"/></body></worldbody>'
        '<keyframe><key qpos="1 2 3 0 1 0 0"/></keyframe></mujoco>'
    )
    assert isinstance(robot.model.joints[0].kind, FreeFlyer)
    assert (robot.nq, robot.nv) == (7, 6)
    np.testing.assert_array_equal(robot.configurations["key_0"], (1, 2, 3, 1, 0, 0, 0))
    np.testing.assert_array_equal(robot.configurations["qpos0"], (1, 2, 3, 0, 0, 0, 1))


def test_gravity_can_be_disabled() -> None:
    text = """<mujoco><option><flag gravity="disable"/></option><worldbody><body name="b"><joint axis="0 1 0"/>
    <geom size="0.1" pos="0.3 0 0" mass="1"/></body></worldbody></mujoco>"""
    robot = ulna.load(text)
    np.testing.assert_array_equal(robot.gravity_forces([0.2]), [0.0])
    assert ulna.load(text.replace("disable", "enable")).gravity_forces([0.2])[0] < -1.0


def test_what_is_left_out_is_said() -> None:
    text = """
    <mujoco><worldbody><body name="a" gravcomp="1"><joint name="j" stiffness="3"/><geom size="0.1"/><site name="s"/></body>
    <site name="t" pos="1 0 0"/></worldbody>
    <tendon><spatial stiffness="2"><site site="s"/><site site="t"/></spatial></tendon>
    <equality><connect body1="a" anchor="0 0 0"/></equality></mujoco>"""
    with pytest.warns(ModelWarning) as caught:
        ulna.load(text)
    assert len(caught) == 1
    words = str(caught[0].message)
    for part in (
        "<joint stiffness> of joint 'j' (line 1)",
        "<tendon stiffness> of tendon (line 3)",
        "<connect> of equality (line 4)",
        "loops_from_mjcf",
        "<body gravcomp> of body 'a' (line 1)",
    ):
        assert part in words


def test_closed_loops_are_constraints_for_the_dynamics() -> None:
    """At the rest position every loop is closed, and what holds them leaves no acceleration that opens one."""
    text = """
    <mujoco><compiler angle="radian"/><worldbody>
    <body name="a" pos="0.1 0.2 0.3" euler="0.1 0.2 0.3"><joint name="ja" axis="1 0 0" pos="0.1 0 0"/><geom size="0.1"/>
      <site name="sa" pos="0.3 0 0" euler="0 0.5 0"/>
      <body name="c" pos="0.3 0 0"><joint name="jc" axis="0 1 0"/><geom size="0.1"/></body></body>
    <body name="b" pos="0.4 0.2 0.3" euler="0.1 0.4 0.3"><joint name="jb" axis="1 1 0"/><geom size="0.1"/>
      <body name="d" pos="0 0 1"><joint name="jd" type="ball"/><geom size="0.1"/></body></body>
    </worldbody><equality>
    <connect body1="c" body2="d" anchor="0.1 0.2 0.3"/><weld body1="a" body2="d" anchor="0.1 0 0.2"/>
    <connect body1="c" anchor="0 0 0.1"/><weld active="false" body1="c" body2="d"/></equality></mujoco>"""
    loops = loops_from_mjcf(text)
    assert [type(loop) for loop in loops] == [PointLoop, FrameLoop, PointLoop]
    assert loops[2].frame_b == "world"
    with pytest.warns(ModelWarning, match="loops_from_mjcf"):
        robot = ulna.load(text)
    for loop in loops:
        (a, at), (b, to) = ((robot.fk(robot.neutral, name), pose.matrix()) for name, pose in loop.ends())
        same = slice(0, 4) if isinstance(loop, FrameLoop) else slice(3, 4)
        np.testing.assert_allclose((a @ at)[:3, same], (b @ to)[:3, same], atol=1e-9)
    v = np.zeros(robot.nv)
    acceleration = robot.constrained_dynamics(robot.neutral, v, v, loops[0])[0]
    J = robot.constraint_jacobian(robot.neutral, loops[0])
    np.testing.assert_allclose(J @ acceleration, np.zeros(3), atol=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<mujoco><worldbdy/></mujoco>", "unrecognized element"),
        ("<mujoco><worldbody><body><joint/></body></worldbody></mujoco>", "Give the body a geom"),
        ("<mujoco><worldbody>", "MuJoCo refuses it"),
        (
            '<mujoco><asset><mesh file="gone.obj" name="m"/></asset><worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>',
            "meshdir",
        ),
    ],
)
def test_broken_text_is_refused_with_the_fix(text: str, words: str) -> None:
    with pytest.raises(FormatError, match=words):
        ulna.load(text)


def test_a_missing_file_has_our_message(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="no such file"):
        ulna.load(tmp_path / "gone.xml")


def test_without_mujoco_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtra, match=r"pip install .*'mujoco>="):
        ulna.load(ARM)


def test_names_that_joints_and_links_between_have_by_themselves_may_be_in_the_file() -> None:
    robot = ulna.load("""<mujoco><worldbody>
      <body name="a"><joint name="b_fixed" axis="0 1 0"/><joint name="two" axis="1 0 0"/><geom size="0.1"/>
        <body name="b" pos="0 0 1"><geom size="0.1"/>
          <body name="a_before_two" pos="0 0 1"><geom size="0.1"/></body></body></body>
    </worldbody></mujoco>""")
    assert robot.joint_names == ("b_fixed", "two")
    assert robot.fk([0.0, 0.0], "a_before_two")[2, 3] == 2.0
    assert robot.fk([0.0, np.pi], "a_before_two")[2, 3] == pytest.approx(-2.0)


CHAIN = """<mujoco><worldbody>
  <body name="a"><joint name="j" axis="0 1 0" range="-90 90"/><geom size="0.1"/></body>
  <body name="b" pos="0 0 1"><joint name="k" axis="0 1 0"/><geom size="0.1"/></body>
  <body name="c" pos="0 0 2"><joint name="l" axis="0 1 0" range="-20 80"/><geom size="0.1"/></body>
</worldbody>
<equality>
  <joint joint1="k" joint2="j" polycoef="0.1 -2 0 0 0"/><joint joint1="l" joint2="k" polycoef="0 0.5 0 0 0"/>
</equality></mujoco>"""


def test_a_leader_stays_in_the_ranges_of_its_followers() -> None:
    robot = ulna.load(CHAIN)
    lower, upper = float(robot.limits.lower[0]), float(robot.limits.upper[0])
    assert [0.5 * (0.1 - 2.0 * q) for q in (upper, lower)] == pytest.approx(
        np.radians([-20.0, 80.0]).tolist()
    )
    each = ulna.load(CHAIN, mimic=False).limits
    np.testing.assert_allclose(each.lower, [-np.pi / 2, -np.inf, np.radians(-20.0)])
    apart = ulna.load(
        CHAIN.replace("-20 80", "300 310")
    ).limits  # no position satisfies both: its own range counts
    np.testing.assert_allclose([apart.lower[0], apart.upper[0]], [-np.pi / 2, np.pi / 2])


def test_keyframes_without_a_name_take_none_of_another() -> None:
    keys = '<keyframe><key qpos="0.1 0 0"/><key name="key_0" qpos="0.2 0 0"/></keyframe></mujoco>'
    with pytest.warns(ModelWarning, match="<key qpos> of key where 'k' is at 0, and follows 'j' to -0.1"):
        robot = ulna.load(CHAIN.replace("</mujoco>", keys))
    assert {name: q.tolist() for name, q in robot.configurations.items()} == {
        "key_0_2": [0.1],
        "key_0": [0.2],
    }
    ball = '<mujoco><worldbody><body pos="0 0 3"><freejoint/><geom size="0.1"/></body></worldbody><keyframe>'
    robot = ulna.load(ball + '<key name="qpos0" qpos="1 1 1 1 0 0 0"/></keyframe></mujoco>')
    assert robot.configurations["qpos0"][0] == 1.0 and robot.configurations["qpos0_2"][2] == 3.0
