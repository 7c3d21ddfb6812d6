"""Fields of a Data that are computed when they are read: of which state, and how."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from ulna import algorithms, spatial
from ulna.model import Model as TowerModel
from ulna.recipes.mass import with_mass
from ulna.typing import Array, Floats

if TYPE_CHECKING:
    from pinocchio._data.data import Data
    from pinocchio._model.kernels import Engine

_CENTRES = {"com": "center_of_mass", "vcom": "center_of_mass_velocity", "acom": "center_of_mass_acceleration"}


@final
@dataclass(frozen=True, eq=False)
class Late:
    """How fields are computed when they are read.

    Attributes:
        inputs: A letter for each input: q, v, a, f.
        fill: Called with a Data, kernels, the fields to write, and the inputs; forces on the joints may follow.
    """

    inputs: str
    fill: Callable[..., None]


def stacked(poses: Sequence[spatial.SE3]) -> Array:
    """Placements as one array (n, 4, 4)."""
    return np.stack([T.matrix() for T in poses]) if poses else np.zeros((0, 4, 4))


def rows(motions: Sequence[Any]) -> Array:
    """Motions or forces as one array (n, 6)."""
    return np.stack([m.vector() for m in motions]) if motions else np.zeros((0, 6))


def split_forces(F: Array) -> list[spatial.Force | None]:
    """Rows of an array as the tower's forces on joints."""
    return [spatial.Force(F[k, :3], F[k, 3:]) for k in range(F.shape[0])]


def _compiled(inputs: str, of: Callable[..., dict[str, Any]], sums: bool = False) -> Late:
    """Fields that `of(tower, *inputs, forces)` tells; of `sums` the universe's are there before."""
    motion = inputs.rstrip("f")

    def fill(data: Data, engine: Engine, fields: tuple[str, ...], *state: Floats) -> None:
        def build(tower: TowerModel) -> Any:
            def run(*given: Array) -> tuple[Array, ...]:
                forces = split_forces(given[-1]) if len(given) > len(motion) else None
                found = of(tower, *given[: len(motion)], forces)
                return tuple(found[field]() for field in fields)

            return run

        shapes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(state)}
        found = engine.made((of, fields, len(state)), build, **shapes)(*state)
        for field, values in zip(fields, found, strict=True):
            data.target(field)[...] = values
            if field in BODIES and not sums:
                data._blocks[field][0] = 0.0
            if field in ("a_gf", "oa_gf"):
                data._blocks[field][0, :3] = -engine.gravity

    return Late(inputs, fill)


def _own_poses(model: TowerModel, q: Array, _: Any) -> dict[str, Any]:
    return {"liMi": lambda: own_poses(model, q)}


def own_poses(model: TowerModel, q: Array) -> Array:
    """Each joint in the frame of the joint before it, (n, 4, 4)."""
    return stacked([j.placement @ j.kind.transform(j.q_of(q)) for j in model.joints])


def _velocities(model: TowerModel, q: Array, v: Array, _: Any) -> dict[str, Any]:
    speeds = algorithms.joint_velocities(model, q, v)
    poses = algorithms.joint_poses(model, q)
    momenta = [i.apply(V) for i, V in zip(model.inertias, speeds, strict=True)]
    carried = {"ov": lambda: _carried(poses, speeds), "oh": lambda: _carried(poses, momenta)}
    return {"v": lambda: rows(speeds), **carried}


def _motions(model: TowerModel, q: Array, v: Array, a: Array, _: Any) -> dict[str, Any]:
    gains = algorithms.joint_accelerations(model, q, v, a)
    poses = algorithms.joint_poses(model, q)
    return {"a": lambda: rows(gains), "oa": lambda: _carried(poses, gains)}


def _bodies(model: TowerModel, q: Array, v: Array, a: Array, forces: Any) -> dict[str, Any]:
    lift = spatial.Motion(-np.asarray(model.gravity), np.zeros(3))
    poses = algorithms.joint_poses(model, q)
    speeds = algorithms.joint_velocities(model, q, v)
    gains = algorithms.joint_accelerations(model, q, v, a)
    felt = [A + T.act_inverse(lift) for A, T in zip(gains, poses, strict=True)]
    momenta = [i.apply(V) for i, V in zip(model.inertias, speeds, strict=True)]

    def wrenches() -> list[Any]:
        return algorithms.joint_wrenches(model, q, v, a, forces)

    return {
        "v": lambda: rows(speeds),
        "a_gf": lambda: rows(felt),
        "f": lambda: rows(wrenches()),
        "h": lambda: rows(momenta),
        "ov": lambda: _carried(poses, speeds),
        "oa": lambda: _carried(poses, gains),
        "oa_gf": lambda: _carried(poses, felt),
        "of": lambda: _carried(poses, wrenches()),
        "oh": lambda: _carried(poses, momenta),
    }


def _carried(poses: Sequence[spatial.SE3], own: Sequence[Any]) -> Array:
    """From the joints' frames into the world's."""
    return rows([T.act(one) for T, one in zip(poses, own, strict=True)])


def _totals(model: TowerModel, q: Array, v: Array, a: Array, _: Any) -> dict[str, Any]:
    """Momenta and their rates of all that each joint moves."""
    poses = algorithms.joint_poses(model, q)
    speeds = algorithms.joint_velocities(model, q, v)
    momenta = [i.apply(V) for i, V in zip(model.inertias, speeds, strict=True)]
    gains = algorithms.joint_accelerations(model, q, v, a)
    rates = [
        i.apply(A) + V.cross(h) for i, V, A, h in zip(model.inertias, speeds, gains, momenta, strict=True)
    ]

    def gathered(own: Sequence[Any], local: bool) -> Array:
        found = [T.act(one) for T, one in zip(poses, own, strict=True)]
        for k in reversed(range(len(found))):
            if model.joints[k].parent >= 0:
                found[model.joints[k].parent] += found[k]
        return rows([T.act_inverse(one) for T, one in zip(poses, found, strict=True)] if local else found)

    return {
        "h": lambda: gathered(momenta, True),
        "f": lambda: gathered(rates, True),
        "oh": lambda: gathered(momenta, False),
        "of": lambda: gathered(rates, False),
    }


def _slopes(model: TowerModel, q: Array, v: Array, a: Array, forces: Any) -> dict[str, Any]:
    by_q, by_v, _ = algorithms.inverse_dynamics_derivatives(model, q, v, a, forces)
    return {"dtau_dq": lambda: by_q, "dtau_dv": lambda: by_v}


def _map(model: TowerModel, q: Array, _: Any) -> dict[str, Any]:
    return {"Ag": lambda: algorithms.centroidal_matrix(model, q)}


def _inverse_mass(model: TowerModel, q: Array, _: Any) -> dict[str, Any]:
    return {"Minv": lambda: with_mass(_inverse_of)(model)(q)}


def _inverse_of(model: TowerModel) -> Any:
    return lambda q: algorithms.inverse_mass_matrix(model, q)


def _centres(data: Data, engine: Engine, fields: tuple[str, ...], *state: Floats) -> None:
    """Of what each joint moves, in its frame."""
    tower = engine.model
    poses = algorithms.joint_poses(tower, state[0])
    for field in fields:
        given = state[: list(_CENTRES).index(field) + 1]
        for i, (joint, pose) in enumerate(zip(tower.joints, poses, strict=True), start=1):
            if algorithms.total_mass(tower, joint.name) > 0.0:
                found = engine.kernel(_CENTRES[field], subtree=joint.name)(*given)
                own = pose.rotation.T @ (found - pose.translation if field == "com" else found)
                data._blocks[field][i] = own


def _masses(data: Data, engine: Engine, fields: tuple[str, ...]) -> None:
    """Of what each joint moves; the universe, first, counts all that moves."""
    tower = engine.model
    for i, name in enumerate((None, *tower.joint_names)):
        list.__setitem__(data.mass, i, float(algorithms.total_mass(tower, name)))


OWN = {"liMi": _compiled("q", _own_poses)}
_BODIES = _compiled("qva", _bodies)
_MOTIONS = _compiled("qva", _motions)
_SPEEDS = _compiled("qv", _velocities)
SPEEDS = dict.fromkeys(("v", "ov"), _SPEEDS)
OV = {"ov": _SPEEDS}
OH = {"oh": _SPEEDS}
GAINS = dict.fromkeys(("a", "oa"), _MOTIONS)
OA = {"oa": _MOTIONS}
FELT = dict.fromkeys(("a_gf", "f", "oa_gf", "of"), _BODIES)
"""What a motion makes bodies feel."""
FELT_BY_ALL = {**FELT, "f": _compiled("qva", _bodies, sums=True)}
"""The same, where `f[0]` is there before."""
BODIES = {**SPEEDS, **dict.fromkeys(("h", "oh"), _BODIES), **FELT}
"""The same, with velocities and momenta."""
UNDER_FORCES = dict.fromkeys(BODIES, _compiled("qvaf", _bodies))
"""The same, where forces act on the joints."""
_TOTALS = _compiled("qva", _totals, sums=True)
MOMENTA = {"h": _TOTALS}
RATES_OF_MOMENTA = dict.fromkeys(("h", "f"), _TOTALS)
"""Momenta and their rates of all that each joint moves."""
IN_WORLD = dict.fromkeys(("oh", "of"), _TOTALS)
SLOPES = dict.fromkeys(("dtau_dq", "dtau_dv"), _compiled("qva", _slopes))
SLOPES_UNDER_FORCES = dict.fromkeys(SLOPES, _compiled("qvaf", _slopes))
MAP = {"Ag": _compiled("q", _map)}
MINV = {"Minv": _compiled("q", _inverse_mass)}
MASSES = {"mass": Late("", _masses)}
CENTRES = {"com": Late("q", _centres), **MASSES}
CENTRES_1 = {**CENTRES, "vcom": Late("qv", _centres)}
CENTRES_2 = {**CENTRES_1, "acom": Late("qva", _centres)}
FILLED_BY = {
    "Ag": "computeCentroidalMap(model, data, q)",
    "Jcom": "jacobianCenterOfMass(model, data, q)",
    "Minv": "computeMinverse(model, data, q)",
    "dFda": "computeCentroidalDynamicsDerivatives(model, data, q, v, a)",
    "dFdq": "computeCentroidalDynamicsDerivatives(model, data, q, v, a)",
    "dFdv": "computeCentroidalDynamicsDerivatives(model, data, q, v, a)",
    "dtau_dq": "computeRNEADerivatives(model, data, q, v, a)",
    "dtau_dv": "computeRNEADerivatives(model, data, q, v, a)",
    "dlambda_dtau": "computeConstraintDynamicsDerivatives(model, data, contact_models, contact_datas)",
    "g": "computeGeneralizedGravity(model, data, q)",
    "oa": "computeForwardKinematicsDerivatives(model, data, q, v, a)",
    "of": "computeRNEADerivatives(model, data, q, v, a)",
    "tau": "rnea(model, data, q, v, a)",
}
"""The call that fills a field that others spoil."""
