"""Whether links and joints form a tree, and in which order: parents first, depth first, in the order of addition."""

from __future__ import annotations

from collections.abc import Mapping

from ulna.errors import ModelError, UnknownName
from ulna.model.records import JointRecord, LinkRecord, model_error, with_location


def joints_above(
    model: str, links: Mapping[str, LinkRecord], joints: Mapping[str, JointRecord]
) -> dict[str, JointRecord]:
    """For each link but the root, the joint that moves it.

    Args:
        model: Name of the model, for messages.
        links: The links by name.
        joints: The joints by name.

    Returns:
        The joints by the name of the link they move.

    Raises:
        UnknownName: a joint connects a link that does not exist.
        ModelError: there is no link, or two joints move one link.
    """
    if not links:
        raise ModelError(f"Model {model!r} has no links; expected at least one. Add it with add_link(name).")
    above: dict[str, JointRecord] = {}
    for joint in joints.values():
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in links:
                raise UnknownName(
                    "link",
                    link,
                    links,
                    with_location(joint.where, f"It is the {role} of joint {joint.name!r}."),
                )
        if joint.child in above:
            both = f"{above[joint.child].name!r} and {joint.name!r}"
            raise model_error(
                joint.where,
                f"Link {joint.child!r} is the child of two joints, {both}; expected one. "
                "A loop is closed by a constraint, not by a second parent.",
            )
        above[joint.child] = joint
    return above


def root_link(model: str, links: Mapping[str, LinkRecord], above: Mapping[str, JointRecord]) -> str:
    """The one link that no joint moves.

    Args:
        model: Name of the model, for messages.
        links: The links by name.
        above: For each link but the root, the joint that moves it.

    Returns:
        Its name.

    Raises:
        ModelError: there is none, or there are several.
    """
    roots = [link for link in links if link not in above]
    if not roots:
        raise ModelError(f"Model {model!r} has no root link: {_cycle(next(iter(links)), above)}.")
    if len(roots) > 1:
        shown = ", ".join(map(repr, roots[:8])) + (" ..." if len(roots) > 8 else "")
        raise ModelError(
            f"Model {model!r} has {len(roots)} root links, {shown}; expected one. "
            "Connect the others to it with joints; Fixed() will do."
        )
    return roots[0]


def _cycle(start: str, above: Mapping[str, JointRecord]) -> str:
    """The circle of links that walking up from `start` ends in, as text."""
    visited: dict[str, int] = {}
    walk: list[str] = []
    link = start
    while link not in visited:
        visited[link] = len(walk)
        walk.append(link)
        link = above[link].parent or ""
    circle = [*walk[visited[link] :], link]
    return "the joints run in a circle, " + " -> ".join(repr(name) for name in reversed(circle))


def depth_first(
    model: str, root: str, links: Mapping[str, LinkRecord], above: Mapping[str, JointRecord]
) -> list[str]:
    """The links, parents before children, siblings in the order their joints were added.

    Args:
        model: Name of the model, for messages.
        root: The link that no joint moves.
        links: The links by name.
        above: For each link but the root, the joint that moves it.

    Returns:
        Their names.

    Raises:
        ModelError: some links are not connected with the root.
    """
    below: dict[str, list[str]] = {link: [] for link in links}
    for child, joint in above.items():
        below[joint.parent or ""].append(child)
    order: list[str] = []
    waiting = [root]
    while waiting:
        link = waiting.pop()
        order.append(link)
        waiting.extend(reversed(below[link]))
    if len(order) < len(links):
        reached = set(order)
        lost = next(link for link in links if link not in reached)
        raise ModelError(
            f"Model {model!r}: link {lost!r} is not connected to the root {root!r}; {_cycle(lost, above)}."
        )
    return order
