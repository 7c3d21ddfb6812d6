"""Poses and Jacobians of chains whose constants or coordinates are symbols, by products of matrices.

| symbol | meaning | unit |
|---|---|---|
| T, U | pose of the end, pose after a joint, in the start | [m, 1] |
| z, p | axis of a joint, the end seen from it, in the axes of the start | [1], [m] |

Source: Corke, Robotics, Vision and Control (2023), section 8.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from roboticstoolbox._common.poses import to_spatial
from roboticstoolbox._common.symbols import has_symbols
from roboticstoolbox._ets.base_transform import BaseET
from ulna.typing import Floats


def symbolic_pose(transforms: Sequence[BaseET], q: Any) -> Floats:
    """The pose of the end, by products of matrices.

    Args:
        transforms: The transforms of the chain.
        q: Coordinates of the joints along the chain, n numbers or symbols [rad or m].

    Returns:
        Pose (4, 4) of numbers or expressions.
    """
    T = None
    for A in reversed(_matrices(transforms, q)):
        T = A if T is None else A @ T
    return _numbers_if_possible(np.eye(4) if T is None else T)


def symbolic_jacobian(transforms: Sequence[BaseET], q: Any) -> Floats:
    """The Jacobian in the axes of the start, linear rows first.

    Args:
        transforms: The transforms of the chain.
        q: Coordinates of the joints along the chain, n numbers or symbols [rad or m].

    Returns:
        Jacobian (6, n) of numbers or expressions.
    """
    end = symbolic_pose(transforms, q)
    U, columns = np.eye(4, dtype=int), []
    for et, A in zip(transforms, _matrices(transforms, q), strict=True):
        U = U @ A
        if not et.isjoint:
            continue
        z = U[:3, "xyz".index(et.ax or "z")] * (-1 if et.isflip else 1)
        p = end[:3, 3] - U[:3, 3]
        columns.append([*(np.cross(z, p) if et.isrotation else z), *(z if et.isrotation else 0 * z)])
    return _numbers_if_possible(np.array(columns, dtype=object).reshape(-1, 6).T)


def to_axes_of_end(J: Floats, T: Floats) -> Floats:
    """A Jacobian turned from the axes of the start into those of the end.

    Args:
        J: Jacobian in the axes of the start, (6, n).
        T: Pose of the end, (4, 4).

    Returns:
        Jacobian (6, n).
    """
    R = T[:3, :3].T
    return _numbers_if_possible(np.vstack([R @ J[:3], R @ J[3:]]))


def _matrices(transforms: Sequence[BaseET], q: Any) -> list[Floats]:
    """The transforms as matrices (4, 4)."""
    coordinates = iter(q)
    return [to_spatial(et.A(next(coordinates)) if et.isjoint else et.A()) for et in transforms]


def _numbers_if_possible(values: Floats) -> Floats:
    return values if has_symbols(values) else values.astype(float)
