"""Rows of constraints along a path: what limits of acceleration and torque say of its squared rate and acceleration.

| symbol | meaning | shape | unit |
|---|---|---|---|
| p, p', p'' | path and its derivatives by its parameter s | (n,) | [rad] |
| x, u | s'^2 and s'', rates of s by time | () | [1/s^2] |
| a, b, c | low <= a u + b x + c <= high; acceleration: p', p'', 0 | (n,) | |
| | torque: M p', M p'' + C(p, p') p', g | (nv,) | [N m] |

Source: Pham & Pham 2018, section II; Bobrow, Dubowsky & Gibson 1985.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ulna import algorithms
from ulna.compiler import compile
from ulna.errors import InputError, ShapeError
from ulna.model import Model
from ulna.numeric import minimum, where
from ulna.trajectory.reach import HUGE
from ulna.typing import Array, ArrayLike, Floats

TINY = 1e-140  # a path that moves a joint less than this in one unit does not move it


@dataclass(frozen=True)
class Rows:
    """Constraints low <= a u + b x <= high at each grid point, (N + 1, m), and what they limit: quantities and joints.

    `low` and `high` are (m,) where they are everywhere the same.
    """

    a: Floats
    b: Floats
    low: Floats
    high: Floats
    quantities: tuple[tuple[str, Any], ...]

    @property
    def arrays(self) -> tuple[Floats, Floats, Floats, Floats]:
        """The four arrays."""
        return self.a, self.b, self.low, self.high

    def labels(self, names: Sequence[str]) -> list[str]:
        """What each row limits, in words."""
        return [
            f"{what} of {names[int(k)]!r}" for what, kept in self.quantities for k in np.flatnonzero(kept)
        ]


@dataclass(frozen=True)
class Bounds:
    """Limits of one quantity from below and above, (n,), and whether all or any of them are finite."""

    low: Floats
    high: Floats
    finite: Any
    all: bool
    any: bool


def bounds_of(name: str, value: ArrayLike | None, n: int) -> Bounds:
    """Limits from one number, (n,) of them, or (2, n): least and greatest.

    Raises:
        InputError: Limits that do not have zero between them.
    """
    if value is None:
        return _unlimited(n)
    given = np.asarray(value, dtype=float)
    if given.shape == (2, n):
        low, high = given
    elif given.shape in ((), (n,)):
        high = given if given.shape else np.full(n, float(given))
        low = -high
        if high.min() > 0.0 and high.max() < np.inf:
            return Bounds(low, high, _yes(n), True, True)
    else:
        raise ShapeError(name, given.shape, f"one number, ({n},), or (2, {n}): least and greatest")
    if high.min() > 0.0 and low.max() < 0.0:
        finite = np.isfinite(high)
        if (finite == np.isfinite(low)).all():
            return Bounds(low, high, finite, bool(finite.all()), bool(finite.any()))
    k = int(np.argmax(~((low < 0.0) & (high > 0.0)) | (np.isinf(low) != np.isinf(high))))
    raise InputError(
        f"`{name}` of joint {k} is from {low[k]:g} to {high[k]:g}; expected limits with zero between them, or "
        "np.inf for none. A joint that must not move does not belong on the path: robot.lock([...])."
    )


@lru_cache(maxsize=32)
def _unlimited(n: int) -> Bounds:
    return Bounds(np.full(n, -np.inf), np.full(n, np.inf), np.zeros(n, dtype=bool), False, False)


@lru_cache(maxsize=32)
def _yes(n: int) -> Any:
    return np.ones(n, dtype=bool)


def speed_cap(tangent: Floats, velocity: Bounds) -> Floats:
    """The greatest x that keeps joint speeds within limits, (N + 1,); huge where nothing limits it."""
    if not velocity.any:
        return np.full(len(tangent), HUGE)
    return _cap_kernel(tangent.shape[1])(tangent, velocity.low, velocity.high)


def acceleration_rows(tangent: Floats, curvature: Floats, limits: Bounds) -> Rows:
    """What limits of joint acceleration say."""
    low, high = limits.low, limits.high
    if not limits.all:
        kept = limits.finite
        tangent, curvature, low, high = tangent[:, kept], curvature[:, kept], low[kept], high[kept]
    return Rows(tangent, curvature, low, high, (("acceleration", limits.finite),))


def torque_rows(model: Model, q: Floats, tangent: Floats, curvature: Floats, limits: Bounds) -> Rows:
    """What limits of joint torque say."""
    a, b, c = _along_path(model)(q, tangent, curvature)
    low, high = limits.low - c, limits.high - c
    if not limits.all:
        kept = limits.finite
        a, b, low, high = a[:, kept], b[:, kept], low[:, kept], high[:, kept]
    return Rows(a, b, low, high, (("torque", limits.finite),))


def joined(rows: Sequence[Rows]) -> Rows:
    """All rows side by side."""
    if len(rows) == 1:
        return rows[0]
    parts = zip(*(np.broadcast_arrays(*r.arrays) for r in rows), strict=True)
    a, b, low, high = (np.concatenate(part, axis=1) for part in parts)
    return Rows(a, b, low, high, tuple(x for r in rows for x in r.quantities))


@lru_cache(maxsize=32)
def _cap_kernel(n: int) -> Any:
    """The kernel p', least and greatest speeds -> x."""

    def cap(tangent: Array, low: Array, high: Array) -> Any:
        rates = [
            where(t < 0.0, lo, hi) / where(abs(t) < TINY, TINY, abs(t))
            for t, lo, hi in zip(tangent, low, high, strict=True)
        ]
        squares = [minimum(rate * rate, HUGE) for rate in rates]
        least = squares[0]
        for x in squares[1:]:
            least = minimum(least, x)
        return least

    return compile(cap, tangent=(n,), low=(n,), high=(n,)).gufunc


@lru_cache(maxsize=32)
def _along_path(model: Model) -> Any:
    """The kernel q, p', p'' -> a, b, c of the torques."""

    def coefficients(q: Array, tangent: Array, curvature: Array) -> tuple[Array, Array, Array]:
        c = algorithms.gravity_forces(model, q)
        a = algorithms.inverse_dynamics(model, q, None, tangent) - c
        b = algorithms.inverse_dynamics(model, q, tangent, curvature) - c
        return a, b, c

    return compile(coefficients, q=(model.nq,), tangent=(model.nv,), curvature=(model.nv,)).gufunc
