"""Nodes of a scene, snapshots of all nodes, and checks of poses and names."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, final

import numpy as np

from ulna.checks.arrays import length_array
from ulna.checks.values import short_repr
from ulna.errors import InputError
from ulna.typing import Array, Floats
from ulna.viewer.graph.content import Content
from ulna.viewer.mesh.surface import Surface


@final
@dataclass(frozen=True, eq=False)
class Node:
    """A thing of the scene that moves as one piece.

    Args:
        name: Its name, unique in the scene; the part before the last `/` is the name of its group.
        surfaces: What it looks like, in its own frame.
        content: What else is there to see: points, lines, text, copies.
        shadow: Whether it casts a shadow.
        through: Whether pictures show it, translucent, in front of what occludes it; useful for lines and axes.
    """

    name: str
    surfaces: tuple[Surface, ...] = ()
    content: Content | None = None
    shadow: bool = True
    through: bool = False

    @property
    def casts_shadow(self) -> bool:
        """Whether it casts a shadow: if it is to, and any of its surfaces holds light back."""
        return self.shadow and any(s.rgba[3] >= 0.999 for s in self.surfaces)

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
    appearance: int
    nodes: tuple[Node, ...]
    poses: Floats
    scales: Floats
    visible: Array
    opacity: Floats
    tint: Floats


_BOTTOM_ROW = np.array([0.0, 0.0, 0.0, 1.0])
_IDENTITY = np.eye(3)


def checked_pose(value: Any, name: str = "pose") -> Floats:
    """A pose (4, 4) from an array or an `SE3`.

    Args:
        value: Array (4, 4), or an `SE3`.
        name: Name of the argument, for messages.

    Returns:
        The pose, (4, 4).

    Raises:
        ShapeError, NonFiniteError, InputError: It is none.
    """
    return checked_poses(value, name, 4, 4, fix="An SE3 is accepted, too.")


def pose_or_position(value: Any) -> Floats:
    """The pose (4, 4) from a pose, an array or an `SE3`, or from a position (3,) [m] without rotation.

    Raises:
        ShapeError, NonFiniteError, InputError: It is neither.
    """
    listed = isinstance(value, list | tuple) and len(value) == 3 and np.ndim(value[0]) == 0
    if not listed and getattr(value, "shape", None) != (3,):
        return checked_poses(value, "pose", 4, 4, fix="An SE3 is accepted, too, or a position (3,).")
    out = np.eye(4)
    out[:3, 3] = length_array("pose", value, 3)
    return out


def checked_poses(value: Any, name: str, *shape: int | None, fix: str = "") -> Floats:
    """Poses of a shape (..., 4, 4), from an array or an `SE3`.

    Args:
        value: Array (..., 4, 4), or an `SE3`.
        name: Name of the argument, for messages.
        *shape: Expected length of each axis; None for any.
        fix: Advice for messages.

    Returns:
        The poses, (..., 4, 4).

    Raises:
        ShapeError, NonFiniteError, InputError: They are none.
    """
    out = length_array(name, value.matrix() if hasattr(value, "matrix") else value, *shape, fix=fix)
    rotations = out[..., :3, :3]
    errors = np.abs(rotations @ rotations.mT - _IDENTITY).max(axis=(-2, -1))
    errors = np.where(np.linalg.det(rotations) < 0.0, 1.0, errors)
    if np.abs(out[..., 3, :] - _BOTTOM_ROW).max(initial=0.0) > 1e-6:
        raise InputError(
            f"`{name}` has a lowest row that is not 0 0 0 1; expected a pose whose position is its last column."
        )
    if errors.max(initial=0.0) > 1e-3:
        where = tuple(int(i) for i in np.argwhere(errors == errors.max())[0])
        entry = f"{name}[{', '.join(map(str, where))}]" if where else name
        raise InputError(
            f"`{entry}` holds no rotation: {out[where][:3, :3].tolist()}. Set the scale to stretch or mirror."
        )
    return out


def check_name(name: str) -> None:
    """Refuse what is no name of a node.

    Raises:
        InputError: It is none.
    """
    if not isinstance(name, str) or "" in name.split("/"):
        raise InputError(
            f"`name` is {short_repr(name)}; expected a name without '//' and without '/' at either end."
        )


def node_name(text: str) -> str:
    """A robot's name as the name of a node: without empty parts between, before and after `/`."""
    return "/".join(part for part in text.split("/") if part.strip()) or "robot"


def check_uniform_scale(name: str, scale: Floats) -> None:
    """Check that a group is not stretched.

    Args:
        name: Name of the group, for the message.
        scale: Its factors along the axes, (3,).

    Raises:
        InputError: Its factors along the axes differ.
    """
    if not (scale[0] == scale[1] == scale[2]):
        raise InputError(f"The group {name!r} can be scaled by one number only, not by {scale.tolist()}.")
