"""The base of all kinds of joints: pose, motion subspace, and geometry of the coordinates.

| symbol | meaning | shape | unit |
|---|---|---|---|
| q | joint position, a point of the joint's Lie group | (..., nq) | [rad], [m], unit quaternion |
| v | joint velocity, in the group's tangent space at q | (..., nv) | [rad/s], [m/s] |
| S | motion subspace: the moving frame's twist is S v | nv Motions | [1], [m/rad] |
| c | bias: (dS/dt) v | Motion | [m/s^2], [rad/s^2] |

Twists are of the moving frame relative to the fixed frame, written in the moving frame, linear part first
(Featherstone, Rigid Body Dynamics Algorithms, 2008, section 4.4). Tangent vectors are taken on the right:
`integrate(q, v) = q exp(v)`, as in Sola, Deray and Atchuthan, A micro Lie theory (2018).
"""

from __future__ import annotations

import abc
import math
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ulna.errors import InputError
from ulna.numeric import is_symbolic
from ulna.spatial import SE3, Motion, quat_normalize
from ulna.spatial.batched import column
from ulna.typing import Array, Floats


class Coordinate(NamedTuple):
    """One entry of q or v: its short name, its unit, and the range to draw from where there is no limit."""

    name: str
    unit: str
    low: float = -1.0
    high: float = 1.0


class ElementaryJoint(NamedTuple):
    """A joint with a constant motion subspace that a kind is made of."""

    placement: SE3
    """Pose of its fixed frame in the moving frame of the elementary joint before."""
    kind: JointKind
    """A kind with a constant motion subspace."""
    start_q: int
    """Where its position begins in the kind's position."""
    start_v: int
    """Where its velocity begins in the kind's velocity."""
    ratio: float
    """Its position as a multiple of that entry."""


def angle(name: str = "") -> Coordinate:
    """A coordinate that is an angle."""
    return Coordinate(name, "rad", -math.pi, math.pi)


def length(name: str = "") -> Coordinate:
    """A coordinate that is a length."""
    return Coordinate(name, "m")


def quaternion() -> tuple[Coordinate, ...]:
    """The four coordinates of a unit quaternion; they have no unit and are never drawn one by one."""
    return tuple(Coordinate(name, "") for name in ("qx", "qy", "qz", "qw"))


class JointKind(abc.ABC):
    """A kind of joint with its constants (axis, pitch ...), the same for every joint of that make.

    Kinds are frozen values. Each method takes leading batch axes, traced scalars, or symbols.
    """

    name: ClassVar[str]
    """What the kind is called in tables, for example ``"revolute"``."""

    @property
    @abc.abstractmethod
    def symbol(self) -> str:
        """The letter of the kind in mechanism theory, for example ``"R"``; several for a composite."""

    @property
    @abc.abstractmethod
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The entries of q."""

    @property
    @abc.abstractmethod
    def rates(self) -> tuple[Coordinate, ...]:
        """The entries of v; their units are per second."""

    @property
    def nq(self) -> int:
        """Number of entries of q."""
        return len(self.coordinates)

    @property
    def nv(self) -> int:
        """Number of entries of v."""
        return len(self.rates)

    @property
    def has_quaternion(self) -> bool:
        """Whether some entries of q are a unit quaternion."""
        return any(c.unit == "" for c in self.coordinates)

    @property
    def is_vector(self) -> bool:
        """Whether q is a plain vector, whose sums and differences are what they look like."""
        return False

    @abc.abstractmethod
    def describe(self) -> str:
        """A short label for tables, such as ``"revolute z"``."""

    # the mechanism -----------------------------------------------------------------------------------------

    @abc.abstractmethod
    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: the pose of the moving frame in the fixed frame.

        Args:
            q: Joint position, shape (..., nq). Quaternions are taken to be of unit length.
        """

    @abc.abstractmethod
    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The nv columns of S, in the moving frame; constants have no batch axes."""

    def bias(self, q: Array, v: Array) -> Motion:
        """The velocity-dependent part of the joint's acceleration, (dS/dt) v; zero where S is constant.

        Args:
            q: Position of the joint, shape (..., nq) [rad, m].
            v: Its velocity, shape (..., nv) [rad/s, m/s].

        Returns:
            Acceleration in the moving frame [m/s^2, rad/s^2].
        """
        return Motion.zero()

    def elementary_joints(self, placement: SE3) -> tuple[ElementaryJoint, ...]:
        """The chain of joints with constant motion subspaces that the kind is made of, which algorithms go through.

        By default the kind itself. A kind whose motion subspace depends on q overrides it, and so does one that costs
        fewer operations as a chain.

        Args:
            placement: Pose of the kind's fixed frame in the moving frame before it [m].

        Returns:
            The elementary joints, from the fixed frame outward.
        """
        return (ElementaryJoint(placement, self, 0, 0, 1.0),)

    # the space of its coordinates --------------------------------------------------------------------------

    @abc.abstractmethod
    def integrate(self, q: Array, v: Array) -> Array:
        """The position reached from `q` by moving with `v` for one unit of time.

        Args:
            q: Position of the joint, shape (..., nq) [rad, m].
            v: Its velocity times that time, shape (..., nv) [rad, m].

        Returns:
            Position, shape (..., nq) [rad, m].
        """

    @abc.abstractmethod
    def difference(self, q0: Array, q1: Array) -> Array:
        """The velocity that leads from `q0` to `q1` in one unit of time, on the shortest path.

        Args:
            q0: Position of the joint, shape (..., nq) [rad, m].
            q1: Position of the joint, shape (..., nq) [rad, m].

        Returns:
            Tangent vector, shape (..., nv) [rad, m].
        """

    @abc.abstractmethod
    def coordinate_rates(self, q: Array, v: Array) -> Array:
        """The rates of the coordinates: the derivative of `integrate(q, t v)` with respect to t at 0.

        Args:
            q: Position of the joint, shape (..., nq) [rad, m].
            v: Its velocity, shape (..., nv) [rad/s, m/s].

        Returns:
            dq/dt, shape (..., nq) [rad/s, m/s, 1/s].
        """

    @abc.abstractmethod
    def integrate_derivatives(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The derivatives of `integrate` with respect to q and v, on the tangent spaces.

        Args:
            q: Position of the joint, shape (..., nq) [rad, m].
            v: Its velocity times that time, shape (..., nv) [rad, m].

        Returns:
            Two matrices, each of shape (..., nv, nv).
        """

    @abc.abstractmethod
    def difference_derivatives(self, q0: Array, q1: Array) -> tuple[Array, Array]:
        """The derivatives of `difference` with respect to q0 and q1, on the tangent spaces.

        Args:
            q0: Position of the joint, shape (..., nq) [rad, m].
            q1: Position of the joint, shape (..., nq) [rad, m].

        Returns:
            Two matrices, each of shape (..., nv, nv).
        """

    @abc.abstractmethod
    def neutral(self) -> Floats:
        """The position from which others are counted, shape (nq,): no angle, no length, no rotation.

        The moving frame then lies on the fixed frame, but for kinds that begin at a distance, such as `Ellipsoid`.
        """

    @abc.abstractmethod
    def normalize(self, q: Array) -> Array:
        """The same pose, with quaternions of unit length and free angles in (-pi, pi], shape (..., nq)."""

    def random(
        self,
        rng: np.random.Generator,
        lower: Array | None = None,
        upper: Array | None = None,
        size: tuple[int, ...] = (),
    ) -> Floats:
        """Positions drawn evenly within the limits.

        Where a coordinate has no limit, angles are drawn from [-pi, pi] and lengths from [-1, 1] m; where it
        has one limit, from an interval of that same width on the allowed side. Quaternions are drawn evenly
        over all rotations, whatever their limits say.

        Args:
            rng: Where randomness comes from.
            lower: Lower limits, shape (nq,); None for none.
            upper: Upper limits, shape (nq,); None for none.
            size: Shape of the batch.

        Returns:
            Positions, shape (*size, nq).
        """
        low = np.full(self.nq, -np.inf) if lower is None else np.asarray(lower, dtype=float)
        high = np.full(self.nq, np.inf) if upper is None else np.asarray(upper, dtype=float)
        draws = [_draw(rng, c, float(low[i]), float(high[i]), size) for i, c in enumerate(self.coordinates)]
        return np.stack(draws, axis=-1) if draws else np.zeros((*size, 0))

    def squared_distance(self, q0: Array, q1: Array) -> Any:
        """The squared length of `difference(q0, q1)`; adds rad^2 and m^2 as they are.

        Args:
            q0: Position of the joint, shape (..., nq) [rad, m].
            q1: Position of the joint, shape (..., nq) [rad, m].

        Returns:
            Shape (...) [rad^2, m^2].
        """
        d = self.difference(q0, q1)
        return (d * d).sum(axis=-1)

    def interpolate(self, q0: Array, q1: Array, t: Any) -> Array:
        """The position at a fraction of the path from `q0` to `q1`.

        Args:
            q0: Position of the joint, shape (..., nq) [rad, m].
            q1: Position of the joint, shape (..., nq) [rad, m].
            t: The fraction, shape (...) [-]: 0 at `q0`, 1 at `q1`.

        Returns:
            Position, shape (..., nq) [rad, m].
        """
        d = self.difference(q0, q1)
        return self.integrate(q0, d * column(t))


class VectorKind(JointKind):
    """A kind whose q is a plain vector: sums and differences are what they look like."""

    @property
    def rates(self) -> tuple[Coordinate, ...]:
        """The entries of v."""
        return self.coordinates

    @property
    def is_vector(self) -> bool:
        """True."""
        return True

    def integrate(self, q: Array, v: Array) -> Array:
        """`q + v`."""
        return q + v

    def difference(self, q0: Array, q1: Array) -> Array:
        """`q1 - q0`."""
        return q1 - q0

    def coordinate_rates(self, q: Array, v: Array) -> Array:
        """`v`."""
        return v

    def integrate_derivatives(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The identity, twice."""
        one = identity(self.nv, q, v)
        return one, one

    def difference_derivatives(self, q0: Array, q1: Array) -> tuple[Array, Array]:
        """Minus the identity, and the identity."""
        one = identity(self.nv, q0, q1)
        return -one, one

    def neutral(self) -> Floats:
        """Zeros."""
        return np.zeros(self.nq)

    def normalize(self, q: Array) -> Array:
        """`q` as it is."""
        return q


def identity(n: int, *like: Array) -> Floats:
    """The identity matrix, once for each element of a batch.

    Args:
        n: Its size.
        *like: Arrays (..., k) whose batch axes are broadcast.

    Returns:
        Identities, shape (..., n, n).
    """
    batch = np.broadcast_shapes(*(np.shape(x)[:-1] for x in like))
    return np.broadcast_to(np.eye(n), (*batch, n, n))


def unit_quaternion(quat: Array) -> Array:
    """`quat_xyzw` (..., 4) scaled to unit length.

    Raises:
        InputError: it is zero (checked for numbers only; a traced zero becomes nan).
    """
    if not is_symbolic(quat) and np.any((quat == 0.0).all(axis=-1)):
        raise InputError(
            "A quaternion (x, y, z, w) is all zero; expected unit length. No rotation is (0, 0, 0, 1)."
        )
    return quat_normalize(quat)


def random_quaternion(rng: np.random.Generator, size: tuple[int, ...]) -> Floats:
    """Unit quaternions, evenly over all rotations: normal deviates, scaled to unit length.

    Args:
        rng: The source of random numbers.
        size: Shape of the batch.

    Returns:
        Quaternions xyzw, shape (*size, 4) [-].
    """
    quat = rng.standard_normal((*size, 4))
    return quat / np.sqrt((quat * quat).sum(axis=-1, keepdims=True))


def _draw(rng: np.random.Generator, c: Coordinate, low: float, high: float, size: tuple[int, ...]) -> Floats:
    bounded_below, bounded_above = math.isfinite(low), math.isfinite(high)
    if not bounded_below and not bounded_above:
        low, high = c.low, c.high
    elif not bounded_above:
        high = low + (c.high - c.low)
    elif not bounded_below:
        low = high - (c.high - c.low)
    return rng.uniform(low, high, size)
