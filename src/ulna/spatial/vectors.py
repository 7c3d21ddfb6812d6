"""Spatial velocities and forces: a pair of 3-vectors each, linear part first.

A `Motion` is a twist: the velocity of the point at the origin of the frame it is written in [m/s], and the
angular velocity [rad/s]. A `Force` is a wrench: the force [N], and the moment about that origin [N m].
Accelerations and momenta are of the same two kinds. Source: Featherstone, Rigid Body Dynamics Algorithms,
chapter 2 (which writes the angular part first).
"""

from __future__ import annotations

from typing import Any, ClassVar, Self, final, overload

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.data_classes import dataclass
from ulna.numeric import apply, cross, dot, matrix
from ulna.spatial.batched import FLOAT, Batched, as_array, column
from ulna.typing import Array, ArrayLike


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SpatialVector(Batched):
    """What twists and wrenches share: they are added and scaled, each kind with its own."""

    linear: Array
    angular: Array

    _ranks: ClassVar[dict[str, int]] = {"linear": 1, "angular": 1}

    def __post_init__(self) -> None:
        linear, angular = self.linear, self.angular
        if type(linear) is not np.ndarray or linear.dtype is not FLOAT:
            object.__setattr__(self, "linear", as_array(linear))
        if type(angular) is not np.ndarray or angular.dtype is not FLOAT:
            object.__setattr__(self, "angular", as_array(angular))

    @classmethod
    def zero(cls, batch_shape: tuple[int, ...] = ()) -> Self:
        """The zero vector, or a batch of them."""
        return cls(np.zeros((*batch_shape, 3)), np.zeros((*batch_shape, 3)))

    @classmethod
    def from_vector(cls, vector: ArrayLike) -> Self:
        """From an array (..., 6), linear part first.

        Raises:
            ShapeError, DtypeError, NonFiniteError: it is not six finite numbers.
        """
        v = np.array(batched_array("vector", vector, (6,)))  # a copy: `vector` may change
        return cls(v[..., :3], v[..., 3:])

    def vector(self) -> Array:
        """The array (..., 6), linear part first."""
        return np.concatenate(np.broadcast_arrays(self.linear, self.angular), axis=-1)

    def __add__(self, other: Self) -> Self:
        if type(other) is not type(self):
            return NotImplemented
        return type(self)(self.linear + other.linear, self.angular + other.angular)

    def __sub__(self, other: Self) -> Self:
        if type(other) is not type(self):
            return NotImplemented
        return type(self)(self.linear - other.linear, self.angular - other.angular)

    def __neg__(self) -> Self:
        return type(self)(-self.linear, -self.angular)

    def __mul__(self, factor: Any) -> Self:
        """Scaled by a number, or by a batch of numbers of the batch's shape."""
        if isinstance(factor, Batched):
            return NotImplemented
        s = column(factor)
        return type(self)(s * self.linear, s * self.angular)

    __rmul__ = __mul__

    def __truediv__(self, divisor: Any) -> Self:
        if isinstance(divisor, Batched):
            return NotImplemented
        s = column(divisor)
        return type(self)(self.linear / s, self.angular / s)

    def is_close(self, other: Self, tolerance: float = 1e-9) -> Any:
        """Whether two vectors are equal within a tolerance.

        Args:
            other: The other vector.
            tolerance: The largest difference of a component that is accepted, in the units of the vector [any].

        Returns:
            Truth values, shape (...).
        """
        return (np.abs(self.vector() - other.vector()) <= tolerance).all(axis=-1)

    def _dense(self) -> Array:
        return self.vector()


@final
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Motion(SpatialVector):
    """A twist: velocity [m/s] of the point at the origin, and angular velocity [rad/s], both (..., 3)."""

    @overload
    def cross(self, other: Motion) -> Motion: ...
    @overload
    def cross(self, other: Force) -> Force: ...
    def cross(self, other: Motion | Force) -> Motion | Force:
        """The rate of `other` when it is fixed in a body that has this twist. Featherstone, eq. (2.31-32)."""
        v, w = self.linear, self.angular
        if isinstance(other, Force):
            return Force(cross(w, other.linear), cross(w, other.angular) + cross(v, other.linear))
        return Motion(cross(w, other.linear) + cross(v, other.angular), cross(w, other.angular))

    def dot(self, force: Force) -> Any:
        """The power (...) [W] of a wrench on this twist."""
        return dot(self.linear, force.linear) + dot(self.angular, force.angular)

    def cross_matrix(self) -> Array:
        """The matrix ad (..., 6, 6) with ad @ m.vector() = self.cross(m).vector(); for forces it is -ad.T."""
        (a, b, c), (x, y, z) = ([u[..., n] for n in range(3)] for u in (self.linear, self.angular))
        o = 0.0
        return matrix(
            [
                [o, -z, y, o, -c, b],
                [z, o, -x, c, o, -a],
                [-y, x, o, -b, a, o],
                [o, o, o, o, -z, y],
                [o, o, o, z, o, -x],
                [o, o, o, -y, x, o],
            ]
        )

    def _moved(self, rotation: Array, translation: Array) -> Motion:
        w = apply(rotation, self.angular)
        return Motion(apply(rotation, self.linear) + cross(translation, w), w)

    def _moved_back(self, rotation: Array, translation: Array) -> Motion:
        back = np.swapaxes(rotation, -1, -2)
        return Motion(apply(back, self.linear - cross(translation, self.angular)), apply(back, self.angular))


@final
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Force(SpatialVector):
    """A wrench: force [N], and moment [N m] about the frame's origin, both (..., 3)."""

    def dot(self, motion: Motion) -> Any:
        """The power (...) [W] of this wrench on a twist."""
        return motion.dot(self)

    def _moved(self, rotation: Array, translation: Array) -> Force:
        f = apply(rotation, self.linear)
        return Force(f, apply(rotation, self.angular) + cross(translation, f))

    def _moved_back(self, rotation: Array, translation: Array) -> Force:
        back = np.swapaxes(rotation, -1, -2)
        return Force(apply(back, self.linear), apply(back, self.angular - cross(translation, self.linear)))
