"""Poses: where a frame stands, as rotation and translation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, Self, TypeVar, final, overload

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.checks.rotations import ROTATION_TOLERANCE, checked_rotation
from ulna.errors import InputError, ShapeError, UnknownOperation
from ulna.idioms import Explained, explained
from ulna.numeric import apply, dot, is_symbolic, skew, sqrt, vector
from ulna.spatial import angles, exponential, quaternion
from ulna.spatial.batched import Batched, as_array, column, numbers
from ulna.spatial.nearest import nearest_rotation
from ulna.spatial.so3 import SO3, checked_quat
from ulna.spatial.vectors import Motion
from ulna.typing import Array, ArrayLike


class Movable(Protocol):
    """What a pose can express in another frame: Motion, Force, Inertia."""

    def _moved(self, rotation: Array, translation: Array) -> Self: ...
    def _moved_back(self, rotation: Array, translation: Array) -> Self: ...


T = TypeVar("T", bound=Movable)


@final
@explained("SE3")
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SE3(Batched, metaclass=Explained):
    """A pose, or a batch of them: `T_a_b @ p_b` is p_a, `T_a_b @ T_b_c` is T_a_c.

    Attributes:
        rotation: orthogonal matrix (..., 3, 3) with determinant 1.
        translation: vector (..., 3) [m].
    """

    rotation: Array
    translation: Array

    _ranks: ClassVar[dict[str, int]] = {"rotation": 2, "translation": 1}

    def __post_init__(self) -> None:
        if type(self.rotation) is not np.ndarray or type(self.translation) is not np.ndarray:
            object.__setattr__(self, "rotation", as_array(self.rotation))
            object.__setattr__(self, "translation", as_array(self.translation))

    @classmethod
    def identity(cls) -> SE3:
        """The pose of a frame in itself."""
        return cls(np.eye(3), np.zeros(3))

    @classmethod
    def from_matrix(cls, matrix: ArrayLike, check: bool = True) -> SE3:
        """From a homogeneous matrix (..., 4, 4).

        Args:
            matrix: Rotation and translation [m], and a last row 0, 0, 0, 1, shape (..., 4, 4).
            check: Whether its values are checked; without, only its shape is.

        Returns:
            The pose.

        Raises:
            InputError: wrong shape, nan or inf, not a rotation within 1e-6, or another last row.
        """
        if not check:
            m = as_array(matrix)
            return cls(m[..., :3, :3], m[..., :3, 3])
        m = batched_array("matrix", matrix, (4, 4))
        if m.dtype != object:
            error = np.abs(m[..., 3, :] - np.array([0.0, 0.0, 0.0, 1.0])).max(initial=0.0)
            if error > ROTATION_TOLERANCE:
                raise InputError(
                    f"`matrix` has a last row that differs from [0, 0, 0, 1] by {error:.3g}. "
                    "Look whether it is transposed, or scaled."
                )
        return cls(checked_rotation("matrix[:3, :3]", m[..., :3, :3], "SE3.project(matrix)"), m[..., :3, 3])

    @classmethod
    def project(cls, matrix: ArrayLike) -> SE3:
        """The pose with the rotation nearest to that of a matrix (..., 4, 4), and its translation."""
        m = batched_array("matrix", matrix, (4, 4))
        return cls(nearest_rotation(m[..., :3, :3]), m[..., :3, 3])

    @classmethod
    def from_quat_xyzw(cls, quat: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> SE3:
        """From a quaternion and a translation.

        Args:
            quat: Quaternion x, y, z, w of any length but zero, shape (..., 4) [-].
            translation: Translation, shape (..., 3) [m].

        Returns:
            The pose.

        Raises:
            InputError: wrong shape, nan or inf, or a quaternion of length zero.
        """
        return cls(
            quaternion.quat_xyzw_to_matrix(checked_quat(quat)),
            batched_array("translation", translation, (3,)),
        )

    @classmethod
    def from_rpy(cls, rpy: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> SE3:
        """From roll, pitch, yaw as in URDF, and a translation.

        Args:
            rpy: Angles about the fixed axes x, y, z, shape (..., 3) [rad].
            translation: Translation, shape (..., 3) [m].

        Returns:
            The pose.

        Raises:
            InputError: wrong shape, nan or inf.
        """
        rotation = angles.rpy_to_matrix(batched_array("rpy", rpy, (3,)))
        return cls(rotation, batched_array("translation", translation, (3,)))

    @classmethod
    def from_rotation(cls, rotation: ArrayLike | SO3, translation: ArrayLike = (0.0, 0.0, 0.0)) -> SE3:
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
            r = checked_rotation("rotation", rotation, "SO3.project(rotation)")
        return cls(r, batched_array("translation", translation, (3,)))

    @classmethod
    def from_translation(cls, translation: ArrayLike) -> SE3:
        """The translation by a vector (..., 3) [m]."""
        return cls(np.eye(3), batched_array("translation", translation, (3,)))

    @classmethod
    def trans(cls, x: Any, y: Any, z: Any) -> SE3:
        """A translation.

        Args:
            x, y, z: Its components, each of shape (...) [m].

        Returns:
            The pose, with the identity as rotation.
        """
        return cls(np.eye(3), vector(x, y, z))

    @classmethod
    def rx(cls, angle: Any) -> SE3:
        """The rotation about x by `angle` (...) [rad]."""
        return cls(angles.rotation_about(0, angle), np.zeros(3))

    @classmethod
    def ry(cls, angle: Any) -> SE3:
        """The rotation about y by `angle` (...) [rad]."""
        return cls(angles.rotation_about(1, angle), np.zeros(3))

    @classmethod
    def rz(cls, angle: Any) -> SE3:
        """The rotation about z by `angle` (...) [rad]."""
        return cls(angles.rotation_about(2, angle), np.zeros(3))

    @classmethod
    def exp(cls, twist: ArrayLike | Motion) -> SE3:
        """The pose reached by moving with a constant twist, a `Motion` or (..., 6), for one second."""
        if isinstance(twist, Motion):
            return cls(*exponential.exp_parts(twist.linear, twist.angular))
        return se3_exp(batched_array("twist", twist, (6,), "Linear part first."))

    @classmethod
    def random(cls, rng: np.random.Generator, size: tuple[int, ...] = (), reach: float = 1.0) -> SE3:
        """Rotations spread evenly, and translations spread evenly over a cube of +-`reach`.

        Args:
            rng: The source of random numbers.
            size: Shape of the batch.
            reach: Half the edge of the cube [m].

        Returns:
            Poses with that batch shape.
        """
        return cls(SO3.random(rng, size).matrix, rng.uniform(-reach, reach, (*size, 3)))

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, (type(self), np.ndarray, list, tuple)):
            kind = type(self).__name__
            raise UnknownOperation(
                f"{kind} has no `*`; compose and apply with `@`: T_a_b @ T_b_c, T @ points."
            )
        return NotImplemented

    @overload
    def __matmul__(self, other: SE3) -> SE3: ...
    @overload
    def __matmul__(self, other: ArrayLike) -> Array: ...
    def __matmul__(self, other: Any) -> Any:
        """What is given in the inner frame, in the outer one: a pose, or points (..., 3) [m]."""
        if isinstance(other, SE3):
            return SE3(
                self.rotation @ other.rotation, apply(self.rotation, other.translation) + self.translation
            )
        if isinstance(other, Batched):
            return NotImplemented
        points = as_array(other)
        if points.shape[-1:] != (3,):
            raise ShapeError("points", points.shape, "(..., 3)", "A pose goes through SE3.from_matrix first.")
        return apply(self.rotation, points) + self.translation

    def inverse(self) -> SE3:
        """The pose of the outer frame in this one."""
        back = np.swapaxes(self.rotation, -1, -2)
        return SE3(back, -apply(back, self.translation))

    def log(self) -> Motion:
        """The constant twist that leads from the identity to here in one second, turning by at most pi."""
        return Motion(*exponential.log_parts(self.rotation, self.translation))

    def act(self, item: T) -> T:
        """A Motion, Force or Inertia given in the inner frame, in the outer one: T_a_b.act(V_b) is V_a."""
        try:
            moved = item._moved
        except AttributeError:
            raise _not_movable(item) from None
        return moved(self.rotation, self.translation)

    def act_inverse(self, item: T) -> T:
        """A Motion, Force or Inertia given in the outer frame, in the inner one: it undoes `act`."""
        try:
            moved = item._moved_back
        except AttributeError:
            raise _not_movable(item) from None
        return moved(self.rotation, self.translation)

    def adjoint(self) -> Array:
        """The matrix (..., 6, 6) of `act` on motions, linear part first: [[R, skew(p) R], [0, R]]."""
        return self._blocks(0, 3)

    def dual_adjoint(self) -> Array:
        """The matrix (..., 6, 6) of `act` on forces, linear part first: [[R, 0], [skew(p) R, R]]."""
        return self._blocks(3, 0)

    def _blocks(self, row: int, col: int) -> Array:
        corner = skew(self.translation) @ self.rotation
        r, corner = np.broadcast_arrays(self.rotation, corner)
        result = np.zeros((*corner.shape[:-2], 6, 6), dtype=corner.dtype if is_symbolic(corner) else r.dtype)
        result[..., :3, :3] = r
        result[..., 3:, 3:] = r
        result[..., row : row + 3, col : col + 3] = corner
        return result

    def matrix(self) -> Array:
        """The homogeneous matrix (..., 4, 4)."""
        t = self.translation[..., None]
        batch = np.broadcast_shapes(self.rotation.shape[:-2], t.shape[:-2])
        top = np.concatenate(
            [np.broadcast_to(self.rotation, (*batch, 3, 3)), np.broadcast_to(t, (*batch, 3, 1))], axis=-1
        )
        last = np.broadcast_to(np.array([[0.0, 0.0, 0.0, 1.0]]), (*batch, 1, 4))
        return np.concatenate([top, last], axis=-2)

    def quat_xyzw(self) -> Array:
        """The rotation as a unit quaternion x, y, z, w (..., 4) with w >= 0."""
        return quaternion.matrix_to_quat_xyzw(self.rotation)

    def rpy(self) -> Array:
        """The rotation as roll, pitch, yaw (..., 3) [rad]."""
        return angles.matrix_to_rpy(self.rotation)

    def so3(self) -> SO3:
        """The rotation alone."""
        return SO3(self.rotation)

    def interpolate(self, other: SE3, t: Any, straight: bool = False) -> SE3:
        """The pose at a fraction of the path to another one.

        The path is the screw motion from one to the other at constant twist; with `straight` the origin moves along a
        straight line instead, while the rotation turns evenly.

        Args:
            other: The pose at t = 1.
            t: The fraction, shape (...) [-]: 0 here, 1 at `other`.
            straight: Whether the origin moves along a straight line.

        Returns:
            The poses.
        """
        if straight:
            s = column(t)
            rotation = SO3(self.rotation).interpolate(SO3(other.rotation), t).matrix
            return SE3(rotation, self.translation + s * (other.translation - self.translation))
        return self @ SE3.exp((self.inverse() @ other).log() * t)

    def distance(self, other: SE3) -> tuple[Any, Any]:
        """How far apart two poses are: the way between the origins (...) [m], and the angle (...) [rad]."""
        d = other.translation - self.translation
        return sqrt(dot(d, d)), SO3(self.rotation).distance(SO3(other.rotation))

    def is_close(self, other: SE3, tolerance: float = 1e-9) -> Any:
        """Whether two poses are equal within a tolerance.

        Args:
            other: The other pose.
            tolerance: The largest difference of an entry of rotation [-] and translation [m] that is accepted.

        Returns:
            Truth values, shape (...).
        """
        rotation = (np.abs(self.rotation - other.rotation) <= tolerance).all(axis=(-2, -1))
        return rotation & (np.abs(self.translation - other.translation) <= tolerance).all(axis=-1)

    def _dense(self) -> Array:
        return self.matrix()

    def _show(self, indent: int) -> str:
        return numbers(self.matrix(), indent)


def se3_exp(twist: Array) -> SE3:
    """The pose reached by moving with a constant `twist` (..., 6), linear part first, for one second.

    Source: Barfoot, State Estimation for Robotics, eq. (7.42).
    """
    return SE3(*exponential.exp_parts(twist[..., :3], twist[..., 3:]))


def se3_log(pose: SE3) -> Motion:
    """The constant twist that leads from the identity to `pose` in one second, turning by at most pi."""
    return pose.log()


def _not_movable(item: object) -> InputError:
    return InputError(
        f"`item` is a {type(item).__name__}; expected a Motion, Force or Inertia. "
        "Motion.from_vector and Force.from_vector make one of six numbers."
    )
