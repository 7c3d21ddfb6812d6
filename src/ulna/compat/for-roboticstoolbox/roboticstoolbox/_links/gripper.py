"""Grippers: links beyond the end of an arm, with separate configurations."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.errors import WrongIndex, WrongType
from roboticstoolbox._common.numbers import numbers
from roboticstoolbox._common.poses import matrix, pose
from roboticstoolbox._links.link import Link
from roboticstoolbox._links.link_tree import links_from
from ulna.errors import ShapeError
from ulna.typing import Floats


class Gripper:
    """A tree of links that an arm carries, its configuration and its tool."""

    def __init__(self, links: Any, name: str = "", tool: Any = None) -> None:
        """The first of `links` is the one that the arm carries."""
        self.links: list[Link] = [links] if isinstance(links, Link) else list(links)
        if not self.links:
            raise WrongIndex("A gripper has at least one link; `links` is empty.")
        if not all(isinstance(link, Link) for link in self.links):
            raise WrongType(
                "`links` of a gripper: expected Link objects, the first of them carried by the arm."
            )
        self.name = name
        self._tool = None if tool is None else matrix(tool)
        joints = [link for link in self.links if link.isjoint]
        for i, link in enumerate(joints):
            link.jindex = i
        self.n = len(joints)
        self._q: Floats = np.zeros(self.n)

    @property
    def q(self) -> Floats:
        """Its configuration, (n,)."""
        return self._q

    @q.setter
    def q(self, q: Any) -> None:
        values = np.array(numbers("q", q)).ravel()
        if values.shape != (self.n,):
            raise ShapeError("q", np.shape(q), f"({self.n},)")
        self._q = values
        robot = self.links[0].robot
        if robot is not None:
            robot.dynchanged()

    @property
    def tool(self) -> Any:
        """The pose of the tool in the first link."""
        return pose(np.eye(4) if self._tool is None else self._tool)

    @tool.setter
    def tool(self, T: Any) -> None:
        self._tool = None if T is None else matrix(T)
        robot = self.links[0].robot
        if robot is not None:
            robot._discard_compiled()

    def dfs_links(self, start: Link, func: Any = None) -> list[Link]:
        """The links from one on, children before siblings.

        Args:
            start: The first link.
            func: Called with each link; None for nothing.

        Returns:
            The links.
        """
        return links_from(start, func)

    def __str__(self) -> str:
        carrier = self.links[0].parent_name if self.links else None
        return f'Gripper("{self.name}", connected to {carrier}, {self.n} joints, {len(self.links)} links)'

    def __repr__(self) -> str:
        return f'Gripper({[repr(link) for link in self.links]}, name="{self.name}", tool={self._tool!r})'
