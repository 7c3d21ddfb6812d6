"""How nodes look: colour, opacity, visibility, scale, and the same as properties."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from typing import Any

import numpy as np

from gepetto.corbaserver.documentation import describe_arguments
from gepetto.corbaserver.tree import Tree, without
from ulna.errors import InputError, UnknownName
from ulna.viewer.colours import colour
from ulna.viewer.graph.handles import Handle

_VISIBILITIES = ("ON", "OFF", "ALWAYS_ON_TOP")
_PROPERTIES = {"Visibility": "String", "Color": "Color", "Scale": "Vector3", "Alpha": "Float"}


@describe_arguments
class Looks(Tree, abc.ABC):
    """Calls that change how nodes look, at once."""

    def _handle(self, name: str) -> Handle:
        return Handle(self.scene, self.known(name))

    def setVisibility(self, nodeName: str, visibility: str) -> bool:
        """Shows or hides a node and all nodes in it.

        Args:
            visibility: "ON", "ALWAYS_ON_TOP" (the same here) or "OFF".

        Raises:
            UnknownName: Another `visibility`, or no such node.
        """
        if visibility not in _VISIBILITIES:
            raise UnknownName("visibility", visibility, _VISIBILITIES)
        self._handle(nodeName).visible = visibility != "OFF"
        return True

    def setColor(self, nodeName: str, color: Sequence[float]) -> bool:
        """Colours a node and all nodes in it.

        Args:
            color: Red, green, blue, opacity from 0 to 1.
        """
        rgba, place = colour(color), self.known(nodeName)
        with self.scene.atomic():
            for name in self.scene.names:
                if name == place or name.startswith(place + "/"):
                    self.scene.set_appearance(name, "tint", rgba[:3])
            self.scene.set_appearance(place, "opacity", rgba[3])
        return True

    def setScale(self, nodeName: str, scale: Sequence[float]) -> bool:
        """Scales a node along its axes; a group by one factor only.

        Args:
            scale: Factors, (3,).
        """
        self._handle(nodeName).scale = np.asarray(scale, dtype=float)
        return True

    def setWireFrameMode(self, nodeName: str, wireFrameMode: str) -> bool:
        """Surfaces are always drawn filled; other modes warn.

        Args:
            wireFrameMode: "FILL", or a mode that is not offered.

        Returns:
            Whether it is "FILL".
        """
        self.known(nodeName)
        return wireFrameMode == "FILL" or without(
            f"setWireFrameMode({nodeName!r}, {wireFrameMode!r})",
            "setColor with a low opacity lets see what is behind.",
        )

    def setLightingMode(self, nodeName: str, lightingMode: str) -> bool:
        """Everything is lit; "OFF" warns.

        Args:
            lightingMode: "ON" or "OFF".

        Returns:
            Whether it is "ON".
        """
        self.known(nodeName)
        return lightingMode == "ON" or without(
            f"setLightingMode({nodeName!r}, {lightingMode!r})", "everything is lit."
        )

    def setHighlight(self, nodeName: str, state: int) -> bool:
        """Nothing can be highlighted; states other than 0 warn.

        Args:
            state: The state.

        Returns:
            Whether it is 0.
        """
        self.known(nodeName)
        return state == 0 or without(f"setHighlight({nodeName!r}, {state})", "use setColor.")

    def setTexture(self, nodeName: str, filename: str) -> bool:
        """Not offered: textures come with meshes; warns.

        Args:
            filename: Accepted and ignored.

        Returns:
            False.
        """
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
        """Not offered: lights are those of the viewer's theme; warns.

        Args:
            lightName: Name of the light, for the warning.
            wid: Accepted and ignored.
            radius: Accepted and ignored, in any unit [-].
            RGBAcolor: Accepted and ignored.

        Returns:
            False.
        """
        return without(
            f"addLight({lightName!r})", "shared_viewer().theme.light_factor is the strength of the lights."
        )

    def setCurveMode(self, curveName: str, mode: Any) -> bool:
        """Curves go from point to point; other modes warn.

        Args:
            mode: 3 (GL_LINE_STRIP), or a mode that is not offered.

        Returns:
            Whether it is 3.
        """
        self.known(curveName)
        return mode == 3 or without(f"setCurveMode({curveName!r}, {mode})", "add a line for each piece.")

    def setCurveColors(self, curveName: str, color: Any) -> bool:
        """Colours a curve in the mean of some colours.

        Args:
            color: Red, green, blue, opacity from 0 to 1, (n, 4) or (4,).
        """
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
        """Calls a property; no node has one that can be called.

        Args:
            propName: Name of the property.

        Returns:
            Never.

        Raises:
            UnknownName: Always.
        """
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
