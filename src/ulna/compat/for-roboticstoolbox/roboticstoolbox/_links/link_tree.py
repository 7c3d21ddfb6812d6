"""The tree of a robot's links: parents and children, joint numbers, and paths from link to link."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from roboticstoolbox._common.errors import UnknownKey, WrongType
from roboticstoolbox._links.link import Link
from ulna.errors import ModelError


def connect(links: Sequence[Link], robot: Any) -> None:
    """Sets the names, the numbers, the robot, the parents and the children of links.

    Where no link has a parent, each one is attached to the one before it.

    Args:
        links: The links.
        robot: The robot that they belong to.

    Raises:
        WrongType: Something is no link.
        ModelError: There is no link, two links share a name, or several have no parent.
        UnknownKey: A parent does not exist.
    """
    for i, link in enumerate(links):
        if not isinstance(link, Link):
            raise WrongType(f"{link!r} is no link; expected links, a chain of transforms, or a robot.")
        link.name = link.name or f"link-{i}"
        link.robot, link.number, link.children = robot, i + 1, []
    by_name = {link.name: link for link in links}
    if len(by_name) != len(links):
        twice = next(a.name for a in links if sum(a.name == b.name for b in links) > 1)
        raise ModelError(f"Two links are named {twice!r}; give each a different `name`.")
    for link in links:
        if link._parent is None and link._parent_name:
            if link._parent_name not in by_name:
                raise UnknownKey("link", link._parent_name, by_name, f"It is the parent of {link.name!r}.")
            link._parent = by_name[link._parent_name]
    if all(link._parent is None for link in links):
        for before, link in pairwise(links):
            link._parent = before
    roots = [link.name for link in links if link._parent is None]
    if len(roots) != 1:
        raise ModelError(
            f"Links without a parent: {', '.join(roots) or 'none'}; expected one, the base link."
        )
    for link in links:
        if link._parent is not None:
            link._parent.children.append(link)


def ordered_joints(links: Sequence[Link], check: bool = True) -> list[Link]:
    """The links of an arm with numbered joints, in their order.

    Links without numbers are numbered, and put in order, depth first; links with numbers keep theirs and their order.

    Args:
        links: Those of the arm.
        check: Whether numbers must be 0 to n - 1.

    Returns:
        The links.

    Raises:
        ModelError: Some joints have numbers and some have none, or they are not 0 to n - 1.
    """
    joints = [link for link in links if link.isjoint]
    numbered = [not link.ets._auto_jindex for link in joints]
    if not any(numbered):
        inside = {id(link) for link in links}
        root = next(link for link in links if link._parent is None or id(link._parent) not in inside)
        order = [link for link in _depth_first(root) if id(link) in inside]
        for i, link in enumerate(link for link in order if link.isjoint):
            link.jindex = i
        return order
    if not all(numbered):
        raise ModelError("Some links have a `jindex` and some have none; set it for all of them or for none.")
    numbers = [link.jindex for link in joints]
    if check and sorted(numbers) != list(range(len(joints))):  # type: ignore[type-var]
        hint = (
            " Names of joints that count from one end with an underscore: 'A1_'." if 0 not in numbers else ""
        )
        raise ModelError(
            f"The joints have the numbers {numbers}; expected 0 to {len(joints) - 1}, each once.{hint}"
        )
    return list(links)


def _depth_first(link: Link) -> list[Link]:
    return [link, *(one for child in link.children for one in _depth_first(child))]


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
