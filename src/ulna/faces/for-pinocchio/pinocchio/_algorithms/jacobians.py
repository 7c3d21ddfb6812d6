"""Jacobians of joints and frames, their time derivatives and Hessians."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._algorithms.kinematics import (
    LOCAL,
    PLACED,
    at_frame,
    at_joint,
    split,
    updateFramePlacement,
    updateFramePlacements,
)
from pinocchio._containers.arrays import index
from pinocchio._containers.enums import ReferenceFrame, reference_of
from pinocchio._data.binding import Algorithm, Scratch, refuse, run, run_at
from pinocchio._data.data import Data, engine_for
from pinocchio._data.deferred_fields import OV, OWN, rows, stacked
from pinocchio._model.kernel_parameters import unread
from pinocchio._model.model import Model
from ulna import algorithms, spatial
from ulna.algorithms.references import Reference
from ulna.model import Frame
from ulna.model import Model as TowerModel
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


def columns(model: TowerModel) -> Any:
    return lambda q: (
        algorithms.joint_jacobians(model, q),
        stacked(algorithms.joint_poses(model, q)),
        q,
        q,
    )


def rates(model: TowerModel) -> Any:
    first = columns(model)

    def run(q: Array, v: Array) -> tuple[Array, ...]:
        speeds = rows(algorithms.joint_velocities(model, q, v))
        return algorithms.joint_jacobians_dot(model, q, v), *first(q), q, v, speeds, q, v

    return run


COLUMNS = ("J", "oMi", "places q", "jacobians q")
RATES = ("dJ", *COLUMNS, "rates q", "rates v", "v", "speeds q", "speeds v")
_J = Algorithm("columns", "q", COLUMNS, columns, (0,), on="places", late=OWN)
_DJ = Algorithm("joint_rates", "qv", RATES, rates, (0,), on="places", late=OWN | OV)
_HERE_J = Algorithm("jacobian_here", "q", (), refuse, (0,), on="places", late=OWN)
_PLACED_J = Algorithm("jacobian_placed", "q", PLACED, refuse, (0,), on="places", late=OWN)
"""Of a joint or frame; not in LOCAL all joints are placed, too."""


def computeJointJacobians(model: Model, data: Data, q: Any = None) -> Floats:
    """Fills `data.J` (columns in WORLD), `data.oMi` and `data.liMi`; returns J (6, nv)."""
    if q is None:
        q = data.require(data._q, "forwardKinematics(model, data, q)")
    step = data._run.columns
    J = step(q) if data._model is model else NotImplemented
    if J is NotImplemented:
        J = run(model, data, _J, q)
    return J


def getJointJacobian(model: Model, data: Data, joint_id: int, reference_frame: Any = LOCAL) -> Floats:
    """The Jacobian (6, nv) of a joint, after computeJointJacobians."""
    place = (joint_id, reference_frame, "joint")
    try:
        step, told = data._run_at[place]
    except (KeyError, TypeError):
        step = told = refuse
    if told is reference_frame and data._model is model:  # 0 equals WORLD, and is refused
        found = step()
        if found is not NotImplemented:
            return found
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) gives one.")
    return _bind_at(model, data, place, ("joint", joint), at_joint(joint))


def computeJointJacobian(model: Model, data: Data, q: Any, joint_id: int) -> Floats:
    """The Jacobian (6, nv) of a joint in LOCAL."""
    place = (joint_id, LOCAL, "joint at q")
    try:
        found = data._run_at[place][0](q) if data._model is model else NotImplemented
    except (KeyError, TypeError):
        found = NotImplemented
    if found is not NotImplemented:
        return found
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) gives one.")
    return _at(model, data, place, None, at_joint(joint), q)


def getFrameJacobian(
    model: Model, data: Data, frame_id: int, placement: Any = None, reference_frame: Any = None
) -> Floats:
    """The Jacobian (6, nv) of a frame, after computeJointJacobians.

    Args:
        model: The model.
        data: Its data.
        frame_id: Index of the frame; or index of a joint, when a placement in its frame follows.
        placement: That placement, or nothing.
        reference_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED; it stands third where there is no placement.
    """
    if placement is None:
        placement, reference_frame = reference_frame, None
    if reference_frame is None:
        try:
            step, told = data._run_at[frame_id, placement]
        except (KeyError, TypeError):
            step = told = refuse
        if told is placement and data._model is model:  # 0 equals WORLD, and is refused
            found = step()
            if found is not NotImplemented:
                return found
        if isinstance(placement, ReferenceFrame):
            return _bind_at(model, data, (frame_id, placement), at_frame(model, (frame_id,))[0], None)
    where, reference = split(tuple(x for x in (frame_id, placement) if x is not None), reference_frame)
    key, frame = at_frame(model, where)
    q = data.require(data._q_of_jacobians, "computeJointJacobians(model, data, q)")
    return _jacobian(model, data, reference, key, frame)(q)


def _bind_at(model: Model, data: Data, place: tuple[Any, ...], key: Any, given: Frame | None) -> Floats:
    """The Jacobian of a frame in a reference, the second of `place`, computed and bound for the next time."""
    reference = reference_of(place[1])
    q = data.require(data._q_of_jacobians, "computeJointJacobians(model, data, q)")
    watch = model.watched("shape" if given is not None else "frame", key)  # before the engine: see `run`
    engine = data.attach(model)
    if model.nvExtended != model.nv:  # columns of mimic joints are not told apart in `data.J`
        return _jacobian(model, data, reference, key, given)(q)

    def build(tower: TowerModel, frames: Sequence[Frame]) -> Any:
        frame = frames[key] if given is None else given

        def run(J: Array, T: Array) -> tuple[Array, Array]:
            of = spatial.SE3(T[:3, :3], T[:3, 3])
            return algorithms.frame_jacobian_of(tower, J, of, frame, reference), (
                of @ frame.placement
            ).matrix()

        return run

    kernel = engine.living(engine.of_frame(("J of", key, reference), build, J=(6, model.nv), T=(4, 4)))
    joint = model.frames[key].parentJoint if given is None else given.joint + 1
    placed = data._blocks["oMf"][key] if given is None else np.empty((4, 4))
    read = data._blocks["J"], data._blocks["oMi"][joint]
    step = Scratch(kernel, unread(kernel, watch), [placed], read).call
    data._run_at[place] = step, place[1]
    return step()


def computeFrameJacobian(
    model: Model, data: Data, q: Any, frame_id: int, reference_frame: Any = LOCAL
) -> Floats:
    """The Jacobian (6, nv) of a frame at q."""
    place = (frame_id, reference_frame, "at q")
    try:
        step, told = data._run_at[place]
    except (KeyError, TypeError):
        step = told = refuse
    if told is reference_frame and data._model is model:  # 0 equals WORLD, and is refused
        found = step(q)
        if found is not NotImplemented:
            return found
    return _at(model, data, place, at_frame(model, (frame_id,))[0], None, q)


def _at(model: Model, data: Data, place: tuple[Any, ...], key: Any, given: Frame | None, q: Any) -> Floats:
    """The Jacobian at q of a frame in a reference, the second of `place`, computed and bound for the next time."""
    reference = reference_of(place[1])

    def build(tower: TowerModel, frames: Sequence[Frame]) -> Any:
        frame = given or frames[key]

        def run(q: Array) -> tuple[Array, ...]:
            J = algorithms.frame_jacobian(tower, q, frame, reference)
            return (J,) if reference == "local" else (J, stacked(algorithms.joint_poses(tower, q)), q)

        return run

    return run_at(model, data, _HERE_J if reference == "local" else _PLACED_J, place, key, build, q)


def _jacobian(model: Model, data: Data, reference: Reference, key: Any, given: Frame | None) -> Any:
    engine = engine_for(model, data)

    def build(tower: TowerModel, frames: Sequence[Frame]) -> Any:
        frame = frames[key] if given is None else given
        return lambda q: algorithms.frame_jacobian(tower, q, frame, reference)

    return engine.of_frame(("J", key, reference), build, q=(model.nq,))


# time derivatives and Hessians --------------------------------------------------------------------------


def computeJointJacobiansTimeVariation(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """Fills `data.dJ` (columns in WORLD) and `data.J`; returns dJ (6, nv)."""
    step = data._run.joint_rates
    dJ = step(q, v) if data._model is model else NotImplemented
    if dJ is NotImplemented:
        dJ = run(model, data, _DJ, q, v)
    return dJ


def getJointJacobianTimeVariation(
    model: Model, data: Data, joint_id: int, reference_frame: Any = LOCAL
) -> Floats:
    """The time derivative (6, nv) of a joint's Jacobian, after computeJointJacobiansTimeVariation."""
    place = (joint_id, reference_frame, "joint dJ")
    found = _known(model, data, place)
    if found is NotImplemented:
        joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) gives one.")
        found = _bind_dot(model, data, place, ("joint", joint), at_joint(joint))
    return found


def getFrameJacobianTimeVariation(
    model: Model, data: Data, frame_id: int, reference_frame: Any = LOCAL
) -> Floats:
    """The time derivative (6, nv) of a frame's Jacobian, after computeJointJacobiansTimeVariation."""
    place = (frame_id, reference_frame, "dJ")
    found = _known(model, data, place)
    if found is NotImplemented:
        found = _bind_dot(model, data, place, at_frame(model, (frame_id,))[0], None)
    updateFramePlacement(model, data, frame_id)
    return found


def frameJacobianTimeVariation(
    model: Model, data: Data, q: Any, v: Any, frame_id: int, reference_frame: Any = LOCAL
) -> Floats:
    """The time derivative (6, nv) of a frame's Jacobian."""
    computeJointJacobiansTimeVariation(model, data, q, v)
    updateFramePlacements(model, data)
    return getFrameJacobianTimeVariation(model, data, frame_id, reference_frame)


def _known(model: Model, data: Data, place: tuple[Any, ...]) -> Any:
    """What was asked for before, in a reference that is second of `place`, is one native call."""
    try:
        step, told = data._run_at[place]
    except (KeyError, TypeError):
        return NotImplemented
    return step() if told is place[1] and data._model is model else NotImplemented  # 0 equals WORLD


def _bind_dot(model: Model, data: Data, place: tuple[Any, ...], key: Any, given: Frame | None) -> Floats:
    """The time derivative of the Jacobian of a frame, computed and bound for the next time; see `_bind_at`."""
    reference = reference_of(place[1])
    read = data.require(data._qv_of_jacobians, "computeJointJacobiansTimeVariation(model, data, q, v)")
    watch = model.watched("places") + ([] if given is not None else model.watched("frame", key))
    engine = data.attach(model)

    def build(tower: TowerModel, frames: Sequence[Frame]) -> Any:
        frame = given or frames[key]
        return lambda q, v: algorithms.frame_jacobian_dot(tower, q, v, frame, reference)

    shapes: dict[str, Any] = {"q": (model.nq,), "v": (model.nv,)}
    kernel = engine.living(engine.of_frame(("dJ", key, reference), build, **shapes))
    step = Scratch(kernel, unread(kernel, watch), given=read).call
    data._run_at[place] = step, place[1]
    return step()


def computeJointKinematicHessians(model: Model, data: Data, q: Any = None) -> None:
    """Prepares getJointKinematicHessian and getFrameKinematicHessian."""
    computeJointJacobians(model, data, q)


def getJointKinematicHessian(model: Model, data: Data, joint_id: int, reference_frame: Any = LOCAL) -> Floats:
    """The derivative (6, nv, nv) of a joint's Jacobian by q; [:, j, k] is that of column j by entry k."""
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) gives one.")
    return _hessian(model, data, reference_of(reference_frame), ("joint", joint), at_joint(joint))


def getFrameKinematicHessian(model: Model, data: Data, frame_id: int, reference_frame: Any = LOCAL) -> Floats:
    """The derivative (6, nv, nv) of a frame's Jacobian by q; see `getJointKinematicHessian`."""
    key, _ = at_frame(model, (frame_id,))
    return _hessian(model, data, reference_of(reference_frame), key, None)


def _hessian(model: Model, data: Data, reference: Reference, key: Any, given: Frame | None) -> Floats:
    q = data.require(data._q_of_jacobians, "computeJointKinematicHessians(model, data, q)")

    def build(tower: TowerModel, frames: Sequence[Frame]) -> Any:
        frame = frames[key] if given is None else given
        return lambda q: algorithms.frame_hessian(tower, q, frame, reference)

    found = engine_for(model, data).of_frame(("H", key, reference), build, q=(model.nq,))(q)
    return np.ascontiguousarray(np.moveaxis(found, 0, 2))
