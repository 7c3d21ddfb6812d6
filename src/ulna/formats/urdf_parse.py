"""URDF text -> UrdfDocument: every element checked, every complaint with its line and the fix."""

from __future__ import annotations

import math

import numpy as np

from ulna.errors import FormatError
from ulna.formats.markup import parse_markup
from ulna.formats.node import Node, nearest, short
from ulna.formats.omitted import warn_of_omissions
from ulna.formats.urdf_document import (
    UrdfBody,
    UrdfDocument,
    UrdfInertial,
    UrdfJoint,
    UrdfLimit,
    UrdfLink,
    UrdfMimic,
    UrdfOrigin,
    UrdfShape,
)
from ulna.formats.urdf_materials import Palette
from ulna.formats.urdf_omitted import has_quaternions, omissions_of
from ulna.formats.urdf_tree import ONE_NUMBER, check_mimics, check_tree
from ulna.spatial import SE3, matrix_to_rpy

JOINT_KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical")
SHAPES = ("box", "cylinder", "sphere", "capsule", "mesh")

_OF_LINK = ("inertial", "visual", "collision", "origin", "contact", "self_filter", "surface", "gravity")
_OF_ROBOT = ("link", "joint", "material", "transmission", "gazebo", "sensor", "ros2_control")
_OF_INERTIAL = ("origin", "mass", "inertia")
_OF_BODY = ("origin", "geometry", "material", "verbose")
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

    Returns:
        The document.

    Raises:
        FormatError: the text is not a URDF, or it contradicts itself.
    """
    root = parse_markup(data, file, "robot", "URDF")
    _reject_xacro(root)
    root.warn_of_unknown_children(_OF_ROBOT)
    palette = Palette(root)
    links: dict[str, UrdfLink] = {}
    for node in root.children("link"):
        link = _link(node, palette)
        _reject_duplicate(node, "link", link.name, links)
        links[link.name] = link
    joints: dict[str, UrdfJoint] = {}
    nodes: dict[str, Node] = {}
    for node in root.children("joint"):
        joint = _joint(node, links)
        _reject_duplicate(node, "joint", joint.name, joints)
        joints[joint.name], nodes[joint.name] = joint, node
    if not links:
        root.fail("the robot has no links.", 'Write at least <link name="..."/>.')
    check_mimics(joints, nodes)
    top = check_tree(links, joints, nodes, root)
    warn_of_omissions(omissions_of(root), file)
    name = root.string("name") or "robot"
    return UrdfDocument(name, tuple(links.values()), tuple(joints.values()), palette.named, top, file)


def _reject_xacro(root: Node) -> None:
    for tag, line in root.foreign():
        if "xacro" in tag:
            local = tag.rsplit("}", 1)[-1].rsplit(":", 1)[-1]
            raise FormatError(
                f"<xacro:{local}> is xacro that was not expanded.",
                file=root.file,
                line=line,
                element="<robot>",
                fix="Name the file *.xacro and it is expanded on loading (extra xacro); or run xacro on it.",
            )


def _reject_duplicate(node: Node, kind: str, name: str, earlier: dict) -> None:
    if name in earlier:
        node.fail(
            f"a second {kind} named {name!r}; the first is on line {earlier[name].line}.",
            "Rename one of them.",
        )


def _origin(node: Node) -> UrdfOrigin:
    origin = node.child("origin")
    if origin is None:
        return UrdfOrigin()
    xyz = origin.vector("xyz", 3, (0.0, 0.0, 0.0))
    if not origin.has("quat_xyzw") or not has_quaternions(node.root):
        return UrdfOrigin(xyz, origin.vector("rpy", 3, (0.0, 0.0, 0.0)))
    if origin.has("rpy"):
        origin.fail("both rpy and quat_xyzw are given.", "Write one of them.")
    quaternion = np.array(origin.vector("quat_xyzw", 4))
    if np.linalg.norm(quaternion) < 1e-9:
        origin.fail("the quaternion quat_xyzw has no length.", 'No rotation is quat_xyzw="0 0 0 1".')
    r, p, y = (float(x) for x in matrix_to_rpy(SE3.from_quat_xyzw(quaternion).rotation))
    return UrdfOrigin(xyz, (r, p, y))


def _link(node: Node, palette: Palette) -> UrdfLink:
    name = node.name()
    node.warn_of_unknown_children(_OF_LINK)
    inertial = node.child("inertial")
    return UrdfLink(
        name,
        _inertial(inertial) if inertial else None,
        _bodies(node, "visual", palette),
        _bodies(node, "collision", palette),
        node.line,
    )


def _inertial(node: Node) -> UrdfInertial:
    node.warn_of_unknown_children(_OF_INERTIAL)
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


def _bodies(link: Node, tag: str, palette: Palette) -> tuple[UrdfBody, ...]:
    bodies = (_body(node, palette) for node in link.children(tag))
    return tuple(body for body in bodies if body is not None)


def _body(node: Node, palette: Palette) -> UrdfBody | None:
    """The body of a visual or collision element; None, with a warning, where other readers leave it out, too."""
    node.warn_of_unknown_children(_OF_BODY)
    geometry = node.required_child("geometry", f"Write <geometry><box size=.../></geometry> in <{node.tag}>.")
    oddity = _oddity(geometry)
    if oddity:
        geometry.warn(f"{oddity}; the <{node.tag}> is left out")
        return None
    shape = _shape(geometry)
    material = None
    element = node.child("material")
    if element is not None and node.tag == "visual":
        material = palette.of(element)
    return UrdfBody(node.string("name"), _origin(node), shape, material)


def _oddity(geometry: Node) -> str:
    """What makes other readers leave a geometry out: nothing in it, or a scale that is not three numbers."""
    nodes = list(geometry.children())
    if not nodes:
        return "<geometry> is empty"
    mesh = next((n for n in nodes if n.tag in SHAPES), None)
    scale = (
        mesh.string("scale", "") if mesh is not None and mesh.tag == "mesh" and mesh.has("scale") else None
    )
    count = 3 if scale is None else len(scale.split())
    return "" if count == 3 else f'scale="{short(scale or "")}" does not hold 3 numbers but {count}'


def _shape(geometry: Node) -> UrdfShape:
    nodes = list(geometry.children())
    known = [n for n in nodes if n.tag in SHAPES]
    if not known:
        fix = nearest(nodes[0].tag, SHAPES, "Did you mean {}?")
        geometry.fail(f"<geometry> holds <{nodes[0].tag}>; expected one of {', '.join(SHAPES)}.", fix)
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
    node.warn_of_unknown_children(_OF_JOINT)
    kind = node.name("type")
    if kind not in JOINT_KINDS:
        fix = (
            nearest(kind.lower(), JOINT_KINDS, "Did you mean {}?") or f"There are: {', '.join(JOINT_KINDS)}."
        )
        node.fail(f"there is no joint type {kind!r}.", fix)
    ends = []
    for tag in ("parent", "child"):
        end = node.required_child(tag, f'Write <{tag} link="..."/>.')
        link = end.name("link")
        if link not in links:
            end.fail(f"there is no link {link!r}.", nearest(link, links, "Did you mean {}?"))
        ends.append(link)
    dynamics = node.child("dynamics")
    mimic = node.child("mimic")
    return UrdfJoint(
        name,
        kind,
        ends[0],
        ends[1],
        _origin(node),
        _axis(node, kind),
        _limit(node, kind),
        _magnitude(dynamics, "damping", 0.0) if dynamics else 0.0,
        _magnitude(dynamics, "friction", 0.0) if dynamics else 0.0,
        UrdfMimic(mimic.name("joint"), mimic.number("multiplier", 1.0), mimic.number("offset", 0.0))
        if mimic
        else None,
        node.line,
    )


def _axis(node: Node, kind: str) -> tuple[float, ...]:
    axis_node = node.child("axis")
    if axis_node is None:
        return (1.0, 0.0, 0.0)
    axis = axis_node.vector("xyz", 3)
    if kind in (*ONE_NUMBER, "planar"):
        length = math.hypot(*axis)
        if length < 1e-12:
            axis_node.fail("the axis has no direction.", 'Write a unit vector, such as xyz="0 0 1".')
        if abs(length - 1.0) > 1e-3:
            axis_node.warn(f"the axis has length {length:g} and is taken as a direction only")
    return axis


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
