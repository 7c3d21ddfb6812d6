"""xacro files are expanded on loading."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from ulna.errors import FormatError, MissingExtra
from ulna.formats.urdf_parse import parse_urdf
from ulna.formats.xacro import expand_xacro

pytest.importorskip("xacro")

TOP = """<?xml version="1.0"?>
<robot name="twins" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="name" default="base"/>
  <xacro:property name="length" value="${0.5 * 2}"/>
  <xacro:include filename="$(find arm_parts)/parts.xacro"/>
  <link name="$(arg name)"/>
  <xacro:segment name="one" parent="$(arg name)"/>
  <xacro:segment name="two" parent="one"/>
</robot>"""

PARTS = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="segment" params="name parent">
    <link name="${name}"/>
    <joint name="joint_${name}" type="continuous"><parent link="${parent}"/><child link="${name}"/>
      <origin xyz="0 0 ${length}"/></joint>
  </xacro:macro>
</robot>"""


@pytest.fixture
def file(tmp_path):
    (tmp_path / "arm_parts").mkdir()
    (tmp_path / "arm_parts" / "parts.xacro").write_text(PARTS)
    (tmp_path / "robot").mkdir()
    path = tmp_path / "robot" / "arm.urdf.xacro"
    path.write_text(TOP)
    return path


def test_macros_arguments_and_packages_without_ros(file):
    document = parse_urdf(expand_xacro(file), str(file))
    assert document.root == "base"
    assert [j.name for j in document.joints] == ["joint_one", "joint_two"]
    assert document.joints[0].origin.xyz == (0, 0, 1)
    assert parse_urdf(expand_xacro(file, {"name": "other"})).root == "other"


def test_the_package_is_left_as_it_was(file):
    from xacro import substitution_args

    before = substitution_args._eval_find
    expand_xacro(file)
    assert substitution_args._eval_find is before


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            ("$(find arm_parts)", "$(find arm_prats)"),
            "there is no package 'arm_prats' for $(find arm_prats). Set ROS",
        ),
        (('"${0.5 * 2}"', '"${0.5 * twp}"'), "xacro does not expand it"),
        (('<xacro:arg name="name" default="base"/>', ""), "Undefined substitution argument name"),
        (("</robot>", ""), "xacro does not expand it"),
        (("xacro:segment name", "xacro:segmnt name"), "xacro does not expand it"),
    ],
)
def test_refusals(file, change, words):
    assert change[0] in TOP
    file.write_text(TOP.replace(*change))
    with pytest.raises(FormatError) as caught:
        expand_xacro(file)
    assert words in str(caught.value)
    assert caught.value.file == str(file)
    assert "\n" not in str(caught.value)
    place = re.search(r"line (\d+)", str(caught.value).partition("xacro does not expand it")[2])
    assert caught.value.line == (int(place[1]) if place else None)
    if change[0] == "</robot>":  # the parser of XML names a place
        assert caught.value.line == len(TOP.splitlines())


def test_missing_file(tmp_path):
    with pytest.raises(FormatError, match="no such file"):
        expand_xacro(tmp_path / "none.xacro")


def test_without_the_package(file, monkeypatch):
    monkeypatch.setitem(sys.modules, "xacro", None)
    with pytest.raises(MissingExtra, match=r"pip install .*'xacro>="):
        expand_xacro(file)


def test_it_is_not_imported_for_other_files():
    code = "import sys, ulna.loading; sys.exit('xacro' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
