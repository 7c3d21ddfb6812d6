"""Rotations in space."""

from __future__ import annotations

from typing import Any, ClassVar, final

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.checks.rotations import checked_rotation
from ulna.data_classes import dataclass
from ulna.errors import ShapeError
from ulna.idioms import Explained, explained
from ulna.numeric import apply, dot, sqrt
from ulna.spatial import angles, exponential, quaternion
from ulna.spatial.batched import FLOAT, Batched, Composed, as_array, column, component, numbers, unit_vectors
from ulna.spatial.nearest import nearest_rotation
from ulna.typing import Array, ArrayLike


@final
@explained("SO3")
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SO3(Composed, metaclass=Explained):
    """A rotation, or a batch of them: `R_a_b @ p_b` is p_a.

    Attributes:
        matrix: orthogonal matrix (..., 3, 3) with determinant 1.
    """

    matrix: Array

    _ranks: ClassVar[dict[str, int]] = {"matrix": 2}

    def __post_init__(self) -> None:
        if type(self.matrix) is not np.ndarray or self.matrix.dtype is not FLOAT:
            object.__setattr__(self, "matrix", as_array(self.matrix))

    @classmethod
    def identity(cls) -> SO3:
        """No rotation."""
        return cls(np.eye(3))

    @classmethod
    def from_matrix(cls, matrix: ArrayLike) -> SO3:
        """From a matrix (..., 3, 3), checked.

        Raises:
            InputError: wrong shape, nan or inf, or not a rotation within 1e-6.
        """
        return cls(np.array(checked_rotation("matrix", matrix, "SO3.project(matrix)")))

    @classmethod
    def project(cls, matrix: ArrayLike) -> SO3:
        """The rotation nearest to a matrix (..., 3, 3) in the Frobenius norm."""
        return cls(nearest_rotation(batched_array("matrix", matrix, (3, 3))))

    @classmethod
    def from_quat_xyzw(cls, quat: ArrayLike) -> SO3:
        """From a quaternion x, y, z, w (..., 4) of any length but zero."""
        return cls(quaternion.quat_xyzw_to_matrix(checked_quat(quat)))

    @classmethod
    def from_rpy(cls, rpy: ArrayLike) -> SO3:
        """From roll, pitch, yaw (..., 3) [rad]: Rz(yaw) Ry(pitch) Rx(roll), as in URDF."""
        return cls(angles.rpy_to_matrix(batched_array("rpy", rpy, (3,))))

    @classmethod
    def from_euler(cls, angles_: ArrayLike, axes: str) -> SO3:
        """From three angles about moving axes; see `euler_to_matrix`.

        Args:
            angles_: The three angles, shape (..., 3) [rad].
            axes: Three letters of xyz, neighbours different, such as "zyx".

        Returns:
            The rotation.

        Raises:
            InputError: wrong shape, nan or inf, or `axes` is not three letters of xyz with neighbours different.
        """
        return cls(angles.euler_to_matrix(batched_array("angles", angles_, (3,)), axes))

    @classmethod
    def from_angle_axis(cls, angle: Any, axis: ArrayLike) -> SO3:
        """From an angle about an axis.

        Args:
            angle: Angle, shape (...) [rad].
            axis: Direction of any length but zero, shape (..., 3).

        Returns:
            The rotation.

        Raises:
            InputError: wrong shape, nan or inf, or an axis of length zero.
        """
        unit = unit_vectors("axis", axis, 3, "a direction, such as [0, 0, 1]")
        return cls(angles.angle_axis_to_matrix(batched_array("angle", angle, ())[()], unit))

    @classmethod
    def rx(cls, angle: Any) -> SO3:
        """The rotation about x by `angle` (...) [rad]."""
        return cls(angles.rotation_about(0, component("angle", angle)))

    @classmethod
    def ry(cls, angle: Any) -> SO3:
        """The rotation about y by `angle` (...) [rad]."""
        return cls(angles.rotation_about(1, component("angle", angle)))

    @classmethod
    def rz(cls, angle: Any) -> SO3:
        """The rotation about z by `angle` (...) [rad]."""
        return cls(angles.rotation_about(2, component("angle", angle)))

    @classmethod
    def exp(cls, w: ArrayLike) -> SO3:
        """The rotation about the direction of `w` (..., 3) by its length [rad]."""
        return cls(exponential.so3_exp(batched_array("w", w, (3,))))

    @classmethod
    def random(cls, rng: np.random.Generator, size: tuple[int, ...] = ()) -> SO3:
        """Rotations spread evenly over all of SO(3).

        Args:
            rng: The source of random numbers.
            size: Shape of the batch.

        Returns:
            Rotations with that batch shape.
        """
        return cls(quaternion.quat_xyzw_to_matrix(quaternion.quat_normalize(rng.standard_normal((*size, 4)))))

    def log(self) -> Array:
        """The rotation vector (..., 3) [rad], no longer than pi."""
        return exponential.so3_log(self.matrix)

    def inverse(self) -> SO3:
        """The rotation back."""
        return SO3(np.swapaxes(self.matrix, -1, -2))

    def __matmul__(self, other: Any) -> Any:
        """The rotation `other` followed by this one; or vectors (..., 3), rotated."""
        if isinstance(other, SO3):
            return SO3(self.matrix @ other.matrix)
        if isinstance(other, Batched):
            return NotImplemented
        vectors = as_array(other)
        if vectors.shape[-1:] != (3,):
            raise ShapeError(
                "vectors", vectors.shape, "(..., 3)", "A rotation goes through SO3.from_matrix first."
            )
        return apply(self.matrix, vectors)

    def __rmatmul__(self, other: ArrayLike) -> SO3:
        """A rotation matrix (..., 3, 3) times this rotation: a rotation."""
        matrix = as_array(other)
        if matrix.shape[-2:] != (3, 3):
            raise ShapeError("the matrix before `@`", matrix.shape, "(..., 3, 3), a rotation")
        return SO3.from_matrix(matrix) @ self

    def as_matrix(self) -> Array:
        """The rotation matrix (..., 3, 3); `matrix` is the same array."""
        return self.matrix

    def quat_xyzw(self) -> Array:
        """The unit quaternion x, y, z, w (..., 4) with w >= 0."""
        return quaternion.matrix_to_quat_xyzw(self.matrix)

    def rpy(self) -> Array:
        """Roll, pitch, yaw (..., 3) [rad]."""
        return angles.matrix_to_rpy(self.matrix)

    def euler(self, axes: str) -> Array:
        """Three angles (..., 3) [rad] about moving axes, such as "zyx"; see `matrix_to_euler`."""
        return angles.matrix_to_euler(self.matrix, axes)

    def angle_axis(self) -> tuple[Any, Array]:
        """The angle (...) in [0, pi] [rad] and the unit axis (..., 3)."""
        return angles.matrix_to_angle_axis(self.matrix)

    def interpolate(self, other: SO3, t: Any) -> SO3:
        """The rotation at a fraction of the shortest path to another one, at constant rate.

        Args:
            other: The rotation at t = 1.
            t: The fraction, shape (...) [-]: 0 here, 1 at `other`.

        Returns:
            The rotations.
        """
        step = exponential.so3_log(np.swapaxes(self.matrix, -1, -2) @ other.matrix)
        return SO3(self.matrix @ exponential.so3_exp(column(t) * step))

    def distance(self, other: SO3) -> Any:
        """The angle (...) [rad] of the rotation that leads from one to the other."""
        w = exponential.so3_log(np.swapaxes(self.matrix, -1, -2) @ other.matrix)
        return sqrt(dot(w, w))

    def is_close(self, other: SO3, tolerance: float = 1e-9) -> Any:
        """Whether two rotations are equal within a tolerance.

        Args:
            other: The other rotation.
            tolerance: The largest difference of an entry of the matrices that is accepted [-].

        Returns:
            Truth values, shape (...).
        """
        return (np.abs(self.matrix - other.matrix) <= tolerance).all(axis=(-2, -1))

    def _dense(self) -> Array:
        return self.matrix

    def _show(self, indent: int) -> str:
        return numbers(self.matrix, indent)


def checked_quat(quat: ArrayLike) -> Array:
    """A quaternion (..., 4) of the user's, normalised.

    Raises:
        InputError: wrong shape, nan or inf, or zero.
    """
    expected = "a quaternion x, y, z, w, such as [0, 0, 0, 1] for no rotation"
    return unit_vectors("quat", quat, 4, expected, "The order is x, y, z, w.")
