"""What the sample models collide with: spheres at their joints, capsules along their bodies."""

from __future__ import annotations

import numpy as np

from pinocchio._containers.enums import FrameType
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._geometry.geometry_object import GeometryObject
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3
from ulna.geometry import Capsule, Shape, Sphere

_BALL, _BONE, _TIP = Sphere(0.05), Capsule(0.05, 0.8), Capsule(0.05, 0.2)
_LIMB: tuple[tuple[str, str, Shape, float], ...] = (
    ("shoulder", "shoulder1", _BALL, 0.0),
    ("elbow", "elbow", _BALL, 0.0),
    ("wrist", "wrist1", _BALL, 0.0),
    ("upperarm", "upperarm", _BONE, 0.5),
    ("lowerarm", "lowerarm", _BONE, 0.5),
    ("effector", "effector", _TIP, 0.1),
)
"""Name, body, shape, and height in the body's frame [m]."""
_TRUNK: tuple[tuple[str, str, Shape, float], ...] = (
    ("chest", "chest1", _BALL, 0.0),
    ("head", "head2", Sphere(0.25), 0.5),
    ("chest2", "chest2", _BONE, 0.5),
)
_COLOUR = (1.0, 1.0, 0.78, 1.0)


def buildSampleGeometryModelManipulator(model: Model) -> GeometryModel:
    """The geometries of the sample manipulator."""
    out = GeometryModel()
    _add(out, model, "", _LIMB)
    return out


def buildSampleGeometryModelHumanoid(model: Model) -> GeometryModel:
    """The geometries of the sample humanoid."""
    out = GeometryModel()
    for limb in ("rleg_", "lleg_", "rarm_", "larm_"):
        _add(out, model, limb, _LIMB)
    _add(out, model, "", _TRUNK)
    return out


def _add(
    out: GeometryModel, model: Model, prefix: str, parts: tuple[tuple[str, str, Shape, float], ...]
) -> None:
    for name, body, shape, height in parts:
        frame = model.getFrameId(f"{prefix}{body}_body", FrameType.BODY)
        joint = model.frames[frame].parentJoint
        appearance = {"mesh_path": type(shape).__name__.upper(), "mesh_color": np.array(_COLOUR)}
        place = SE3(np.eye(3), [0.0, 0.0, height])
        out.addGeometryObject(
            GeometryObject(f"{prefix}{name}_object", joint, frame, place, shape, **appearance)
        )
