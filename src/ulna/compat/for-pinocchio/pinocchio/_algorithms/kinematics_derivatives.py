"""Derivatives of velocities and accelerations of joints, frames, points and the centre of mass."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._algorithms.frame_arguments import (
    Place,
    at_frame_or_joint,
    at_placement,
    place_of,
    repeated_call,
    repeated_call_at_placement,
)
from pinocchio._algorithms.jacobians import computeJointJacobiansTimeVariation
from pinocchio._algorithms.kinematics import forwardKinematics
from pinocchio._algorithms.stored_motions import (
    bound_to_fields,
    carrier_of,
    has_constant_subspaces,
    motion_derivatives,
    placement_of,
    point_derivatives,
)
from pinocchio._algorithms.stored_sums import CENTER_RATE_COLUMNS
from pinocchio._containers.arguments import checked
from pinocchio._containers.arrays import index
from pinocchio._containers.enums import ReferenceFrame, reference_of
from pinocchio._data.algorithm import STATES
from pinocchio._data.data import Data
from pinocchio._data.evaluated_model import NUMBER_CALLS, kernels_for
from pinocchio._data.first_evaluation import TABLE_CALLS, loaded_evaluator
from pinocchio._data.states import compiled_for
from pinocchio._model.model import Model
from pinocchio._tables.world_derivatives import WorldDerivatives
from ulna import algorithms
from ulna.algorithms.multibody.references import Reference
from ulna.compiler.runtime.repeated_calls import call_cache, repeated_calls
from ulna.model import Frame
from ulna.model import Model as CoreModel
from ulna.typing import Array, Floats

__all__ = [
    "computeForwardKinematicsDerivatives",
    "getCenterOfMassVelocityDerivatives",
    "getFrameAccelerationDerivatives",
    "getFrameVelocityDerivatives",
    "getJointAccelerationDerivatives",
    "getJointVelocityDerivatives",
    "getPointClassicAccelerationDerivatives",
    "getPointVelocityDerivatives",
]


def computeForwardKinematicsDerivatives(model: Model, data: Data, q: Any, v: Any, a: Any = None) -> None:
    """Prepares the derivatives of velocities and accelerations of joints and frames.

    Args:
        a: Acceleration (nv,) [rad/s^2 or m/s^2]; zero by default.
    """
    a = np.zeros(model.nv) if a is None else a
    forwardKinematics(model, data, q, v, a)
    computeJointJacobiansTimeVariation(model, data, q, v)


@repeated_call("joint velocity derivatives", has_default=False)
def getJointVelocityDerivatives(
    model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame
) -> tuple[Floats, Floats]:
    """Derivatives of a joint's velocity by q and v, (6, nv) each.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.

    Returns:
        Two matrices (6, nv).
    """
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    binding_key = joint_id, reference_frame, "joint velocity derivatives"
    return _motions(model, data, Place(None, joint), reference_frame, False, binding_key)


@repeated_call("velocity derivatives", has_default=False)
@at_frame_or_joint
def getFrameVelocityDerivatives(
    model: Model,
    data: Data,
    frame_id: int | None = None,
    placement: Any = None,
    reference_frame: Any = None,
    joint_id: int | None = None,
) -> tuple[Floats, Floats]:
    """Derivatives of a frame's velocity (its index, or a joint's and a placement) by q and v, (6, nv) each.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.
        placement: Pose of the frame in the frame of the joint `joint_id`, an SE3.

    Returns:
        Two matrices (6, nv).
    """
    place = place_of(model, frame_id, joint_id, placement)
    binding_key = _binding_key(place, frame_id, reference_frame, "velocity derivatives")
    return _motions(model, data, place, reference_frame, False, binding_key)


@repeated_call("joint acceleration derivatives", has_default=False)
def getJointAccelerationDerivatives(
    model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame
) -> tuple[Floats, ...]:
    """Derivatives of a joint's velocity by q, and of its acceleration by q, v and a, (6, nv) each.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.

    Returns:
        Four matrices (6, nv).
    """
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    binding_key = joint_id, reference_frame, "joint acceleration derivatives"
    return _motions(model, data, Place(None, joint), reference_frame, True, binding_key)


@repeated_call("acceleration derivatives", has_default=False)
@at_frame_or_joint
def getFrameAccelerationDerivatives(
    model: Model,
    data: Data,
    frame_id: int | None = None,
    placement: Any = None,
    reference_frame: Any = None,
    joint_id: int | None = None,
) -> tuple[Floats, ...]:
    """Derivatives of a frame's velocity by q, and of its acceleration by q, v and a, (6, nv) each.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.
        placement: Pose of the frame in the frame of the joint `joint_id`, an SE3.

    Returns:
        Four matrices (6, nv).
    """
    place = place_of(model, frame_id, joint_id, placement)
    binding_key = _binding_key(place, frame_id, reference_frame, "acceleration derivatives")
    return _motions(model, data, place, reference_frame, True, binding_key)


def _binding_key(place: Place, frame_id: Any, reference_frame: Any, kind: str) -> tuple[Any, ...]:
    """What decides the bound call for a frame, or for a placement, which is an input, on a joint."""
    if place.placement is None:
        return frame_id, reference_frame, kind
    return place.joint, reference_frame, f"placed {kind}"


def _motions(
    model: Model, data: Data, place: Place, rf: Any, with_a: bool, binding_key: tuple[Any, ...]
) -> Any:
    """The derivatives of a frame's motion; bound at `binding_key` for the next time."""
    reference, of_model = reference_of(rf), place.frame_id is not None
    state = data._require(data._qva, "computeForwardKinematicsDerivatives(model, data, q, v, a)")
    compiled_for(model, data)
    if _fields_are_of_one_state(model, data):
        return _stored_motions(model, data, place, reference, with_a, binding_key)

    def build(core: CoreModel, frames: Sequence[Frame]) -> Any:
        def run(*inputs: Array) -> tuple[Array, ...]:
            frame, (q, v, a) = place.split(frames, inputs)
            V_q, V_v, *of_a = algorithms.motion_derivatives(core, q, v, a, frame, reference)
            results = (V_q, *of_a) if with_a else (V_q, V_v)
            return *results, algorithms.frame_poses(core, q, (frame,))[0].matrix()

        return run

    kernels = kernels_for(model, data, "motion derivatives")
    name = "acceleration derivatives" if with_a else "velocity derivatives"
    kernel = kernels.compile_at_frames((name, place.key, reference), build, **place.shapes, **_sizes(model))
    *results, T = kernel(*place.inputs, *state)
    if of_model:
        data._arrays["oMf"][place.frame_id] = T
    return tuple(results)


def _stored_motions(
    model: Model, data: Data, place: Place, reference: Reference, with_a: bool, binding_key: tuple[Any, ...]
) -> Any:
    """The derivatives of a frame's motion out of what the Data holds; bound at `binding_key` for the next time."""
    joint, placement = place.on_joint(model)
    carrier = carrier_of(model, joint, placement is not None, reference)
    fields = ("ov", "oa", "v") if with_a else ("ov",)
    for field in fields:
        data._read(field)
    arrays = data._arrays
    read = [*placement_of(placement), arrays["oMi"][joint], arrays["J"], arrays["ov"]]
    read += [arrays["dJ"], arrays["oa"], arrays["v"][joint]] if with_a else []
    function, of_model = motion_derivatives(carrier, with_a), place.frame_id is not None
    placed = arrays["oMf"][place.frame_id] if of_model else np.empty((4, 4))
    if model.first_calls.includes("motion derivatives", TABLE_CALLS):
        *results, placed[...] = function(*read)
        return tuple(results)
    watch = model._watched_frames() if of_model else model._watched("structure")
    step = bound_to_fields(
        model,
        data,
        ("motion derivatives of fields", carrier, with_a),
        function,
        read,
        fields,
        watch=[*watch, *_equal_states(data)],
        last_target=placed,
        passes_placement=place.placement is not None,
    )
    if data._model is model:
        data._bound_at[binding_key] = step, binding_key[1]
    return step(*place.holders)


def _fields_are_of_one_state(model: Model, data: Data) -> bool:
    """Whether Jacobians and motions in a Data are of one state, and each column is that of one joint."""
    known = {"placements", "velocities", "jacobians", "jacobian_rates"} <= data._known_states
    same = known and all(np.array_equal(x, y) for x, y in _equal_states(data))
    return same and model.nvExtended == model.nv and has_constant_subspaces(model)


def _equal_states(data: Data) -> list[tuple[Floats, Floats]]:
    """Pairs of arrays (...) that are equal while Jacobians and motions in a Data are of one state."""
    data._read("v")
    names = ("placements", "velocities", "jacobians", "jacobian_rates")
    keys = [(f"{name} {x}", f"accelerations {x}") for name in names for x in STATES[name]]
    return [(data._arrays[one], data._arrays[other]) for one, other in keys]


def _sizes(model: Model) -> dict[str, Any]:
    """The shapes of a state and its acceleration."""
    return {"q": (model.nq,), "v": (model.nv,), "a": (model.nv,)}


@repeated_call_at_placement("point velocity derivatives")
def getPointVelocityDerivatives(
    model: Model, data: Data, joint_id: int, placement: Any, reference_frame: ReferenceFrame
) -> tuple[Floats, Floats]:
    """Derivatives of the velocity of a point on a joint by q and v, (3, nv) each, in LOCAL or LOCAL_WORLD_ALIGNED.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.
        placement: Pose in the frame of the joint, an SE3; its origin is the point.
        reference_frame: LOCAL or LOCAL_WORLD_ALIGNED.

    Returns:
        Two matrices (3, nv).
    """
    return _point(model, data, joint_id, placement, reference_frame, False)


@repeated_call_at_placement("point acceleration derivatives")
def getPointClassicAccelerationDerivatives(
    model: Model, data: Data, joint_id: int, placement: Any, reference_frame: ReferenceFrame
) -> tuple[Floats, Floats, Floats, Floats]:
    """Derivatives of that velocity by q, and of the point's acceleration by q, v and a, (3, nv) each.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.
        placement: Pose in the frame of the joint, an SE3; its origin is the point.
        reference_frame: LOCAL or LOCAL_WORLD_ALIGNED.

    Returns:
        Four matrices (3, nv).
    """
    return _point(model, data, joint_id, placement, reference_frame, True)


def _point(model: Model, data: Data, joint_id: int, placement: Any, rf: Any, with_a: bool) -> Any:
    place = Place(None, *at_placement(model, joint_id, placement))
    state = data._require(data._qva, "computeForwardKinematicsDerivatives(model, data, q, v, a)")
    reference: Any = reference_of(rf)
    compiled_for(model, data)
    if reference_of(rf) != "world" and _fields_are_of_one_state(model, data):
        return _stored_point(model, data, place, rf, with_a)

    def build(core: CoreModel, frames: Sequence[Frame]) -> Any:
        def run(*inputs: Array) -> Any:
            frame, (q, v, a) = place.split(frames, inputs)
            return algorithms.point_derivatives(core, q, v, a, frame, reference)

        return run

    kernels, shapes = kernels_for(model, data, "point derivatives"), place.shapes | _sizes(model)
    kernel = kernels.compile_at_frames(("point", place.key, reference), build, **shapes)
    u_q, u_v, *rest = kernel(*place.inputs, *state)
    return (u_q, *rest) if with_a else (u_q, u_v)


def _stored_point(model: Model, data: Data, place: Place, rf: Any, with_a: bool) -> Any:
    """Derivatives of how a point moves, out of what the Data holds; bound for the next time."""
    joint, placement = place.on_joint(model)
    carrier = carrier_of(model, joint, True, reference_of(rf))
    fields = ("ov", "oa") if with_a else ("ov",)
    for field in fields:
        data._read(field)
    arrays, function = data._arrays, point_derivatives(carrier, with_a)
    names = ("J", "ov", "dJ", "oa") if with_a else ("J", "ov")
    read = [*placement_of(placement), arrays["oMi"][joint], *(arrays[name] for name in names)]
    if model.first_calls.includes("point derivatives", NUMBER_CALLS):
        return function(*read)
    step = bound_to_fields(
        model,
        data,
        ("point derivatives of fields", carrier, with_a),
        function,
        read,
        fields,
        watch=[*model._watched("structure"), *_equal_states(data)],
        passes_placement=True,
    )
    if data._model is model:
        kind = "point acceleration derivatives" if with_a else "point velocity derivatives"
        data._bound_at[place.joint, rf, kind] = step, rf
    return step(*place.holders)


_center_calls = call_cache(2, weak=2)


@repeated_calls(_center_calls)
@checked
def getCenterOfMassVelocityDerivatives(model: Model, data: Data) -> Floats:
    """The derivative (3, nv) of the velocity of the centre of mass by q.

    Args:
        data: Its data, after computeForwardKinematicsDerivatives.

    Returns:
        Matrix (3, nv).
    """
    q, v = data._require(data._qv, "computeForwardKinematicsDerivatives(model, data, q, v)")
    if model.nvExtended == model.nv:
        J = CENTER_RATE_COLUMNS.run(model, data, _center_calls)
        if J is not NotImplemented:
            return J
    if evaluator := loaded_evaluator(model, data, "com derivatives"):
        derivatives = WorldDerivatives(evaluator, q, v)
        return evaluator.by_entries(derivatives.momenta_by_configuration())[:3] / derivatives.mass
    return data._attach(model).kernel("com_velocity_derivatives")(q, v)[0]
