"""Inverse and forward dynamics, the mass matrix and its kin, and all of them at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from pinocchio._arrays import vector
from pinocchio._data import Data
from pinocchio._enums import Convention
from pinocchio._jacobians import COLUMNS, RATES, columns, computeJointJacobians, rates
from pinocchio._kinematics import rows
from pinocchio._masses import as_one_body
from pinocchio._model import Model
from pinocchio._runs import Algorithm, run
from pinocchio._states import BODIES, COM, GAIN, MASS, NOT_BODIES, NOT_SPEED, OWN, SPEED, VCOM, WEIGHT
from pinocchio._vectors import Force
from ulna import algorithms, spatial
from ulna.errors import InputError
from ulna.model import Model as TowerModel
from ulna.recipes.base import with_mass
from ulna.typing import Array, Floats

if TYPE_CHECKING:
    from pinocchio._engine import Engine

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


def external(fext: Any, count: int) -> Floats:
    """Forces on the joints, the universe left out, as one array (njoints - 1, 6).

    Raises:
        InputError: there are not as many as joints.
    """
    if len(fext) != count:
        raise InputError(
            f"`fext` holds {len(fext)} forces; expected {count}, one for each joint, the universe included."
        )
    forces = [f.vector if isinstance(f, Force) else vector(f, 6, "fext") for f in fext]
    return np.array(forces[1:], dtype=float).reshape(count - 1, 6)


def split_forces(F: Array) -> list[spatial.Force | None]:
    """Rows of an array as the tower's forces on joints."""
    return [spatial.Force(F[k, :3], F[k, 3:]) for k in range(F.shape[0])]


def under_forces(engine: Engine, algorithm: Callable[..., Any], *arrays: Floats) -> Any:
    """An algorithm of the tower on a state and, the last of the arrays, forces on the joints; compiled once."""

    def build(tower: TowerModel) -> Any:
        return lambda *given: algorithm(tower, *given[:-1], split_forces(given[-1]))

    shapes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(arrays)}
    return engine.made((algorithm, "under forces"), build, **shapes)(*arrays)


def _inverse(model: TowerModel) -> Any:
    return lambda q, v, a: (algorithms.inverse_dynamics(model, q, v, a), q, q, v, a)


def _bias(model: TowerModel) -> Any:
    return lambda q, v: (algorithms.bias_forces(model, q, v), q, q, v, np.zeros(model.nv))


def _gravity(model: TowerModel) -> Any:
    return lambda q: (algorithms.gravity_forces(model, q), q, q)


def _forward(model: TowerModel) -> Any:
    def run(q: Array, v: Array, tau: Array) -> tuple[Array, ...]:
        ddq = algorithms.forward_dynamics(model, q, v, tau)
        return ddq, q, q, v, ddq, q, v, ddq

    return run


def _mass(model: TowerModel) -> Any:
    return lambda q: (algorithms.mass_matrix(model, q), q)


def _inverse_mass(model: TowerModel) -> Any:
    def run(q: Array) -> tuple[Array, ...]:
        return (algorithms.inverse_mass_matrix(model, q), *columns(model)(q))

    return run


def _coriolis(model: TowerModel) -> Any:
    return lambda q, v: (algorithms.coriolis_matrix(model, q, v), *rates(model)(q, v))


_OF_BODIES = ("own q", "bodies q", "bodies v", "bodies a")
_RNEA = Algorithm("rnea", "qva", ("tau", *_OF_BODIES), _inverse, (0,))
_NLE = Algorithm("nle", "qv", ("nle", *_OF_BODIES), _bias, (0,))
_GRAVITY = Algorithm("gravity", "q", ("g", "own q", "weights q"), _gravity, (0,))
_FORWARD = ("forward q", "forward v", "forward a")
_ABA = Algorithm("aba", "qvt", ("ddq", *_OF_BODIES, *_FORWARD), with_mass(_forward), (0,))
_CRBA = Algorithm("crba", "q", ("M", "own q"), _mass, (0,))
_MINV = Algorithm("minverse", "q", ("Minv", *COLUMNS), with_mass(_inverse_mass), (0,))
_CORIOLIS = Algorithm("coriolis", "qv", ("C", *RATES), _coriolis, (0,))


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
        data._due |= OWN | SPEED | BODIES
        return tau
    F, engine = external(fext, model.njoints), data.attach(model)
    state = vector(q, model.nq, "q"), vector(v, model.nv, "v"), vector(a, model.nv, "a")
    data._blocks["tau"][...] = tau = under_forces(engine, algorithms.inverse_dynamics, *state, F)
    data._blocks["own q"][...] = state[0]
    data._due |= OWN
    for bit in (SPEED, BODIES):
        data.leave(bit, (engine, *(x.copy() for x in state), F))
    return tau


def bodies(engine: Engine, q: Floats, v: Floats, a: Floats, F: Floats | None = None) -> tuple[Floats, ...]:
    """What a motion makes of every body: its velocity, its acceleration less gravity, the force on it, its momentum."""
    under = F is not None

    def build(tower: TowerModel) -> Any:
        lift = spatial.Motion(-np.asarray(tower.gravity), np.zeros(3))

        def run(q: Array, v: Array, a: Array, *F: Array) -> tuple[Array, ...]:
            speeds = algorithms.joint_velocities(tower, q, v)
            poses = algorithms.joint_poses(tower, q)
            gains = algorithms.joint_accelerations(tower, q, v, a)
            felt = [A + T.act_inverse(lift) for A, T in zip(gains, poses, strict=True)]
            wrenches = algorithms.joint_wrenches(tower, q, v, a, split_forces(F[0]) if F else None)
            momenta = [i.apply(V) for i, V in zip(tower.inertias, speeds, strict=True)]
            return rows(speeds), rows(felt), rows(wrenches), rows(momenta)

        return run

    shapes: dict[str, Any] = {"q": q.shape, "v": v.shape, "a": a.shape}
    if F is not None:
        shapes["F"] = F.shape
    return engine.made(("bodies", under), build, **shapes)(q, v, a, *(() if F is None else (F,)))


def nonLinearEffects(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """Coriolis, centrifugal and gravity torques (nv,); kept in `data.nle`."""
    step = data._run.nle
    found = step(q, v) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _NLE, q, v)
    data._due |= OWN | SPEED | BODIES
    return found


nle = nonLinearEffects


def computeGeneralizedGravity(model: Model, data: Data, q: Any) -> Floats:
    """The torques that hold the robot against gravity (nv,); kept in `data.g`."""
    step = data._run.gravity
    found = step(q) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _GRAVITY, q)
    data._due = data._due & NOT_BODIES | OWN | WEIGHT
    return found


def computeStaticTorque(model: Model, data: Data, q: Any, fext: Any) -> Floats:
    """The torques that hold the robot against gravity and forces on its joints (nv,); kept in `data.tau`."""
    F = external(fext, model.njoints)
    q = vector(q, model.nq, "q")
    engine, rest = data.attach(model), np.zeros(model.nv)
    data._blocks["tau"][:] = found = under_forces(engine, algorithms.static_torque, q, F)
    data._blocks["own q"][...] = q
    data._due |= OWN
    data.leave(BODIES, (engine, q.copy(), rest, rest, F))
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
    if fext is None or isinstance(fext, Convention):
        step = data._run.aba
        found = step(q, v, tau) if data._model is model else NotImplemented
        if found is NotImplemented:
            found = run(model, data, _ABA, q, v, tau)
        data._due |= OWN | SPEED | BODIES | GAIN
        if convention is Convention.WORLD or fext is Convention.WORLD:
            computeJointJacobians(model, data, q)
        return found
    F, engine = external(fext, model.njoints), data.attach(model)
    q, v, tau = vector(q, model.nq, "q"), vector(v, model.nv, "v"), vector(tau, model.nv, "tau")
    data._blocks["ddq"][:] = found = under_forces(engine, algorithms.forward_dynamics, q, v, tau, F)
    data._blocks["own q"][...] = q
    data._due |= OWN
    for bit in (SPEED, BODIES):
        data.leave(bit, (engine, q.copy(), v.copy(), found.copy(), F))
    data.leave(GAIN, (engine, q.copy(), v.copy(), found.copy()))
    return found


def crba(model: Model, data: Data, q: Any, convention: Any = None) -> Floats:
    """The mass matrix (nv, nv), both triangles; kept in `data.M`."""
    step = data._run.crba
    found = step(q) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _CRBA, q)
    data._due |= OWN
    if convention is Convention.WORLD:
        computeJointJacobians(model, data, q)
    return found


def computeMinverse(model: Model, data: Data, q: Any = None) -> Floats:
    """The inverse of the mass matrix (nv, nv); kept in `data.Minv`."""
    if q is None:
        q = (
            data._blocks["own q"]
            if data._engine is not None
            else data.require(None, "aba(model, data, q, v, tau)")
        )
    step = data._run.minverse
    found = step(q) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _MINV, q)
    data._due |= OWN
    return found


def computeCoriolisMatrix(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The Coriolis matrix (nv, nv) of the Christoffel symbols; kept in `data.C`."""
    step = data._run.coriolis
    found = step(q, v) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _CORIOLIS, q, v)
    data._due = data._due & NOT_SPEED | OWN
    return found


def getCoriolisMatrix(model: Model, data: Data) -> Floats:
    """The Coriolis matrix of the last derivatives of inverse dynamics."""
    state = data.require(data._of_derivatives, "computeRNEADerivatives(model, data, q, v, a)")
    return computeCoriolisMatrix(model, data, *state[:2])


def _everything(model: TowerModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Any, ...]:
        Ag = algorithms.centroidal_matrix(model, q)
        return (
            algorithms.mass_matrix(model, q),
            algorithms.bias_forces(model, q, v),
            algorithms.gravity_forces(model, q),
            algorithms.joint_jacobians_dot(model, q, v),
            algorithms.center_of_mass_jacobian(model, q),
            Ag,
            Ag @ v,
            algorithms.center_of_mass(model, q),
            algorithms.center_of_mass_velocity(model, q, v),
            rows(algorithms.joint_velocities(model, q, v)),
            algorithms.kinetic_energy(model, q, v),
            algorithms.potential_energy(model, q),
            algorithms.centroidal_matrix_dot(model, q, v),
            as_one_body(model, q),
            *(x for _ in range(5) for x in (q, v)),
            np.zeros(model.nv),
            np.zeros(model.nv),
            *columns(model)(q),
        )

    return run


_ALL = Algorithm(
    "everything",
    "qv",
    (
        *("M", "nle", "g", "dJ", "Jcom", "Ag", "hg", "com[0]", "vcom[0]", "v", "energy K", "energy P"),
        *("dAg", "Ig"),
        *(f"{name} {x}" for name in ("speeds", "rates", "moments", "bodies", "forward") for x in "qv"),
        *("bodies a", "forward a", *COLUMNS),
    ),
    _everything,
)


def computeAllTerms(model: Model, data: Data, q: Any, v: Any) -> None:
    """Fills M, nle, g, J, dJ, Jcom, Ag, dAg, hg, Ig, com, vcom, energies, placements, velocities; not C, not oMf."""
    step = data._run.everything
    if data._model is not model or step(q, v) is NotImplemented:
        run(model, data, _ALL, q, v)
    data._due = data._due & NOT_SPEED | OWN | BODIES | GAIN | COM | VCOM | MASS
    data.kinetic_energy = float(data._blocks["energy K"])
    data.potential_energy = float(data._blocks["energy P"])
    data.mechanical_energy = data.kinetic_energy + data.potential_energy
