"""The handles of the nodes of a scene, by name."""

from __future__ import annotations

import abc
import itertools
from collections.abc import Iterable
from typing import Any

from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import fraction, one_of
from ulna.viewer.graph.content import Content
from ulna.viewer.graph.handles import Handle
from ulna.viewer.graph.node import check_name
from ulna.viewer.mesh.surface import Surface
from ulna.viewer.scene.scene import Scene


class HandleRegistry(FixedAttributes, abc.ABC):
    """A scene whose things are found, replaced and removed by name."""

    scene: Scene
    """The scene: names, poses and looks of everything."""

    def __init__(self) -> None:
        self.scene = Scene()
        self._handles: dict[str, Handle] = {}
        self._counts: dict[str, int] = {}

    @abc.abstractmethod
    def _on_added(self, handle: Handle) -> None:
        """Something was added."""

    def remove(self, thing: Handle | str) -> None:
        """Take a thing out, with all that is in it.

        Raises:
            UnknownName: There is nothing of that name.
        """
        name = (
            thing.name
            if isinstance(thing, Handle)
            else one_of("object in the scene", thing, self.scene.names)
        )
        handle = self._handles.get(name)
        if handle is not None:
            handle.remove()
        else:
            self.scene.remove(name)
        self._handles = {n: h for n, h in self._handles.items() if n in self.scene}

    def clear(self) -> None:
        """Take everything out."""
        for name in self.scene.names:
            if name in self.scene:
                self.remove(name)
        self._counts.clear()

    def __getitem__(self, name: str) -> Any:
        """The handle of a node or a group."""
        one_of("object in the scene", name, self.scene.names)
        return self._handles.get(name) or Handle(self.scene, name)

    def __contains__(self, name: object) -> bool:
        return name in self.scene

    def _unused_name(self, kind: str) -> str:
        """A name for another thing of that kind."""
        names = ((k, kind if k == 1 else f"{kind} {k}") for k in itertools.count(self._counts.get(kind, 1)))
        count, name = next((k, n) for k, n in names if n not in self.scene)
        self._counts[kind] = count
        return name

    def _name(self, name: str | None, kind: str) -> str:
        """A name that was given, or one for another thing of that kind."""
        if name is None:
            return self._unused_name(kind)
        check_name(name)
        return name

    def _add_node(
        self,
        name: str | None,
        kind: str,
        surfaces: Iterable[Surface] = (),
        *,
        content: Content | None = None,
        pose: Any = None,
        opacity: float = 1.0,
        shadow: bool = True,
        through: bool = False,
        kind_of: Any = Handle,
    ) -> Any:
        node = self._name(name, kind)
        fraction("opacity", opacity)
        self.scene.add(node, surfaces, pose, shadow, through, content)
        out = kind_of(self.scene, node)
        self._register(out, opacity)
        return out

    def _register(self, handle: Handle, opacity: float) -> None:
        handle.opacity = opacity
        self._handles[handle.name] = handle
        self._on_added(handle)
