"""MeshCat's materials. What only concerns shading (`reflectivity`, `side`, ...) is kept and plays no part."""

from __future__ import annotations

from typing import Any

from ulna.errors import InputError


class SceneElement:
    """Anything that a scene consists of."""


class ReferenceSceneElement(SceneElement):
    """What objects of a scene refer to: forms and materials, which several objects may share."""


class Material(ReferenceSceneElement):
    """How a form looks."""


class GenericMaterial(Material):
    """A material with a colour.

    Args:
        color: 0xRRGGBB.
        reflectivity: Kept; plays no part here [-].
        map: Not offered.
        side: Kept; surfaces are drawn on both sides.
        transparent: False draws it opaque; by default it is so where `opacity` is 1.
        opacity: From 0 to 1 [-].
        linewidth: Thickness of lines [pixels].
        wireframe: Whether only the edges of the triangles are drawn.
        wireframeLinewidth: Their thickness [pixels].
        vertexColors: Whether the colours of vertices count.
        **kwargs: Properties of three.js for shading; kept.

    Raises:
        InputError: `map` was passed.
    """

    def __init__(
        self,
        color: Any = 0xFFFFFF,
        reflectivity: float = 0.5,
        map: Any = None,
        side: int = 2,
        transparent: bool | None = None,
        opacity: float = 1.0,
        linewidth: float = 1.0,
        wireframe: bool = False,
        wireframeLinewidth: float = 1.0,
        vertexColors: bool = False,
        **kwargs: Any,
    ) -> None:
        if map is not None:
            raise InputError("`map` is not offered: textures are drawn where a dae or glb file names them.")
        self.color, self.opacity, self.transparent = color, opacity, transparent
        self.reflectivity, self.map, self.side = reflectivity, map, side
        self.linewidth, self.wireframe = linewidth, wireframe
        self.wireframeLinewidth, self.vertexColors = wireframeLinewidth, vertexColors
        self.properties = kwargs


class MeshBasicMaterial(GenericMaterial):
    """A material without shading in three.js; shaded as others here."""


class MeshPhongMaterial(GenericMaterial):
    """A shiny material."""


class MeshLambertMaterial(GenericMaterial):
    """A dull material."""


class MeshToonMaterial(GenericMaterial):
    """A material of few shades in three.js; shaded as others here."""


class LineBasicMaterial(GenericMaterial):
    """The colour and thickness of lines."""


class PointsMaterial(Material):
    """The size and colour of points.

    Args:
        size: Diameter [m].
        color: 0xRRGGBB, where the points have no colours.
    """

    def __init__(self, size: float = 0.001, color: Any = 0xFFFFFF) -> None:
        self.size, self.color = size, color
