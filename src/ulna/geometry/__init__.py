"""Shapes, materials and their places on links, as frozen data."""

from ulna.geometry.geometry import Geometry, Material
from ulna.geometry.shapes import Box, Capsule, Cone, Cylinder, Ellipsoid, Mesh, Plane, Shape, Sphere

__all__ = [
    "Box",
    "Capsule",
    "Cone",
    "Cylinder",
    "Ellipsoid",
    "Geometry",
    "Material",
    "Mesh",
    "Plane",
    "Shape",
    "Sphere",
]
