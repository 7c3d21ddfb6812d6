"""Shapes, materials and their places on links, as frozen data."""

from ulna.geometry.geometry import Geometry as Geometry
from ulna.geometry.geometry import Material as Material
from ulna.geometry.shapes import Box as Box
from ulna.geometry.shapes import Capsule as Capsule
from ulna.geometry.shapes import Cone as Cone
from ulna.geometry.shapes import Cylinder as Cylinder
from ulna.geometry.shapes import Ellipsoid as Ellipsoid
from ulna.geometry.shapes import HeightField as HeightField
from ulna.geometry.shapes import Mesh as Mesh
from ulna.geometry.shapes import Plane as Plane
from ulna.geometry.shapes import PointCloud as PointCloud
from ulna.geometry.shapes import Shape as Shape
from ulna.geometry.shapes import Sphere as Sphere
