"""What the calls are made on: objects and functions of the toolbox, by the expressions that make them.

Names in the expressions: `rtb`, `sm`, `np`, and those of `SETUP`.
"""

from __future__ import annotations

from typing import NamedTuple

SETUP = """
from spatialmath import SE2, SE3
ET, ETS, ET2, ETS2, Link, Link2 = rtb.ET, rtb.ETS, rtb.ET2, rtb.ETS2, rtb.Link, rtb.Link2
T = SE3(0.3, 0.2, 0.4) * SE3.RPY(0.3, 0.2, 0.5)
S = SE2(0.3, 0.2, 0.4)
BODY = dict(m=1.5, r=[0.1, 0.02, 0.03], I=[0.02, 0.03, 0.04, 0.001, 0.002, 0.003])
MOTOR = dict(Jm=1e-4, G=50.0, B=1e-3, Tc=[0.02, -0.03])
def chain():
    return ET.tz(0.5) * ET.Rz() * ET.tx(0.4) * ET.Ry(qlim=[-2, 2]) * ET.tz(0.3) * ET.tx(qlim=[0, 1]) * ET.Rx(0.3)
def plain():
    return ET.Rx(0.3) * ET.Rx(0.2) * ET.tx(1) * ET.ty(2) * ET.SE3(T) * ET.Rz(np.pi / 2) * ET.tx(0.5)
def flat():
    return ET2.R() * ET2.tx(1) * ET2.R(flip=True) * ET2.tx(0.5)
def arm():
    one = Link(ET.tz(0.3) * ET.Rz(), name="one", qlim=[-2, 2], **BODY, **MOTOR)
    two = Link(ET.tx(0.4) * ET.Ry(), name="two", parent=one, **BODY)
    three = Link(ET.tz(0.2) * ET.Rx(qlim=[0, 0.5]), name="three", parent=two, **BODY)
    return rtb.Robot([one, two, three, Link(ETS(ET.tx(0.1)), name="end", parent=three)], name="arm")
def dh():
    links = [rtb.RevoluteDH(d=0.3, alpha=np.pi / 2, offset=0.1, qlim=[-2, 2], **BODY, **MOTOR)]
    links += [rtb.RevoluteDH(a=0.4, alpha=0.2, **BODY), rtb.PrismaticDH(theta=0.3, a=0.1, qlim=[0, 1], **BODY)]
    return rtb.DHRobot(links, name="dh", tool=SE3(0.1, 0, 0.2))
def mdh():
    links = [rtb.RevoluteMDH(d=0.3, **BODY), rtb.RevoluteMDH(a=0.4, alpha=0.2, offset=0.3, **BODY)]
    return rtb.DHRobot([*links, rtb.PrismaticMDH(theta=0.3, alpha=0.1, qlim=[0, 1], **BODY)], name="mdh")
PANDA = rtb.models.Panda().ets()
def screws():
    links = [rtb.PoERevolute([0, 0, 1], [0, 0, 0]), rtb.PoERevolute([0, 1, 0], [0.4, 0, 0.2])]
    return rtb.PoERobot(links, SE3(0.5, 0, 0.2))
"""


class Subject(NamedTuple):
    """An object to call the methods of.

    Attributes:
        name: What the calls are named after.
        group: Under which results are counted.
        make: The expression that makes it.
        joints: How many joint coordinates it takes.
        changing: Whether methods that change it are called, each on a new object.
        only: Names of members to which the calls are confined; empty for all public ones.
    """

    name: str
    group: str
    make: str
    joints: int = 0
    changing: bool = True
    only: tuple[str, ...] = ()


SUBJECTS = (
    *(
        Subject(f"ET {text}", "ET", text)
        for text in (
            "ET.Rx()", "ET.Rz(0.3)", "ET.tx(1)", "ET.tz(qlim=[0, 1])", "ET.Ry(flip=True, jindex=2)", "ET.SE3(T)",
            "ET.Ry(45, 'deg')",
        )
    ),
    *(Subject(f"ET2 {text}", "ET", text) for text in ("ET2.R()", "ET2.R(0.3)", "ET2.tx(1)", "ET2.ty()", "ET2.SE2(S)")),
    Subject("chain", "ETS", "chain()", 3),
    Subject("plain", "ETS", "plain()", 0),
    Subject("empty", "ETS", "ETS()", 0),
    Subject("panda chain", "ETS", "rtb.models.Panda().ets()", 7, changing=False),
    Subject("flat", "ETS", "flat()", 2),
    Subject("moving link", "Link", "Link(ET.tz(0.3) * ET.Rz(), name='one', qlim=[-2, 2], **BODY, **MOTOR)"),
    Subject("fixed link", "Link", "Link(ETS(ET.tz(0.3)), name='fixed')"),
    Subject("link of a robot", "Link", "arm().links[1]"),
    Subject("flat link", "Link", "Link2(ETS2(ET2.tx(1) * ET2.R()), name='flat')"),
    Subject("RevoluteDH", "Link", "rtb.RevoluteDH(d=0.1, a=0.2, alpha=0.3, offset=0.1, qlim=[-1, 1], **BODY, **MOTOR)"),
    Subject("PrismaticDH", "Link", "rtb.PrismaticDH(theta=0.1, a=0.2, alpha=0.3, offset=0.1, **BODY)"),
    Subject("RevoluteMDH", "Link", "rtb.RevoluteMDH(d=0.1, a=0.2, alpha=0.3, flip=True)"),
    Subject("PrismaticMDH", "Link", "rtb.PrismaticMDH(theta=0.1, alpha=0.3)"),
    Subject("DHLink", "Link", "rtb.DHLink(0, 0.2, 0.3, 0.4, sigma=1)"),
    Subject("arm", "Robot", "arm()", 3),
    Subject("panda", "Robot", "rtb.models.Panda()", 7, changing=False),
    Subject("planar", "Robot", "rtb.models.ETS.Planar2()", 2),
    Subject("dh", "DHRobot", "dh()", 3),
    Subject("mdh", "DHRobot", "mdh()", 3),
    Subject("puma", "DHRobot", "rtb.models.DH.Puma560()", 6, changing=False),
    Subject("screws", "PoERobot", "screws()", 2),
    Subject("gripper", "Gripper", "rtb.models.Panda().grippers[0]", 2, changing=False),
    Subject("new gripper", "Gripper", "rtb.Gripper([Link(ETS(ET.ty(qlim=[0, 1])), name='finger')], name='hand')", 1),
    Subject("IK_LM", "IK", "rtb.IK_LM(seed=1)", 7),
    Subject("IK_NR", "IK", "rtb.IK_NR(pinv=True, seed=1)", 7),
    Subject("IK_GN", "IK", "rtb.IK_GN(pinv=True, seed=1)", 7),
    Subject("IK_QP", "IK", "rtb.IK_QP(seed=1)", 7, only=("kj", "ks", "name", "error")),
    Subject("IKSolution", "IK", "rtb.IKSolution(np.arange(3.0), True, 5, 2, 1e-9)", 3),
    Subject("failed IKSolution", "IK", "rtb.IKSolution(None, False, reason='no')", 3),
    Subject("jtraj", "Trajectory", "rtb.jtraj([0, 1], [1, 3], 5)", 2),
    Subject("trapezoidal", "Trajectory", "rtb.trapezoidal(0, 1, 5)", 1),
)  # fmt: skip

CONSTRUCTORS = {
    "ET": (
        "ET.Rx", "ET.Ry", "ET.Rz", "ET.tx", "ET.ty", "ET.tz", "ET.SE3", "ET2.R", "ET2.tx", "ET2.ty", "ET2.SE2",
    ),
    "ETS": ("ETS", "ETS2"),
    "Link": (
        "Link", "Link2", "rtb.DHLink", "rtb.RevoluteDH", "rtb.PrismaticDH", "rtb.RevoluteMDH", "rtb.PrismaticMDH",
    ),
    "Robot": ("rtb.Robot", "rtb.ERobot", "rtb.Robot2"),
    "DHRobot": ("rtb.DHRobot",),
    "PoERobot": ("rtb.PoERobot", "rtb.PoERevolute", "rtb.PoEPrismatic"),
    "Gripper": ("rtb.Gripper",),
    "IK": ("rtb.IK_LM", "rtb.IK_NR", "rtb.IK_GN", "rtb.IK_QP", "rtb.IKSolution"),
    "Trajectory": (
        "rtb.jtraj", "rtb.ctraj", "rtb.mtraj", "rtb.mstraj", "rtb.quintic", "rtb.quintic_func", "rtb.trapezoidal",
        "rtb.trapezoidal_func",
    ),
    "tools": (
        "rtb.p_servo", "rtb.angle_axis", "rtb.angle_axis_python", "rtb.trchain", "rtb.trchain2", "rtb.tools.null",
        "rtb.jsingu", "rtb.jacobian_numerical", "rtb.hessian_numerical", "rtb.rtb_get_param",
    ),
}  # fmt: skip
"""Classes and functions that are called themselves, by group."""

MODELS = {
    "DH": (
        "AL5D", "Ball", "Baxter", "Coil", "Cobra600", "Hyper", "Hyper3d", "IRB140", "Jaco", "KR5", "LWR4",
        "Mico", "Orion5", "P8", "Panda", "Planar2", "Planar3", "Puma560", "Sawyer", "Stanford", "TwoLink",
        "UR10", "UR3", "UR5",
    ),
    "ETS": ("Frankie", "GenericSeven", "Panda", "Planar2", "Planar_Y", "Puma560", "XYPanda"),
    "URDF": ("LBR", "Panda", "Puma560", "px100", "px150", "rx150", "rx200", "vx300", "wx200", "wx250"),
}  # fmt: skip
"""Robots that both packages have without fetching anything."""
