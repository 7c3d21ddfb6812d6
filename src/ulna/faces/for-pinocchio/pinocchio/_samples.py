"""A small model to try things on."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio import _joints
from pinocchio._inertia import Inertia
from pinocchio._model import Model
from pinocchio._se3 import SE3

__all__ = ["buildSampleModelManipulator"]

_LIGHT = (0.1, 0.0, 0.01)
_HEAVY = (1.0, 0.5, 1.0)
"""Mass [kg], height of the centre of mass [m], moments of inertia [kg m^2]."""
_ARM: tuple[tuple[str, Any, float, tuple[float, float, float], str], ...] = (
    ("shoulder1", _joints.JointModelRX, 0.0, _LIGHT, ""),
    ("shoulder2", _joints.JointModelRY, 0.0, _LIGHT, ""),
    ("shoulder3", _joints.JointModelRZ, 0.0, _HEAVY, "upperarm_body"),
    ("elbow", _joints.JointModelRY, 1.0, _HEAVY, "lowerarm_body"),
    ("wrist1", _joints.JointModelRX, 1.0, _LIGHT, ""),
    ("wrist2", _joints.JointModelRY, 0.0, _HEAVY, "effector_body"),
)


def buildSampleModelManipulator(mimic: bool = False) -> Model:
    """A manipulator of six joints; with `mimic`, the last one follows the one before it."""
    model = Model()
    parent = 0
    for name, kind, height, (mass, centre, moment), body in _ARM:
        place = SE3(np.eye(3), [0.0, 0.0, height])
        parent = model.addJoint(parent, kind(), place, f"{name}_joint", 10.0, 10.0, -3.14, 3.14)
        model.appendBodyToJoint(parent, Inertia(mass, [0.0, 0.0, centre], moment * np.eye(3)))
        model.addJointFrame(parent)
        model.addBodyFrame(f"{name}_body", parent, SE3())
        if body:
            model.addBodyFrame(body, parent, SE3())
    if mimic:
        model.make_mimic(parent - 1, parent, 1.0, 0.0)
    return model
