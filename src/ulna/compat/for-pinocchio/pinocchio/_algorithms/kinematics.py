"""Forward kinematics: placements of joints and frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._algorithms.frame_arguments import key_of
from pinocchio._containers.arguments import ArgumentError, check_model_and_data, checked, checks_itself
from pinocchio._containers.arrays import index, not_applicable
from pinocchio._data.algorithm import Algorithm
from pinocchio._data.binding import run
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import (
    ACCELERATIONS_IN_WORLD,
    JOINTS_AFTER_KINEMATICS,
    VELOCITIES_IN_WORLD,
    rows,
    stacked,
)
from pinocchio._data.first_evaluation import TABLE_CALLS
from pinocchio._data.functions import fast_path
from pinocchio._data.states import check_frames
from pinocchio._model.bound_kernels import not_read
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3, se3_kernel
from pinocchio._spatial.small_kernels import pose
from pinocchio._tables.fields import frames_at
from ulna import algorithms, spatial
from ulna.compiler.runtime.repeated_calls import call_cache, repeated_calls
from ulna.model import Frame
from ulna.model import Model as CoreModel
from ulna.typing import Array

__all__ = [
    "forwardKinematics",
    "framesForwardKinematics",
    "updateFramePlacement",
    "updateFramePlacements",
    "updateGlobalPlacements",
]


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


_POSITION = Algorithm(
    "position",
    "q",
    ("oMi",),
    _placements,
    depends_on="placements",
    deferred=JOINTS_AFTER_KINEMATICS,
)
_VELOCITY = Algorithm(
    "velocity",
    "qv",
    ("oMi", "v"),
    _velocities,
    depends_on="placements",
    deferred=JOINTS_AFTER_KINEMATICS | VELOCITIES_IN_WORLD,
)
_ACCELERATION = Algorithm(
    "acceleration",
    "qva",
    ("oMi", "v", "a"),
    _accelerations,
    depends_on="placements",
    deferred=JOINTS_AFTER_KINEMATICS | VELOCITIES_IN_WORLD | ACCELERATIONS_IN_WORLD,
)
_FRAMES = Algorithm(
    "frames", "q", ("oMi", "oMf"), _frame_placements, depends_on="frames", deferred=JOINTS_AFTER_KINEMATICS
)


@fast_path(_POSITION, _VELOCITY, _ACCELERATION)
def forwardKinematics(model: Model, data: Data, q: Any, v: Any = None, a: Any = None) -> None:
    """Fills `data.oMi` and `data.liMi`; with v and a also `data.v` and `data.a`.

    Raises:
        ArgumentError: No configuration, or an acceleration without a velocity.
    """
    if v is None and a is not None:
        raise ArgumentError(
            "forwardKinematics was given accelerations without velocities; expected both, or q alone."
        )
    if q is None:
        raise ArgumentError("forwardKinematics was given no configuration; expected q (nq,).")
    state = [x for x in (q, v, a) if x is not None]
    run(model, data, (_POSITION, _VELOCITY, _ACCELERATION)[len(state) - 1], *state)


@fast_path(_FRAMES)
def framesForwardKinematics(model: Model, data: Data, q: Any) -> None:
    """Fills `data.oMi`, `data.liMi` and `data.oMf`."""
    check_frames(model, data)
    run(model, data, _FRAMES, q)


def _moved_frames(model: CoreModel, frames: Sequence[Frame]) -> Any:
    def run(oMi: Array) -> Array:
        return stacked([pose(oMi[frame.joint + 1]) @ frame.placement for frame in frames])

    return run


_frames_calls, _global_calls = call_cache(2, weak=2), call_cache(2, weak=2)
_frame_calls = call_cache(3, weak=2)


@repeated_calls(_frames_calls)
@checks_itself
def updateFramePlacements(model: Model, data: Data) -> None:
    """Fills `data.oMf` from `data.oMi`."""
    try:
        step = data._bound_at.get("frames", not_applicable)
        applies = data._model is model and step() is not NotImplemented
    except AttributeError:
        applies = False
    if applies:
        _frames_calls.add(step, 0, model, data)
    else:
        check_model_and_data("updateFramePlacements", model, data)
        check_frames(model, data)
        data._require(data._q, "forwardKinematics(model, data, q)")
        if model.first_calls.includes("oMf", TABLE_CALLS):
            data._arrays["oMf"][...] = frames_at(model, data._arrays["oMi"])
            return
        watch = model._watched("frames on joints")  # first: see `run`
        compiled = data._attach(model)
        kernel = compiled.live(compiled.compile_at_frames("frames", _moved_frames, oMi=(model.njoints, 4, 4)))
        oMi, oMf = data._arrays["oMi"], data._arrays["oMf"]
        step = kernel.into(
            oMf, watch=not_read(kernel, watch), otherwise=not_applicable, trailing_inputs=[oMi]
        )
        data._bound_at["frames"] = step
        step()


@repeated_calls(_frame_calls)
@checks_itself
def updateFramePlacement(model: Model, data: Data, frame_id: int) -> SE3:
    """Fills `data.oMf[frame_id]` from `data.oMi`, and returns a copy.

    Returns:
        The placement of the frame in the world.
    """
    try:
        step = data._bound_at.get(("frames", key_of(frame_id)), not_applicable)
        T = step() if data._model is model else NotImplemented
    except (AttributeError, TypeError):  # of what is no model, no data, or no index
        T = NotImplemented
    if T is not NotImplemented:
        _frame_calls.add(step, 0, model, data, frame_id)
        return T
    check_model_and_data("updateFramePlacement", model, data)
    check_frames(model, data)
    place = index(frame_id, model.nframes, "frame", "model.getFrameId(name) returns one.")
    data._require(data._q, "forwardKinematics(model, data, q)")
    data._attach(model)
    watch, frame = model._watched_frames(), model.frames[place]
    factors = data._arrays["oMi"][frame.parentJoint], frame.placement._m
    step = se3_kernel("product").into(
        data._arrays["oMf"][place],
        returns=(0,),
        watch=watch,
        otherwise=not_applicable,
        trailing_inputs=factors,
        holder=SE3,
    )
    data._bound_at["frames", frame_id] = step
    return step()


@repeated_calls(_global_calls)
@checked
def updateGlobalPlacements(model: Model, data: Data) -> None:
    """Fills `data.oMi` from `data.liMi`."""
    step = data._bound_at.get("global placements", not_applicable) if data._model is model else not_applicable
    if step() is not NotImplemented:
        _global_calls.add(step, 0, model, data)
        return
    data._read("liMi")
    parents, liMi = tuple(model.parents), data._arrays["liMi"]
    key = "global placements", parents
    kernel = model._compiled_structure().compile(key, _global_placements(parents), liMi=liMi.shape)
    watch = [*model._watched("structure"), (data._mark_of("liMi"), np.zeros(()))]

    def bind(otherwise: Any) -> Any:
        return kernel.into(data._arrays["oMi"][1:], watch=watch, otherwise=otherwise, trailing_inputs=[liMi])

    step = data._bound_after_reads(("liMi",), bind)
    if data._model is model:
        data._bound_at["global placements"] = step
    step()


def _global_placements(parents: tuple[int, ...]) -> Any:
    def run(liMi: Array) -> Array:
        placed = [spatial.SE3.identity()]
        for i in range(1, len(parents)):
            placed.append(placed[parents[i]] @ pose(liMi[i]))
        return stacked(placed[1:])

    return lambda _: run
