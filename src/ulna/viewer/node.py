"""What a scene is made of: nodes, a snapshot of all of them, and poses that are checked before they get there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, final

import numpy as np

from ulna.errors import InputError, NonFiniteError, ShapeError
from ulna.typing import Array, ArrayLike, Floats
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
    out = _floats(name, value.matrix() if hasattr(value, "matrix") else value)
    if out.shape != (4, 4):
        raise ShapeError(name, out.shape, "(4, 4), or an SE3")
    _check_finite(name, out)
    if np.abs(out[:3, :3] @ out[:3, :3].T - np.eye(3)).max() > 1e-3 or np.linalg.det(out[:3, :3]) < 0:
        raise InputError(
            f"`{name}` holds no rotation: {out[:3, :3].tolist()}. To stretch or mirror a thing, set its scale."
        )
    return out


def check_name(name: str) -> None:
    """Refuse what is no name of a node.

    Raises:
        InputError: It is none.
    """
    if not isinstance(name, str) or "" in name.split("/"):
        raise InputError(
            f"A node's name is not empty, and neither begins nor ends with '/' nor holds '//'; got {name!r}."
        )


def check_even(name: str, scale: Floats) -> None:
    """Refuse to stretch a group.

    Raises:
        InputError: Its factors along the axes differ.
    """
    if not (scale[0] == scale[1] == scale[2]):
        raise InputError(f"The group {name!r} can be scaled by one number only, not by {scale.tolist()}.")


def numbers(name: str, value: ArrayLike, *shape: int) -> Floats:
    """Finite numbers of a shape.

    Raises:
        InputError, ShapeError, NonFiniteError: They are not.
    """
    out = _floats(name, value)
    if out.shape != shape:
        raise ShapeError(name, out.shape, str(shape))
    _check_finite(name, out)
    return out


def _floats(name: str, value: Any) -> Floats:
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"`{name}` is {value!r}; expected numbers.") from None


def _check_finite(name: str, value: Floats) -> None:
    if not np.isfinite(value).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(value))[0])
        raise NonFiniteError(name, where, float(value[where]))
