"""SE3: a placement in one 4x4 array, with views of its rotation and translation."""

from __future__ import annotations

import numbers
from typing import Any, final

import numpy as np

from pinocchio._containers.arguments import CONVERSIONS, ArgumentError, SizeError
from pinocchio._containers.arrays import matrix, text, vector
from pinocchio._containers.attributes import one_of
from pinocchio._containers.files import register
from pinocchio._containers.keywords import by_name, reads_names, the_one
from pinocchio._spatial.bound_functions import BoundFunctions, directly, without_gaps
from pinocchio._spatial.random_numbers import Random
from pinocchio._spatial.rotations import (
    UNIT_TOLERANCE,
    Quaternion,
    check_unit,
    coefficients_of,
    quaternion_of,
)
from pinocchio._spatial.small_kernels import pose, random_pose, small_kernel
from ulna import spatial
from ulna.typing import Array, Floats


def _placed(x: Array) -> Array:
    return spatial.SE3(spatial.quat_xyzw_to_matrix(x[3:]), x[:3]).matrix()


def _placed_and_valid(x: Array) -> tuple[Array, Any]:
    """The placement of a position and a quaternion, and a number above zero where its length is close to 1."""
    off = x[3:] @ x[3:] - (1.0 + UNIT_TOLERANCE**2)
    return _placed(x), (2.0 * UNIT_TOLERANCE) ** 2 - off * off


def _quotient(a: Array, b: Array) -> Array:
    """The second placement in the first; places are subtracted before they are turned, so that no digits are lost."""
    back = a[:3, :3].T
    return spatial.SE3(back @ b[:3, :3], back @ (b[:3, 3] - a[:3, 3])).matrix()


_M, _V = (4, 4), (6,)
_FUNCTIONS: dict[str, tuple[Any, ...]] = {
    "product": (lambda a, b: (pose(a) @ pose(b)).matrix(), _M, _M),
    "quotient": (_quotient, _M, _M),
    "inverse": (lambda a: pose(a).inverse().matrix(), _M),
    "action": (lambda a: pose(a).adjoint(), _M),
    "action back": (lambda a: pose(a).inverse().adjoint(), _M),
    "dual action": (lambda a: pose(a).dual_adjoint(), _M),
    "Motion": (lambda a, v: pose(a).act(spatial.Motion(v[:3], v[3:])).vector(), _M, _V),
    "Motion back": (lambda a, v: pose(a).act_inverse(spatial.Motion(v[:3], v[3:])).vector(), _M, _V),
    "Force": (lambda a, f: pose(a).act(spatial.Force(f[:3], f[3:])).vector(), _M, _V),
    "Force back": (lambda a, f: pose(a).act_inverse(spatial.Force(f[:3], f[3:])).vector(), _M, _V),
    "placed": (_placed, (7,)),
}


MATRICES = BoundFunctions(_FUNCTIONS | {"itself": (lambda a: 1.0 * a, _M)})
"""What is computed of placements (4, 4), as arrays."""
se3_kernel = MATRICES.kernel
"""The compiled function of a name, of placements (4, 4)."""


_ITEMS = ("M", "motion", "force", "inertia", "point")
"""What a placement acts on, by the names of arguments."""


_EYE = np.eye(4)
_ROTATION, _TRANSLATION = np.s_[:3, :3], np.s_[:3, 3]  # slices that are made once
_FLOAT, _THREE = np.dtype(float), (3,)
_new = object.__new__


@final
class SE3:
    """A rigid displacement. `SE3()`, `SE3(R, p)`, `SE3(quaternion, p)`, `SE3(matrix 4x4)`, `SE3(other)`, `SE3(1)`."""

    __slots__ = ("_m",)

    @reads_names("rotation translation", "quat translation", "array", "clone", "int")
    def __init__(self, *parts: Any, **named: Any) -> None:
        if named:
            self._set(*parts, **named)
        elif len(parts) == 2:
            turn, place = parts
            placement = _ARRAY_FUNCTIONS["placement"](
                turn.matrix() if type(turn) is Quaternion else turn, place
            )
            if placement is NotImplemented:
                self._set(*parts)
            else:
                self._m = placement
        elif not parts:
            self._m = _EYE.copy()
        elif len(parts) == 1 and type(parts[0]) is SE3:
            self._m = parts[0]._m.copy()
        elif type(parts[0]) is np.ndarray and parts[0].shape == _M and parts[0].dtype is _FLOAT:
            self._m = parts[0].copy()
            self._m[3] = _EYE[3]
        else:
            self._set(*parts)

    @by_name("rotation translation", "quat translation", "array", "clone", "int")
    def _set(self, *parts: Any) -> None:
        """Sets a new instance to what it is made of."""
        if len(parts) == 2:
            placement = without_gaps(_ARRAY_FUNCTIONS["placement"], *parts)
            if placement is not NotImplemented:
                self._m = placement
                return
        self._m = _EYE.copy()
        if len(parts) == 2:
            turn = parts[0].matrix() if hasattr(parts[0], "matrix") else parts[0]
            self._m[:3, :3] = matrix(turn, (3, 3), "rotation")
            self._m[:3, 3] = vector(parts[1], 3, "translation")
        elif len(parts) == 1:
            one = parts[0]
            if isinstance(one, SE3):
                self._m[:] = one._m
            elif hasattr(one, "getRotation"):  # a transform of coal
                self._m[:3, :3], self._m[:3, 3] = one.getRotation(), one.getTranslation()
            elif isinstance(one, int):
                if abs(one) >= 2**31:
                    raise SizeError(
                        f"SE3 was given {one}; expected a whole number of 32 bits: SE3(1) is the identity."
                    )
            else:
                self._m[:3] = matrix(one, (4, 4), "homogeneous")[:3]
        elif parts:
            raise ArgumentError(
                f"SE3 was given {len(parts)} arguments; expected a rotation and a translation."
            )

    @classmethod
    def _of(cls, storage: Floats) -> SE3:
        self = _new(cls)
        self._m = storage
        return self

    def _assign(self, other: Any) -> None:
        if type(other) is SE3:
            self._m[:] = other._m
            return
        if isinstance(other, numbers.Number):  # SE3(1) is the identity
            raise ArgumentError(f"A placement was given {other!r}; expected an SE3.")
        self._m[:] = (other if isinstance(other, SE3) else SE3(other))._m

    def _pose(self) -> spatial.SE3:
        return pose(self._m)

    @staticmethod
    def Identity() -> SE3:
        """No displacement."""
        return SE3._of(_EYE.copy())

    @staticmethod
    def Random() -> SE3:
        """A rotation uniform on SO(3), a translation uniform in [-1, 1] m along each axis."""
        return PLACEMENTS["random"]()

    @staticmethod
    def Interpolate(A: SE3, B: SE3, alpha: float) -> SE3:
        """The placement at a part `alpha` of the screw that leads from A to B.

        Args:
            A, B: Placement.
            alpha: Fraction of the way, 0 at A and 1 at B [-].

        Returns:
            The placement.
        """
        return PLACEMENTS["interpolation"](A._m, B._m, float(alpha))

    @property
    def rotation(self) -> Floats:
        """The rotation matrix (3, 3), a view; assigning copies into it."""
        return self._m[_ROTATION]

    @rotation.setter
    def rotation(self, value: Any) -> None:
        self._m[_ROTATION] = matrix(value, (3, 3), "rotation")

    @property
    def translation(self) -> Floats:
        """The translation (3,) [m], a view; assigning copies into it."""
        return self._m[_TRANSLATION]

    @translation.setter
    def translation(self, value: Any) -> None:
        if type(value) is not np.ndarray or value.dtype is not _FLOAT or value.shape != _THREE:
            value = vector(value, 3, "translation")
        self._m[_TRANSLATION] = value

    @property
    def homogeneous(self) -> Floats:
        """The 4x4 matrix, a copy."""
        return self._m.copy()

    np = homogeneous

    def __array__(self, dtype: Any = None, copy: Any = None) -> Floats:
        return np.array(self._m, dtype=dtype, copy=copy is not False)

    @property
    def action(self) -> Floats:
        """The 6x6 matrix that transforms motions: the adjoint."""
        return se3_kernel("action")(self._m)

    @property
    def actionInverse(self) -> Floats:
        """The 6x6 matrix that transforms motions by the inverse displacement."""
        return se3_kernel("action back")(self._m)

    @property
    def dualAction(self) -> Floats:
        """The 6x6 matrix that transforms forces."""
        return se3_kernel("dual action")(self._m)

    def toActionMatrix(self) -> Floats:
        """See `action`."""
        return self.action

    def toActionMatrixInverse(self) -> Floats:
        """See `actionInverse`."""
        return self.actionInverse

    def toDualActionMatrix(self) -> Floats:
        """See `dualAction`."""
        return self.dualAction

    def inverse(self) -> SE3:
        """The inverse displacement."""
        return PLACEMENTS["inverse"](self._m)

    __invert__ = inverse

    @reads_names(*_ITEMS)
    def act(self, item: Any = None, **named: Any) -> Any:
        """Applies the displacement to an object.

        Args:
            item: SE3, Motion, Force, Inertia, or point (3,) [m].
            **named: The same by one of its names in Pinocchio.

        Returns:
            An object of the same kind.
        """
        if item is None or named:
            item = self._only("act", item, named)
        if isinstance(item, SE3):
            return PLACEMENTS["product"](self._m, item._m)
        if hasattr(item, "_moved"):
            return item._moved(self)
        if type(item) is np.ndarray and item.shape == (3,) and item.dtype == float:
            return small_kernel("pose point")(self._m, item)
        if hasattr(item, "getRotation"):
            return self.act(SE3(item))
        return self._m[:3, :3] @ vector(item, 3, "point") + self._m[:3, 3]

    @reads_names(*_ITEMS)
    def actInv(self, item: Any = None, **named: Any) -> Any:
        """Applies the inverse displacement to an object.

        Args:
            item: SE3, Motion, Force, Inertia, or point (3,) [m].
            **named: The same by one of its names in Pinocchio.

        Returns:
            An object of the same kind.
        """
        if item is None or named:
            item = self._only("actInv", item, named)
        if isinstance(item, SE3):
            return PLACEMENTS["quotient"](self._m, item._m)
        if hasattr(item, "_moved_back"):
            return item._moved_back(self)
        if hasattr(item, "getRotation"):
            return self.actInv(SE3(item))
        return self._m[:3, :3].T @ (vector(item, 3, "point") - self._m[:3, 3])

    def __mul__(self, item: Any) -> Any:
        if isinstance(item, SE3):
            return PLACEMENTS["product"](self._m, item._m)
        if isinstance(item, (np.ndarray, np.number)):
            if item.shape not in ((3,), (3, 1)):
                return NotImplemented  # NumPy takes the displacement for its matrix
            if item.dtype == float and type(item) is np.ndarray and item.shape == (3,):
                return small_kernel("pose point")(self._m, item)
        return self.act(item)

    __matmul__ = __mul__

    @staticmethod
    def _only(function: str, item: Any, named: dict[str, Any]) -> Any:
        """The argument by its name, where there is no other."""
        if item is not None:
            raise ArgumentError(
                f"SE3.{function} was given two arguments, one as {', '.join(named)}; expected one."
            )
        return the_one(f"SE3.{function}", named, _ITEMS)

    def isApprox(self, other: SE3, prec: float = 1e-12) -> bool:
        """Whether rotation and translation agree.

        Args:
            other: Another placement.
            prec: Largest difference, relative to the smaller norm [-].

        Returns:
            Whether they do.
        """
        return bool(small_kernel("pose excess")(self._m, other._m, prec) <= 0.0)

    def isIdentity(self, prec: float = 1e-12) -> bool:
        """Whether it is the identity, within `prec`."""
        return bool(np.abs(self._m - _EYE).max() <= prec)

    def setIdentity(self) -> None:
        """Makes it the identity."""
        self._m[:] = _EYE

    def setRandom(self) -> None:
        """Draws it anew; see `Random`."""
        self._m[:] = SE3.Random()._m

    def copy(self) -> SE3:
        """A copy."""
        out = _new(SE3)
        out._m = self._m.copy()
        return out

    __copy__ = cast = copy

    def __deepcopy__(self, memo: Any) -> SE3:
        return self.copy()

    def __reduce__(self) -> Any:
        return SE3, (self._m.copy(),)

    def __eq__(self, other: object) -> bool:
        return self._m.tolist() == other._m.tolist() if isinstance(other, SE3) else NotImplemented

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"SE3({self._m!r})".replace("\n", "").replace(" " * 7, "")

    def __str__(self) -> str:
        return f"  R =\n{text(self._m[:3, :3])}\n  p = {text(self._m[:3, 3])}\n"


PLACEMENTS = BoundFunctions(
    _FUNCTIONS
    | {
        "random": Random(random_pose, even=6),
        "interpolation": (lambda a, b, t: pose(a).interpolate(pose(b), t).matrix(), _M, _M, ()),
    },
    holder=SE3,
)
_XYZQUAT_FUNCTIONS = BoundFunctions({"placed": (_placed_and_valid, (7,))}, holder=SE3)
_ARRAY_FUNCTIONS = BoundFunctions(
    {
        "placement": (lambda R, p: spatial.SE3(R, p).matrix(), (3, 3), (3,)),
        "coefficients": (lambda m: np.concatenate([m[:3, 3], quaternion_of(m[:3, :3])]), _M),
    },
    exact=True,
)


@directly(_XYZQUAT_FUNCTIONS.row("placed", np.ndarray))
@by_name("array", "xyzquat", "tuple", "list")
def XYZQUATToSE3(xyzquat: Any) -> SE3:
    """The placement of a position and a quaternion xyzw in one array (7,), whose length is 1 to 1 %.

    As in Pinocchio, the quaternion is not scaled: of one that is not quite of unit length no exact rotation is made.
    """
    values = vector(xyzquat, 7, "xyzquat")
    check_unit(values[3:], "XYZQUATToSE3")
    return SE3._of(se3_kernel("placed")(values))


@directly(_ARRAY_FUNCTIONS.row("coefficients", SE3))
def SE3ToXYZQUAT(M: SE3) -> Floats:
    """Position and quaternion xyzw (7,) of a placement."""
    values = _ARRAY_FUNCTIONS["coefficients"](M._m)
    if values is NotImplemented:
        values = np.concatenate([M.translation, coefficients_of(M.rotation)])
    return values


def SE3ToXYZQUATtuple(M: SE3) -> tuple[float, ...]:
    """Position and quaternion xyzw of a placement, as a tuple of seven numbers."""
    return tuple(SE3ToXYZQUAT(M).tolist())


def as_placement(value: Any) -> Any:
    """The placement that a transform of coal is; all else as it is."""
    return (
        SE3(value) if hasattr(type(value), "getRotation") else value
    )  # of the type: a Data looks for near names


CONVERSIONS["SE3"] = as_placement


_placement_of = one_of(SE3)


class HasPlacement:
    """Mixin of classes with a placement on a joint."""

    __slots__ = ()
    _placement: SE3

    @property
    def placement(self) -> SE3:
        """Where it is in the frame of its joint, a live reference."""
        return self._placement

    @placement.setter
    def placement(self, M: SE3) -> None:
        if type(M) is SE3:
            self._placement._m[:] = M._m
            return
        _placement_of(self, "placement", as_placement(M))


register(SE3)
