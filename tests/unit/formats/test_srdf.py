"""SRDF files and what they give a model."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ulna.errors import ModelWarning
from ulna.formats.srdf import parse_srdf, read_srdf
from ulna.formats.srdf_apply import with_srdf
from ulna.formats.urdf import model_from_urdf
from ulna.formats.urdf_parse import parse_urdf

SRDF = """<robot name="r">
  <group name="arm"><chain base_link="base" tip_link="c"/></group>
  <group name="upper"><joint name="ja"/><joint name="gone"/></group>
  <group name="tip"><link name="c"/><link name="base"/></group>
  <group name="both"><group name="upper"/><group name="tip"/><group name="both"/><group name="no"/></group>
  <group name="none"><joint name="gone"/></group>
  <group_state name="home" group="arm"><joint name="ja" value="0.5"/><joint name="jb" value="0. 1."/>
     <joint name="r/jc" value="0.1"/><joint name="root_joint" value="0 0 0.5 0 0 0 2"/></group_state>
  <group_state name="elsewhere"><joint name="gone" value="1"/></group_state>
  <virtual_joint name="world_joint" type="planar" parent_frame="odom" child_link="base"/>
  <end_effector name="hand" parent_link="c" group="tip"/>
  <passive_joint name="wheel"/>
  <disable_collisions link1="b" link2="a" reason="Adjacent"/>
  <disable_collisions link1="a" link2="b"/>
  <disable_collisions link1="a" link2="gone"/>
  <rotor_params><joint name="ja" mass="0.5" gear_ratio="100"/></rotor_params>
  <specificities><feet/></specificities>
</robot>"""

URDF = """<robot name="r"><link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
  <joint name="ja" type="revolute"><parent link="base"/><child link="a"/><limit lower="-1" upper="1"/></joint>
  <joint name="jb" type="continuous"><parent link="a"/><child link="b"/></joint>
  <joint name="jc" type="prismatic"><parent link="b"/><child link="c"/><limit lower="0" upper="1"/></joint>
  <joint name="jd" type="continuous"><parent link="a"/><child link="d"/></joint></robot>"""


def test_document():
    document = parse_srdf(SRDF)
    assert document.groups["arm"].chains == (("base", "c"),)
    assert document.states[0].values["root_joint"] == (0, 0, 0.5, 0, 0, 0, 2)
    assert document.virtual_joints[0].kind == "planar"
    assert document.end_effectors[0].parent_link == "c"
    assert document.passive_joints == ("wheel",)
    assert document.rotors == {"ja": (0.5, 100.0)}


def test_fixed_base():
    model = with_srdf(model_from_urdf(parse_urdf(URDF)), parse_srdf(SRDF))
    assert list(model.configurations) == ["home"]
    np.testing.assert_allclose(model.configurations["home"], [0.5, math.pi / 2, 0.1, 0.0])
    assert model.groups == {
        "arm": ("ja", "jb", "jc"),
        "upper": ("ja",),
        "tip": ("jc",),
        "both": ("ja", "jc"),
    }
    assert model.disabled_pairs == (("a", "b"),)


def test_free_flyer_gets_a_unit_quaternion():
    model = with_srdf(model_from_urdf(parse_urdf(URDF), root="free_flyer"), parse_srdf(SRDF))
    np.testing.assert_allclose(model.configurations["home"][:7], [0, 0, 0.5, 0, 0, 0, 1])


def test_applying_twice_changes_nothing():
    once = with_srdf(model_from_urdf(parse_urdf(URDF)), parse_srdf(SRDF))
    assert with_srdf(once, parse_srdf(SRDF)) == once


def test_duplicate_elements_warn():
    with pytest.warns(ModelWarning, match="a second group 'g'"):
        parse_srdf('<robot><group name="g"/><group name="g"/></robot>')
    with pytest.warns(ModelWarning, match="a second value for joint 'j'"):
        parse_srdf(
            '<robot><group_state name="s"><joint name="j" value="0"/>'
            '<joint name="j" value="1"/></group_state></robot>'
        )


def test_states_of_one_name_are_one_configuration():
    text = """<robot><group_state name="home" group="left"><joint name="ja" value="0.5"/></group_state>
      <group_state name="home" group="right"><joint name="jd" value="0.25"/></group_state></robot>"""
    model = with_srdf(model_from_urdf(parse_urdf(URDF)), parse_srdf(text))
    np.testing.assert_array_equal(model.configurations["home"], [0.5, 0.0, 0.0, 0.25])


def test_positions_that_are_ignored_warn():
    text = """<robot><group_state name="home"><joint name="ja" value="0.5 1"/><joint name="jc" value="1"/></group_state>
      <group_state name="home"><joint name="jc" value="0.5"/><joint name="jd" value="0.25"/></group_state></robot>"""
    document = parse_srdf(text, "r.srdf")
    with pytest.warns(ModelWarning) as warned:
        model = with_srdf(model_from_urdf(parse_urdf(URDF)), document)
    np.testing.assert_array_equal(model.configurations["home"], [0.0, 0.0, 1.0, 0.25])
    assert [str(w.message) for w in warned] == [
        "r.srdf: group_state 'home' has 2 values for joint 'ja', which has 1; it is ignored.",
        "r.srdf: group_state 'home' has a second position of joint 'jc'; it is ignored.",
    ]


def test_file(tmp_path):
    (tmp_path / "r.srdf").write_text(SRDF)
    assert read_srdf(tmp_path / "r.srdf").file == str(tmp_path / "r.srdf")
