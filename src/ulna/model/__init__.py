"""Models of robots: joints, links, frames and inertias as frozen data, made by a builder."""

from ulna.model.builder import ModelBuilder
from ulna.model.change import (
    with_configuration,
    with_disabled_pairs,
    with_gravity,
    with_root_joint,
    with_tool,
)
from ulna.model.joints import (
    Composite,
    Continuous,
    Coordinate,
    Fixed,
    FreeFlyer,
    Helical,
    JointKind,
    Planar,
    Prismatic,
    Revolute,
    Spherical,
    Translation,
    Universal,
)
from ulna.model.merge import attach
from ulna.model.model import Model
from ulna.model.parts import Frame, Joint, Limits, Link, Mimic
from ulna.model.positions import position
from ulna.model.reduce import lock_joints

__all__ = [
    "Composite",
    "Continuous",
    "Coordinate",
    "Fixed",
    "Frame",
    "FreeFlyer",
    "Helical",
    "Joint",
    "JointKind",
    "Limits",
    "Link",
    "Mimic",
    "Model",
    "ModelBuilder",
    "Planar",
    "Prismatic",
    "Revolute",
    "Spherical",
    "Translation",
    "Universal",
    "attach",
    "lock_joints",
    "position",
    "with_configuration",
    "with_disabled_pairs",
    "with_gravity",
    "with_root_joint",
    "with_tool",
]
