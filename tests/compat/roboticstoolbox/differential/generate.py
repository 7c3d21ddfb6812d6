"""Generates calls from the signatures of the installed toolbox: `python generate.py FILE` writes them as JSON.

Each public method and property of the subjects is called with its required arguments, and then with each value of
`values.py` for each parameter in turn, by keyword and, for the first values, by position.
"""

from __future__ import annotations

import inspect
import json
import sys
from collections.abc import Iterator
from typing import Any, NamedTuple

from subjects import CONSTRUCTORS, MODELS, SETUP, SUBJECTS, Subject
from values import MORE_KEYWORDS, OF_MEMBER, VALUES

SKIPPED = {
    "plot", "teach", "plot_ellipse", "plot_vellipse", "plot_fellipse", "vellipse", "fellipse", "showgraph", "qplot",
    "linkcolormap", "set_default_backend", "default_backend",  # pictures
    "attach", "attach_to", "scene_children", "scene_parent", "tree", "tree_children", "update",  # the scene
    "geometry", "collision", "fkine_geometry", "iscollided", "isselfcollided", "collided", "closest_point",
    "link_collision_damper", "vision_collision_damper", "joint_velocity_damper",  # tests of shapes compare these
    "fknm", "random_q", "URDF", "ikine_6s", "analytic_ik", "ikine_analytic", "ikine_a", "delete_rne", "rne_python",
    "dotfile", "fdyn", "axis_func", "robot", "basemesh", "actuator",
    "ikine_QP",  # its solver is not installed
}  # fmt: skip
CHANGING = (
    "addconfiguration", "addconfiguration_attr", "append", "clear", "extend", "insert", "payload", "pop", "remove",
    "reverse", "dynchanged", "addlink",
)  # fmt: skip
"""Members that change an object: they are called on one that is made for them."""
OF_JOINTS = ("ik", "jacob", "hessian", "manipul", "partial")  # beginnings of methods that need joints
"""Members that other tests compare, that draw, or whose results are random."""
CONSTANT_MEMBERS = 2  # how many values of a parameter are passed by position, too


class Call(NamedTuple):
    """A call to make in both packages.

    Attributes:
        key: What it is called.
        group: Under which it counts.
        subject: The expression of the object that `robot` stands for.
        joints: How many joint coordinates it takes.
        keep: Whether one object serves all calls.
        code: The expression to evaluate, or statements that set `value`.
    """

    key: str
    group: str
    subject: str
    joints: int
    keep: bool
    code: str


def parameters_of(function: Any) -> list[inspect.Parameter] | None:
    """The parameters of a function without `self`; None where they are not known."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return None
    return [p for p in parameters if p.name != "self"]


def values_of(member: str, name: str, joints: int) -> tuple[str, ...]:
    """Expressions for a parameter."""
    texts = OF_MEMBER.get(member, {}).get(name) or VALUES.get(name) or ("None", "1.0", "'x'")
    return tuple(_filled(text, joints) for text in texts)


def _filled(text: str, joints: int) -> str:
    for mark, name in (("{0}", "q"), ("{1}", "qd"), ("{2}", "qdd"), ("{n}", str(joints))):
        text = text.replace(mark, name)
    return text


def arguments(member: str, parameters: list[inspect.Parameter], joints: int) -> Iterator[str]:
    """Argument lists, as text."""
    plain = [p for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.POSITIONAL_ONLY)]
    required = [p.name for p in plain if p.default is p.empty]
    base = {name: values_of(member, name, joints)[0] for name in required}
    yield _text([], base)
    optional = [p.name for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
    keywords = [p for p in parameters if p.kind is p.VAR_KEYWORD]
    optional += [name for name in (MORE_KEYWORDS.get(member, ()) if keywords else ()) if name not in optional]
    for name in optional:
        for text in values_of(member, name, joints):
            yield _text([], base | {name: text})
    for count in range(len(required) + 1, len(plain) + 1):
        for k in range(CONSTANT_MEMBERS):
            chosen = [values_of(member, p.name, joints) for p in plain[:count]]
            yield _text([*(texts[0] for texts in chosen[:-1]), chosen[-1][k % len(chosen[-1])]], {})
    yield _text([], base | {"nonsense": "1"})


def _text(positional: list[str], named: dict[str, str]) -> str:
    return ", ".join([*positional, *(f"{name}={text}" for name, text in named.items())])


def calls_of(subject: Subject, thing: Any) -> Iterator[Call]:
    """The calls of a subject, given an object of the toolbox."""
    keep = not subject.changing
    for member in sorted({*dir(type(thing)), *getattr(thing, "__dict__", ())}):
        if member.startswith("_") or member in SKIPPED:
            continue
        if subject.only and member not in subject.only:
            continue
        if not subject.joints and subject.group == "ETS" and member.startswith(OF_JOINTS):
            continue
        static = inspect.getattr_static(thing, member, None)

        def call(code: str, member: str = member) -> Call:
            kept = keep and member not in CHANGING
            return Call(f"{subject.name}: {code}", subject.group, subject.make, subject.joints, kept, code)

        if isinstance(static, property) or not callable(getattr(type(thing), member, None)):
            yield call(f"robot.{member}")
            if subject.changing and (not isinstance(static, property) or static.fset):
                for text in values_of("=", member, subject.joints):
                    yield call(f"robot.{member} = {text}\nvalue = (robot.{member}, robot)")
            continue
        parameters = parameters_of(getattr(type(thing), member))
        for text in arguments(member, parameters, subject.joints) if parameters is not None else ("",):
            code = f"robot.{member}({text})"
            if member == "payload":
                code += ", robot.gravload(q)"
            changes = subject.changing or member in CHANGING
            yield call(f"value = ({code}, robot)" if changes else code)
    for text in (
        "str(robot)",
        "repr(robot)",
        "len(robot)",
        "list(robot)",
        "robot * robot",
        "robot + robot",
        "robot == robot",
        "robot[0]",
        "robot[99]",
        "bool(robot)",
        "robot * 3",
    ):
        yield call(text) if keep or "*" not in text else call(f"value = {text}")


def constructor_calls(namespace: dict[str, Any]) -> Iterator[Call]:
    """The calls of classes and functions themselves."""
    for group, names in CONSTRUCTORS.items():
        for name in names:
            function = eval(name, namespace)
            parameters = parameters_of(function)
            if parameters is None:
                continue
            member = name.rpartition(".")[2]
            for text in arguments(member, parameters, 2):
                code = f"{name}({text})"
                if member in ("quintic_func", "trapezoidal_func"):
                    code = f"[{code}(at) for at in (0.0, 0.3, 9.0, np.array([0.1, 1.0]))]"
                yield Call(code, group, "None", 2, False, code)


def model_calls() -> Iterator[Call]:
    """The calls of the models: what each is, and what it computes."""
    for kind, names in MODELS.items():
        for name in names:
            make = f"rtb.models.{kind}.{name}()"
            for text in (
                "robot.n", "robot.name", "robot.manufacturer", "robot.structure", "robot.qlim", "str(robot)", "robot.ets()",
                "robot.configs", "robot.fkine(0.1 + np.arange(robot.n) / 9)", "robot.jacob0(np.arange(robot.n) / 9)",
                "robot.links", "robot.reach", "robot.gravity", "robot.hasdynamics", "robot.base", "robot.tool",
                "robot.ee_links", "robot.keywords", "robot.comment", "robot.nlinks", "robot.grippers",
                "robot.gravload(np.arange(robot.n) / 9)", "robot.inertia(np.arange(robot.n) / 9)",
            ):  # fmt: skip
                yield Call(f"{make[:-2]}: {text}", f"models.{kind}", make, 0, True, text)


def generated() -> list[Call]:
    """All calls."""
    import numpy as np
    import roboticstoolbox as rtb
    import spatialmath as sm

    namespace: dict[str, Any] = {"rtb": rtb, "np": np, "sm": sm}
    exec(SETUP, namespace)
    calls = [call for subject in SUBJECTS for call in calls_of(subject, eval(subject.make, namespace))]
    calls += [*constructor_calls(namespace), *model_calls()]
    return list({call.key: call for call in calls}.values())


if __name__ == "__main__":
    with open(sys.argv[1], "w") as file:
        file.write(json.dumps([call._asdict() for call in generated()]))
