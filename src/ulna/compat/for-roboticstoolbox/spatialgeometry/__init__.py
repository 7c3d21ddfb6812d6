"""The face of spatialgeometry over Ulna: shapes with a pose, a colour and a velocity, in a tree of frames."""

from __future__ import annotations

from spatialgeometry import geom, tools
from spatialgeometry._collision import CollisionShape, CollisionShapeGroup
from spatialgeometry._lines import Arrow, Axes, Path, Polyline
from spatialgeometry._mesh import Mesh
from spatialgeometry._node import SceneGroup, SceneNode
from spatialgeometry._shape import Shape
from spatialgeometry._solids import Box, Capsule, Cone, Cuboid, Cylinder, Ellipsoid, Sphere
from ulna.compat.missing_names import missing_name as _missing_name

__version__ = "1.4"
"""The version of spatialgeometry whose names these are."""

__all__ = [
    "Arrow",
    "Axes",
    "Box",
    "Capsule",
    "CollisionShape",
    "CollisionShapeGroup",
    "Cone",
    "Cuboid",
    "Cylinder",
    "Ellipsoid",
    "Mesh",
    "Path",
    "Polyline",
    "SceneGroup",
    "SceneNode",
    "Shape",
    "Sphere",
    "geom",
    "tools",
]

_ALTERNATIVES = {
    "scene": "It is the compiled part of the scene tree; SceneNode has `T`, `scene_parent`, `attach` and `update`.",
    "Plane": "A Cuboid with one thin edge is drawn and collided with as one; ulna.geometry.Plane is without end.",
    "Torus": "Load it as a Mesh.",
    "SceneObject": "Use SceneNode.",
}


def __getattr__(name: str) -> object:
    hint = _ALTERNATIVES.get(name, f"There are: {', '.join(__all__)}.")
    raise _missing_name(__name__, name, f"Ulna's package for spatialgeometry has no {name!r}. {hint}")
