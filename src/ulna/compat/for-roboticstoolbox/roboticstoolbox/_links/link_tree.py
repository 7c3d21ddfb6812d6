"""The tree of a robot's links: parents and children, joint numbers, and paths from link to link."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from roboticstoolbox._links.link import Link
from ulna.errors import ModelError, UnknownName


def connect(links: Sequence[Link], robot: Any) -> None:
    """Sets the names, the robot, the parents and the children of links.

    Args:
        links: The links.
        robot: The robot that they belong to.

    Raises:
        ModelError: Two links share a name.
        UnknownName: A parent does not exist.
    """
    for i, link in enumerate(links):
        link.name = link.name or f"link{i}"
        link.robot = robot
        link.children = []
    by_name = {link.name: link for link in links}
    if len(by_name) != len(links):
        twice = next(a.name for a in links if sum(a.name == b.name for b in links) > 1)
        raise ModelError(f"Two links are named {twice!r}; give each a different `name`.")
    for link in links:
        if link._parent is None and link._parent_name:
            if link._parent_name not in by_name:
                raise UnknownName("link", link._parent_name, by_name, f"It is the parent of {link.name!r}.")
            link._parent = by_name[link._parent_name]
        if link._parent is not None:
            link._parent.children.append(link)


def assign_joint_numbers(links: Sequence[Link]) -> None:
    """Numbers joints in the order of the links, unless they are numbered from 0 to n - 1 already."""
    joints = [link for link in links if link.isjoint]
    if sorted(link.jindex or 0 for link in joints) != list(range(len(joints))):
        for i, link in enumerate(joints):
            link.jindex = i


def path_from_root(link: Link) -> list[Link]:
    """The links from the root to `link`."""
    out: list[Link] = []
    at: Link | None = link
    while at is not None:
        out.insert(0, at)
        at = at.parent
    return out


def links_between(start: Link | None, end: Link) -> tuple[list[Link], list[Link]]:
    """The path from `start` (the base for None) to `end`: links that it ascends, then links that it descends.

    As in the toolbox a descending path from a link includes the transforms of that link, an ascending path does not.

    Args:
        start: A link; None for the base.
        end: Another link.

    Returns:
        Links that the path ascends, and links that it descends.
    """
    downward = path_from_root(end)
    if start is None:
        return [], downward
    upward = path_from_root(start)
    shared = 0
    while shared < min(len(upward), len(downward)) and upward[shared] is downward[shared]:
        shared += 1
    if shared == len(upward):
        return [], downward[shared - 1 :]
    return upward[shared:][::-1], downward[shared:]


def links_from(start: Link, func: Callable[[Link], Any] | None = None) -> list[Link]:
    """The links from `start` on, children before siblings.

    Args:
        start: The first link.
        func: Called with each; None for nothing.

    Returns:
        The links.
    """
    out = [start]
    if func is not None:
        func(start)
    for child in start.children:
        out += links_from(child, func)
    return out
