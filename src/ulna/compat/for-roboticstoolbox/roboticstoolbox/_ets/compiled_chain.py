"""A chain of transforms with its compiled kernels, which compute the kinematics of sequences and robots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from roboticstoolbox._common.documentation import describe_arguments
from roboticstoolbox._common.errors import UnknownOption, WrongShape, WrongType
from roboticstoolbox._common.numbers import numbers
from roboticstoolbox._common.symbols import has_symbols
from roboticstoolbox._ets.base_transform import BaseET
from roboticstoolbox._ets.jacobian_array import Jacobian
from roboticstoolbox._ets.measures import axes_of, measure_name, measure_of
from roboticstoolbox._ets.symbolic_chain import symbolic_jacobian, symbolic_pose, to_axes_of_end
from ulna import algorithms
from ulna.algorithms.kinematics.manipulability import chosen_rows
from ulna.errors import InputError
from ulna.formats.ets import ETS as Transforms
from ulna.robot import Robot
from ulna.system.cached import cached_property
from ulna.typing import Floats

ANGLES = ("rpy/xyz", "rpy/zyx", "eul", "exp")


@describe_arguments
class Chain:
    """The transforms from one frame to another; configurations are those of the robot it belongs to.

    Columns of Jacobians stand in the order of the joints along the chain.
    """

    def __init__(self, transforms: Sequence[BaseET]) -> None:
        """`transforms` are copied: later changes to them have no effect."""
        self.transforms = tuple(et._copy() for et in transforms)
        self.jindices = np.array([et.jindex for et in self.transforms if et.isjoint], dtype=int)
        self.n = len(self.jindices)
        self.is_symbolic = any(et._is_symbolic for et in self.transforms)
        self._in_order = bool((self.jindices == np.arange(self.n)).all())
        self._shape = (self.n,)
        self._tools: dict[bytes, Chain] = {}

    @cached_property
    def arm(self) -> Robot:
        """The robot that Ulna computes with: the chain alone, its end the tool."""
        count = iter(range(self.n))
        if self.is_symbolic:
            raise WrongType("The chain holds symbols; only poses and Jacobians are computed with them.")
        parts = [et._parts_in_ulna(next(count) if et.isjoint else None) for et in self.transforms]
        return Robot(Transforms(tuple(one for part in parts for one in part)).model("chain"))

    @cached_property
    def unlimited(self) -> Chain:
        """The same chain without joint limits."""
        free = [et._copy() for et in self.transforms]
        for et in free:
            et.qlim = None
        return Chain(free)

    def with_tool(self, T: Floats) -> Chain:
        """The chain that ends in a tool at `T`."""
        if T.dtype == object:  # of symbols, whose bytes are addresses
            return Chain([*self.transforms, BaseET("SE3", T=T)])
        key = T.tobytes()
        chain = self._tools.get(key)
        if chain is None:  # other threads may add and remove chains meanwhile
            if len(self._tools) > 32:
                self._tools.clear()
            chain = self._tools.setdefault(key, Chain([*self.transforms, BaseET("SE3", T=T)]))
        return chain

    def q(self, q: Any) -> Floats:
        """The joint coordinates along the chain, from those of the robot or of the chain."""
        if self._in_order and type(q) is np.ndarray and q.shape == self._shape:
            return q
        coordinates = numbers("q", q)
        if coordinates.ndim == 2 and 1 in coordinates.shape:  # one configuration, as a row or a column
            coordinates = (
                coordinates.ravel()
                if coordinates.shape[0] == 1 or coordinates.size == self.n != 1
                else coordinates
            )
        size = coordinates.shape[-1] if coordinates.ndim else 1
        if coordinates.ndim in (0, 1) and self.n == 1 and size == 1:
            return coordinates.reshape(1)
        if self.n and size > self.jindices.max():
            return coordinates if self._in_order and size == self.n else coordinates[..., self.jindices]
        if size != self.n:
            raise WrongShape("q", coordinates.shape, f"({max([self.n, *(self.jindices + 1)])},) or (m, n)")
        return coordinates

    def fk(self, q: Any) -> Floats:
        """The pose of the end in the start, (..., 4, 4)."""
        if self.n == 0:
            rows = (len(q),) if np.ndim(q) > 1 and len(q) > 1 else ()
            return np.broadcast_to(self._constant, (*rows, 4, 4)).copy()
        try:
            return self._fk(self.q(q))
        except (TypeError, InputError) as error:
            return self._symbolic(symbolic_pose, q, error)

    @cached_property
    def _fk(self) -> Any:
        return self.arm.kernel("fk", checked=True)

    @cached_property
    def _constant(self) -> Floats:
        return symbolic_pose(self.transforms, ())

    def jacob0(self, q: Any) -> Floats:
        """The Jacobian in the axes of the start, (..., 6, n)."""
        if self.n == 0:
            return np.zeros((6, 0))
        try:
            return self._jacob0(self.q(q)).view(Jacobian)
        except (TypeError, InputError) as error:
            return self._symbolic(symbolic_jacobian, q, error)

    def jacobe(self, q: Any) -> Floats:
        """The Jacobian in the axes of the end, (..., 6, n)."""
        if self.n == 0:
            return np.zeros((6, 0))
        try:
            return self._jacobe(self.q(q)).view(Jacobian)
        except (TypeError, InputError) as error:
            return to_axes_of_end(
                self._symbolic(symbolic_jacobian, q, error), self._symbolic(symbolic_pose, q, error)
            )

    def _symbolic(self, compute: Any, q: Any, error: Exception) -> Floats:
        """A product of matrices that hold symbols; raises `error` where neither the chain nor `q` does."""
        coordinates = np.asarray(q, dtype=object)
        if not (self.is_symbolic or has_symbols(coordinates)):
            raise error
        if coordinates.ndim <= 1:
            return compute(self.transforms, self._along(np.atleast_1d(coordinates)))
        rows = [compute(self.transforms, self._along(row)) for row in coordinates]
        return np.array(rows) if len(rows) > 1 else rows[0]

    def _along(self, q: Any) -> Any:
        if self.n and q.size > self.jindices.max():
            return q[self.jindices]
        if q.shape != self._shape:
            raise WrongShape(
                "q",
                q.shape,
                f"({max([self.n, *(self.jindices + 1)])},) or (m, n); symbols for one configuration, or for each of m",
            )
        return q

    @cached_property
    def _jacob0(self) -> Any:
        return self.arm.kernel("jacobian", checked=True, reference="local_world_aligned")

    @cached_property
    def _jacobe(self) -> Any:
        return self.arm.kernel("jacobian", checked=True, reference="local")

    def hessian0(self, q: Any, J0: Any = None) -> Floats:
        """The Hessian in the axes of the start, of the Jacobian `J0` if it is passed.

        Returns:
            Hessian (..., n, 6, n).
        """
        if self.n == 0:
            return np.zeros((0, 6, 0))
        return self.arm.derivatives.jacobian(self.q(q)) if J0 is None else hessian_of(J0, self.n)

    def hessiane(self, q: Any, Je: Any = None) -> Floats:
        """`hessian0` turned into the axes of the end, (..., n, 6, n); it is not the derivative of `jacobe`.

        Returns:
            Hessian (..., n, 6, n).
        """
        if Je is not None:
            return hessian_of(Je, self.n)
        H, R = self.hessian0(q), self.fk(q)[..., None, :3, :3]
        turned = np.swapaxes(R, -1, -2)
        return np.concatenate([turned @ H[..., :3, :], turned @ H[..., 3:, :]], axis=-2)

    def partial(self, q: Any, order: int) -> Floats:
        """A derivative of the pose in the axes of the start: 1 the Jacobian, 2 the Hessian, and so on.

        Args:
            order: Order of the derivative.

        Returns:
            Array (n, ..., n, 6, n), or (m, n, ..., n, 6, n).
        """
        from ulna.algorithms import jacobian_partials

        J = np.asarray(self.jacob0(q))
        if J.ndim == 2:
            return jacobian_partials(J, order)
        return np.array([jacobian_partials(one, order) for one in J])

    def jacob0_dot(self, q: Any, qd: Any) -> Floats:
        """The time derivative of the Jacobian in the axes of the start.

        Args:
            qd: Velocities (n,) or (m, n) [rad/s or m/s].

        Returns:
            Derivative (..., 6, n) [1/s].
        """
        return self.arm.jacobian_dot(self.q(q), self.q(qd))

    def analytical(self, q: Any, representation: Any) -> Floats:
        """The Jacobian of position and angles.

        Args:
            representation: "rpy/xyz", "rpy/zyx", "eul" or "exp".

        Returns:
            Jacobian (..., 6, n).
        """
        known_angles(representation)
        if self.n == 0:
            return np.zeros((6, 0))
        return self.arm.analytical_jacobian(self.q(q), representation).view(Jacobian)

    def manipulability(self, q: Any, method: str, axes: Any) -> Any:
        """A measure of the distance from singularities.

        Args:
            method: "yoshikawa", "asada", "minsingular" or "invcondition".
            axes: "all", "trans", "rot", "both" for a pair of measures, or six truth values.

        Returns:
            The measure (...); a pair of them for "both".
        """
        if isinstance(axes, str) and axes == "both":
            return tuple(self.manipulability(q, method, part) for part in ("trans", "rot"))
        measure, rows = measure_name(method), axes_of(axes)
        if measure != "yoshikawa" and self.n < len(chosen_rows(rows)):
            return measure_of(np.asarray(self.jacob0(q)), measure, rows)
        return np.asarray(self.arm.manipulability(self.q(q), measure, rows))[()]

    def jacobm(self, q: Any, axes: Any) -> Floats:
        """The gradient of manipulability.

        Returns:
            Gradient (n, 1).
        """
        return self.arm.derivatives.manipulability(self.q(q), axes_of(axes))[..., None]

    def jacobm_of(self, J: Any, H: Any, axes: Any) -> Floats:
        """The gradient of manipulability of a Jacobian and its Hessian.

        Args:
            J: Jacobian (6, n).
            H: Hessian (n, 6, n); None for that of `J`.

        Returns:
            Gradient (n, 1).

        Raises:
            ShapeError: `J` or `H` has another shape.
            WrongShape: `J` or `H` has another shape.
        """
        matrix = jacobian_matrix(J, self.n)
        hessian = hessian_of(matrix, self.n) if H is None else np.asarray(H, dtype=float)
        if hessian.shape != (self.n, 6, self.n):
            raise WrongShape("H", hessian.shape, f"({self.n}, 6, {self.n}), as hessian0 returns it")
        chosen = axes_of(axes)
        rows = chosen_rows(chosen)
        part, change = matrix[rows], hessian[:, rows]
        value = measure_of(matrix, "yoshikawa", chosen)
        inverse = np.linalg.inv(part @ part.T)
        return value * np.einsum("ij,kjl,il->k", inverse, change, part)[:, None]


def jacobian_matrix(J: Any, n: int) -> Floats:
    """A Jacobian that was passed, checked.

    Args:
        J: The Jacobian.
        n: Number of joints.

    Returns:
        Jacobian (6, n).

    Raises:
        TypeError: It is no array.
        WrongShape: It has another shape.
        WrongType: It is no array.
    """
    if not isinstance(J, np.ndarray):
        raise WrongType(f"A Jacobian is {type(J).__name__}; expected a NumPy array (6, {n}).")
    if J.shape != (6, n):
        raise WrongShape("J", J.shape, f"(6, {n})")
    return np.asarray(J, dtype=float)


def hessian_of(J: Any, n: int) -> Floats:
    """The Hessian of a Jacobian, which determines it.

    Args:
        J: Jacobian (6, n).
        n: Number of joints.

    Returns:
        Hessian (n, 6, n) in the axes of the Jacobian.
    """
    return algorithms.jacobian_partials(jacobian_matrix(J, n), 2)


def known_angles(representation: str) -> None:
    """Raises UnknownOption where there are no angles of that name."""
    if representation not in ANGLES:
        raise UnknownOption("representation", representation, ANGLES)
