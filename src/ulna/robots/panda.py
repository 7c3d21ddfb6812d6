"""The Franka Emika Panda: kinematics from its maker's data sheet, inertias as identified by Gaz et al.

Kinematics and limits: Franka Control Interface documentation, "Robot and interface specifications". Inertias:
Gaz, Cognetti, Oliva, Robuffo Giordano and De Luca, Dynamic Identification of the Franka Emika Panda Robot
With Retrieval of Feasible Parameters Using Penalty-Based Optimization, IEEE Robotics and Automation Letters 4
(2019).
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from ulna.formats.poses import pose
from ulna.geometry import Geometry
from ulna.model import Fixed, JointKind, Model, ModelBuilder, Prismatic, Revolute
from ulna.robots.shapes import DARK, GREY, SILVER, WHITE, add_root_and_links, block, rod, tube
from ulna.spatial import Inertia

_RIGHT = math.pi / 2.0

# joint: translation [m] and turn about x [rad] from the link before; lower, upper [rad]; [rad/s]; [N m]
_JOINTS = (
    ((0.0, 0.0, 0.333), 0.0, -2.8973, 2.8973, 2.175, 87.0),
    ((0.0, 0.0, 0.0), -_RIGHT, -1.7628, 1.7628, 2.175, 87.0),
    ((0.0, -0.316, 0.0), _RIGHT, -2.8973, 2.8973, 2.175, 87.0),
    ((0.0825, 0.0, 0.0), _RIGHT, -3.0718, -0.0698, 2.175, 87.0),
    ((-0.0825, 0.384, 0.0), -_RIGHT, -2.8973, 2.8973, 2.61, 12.0),
    ((0.0, 0.0, 0.0), _RIGHT, -0.0175, 3.7525, 2.61, 12.0),
    ((0.088, 0.0, 0.0), _RIGHT, -2.8973, 2.8973, 2.61, 12.0),
)

# link: mass [kg]; centre of mass [m]; xx, xy, xz, yy, yz, zz about it [kg m^2], in link axes
_INERTIAS = {
    "panda_link0": (
        0.629769,
        (-0.041018, -0.00014, 0.049974),
        (0.00315, 8.2904e-07, 0.00015, 0.00388, 8.2299e-06, 0.004285),
    ),
    "panda_link1": (
        4.970684,
        (0.003875, 0.002081, -0.04762),
        (0.70337, -0.000139, 0.006772, 0.70661, 0.019169, 0.009117),
    ),
    "panda_link2": (
        0.646926,
        (-0.003141, -0.02872, 0.003495),
        (0.007962, -0.003925, 0.010254, 0.02811, 0.000704, 0.025995),
    ),
    "panda_link3": (
        3.228604,
        (0.027518, 0.039252, -0.066502),
        (0.037242, -0.004761, -0.011396, 0.036155, -0.012805, 0.01083),
    ),
    "panda_link4": (
        3.587895,
        (-0.05317, 0.104419, 0.027454),
        (0.025853, 0.007796, -0.001332, 0.019552, 0.008641, 0.028323),
    ),
    "panda_link5": (
        1.225946,
        (-0.011953, 0.041065, -0.038437),
        (0.035549, -0.002117, -0.004037, 0.029474, 0.000229, 0.008627),
    ),
    "panda_link6": (
        1.666555,
        (0.060149, -0.014117, -0.010517),
        (0.001964, 0.000109, -0.001158, 0.004354, 0.000341, 0.005433),
    ),
    "panda_link7": (
        0.735522,
        (0.010517, -0.004252, 0.061597),
        (0.012516, -0.000428, -0.001196, 0.010027, -0.000741, 0.004815),
    ),
    "panda_hand": (0.73, (-0.01, 0.0, 0.03), (0.001, 0.0, 0.0, 0.0025, 0.0, 0.0017)),
    "panda_leftfinger": (0.015, (0.0, 0.0, 0.0), (2.375e-06, 0.0, 0.0, 2.375e-06, 0.0, 7.5e-07)),
    "panda_rightfinger": (0.015, (0.0, 0.0, 0.0), (2.375e-06, 0.0, 0.0, 2.375e-06, 0.0, 7.5e-07)),
}

# pairs of links that touch by construction, or whose rounded shapes touch where the real ones do not
_TOUCHING = (
    *((f"panda_link{i}", f"panda_link{i + 1}") for i in range(7)),
    ("panda_link5", "panda_link7"),
    ("panda_link5", "panda_hand"),
    ("panda_link6", "panda_hand"),
    ("panda_link7", "panda_hand"),
    ("panda_hand", "panda_leftfinger"),
    ("panda_hand", "panda_rightfinger"),
    ("panda_leftfinger", "panda_rightfinger"),
)

FINGER_OPENING = 0.035
"""How far each finger of the model with rigid fingers stands from the middle [m]."""

CONFIGURATIONS = {
    "qr": (0.0, -0.3, 0.0, -2.2, 0.0, 2.0, math.pi / 4),
    "qz": (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    "ready": (0.0, -math.pi / 4, 0.0, -3 * math.pi / 4, 0.0, math.pi / 2, math.pi / 4),
}
"""Joint angles [rad] of the arm: a bent pose, zero, and the pose its maker starts from."""

_TIP = block((0.0, 0.0076, 0.045), (0.0175, 0.0152, 0.0175), DARK)
_TIP_RIGHT = block((0.0, -0.0076, 0.045), (0.0175, 0.0152, 0.0175), DARK)
_BODIES: dict[str, list[Geometry]] = {
    "panda_link0": [
        tube((0.0, 0.0, 0.0), (0.0, 0.0, 0.141), 0.0675, WHITE),
        block((-0.055, 0.0, 0.009), (0.18, 0.186, 0.018), WHITE),
        block((-0.07, 0.0, 0.05), (0.12, 0.105, 0.1), WHITE),
        block((-0.127, 0.0, 0.052), (0.012, 0.085, 0.06), GREY),
    ],
    "panda_link1": [
        tube((0.0, 0.0, -0.192), (0.0, 0.0, -0.03), 0.0545, WHITE),
        rod((0.0, -0.073, 0.0), (0.0, 0.0, 0.0), 0.055, WHITE),
    ],
    "panda_link2": [
        rod((0.0, 0.0, 0.0), (0.0, 0.0, 0.073), 0.055, WHITE),
        tube((0.0, -0.194, 0.0), (0.0, -0.03, 0.0), 0.0545, WHITE),
    ],
    "panda_link3": [
        tube((0.0, 0.0, -0.121), (0.0, 0.0, -0.06), 0.0545, WHITE),
        rod((0.0, 0.0, -0.06), (0.0825, 0.028, 0.0), 0.0545, WHITE),
        rod((0.0825, 0.0, 0.0), (0.0825, 0.056, 0.0), 0.055, WHITE),
        tube((0.0825, -0.058, 0.0), (0.0825, 0.0, 0.0), 0.048, GREY),
    ],
    "panda_link4": [
        rod((0.0, 0.0, 0.0), (0.0, 0.0, 0.056), 0.055, WHITE),
        tube((0.0, 0.0, 0.056), (0.0, 0.0, 0.113), 0.046, GREY),
        rod((0.0, 0.0, 0.028), (-0.0825, 0.06, 0.0), 0.0545, WHITE),
        tube((-0.0825, 0.06, 0.0), (-0.0825, 0.124, 0.0), 0.0545, WHITE),
    ],
    "panda_link5": [
        tube((0.0, 0.0, -0.26), (0.0, 0.0, -0.19), 0.0545, WHITE),
        rod((0.0, 0.0, -0.19), (0.0, 0.058, -0.1), 0.052, WHITE),
        rod((0.0, 0.058, -0.1), (0.0, 0.078, -0.004), 0.047, WHITE),
        tube((0.0, 0.0, 0.0), (0.0, 0.078, 0.0), 0.049, WHITE),
    ],
    "panda_link6": [
        rod((0.0, 0.0, -0.004), (0.0, 0.0, 0.012), 0.047, WHITE),
        tube((0.0, 0.0, 0.0), (0.0, 0.0, 0.058), 0.041, GREY),
        rod((0.0, 0.0, 0.0), (0.088, 0.012, 0.0), 0.044, WHITE),
        tube((0.088, -0.05, 0.0), (0.088, 0.06, 0.0), 0.0455, WHITE),
        tube((0.088, -0.054, 0.0), (0.088, -0.05, 0.0), 0.03, GREY),
    ],
    "panda_link7": [
        tube((0.0, 0.0, 0.06), (0.0, 0.0, 0.107), 0.044, WHITE),
        block((0.035, 0.035, 0.082), (0.066, 0.052, 0.036), WHITE, (0.0, 0.0, math.pi / 4)),
        block((0.045, 0.045, 0.1005), (0.03, 0.018, 0.003), GREY, (0.0, 0.0, math.pi / 4)),
    ],
    "panda_link8": [],
    "panda_hand": [
        tube((0.0, 0.0, 0.0), (0.0, 0.0, 0.012), 0.0315, SILVER),
        block((0.0, 0.0, 0.034), (0.058, 0.204, 0.058), WHITE),
        block((0.0, 0.0, 0.0635), (0.022, 0.17, 0.005), DARK),
        block((0.0, 0.0, 0.036), (0.06, 0.12, 0.012), GREY),
    ],
    "panda_hand_tcp": [],
    "panda_leftfinger": [
        block((0.0, 0.0165, 0.012), (0.021, 0.019, 0.024), SILVER),
        block((0.0, 0.0126, 0.0305), (0.0175, 0.0075, 0.022), SILVER, (0.5235987755982988, 0.0, 0.0)),
        _TIP,
    ],
    "panda_rightfinger": [
        block((0.0, -0.0165, 0.012), (0.021, 0.019, 0.024), SILVER),
        block((0.0, -0.0126, 0.0305), (0.0175, 0.0075, 0.022), SILVER, (-0.5235987755982988, 0.0, 0.0)),
        _TIP_RIGHT,
    ],
}
"""The shapes of each link, in link coordinates [m]; the links in order."""


def panda(
    *,
    fingers: bool = False,
    visuals: Mapping[str, tuple[Geometry, ...]] | None = None,
    root: str | JointKind | None = None,
    mimic: bool = True,
) -> Model:
    """The Panda with its hand.

    Args:
        fingers: whether the fingers move (two sliding joints, the second follows the first); else they are rigid,
            each `FINGER_OPENING` from the middle.
        visuals: geometries to draw instead of the simple shapes, by link name.
        root: how the base hangs in the world: None fixed, "free_flyer", or a joint kind.
        mimic: whether the second finger follows the first; else each moves on its own.

    Returns:
        The model.
    """
    builder = ModelBuilder("panda_fingers" if fingers else "panda")
    add_root_and_links(builder, root, _BODIES, _inertia, visuals)
    for i, (xyz, turn, lower, upper, velocity, effort) in enumerate(_JOINTS, 1):
        builder.add_joint(
            f"panda_joint{i}",
            Revolute((0.0, 0.0, 1.0)),
            f"panda_link{i - 1}",
            f"panda_link{i}",
            pose(xyz, (turn, 0.0, 0.0)),
            lower=lower,
            upper=upper,
            velocity=velocity,
            effort=effort,
            damping=0.003,
        )
    fixed = Fixed()
    hand_turn = (0.0, 0.0, -math.pi / 4)
    builder.add_joint("panda_joint8", fixed, "panda_link7", "panda_link8", pose((0.0, 0.0, 0.107)))
    builder.add_joint("panda_hand_joint", fixed, "panda_link8", "panda_hand", pose(rpy=hand_turn))
    builder.add_joint("panda_hand_tcp_joint", fixed, "panda_hand", "panda_hand_tcp", pose((0.0, 0.0, 0.1034)))
    _add_fingers(builder, fingers, mimic)
    for pair in _TOUCHING:
        builder.disable_pair(*pair)
    builder.set_tool("panda_hand_tcp")
    for name, q in CONFIGURATIONS.items():
        values = {f"panda_joint{i}": angle for i, angle in enumerate(q, 1)}
        moving = () if not fingers else (1,) if mimic else (1, 2)
        opening = {f"panda_finger_joint{i}": FINGER_OPENING for i in moving}
        builder.add_configuration(name, values | opening)
    return builder.build()


def _add_fingers(builder: ModelBuilder, moving: bool, mimic: bool) -> None:
    for i, (side, sign) in enumerate((("left", 1.0), ("right", -1.0)), 1):
        joint, link = f"panda_finger_joint{i}", f"panda_{side}finger"
        if not moving:
            builder.add_joint(joint, Fixed(), "panda_hand", link, pose((0.0, sign * FINGER_OPENING, 0.0584)))
            continue
        builder.add_joint(
            joint,
            Prismatic((0.0, sign, 0.0)),
            "panda_hand",
            link,
            pose((0.0, 0.0, 0.0584)),
            lower=0.0,
            upper=0.04,
            velocity=0.2,
            effort=100.0,
            damping=0.3,
            mimic=("panda_finger_joint1", 1.0, 0.0) if mimic and i == 2 else None,
        )


def _inertia(link: str) -> Inertia | None:
    if link not in _INERTIAS:
        return None
    mass, com, entries = _INERTIAS[link]
    return Inertia.from_com(mass, com, entries)
