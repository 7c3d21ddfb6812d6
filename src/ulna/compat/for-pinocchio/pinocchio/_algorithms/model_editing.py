"""Models made of models: with joints locked, with another one appended, with a joint that mimics."""

from __future__ import annotations

from typing import Any

from pinocchio._algorithms.appended_model import appended_model, joined_geometries
from pinocchio._algorithms.reduced_model import Moved, reduced_model
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import index
from pinocchio._containers.keywords import by_name
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3
from ulna.errors import InputError

__all__ = [
    "appendModel",
    "buildReducedModel",
    "findCommonAncestor",
    "transformJointIntoMimic",
]


@by_name(
    "model list_of_joints_to_lock reference_configuration",
    "model geom_model list_of_joints_to_lock reference_configuration",
    "model list_of_geom_models list_of_joints_to_lock reference_configuration",
)
def buildReducedModel(model: Model, *rest: Any) -> Any:
    """The model with some joints locked.

    Args:
        model: The model.
        rest: A geometry model or a list of them, if wanted; the indices of the joints to lock; a configuration (nq,).

    Returns:
        The model, or (model, geometry model), or (model, list of geometry models).
    """
    *geometries, locked, reference = rest
    several = bool(geometries) and isinstance(geometries[0], (list, tuple))
    geometry_models = list(geometries[0]) if several else geometries
    out, moved = reduced_model(model, [index(i, model.njoints, "joint", _NAMES) for i in locked], reference)
    if not geometry_models:
        return out
    reduced = [_moved_geometry(g, moved) for g in geometry_models]
    return (out, reduced) if several else (out, reduced[0])


_NAMES = "model.getJointId(name) returns one."


def _moved_geometry(geometry: Any, moved: Moved) -> Any:
    out = geometry.copy()
    for shape in out.geometryObjects:
        joint = index(shape.parentJoint, len(moved), "joint", "The geometries are those of another robot.")
        carrier, M = moved[joint]
        shape.parentJoint = carrier
        if M is not None:
            shape.placement = M * shape.placement
    return out


@by_name("modelA modelB frame_in_modelA aMb", "modelA modelB geomModelA geomModelB frame_in_modelA aMb")
def appendModel(modelA: Model, modelB: Model, *rest: Any) -> Any:
    """Model B put on a frame of model A.

    Args:
        modelA: The first model; its gravity is kept.
        modelB: The model to append. Its names must not be those of A.
        rest: Two geometry models, if wanted; the index of the frame of A; the placement of B's world in it.

    Returns:
        The model, or (model, geometry model).

    Raises:
        ArgumentError: Arguments are too many, too few, or of other types.
    """
    if len(rest) not in (2, 4) or not isinstance(rest[-1], SE3):
        raise ArgumentError(
            f"appendModel was given {len(rest)} arguments after the models; expected two geometry models or none, the "
            "index of a frame, and a placement SE3."
        )
    *geometries, frame_id, aMb = rest
    if not all(hasattr(g, "geometryObjects") for g in geometries):
        raise ArgumentError(f"appendModel was given {geometries!r}; expected two geometry models.")
    at = index(frame_id, modelA.nframes, "frame", "model.getFrameId(name) returns one.")
    out, made, base = appended_model(modelA, modelB, at, aMb)
    return (out, joined_geometries(made, base, geometries)) if geometries else out


def transformJointIntoMimic(
    input_model: Model, index_mimicked: int, index_mimicking: int, scaling: float, offset: float
) -> Model:
    """The model with one joint following another: q = scaling * q_followed + offset.

    Args:
        input_model: The model, which stays as it is.
        index_mimicked: Index of the joint that is followed.
        index_mimicking: Index of the joint that follows.
        scaling: Factor [-].
        offset: Offset [rad or m].

    Returns:
        The new model.

    Raises:
        InputError: The joint that is followed comes after the other one.
    """
    out = input_model.copy()
    for i in (index_mimicked, index_mimicking):
        index(i, out.njoints, "joint", _NAMES)
    if not index_mimicked < index_mimicking:
        raise InputError(
            f"transformJointIntoMimic: joint {index_mimicking} cannot follow joint {index_mimicked}; expected the one "
            "that is followed to come first."
        )
    out._make_mimic(int(index_mimicked), int(index_mimicking), float(scaling), float(offset))
    return out


def findCommonAncestor(model: Model, joint1_id: int, joint2_id: int) -> tuple[int, int, int]:
    """The last common ancestor of two joints, and where it is in both of their supports.

    Args:
        joint1_id: Index of a joint.
        joint2_id: Index of another joint.

    Returns:
        Index of the joint, and its places in both supports.
    """
    first, second = (model.supports[index(i, model.njoints, "joint", _NAMES)] for i in (joint1_id, joint2_id))
    shared = sum(1 for a, b in zip(first, second, strict=False) if a == b)
    return first[shared - 1], shared - 1, shared - 1
