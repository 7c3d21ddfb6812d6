"""Dynamics under constraints that are given by their Jacobian, and the Delassus matrix."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._arrays import exact, numbers, vector
from pinocchio._data import Data, engine_for
from pinocchio._dynamics import computeAllTerms, crba
from pinocchio._model import Model
from pinocchio._proximal import damping_of
from ulna import linalg
from ulna.algorithms.constrained_dynamics_damped import Damped, damped_response
from ulna.errors import InputError, ShapeError
from ulna.model import Model as TowerModel
from ulna.typing import Array, Floats

__all__ = [
    "computeKKTContactDynamicMatrixInverse",
    "forwardDynamics",
    "getKKTContactDynamicMatrixInverse",
]


def _jacobian(model: Model, J: Any) -> Floats:
    J = numbers(J, "constraint_jacobian")
    if J.ndim != 2 or J.shape[1] != model.nv:
        raise ShapeError("constraint_jacobian", J.shape, f"(m, {model.nv})")
    return J


def _factored(model: Model, data: Data, J: Floats, damping: float) -> tuple[Floats, Floats]:
    """M^-1 J^T, and the damped Delassus matrix; kept for getKKTContactDynamicMatrixInverse.

    Raises:
        InputError: rows of the Jacobian depend on each other.
    """
    M = _mass(data)
    MJ = np.asarray(np.linalg.solve(M, J.T), dtype=float)
    G = J @ MJ + damping * np.eye(len(J))
    if len(J) and not np.linalg.eigvalsh(G)[0] > 1e-14 * np.trace(G) / len(J):
        raise _dependent(J)
    data._damped = (J.shape, damping)
    return MJ, G


def _mass(data: Data) -> Floats:
    M = data._blocks["M"]
    if not M[:1].any() and not M.any():
        raise InputError("`data.M` holds no mass matrix yet. Give q, or call crba(model, data, q) first.")
    return M


def _dependent(J: Floats) -> InputError:
    return InputError(
        f"Rows of the constraint Jacobian, of {len(J)} rows and rank {np.linalg.matrix_rank(J)}, depend on each "
        "other, so that their forces are not unique. Leave some out, or give a damping such as 1e-8."
    )


def _response(
    model: Model, data: Data, J: Floats, drive: Floats, g: Floats, damping: Any
) -> tuple[Floats, Floats]:
    """a and f of M a = drive + J^T f, J a + g = -damping f.

    Raises:
        InputError: rows of the Jacobian depend on each other.
    """
    M, mu = _mass(data), damping_of(damping)
    if not len(J):
        return np.asarray(np.linalg.solve(M, drive), dtype=float), np.zeros(0)

    def build(tower: TowerModel) -> Any:
        apart = np.zeros((tower.nv, tower.nv))
        for k in range(len(tower.joints)):
            for i in tower.subtree(k):
                apart[np.ix_(_rows(tower, k), _rows(tower, i))] = 1.0
        apart = np.maximum(apart, apart.T)

        def run(M: Array, J: Array, drive: Array, g: Array, mu: Array) -> tuple[Any, ...]:
            found = damped_response(M * apart, J, drive, g, Damped(mu, 0.0, 0.0, 1))
            return found.a, found.forces, found.unique

        return run

    sizes: dict[str, Any] = {"M": M.shape, "J": J.shape, "drive": drive.shape, "g": g.shape, "mu": ()}
    a, forces, unique = data.attach(model).made(("response", len(J)), build, **sizes)(M, J, drive, g, mu)
    if unique == 0.0:
        raise _dependent(J)
    data._damped = (J.shape, mu)
    return a, forces


def _rows(tower: TowerModel, k: int) -> range:
    """Where a joint's velocities stand, those of a mimic joint with what it follows."""
    joint = tower.joints[k]
    leader = tower.joints[joint.mimic.source] if joint.mimic is not None else joint
    return range(leader.idx_v, leader.idx_v + leader.kind.nv)


def forwardDynamics(
    model: Model, data: Data, *state: Any, damping: float | None = None, **named: Any
) -> Floats:
    """The accelerations under J a + drift = 0 (nv,); kept in `data.ddq`, the forces in `data.lambda_c`.

    `forwardDynamics(model, data, q, v, tau, J, drift[, damping])`; without q and v after computeAllTerms.
    """
    told = list(state)
    for name in ("q", "v", "tau", "constraint_jacobian", "constraint_drift"):
        if name in named:
            told.append(named.pop(name))
    if named or not 3 <= len(told) <= 6:
        raise InputError("forwardDynamics takes (model, data, [q, v,] tau, J, drift[, damping]).")
    if len(told) >= 5:
        q, v, *told = told
        computeAllTerms(model, data, q, v)
    else:
        engine_for(model, data)
    tau, J, drift = exact(told[0], model.nv, "tau"), _jacobian(model, told[1]), told[2]
    drift = exact(drift, len(J), "constraint_drift")
    given = told[3] if len(told) > 3 else damping
    a, forces = _response(model, data, J, tau - data._blocks["nle"], drift, 0.0 if given is None else given)
    data._blocks["lambda_c"] = forces
    data._blocks["ddq"][:] = a
    return a


def impact_with_jacobian(
    model: Model, data: Data, *state: Any, restitution_coefficient: float = 0.0, damping: float = 0.0
) -> Floats:
    """The velocity after an impact on what a Jacobian describes; see `impulseDynamics`."""
    told = list(state)
    at = next((i for i, x in enumerate(told) if np.ndim(x) == 2 and np.shape(x)[1] == model.nv and i), None)
    if at not in (1, 2):
        raise InputError(
            "impulseDynamics takes (model, data, q, v, constraints, datas), or (model, data, [q,] v, J) with a "
            f"Jacobian of {model.nv} columns."
        )
    if at == 2:
        crba(model, data, told.pop(0))
    else:
        engine_for(model, data)
    v, J = vector(told[0], model.nv, "v_before"), _jacobian(model, told[1])
    rest = dict(zip(("restitution_coefficient", "damping"), told[2:], strict=False))
    back = float(rest.get("restitution_coefficient", restitution_coefficient))
    jump, impulses = _response(
        model, data, J, np.zeros(model.nv), (1.0 + back) * (J @ v), rest.get("damping", damping)
    )
    data._blocks["impulse_c"] = impulses
    data._blocks["dq_after"][:] = found = v + jump
    return found


def computeKKTContactDynamicMatrixInverse(
    model: Model, data: Data, q: Any, constraint_jacobian: Any, damping: float = 0.0
) -> Floats:
    """The inverse of [[M, J^T], [J, -damping 1]], (nv + m, nv + m)."""
    crba(model, data, q)
    J = _jacobian(model, constraint_jacobian)
    return _kkt(data, J, *_factored(model, data, J, damping_of(damping)))


def getKKTContactDynamicMatrixInverse(model: Model, data: Data, constraint_jacobian: Any) -> Floats:
    """The same with the mass matrix and the damping of the last forwardDynamics or impulseDynamics with a Jacobian."""
    engine_for(model, data)
    J = _jacobian(model, constraint_jacobian)
    shape, damping = data.require(data._damped, "forwardDynamics or impulseDynamics with a Jacobian")
    if shape != J.shape:
        raise InputError(
            f"The Jacobian has {len(J)} rows; that of forwardDynamics or impulseDynamics had {shape[0]}."
        )
    return _kkt(data, J, *_factored(model, data, J, damping))


def _kkt(data: Data, J: Floats, MJ: Floats, G: Floats) -> Floats:
    S = linalg.inverse(G)
    corner = MJ @ S
    return np.block([[linalg.inverse(data._blocks["M"]) - corner @ MJ.T, corner], [corner.T, -S]])
