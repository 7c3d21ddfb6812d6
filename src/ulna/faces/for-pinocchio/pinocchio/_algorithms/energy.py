"""Kinetic and potential energy."""

from __future__ import annotations

from typing import Any

from pinocchio._data.binding import Algorithm, run
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import OV, OWN, rows, stacked
from pinocchio._model.model import Model
from ulna import algorithms
from ulna.model import Model as TowerModel
from ulna.typing import Array

__all__ = ["computeKineticEnergy", "computeMechanicalEnergy", "computePotentialEnergy"]


def _kinetic(model: TowerModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        speeds = rows(algorithms.joint_velocities(model, q, v))
        places = stacked(algorithms.joint_poses(model, q))
        return algorithms.kinetic_energy(model, q, v), places, q, speeds, q, v

    return run


def _potential(model: TowerModel) -> Any:
    return lambda q: (algorithms.potential_energy(model, q), stacked(algorithms.joint_poses(model, q)), q)


_KINETIC = Algorithm(
    "kinetic",
    "qv",
    ("energy K", "oMi", "places q", "v", "speeds q", "speeds v"),
    _kinetic,
    (0,),
    late=OWN | OV,
)
_POTENTIAL = Algorithm("potential", "q", ("energy P", "oMi", "places q"), _potential, (0,), late=OWN)


def computeKineticEnergy(model: Model, data: Data, q: Any = None, v: Any = None) -> float:
    """The kinetic energy [J]; kept in `data.kinetic_energy`."""
    if q is None:
        q, v = data.require(data._qv, "forwardKinematics(model, data, q, v)")
    step = data._run.kinetic
    found = step(q, v) if data._model is model else NotImplemented
    if found is NotImplemented:
        found = run(model, data, _KINETIC, q, v)
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
    data.potential_energy = energy = float(found)
    return energy


def computeMechanicalEnergy(model: Model, data: Data, q: Any = None, v: Any = None) -> float:
    """Their sum [J]; kept in `data.mechanical_energy`."""
    kinetic = computeKineticEnergy(model, data, q, v)
    data.mechanical_energy = kinetic + computePotentialEnergy(model, data, q)
    return data.mechanical_energy
