"""Sampled trajectories by the toolbox's names; the laws of motion are those of ulna.trajectory."""

from __future__ import annotations

import math
from collections import namedtuple
from collections.abc import Callable
from typing import Any

import numpy as np

from roboticstoolbox._plot.curves import plot_trajectory, xplot
from ulna import trajectory
from ulna.checks.arrays import number_or_array
from ulna.errors import InputError, ShapeError
from ulna.typing import Floats

mstraj_info = namedtuple("mstraj_info", ["slowest", "segtime", "clock"])


class Trajectory:
    """Positions, velocities and accelerations by rows, (m, n), or (m,) of one coordinate.

    Attributes:
        name: What made it.
        t: Times, (m,).
        q: Positions; also `s`.
        qd: Velocities; also `sd`.
        qdd: Accelerations; also `sdd`.
        istime: Whether `t` is in seconds rather than steps.
    """

    def __init__(
        self, name: str, t: Any, s: Any, sd: Any = None, sdd: Any = None, istime: bool = False
    ) -> None:
        """`s`, `sd` and `sdd` are positions, velocities and accelerations."""
        self.name, self.t, self.istime = name, np.asarray(t), istime
        self.s, self.sd, self.sdd = s, sd, sdd

    @property
    def q(self) -> Floats:
        """Positions."""
        return self.s

    @property
    def qd(self) -> Floats:
        """Velocities."""
        return self.sd

    @property
    def qdd(self) -> Floats:
        """Accelerations."""
        return self.sdd

    @property
    def naxes(self) -> int:
        """How many coordinates there are."""
        return 1 if self.s.ndim == 1 else self.s.shape[1]

    def __len__(self) -> int:
        return len(self.s)

    def __str__(self) -> str:
        return f"Trajectory created by {self.name}: {len(self)} time steps x {self.naxes} axes"

    __repr__ = __str__

    def plot(self, block: bool = False, plotargs: Any = None, textargs: Any = None) -> Any:
        """Draws positions, velocities and accelerations over time.

        Args:
            block: Whether to wait until the window is closed.
            plotargs: Options of matplotlib's `plot`, a dict.
            textargs: Options of the labels, a dict.

        Returns:
            The Matplotlib figure.
        """
        return plot_trajectory(self, block, plotargs, textargs)

    def qplot(self, **options: Any) -> Any:
        """Draws positions over time; see `xplot`."""
        return xplot(self.t, self.s, **options)


def _times(t: Any) -> tuple[Any, bool]:
    """Steps 0 ... t - 1 of a count, or the times given."""
    if isinstance(t, (int, np.integer)):
        if t < 2:
            raise InputError(f"`t` is {t}; expected at least 2 steps, or times.")
        return np.arange(t), False
    out = np.asarray(t, dtype=float)
    if out.ndim != 1 or out.size < 2:
        raise ShapeError("t", out.shape, "a count, or times (m,)")
    return out, True


def jtraj(q0: Any, qf: Any, t: Any, qd0: Any = None, qd1: Any = None) -> Trajectory:
    """A quintic from one configuration to another.

    Args:
        q0: Start, (n,).
        qf: End, (n,).
        t: Times [s]; or how many points: then velocities are per duration of the whole, as those of the toolbox.
        qd0: Velocity at the start, (n,); zero by default.
        qd1: Velocity at the end, (n,); zero by default.

    Returns:
        Positions, velocities and accelerations, (m, n) each.

    Raises:
        InputError: A time is below 0.
    """
    rows, is_time = _times(t)
    if is_time and rows.min() < 0.0:
        raise InputError(
            f"`t` begins at {rows.min()}; expected times from 0 on: jtraj counts them from its start."
        )
    duration = float(rows.max()) if is_time else 1.0
    at = rows if is_time else rows / (len(rows) - 1)
    q, v, a = trajectory.quintic_states(q0, qf, duration, at, qd0, qd1)
    return Trajectory("jtraj", rows if is_time else at * float(t), q, v, a, istime=True)


def quintic_func(q0: float, qf: float, T: float, qd0: float = 0, qdf: float = 0) -> Callable[[Any], Any]:
    """A quintic of one coordinate as a function of time.

    Args:
        q0: Start [any].
        qf: End [any].
        T: Duration [s].
        qd0: Velocity at the start [any].
        qdf: Velocity at the end [any].

    Returns:
        Function of times (m,) that returns position, velocity, acceleration.
    """
    return _function(trajectory.quintic(float(q0), float(qf), float(T), float(qd0), float(qdf)))


def trapezoidal_func(q0: float, qf: float, T: float, V: float | None = None) -> Callable[[Any], Any]:
    """A trapezoid of speed of one coordinate as a function of time.

    Args:
        q0: Start [any].
        qf: End [any].
        T: Duration [s].
        V: Cruising speed [any]; None for half as fast again as the mean speed.

    Returns:
        Function of times (m,) that returns position, velocity, acceleration.
    """
    return _function(_trapezoid(q0, qf, T, V))


def _trapezoid(q0: float, qf: float, T: float, V: float | None) -> Any:
    speed = None if V is None else abs(float(V))
    return trajectory.trapezoidal(float(q0), float(qf), duration=float(T), velocity=speed)


def _function(law: Any) -> Callable[[Any], Any]:
    def at(t: Any) -> Any:
        rows = [x[..., 0] for x in law.state(np.asarray(t, dtype=float))]
        return tuple(map(float, rows)) if np.ndim(t) == 0 else tuple(rows)

    return at


def _one(name: str, make: Callable[[float], Any], t: Any) -> Trajectory:
    """A law of one coordinate from the first time to the last."""
    rows, is_time = _times(t)
    elapsed = rows - rows[0]
    s, sd, sdd = (x[:, 0] for x in make(float(elapsed[-1])).state(elapsed))
    return Trajectory(name, rows, s, sd, sdd, istime=is_time)


def quintic(q0: float, qf: float, t: Any, qd0: float = 0, qdf: float = 0) -> Trajectory:
    """A quintic of one coordinate, at times, or at steps one second apart.

    Args:
        q0: Start [any].
        qf: End [any].
        t: Times (m,) [s], or the number of steps one second apart.
        qd0: Velocity at the start [any].
        qdf: Velocity at the end [any].

    Returns:
        Position, velocity and acceleration, (m,) each.
    """
    return _one("quintic", lambda T: trajectory.quintic(float(q0), float(qf), T, float(qd0), float(qdf)), t)


def trapezoidal(q0: float, qf: float, t: Any, V: float | None = None) -> Trajectory:
    """A trapezoid of speed of one coordinate.

    Args:
        q0: Start [any].
        qf: End [any].
        t: Times (m,) [s], or the number of steps one second apart.
        V: Cruising speed [any]; None for half as fast again as the mean speed.

    Returns:
        Position, velocity and acceleration, (m,) each.
    """
    return _one("trapezoidal", lambda T: _trapezoid(q0, qf, T, V), t)


lspb = trapezoidal


def mtraj(tfunc: Callable[..., Trajectory], q0: Any, qf: Any, t: Any) -> Trajectory:
    """A law of one coordinate for each coordinate.

    Args:
        tfunc: `quintic` or `trapezoidal`.
        q0: Start, (n,).
        qf: End, (n,).
        t: Times (m,) [s], or the number of steps one second apart.

    Returns:
        Positions, velocities and accelerations, (m, n) each.

    Raises:
        ShapeError: `qf` has another shape than `q0`.
    """
    start, end = np.ravel(np.asarray(q0, dtype=float)), np.ravel(np.asarray(qf, dtype=float))
    if start.shape != end.shape:
        raise ShapeError("qf", end.shape, f"({start.size},), like q0")
    laws = [tfunc(a, b, t) for a, b in zip(start, end, strict=True)]
    s, sd, sdd = (np.column_stack([getattr(law, k) for law in laws]) for k in ("s", "sd", "sdd"))
    return Trajectory("mtraj", laws[0].t, s, sd, sdd, istime=laws[0].istime)


def ctraj(T0: Any, T1: Any, t: Any = None, s: Any = None) -> Any:
    """Poses on the straight line from one to another, turning evenly, as one SE3.

    Args:
        T0: Start, an SE3 or (4, 4).
        T1: End, an SE3 or (4, 4).
        t: How many, or times; the path parameter follows a trapezoid of speed.
        s: The path parameter instead, from 0 to 1, (m,).

    Returns:
        Poses as one SE3 of m elements.

    Raises:
        InputError: Both `t` and `s`, or neither.
    """
    from roboticstoolbox._common.poses import matrix, pose
    from ulna.spatial import SE3

    if (t is None) == (s is None):
        raise InputError("ctraj takes `t` or `s`, one of them.")
    path = np.asarray(s, dtype=float) if s is not None else _path(t)
    start, end = SE3.from_matrix(matrix(T0)), SE3.from_matrix(matrix(T1))
    return pose(start.interpolate(end, path, straight=True).matrix())


def _path(t: Any) -> Floats:
    """The path parameter at steps, or at times as fractions of the last one."""
    rows, is_time = _times(t)
    if not is_time:
        return trapezoidal(0.0, 1.0, t).s
    return _trapezoid(0.0, 1.0, 1.0, None).state(rows / rows.max())[0][:, 0]


def mstraj(
    viapoints: Any,
    dt: float,
    tacc: Any,
    qdmax: Any = None,
    tsegment: Any = None,
    q0: Any = None,
    qd0: Any = None,
    qdf: Any = None,
    verbose: bool = False,
) -> Trajectory:
    """Straight from point to point, corners cut by quintic blends of `tacc` seconds, sampled every `dt`.

    Args:
        viapoints: Points by rows, (k, n); the first is the start unless `q0` is given.
        dt: Time between rows [s].
        tacc: Time of a blend [s], one for all or one for each segment; with 0 velocities jump at the points.
        qdmax: Greatest speeds, one or (n,).
        tsegment: Times of segments instead, (k - 1,) [s].
        q0: Start, (n,).
        qd0: Velocity at the start, (n,).
        qdf: Velocity at the end, (n,).
        verbose: Whether to print each segment.

    Returns:
        Positions, (m, n).

    Raises:
        InputError: Both `qdmax` and `tsegment`, or neither, or times that do not fit.
    """
    points = np.atleast_2d(np.asarray(viapoints, dtype=float))
    if q0 is not None:
        points = np.vstack([np.asarray(q0, dtype=float), points])
    if (qdmax is None) == (tsegment is None):
        raise InputError("mstraj takes `qdmax` or `tsegment`, one of them.")
    segments, n = len(points) - 1, points.shape[1]
    blends = np.ceil(number_or_array("tacc", tacc, segments) / dt - 1e-9) * dt
    v = number_or_array("qd0", 0.0 if qd0 is None else qd0, n)
    p, clock, half, duration = points[0], 0.0, 0.0, 0.0
    rows: list[Any] = []
    arrive, info = np.zeros(segments), []
    for k, (a, b, blend) in enumerate(zip(points, points[1:], blends, strict=False)):
        half = math.ceil(blend / 2 / dt - 1e-9) * dt
        corner = half if k == 0 else blend
        slowest: float = math.nan
        if tsegment is None:
            needed = corner + np.ceil(np.abs(b - a) / number_or_array("qdmax", qdmax, n) / dt - 1e-9) * dt
            slowest, duration = int(needed.argmax()), max(float(needed.max()), 2 * blend)
        else:
            duration = float(number_or_array("tsegment", tsegment, segments)[k])
        info.append(mstraj_info(slowest, duration, clock))
        arrive[k] = clock + duration + (half if k else 0.0)
        rate = (b - a) / duration
        if verbose:
            print(f"segment {k}: from {a} to {b} in {duration:.6g} s, slowest axis {slowest}")
        rows += _corner(p, v, a + half * rate, rate, corner, dt)
        line = np.arange(round(half / dt) + 1, round((duration - half) / dt) + 1) * dt
        rows += [(a + t * rate, rate, np.zeros(n)) for t in line]
        p, v = rows[-1][0] if rows else a, rate
        clock += corner + dt * len(line)
    rows += _corner(p, v, points[-1], number_or_array("qdf", 0.0 if qdf is None else qdf, n), half, dt)
    q, rates, rises = (np.array(part) for part in zip(*rows, strict=True))
    out: Any = Trajectory("mstraj", dt * np.arange(len(q)), q, rates, rises, istime=True)
    out.arrive, out.via = arrive, points[1:]
    out.info = [*info, mstraj_info(None, duration, clock)]
    return out


def _corner(a: Floats, v: Floats, b: Floats, w: Floats, duration: float, dt: float) -> list[Any]:
    """Rows of the quintic from `a` at the velocity `v` to `b` at `w`, without the first."""
    at = np.arange(1, round(duration / dt) + 1) * dt
    return list(zip(*trajectory.quintic_states(a, b, duration, at, v, w), strict=True)) if at.size else []
