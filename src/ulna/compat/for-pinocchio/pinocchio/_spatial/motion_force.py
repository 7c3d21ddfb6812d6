"""Motion and Force: six numbers, the linear part first, with views of both parts."""

from __future__ import annotations

from typing import Any, Self, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError, is_number
from pinocchio._containers.arrays import matrix, numbers, real, text, vector
from pinocchio._containers.files import register
from pinocchio._containers.keywords import by_name, reads_names, the_one
from pinocchio._spatial.bound_functions import BoundFunctions, directly, without_gaps
from pinocchio._spatial.random_numbers import Random
from pinocchio._spatial.se3 import SE3
from pinocchio._spatial.small_kernels import SIX_NUMBERS, SMALL, pose, small_kernel
from ulna import numeric, spatial
from ulna.errors import excerpt
from ulna.typing import Array, Floats

_new = object.__new__


class _Six:
    """What motions and forces have in common."""

    __slots__ = ("_v",)
    _names = ("linear", "angular")
    _signs = ("v", "w")
    _tower: Any
    _made: BoundFunctions

    @reads_names("linear angular", "array", "clone")
    def __init__(self, *parts: Any, **named: Any) -> None:
        if named:
            self._set(*parts, **named)
        elif not parts:
            self._v = np.zeros(6)
        elif len(parts) == 1 and type(parts[0]) is type(self):
            self._v = parts[0]._v.copy()
        else:
            numbers = _SIX["parts" if len(parts) == 2 else "copy"](*parts)
            if numbers is NotImplemented:
                self._set(*parts)
            else:
                self._v = numbers

    @by_name("linear angular", "array", "clone")
    def _set(self, *parts: Any) -> None:
        """Sets a new instance to what it is made of."""
        kind = type(self).__name__
        if not parts:
            self._v = np.zeros(6)
        elif len(parts) == 1:
            one = parts[0]
            self._v = one._v.copy() if isinstance(one, type(self)) else vector(one, 6, "vector").copy()
        elif len(parts) == 2:
            both = without_gaps(_SIX["parts"], *parts)
            if both is NotImplemented:
                both = np.concatenate([vector(p, 3, n) for p, n in zip(parts, self._names, strict=True)])
            self._v = both
        else:
            raise ArgumentError(
                f"{kind} was given {len(parts)} arguments; expected a linear and an angular part."
            )

    @classmethod
    def _of(cls, storage: Floats) -> Self:
        self = _new(cls)
        self._v = storage
        return self

    def _assign(self, other: Any) -> None:
        self._v[:] = other._v if isinstance(other, type(self)) else vector(other, 6, "vector")

    @classmethod
    def Zero(cls) -> Self:
        """All zero."""
        return cls._of(np.zeros(6))

    @property
    def linear(self) -> Floats:
        """The linear part (3,), a view; assigning copies into it."""
        return self._v[:3]

    @linear.setter
    def linear(self, value: Any) -> None:
        self._v[:3] = vector(value, 3, "linear")

    @property
    def angular(self) -> Floats:
        """The angular part (3,), a view; assigning copies into it."""
        return self._v[3:]

    @angular.setter
    def angular(self, value: Any) -> None:
        self._v[3:] = vector(value, 3, "angular")

    @property
    def vector(self) -> Floats:
        """All six numbers, the linear part first, a view; assigning copies into it."""
        return self._v

    @vector.setter
    def vector(self, value: Any) -> None:
        self._v[:] = vector(value, 6, "vector")

    @property
    def np(self) -> Floats:
        """All six numbers, a view."""
        return self._v

    def __array__(self, dtype: Any = None, copy: Any = None) -> Floats:
        return np.array(self._v, dtype=dtype, copy=copy)

    def setZero(self) -> None:
        """Makes it zero."""
        self._v.fill(0.0)

    def setRandom(self) -> None:
        """Draws it anew; see `Random`."""
        self._v[:] = self._made["random"]()._v

    def copy(self) -> Self:
        """A copy."""
        return self._of(self._v.copy())

    __copy__ = cast = copy

    def __deepcopy__(self, memo: Any) -> Self:
        return self.copy()

    def __reduce__(self) -> Any:
        return type(self), (self._v[:3].copy(), self._v[3:].copy())

    def isApprox(self, other: Self, prec: float = 1e-12) -> bool:
        """Whether both parts differ by at most `prec` times the smaller of their norms."""
        if not isinstance(other, type(self)):
            kind = type(self).__name__
            raise ArgumentError(f"{kind}.isApprox was given {other!r}; expected another {kind}.")
        return bool(small_kernel("excess")(self._v, other._v, prec) <= 0.0)

    def isZero(self, prec: float = 1e-12) -> bool:
        """Whether all entries are at most `prec`."""
        return bool(np.abs(self._v).max() <= prec)

    def se3Action(self, M: SE3) -> Self:
        """It, carried along by M."""
        return self._moved(M)

    def se3ActionInverse(self, M: SE3) -> Self:
        """It, carried along by the inverse of M."""
        return self._moved_back(M)

    def _moved(self, M: SE3) -> Self:
        return self._made["moved"](M._m, self._v)

    def _moved_back(self, M: SE3) -> Self:
        return self._made["moved back"](M._m, self._v)

    def _value(self) -> Any:
        return self._tower(self._v[:3], self._v[3:])

    @classmethod
    def _from(cls, value: Any) -> Self:
        return cls._of(np.concatenate([value.linear, value.angular]))

    def __add__(self, other: Self) -> Any:
        return self._made["sum"](self._v, other._v) if isinstance(other, type(self)) else NotImplemented

    def __sub__(self, other: Self) -> Any:
        return (
            self._made["difference"](self._v, other._v) if isinstance(other, type(self)) else NotImplemented
        )

    def __iadd__(self, other: Self) -> Self:
        self._v += other._v if type(other) is type(self) else _entries(other, type(self), "other", "+=")
        return self

    def __isub__(self, other: Self) -> Self:
        self._v -= other._v if type(other) is type(self) else _entries(other, type(self), "other", "-=")
        return self

    def __neg__(self) -> Self:
        return self._made["opposite"](self._v)

    def __mul__(self, factor: Any) -> Any:
        if type(factor) is float or type(factor) is int:
            return self._made["product"](self._v, float(factor))
        return self._of(self._v * factor) if is_number(factor) else NotImplemented

    __rmul__ = __mul__

    def __truediv__(self, divisor: Any) -> Any:
        return self._of(self._v / real(divisor, "divisor")) if np.ndim(divisor) == 0 else NotImplemented

    def __eq__(self, other: object) -> bool:
        return self._v.tolist() == other._v.tolist() if isinstance(other, type(self)) else NotImplemented

    __hash__ = object.__hash__

    def __str__(self) -> str:
        first, second = (name.rjust(3) for name in self._signs)
        return f"{first} = {text(self._v[:3])}\n{second} = {text(self._v[3:])}\n"

    __repr__ = __str__


@final
class Motion(_Six):
    """A spatial velocity or acceleration: linear part [m/s], angular part [rad/s]."""

    __slots__ = ()
    _tower = spatial.Motion

    @staticmethod
    def Random() -> Motion:
        """Entries drawn evenly from [-1, 1]."""
        return Motion._made["random"]()

    @reads_names("m", "f")
    def cross(self, other: Any = None, **named: Any) -> Any:
        """The cross product with a Motion, or with a Force.

        Args:
            other: A Motion or a Force.
            **named: The same by its name `m` or `f`.

        Returns:
            An object of the same class as `other`.

        Raises:
            ArgumentError: It is neither.
        """
        if other is None:
            other = the_one("Motion.cross", named, ("m", "f"))
        if not isinstance(other, (Motion, Force)):
            raise ArgumentError(f"Motion.cross was given {other!r}; expected a Motion or a Force.")
        return other._made["cross"](self._v, other._v)

    __xor__ = cross

    def dot(self, f: Any) -> float:
        """The power of a Force at this velocity [W]."""
        return float(self._v @ _entries(f, Force, "f"))

    @property
    def action(self) -> Floats:
        """The 6x6 matrix of the cross product with motions."""
        return small_kernel("motion matrix")(self._v)

    @property
    def dualAction(self) -> Floats:
        """The 6x6 matrix of the cross product with forces."""
        return small_kernel("motion dual")(self._v)

    @property
    def homogeneous(self) -> Floats:
        """The 4x4 matrix whose exponential is the displacement of one second."""
        return small_kernel("motion homogeneous")(self._v)


@final
class Force(_Six):
    """A spatial force: force [N], moment [N m]."""

    __slots__ = ()
    _signs = ("f", "tau")
    _tower = spatial.Force

    @staticmethod
    def Random() -> Force:
        """Entries drawn evenly from [-1, 1]."""
        return Force._made["random"]()

    def dot(self, m: Any) -> float:
        """The power at a velocity [W]."""
        return float(self._v @ _entries(m, Motion, "m"))


def _entries(value: Any, kind: type[Any], name: str, function: str = "dot") -> Floats:
    """The six numbers of a Motion or a Force.

    Raises:
        ArgumentError: It is neither, or the other one.
    """
    if not isinstance(value, kind):
        raise ArgumentError(
            f"{function}: `{name}` is {excerpt(repr(value))}; expected a pinocchio.{kind.__name__}, such as "
            f"{kind.__name__}(array)."
        )
    return value._v


_M, _V = (4, 4), (6,)
_SIX = BoundFunctions(
    {
        "parts": (lambda a, b: np.concatenate([a, b]), (3,), (3,)),
        "copy": (lambda v: 1.0 * v, _V),
        "skew": (numeric.skew, (3,)),
    },
    exact=True,
)


def _functions(kind: Any) -> dict[str, tuple[Any, ...]]:
    """What is computed of motions, or of forces."""

    def cross(v: Array, w: Array) -> Array:
        return spatial.Motion(v[:3], v[3:]).cross(kind(w[:3], w[3:])).vector()

    return {
        "random": Random(lambda even: 2.0 * even - 1.0, even=6),
        "moved": (lambda m, v: pose(m).act(kind(v[:3], v[3:])).vector(), _M, _V),
        "moved back": (lambda m, v: pose(m).act_inverse(kind(v[:3], v[3:])).vector(), _M, _V),
        **SIX_NUMBERS,
        "moved by": (lambda v, m: pose(m).act(kind(v[:3], v[3:])).vector(), _V, _M),
        "moved back by": (lambda v, m: pose(m).act_inverse(kind(v[:3], v[3:])).vector(), _V, _M),
        "cross": (cross, _V, _V),
    }


Motion._made = BoundFunctions(_functions(spatial.Motion), holder=Motion)
Force._made = BoundFunctions(_functions(spatial.Force), holder=Force)


@directly(_SIX.row("skew", np.ndarray))
def skew(u: Any) -> Floats:
    """The matrix of the cross product with a 3-vector."""
    result = without_gaps(_SIX["skew"], u)
    if result is not NotImplemented:
        return result
    x, y, z = vector(u, 3, "u")
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def unSkew(U: Any) -> Floats:
    """The 3-vector of a matrix of the cross product."""
    m = matrix(U, (3, 3), "U")
    return 0.5 * np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])


def skewSquare(u: Any, v: Any) -> Floats:
    """The matrix [u]x [v]x.

    Args:
        u: Vector (3,).
        v: Vector (3,), in any unit [-].

    Returns:
        Matrix (3, 3).
    """
    return skew(u) @ skew(v)


@directly(
    SMALL.row("classic acceleration", Motion, Motion),
    SMALL.row("classic acceleration at a placement", Motion, Motion, SE3),
)
def classicAcceleration(
    spatial_velocity: Motion, spatial_acceleration: Motion, placement: Any = None
) -> Floats:
    """The acceleration of the point at the origin of a frame.

    Args:
        spatial_velocity: Spatial velocity.
        spatial_acceleration: Spatial acceleration, in the same frame.
        placement: Pose of another frame, an SE3, whose origin and axes to take.

    Returns:
        Acceleration (3,) [m/s^2].
    """
    v, a = spatial_velocity, spatial_acceleration
    if placement is not None:
        v, a = placement.actInv(v), placement.actInv(a)
    return numbers(a.linear + np.cross(v.angular, v.linear), "acceleration")


def checked_forces(fext: Any, count: int) -> list[Floats]:
    """Forces on the joints, the universe included, each (6,).

    Args:
        fext: Forces, each a Force or (6,) [N, N m].
        count: Number of joints, the universe included.

    Returns:
        Forces (6,) each.

    Raises:
        ArgumentError: It is no list, or there are not as many as joints.
    """
    if not hasattr(fext, "__len__"):
        raise ArgumentError(
            f"`fext` is {fext!r}; expected {count} forces, one for each joint, the universe included."
        )
    if len(fext) != count:
        raise ArgumentError(
            f"`fext` holds {len(fext)} forces; expected {count}, one for each joint, the universe included."
        )
    return [f.vector if isinstance(f, Force) else vector(f, 6, "fext") for f in fext]


register(Motion, Force)
