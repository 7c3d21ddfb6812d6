"""The tree of nodes: groups, names, placements that take effect at `refresh`."""

from __future__ import annotations

import abc
import warnings
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from gepetto.corbaserver.documentation import describe_arguments
from gepetto.corbaserver.placement import configuration_of, pose_of
from ulna.errors import InputError, UlnaWarning, UnknownName
from ulna.typing import Floats
from ulna.viewer.viewer import Viewer

PARTS = "·"
"""Begins the names of what a node is made of, which are not separate nodes."""


@describe_arguments
class Tree(abc.ABC):
    """Nodes of a viewer by their names, in the groups of their paths or those they were added to."""

    def __init__(self, viewer: Viewer) -> None:
        self.viewer = viewer
        """The `ulna.Viewer` that is drawn into."""
        self.had_page = not viewer.closed
        self._elsewhere: dict[str, str] = {}  # nodes that were put into other groups, and where they are
        self._placed: dict[str, Floats] = {}
        self._static: dict[str, Floats] = {}
        self._waiting: dict[str, Floats] = {}

    @property
    def scene(self) -> Any:
        """The scene of the viewer."""
        return self.viewer.scene

    # names ----------------------------------------------------------------------------------------------

    def at(self, name: str) -> str:
        """The name in the scene of a node, whether there is one or not."""
        parts = [part for part in str(name).split("/") if part]
        if not parts:
            raise InputError(f"The name of a node is {name!r}; expected names with '/' between them.")
        for k in range(len(parts), 0, -1):
            moved = self._elsewhere.get("/".join(parts[:k]))
            if moved is not None:
                return "/".join([moved, *parts[k:]])
        return "/".join(parts)

    def known(self, name: str) -> str:
        """The name in the scene of a node. Raises UnknownName with the nearest one if there is none."""
        place = self.at(name)
        if place not in self.scene:
            raise UnknownName("node of the viewer", name, self.getNodeList())
        return place

    def nodeExists(self, nodeName: str) -> bool:
        """Whether there is a node of that name."""
        return self.at(nodeName) in self.scene

    def getNodeList(self) -> list[str]:
        """The names of all nodes."""
        back = {place: name for name, place in self._elsewhere.items()}
        out = []
        for place in self.scene.names:
            if PARTS in place:
                continue
            above = next((a for a in _upwards(place) if a in back), "")
            out.append(back[above] + place[len(above) :] if above else place)
        return out

    def getGroupNodeList(self, group: str) -> list[str]:
        """The names of the nodes in a group."""
        inside = self.known(group) + "/"
        return [name for name in self.getNodeList() if self.at(name).startswith(inside)]

    def getSceneList(self) -> list[str]:
        """The names of the scenes: the groups that are in no other."""
        return [name for name in self.getNodeList() if "/" not in self.at(name)]

    # groups ---------------------------------------------------------------------------------------------

    def createGroup(self, groupName: str) -> bool:
        """Adds a group, if there is none of that name."""
        place = self.at(groupName)
        if place not in self.scene:
            self.viewer.group(place)
        return True

    def createScene(self, sceneName: str) -> bool:
        """Adds a scene, which is a group in no other."""
        return self.createGroup(sceneName)

    def addToGroup(self, nodeName: str, groupName: str) -> bool:
        """Moves a node into a group, whose pose, visibility and colour hold for it from now on; its name remains
        valid.

        Raises:
            InputError: The group is in the node, or has a node of that name.
        """
        old, group = self.known(nodeName), self.known(groupName)
        if old == group or group.startswith(old + "/"):
            raise InputError(f"{groupName!r} is in {nodeName!r}; a node cannot be in itself.")
        new = f"{group}/{old.rpartition('/')[2]}"
        if new == old:  # it may have been taken out of sight
            self.scene.set_appearance(old, "visible", True)
            return True
        if new in self.scene:
            raise InputError(f"There is a node named {new!r} already; rename {nodeName!r}.")
        self._move(old, new)
        self._elsewhere["/".join(part for part in str(nodeName).split("/") if part)] = new
        return True

    def removeFromGroup(self, nodeName: str, groupName: str) -> bool:
        """Hides a node of a group, until it is added to another.

        Returns:
            Whether the node is in that group.
        """
        if self.known(nodeName).rpartition("/")[0] != self.known(groupName):
            return False
        self.scene.set_appearance(self.known(nodeName), "visible", False)
        return True

    def _move(self, old: str, new: str) -> None:
        scene = self.scene
        with scene.atomic():
            for name in [n for n in scene.names if n == old or n.startswith(old + "/")]:
                node, to = scene.node(name), new + name[len(old) :]
                scene.add(to, node.surfaces, scene.pose(name), node.shadow, node.through, node.content)
                for key in ("scale", "opacity", "tint", "visible"):
                    scene.set_appearance(to, key, scene.look(name, key))
            scene.set_appearance(new, "visible", True)
            self.viewer.remove(old)

    def deleteNode(self, nodeName: str, all: bool = True) -> bool:
        """Removes a node with all nodes in it.

        Args:
            all: Whether to remove nodes that contain others.

        Returns:
            Whether there was such a node.

        Raises:
            InputError: There are nodes in it, and `all` is False.
        """
        place = self.at(nodeName)
        if place not in self.scene:
            return False
        inside = self.getGroupNodeList(nodeName)
        if inside and not all:
            raise InputError(
                f"{len(inside)} nodes are in {nodeName!r}: deleteNode({nodeName!r}, True) removes them, too."
            )
        self.viewer.remove(place)
        self._elsewhere = {name: to for name, to in self._elsewhere.items() if to in self.scene}
        for poses_by_node in (self._placed, self._static, self._waiting):
            for gone in [p for p in poses_by_node if p not in self.scene]:
                del poses_by_node[gone]
        return True

    # placements -----------------------------------------------------------------------------------------

    def applyConfiguration(self, nodeName: str, configuration: Sequence[float]) -> bool:
        """Places a node in its group. It takes effect at `refresh`.

        The quaternion stands as `gepetto.corbaserver.quaternion_order` says: xyzw, unless set otherwise.
        """
        place = self.known(nodeName)
        self._waiting[place] = pose_of(configuration)
        return True

    def applyConfigurations(
        self, nodeNames: Sequence[str], configurations: Iterable[Sequence[float]]
    ) -> bool:
        """Places several nodes; see `applyConfiguration`.

        Args:
            nodeNames: Names of the nodes.
            configurations: x, y, z [m] and a quaternion of each, (n, 7).

        Raises:
            InputError: Not as many configurations as nodes.
        """
        configuration_list = list(configurations)
        if len(nodeNames) != len(configuration_list):
            raise InputError(
                f"{len(nodeNames)} nodes, but {len(configuration_list)} configurations; expected one for each."
            )
        placed = {
            self.known(name): pose_of(c, f"configuration of {name}")
            for name, c in zip(nodeNames, configuration_list, strict=True)
        }
        self._waiting |= placed
        return True

    def refresh(self) -> bool:
        """Shows what was placed since the last time, all of it at once."""
        with self.scene.atomic():
            self.settle()
        self.refreshed()
        return True

    def settle(self) -> None:
        """Writes the placements that wait into the scene."""
        for place, pose in self._waiting.items():
            if place not in self.scene:  # removed by other means
                continue
            self._placed[place] = pose
            self.scene.set_pose(place, pose @ self._static[place] if place in self._static else pose)
        self._waiting.clear()

    @abc.abstractmethod
    def refreshed(self) -> None:
        """Something new is to be seen."""

    def getNodeGlobalTransform(self, nodeName: str) -> list[float]:
        """Where a node is in the world, as seven numbers."""
        return configuration_of(self.scene.snapshot().poses[self.scene.row(self.known(nodeName))])

    def getStaticTransform(self, nodeName: str) -> list[float]:
        """Where a node is in the frame that its configuration places, as seven numbers."""
        return configuration_of(self._static.get(self.known(nodeName), np.eye(4)))

    def setStaticTransform(self, nodeName: str, configuration: Sequence[float]) -> bool:
        """Places a node in the frame that its configuration places. It takes effect at `refresh`."""
        place = self.known(nodeName)
        self._static[place] = pose_of(configuration)
        self._waiting.setdefault(place, self._placed.get(place, np.eye(4)))
        return True

    def setRefreshIsSynchronous(self, synchronous: bool) -> bool:
        """Says whether `refresh` waits until it is drawn; it never needs to."""
        return True


def without(name: str, reason: str) -> bool:
    """Warns that a call changes nothing in this viewer, so that scripts go on.

    Args:
        name: The call.
        reason: Why, or what to use instead.

    Returns:
        False.
    """
    warnings.warn(f"{name} changes nothing in this viewer: {reason}", UlnaWarning, stacklevel=3)
    return False


def _upwards(place: str) -> Iterable[str]:
    while place:
        yield place
        place = place.rpartition("/")[0]
