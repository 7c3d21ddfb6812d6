"""Inverse and forward dynamics, the mass matrix and its kin, and all of them at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from pinocchio._algorithms.center_of_mass import about_origin, as_one_body
from pinocchio._algorithms.jacobians import COLUMNS, RATES, columns, computeJointJacobians, rates
from pinocchio._containers.arrays import vector
from pinocchio._containers.enums import Convention
from pinocchio._data.binding import Algorithm, run
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import (
    BODIES,
    CENTRES,
    CENTRES_1,
    FELT,
    FELT_BY_ALL,
    GAINS,
    MOMENTA,
    OH,
    OV,
    OWN,
    UNDER_FORCES,
    split_forces,
)
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Force
from ulna import algorithms
from ulna.errors import InputError
from ulna.model import Model as TowerModel
from ulna.recipes.mass import with_mass
from ulna.typing import Array, Floats

if TYPE_CHECKING:
    from pinocchio._model.kernels import Engine

_WORLD = Convention.WORLD  # looking a member up costs as much as a small robot's placements

__all__ = [
    "aba",
    "computeAllTerms",
    "computeCoriolisMatrix",
    "computeGeneralizedGravity",
    "computeMinverse",
    "computeStaticTorque",
    "crba",
    "getCoriolisMatrix",
    "nle",
    "nonLinearEffects",
    "rnea",
]


def checked(fext: Any, count: int) -> list[Floats]:
    """Forces on the joints, the universe included, each (6,).

    Raises:
        InputError: there are not as many as joints.
    """
    if len(fext) != count:
        raise InputError(
            f"`fext` holds {len(fext)} forces; expected {count}, one for each joint, the universe included."
        )
    return [f.vector if isinstance(f, Force) else vector(f, 6, "fext") for f in fext]


def external(fext: Any, count: int) -> Floats:
    """The same, the universe left out, as one array (njoints - 1, 6)."""
    return np.array(checked(fext, count)[1:], dtype=float).reshape(count - 1, 6)


def under_forces(engine: Engine, algorithm: Callable[..., Any], *arrays: Floats) -> Any:
    """An algorithm of the tower on a state and, the last of the arrays, forces on the joints; compiled once."""

    def build(tower: TowerModel) -> Any:
        return lambda *given: algorithm(tower, *given[:-1], split_forces(given[-1]))

    shapes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(arrays)}
    return engine.made((algorithm, "under forces"), build, **shapes)(*arrays)


def _inverse(model: TowerModel) -> Any:
    return lambda q, v, a, *F: algorithms.inverse_dynamics(model, q, v, a, *map(split_forces, F))


def _bias(model: TowerModel) -> Any:
    return lambda q, v: algorithms.bias_forces(model, q, v)


def _gravity(model: TowerModel) -> Any:
    return lambda q: algorithms.gravity_forces(model, q)


def _forward(model: TowerModel) -> Any:
    def run(q: Array, v: Array, tau: Array) -> tuple[Array, ...]:
        ddq = algorithms.forward_dynamics(model, q, v, tau)
        return ddq, ddq

    return run


def _forward_under(model: TowerModel) -> Any:
    def run(q: Array, v: Array, tau: Array, F: Array) -> tuple[Array, ...]:
        ddq = algorithms.forward_dynamics(model, q, v, tau, split_forces(F))
        return ddq, ddq, q, v, ddq

    return run


def _mass(model: TowerModel) -> Any:
    return lambda q: algorithms.mass_matrix(model, q)


def _mass_in_world(model: TowerModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        com, Ag = algorithms.center_of_mass(model, q), algorithms.centroidal_matrix(model, q)
        return algorithms.mass_matrix(model, q), Ag, com, *columns(model)(q)

    return run


def _inverse_mass(model: TowerModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        return (algorithms.inverse_mass_matrix(model, q), *columns(model)(q))

    return run


def _coriolis(model: TowerModel) -> Any:
    return lambda q, v: (algorithms.coriolis_matrix(model, q, v), *rates(model)(q, v))


_RNEA = Algorithm("rnea", "qva", ("tau",), _inverse, (0,), late=OWN | BODIES)
_RNEA_UNDER = Algorithm("rnea_under", "qvaf", ("tau",), _inverse, (0,), late=OWN | UNDER_FORCES)
_NLE = Algorithm("nle", "qv", ("nle",), _bias, (0,), late=OWN | BODIES)
_GRAVITY = Algorithm("gravity", "q", ("g",), _gravity, (0,), late=OWN | FELT)
_ABA = Algorithm("aba", "qvt", ("ddq", "aba a"), with_mass(_forward), (0,), late=OWN | BODIES | GAINS)
_ABA_UNDER = Algorithm(
    "aba_under",
    "qvtf",
    ("ddq", "aba_under a", "aba q", "aba v", "aba a"),
    with_mass(_forward_under),
    (0,),
    late=OWN | UNDER_FORCES | GAINS,
)
_CRBA = Algorithm("crba", "q", ("M",), _mass, (0,), late=OWN)
_CRBA_WORLD = Algorithm(
    "crba_world", "q", ("M", "Ag", "com[0]", *COLUMNS), _mass_in_world, (0,), late=OWN | CENTRES
)
_MINV = Algorithm("minverse", "q", ("Minv", *COLUMNS), with_mass(_inverse_mass), (0,), late=OWN)
_CORIOLIS = Algorithm(
    "coriolis",
    "qv",
    ("C", *RATES),
    _coriolis,
    (0,),
    late=OWN | OV | OH,
    spoils=("Ag", "dFdv"),
    title="computeCoriolisMatrix",
)


def rnea(model: Model, data: Data, q: Any, v: Any, a: Any, fext: Any = None) -> Floats:
    """The joint torques of a motion, (nv,); kept in `data.tau`.

    Args:
        model: The model.
        data: Its data.
        q: Configuration (nq,).
        v: Velocity (nv,).
        a: Acceleration (nv,).
        fext: For every joint, the force on its body in its frame.
    """
    if fext is None:
        step = data._run.rnea
        tau = step(q, v, a) if data._model is model else NotImplemented
        if tau is NotImplemented:
            tau = run(model, data, _RNEA, q, v, a)
        return tau
    return run_under(model, data, _RNEA_UNDER, q, v, a, fext)


def run_under(model: Model, data: Data, algorithm: Algorithm, q: Any, v: Any, third: Any, fext: Any) -> Any:
    """Runs an algorithm under forces on the joints, each read where it lies."""
    step = getattr(data._run, algorithm.name)
    try:
        found = step(q, v, third, *[f._v for f in fext]) if data._model is model else NotImplemented
    except (AttributeError, TypeError):  # no forces
        found = NotImplemented
    if found is NotImplemented:
        found = run(model, data, algorithm, q, v, third, *checked(fext, model.njoints))
    return found


def nonLinearEffects(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """Coriolis, centrifugal and gravity torques (nv,); kept in `data.nle`."""
    step = data._run.nle
    found = step(q, v) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _NLE, q, v)
    return found


nle = nonLinearEffects


def computeGeneralizedGravity(model: Model, data: Data, q: Any) -> Floats:
    """The torques that hold the robot against gravity (nv,); kept in `data.g`."""
    step = data._run.gravity
    found = step(q) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _GRAVITY, q)
    return found


def computeStaticTorque(model: Model, data: Data, q: Any, fext: Any) -> Floats:
    """The torques that hold the robot against gravity and forces on its joints (nv,); kept in `data.tau`."""
    F = external(fext, model.njoints)
    q = vector(q, model.nq, "q")
    engine, rest = data.attach(model), np.zeros(model.nv)
    data.tau = found = under_forces(engine, algorithms.static_torque, q, F)
    data.moved(engine, q)
    data.leave(FELT["f"], tuple(FELT), engine, q.copy(), rest, rest, F)
    return found


def aba(
    model: Model, data: Data, q: Any, v: Any, tau: Any, fext: Any = None, convention: Any = None
) -> Floats:
    """The accelerations that torques give (nv,); kept in `data.ddq`.

    Args:
        model: The model.
        data: Its data.
        q: Configuration (nq,).
        v: Velocity (nv,).
        tau: Torques (nv,).
        fext: For every joint, the force on its body in its frame.
        convention: LOCAL or WORLD; the result is the same.
    """
    if fext is not None and isinstance(fext, Convention):
        fext, convention = None, fext
    if fext is None:
        step = data._run.aba
        found = step(q, v, tau) if data._model is model else NotImplemented
        if found is NotImplemented:
            found = run(model, data, _ABA, q, v, tau)
    else:
        found = run_under(model, data, _ABA_UNDER, q, v, tau, fext)
    if convention is _WORLD:
        computeJointJacobians(model, data, q)
    return found


def crba(model: Model, data: Data, q: Any, convention: Any = None) -> Floats:
    """The mass matrix (nv, nv), both triangles; kept in `data.M`."""
    if convention is _WORLD:
        step, algorithm = data._run.crba_world, _CRBA_WORLD
    else:
        step, algorithm = data._run.crba, _CRBA
    found = step(q) if data._model is model else NotImplemented
    return run(model, data, algorithm, q) if found is NotImplemented else found


def computeMinverse(model: Model, data: Data, q: Any = None) -> Floats:
    """The inverse of the mass matrix (nv, nv); kept in `data.Minv`."""
    if q is None:
        q = data.require(data._q_of_joints, "aba(model, data, q, v, tau)")
    step = data._run.minverse
    found = step(q) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _MINV, q)
    return found


def computeCoriolisMatrix(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The Coriolis matrix (nv, nv) of the Christoffel symbols; kept in `data.C`."""
    step = data._run.coriolis
    found = step(q, v) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _CORIOLIS, q, v)
    return found


def getCoriolisMatrix(model: Model, data: Data) -> Floats:
    """The Coriolis matrix of the last derivatives of inverse dynamics."""
    state = data.require(data._of_derivatives, "computeRNEADerivatives(model, data, q, v, a)")
    return computeCoriolisMatrix(model, data, *state[:2])


def _everything(model: TowerModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Any, ...]:
        Ag, dAg = algorithms.centroidal_matrix(model, q), algorithms.centroidal_matrix_dot(model, q, v)
        weight = np.asarray(model.gravity) * algorithms.total_mass(model)
        hg, dhg = Ag @ v, dAg @ v - np.concatenate([weight, np.zeros(3)])
        return (
            algorithms.mass_matrix(model, q),
            algorithms.bias_forces(model, q, v),
            algorithms.gravity_forces(model, q),
            algorithms.center_of_mass_jacobian(model, q),
            Ag,
            hg,
            dhg,
            about_origin(model, q, hg),
            about_origin(model, q, dhg),
            algorithms.center_of_mass(model, q),
            algorithms.center_of_mass_velocity(model, q, v),
            algorithms.kinetic_energy(model, q, v),
            algorithms.potential_energy(model, q),
            dAg,
            as_one_body(model, q),
            *rates(model)(q, v),
        )

    return run


_ALL = Algorithm(
    "everything",
    "qv",
    (
        *("M", "nle", "g", "Jcom", "Ag", "hg", "dhg", "h[0]", "f[0]", "com[0]", "vcom[0]"),
        *("energy K", "energy P", "dAg", "Ig", *RATES),
    ),
    _everything,
    late=OWN | OV | FELT_BY_ALL | MOMENTA | GAINS | CENTRES_1,
)


def computeAllTerms(model: Model, data: Data, q: Any, v: Any) -> None:
    """Fills M, nle, g, J, dJ, Jcom, Ag, dAg, hg, Ig, com, vcom, energies, placements, velocities; not C, not oMf."""
    step = data._run.everything
    if data._model is not model or step(q, v) is NotImplemented:
        run(model, data, _ALL, q, v)
    data.kinetic_energy = float(data._blocks["energy K"])
    data.potential_energy = float(data._blocks["energy P"])
    data.mechanical_energy = data.kinetic_energy + data.potential_energy
