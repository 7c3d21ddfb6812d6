"""Poses from the numbers of model files, with the rounding errors of right angles removed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ulna.spatial import SE3, rpy_to_matrix
from ulna.typing import Floats

SNAP = 1e-15
"""Entries of a rotation matrix this close to 0 or +-1 are made exact: cos(pi/2) is 6e-17 in floating point,
and every such entry would cost a product in the compiled kernels."""


def snapped(rotation: Floats) -> Floats:
    """The matrix with entries within `SNAP` of 0 and +-1 made exact."""
    nearest = np.round(rotation)
    return np.where(np.abs(rotation - nearest) <= SNAP, nearest, rotation) + 0.0


def pose(xyz: Sequence[float] = (0.0, 0.0, 0.0), rpy: Sequence[float] = (0.0, 0.0, 0.0)) -> SE3:
    """A pose from position and angles as URDF writes them.

    Args:
        xyz: Position [m].
        rpy: Roll, pitch, yaw about the fixed axes [rad], R = Rz(yaw) Ry(pitch) Rx(roll).

    Returns:
        The pose.
    """
    if not any(rpy):
        return SE3(np.eye(3), np.array(xyz, dtype=float))
    return SE3(snapped(rpy_to_matrix(np.array(rpy, dtype=float))), np.array(xyz, dtype=float))


def without_rounding(placement: SE3) -> SE3:
    """A pose without rounding noise in its rotation: entries near 0 and 1 become exact."""
    return SE3(snapped(placement.rotation), placement.translation)
