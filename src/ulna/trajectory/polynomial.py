"""Piecewise polynomials of time: what most joint trajectories are.

| symbol | meaning | shape | unit |
|---|---|---|---|
| knots | times where pieces meet | (k + 1,) | [s] |
| c | coefficients by piece and power, of the time since the piece's start | (k, d + 1, n) | [rad/s^i] |
| tau | time since the piece's start | () | [s] |
| q, v, a, j | sum of c_i tau^i and its derivatives, by Horner's rule | (n,) | [rad] to [rad/s^3] |

Source: Biagiotti & Melchiorri, Trajectory Planning for Automatic Machines and Robots (2008), section 2.1.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb, perm
from typing import Any, final

import numpy as np

from ulna.checks.arrays import check_finite, finite_array
from ulna.compiler import compile
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError
from ulna.trajectory.space import Space, Vectors
from ulna.trajectory.trajectory import Trajectory
from ulna.typing import Array, Floats

_LONGEST = 1e30  # s; the fifth power of longer times is too large for floats, and coefficients become zero


@final
@dataclass(frozen=True, eq=False, repr=False)
class Polynomial(Trajectory):
    """A trajectory of plain numbers that is a polynomial between its knots.

    Attributes:
        times: Times where pieces meet, increasing from 0, (k + 1,) [s].
        coefficients: By piece, power of the time since the piece's start, and joint, (k, d + 1, n).
        space: What moves.
        kind: What made it.
    """

    times: Floats
    coefficients: Floats
    space: Space
    kind: str = "polynomial"

    @classmethod
    def of(
        cls, times: Any, coefficients: Any, kind: str = "polynomial", space: Space | None = None
    ) -> Polynomial:
        """A polynomial trajectory of checked, copied, read-only arrays.

        Args:
            times: Knots, (k + 1,) from 0 [s].
            coefficients: By piece, power of the time since the piece's start, and joint, (k, d + 1, n).
            kind: What made it.
            space: What moves; None for plain numbers.

        Returns:
            The trajectory.

        Raises:
            InputError: Times that do not increase from 0.
            ShapeError: Shapes that do not fit.
        """
        t, c = finite_array("times", times), finite_array("coefficients", coefficients)
        if c.ndim != 3 or t.shape != (c.shape[0] + 1,) or 0 in c.shape:
            raise ShapeError("coefficients", c.shape, f"(k, d + 1, n) with k + 1 = {t.size} times")
        if t[0] != 0.0 or (np.diff(t) <= 0.0).any():
            raise InputError("`times` do not increase from 0; expected knots such as [0, 1, 2.5].")
        t.flags.writeable = c.flags.writeable = False
        return cls(t, c, space or Vectors.of(c.shape[2]), kind)

    @property
    def duration(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]
        """How long it takes [s]."""
        return float(self.times[-1])

    @property
    def knots(self) -> Floats:
        """Times where pieces meet."""
        return self.times

    @property
    def order(self) -> int:
        """3: it has a jerk."""
        return 3

    def _at(self, t: Floats, order: int) -> tuple[Floats, ...]:
        _, powers, n = self.coefficients.shape
        evaluate = _horner(powers, n, order)
        if len(self.coefficients) == 1:
            rows = evaluate(self.coefficients[0], t)
        else:
            piece = np.searchsorted(self.times[1:-1], t, side="right")
            rows = evaluate(self.coefficients[piece], t - self.times[piece])
        return rows if order else (rows,)

    def _stretched(self, factor: float) -> Polynomial:
        c, times = self.coefficients, self.times
        if factor < 0.0:
            c, times = shifted(c, np.diff(times))[::-1], times[-1] - times[::-1]
        powers = np.arange(c.shape[1])[:, None]
        return Polynomial.of(times * abs(factor), c / factor**powers, self.kind, self.space)

    def __eq__(self, other: object) -> bool:
        """Whether both are the same polynomials of the same things."""
        if not isinstance(other, Polynomial):
            return NotImplemented
        same = np.array_equal(self.times, other.times) and np.array_equal(
            self.coefficients, other.coefficients
        )
        return same and self.space == other.space

    def __hash__(self) -> int:
        return hash((self.times.tobytes(), self.coefficients.tobytes(), self.space.names))


def hermite(
    times: Floats, q: Floats, v: Floats, a: Floats | None = None, kind: str = "", space: Space | None = None
) -> Polynomial:
    """The cubics, or with accelerations the quintics, that have given states at given times.

    Args:
        times: Times, (k + 1,) [s].
        q: Points, (k + 1, n) [rad or m].
        v: Velocities there, (k + 1, n) [rad/s or m/s].
        a: Accelerations there, (k + 1, n) [rad/s^2 or m/s^2]; None for cubics.
        kind: What to call it.
        space: What moves.

    Returns:
        The trajectory.

    Raises:
        NonFiniteError: An argument holds nan or inf.
        InputError: Times are so short that coefficients are not finite, or so long that powers of them are not.

    Source: Biagiotti & Melchiorri 2008, eq. (2.2) and (2.6).
    """
    h, n = times[1:] - times[:-1], q.shape[1]
    states = [row for x in (q, v, a) if x is not None for row in (x[:-1], x[1:])]
    c = _hermite_kernel(n, a is not None)(h, *states)
    if h.max() > _LONGEST:
        raise InputError(
            f"A motion takes {h.max():g} s; expected at most {_LONGEST:g} s from point to point."
        )
    if not np.isfinite(c).all():
        for name, array in {"times": times, "q": q, "v": v, "a": a}.items():
            if array is not None:
                check_finite(name, array, "Look where it comes from.")
        raise InputError(
            f"Between {times[0]:g} s and {times[-1]:g} s the motion is too fast to be computed; expected longer times "
            "or points nearer to each other."
        )
    times = times.copy()
    times.flags.writeable = c.flags.writeable = False
    return Polynomial(times, c, space or Vectors.of(n), kind)


def shifted(c: Floats, h: Floats) -> Floats:
    """Coefficients of the same pieces by the time since `h` after their starts.

    Args:
        c: Coefficients, (k, d + 1, n).
        h: Time of each piece, (k,) [s].

    Returns:
        Coefficients, (k, d + 1, n).
    """
    out = np.zeros_like(c)
    for i in range(c.shape[1]):
        for j in range(i, c.shape[1]):
            out[:, i] += c[:, j] * (comb(j, i) * h[:, None] ** (j - i))
    return out


def hermite_coefficients(h: Any, q0: Array, q1: Array, v0: Array, v1: Array, *a: Array) -> Array:
    """Coefficients of one piece of length `h` from the states at its ends, (4, n), or with accelerations (6, n).

    Args:
        h: Time that the piece takes [s].
        q0: Point at its start, (n,) [rad or m].
        q1: Point at its end, (n,) [rad or m].
        v0: Velocity at its start, (n,) [rad/s or m/s].
        v1: Velocity at its end, (n,) [rad/s or m/s].
        *a: Accelerations at both ends, (n,) each [rad/s^2 or m/s^2], or none.

    Returns:
        Coefficients (4, n) or (6, n), by power of the time.
    """
    displacement, b0, b1 = q1 - q0, v0 * h, v1 * h
    if not a:
        return np.stack(
            [q0, v0, (3.0 * displacement - 2.0 * b0 - b1) / h**2, (b0 + b1 - 2.0 * displacement) / h**3]
        )
    half = 0.5 * a[0]
    c0, c1 = half * h**2, 0.5 * a[1] * h**2
    cubic = 10.0 * displacement - 6.0 * b0 - 4.0 * b1 - 3.0 * c0 + c1
    quartic = -15.0 * displacement + 8.0 * b0 + 7.0 * b1 + 3.0 * c0 - 2.0 * c1
    last = 6.0 * displacement - 3.0 * (b0 + b1) - c0 + c1
    return np.stack([q0, v0, half, cubic / h**3, quartic / h**4, last / h**5])


def horner(c: Array, tau: Any, order: int) -> tuple[Array, ...]:
    """The polynomial with coefficients `c` (d + 1, n) at `tau`, and its derivatives up to `order`, (n,) each.

    Args:
        c: Coefficients by power, (d + 1, n).
        tau: Time since the piece's start [s].
        order: Highest derivative.

    Returns:
        Value and derivatives, (n,) each.
    """

    def derivative(k: int) -> Array:
        value = 0.0 * c[0]
        for i in reversed(range(k, len(c))):
            value = value * tau + c[i] * float(perm(i, k))
        return value

    return tuple(derivative(k) for k in range(order + 1))


@lru_cache(maxsize=64)
def _hermite_kernel(n: int, quintic: bool) -> Any:
    """The kernel from a piece's length and the states at its ends to its coefficients, (4, n) or (6, n)."""
    names = ("q0", "q1", "v0", "v1", *(("a0", "a1") if quintic else ()))
    shapes: dict[str, Any] = {"h": ()} | dict.fromkeys(names, (n,))
    return compile(hermite_coefficients, **shapes).gufunc


@lru_cache(maxsize=64)
def _horner(rows: int, n: int, order: int) -> Any:
    """The kernel (rows, n), () -> (n,) ...: a polynomial and its derivatives up to `order`."""

    def evaluate(c: Array, tau: Any) -> Any:
        values = horner(c, tau, order)
        return values if order else values[0]

    return compile(evaluate, c=(rows, n), tau=()).gufunc
