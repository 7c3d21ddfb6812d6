"""Content of a URDF file that a model has no place for, or that readers of URDF ignore, as omissions with lines."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterator
from functools import lru_cache

from ulna.formats.node import Node, short
from ulna.formats.omitted import Omission, place

ATTRIBUTES = {
    "origin": ("xyz", "rpy", "quat_xyzw"),
    "mass": ("value",),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "axis": ("xyz",),
    "limit": ("lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"),
    "dynamics": ("damping", "friction"),
    "mimic": ("joint", "multiplier", "offset"),
    "mesh": ("filename", "scale"),
    "joint": ("name", "type"),
}
"""The attributes of the elements on which numbers of a model depend."""

EXTENSIBLE = ("limit", "dynamics", "joint")
"""To these vendors add attributes of their own: only those that resemble a known one are reported."""

FASTER = ("acceleration", "deceleration", "jerk")
SPRINGS = ("spring_stiffness", "spring_reference", "spring_k", "stiffness")
ROTORS = ("armature", "rotor_inertia", "gear_ratio")

MUJOCO_PHYSICS = ("balanceinertia", "boundinertia", "boundmass", "inertiafromgeom", "settotalmass")
"""What <mujoco><compiler> of a URDF changes in masses and inertias."""

IN_GAZEBO = ("joint", "springStiffness", "springReference", "dampingFactor")
"""What <gazebo> says of the mechanism itself; contacts, looks and sensors of a simulator are not looked at."""

LOOPS = (
    "loop_joint",
    "loop",
    "linear_bushing_rpy",
    "ball_constraint",
    "weld_constraint",
    "distance_constraint",
)
NO = ("0", "false")
LONGEST = 30
"""Longer names of attributes look like none."""


def _limits(root: Node) -> Iterator[str]:
    return _with_attributes(root, "limit", FASTER)


def _springs(root: Node) -> Iterator[str]:
    return _with_attributes(root, "dynamics", SPRINGS)


def _rotors(root: Node) -> Iterator[str]:
    yield from _with_attributes(root, "dynamics", ROTORS)
    for tag, line in root.foreign():
        if _local(tag) in ("rotor_inertia", "gear_ratio"):
            yield place(f"<{_local(tag)}>", "", line)


def _with_attributes(root: Node, tag: str, attributes: tuple[str, ...]) -> Iterator[str]:
    for joint in root.children("joint"):
        for node in joint.children(tag):
            if any(node.has(attribute) for attribute in attributes):
                yield place("joint", joint.string("name") or "", node.line)


def _quaternions(root: Node) -> Iterator[str]:
    if has_quaternions(root):
        return
    for node in _owners_of_origins(root):
        for origin in node.children("origin"):
            if origin.has("quat_xyzw"):
                yield place(f"<{node.tag}>", "", origin.line)


def has_quaternions(root: Node) -> bool:
    """Whether the file is of a version of URDF, 1.1 or later, in which origins may have quaternions."""
    major, _, minor = (root.string("version") or "1.0").partition(".")
    numbers = [int(x) if x.isdecimal() and x.isascii() and len(x) < 9 else 0 for x in (major, minor)]
    return numbers >= [1, 1]


def _owners_of_origins(root: Node) -> Iterator[Node]:
    yield from root.children("joint")
    for link in root.children("link"):
        for tag in ("inertial", "visual", "collision"):
            yield from link.children(tag)


def _loops(root: Node) -> Iterator[str]:
    for node in root.children():
        if node.tag in LOOPS:
            yield place(f"<{node.tag}>", node.string("name") or "", node.line)
    for tag, line in root.foreign():
        if _local(tag) in LOOPS:
            yield place(f"<{_local(tag)}>", "", line)
    for gazebo in root.children("gazebo"):
        for node in gazebo.children("joint"):
            yield place("<gazebo><joint>", node.string("name") or "", node.line)


def _gazebo(root: Node) -> Iterator[str]:
    for gazebo in root.children("gazebo"):
        for node in gazebo.children():
            if node.tag in IN_GAZEBO[1:]:
                yield place(f"<{node.tag}>", gazebo.string("reference") or "", node.line)


def _weightless(root: Node) -> Iterator[str]:
    for link in root.children("link"):
        odd = [n for n in link.children("gravity") if n.text.lower() in NO]
        odd += [n for n in link.children("kinematic") if n.text.lower() not in (*NO, "")]
        for node in odd:
            yield place("link", link.string("name") or "", node.line)


def _mujoco(root: Node) -> Iterator[str]:
    for mujoco in root.children("mujoco"):
        for node in mujoco.children("compiler"):
            if any(node.has(attribute) for attribute in MUJOCO_PHYSICS):
                yield place("<compiler>", "", node.line)
        for node in mujoco.children("option"):
            yield place("<option>", "", node.line)


def _misspelt(root: Node) -> Iterator[str]:
    """Attributes that look like a known one that is not there, and unknown ones where there are no others."""
    for node in _numbered(root):
        known = ATTRIBUTES.get(node.tag, ())
        for attribute in node.attributes:
            meant = _like(attribute, known)
            if meant and not node.has(meant):
                yield place(f"<{node.tag} {short(attribute)}> (meant as {meant}?)", "", node.line)
            elif known and attribute not in known and node.tag not in EXTENSIBLE:
                yield place(f"<{node.tag} {short(attribute)}> (known: {', '.join(known)})", "", node.line)


def _numbered(root: Node) -> Iterator[Node]:
    for joint in root.children("joint"):
        yield joint
        yield from joint.children()
    for link in root.children("link"):
        for tag in ("inertial", "visual", "collision"):
            for node in link.children(tag):
                yield from node.children()
                for geometry in node.children("geometry"):
                    yield from geometry.children("mesh")


@lru_cache(1024)
def _like(attribute: str, known: tuple[str, ...]) -> str | None:
    if attribute in known or len(attribute) > LONGEST:
        return None
    lowered = attribute.lower()
    suggestions = difflib.get_close_matches(lowered, known, n=1, cutoff=0.8)
    longer = [name for name in known if len(lowered) > 2 and name.startswith(lowered)]  # vel, eff, mult
    return next(iter(suggestions or longer), None)


def _local(tag: str) -> str:
    return tag.rsplit("}", 1)[-1].rsplit(":", 1)[-1]


Look = Callable[[Node], Iterator[str]]

KINDS: tuple[tuple[Look, str, str, str], ...] = (
    (
        _limits,
        "<limit acceleration deceleration jerk>",
        "a model has no such limits.",
        "Pass them to the functions of ulna.trajectory.",
    ),
    (_springs, "<dynamics> with a spring", "torques are without springs of joints.", "Add theirs to `tau`."),
    (
        _rotors,
        "inertia of rotors",
        "readers of URDF do not know it, and the mass matrix is without it.",
        "Set it with robot.with_parameters({'armature': ...}).",
    ),
    (
        _quaternions,
        "<origin quat_xyzw>",
        'it is ignored below <robot version="1.1">, by the rules of URDF.',
        "Write the version, or rpy.",
    ),
    (
        _loops,
        "closed loops",
        "a URDF is a tree, and these constraints are not in the model.",
        "Pass a PointLoop or FrameLoop to the constrained dynamics.",
    ),
    (
        _gazebo,
        "<gazebo> with a spring or damping",
        "only Gazebo computes with it.",
        "Write <dynamics damping>, or add the torques to `tau`.",
    ),
    (
        _weightless,
        "<gravity> or <kinematic>",
        "gravity acts on all links, and all move as their joints do.",
        "Give the link no mass, or lock its joint.",
    ),
    (
        _mujoco,
        "<mujoco>",
        "only MuJoCo's reader changes masses, inertias and options by it.",
        "Write the numbers themselves.",
    ),
    (_misspelt, "attributes with unknown names", "they are ignored.", "Correct their names."),
)
"""What is looked for, and the element, the effect and the advice of its omission."""


def omissions_of(root: Node) -> list[Omission]:
    """What a file says beyond its model, from its root element."""
    out = []
    for look, element, effect, advice in KINDS:
        places = tuple(look(root))
        if places:
            out.append(Omission(element, effect, advice, places))
    return out
