"""Where the geometries of a robot are."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.kinematics import forwardKinematics
from pinocchio._containers.arguments import IndexOutOfRange
from pinocchio._data.data import Data
from pinocchio._geometry.geometry_data import GeometryData
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._model.model import Model
from ulna.errors import InputError


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
    check_geometries(geometry_model, geometry_data)
    if q is not None:
        forwardKinematics(model, data, q)
    objects = geometry_model.geometryObjects
    joints = [g.parentJoint for g in objects]
    if joints and max(joints) >= model.njoints:
        raise IndexOutOfRange(
            f"The geometries are on joints up to {max(joints)}; the model has {model.njoints}. They are those of "
            "another robot: buildGeomFromUrdf(model, ...) makes those of this one."
        )
    placements = np.array([g._placement._m for g in objects]).reshape(-1, 4, 4)
    np.matmul(data._arrays["oMi"][joints], placements, out=geometry_data._block)


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
