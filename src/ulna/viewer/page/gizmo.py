"""A pose in the page that can be dragged, and poses as the page takes them."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna.spatial import quat_xyzw_to_matrix
from ulna.typing import ArrayLike, Floats
from ulna.viewer.page.poses import position_wxyz


@final
class Gizmo:
    """A pose in the page that can be dragged; `held` while someone drags it."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self.is_dragged = False

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
