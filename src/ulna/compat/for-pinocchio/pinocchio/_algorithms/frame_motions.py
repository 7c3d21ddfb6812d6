"""Velocities and accelerations of joints and frames, after forward kinematics."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from pinocchio._algorithms.frame_arguments import (
    LOCAL,
    at_frame,
    at_frame_or_joint_by_default_local,
    at_placement,
    repeated_call,
)
from pinocchio._containers.arrays import index, not_applicable
from pinocchio._containers.enums import reference_of
from pinocchio._data.data import Data
from pinocchio._data.states import compiled_for
from pinocchio._model.bound_kernels import BoundKernel
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from pinocchio._spatial.small_kernels import pose
from ulna import spatial
from ulna.algorithms.multibody.references import Reference
from ulna.compiler import compile as compile_function
from ulna.numeric import cross
from ulna.typing import Array, Floats

__all__ = [
    "getAcceleration",
    "getClassicalAcceleration",
    "getFrameAcceleration",
    "getFrameClassicalAcceleration",
    "getFrameVelocity",
    "getVelocity",
]


@repeated_call("joint velocity")
def getVelocity(model: Model, data: Data, joint_id: int, reference_frame: Any = LOCAL) -> Motion:
    """The velocity of a joint, after forwardKinematics with v.

    Args:
        data: Its data, after forwardKinematics.

    Returns:
        Motion (6,) [m/s, rad/s].
    """
    return _joint_motion(model, data, joint_id, reference_frame, "velocity")


@repeated_call("joint acceleration")
def getAcceleration(model: Model, data: Data, joint_id: int, reference_frame: Any = LOCAL) -> Motion:
    """The spatial acceleration of a joint, after forwardKinematics with v and a.

    Args:
        data: Its data, after forwardKinematics.

    Returns:
        Motion (6,) [m/s^2, rad/s^2].
    """
    return _joint_motion(model, data, joint_id, reference_frame, "acceleration")


@repeated_call("joint classical")
def getClassicalAcceleration(model: Model, data: Data, joint_id: int, reference_frame: Any = LOCAL) -> Motion:
    """The acceleration of the point at a joint's origin, after forwardKinematics with v and a.

    Args:
        data: Its data, after forwardKinematics.

    Returns:
        Motion (6,) [m/s^2, rad/s^2].
    """
    return _joint_motion(model, data, joint_id, reference_frame, "classical")


@repeated_call("velocity")
@at_frame_or_joint_by_default_local
def getFrameVelocity(
    model: Model,
    data: Data,
    frame_id: int | None = None,
    placement: Any = None,
    reference_frame: Any = None,
    joint_id: int | None = None,
) -> Motion:
    """The velocity of a frame (its index, or a joint's and a placement), after forwardKinematics with v.

    Args:
        data: Its data, after forwardKinematics.
        frame_id: Index of the frame; or index of a joint, when a placement in its frame follows.
        placement: That placement, an SE3; the reference frame may stand here.
        joint_id: Index of the joint, by name.

    Returns:
        Motion (6,) [m/s, rad/s].
    """
    return _frame_motion(model, data, (frame_id, joint_id, placement), reference_frame, "velocity")


@repeated_call("acceleration")
@at_frame_or_joint_by_default_local
def getFrameAcceleration(
    model: Model,
    data: Data,
    frame_id: int | None = None,
    placement: Any = None,
    reference_frame: Any = None,
    joint_id: int | None = None,
) -> Motion:
    """The spatial acceleration of a frame, after forwardKinematics with v and a; see `getFrameVelocity`.

    Args:
        data: Its data, after forwardKinematics.
        frame_id: Index of the frame; or index of a joint, when a placement in its frame follows.
        placement: That placement, an SE3; the reference frame may stand here.
        joint_id: Index of the joint, by name.

    Returns:
        Motion (6,) [m/s^2, rad/s^2].
    """
    return _frame_motion(model, data, (frame_id, joint_id, placement), reference_frame, "acceleration")


@repeated_call("classical")
@at_frame_or_joint_by_default_local
def getFrameClassicalAcceleration(
    model: Model,
    data: Data,
    frame_id: int | None = None,
    placement: Any = None,
    reference_frame: Any = None,
    joint_id: int | None = None,
) -> Motion:
    """The acceleration of the point at a frame's origin; see `getFrameAcceleration`.

    Args:
        data: Its data, after forwardKinematics.
        frame_id: Index of the frame; or index of a joint, when a placement in its frame follows.
        placement: That placement, an SE3; the reference frame may stand here.
        joint_id: Index of the joint, by name.

    Returns:
        Motion (6,) [m/s^2, rad/s^2].
    """
    return _frame_motion(model, data, (frame_id, joint_id, placement), reference_frame, "classical")


def _joint_motion(model: Model, data: Data, joint_id: int, rf: Any, kind: str) -> Motion:
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _motion(model, data, kind, reference_of(rf), joint, None, (joint_id, rf, f"joint {kind}"))


def _frame_motion(model: Model, data: Data, place: Any, rf: Any, kind: str) -> Motion:
    rf = LOCAL if rf is None else rf
    if place[2] is not None:
        joint, placement = at_placement(model, *place[1:])
        return _placed_motion(model, data, kind, rf, joint, placement)
    frame = model.frames[at_frame(model, place[0])]
    binding_key = place[0], rf, kind
    return _motion(model, data, kind, reference_of(rf), frame.parentJoint, frame.placement._m, binding_key)


def _placed_motion(model: Model, data: Data, kind: str, rf: Any, joint: int, placement: SE3) -> Motion:
    """The motion of a frame at a placement on a joint; bound to what the Data holds of the joint for the next time."""
    place = joint, rf, f"placed {kind}"
    step, bound_reference = data._bound_at.get(place, (not_applicable, rf))
    if data._model is model and bound_reference is rf:
        motion = step(placement)
        if motion is not NotImplemented:
            return motion
    reference = reference_of(rf)
    motion = _motion(model, data, kind, reference, joint, placement._m)  # deferred fields are filled
    if data._model is model:
        watch = [*model._watched("structure"), *_marks(data, kind)]
        kernel, read = _frame_motion_at(kind, reference, True), _read(data, kind, reference, joint)

        def bind(otherwise: Any) -> Any:
            held = {"holder": Motion, "input_holders": [SE3]}
            return BoundKernel(kernel, watch, trailing_inputs=read, otherwise=otherwise, **held).call

        data._bound_at[place] = data._bound_after_reads(_fields(kind), bind), rf
    return motion


def _motion(
    model: Model,
    data: Data,
    kind: str,
    reference: Reference,
    joint: int,
    placement: Floats | None,
    place: Any = None,
) -> Motion:
    """The motion of a frame out of what the Data holds of its joint; bound at `place` for the next time.

    Args:
        placement: The placement of the frame on the joint (4, 4); None for that of the joint.
    """
    watch = model._watched("structure") if placement is None else model._watched_frames()
    if data._layout is not model._layout:
        compiled_for(model, data)
    if kind == "velocity":
        data._require(data._qv, "forwardKinematics(model, data, q, v)")
    else:
        data._require(data._qva, "forwardKinematics(model, data, q, v, a)")
    for field in _fields(kind):
        data._read(field)
    step = data._bound_at.get(place, (not_applicable,))[0] if data._model is model else not_applicable
    motion = step()  # deferred fields are filled now
    if motion is not NotImplemented:
        return motion
    placements = [] if placement is None else [np.ascontiguousarray(placement)]
    arrays = [*placements, *_read(data, kind, reference, joint)]
    kernel = _frame_motion_at(kind, reference, bool(placements))
    if place is not None and data._model is model:
        watch += _marks(data, kind)

        def bind(otherwise: Any) -> Any:
            return BoundKernel(kernel, watch, trailing_inputs=arrays, holder=Motion, otherwise=otherwise).call

        data._bound_at[place] = data._bound_after_reads(_fields(kind), bind), place[1]
    return Motion._of(kernel(*arrays))


def _fields(kind: str) -> tuple[str, ...]:
    return ("v",) if kind == "velocity" else ("v", "a")


def _marks(data: Data, kind: str) -> list[tuple[Floats, Floats]]:
    """Pairs of arrays that are equal while the fields of a motion hold what the last algorithm left."""
    return [(data._mark_of(field), np.zeros(())) for field in _fields(kind)]


def _read(data: Data, kind: str, reference: Reference, joint: int) -> list[Floats]:
    """What a kernel of `_frame_motion_at` reads of a Data: the pose of the joint where it counts, and its motions."""
    fields = _fields(kind) if reference == "local" else ("oMi", *_fields(kind))
    return [data._arrays[field][joint] for field in fields]


@cache
def _frame_motion_at(kind: str, reference: Reference, is_placed: bool) -> Any:
    """The compiled motion of a frame in a reference, at a placement in its joint's frame or where that is."""

    def run(*arrays: Array) -> Array:
        inputs = iter(arrays)
        M = pose(next(inputs)) if is_placed else spatial.SE3.identity()
        into = M.inverse()
        if reference != "local":
            T = pose(next(inputs))
            turned = spatial.SE3.from_rotation(T.rotation @ M.rotation, np.zeros(3))
            into = T if reference == "world" else turned @ into
        velocity, *gains = (into.act(spatial.Motion(x[:3], x[3:])) for x in inputs)
        if kind == "velocity":
            return velocity.vector()
        (gain,) = gains
        if kind == "classical":
            gain = spatial.Motion(gain.linear + cross(velocity.angular, velocity.linear), gain.angular)
        return gain.vector()

    places = is_placed + (reference != "local")
    shapes = [(4, 4)] * places + [(6,)] * len(_fields(kind))
    sizes: dict[str, Any] = {f"x{k}": shape for k, shape in enumerate(shapes)}
    return compile_function(run, **sizes)
