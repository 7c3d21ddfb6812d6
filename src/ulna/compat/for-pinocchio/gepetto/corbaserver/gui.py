"""The graphical interface: all calls of the viewer together, and messages for those that are not offered."""

from __future__ import annotations

from typing import Any, NoReturn, final

from gepetto.corbaserver.curves import Curves
from gepetto.corbaserver.looks import Looks
from gepetto.corbaserver.windows import Windows
from ulna.errors import UnknownName, ViewerError

REFUSED = {
    "addRod": "addCapsule and addCylinder draw rods.",
    "attachCameraToNode": "Set the camera in your loop: setCameraTransform(wid, configuration).",
    "registerNodeCallback": "Panels of `viewer.panel` and `viewer.teach_panel(robot)` report clicks and drags.",
    "setCaptureTransform": "viewer.html(path, recording) writes what moves as a file that plays.",
    "captureTransformOnRefresh": "viewer.html(path, recording) writes what moves as a file that plays.",
    "captureTransform": "getNodeGlobalTransform(nodeName) returns where a node is; write it down in your loop.",
    "writeBlenderScript": "Blender reads the URDF's meshes; getNodeGlobalTransform(nodeName) returns where they are.",
}
"""Calls that make no sense in a browser, and what to use."""


@final
class Gui(Curves, Looks, Windows):
    """The calls of Gepetto viewer's graphical interface over an `ulna.Viewer`.

    Nodes are named by paths; a node is placed in its group by `applyConfiguration`, which takes effect at `refresh`.
    Wrong names raise at once with the nearest right one.
    """

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        offered = [n for n in dir(type(self)) if n[0] != "_"]
        raise AttributeError(str(UnknownName("call of the viewer", name, offered)), name=name, obj=self)

    def __repr__(self) -> str:
        return f"<calls of {self.viewer!r}>"


def _unsupported_call(name: str, reason: str) -> Any:
    def raise_error(self: Gui, *_: Any, **__: Any) -> NoReturn:
        raise ViewerError(f"{name} is not offered in this viewer. {reason}")

    raise_error.__name__, raise_error.__doc__ = name, f"Not offered. {reason}"
    return raise_error


for _name, _reason in REFUSED.items():
    setattr(Gui, _name, _unsupported_call(_name, _reason))
