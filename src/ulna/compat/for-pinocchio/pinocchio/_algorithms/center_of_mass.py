"""Centre of mass, centroidal momentum, masses."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from pinocchio._algorithms.jacobians import JACOBIANS, columns
from pinocchio._algorithms.stored_sums import (
    CENTER_COLUMNS,
    MOMENTUM,
    MOMENTUM_RATE,
    columns_of_fields,
    subtree_columns,
)
from pinocchio._algorithms.stored_sums import CENTERS as FIELD_CENTERS
from pinocchio._containers.arguments import OMITTED, checked, checks_itself, wrong_model
from pinocchio._containers.arrays import index
from pinocchio._containers.enums import KinematicLevel
from pinocchio._containers.keywords import overloads
from pinocchio._data.algorithm import Algorithm
from pinocchio._data.binding import run
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import (
    ACCELERATIONS_IN_WORLD,
    CENTERS,
    CENTERS_AND_VELOCITIES,
    CENTERS_TO_ACCELERATIONS,
    JOINTS,
    MASSES,
    SUBTREE_MOMENTA,
    SUBTREE_MOMENTA_AND_RATES,
    VELOCITIES_IN_WORLD,
    rows,
    stacked,
)
from pinocchio._data.evaluated_model import NUMBER_CALLS
from pinocchio._data.first_evaluation import loaded_evaluator
from pinocchio._data.functions import algorithm, fast_path
from pinocchio._model.bound_kernels import BoundKernel
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Force
from pinocchio._tables.world_sums import WorldSums
from ulna import algorithms
from ulna.compiler.runtime.repeated_calls import call_cache, repeated_calls
from ulna.model import Model as CoreModel
from ulna.numeric import cross
from ulna.typing import Array, Floats

__all__ = [
    "ccrba",
    "centerOfMass",
    "computeCentroidalMap",
    "computeCentroidalMapTimeVariation",
    "computeCentroidalMomentum",
    "computeCentroidalMomentumTimeVariation",
    "computeSubtreeMasses",
    "computeTotalMass",
    "dccrba",
    "getJacobianSubtreeCenterOfMass",
    "jacobianCenterOfMass",
    "jacobianSubtreeCenterOfMass",
]


def _center(model: CoreModel) -> Any:
    return lambda q: (algorithms.center_of_mass(model, q), stacked(algorithms.joint_poses(model, q)))


def _center_velocity(model: CoreModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        velocities = rows(algorithms.joint_velocities(model, q, v))
        return *_center(model)(q), algorithms.center_of_mass_velocity(model, q, v), velocities

    return run


def _center_acceleration(model: CoreModel) -> Any:
    def run(q: Array, v: Array, a: Array) -> tuple[Array, ...]:
        accelerations = rows(algorithms.joint_accelerations(model, q, v, a))
        return (
            *_center_velocity(model)(q, v),
            algorithms.center_of_mass_acceleration(model, q, v, a),
            accelerations,
        )

    return run


def _center_and_columns(model: CoreModel) -> Any:
    return lambda q: (algorithms.center_of_mass(model, q), *columns(model)(q))


def _center_jacobian(model: CoreModel) -> Any:
    return lambda q: (algorithms.center_of_mass_jacobian(model, q), *_center_and_columns(model)(q))


_WITH_VELOCITY = JOINTS | VELOCITIES_IN_WORLD | CENTERS_AND_VELOCITIES
_CENTER_FIELDS = ("com[0]", "oMi")
_VELOCITY_FIELDS = (*_CENTER_FIELDS, "vcom[0]", "v")
_POSITION = Algorithm(
    "center", "q", _CENTER_FIELDS, _center, (0,), deferred=JOINTS | CENTERS, depends_on="masses"
)
_VELOCITY = Algorithm(
    "center_velocity",
    "qv",
    _VELOCITY_FIELDS,
    _center_velocity,
    (0,),
    deferred=_WITH_VELOCITY,
    depends_on="masses",
)
_ACCELERATION = Algorithm(
    "center_acceleration",
    "qva",
    (*_VELOCITY_FIELDS, "acom[0]", "a"),
    _center_acceleration,
    (0,),
    deferred=JOINTS | VELOCITIES_IN_WORLD | ACCELERATIONS_IN_WORLD | CENTERS_TO_ACCELERATIONS,
    depends_on="masses",
)


_center_calls, _center_calls_by_level = call_cache(2, weak=2), call_cache(3, weak=2)


@repeated_calls(_center_calls_by_level)
@fast_path(_POSITION, _VELOCITY, _ACCELERATION, calls=_center_calls)
@overloads(
    "model data kinematic_level:KinematicLevel compute_subtree_coms:bool?",
    "model data compute_subtree_coms:bool?",
    "model data q compute_subtree_coms:bool?",
    "model data q v compute_subtree_coms:bool?",
    "model data q v a compute_subtree_coms:bool?",
)
def centerOfMass(
    model: Model,
    data: Data,
    q: Any = None,
    v: Any = None,
    a: Any = None,
    compute_subtree_coms: bool = True,
    kinematic_level: Any = None,
) -> Floats:
    """The centre of mass in the world (3,) [m]; fills `data.com` and `data.mass`, with v `vcom`, with a `acom`.

    Args:
        q: Configuration (nq,) [rad or m]; None, or a KinematicLevel, for the state of the last forwardKinematics.
        v: Velocity (nv,).
        a: Acceleration (nv,).
        compute_subtree_coms: Values of subtrees are computed when they are read, whatever it says.
        kinematic_level: Up to which derivative the stored state is taken, in place of q.

    Returns:
        Position (3,) [m].
    """
    if q is None:
        return _of_stored_motions(model, data, kinematic_level)
    state = [x for x in (q, v, a) if x is not None]
    return run(model, data, (_POSITION, _VELOCITY, _ACCELERATION)[len(state) - 1], *state)


def _of_stored_motions(model: Model, data: Data, kinematic_level: Any) -> Floats:
    """The centre of mass out of fields of the Data, where motions are known up to a KinematicLevel that is given."""
    data._require(data._q, "forwardKinematics(model, data, q)")
    level = int(kinematic_level) if isinstance(kinematic_level, KinematicLevel) else 0
    states = [data._qv, data._qva]
    is_known = all(state is not None for state in states[:level])
    center = FIELD_CENTERS[level].run(model, data, _center_calls) if is_known else NotImplemented
    if center is NotImplemented:
        return data._require(None, "forwardKinematics(model, data, q, v, a)")
    data._known_states |= {"centers", "center_velocities"}
    if isinstance(kinematic_level, KinematicLevel):
        step = FIELD_CENTERS[level].step(model, data)
        _center_calls_by_level.add(step, 0, model, data, kinematic_level)
    return center


@algorithm(
    fills=("Jcom", "com[0]", *JACOBIANS),
    kernel=_center_jacobian,
    returns=(0,),
    deferred=JOINTS | CENTERS,
    depends_on="masses",
    default_state=("_q", "forwardKinematics(model, data, q)"),
    of_fields=partial(columns_of_fields, algorithm=CENTER_COLUMNS),
    calls=("model data compute_subtree_coms:bool?", "model data q compute_subtree_coms:bool?"),
)
def jacobianCenterOfMass(
    model: Model, data: Data, q: Any = None, compute_subtree_coms: bool = True
) -> Floats:
    """The Jacobian (3, nv) of the centre of mass; kept in `data.Jcom`.

    Args:
        compute_subtree_coms: Accepted; values of subtrees are computed when they are read.

    Returns:
        Jacobian (3, nv).
    """
    ...


_SUBTREE = Algorithm(
    "subtree_jacobian",
    "q",
    ("com[0]", *JACOBIANS),
    _center_and_columns,
    deferred=JOINTS | CENTERS,
    depends_on="masses",
    invalidates=("Jcom",),
    title="jacobianSubtreeCenterOfMass",
)


@fast_path(_SUBTREE)
def _center_and_jacobians(model: Model, data: Data, q: Any) -> None:
    run(model, data, _SUBTREE, q)


_subtree_calls_at_placements, _subtree_calls = (call_cache(3, weak=2) for _ in range(2))


@repeated_calls(_subtree_calls_at_placements)
@overloads("model data subtree_root_joint_id:int", "model data q subtree_root_joint_id:int")
def jacobianSubtreeCenterOfMass(
    model: Model, data: Data, q: Any = None, subtree_root_joint_id: int | None = None
) -> Floats:
    """The Jacobian (3, nv) of the centre of mass of what a joint moves.

    Args:
        q: Configuration (nq,); without it, that of the last forwardKinematics.
        subtree_root_joint_id: The index of the joint.

    Returns:
        Jacobian (3, nv).
    """
    if q is None:
        q = data._require(data._q, "forwardKinematics(model, data, q)")
        J = _of_fields(model, data, subtree_root_joint_id, True)
        if J is not NotImplemented:
            return J
    _center_and_jacobians(model, data, q)
    assert subtree_root_joint_id is not None  # every overload has it
    return _of_subtree(model, data, subtree_root_joint_id, data._arrays["placements q"])


@repeated_calls(_subtree_calls)
@checked
def getJacobianSubtreeCenterOfMass(model: Model, data: Data, subtree_root_joint_id: int) -> Floats:
    """The Jacobian of the centre of mass of what a joint moves, after jacobianCenterOfMass.

    Args:
        subtree_root_joint_id: Index of the joint.

    Returns:
        Jacobian (3, nv).
    """
    q = data._require(data._q_of_jacobians, "jacobianCenterOfMass(model, data, q)")
    J = _of_fields(model, data, subtree_root_joint_id, False)
    if J is not NotImplemented:
        return J
    return _of_subtree(model, data, subtree_root_joint_id, q)


def _of_fields(model: Model, data: Data, root: Any, is_anew: bool) -> Any:
    """The Jacobian out of fields of the Data, added to the cache of calls; NotImplemented where it does not apply."""
    joint = index(root, model.njoints, "joint", "model.getJointId(name) returns one.")
    algorithm = subtree_columns(joint, is_anew)
    step = algorithm.step(model, data)
    J = step()
    if J is NotImplemented:
        inertias = np.concatenate(model._parameter_blocks("inertias"))
        masses = [inertias[i, 0] for i in list(model.subtrees[joint]) if i]
        if model.nvExtended != model.nv or not sum(masses) > 0.0 or not all(masses):
            return NotImplemented
        return algorithm.run(model, data)
    (_subtree_calls_at_placements if is_anew else _subtree_calls).add(step, 0, model, data, root)
    return J


def _of_subtree(model: Model, data: Data, root: int, q: Floats) -> Floats:
    joint = index(root, model.njoints, "joint", "model.getJointId(name) returns one.")
    subtree = None if joint == 0 else model.names[joint]
    if evaluator := loaded_evaluator(model, data, "subtree Jacobian"):
        sums = WorldSums(evaluator, q)
        J = sums.subtree_center_jacobian(joint) if joint else sums.center_jacobian
        if np.isfinite(J).all():  # else what moves has no mass, which is left to the compiled function
            return J
    return data._attach(model).kernel("center_of_mass_jacobian", subtree=subtree)(q)


_total_mass_calls = call_cache(1, weak=1)


@repeated_calls(_total_mass_calls)
@checks_itself
def computeTotalMass(model: Model, data: Data = OMITTED) -> float:
    """The mass of all that moves [kg]; kept in `data.mass[0]`.

    Args:
        data: Its data, which is filled; it may be left out.

    Returns:
        The mass [kg].

    Raises:
        ArgumentError: `model` is no model.
    """
    if data is not OMITTED:
        computeSubtreeMasses(model, data)
        return data.mass[0]
    try:
        mass = model._total_mass()
    except AttributeError:
        raise wrong_model("computeTotalMass", model) from None
    if mass is NotImplemented:
        return _first_total_mass(model)
    _total_mass_calls.add(model._total_mass, 0, model)
    return mass


def _first_total_mass(model: Model) -> float:
    """The mass of all that moves; after the first calls, a compiled kernel of it is bound to the model."""
    blocks = model._parameter_blocks("inertias")
    if len(blocks) > 1 or model.first_calls.includes("total mass", NUMBER_CALLS):
        return float(np.concatenate(blocks)[1:, 0].sum())
    kernel = model._compiled_structure().compile(
        ("total mass", model.njoints),
        lambda _: lambda inertias: sum(inertias[1:, 0], 0.0) + 0.0,
        inertias=blocks[0].shape,
    )
    model._total_mass = BoundKernel(kernel, trailing_inputs=blocks, holder=float).call
    return model._total_mass()


@algorithm(fills=(), kernel=lambda _: lambda: (), deferred=MASSES, depends_on="inertias")
def computeSubtreeMasses(model: Model, data: Data) -> None:
    """Fills `data.mass` with the mass of what each joint moves; the universe, first, counts all that moves."""
    ...


# momentum -----------------------------------------------------------------------------------------------


def _map(model: CoreModel) -> Any:
    return lambda q: (algorithms.centroidal_matrix(model, q), *_center_and_columns(model)(q))


def _map_and_momentum(model: CoreModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        Ag, *others = _map(model)(q)
        return Ag, Ag @ v, as_one_body(model, q), *others

    return run


def _map_rate(model: CoreModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        Ag, J = algorithms.centroidal_matrix(model, q), algorithms.joint_jacobians(model, q)
        dAg = algorithms.centroidal_matrix_dot(model, q, v)
        return dAg, Ag, algorithms.joint_jacobians_dot(model, q, v), *_center_velocity(model)(q, v), J

    return run


def as_one_body(model: CoreModel, q: Array) -> Array:
    """Mass, lever and inertia about the centre of mass of the whole robot, as an Inertia stores them.

    Args:
        model: Ulna's model.

    Returns:
        Mass [kg], lever (0, 0, 0) and inertia row by row [kg m^2], (13,).
    """
    inertia = algorithms.centroidal_inertia(model, q).reshape(9)
    return np.concatenate([[algorithms.total_mass(model), 0.0, 0.0, 0.0], inertia])


def about_origin(model: CoreModel, q: Array, about_centre: Array) -> Array:
    """Momentum, or its rate, about the world's origin.

    Args:
        model: Ulna's model.
        about_centre: Momentum, or its rate, about the centre of mass, (6,).

    Returns:
        The same about the world's origin, (6,).
    """
    linear, angular = about_centre[:3], about_centre[3:]
    return np.concatenate([linear, angular + cross(algorithms.center_of_mass(model, q), linear)])


def _momentum(model: CoreModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        hg = algorithms.centroidal_momentum(model, q, v)
        return hg, as_one_body(model, q), about_origin(model, q, hg), *_center_velocity(model)(q, v)

    return run


def _momentum_rate(model: CoreModel) -> Any:
    def run(q: Array, v: Array, a: Array) -> tuple[Array, ...]:
        rate = algorithms.centroidal_momentum_rate(model, q, v, a)
        accelerations = rows(algorithms.joint_accelerations(model, q, v, a))
        return rate, about_origin(model, q, rate), *_momentum(model)(q, v), accelerations

    return run


@algorithm(
    fills=("Ag", "hg", "Ig", "com[0]", *JACOBIANS),
    kernel=_map_and_momentum,
    returns=(0,),
    deferred=JOINTS | CENTERS,
    depends_on="masses",
)
def ccrba(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The centroidal matrix (6, nv); fills `data.Ag`, `data.hg` and `data.Ig`.

    Returns:
        Matrix (6, nv).
    """
    ...


def dccrba(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The time derivative (6, nv) of the centroidal matrix; fills `data.dAg` and what ccrba fills.

    Returns:
        Matrix (6, nv).
    """
    ccrba(model, data, q, v)
    return computeCentroidalMapTimeVariation(model, data, q, v)


@algorithm(
    fills=("Ag", "com[0]", *JACOBIANS),
    kernel=_map,
    returns=(0,),
    deferred=JOINTS | CENTERS,
    depends_on="masses",
)
def computeCentroidalMap(model: Model, data: Data, q: Any) -> Floats:
    """The centroidal matrix (6, nv); kept in `data.Ag`.

    Returns:
        Matrix (6, nv).
    """
    ...


@algorithm(
    fills=("dAg", "Ag", "dJ", *_VELOCITY_FIELDS, "J"),
    kernel=_map_rate,
    returns=(0,),
    deferred=_WITH_VELOCITY,
    depends_on="masses",
)
def computeCentroidalMapTimeVariation(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The time derivative (6, nv) of the centroidal matrix; kept in `data.dAg`.

    Returns:
        Matrix (6, nv).
    """
    ...


@algorithm(
    fills=("hg", "Ig", "h[0]", *_VELOCITY_FIELDS),
    kernel=_momentum,
    deferred=_WITH_VELOCITY | SUBTREE_MOMENTA,
    depends_on="masses",
    default_state=("_qv", "forwardKinematics(model, data, q, v)"),
    of_fields=MOMENTUM.run,
    returns_field="hg",
)
def computeCentroidalMomentum(model: Model, data: Data, q: Any = None, v: Any = None) -> Force:
    """The momentum about the centre of mass; kept in `data.hg`, the inertia in `data.Ig`.

    Args:
        q: Configuration (nq,) [rad or m]; None for the state of the last forwardKinematics.

    Returns:
        Force (6,) [kg m/s, kg m^2/s] in world axes.
    """
    ...


@algorithm(
    fills=("dhg", "f[0]", "hg", "Ig", "h[0]", *_VELOCITY_FIELDS, "a"),
    kernel=_momentum_rate,
    deferred=_WITH_VELOCITY | ACCELERATIONS_IN_WORLD | SUBTREE_MOMENTA_AND_RATES,
    depends_on="masses",
    default_state=("_qva", "forwardKinematics(model, data, q, v, a)"),
    of_fields=MOMENTUM_RATE.run,
    returns_field="dhg",
)
def computeCentroidalMomentumTimeVariation(
    model: Model, data: Data, q: Any = None, v: Any = None, a: Any = None
) -> Force:
    """The time derivative of the momentum; kept in `data.dhg`, the momentum in `data.hg`.

    Args:
        q: Configuration (nq,) [rad or m]; None for the state of the last forwardKinematics.

    Returns:
        Force (6,) [N, N m] in world axes.
    """
    ...
