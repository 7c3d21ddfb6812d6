"""The nodes of a viewer that MeshCat's tree draws: objects with what they are stretched by."""

from __future__ import annotations

from typing import final

import numpy as np
from gepetto.corbaserver.gui import Gui
from gepetto.corbaserver.reach import is_drawable
from gepetto.corbaserver.tree import PARTS

from meshcat.drawing import Drawn
from meshcat.surroundings import Surroundings
from ulna.errors import InputError
from ulna.spatial.nearest import nearest_rotation
from ulna.typing import Floats

_OBJECT = f"{PARTS}object"


@final
class ViewerWindow:
    """The viewer that a tree is drawn into, and what its objects look like before they are stretched.

    Args:
        gui: The calls of the viewer.
    """

    def __init__(self, gui: Gui) -> None:
        self.gui = gui
        self.surroundings = Surroundings(gui)
        self.objects: dict[str, Drawn] = {}
        """What was set as an object, by the name of its node."""
        self.stretched: dict[str, Floats] = {}
        """Linear maps (3, 3) of nodes whose objects are stretched."""

    @property
    def web_url(self) -> str:
        """The address of the page; empty without one."""
        return self.gui.viewer.url

    zmq_url = ""
    """There is no server to connect to."""

    # nodes ----------------------------------------------------------------------------------------------

    def place(self, node: str, matrix: Floats) -> None:
        """Places a node in its group; what is not a rotation stretches its object.

        Args:
            node: Name of the node; an empty group is made where there is none.
            matrix: Any affine map, (4, 4).

        Raises:
            InputError: A group would be stretched differently along its axes.
        """
        scene, gui = self.gui.scene, self.gui
        if not is_drawable(matrix, node):
            return
        linear, pose = matrix[:3, :3], matrix.copy()
        stretch: Floats | None = None
        if np.abs(linear.T @ linear - np.eye(3)).max() > 1e-6 or np.linalg.det(linear) < 0.0:
            pose[:3, :3] = nearest_rotation(linear)
            stretch = pose[:3, :3].T @ linear
        if node not in scene:
            gui.createGroup(node)
        with scene.atomic():
            if stretch is not None or node in self.stretched:
                self._stretch(node, np.eye(3) if stretch is None else stretch)
            scene.set_pose(node, pose)

    def _stretch(self, node: str, linear: Floats) -> None:
        scene = self.gui.scene
        factors = np.diag(linear)
        uniform = bool(np.ptp(factors) < 1e-9)
        self.stretched[node] = linear
        if node in self.objects and not self._inside(node):
            scene.set_appearance(node, "scale", np.ones(3))
            self._draw(node)
        elif np.abs(linear - np.diag(factors)).max() < 1e-9 and (uniform or not self._inside(node)):
            scene.set_appearance(node, "scale", np.full(3, factors.mean()) if uniform else factors)
        else:
            raise InputError(
                f"{node!r} has objects below it, and its matrix stretches them differently along its axes; "
                "expected a rotation with a factor for all axes."
            )

    def _inside(self, node: str) -> list[str]:
        """The nodes below a node that are not parts of it."""
        start = f"{node}/"
        return [n for n in self.gui.scene.names if n.startswith(start) and PARTS not in n[len(start) :]]

    def show(self, node: str, drawn: Drawn) -> None:
        """Replaces the object of a node; its place and the nodes below it remain.

        Args:
            node: Name of the node; it is made where there is none.
            drawn: What is seen.
        """
        gui, scene = self.gui, self.gui.scene
        with scene.atomic():
            gui.createGroup(node)
            if scene.node(node).surfaces:
                scene.set_surfaces(node, ())
            self.objects[node] = drawn
            self._draw(node)

    def _draw(self, node: str) -> None:
        viewer, scene = self.gui.viewer, self.gui.scene
        start = f"{node}/{_OBJECT}"
        for name in [n for n in scene.names if n.startswith(start)]:
            viewer.remove(name)
        drawn = self.objects[node]
        if node in self.stretched:
            drawn = drawn.stretched(self.stretched[node])
        if drawn.surfaces:
            scene.add(start, drawn.surfaces)
        for i, content in enumerate(drawn.contents):
            scene.add(f"{start}{i}", content=content, shadow=False)

    def remove(self, node: str) -> None:
        """Removes a node with all nodes in it; nothing happens where there is none.

        Args:
            node: Name of the node; empty for all of them.
        """
        if node:
            self.gui.deleteNode(node, True)
        else:
            self.gui.viewer.clear()
        for states in (self.objects, self.stretched):
            for gone in [n for n in states if n not in self.gui.scene]:
                del states[gone]
