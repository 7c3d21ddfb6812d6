"""A pose in the page that can be dragged."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

import numpy as np

from ulna.spatial import quat_xyzw_to_matrix
from ulna.typing import ArrayLike, Floats
from ulna.viewer.page.page import Page
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


def add_gizmo(
    page: Page, name: str, pose: Floats, on_drag: Callable[[tuple[Floats, str]], None], size: float
) -> Gizmo:
    """Add a pose to drag to a page.

    Args:
        page: The page.
        name: Its name.
        pose: T_world_gizmo, shape (4, 4).
        on_drag: Called with (T_world_gizmo (4, 4), "start" | "update" | "end").
        size: Length of its axes [m].

    Returns:
        The gizmo.
    """
    position, wxyz = position_wxyz(pose)
    handle = page.server.scene.add_transform_controls(
        f"/(page)/{name}",
        scale=size,
        line_width=3.0,
        depth_test=False,
        opacity=0.9,
        position=position,
        wxyz=wxyz,
    )
    gizmo = Gizmo(handle)

    @handle.on_update
    async def _(event: Any) -> None:  # async: on viser's own loop, so that events stay in order
        gizmo.is_dragged = event.phase != "end"
        # starts and ends are never dropped, of updates only the newest counts
        page.post_event(id(handle) if event.phase == "update" else None, on_drag, (gizmo.pose, event.phase))

    return gizmo
