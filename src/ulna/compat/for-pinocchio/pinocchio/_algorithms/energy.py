"""Kinetic and potential energy."""

from __future__ import annotations

from typing import Any

from pinocchio._data.algorithm import Algorithm
from pinocchio._data.binding import run
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import JOINTS, VELOCITIES_IN_WORLD, rows, stacked
from pinocchio._model.model import Model
from ulna import algorithms
from ulna.model import Model as CoreModel
from ulna.typing import Array

__all__ = ["computeKineticEnergy", "computeMechanicalEnergy", "computePotentialEnergy"]


def _kinetic(model: CoreModel) -> Any:
    def run(q: Array, v: Array) -> tuple[Array, ...]:
        velocities = rows(algorithms.joint_velocities(model, q, v))
        return algorithms.kinetic_energy(model, q, v), stacked(algorithms.joint_poses(model, q)), velocities

    return run


def _potential(model: CoreModel) -> Any:
    return lambda q: (algorithms.potential_energy(model, q), stacked(algorithms.joint_poses(model, q)))


_KINETIC = Algorithm(
    "kinetic", "qv", ("energy K", "oMi", "v"), _kinetic, (0,), deferred=JOINTS | VELOCITIES_IN_WORLD
)
_POTENTIAL = Algorithm("potential", "q", ("energy P", "oMi"), _potential, (0,), deferred=JOINTS)


def computeKineticEnergy(model: Model, data: Data, q: Any = None, v: Any = None) -> float:
    """The kinetic energy [J]; kept in `data.kinetic_energy`."""
    if q is None:
        q, v = data.require(data._qv, "forwardKinematics(model, data, q, v)")
    energy = data._bound.kinetic(q, v) if data._model is model else NotImplemented
    if energy is NotImplemented:
        energy = run(model, data, _KINETIC, q, v)
    data.kinetic_energy = energy = float(energy)
    return energy


def computePotentialEnergy(model: Model, data: Data, q: Any = None) -> float:
    """The potential energy [J]; kept in `data.potential_energy`."""
    if q is None:
        q = data.require(data._q, "forwardKinematics(model, data, q)")
    energy = data._bound.potential(q) if data._model is model else NotImplemented
    if energy is NotImplemented:
        energy = run(model, data, _POTENTIAL, q)
    data.potential_energy = energy = float(energy)
    return energy


def computeMechanicalEnergy(model: Model, data: Data, q: Any = None, v: Any = None) -> float:
    """Their sum [J]; kept in `data.mechanical_energy`."""
    kinetic = computeKineticEnergy(model, data, q, v)
    data.mechanical_energy = kinetic + computePotentialEnergy(model, data, q)
    return data.mechanical_energy
