"""The Universal Robots UR5: kinematics and masses from its maker's published parameters.

Link lengths and masses: Universal Robots, "DH parameters for calculations of kinematics and dynamics". The
rotational inertias are those in common use for this arm: of solid cylinders about the joint axes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ulna.formats.poses import pose
from ulna.geometry import Geometry
from ulna.model import Fixed, JointKind, Model, ModelBuilder, Revolute
from ulna.robots.shapes import BLUE, DARK, GREY, SILVER, add_root_and_links, block, rod, tube
from ulna.spatial import Inertia

_RIGHT = math.pi / 2.0
_TURN = 2.0 * math.pi

# joint: child; translation [m] and turn about y [rad] from the link before; axis; limit [rad]; [rad/s]; [N m]
_JOINTS = {
    "shoulder_pan_joint": ("shoulder_link", (0.0, 0.0, 0.089159), 0.0, "z", _TURN, 3.15, 150.0),
    "shoulder_lift_joint": ("upper_arm_link", (0.0, 0.13585, 0.0), _RIGHT, "y", _TURN, 3.15, 150.0),
    "elbow_joint": ("forearm_link", (0.0, -0.1197, 0.425), 0.0, "y", math.pi, 3.15, 150.0),
    "wrist_1_joint": ("wrist_1_link", (0.0, 0.0, 0.39225), _RIGHT, "y", _TURN, 3.2, 28.0),
    "wrist_2_joint": ("wrist_2_link", (0.0, 0.093, 0.0), 0.0, "z", _TURN, 3.2, 28.0),
    "wrist_3_joint": ("wrist_3_link", (0.0, 0.0, 0.09465), 0.0, "y", _TURN, 3.2, 28.0),
}

_AXES = {"y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

# link: mass [kg]; height of the centre of mass [m]; inertia about it across and along z [kg m^2]
_INERTIAS = {
    "base_link": (4.0, 0.0, 0.00443333156, 0.0072),
    "shoulder_link": (3.7, 0.0, 0.010267495893, 0.00666),
    "upper_arm_link": (8.393, 0.28, 0.22689067591, 0.0151074),
    "forearm_link": (2.275, 0.25, 0.049443313556, 0.004095),
    "wrist_1_link": (1.219, 0.0, 0.111172755531, 0.21942),
    "wrist_2_link": (1.219, 0.0, 0.111172755531, 0.21942),
    "wrist_3_link": (0.1879, 0.0, 0.0171364731454, 0.033822),
}

CONFIGURATIONS = {
    "qz": (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    "qr": (math.pi, 0.0, 0.0, 0.0, math.pi / 2, 0.0),
    "ready": (0.0, -math.pi / 2, math.pi / 2, -math.pi / 2, -math.pi / 2, 0.0),
}
"""Joint angles [rad]: zero (stretched out level), the same with the wrist turned, and bent, tool down."""

_BODIES: dict[str, list[Geometry]] = {
    "world": [],
    "base_link": [
        tube((0.0, 0.0, 0.0), (0.0, 0.0, 0.012), 0.0745, SILVER),
        tube((0.0, 0.0, 0.012), (0.0, 0.0, 0.024), 0.06, DARK),
        block((0.0, -0.085, 0.011), (0.05, 0.04, 0.014), DARK),
    ],
    "shoulder_link": [
        tube((0.0, 0.0, -0.065), (0.0, 0.0, -0.052), 0.06, DARK),
        tube((0.0, 0.0, -0.052), (0.0, 0.0, 0.0), 0.0585, SILVER),
        rod((0.0, 0.0, 0.0), (0.0, 0.01, 0.005), 0.0585, SILVER),
        tube((0.0, 0.0, 0.0), (0.0, 0.066, 0.0), 0.0585, SILVER),
        tube((0.0, 0.066, 0.0), (0.0, 0.072, 0.0), 0.059, DARK),
    ],
    "upper_arm_link": [
        tube((0.0, -0.064, 0.0), (0.0, 0.05, 0.0), 0.0585, SILVER),
        tube((0.0, 0.05, 0.0), (0.0, 0.068, 0.0), 0.054, BLUE),
        rod((0.0, -0.004, 0.05), (0.0, -0.004, 0.375), 0.0425, SILVER),
        tube((0.0, -0.06, 0.425), (0.0, 0.042, 0.425), 0.0585, SILVER),
        tube((0.0, 0.042, 0.425), (0.0, 0.06, 0.425), 0.054, BLUE),
    ],
    "forearm_link": [
        tube((0.0, -0.05, 0.0), (0.0, 0.056, 0.0), 0.0575, SILVER),
        tube((0.0, -0.056, 0.0), (0.0, -0.05, 0.0), 0.053, BLUE),
        rod((0.0, 0.002, 0.04), (0.0, 0.002, 0.35), 0.0365, SILVER),
        tube((0.0, -0.036, 0.39225), (0.0, 0.047, 0.39225), 0.038, SILVER),
        tube((0.0, -0.05, 0.39225), (0.0, -0.036, 0.39225), 0.035, BLUE),
    ],
    "wrist_1_link": [
        tube((0.0, 0.047, 0.0), (0.0, 0.053, 0.0), 0.0375, DARK),
        rod((0.0, 0.093, 0.0), (0.0, 0.09, 0.0), 0.0385, SILVER),
        tube((0.0, 0.053, 0.0), (0.0, 0.09, 0.0), 0.038, SILVER),
        tube((0.0, 0.093, -0.043), (0.0, 0.093, 0.047), 0.038, SILVER),
        tube((0.0, 0.093, -0.057), (0.0, 0.093, -0.043), 0.035, BLUE),
    ],
    "wrist_2_link": [
        tube((0.0, 0.0, 0.047), (0.0, 0.0, 0.053), 0.0375, DARK),
        tube((0.0, 0.0, 0.053), (0.0, 0.0, 0.0946), 0.038, SILVER),
        tube((0.0, -0.043, 0.0946), (0.0, 0.047, 0.0946), 0.038, SILVER),
        tube((0.0, -0.057, 0.0946), (0.0, -0.043, 0.0946), 0.035, BLUE),
        rod((0.0, 0.0, 0.09), (0.0, 0.0, 0.0946), 0.0385, SILVER),
    ],
    "wrist_3_link": [
        tube((0.0, 0.047, 0.0), (0.0, 0.0715, 0.0), 0.037, GREY),
        tube((0.0, 0.0715, 0.0), (0.0, 0.0823, 0.0), 0.031, SILVER),
    ],
    "ee_link": [],
    "base": [],
    "tool0": [],
}
"""The shapes of each link, in link coordinates [m]; the links in order."""


def ur5(
    *, visuals: Mapping[str, tuple[Geometry, ...]] | None = None, root: str | JointKind | None = None
) -> Model:
    """The UR5 without a gripper; its tool frame is "tool0".

    Args:
        visuals: geometries to draw instead of the simple shapes, by link name.
        root: how the base hangs in the world: None fixed, "free_flyer", or a joint kind.

    Returns:
        The model.
    """
    builder = ModelBuilder("ur5")
    add_root_and_links(builder, root, _BODIES, _inertia, visuals)
    fixed = Fixed()
    builder.add_joint("world_joint", fixed, "world", "base_link", pose())
    parent = "base_link"
    for joint, (child, xyz, turn, axis, reach, velocity, effort) in _JOINTS.items():
        builder.add_joint(
            joint,
            Revolute(_AXES[axis]),
            parent,
            child,
            pose(xyz, (0.0, turn, 0.0)),
            lower=-reach,
            upper=reach,
            velocity=velocity,
            effort=effort,
        )
        builder.disable_pair(parent, child)
        parent = child
    # The controller's base frame looks the other way than the arm's first link.
    builder.add_joint("base_link-base_fixed_joint", fixed, "base_link", "base", pose(rpy=(0.0, 0.0, math.pi)))
    builder.add_joint(
        "ee_fixed_joint", fixed, parent, "ee_link", pose((0.0, 0.0823, 0.0), (0.0, 0.0, _RIGHT))
    )
    builder.add_joint(
        "wrist_3_link-tool0_fixed_joint",
        fixed,
        parent,
        "tool0",
        pose((0.0, 0.0823, 0.0), (-_RIGHT, 0.0, 0.0)),
    )
    builder.set_tool("tool0")
    for name, q in CONFIGURATIONS.items():
        builder.add_configuration(name, dict(zip(_JOINTS, q, strict=True)))
    return builder.build()


def _inertia(link: str) -> Inertia | None:
    if link not in _INERTIAS:
        return None
    mass, height, across, along = _INERTIAS[link]
    return Inertia.from_com(mass, (0.0, 0.0, height), np.diag([across, across, along]))
