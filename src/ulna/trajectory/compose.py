"""Trajectories made of trajectories: under another law of time, and one after the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from functools import cached_property
from itertools import pairwise
from typing import final

import numpy as np

from ulna.checks.values import number
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.trajectory.polynomial import Polynomial
from ulna.trajectory.space import Space, Vectors
from ulna.trajectory.trajectory import Trajectory, register_operation
from ulna.typing import Floats

_SAME_KNOT = 1e-9  # how near a knot of the law and one of the path are one, in parts of the path's length
_HALVINGS = 60
_INTERVAL_SAMPLES = np.linspace(0.01, 0.99, 9)  # where a law is asked whether it turns between two knots
_AT_ENDS = 1e-6  # how far a law may miss the ends of the path, in parts of its length


@final
@dataclass(frozen=True, eq=False, repr=False)
class Retimed(Trajectory):
    """A path under a law of time: q(t) = path(s(t)), v = path' s', a = path'' s'^2 + path' s''.

    Attributes:
        path: What is followed; its time is the path's parameter s.
        law: s(t), a trajectory of one number.
        kind: What made it.
        use: What part of each limit is used at most, by quantity, where the maker has bounded it: 1 is at the limit.
    """

    path: Trajectory
    law: Polynomial
    kind: str
    use: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, path: Trajectory, law: Trajectory, kind: str = "") -> Retimed:
        """A path under a law, checked: the law stays between 0 and the path's length.

        Args:
            path: What is followed.
            law: s(t), a polynomial trajectory of one number.
            kind: What made it; "" for that of the path.

        Returns:
            The trajectory.

        Raises:
            InputError: The law is none, or leaves the path.
        """
        if not isinstance(law, Polynomial) or law.space.n != 1:
            raise InputError(f"`law` is {law!r}; expected a polynomial trajectory of one number, s(t).")
        reach = law._at(law.instants(200), 0)[0]
        low, high, slack = float(reach.min()), float(reach.max()), _AT_ENDS * path.duration
        if low < -slack or high > path.duration + slack:
            raise InputError(
                f"The law runs from {low:.6g} to {high:.6g}, but the path only from 0 to {path.duration:.6g}."
            )
        return cls(path, law, kind or path.kind)

    @classmethod
    def evenly(cls, path: Trajectory, factor: float) -> Trajectory:
        """A path slower by `factor`, backwards if it is negative.

        Args:
            path: What is followed.
            factor: How many times as long it takes, not 0 [-].

        Returns:
            The trajectory.
        """
        if isinstance(path, Retimed):
            return cls(path.path, path.law._stretched(factor), path.kind)
        duration, start = path.duration * abs(factor), 0.0 if factor > 0.0 else path.duration
        law = Polynomial.of([0.0, duration], [[[start], [1.0 / factor]]], "even")
        return cls(path, law, path.kind)

    @property
    def duration(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]
        """How long it takes [s]."""
        return self.law.duration

    @property
    def space(self) -> Space:  # pyright: ignore[reportIncompatibleVariableOverride]
        """What moves."""
        return self.path.space

    @property
    def knots(self) -> Floats:
        """Times where the law's pieces meet, and where it passes the path's knots."""
        return self._knots

    @cached_property
    def _knots(self) -> Floats:
        law, times, inner = self.law, self.law.times, self.path.knots[1:-1]
        s = law._at(times, 0)[0][:, 0]
        rounding = _SAME_KNOT * self.path.duration
        low, high = np.minimum(s[:-1], s[1:])[:, None], np.maximum(s[:-1], s[1:])[:, None]
        piece, knot = np.nonzero((inner > low + rounding) & (inner < high - rounding))
        before, after, rises = times[piece], times[piece + 1], s[piece] < s[piece + 1]
        for _ in range(_HALVINGS if piece.size else 0):
            middle = 0.5 * (before + after)
            passed = (law._at(middle, 0)[0][:, 0] >= inner[knot]) == rises
            before, after = np.where(passed, before, middle), np.where(passed, middle, after)
        return np.unique(np.concatenate([times, after]))

    @property
    def order(self) -> int:
        """As many derivatives as the path has."""
        return self.path.order

    def _at(self, t: Floats, order: int) -> tuple[Floats, ...]:
        s, *rates = self.law._at(t, order)
        q, *d = self.path._at(self._on_its_side(s[:, 0], t), order)
        if order == 0:
            return (q,)
        rows, ds = [d[0] * rates[0]], rates[0]
        if order > 1:
            rows.append(d[1] * (ds * ds) + d[0] * rates[1])
        if order > 2:
            rows.append(d[2] * ds**3 + 3.0 * d[1] * (ds * rates[1]) + d[0] * rates[2])
        return (q, *rows)

    def _on_its_side(self, s: Floats, t: Floats) -> Floats:
        """Places on the path at times, on that side of the path's knots which belongs to the time despite rounding.

        So the law's acceleration and the path's curvature are always those of one piece.
        """
        low, high = self._sides
        if len(low) == 1:
            return np.minimum(np.maximum(s, low[0]), high[0])
        piece = np.searchsorted(self._knots[1:-1], t, side="right")
        return np.minimum(np.maximum(s, low[piece]), high[piece])

    @cached_property
    def _sides(self) -> tuple[Floats, Floats]:
        """The least and the greatest place on the path between any two knots."""
        length, times, knots = self.path.duration, self._knots, self.path.knots
        ends = self.law._at(times, 0)[0][:, 0]
        near = np.clip(np.searchsorted(knots, ends - _SAME_KNOT * length), 0, knots.size - 1)
        ends = np.where(np.abs(knots[near] - ends) <= _SAME_KNOT * length, knots[near], ends)
        inside = times[:-1, None] + np.diff(times)[:, None] * _INTERVAL_SAMPLES
        rates = self.law._at(inside.reshape(-1), 1)[1].reshape(inside.shape)
        turns = (rates.min(axis=1) < 0.0) & (rates.max(axis=1) > 0.0)
        low, high = np.minimum(ends[:-1], ends[1:]), np.maximum(ends[:-1], ends[1:])
        high = np.where(high < length, np.nextafter(high, -np.inf), high)
        low, high = np.where(turns, 0.0, low), np.where(turns, length, high)
        return np.clip(low, 0.0, length), np.clip(np.maximum(high, low), 0.0, length)


@final
@dataclass(frozen=True, eq=False, repr=False)
class Chain(Trajectory):
    """Trajectories one after the other.

    Attributes:
        parts: The trajectories.
        starts: When each begins, and when the last ends, (len(parts) + 1,) [s].
        kind: What made it.
    """

    parts: tuple[Trajectory, ...]
    starts: Floats
    kind: str = "chain"

    @classmethod
    def of(cls, parts: Sequence[Trajectory], kind: str = "chain") -> Chain:
        """Parts one after the other, unchecked.

        Args:
            parts: Trajectories of one space.
            kind: What made it.

        Returns:
            The trajectory.
        """
        flat = [p for part in parts for p in (part.parts if isinstance(part, Chain) else (part,))]
        starts = np.concatenate([[0.0], np.cumsum([p.duration for p in flat])])
        starts.flags.writeable = False
        return cls(tuple(flat), starts, kind)

    @property
    def duration(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]
        """How long it takes [s]."""
        return float(self.starts[-1])

    @property
    def space(self) -> Space:  # pyright: ignore[reportIncompatibleVariableOverride]
        """What moves."""
        return self.parts[0].space

    @property
    def knots(self) -> Floats:
        """The knots of all parts."""
        inner = [p.knots[:-1] + start for p, start in zip(self.parts, self.starts, strict=False)]
        return np.concatenate([*inner, self.starts[-1:]])

    @property
    def order(self) -> int:
        """As many derivatives as all parts have."""
        return min(p.order for p in self.parts)

    def _at(self, t: Floats, order: int) -> tuple[Floats, ...]:
        which = np.searchsorted(self.starts[1:-1], t, side="right")
        shapes = [self.space.shape] + [(self.space.n,)] * order
        rows = tuple(np.empty((t.size, *shape)) for shape in shapes)
        for k in np.unique(which):
            here = which == k
            part = self.parts[k]
            local = np.minimum(t[here] - self.starts[k], part.duration)
            for row, value in zip(rows, part._at(local, order), strict=True):
                row[here] = value
        return rows

    def _stretched(self, factor: float) -> Chain:
        parts = [p._stretched(factor) for p in self.parts]
        return Chain.of(parts if factor > 0.0 else parts[::-1], self.kind)


def concatenate(*parts: Trajectory, tolerance: float = 1e-6) -> Trajectory:
    """One trajectory after the other, which `a + b` writes shorter.

    Args:
        *parts: Trajectories of the same space.
        tolerance: By how much the end of one and the start of the next may differ in any entry, of the point [rad or
            m] and of the velocity [rad/s or m/s]; accelerations may jump.

    Returns:
        One polynomial if all parts are polynomials, else a chain.

    Raises:
        InputError: The spaces differ, `tolerance` is none, or there is a gap; names what jumps, where, and by how much.

    Example:
        >>> first = ulna.trajectory.quintic([0.0], [1.0], duration=2.0)
        >>> second = ulna.trajectory.quintic([1.0], [0.5], duration=1.0)
        >>> ulna.trajectory.concatenate(first, second).duration
        3.0
    """
    if not parts:
        raise InputError("concatenate() has no argument; expected at least one trajectory.")
    allowed = number("tolerance", tolerance, "a finite jump of zero or more", least=0.0)
    for place, part in enumerate(parts):
        if not isinstance(part, Trajectory):
            raise InputError(f"Part {place} is {part!r}; expected a trajectory.")
    clock = 0.0
    for place, (one, two) in enumerate(pairwise(parts)):
        clock += one.duration
        _same_space(place, one.space, two.space)
        _check_continuity(place, clock, one, two, allowed)
    polynomials = [p for p in parts if isinstance(p, Polynomial)]
    if len(polynomials) < len(parts):
        return Chain.of(parts)
    starts = np.cumsum([0.0] + [p.duration for p in polynomials])
    times = [p.times[:-1] + start for p, start in zip(polynomials, starts, strict=False)]
    rows = max(p.coefficients.shape[1] for p in polynomials)
    c = [np.pad(p.coefficients, ((0, 0), (0, rows - p.coefficients.shape[1]), (0, 0))) for p in polynomials]
    kinds = {p.kind for p in polynomials}
    kind = kinds.pop() if len(kinds) == 1 else "chain"
    return Polynomial.of(np.concatenate([*times, starts[-1:]]), np.concatenate(c), kind, parts[0].space)


def _same_space(number: int, one: Space, two: Space) -> None:
    named = isinstance(one, Vectors) and isinstance(two, Vectors) and one.n == two.n
    if one != two and not named:
        raise InputError(
            f"Trajectory {number} moves {one.n} of {type(one).__name__.lower()}, and trajectory {number + 1} "
            f"{two.n} of {type(two).__name__.lower()}; expected the same robot, or poses in both."
        )


def _check_continuity(number: int, clock: float, one: Trajectory, two: Trajectory, tolerance: float) -> None:
    q0, v0 = one._at(np.array([one.duration]), 1)
    q1, v1 = two._at(np.array([0.0]), 1)
    gaps = (("position", one.space.difference(q0, q1)[0]), ("velocity", (v1 - v0)[0]))
    for what, gap in gaps:
        k = int(np.argmax(np.abs(gap)))
        if abs(gap[k]) > tolerance:
            raise InputError(
                f"Between trajectory {number} and {number + 1}, at {clock:.6g} s, the {what} of "
                f"{one.space.names[k]!r} jumps by {gap[k]:.4g}; expected at most {tolerance:g}. "
                "Start the next where the last ends, or make a transition with quintic(...)."
            )


register_operation("concatenate", concatenate)
register_operation("retimed", Retimed.of)
register_operation("evenly", Retimed.evenly)
