"""Centre of mass, centroidal momentum, energies, masses."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._arrays import index, vector
from pinocchio._data import Data, engine_for
from pinocchio._kinematics import stacked
from pinocchio._model import Model
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
_FIELDS = ("com", "vcom", "acom")
_KEYS = ("com", "com 1", "com 2")
_CENTRES: tuple[Any, ...] = (
    algorithms.center_of_mass,
    algorithms.center_of_mass_velocity,
    algorithms.center_of_mass_acceleration,
)


def centerOfMass(
    model: Model, data: Data, q: Any = None, v: Any = None, a: Any = None, compute_subtree_coms: bool = True
) -> Floats:
    """The centre of mass in the world (3,); fills `data.com` and `data.mass`, with v `vcom`, with a `acom`.

    What belongs to subtrees is computed when it is read, whatever `compute_subtree_coms` says.
    """
    if v is None or isinstance(v, bool):  # compute_subtree_coms may stand in its place
        if q is None or isinstance(q, (int, np.integer)):
            q = data.require(data._q, "forwardKinematics(model, data, q)")
        fill_masses(model, data, vector(q, model.nq, "q"))
    elif a is None or isinstance(a, bool):
        fill_masses(model, data, vector(q, model.nq, "q"), vector(v, model.nv, "v"))
    else:
        fill_masses(model, data, vector(q, model.nq, "q"), vector(v, model.nv, "v"), vector(a, model.nv, "a"))
    return data._blocks["com"][0].copy()


def _moments(order: int) -> Any:
    """The centre of mass and its rates up to an order, and the placements of the joints."""

    def build(tower: TowerModel) -> Any:
        def run(*state: Array) -> tuple[Array, ...]:
            found = [f(tower, *state[: k + 1]) for k, f in enumerate(_CENTRES[: order + 1])]
            return (*found, stacked(algorithms.joint_poses(tower, state[0])))

        return run

    return build


def fill_masses(model: Model, data: Data, *state: Floats) -> None:
    """Fills com, vcom and acom of the whole robot; those of subtrees are left until they are asked for."""
    engine = engine_for(model, data)
    order = len(state) - 1
    key = _KEYS[order]
    kernel = engine.kernels.get(key)
    if kernel is None:
        shapes: dict[str, Any] = dict(zip("qva", (x.shape for x in state), strict=False))
        kernel = engine.made(key, _moments(order), **shapes)
    found = kernel(*state)
    data._tails["oMi"][...] = found[-1]
    for k in range(order + 1):
        field = _FIELDS[k]
        data._blocks[field][0] = found[k]
        data._lists[field].pull = data._subtrees[field]
    q = data.keep(engine, state[0])
    data._moments = (q, *(x.copy() for x in state[1:])) if order else (q,)
    if data._mass_of is not engine:
        data._mass_of = engine
        list.__setitem__(data.mass, 0, float(algorithms.total_mass(engine.model)))
        data.mass.pull = data._subtrees["mass"]


def fill_subtrees(model: Model, data: Data, field: str) -> None:
    """The same of what each joint moves, in the joint's frame; or the masses."""
    if field == "mass":
        computeSubtreeMasses(model, data)
        return
    order = _FIELDS.index(field)
    engine = engine_for(model, data)
    heavy = [j.name for j in engine.model.joints if algorithms.total_mass(engine.model, j.name) > 0.0]
    state = data._moments[: order + 1]
    found = {name: engine.kernel(_WORDS[order], subtree=name)(*state) for name in heavy}
    for i, name in enumerate(model.names):
        if name in found:
            M = data.oMi[i]
            data._blocks[field][i] = M.actInv(found[name]) if order == 0 else M.rotation.T @ found[name]


def jacobianCenterOfMass(
    model: Model, data: Data, q: Any = None, compute_subtree_coms: bool = True
) -> Floats:
    """The Jacobian (3, nv) of the centre of mass; kept in `data.Jcom`."""
    q = data.require(data._q, "forwardKinematics(model, data, q)") if q is None else vector(q, model.nq, "q")
    fill_masses(model, data, q)
    data._blocks["Jcom"][...] = found = engine_for(model, data).plain("center_of_mass_jacobian")(q)
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
    """The mass of all that moves [kg]."""
    return float(algorithms.total_mass(model.engine().model))


def computeSubtreeMasses(model: Model, data: Data) -> None:
    """Fills `data.mass` with the mass of what each joint moves; the universe, first, counts all that moves."""
    tower = engine_for(model, data).model
    found = [float(algorithms.total_mass(tower, n)) for n in (None, *tower.joint_names)]
    data.mass.pull = None
    for i, mass in enumerate(found):
        list.__setitem__(data.mass, i, mass)


# momentum -----------------------------------------------------------------------------------------------


def ccrba(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The centroidal matrix (6, nv); fills `data.Ag`, `data.hg` and `data.Ig`."""
    computeCentroidalMomentum(model, data, q, v)
    return computeCentroidalMap(model, data, q)


def dccrba(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The time derivative (6, nv) of the centroidal matrix; fills `data.dAg` and what ccrba fills."""
    ccrba(model, data, q, v)
    return computeCentroidalMapTimeVariation(model, data, q, v)


def computeCentroidalMap(model: Model, data: Data, q: Any) -> Floats:
    """The centroidal matrix (6, nv); kept in `data.Ag`."""
    data._blocks["Ag"][:] = found = engine_for(model, data).kernel("centroidal_matrix")(
        vector(q, model.nq, "q")
    )
    return found


def computeCentroidalMapTimeVariation(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """Its time derivative (6, nv); kept in `data.dAg`."""
    kernel = engine_for(model, data).kernel("centroidal_matrix_dot")
    data._blocks["dAg"][:] = found = kernel(vector(q, model.nq, "q"), vector(v, model.nv, "v"))
    computeCentroidalMap(model, data, q)
    return found


def computeCentroidalMomentum(model: Model, data: Data, q: Any = None, v: Any = None) -> Force:
    """The momentum about the centre of mass; kept in `data.hg`, the inertia in `data.Ig`."""
    if q is None:
        q, v = data.require(data._qv, "forwardKinematics(model, data, q, v)")
    engine = engine_for(model, data)
    q, v = vector(q, model.nq, "q"), vector(v, model.nv, "v")
    data.hg._v[:] = engine.kernel("centroidal_momentum")(q, v)
    data.Ig.mass = float(algorithms.total_mass(engine.model))
    data.Ig.inertia = engine.kernel("centroidal_inertia")(q)
    fill_masses(model, data, q, v)
    return data.hg


def computeCentroidalMomentumTimeVariation(
    model: Model, data: Data, q: Any = None, v: Any = None, a: Any = None
) -> Force:
    """Its time derivative; kept in `data.dhg`, the momentum in `data.hg`."""
    if q is None:
        q, v, a = data.require(data._qva, "forwardKinematics(model, data, q, v, a)")
    state = vector(q, model.nq, "q"), vector(v, model.nv, "v"), vector(a, model.nv, "a")
    computeCentroidalMomentum(model, data, *state[:2])
    data.dhg._v[:] = engine_for(model, data).kernel("centroidal_momentum_rate")(*state)
    return data.dhg


# energies -----------------------------------------------------------------------------------------------


def computeKineticEnergy(model: Model, data: Data, q: Any = None, v: Any = None) -> float:
    """The kinetic energy [J]; kept in `data.kinetic_energy`."""
    if q is None:
        q, v = data.require(data._qv, "forwardKinematics(model, data, q, v)")
    kernel = engine_for(model, data).kernel("kinetic_energy")
    data.kinetic_energy = float(kernel(vector(q, model.nq, "q"), vector(v, model.nv, "v")))
    return data.kinetic_energy


def computePotentialEnergy(model: Model, data: Data, q: Any = None) -> float:
    """The potential energy [J]; kept in `data.potential_energy`."""
    q = data.require(data._q, "forwardKinematics(model, data, q)") if q is None else vector(q, model.nq, "q")
    data.potential_energy = float(engine_for(model, data).kernel("potential_energy")(q))
    return data.potential_energy


def computeMechanicalEnergy(model: Model, data: Data, q: Any = None, v: Any = None) -> float:
    """Their sum [J]; kept in `data.mechanical_energy`."""
    kinetic = computeKineticEnergy(model, data, q, v)
    data.mechanical_energy = kinetic + computePotentialEnergy(model, data, q)
    return data.mechanical_energy
