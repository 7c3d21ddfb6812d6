"""Controls of the page: values in the panel, and a pose in the scene that can be dragged."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna.spatial import matrix_to_quat_xyzw, quat_xyzw_to_matrix
from ulna.typing import Array, ArrayLike, Floats


@final
class Control:
    """A control of the panel; `value` is read and written from any thread."""

    def __init__(self, handle: Any, attribute: str) -> None:
        self._handle, self._attribute = handle, attribute

    @classmethod
    def kept(cls, value: Any) -> Control:
        """A value that nobody sees."""
        return cls(_Kept(value), "value")

    @classmethod
    def of_choice(cls, boxes: dict[str, Any], value: str) -> Control:
        """The one of several boxes that is ticked."""
        return cls(_Choice(boxes, value), "value")

    @property
    def value(self) -> Any:
        """What it shows."""
        return getattr(self._handle, self._attribute)

    @value.setter
    def value(self, value: Any) -> None:
        if isinstance(self._handle, _Choice) or value != self.value:
            setattr(self._handle, self._attribute, value)


class _Kept:
    def __init__(self, value: Any) -> None:
        self.value = value


class _Choice:
    def __init__(self, boxes: dict[str, Any], value: str) -> None:
        self._boxes, self._value = boxes, value

    @property
    def value(self) -> str:
        return self._value

    @value.setter
    def value(self, value: str) -> None:
        self._value = value
        for option, box in self._boxes.items():
            if box.value != (option == value):
                box.value = option == value


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
