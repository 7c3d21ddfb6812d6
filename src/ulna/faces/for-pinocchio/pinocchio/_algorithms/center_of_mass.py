"""Centre of mass, centroidal momentum, masses."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.jacobians import COLUMNS, columns
from pinocchio._containers.arrays import index
from pinocchio._containers.enums import KinematicLevel
from pinocchio._data.binding import Algorithm, run
from pinocchio._data.data import Data, engine_for
from pinocchio._data.deferred_fields import (
    CENTRES,
    CENTRES_1,
    CENTRES_2,
    MASSES,
    MOMENTA,
    OA,
    OV,
    OWN,
    RATES_OF_MOMENTA,
    rows,
    stacked,
)
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Force
from ulna import algorithms
from ulna.model import Model as TowerModel
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


def _centre(model: TowerModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        return algorithms.center_of_mass(model, q), stacked(algorithms.joint_poses(model, q)), q

    return run


def _centre1(model: TowerModel) -> Any:
    first = _centre(model)

    def run(q: Array, v: Array) -> tuple[Array, ...]:
        speeds = rows(algorithms.joint_velocities(model, q, v))
        return *first(q), algorithms.center_of_mass_velocity(model, q, v), speeds, q, v

    return run


def _centre2(model: TowerModel) -> Any:
    first = _centre1(model)

    def run(q: Array, v: Array, a: Array) -> tuple[Array, ...]:
        gains = rows(algorithms.joint_accelerations(model, q, v, a))
        return *first(q, v), algorithms.center_of_mass_acceleration(model, q, v, a), gains, q, v, a

    return run


def _slope(model: TowerModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        com = algorithms.center_of_mass(model, q)
        return algorithms.center_of_mass_jacobian(model, q), com, *columns(model)(q)

    return run


_AT = ("com[0]", "oMi", "places q")
_AT1 = (*_AT, "vcom[0]", "v", "speeds q", "speeds v")
_AT2 = (*_AT1, "acom[0]", "a", "gains q", "gains v", "gains a")
_COM = Algorithm("centre", "q", _AT, _centre, (0,), late=OWN | CENTRES)
_COM1 = Algorithm("centre1", "qv", _AT1, _centre1, (0,), late=OWN | OV | CENTRES_1)
_COM2 = Algorithm("centre2", "qva", _AT2, _centre2, (0,), late=OWN | OV | OA | CENTRES_2)
_JCOM = Algorithm("slope", "q", ("Jcom", "com[0]", *COLUMNS), _slope, (0,), late=OWN | CENTRES)


def centerOfMass(
    model: Model, data: Data, q: Any = None, v: Any = None, a: Any = None, compute_subtree_coms: bool = True
) -> Floats:
    """The centre of mass in the world (3,); fills `data.com` and `data.mass`, with v `vcom`, with a `acom`.

    What belongs to subtrees is computed when it is read, whatever `compute_subtree_coms` says.
    """
    if v is None or isinstance(v, bool):  # compute_subtree_coms may stand in its place
        step = data._run.centre
        found = step(q) if data._model is model else NotImplemented
        if found is NotImplemented:
            if q is None or isinstance(q, (int, np.integer)):
                q, v, a = _moved(data, q)
                return centerOfMass(model, data, q, v, a)
            found = run(model, data, _COM, q)
    elif a is None or isinstance(a, bool):
        step = data._run.centre1
        found = step(q, v) if data._model is model else NotImplemented
        if found is NotImplemented:
            found = run(model, data, _COM1, q, v)
    else:
        step = data._run.centre2
        found = step(q, v, a) if data._model is model else NotImplemented
        if found is NotImplemented:
            found = run(model, data, _COM2, q, v, a)
    return found


def _moved(data: Data, level: Any) -> list[Any]:
    """The state that forwardKinematics left, up to what it was given, at least up to a KinematicLevel."""
    q = data.require(data._q, "forwardKinematics(model, data, q)")
    known = [(q,), *(s for s in (data._qv, data._qva) if s is not None and np.array_equal(s[0], q))]
    if isinstance(level, KinematicLevel) and len(known[-1]) <= level:
        data.require(None, "forwardKinematics(model, data, q, v, a)")
    return [*(x.copy() for x in known[-1]), None, None][:3]


def jacobianCenterOfMass(
    model: Model, data: Data, q: Any = None, compute_subtree_coms: bool = True
) -> Floats:
    """The Jacobian (3, nv) of the centre of mass; kept in `data.Jcom`."""
    if q is None:
        q = data.require(data._q, "forwardKinematics(model, data, q)")
    step = data._run.slope
    found = step(q) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _JCOM, q)
    return found


_SUBTREE = Algorithm(
    "subtree_slope",
    "q",
    ("com[0]", *COLUMNS),
    lambda model: lambda q: _slope(model)(q)[1:],
    late=OWN | CENTRES,
    spoils=("Jcom",),
    title="jacobianSubtreeCenterOfMass",
)


def jacobianSubtreeCenterOfMass(
    model: Model, data: Data, q: Any, subtree_root_joint_id: int | None = None
) -> Floats:
    """The Jacobian (3, nv) of the centre of mass of what a joint moves."""
    if subtree_root_joint_id is None:
        q, subtree_root_joint_id = data.require(data._q, "forwardKinematics(model, data, q)"), int(q)
    if data._model is not model or data._run.subtree_slope(q) is NotImplemented:
        run(model, data, _SUBTREE, q)
    return _of_subtree(model, data, subtree_root_joint_id, data._blocks["places q"])


def getJacobianSubtreeCenterOfMass(model: Model, data: Data, subtree_root_joint_id: int) -> Floats:
    """The same after jacobianCenterOfMass."""
    q = data.require(data._q_of_jacobians, "jacobianCenterOfMass(model, data, q)")
    return _of_subtree(model, data, subtree_root_joint_id, q)


def _of_subtree(model: Model, data: Data, root: int, q: Floats) -> Floats:
    joint = index(root, model.njoints, "joint", "model.getJointId(name) gives one.")
    subtree = None if joint == 0 else model.names[joint]
    return engine_for(model, data).kernel("center_of_mass_jacobian", subtree=subtree)(q)


def computeTotalMass(model: Model, data: Data | None = None) -> float:
    """The mass of all that moves [kg]; kept in `data.mass[0]`."""
    if data is not None:
        computeSubtreeMasses(model, data)
    return float(algorithms.total_mass(model.engine().model))


def computeSubtreeMasses(model: Model, data: Data) -> None:
    """Fills `data.mass` with the mass of what each joint moves; the universe, first, counts all that moves."""
    data.leave(MASSES["mass"], ("mass",), data.attach(model))


# momentum -----------------------------------------------------------------------------------------------


def _map(model: TowerModel) -> Any:
    return lambda q: (algorithms.centroidal_matrix(model, q), *_slope(model)(q)[1:])


def _map_rate(model: TowerModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        Ag, J = algorithms.centroidal_matrix(model, q), algorithms.joint_jacobians(model, q)
        rate, J_rate = (
            algorithms.centroidal_matrix_dot(model, q, v),
            algorithms.joint_jacobians_dot(model, q, v),
        )
        return rate, Ag, J_rate, q, v, *_centre1(model)(q, v), J, q

    return run


def as_one_body(model: TowerModel, q: Array) -> Array:
    """Mass, lever and inertia about the centre of mass of the whole robot, as an Inertia stores them."""
    inertia = algorithms.centroidal_inertia(model, q).reshape(9)
    return np.concatenate([[algorithms.total_mass(model), 0.0, 0.0, 0.0], inertia])


def about_origin(model: TowerModel, q: Array, about_centre: Array) -> Array:
    """Momentum, or its rate, about the world's origin."""
    linear, angular = about_centre[:3], about_centre[3:]
    return np.concatenate([linear, angular + cross(algorithms.center_of_mass(model, q), linear)])


def _momentum(model: TowerModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        hg = algorithms.centroidal_momentum(model, q, v)
        return hg, as_one_body(model, q), about_origin(model, q, hg), *_centre1(model)(q, v)

    return run


def _momentum_rate(model: TowerModel) -> Any:
    def run(q: Array, v: Array, a: Array) -> tuple[Array, ...]:
        rate = algorithms.centroidal_momentum_rate(model, q, v, a)
        gains = rows(algorithms.joint_accelerations(model, q, v, a))
        return rate, about_origin(model, q, rate), *_momentum(model)(q, v), gains, q, v, a

    return run


def _map_and_momentum(model: TowerModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        Ag, *others = _map(model)(q)
        return Ag, Ag @ v, as_one_body(model, q), *others

    return run


_LEFT = OWN | CENTRES
_MAP = Algorithm("map", "q", ("Ag", "com[0]", *COLUMNS), _map, (0,), late=_LEFT)
_CCRBA = Algorithm("ccrba", "qv", ("Ag", "hg", "Ig", "com[0]", *COLUMNS), _map_and_momentum, (0,), late=_LEFT)
_DCCRBA = ("dAg", "Ag", "dJ", "rates q", "rates v", *_AT1, "J", "jacobians q")
_MAP_RATE = Algorithm("map_rate", "qv", _DCCRBA, _map_rate, (0,), late=OWN | OV | CENTRES_1)
_MOMENTUM = Algorithm(
    "momentum", "qv", ("hg", "Ig", "h[0]", *_AT1), _momentum, late=OWN | OV | CENTRES_1 | MOMENTA
)
_MOMENTUM_RATE = Algorithm(
    "momentum_rate",
    "qva",
    ("dhg", "f[0]", "hg", "Ig", "h[0]", *_AT1, "a", "gains q", "gains v", "gains a"),
    _momentum_rate,
    late=OWN | OV | OA | CENTRES_1 | RATES_OF_MOMENTA,
)


def ccrba(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The centroidal matrix (6, nv); fills `data.Ag`, `data.hg` and `data.Ig`."""
    step = data._run.ccrba
    found = step(q, v) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _CCRBA, q, v)
    return found


def dccrba(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The time derivative (6, nv) of the centroidal matrix; fills `data.dAg` and what ccrba fills."""
    ccrba(model, data, q, v)
    return computeCentroidalMapTimeVariation(model, data, q, v)


def computeCentroidalMap(model: Model, data: Data, q: Any) -> Floats:
    """The centroidal matrix (6, nv); kept in `data.Ag`."""
    step = data._run.map
    found = step(q) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _MAP, q)
    return found


def computeCentroidalMapTimeVariation(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """Its time derivative (6, nv); kept in `data.dAg`."""
    step = data._run.map_rate
    found = step(q, v) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _MAP_RATE, q, v)
    return found


def computeCentroidalMomentum(model: Model, data: Data, q: Any = None, v: Any = None) -> Force:
    """The momentum about the centre of mass; kept in `data.hg`, the inertia in `data.Ig`."""
    if q is None:
        q, v = data.require(data._qv, "forwardKinematics(model, data, q, v)")
    step = data._run.momentum
    if data._model is not model or step(q, v) is NotImplemented:
        run(model, data, _MOMENTUM, q, v)
    return data.hg


def computeCentroidalMomentumTimeVariation(
    model: Model, data: Data, q: Any = None, v: Any = None, a: Any = None
) -> Force:
    """Its time derivative; kept in `data.dhg`, the momentum in `data.hg`."""
    if q is None:
        q, v, a = (x.copy() for x in data.require(data._qva, "forwardKinematics(model, data, q, v, a)"))
    step = data._run.momentum_rate
    if data._model is not model or step(q, v, a) is NotImplemented:
        run(model, data, _MOMENTUM_RATE, q, v, a)
    return data.dhg
