"""Copies and pickles of robots: links are copied, compiled kernels are shared or compiled again."""

from __future__ import annotations

import copy as copying
from typing import Any, Self

from roboticstoolbox._links.gripper import Gripper
from roboticstoolbox._mixins.robot_mixin import RobotMixin

_CACHES = {"_kernels", "_chains", "_cached_robot", "_dynamic_arrays", "_figure"}
"""What follows from the links, and is not copied with them."""


class Copying(RobotMixin):
    """Copies of a robot."""

    def copy(self) -> Self:
        """A copy, with copies of the links."""
        return copying.deepcopy(self)

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Self:
        out: Any = object.__new__(type(self))
        memo[id(self)] = out
        new = {}
        all_links = list(self.link_dict.values())
        for link in all_links:
            new[id(link)] = memo[id(link)] = link.copy()
            new[id(link)].robot = out
        for link in all_links:
            duplicate = new[id(link)]
            duplicate._parent = new.get(id(link._parent))
            duplicate.children = [new[id(child)] for child in link.children]
        for key, value in self.__dict__.items():
            if key not in _CACHES and key not in ("_links", "_grippers", "_parent", "_children"):
                out.__dict__[key] = copying.deepcopy(value, memo)
        out._kernels, out._chains, out._cached_robot = self._kernels, self._chains, self._cached_robot
        out._dynamic_arrays = None
        out._links = [new[id(link)] for link in self._links]
        out._grippers, out._parent, out._children = [], None, []
        for gripper in self._grippers:
            duplicate = Gripper([new[id(link)] for link in gripper.links], gripper.name, gripper._tool)
            duplicate.q = gripper.q.copy()
            out._grippers.append(duplicate)
        return out

    def __reduce__(self) -> Any:
        state = {key: value for key, value in self.__dict__.items() if key not in _CACHES}
        return _rebuilt, (type(self), state | {"_parent": None})


def _rebuilt(kind: type, state: dict[str, Any]) -> Any:
    out = object.__new__(kind)
    out.__dict__.update(state)
    out._kernels, out._chains, out._cached_robot, out._dynamic_arrays = {}, {}, None, None
    return out
