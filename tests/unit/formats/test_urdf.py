"""URDF files of every make become documents and models."""

from __future__ import annotations

import math
import pickle
import warnings

import numpy as np
import pytest

from ulna.errors import FormatError, ModelWarning, UnknownName
from ulna.formats import markup
from ulna.formats.markup import MAX_BYTES
from ulna.formats.root import root_kind
from ulna.formats.urdf import model_from_urdf, read_urdf
from ulna.formats.urdf_document import UrdfJoint, UrdfLimit, UrdfMimic
from ulna.formats.urdf_parse import parse_urdf
from ulna.geometry import Box, Capsule, Cylinder, Mesh, Sphere
from ulna.model import Continuous, FreeFlyer, Planar, Prismatic, Revolute, Spherical

ALL_KINDS = """<?xml version="1.0"?>
<!-- a comment --> <robot name="zoo" xmlns:controller="http://playerstage.sourceforge.net/gazebo#controller">
  <material name="red"><color rgba="1 0 0 0.5"/></material>
  <link name="base">
    <inertial>
      <origin xyz="0.1 0 0" rpy="0 0 1.5707963267948966"/>
      <mass value="2"/><inertia ixx="1" ixy="0.1" ixz="0" iyy="2" iyz="0" izz="2.5"/>
    </inertial>
    <visual name="skin"><origin xyz="1 2 3" rpy="0 0 0.5"/><geometry><box size="1 2 3"/></geometry>
      <material name="red"/></visual>
    <visual><geometry><cylinder radius="0.1" length="0.4"/></geometry>
      <material name="green"><color rgba="0 1 0 1"/></material></visual>
    <collision><geometry><sphere radius="0.2"/></geometry></collision>
    <collision><geometry><capsule radius="0.1" length="0.3"/></geometry></collision>
  </link>
  <link name="a"><visual><geometry><sphere radius="1"/></geometry><material name="green"/></visual></link>
  <link name="b"/><link name="c"/><link name="d"/><link name="e"/><link name="f"/><link name="g"/>
  <link name="h"/>
  <joint name="ja" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" velocity="3" effort="4"/><dynamics damping="0.5" friction="0.25"/>
    <safety_controller k_velocity="1"/><calibration rising="0"/></joint>
  <joint name="jb" type="continuous"><origin xyz="0 0 1"/><parent link="a"/><child link="b"/>
    <axis xyz="0 0 2"/>
    <limit velocity="1" effort="2"/></joint>
  <joint name="jc" type="prismatic"><parent link="a"/><child link="c"/>
    <limit lower="0" upper="0.1" velocity="1" effort="inf"/>
    <mimic joint="ja" multiplier="2" offset="0.5"/></joint>
  <joint name="jd" type="fixed"><origin xyz="0 1 0" rpy="1.5707963267948966 0 0"/><parent link="base"/>
    <child link="d"/></joint>
  <joint name="je" type="planar"><parent link="d"/><child link="e"/><axis xyz="0 0 1"/></joint>
  <joint name="jf" type="floating"><parent link="d"/><child link="f"/></joint>
  <joint name="jg" type="spherical"><parent link="f"/><child link="g"/></joint>
  <joint name="jh" type="prismatic"><parent link="g"/><child link="h"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="1"/></joint>
  <transmission name="t"><joint name="ja"><hardwareInterface>x</hardwareInterface></joint></transmission>
  <gazebo reference="base"><controller:foo/></gazebo>
</robot>"""


@pytest.fixture
def zoo():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        return model_from_urdf(parse_urdf(ALL_KINDS))


def test_every_joint_kind(zoo):
    kinds = {j.name: j.kind for j in zoo.joints}
    assert kinds["ja"] == Revolute((0, 0, 1))
    assert kinds["jb"] == Continuous((0, 0, 1))
    assert kinds["jc"] == Prismatic((1, 0, 0))
    assert isinstance(kinds["je"], Planar)
    assert isinstance(kinds["jf"], FreeFlyer)
    assert isinstance(kinds["jg"], Spherical)
    assert zoo.joint_names == ("ja", "jb", "jc", "je", "jf", "jg", "jh")
    assert zoo.frame("jd").kind == "fixed_joint"


def test_siblings_keep_file_order():
    text = '<robot name="r"><link name="z"/><link name="m"/><link name="a"/><link name="k"/>'
    for name, child in (("j9", "m"), ("j1", "a"), ("j5", "k")):
        text += f'<joint name="{name}" type="continuous"><parent link="z"/><child link="{child}"/></joint>'
    assert model_from_urdf(parse_urdf(text + "</robot>")).joint_names == ("j9", "j1", "j5")


def test_limits_and_dynamics(zoo):
    a, b, c, h = (zoo.joint(n) for n in ("ja", "jb", "jc", "jh"))
    assert (a.limits.lower, a.limits.upper, a.limits.velocity, a.limits.effort) == ((-1,), (2,), (3,), (4,))
    assert (a.damping, a.friction) == ((0.5,), (0.25,))
    assert (b.limits.lower, b.limits.upper) == ((-math.inf,), (math.inf,))
    assert b.limits.velocity == (1,)
    assert c.limits.effort == (math.inf,)
    assert h.limits.velocity == (math.inf,)


def test_mimic_follows_or_not(zoo):
    mimic = zoo.joint("jc").mimic
    assert (zoo.joints[mimic.source].name, mimic.multiplier, mimic.offset) == ("ja", 2.0, 0.5)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        free = model_from_urdf(parse_urdf(ALL_KINDS), mimic=False)
    assert free.joint("jc").mimic is None
    assert free.nq == zoo.nq + 1


def test_shapes_and_materials(zoo):
    base = zoo.link("base")
    skin, tube = base.visuals
    assert skin.name == "skin"
    assert skin.shape == Box((1, 2, 3))
    assert skin.material.rgba == (1, 0, 0, 0.5)
    np.testing.assert_array_equal(skin.placement.translation, [1, 2, 3])
    np.testing.assert_allclose(skin.placement.rpy(), [0, 0, 0.5], atol=1e-15)
    assert tube.shape == Cylinder(0.1, 0.4)
    assert [g.shape for g in base.collisions] == [Sphere(0.2), Capsule(0.1, 0.3)]
    # a material defined inside one visual serves others by its name
    assert zoo.link("a").visuals[0].material.rgba == (0, 1, 0, 1)


def test_inertia_is_turned_into_link_axes(zoo):
    inertia = zoo.link("base").inertia
    assert inertia.mass == 2
    np.testing.assert_array_equal(inertia.com, [0.1, 0, 0])
    # a quarter turn about z exchanges xx and yy and turns the sign of xy; exactly, as it is snapped
    np.testing.assert_array_equal(inertia.inertia, [[2, -0.1, 0], [-0.1, 1, 0], [0, 0, 2.5]])


def test_right_angles_are_exact(zoo):
    rotation = zoo.frame("jd").placement.rotation
    np.testing.assert_array_equal(rotation, [[1, 0, 0], [0, 0, -1], [0, 1, 0]])


def test_roots():
    text = '<robot name="r"><link name="a"/></robot>'
    document = parse_urdf(text)
    assert model_from_urdf(document).nq == 0
    assert model_from_urdf(document, root="free_flyer").nq == 7
    assert model_from_urdf(document, root="planar").nq == 3
    assert model_from_urdf(document, root=Revolute((0, 0, 1))).nq == 1
    assert root_kind("fixed") is None
    with pytest.raises(UnknownName, match="free_flyer"):
        model_from_urdf(document, root="freeflyer")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "iso-8859-1"])
def test_encodings(encoding):
    declared = {"utf-8-sig": "utf-8"}.get(encoding, encoding)
    text = f'<?xml version="1.0" encoding="{declared}"?>\n<robot name="r"><link name="bäse"/></robot>'
    assert parse_urdf(text.encode(encoding)).root == "bäse"
    assert parse_urdf(text).root == "bäse"


def test_default_namespace_and_foreign_tags_are_read_over():
    text = '<robot name="r" xmlns="http://www.ros.org" xmlns:x="urn:x"><x:link/><link name="a"/></robot>'
    assert [link.name for link in parse_urdf(text).links] == ["a"]
    undeclared = '<robot name="r"><gazebo><controller:thing/></gazebo><link name="a"/></robot>'
    assert parse_urdf(undeclared).root == "a"


def test_a_name_is_not_needed():
    assert parse_urdf('<robot><link name="a"/></robot>').name == "robot"


def test_links_may_come_after_joints_and_numbers_in_any_layout():
    text = """<robot name="r"><joint name="j" type="revolute"><parent link="a"/><child link="b"/>
      <origin xyz=" 1e-1\t+2.
      .5 "/><axis xyz="0 0 -1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
      <link name="b"/><link name="a"/></robot>"""
    document = parse_urdf(text)
    assert document.joints[0].origin.xyz == (0.1, 2.0, 0.5)
    assert document.root == "a"


def test_missing_meshes_are_reported_once(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_PACKAGE_PATH", "/opt/nowhere")
    visuals = "".join(
        f'<visual><geometry><mesh filename="package://gone/m{i}.stl" scale="1 2 3"/></geometry></visual>'
        for i in (1, 1, 2)
    )
    file = tmp_path / "r.urdf"
    file.write_text(f'<robot name="r">\n<link name="a">{visuals}</link></robot>')
    with pytest.warns(ModelWarning) as caught:
        model = model_from_urdf(file)
    assert len(caught) == 1
    text = str(caught[0].message)
    assert text.startswith(
        f"{file}:2: the mesh 'package://gone/m1.stl' and 1 more were not found. Looked in: "
    )
    assert "ROS_PACKAGE_PATH is /opt/nowhere" in text
    assert "package_dirs=" in text
    shapes = [g.shape for g in model.link("a").visuals]
    assert shapes[0] == Mesh("package://gone/m1.stl", (1, 2, 3), missing=True)


def test_meshes_and_textures_are_found(tmp_path):
    (tmp_path / "arm" / "urdf").mkdir(parents=True)
    (tmp_path / "arm" / "a.stl").write_bytes(b"")
    (tmp_path / "arm" / "urdf" / "t.png").write_bytes(b"")
    file = tmp_path / "arm" / "urdf" / "r.urdf"
    file.write_text(
        '<robot name="r"><link name="a"><visual><geometry><mesh filename="package://arm/a.stl"/></geometry>'
        '<material name="m"><texture filename="t.png"/></material></visual></link></robot>'
    )
    geometry = model_from_urdf(file).link("a").visuals[0]
    assert geometry.shape == Mesh(str(tmp_path / "arm" / "a.stl"))
    assert geometry.material.texture == str(tmp_path / "arm" / "urdf" / "t.png")


def test_an_unusual_thing_is_reported_once():
    visual = '<visual><geometry><box size="1 1 1"/></geometry><material name="{}">{}</material></visual>'
    colour = '<color rgba="3 0 0 1"/>'
    text = (
        f'<robot><link name="a">{visual.format("gone", "") * 3}{visual.format("loud", colour)}</link></robot>'
    )
    with pytest.warns(ModelWarning) as caught:
        document = parse_urdf(text)
    assert ["gone" in str(w.message) for w in caught] == [True, False]
    assert document.links[0].visuals[3].material.rgba == (1, 0, 0, 1)
    assert list(document.materials) == ["loud"]


def chain(n: int, mimic) -> str:
    """A chain of n joints, without the end tag; `mimic(i)` names the leader of joint i, or None."""
    text = "<robot>" + "".join(f'<link name="l{i}"/>' for i in range(n + 1))
    for i in range(n):
        follows = f'<mimic joint="{mimic(i)}"/>' if mimic(i) else ""
        ends = f'<parent link="l{i}"/><child link="l{i + 1}"/>'
        text += f'<joint name="j{i}" type="continuous">{ends}{follows}</joint>'
    return text


def test_many_oddities_cost_no_search_each():
    n = 3000
    with pytest.warns(ModelWarning) as caught:
        document = parse_urdf(chain(n, lambda i: f"gone{i}" if i % 2 else None) + "</robot>")
    assert len(caught) == n // 2
    assert not any(j.mimic for j in document.joints)


def test_long_chains_of_mimics():
    n = 3000
    assert len(parse_urdf(chain(n, lambda i: f"j{i + 1}" if i < n - 1 else None) + "</robot>").joints) == n
    with pytest.raises(FormatError, match="it mimics itself"):
        parse_urdf(chain(n, lambda i: f"j{(i + 1) % n}") + "</robot>")


def test_documents_are_values():
    plain = ALL_KINDS.replace('<axis xyz="0 0 2"/>', "")
    document = parse_urdf(plain)
    assert parse_urdf(plain) == document
    assert parse_urdf(plain.replace("0.25", "0.26")) != document
    assert pickle.loads(pickle.dumps(document)) == document


def test_what_an_element_leaves_out_has_the_values_of_the_format():
    head = '<robot name="r"><link name="a"/><link name="b"/><link name="c"/><joint name="k" type="continuous"><parent link="a"/>'
    text = (
        head
        + '<child link="c"/></joint><joint name="j" type="{}"><parent link="a"/><child link="b"/>{}</joint></robot>'
    )
    limits = UrdfLimit(lower=-1.0, upper=1.0, velocity=2.0, effort=3.0)
    for kind, more, fields in (
        ("fixed", "", {}),
        ("continuous", "", {}),
        ("continuous", "<dynamics/>", {}),
        ("continuous", '<mimic joint="k"/>', {"mimic": UrdfMimic("k")}),
        ("revolute", '<limit effort="3" velocity="2" lower="-1" upper="1"/>', {"limit": limits}),
    ):
        joint = parse_urdf(text.format(kind, more)).joints[1]
        assert joint == UrdfJoint("j", kind, "a", "b", **fields)
        assert (joint.damping, joint.friction, joint.axis) == (0.0, 0.0, (1.0, 0.0, 0.0))
        assert joint.mimic is None or (joint.mimic.multiplier, joint.mimic.offset) == (1.0, 0.0)


def test_long_chains():
    assert model_from_urdf(parse_urdf(chain(1500, lambda i: None) + "</robot>")).nq == 1500


def test_size_limit(tmp_path):
    big = tmp_path / "big.urdf"
    with open(big, "wb") as stream:
        stream.truncate(MAX_BYTES + 1)
    with pytest.raises(FormatError) as caught:
        read_urdf(big)
    assert str(caught.value) == (
        f"{big}: the file is too large; expected at most 67 MB. Meshes belong in separate files."
    )


def test_a_file_of_just_the_largest_size_is_read_to_its_end(tmp_path, monkeypatch):
    text, file = '<robot name="r"><link name="a"/></robot>', tmp_path / "one.urdf"
    file.write_text(text)
    monkeypatch.setattr(markup, "MAX_BYTES", len(text))
    assert [link.name for link in read_urdf(file).links] == ["a"]
    file.write_text(text + " ")
    with pytest.raises(FormatError, match="too large"):
        read_urdf(file)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('<axis xyz="0 0 2"/>', '<axis xyz="0 0 2"/>'), "taken as a direction only"),
        (('lower="-1" upper="2" ', ""), "neither lower nor upper is given"),
        (("<dynamics damping", "<dynamic damping"), "did you mean <dynamics>"),
        (('<mimic joint="ja"', '<mimic joint="jx"'), "there is no such joint"),
        (('<mimic joint="ja"', '<mimic joint="jd"'), "which is fixed"),
        (('rgba="1 0 0 0.5"', 'rgba="2 0 0 0.5"'), "held to it"),
        (
            ('<material name="red"/>', '<material name="rad"/>'),
            "no material 'rad' is defined; did you mean 'red'",
        ),
        (('damping="0.5"', 'damping="-0.5"'), "negative"),
        (('<mass value="2"/>', '<mass value="2"/><mass value="3"/>'), "a second <mass>"),
    ],
)
def test_oddities_warn(change, words):
    assert change[0] in ALL_KINDS
    with pytest.warns(ModelWarning) as caught:
        model_from_urdf(parse_urdf(ALL_KINDS.replace(*change)))
    assert any(words in str(w.message) for w in caught)
