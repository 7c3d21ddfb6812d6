"""The face of spatialgeometry over Ulna: shapes with a pose, a colour and a velocity, in a tree of frames."""

from __future__ import annotations

from spatialgeometry import geom as geom
from spatialgeometry import tools as tools
from spatialgeometry._collision import CollisionShape as CollisionShape
from spatialgeometry._collision import CollisionShapeGroup as CollisionShapeGroup
from spatialgeometry._lines import Arrow as Arrow
from spatialgeometry._lines import Axes as Axes
from spatialgeometry._lines import Path as Path
from spatialgeometry._lines import Polyline as Polyline
from spatialgeometry._mesh import Mesh as Mesh
from spatialgeometry._node import SceneGroup as SceneGroup
from spatialgeometry._node import SceneNode as SceneNode
from spatialgeometry._shape import Shape as Shape
from spatialgeometry._solids import Box as Box
from spatialgeometry._solids import Capsule as Capsule
from spatialgeometry._solids import Cone as Cone
from spatialgeometry._solids import Cuboid as Cuboid
from spatialgeometry._solids import Cylinder as Cylinder
from spatialgeometry._solids import Ellipsoid as Ellipsoid
from spatialgeometry._solids import Sphere as Sphere

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

_INSTEAD = {
    "scene": "It is the compiled part of the scene tree; SceneNode has `T`, `scene_parent`, `attach` and `update`.",
    "Plane": "A Cuboid with one thin edge is drawn and collided with as one; ulna.geometry.Plane is without end.",
    "Torus": "Load it as a Mesh.",
    "SceneObject": "Use SceneNode.",
}


def __getattr__(name: str) -> object:
    hint = _INSTEAD.get(name, f"There are: {', '.join(__all__)}.")
    raise AttributeError(f"Ulna's package for spatialgeometry has no {name!r}. {hint}")
