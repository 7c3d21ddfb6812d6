"""URDF text -> UrdfDocument: every element checked, every complaint with its line and the mend."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable
from dataclasses import replace

from ulna.errors import FormatError
from ulna.formats.markup import Node, parse_markup
from ulna.formats.urdf_document import (
    UrdfBody,
    UrdfDocument,
    UrdfInertial,
    UrdfJoint,
    UrdfLimit,
    UrdfLink,
    UrdfMaterial,
    UrdfMimic,
    UrdfOrigin,
    UrdfShape,
)

JOINT_KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical")
_ONE_NUMBER = ("revolute", "continuous", "prismatic")
SHAPES = ("box", "cylinder", "sphere", "capsule", "mesh")

_OF_LINK = ("inertial", "visual", "collision", "origin", "contact", "self_filter", "surface", "gravity")
_OF_JOINT = (
    "origin",
    "parent",
    "child",
    "axis",
    "limit",
    "dynamics",
    "mimic",
    "calibration",
    "safety_controller",
)


def parse_urdf(data: bytes | str, file: str | None = None) -> UrdfDocument:
    """The document that a URDF text describes.

    Args:
        data: the text.
        file: its name, for messages and for resolving mesh paths.

    Raises:
        FormatError: the text is not a URDF, or it contradicts itself.
    """
    root = parse_markup(data, file, "robot", "URDF")
    _refuse_xacro(root)
    materials = _materials(root)
    links: dict[str, UrdfLink] = {}
    for node in root.children("link"):
        link = _link(node, materials)
        _refuse_twin(node, "link", link.name, links)
        links[link.name] = link
    joints: dict[str, UrdfJoint] = {}
    nodes: dict[str, Node] = {}
    for node in root.children("joint"):
        joint = _joint(node, links)
        _refuse_twin(node, "joint", joint.name, joints)
        joints[joint.name], nodes[joint.name] = joint, node
    if not links:
        root.fail("the robot has no links.", 'Write at least <link name="..."/>.')
    _check_mimics(joints, nodes)
    top = _check_tree(links, joints, nodes, root)
    name = root.string("name") or "robot"
    return UrdfDocument(name, tuple(links.values()), tuple(joints.values()), materials, top, file)


def _refuse_xacro(root: Node) -> None:
    for tag, line in root.foreign():
        if "xacro" in tag:
            local = tag.rsplit("}", 1)[-1].rsplit(":", 1)[-1]
            raise FormatError(
                f"<xacro:{local}> is xacro that was not expanded.",
                file=root.file,
                line=line,
                element="<robot>",
                mend="Name the file *.xacro and it is expanded on loading (extra xacro); or run xacro on it.",
            )


def _refuse_twin(node: Node, kind: str, name: str, seen: dict) -> None:
    if name in seen:
        node.fail(
            f"a second {kind} named {name!r}; the first is on line {seen[name].line}.", "Rename one of them."
        )


def _materials(root: Node) -> dict[str, UrdfMaterial]:
    """The materials by name: those of the robot, then those that a visual defines on the way."""
    found: dict[str, UrdfMaterial] = {}
    inline = (
        m for link in root.children("link") for v in link.children("visual") for m in v.children("material")
    )
    for node in (*root.children("material"), *inline):
        material = _material(node)
        if material.name and (material.rgba or material.texture):
            found.setdefault(material.name, material)
    return found


def _material(node: Node) -> UrdfMaterial:
    color, texture = node.child("color"), node.child("texture")
    rgba = None
    if color is not None:
        rgba = color.vector("rgba", 4)
        if not all(0.0 <= c <= 1.0 for c in rgba):
            color.warn("a colour outside 0..1 is held to it")
            rgba = tuple(min(max(c, 0.0), 1.0) for c in rgba)
    return UrdfMaterial(node.string("name") or "", rgba, texture.string("filename") if texture else None)


def _origin(node: Node) -> UrdfOrigin:
    origin = node.child("origin")
    if origin is None:
        return UrdfOrigin()
    return UrdfOrigin(origin.vector("xyz", 3, (0.0, 0.0, 0.0)), origin.vector("rpy", 3, (0.0, 0.0, 0.0)))


def _link(node: Node, materials: dict[str, UrdfMaterial]) -> UrdfLink:
    name = node.name()
    node.warn_of_strangers(_OF_LINK)
    inertial = node.child("inertial")
    return UrdfLink(
        name,
        _inertial(inertial) if inertial else None,
        tuple(_body(n, materials) for n in node.children("visual")),
        tuple(_body(n, materials) for n in node.children("collision")),
        node.line,
    )


def _inertial(node: Node) -> UrdfInertial:
    mass = node.required_child("mass", 'Write <mass value="..."/> in kg, or leave <inertial> out.').number(
        "value"
    )
    inertia = node.required_child("inertia", 'Write <inertia ixx="..." ... izz="..."/> in kg m^2.')
    entries = tuple(
        inertia.number(entry, 0.0 if entry in ("ixy", "ixz", "iyz") else None)
        for entry in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    if mass < 0.0:
        node.fail(f"the mass is {mass:g} kg; expected zero or more.")
    return UrdfInertial(mass, _origin(node), entries)


def _body(node: Node, materials: dict[str, UrdfMaterial]) -> UrdfBody:
    shape = _shape(
        node.required_child("geometry", f"Write <geometry><box size=.../></geometry> in <{node.tag}>.")
    )
    material = None
    given = node.child("material")
    if given is not None and node.tag == "visual":
        material = _material(given)
        if material.rgba is None and material.texture is None and material.name:
            if material.name not in materials:
                near = difflib.get_close_matches(material.name, materials, n=1)
                hint = f"; did you mean {near[0]!r}?" if near else ""
                given.warn(f"no material {material.name!r} is defined{hint}")
            material = materials.get(material.name, material)
        elif material.rgba is None and material.name in materials:
            material = replace(material, rgba=materials[material.name].rgba)
    return UrdfBody(node.string("name"), _origin(node), shape, material)


def _shape(geometry: Node) -> UrdfShape:
    nodes = list(geometry.children())
    known = [n for n in nodes if n.tag in SHAPES]
    if not known:
        given = f"holds <{nodes[0].tag}>" if nodes else "is empty"
        near = difflib.get_close_matches(nodes[0].tag, SHAPES, n=1) if nodes else []
        mend = f"Did you mean <{near[0]}>?" if near else ""
        geometry.fail(f"<geometry> {given}; expected one of {', '.join(SHAPES)}.", mend)
    if len(known) > 1:
        known[1].warn(
            "a second shape in one <geometry> is ignored; give each its own <visual> or <collision>"
        )
    node = known[0]
    if node.tag == "mesh":
        return UrdfShape(
            "mesh", (), node.name("filename"), node.vector("scale", 3, (1.0, 1.0, 1.0)), node.line
        )
    if node.tag == "box":
        size = node.vector("size", 3)
    elif node.tag == "sphere":
        size = (node.number("radius"),)
    else:
        size = (node.number("radius"), node.number("length"))
    if min(size) < 0.0:
        node.fail(
            f"<{node.tag}> has a negative size {' '.join(f'{s:g}' for s in size)}.", "Sizes are in metres."
        )
    return UrdfShape(node.tag, size, line=node.line)


def _joint(node: Node, links: dict[str, UrdfLink]) -> UrdfJoint:
    name = node.name()
    node.warn_of_strangers(_OF_JOINT)
    kind = node.name("type")
    if kind not in JOINT_KINDS:
        near = difflib.get_close_matches(kind.lower(), JOINT_KINDS, n=1, cutoff=0.5)
        mend = f"Did you mean {near[0]!r}?" if near else f"There are: {', '.join(JOINT_KINDS)}."
        node.fail(f"there is no joint type {kind!r}.", mend)
    ends = []
    for tag in ("parent", "child"):
        end = node.required_child(tag, f'Write <{tag} link="..."/>.')
        link = end.name("link")
        if link not in links:
            near = difflib.get_close_matches(link, links, n=1, cutoff=0.5)
            end.fail(f"there is no link {link!r}.", f"Did you mean {near[0]!r}?" if near else "")
        ends.append(link)
    axis = (1.0, 0.0, 0.0)
    axis_node = node.child("axis")
    if axis_node is not None:
        axis = axis_node.vector("xyz", 3)
        if kind in (*_ONE_NUMBER, "planar"):
            length = math.hypot(*axis)
            if length < 1e-12:
                axis_node.fail("the axis has no direction.", 'Write a unit vector, such as xyz="0 0 1".')
            if abs(length - 1.0) > 1e-3:
                axis_node.warn(f"the axis has length {length:g} and is taken as a direction only")
    dynamics = node.child("dynamics")
    mimic = node.child("mimic")
    return UrdfJoint(
        name,
        kind,
        ends[0],
        ends[1],
        _origin(node),
        axis,
        _limit(node, kind),
        _magnitude(dynamics, "damping", 0.0) if dynamics else 0.0,
        _magnitude(dynamics, "friction", 0.0) if dynamics else 0.0,
        UrdfMimic(mimic.name("joint"), mimic.number("multiplier", 1.0), mimic.number("offset", 0.0))
        if mimic
        else None,
        node.line,
    )


def _limit(node: Node, kind: str) -> UrdfLimit | None:
    limit = node.child("limit")
    if limit is None:
        if kind in ("revolute", "prismatic"):
            unit = "rad" if kind == "revolute" else "m"
            other = ', or make it type="continuous"' if kind == "revolute" else ""
            node.fail(
                f"a {kind} joint needs a <limit>.",
                f'Write <limit lower="..." upper="..." velocity="..." effort="..."/> [{unit}]{other}.',
            )
        return None
    if kind == "fixed":
        return None
    bounded = kind in ("revolute", "prismatic")
    if bounded and not limit.has("lower") and not limit.has("upper"):
        limit.warn(
            "neither lower nor upper is given; by the URDF rules both are then 0 and the joint is stuck"
        )
    lower = limit.number("lower", 0.0, infinite=True) if bounded else -math.inf
    upper = limit.number("upper", 0.0, infinite=True) if bounded else math.inf
    if lower > upper:
        limit.fail(f"lower = {lower:g} is above upper = {upper:g}.", "Exchange them.")
    if lower == math.inf or upper == -math.inf:
        limit.fail(f"no position lies between lower = {lower:g} and upper = {upper:g}.")
    velocity = _magnitude(limit, "velocity", math.inf, infinite=True)
    return UrdfLimit(lower, upper, velocity, _magnitude(limit, "effort", math.inf, infinite=True))


def _magnitude(node: Node, attribute: str, default: float, *, infinite: bool = False) -> float:
    value = node.number(attribute, default, infinite=infinite)
    if value < 0.0:
        node.warn(f"{attribute} = {value:g} is negative; its magnitude is used")
    return abs(value)


def _check_mimics(joints: dict[str, UrdfJoint], nodes: dict[str, Node]) -> None:
    """Drop, with a warning, what cannot be followed (other readers drop it silently); refuse rings."""
    for joint in list(joints.values()):
        problem = _mimic_problem(joint, joints)
        if problem:
            if joint.kind != "fixed":
                nodes[joint.name].warn(f"{problem}; it moves on its own")
            joints[joint.name] = replace(joint, mimic=None)
    for joint in joints.values():
        seen = [joint.name]
        leader = joint.mimic
        while leader is not None:
            if leader.joint in seen:
                ring = " -> ".join([*seen, leader.joint])
                nodes[joint.name].fail(f"it mimics itself: {ring}.", "One joint of the ring must be free.")
            seen.append(leader.joint)
            leader = joints[leader.joint].mimic


def _mimic_problem(joint: UrdfJoint, joints: dict[str, UrdfJoint]) -> str:
    if joint.mimic is None:
        return ""
    if joint.kind not in _ONE_NUMBER:
        return f"a {joint.kind} joint cannot mimic another"
    leader = joints.get(joint.mimic.joint)
    if leader is None:
        near = difflib.get_close_matches(joint.mimic.joint, joints, n=1, cutoff=0.5)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        return f"it mimics {joint.mimic.joint!r}, and there is no such joint{hint}"
    if leader.kind not in _ONE_NUMBER:
        return f"it mimics {leader.name!r}, which is {leader.kind}"
    return ""


def _check_tree(
    links: dict[str, UrdfLink], joints: dict[str, UrdfJoint], nodes: dict[str, Node], root: Node
) -> str:
    """Check that the joints make one tree; the name of its root link."""
    parent_of: dict[str, UrdfJoint] = {}
    for joint in joints.values():
        node = nodes[joint.name]
        if joint.child in parent_of:
            first = parent_of[joint.child].name
            node.fail(
                f"link {joint.child!r} already has a parent, through joint {first!r}.",
                "A URDF is a tree; close a loop outside it.",
            )
        if joint.child == joint.parent:
            node.fail(f"it joins link {joint.child!r} to itself.")
        parent_of[joint.child] = joint
    tops = [name for name in links if name not in parent_of]
    if not tops:
        joint = next(iter(joints.values()))
        nodes[joint.name].fail(
            f"the joints form a loop: {_loop(joint.child, parent_of)}.", "One link must be nobody's child."
        )
    if len(tops) > 1:
        shown = ", ".join(repr(t) for t in tops[:6]) + (", ..." if len(tops) > 6 else "")
        root.fail(
            f"there are {len(tops)} links without a parent: {shown}; expected one.",
            f"Join them, for example by a fixed joint from {tops[0]!r} to {tops[1]!r}.",
        )
    stray = _unreached(tops[0], links, joints.values())
    if stray:
        nodes[parent_of[stray].name].fail(
            f"the joints form a loop: {_loop(stray, parent_of)}.",
            f"Nothing joins it to the root link {tops[0]!r}.",
        )
    return tops[0]


def _unreached(top: str, links: Iterable[str], joints: Iterable[UrdfJoint]) -> str | None:
    below: dict[str, list[str]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint.child)
    reached, waiting = {top}, [top]
    while waiting:
        for child in below.get(waiting.pop(), ()):
            reached.add(child)
            waiting.append(child)
    return next((name for name in links if name not in reached), None)


def _loop(link: str, parent_of: dict[str, UrdfJoint]) -> str:
    seen: list[str] = []
    while link not in seen:
        seen.append(link)
        link = parent_of[link].parent
    ring = [*seen[seen.index(link) :], link]
    ring = ring if len(ring) < 8 else [*ring[:6], "...", ring[-1]]
    return " <- ".join(ring)
