"""Lie groups of configurations: R1, R2, R3, Rn, SO2, SO3, SE2, SE3, and their products."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError, WrongShape, check_size, is_index
from pinocchio._containers.arrays import exact, not_applicable, numbers, vector
from pinocchio._containers.enums import ArgumentPosition
from pinocchio._model.bound_kernels import BoundKernel
from pinocchio._model.joint_base import JointBase
from pinocchio._model.quaternion_signs import quaternion_starts, with_continuous_signs
from pinocchio._spatial.random_numbers import generator
from ulna.compiler import compile as compile_function
from ulna.errors import InputError, excerpt
from ulna.model import Circle, Composite, FreeFlyer, JointKind, PlanarCircle, Prismatic, Spherical
from ulna.typing import Floats

_kernels: dict[tuple[str, str], Any] = {}
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
        self._name = " x ".join(name for name, _ in blocks)
        self._integrate = self._difference = self._squared_distance = not_applicable
        kinds = tuple(kind for _, part in blocks for kind in part)
        self._kind: JointKind | None = None
        if kinds:
            self._kind = kinds[0] if len(kinds) == 1 else Composite(kinds)

    @property
    def name(self) -> str:
        """Its name, such as "SE(3) x R^1"."""
        return self._name

    @property
    def nq(self) -> int:
        """How many numbers a point has."""
        return 0 if self._kind is None else self._kind.nq

    @property
    def nv(self) -> int:
        """How many numbers a tangent vector has."""
        return 0 if self._kind is None else self._kind.nv

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
        reached = self._integrate(q, v)
        return self._bound("integrate", q=q, v=v) if reached is NotImplemented else reached

    def difference(self, q0: Any, q1: Any) -> Floats:
        """The tangent vector that leads from q0 to q1.

        Args:
            q0, q1: Point (nq,).

        Returns:
            Tangent vector (nv,).
        """
        result = self._difference(q0, q1)
        return self._bound("difference", q0=q0, q1=q1) if result is NotImplemented else result

    def interpolate(self, q0: Any, q1: Any, u: float) -> Floats:
        """The point a part u of the way from q0 to q1.

        Args:
            q0, q1: Point (nq,).
            u: Fraction of the way, 0 at q0 and 1 at q1 [-].

        Returns:
            Point (nq,).
        """
        return np.array(
            self._nonempty_kind.interpolate(vector(q0, self.nq, "q0"), vector(q1, self.nq, "q1"), u)
        )

    def squaredDistance(self, q0: Any, q1: Any) -> float:
        """The squared length of the difference.

        Args:
            q0, q1: Point (nq,).

        Returns:
            The squared length [rad^2 or m^2].
        """
        result = self._squared_distance(q0, q1)
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
        unit = self._nonempty_kind.normalize(vector(q, self.nq, "q"))
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
        both = self._nonempty_kind.integrate_derivatives(vector(q, self.nq, "q"), vector(v, self.nv, "v"))
        return np.array(both[first_or_second(argument_position)])

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
        both = self._nonempty_kind.difference_derivatives(
            vector(q0, self.nq, "q0"), vector(q1, self.nq, "q1")
        )
        return _product(np.array(both[first_or_second(argument_position)]), factor)

    def tangentMap(self, q: Any) -> Floats:
        """The matrix (nq, nv) from tangent vectors at q to changes of its entries."""
        at = vector(q, self.nq, "q")
        return np.stack([self._nonempty_kind.coordinate_rates(at, unit) for unit in np.eye(self.nv)], axis=1)

    def tangentMapProduct(self, q: Any, mat_in: Any) -> Floats:
        """`tangentMap` times a matrix (nv, n).

        Args:
            q: Point (nq,) [-].
            mat_in: Matrix (nv, n).

        Returns:
            Matrix (nq, n).
        """
        return self.tangentMap(q) @ numbers(mat_in, "mat_in")

    def tangentMapTransposeProduct(self, q: Any, mat_in: Any) -> Floats:
        """`tangentMap` transposed times a matrix (nq, n).

        Args:
            q: Point (nq,) [-].
            mat_in: Matrix (nq, n).

        Returns:
            Matrix (nv, n).
        """
        return self.tangentMap(q).T @ numbers(mat_in, "mat_in")

    def _bound(self, name: str, **points: Any) -> Any:
        """Calls the kind's function of that name, and binds its kernel where none was bound."""
        sizes = {key: self.nv if key == "v" else self.nq for key in points}
        arrays = [exact(x, sizes[key], key) for key, x in points.items()]
        key = self._name, name
        if key not in _kernels:
            shapes: dict[str, Any] = {key: (size,) for key, size in sizes.items()}
            function, starts = (
                getattr(self._nonempty_kind, name),
                quaternion_starts([(0, self._nonempty_kind)]),
            )
            if name == "integrate" and starts:
                function = with_continuous_signs(function, starts)
            _kernels[key] = BoundKernel(compile_function(function, **shapes)).call
        setattr(self, f"_{name}", _kernels[key])
        return _kernels[key](*arrays)

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
    if joint.kind is None or joint.nv == 0:
        return LieGroup()
    groups: dict[type, Any] = {Circle: SO2, Spherical: SO3, PlanarCircle: SE2, FreeFlyer: SE3}
    kinds = joint.kind.kinds if isinstance(joint.kind, Composite) else (joint.kind,)
    if all(type(kind) not in groups for kind in kinds):
        return Rn(joint.nv)
    out = LieGroup()
    for kind in kinds:
        out = out * (groups[type(kind)]() if type(kind) in groups else Rn(kind.nv))
    return out


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
