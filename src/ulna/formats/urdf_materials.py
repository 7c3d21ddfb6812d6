"""The materials of a URDF: those that the robot defines, those that a visual defines, and which one a visual means."""

from __future__ import annotations

from dataclasses import replace

from ulna.formats.node import Node, nearest
from ulna.formats.urdf_document import UrdfMaterial


class Palette:
    """The materials of a file by name: those of the robot, then those that a visual defines on the way."""

    def __init__(self, root: Node) -> None:
        self.named: dict[str, UrdfMaterial] = {}
        self._undefined: set[str] = set()
        for node in root.children("material"):
            self._add(_material(node))
        for link in root.children("link"):
            for visual in link.children("visual"):
                for node in visual.children("material"):
                    self._add(_material(node, quiet=True))  # its warnings come when the visual is read

    def _add(self, material: UrdfMaterial) -> None:
        if material.name and (material.rgba or material.texture):
            self.named.setdefault(material.name, material)

    def of(self, node: Node) -> UrdfMaterial:
        """The material that a visual means, its own or one by name; warns once of a name that is not defined."""
        material = _material(node)
        known = self.named.get(material.name)
        if material.texture is not None or material.rgba is not None:
            return replace(material, rgba=known.rgba) if material.rgba is None and known else material
        if known is not None:
            return known
        if material.name and material.name not in self._undefined:
            self._undefined.add(material.name)
            hint = nearest(material.name, self.named, "; did you mean {}?")
            node.warn(f"no material {material.name!r} is defined{hint}")
        return material


def _material(node: Node, quiet: bool = False) -> UrdfMaterial:
    color = next(node.children("color"), None) if quiet else node.child("color")
    texture = next(node.children("texture"), None) if quiet else node.child("texture")
    rgba = None
    if color is not None:
        rgba = color.vector("rgba", 4)
        if not all(0.0 <= c <= 1.0 for c in rgba):
            if not quiet:
                color.warn("a colour outside 0..1 is held to it")
            rgba = tuple(min(max(c, 0.0), 1.0) for c in rgba)
    return UrdfMaterial(node.string("name") or "", rgba, texture.string("filename") if texture else None)
