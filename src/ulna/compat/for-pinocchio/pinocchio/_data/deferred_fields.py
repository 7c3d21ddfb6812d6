"""Fields of a Data that are computed when they are read: from which state, and how."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pinocchio._data.algorithm import Deferred
from pinocchio._data.evaluated_model import EvaluatedModel
from pinocchio._data.states import FieldStates
from pinocchio._model.compiled_model import CompiledModel
from pinocchio._tables import deferred as by_table
from pinocchio._tables.evaluation import TableEvaluator
from pinocchio._tables.joint_table import UnknownKind
from ulna import algorithms, spatial
from ulna.model import Model as CoreModel
from ulna.quantities.mass import with_mass
from ulna.typing import Array, Floats

_CENTER_FUNCTIONS = {
    "com": "center_of_mass",
    "vcom": "center_of_mass_velocity",
    "acom": "center_of_mass_acceleration",
}


def stacked(poses: Sequence[spatial.SE3]) -> Array:
    """Placements as one array (n, 4, 4)."""
    return np.stack([T.matrix() for T in poses]) if poses else np.zeros((0, 4, 4))


def rows(motions: Sequence[Any]) -> Array:
    """Motions or forces as one array (n, 6)."""
    return np.stack([m.vector() for m in motions]) if motions else np.zeros((0, 6))


def split_forces(F: Array) -> list[spatial.Force | None]:
    """Rows of an array as forces on joints."""
    return [spatial.Force(F[k, :3], F[k, 3:]) for k in range(F.shape[0])]


def _compiled(
    inputs: str,
    functions: Callable[..., dict[str, Any]],
    by_table: Callable[..., dict[str, Floats]] | None = None,
    universe_is_filled: bool = False,
) -> Deferred:
    """Fields that `functions(model, *inputs, forces)` computes: a function without arguments for each field.

    `by_table` computes them for a model that is evaluated. The first row, of the universe, is set here, unless an
    algorithm fills it.
    """
    state_size = len(inputs.rstrip("f"))

    def fill(
        data: FieldStates, compiled: CompiledModel | EvaluatedModel, fields: tuple[str, ...], *state: Floats
    ) -> None:
        def build(core: CoreModel) -> Any:
            def run(*args: Array) -> tuple[Array, ...]:
                forces = split_forces(args[-1]) if len(args) > state_size else None
                field_functions = functions(core, *args[:state_size], forces)
                return tuple(field_functions[field]() for field in fields)

            return run

        evaluator = _evaluator(data, compiled) if by_table else None
        if by_table and evaluator:
            computed = by_table(evaluator, *state)
            results = tuple(computed[field] for field in fields)
        else:
            shapes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(state)}
            results = compiled.compile((functions, fields, len(state)), build, **shapes)(*state)
        for field, values in zip(fields, results, strict=True):
            data._target(field)[...] = values
            if field in BODIES and not universe_is_filled:
                data._arrays[field][0] = 0.0
            if field in ("a_gf", "oa_gf"):
                data._arrays[field][0, :3] = -compiled.gravity

    return Deferred(inputs, fill)


def _evaluator(data: FieldStates, compiled: Any) -> TableEvaluator | None:
    """The evaluator for a model that is evaluated; None for others, and where a table does not have its joints."""
    try:
        return compiled.evaluator(data) if isinstance(compiled, EvaluatedModel) else None
    except UnknownKind:
        return None


def defer_joint_placements(
    data: FieldStates, compiled: CompiledModel, q: Floats, v: Floats | None = None
) -> None:
    """Defers the joints' placements in their parents, and stores the state of the joints.

    Args:
        v: Velocity (nv,) [rad/s or m/s]; None for none.
    """
    data._defer(JOINTS["liMi"], ("liMi",), compiled, q.copy())
    data._q_of_joints = q
    if v is not None:
        data._qv_of_joints = q, v


def _joint_placements(model: CoreModel, q: Array, _: Any) -> dict[str, Any]:
    return {"liMi": lambda: joint_placements(model, q)}


def joint_placements(model: CoreModel, q: Array) -> Array:
    """Each joint in the frame of the joint before it, (n, 4, 4).

    Args:
        model: Ulna's model.

    Returns:
        Poses (n, 4, 4).
    """
    return stacked([j.placement @ j.kind.transform(j.q_of(q)) for j in model.joints])


def _body_velocities(model: CoreModel, q: Array, v: Array, _: Any) -> dict[str, Any]:
    velocities = algorithms.joint_velocities(model, q, v)
    poses = algorithms.joint_poses(model, q)
    momenta = [i.apply(V) for i, V in zip(model.inertias, velocities, strict=True)]
    carried = {"ov": lambda: _in_world(poses, velocities), "oh": lambda: _in_world(poses, momenta)}
    return {"v": lambda: rows(velocities), **carried}


def _body_accelerations(model: CoreModel, q: Array, v: Array, a: Array, _: Any) -> dict[str, Any]:
    accelerations = algorithms.joint_accelerations(model, q, v, a)
    poses = algorithms.joint_poses(model, q)
    return {"a": lambda: rows(accelerations), "oa": lambda: _in_world(poses, accelerations)}


def _body_dynamics(model: CoreModel, q: Array, v: Array, a: Array, forces: Any) -> dict[str, Any]:
    lift = spatial.Motion(-np.asarray(model.gravity), np.zeros(3))
    poses = algorithms.joint_poses(model, q)
    velocities = algorithms.joint_velocities(model, q, v)
    accelerations = algorithms.joint_accelerations(model, q, v, a)
    relative_to_free_fall = [A + T.act_inverse(lift) for A, T in zip(accelerations, poses, strict=True)]
    momenta = [i.apply(V) for i, V in zip(model.inertias, velocities, strict=True)]

    def wrenches() -> list[Any]:
        return algorithms.joint_wrenches(model, q, v, a, forces)

    return {
        "v": lambda: rows(velocities),
        "a_gf": lambda: rows(relative_to_free_fall),
        "f": lambda: rows(wrenches()),
        "h": lambda: rows(momenta),
        "ov": lambda: _in_world(poses, velocities),
        "oa": lambda: _in_world(poses, accelerations),
        "oa_gf": lambda: _in_world(poses, relative_to_free_fall),
        "of": lambda: _in_world(poses, wrenches()),
        "oh": lambda: _in_world(poses, momenta),
    }


def _body_statics(model: CoreModel, q: Array, forces: Any) -> dict[str, Any]:
    """Accelerations relative to free fall, and forces, at rest under forces on the joints."""
    rest = np.zeros(model.nv)
    fields = _body_dynamics(model, q, rest, rest, forces)
    return {name: fields[name] for name in ("a_gf", "f", "oa_gf", "of")}


def _in_world(poses: Sequence[spatial.SE3], vectors: Sequence[Any]) -> Array:
    """From the joints' frames into the world's."""
    return rows([T.act(one) for T, one in zip(poses, vectors, strict=True)])


def _subtree_momenta(model: CoreModel, q: Array, v: Array, a: Array, _: Any) -> dict[str, Any]:
    """Momenta and their rates of all that each joint moves."""
    poses = algorithms.joint_poses(model, q)
    velocities = algorithms.joint_velocities(model, q, v)
    momenta = [i.apply(V) for i, V in zip(model.inertias, velocities, strict=True)]
    accelerations = algorithms.joint_accelerations(model, q, v, a)
    rates = [
        i.apply(A) + V.cross(h)
        for i, V, A, h in zip(model.inertias, velocities, accelerations, momenta, strict=True)
    ]

    def subtree_sums(vectors: Sequence[Any], local: bool) -> Array:
        sums = [T.act(one) for T, one in zip(poses, vectors, strict=True)]
        for k in reversed(range(len(sums))):
            if model.joints[k].parent >= 0:
                sums[model.joints[k].parent] += sums[k]
        return rows([T.act_inverse(one) for T, one in zip(poses, sums, strict=True)] if local else sums)

    return {
        "h": lambda: subtree_sums(momenta, True),
        "f": lambda: subtree_sums(rates, True),
        "oh": lambda: subtree_sums(momenta, False),
        "of": lambda: subtree_sums(rates, False),
    }


def _derivatives(model: CoreModel, q: Array, v: Array, a: Array, forces: Any) -> dict[str, Any]:
    by_q, by_v, _ = algorithms.inverse_dynamics_derivatives(model, q, v, a, forces)
    return {"dtau_dq": lambda: by_q, "dtau_dv": lambda: by_v}


def _map(model: CoreModel, q: Array, _: Any) -> dict[str, Any]:
    return {"Ag": lambda: algorithms.centroidal_matrix(model, q)}


def _inverse_mass(model: CoreModel, q: Array, _: Any) -> dict[str, Any]:
    return {"Minv": lambda: with_mass(_inverse_of)(model)(q)}


def _inverse_of(model: CoreModel) -> Any:
    return lambda q: algorithms.inverse_mass_matrix(model, q)


def _subtree_centers(
    data: FieldStates, compiled: CompiledModel, fields: tuple[str, ...], *state: Floats
) -> None:
    """The centre of mass of the subtree of each joint, its velocity and acceleration, in the joint's frame."""
    if evaluator := _evaluator(data, compiled):
        centers = by_table.subtree_centers(evaluator, *state)
        for field in fields:
            has_mass = by_table.subtree_masses(evaluator)[1:] > 0.0
            data._arrays[field][1:][has_mass] = centers[field][has_mass]
        return
    core = compiled.model
    poses = algorithms.joint_poses(core, state[0])
    for field in fields:
        inputs = state[: list(_CENTER_FUNCTIONS).index(field) + 1]
        for i, (joint, pose) in enumerate(zip(core.joints, poses, strict=True), start=1):
            if algorithms.total_mass(core, joint.name) > 0.0:
                x = compiled.kernel(_CENTER_FUNCTIONS[field], subtree=joint.name)(*inputs)
                data._arrays[field][i] = pose.rotation.T @ (x - pose.translation if field == "com" else x)


def _subtree_masses(data: FieldStates, compiled: CompiledModel, fields: tuple[str, ...]) -> None:
    """The mass of the subtree of each joint; that of the universe, first, leaves out its own body."""
    if evaluator := _evaluator(data, compiled):
        masses = evaluator.of_joints(evaluator.inertias[:, :1])[:, 0].tolist()
    else:
        masses = [float(inertia.mass) for inertia in compiled.model.inertias]
    sums, parents = [0.0, *masses], data._model.parents
    for i in range(len(masses), 0, -1):
        sums[parents[i]] += sums[i]
    list.__setitem__(data.mass, slice(None), sums)


JOINTS = {"liMi": _compiled("q", _joint_placements, by_table.joint_placements)}
_BODY_DYNAMICS = _compiled("qva", _body_dynamics, by_table.dynamics)
_ACCELERATIONS = _compiled("qva", _body_accelerations, by_table.accelerations)
_VELOCITIES = _compiled("qv", _body_velocities, by_table.velocities)
VELOCITIES = dict.fromkeys(("v", "ov"), _VELOCITIES)
VELOCITIES_IN_WORLD = {"ov": _VELOCITIES}
BODY_MOMENTA_IN_WORLD = {"oh": _VELOCITIES}
ACCELERATIONS = dict.fromkeys(("a", "oa"), _ACCELERATIONS)
ACCELERATIONS_IN_WORLD = {"oa": _ACCELERATIONS}
BODY_FORCES = dict.fromkeys(("a_gf", "f", "oa_gf", "of"), _BODY_DYNAMICS)
"""Accelerations relative to free fall, and the forces through the joints."""
BODY_FORCES_AT_REST = dict.fromkeys(BODY_FORCES, _compiled("qf", _body_statics, by_table.statics))
"""The same at rest, where forces act on the joints."""
BODY_FORCES_BELOW_TOTAL = {
    **BODY_FORCES,
    "f": _compiled("qva", _body_dynamics, by_table.dynamics, universe_is_filled=True),
}
"""The same, where `f[0]` is filled by the algorithm."""
BODIES = {**VELOCITIES, **dict.fromkeys(("h", "oh"), _BODY_DYNAMICS), **BODY_FORCES}
"""The same, with velocities and momenta."""
BODIES_UNDER_FORCES = dict.fromkeys(BODIES, _compiled("qvaf", _body_dynamics, by_table.dynamics))
"""The same, where forces act on the joints."""
_SUBTREE_MOMENTA = _compiled("qva", _subtree_momenta, by_table.subtree_momenta, universe_is_filled=True)
SUBTREE_MOMENTA = {"h": _SUBTREE_MOMENTA}
SUBTREE_MOMENTA_AND_RATES = dict.fromkeys(("h", "f"), _SUBTREE_MOMENTA)
SUBTREE_MOMENTA_IN_WORLD = dict.fromkeys(("oh", "of"), _SUBTREE_MOMENTA)
TORQUE_DERIVATIVES = dict.fromkeys(("dtau_dq", "dtau_dv"), _compiled("qva", _derivatives))
TORQUE_DERIVATIVES_UNDER_FORCES = dict.fromkeys(TORQUE_DERIVATIVES, _compiled("qvaf", _derivatives))
CENTROIDAL_MAP = {"Ag": _compiled("q", _map)}
INVERSE_MASS = {"Minv": _compiled("q", _inverse_mass)}
MASSES = {"mass": Deferred("", _subtree_masses)}
CENTERS = {"com": Deferred("q", _subtree_centers), **MASSES}
CENTERS_AND_VELOCITIES = {**CENTERS, "vcom": Deferred("qv", _subtree_centers)}
CENTERS_TO_ACCELERATIONS = {**CENTERS_AND_VELOCITIES, "acom": Deferred("qva", _subtree_centers)}
