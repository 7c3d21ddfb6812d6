"""Access to the links of a robot: joints, limits, branches, paths and shapes."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.errors import UnknownKey
from roboticstoolbox._common.poses import pose
from roboticstoolbox._links.gripper import Gripper
from roboticstoolbox._links.link import Link
from roboticstoolbox._links.link_tree import links_between, links_from
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.typing import Floats


class LinkAccess(RobotMixin):
    """Links, joints and branches."""

    @property
    def links(self) -> list[Link]:
        """The links of the arm, those of grippers left out."""
        return self._links

    @property
    def grippers(self) -> list[Gripper]:
        """What the arm carries."""
        return self._grippers

    @property
    def base_link(self) -> Link:
        """The first link."""
        return next(link for link in self._links if link.parent is None)

    @property
    def nlinks(self) -> int:
        """How many links there are, those of grippers included."""
        return len(self.link_dict)

    @property
    def nbranches(self) -> int:
        """How many ends the arm has."""
        return len(self.ee_links)

    def _joints(self) -> list[Link]:
        return sorted((link for link in self._links if link.isjoint), key=lambda link: link.jindex or 0)

    @property
    def structure(self) -> str:
        """A letter for each joint: R turns, P slides."""
        return "".join("R" if link.isrevolute else "P" for link in self._joints())

    @property
    def revolutejoints(self) -> list[bool]:
        """Which joints turn."""
        return [link.isrevolute for link in self._joints()]

    @property
    def prismaticjoints(self) -> list[bool]:
        """Which joints slide."""
        return [link.isprismatic for link in self._joints()]

    def isrevolute(self, j: int) -> bool:
        """Whether joint `j` turns."""
        return self._joints()[j].isrevolute

    def isprismatic(self, j: int) -> bool:
        """Whether joint `j` slides."""
        return self._joints()[j].isprismatic

    def islimit(self, q: Any = None) -> list[np.bool_]:
        """Which joint coordinates are beyond their limits."""
        at = self.q if q is None else np.asarray(q, dtype=float)
        return [np.bool_(link.islimit(x)) for link, x in zip(self._joints(), at, strict=True)]

    @property
    def reach(self) -> float:
        """The greatest distance its links could span [m]."""
        total = 0.0
        for link in self._links:
            for et in link.ets.data:
                if et.istranslation:
                    step = (
                        et.param
                        if et.param is not None
                        else 0.0
                        if et.qlim is None
                        else float(np.abs(et.qlim).max())
                    )
                    total += abs(step)
                elif et._T is not None:
                    total += float(np.linalg.norm(et._T[:-1, -1]))
        return total

    @property
    def hasgeometry(self) -> bool:
        """Whether any link has shapes to draw."""
        return any(link._drawn for link in self._links)

    @property
    def hascollision(self) -> bool:
        """Whether any link has shapes to check."""
        return any(link._solids for link in self._links)

    @property
    def _joint_bounds(self) -> Floats:
        """Joint limits, (2, n); infinite for a joint without limits."""
        limits = [(-np.inf, np.inf) if link.qlim is None else link.qlim for link in self._joints()]
        return np.array(limits, dtype=float).reshape(-1, 2).T

    def dfs_links(self, start: Link, func: Any = None) -> list[Link]:
        """The links from one on, children before siblings.

        Args:
            start: The first link.
            func: Called with each link; None for nothing.

        Returns:
            The links.
        """
        return links_from(start, func)

    def get_path(self, end: Any = None, start: Any = None) -> tuple[list[Link], int, Any]:
        """The links from one to another.

        Args:
            end: Last link of the chain, a gripper, or a name; the tool by default.
            start: First link of the chain, or its name; the base by default.

        Returns:
            The links, their number, and the pose of the tool.
        """
        last, tool = self._default_end() if end is None else (self._link(end), None)
        if isinstance(end, Gripper):
            tool = end.tool.A
        upward, downward = links_between(None if start is None else self._link(start), last)
        path = [*upward, *downward]
        return path, len(path), pose(np.eye(4) if tool is None else tool)

    def segments(self) -> list[list[Link | None]]:
        """The branches of the tree, each from the link before it to its end."""
        out: list[list[Link | None]] = []
        waiting: list[tuple[Link | None, Link]] = [(None, self.base_link)]
        while waiting:
            before, at = waiting.pop(0)
            branch: list[Link | None] = [before, at]
            while len(at.children) == 1:
                at = at.children[0]
                branch.append(at)
            out.append(branch)
            waiting += [(at, child) for child in at.children]
        return out

    def __len__(self) -> int:
        return len(self._links)

    def __getitem__(self, i: Any) -> Any:
        if not isinstance(i, str):
            return self._links[i]
        if i not in self._names():
            raise UnknownKey("link", i, self._names())
        return self._links[self._names().index(i)]

    def __iter__(self) -> Any:
        return iter(self._links)

    def _names(self) -> list[str]:
        return [link.name for link in self._links]
