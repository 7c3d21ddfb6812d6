"""Quaternion and AngleAxis; the coefficients of a quaternion are in the order x, y, z, w."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import exact, is_empty, matrix, numbers, real, text, vector
from pinocchio._containers.attributes import AttributeKind, CheckedAttributes, entries, number
from pinocchio._containers.keywords import by_name, reads_names
from pinocchio._spatial.bound_functions import BoundFunctions, without_gaps
from pinocchio._spatial.small_kernels import small_kernel
from ulna import spatial
from ulna.errors import excerpt
from ulna.numeric import less, where
from ulna.numeric import vector as numeric_vector
from ulna.typing import Array, Floats

_IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
_CONJUGATE = np.array([-1.0, -1.0, -1.0, 1.0])
UNIT_TOLERANCE = 0.01
"""By how much the length of a quaternion may be off where a rotation is made of it."""


def check_unit(quat: Floats, function: str) -> float:
    """Checks that a quaternion is of unit length, to 1 %: of others there is no rotation.

    Args:
        quat: Quaternion xyzw (4,).
        function: What was called with it, for the message.

    Returns:
        Its length [-].

    Raises:
        ArgumentError: It has another length.
    """
    length = float(np.linalg.norm(quat))
    if not abs(length - 1.0) < UNIT_TOLERANCE:
        raise ArgumentError(
            f"{function} was given a quaternion (x, y, z, w) of {quat.tolist()}, {length:.6g} long; expected length 1. "
            "Divide it by its length; q[3:] /= np.linalg.norm(q[3:]) for a position and a quaternion."
        )
    return length


@final
class Quaternion:
    """`Quaternion(w, x, y, z)`, `(R)`, `(coefficients xyzw)`, `(angle_axis)`, `(other)`; the identity without."""

    __slots__ = ("_c",)

    @reads_names("w x y z", "R", "vec4", "aa", "quat", "u v")
    def __init__(self, *parts: Any, **named: Any) -> None:
        known: Any = NotImplemented
        if len(parts) == 1 and not named:
            one = parts[0]
            if type(one) is Quaternion:
                known = one._c.copy()
            elif type(one) is np.ndarray and one.shape == (4,) and one.dtype == float:
                known = one.copy()
            else:
                known = _OF_MATRIX["quaternion"](one)
        elif not (parts or named):
            known = _IDENTITY.copy()
        elif len(parts) == 4 and not named:
            known = _OF_MATRIX["four numbers"](*parts)
        if known is NotImplemented:
            self._set(*parts, **named)
        else:
            self._c = known

    @by_name("w x y z", "R", "vec4", "aa", "quat", "u v")
    def _set(self, *parts: Any) -> None:
        """Sets a new instance to what it is made of."""
        if len(parts) == 4:
            w, x, y, z = parts
            self._c = numbers([x, y, z, w], "w, x, y, z")
        elif len(parts) == 1:
            self._c = _coefficients(parts[0])
        elif len(parts) == 2:
            self._c = _IDENTITY.copy()
            self.setFromTwoVectors(*parts)
        else:
            raise ArgumentError(
                f"Quaternion was given {len(parts)} arguments; expected w, x, y, z, one matrix, or two vectors."
            )

    @staticmethod
    def _of(coefficients: Any) -> Quaternion:
        self = Quaternion.__new__(Quaternion)
        self._c = np.array(coefficients, dtype=float)
        return self

    @staticmethod
    def _holding(storage: Floats) -> Quaternion:
        self = Quaternion.__new__(Quaternion)
        self._c = storage
        return self

    @staticmethod
    def Identity() -> Quaternion:
        """No rotation."""
        return Quaternion()

    @staticmethod
    @by_name("a b", "u v")
    def FromTwoVectors(u: Any, v: Any) -> Quaternion:
        """The least rotation that turns the direction of u into that of v.

        Args:
            u: Vector (3,), not zero.
            v: Vector (3,), not zero, in any unit [-].

        Returns:
            The quaternion.
        """
        return Quaternion().setFromTwoVectors(u, v)

    @by_name("a b", "u v")
    def setFromTwoVectors(self, u: Any, v: Any) -> Quaternion:
        """Sets this quaternion to the least rotation that turns the direction of u into that of v.

        Args:
            u: Vector (3,), not zero.
            v: Vector (3,), not zero, in any unit [-].

        Returns:
            This quaternion.
        """
        a, b = (x / np.linalg.norm(x) for x in (vector(u, 3, "u"), vector(v, 3, "v")))
        half = 0.5 * (a + b) @ (a + b)
        axis = np.cross(a, b - a) if half > 5e-15 else np.cross(a, np.eye(3)[np.abs(a).argmin()])
        self._c[:] = *axis, half if half > 5e-15 else 0.0
        return self._scaled()

    def _scaled(self) -> Quaternion:
        self._c /= np.linalg.norm(self._c)
        return self

    def coeffs(self) -> Floats:
        """x, y, z, w."""
        return self._c.copy()

    def vec(self) -> Floats:
        """x, y, z."""
        return self._c[:3].copy()

    def matrix(self) -> Floats:
        """The rotation matrix (3, 3)."""
        return small_kernel("quaternion matrix")(self._c)

    toRotationMatrix = matrix

    def norm(self) -> float:
        """Its length; 1 for a rotation."""
        return math.sqrt(self._c @ self._c)

    def squaredNorm(self) -> float:
        """Its squared length."""
        return float(self._c @ self._c)

    def normalize(self) -> Quaternion:
        """Scales it to length 1."""
        return self._scaled()

    def normalized(self) -> Quaternion:
        """One like it of length 1."""
        return Quaternion._holding(self._c / math.sqrt(self._c @ self._c))

    def conjugate(self) -> Quaternion:
        """The rotation back, when of length 1."""
        return Quaternion._holding(self._c * _CONJUGATE)

    def inverse(self) -> Quaternion:
        """The rotation back."""
        return Quaternion._holding(self._c * (_CONJUGATE / (self._c @ self._c)))

    def dot(self, other: Quaternion) -> float:
        """The dot product of the coefficients."""
        return float(self._c @ other._c)

    def angularDistance(self, other: Quaternion) -> float:
        """The angle between two rotations [rad]."""
        return float(small_kernel("quaternion angle")(self._c, other._c))

    def slerp(self, t: float, other: Quaternion) -> Quaternion:
        """The rotation between this one and another.

        Args:
            t: Fraction of the way, 0 to 1 [-].
            other: The other quaternion.

        Returns:
            The quaternion.
        """
        return Quaternion._holding(small_kernel("quaternion between")(self._c, other._c, np.float64(t)))

    def setIdentity(self) -> Quaternion:
        """Makes it the identity."""
        self._c[:] = _IDENTITY
        return self

    @by_name("quat", "aa", "other")
    def assign(self, other: Any) -> Quaternion:
        """Takes over another rotation."""
        self._c[:] = _coefficients(other)
        return self

    def isApprox(self, other: Quaternion, prec: float = 1e-12) -> bool:
        """Whether the coefficients agree.

        Args:
            other: Another quaternion.
            prec: Largest norm of their difference [-].

        Returns:
            Whether they do.
        """
        return bool(np.linalg.norm(self._c - other._c) <= prec)

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Quaternion):
            return Quaternion._holding(small_kernel("quaternion product")(self._c, other._c))
        if isinstance(other, (np.ndarray, np.number)) and other.shape not in ((3,), (3, 1)):
            return NotImplemented
        return small_kernel("quaternion point")(self._c, vector(other, 3, "v"))

    def __imul__(self, other: Any) -> Quaternion:
        if not isinstance(other, Quaternion):
            raise ArgumentError(f"A Quaternion *= was given {excerpt(repr(other))}; expected a Quaternion.")
        self._c[:] = (self * other)._c
        return self

    def _transformVector(self, vector: Any) -> Floats:
        """The vector (3,) turned."""
        return self * exact(vector, 3, "v")

    def __getitem__(self, place: int) -> float:
        return float(self._c[place])

    def __setitem__(self, place: int, value: float) -> None:
        self._c[place] = value

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        out = np.empty((), object)  # a sequence, but no vector that could be added or scaled
        out[()] = self
        return out if dtype is None else out.astype(dtype)

    def __abs__(self) -> float:
        return self.norm()

    def __len__(self) -> int:
        return 4

    def __eq__(self, other: object) -> bool:
        return bool((self._c == other._c).all()) if isinstance(other, Quaternion) else NotImplemented

    __hash__ = object.__hash__

    def __reduce__(self) -> Any:
        return Quaternion, (self._c.copy(),)

    def __str__(self) -> str:
        return f"(x,y,z,w) = {text(self._c)}\n"

    __repr__ = __str__


for _place, _letter in enumerate("xyzw"):
    setattr(
        Quaternion,
        _letter,
        property(
            lambda self, place=_place: float(self._c[place]),
            lambda self, value, place=_place, name=_letter: self._c.__setitem__(place, real(value, name)),
            doc=f"The coefficient {_letter}.",
        ),
    )


def _coefficients(one: Any) -> Floats:
    if isinstance(one, Quaternion):
        return one._c.copy()
    result = without_gaps(_OF_MATRIX["quaternion"], one)
    if result is not NotImplemented:
        return result
    if isinstance(one, AngleAxis):
        one = one.matrix()
    array = numbers(one, "coefficients")
    if array.shape == (3, 3):
        return coefficients_of(np.array(array, dtype=float))
    return vector(one, 4, "coefficients").copy()


def quaternion_of(R: Array) -> Array:
    """The quaternion xyzw of a rotation matrix, with the sign that Eigen gives it: its largest entry is positive.

    Largest is w where the trace is positive, else the entry of the largest number on the diagonal.

    Args:
        R: Rotation matrix (3, 3).

    Returns:
        Quaternion (4,) [-].
    """
    x, y, z, w = quaternion = spatial.matrix_to_quat_xyzw(R)
    a, b, c = R[0, 0], R[1, 1], R[2, 2]
    of_diagonal = where(less(a, b), where(less(b, c), z, y), where(less(a, c), z, x))
    lead = where(less(0.0, a + b + c), w, of_diagonal)
    return numeric_vector(*(where(less(lead, 0.0), -entry, entry) for entry in quaternion))


def _angle_and_axis(R: Array) -> Array:
    angle, axis = spatial.matrix_to_angle_axis(R)
    return np.concatenate([[angle], axis])


_OF_MATRIX = BoundFunctions(
    {
        "quaternion": (quaternion_of, (3, 3)),
        "angle and axis": (_angle_and_axis, (3, 3)),
        "four numbers": (lambda w, x, y, z: 1.0 * numeric_vector(x, y, z, w), (), (), (), ()),
    },
    exact=True,
)


def coefficients_of(R: Floats) -> Floats:
    """The quaternion xyzw (4,) of a rotation matrix (3, 3) of floats; see `quaternion_of`."""
    return without_gaps(_OF_MATRIX["quaternion"], R)


@final
class AngleAxis(CheckedAttributes):
    """A rotation by an angle [rad] about a unit axis: `AngleAxis(angle, axis)`, `(R)`, `(quaternion)`."""

    angle: float
    axis: Floats
    _kinds: ClassVar[Mapping[str, AttributeKind]] = {"angle": number, "axis": entries}

    @reads_names("angle axis", "R", "quaternion", "copy")
    def __init__(self, *parts: Any, **named: Any) -> None:
        four = NotImplemented if named or len(parts) != 1 else _OF_MATRIX["angle and axis"](parts[0])
        if four is NotImplemented:
            self._set(*parts, **named)
        else:
            own = self.__dict__  # attributes that are set are checked
            own["angle"], own["axis"] = four.item(0), four[1:].copy()

    @by_name("angle axis", "R", "quaternion", "copy")
    def _set(self, *parts: Any) -> None:
        """Sets a new instance to what it is made of."""
        self._keep(angle=0.0, axis=np.array([1.0, 0.0, 0.0]))
        if len(parts) == 2:
            self.angle, self.axis = parts
        elif len(parts) == 1:
            one = parts[0]
            if isinstance(one, AngleAxis):
                self.angle, self.axis = one.angle, one.axis
            else:
                self.fromRotationMatrix(one.matrix() if hasattr(one, "matrix") else one)
        elif parts:
            raise ArgumentError(
                f"AngleAxis was given {len(parts)} arguments; expected (angle, axis), a matrix, or a quaternion."
            )

    @by_name("rotation", "R")
    def fromRotationMatrix(self, R: Any) -> AngleAxis:
        """Takes over a rotation matrix."""
        turn = np.ascontiguousarray(matrix(R, (3, 3), "R"))
        four = _OF_MATRIX["angle and axis"](turn)
        self._keep(angle=float(four[0]), axis=four[1:].copy())
        return self

    def matrix(self) -> Floats:
        """The rotation matrix (3, 3)."""
        return small_kernel("turn")(np.float64(self.angle), self.axis)

    toRotationMatrix = matrix

    def inverse(self) -> AngleAxis:
        """The rotation back."""
        out = object.__new__(AngleAxis)
        out.__dict__.update(angle=-self.angle, axis=self.axis.copy())
        return out

    def isApprox(self, other: AngleAxis, prec: float = 1e-12) -> bool:
        """Whether angle and axis agree.

        Args:
            other: Another rotation.
            prec: Largest difference of both [-].

        Returns:
            Whether they do.
        """
        return abs(self.angle - other.angle) <= prec and bool(np.linalg.norm(self.axis - other.axis) <= prec)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, AngleAxis):
            return NotImplemented
        return self.angle == other.angle and self.axis.tolist() == other.axis.tolist()

    __hash__ = object.__hash__

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, (AngleAxis, Quaternion)):
            return Quaternion(self) * Quaternion(other)
        return NotImplemented if is_empty(other) else self.matrix() @ vector(other, 3, "v")

    def __str__(self) -> str:
        return f"angle: {self.angle:.6g}\naxis: {text(self.axis)}\n"

    __repr__ = __str__
