"""Fields of a Data that derivatives are made of, in the world: of accelerations and of forces, when they are read."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pinocchio._data.algorithm import Deferred
from pinocchio._data.evaluated_model import loaded_with
from pinocchio._data.states import FieldStates
from pinocchio._data.storage import FILLED_BY
from pinocchio._tables.world_derivatives import WorldDerivatives
from ulna.errors import InputError
from ulna.typing import Floats

_COLUMNS: dict[str, Callable[[WorldDerivatives], Floats]] = {
    "dAdq": lambda d: d.accelerations(False),
    "dAdv": lambda d: d.by_velocity,
    "dFda": lambda d: d.by_acceleration,
    "dFdq": WorldDerivatives.forces_by_configuration,
    "dFdv": WorldDerivatives.forces_by_velocity,
}


def _fill_columns(data: FieldStates, compiled: Any, fields: tuple[str, ...], *state: Floats) -> None:
    evaluator = loaded_with(compiled, data)
    derivatives = WorldDerivatives(evaluator, *state)
    if "dFdq" in fields:
        data._arrays["center_columns q"][...] = np.nan  # they are about the world's origin
    for field in fields:
        data._arrays[field][...] = evaluator.by_entries(_COLUMNS[field](derivatives))


def _fill_forces_by_acceleration(data: FieldStates, compiled: Any, _: tuple[str, ...], q: Floats) -> None:
    evaluator = loaded_with(compiled, data)
    data._arrays["dFda"][...] = evaluator.by_entries(WorldDerivatives(evaluator, q).by_acceleration)


def _fill_coriolis(data: FieldStates, compiled: Any, _: tuple[str, ...], q: Floats, v: Floats) -> None:
    evaluator = loaded_with(compiled, data)
    data._arrays["B"][1:] = evaluator.of_joints(WorldDerivatives(evaluator, q, v).coriolis_of_subtrees)


def _fill_coriolis_forces(data: FieldStates, compiled: Any, _: tuple[str, ...], q: Floats, v: Floats) -> None:
    evaluator = loaded_with(compiled, data)
    entries = evaluator.steps.table.entries
    if len(np.unique(entries)) < len(entries):
        raise InputError(
            "`data.dFdv` after computeCoriolisMatrix holds an intermediate result in Pinocchio where joints share a "
            f"velocity, as mimic joints do, and nothing here. Call {FILLED_BY['dFdv']} first."
        )
    data._arrays["dFdv"][...] = evaluator.by_entries(WorldDerivatives(evaluator, q, v).coriolis_forces())


def _fill_composite_forces(data: FieldStates, compiled: Any, fields: tuple[str, ...], q: Floats) -> None:
    evaluator = loaded_with(compiled, data)
    forces, placements = WorldDerivatives(evaluator, q).by_acceleration, evaluator.placements()
    for joint, T in enumerate(placements, start=1):
        moved = forces * (evaluator.beyond(joint))[:, None]
        linear, angular = moved[:, :3], moved[:, 3:] - np.cross(T[:3, 3], moved[:, :3])
        local = np.concatenate([linear @ T[:3, :3], angular @ T[:3, :3]], axis=1)
        data._arrays["Fcrb"][joint] = evaluator.by_entries(local)


DERIVATIVE_COLUMNS = dict.fromkeys(_COLUMNS, Deferred("qva", _fill_columns))
"""Accelerations by q and v, and forces by q, v and a, after derivatives of inverse or forward dynamics."""
DERIVATIVE_COLUMNS_UNDER_FORCES = dict.fromkeys(_COLUMNS, Deferred("qvaf", _fill_columns))
"""The same, where forces act on the joints."""
ACCELERATION_COLUMNS = dict.fromkeys(("dAdq", "dAdv"), DERIVATIVE_COLUMNS["dAdq"])
"""Those of accelerations alone."""
FORCES_BY_ACCELERATION = {"dFda": Deferred("q", _fill_forces_by_acceleration)}
"""Forces by a alone."""
CORIOLIS_COLUMNS = {"B": Deferred("qv", _fill_coriolis), "dFdv": Deferred("qv", _fill_coriolis_forces)}
"""After the Coriolis matrix."""
COMPOSITE_FORCES = {"Fcrb": Deferred("q", _fill_composite_forces)}
"""For each joint, in its frame, the forces that columns of J cause on what they move (6, nv); after the mass matrix."""
