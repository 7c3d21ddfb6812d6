"""Checks how the joints of a URDF fit together: one tree, one root, mimic joints that lead somewhere."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from ulna.formats.node import Node, nearest
from ulna.formats.urdf_document import UrdfJoint, UrdfLink

ONE_NUMBER = ("revolute", "continuous", "prismatic")
"""The joint types with one coordinate."""


def check_mimics(joints: dict[str, UrdfJoint], nodes: dict[str, Node]) -> None:
    """Remove, with a warning, mimic relations that cannot be followed (other readers remove them silently).

    Args:
        joints: The joints by name, which are changed in place.
        nodes: The elements of the joints, by name, for messages.

    Raises:
        FormatError: joints follow each other in a ring.
    """
    for joint in list(joints.values()):
        problem = _mimic_problem(joint, joints)
        if problem:
            if joint.kind != "fixed":
                nodes[joint.name].warn(f"{problem}; it moves on its own")
            joints[joint.name] = replace(joint, mimic=None)
    harmless: set[str] = set()
    for joint in joints.values():
        chain = {joint.name: None}
        leader = joint.mimic
        while leader is not None and leader.joint not in harmless:
            if leader.joint in chain:
                ring = " -> ".join([*chain, leader.joint])
                nodes[joint.name].fail(f"it mimics itself: {ring}.", "One joint of the ring must be free.")
            chain[leader.joint] = None
            leader = joints[leader.joint].mimic
        harmless.update(chain)


def _mimic_problem(joint: UrdfJoint, joints: dict[str, UrdfJoint]) -> str:
    if joint.mimic is None:
        return ""
    if joint.kind not in ONE_NUMBER:
        return f"a {joint.kind} joint cannot mimic another"
    leader = joints.get(joint.mimic.joint)
    if leader is None:
        hint = nearest(joint.mimic.joint, joints, "; did you mean {}?")
        return f"it mimics {joint.mimic.joint!r}, and there is no such joint{hint}"
    if leader.kind not in ONE_NUMBER:
        return f"it mimics {leader.name!r}, which is {leader.kind}"
    return ""


def check_tree(
    links: dict[str, UrdfLink], joints: dict[str, UrdfJoint], nodes: dict[str, Node], root: Node
) -> str:
    """Check that the joints make one tree.

    Args:
        links: The links by name.
        joints: The joints by name.
        nodes: The elements of the joints, by name, for messages.
        root: The root element of the document, for messages.

    Returns:
        The name of the root link.

    Raises:
        FormatError: they do not.
    """
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
    link_in_loop = _unreached(tops[0], links, joints.values())
    if link_in_loop:
        nodes[parent_of[link_in_loop].name].fail(
            f"the joints form a loop: {_loop(link_in_loop, parent_of)}.",
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
    visited: dict[str, None] = {}
    while link not in visited:
        visited[link] = None
        link = parent_of[link].parent
    walk = list(visited)
    ring = [*walk[walk.index(link) :], link]
    ring = ring if len(ring) < 8 else [*ring[:6], "...", ring[-1]]
    return " <- ".join(ring)
