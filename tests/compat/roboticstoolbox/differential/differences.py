"""Documented differences: which calls may differ from the toolbox's, how, and why; docs/robotics_toolbox.md says so."""

from __future__ import annotations

import re
from typing import NamedTuple


class Difference(NamedTuple):
    """A difference on purpose.

    Attributes:
        calls: A regular expression for the keys of the calls.
        how: A regular expression for what `compare.difference` says.
        reason: Why.
    """

    calls: str
    how: str
    reason: str


DOCUMENTED = (
    Difference(
        r"robot\.(jacob\w*|hessian\w|partial_fkine0|manipulability|jacob0_dot|inertia\w*|coriolis\w*|gravload\w*|accel\w*|rne|"
        r"itorque|friction|fkine\w*|eval|jointdynamics|cinertia|twists|A)\(.*(np\.vstack|\[None\]|\[:, None\])",
        "value|no error|for a result",
        "rows of configurations give rows of results; the toolbox takes the first, fails, or returns other shapes",
    ),
    Difference(
        r"robot\.(hessian\w|jacobm|gravload\w*|inertia_x|manipulability|accel_x|coriolis_x|A)\((?!q)",
        "value|no error| for ",
        "without q the robot's own configuration counts, where the toolbox computes nan or fails",
    ),
    Difference(r"jacobm\(", "no error|value", "zero where the Jacobian is singular, where the toolbox fails or divides"),
    Difference(
        "partial_fkine0", "value", "the toolbox's is wrong where a joint that is derived by comes after the column's"
    ),
    Difference(r"\bik\w*\(|IK_\w+: .*(solve|step)\(|ikine", ".*", "solvers are Ulna's: deterministic, and for trajectories, too"),
    Difference(r"^(panda|rtb\.models\.URDF\.Panda): ", "no error|value|text", "Ulna's Panda has masses, the toolbox's has none"),
    Difference(r"^rtb\.models\.URDF\.\w+: .*gravload", "value", "masses on fixed links of URDF robots count where they are"),
    Difference(r"^rtb\.models\.URDF\.\w+: str", "value", "meshes of some URDF robots are not included, and tables say so"),
    Difference(r"representation='nonsense'", " for ", "unknown angles raise UnknownOption first"),
    Difference(r"J\[:, :-1\]", " for ", "a Jacobian has a column for each joint"),
    Difference("hessiane", "value", "of DH robots with a tool as of their chains"),
    Difference(r"^(dh|mdh|puma): .*(robot\.links\[|jacob0\(q, T, None)", "value|no error", "the toolbox's DH robots do not look at start and end"),
    Difference(r"unit='deg'", "value", "sliding joints are not converted from degrees"),
    Difference(r"q=None|np\.r_\[q, 1\.0\]", "value|no error", "q None is the robot's; coordinates beyond the joints are left out"),
    Difference(r"angle_axis|len\(robot\)|asada", "no error", "computed, where the toolbox fails"),
    Difference("dfs_links", "value", "Ulna's Panda has masses, the toolbox's has none"),
    Difference(r"reach|dynamics_list", "value|text", "lengths are added as magnitudes; links print as here"),
    Difference(r"coriolis\w*\(|jointdynamics\(|rne\(", ".*", "URDF robots have them here; motors count once; flips count"),
    Difference(r"payload\w*\(|nofriction\(|perturb\(", ".*", "payloads count in copies, and copies are of the robot's class"),
    Difference(r"(start|end)='nonsense'|robot\.hessian0\(q, J, ", ".*", "the toolbox's DH robots do not look at start and end"),
    Difference(r"nonsense=1|Link2\(flip", " for ", "unknown keywords raise TypeError first"),
    Difference(r"jindex=", "for a result", "a joint has no negative number, and none that is text"),
    Difference(r"=np\.eye\(3\)|= np\.eye\(3\)|^planar: robot\.tool = ", "for a result", "a pose in space is (4, 4), in the plane (3, 3)"),
    Difference(r"cinertia\(", "value|for a result", "returns inertia_x; the toolbox's returns nothing"),
    Difference(r"^screws: |PoE", ".*", "screws are links in frames that lie otherwise; poses of the end agree"),
    Difference(r"robot\.T\b", ".*", "where a link is follows from the configuration"),
    Difference(r"robot\.\w+ = ", ".*", "attributes hold what they can mean, not any object, and a base is printed where it stands"),
    Difference("pinv_damping", ".*", "a damped pseudoinverse is `method='wampler'`"),
    Difference(r"='x'|\('x'|None", "no error| for ", "what is no number, or not given, raises or has a default"),
    Difference(r"robot \* 3|='nonsense'|\[1, 2\]|'foo'|^planar: .*(inertia|gravload|accel)\w*\(|=3\)|append\(|insert\(|extend\(",
               " for ", "wrong arguments, and robots without masses, raise errors that say so"),
    Difference(r"fkine_path|^(empty|plain): |rtb\.DHRobot\(links=dh", "no error", "computed, where the toolbox fails"),
    Difference(r"robot\.(mesh|id|actuator)\b", "for a result", "not offered; the error names what to use"),
    Difference("get_path", "value", "the tool is a pose for DH robots, too"),
    Difference(r"ctraj\(T, T, ", "for a result", "`t` and `s` exclude each other"),
    Difference(r"robot\.(ets|fkine\w*|jacob\w*|links|ee_links)", "text", "that a robot has several ends is a warning, not printed"),
)  # fmt: skip


def documented(key: str, how: str) -> Difference | None:
    """The documented difference of a call, if there is one."""
    for one in DOCUMENTED:
        if re.search(one.calls, key) and re.search(one.how, how):
            return one
    return None
