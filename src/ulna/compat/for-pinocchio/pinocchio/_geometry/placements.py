"""Where the geometries of a robot are."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from pinocchio._algorithms.kinematics import forwardKinematics
from pinocchio._containers.arguments import IndexOutOfRange, checked
from pinocchio._containers.arrays import not_applicable
from pinocchio._data.data import Data
from pinocchio._geometry.geometry_data import GeometryData, Placing
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._model.model import Model
from pinocchio._spatial.small_kernels import pose
from ulna.compiler import compile as compile_function
from ulna.compiler.runtime.repeated_calls import call_cache, repeated_calls
from ulna.errors import InputError
from ulna.typing import Array

_calls = call_cache(4, weak=4)
_FIRST_CALLS = 10
"""How many calls for the first model compile nothing."""
_MOST_COMPILED = 100
"""Geometries beyond which nothing is compiled: code for thousands takes seconds to compile, NumPy a millisecond."""


@repeated_calls(_calls)
@checked
def updateGeometryPlacements(
    model: Model, data: Data, geometry_model: GeometryModel, geometry_data: GeometryData, q: Any = None
) -> None:
    """Fills `geometry_data.oMg` from `data.oMi`; with q, forwardKinematics comes first.

    Args:
        data: Its data, after forwardKinematics if `q` is not passed.
        geometry_data: Their data, which is filled.

    Raises:
        InputError: `geometry_data` has another number of geometries.
        IndexOutOfRange: A geometry is on a joint that the model does not have.
    """
    objects, known = geometry_model.geometryObjects, geometry_data._placing
    if known.objects is not objects:
        check_geometries(geometry_model, geometry_data)
    if q is not None:
        forwardKinematics(model, data, q)
    oMi = data._arrays["oMi"]
    if known.objects is objects and known.oMi is oMi and known.call() is not NotImplemented:
        if q is None:
            _calls.add(known.call, 0, model, data, geometry_model, geometry_data)
        return
    check_geometries(geometry_model, geometry_data)
    joints = [g.parentJoint for g in objects]
    if joints and max(joints) >= model.njoints:
        raise IndexOutOfRange(
            f"The geometries are on joints up to {max(joints)}; the model has {model.njoints}. They are those of "
            "another robot: buildGeomFromUrdf(model, ...) makes those of this one."
        )
    placements = [g._placement._m for g in objects]
    np.matmul(oMi[joints], np.array(placements).reshape(-1, 4, 4), out=geometry_data._block)
    if not 0 < len(joints) <= _MOST_COMPILED or model.first_calls.includes(
        "updateGeometryPlacements", _FIRST_CALLS
    ):
        return
    for one in objects:
        one._count_in(objects.changes)
    call = _kernel(len(oMi), tuple(joints)).into(
        geometry_data._block,
        trailing_inputs=[oMi, *placements],
        watch=[(objects.changes, objects.changes.copy())],
        otherwise=not_applicable,
    )
    geometry_data._keep(_placing=Placing(objects, oMi, call))


@functools.lru_cache(maxsize=32)
def _kernel(joints: int, carriers: tuple[int, ...]) -> Any:
    """The kernel from placements of joints (n, 4, 4), and of geometries on them (4, 4), to those in the world."""

    def run(oMi: Array, *placements: Array) -> Array:
        return np.stack(
            [(pose(oMi[j]) @ pose(M)).matrix() for j, M in zip(carriers, placements, strict=True)]
        )

    shapes: dict[str, Any] = {f"M{k}": (4, 4) for k in range(len(carriers))}
    return compile_function(run, **{"oMi": (joints, 4, 4), **shapes})


def check_geometries(geometry_model: Any, geometry_data: Any) -> None:
    """Checks that a GeometryData is of a model with as many geometries.

    Args:
        geometry_data: Their data.

    Raises:
        InputError: It was made for another number of geometries.
    """
    if len(geometry_data.oMg) != geometry_model.ngeoms:
        raise InputError(
            f"This GeometryData was made for {len(geometry_data.oMg)} geometries; now there are "
            f"{geometry_model.ngeoms}. Make a new one: geometry_model.createData()."
        )
