"""Misspelt elements and attributes of model files are named; what vendors add is not."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import ulna
from ulna.errors import ModelWarning
from ulna.formats.srdf import parse_srdf
from ulna.formats.urdf_parse import parse_urdf

URDF = """<robot name="arm"><link name="a"/><link name="b">
<inertial><origin xyz="0 0 1"/><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><origin xyz="0 0 1"/><geometry><sphere radius="1"/></geometry></visual>
<collision><origin xyz="0 0 1"/><geometry><box size="1 1 1"/></geometry></collision></link>
<joint name="j" type="revolute"><origin xyz="0 0 1" rpy="0 0 1"/><parent link="a"/><child link="b"/>
<axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"""

SRDF = """<robot name="arm"><group name="all"><joint name="j"/></group>
<group_state name="home" group="all"><joint name="j" value="0.5"/></group_state>
<disable_collisions link1="a" link2="b" reason="Adjacent"/>
<rotor_params><joint name="j" mass="1e-4" gear_ratio="100"/></rotor_params></robot>"""


@pytest.mark.parametrize(
    ("there", "wrong", "said"),
    [
        ("<inertial><origin", "<inertial><orign", "<orign> is not known.*did you mean <origin>"),
        ("<visual><origin", "<visual><orgin", "<orgin> is not known.*did you mean <origin>"),
        ("<collision><origin", "<collision><orign", "<orign> is not known.*did you mean <origin>"),
        ("<axis", "<axes", "<axes> is not known.*did you mean <axis>"),
        ("<joint", '<lnk name="c"/><joint', "<lnk> is not known.*did you mean <link>"),
        ('rpy="0 0 1"', 'rot="0 0 1"', r"<origin rot> \(known: xyz, rpy, quat_xyzw\)"),
        ('ixy="0"', 'iyx="0.1"', r"<inertia iyx> \(known: ixx, ixy"),
        ('velocity="1"', 'vel="1"', r"<limit vel> \(meant as velocity\?\)"),
    ],
)
def test_misspellings_in_urdf(there: str, wrong: str, said: str) -> None:
    assert URDF.count(there) == 1
    with pytest.warns(ModelWarning, match=said):
        parse_urdf(URDF.replace(there, wrong))


@pytest.mark.parametrize(
    ("there", "wrong", "said"),
    [
        ("<group name", "<grup name", "<grup> is not known.*did you mean <group>"),
        ("<disable_collisions", "<disable_collision", "did you mean <disable_collisions>"),
        ('group="all"', 'grup="all"', "attribute 'grup' is not known and is ignored; did you mean 'group'"),
        ('gear_ratio="100"', 'gear_rato="100"', "did you mean 'gear_ratio'"),
        ('all"><joint name="j"/>', 'all"><joints name="j"/>', "<joints> is not known.*did you mean <joint>"),
        ("<disable_collisions ", "<enable_collisions ", "<enable_collisions> is not read"),
    ],
)
def test_misspellings_in_srdf(there: str, wrong: str, said: str) -> None:
    assert SRDF.count(there) == 1
    text = SRDF.replace(there, wrong)
    if wrong == "<grup name":
        text = text.replace("</group>", "</grup>")
    with pytest.warns(ModelWarning, match=said):
        parse_srdf(text)


def test_what_is_right_or_a_vendors_is_silent() -> None:
    extensions = (
        '<gazebo reference="b"><material>Red</material></gazebo><transmission name="t"><joint name="j"/></transmission>'
        '<ros2_control name="r" type="system"><hardware/></ros2_control><vendor_data x="1"/>'
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parse_urdf(URDF.replace("</robot>", extensions + "</robot>"))
        parse_urdf(URDF.replace('effort="1"', 'effort="1" current="3" command_effort="2"'))
        parse_srdf(SRDF)
        parse_srdf(SRDF.replace("</robot>", "<vendor_data/></robot>"))


MJCF = """<mujoco><worldbody><body><joint name="j" axis="0 1 0"/><geom size="0.1"/>
<body pos="0 0 1"><joint name="k" axis="0 1 0"/><geom size="0.1"/></body></body></worldbody>
<equality><joint joint1="k" joint2="j" polycoef="0 2 0 0 0"/></equality>
<keyframe><key name="home" qpos="0.1 0.2"/><key name="odd" qpos="0.1 0.9"/></keyframe></mujoco>"""


def test_keyframes_that_violate_an_equality_are_named() -> None:
    pytest.importorskip("mujoco")
    with pytest.warns(
        ModelWarning, match=r"key 'odd'.* where 'k' is at 0.9, and follows 'j' to 0.2"
    ) as found:
        robot = ulna.load(MJCF)
    assert len(found) == 1 and "'home'" not in str(found[0].message)
    np.testing.assert_allclose(robot.configurations["odd"], [0.1])
