"""Fields of a Data that are computed when they are read: from which state, and how."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pinocchio._data.algorithm import Deferred
from pinocchio._data.articulated_bodies import ARTICULATED, ARTICULATED_AS_READ
from pinocchio._data.compiled_fields import CompiledFields, table_of
from pinocchio._data.states import FieldStates
from pinocchio._model.compiled_model import CompiledModel
from pinocchio._tables import deferred as by_table
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


def _compiled(
    inputs: str,
    functions: Callable[..., dict[str, Any]],
    by_table: Callable[..., dict[str, Floats]] | None = None,
    totals: tuple[str, ...] = (),
    is_of_subtrees: bool = False,
) -> Deferred:
    return CompiledFields(inputs, functions, by_table, totals, is_of_subtrees).deferred()


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

    def on_the_base() -> Array:
        joints = zip(model.joints, poses, wrenches(), strict=True)
        zero = spatial.Force(np.zeros(3), np.zeros(3))
        return sum((T.act(F) for joint, T, F in joints if joint.parent < 0), zero).vector()

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
        "f[0]": on_the_base,
        "of[0]": on_the_base,
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

    def in_world(vectors: Sequence[Any]) -> list[Any]:
        return _subtree_sums(model, [T.act(one) for T, one in zip(poses, vectors, strict=True)])

    def local(vectors: Sequence[Any]) -> Array:
        return rows([T.act_inverse(one) for T, one in zip(poses, in_world(vectors), strict=True)])

    return {
        "h": lambda: local(momenta),
        "f": lambda: local(rates),
        "oh": lambda: rows(in_world(momenta)),
        "of": lambda: rows(in_world(rates)),
    }


def _subtree_sums(model: CoreModel, values: Sequence[Any]) -> list[Any]:
    """For each joint the sum of the values of all bodies that it moves."""
    sums = [*values]
    for k in reversed(range(len(sums))):
        parent = model.joints[k].parent
        if parent >= 0:
            sums[parent] = sums[parent] + sums[k]
    return sums


def _centers(model: CoreModel, q: Array, *rates: Any) -> dict[str, Any]:
    """The centre of mass of what each joint moves, its velocity and acceleration, in the joint's frame."""
    v, a, *_ = *rates[:-1], *np.zeros((2, model.nv))
    masses = _subtree_sums(model, [inertia.mass for inertia in model.inertias])

    def positions() -> Array:
        poses = algorithms.joint_poses(model, q)
        bodies = zip(model.inertias, poses, strict=True)
        moments = [body.mass * (T.rotation @ body.com + T.translation) for body, T in bodies]
        sums = zip(poses, _subtree_sums(model, moments), masses, strict=True)
        return np.stack([T.rotation.T @ (moment / mass - T.translation) for T, moment, mass in sums])

    def per_mass(field: str) -> Array:
        momenta = _subtree_momenta(model, q, v, a, None)[field]()
        return np.stack([momenta[k, :3] / mass for k, mass in enumerate(masses)])

    return {"com": positions, "vcom": lambda: per_mass("h"), "acom": lambda: per_mass("f")}


def _derivatives(model: CoreModel, q: Array, v: Array, a: Array, forces: Any) -> dict[str, Any]:
    by_q, by_v, _ = algorithms.inverse_dynamics_derivatives(model, q, v, a, forces)
    return {"dtau_dq": lambda: by_q, "dtau_dv": lambda: by_v}


def _map(model: CoreModel, q: Array, _: Any) -> dict[str, Any]:
    return {"Ag": lambda: algorithms.centroidal_matrix(model, q)}


def _inverse_mass(model: CoreModel, q: Array, _: Any) -> dict[str, Any]:
    return {"Minv": lambda: with_mass(_inverse_of)(model)(q)}


def _inverse_of(model: CoreModel) -> Any:
    return lambda q: algorithms.inverse_mass_matrix(model, q)


def _centers_with_mass(
    data: FieldStates, compiled: CompiledModel, fields: tuple[str, ...], *state: Floats
) -> None:
    """The same, subtree by subtree; those without mass keep what they have."""
    if evaluator := table_of(data, compiled):
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


def _subtree_centers(inputs: str) -> Deferred:
    """Centres of mass: by one kernel, where every joint moves some mass."""
    whole = _compiled(inputs, _centers)

    def has_mass(compiled: Any) -> bool:
        if not isinstance(compiled, CompiledModel):
            return False
        core = compiled.model
        return min(_subtree_sums(core, [float(inertia.mass) for inertia in core.inertias]), default=0.0) > 0.0

    def fill(data: FieldStates, compiled: Any, fields: tuple[str, ...], *state: Floats) -> None:
        (whole.fill if has_mass(compiled) else _centers_with_mass)(data, compiled, fields, *state)

    def bind(data: FieldStates, number: int, compiled: Any, *rest: Any) -> Any:
        assert whole.bind is not None
        constant = not getattr(compiled, "parameter_names", ())
        return whole.bind(data, number, compiled, *rest) if constant and has_mass(compiled) else None

    return Deferred(inputs, fill, bind)


def _subtree_masses(data: FieldStates, compiled: CompiledModel, fields: tuple[str, ...]) -> None:
    """The mass of the subtree of each joint; that of the universe, first, leaves out its own body."""
    if evaluator := table_of(data, compiled):
        masses = evaluator.of_joints(evaluator.inertias[:, :1])[:, 0].tolist()
    else:
        masses = [float(inertia.mass) for inertia in compiled.model.inertias]
    sums, parents = [0.0, *masses], data._model.parents
    for i in range(len(masses), 0, -1):
        sums[parents[i]] += sums[i]
    list.__setitem__(data.mass, slice(None), sums)
    data._arrays["mass changes"][...] = 0.0


_PLACEMENTS = {"liMi": _compiled("q", _joint_placements, by_table.joint_placements)}
JOINTS = _PLACEMENTS | ARTICULATED
JOINTS_AFTER_KINEMATICS = _PLACEMENTS | ARTICULATED_AS_READ
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
BODIES = {**VELOCITIES, **dict.fromkeys(("h", "oh"), _BODY_DYNAMICS), **BODY_FORCES}
"""The same, with velocities and momenta."""
BODIES_UNDER_FORCES = dict.fromkeys(BODIES, _compiled("qvaf", _body_dynamics, by_table.dynamics))
"""The same, where forces act on the joints."""
_WITH_TOTAL = ("f", "of")
BODIES_AND_BASE = dict.fromkeys(BODIES, _compiled("qva", _body_dynamics, by_table.dynamics, _WITH_TOTAL))
"""Those of `BODIES`; `f[0]` and `of[0]` are the force of the base on all joints that stand on it."""
BODIES_AND_BASE_UNDER_FORCES = dict.fromkeys(
    BODIES, _compiled("qvaf", _body_dynamics, by_table.dynamics, _WITH_TOTAL)
)
"""The same, where forces act on the joints."""
_SUBTREE_MOMENTA = _compiled("qva", _subtree_momenta, by_table.subtree_momenta, is_of_subtrees=True)
SUBTREE_MOMENTA = {"h": _SUBTREE_MOMENTA}
SUBTREE_MOMENTA_AND_RATES = dict.fromkeys(("h", "f"), _SUBTREE_MOMENTA)
SUBTREE_MOMENTA_IN_WORLD = dict.fromkeys(("oh", "of"), _SUBTREE_MOMENTA)
TORQUE_DERIVATIVES = dict.fromkeys(("dtau_dq", "dtau_dv"), _compiled("qva", _derivatives))
TORQUE_DERIVATIVES_UNDER_FORCES = dict.fromkeys(TORQUE_DERIVATIVES, _compiled("qvaf", _derivatives))
CENTROIDAL_MAP = {"Ag": _compiled("q", _map)}
INVERSE_MASS = {"Minv": _compiled("q", _inverse_mass)}
MASSES = {"mass": Deferred("", _subtree_masses)}
CENTERS = {"com": _subtree_centers("q"), **MASSES}
CENTERS_AND_VELOCITIES = {**CENTERS, "vcom": _subtree_centers("qv")}
CENTERS_TO_ACCELERATIONS = {**CENTERS_AND_VELOCITIES, "acom": _subtree_centers("qva")}
