"""Lie groups of configurations: R1, R2, R3, Rn, SO2, SO3, SE2, SE3, and their products."""

from __future__ import annotations

import functools
from typing import Any, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError, WrongShape, check_size, is_index
from pinocchio._containers.arrays import exact, not_applicable, numbers, vector
from pinocchio._containers.enums import ArgumentPosition
from pinocchio._model.joint_base import JointBase
from pinocchio._model.quaternion_signs import quaternion_starts, with_continuous_signs
from pinocchio._spatial.random_numbers import generator
from ulna.compiler import compile as compile_function
from ulna.errors import InputError, excerpt
from ulna.model import Circle, Composite, FreeFlyer, JointKind, PlanarCircle, Prismatic, Spherical
from ulna.typing import Floats

_calls: dict[tuple[str, str], tuple[Any, ...]] = {}
"""Bound kernels by the name of a group and of a function, one for each of its results."""
_asked: dict[tuple[str, str], int] = {}
_FIRST_CALLS = 10
"""How many calls for the first group compile nothing, of functions that take long to compile."""
_Block = tuple[str, tuple[JointKind, ...]]


@final
class LieGroup:
    """A Lie group, or with `*` a product of several."""

    def __init__(self, blocks: tuple[_Block, ...] = ()) -> None:
        if not all(isinstance(block, tuple) for block in blocks):
            raise ArgumentError(
                f"LieGroup was given {blocks!r}; expected nothing: pinocchio.liegroups.SE3() makes one."
            )
        self._blocks = blocks
        self._name, self._kind, self._nq, self._nv = _name_and_kind(blocks)

    _integrate = _difference = _squared_distance = _interpolate = (not_applicable,)
    _normalize = _tangent_map = (not_applicable,)
    _integrate_derivatives = _difference_derivatives = (not_applicable,) * 2

    @property
    def name(self) -> str:
        """Its name, such as "SE(3) x R^1"."""
        return self._name

    @property
    def nq(self) -> int:
        """How many numbers a point has."""
        return self._nq

    @property
    def nv(self) -> int:
        """How many numbers a tangent vector has."""
        return self._nv

    @property
    def neutral(self) -> Floats:
        """The neutral point (nq,)."""
        return np.zeros(0) if self._kind is None else np.array(self._kind.neutral())

    def integrate(self, q: Any, v: Any) -> Floats:
        """The point reached from q with v.

        Args:
            q: Point (nq,) [-].
            v: Tangent vector (nv,) [-].

        Returns:
            Point (nq,).
        """
        reached = self._integrate[0](q, v)
        return self._bound("integrate", q=q, v=v) if reached is NotImplemented else reached

    def difference(self, q0: Any, q1: Any) -> Floats:
        """The tangent vector that leads from q0 to q1.

        Args:
            q0, q1: Point (nq,).

        Returns:
            Tangent vector (nv,).
        """
        result = self._difference[0](q0, q1)
        return self._bound("difference", q0=q0, q1=q1) if result is NotImplemented else result

    def interpolate(self, q0: Any, q1: Any, u: float) -> Floats:
        """The point a part u of the way from q0 to q1.

        Args:
            q0, q1: Point (nq,).
            u: Fraction of the way, 0 at q0 and 1 at q1 [-].

        Returns:
            Point (nq,).
        """
        result = self._interpolate[0](q0, q1, float(u) if type(u) is int else u)
        return self._bound("interpolate", q0=q0, q1=q1, u=u) if result is NotImplemented else result

    def squaredDistance(self, q0: Any, q1: Any) -> float:
        """The squared length of the difference.

        Args:
            q0, q1: Point (nq,).

        Returns:
            The squared length [rad^2 or m^2].
        """
        result = self._squared_distance[0](q0, q1)
        return float(self._bound("squared_distance", q0=q0, q1=q1) if result is NotImplemented else result)

    def distance(self, q0: Any, q1: Any) -> float:
        """The length of the difference.

        Args:
            q0, q1: Point (nq,).

        Returns:
            The length [rad or m].
        """
        return float(np.sqrt(self.squaredDistance(q0, q1)))

    def normalize(self, q: Any) -> None:
        """Scales entries that together have unit length, such as a quaternion, to it; in place, as in C++.

        Args:
            q: Array (nq,) of floats, which is changed.

        Raises:
            ArgumentError: It cannot be changed in place: it is a list, read-only, or of other numbers.
        """
        unit = self._normalize[0](q)
        if unit is NotImplemented:
            unit = self._bound("normalize", q=q)
        elif q.flags.writeable:
            q[:] = unit
            return
        if not isinstance(q, np.ndarray) or q.dtype != float or not q.flags.writeable:
            raise ArgumentError(
                f"`q` is {excerpt(repr(q))}; expected an array of floats that can be changed in place: "
                "np.array(q, float)."
            )
        q.reshape(-1)[...] = unit

    def random(self) -> Floats:
        """Any point."""
        return self._nonempty_kind.random(generator())

    def randomConfiguration(self, lower: Any, upper: Any) -> Floats:
        """A point within limits (nq,).

        Args:
            lower: Least values (nq,).
            upper: Greatest values (nq,).

        Returns:
            Point (nq,).
        """
        return self._nonempty_kind.random(
            generator(), vector(lower, self.nq, "lower"), vector(upper, self.nq, "upper")
        )

    def dIntegrate(self, q: Any, v: Any, argument_position: ArgumentPosition) -> Floats:
        """The derivative (nv, nv) of `integrate` by q (ARG0) or v (ARG1).

        Args:
            q: Point (nq,) [-].
            v: Tangent vector (nv,) [-].
            argument_position: ARG0 or ARG1.

        Returns:
            Matrix (nv, nv).
        """
        which = first_or_second(argument_position)
        result = self._integrate_derivatives[which](q, v)
        return self._bound("integrate_derivatives", which, q=q, v=v) if result is NotImplemented else result

    def dIntegrate_dq(self, q: Any, v: Any, *factor: Any) -> Floats:
        """The derivative (nv, nv) of `integrate` by q, or its product with a matrix.

        Args:
            q: Point (nq,) [-].
            v: Tangent vector (nv,) [-].
            *factor: Nothing; J (n, nv) and 0 for J times the derivative; 0 and J (nv, n) for the derivative times J.

        Returns:
            The derivative (nv, nv), or the product.
        """
        return _product(self.dIntegrate(q, v, ArgumentPosition.ARG0), factor)

    def dIntegrate_dv(self, q: Any, v: Any, *factor: Any) -> Floats:
        """The derivative (nv, nv) of `integrate` by v, or its product with a matrix.

        Args:
            q: Point (nq,) [-].
            v: Tangent vector (nv,) [-].
            *factor: Nothing; J (n, nv) and 0 for J times the derivative; 0 and J (nv, n) for the derivative times J.

        Returns:
            The derivative (nv, nv), or the product.
        """
        return _product(self.dIntegrate(q, v, ArgumentPosition.ARG1), factor)

    def dIntegrateTransport(self, q: Any, v: Any, J: Any, argument_position: ArgumentPosition) -> Floats:
        """A matrix at integrate(q, v), transported by the derivative of `integrate`.

        Args:
            q: Point (nq,) [-].
            v: Tangent vector (nv,) [-].
            J: Matrix (nv, n).
            argument_position: ARG0 or ARG1.

        Returns:
            Matrix (nv, n).
        """
        return self.dIntegrate(q, v, argument_position) @ numbers(J, "J")

    def dDifference(self, q0: Any, q1: Any, argument_position: ArgumentPosition, *factor: Any) -> Floats:
        """The derivative (nv, nv) of `difference` by q0 (ARG0) or q1 (ARG1), or its product with a matrix.

        Args:
            q0: Point (nq,) [-].
            q1: Point (nq,) [-].
            argument_position: ARG0 or ARG1.
            *factor: Nothing, or J and 0, or 0 and J; see `dIntegrate_dq`.

        Returns:
            The derivative (nv, nv), or the product.
        """
        which = first_or_second(argument_position)
        result = self._difference_derivatives[which](q0, q1)
        if result is NotImplemented:
            result = self._bound("difference_derivatives", which, q0=q0, q1=q1)
        return _product(result, factor)

    def tangentMap(self, q: Any) -> Floats:
        """The matrix (nq, nv) from tangent vectors at q to changes of its entries."""
        result = self._tangent_map[0](q)
        return self._bound("tangent_map", q=q) if result is NotImplemented else result

    def tangentMapProduct(self, q: Any, mat_in: Any) -> Floats:
        """`tangentMap` times a matrix (nv, n).

        Args:
            q: Point (nq,) [-].
            mat_in: Matrix (nv, n).

        Returns:
            Matrix (nq, n).
        """
        return self.tangentMap(q).dot(numbers(mat_in, "mat_in"))

    def tangentMapTransposeProduct(self, q: Any, mat_in: Any) -> Floats:
        """`tangentMap` transposed times a matrix (nq, n).

        Args:
            q: Point (nq,) [-].
            mat_in: Matrix (nq, n).

        Returns:
            Matrix (nv, n).
        """
        return self.tangentMap(q).T.dot(numbers(mat_in, "mat_in"))

    def _bound(self, name: str, which: int = 0, **points: Any) -> Any:
        """Calls the kind's function of that name for its result `which`, and binds its kernels where none were bound.

        Args:
            name: The name.
            which: The number of the result.
            **points: Its arguments by their names.

        Returns:
            The result.
        """
        kind = self._nonempty_kind
        sizes = {key: 0 if key == "u" else self.nv if key == "v" else self.nq for key in points}
        arrays = [x if key == "u" else exact(x, sizes[key], key) for key, x in points.items()]
        key, function = (self._name, name), _function(kind, name)
        if key not in _calls:
            asked = _asked[key] = _asked.get(key, 0) + 1
            if name not in _COMPILED_AT_ONCE and asked <= _FIRST_CALLS:
                return _result(function(*arrays), which)
            shapes: dict[str, Any] = {key: () if key == "u" else (size,) for key, size in sizes.items()}
            _calls[key] = _bound_to_each_result(compile_function(function, **shapes))
        setattr(self, f"_{name}", _calls[key])
        result = _calls[key][which](*arrays)
        return _result(function(*arrays), which) if result is NotImplemented else result

    def __reduce__(self) -> Any:
        return LieGroup, (self._blocks,)

    @property
    def _nonempty_kind(self) -> JointKind:
        if self._kind is None:
            raise InputError("This Lie group is empty; make one with pinocchio.liegroups.SE3() and the like.")
        return self._kind

    def __mul__(self, other: LieGroup) -> LieGroup:
        if not isinstance(other, LieGroup):
            return NotImplemented
        return LieGroup((*self._blocks, *other._blocks))

    def __eq__(self, other: object) -> bool:
        return self._blocks == other._blocks if isinstance(other, LieGroup) else NotImplemented

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"<LieGroup {self.name}>"


@functools.lru_cache(maxsize=256)
def _name_and_kind(blocks: tuple[_Block, ...]) -> tuple[str, JointKind | None, int, int]:
    """The name of a group, the kind of joint that it is the group of (None for none), and its nq and nv."""
    kinds = tuple(kind for _, part in blocks for kind in part)
    kind = None if not kinds else kinds[0] if len(kinds) == 1 else Composite(kinds)
    nq, nv = (0, 0) if kind is None else (kind.nq, kind.nv)
    return " x ".join(name for name, _ in blocks), kind, nq, nv


_COMPILED_AT_ONCE = ("integrate", "difference", "squared_distance")


def _function(kind: JointKind, name: str) -> Any:
    """The function of a kind of joint by its name in `LieGroup._bound`."""
    if name == "tangent_map":
        units = np.eye(kind.nv)
        return lambda q: np.stack([kind.coordinate_rates(q, unit) for unit in units], axis=1)
    function: Any = getattr(kind, name)
    starts = quaternion_starts([(0, kind)]) if name == "integrate" else ()
    return with_continuous_signs(function, starts) if starts else function


def _result(results: Any, which: int) -> Floats:
    """One of the results of a function."""
    return np.array(results[which] if isinstance(results, tuple) else results)


def _bound_to_each_result(kernel: Any) -> tuple[Any, ...]:
    """For each result of a kernel, the kernel bound to return it."""
    shapes = [output.shape for output in kernel.function.outputs]
    return tuple(
        kernel.into(*map(np.zeros, shapes), returns=(k,), otherwise=not_applicable)
        for k in range(len(shapes))
    )


def first_or_second(position: Any) -> int:
    """The place of the argument that a derivative is by.

    Args:
        position: ARG0 or ARG1; numbers are none of them.

    Returns:
        0 or 1.

    Raises:
        ArgumentError: It is something else.
    """
    if not isinstance(position, ArgumentPosition) or position == ArgumentPosition.ARG2:
        raise ArgumentError(f"The argument is {position!r}; expected ARG0 or ARG1.")
    return int(position)


def Rn(n: int) -> LieGroup:
    """Vectors of n numbers."""
    n = check_size(n, "n")
    return LieGroup(((f"R^{n}", (Prismatic(),) * n),))


def R1() -> LieGroup:
    """Numbers."""
    return Rn(1)


def R2() -> LieGroup:
    """Vectors in the plane."""
    return Rn(2)


def R3() -> LieGroup:
    """Vectors in space."""
    return Rn(3)


def SO2() -> LieGroup:
    """Rotations in the plane, as (cos, sin)."""
    return LieGroup((("SO(2)", (Circle(),)),))


def SO3() -> LieGroup:
    """Rotations in space, as quaternions xyzw."""
    return LieGroup((("SO(3)", (Spherical(),)),))


def SE2() -> LieGroup:
    """Displacements in the plane, as (x, y, cos, sin)."""
    return LieGroup((("SE(2)", (PlanarCircle(),)),))


def SE3() -> LieGroup:
    """Displacements in space, as position and quaternion xyzw."""
    return LieGroup((("SE(3)", (FreeFlyer(),)),))


def of_joint(joint: JointBase) -> LieGroup:
    """The group of a joint's configurations."""
    return LieGroup(blocks_of(joint))


def blocks_of(joint: JointBase) -> tuple[_Block, ...]:
    """What the group of a joint's configurations is the product of."""
    return () if joint.kind is None or joint.nv == 0 else _blocks_of_kind(joint.kind, joint.nv)


@functools.lru_cache(maxsize=256)
def _blocks_of_kind(kind: JointKind, nv: int) -> tuple[_Block, ...]:
    groups: dict[type, Any] = {Circle: SO2, Spherical: SO3, PlanarCircle: SE2, FreeFlyer: SE3}
    kinds = kind.kinds if isinstance(kind, Composite) else (kind,)
    if all(type(part) not in groups for part in kinds):
        return Rn(nv)._blocks
    parts = [groups[type(part)]() if type(part) in groups else Rn(part.nv) for part in kinds]
    return tuple(block for part in parts for block in part._blocks)


def _product(derivative: Floats, factor: tuple[Any, ...]) -> Floats:
    """The derivative, J times it for (J, 0), or it times J for (0, J).

    Raises:
        ArgumentError: The factor is given in another way.
        WrongShape: The sizes do not fit.
    """
    if not factor:
        return derivative
    first = len(factor) == 2 and not is_index(factor[0]) and is_index(factor[1])
    last = len(factor) == 2 and is_index(factor[0]) and not is_index(factor[1])
    if not (first or last):
        raise ArgumentError(f"The factor is given as {factor}; expected (J, 0) or (0, J), J being a matrix.")
    J, size = numbers(factor[0] if first else factor[1], "J"), len(derivative)
    if J.ndim != 2 or J.shape[1 if first else 0] != size:
        raise WrongShape("J", J.shape, f"(n, {size})" if first else f"({size}, n)")
    return J @ derivative if first else derivative @ J
