"""Poses as viser takes them: positions and quaternions w x y z."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.spatial import matrix_to_quat_xyzw
from ulna.typing import Array, Floats


def pose_rows(poses: Floats) -> Array:
    """Poses (n, 4, 4) as rows x y z, w x y z, shape (n, 7), float32."""
    quat = matrix_to_quat_xyzw(poses[:, :3, :3])
    return np.concatenate([poses[:, :3, 3], quat[:, 3:], quat[:, :3]], axis=1).astype(np.float32)


def position_wxyz(pose: Floats) -> tuple[Any, Any]:
    """A pose (4, 4) as position x y z and quaternion w x y z."""
    row = pose_rows(pose[None])[0].astype(float)
    return tuple(row[:3].tolist()), tuple(row[3:].tolist())
