"""Poses as the toolbox passes them: SE3 objects of spatialmath, or plain matrices."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np

from roboticstoolbox._common.errors import WrongShape, WrongType
from ulna.errors import MissingExtra, excerpt
from ulna.spatial import matrix_to_rpy
from ulna.typing import Floats


@cache
def _spatialmath() -> Any:
    try:
        import spatialmath
    except ImportError:
        raise MissingExtra("spatialmath-python", "toolbox", "A pose of the toolbox") from None
    return spatialmath


@cache
def _class(size: int) -> Any:
    return _spatialmath().SE3 if size == 4 else _spatialmath().SE2


def pose(T: Floats) -> Any:
    """An SE3 that holds one matrix (4, 4) or many (m, 4, 4), an SE2 for (3, 3); unchecked, as kernels made them."""
    kind = _class(T.shape[-1])
    out = kind.__new__(kind)
    out.data = [T] if T.ndim == 2 else list(T)
    return out


def array(T: Any) -> Floats:
    """The numbers of a pose object, or of poses, or of an array."""
    values = getattr(T, "data", None)
    if type(values) is list:
        return values[0] if len(values) == 1 else np.array(values, dtype=float)
    try:
        return np.asarray(T, dtype=float)
    except (TypeError, ValueError):
        raise WrongType(f"A pose is {excerpt(repr(T))}; expected an SE3, an SE2, or a matrix.") from None


def matrix(T: Any, size: int = 4) -> Floats:
    """The homogeneous matrix (size, size) of a pose object or an array.

    Args:
        T: A pose object, or an array (size, size).
        size: 4 in space, 3 in the plane.

    Returns:
        Matrix (size, size).

    Raises:
        WrongShape: It is neither.
    """
    M = array(T)
    if M.shape != (size, size):
        raise WrongShape("pose", M.shape, f"({size}, {size}), or one SE{size - 1}")
    return M


def constant_pose(T: Any, size: int = 4) -> Floats:
    """A copy of the matrix (size, size) of a pose, which may hold symbols.

    Args:
        T: A pose object, or an array (size, size).
        size: 4 in space, 3 in the plane.

    Returns:
        Matrix (size, size), of objects where there are symbols.

    Raises:
        WrongShape: It is neither.
    """
    values = getattr(T, "data", None)
    M = values[0] if type(values) is list and len(values) == 1 else np.asarray(T)
    return M.copy() if M.dtype == object and M.shape == (size, size) else matrix(array(T), size).copy()


def matrices(T: Any, size: int = 4) -> Floats:
    """The matrices of poses, (size, size) or (m, size, size).

    Args:
        T: Pose objects, or an array.
        size: 4 in space, 3 in the plane.

    Returns:
        Matrix (size, size), or matrices (m, size, size).

    Raises:
        WrongShape: It is neither.
    """
    M = array(T)
    if M.shape != (size, size) and (M.shape[-2:] != (size, size) or M.ndim > 3):
        raise WrongShape("pose", M.shape, f"({size}, {size}) or (m, {size}, {size}), or an SE{size - 1}")
    return M


def describe(T: Floats) -> str:
    """A constant pose as text, "SE3(x, y, z; roll, pitch, yaw)", without the parts that are zero."""
    if T.dtype == object:
        return f"SE{len(T) - 1}({T.tolist()})"
    if T.shape == (3, 3):
        angle = math.degrees(math.atan2(T[1, 0], T[0, 0]))
        return f"SE2({T[0, 2]:.4g}, {T[1, 2]:.4g}; {angle:.4g}°)"
    parts = []
    if T[:3, 3].any():
        parts.append(", ".join(f"{x:.4g}" for x in T[:3, 3]))
    rpy = np.degrees(matrix_to_rpy(T[:3, :3])) + np.array([0.0, -0.0, 0.0])  # no roll or yaw of -0
    if np.abs(rpy).max() > 0.0:
        parts.append(", ".join(f"{x:.4g}°" for x in rpy))
    return f"SE3({'; '.join(parts)})"


def along(z: Floats, point: Any) -> Floats:
    """A frame at a point with a given z axis.

    Args:
        z: Unit vector (3,).
        point: Point (3,) [m].

    Returns:
        Pose (4, 4).
    """
    x = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
    x /= np.linalg.norm(x)
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = x, np.cross(z, x), z, np.asarray(point, dtype=float).ravel()
    return T


def rotation_between(a: Any, b: Any) -> Any:
    """The rotation that takes the direction of one vector to that of another one.

    Args:
        a, b: Vector (3,).

    Returns:
        One SE3.
    """
    return _spatialmath().SE3(
        _spatialmath().SO3.RotatedVector(np.asarray(a, dtype=float), np.asarray(b, dtype=float))
    )


def to_spatial(T: Floats) -> Floats:
    """Poses in the plane (..., 3, 3) as poses in space (..., 4, 4); those in space as they are."""
    if T.shape[-2:] == (4, 4):
        return T
    out = np.broadcast_to(np.eye(4, dtype=T.dtype), (*T.shape[:-2], 4, 4)).copy()
    out[..., :2, :2], out[..., :2, 3] = T[..., :2, :2], T[..., :2, 2]
    return out


def to_planar(T: Floats) -> Floats:
    """The pose in the plane (..., 3, 3) of a pose in space (..., 4, 4) that stays in it."""
    axes = [0, 1, 3]
    return T[..., axes, :][..., axes]
