"""What a scene is made of: nodes, a snapshot of all of them, and poses that are checked before they get there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, final

import numpy as np

from ulna.errors import InputError, NonFiniteError, ShapeError
from ulna.typing import Array, Floats
from ulna.viewer.content import Content
from ulna.viewer.surface import Surface


@final
@dataclass(frozen=True, eq=False)
class Node:
    """A thing of the scene that moves as one piece.

    Args:
        name: Its name, unique in the scene; what stands before the last `/` is the group that it belongs to.
        surfaces: What it looks like, in its own frame.
        content: What else is there to see: points, lines, words, copies.
        shadow: Whether it casts a shadow.
        through: Whether pictures show it faintly through what hides it, as is good for lines and axes.
    """

    name: str
    surfaces: tuple[Surface, ...] = ()
    content: Content | None = None
    shadow: bool = True
    through: bool = False

    @property
    def translucent(self) -> bool:
        """Whether any of its surfaces lets light through."""
        return any(s.rgba[3] < 0.999 for s in self.surfaces)

    @property
    def group(self) -> str:
        """The name of the group it belongs to; empty for none."""
        return self.name.rpartition("/")[0]


class Snapshot(NamedTuple):
    """A scene at one instant: three counters, the nodes, where they are, and how they look with their groups.

    `poses` are T_world_node (n, 4, 4); `scales` are factors (n, 3); `visible` is (n,); `opacity` is (n,) from 0 to 1;
    `tint` is (n, 3), red, green, blue, or -1 where nodes keep their own colours.
    """

    structure: int
    motion: int
    looks: int
    nodes: tuple[Node, ...]
    poses: Floats
    scales: Floats
    visible: Array
    opacity: Floats
    tint: Floats


def checked_pose(value: Any, name: str = "pose") -> Floats:
    """A pose (4, 4) from an array or an `SE3`.

    Raises:
        ShapeError, NonFiniteError, InputError: It is none.
    """
    out = np.array(value.matrix() if hasattr(value, "matrix") else value, dtype=float)
    if out.shape != (4, 4):
        raise ShapeError(name, out.shape, "(4, 4), or an SE3")
    if not np.isfinite(out).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(out))[0])
        raise NonFiniteError(name, where, float(out[where]))
    if np.abs(out[:3, :3] @ out[:3, :3].T - np.eye(3)).max() > 1e-3 or np.linalg.det(out[:3, :3]) < 0:
        raise InputError(
            f"`{name}` holds no rotation: {out[:3, :3].tolist()}. To stretch or mirror a thing, set its scale."
        )
    return out
