"""Calls of Pinocchio's functions, generated of their overloads: valid ones, boundary cases, and wrong arguments.

A call is the text of an expression. Names in it are made anew for each call by `NAMES`, which works with either package.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterable, Iterator
from typing import Any

NAMES: dict[str, str] = {
    "m": "prepared[0]",
    "own_m": "prepared[0].copy()",
    "d": "data_of(m)",
    "other_d": "pin.Model().createData()",
    "q": "np.linspace(0.1, 0.6, 6)",
    "k": "np.linspace(-0.3, 0.9, 6)",
    "v": "np.linspace(-1.0, 1.0, 6)",
    "six": "np.arange(1.0, 7.0)",
    "three": "np.array([0.3, -0.2, 0.5])",
    "three_b": "np.array([-0.1, 0.4, 0.7])",
    "R": "pin.exp3(np.array([0.3, -0.2, 0.5]))",
    "T": "M.homogeneous",
    "M": "pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([-0.1, 0.4, 0.7]))",
    "mo": "pin.Motion(np.arange(1.0, 7.0))",
    "fo": "pin.Force(np.arange(2.0, 8.0))",
    "I": "pin.Inertia(2.5, np.array([0.1, 0.2, -0.1]), np.diag([0.5, 0.6, 0.7]) + 0.01)",
    "Y": "pin.Symmetric3(np.diag([1.0, 2.0, 3.0]) + 0.2)",
    "Q": "pin.Quaternion(pin.exp3(np.array([0.3, -0.2, 0.5])))",
    "AA": "pin.AngleAxis(0.3, np.array([0.0, 0.0, 1.0]))",
    "F": "pin.Frame('tool', 2, 1, pin.SE3.Identity(), pin.FrameType.OP_FRAME)",
    "forces": "filled(pin.StdVec_Force(), [pin.Force(np.arange(6.0) + i) for i in range(7)])",
    "pool": "pin.ModelPool(m, 2)",
    "G": "pin.liegroups.SE3()",
    "g": "pin.buildSampleGeometryModelManipulator(m)",
    "gd": "g.createData()",
    "go": "g.geometryObjects[0]",
    "rigid": "pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, 3, pin.LOCAL)",
    "motions": "filled(pin.StdVec_Motion(), [pin.Motion(np.arange(6.0) - i) for i in range(7)])",
    "friction": "pin.JointFrictionConstraintModel(m, [2, 3])",
    "limits": "pin.JointLimitConstraintModel(m, [2, 3], np.full(6, -1.0), np.full(6, 1.0), np.full(6, 0.5))",
    "point": "pin.PointAnchorConstraintModel(m, 3)",
    "frame_anchor": "pin.FrameAnchorConstraintModel(m, 3)",
    "touch": "pin.PointContactConstraintModel(m, 3)",
    "pseudo": "pin.PseudoInertia.FromInertia(I)",
    "cholesky": "pin.LogCholeskyParameters(np.linspace(-0.4, 0.5, 10))",
    "composite": "pin.JointModelComposite(pin.JointModelRX(), pin.SE3.Identity())",
}
"""How each name is made; `prepared`, `data_of` and `filled` are those of `answers.py`."""


def names_with_numbers(seed: int) -> dict[str, str]:
    """`NAMES`, with numbers that are drawn anew for each seed but 0."""
    if seed == 0:
        return NAMES
    draws = random.Random(seed)

    def drawn(count: int, least: float = -1.0, most: float = 1.0) -> str:
        return f"np.array({[draws.uniform(least, most) for _ in range(count)]})"

    new = {name: drawn(6) for name in ("q", "k", "v", "six")}
    new |= {"three": drawn(3), "three_b": drawn(3), "R": f"pin.exp3({drawn(3)})"}
    new |= {"M": f"pin.SE3(pin.exp3({drawn(3)}), {drawn(3)})", "mo": f"pin.Motion({drawn(6)})"}
    new |= {"fo": f"pin.Force({drawn(6)})", "Q": f"pin.Quaternion(pin.exp3({drawn(3)}))"}
    new["I"] = (
        f"pin.Inertia({draws.uniform(1, 3)}, {drawn(3, -0.1, 0.1)}, np.diag({drawn(3, 0.5, 0.7)}) + 0.01)"
    )
    new["Y"] = f"pin.Symmetric3(np.diag({drawn(3, 1.0, 3.0)}) + 0.2)"
    new["AA"] = f"pin.AngleAxis({draws.uniform(0, 1)}, np.array([0.0, 1.0, 0.0]))"
    return NAMES | new


CLASSES = {
    "Model": "m",
    "Data": "d",
    "SE3": "M",
    "Motion": "mo",
    "Force": "fo",
    "Inertia": "I",
    "Symmetric3": "Y",
    "coal.coal_pywrap.Quaternion": "Q",
    "Quaternion": "Q",
    "coal.coal_pywrap.AngleAxis": "AA",
    "AngleAxis": "AA",
    "Frame": "F",
    "StdVec_Force": "forces",
    "ModelPool": "pool",
    "LieGroup": "G",
    "GeometryModel": "g",
    "GeometryData": "gd",
    "GeometryObject": "go",
    "CollisionPair": "pin.CollisionPair(0, 1)",
    "ReferenceFrame": "pin.LOCAL",
    "ArgumentPosition": "pin.ARG1",
    "Convention": "pin.Convention.LOCAL",
    "KinematicLevel": "pin.VELOCITY",
    "GeometryType": "pin.COLLISION",
    "FrameType": "pin.FrameType.BODY",
    "JointModel": "m.joints[2]",
    "JointData": "m.joints[2].createData()",
    "JointModelComposite": "composite",
    "JointModelUniversal": "pin.JointModelUniversal(1, 0, 0, 0, 1, 0)",
    "JointModelMimic": "",
    "JointDataMimic": "",
    "JointDataMimicTpl": "",
    "RigidConstraintModel": "rigid",
    "RigidConstraintData": "rigid.createData()",
    "PointAnchorConstraintModel": "point",
    "PointAnchorConstraintData": "calculated(m, d, point)",
    "FrameAnchorConstraintModel": "frame_anchor",
    "FrameAnchorConstraintData": "calculated(m, d, frame_anchor)",
    "PointContactConstraintModel": "touch",
    "PointContactConstraintData": "calculated(m, d, touch)",
    "BaumgarteCorrectorParameters": "pin.BaumgarteCorrectorParameters(2.0, 3.0)",
    "JointFrictionConstraintModel": "friction",
    "JointFrictionConstraintData": "calculated(m, d, friction)",
    "JointLimitConstraintModel": "limits",
    "JointLimitConstraintData": "calculated(m, d, limits)",
    "StdVec_Motion": "motions",
    "CoulombFrictionCone": "pin.CoulombFrictionCone(0.4)",
    "DualCoulombFrictionCone": "pin.DualCoulombFrictionCone(0.4)",
    "BoxSet": "pin.BoxSet(-np.ones(3), np.ones(3))",
    "ProximalSettings": "pin.ProximalSettings(1e-9, 1e-6, 4)",
    "PseudoInertia": "pseudo",
    "LogCholeskyParameters": "cholesky",
    "PhysicsMaterial": "pin.PhysicsMaterial()",
    "bool": "True",
    "float": "0.4",
}
"""An example of each class."""
INTEGERS = {
    "size": "2",
    "new_size": "3",
    "num_thread": "1",
    "frame_id": "5",
    "parent_frame": "1",
    "axis": "1",
}
ARRAYS = {
    **dict.fromkeys(("q", "q0", "reference_configuration", "lower_bound"), "q"),
    **dict.fromkeys(("q1", "k", "upper_bound"), "k"),
    **dict.fromkeys(("v", "a", "tau", "v_before"), "v"),
    **dict.fromkeys(("R", "rotation", "rotation_matrix"), "R"),
    **dict.fromkeys(
        ("translation", "point", "lever", "linear", "angular", "u", "axis", "rpy", "w", "f"), "three"
    ),
    **dict.fromkeys(("rpydot", "b"), "three_b"),
    **dict.fromkeys(("array", "M", "homegeneous_matrix"), "T"),
}
OTHER_ARRAYS = (
    "v",
    "three",
    "R",
    "T",
    "np.eye(6)",
    "M.homogeneous[:3]",
    "np.arange(1.0, 8.0)",
    "np.arange(1.0, 11.0)",
)
WRONG = {
    "numpy.ndarray": ("None", "'a'", "np.zeros(2)", "v + 1j", "np.zeros((0,))", "np.full(6, np.nan)"),
    "int": ("-1", "10**6", "2**70", "'a'", "1.5"),
    "float": ("'a'", "1j", "None", "2"),
    "bool": ("'a'", "1", "None"),
    "str": ("3", "''"),
}
LEFT_OUT = re.compile(
    r".*(Viewer|Visualizer|loadFrom|saveTo|Mesh|boost_|std_|map_index|StdVec|StdMap|serialization|id$|Collision(Object|"
    r"Result|Request|Geometry|Set)|Distance(Result|Request)|BroadPhase|Contact(Patch)?(Request|Result)?$|graph|"
    r"Ellipsoid|CallBack|Exception|Deprec|__(reduce|setstate|getstate|getinit|copy|deepcopy|hash|dir|"
    r"sizeof|init_sub|reduce_ex|instance|format|new|getattr|setattr|delattr|class)|.*Urdf|.*XML|.*MJCF|.*Sdf|.*Srdf|"
    r"loadReference|loadRotor|Symmetric3.*[rR]hs|sharedMemory|map_|eigen|.*InParallel|seed|.*IndexedBy|cast|hppfcl|coal|__address__|GeometryPool).*"
)
"""What reads files, draws, is coal's, ends Pinocchio's process, or is not offered as a whole."""
OPERATORS = {"__add__": "+", "__sub__": "-", "__mul__": "*", "__xor__": "^", "__eq__": "==", "__ne__": "!="}


def example(kind: str | None, name: str) -> str | None:
    """An expression for a parameter, None where there is none."""
    if kind == "numpy.ndarray":
        return ARRAYS.get(name, "six")
    if kind == "int":
        return INTEGERS.get(name, "2")
    if kind == "str":
        return "'shoulder2_joint'" if "joint" in name or name == "name" else "'tool'"
    if kind == "object":
        return {"self": None, "joint_name": "'more'"}.get(name, "q")
    if kind in CLASSES:
        return CLASSES[kind] or None
    if kind and kind.startswith("JointModel"):
        return f"pin.{kind}({'three / np.linalg.norm(three)' if 'Unaligned' in kind else ''})"
    if kind and kind.startswith("JointData"):
        model = kind.replace("JointData", "JointModel").removesuffix("Tpl")
        return f"pin.{model}({'three / np.linalg.norm(three)' if 'Unaligned' in kind else ''}).createData()"
    return None


def calls(overloads: dict[str, list[list[list[Any]]]]) -> Iterator[tuple[str, str]]:
    """Pairs of a path and an expression."""
    for path, ways in overloads.items():
        if LEFT_OUT.fullmatch(path):
            continue
        seen = set()
        for parameters in ways:
            for text in _of_overload(path, parameters):
                if text not in seen:
                    seen.add(text)
                    yield path, text


def _of_overload(path: str, parameters: list[list[Any]]) -> Iterator[str]:
    owner, _, name = path.rpartition(".")
    first = [kind for _, kind, _ in parameters][:1]
    constructor = name == "__init__"
    bound = bool(owner) and owner[0].isupper() and (constructor or first == [owner])
    taken = parameters[1:] if bound or constructor else parameters
    target = f"pin.{owner}" if constructor else f"pin.{path}"
    this = ""
    if bound and not constructor:
        this = "own_m" if owner == "Model" else example(owner, "self") or ""
        if not this:
            return
        target = f"({this}).{name}"
    usual = [example(kind, parameter) for parameter, kind, _ in taken]
    if None in usual:
        return
    required = sum(default is None for *_, default in taken)

    def text(args: list[Any], named: str = "") -> str:
        if name in OPERATORS and len(args) == 1:
            return f"({this}) {OPERATORS[name]} ({args[0]})"
        return f"{target}({', '.join([*args, *([named] if named else [])])})"

    yield text(usual)
    if name in OPERATORS or (name.startswith("__") and not constructor):
        return
    for count in range(required, len(usual)):
        yield text(usual[:count])
    if taken and not any(re.fullmatch(r"arg\d+|object|int", p) for p, *_ in taken):
        yield text(usual[:-1], f"{taken[-1][0]}={usual[-1]}")
    arrays = [i for i, (_, kind, _) in enumerate(taken) if kind == "numpy.ndarray"]
    for other in OTHER_ARRAYS if arrays else ():
        yield text([other if i in arrays else x for i, x in enumerate(usual)])
    for i, (_, kind, _) in enumerate(taken):
        for wrong in WRONG.get(kind, ("None", "3")):
            yield text([*usual[:i], wrong, *usual[i + 1 :]])
    yield text([*usual, "3"])
    if required:
        yield text(usual[: required - 1])


def reads(properties: dict[str, Iterable[str]]) -> Iterator[tuple[str, str]]:
    """Pairs of a path and an expression that reads an attribute of an example."""
    for owner, names in properties.items():
        this = example(owner, "self")
        for name in names if this else ():
            if not LEFT_OUT.fullmatch(f"{owner}.{name}"):
                yield f"{owner}.{name}", f"({this}).{name}"
