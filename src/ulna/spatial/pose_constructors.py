"""Poses from matrices, quaternions, angles, points and directions."""

from __future__ import annotations

from typing import Any, Self

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.checks.rotations import ROTATION_TOLERANCE, checked_rotation
from ulna.checks.values import flag
from ulna.errors import InputError
from ulna.numeric import vector
from ulna.spatial import angles, quaternion
from ulna.spatial.batched import Composed, as_array, component
from ulna.spatial.nearest import nearest_rotation
from ulna.spatial.pointing import rotation_along, rotation_looking
from ulna.spatial.so3 import SO3, checked_quat
from ulna.typing import Array, ArrayLike


def _copied(name: str, value: ArrayLike, core: tuple[int, ...]) -> Array:
    """An array (..., *core) of its own, which does not change when what was passed does."""
    return np.array(batched_array(name, value, core))


class PoseConstructors(Composed):
    """Constructors of poses.

    Args:
        rotation: Rotation matrix, shape (..., 3, 3) [-].
        translation: Translation, shape (..., 3) [m].
    """

    __slots__ = ()

    def __init__(self, rotation: Array, translation: Array) -> None:
        raise NotImplementedError

    @classmethod
    def identity(cls) -> Self:
        """The pose of a frame in itself."""
        return cls(np.eye(3), np.zeros(3))

    @classmethod
    def from_matrix(cls, matrix: ArrayLike, check: bool = True) -> Self:
        """From a homogeneous matrix (..., 4, 4).

        Args:
            matrix: Rotation and translation [m], and a last row 0, 0, 0, 1, shape (..., 4, 4).
            check: Whether its values are checked; without, only its shape is.

        Returns:
            The pose.

        Raises:
            InputError: wrong shape, nan or inf, not a rotation within 1e-6, or another last row.

        Example:
            >>> robot = ulna.load("panda")
            >>> T = ulna.SE3.from_matrix(robot.fk(robot.configurations["ready"]))
            >>> T.translation.round(3)
            array([0.307, 0.   , 0.487])
        """
        if not flag("check", check):
            m = as_array(matrix)
            return cls(m[..., :3, :3], m[..., :3, 3])
        m = _copied("matrix", matrix, (4, 4))
        if m.dtype != object:
            error = np.abs(m[..., 3, :] - np.array([0.0, 0.0, 0.0, 1.0])).max(initial=0.0)
            if error > ROTATION_TOLERANCE:
                raise InputError(
                    f"`matrix` has a last row that differs from [0, 0, 0, 1] by {error:.3g}. "
                    "Look whether it is transposed, or scaled."
                )
        return cls(checked_rotation("matrix[:3, :3]", m[..., :3, :3], "SE3.project(matrix)"), m[..., :3, 3])

    @classmethod
    def project(cls, matrix: ArrayLike) -> Self:
        """The pose with the rotation nearest to that of a matrix (..., 4, 4), and its translation."""
        m = _copied("matrix", matrix, (4, 4))
        return cls(nearest_rotation(m[..., :3, :3]), m[..., :3, 3])

    @classmethod
    def from_quat_xyzw(cls, quat: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Self:
        """From a quaternion and a translation.

        Args:
            quat: Quaternion x, y, z, w of any length but zero, shape (..., 4) [-].
            translation: Translation, shape (..., 3) [m].

        Returns:
            The pose.

        Raises:
            InputError: wrong shape, nan or inf, or a quaternion of length zero.

        Example:
            >>> ulna.SE3.from_quat_xyzw([0, 0, 0, 1], (0.4, 0.0, 0.3)).translation
            array([0.4, 0. , 0.3])
        """
        return cls(
            quaternion.quat_xyzw_to_matrix(checked_quat(quat)),
            _copied("translation", translation, (3,)),
        )

    @classmethod
    def from_rpy(cls, rpy: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Self:
        """From roll, pitch, yaw as in URDF, and a translation.

        Args:
            rpy: Angles about the fixed axes x, y, z, shape (..., 3) [rad].
            translation: Translation, shape (..., 3) [m].

        Returns:
            The pose.

        Raises:
            InputError: wrong shape, nan or inf.

        Example:
            >>> ulna.SE3.from_rpy([0.1, 0.2, 0.3]).rpy().round(6)
            array([0.1, 0.2, 0.3])
        """
        rotation = angles.rpy_to_matrix(batched_array("rpy", rpy, (3,)))
        return cls(rotation, _copied("translation", translation, (3,)))

    @classmethod
    def from_rotation(cls, rotation: ArrayLike | SO3, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Self:
        """From a rotation and a translation.

        Args:
            rotation: Rotation matrix, shape (..., 3, 3) [-], checked; or an SO3.
            translation: Translation, shape (..., 3) [m].

        Returns:
            The pose.

        Raises:
            InputError: wrong shape, nan or inf, or not a rotation within 1e-6.
        """
        if isinstance(rotation, SO3):
            r = rotation.matrix
        else:
            r = np.array(checked_rotation("rotation", rotation, "SO3.project(rotation)"))
        return cls(r, _copied("translation", translation, (3,)))

    @classmethod
    def from_translation(cls, translation: ArrayLike) -> Self:
        """The translation by a vector (..., 3) [m]."""
        return cls(np.eye(3), _copied("translation", translation, (3,)))

    @classmethod
    def trans(cls, x: Any, y: Any, z: Any) -> Self:
        """A translation.

        Args:
            x, y, z: Its components, each of shape (...) [m].

        Returns:
            The pose, with the identity as rotation.

        Example:
            >>> ulna.SE3.trans(0.4, 0.0, 0.3) @ [0.0, 0.0, 0.1]
            array([0.4, 0. , 0.4])
            >>> ulna.SE3.trans(np.zeros(50), 0.0, np.linspace(0.0, 1.0, 50)).matrix().shape  # a batch of poses
            (50, 4, 4)
        """
        return cls(np.eye(3), vector(component("x", x), component("y", y), component("z", z)))

    @classmethod
    def pointing(cls, position: ArrayLike, direction: ArrayLike, x: ArrayLike | None = None) -> Self:
        """The pose of a tool at a point whose z axis points along a direction.

        Args:
            position: The point, shape (..., 3) [m].
            direction: Direction of the z axis, of any length but zero, shape (..., 3) [-].
            x: Direction that the x axis is as near to as it can, shape (..., 3) [-]; None for the x axis of the outer
                frame, or its z axis where `direction` is along x.

        Returns:
            The pose.

        Raises:
            InputError: wrong shape, nan or inf, a direction of zero, or `x` parallel to `direction`.

        Example:
            >>> ulna.SE3.pointing((0.4, 0.0, 0.3), (1.0, 0.0, 0.0)).rotation[:, 2]
            array([1., 0., 0.])
        """
        return cls(rotation_along(direction, x), _copied("position", position, (3,)))

    @classmethod
    def pointing_down(cls, position: ArrayLike, yaw: Any = 0.0) -> Self:
        """The pose of a tool at a point whose z axis points down: SE3.rx(pi) there, turned about the vertical.

        Args:
            position: The point, shape (..., 3) [m].
            yaw: Angle from the x axis of the outer frame to that of the tool, about the vertical, shape (...) [rad].

        Returns:
            The pose.

        Raises:
            InputError: wrong shape, nan or inf.

        Example:
            >>> ulna.SE3.pointing_down((0.4, 0.0, 0.3)).rotation[:, 2]
            array([ 0.,  0., -1.])
        """
        turned = angles.rotation_about(2, component("yaw", yaw)) @ np.diag([1.0, -1.0, -1.0])
        return cls(turned, _copied("position", position, (3,)))

    @classmethod
    def looking_at(cls, position: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 0.0, 1.0)) -> Self:
        """The pose of a camera at a point: z towards a target, x to the right and y down in the picture.

        Args:
            position: The point, shape (..., 3) [m].
            target: What it looks at, shape (..., 3) [m].
            up: Direction that is up in the picture, shape (..., 3) [-].

        Returns:
            The pose.

        Raises:
            InputError: wrong shape, nan or inf, target and position are equal, or the view is along `up`.

        Example:
            >>> ulna.SE3.looking_at((1.0, 0.0, 0.0), (0.0, 0.0, 0.0)).rotation[:, 2]
            array([-1.,  0.,  0.])
        """
        place = _copied("position", position, (3,))
        return cls(rotation_looking(batched_array("target", target, (3,)) - place, up), place)

    @classmethod
    def rx(cls, angle: Any) -> Self:
        """The rotation about x by `angle` (...) [rad].

        Example:
            >>> (ulna.SE3.rx(np.pi) @ [0.0, 0.0, 1.0]).round(6)  # upside down
            array([ 0., -0., -1.])
        """
        return cls(angles.rotation_about(0, component("angle", angle)), np.zeros(3))

    @classmethod
    def ry(cls, angle: Any) -> Self:
        """The rotation about y by `angle` (...) [rad]."""
        return cls(angles.rotation_about(1, component("angle", angle)), np.zeros(3))

    @classmethod
    def rz(cls, angle: Any) -> Self:
        """The rotation about z by `angle` (...) [rad]."""
        return cls(angles.rotation_about(2, component("angle", angle)), np.zeros(3))
