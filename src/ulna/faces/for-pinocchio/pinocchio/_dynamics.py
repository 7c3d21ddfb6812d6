"""Inverse and forward dynamics, the mass matrix and its kin, and all of them at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from pinocchio._arrays import vector
from pinocchio._data import Data, engine_for
from pinocchio._enums import Convention
from pinocchio._kinematics import rows, stacked
from pinocchio._masses import fill_masses
from pinocchio._model import Model
from pinocchio._vectors import Force
from ulna import algorithms, spatial
from ulna.errors import InputError
from ulna.model import Model as TowerModel
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
    engine = engine_for(model, data)
    nv = model.nv
    q, v, a = vector(q, model.nq, "q"), vector(v, nv, "v"), vector(a, nv, "a")
    F = None
    if fext is None:
        tau = engine.plain("inverse_dynamics")(q, v, a)
    else:
        F = external(fext, model.njoints)
        tau = under_forces(engine, algorithms.inverse_dynamics, q, v, a, F)
    data._blocks["tau"][...] = tau
    data._motion = (engine, q.copy(), v.copy(), a.copy(), F)
    data._due.update(data._due_of_motion)
    return tau


def bodies(engine: Engine, q: Floats, v: Floats, a: Floats, F: Floats | None) -> tuple[Floats, ...]:
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
    kernel = engine_for(model, data).kernel("bias_forces")
    data._blocks["nle"][:] = found = kernel(vector(q, model.nq, "q"), vector(v, model.nv, "v"))
    return found


nle = nonLinearEffects


def computeGeneralizedGravity(model: Model, data: Data, q: Any) -> Floats:
    """The torques that hold the robot against gravity (nv,); kept in `data.g`."""
    data._blocks["g"][:] = found = engine_for(model, data).kernel("gravity_forces")(vector(q, model.nq, "q"))
    return found


def computeStaticTorque(model: Model, data: Data, q: Any, fext: Any) -> Floats:
    """The torques that hold the robot against gravity and forces on its joints (nv,); kept in `data.tau`."""
    F = external(fext, model.njoints)
    q = vector(q, model.nq, "q")
    data._blocks["tau"][:] = found = under_forces(engine_for(model, data), algorithms.static_torque, q, F)
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
    engine = engine_for(model, data)
    nv = model.nv
    q, v, tau = vector(q, model.nq, "q"), vector(v, nv, "v"), vector(tau, nv, "tau")
    if fext is None or isinstance(fext, Convention):
        found = engine.plain("forward_dynamics")(q, v, tau)
    else:
        F = external(fext, model.njoints)
        found = under_forces(engine, algorithms.forward_dynamics, q, v, tau, F)
    data._blocks["ddq"][:] = found
    return found


def crba(model: Model, data: Data, q: Any, convention: Any = None) -> Floats:
    """The mass matrix (nv, nv), both triangles; kept in `data.M`."""
    found = engine_for(model, data).plain("mass_matrix")(vector(q, model.nq, "q"))
    data._blocks["M"][...] = found
    return found


def computeMinverse(model: Model, data: Data, q: Any = None) -> Floats:
    """The inverse of the mass matrix (nv, nv); kept in `data.Minv`."""
    q = data.require(data._q, "aba(model, data, q, v, tau)") if q is None else vector(q, model.nq, "q")
    data._blocks["Minv"][:] = found = engine_for(model, data).kernel("inverse_mass_matrix")(q)
    return found


def computeCoriolisMatrix(model: Model, data: Data, q: Any, v: Any) -> Floats:
    """The Coriolis matrix (nv, nv) of the Christoffel symbols; kept in `data.C`."""
    kernel = engine_for(model, data).kernel("coriolis_matrix")
    data._blocks["C"][:] = found = kernel(vector(q, model.nq, "q"), vector(v, model.nv, "v"))
    return found


def getCoriolisMatrix(model: Model, data: Data) -> Floats:
    """The Coriolis matrix of the last derivatives of inverse dynamics."""
    state = data.require(data._of_derivatives, "computeRNEADerivatives(model, data, q, v, a)")
    return computeCoriolisMatrix(model, data, *state[:2])


def _everything(model: TowerModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Any, ...]:
        return (
            algorithms.mass_matrix(model, q),
            algorithms.bias_forces(model, q, v),
            algorithms.gravity_forces(model, q),
            algorithms.joint_jacobians(model, q),
            algorithms.joint_jacobians_dot(model, q, v),
            algorithms.center_of_mass_jacobian(model, q),
            algorithms.centroidal_matrix(model, q),
            stacked(algorithms.joint_poses(model, q)),
            rows(algorithms.joint_velocities(model, q, v)),
        )

    return run


def computeAllTerms(model: Model, data: Data, q: Any, v: Any) -> None:
    """Fills M, nle, g, J, dJ, Jcom, Ag, hg, com, vcom, energies and placements; not C, not oMf."""
    engine = engine_for(model, data)
    q, v = vector(q, model.nq, "q"), vector(v, model.nv, "v")
    blocks, tails = data._blocks, data._tails
    found = engine.made("everything", _everything, q=(model.nq,), v=(model.nv,))(q, v)
    for name, block in zip(("M", "nle", "g", "J", "dJ", "Jcom", "Ag"), found[:7], strict=True):
        blocks[name][...] = block
    tails["oMi"][...], tails["v"][...] = found[7:]
    q, v = data.keep(engine, q), v.copy()
    data._qv = data._qv_of_jacobians = (q, v)
    data._q_of_jacobians = q
    data._due.pop("v", None)
    data.hg._v[:] = blocks["Ag"] @ v
    fill_masses(model, data, q, v)
    data.kinetic_energy = float(0.5 * v @ blocks["M"] @ v)
    data.potential_energy = float(engine.kernel("potential_energy")(q))
    data.mechanical_energy = data.kinetic_energy + data.potential_energy
