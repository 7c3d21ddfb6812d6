"""Centre of mass, centroidal momentum, energies, masses."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._arrays import index, vector
from pinocchio._data import Data, engine_for
from pinocchio._jacobians import COLUMNS, columns
from pinocchio._kinematics import forwardKinematics, rows, stacked
from pinocchio._model import Model
from pinocchio._runs import Algorithm, run
from pinocchio._states import ACOM, COM, MASS, NOT_MOTION, NOT_SPEED, OWN, VCOM
from pinocchio._vectors import Force
from ulna import algorithms
from ulna.model import Model as TowerModel
from ulna.typing import Array, Floats

__all__ = [
    "ccrba",
    "centerOfMass",
    "computeCentroidalMap",
    "computeCentroidalMapTimeVariation",
    "computeCentroidalMomentum",
    "computeCentroidalMomentumTimeVariation",
    "computeKineticEnergy",
    "computeMechanicalEnergy",
    "computePotentialEnergy",
    "computeSubtreeMasses",
    "computeTotalMass",
    "dccrba",
    "getJacobianSubtreeCenterOfMass",
    "jacobianCenterOfMass",
    "jacobianSubtreeCenterOfMass",
]

_WORDS = ("center_of_mass", "center_of_mass_velocity", "center_of_mass_acceleration")
_FIELDS = {COM: "com", VCOM: "vcom", ACOM: "acom"}


def _centre(model: TowerModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        return algorithms.center_of_mass(model, q), stacked(algorithms.joint_poses(model, q)), q, q, q

    return run


def _centre1(model: TowerModel) -> Any:
    first = _centre(model)

    def run(q: Array, v: Array) -> tuple[Array, ...]:
        speeds = rows(algorithms.joint_velocities(model, q, v))
        return *first(q), algorithms.center_of_mass_velocity(model, q, v), v, speeds, q, v

    return run


def _centre2(model: TowerModel) -> Any:
    first = _centre1(model)

    def run(q: Array, v: Array, a: Array) -> tuple[Array, ...]:
        gains = rows(algorithms.joint_accelerations(model, q, v, a))
        return *first(q, v), algorithms.center_of_mass_acceleration(model, q, v, a), a, gains, q, v, a

    return run


def _slope(model: TowerModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        com = algorithms.center_of_mass(model, q)
        return algorithms.center_of_mass_jacobian(model, q), com, q, *columns(model)(q)

    return run


_AT = ("com[0]", "oMi", "places q", "own q", "moments q")
_AT1 = (*_AT, "vcom[0]", "moments v", "v", "speeds q", "speeds v")
_AT2 = (*_AT1, "acom[0]", "moments a", "a", "gains q", "gains v", "gains a")
_COM = Algorithm("centre", "q", _AT, _centre, (0,))
_COM1 = Algorithm("centre1", "qv", _AT1, _centre1, (0,))
_COM2 = Algorithm("centre2", "qva", _AT2, _centre2, (0,))
_JCOM = Algorithm("slope", "q", ("Jcom", "com[0]", "moments q", *COLUMNS), _slope, (0,))


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
                q = data.require(data._q, "forwardKinematics(model, data, q)")
            found = run(model, data, _COM, q)
        data._due |= OWN | COM | MASS
    elif a is None or isinstance(a, bool):
        step = data._run.centre1
        found = step(q, v) if data._model is model else NotImplemented
        if found is NotImplemented:
            found = run(model, data, _COM1, q, v)
        data._due = data._due & NOT_SPEED | OWN | COM | VCOM | MASS
    else:
        step = data._run.centre2
        found = step(q, v, a) if data._model is model else NotImplemented
        if found is NotImplemented:
            found = run(model, data, _COM2, q, v, a)
        data._due = data._due & NOT_MOTION | OWN | COM | VCOM | ACOM | MASS
    return found


def fill_subtrees(data: Data, bit: int) -> None:
    """What was left of subtrees: the centre of what each joint moves, or a rate of it, in its frame; or the masses."""
    due = data.claim(bit)
    if due is None:
        return
    engine, *state = due
    tower = engine.model
    if bit == MASS:
        _fill_masses(data, tower)
        return
    order = list(_FIELDS).index(bit)
    poses = algorithms.joint_poses(tower, state[0])
    for i, (joint, pose) in enumerate(zip(tower.joints, poses, strict=True), start=1):
        if algorithms.total_mass(tower, joint.name) > 0.0:
            found = engine.kernel(_WORDS[order], subtree=joint.name)(*state[: order + 1])
            own = pose.rotation.T @ (found - pose.translation if order == 0 else found)
            data._blocks[_FIELDS[bit]][i] = own


def _fill_masses(data: Data, tower: TowerModel) -> None:
    for i, name in enumerate((None, *tower.joint_names)):
        list.__setitem__(data.mass, i, float(algorithms.total_mass(tower, name)))


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
    data._due |= OWN | COM | MASS
    return found


def jacobianSubtreeCenterOfMass(
    model: Model, data: Data, q: Any, subtree_root_joint_id: int | None = None
) -> Floats:
    """The Jacobian (3, nv) of the centre of mass of what a joint moves."""
    if subtree_root_joint_id is None:
        q, subtree_root_joint_id = data.require(data._q, "forwardKinematics(model, data, q)"), int(q)
    joint = index(subtree_root_joint_id, model.njoints, "joint", "model.getJointId(name) gives one.")
    subtree = None if joint == 0 else model.names[joint]
    return engine_for(model, data).kernel("center_of_mass_jacobian", subtree=subtree)(
        vector(q, model.nq, "q")
    )


def getJacobianSubtreeCenterOfMass(model: Model, data: Data, subtree_root_joint_id: int) -> Floats:
    """The same after jacobianCenterOfMass."""
    return jacobianSubtreeCenterOfMass(model, data, subtree_root_joint_id)


def computeTotalMass(model: Model, data: Data | None = None) -> float:
    """The mass of all that moves [kg]; kept in `data.mass[0]`."""
    mass = float(algorithms.total_mass(model.engine().model))
    if data is not None:
        data.claim(MASS)
        list.__setitem__(data.mass, 0, mass)
    return mass


def computeSubtreeMasses(model: Model, data: Data) -> None:
    """Fills `data.mass` with the mass of what each joint moves; the universe, first, counts all that moves."""
    data.claim(MASS)
    _fill_masses(data, data.attach(model).model)


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
        return rate, Ag, J_rate, q, v, *_centre1(model)(q, v), J, q, rate @ v

    return run


def as_one_body(model: TowerModel, q: Array) -> Array:
    """Mass, lever and inertia about the centre of mass of the whole robot, as an Inertia stores them."""
    inertia = algorithms.centroidal_inertia(model, q).reshape(9)
    return np.concatenate([[algorithms.total_mass(model), 0.0, 0.0, 0.0], inertia])


def _momentum(model: TowerModel) -> Any:
    first = _centre1(model)
    return lambda q, v: (algorithms.centroidal_momentum(model, q, v), as_one_body(model, q), *first(q, v))


def _map_and_momentum(model: TowerModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        Ag, *others = _map(model)(q)
        return Ag, Ag @ v, as_one_body(model, q), *others

    return run


_MAP = Algorithm("map", "q", ("Ag", "com[0]", "moments q", *COLUMNS), _map, (0,))
_CCRBA = Algorithm(
    "ccrba", "qv", ("Ag", "hg", "Ig", "com[0]", "moments q", *COLUMNS), _map_and_momentum, (0,)
)
_MAP_RATE = Algorithm(
    "map_rate",
    "qv",
    ("dAg", "Ag", "dJ", "rates q", "rates v", *_AT1, "J", "jacobians q", "dhg"),
    _map_rate,
    (0,),
)
_MOMENTUM = Algorithm("momentum", "qv", ("hg", "Ig", *_AT1), _momentum)


def ccrba(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The centroidal matrix (6, nv); fills `data.Ag`, `data.hg` and `data.Ig`."""
    step = data._run.ccrba
    found = step(q, v) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _CCRBA, q, v)
    data._due |= OWN | COM | MASS
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
    data._due |= OWN | COM | MASS
    return found


def computeCentroidalMapTimeVariation(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """Its time derivative (6, nv); kept in `data.dAg`."""
    step = data._run.map_rate
    found = step(q, v) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _MAP_RATE, q, v)
    data._due = data._due & NOT_SPEED | OWN | COM | VCOM | MASS
    return found


def computeCentroidalMomentum(model: Model, data: Data, q: Any = None, v: Any = None) -> Force:
    """The momentum about the centre of mass; kept in `data.hg`, the inertia in `data.Ig`."""
    if q is None:
        q, v = data.require(data._qv, "forwardKinematics(model, data, q, v)")
    step = data._run.momentum
    if data._model is not model or step(q, v) is NotImplemented:
        run(model, data, _MOMENTUM, q, v)
    data._due = data._due & NOT_SPEED | OWN | COM | VCOM | MASS
    return data.hg


def computeCentroidalMomentumTimeVariation(
    model: Model, data: Data, q: Any = None, v: Any = None, a: Any = None
) -> Force:
    """Its time derivative; kept in `data.dhg`, the momentum in `data.hg`."""
    if q is None:
        q, v, a = (x.copy() for x in data.require(data._qva, "forwardKinematics(model, data, q, v, a)"))
    forwardKinematics(model, data, q, v, a)
    computeCentroidalMomentum(model, data, q, v)
    state = vector(q, model.nq, "q"), vector(v, model.nv, "v"), vector(a, model.nv, "a")
    data.dhg._v[:] = data.attach(model).kernel("centroidal_momentum_rate")(*state)
    return data.dhg


# energies -----------------------------------------------------------------------------------------------


def _kinetic(model: TowerModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        speeds = rows(algorithms.joint_velocities(model, q, v))
        places = stacked(algorithms.joint_poses(model, q))
        return algorithms.kinetic_energy(model, q, v), places, q, q, speeds, q, v

    return run


def _potential(model: TowerModel) -> Any:
    return lambda q: (algorithms.potential_energy(model, q), stacked(algorithms.joint_poses(model, q)), q, q)


_KINETIC = Algorithm(
    "kinetic", "qv", ("energy K", "oMi", "places q", "own q", "v", "speeds q", "speeds v"), _kinetic, (0,)
)
_POTENTIAL = Algorithm("potential", "q", ("energy P", "oMi", "places q", "own q"), _potential, (0,))


def computeKineticEnergy(model: Model, data: Data, q: Any = None, v: Any = None) -> float:
    """The kinetic energy [J]; kept in `data.kinetic_energy`."""
    if q is None:
        q, v = data.require(data._qv, "forwardKinematics(model, data, q, v)")
    step = data._run.kinetic
    found = step(q, v) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _KINETIC, q, v)
    data._due = data._due & NOT_SPEED | OWN
    data.kinetic_energy = energy = float(found)
    return energy


def computePotentialEnergy(model: Model, data: Data, q: Any = None) -> float:
    """The potential energy [J]; kept in `data.potential_energy`."""
    if q is None:
        q = data.require(data._q, "forwardKinematics(model, data, q)")
    step = data._run.potential
    found = step(q) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _POTENTIAL, q)
    data._due |= OWN
    data.potential_energy = energy = float(found)
    return energy


def computeMechanicalEnergy(model: Model, data: Data, q: Any = None, v: Any = None) -> float:
    """Their sum [J]; kept in `data.mechanical_energy`."""
    kinetic = computeKineticEnergy(model, data, q, v)
    data.mechanical_energy = kinetic + computePotentialEnergy(model, data, q)
    return data.mechanical_energy
