"""Poses: where a frame stands, as rotation and translation."""

from __future__ import annotations

from typing import Any, ClassVar, Protocol, Self, TypeVar, final, overload

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.checks.values import flag, short_repr
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError
from ulna.idioms import Explained, explained
from ulna.numeric import apply, dot, skew, sqrt, vector
from ulna.spatial import angles, exponential, quaternion
from ulna.spatial.batched import FLOAT, Batched, as_array, column, component, core_shapes, numbers
from ulna.spatial.pose_constructors import PoseConstructors
from ulna.spatial.so3 import SO3
from ulna.spatial.vectors import Motion
from ulna.typing import Array, ArrayLike


class Movable(Protocol):
    """What a pose can express in another frame: Motion, Force, Inertia."""

    def _moved(self, rotation: Array, translation: Array) -> Self: ...
    def _moved_back(self, rotation: Array, translation: Array) -> Self: ...


T = TypeVar("T", bound=Movable)

_MATRIX, _VECTOR, _set = (3, 3), (3,), object.__setattr__


@final
@explained("SE3")
@dataclass(frozen=True, slots=True, eq=False, repr=False, init=False)
class SE3(PoseConstructors, metaclass=Explained):
    """A pose, or a batch of them: `T_a_b @ p_b` is p_a, `T_a_b @ T_b_c` is T_a_c.

    `SE3(rotation, translation)` takes both parts, unchecked; `SE3(T)` a homogeneous matrix (..., 4, 4), which is
    checked, or a pose; `SE3(x, y, z)` a translation [m]; `SE3()` is the identity.

    Attributes:
        rotation: orthogonal matrix (..., 3, 3) with determinant 1.
        translation: vector (..., 3) [m].

    Args:
        rotation: Rotation matrix, shape (..., 3, 3) [-], an SO3, a pose (..., 4, 4), or x [m], shape (...).
        translation: Translation, shape (..., 3) [m], or y [m], shape (...).
        z: z [m], shape (...), where the others are x and y.

    Raises:
        InputError: What is given makes no pose; the message says what does.

    Example:
        >>> T_world_table = ulna.SE3(0.6, 0.0, 0.4)
        >>> T_table_cup = ulna.SE3.trans(0.1, 0.2, 0.0) @ ulna.SE3.rz(np.pi / 2)
        >>> T_world_cup = T_world_table @ T_table_cup
        >>> T_world_cup.translation, T_world_cup.rpy().round(3)
        (array([0.7, 0.2, 0.4]), array([ 0.   , -0.   ,  1.571]))
        >>> T_world_cup @ [0.1, 0.0, 0.0]  # a point of the cup, in the world
        array([0.7, 0.3, 0.4])
    """

    rotation: Array
    translation: Array

    _ranks: ClassVar[dict[str, int]] = {"rotation": 2, "translation": 1}

    def __init__(self, rotation: Any = None, translation: Any = None, z: Any = None) -> None:
        if type(rotation) is not np.ndarray or type(translation) is not np.ndarray or z is not None:
            rotation, translation = _parts(rotation, translation, z)
        elif rotation.dtype is not FLOAT or translation.dtype is not FLOAT:
            rotation, translation = as_array(rotation), as_array(translation)
        if rotation.shape[-2:] != _MATRIX or translation.shape[-1:] != _VECTOR:
            raise _wrong_parts(rotation, translation)
        _set(self, "rotation", rotation)
        _set(self, "translation", translation)

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

    @overload
    def __matmul__(self, other: SE3) -> SE3: ...
    @overload
    def __matmul__(self, other: ArrayLike) -> Any: ...
    def __matmul__(self, other: Any) -> Any:
        """What is given in the inner frame, in the outer one: a pose or matrix (..., 4, 4), or points (..., 3) [m]."""
        if isinstance(other, SE3):
            return SE3(
                self.rotation @ other.rotation, apply(self.rotation, other.translation) + self.translation
            )
        if isinstance(other, Batched):
            return NotImplemented
        points = as_array(other)
        if points.shape[-2:] == (4, 4):
            return self @ SE3.from_matrix(points)
        if points.shape[-1:] != (3,):
            raise ShapeError("points", points.shape, "(..., 3), or a pose (..., 4, 4)")
        return apply(self.rotation, points) + self.translation

    def __rmatmul__(self, other: ArrayLike) -> SE3:
        """A matrix (..., 4, 4), such as `robot.fk(q)`, times this pose: a pose."""
        matrix = as_array(other)
        if matrix.shape[-2:] != (4, 4):
            raise ShapeError("the matrix before `@`", matrix.shape, "(..., 4, 4), a pose")
        return SE3.from_matrix(matrix) @ self

    def inverse(self) -> SE3:
        """The pose of the outer frame in this one.

        Example:
            >>> T_world_camera = ulna.SE3.looking_at((1.0, 0.0, 1.0), (0.0, 0.0, 0.0))
            >>> T_camera_world = T_world_camera.inverse()
            >>> (T_camera_world @ np.zeros(3)).round(3)  # the world's origin is straight ahead
            array([0.   , 0.   , 1.414])
        """
        back = np.swapaxes(self.rotation, -1, -2)
        return SE3(back, -apply(back, self.translation))

    def log(self) -> Motion:
        """The constant twist that leads from the identity to here in one second, turning by at most pi.

        Example:
            >>> twist = (ulna.SE3(0.1, 0.0, 0.0) @ ulna.SE3.rz(0.2)).log()
            >>> twist.angular, ulna.SE3.exp(twist).rpy().round(3)
            (array([0. , 0. , 0.2]), array([ 0. , -0. ,  0.2]))
        """
        return Motion(*exponential.log_parts(self.rotation, self.translation))

    def act(self, item: T) -> T:
        """A Motion, Force or Inertia given in the inner frame, in the outer one: T_a_b.act(V_b) is V_a.

        Example:
            >>> force = ulna.Force((0.0, 0.0, -10.0), (0.0, 0.0, 0.0))  # 10 N down, at the end of a stick
            >>> ulna.SE3(0.5, 0.0, 0.0).act(force).angular  # its moment at the other end, half a metre away [N m]
            array([0., 5., 0.])
        """
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
        result = np.zeros((*corner.shape[:-2], 6, 6), dtype=np.result_type(r, corner))
        result[..., :3, :3] = r
        result[..., 3:, 3:] = r
        result[..., row : row + 3, col : col + 3] = corner
        return result

    def as_matrix(self) -> Array:
        """The homogeneous matrix (..., 4, 4).

        Example:
            >>> ulna.SE3(0.1, 0.2, 0.3).as_matrix()[:3, 3]
            array([0.1, 0.2, 0.3])
        """
        t = self.translation[..., None]
        batch = np.broadcast_shapes(self.rotation.shape[:-2], t.shape[:-2])
        top = np.concatenate(
            [np.broadcast_to(self.rotation, (*batch, 3, 3)), np.broadcast_to(t, (*batch, 3, 1))], axis=-1
        )
        last = np.broadcast_to(np.array([[0.0, 0.0, 0.0, 1.0]]), (*batch, 1, 4))
        return np.concatenate([top, last], axis=-2)

    def matrix(self) -> Array:
        """The same as `as_matrix()`."""
        return self.as_matrix()

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

        Example:
            >>> T = ulna.SE3().interpolate(ulna.SE3(0.4, 0.0, 0.0), 0.5)
            >>> T.translation
            array([0.2, 0. , 0. ])
        """
        if flag("straight", straight):
            s = column(t)
            rotation = SO3(self.rotation).interpolate(SO3(other.rotation), t).matrix
            return SE3(rotation, self.translation + s * (other.translation - self.translation))
        return self @ SE3.exp((self.inverse() @ other).log() * t)

    def distance(self, other: SE3) -> tuple[Any, Any]:
        """How far apart two poses are: the way between the origins (...) [m], and the angle (...) [rad].

        Example:
            >>> ulna.SE3().distance(ulna.SE3(3.0, 4.0, 0.0))
            (np.float64(5.0), np.float64(0.0))
        """
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


@core_shapes(twist=(6,))
def se3_exp(twist: Array) -> SE3:
    """The pose reached by moving with a constant `twist` (..., 6), linear part first, for one second.

    Source: Barfoot, State Estimation for Robotics, eq. (7.42).
    """
    return SE3(*exponential.exp_parts(twist[..., :3], twist[..., 3:]))


def se3_log(pose: SE3) -> Motion:
    """The constant twist that leads from the identity to `pose` in one second, turning by at most pi.

    Raises:
        InputError: `pose` is no SE3.
    """
    if not isinstance(pose, SE3):
        raise InputError(
            f"`pose` is {short_repr(pose)}; expected an SE3. SE3.from_matrix(T) makes one of a matrix (4, 4)."
        )
    return pose.log()


def _parts(rotation: Any, translation: Any, z: Any) -> tuple[Array, Array]:
    """Rotation and translation of what a pose was made of."""
    if z is not None:
        if np.ndim(rotation) > 1 and np.shape(rotation)[-2:] == (3, 3):
            raise InputError(
                "Expected SE3(rotation, translation) or SE3(x, y, z); three arguments with a matrix."
            )
        y = 0.0 if translation is None else component("y", translation)
        return np.eye(3), vector(component("x", rotation), y, component("z", z))
    if translation is not None:
        return as_array(rotation.matrix if isinstance(rotation, SO3) else rotation), as_array(translation)
    if rotation is None:
        return np.eye(3), np.zeros(3)
    if isinstance(rotation, SE3):
        return rotation.rotation, rotation.translation
    if isinstance(rotation, SO3):
        return rotation.matrix, np.zeros(3)
    matrix = as_array(rotation)
    if matrix.shape[-2:] != (4, 4):
        raise ShapeError("T", matrix.shape, "(..., 4, 4)", _CONSTRUCTORS)
    pose = SE3.from_matrix(matrix)
    return pose.rotation, pose.translation


_CONSTRUCTORS = (
    "SE3(x, y, z), SE3.from_translation(p), SE3.from_rotation(R, p), SE3.from_quat_xyzw(quat, p), "
    "SE3.from_rpy(rpy, p), SE3.pointing_down(p) make poses of other things."
)


def read_only(pose: SE3) -> SE3:
    """A pose that stays as it is, for what is frozen: with arrays of its own that cannot be written to.

    Args:
        pose: A pose.

    Returns:
        The same pose.
    """
    parts = np.array(pose.rotation), np.array(pose.translation)
    for part in parts:
        part.setflags(write=False)
    return SE3(*parts)


def _wrong_parts(rotation: Array, translation: Array) -> ShapeError:
    if rotation.shape[-2:] != (3, 3):
        return ShapeError("rotation", rotation.shape, "(..., 3, 3)", _CONSTRUCTORS)
    return ShapeError("translation", translation.shape, "(..., 3)", _CONSTRUCTORS)


def _not_movable(item: object) -> InputError:
    return InputError(
        f"`item` is a {type(item).__name__}; expected a Motion, Force or Inertia. "
        "Motion.from_vector and Force.from_vector make one of six numbers."
    )
