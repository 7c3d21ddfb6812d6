"""Models of robots: joints, links, frames and inertias as frozen data, made by a builder."""

from ulna.model.builder import ModelBuilder
from ulna.model.change import (
    with_configuration,
    with_disabled_pairs,
    with_gravity,
    with_root_joint,
    with_tool,
)
from ulna.model.constraint import Constraint, FrameContact, FrameLoop, PointContact, PointLoop
from ulna.model.inertial import (
    dynamic_parameters,
    perturbed,
    with_dynamic_parameters,
    with_joint_dynamics,
    with_link_inertias,
)
from ulna.model.joints import (
    Circle,
    Composite,
    Continuous,
    Coordinate,
    Fixed,
    FreeFlyer,
    Helical,
    JointKind,
    Planar,
    PlanarCircle,
    Prismatic,
    Revolute,
    Spherical,
    Translation,
    Universal,
)
from ulna.model.merge import attach
from ulna.model.model import Model
from ulna.model.parts import Frame, Joint, Limits, Link, Mimic
from ulna.model.payload import Drive, with_drives, with_payload
from ulna.model.positions import position
from ulna.model.reduce import lock_joints
from ulna.model.variable import parameter_names, parameters, with_parameters

__all__ = [
    "Circle",
    "Composite",
    "Constraint",
    "Continuous",
    "Coordinate",
    "Drive",
    "Fixed",
    "Frame",
    "FrameContact",
    "FrameLoop",
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
    "PlanarCircle",
    "PointContact",
    "PointLoop",
    "Prismatic",
    "Revolute",
    "Spherical",
    "Translation",
    "Universal",
    "attach",
    "dynamic_parameters",
    "lock_joints",
    "parameter_names",
    "parameters",
    "perturbed",
    "position",
    "with_configuration",
    "with_disabled_pairs",
    "with_drives",
    "with_dynamic_parameters",
    "with_gravity",
    "with_joint_dynamics",
    "with_link_inertias",
    "with_parameters",
    "with_payload",
    "with_root_joint",
    "with_tool",
]
