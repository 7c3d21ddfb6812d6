"""Documented differences: which calls may differ from the toolbox's, how, of what kind, and why."""

from __future__ import annotations

import re
from typing import Any, Literal, NamedTuple

from compare import difference, nearness

Kind = Literal["fails", "wrong", "stricter", "chosen"]
KINDS: dict[Kind, str] = {
    "fails": "the toolbox fails or returns numbers from uninitialised memory, where Ulna computes",
    "wrong": "the toolbox's result contradicts its other functions, or it ignores an argument that it accepts",
    "stricter": "the toolbox accepts what it cannot use, where Ulna raises an error that says so",
    "chosen": "both have a use, and Ulna's differs on purpose",
}
OUT_OF_SCOPE: tuple[Kind, ...] = ("fails", "wrong", "stricter")
"""Kinds of calls on which no working script relies."""


class Difference(NamedTuple):
    """A difference on purpose.

    Attributes:
        kind: One of `KINDS`.
        calls: A regular expression for the keys of the calls.
        how: A regular expression for what `compare.difference` says.
        reason: Why.
        without: A regular expression of parts of texts: without them the results are the same. None where they differ in more.
    """

    kind: Kind
    calls: str
    how: str
    reason: str
    without: str | None = None


ROWS = r"(np\.vstack|\[None\]|\[:, None\])"
URDF = r"^rtb\.models\.URDF\.\w+: "
IK = r"robot\.ik\w*\("
DH = r"^(dh|mdh|puma): "
PANDA = r"^(panda|gripper|rtb\.models\.URDF\.Panda): "
MASSES = (
    "Ulna's Panda has the masses of Gaz et al. 2019, which its tables show and its `friction` and `rne` count"
)
OF_MASSES = r", m=[^()]*?G=[\d.e+-]+|, dynamics"
OF_MESHES = r", (geometry|collision)\b"
OF_COPIES = rf"{OF_MASSES}|{OF_MESHES}|, 1 gripper|[@─ ]|\b(DHRobot|URDFRobot|Robot2?)\.|\b(DHRobot|Robot2?|Panda|Puma560|Planar2)\b"


DOCUMENTED = (
    Difference("fails", r"robot\.(hessian0|hessiane)\(((tool|start|end|J0|Je)=(?!J)[^)]*|q=None)?\)", "value|WrongType for a result",
               "a Hessian without `q` is of uninitialised memory there; here of `robot.q`, or an error for a chain"),
    Difference("fails", r"panda: robot\.jacobm\(((H|start|axes)=[^)]*|q=None|end=None)?\)", "value",
               "`jacobm` without `q` is of uninitialised memory there; here of `robot.q`"),
    Difference("fails", r"jacobm\(q, J, robot\.hessian0", "no error for ValueError",
               "`jacobm(J=, H=)` there asks for an H of (6, n, n), which no function returns; here for that of `hessian0`"),
    Difference("fails", r"robot\.jacobm\(", "no error for ValueError",
               "`jacobm` of the toolbox loses its links after some other calls: 'link not in robot links'"),
    Difference("fails", r"^(dh|mdh|puma): robot \+ robot", "no error for ValueError", "links of joined robots get names that differ"),
    Difference("fails", r"^(plain|empty): .*(eval|fkine|split)\(", "no error for",
               "chains without joints are computed, with any `q`"),
    Difference("fails", r"coriolis_x\(", "no error for ValueError", "Coriolis terms of URDF robots with fixed links are computed"),
    Difference("fails", r"^(panda|gripper|rtb\.models\.URDF\.Panda): .*(accel|coriolis|gravload|inertia|itorque|jointdynamics|manipulability|payload|rne)",
               "no error for ValueError", "Ulna's Panda has the masses of Gaz et al. 2019; the toolbox's has none, so that its dynamics fail"),
    Difference("fails", r"robot\.rne\(q(=q)?(, (qd|qdd)(=\w+)?[^,]*)?\)$|robot\.rne\(q(=q)?(, (qd|qdd)(=\w+)?[^,]*)?\), robot\)$",
               "no error for", "`rne` without `qd` or `qdd` takes zero for them"),
    Difference("fails", r"robot\.rne\(.*(qd|qdd)=None", "no error for TypeError", "`rne` without `qd` or `qdd` takes zero for them"),
    Difference("fails", r"robot\.rne\(q=q, qdd=qdd\[:-1\]\)", "ShapeError for TypeError", "`rne` without `qd` or `qdd` takes zero for them"),
    Difference("fails", rf"robot\.(rne|itorque|coriolis|accel|jacob0|jacob0_analytical|jacobe|jacobm|jacob0_dot)\(.*{ROWS}",
               "no error for", "rows of configurations give rows of results"),
    Difference("fails", r"fkine_path\(q=None|jtraj\(q0=q, qf=2 \* q, t=0", "no error for", "zeros are taken for no configuration"),
    Difference("fails", r"robot\.(eval|fkine|jacobe|jacob0_analytical|manipulability)\(q=q\[:, None\]\)", "no error for ValueError",
               "a column is taken for a configuration"),
    Difference("fails", r"robot\.(jacob0|jacobe|jacob0_analytical|jacob0_dot|jacobm|fkine|manipulability)\(q=np\.r_\[q, 1\.0\]|jacob0_dot\(q=q, qd=np\.r_\[qd, 1\.0\]",
               "no error for ValueError", "coordinates beyond a robot's joints are left out in all of its kinematics, there in some"),
    Difference("fails", r"manipulability\(q=q, axes='both'\)", "no error for ValueError", "chains have a pair of measures, as robots have"),
    Difference("fails", r"\.qlim = None", "no error for ValueError", "None takes limits away"),
    Difference("fails", r"^(dh|puma|mdh): .*robot\.A\((j=|j=0, q=None)", "no error for TypeError", "`A` without `q` is at `robot.q`"),
    Difference("fails", r"rtb\.DHRobot\((links=)?dh\(\)", "no error for TypeError", "a robot serves as a list of links with every keyword"),
    Difference("fails", r"get_path\(.*robot\.links\[-1\]|get_path\(end=robot\.links\[0\]", "no error for ValueError",
               "the path from a link to itself is that link"),
    Difference("fails", r"rtb\.models\.DH\.(TwoLink|Baxter|Orion5|P8): str|robot\.base = T", "value", "the toolbox prints a base as an empty cell"),
    Difference("fails", r"^screws: .*robot\.jacobm\(", "LinAlgError for TypeError",
               "`jacobm` of the toolbox's robots of screws always fails: their `jacob0` has no `start`"),
    Difference("wrong", rf"{DH}.*robot\.(ik\w*|hessian\w|partial_fkine0|get_path|jacob0)\(.*(start|end)=|{DH}.*robot\.\w+\(.*robot\.links\[",
               "value|UnknownKey|for a result|no error", "the toolbox's DH robots accept `start` and `end` and ignore them; here they count, and unknown names raise"),
    Difference("wrong", r"partial_fkine0", "value", "the toolbox's is wrong where a joint that is derived by comes after the column's"),
    Difference("wrong", r"^(dh|puma|mdh): .*hessiane\(", "value", "the toolbox's DH robots leave the tool out of it, but not of `jacobe`"),
    Difference("wrong", r"(inertia|gravload)\(np\.arange\(robot\.n\)", "value", "the toolbox does not count masses of fixed links where they are"),
    Difference("wrong", r"jointdynamics\(", "value|TypeError for (Value|Index)Error", "the toolbox counts the motor's inertia twice"),
    Difference("wrong", r"robot\.reach$", "value", "the toolbox adds signed lengths"),
    Difference("wrong", r"^ET2? ET2?\.SE[23]\([ST]\): robot\.s$", "value", "a pose has no axis of its own"),
    Difference("wrong", r"DHLink: robot\.id = ", "value", "the toolbox prints whatever `id` is as the number of the joint"),
    Difference("wrong", r"(planar|Planar2): robot\.tool($| = (np\.eye\(3\)|None))", "value", "the tool of the toolbox's robots in the plane is a pose in space"),
    Difference("wrong", r"cinertia\(", ".*", "the toolbox's computes `inertia_x` and returns nothing"),
    Difference("wrong", r"puma: robot\.accel\(.*np\.vstack", "value", "the toolbox leaves all rows but one at zero"),
    Difference("wrong", r"^(dh|puma|mdh): .*robot\.get_path\(", "value", "the toolbox's path of a DH robot ends with None"),
    Difference("wrong", r"^screws: .*fkine\(q=np\.vstack", "value", "the toolbox takes rows for coordinates"),
    Difference("wrong", r"unit='deg'|, 'deg'\)", "value", "the toolbox converts sliding joints from degrees"),
    Difference("wrong", rf"{IK}.*pinv_damping=1\.0|{IK}.*, True, True, 1\.0", "value", "`ik_GN` of the toolbox ignores `pinv_damping`"),
    Difference("wrong", r"link of a robot: robot\.T$", "value", "a link of a robot is where the robot's `q` puts it"),
    Difference("wrong", r"^mdh: .*rne\w*\(.*(base_wrench=True|np\.arange\(6\.0\), (False, )?True)", "value",
               "with modified parameters the toolbox takes the moment at the base about the first link's origin, else about the base's"),
    Difference("wrong", r"^(dh|mdh): robot\.T = T", "value", "where a robot is follows from its base"),
    Difference("wrong", r"Tep=None", "WrongShape for a result", "no pose is an error, there a failed search"),
    Difference("wrong", rf"^(panda|arm|screws): .*{IK}.*(robot\.links\[-1\]|end=robot\.links\[0\])", "InputError for a result",
               "the chain from the last link has no joint to solve for"),

    Difference("stricter", r"jindex='x'|jindex=-1|jindices = ", "for a result", "a joint has no negative number, and none that is text"),
    Difference("stricter", r"robot\.T = ", "for a result", "where a link is follows from the configuration"),
    Difference("stricter", r"J\w?=J\[:, :-1\]|, J\[:, :-1\]|hessian0\(q, J, robot", "WrongShape for a result",
               "a Jacobian has a column for each joint; there the columns beyond it are uninitialised memory"),
    Difference("stricter", r"(append|extend|insert)\(", "for a result", "a chain holds transforms of its own kind"),
    Difference("stricter", r"robot \* 3", "for AttributeError", "a chain is multiplied by chains and transforms"),
    Difference("stricter", r"nonsense=1|Link2?\(flip", " for ", "unknown keywords raise TypeError"),
    Difference("stricter", r"='x'|= 'x'|parent = 3", "for a result", "what is no number, and no link, is refused at once"),
    Difference("stricter", r"='x'", "for a result|for TypeError", "text for numbers is refused with the name of the argument"),
    Difference("stricter", r"payload\(m=-1", "for a result", "no mass is negative"),
    Difference("stricter", r"ets='foo'|etsbox='|filename=1\.0|'dot', 1\.0", " for ", "unknown options of `graph` raise"),
    Difference("stricter", r"=np\.eye\(3\)|= np\.eye\(3\)|^planar: robot\.(base|tool) = ", "for a result", "a pose in space is (4, 4), in the plane (3, 3)"),
    Difference("stricter", r"fkine_all\(q=(np\.(vstack|r_)|q\[:-1)|twists\(q=(np\.r_|q\[:-1)|rne\(.*np\.r_\[", "ShapeError for", "a configuration has a number for each joint"),
    Difference("stricter", r"get_path\(end='nonsense'\)|jacobm\((start|end)='nonsense'", "UnknownKey", "unknown links raise"),
    Difference("fails", r"jacobm\(q=0 \* q", "value",
               "where the arm is singular the measure has no gradient: there a quotient of rounding errors, here zero"),
    Difference("stricter", r"ctraj\(.*t=2\.5", "for a result", "a count of poses is whole"),
    Difference("stricter", r"^screws: .*manipulability\(.*asada", "InputError for a result", "without masses there is no ellipsoid of inertia"),
    Difference("stricter", r"trapezoidal\(.*t=(1|2\.5)\)", "for a result", "one time makes no trapezoid"),
    Difference("stricter", r"IK_LM\(.*'foo'|p_servo\(.*'nonsense'", "UnknownOption for a result",
               "unknown methods raise; there another one is taken"),
    Difference("stricter", r"quintic_func\(q0=None|ET\.t[xyz]\(.*A\(q=None", " for ", "None is no number"),

    Difference("chosen", rf"robot\.(jacob\w*|hessian\w|itorque|rne|accel\w*)\(.*{ROWS}", "value", "rows of configurations give rows of results; the toolbox takes the first"),
    Difference("chosen", rf"{PANDA}.*(dynamics|dynamics_list|payload|friction|perturb)\b", "text|value", MASSES),
    Difference("chosen", PANDA, "text|value", MASSES, OF_MASSES),
    Difference("chosen", rf"{PANDA}robot\.urdf_(filepath|string)", "value", "Ulna's Panda is not read from that file"),
    Difference("wrong", r"^screws: .*robot\.nbranches\(", "TypeError", "the toolbox's robots of screws have a method that returns 0, others a number"),
    Difference("chosen", r"^panda chain: repr\(robot\)", "value", "matrices in reprs are without rounding errors"),
    Difference("chosen", r"^screws: .*graph\(", "value", "names that the language of graphs does not read, such as link-0, are quoted", '"'),
    Difference("chosen", r"ik_LM\(.*method='(wampler|sugihara)'", "value",
               "with damping of 1 one search in 50 meets the pose; the starts of the searches are others"),
    Difference("chosen", r"trapezoidal\(.*t=\[", "value", "where the acceleration jumps it is that after the jump, there that before it"),
    Difference("chosen", r"(nofriction|copy|perturb)\(", "value", "copies are of the robot's class, and mark its ends", OF_COPIES),
    Difference("chosen", r"robot\.Ts$", "value", "the constant part of a DH link's transforms is computed"),
    Difference("chosen", r"robot\.(id|actuator)\b", "for a result", "not offered; the error names what to use"),
    Difference("chosen", r"\.parent = 'base'", "value", "the parent of a link that is named only is None until a robot is made; `parent_name` is the name"),
    Difference("chosen", r"ctraj\(T, T, 5, ", "WrongType for a result", "`t` and `s` exclude each other"),
    Difference("chosen", rf"({URDF}|Planar_Y: ).*", "text", "that a robot has several ends is a warning, not printed",
               r"multiple end-effectors present.*\n"),
)  # fmt: skip


def documented(key: str, how: str, theirs: dict[str, Any], ours: dict[str, Any]) -> Difference | None:
    """The documented difference of a call, if there is one.

    Args:
        key: The call.
        how: What `compare.difference` says of it.
        theirs: The toolbox's result.
        ours: The result here.

    Returns:
        The difference, or None. Where the toolbox fails without a check of its arguments, `FAILS`.
    """
    for one in DOCUMENTED:
        if re.search(one.calls, key) and re.search(one.how, how) and _is_all(one, key, theirs, ours):
            return one
    if how.startswith("no error") and not theirs.get("checked"):
        return FAILS
    return None


def _is_all(one: Difference, key: str, theirs: dict[str, Any], ours: dict[str, Any]) -> bool:
    """Whether the results are the same without what a difference says that they differ in."""
    if one.without is None:
        return True
    return difference(_less(ours, one.without), _less(theirs, one.without), nearness(key)) is None


def _less(data: Any, pattern: str) -> Any:
    """Plain data, without parts of its texts."""
    if isinstance(data, str):
        return re.sub(pattern, "", data)
    if isinstance(data, (tuple, list)):
        return type(data)(_less(x, pattern) for x in data)
    return {k: _less(x, pattern) for k, x in data.items()} if isinstance(data, dict) else data


FAILS = Difference(
    "fails",
    "",
    "no error",
    "the toolbox fails within, without a check of its arguments; Ulna computes the result",
)
