"""What a world holds: obstacles that stand or are moved, and objects that links carry."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, final

from ulna.checks.arrays import check_finite, real_array
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError
from ulna.geometry import Shape
from ulna.spatial import SE3
from ulna.spatial.se3 import read_only
from ulna.typing import ArrayLike, Floats


@final
@dataclass(frozen=True, eq=False)
class Obstacle:
    """A named shape in the world.

    Attributes:
        name: Its name, once in a world.
        shape: The shape in its own frame.
        pose: T_world_shape; of a moving obstacle, where it stands unless a call says otherwise.
        moving: Whether calls may give it another pose.
        touches: Names of links and attached objects that may touch it: a base on a table, fingers around a part.
    """

    name: str
    shape: Shape
    pose: SE3
    moving: bool = False
    touches: tuple[str, ...] = ()


@final
@dataclass(frozen=True, eq=False)
class Attachment:
    """An object that a link carries.

    Attributes:
        name: Its name, once in a world.
        link: The link that carries it.
        shape: The shape in its own frame.
        pose: T_link_shape.
        touches: Names of links, obstacles and attached objects that it may touch: fingers around it, what it stands on.
    """

    name: str
    link: str
    shape: Shape
    pose: SE3
    touches: tuple[str, ...] = ()


def checked_object(name: Any, shape: Any, touches: Iterable[str], what: str) -> tuple[str, ...]:
    """The names of `touches`, once name and shape of a new object were examined.

    Args:
        name: Its name.
        shape: Its shape.
        touches: Names of what it may touch.
        what: What it is, for messages.

    Returns:
        The names.

    Raises:
        InputError: If one of them makes no sense.
    """
    if not isinstance(name, str) or not name:
        raise InputError(f"`name` is {name!r}; expected a name for the {what.lower()}.")
    if not isinstance(shape, Shape):
        raise InputError(
            f"{what} {name!r}: `shape` is {shape!r}; expected a shape of ulna.geometry, such as Box((1, 1, 0.1))."
        )
    is_list = not isinstance(touches, (str, bytes, Mapping)) and isinstance(touches, Iterable)
    allowed = tuple(touches) if is_list else ()
    if not is_list or not all(isinstance(one, str) for one in allowed):
        raise InputError(f"{what} {name!r}: `touches` is {touches!r}; expected a list of link names.")
    return allowed


def checked_pose(what: str, pose: SE3 | ArrayLike | None) -> SE3:
    """A single pose.

    Args:
        what: Whose it is, for messages: "obstacle 'table'".
        pose: An SE3, an array of shape (4, 4), or a position of shape (3,) [m]; None for the identity.

    Returns:
        The pose.

    Raises:
        ShapeError: If it has another shape.
        InputError: If it is a batch.
        NonFiniteError: If it holds nan or inf.
    """
    if pose is None:
        return SE3.identity()
    checked = (
        pose if isinstance(pose, SE3) else _pose_of(what, real_array("pose", pose, shape="(4, 4) or (3,)"))
    )
    matrix: Any = checked.matrix()
    if matrix.shape != (4, 4):
        raise InputError(
            f"{what[0].upper()}{what[1:]}: `pose` is a batch of shape {matrix.shape[:-2]}; expected one pose."
        )
    check_finite(f"pose of {what}", matrix)
    return read_only(checked)


def _pose_of(what: str, array: Floats) -> SE3:
    if array.shape == (3,):
        return SE3.from_translation(array)
    if array.shape[-2:] == (4, 4):
        return SE3.from_matrix(array)
    advice = {
        (7,): "Of a position and a quaternion x, y, z, w: SE3.from_quat_xyzw(pose[3:], pose[:3]).",
        (6,): "Of a position and roll, pitch, yaw: SE3.from_rpy(pose[3:], pose[:3]).",
        (3, 3): "Of a rotation: SE3.from_rotation(R, position).",
    }
    raise ShapeError(
        f"pose of {what}", array.shape, "an SE3, (4, 4), or a position (3,)", advice.get(array.shape, "")
    )
