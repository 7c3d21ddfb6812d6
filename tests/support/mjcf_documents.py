"""MJCF documents with a place for one element's attributes: @ in the element, % in the section of defaults.

Each document brings a class `c` of defaults, and what the attributes need to have an effect.
"""

from __future__ import annotations

CLASS = """<default><default class="c"><joint damping="2"/><geom density="500"/><site pos="0 0 .1"/><pair condim="1"/>
<tendon stiffness="0" group="1"/><equality solref=".03 1"/><general armature=".3"/><motor armature=".3"/><position armature=".3"/>
<mesh scale="2 2 2"/></default>%</default>"""


def document(worldbody: str, rest: str = "", head: str = "") -> str:
    return f"<mujoco>{head}{CLASS}<worldbody>{worldbody}</worldbody>{rest}</mujoco>"


FORE = '<body name="b" pos=".4 .2 .1"><joint name="k" axis="1 0 1" pos="0 -.2 0"/><geom name="gb" size=".1"/></body>'

OPTIONS = """<mujoco><compiler angle="radian"/><option %/><worldbody><body name="a" euler=".3 .2 .1">
<joint name="j" range="-1 1" frictionloss=".2" damping=".3" stiffness="@STIFF"/>
<geom size=".1 .2 .3" type="box" pos=".3 .1 0"/><body name="b" pos=".4 0 0"><joint name="k" axis="1 0 0" springref=".2"/>
<joint name="s" type="slide" axis="0 1 0"/><geom size=".1" pos="0 .2 0"/></body></body>
<body name="c" pos="1 0 0"><joint name="l"/><geom size=".1"/></body></worldbody>
<equality><joint joint1="l" joint2="k" polycoef="0.1 2 0 0 0"/></equality>
<actuator><motor joint="j" ctrlrange="-2 2" gear="3" damping=".1" group="3"/></actuator></mujoco>"""


def options(attributes: str, stiffness: float = 0.0) -> str:
    return OPTIONS.replace("<option %/>", f"<option {attributes}/>").replace("@STIFF", str(stiffness))


def flags(attributes: str, stiffness: float = 0.0) -> str:
    flag = f"<option><flag {attributes}/></option>"
    return OPTIONS.replace("<option %/>", flag).replace("@STIFF", str(stiffness))


COMPILER = """<mujoco><compiler @/><worldbody><body name="a" euler=".3 .2 .1"><joint name="j" range="-1 1" limited="true"/>
<geom size=".1 .2 .3" type="box" pos=".3 .1 0" group="1"/><geom size=".1 .1 .1" type="box" group="4" mass="2"/>
<body name="fixed" pos="0 1 0"><geom size=".1" contype="0" conaffinity="0"/></body></body>
<body name="m"><freejoint/><inertial mass=".5" pos=".1 0 0" diaginertia=".1 .1 .1"/><geom size=".2" pos="0 0 .1"/></body></worldbody></mujoco>"""

BALANCE = """<mujoco><compiler @/><worldbody><body name="m"><joint/>
<inertial mass=".5" pos=".1 0 0" diaginertia=".1 .1 .3"/></body></worldbody></mujoco>"""

BODY = document(
    f'<body name="a" euler="20 0 0"><joint name="j"/><geom size=".1" pos=".2 0 0"/><body name="x" @><joint name="y" axis="0 1 0"/>'
    f'<geom size=".1 .2 .3" type="box" pos=".1 .2 0"/></body>{FORE}</body>'
)
MOCAP = document('<body name="x" @><geom size=".1"/></body><body name="a"><joint/><geom size=".1"/></body>')
FUSED = document(
    '<body name="a"><joint/><geom size=".1"/><body name="x" pos="0 0 1" @><geom size=".1"/></body></body>',
    head='<compiler fusestatic="true"/>',
)
INERTIAL = document(f'<body name="a" euler="20 0 0"><joint name="j" axis="3 1 1"/><inertial @/>{FORE}</body>')
JOINT = document(
    f'<body name="a" euler="20 30 0"><joint name="j" @/><geom size=".1 .2 .3" type="box" pos=".3 .1 0"/>{FORE}</body>'
)
LONE_JOINT = JOINT.replace(FORE, "")
JOINT_GRAVCOMP = JOINT.replace('<body name="a"', '<body name="a" gravcomp="1"')
DRIVEN_JOINT = JOINT.replace("</worldbody>", '</worldbody><actuator><motor joint="j" gear="2"/></actuator>')
FREEJOINT = document(
    '<body name="a" pos="1 0 0" euler="20 0 0"><freejoint @/><geom size=".1 .2 .3" type="box" pos=".3 .1 0"/></body>'
)
GEOM = document(
    f'<body name="a" euler="20 30 0"><joint name="j"/><geom name="first" size=".05"/><geom name="g" @/>{FORE}</body>'
    '<body name="far" pos="3 0 0"><joint/><geom name="gc" size=".1"/></body>',
    head='<asset><material name="red"/></asset>',
)
TWO_PARTS = document(
    '<body name="a"><joint/><geom name="g" size=".1" contype="0" conaffinity="0"/><geom name="h" size=".2" contype="0" conaffinity="0"/></body>'
    '<body name="far" pos="3 0 0"><joint/><geom name="gc" size=".1"/></body>'
    '<body name="off" pos="5 0 0"><joint/><geom name="gd" size=".1" contype="0" conaffinity="0"/></body>',
    "<contact>@</contact>",
)
PAIR = TWO_PARTS.replace("<contact>@</contact>", '<contact><pair geom1="gc" geom2="gd" @/></contact>')
SITE = document(
    f'<body name="a" euler="20 30 0"><joint name="j"/><geom size=".1"/><site name="s" @/>{FORE}</body>'
)
FLUID = document(
    '<body name="a"><joint/><geom size=".1 .2 .3" type="box" @/></body>', head='<option density="1.2"/>'
)

MESHES = """<mujoco><compiler !/><default><default class="c"><mesh scale="2 2 2"/></default>%</default>
<asset><mesh name="t" @/></asset><worldbody><body name="a" pos="1 2 3" euler="10 20 30"><joint name="j"/>
<geom type="mesh" mesh="t" pos=".1 .2 .3" euler="40 50 60"/></body></worldbody></mujoco>"""
FITTED = """<mujoco><compiler !/><default>%</default><asset><mesh name="t" file="tetra.obj"/></asset><worldbody><body name="a"><joint/>
<geom type="box" mesh="t" @/></body></worldbody></mujoco>"""
ATTACHED = """<mujoco><asset><model name="other" file="other.xml"/></asset><worldbody><body name="a" euler="20 0 0"><joint/>
<geom size=".1" pos=".1 0 0"/><frame pos="1 0 0"><attach @/></frame></body></worldbody></mujoco>"""
OTHER = """<mujoco model="other"><compiler angle="radian"/><worldbody><body name="root" euler=".3 0 0">
<joint name="r" axis="0 1 0" range="-1 1"/><geom size=".1 .1 .3" type="box" pos=".1 .2 .3"/>
<body name="tip" pos="0 .5 0"><joint name="t"/><geom size=".1" pos=".1 0 0"/></body></body><frame name="f"><body name="under"><joint name="u"/>
<geom size=".2"/></body></frame></worldbody></mujoco>"""

TENDON = document(
    f'<site name="w" pos="0 0 2"/><body name="a" euler="20 0 0"><joint name="j"/><geom size=".1" pos=".2 0 0"/><site name="s"/>{FORE}</body>',
    "<tendon>@</tendon>",
)
SPATIAL = TENDON.replace("@", '<spatial name="t" @><site site="w"/><site site="s"/></spatial>')
FIXED = TENDON.replace("@", '<fixed name="t" @><joint joint="j" coef="2"/></fixed>')
DRIVEN_TENDON = FIXED.replace("</tendon>", '</tendon><actuator><motor tendon="t"/></actuator>')

BODIES = f"""<site name="w" pos="0 0 2"/><body name="a" euler="20 0 0"><joint name="j"/><geom size=".1" pos=".2 0 0"/><site name="s"/>{FORE}</body>
<body name="c"><joint name="l" type="slide" ref=".2"/><geom size=".1"/></body>"""
EQUALITY = document(
    BODIES,
    '<tendon><fixed name="t"><joint joint="j" coef="2"/></fixed><fixed name="u"><joint joint="k" coef="2"/></fixed></tendon>'
    "<equality>@</equality>",
)
ACTUATOR = document(
    BODIES,
    '<tendon><fixed name="t"><joint joint="k" coef="2"/></fixed></tendon><actuator><MOTOR @/></actuator>',
    head='<option actuatorgroupdisable="3"/>',
)
BALL_ACTUATOR = document(
    '<body name="a"><joint name="j" type="ball"/><geom size=".1" pos=".2 0 0"/><site name="s"/></body>',
    "<actuator><MOTOR @/></actuator>",
)
FLEX = """<mujoco><worldbody><body name="a"><joint/><geom size=".1"/></body>
<body name="b"><joint/><geom size=".1"/></body>%</worldbody>@</mujoco>"""
KEY = document(
    f'<body name="a"><joint name="j"/><geom size=".1"/>{FORE}</body><body name="f"><freejoint/><geom size=".1"/></body>',
    "<keyframe><key @/></keyframe>",
)
MOCAP_KEY = KEY.replace("</worldbody>", '<body name="m" mocap="true"/></worldbody>')
MASKS = document(
    '<body name="a"><joint/><geom size=".2" @/></body><body name="far" pos="3 0 0"><joint/><geom size=".1"/></body>'
)
SLEEP = document('<body name="x" @><joint/><geom size=".1"/></body>')
FRAMES = document(
    '<body name="a"><joint name="j"/><geom size=".1"/>@</body>', head='<option gravity="1 2 3"/>'
)
DRIVEN_SPATIAL = SPATIAL.replace("</tendon>", '</tendon><actuator><motor tendon="t"/></actuator>')
