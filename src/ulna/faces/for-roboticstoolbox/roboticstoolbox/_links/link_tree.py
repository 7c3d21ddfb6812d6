"""The tree of a robot's links: parents and children, joint numbers, and paths from link to link."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from roboticstoolbox._links.link import Link
from ulna.errors import ModelError, UnknownName


def connect(links: Sequence[Link], robot: Any) -> None:
    """Names, numbers and joins links, and tells them whose they are.

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
        raise ModelError(f"Two links are named {twice!r}; give each its own `name`.")
    for link in links:
        if link._parent is None and link._parent_name:
            if link._parent_name not in by_name:
                raise UnknownName("link", link._parent_name, by_name, f"It is the parent of {link.name!r}.")
            link._parent = by_name[link._parent_name]
        if link._parent is not None:
            link._parent.children.append(link)


def number(links: Sequence[Link]) -> None:
    """Gives joints their places in q, in the order of the links, unless they have them: 0 to n - 1, each once."""
    joints = [link for link in links if link.isjoint]
    if sorted(link.jindex or 0 for link in joints) != list(range(len(joints))):
        for i, link in enumerate(joints):
            link.jindex = i


def up(link: Link) -> list[Link]:
    """The links from the root to `link`."""
    out: list[Link] = []
    at: Link | None = link
    while at is not None:
        out.insert(0, at)
        at = at.parent
    return out


def between(start: Link | None, end: Link) -> tuple[list[Link], list[Link]]:
    """Links to go up and then down, from `start` (the base for None) to the frame of `end`.

    As in the toolbox the way down from a link begins before its own transforms, the way up from it beyond them.
    """
    down = up(end)
    if start is None:
        return [], down
    rise = up(start)
    shared = 0
    while shared < min(len(rise), len(down)) and rise[shared] is down[shared]:
        shared += 1
    if shared == len(rise):
        return [], down[shared - 1 :]
    return rise[shared:][::-1], down[shared:]
