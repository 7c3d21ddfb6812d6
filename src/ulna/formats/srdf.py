"""SRDF, the file beside a URDF: groups, named configurations, pairs of links not checked for contact."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

from ulna.formats.markup import parse_markup, read_file
from ulna.formats.node import Node


@dataclass(frozen=True)
class SrdfGroup:
    """A group of a robot: joints, links, chains (base link, tip link) and other groups, by name."""

    name: str
    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    chains: tuple[tuple[str, str], ...] = ()
    groups: tuple[str, ...] = ()


@dataclass(frozen=True)
class SrdfState:
    """A named configuration: joint name -> its values [rad, m; a free flyer: position, quaternion xyzw]."""

    name: str
    group: str | None
    values: dict[str, tuple[float, ...]]


@dataclass(frozen=True)
class SrdfVirtualJoint:
    """A joint that ties the robot to the world; recorded only, since the caller chooses the root joint."""

    name: str
    kind: str
    parent_frame: str | None
    child: str


@dataclass(frozen=True)
class SrdfEndEffector:
    """A named tool: the link it is attached to and the group it is."""

    name: str
    parent_link: str
    group: str | None


@dataclass(frozen=True)
class SrdfDocument:
    """What an SRDF file says, in file order.

    Attributes:
        name: of the robot.
        groups: by name.
        states: the named configurations.
        disabled_pairs: pairs of link names that are not checked for contact.
        virtual_joints: ties to the world.
        end_effectors: the tools.
        passive_joints: joints without a motor.
        rotors: joint name -> (rotor inertia [kg m^2], gear ratio), from the rotor_params element.
        file: where it was read from; None for text.
    """

    name: str
    groups: dict[str, SrdfGroup] = field(default_factory=dict)
    states: tuple[SrdfState, ...] = ()
    disabled_pairs: tuple[tuple[str, str], ...] = ()
    virtual_joints: tuple[SrdfVirtualJoint, ...] = ()
    end_effectors: tuple[SrdfEndEffector, ...] = ()
    passive_joints: tuple[str, ...] = ()
    rotors: dict[str, tuple[float, float]] = field(default_factory=dict)
    file: str | None = None


def read_srdf(path: str | os.PathLike[str]) -> SrdfDocument:
    """The document in an SRDF file.

    Raises:
        FormatError: the file is missing or broken.
    """
    return parse_srdf(read_file(path), str(path))


def parse_srdf(data: bytes | str, file: str | None = None) -> SrdfDocument:
    """The document that an SRDF text describes; unknown elements are ignored, with a warning if they look misspelt.

    Args:
        data: The text.
        file: Its name, for messages.

    Returns:
        The document.

    Raises:
        FormatError: the text is not an SRDF.
    """
    root = parse_markup(data, file, "robot", "SRDF")
    _warn_of_unknown(root)
    groups: dict[str, SrdfGroup] = {}
    for node in root.children("group"):
        group = _group(node)
        if group.name in groups:
            node.warn(f"a second group {group.name!r}; the first one is used")
        groups.setdefault(group.name, group)
    pairs: dict[tuple[str, str], None] = {}
    for node in root.children("disable_collisions"):
        pairs[node.name("link1"), node.name("link2")] = None
    return SrdfDocument(
        root.string("name") or "robot",
        groups,
        tuple(_state(n) for n in root.children("group_state")),
        tuple(pairs),
        tuple(
            SrdfVirtualJoint(n.name(), n.name("type"), n.string("parent_frame"), n.name("child_link"))
            for n in root.children("virtual_joint")
        ),
        tuple(
            SrdfEndEffector(n.name(), n.name("parent_link"), n.string("group"))
            for n in root.children("end_effector")
        ),
        tuple(n.name() for n in root.children("passive_joint")),
        {
            n.name(): (n.number("mass", 0.0), n.number("gear_ratio", 1.0))
            for parameters in root.children("rotor_params")
            for n in parameters.children("joint")
        },
        file,
    )


_CHILDREN = {
    "robot": (
        "group",
        "group_state",
        "disable_collisions",
        "virtual_joint",
        "end_effector",
        "passive_joint",
        "rotor_params",
        "gripper",
        "specificities",
        "link_sphere_approximation",
    ),
    "group": ("joint", "link", "chain", "group"),
    "group_state": ("joint",),
    "rotor_params": ("joint",),
}
_ATTRIBUTES = {
    ("robot", "group_state"): ("name", "group"),
    ("robot", "end_effector"): ("name", "parent_link", "group", "parent_group"),
    ("robot", "virtual_joint"): ("name", "type", "parent_frame", "child_link"),
    ("robot", "disable_collisions"): ("link1", "link2", "reason"),
    ("rotor_params", "joint"): ("name", "mass", "gear_ratio"),
}
_NOT_READ = ("disable_default_collisions", "enable_collisions")


def _warn_of_unknown(root: Node) -> None:
    """Warn about elements that look misspelt, and unknown attributes of those that are read."""
    waiting = [root]
    for parent in waiting:
        parent.warn_of_unknown_children((*_CHILDREN[parent.tag], *_NOT_READ))
        for node in parent.children():
            if node.tag in _NOT_READ:
                node.warn(f"<{node.tag}> is not read; write <disable_collisions> for each pair")
            if (parent.tag, node.tag) in _ATTRIBUTES:
                node.warn_of_unknown_attributes(_ATTRIBUTES[parent.tag, node.tag])
            if parent is root and node.tag in _CHILDREN:
                waiting.append(node)


def _group(node: Node) -> SrdfGroup:
    return SrdfGroup(
        node.name(),
        tuple(n.name() for n in node.children("joint")),
        tuple(n.name() for n in node.children("link")),
        tuple((n.name("base_link"), n.name("tip_link")) for n in node.children("chain")),
        tuple(n.name() for n in node.children("group")),
    )


def _state(node: Node) -> SrdfState:
    values: dict[str, tuple[float, ...]] = {}
    for joint in node.children("joint"):
        count = len((joint.string("value") or "").split())
        if joint.name() in values:
            joint.warn(f"a second value for joint {joint.name()!r}; the last one is used")
        values[joint.name()] = joint.vector("value", max(count, 1))
    return SrdfState(node.name(), node.string("group"), values)
