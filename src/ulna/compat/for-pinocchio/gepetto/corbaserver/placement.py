"""Seven numbers of a placement, and the order that their quaternion stands in."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from ulna.checks.arrays import check_finite
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.spatial import matrix_to_quat_xyzw, quat_xyzw_to_matrix
from ulna.typing import Floats

VARIABLE = "ULNA_GEPETTO_QUATERNION"
"""The environment variable that says how quaternions stand in configurations."""
_ORDERS = {"xyzw": [0, 1, 2, 3], "wxyz": [1, 2, 3, 0]}
_chosen: list[str] = []


def quaternion_order(order: str | None = None) -> str:
    """How quaternions stand in configurations: "xyzw", as since 2017, or "wxyz", as in older scripts.

    Without anything said, it is what the variable ULNA_GEPETTO_QUATERNION says, and else "xyzw".

    Args:
        order: The order from now on; only asks when not given.

    Raises:
        UnknownName: It is neither.
    """
    if order is not None:
        _chosen[:] = [_checked_order(order)]
    return _chosen[0] if _chosen else _checked_order(os.environ.get(VARIABLE) or "xyzw")


def _checked_order(order: str) -> str:
    if order not in _ORDERS:
        raise UnknownName("order of quaternions", order, _ORDERS)
    return order


def pose_of(configuration: Any, name: str = "configuration") -> Floats:
    """The pose T_group_node of a placement; the length of its quaternion plays no part.

    Args:
        configuration: x, y, z [m] and a quaternion, (7,).
        name: Name of the argument, for messages.

    Returns:
        The pose, (4, 4).

    Raises:
        ShapeError, NonFiniteError, InputError: It is no placement.
    """
    values = np.asarray([float(x) for x in np.ravel(configuration)])
    if values.shape != (7,):
        raise ShapeError(name, values.shape, "(7,): x, y, z and a quaternion")
    check_finite(name, values)
    quat = values[3:][_ORDERS[quaternion_order()]]
    length = float(np.linalg.norm(quat))
    if length < 1e-6:
        raise InputError(f"`{name}` has the quaternion {values[3:].tolist()}, which is no rotation.")
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = quat_xyzw_to_matrix(quat / length), values[:3]
    return out


def configuration_of(pose: Floats) -> list[float]:
    """x, y, z and a quaternion of a placement (4, 4)."""
    quat = np.asarray(matrix_to_quat_xyzw(pose[:3, :3]), dtype=float)
    ordered = quat if quaternion_order() == "xyzw" else quat[[3, 0, 1, 2]]
    return [*pose[:3, 3].tolist(), *ordered.tolist()]
