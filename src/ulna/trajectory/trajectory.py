"""The base of all trajectories: a frozen value with position, velocity and acceleration at any time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import count as checked_count
from ulna.checks.values import duration as checked_duration
from ulna.checks.values import flag, number
from ulna.errors import InputError
from ulna.system.discarded import returns_copy
from ulna.trajectory.inputs import positive
from ulna.trajectory.peaks import greatest
from ulna.trajectory.space import Poses, Space
from ulna.typing import ArrayLike, Floats

_MOST_ROWS = 10**8  # more do not fit
END_TOLERANCE = 1e-9
"""How far beyond its ends, in parts of the duration, a time still counts as that end: what summing steps may lose."""

_operations: dict[str, Callable[..., Any]] = {}


def register_operation(name: str, function: Callable[..., Any]) -> None:
    """Makes `function` the implementation of a method that needs modules built on this one, such as `retimed`.

    Args:
        name: Name of the method.
        function: The implementation; called with the trajectory and the method's arguments.
    """
    _operations[name] = function


_BETWEEN = np.arange(1, 16) / 16.0  # where between two knots peaks are looked for at least
_BOUND_TOLERANCE = 1e-9  # how close the bound of a peak is to it, in parts of it


class Samples(NamedTuple):
    """Rows of a trajectory: times (m,) [s], points (m, ...), and their derivatives with respect to time (m, n)."""

    t: Floats
    q: Floats
    v: Floats
    a: Floats


class SamplesWithJerk(NamedTuple):
    """The same with the jerk (m, n)."""

    t: Floats
    q: Floats
    v: Floats
    a: Floats
    jerk: Floats


class Trajectory(ABC):
    """A motion over the time from 0 to `duration` [s]; of joints, or of a pose.

    Call it, or ask `q`, `v`, `a` and `jerk`, at any time or array of times. Before its start and after its end a
    trajectory *holds*: the point is that of the nearer end, and nothing moves. At a time where a derivative jumps,
    the later value counts.

    Of joints, `q` (..., nq) is a configuration and `v`, `a` (..., nv) are its velocity and acceleration as the
    robot's methods take them. Of a pose, `T` (..., 4, 4) is T_world_frame, and `v`, `a` (..., 6) are velocity and
    acceleration of the frame's origin and of the rotation, in world axes, linear part first: what
    `robot.frame_velocity` and `robot.frame_acceleration(..., classical=True)` give in "local_world_aligned".
    """

    duration: float
    """How long it takes [s]."""

    space: Space
    """What moves: the names of the directions, and how points differ."""

    kind: str
    """The function that made it, such as "quintic"."""

    @property
    @abstractmethod
    def knots(self) -> Floats:
        """Times between which it is smooth, from 0 to the duration [s]."""

    @property
    @abstractmethod
    def order(self) -> int:
        """How many derivatives it has: 3 with jerk, else 2."""

    @abstractmethod
    def _at(self, t: Floats, order: int) -> tuple[Floats, ...]:
        """Points at times (m,) within the duration, and their derivatives up to `order`."""

    def __call__(self, t: ArrayLike) -> Floats:
        """The point at time `t` [s]: a configuration (..., nq), or a pose (..., 4, 4)."""
        return self._derivative(t, 0)

    def q(self, t: ArrayLike) -> Floats:
        """The configuration at time `t` [s], (..., nq) [rad or m]."""
        if isinstance(self.space, Poses):
            raise InputError(
                "This trajectory moves a pose and has no `q`; use T(t), or convert it to joint motion: follow(...)."
            )
        return self._derivative(t, 0)

    def T(self, t: ArrayLike) -> Floats:
        """The pose at time `t` [s], T_world_frame, (..., 4, 4)."""
        if not isinstance(self.space, Poses):
            raise InputError(
                "This trajectory moves joints and has no `T`; use q(t), or robot.fk(trajectory.q(t))."
            )
        return self._derivative(t, 0)

    def v(self, t: ArrayLike) -> Floats:
        """The velocity at time `t` [s], (..., nv) [rad/s or m/s]; for a pose its twist (..., 6), linear part first.

        Example:
            >>> move = ulna.trajectory.quintic([0.0], [1.0], duration=2.0)
            >>> move.v([0.0, 1.0, 2.0]).round(4)  # three times: three rows
            array([[0.    ],
                   [0.9375],
                   [0.    ]])
        """
        return self._derivative(t, 1)

    def a(self, t: ArrayLike) -> Floats:
        """The acceleration at time `t` [s], (..., nv) [rad/s^2 or m/s^2]; for a pose (..., 6), linear part first."""
        return self._derivative(t, 2)

    def jerk(self, t: ArrayLike) -> Floats:
        """The jerk at time `t` [s], (..., nv) [rad/s^3 or m/s^3]."""
        return self._derivative(t, 3)

    def state(self, t: ArrayLike) -> tuple[Floats, Floats, Floats]:
        """Point, velocity and acceleration at time `t` [s], in one evaluation."""
        q, v, a = self._evaluate(t, 2)
        return q, v, a

    def sample(self, rate: float | None = None, n: int | None = None, jerk: bool = False) -> Any:
        """Rows of times, points, velocities and accelerations, with the last at the very end.

        Args:
            rate: Rows a second [1/s]; the end is an additional last row where the duration is no multiple.
            n: How many rows, evenly spaced, instead.
            jerk: Whether to add the jerk.

        Returns:
            `(t, q, v, a)` or `(t, q, v, a, jerk)`, a named tuple.

        Raises:
            InputError: Both or neither of `rate` and `n`, or one that is too small or too large, or `jerk` is no truth
                value.

        Example:
            >>> move = ulna.trajectory.quintic([0.0], [1.0], duration=2.0)
            >>> t, q, v, a = move.sample(rate=100)
            >>> q.shape, float(v.max())
            ((201, 1), 0.9375)
        """
        with_jerk = flag("jerk", jerk)
        if (rate is None) == (n is None):
            raise InputError(f"sample(rate={rate}, n={n}): expected one of both: rate=1000 or n=200.")
        if rate is not None:
            per_second = number("rate", rate, "rows a second, above zero [1/s]", above=0.0)
            rows = np.ceil(self.duration * per_second * (1.0 - END_TOLERANCE))
            if not rows <= _MOST_ROWS:
                raise InputError(
                    f"`rate` is {per_second:g}, {rows:.3g} rows; expected at most {_MOST_ROWS:.0e}."
                )
            count = int(rows)
            t = np.append(np.arange(count) / per_second, self.duration)
        else:
            if not isinstance(n, (int, np.integer)) or n < 2:
                raise InputError(f"`n` is {n!r}; expected a count of at least 2 rows.")
            checked_count("n", n, 2, _MOST_ROWS)
            t = np.linspace(0.0, self.duration, int(n))
        parts = self._checked_at(t, 3 if with_jerk else 2)
        return SamplesWithJerk(t, *parts) if with_jerk else Samples(t, *parts)

    @property
    def start(self) -> Floats:
        """The first point."""
        return self(0.0)

    @property
    def end(self) -> Floats:
        """The last point."""
        return self(self.duration)

    def __add__(self, other: Trajectory) -> Trajectory:
        """This trajectory, then the other; see `concatenate`."""
        if not isinstance(other, Trajectory):
            return NotImplemented
        return _operations["concatenate"](self, other)

    @returns_copy("trajectory")
    def retimed(self, law: Trajectory) -> Trajectory:
        """The same path under another law of time: the point at `t` is this one's at `law(t)`.

        Args:
            law: A trajectory of one number that runs from 0 to this duration.
        """
        return _operations["retimed"](self, law)

    @returns_copy("trajectory")
    def with_duration(self, duration: float) -> Trajectory:
        """The same motion, evenly slowed down or sped up to last `duration` [s]."""
        return self._stretched(checked_duration("duration", duration) / self.duration)

    @returns_copy("trajectory")
    def slowed(self, factor: float) -> Trajectory:
        """The same motion, `factor` times as slow."""
        return self._stretched(number("factor", factor, "a factor above zero", above=0.0))

    @returns_copy("trajectory")
    def within(
        self,
        velocity: ArrayLike = np.inf,
        acceleration: ArrayLike = np.inf,
        jerk: ArrayLike = np.inf,
        samples: int = 1000,
    ) -> Trajectory:
        """The same motion, evenly stretched to be just within limits; it may become slower or faster.

        Args:
            velocity: Limits of speed, one or (nv,) [rad/s or m/s].
            acceleration: Limits of acceleration, one or (nv,) [rad/s^2 or m/s^2].
            jerk: Limits of jerk, one or (nv,) [rad/s^3 or m/s^3].
            samples: At how many times the motion is evaluated, at least, before it is refined near its peaks.

        Returns:
            The stretched trajectory.

        Raises:
            InputError: No limit is finite, or nothing moves.
        """
        bounds = {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}
        limits = [positive(name, x, self.space.n, infinite=True) for name, x in bounds.items()]
        order = 3 if np.isfinite(limits[2]).any() else 2
        peaks = self._peaks(samples, order)
        used = [float((peak / limit).max()) for peak, limit in zip(peaks, limits, strict=False)]
        factor = max(part ** (1.0 / power) for power, part in enumerate(used, start=1))
        if factor == 0.0:
            raise InputError("No limit is finite, or nothing moves; expected a finite limit and a motion.")
        return self._stretched(factor)

    def instants(self, samples: int) -> Floats:
        """Where peaks are searched for, sorted: `samples` even times, some between any two knots, and each knot with
        the moment before it.
        """
        knots = self.knots
        before = np.nextafter(knots[1:], 0.0)
        between = knots[:-1, None] + np.diff(knots)[:, None] * _BETWEEN
        even = np.linspace(0.0, self.duration, max(samples, 2))
        return np.sort(np.concatenate([even, between.reshape(-1), knots, before]))

    def _peaks(self, samples: int, order: int) -> list[Floats]:
        """Bounds (n,) of the absolute values of the derivatives from the first to `order`."""

        def sizes(t: Floats) -> Floats:
            rates = np.concatenate(self._checked_at(t, order)[1:], axis=1)
            return np.concatenate([rates, -rates], axis=1)

        rough = sizes(self.instants(2)).max(axis=0)
        peaks = greatest(
            sizes, self.knots, samples, _BOUND_TOLERANCE * np.maximum(rough, rough.max() * 1e-6)
        ).bound
        return list(peaks.reshape(2, order, -1).max(axis=0))

    @returns_copy("trajectory")
    def reversed(self) -> Trajectory:
        """The same path backwards: at `t` it is where this one is at `duration - t`.

        Example:
            >>> out = ulna.trajectory.quintic([0.0], [1.0], duration=2.0)
            >>> there_and_back = out + out.reversed()
            >>> there_and_back(4.0).round(6), there_and_back.duration
            (array([0.]), 4.0)
        """
        return self._stretched(-1.0)

    def plot(self, path: str | Path | None = None, samples: int = 500) -> Any:
        """Draws point, velocity and acceleration over time; see `ulna.trajectory.picture.plot`.

        Args:
            path: Name of a picture file to write; None writes nothing.
            samples: Number of times that are drawn.

        Returns:
            The Matplotlib figure.

        Example:
            >>> move = ulna.trajectory.quintic([0.0, 0.0], [1.0, 2.0], duration=2.0)
            >>> figure = move.plot("move.png")
            >>> [axes.get_ylabel() for axes in figure.axes]
            ['position [rad or m]', 'velocity [1/s]', 'acceleration [1/s^2]']
        """
        return _operations["plot"](self, path, samples)

    def save(self, path: str | Path, rate: float | None = None) -> None:
        """Writes a .npz or .csv file; see `ulna.trajectory.files.save`.

        Args:
            path: Name of the file; its ending says the format.
            rate: Rows a second of a .csv file [1/s].
        """
        _operations["save"](self, path, rate)

    def __repr__(self) -> str:
        what = (
            "a pose" if isinstance(self.space, Poses) else f"{self.space.n} joint{'s' * (self.space.n != 1)}"
        )
        count = len(self.knots) - 1
        return f"<{self.kind}: {what}, {self.duration:.6g} s, {count} segment{'s' * (count != 1)}>"

    def _stretched(self, factor: float) -> Trajectory:
        """Slower by `factor`; backwards when it is negative."""
        return _operations["evenly"](self, factor)

    def _derivative(self, t: ArrayLike, order: int) -> Floats:
        return self._evaluate(t, order)[order]

    def _evaluate(self, t: ArrayLike, order: int) -> tuple[Floats, ...]:
        times = finite_array("t", t)
        flat, duration = times.reshape(-1), self.duration
        if flat.size == 0 or (flat.min() >= 0.0 and flat.max() <= duration):
            rows = self._checked_at(flat, order)
        else:
            rows = self._checked_at(np.minimum(np.maximum(flat, 0.0), duration), order)
            still = np.maximum(-flat, flat - duration) > END_TOLERANCE * duration
            rows = (rows[0], *(np.where(still[:, None], 0.0, row) for row in rows[1:]))
        if times.ndim == 1:
            return rows
        return tuple(row.reshape(times.shape + row.shape[1:]) for row in rows)

    def _checked_at(self, t: Floats, order: int) -> tuple[Floats, ...]:
        if order > self.order:
            raise InputError(
                f"{self!r} has {self.order} derivatives and no jerk; polynomials of joints have it."
            )
        return self._at(t, order)
