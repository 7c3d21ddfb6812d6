"""A pose in the page that can be dragged, and poses as the page takes them."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna.spatial import matrix_to_quat_xyzw, quat_xyzw_to_matrix
from ulna.typing import Array, ArrayLike, Floats


@final
class Gizmo:
    """A pose in the page that can be dragged; `held` while someone drags it."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self.held = False

    @property
    def pose(self) -> Floats:
        """T_world_gizmo, shape (4, 4)."""
        out = np.eye(4)
        out[:3, 3] = self._handle.position
        out[:3, :3] = quat_xyzw_to_matrix(np.roll(np.asarray(self._handle.wxyz, dtype=float), -1))
        return out

    @pose.setter
    def pose(self, pose: ArrayLike) -> None:
        position, wxyz = position_wxyz(np.asarray(pose, dtype=float))
        self._handle.position, self._handle.wxyz = position, wxyz

    def remove(self) -> None:
        """Take it out of the page."""
        self._handle.remove()

    @property
    def visible(self) -> bool:
        """Whether it can be seen."""
        return bool(self._handle.visible)

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._handle.visible = bool(visible)


def pose_rows(poses: Floats) -> Array:
    """Poses (n, 4, 4) as rows x y z, w x y z, shape (n, 7), float32."""
    quat = matrix_to_quat_xyzw(poses[:, :3, :3])
    return np.concatenate([poses[:, :3, 3], quat[:, 3:], quat[:, :3]], axis=1).astype(np.float32)


def position_wxyz(pose: Floats) -> tuple[Any, Any]:
    """A pose (4, 4) as position x y z and quaternion w x y z."""
    row = pose_rows(pose[None])[0].astype(float)
    return tuple(row[:3].tolist()), tuple(row[3:].tolist())
