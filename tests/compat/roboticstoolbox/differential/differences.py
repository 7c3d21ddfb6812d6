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
        r"robot\.(hessian\w|jacobm|gravload\w*|inertia_x|manipulability|accel_x|coriolis_x)\(",
        "value|no error",
        "without q the robot's own configuration counts, where the toolbox computes nan or fails",
    ),
    Difference(
        r"partial_fkine0", "value", "the toolbox's is wrong where a joint that is derived by comes after the column's"
    ),
    Difference(r"\bik\w*\(|IK_\w+: .*(solve|step)\(|ikine", ".*", "solvers are Ulna's: deterministic, and for trajectories, too"),
    Difference(r"^(panda|rtb\.models\.URDF\.Panda): ", "no error", "Ulna's Panda has masses, the toolbox's has none"),
    Difference(r"hasdynamics|dynamics\(\)|str\(robot\)|dynamics_list|ee_links|robot\.links|reach", "value|text",
               "the Panda's masses; lengths are added as magnitudes"),
    Difference(r"coriolis\w*\(|jointdynamics\(|rne\(", ".*", "URDF robots have them here; motors count once; flips count"),
    Difference(r"payload\w*\(|nofriction\(|perturb\(", "value", "payloads count in copies"),
    Difference(r"(start|end)='nonsense'", ".*", "there is no such link; the toolbox's DH robots do not look at it"),
    Difference(r"nonsense=1", "TypeError for a result", "DH robots of the toolbox ignore unknown keywords"),
    Difference(r"jindex=-1", "for a result", "a joint has no negative number"),
    Difference(r"tool=np\.eye\(3\)|= np\.eye\(3\)", "for a result", "a pose in space is (4, 4)"),
    Difference(r"cinertia\(", "value|for a result", "returns inertia_x; the toolbox's returns nothing"),
    Difference(r"^screws: ", ".*", "screws are links in frames that lie otherwise; poses of the end agree"),
    Difference(r"^[\w. ]*: robot\.T\b", ".*", "where a link is follows from the configuration"),
    Difference(r"robot\.(q|qd|qdd|parent|jindices|data|_\w+|actuator|number|children|name|We|method) = ", ".*",
               "attributes hold what they can mean, not any object"),
    Difference(r"pinv_damping", ".*", "a damped pseudoinverse is `method='wampler'`"),
    Difference(r"='x'|\('x'|None", "no error|for a result|Error for", "what is no number, or not given, raises or has a default"),
)  # fmt: skip


def documented(key: str, how: str) -> Difference | None:
    """The documented difference of a call, if there is one."""
    for one in DOCUMENTED:
        if re.search(one.calls, key) and re.search(one.how, how):
            return one
    return None
