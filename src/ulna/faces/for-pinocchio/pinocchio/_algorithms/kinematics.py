"""Placements, velocities and accelerations of joints and frames."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, TypeVar

import numpy as np

from pinocchio._containers.arrays import index
from pinocchio._containers.enums import ReferenceFrame, reference_of
from pinocchio._containers.keywords import by_name
from pinocchio._data.algorithm import Algorithm
from pinocchio._data.binding import run
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import ACCELERATIONS_IN_WORLD, JOINTS, VELOCITIES_IN_WORLD, rows, stacked
from pinocchio._data.functions import fast_path
from pinocchio._data.states import check_frames, compiled_for
from pinocchio._model.bound_kernels import BoundKernel, not_applicable, not_read
from pinocchio._model.frame import changes
from pinocchio._model.kernel_parameters import pose_of
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3, se3_kernel
from ulna import algorithms, spatial
from ulna.algorithms.multibody.references import Reference
from ulna.compiler import compile as compile_function
from ulna.errors import InputError
from ulna.model import Frame
from ulna.model import Model as CoreModel
from ulna.numeric import cross
from ulna.typing import Array, Floats

__all__ = [
    "forwardKinematics",
    "framesForwardKinematics",
    "getAcceleration",
    "getClassicalAcceleration",
    "getFrameAcceleration",
    "getFrameClassicalAcceleration",
    "getFrameVelocity",
    "getVelocity",
    "updateFramePlacement",
    "updateFramePlacements",
    "updateGlobalPlacements",
]

LOCAL = ReferenceFrame.LOCAL
_HERE = np.eye(4)
_new = object.__new__
Asked = TypeVar("Asked", bound=Callable[..., Motion])


def _placements(model: CoreModel) -> Any:
    return lambda q: stacked(algorithms.joint_poses(model, q))


def _velocities(model: CoreModel) -> Any:
    return lambda q, v: (_placements(model)(q), rows(algorithms.joint_velocities(model, q, v)))


def _accelerations(model: CoreModel) -> Any:
    def run(q: Array, v: Array, a: Array) -> tuple[Array, ...]:
        return *_velocities(model)(q, v), rows(algorithms.joint_accelerations(model, q, v, a))

    return run


def _frame_placements(model: CoreModel, frames: Sequence[Frame]) -> Any:
    return lambda q: (_placements(model)(q), stacked(algorithms.frame_poses(model, q, frames)))


_POSITION = Algorithm("position", "q", ("oMi",), _placements, depends_on="placements", deferred=JOINTS)
_VELOCITY = Algorithm(
    "velocity",
    "qv",
    ("oMi", "v"),
    _velocities,
    depends_on="placements",
    deferred=JOINTS | VELOCITIES_IN_WORLD,
)
_ACCELERATION = Algorithm(
    "acceleration",
    "qva",
    ("oMi", "v", "a"),
    _accelerations,
    depends_on="placements",
    deferred=JOINTS | VELOCITIES_IN_WORLD | ACCELERATIONS_IN_WORLD,
)
_FRAMES = Algorithm("frames", "q", ("oMi", "oMf"), _frame_placements, depends_on="frames", deferred=JOINTS)


@fast_path(_POSITION, _VELOCITY, _ACCELERATION)
def forwardKinematics(model: Model, data: Data, q: Any, v: Any = None, a: Any = None) -> None:
    """Fills `data.oMi` and `data.liMi`; with v and a also `data.v` and `data.a`."""
    if v is None and a is not None:
        raise InputError(
            "forwardKinematics was given accelerations without velocities; expected both, or q alone."
        )
    state = [x for x in (q, v, a) if x is not None]
    run(model, data, (_POSITION, _VELOCITY, _ACCELERATION)[len(state) - 1], *state)


@fast_path(_FRAMES)
def framesForwardKinematics(model: Model, data: Data, q: Any) -> None:
    """Fills `data.oMi`, `data.liMi` and `data.oMf`."""
    check_frames(model, data)
    run(model, data, _FRAMES, q)


def _moved_frames(model: CoreModel, frames: Sequence[Frame]) -> Any:
    def run(oMi: Array) -> Array:
        return stacked([pose_of(oMi[frame.joint + 1]) @ frame.placement for frame in frames])

    return run


def updateFramePlacements(model: Model, data: Data) -> None:
    """Fills `data.oMf` from `data.oMi`."""
    step = data._bound_at.get("frames", not_applicable)
    if data._model is not model or step() is NotImplemented:
        check_frames(model, data)
        data.require(data._q, "forwardKinematics(model, data, q)")
        watch = model.watched("frames")  # first: see `run`
        compiled = data.attach(model)
        kernel = compiled.live(compiled.compile_at_frames("frames", _moved_frames, oMi=(model.njoints, 4, 4)))
        oMi, oMf = data._arrays["oMi"], data._arrays["oMf"]
        step = kernel.into(oMf, watch=not_read(kernel, watch), otherwise=not_applicable, given=[oMi])
        data._bound_at["frames"] = step
        step()


def updateFramePlacement(model: Model, data: Data, frame_id: int) -> SE3:
    """Fills `data.oMf[frame_id]` from `data.oMi`, and returns a copy."""
    step = data._bound_at.get(("frames", frame_id), not_applicable)
    T = step() if data._model is model else NotImplemented
    if T is NotImplemented:
        check_frames(model, data)
        place = index(frame_id, model.nframes, "frame", "model.getFrameId(name) returns one.")
        data.require(data._q, "forwardKinematics(model, data, q)")
        data.attach(model)
        watch, frame = [(changes, changes.copy())], model.frames[place]
        factors = data._arrays["oMi"][frame.parentJoint], frame.placement._m
        into = data._arrays["oMf"][place]
        step = se3_kernel("product").into(
            into, returns=(0,), watch=watch, otherwise=not_applicable, given=factors
        )
        data._bound_at["frames", frame_id] = step
        T = step()
    return SE3._of(T)


def updateGlobalPlacements(model: Model, data: Data) -> None:
    """Fills `data.oMi` from `data.liMi`."""
    blocks = data._arrays
    data.read("liMi")
    for i in range(1, model.njoints):
        np.matmul(blocks["oMi"][model.parents[i]], blocks["liMi"][i], out=blocks["oMi"][i])


# velocities and accelerations ---------------------------------------------------------------------------


def at_joint(joint: int) -> Frame:
    """The frame of a joint, for Ulna."""
    return Frame("", joint - 1, spatial.SE3.identity(), "user", "", spatial.SE3.identity())


def at_frame(model: Model, place: Any) -> tuple[Any, Any]:
    """A key and Ulna's frame of an index of a frame, or of (index of a joint, placement)."""
    if len(place) == 1:
        return index(place[0], model.nframes, "frame", "model.getFrameId(name) returns one."), None
    joint, M = place
    joint = index(joint, model.njoints, "joint", "model.getJointId(name) returns one.")
    fixed_frame = Frame("", joint - 1, M._pose(), "user", "", spatial.SE3.identity())
    return (joint, M._m.tobytes()), fixed_frame


def split(rest: tuple[Any, ...], rf: Any) -> tuple[tuple[Any, ...], Reference]:
    """(index) or (joint, placement), and the reference, out of what stands before and by name."""
    if len(rest) > 1 and isinstance(rest[-1], ReferenceFrame):
        rest, rf = rest[:-1], rest[-1]
    elif len(rest) > 1 and not isinstance(rest[-1], SE3):
        reference_of(rest[-1])
    return rest, reference_of(LOCAL if rf is None else rf)


def _quick(kind: str) -> Callable[[Asked], Asked]:
    """Repeats a call with the same arguments by one native call, and leaves all others to the function."""

    def decorate(function: Any) -> Any:
        @functools.wraps(function)
        def call(
            model: Model, data: Data, place: Any = None, reference: Any = None, *rest: Any, **named: Any
        ) -> Motion:
            if rest or named:
                args = (x for x in (place, reference) if x is not None)
                return function(model, data, *args, *rest, **named)
            if reference is None:
                reference = LOCAL
            try:
                step, bound_reference = data._bound_at[place, reference, kind]
            except (KeyError, TypeError):
                step, bound_reference = not_applicable, None
            if bound_reference is reference and data._model is model:  # 0 == WORLD, but a plain number raises
                values = step()
                if values is not NotImplemented:
                    motion = _new(Motion)
                    motion._v = values
                    return motion
            return function(model, data, place, reference)

        return call

    return decorate


@_quick("joint velocity")
def getVelocity(model: Model, data: Data, joint_id: int, reference_frame: Any = LOCAL) -> Motion:
    """The velocity of a joint, after forwardKinematics with v."""
    return _joint_motion(model, data, joint_id, reference_frame, "velocity")


@_quick("joint acceleration")
def getAcceleration(model: Model, data: Data, joint_id: int, reference_frame: Any = LOCAL) -> Motion:
    """The spatial acceleration of a joint, after forwardKinematics with v and a."""
    return _joint_motion(model, data, joint_id, reference_frame, "acceleration")


@_quick("joint classical")
def getClassicalAcceleration(model: Model, data: Data, joint_id: int, reference_frame: Any = LOCAL) -> Motion:
    """The acceleration of the point at a joint's origin, after forwardKinematics with v and a."""
    return _joint_motion(model, data, joint_id, reference_frame, "classical")


@_quick("velocity")
@by_name("model data frame_id reference_frame", "model data joint_id placement reference_frame")
def getFrameVelocity(
    model: Model, data: Data, frame_id: int, placement: Any = None, reference_frame: Any = None
) -> Motion:
    """The velocity of a frame (its index, or a joint's and a placement), after forwardKinematics with v."""
    return _frame_motion(model, data, frame_id, placement, reference_frame, "velocity")


@_quick("acceleration")
@by_name("model data frame_id reference_frame", "model data joint_id placement reference_frame")
def getFrameAcceleration(
    model: Model, data: Data, frame_id: int, placement: Any = None, reference_frame: Any = None
) -> Motion:
    """The spatial acceleration of a frame, after forwardKinematics with v and a; see `getFrameVelocity`."""
    return _frame_motion(model, data, frame_id, placement, reference_frame, "acceleration")


@_quick("classical")
@by_name("model data frame_id reference_frame", "model data joint_id placement reference_frame")
def getFrameClassicalAcceleration(
    model: Model, data: Data, frame_id: int, placement: Any = None, reference_frame: Any = None
) -> Motion:
    """The acceleration of the point at a frame's origin; see `getFrameAcceleration`."""
    return _frame_motion(model, data, frame_id, placement, reference_frame, "classical")


def _joint_motion(model: Model, data: Data, joint_id: int, rf: Any, kind: str) -> Motion:
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _motion(model, data, kind, reference_of(rf), joint, _HERE, (joint_id, rf, f"joint {kind}"))


def _frame_motion(model: Model, data: Data, frame_id: int, placement: Any, rf: Any, kind: str) -> Motion:
    where, reference = split(tuple(x for x in (frame_id, placement) if x is not None), rf)
    key, fixed_frame = at_frame(model, where)
    if fixed_frame is not None:
        return _motion(model, data, kind, reference, key[0], where[1]._m)
    frame, key_part = model.frames[key], (LOCAL if rf is None else rf) if placement is None else placement
    return _motion(
        model, data, kind, reference, frame.parentJoint, frame.placement._m, (frame_id, key_part, kind)
    )


def _motion(
    model: Model,
    data: Data,
    kind: str,
    reference: Reference,
    joint: int,
    placement: Floats,
    place: Any = None,
) -> Motion:
    """The motion of a frame out of what the Data holds of its joint; bound at `place` for the next time."""
    watch = [(changes, changes.copy())]  # joints and frames
    if data._layout is not model._layout:
        compiled_for(model, data)
    if kind == "velocity":
        data.require(data._qv, "forwardKinematics(model, data, q, v)")
    else:
        data.require(data._qva, "forwardKinematics(model, data, q, v, a)")
    step = data._bound_at.get(place, (not_applicable,))[0] if data._model is model else not_applicable
    motion = step()  # deferred fields may be filled now
    if motion is NotImplemented:
        fields = ("v",) if kind == "velocity" else ("v", "a")
        arrays = [np.ascontiguousarray(placement), *(data._arrays[x][joint] for x in ("oMi", *fields))]
        kernel = _seen_from(kind, reference)
        if place is not None and data._model is model:
            watch += [(data.mark_of(field), np.zeros(())) for field in fields]
            data._bound_at[place] = BoundKernel(kernel, watch, given=arrays).call, place[1]
        motion = kernel(*arrays)
    return Motion._of(motion)


@cache
def _seen_from(kind: str, reference: Reference) -> Any:
    """The compiled motion of a frame at a placement in its joint's frame, in a reference."""

    def run(placement: Array, oMi: Array, v: Array, a: Array | None = None) -> Array:
        T, M = (spatial.SE3(m[:3, :3], m[:3, 3]) for m in (oMi, placement))
        into = M.inverse()
        if reference == "world":
            into = T
        elif reference == "local_world_aligned":
            into = spatial.SE3.from_rotation(T.rotation @ M.rotation, np.zeros(3)) @ into
        velocity = into.act(spatial.Motion(v[:3], v[3:]))
        if kind == "velocity":
            return velocity.vector()
        assert a is not None
        gain = into.act(spatial.Motion(a[:3], a[3:]))
        if kind == "classical":
            gain = spatial.Motion(gain.linear + cross(velocity.angular, velocity.linear), gain.angular)
        return gain.vector()

    motions: dict[str, Any] = {"v": (6,)} if kind == "velocity" else {"v": (6,), "a": (6,)}
    return compile_function(run, placement=(4, 4), oMi=(4, 4), **motions)
