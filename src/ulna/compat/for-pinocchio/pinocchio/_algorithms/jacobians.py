"""Jacobians of joints and frames, their time derivatives and Hessians."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from pinocchio._algorithms.frame_arguments import (
    LOCAL,
    Place,
    at_frame,
    at_frame_or_joint,
    at_joint,
    at_placement,
    key_of,
    place_of,
    repeated_call,
)
from pinocchio._algorithms.kinematics import updateFramePlacement, updateFramePlacements
from pinocchio._algorithms.stored_motions import (
    bound_to_fields,
    carrier_of,
    hessian,
    jacobian_rate,
    orders_of,
    placement_of,
)
from pinocchio._algorithms.stored_sums import COLUMNS, columns_of_fields
from pinocchio._containers.arguments import check_model_and_data, checks_itself
from pinocchio._containers.arrays import exact, index, not_applicable
from pinocchio._containers.enums import reference_of
from pinocchio._containers.keywords import overloads
from pinocchio._data.algorithm import Algorithm
from pinocchio._data.binding import run_at_frame
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import JOINTS_AFTER_KINEMATICS, VELOCITIES_IN_WORLD, rows, stacked
from pinocchio._data.evaluated_model import NUMBER_CALLS, kernels_for
from pinocchio._data.first_evaluation import TABLE_CALLS, loaded_evaluator, store
from pinocchio._data.functions import algorithm
from pinocchio._data.states import compiled_for
from pinocchio._model.bound_kernels import BoundKernel, not_read
from pinocchio._model.compiled_model import CompiledModel
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3
from pinocchio._spatial.small_kernels import pose
from pinocchio._tables.evaluation import TableEvaluator
from pinocchio._tables.frame_jacobians import frame_jacobian, frame_jacobian_rate, jacobian_of_columns
from ulna import algorithms, spatial
from ulna.algorithms.multibody.references import Reference
from ulna.compiler.runtime.repeated_calls import call_cache, repeated_calls
from ulna.model import Frame
from ulna.model import Model as CoreModel
from ulna.typing import Array, Floats

__all__ = [
    "computeFrameJacobian",
    "computeJointJacobian",
    "computeJointJacobians",
    "computeJointJacobiansTimeVariation",
    "computeJointKinematicHessians",
    "frameJacobianTimeVariation",
    "getFrameJacobian",
    "getFrameJacobianTimeVariation",
    "getFrameKinematicHessian",
    "getJointJacobian",
    "getJointJacobianTimeVariation",
    "getJointKinematicHessian",
]


def columns(model: CoreModel) -> Any:
    """The fields of `JACOBIANS`."""
    return lambda q: (algorithms.joint_jacobians(model, q), stacked(algorithms.joint_poses(model, q)))


def rates(model: CoreModel) -> Any:
    """The fields of `JACOBIAN_RATES`."""

    def run(q: Array, v: Array) -> tuple[Array, ...]:
        velocities = rows(algorithms.joint_velocities(model, q, v))
        return algorithms.joint_jacobians_dot(model, q, v), *columns(model)(q), velocities

    return run


JACOBIANS = ("J", "oMi")
JACOBIAN_RATES = ("dJ", *JACOBIANS, "v")
_JACOBIAN = Algorithm(
    "jacobian",
    "q",
    (),
    not_applicable,
    (0,),
    depends_on="placements",
    deferred=JOINTS_AFTER_KINEMATICS,
)
_JACOBIAN_AND_PLACEMENTS = Algorithm(
    "jacobian_and_placements",
    "q",
    ("oMi",),
    not_applicable,
    (0,),
    depends_on="placements",
    deferred=JOINTS_AFTER_KINEMATICS,
)
"""Of a joint or frame; all reference frames but LOCAL need the placements of all joints, too."""


@algorithm(
    fills=JACOBIANS,
    kernel=columns,
    returns=(0,),
    depends_on="placements",
    deferred=JOINTS_AFTER_KINEMATICS,
    default_state=("_q", "forwardKinematics(model, data, q)"),
    of_fields=partial(columns_of_fields, algorithm=COLUMNS),
)
def computeJointJacobians(model: Model, data: Data, q: Any = None) -> Floats:
    """Fills `data.J` (columns in WORLD), `data.oMi` and `data.liMi`; returns J (6, nv).

    Args:
        q: Configuration (nq,) [rad or m]; None for the state of the last forwardKinematics.

    Returns:
        Jacobian (6, nv), linear rows first.
    """
    ...


@repeated_call("joint J", has_default=False)
def getJointJacobian(model: Model, data: Data, joint_id: int, reference_frame: Any) -> Floats:
    """The Jacobian (6, nv) of a joint, after computeJointJacobians.

    Args:
        data: Its data, after computeJointJacobians.

    Returns:
        Jacobian (6, nv), linear rows first.
    """
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _bind_at(model, data, (joint_id, reference_frame, "joint J"), ("joint", joint), at_joint(joint))


_joint_calls, _frame_calls = (call_cache(4, weak=2, kernel_argument=2) for _ in range(2))


@repeated_calls(_joint_calls)
@checks_itself
def computeJointJacobian(model: Model, data: Data, q: Any, joint_id: int) -> Floats:
    """The Jacobian (6, nv) of a joint in LOCAL.

    Returns:
        Jacobian (6, nv), linear rows first.
    """
    binding_key = (joint_id, LOCAL, "joint at q")
    try:
        step = (
            data._bound_at[key_of(joint_id), LOCAL, "joint at q"][0]
            if data._model is model
            else not_applicable
        )
    except (KeyError, TypeError, AttributeError):
        step = not_applicable
    result = step(q)
    if result is not NotImplemented:
        _joint_calls.add(step, 1, model, data, joint_id)
        return result
    check_model_and_data("computeJointJacobian", model, data)
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _at(model, data, binding_key, None, at_joint(joint), q)


@repeated_call("J", has_default=False)
@at_frame_or_joint
def getFrameJacobian(
    model: Model,
    data: Data,
    frame_id: int | None = None,
    placement: Any = None,
    reference_frame: Any = None,
    joint_id: int | None = None,
) -> Floats:
    """The Jacobian (6, nv) of a frame, after computeJointJacobians.

    Args:
        placement: A placement in the frame of a joint, in place of a frame.
        reference_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED; it stands third where there is no placement.
        joint_id: Index of that joint; it stands where `frame_id` does.

    Returns:
        Jacobian (6, nv), linear rows first.
    """
    rf = reference_frame
    if placement is not None:
        return _placed_jacobian(model, data, *at_placement(model, joint_id, placement), rf)
    return _bind_at(model, data, (frame_id, rf, "J"), at_frame(model, frame_id), None)


def _placed_jacobian(model: Model, data: Data, joint: int, placement: SE3, rf: Any) -> Floats:
    """The Jacobian of a frame at a placement on a joint; bound to what the Data holds for the next time."""
    reference = reference_of(rf)
    q = data._require(data._q_of_jacobians, "computeJointJacobians(model, data, q)")
    if evaluator := loaded_evaluator(model, data, "J of frames"):
        return _stored_jacobian(model, data, evaluator, q, joint, placement._m, reference)[0]
    watch = model._watched("structure")
    compiled = data._attach(model)
    if model.nvExtended != model.nv:  # columns of mimic joints are not separate in `data.J`
        return _placed_kernel(compiled, joint, reference, q=(model.nq,))(placement._m, q)
    live = compiled.live(_placed_kernel(compiled, joint, reference, J=(6, model.nv), T=(4, 4)))
    read = data._arrays["J"], data._arrays["oMi"][joint]
    step = BoundKernel(live, not_read(live, watch), trailing_inputs=read, input_holders=[SE3]).call
    data._bound_at[joint, rf, "placed J"] = step, rf
    return step(placement)


def _placed_kernel(compiled: CompiledModel, joint: int, reference: Reference, **shapes: Any) -> Any:
    """The kernel of the Jacobian of a frame at a placement on a joint: of q, or of all columns and the joint's pose."""

    def build(core: CoreModel) -> Any:
        def frame_at(placed: Array) -> Frame:
            return Frame("", joint - 1, pose(placed), "user", "", spatial.SE3.identity())

        def at_q(placed: Array, q: Array) -> Array:
            return algorithms.frame_jacobian(core, q, frame_at(placed), reference)

        def of_columns(placed: Array, J: Array, T: Array) -> Array:
            return algorithms.frame_jacobian_of(core, J, pose(T), frame_at(placed), reference)

        return at_q if "q" in shapes else of_columns

    return compiled.compile(("J placed", joint, reference), build, placed=(4, 4), **shapes)


def _stored_jacobian(
    model: Model,
    data: Data,
    evaluator: TableEvaluator,
    q: Floats,
    joint: int,
    placement: Floats,
    reference: Reference,
) -> tuple[Floats, Floats]:
    """The Jacobian (6, nv) of a frame and its placement (4, 4), of `data.J` and `data.oMi`, which users may change."""
    if model.nvExtended != model.nv:  # columns of mimic joints are not separate in `data.J`
        J, _, T = frame_jacobian(evaluator, q, joint, placement, reference)
        return J, T
    read = data._arrays["J"], data._arrays["oMi"][joint]
    return jacobian_of_columns(evaluator, *read, joint, placement, reference)


def _bind_at(
    model: Model, data: Data, binding_key: tuple[Any, ...], key: Any, fixed_frame: Frame | None
) -> Floats:
    """The Jacobian of a frame in a reference, the second of `place`, computed and bound for the next time."""
    reference = reference_of(binding_key[1])
    q = data._require(data._q_of_jacobians, "computeJointJacobians(model, data, q)")
    if evaluator := loaded_evaluator(model, data, "J of frames"):
        joint, placement = _carrier(model, key, fixed_frame)
        J, T = _stored_jacobian(model, data, evaluator, q, joint, placement, reference)
        if fixed_frame is None:
            data._arrays["oMf"][key] = T
        return J
    watch = model._watched("structure" if fixed_frame is not None else "frame", key)  # first: see `run`
    compiled = data._attach(model)
    if model.nvExtended != model.nv:  # columns of mimic joints are not separate in `data.J`
        if fixed_frame is None:
            updateFramePlacement(model, data, key)
        return _jacobian(model, data, reference, key, fixed_frame)(q)

    def build(core: CoreModel, frames: Sequence[Frame]) -> Any:
        frame = frames[key] if fixed_frame is None else fixed_frame

        def run(J: Array, T: Array) -> tuple[Array, Array]:
            of = spatial.SE3(T[:3, :3], T[:3, 3])
            return algorithms.frame_jacobian_of(core, J, of, frame, reference), (
                of @ frame.placement
            ).matrix()

        return run

    kernel = compiled.live(
        compiled.compile_at_frames(("J of", key, reference), build, J=(6, model.nv), T=(4, 4))
    )
    joint = model.frames[key].parentJoint if fixed_frame is None else fixed_frame.joint + 1
    placed = data._arrays["oMf"][key] if fixed_frame is None else np.empty((4, 4))
    read = data._arrays["J"], data._arrays["oMi"][joint]
    step = BoundKernel(kernel, not_read(kernel, watch), [placed], read).call
    data._bound_at[binding_key] = step, binding_key[1]
    return step()


@repeated_calls(_frame_calls)
@checks_itself
def computeFrameJacobian(
    model: Model, data: Data, q: Any, frame_id: int, reference_frame: Any = LOCAL
) -> Floats:
    """The Jacobian (6, nv) of a frame at q.

    Returns:
        Jacobian (6, nv), linear rows first.
    """
    binding_key = (frame_id, reference_frame, "at q")
    try:
        step, bound_reference = data._bound_at[key_of(frame_id), reference_frame, "at q"]
    except (KeyError, TypeError, AttributeError):
        step = bound_reference = not_applicable
    if bound_reference is reference_frame and data._model is model:  # 0 == WORLD, but a plain number raises
        result = step(q)
        if result is not NotImplemented:
            _frame_calls.add(step, 1, model, data, frame_id, reference_frame)
            if reference_frame is LOCAL:  # where it is left out, too
                _frame_calls.add(step, 1, model, data, frame_id)
            return result
    check_model_and_data("computeFrameJacobian", model, data)
    return _at(model, data, binding_key, at_frame(model, frame_id), None, q)


def _at(
    model: Model, data: Data, binding_key: tuple[Any, ...], key: Any, fixed_frame: Frame | None, q: Any
) -> Floats:
    """The Jacobian at q of a frame in a reference, the second of `place`, computed and bound for the next time."""
    reference = reference_of(binding_key[1])
    record = _JACOBIAN if reference == "local" else _JACOBIAN_AND_PLACEMENTS
    if binding_key not in data._bound_at and (evaluator := loaded_evaluator(model, data, "J at q")):
        q = exact(q, model.nq, "q")
        joint, placement = _carrier(model, key, fixed_frame)
        J, oMi, _ = frame_jacobian(evaluator, q, joint, placement, reference)
        store(model, data, record, [q], *([] if reference == "local" else [oMi]))
        return J

    def build(core: CoreModel, frames: Sequence[Frame]) -> Any:
        frame = fixed_frame or frames[key]

        def run(q: Array) -> tuple[Array, ...]:
            J = algorithms.frame_jacobian(core, q, frame, reference)
            return (J,) if reference == "local" else (J, stacked(algorithms.joint_poses(core, q)))

        return run

    return run_at_frame(model, data, record, binding_key, key, build, q)


def _carrier(model: Model, key: Any, fixed_frame: Frame | None) -> tuple[int, Floats]:
    """The joint that carries a frame, and the placement of the frame there."""
    if fixed_frame is None:
        return model.frames[key].parentJoint, model.frames[key].placement._m
    return fixed_frame.joint + 1, np.asarray(fixed_frame.placement.matrix())


def _jacobian(model: Model, data: Data, reference: Reference, key: Any, fixed_frame: Frame | None) -> Any:
    compiled = kernels_for(model, data, "J at stored q")

    def build(core: CoreModel, frames: Sequence[Frame]) -> Any:
        frame = frames[key] if fixed_frame is None else fixed_frame
        return lambda q: algorithms.frame_jacobian(core, q, frame, reference)

    return compiled.compile_at_frames(("J", key, reference), build, q=(model.nq,))


# time derivatives and Hessians --------------------------------------------------------------------------


@algorithm(
    fills=JACOBIAN_RATES,
    kernel=rates,
    returns=(0,),
    depends_on="placements",
    deferred=JOINTS_AFTER_KINEMATICS | VELOCITIES_IN_WORLD,
)
def computeJointJacobiansTimeVariation(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """Fills `data.dJ` (columns in WORLD) and `data.J`; returns dJ (6, nv).

    Returns:
        Matrix (6, nv).
    """
    ...


@repeated_call("joint dJ", has_default=False)
def getJointJacobianTimeVariation(model: Model, data: Data, joint_id: int, reference_frame: Any) -> Floats:
    """The time derivative (6, nv) of a joint's Jacobian, after computeJointJacobiansTimeVariation.

    Args:
        data: Its data, after computeJointJacobiansTimeVariation.

    Returns:
        Matrix (6, nv).
    """
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _bind_dot(model, data, (joint_id, reference_frame, "joint dJ"), ("joint", joint), at_joint(joint))


def getFrameJacobianTimeVariation(model: Model, data: Data, frame_id: int, reference_frame: Any) -> Floats:
    """The time derivative (6, nv) of a frame's Jacobian, after computeJointJacobiansTimeVariation.

    Args:
        data: Its data, after computeJointJacobiansTimeVariation.

    Returns:
        Matrix (6, nv).
    """
    J_rate = _frame_jacobian_rate(model, data, frame_id, reference_frame)
    updateFramePlacement(model, data, frame_id)
    return J_rate


@repeated_call("dJ", has_default=False)
def _frame_jacobian_rate(model: Model, data: Data, frame_id: int, reference_frame: Any) -> Floats:
    return _bind_dot(model, data, (frame_id, reference_frame, "dJ"), at_frame(model, frame_id), None)


def frameJacobianTimeVariation(
    model: Model, data: Data, q: Any, v: Any, frame_id: int, reference_frame: Any
) -> Floats:
    """The time derivative (6, nv) of a frame's Jacobian.

    Returns:
        Matrix (6, nv).
    """
    computeJointJacobiansTimeVariation(model, data, q, v)
    updateFramePlacements(model, data)
    return getFrameJacobianTimeVariation(model, data, frame_id, reference_frame)


def _bind_dot(
    model: Model, data: Data, binding_key: tuple[Any, ...], key: Any, fixed_frame: Frame | None
) -> Floats:
    """The time derivative of the Jacobian of a frame, computed and bound for the next time; see `_bind_at`."""
    reference = reference_of(binding_key[1])
    state = data._require(data._qv_of_jacobians, "computeJointJacobiansTimeVariation(model, data, q, v)")
    compiled_for(model, data)
    if model.nvExtended != model.nv:  # columns of mimic joints are not separate in `data.J`
        return _rate_at_state(model, data, reference, key, fixed_frame, state)
    joint = model.frames[key].parentJoint if fixed_frame is None else fixed_frame.joint + 1
    carrier = carrier_of(model, joint, fixed_frame is None, reference)
    fields = {"local": ("v",), "world": (), "local_world_aligned": ("ov",)}[reference]
    for field in fields:
        data._read(field)
    arrays = data._arrays
    placement = placement_of(model.frames[key].placement._m if fixed_frame is None else None)
    twist = [arrays[field][joint] for field in fields]
    read = [*placement, arrays["oMi"][joint], arrays["J"], arrays["dJ"], *twist]
    function = jacobian_rate(carrier)
    if model.first_calls.includes("dJ of frames", TABLE_CALLS):
        return function(*read)
    watch = model._watched_frames() if fixed_frame is None else model._watched("structure")
    step = bound_to_fields(model, data, ("dJ of fields", carrier), function, read, fields, watch)
    if data._model is model:
        data._bound_at[binding_key] = step, binding_key[1]
    return step()


def _rate_at_state(
    model: Model, data: Data, reference: Reference, key: Any, fixed_frame: Frame | None, state: Any
) -> Floats:
    """The time derivative of the Jacobian of a frame at a state, of models with mimic joints."""
    if evaluator := loaded_evaluator(model, data, "dJ of frames"):
        (q, v), (joint, placement) = state, _carrier(model, key, fixed_frame)
        return frame_jacobian_rate(evaluator, q, v, joint, placement, reference)

    def build(core: CoreModel, frames: Sequence[Frame]) -> Any:
        frame = fixed_frame or frames[key]
        return lambda q, v: algorithms.frame_jacobian_dot(core, q, v, frame, reference)

    shapes: dict[str, Any] = {"q": (model.nq,), "v": (model.nv,)}
    return data._attach(model).compile_at_frames(("dJ", key, reference), build, **shapes)(*state)


def computeJointKinematicHessians(model: Model, data: Data, q: Any = None) -> None:
    """Prepares getJointKinematicHessian and getFrameKinematicHessian.

    Args:
        q: Configuration (nq,) [rad or m]; None for the state of the last forwardKinematics.
    """
    if q is None:
        computeJointJacobians(model, data)
    else:
        computeJointJacobians(model, data, q)


@repeated_call("joint H", has_default=False)
def getJointKinematicHessian(model: Model, data: Data, joint_id: int, reference_frame: Any) -> Floats:
    """The derivative (6, nv, nv) of a joint's Jacobian by q; [:, j, k] is that of column j by entry k.

    Args:
        data: Its data, after computeJointKinematicHessians.

    Returns:
        Array (6, nv, nv).
    """
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    return _hessian(model, data, Place(None, joint), (joint_id, reference_frame, "joint H"))


_hessian_calls = call_cache(4, weak=2)
_placed_hessian_calls = call_cache(4, weak=2, kernel_argument=3)


@repeated_calls(_hessian_calls, _placed_hessian_calls)
@overloads(
    "model data frame_id reference_frame:ReferenceFrame",
    "model data joint_id>frame_id frame_placement:SE3 reference_frame:ReferenceFrame",
)
def getFrameKinematicHessian(
    model: Model, data: Data, frame_id: int, reference_frame: Any = LOCAL, frame_placement: Any = None
) -> Floats:
    """The derivative (6, nv, nv) of a frame's Jacobian by q; see `getJointKinematicHessian`.

    Args:
        data: Its data, after computeJointKinematicHessians.
        frame_id: Index of the frame; or index of a joint, when a placement in its frame follows.
        reference_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED.
        frame_placement: That placement, or nothing.

    Returns:
        Array (6, nv, nv).
    """
    place = place_of(model, frame_id, frame_id, frame_placement)
    binding_key = frame_id, reference_frame, "H" if place.placement is None else "placed H"
    H = _bound_hessian(model, data, place, binding_key)
    if H is not NotImplemented:
        calls = _hessian_calls if place.placement is None else _placed_hessian_calls
        step = data._bound_at[binding_key][0]
        calls.add(step, len(place.holders), model, data, frame_id, reference_frame)
        return H
    return _hessian(model, data, place, binding_key)


def _bound_hessian(model: Model, data: Data, place: Place, binding_key: tuple[Any, ...]) -> Any:
    step, bound_frame = data._bound_at.get(binding_key, (not_applicable, None))
    if data._model is not model or bound_frame is not binding_key[1]:  # 0 == WORLD, but a plain number raises
        return NotImplemented
    return step(*place.holders)


def _hessian(model: Model, data: Data, place: Place, binding_key: tuple[Any, ...]) -> Floats:
    """The Hessian of a frame out of `data.J` and `data.oMi`, bound at `binding_key` for the next time."""
    reference = reference_of(binding_key[1])
    q = data._require(data._q_of_jacobians, "computeJointKinematicHessians(model, data, q)")
    compiled_for(model, data)
    joint, placement = place.on_joint(model)
    carrier = carrier_of(model, joint, placement is not None, reference)
    orders = orders_of(model, carrier) if model.nvExtended == model.nv else None
    if orders is None:
        return _hessian_at(model, data, reference, place, q)
    arrays, function = data._arrays, hessian(carrier, orders)
    read = [*placement_of(placement), arrays["oMi"][joint], arrays["J"]]
    if model.first_calls.includes("H", NUMBER_CALLS):
        return np.ascontiguousarray(function(*read))
    watch = model._watched_frames() if place.frame_id is not None else model._watched("structure")
    key = "H of fields", carrier, orders
    step = bound_to_fields(
        model, data, key, function, read, (), watch, passes_placement=place.placement is not None
    )
    if data._model is model:
        data._bound_at[binding_key] = step, binding_key[1]
    return step(*place.holders)


def _hessian_at(model: Model, data: Data, reference: Reference, place: Place, q: Floats) -> Floats:
    """The Hessian of a frame at q, of models whose columns are not separate in `data.J`."""

    def build(core: CoreModel, frames: Sequence[Frame]) -> Any:
        def run(*inputs: Array) -> Array:
            frame, (q,) = place.split(frames, inputs)
            return algorithms.frame_hessian(core, q, frame, reference)

        return run

    kernels, shapes = kernels_for(model, data, "H"), place.shapes | {"q": (model.nq,)}
    result = kernels.compile_at_frames(("H", place.key, reference), build, **shapes)(*place.inputs, q)
    return np.ascontiguousarray(np.moveaxis(result, 0, 2))
