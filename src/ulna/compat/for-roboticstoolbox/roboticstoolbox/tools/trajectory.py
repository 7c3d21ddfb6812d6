"""Sampled trajectories by the toolbox's names; the laws of motion are those of ulna.trajectory."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np

from roboticstoolbox._common.errors import UnknownOption, WrongShape, WrongType
from roboticstoolbox._common.numbers import number
from roboticstoolbox._plot.curves import xplot
from roboticstoolbox.tools.sampled import Trajectory
from roboticstoolbox.tools.via_points import mstraj
from ulna import trajectory
from ulna.errors import InputError, ShapeError
from ulna.typing import Floats


def _times(t: Any, least: int = 2) -> tuple[Any, bool]:
    """Steps 0 ... t - 1 of a count of at least `least`, or the times given."""
    if isinstance(t, (int, np.integer)):
        if t < least:
            raise InputError(f"`t` is {t}; expected at least {least} steps, or times.")
        return np.arange(t), False
    try:
        out = np.asarray(t, dtype=float)
    except (TypeError, ValueError):
        raise WrongType(f"`t` is {t!r}; expected a count, or times (m,).") from None
    if out.ndim != 1 or out.size < 2:
        raise WrongShape("t", out.shape, "a count, or times (m,)")
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
    rows, is_time = _times(t, 1)
    if is_time and rows.min() < 0.0:
        raise InputError(
            f"`t` begins at {rows.min()}; expected times from 0 on: jtraj counts them from its start."
        )
    duration = float(rows.max()) if is_time else 1.0
    at = rows if is_time else rows / max(len(rows) - 1, 1)
    q, v, a = trajectory.quintic_states(q0, qf, duration, at, qd0, qd1)
    return Trajectory("jtraj", rows if is_time else at * float(t), q, v, a, istime=True)


def quintic_func(
    q0: float, qf: float, T: float, qd0: float = 0, qdf: float = 0, method: str = "lstsq"
) -> Callable[[Any], Any]:
    """A quintic of one coordinate as a function of time.

    Args:
        q0: Start [any].
        qf: End [any].
        T: Duration [s].
        qd0: Velocity at the start [any].
        qdf: Velocity at the end [any].
        method: "lstsq" or "hermite": two ways to compute the coefficients, which have the same values here.

    Returns:
        Function of times (m,) that returns position, velocity, acceleration.

    Raises:
        UnknownOption: There is no such method.
    """
    if method not in ("lstsq", "hermite"):
        raise UnknownOption("method", method, ("lstsq", "hermite"))
    ends = [_scalar(name, x) for name, x in (("q0", q0), ("qf", qf), ("qd0", qd0), ("qdf", qdf))]
    return _function(trajectory.quintic(ends[0], ends[1], float(T), ends[2], ends[3]))


def _scalar(name: str, value: Any) -> float:
    if np.ndim(value):
        raise WrongShape(name, np.shape(value), "a number; mtraj takes several coordinates")
    return number(name, value)


@final
class TrapezoidalProfile:
    """A trapezoid of speed as a function of time.

    Attributes:
        tb: Duration of a blend [s]; infinite without motion.
        V: Cruising speed, negative where the coordinate decreases.
    """

    def __init__(self, q0: float, qf: float, T: float, V: float | None = None) -> None:
        """A profile of one coordinate; see `trapezoidal_func`.

        Args:
            q0: Start [any].
            qf: End [any].
            T: Duration [s].
            V: Cruising speed [any]; None for half as fast again as the mean speed.
        """
        q0, qf = _scalar("q0", q0), _scalar("qf", qf)
        self._law = _function(_trapezoid(q0, qf, T, V))
        speed = abs(qf - q0) / T * 1.5 if V is None else abs(float(V))
        self.V = math.copysign(speed, qf - q0) if qf != q0 else 0.0
        self.tb = (q0 - qf + self.V * T) / self.V if self.V else math.inf

    def __call__(self, t: Any) -> Any:
        """Position, velocity and acceleration at times, a number or (m,) [s]."""
        return self._law(t)


def trapezoidal_func(q0: float, qf: float, T: float, V: float | None = None) -> TrapezoidalProfile:
    """A trapezoid of speed of one coordinate as a function of time.

    Args:
        q0: Start [any].
        qf: End [any].
        T: Duration [s].
        V: Cruising speed [any]; None for half as fast again as the mean speed.

    Returns:
        Function of times (m,) that returns position, velocity, acceleration; its `tb` is the duration of a blend,
        its `V` the cruising speed.
    """
    return TrapezoidalProfile(q0, qf, T, V)


def _trapezoid(q0: float, qf: float, T: float, V: float | None) -> Any:
    speed = None if V is None else abs(float(V))
    return trajectory.trapezoidal(float(q0), float(qf), duration=float(T), velocity=speed)


def _function(law: Any) -> Callable[[Any], Any]:
    def at(t: Any) -> Any:
        return tuple(x[..., 0][()] + 0.0 for x in law.state(np.asarray(t, dtype=float)))

    return at


def _one(name: str, make: Callable[[float], Any], t: Any, speeds: Sequence[float]) -> Trajectory:
    """A law of one coordinate from the first time to the last, where its speeds are `speeds` without rounding."""
    rows, is_time = _times(t)
    elapsed = rows - rows[0]
    s, sd, sdd = (x[:, 0] + 0.0 for x in make(float(elapsed[-1])).state(elapsed))
    sd[[0, -1]] = speeds
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
    start, end, *speeds = (_scalar(n, x) for n, x in (("q0", q0), ("qf", qf), ("qd0", qd0), ("qdf", qdf)))
    return _one("quintic", lambda T: trajectory.quintic(start, end, T, *speeds), t, speeds)


def trapezoidal(q0: float, qf: float, t: Any, V: float | None = None) -> Trajectory:
    """A trapezoid of speed of one coordinate.

    Args:
        q0: Start [any].
        qf: End [any].
        t: Times (m,) [s], or the number of steps one second apart.
        V: Cruising speed [any]; None for half as fast again as the mean speed.

    Returns:
        Position, velocity and acceleration, (m,) each; `tblend` is the duration of a blend [s].
    """
    out: Any = _one("trapezoidal", lambda T: _trapezoid(q0, qf, T, V), t, (0.0, 0.0))
    out.tblend = TrapezoidalProfile(q0, qf, float(out.t[-1] - out.t[0]), V).tb
    return out


def lspb(*arguments: Any, **options: Any) -> Trajectory:
    """The former name of `trapezoidal`.

    Args:
        *arguments, **options: As for `trapezoidal`.

    Returns:
        The trajectory.
    """
    warnings.warn("lspb is the former name of trapezoidal", FutureWarning, stacklevel=2)
    return trapezoidal(*arguments, **options)


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
        WrongType: Both `t` and `s`, or neither.
    """
    from roboticstoolbox._common.poses import matrix, pose
    from ulna.spatial import SE3

    if (t is None) == (s is None):
        raise WrongType("ctraj takes `t` or `s`, one of them.")
    path = np.asarray(s, dtype=float) if s is not None else _path(t)
    start, end = SE3.from_matrix(matrix(T0)), SE3.from_matrix(matrix(T1))
    return pose(start.interpolate(end, path, straight=True).matrix())


def _path(t: Any) -> Floats:
    """The path parameter at steps, or at times as fractions of the last one."""
    rows, is_time = _times(t)
    if not is_time:
        return trapezoidal(0.0, 1.0, t).s
    return _trapezoid(0.0, 1.0, 1.0, None).state(rows / rows.max())[0][:, 0]


__all__ = [
    "Trajectory", "TrapezoidalProfile", "ctraj", "jtraj", "lspb", "mstraj", "mtraj", "quintic", "quintic_func",
    "trapezoidal", "trapezoidal_func", "xplot",
]  # fmt: skip
