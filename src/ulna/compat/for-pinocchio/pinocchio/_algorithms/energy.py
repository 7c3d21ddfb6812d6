"""Kinetic and potential energy."""

from __future__ import annotations

from typing import Any

from pinocchio._algorithms.stored_sums import KINETIC_ENERGY, MECHANICAL_ENERGY, POTENTIAL_ENERGY
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import JOINTS, VELOCITIES_IN_WORLD, rows, stacked
from pinocchio._data.functions import algorithm
from pinocchio._model.model import Model
from ulna import algorithms
from ulna.model import Model as CoreModel
from ulna.typing import Array

__all__ = ["computeKineticEnergy", "computeMechanicalEnergy", "computePotentialEnergy"]


def energies(model: CoreModel, q: Array, v: Array) -> tuple[Array, Array, Array]:
    """The kinetic energy, the potential one, and their sum [J].

    Args:
        model: Ulna's model.

    Returns:
        The energies [J], () each.
    """
    kinetic, potential = algorithms.kinetic_energy(model, q, v), algorithms.potential_energy(model, q)
    return kinetic, potential, kinetic + potential


def _placed(model: CoreModel, q: Array, v: Array) -> tuple[Array, Array]:
    return stacked(algorithms.joint_poses(model, q)), rows(algorithms.joint_velocities(model, q, v))


def _kinetic(model: CoreModel) -> Any:
    return lambda q, v: (algorithms.kinetic_energy(model, q, v), *_placed(model, q, v))


def _potential(model: CoreModel) -> Any:
    return lambda q: (algorithms.potential_energy(model, q), stacked(algorithms.joint_poses(model, q)))


def _mechanical(model: CoreModel) -> Any:
    return lambda q, v: (*energies(model, q, v), *_placed(model, q, v))


_WITH_VELOCITY: dict[str, Any] = {
    "returns_number": True,
    "deferred": JOINTS | VELOCITIES_IN_WORLD,
    "default_state": ("_qv", "forwardKinematics(model, data, q, v)"),
}


@algorithm(
    fills=("energy K", "oMi", "v"),
    kernel=_kinetic,
    returns=(0,),
    depends_on="masses",
    of_fields=KINETIC_ENERGY.run,
    **_WITH_VELOCITY,
)
def computeKineticEnergy(model: Model, data: Data, q: Any = None, v: Any = None) -> float:
    """The kinetic energy [J]; kept in `data.kinetic_energy`.

    Args:
        q: Configuration (nq,) [rad or m]; None for the placements and velocities that `data` holds.

    Returns:
        The energy [J].
    """
    ...


@algorithm(
    fills=("energy P", "oMi"),
    kernel=_potential,
    returns=(0,),
    returns_number=True,
    deferred=JOINTS,
    default_state=("_q", "forwardKinematics(model, data, q)"),
    of_fields=POTENTIAL_ENERGY.run,
)
def computePotentialEnergy(model: Model, data: Data, q: Any = None) -> float:
    """The potential energy [J]; kept in `data.potential_energy`.

    Args:
        q: Configuration (nq,) [rad or m]; None for the placements and velocities that `data` holds.

    Returns:
        The energy [J].
    """
    ...


@algorithm(
    fills=("energy K", "energy P", "energy K + P", "oMi", "v"),
    kernel=_mechanical,
    returns=(2,),
    of_fields=MECHANICAL_ENERGY.run,
    **_WITH_VELOCITY,
)
def computeMechanicalEnergy(model: Model, data: Data, q: Any = None, v: Any = None) -> float:
    """Kinetic plus potential energy [J]; kept in `data.mechanical_energy`.

    Args:
        q: Configuration (nq,) [rad or m]; None for the placements and velocities that `data` holds.

    Returns:
        The energy [J].
    """
    ...
