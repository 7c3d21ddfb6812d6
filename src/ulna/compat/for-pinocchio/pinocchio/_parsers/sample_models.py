"""Small models to try things on: an arm, a humanoid of four such limbs, a humanoid with random numbers."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from pinocchio._model import joint_kinds
from pinocchio._model.joint_compositions import JointModelComposite
from pinocchio._model.joint_model import JointModel
from pinocchio._model.model import Model
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.random_numbers import generator
from pinocchio._spatial.se3 import SE3
from pinocchio.rpy import rotate

_LIGHT = (0.1, 0.0, 0.01)
_HEAVY = (1.0, 0.5, 1.0)
"""Mass [kg], height of the centre of mass [m], moments of inertia [kg m^2]."""
_ARM: tuple[tuple[str, Any, float, tuple[float, float, float], str], ...] = (
    ("shoulder1", joint_kinds.JointModelRX, 0.0, _LIGHT, ""),
    ("shoulder2", joint_kinds.JointModelRY, 0.0, _LIGHT, ""),
    ("shoulder3", joint_kinds.JointModelRZ, 0.0, _HEAVY, "upperarm"),
    ("elbow", joint_kinds.JointModelRY, 1.0, _HEAVY, "lowerarm"),
    ("wrist1", joint_kinds.JointModelRX, 1.0, _LIGHT, ""),
    ("wrist2", joint_kinds.JointModelRY, 0.0, _HEAVY, "effector"),
)
_LIMITS = (10.0, 10.0, -3.14, 3.14)
"""Effort [N m], velocity [rad/s], least and greatest angle [rad]."""


def buildSampleModelManipulator(mimic: bool = False) -> Model:
    """A manipulator of six joints; with `mimic`, the last one follows the one before it."""
    model = Model()
    _limb(model, 0, SE3(), "", mimic)
    return model


def buildSampleModelHumanoid(using_free_flyer: bool = True) -> Model:
    """A humanoid of 28 joints, its limbs being sample manipulators.

    Args:
        using_free_flyer: Whether its base has a free flyer; else a translation and three angles, which have a
            singularity, but as many entries of q as of v.
    """
    model = Model()
    root = _root(model, using_free_flyer)
    _put(model, root, _LIGHT)
    down = rotate("x", np.pi).round()
    for side, y in (("r", -0.2), ("l", 0.2)):
        last = _limb(model, root, SE3(down, [0.0, y, -0.1]), f"{side}leg_")
        model.jointPlacements[last].rotation = rotate("y", np.pi / 2).round()
    chest = root
    for part, height in (("chest", 0.0), ("head", 1.0)):
        first = _segment(model, chest, f"{part}1", joint_kinds.JointModelRX(), height, _LIGHT)
        second = _segment(model, first, f"{part}2", joint_kinds.JointModelRY(), 0.0, _HEAVY)
        chest = second if part == "chest" else chest
    for side, y in (("r", -0.3), ("l", 0.3)):
        _limb(model, chest, SE3(down, [0.0, y, 1.0]), f"{side}arm_")
    return model


def buildSampleModelHumanoidRandom(using_free_flyer: bool = True, mimic: bool = False) -> Model:
    """A humanoid of 27 joints with random placements, inertias and limits, for tests.

    Args:
        using_free_flyer: Whether its base has a free flyer; else a translation and three angles.
        mimic: Whether the last joint of the left arm follows the one before it.

    Returns:
        The model.
    """
    model = _humanoid_of_chains(using_free_flyer, mimic).copy()
    (placements,), (inertias,) = model._parameter_blocks("placements"), model._parameter_blocks("inertias")
    for i in range(1, model.njoints):
        if i > 1:
            placements[i] = SE3.Random()._m
        inertias[i] = Inertia.Random().se3Action(SE3.Random())._p
    rng, arrays = generator(), model._arrays
    for key in ("Effort", "Velocity", "DryFriction"):
        least, most = -2.0 * rng.random(model.nv), 2.0 * rng.random(model.nv)
        arrays[f"lower{key}Limit"][:], arrays[f"upper{key}Limit"][:] = least, most
        if key != "DryFriction":
            arrays[f"lower{key}Limit"][:] = -most
    low, high, margin = 2.0 * rng.random((3, model.nq))
    model.lowerPositionLimit, model.upperPositionLimit, model.positionLimitMargin = -low, high, margin
    if using_free_flyer:
        model.lowerPositionLimit[3:7], model.upperPositionLimit[3:7] = -1.0, 1.0
    return model


@cache
def _humanoid_of_chains(using_free_flyer: bool, mimic: bool) -> Model:
    """The joints and frames of that humanoid, its numbers being those of new joints."""
    model = Model()
    root = _root(model, using_free_flyer)
    _add_body_frame(model, root, "root")
    kinds = (*"XYZ", *"YYX")
    for side in ("lleg", "rleg"):
        _chain(model, root, [f"{side}{k}" for k in range(1, 7)], kinds)
    chest = _chain(model, root, ["torso1", "chest"], "YZ")
    for side in ("rarm", "larm"):
        last = _chain(model, chest, [f"{side}{k}" for k in range(1, 7)], kinds)
    if mimic:
        model._make_mimic(last - 1, last, 1.0, 0.0)
    return model


def _root(model: Model, using_free_flyer: bool) -> int:
    if using_free_flyer:
        joint: JointModel = joint_kinds.JointModelFreeFlyer()
    else:
        joint = JointModelComposite(joint_kinds.JointModelTranslation()).addJoint(
            joint_kinds.JointModelSphericalZYX()
        )
    root = model.addJoint(0, joint, SE3(), "root_joint")
    if using_free_flyer:
        model.lowerPositionLimit[3:7], model.upperPositionLimit[3:7] = -1.0, 1.0
    model.addJointFrame(root, -1)
    return root


def _limb(model: Model, parent: int, placement: SE3, prefix: str, mimic: bool = False) -> int:
    for k, (name, kind, height, body, extra) in enumerate(_ARM):
        place = SE3(np.eye(3), [0.0, 0.0, height]) if k else placement
        named = "wrist1_mimic" if mimic and name == "wrist2" else name
        parent = _segment(model, parent, prefix + named, kind(), place, body)
        if extra:
            model.addBodyFrame(f"{prefix}{extra}_body", parent, SE3(), -1)
    if mimic:
        model._make_mimic(parent - 1, parent, 1.0, 0.0)
    return parent


def _segment(
    model: Model, parent: int, name: str, kind: JointModel, place: Any, body: tuple[float, ...]
) -> int:
    placement = place if isinstance(place, SE3) else SE3(np.eye(3), [0.0, 0.0, place])
    joint = model.addJoint(parent, kind, placement, f"{name}_joint", *_LIMITS)
    _put(model, joint, body)
    model.addJointFrame(joint, -1)
    model.addBodyFrame(f"{name}_body", joint, SE3(), -1)
    return joint


def _put(model: Model, joint: int, body: tuple[float, ...]) -> None:
    mass, centre, moment = body
    model.appendBodyToJoint(joint, Inertia(mass, [0.0, 0.0, centre], moment * np.eye(3)), SE3())


def _chain(model: Model, parent: int, names: list[str], axes: Any) -> int:
    for name, letter in zip(names, axes, strict=True):
        kind = getattr(joint_kinds, f"JointModelR{letter}")()
        parent = model.addJoint(parent, kind, SE3(), f"{name}_joint")
        model.addJointFrame(parent, -1)
        _add_body_frame(model, parent, name)
    return parent


def _add_body_frame(model: Model, joint: int, name: str) -> None:
    model.addBodyFrame(f"{name}_body", joint, SE3(), -1)
    model._keep(nbodies=model.nbodies + 1)
