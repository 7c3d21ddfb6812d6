"""The kinds of joints."""

from ulna.model.joints.ball import FreeFlyer, Spherical
from ulna.model.joints.base import Coordinate, JointKind, VectorKind
from ulna.model.joints.circle import Circle, PlanarCircle
from ulna.model.joints.composite import Composite
from ulna.model.joints.fixed import Fixed
from ulna.model.joints.planar import Planar
from ulna.model.joints.sliding import Prismatic, Translation
from ulna.model.joints.turning import Continuous, Helical, Revolute, Universal

__all__ = [
    "Circle",
    "Composite",
    "Continuous",
    "Coordinate",
    "Fixed",
    "FreeFlyer",
    "Helical",
    "JointKind",
    "Planar",
    "PlanarCircle",
    "Prismatic",
    "Revolute",
    "Spherical",
    "Translation",
    "Universal",
    "VectorKind",
]
