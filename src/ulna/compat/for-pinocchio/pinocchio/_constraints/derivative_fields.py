"""Intermediate results of derivatives under constraints, computed when they are read.

They belong to the state, and to the numbers of the model, of the call that made the derivatives.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._constraints.kernels import core_constraints, flat
from pinocchio._data.algorithm import Deferred
from pinocchio._data.evaluated_model import EvaluatedModel, loaded_with
from pinocchio._data.states import FieldStates
from pinocchio._model.compiled_model import CompiledModel
from pinocchio._tables import deferred as by_table
from pinocchio._tables import recursions as r
from pinocchio._tables.world_derivatives import WorldDerivatives
from ulna.algorithms.constraints.dynamics_derivatives import bound_terms
from ulna.algorithms.constraints.frame_errors import frame_of
from ulna.algorithms.derivatives.velocity import frame_velocity_derivatives
from ulna.algorithms.kinematics.forward_kinematics import frame_pose, frame_velocity
from ulna.model import Model as CoreModel
from ulna.model.constraint import End, FramePair
from ulna.numeric import skew
from ulna.spatial import SE3
from ulna.typing import Floats

_Compiled = CompiledModel | EvaluatedModel


def forces_on_joints(shapes: Any, places: Floats, forces: Floats, poses: Floats) -> Floats:
    """The forces of constraints on the joints, in the joints' frames.

    Args:
        shapes: For each constraint its rows, whether they are local, and its two joints.
        places: Both placements (c, 2, 4, 4) of each constraint.
        forces: The forces (m,) along the axes of their constraints [N, N m].
        poses: The placements of the joints in the world, the universe first (njoints, 4, 4).

    Returns:
        Forces and moments (njoints, 6), the universe first [N, N m].
    """
    out, start = np.zeros((len(poses), 6)), 0
    for (size, local, *joints), ends in zip(shapes, places, strict=True):
        wrench = np.zeros(6)
        wrench[:size] = forces[start : start + size]
        start += size
        frames = [poses[joint] @ end for joint, end in zip(joints, ends, strict=True)]
        axes = frames[0][:3, :3] if local else np.eye(3)
        for sign, joint, frame in zip((1.0, -1.0), joints, frames, strict=True):
            R, lever = poses[joint][:3, :3], (frames[0] if size == 6 else frame)[:3, 3] - poses[joint][:3, 3]
            linear, moment = axes @ wrench[:3], axes @ wrench[3:]
            out[joint] += sign * np.concatenate([linear @ R, (moment + np.cross(lever, linear)) @ R])
    return out


def _along_constraints(data: FieldStates, compiled: _Compiled, fields: tuple[str, ...]) -> None:
    """How accelerations along the constraints change by q and v, with those of the joints as they are."""
    derived = data._motion_derivatives
    q, v, placements, gains, desired, a, forces, *_ = derived.at
    pairs, wanted = core_constraints(derived.shapes, placements), flat(desired, derived.shapes)
    terms = bound_terms(compiled.model, q, v, a, forces, gains, wanted, pairs)
    for name in fields:
        data._arrays[name] = terms.X @ (terms.g_q if name == "dac_dq" else terms.g_v)


def _velocities(data: FieldStates, compiled: _Compiled, _: tuple[str, ...]) -> None:
    """How velocities along the constraints change by q."""
    _fill_velocities(data, compiled, data._motion_derivatives)


def _velocities_of_impact(data: FieldStates, compiled: _Compiled, _: tuple[str, ...]) -> None:
    """How velocities along the constraints before the impact change by q."""
    _fill_velocities(data, compiled, data._impact_derivatives)


def _fill_velocities(data: FieldStates, compiled: _Compiled, derived: Any) -> None:
    q, v, placements = derived.at[:3]
    pairs = core_constraints(derived.shapes, placements)
    data._arrays["dvc_dq"] = np.concatenate([_velocity_by_q(compiled.model, q, v, pair) for pair in pairs])


def _velocity_by_q(model: CoreModel, q: Floats, v: Floats, pair: FramePair) -> Floats:
    """The difference of what both frames' velocities change by; of points along axes that turn with their own bodies.

    Six rows are of both bodies where the first frame is, along its axes or those of the world: J(q) v by q.

    Args:
        model: Ulna's model.
        pair: The constraint.

    Returns:
        The derivatives (rows, nv).
    """
    assert pair.second is not None
    whole = pair.size == 6
    T = frame_pose(model, q, frame_of(pair.first))
    on = frame_pose(model, q, frame_of(End(pair.second.joint, SE3.identity()))).inverse() @ T
    second = End(pair.second.joint, on if whole else SE3(on.rotation, pair.second.placement.translation))
    sides = []
    for frame in (frame_of(pair.first), frame_of(second)):
        V = frame_velocity(model, q, v, frame, "local")
        by_q, by_v = frame_velocity_derivatives(model, q, v, frame)
        if not pair.local:
            parts = zip(np.split(by_q, 2), (V.linear, V.angular), strict=True)
            by_q = np.concatenate([T.rotation @ (rows - skew(u) @ by_v[3:]) for rows, u in parts])
        sides.append((V, by_q, by_v))
    (_, one, S), (V, other, before) = sides
    if whole and pair.local:
        other = other + V.cross_matrix() @ (S - before)
    elif whole:  # the place moves along the second body
        moved = T.rotation @ skew(V.angular) @ (S - before)[:3]
        other = other + np.concatenate([moved, np.zeros_like(moved)])
    return (one - other)[: pair.size]


def _torques(data: FieldStates, compiled: _Compiled, fields: tuple[str, ...]) -> None:
    """The torques that would take back what q and v change of the accelerations."""
    _fill_torques(data, compiled, fields, data._motion_derivatives)


def _fill_torques(data: FieldStates, compiled: _Compiled, fields: tuple[str, ...], derived: Any) -> None:
    M = compiled.kernel("mass_matrix")(derived.at[0])
    n = len(M)
    columns = {"dtau_dq": slice(0, n), "dtau_dv": slice(n, 2 * n)}
    for name in fields:
        data._arrays[name][...] = -M @ derived.solution[:n, columns[name]]


def _forces(data: FieldStates, compiled: _Compiled, fields: tuple[str, ...]) -> None:
    """The forces through the joints, those of constraints being external ones, and how they change by q and v.

    The universe's is what all weighs and is accelerated by without accelerations of the joints, as constraintDynamics
    left it.
    """
    derived = data._motion_derivatives
    q, v, placements, _, _, a, forces, *_ = derived.at
    evaluator = loaded_with(compiled, data)
    evaluator.run(r.PLACEMENTS, q)
    poses = np.concatenate([np.eye(4)[None], evaluator.placements()])
    F = forces_on_joints(derived.shapes, placements, forces, poses)[1:]
    if "of" in fields:
        data._target("of")[...] = by_table.dynamics(evaluator, q, v, a, F)["of"]
        data._arrays["of"][0] = _total(data, by_table.dynamics(evaluator, q, v)["of"])
    derivatives = WorldDerivatives(evaluator, q, v, a, F)
    if "dFdq" in fields:
        data._arrays["dFdq"][...] = evaluator.by_entries(derivatives.forces_by_configuration())
    if "dFdv" in fields:
        data._arrays["dFdv"][...] = evaluator.by_entries(derivatives.forces_by_velocity())


def _forces_at_rest(data: FieldStates, compiled: _Compiled, _: tuple[str, ...], q: Floats, v: Floats) -> None:
    """The forces through the joints without accelerations; the universe's is the sum over joints on it."""
    of = by_table.dynamics(loaded_with(compiled, data), q, v)["of"]
    data._target("of")[...] = of
    data._arrays["of"][0] = _total(data, of)


def _total(data: FieldStates, forces: Floats) -> Floats:
    """The sum of the forces (njoints - 1, 6) through the joints that are on the universe."""
    return forces[np.array(data._model.parents[1:]) == 0].sum(axis=0)


def _torques_of_impact(data: FieldStates, compiled: _Compiled, fields: tuple[str, ...]) -> None:
    """The impulses of joints that would take back what q changes of the jump of the velocity."""
    _fill_torques(data, compiled, fields, data._impact_derivatives)


def _impulses(data: FieldStates, compiled: _Compiled, fields: tuple[str, ...]) -> None:
    """The jumps of the velocities of joints, the impulses through them, and how both change by q."""
    derived = data._impact_derivatives
    q, _, placements, _, _, jump, impulses, *_ = derived.at
    evaluator = loaded_with(compiled, data)
    evaluator.run(r.PLACEMENTS, q)
    poses = np.concatenate([np.eye(4)[None], evaluator.placements()])
    F = forces_on_joints(derived.shapes, placements, impulses, poses)[1:]
    derivatives = WorldDerivatives(evaluator, q, None, jump, F)
    if "oa" in fields:
        data._target("oa")[...] = by_table.accelerations(evaluator, q, np.zeros_like(jump), jump)["oa"]
    if "of" in fields:
        data._target("of")[...] = evaluator.of_joints(derivatives.forces(falling=False))
    for name in ("oa", "of"):
        if name in fields:
            data._arrays[name][0] = 0.0
    if "dAdq" in fields:
        data._arrays["dAdq"][...] = evaluator.by_entries(derivatives.accelerations(False))
    if "dFdq" in fields:
        data._arrays["dFdq"][...] = evaluator.by_entries(derivatives.forces_by_configuration(False))


FORCES_AT_REST = {"of": Deferred("qv", _forces_at_rest)}
"""After constraintDynamics."""
DERIVATIVES = {
    **dict.fromkeys(("dac_dq", "dac_dv"), Deferred("", _along_constraints)),
    "dvc_dq": Deferred("", _velocities),
    **dict.fromkeys(("dtau_dq", "dtau_dv"), Deferred("", _torques)),
    **dict.fromkeys(("of", "dFdq", "dFdv"), Deferred("", _forces)),
}
"""After computeConstraintDynamicsDerivatives."""
IMPACT_DERIVATIVES = {
    "dvc_dq": Deferred("", _velocities_of_impact),
    "dtau_dq": Deferred("", _torques_of_impact),
    **dict.fromkeys(("oa", "of", "dAdq", "dFdq"), Deferred("", _impulses)),
}
"""After computeImpulseDynamicsDerivatives."""
