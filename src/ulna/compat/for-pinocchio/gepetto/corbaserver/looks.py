"""How nodes look: colour, opacity, visibility, scale, and the same as properties."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from typing import Any

import numpy as np

from gepetto.corbaserver.tree import Tree, without
from ulna.errors import InputError, UnknownName
from ulna.viewer.colours import colour
from ulna.viewer.graph.handles import Handle

_VISIBILITIES = ("ON", "OFF", "ALWAYS_ON_TOP")
_PROPERTIES = {"Visibility": "String", "Color": "Color", "Scale": "Vector3", "Alpha": "Float"}


class Looks(Tree, abc.ABC):
    """Calls that change how nodes look, at once."""

    def _handle(self, name: str) -> Handle:
        return Handle(self.scene, self.known(name))

    def setVisibility(self, nodeName: str, visibility: str) -> bool:
        """Shows a node and all in it ("ON", "ALWAYS_ON_TOP", which is the same here) or hides it ("OFF")."""
        if visibility not in _VISIBILITIES:
            raise UnknownName("visibility", visibility, _VISIBILITIES)
        self._handle(nodeName).visible = visibility != "OFF"
        return True

    def setColor(self, nodeName: str, color: Sequence[float]) -> bool:
        """Colours a node and all in it: red, green, blue, opacity from 0 to 1."""
        rgba, place = colour(color), self.known(nodeName)
        with self.scene.atomic():
            for name in self.scene.names:
                if name == place or name.startswith(place + "/"):
                    self.scene.set_appearance(name, "tint", rgba[:3])
            self.scene.set_appearance(place, "opacity", rgba[3])
        return True

    def setScale(self, nodeName: str, scale: Sequence[float]) -> bool:
        """Stretches a node along its axes; a group by one factor only."""
        self._handle(nodeName).scale = np.asarray(scale, dtype=float)
        return True

    def setWireFrameMode(self, nodeName: str, wireFrameMode: str) -> bool:
        """Surfaces are drawn filled here; False, with a warning, for anything else."""
        self.known(nodeName)
        return wireFrameMode == "FILL" or without(
            f"setWireFrameMode({nodeName!r}, {wireFrameMode!r})",
            "setColor with a low opacity lets see what is behind.",
        )

    def setLightingMode(self, nodeName: str, lightingMode: str) -> bool:
        """Everything is lit here; False, with a warning, for "OFF"."""
        self.known(nodeName)
        return lightingMode == "ON" or without(
            f"setLightingMode({nodeName!r}, {lightingMode!r})", "everything is lit."
        )

    def setHighlight(self, nodeName: str, state: int) -> bool:
        """Nothing is highlighted here; False, with a warning, unless `state` is 0."""
        self.known(nodeName)
        return state == 0 or without(f"setHighlight({nodeName!r}, {state})", "use setColor.")

    def setTexture(self, nodeName: str, filename: str) -> bool:
        """Textures come with meshes here; False, with a warning."""
        self.known(nodeName)
        return without(
            f"setTexture({nodeName!r})", "addMesh draws the textures that a dae or glb file names."
        )

    def removeLightSources(self, meshName: str) -> bool:
        """Lights in mesh files play no part, so there are none to remove."""
        self.known(meshName)
        return True

    def removeObjectFromCache(self, nodeName: str) -> bool:
        """Mesh files that changed are read anew, so nothing needs to be removed."""
        return True

    def addLight(self, lightName: str, wid: str, radius: float, RGBAcolor: Sequence[float]) -> bool:
        """The lamps are fixed here; False, with a warning."""
        return without(f"addLight({lightName!r})", "shared_viewer().theme says how strong the lamps are.")

    def setCurveMode(self, curveName: str, mode: Any) -> bool:
        """Curves go from point to point here; False, with a warning, for other modes than 3 (GL_LINE_STRIP)."""
        self.known(curveName)
        return mode == 3 or without(f"setCurveMode({curveName!r}, {mode})", "add a line for each piece.")

    def setCurveColors(self, curveName: str, color: Any) -> bool:
        """A curve has one colour here, the mean of those given."""
        return self.setColor(
            curveName, np.array(color, dtype=float).reshape(-1, np.shape(color)[-1]).mean(axis=0)
        )

    # properties -----------------------------------------------------------------------------------------

    def getPropertyNames(self, nodeName: str) -> list[str]:
        """The names of a node's properties."""
        self.known(nodeName)
        return list(_PROPERTIES)

    def getPropertyTypes(self, nodeName: str) -> list[str]:
        """The types of a node's properties."""
        self.known(nodeName)
        return list(_PROPERTIES.values())

    def _get(self, nodeName: str, propName: str, kind: str) -> Any:
        handle = self._handle(nodeName)
        match _checked(propName, kind):
            case "Visibility":
                return "ON" if handle.visible else "OFF"
            case "Color":
                return [*self._colour(handle), handle.opacity]
            case "Scale":
                return handle.scale.tolist()
        return handle.opacity

    def _colour(self, handle: Handle) -> Sequence[float]:
        surfaces = self.scene.node(handle.name).surfaces
        return handle.color or (surfaces[0].rgba[:3] if surfaces else (1.0, 1.0, 1.0))

    def _set(self, nodeName: str, propName: str, value: Any, kind: str) -> bool:
        match _checked(propName, kind):
            case "Visibility":
                return self.setVisibility(nodeName, value)
            case "Color":
                return self.setColor(nodeName, value)
            case "Scale":
                return self.setScale(nodeName, value)
        self._handle(nodeName).opacity = value
        return True

    def callVoidProperty(self, nodeName: str, propName: str) -> bool:
        """Calls a property that does something; no node has one here."""
        self.known(nodeName)
        raise UnknownName("property to call", propName, ())


def _checked(name: str, kind: str) -> str:
    if name not in _PROPERTIES:
        raise UnknownName("property", name, _PROPERTIES)
    if _PROPERTIES[name] != kind:
        right = _PROPERTIES[name]
        raise InputError(
            f"The property {name!r} is a {right}; use set{right}Property and get{right}Property."
        )
    return name


def _getter(kind: str) -> Any:
    def get(self: Looks, nodeName: str, propName: str) -> Any:
        return self._get(nodeName, propName, kind)

    get.__doc__ = f"A property that is a {kind}."
    return get


def _setter(kind: str) -> Any:
    def put(self: Looks, nodeName: str, propName: str, value: Any) -> bool:
        return self._set(nodeName, propName, value, kind)

    put.__doc__ = f"Changes a property that is a {kind}."
    return put


for _kind in ("String", "Color", "Vector3", "Vector2", "Float", "Bool", "Int"):
    setattr(Looks, f"get{_kind}Property", _getter(_kind))
    setattr(Looks, f"set{_kind}Property", _setter(_kind))
