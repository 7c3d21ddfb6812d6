"""Rows of constraints along a path: limits of acceleration and torque in terms of its squared rate and acceleration.

| symbol | meaning | shape | unit |
|---|---|---|---|
| p, p', p'' | path and its derivatives with respect to its parameter s | (n,) | [rad] |
| x, u | s'^2 and s'', rates of s by time | () | [1/s^2] |
| a, b, c | low <= a u + b x + c <= high; acceleration: p', p'', 0 | (n,) | |
| | torque: M p', M p'' + C(p, p') p', g | (nv,) | [N m] |

Source: Pham & Pham 2018, section II; Bobrow, Dubowsky & Gibson 1985.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from ulna import algorithms
from ulna.compiler import compile
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError
from ulna.model import Model
from ulna.typing import Array, ArrayLike, Floats

_SHORT, _LONG = 1e-2, 1e2  # a path's parameter, as usual


@dataclass(frozen=True, eq=False)
class Rows:
    """Constraints low <= a u + b x <= high at the nodes of each segment, (N, 5, m), and what they limit.

    `low` and `high` are (1, m) where they are the same everywhere.

    Attributes:
        a: Factors of the path's acceleration.
        b: Factors of the path's squared rate.
        low: Least values: the limits, less what is there at rest.
        high: Greatest values, likewise.
        limits: The limits themselves, (2, m).
        quantities: What is limited, and of which joints.
    """

    a: Floats
    b: Floats
    low: Floats
    high: Floats
    limits: Floats
    quantities: tuple[tuple[str, Any], ...]

    @property
    def arrays(self) -> tuple[Floats, Floats, Floats, Floats]:
        """The four arrays."""
        return self.a, self.b, self.low, self.high

    def labels(self, names: Sequence[str]) -> list[str]:
        """What each row limits, as text."""
        return [
            f"{what} of {names[int(k)]!r}" for what, finite in self.quantities for k in np.flatnonzero(finite)
        ]

    def of_quantity(self) -> list[tuple[str, slice]]:
        """Each quantity with its rows."""
        slices, begin = [], 0
        for what, finite in self.quantities:
            count = int(np.count_nonzero(finite))
            slices.append((what, slice(begin, begin + count)))
            begin += count
        return slices


@dataclass(frozen=True)
class Bounds:
    """Limits of one quantity from below and above, (n,), and whether all or any of them are finite."""

    low: Floats
    high: Floats
    finite: Any
    all: bool
    any: bool

    @property
    def both(self) -> Floats:
        """Least and greatest, (2, n)."""
        return np.array([self.low, self.high])


def bounds_of(name: str, value: ArrayLike | None, n: int) -> Bounds:
    """Limits from one number, (n,) of them, or (2, n): least and greatest.

    Args:
        name: Name of the argument, for messages.
        value: Limits, (), (n,) or (2, n); None for no limits.
        n: Number of joints.

    Returns:
        Least and greatest values.

    Raises:
        InputError: Limits that do not have zero between them.
        ShapeError: Limits of another shape.
    """
    if value is None:
        return _unlimited(n)
    bound = np.asarray(value, dtype=float)
    if bound.shape == (2, n):
        low, high = bound
    elif bound.shape in ((), (n,)):
        high = bound if bound.shape else np.full(n, float(bound))
        low = -high
        if high.min() > 0.0 and high.max() < np.inf:
            return Bounds(low, high, _all_true(n), True, True)
    else:
        raise ShapeError(name, bound.shape, f"one number, ({n},), or (2, {n}): least and greatest")
    if high.min() > 0.0 and low.max() < 0.0:
        finite = np.isfinite(high)
        if (finite == np.isfinite(low)).all():
            return Bounds(low, high, finite, bool(finite.all()), bool(finite.any()))
    k = int(np.argmax(~((low < 0.0) & (high > 0.0)) | (np.isinf(low) != np.isinf(high))))
    raise InputError(
        f"`{name}` of joint {k} is from {low[k]:g} to {high[k]:g}; expected limits with zero between them, or "
        "np.inf on both sides for none. A joint that must not move does not belong on the path: robot.lock([...])."
    )


@lru_cache(maxsize=32)
def _unlimited(n: int) -> Bounds:
    return Bounds(np.full(n, -np.inf), np.full(n, np.inf), np.zeros(n, dtype=bool), False, False)


@lru_cache(maxsize=32)
def _all_true(n: int) -> Any:
    return np.ones(n, dtype=bool)


def acceleration_rows(tangent: Floats, curvature: Floats, limits: Bounds) -> Rows:
    """Constraints from limits of joint acceleration: p' u + p'' x within them.

    Args:
        tangent: p' at places of the path, (..., n).
        curvature: p'' there, (..., n).
        limits: Limits of the joints.

    Returns:
        Rows of the joints with finite limits.
    """
    return _finite_rows("acceleration", (tangent, curvature, limits.low[None], limits.high[None]), limits)


def torque_rows(
    model: Model, q: Floats, tangent: Floats, curvature: Floats, limits: Bounds, length: float = 1.0
) -> Rows:
    """Constraints from limits of joint torque, by inverse dynamics along the path.

    Args:
        model: The robot.
        q: Configurations at places of the path, (..., nq) [rad or m].
        tangent: p' at places of the path, (..., n).
        curvature: p'' there, (..., n).
        limits: Limits of the joints.
        length: Length of the range of the path's parameter [-].

    Returns:
        Rows of the joints with finite limits.
    """
    if _SHORT < length < _LONG:
        a, b, c = _along_path(model)(q, tangent, curvature)
    else:  # by a parameter from 0 to 1: else torques that accelerate drown in the rounding of those that hold
        a, b, c = _along_path(model)(q, tangent * length, curvature * length**2)
        a, b = a / length, b / length**2
    return _finite_rows("torque", (a, b, limits.low - c, limits.high - c), limits)


def joined(rows: Sequence[Rows]) -> Rows:
    """All rows side by side."""
    if len(rows) == 1:
        return rows[0]
    parts = zip(*(np.broadcast_arrays(*r.arrays) for r in rows), strict=True)
    a, b, low, high = (np.concatenate(part, axis=-1) for part in parts)
    limits = np.concatenate([r.limits for r in rows], axis=1)
    return Rows(a, b, low, high, limits, tuple(x for r in rows for x in r.quantities))


def _finite_rows(what: str, arrays: tuple[Floats, Floats, Floats, Floats], limits: Bounds) -> Rows:
    """The rows whose limits are finite."""
    both = limits.both
    if not limits.all:
        finite = limits.finite
        a, b, low, high = (x[..., finite] for x in arrays)
        return Rows(a, b, low, high, both[:, finite], ((what, limits.finite),))
    return Rows(*arrays, both, ((what, limits.finite),))


@lru_cache(maxsize=32)
def _along_path(model: Model) -> Any:
    """The kernel q, p', p'' -> a, b, c of the torques."""

    def coefficients(q: Array, tangent: Array, curvature: Array) -> tuple[Array, Array, Array]:
        c = algorithms.gravity_forces(model, q)
        a = algorithms.inverse_dynamics(model, q, None, tangent) - c
        b = algorithms.inverse_dynamics(model, q, tangent, curvature) - c
        return a, b, c

    return compile(coefficients, q=(model.nq,), tangent=(model.nv,), curvature=(model.nv,)).gufunc
