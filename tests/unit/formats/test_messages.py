"""Errors of broken URDF files: file, line, element, and how to fix them."""

from __future__ import annotations

import pytest

from ulna.errors import FormatError
from ulna.formats.srdf import parse_srdf
from ulna.formats.urdf import model_from_urdf, read_urdf
from ulna.formats.urdf_parse import parse_urdf

HEAD = '<robot name="r">\n<link name="base"/>\n<link name="tip"/>\n'
LIMIT = '<limit lower="-1" upper="1" velocity="1" effort="1"/>'


def joint(body: str, kind: str = "revolute", name: str = "j", ends: tuple[str, str] = ("base", "tip")) -> str:
    links = f'<parent link="{ends[0]}"/><child link="{ends[1]}"/>'
    return f'<joint name="{name}" type="{kind}">{links}{body}</joint>\n'


def robot(*parts: str) -> str:
    return HEAD + "".join(parts) + "</robot>"


def link(body: str) -> str:
    return f'<robot name="r">\n<link name="base">\n{body}\n</link></robot>'


CASES = {
    # the document as a whole
    "empty": ("", "f.urdf: the file is empty. Expected a URDF: <robot> ... </robot>."),
    "blank": ("  \n ", "f.urdf: the file is empty. Expected a URDF: <robot> ... </robot>."),
    "no xml": (
        "hello",
        "f.urdf:1: this is not well-formed XML: Start tag expected, '<' not found. Is this a text",
    ),
    "truncated": (robot(joint(LIMIT))[:-30], "f.urdf:4: this is not well-formed XML: "),
    "truncated in a limit": (
        robot(joint(LIMIT)).partition(" upper")[0],
        "Look at that line and the ones above it for an unclosed tag",
    ),
    "unclosed": (
        "<robot>\n<link>\n</robot>",
        "f.urdf:3: this is not well-formed XML: Opening and ending tag mismatch",
    ),
    "deep": ("<robot>" + "<a>" * 300, "Elements may nest 256 deep"),
    "wrong root": (
        "<mujoco/>",
        "the root element is <mujoco>; expected <robot>. This is a MuJoCo model (MJCF)",
    ),
    "html": ("<html/>", "This is a web page; the download went wrong."),
    "foreign root": ("<arm/>", "the root element is <arm>; expected <robot>. This is no URDF."),
    "no links": ('<robot name="r"/>', "f.urdf:1: the robot has no links. In <robot>. Write at least"),
    "entities": (
        '<!DOCTYPE r [<!ENTITY a "x">]><robot name="&a;"/>',
        "the document type declares entities (a), which Ulna does not follow. Remove the <!DOCTYPE ...>",
    ),
    "external": ('<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot/>', "an external DTD (file:///etc/passwd)"),
    "xacro": (
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">\n<xacro:include filename="a"/></robot>',
        "f.urdf:2: <xacro:include> is xacro that was not expanded. In <robot>. Name the file *.xacro",
    ),
    "undeclared xacro": ("<robot><xacro:macro/></robot>", "<xacro:macro> is xacro that was not expanded."),
    "nested xacro": (
        '<robot xmlns:xacro="http://ros.org/xacro"><link name="a">\n<xacro:box/></link></robot>',
        "f.urdf:2: <xacro:box> is xacro that was not expanded.",
    ),
    # names
    "nameless link": (
        "<robot><link/></robot>",
        '<link> has no attribute "name" (attributes: none). In <link>.',
    ),
    "empty name": (robot('<link name=" "/>'), '<link> has an empty attribute "name".'),
    "nameless joint": (robot("<joint/>"), 'f.urdf:4: <joint> has no attribute "name"'),
    "twin links": (
        robot('<link name="tip"/>'),
        "f.urdf:4: a second link named 'tip'; the first is on line 3. In",
    ),
    "twin joints": (
        robot(joint(LIMIT), joint(LIMIT)),
        "f.urdf:5: a second joint named 'j'; the first is on line 4. In joint 'j'. Rename one of them.",
    ),
    # joints
    "unknown kind": (
        robot(joint(LIMIT, "revolut")),
        "f.urdf:4: there is no joint type 'revolut'. In joint 'j'. Did you mean 'revolute'?",
    ),
    "odd kind": (
        robot(joint(LIMIT, "xyz")),
        "There are: revolute, continuous, prismatic, fixed, floating, planar",
    ),
    "no kind": (
        robot('<joint name="j"><parent link="base"/><child link="tip"/></joint>'),
        '<joint> has no attribute "type" (attributes: name). In joint \'j\'. Write <joint type="...">.',
    ),
    "no parent": (
        robot('<joint name="j" type="fixed"><child link="tip"/></joint>'),
        "f.urdf:4: <joint> has no <parent>. In joint 'j'. Write <parent link=\"...\"/>.",
    ),
    "unknown link": (
        robot(joint(LIMIT, ends=("bas", "tip"))),
        "there is no link 'bas'. In <parent> of joint 'j'. Did you mean 'base'?",
    ),
    "no limit": (
        robot(joint("")),
        "f.urdf:4: a revolute joint needs a <limit>. In joint 'j'. "
        'Write <limit lower="..." upper="..." velocity="..." effort="..."/> [rad], '
        'or make it type="continuous".',
    ),
    "no limit, sliding": (
        robot(joint("", "prismatic")),
        "a prismatic joint needs a <limit>. In joint 'j'. Write",
    ),
    "swapped limits": (
        robot(joint('<limit lower="2" upper="1" velocity="1" effort="1"/>')),
        "lower = 2 is above upper = 1. In <limit> of joint 'j'. Exchange them.",
    ),
    "empty range": (robot(joint('<limit lower="inf" upper="inf"/>')), "no position lies between lower = inf"),
    "no axis": (
        robot(joint(LIMIT + '<axis xyz="0 0 0"/>')),
        "the axis has no direction. In <axis> of joint 'j'. Write a unit vector, such as xyz=\"0 0 1\".",
    ),
    "mimic ring": (
        '<robot><link name="a"/><link name="b"/><link name="c"/>'
        + joint(LIMIT + '<mimic joint="k"/>', ends=("a", "b"))
        + joint(LIMIT + '<mimic joint="j"/>', name="k", ends=("b", "c"))
        + "</robot>",
        "it mimics itself: j -> k -> j. In joint 'j'. One joint of the ring must be free.",
    ),
    # the tree
    "two roots": (
        robot(),
        "f.urdf:1: there are 2 links without a parent: 'base', 'tip'; expected one. In <robot>. "
        "Join them, for example by a fixed joint from 'base' to 'tip'.",
    ),
    "two parents": (
        '<robot><link name="x"/>'
        + robot(joint(LIMIT), joint(LIMIT, name="k", ends=("x", "tip"))).split("\n", 1)[1],
        "link 'tip' already has a parent, through joint 'j'. In joint 'k'. A URDF is a tree",
    ),
    "self": (robot(joint(LIMIT, ends=("tip", "tip"))), "it joins link 'tip' to itself. In joint 'j'."),
    "loop": (
        robot(joint(LIMIT), joint(LIMIT, name="k", ends=("tip", "base"))),
        "the joints form a loop: tip <- base <- tip. In joint 'j'. One link must be nobody's child.",
    ),
    "stray loop": (
        '<robot><link name="x"/>'
        + robot(joint(LIMIT), joint(LIMIT, name="k", ends=("tip", "base"))).split("\n", 1)[1],
        "Nothing joins it to the root link 'x'.",
    ),
    # numbers
    "nan": (
        robot(joint(LIMIT + '<origin xyz="0 nan 0"/>')),
        "xyz=\"nan\" is not a number (nan); expected a finite number. In <origin> of joint 'j'.",
    ),
    "inf": (
        robot(joint(LIMIT + '<origin xyz="0 -inf 0"/>')),
        'xyz="-inf" is infinite; expected a finite number.',
    ),
    "inf after an underscore": (
        robot(joint(LIMIT + '<origin xyz="0 _inf 0"/>')),
        'xyz="_inf" is not a number. In <origin> of joint',
    ),
    "words": (robot(joint(LIMIT + '<origin xyz="0 x 0"/>')), 'xyz="x" is not a number. In <origin> of joint'),
    "python numbers": (robot(joint(LIMIT + '<origin xyz="0 1_0 0"/>')), 'xyz="1_0" is not a number.'),
    "xacro number": (
        robot(joint(LIMIT + '<origin xyz="0 ${a} 0"/>')),
        "This is xacro that was not expanded;",
    ),
    "too few": (robot(joint(LIMIT + '<origin xyz="0 1"/>')), 'xyz="0 1" holds 2 values; expected 3 numbers.'),
    "commas": (
        robot(joint(LIMIT + '<origin xyz="0,1,2"/>')),
        'xyz="0,1,2" holds 1 value; expected 3 numbers. Separate the numbers with blanks, not commas.',
    ),
    "two numbers": (
        robot(joint('<limit lower="0 1" upper="2"/>')),
        'lower="0 1" is not one number. In <limit>',
    ),
    "huge": (robot(joint(LIMIT + '<origin xyz="0 1e60 0"/>')), 'xyz="1e60" is too large to compute with'),
    # links
    "no geometry": (link("<visual/>"), "f.urdf:3: <visual> has no <geometry>. In <visual> of link 'base'."),
    "unknown shape": (
        link("<visual><geometry><cilinder/></geometry></visual>"),
        "<geometry> holds <cilinder>; expected one of box, cylinder, sphere, capsule, mesh. "
        "In <geometry> of <visual> of link 'base'. Did you mean 'cylinder'?",
    ),
    "no size": (
        link("<visual><geometry><box/></geometry></visual>"),
        "In <box> of <geometry> of <visual> of link 'base'. Write <box size=\"0 0 0\">.",
    ),
    "negative size": (
        link('<visual><geometry><sphere radius="-1"/></geometry></visual>'),
        "<sphere> has a negative size -1.",
    ),
    "no file": (link("<visual><geometry><mesh/></geometry></visual>"), '<mesh> has no attribute "filename"'),
    "no mass": (
        link('<inertial><inertia ixx="1" iyy="1" izz="1"/></inertial>'),
        "<inertial> has no <mass>. In <inertial> of link 'base'. Write <mass value=\"...\"/> in kg",
    ),
    "negative mass": (
        link('<inertial><mass value="-1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'),
        "the mass is -1 kg; expected zero or more. In <inertial> of link 'base'.",
    ),
    "no inertia": (link('<inertial><mass value="1"/></inertial>'), "<inertial> has no <inertia>."),
    "half an inertia": (
        link('<inertial><mass value="1"/><inertia ixx="1" iyy="1"/></inertial>'),
        "In <inertia> of <inertial> of link 'base'. Write <inertia izz=\"...\">.",
    ),
}


@pytest.mark.filterwarnings("ignore::ulna.errors.ModelWarning")
@pytest.mark.parametrize("case", CASES, ids=str)
def test_message(case):
    text, expected = CASES[case]
    with pytest.raises(FormatError) as caught:
        parse_urdf(text, "f.urdf")
    message = str(caught.value)
    assert message.startswith("f.urdf")
    assert expected in message
    assert caught.value.file == "f.urdf"


def test_missing_file(tmp_path):
    (tmp_path / "robot.urdf").write_text("")
    with pytest.raises(FormatError, match=r"there is no such file\. Did you mean '.*robot\.urdf'\?"):
        read_urdf(tmp_path / "robto.urdf")
    with pytest.raises(FormatError, match="There is no folder"):
        read_urdf(tmp_path / "nowhere" / "robot.urdf")
    with pytest.raises(FormatError) as folder:
        read_urdf(tmp_path)
    assert str(folder.value) == f"{tmp_path}: this is a folder, not a file."
    with pytest.raises(FormatError, match="cannot be read"):
        read_urdf("a\0b.urdf")


def test_model_from_a_broken_file_names_it(tmp_path):
    file = tmp_path / "r.urdf"
    file.write_text("<robot>\n<link/></robot>")
    with pytest.raises(FormatError) as caught:
        model_from_urdf(file)
    assert (caught.value.file, caught.value.line) == (str(file), 2)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("<urdf/>", "the root element is <urdf>; expected <robot>. This is no SRDF."),
        ("<robot><group/></robot>", '<group> has no attribute "name"'),
        ('<robot><disable_collisions link1="a"/></robot>', '<disable_collisions> has no attribute "link2"'),
        (
            '<robot><group_state name="s"><joint name="j" value="x"/></group_state></robot>',
            "value=\"x\" is not a number. In joint 'j'.",
        ),
    ],
)
def test_srdf_messages(text, expected):
    with pytest.raises(FormatError) as caught:
        parse_srdf(text, "f.srdf")
    assert expected in str(caught.value)
