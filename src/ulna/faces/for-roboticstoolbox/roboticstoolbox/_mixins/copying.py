"""Robots that are copied and pickled: links of their own, kernels shared or made anew."""

from __future__ import annotations

import copy as copying
from typing import Any, Self

from roboticstoolbox._links.gripper import Gripper
from roboticstoolbox._mixins.robot_mixin import Part


class Copies(Part):
    """Copies of a robot."""

    def copy(self) -> Self:
        """A copy with links of its own."""
        return copying.deepcopy(self)

    def __deepcopy__(self, memo: Any) -> Self:
        out: Any = object.__new__(type(self))
        memo[id(self)] = out
        shared = {"_kernels", "_chains", "_whole", "_weights"}
        new = {}
        everyone = list(self.link_dict.values())
        for link in everyone:
            new[id(link)] = link.copy()
            new[id(link)].robot = out
        for link in everyone:
            twin = new[id(link)]
            twin._parent = new.get(id(link._parent))
            twin.children = [new[id(child)] for child in link.children]
        for key, value in self.__dict__.items():
            if key in shared or key in ("_links", "_grippers", "_parent", "_children"):
                continue
            out.__dict__[key] = copying.deepcopy(value, memo)
        out._kernels, out._chains, out._whole, out._weights = self._kernels, self._chains, self._whole, None
        out._links = [new[id(link)] for link in self._links]
        out._grippers, out._parent, out._children = [], None, []
        for gripper in self._grippers:
            twin = Gripper([new[id(link)] for link in gripper.links], gripper.name, gripper._tool)
            twin.q = gripper.q.copy()
            out._grippers.append(twin)
        return out

    def __reduce__(self) -> Any:
        state = {
            k: v for k, v in self.__dict__.items() if k not in ("_kernels", "_chains", "_whole", "_weights")
        }
        return _rebuilt, (type(self), state | {"_parent": None})


def _rebuilt(kind: type, state: dict[str, Any]) -> Any:
    out = object.__new__(kind)
    out.__dict__.update(state)
    out._kernels, out._chains, out._whole, out._weights = {}, {}, None, None
    return out
