"""The elements and attributes of URDF: honoured as Pinocchio honours them, warned of, or without effect.

A row is an element, an attribute, and a replacement in the document below: of a piece of it, by another.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

DOCUMENT = """<robot name="r" version="1.2">
  <link name="base"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="arm"><inertial><origin xyz=".1 .2 .3" rpy=".1 .2 .3"/><mass value="2"/>
    <inertia ixx=".2" iyy=".3" izz=".4" ixy=".01" ixz=".02" iyz=".03"/></inertial>
    <visual><origin xyz="0 0 .1"/><geometry><box size=".1 .2 .3"/></geometry></visual>
    <collision><origin xyz="0 0 .1" rpy=".1 0 0"/><geometry><box size=".1 .2 .3"/></geometry></collision></link>
  <link name="hand"><inertial><mass value="3"/><inertia ixx=".3" iyy=".3" izz=".3" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="one" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 1" rpy=".3 .2 .1"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="30" velocity="4"/><dynamics damping=".5" friction=".6"/><!--one--></joint>
  <joint name="two" type="prismatic"><parent link="arm"/><child link="hand"/><origin xyz=".5 0 0"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="2" effort="3" velocity="4"/><!--two--></joint>
  <!--robot-->
</robot>"""

Verdict = Literal["honoured", "warned", "irrelevant"]


@dataclass(frozen=True)
class Row:
    """One attribute (or the text, "") of an element, with its verdict and a change of `DOCUMENT` that shows it."""

    element: str
    attribute: str
    verdict: Verdict
    old: str
    new: str
    words: str = ""

    @property
    def name(self) -> str:
        return f"{self.element}@{self.attribute}"

    @property
    def source(self) -> str:
        assert self.old in DOCUMENT
        return DOCUMENT.replace(self.old, self.new, 1)


def honoured(element: str, attribute: str, old: str, new: str) -> Row:
    return Row(element, attribute, "honoured", old, new)


def warned(element: str, attribute: str, old: str, new: str, words: str) -> Row:
    return Row(element, attribute, "warned", old, new, words)


def irrelevant(element: str, attributes: str, old: str, new: str) -> list[Row]:
    names = attributes.split() or [""]
    return [Row(element, name, "irrelevant", old, new) for name in names]


ONE, TWO, ROBOT = "<!--one-->", "<!--two-->", "<!--robot-->"
GAZEBO = '<gazebo reference="arm"><mu1>1</mu1><kp>1</kp><turnGravityOff>true</turnGravityOff><selfCollide>1</selfCollide></gazebo>'
CONTACT = '<contact><lateral_friction value="1"/><stiffness value="1"/><damping value="1"/><restitution value="1"/></contact>'

TABLE = [
    honoured("link", "name", 'name="arm"', 'name="arm" '),
    honoured("link/inertial/origin", "xyz", 'xyz=".1 .2 .3"', 'xyz=".1 .2 .4"'),
    honoured("link/inertial/origin", "rpy", 'rpy=".1 .2 .3"', 'rpy="1 2 3"'),
    honoured("link/inertial/origin", "quat_xyzw", 'rpy=".1 .2 .3"', 'quat_xyzw=".1 .2 .3 .4"'),
    honoured("link/inertial/mass", "value", 'value="2"', 'value="2.5"'),
    *(
        honoured("link/inertial/inertia", name, f'{name}="{old}"', f'{name}="{new}"')
        for name, old, new in (
            ("ixx", ".2", ".25"),
            ("iyy", ".3", ".35"),
            ("izz", ".4", ".45"),
            ("ixy", ".01", ".015"),
            ("ixz", ".02", ".025"),
            ("iyz", ".03", ".035"),
        )
    ),
    honoured("joint", "name", 'name="one"', 'name="uno"'),
    honoured("joint", "type", 'type="prismatic"', 'type="revolute"'),
    honoured("joint", "type", 'type="prismatic"', 'type="fixed"'),
    honoured("joint/parent", "link", '<parent link="arm"/>', '<parent link="base"/>'),
    honoured("joint/child", "link", '<child link="arm"/>', '<child link="arm" />'),
    honoured("joint/origin", "xyz", 'xyz="0 0 1"', 'xyz="0 .2 1"'),
    honoured("joint/origin", "rpy", 'rpy=".3 .2 .1"', 'rpy="3 2 1"'),
    honoured("joint/origin", "quat_xyzw", 'rpy=".3 .2 .1"', 'quat_xyzw=".1 .2 .3 .4"'),
    honoured("joint/axis", "xyz", 'xyz="0 1 0"', 'xyz=".6 .8 0"'),
    honoured("joint/limit", "lower", 'lower="-1"', 'lower="-.5"'),
    honoured("joint/limit", "upper", 'upper="2"', 'upper="2.5"'),
    honoured("joint/limit", "effort", 'effort="30"', 'effort="40"'),
    honoured("joint/limit", "velocity", 'velocity="4"', 'velocity="5"'),
    honoured("joint/dynamics", "damping", 'damping=".5"', 'damping=".7"'),
    honoured("joint/dynamics", "friction", 'friction=".6"', 'friction=".7"'),
    honoured("joint/mimic", "joint", TWO, '<mimic joint="one"/>'),
    honoured("joint/mimic", "multiplier", TWO, '<mimic joint="one" multiplier="-2"/>'),
    honoured("joint/mimic", "offset", TWO, '<mimic joint="one" multiplier="-2" offset=".3"/>'),
    warned(
        "joint/limit", "acceleration", 'lower="-1"', 'lower="-1" acceleration="3"', "joint 'one' (line 9)"
    ),
    warned(
        "joint/limit", "deceleration", 'lower="-1"', 'lower="-1" deceleration="3"', "joint 'one' (line 9)"
    ),
    warned(
        "joint/limit", "jerk", 'lower="-1"', 'lower="-1" jerk="3"', "<limit acceleration deceleration jerk>"
    ),
    warned("joint/dynamics", "spring_stiffness", "damping", 'spring_stiffness="3" damping', "with a spring"),
    warned("joint/dynamics", "spring_reference", "damping", 'spring_reference="3" damping', "with a spring"),
    warned("joint/dynamics", "armature", "damping", 'armature="3" damping', "inertia of rotors"),
    warned("joint/dynamics", "rotor_inertia", "damping", 'rotor_inertia="3" damping', "inertia of rotors"),
    warned(
        "joint/drake:rotor_inertia", "value", ONE, '<drake:rotor_inertia value="3"/>', "inertia of rotors"
    ),
    warned("joint/drake:gear_ratio", "value", ONE, '<drake:gear_ratio value="3"/>', "inertia of rotors"),
    warned(
        "joint/mimic",
        "multipler",
        TWO,
        '<mimic joint="one" multipler="2"/>',
        "<mimic multipler> (meant as multiplier?)",
    ),
    warned("joint/origin", "RPY", 'rpy=".3', 'RPY=".3', "<origin RPY> (meant as rpy?) (line 8)"),
    warned("joint/limit", "efort", "effort", "efort", "<limit efort> (meant as effort?)"),
    warned(
        "loop_joint", "name", ROBOT, '<loop_joint name="l"/>', "closed loops of <loop_joint> 'l' (line 12)"
    ),
    warned("drake:linear_bushing_rpy", "", ROBOT, "<drake:linear_bushing_rpy/>", "closed loops"),
    warned(
        "gazebo/joint",
        "name",
        ROBOT,
        '<gazebo><joint name="l"/></gazebo>',
        "closed loops of <gazebo><joint> 'l'",
    ),
    warned(
        "gazebo/springStiffness",
        "",
        ROBOT,
        '<gazebo reference="one"><springStiffness>3</springStiffness></gazebo>',
        "<gazebo> with a spring or damping of <springStiffness> 'one'",
    ),
    warned(
        "gazebo/dampingFactor",
        "",
        ROBOT,
        '<gazebo reference="arm"><dampingFactor>3</dampingFactor></gazebo>',
        "damping",
    ),
    warned(
        "link/gravity",
        "",
        '<link name="arm">',
        '<link name="arm"><gravity>0</gravity>',
        "of link 'arm' (line 3)",
    ),
    warned(
        "link/kinematic",
        "",
        '<link name="arm">',
        '<link name="arm"><kinematic>1</kinematic>',
        "of link 'arm'",
    ),
    warned(
        "mujoco/compiler",
        "inertiafromgeom",
        ROBOT,
        '<mujoco><compiler inertiafromgeom="true"/></mujoco>',
        "<mujoco>",
    ),
    warned(
        "mujoco/option",
        "gravity",
        ROBOT,
        '<mujoco><option gravity="0 0 -1"/></mujoco>',
        "<mujoco> of <option>",
    ),
    *irrelevant(
        "mujoco/compiler",
        "meshdir strippath",
        ROBOT,
        '<mujoco><compiler meshdir="m" strippath="true"/></mujoco>',
    ),
    *irrelevant("link", "type", '<link name="arm">', '<link name="arm" type="laser">'),
    *irrelevant("link/gravity", "", '<link name="arm">', '<link name="arm"><gravity>1</gravity>'),
    *irrelevant("link/kinematic", "", '<link name="arm">', '<link name="arm"><kinematic>0</kinematic>'),
    *irrelevant(
        "link/origin", "xyz rpy", '<link name="arm">', '<link name="arm"><origin xyz="1 2 3" rpy="1 2 3"/>'
    ),
    *irrelevant("link/visual", "name", "<visual>", '<visual name="v">'),
    *irrelevant("link/collision", "name", "<collision>", '<collision name="v">'),
    *irrelevant("link/collision/verbose", "value", "<collision>", '<collision><verbose value="Yes"/>'),
    *irrelevant("link/contact/*", "value", '<link name="arm">', f'<link name="arm">{CONTACT}'),
    *irrelevant("joint", "dont_collapse", 'name="one"', 'name="one" dont_collapse="true"'),
    *irrelevant(
        "joint/calibration",
        "rising falling reference_position",
        ONE,
        '<calibration rising="1" falling="2" reference_position="1"/>',
    ),
    *irrelevant(
        "joint/safety_controller",
        "soft_lower_limit soft_upper_limit k_position k_velocity",
        ONE,
        '<safety_controller soft_lower_limit="-.1" soft_upper_limit=".1" k_position="1" k_velocity="1"/>',
    ),
    *irrelevant(
        "joint/dynamics",
        "D K mu_coulomb mu_viscous",
        "damping",
        'D="1" K="2" mu_coulomb="3" mu_viscous="4" damping',
    ),
    *irrelevant(
        "joint/limit",
        "command_effort current gear_velocity",
        "effort",
        'command_effort="1" current="2" gear_velocity="3" effort',
    ),
    *irrelevant("gazebo", "reference", ROBOT, GAZEBO),
    *irrelevant(
        "transmission",
        "name type",
        ROBOT,
        '<transmission name="t"><joint name="one"/><mechanicalReduction>50</mechanicalReduction></transmission>',
    ),
    *irrelevant("material", "name", ROBOT, '<material name="red"><color rgba="1 0 0 1"/></material>'),
    *irrelevant("", "name", 'name="r"', 'name="q"'),
]

SHAPES = ("geometry", "origin", "material")
"""Parts of <visual> and <collision>, which are compared with MuJoCo and Pinocchio elsewhere."""

FOREIGN = ("gazebo", "transmission", "ros2_control", "sensor", "material")
OF_LINKS = ("contact", "surface", "self_filter", "collision_checking")
"""Elements of simulators and drivers, with all below them."""
