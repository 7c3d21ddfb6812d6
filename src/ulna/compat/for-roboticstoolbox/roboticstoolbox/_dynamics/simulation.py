"""How a robot moves under torques: the integrators of scipy on the robot's accelerations."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Mapping
from typing import Any

import numpy as np

from roboticstoolbox._common.errors import UnknownKey, WrongType
from roboticstoolbox._common.numbers import number, numbers, vector
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.checks.arrays import check_finite
from ulna.checks.values import short_repr
from ulna.errors import InputError, MissingExtra, NonFiniteError
from ulna.typing import Floats

_FIND = "Look where it comes from."

fdyn = namedtuple("fdyn", ["t", "q", "qd"])


class ForwardSimulation(RobotMixin):
    """Motion under torques."""

    accel: Any

    def fdyn(
        self,
        T: float,
        q0: Any,
        Q: Any = None,
        Q_args: dict[str, Any] | None = None,
        qd0: Any = None,
        solver: str = "RK45",
        solver_args: dict[str, Any] | None = None,
        dt: float | None = None,
        progress: bool = False,
    ) -> fdyn:
        """The motion under torques, by an integrator of SciPy.

        Args:
            T: Duration [s]; below 0 the motion is followed back in time.
            q0: Configuration at the start, (n,) [rad or m].
            Q: Called as `Q(robot, t, q, qd, **Q_args)`; returns torques (n,) [N m or N]. None for no torques.
            Q_args: Keywords for `Q`.
            qd0: Velocity at the start, (n,) [rad/s or m/s]; None for rest.
            solver: "RK23", "RK45", "DOP853", "Radau", "BDF" or "LSODA".
            solver_args: Keywords for the solver.
            dt: Time between rows [s], with the sign of `T`; None for a row at each step of the solver.
            progress: Whether to print the time reached.

        Returns:
            Times `t` (m,) [s], `q` (m, n) [rad or m], `qd` (m, n) [rad/s or m/s].

        Raises:
            MissingExtra: SciPy is not installed.
            WrongType: `Q` is no function, or another argument is of a wrong type; a ValueError, too, which the toolbox
                raises.
            RuntimeError: The solver failed; says when.
            WrongShape: `q0`, `qd0` or the torques have another shape.
            NonFiniteError: nan or inf in one of them, in `T` or `dt`; nan in `solver_args`.
            InputError: `dt` is 0, or has not the sign of `T`.
            UnknownName: There is no such solver.
            UnknownKey: There is no such solver; an UnknownName, also of the class that the toolbox raises.
        """
        try:
            from scipy import integrate, interpolate
        except ImportError:
            raise MissingExtra("scipy", "toolbox", "fdyn") from None
        solvers = ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")
        if solver not in solvers:
            raise UnknownKey("solver", solver, solvers)
        if Q is not None and not callable(Q):
            raise WrongType(
                f"`Q` is {Q!r}; expected a function of the robot, t, q and qd, or None for no torques."
            )
        n, still, end = self.n, np.zeros(self.n), _time("T", T)
        arguments, options = _keywords("Q_args", Q_args), _keywords("solver_args", solver_args)
        _check_not_nan(options)
        even = None if dt is None else _even_times(end, _time("dt", dt))

        def rate(t: float, x: Floats) -> Floats:
            tau = still if Q is None else _vector("Q(...)", Q(self, t, x[:n], x[n:], **arguments), n)
            return np.concatenate([x[n:], self.accel(x[:n], x[n:], tau)])

        start = np.concatenate([_vector("q0", q0, n), still if qd0 is None else _vector("qd0", qd0, n)])
        stepper = getattr(integrate, solver)(rate, t0=0.0, y0=start, t_bound=end, **options)
        t, x = _all_steps(stepper, solver, end, progress)
        if even is not None:
            x, t = interpolate.interp1d(t, x, axis=0)(even), even
        return fdyn(t, x[:, :n], x[:, n:])


def _vector(name: str, value: Any, n: int) -> Floats:
    """The finite numbers of an argument, (n,)."""
    out = vector(name, value, n)
    check_finite(name, out, _FIND)
    return out


def _time(name: str, value: Any) -> float:
    out = number(name, value)
    check_finite(name, np.array(out), _FIND)
    return out


def _even_times(end: float, dt: float) -> Floats:
    """Times from 0, `dt` apart, before the end."""
    if dt == 0.0 or end * dt < 0.0:
        raise InputError(
            f"`dt` is {dt:g}; expected a time {'below' if end < 0.0 else 'above'} 0, as `T` = {end:g}."
        )
    return np.arange(0.0, end, dt)


def _keywords(name: str, value: Any) -> dict[str, Any]:
    if value is not None and not isinstance(value, Mapping):
        raise WrongType(f"`{name}` is {short_repr(value)}; expected a dict of keywords, or None.")
    return {} if value is None else dict(value)


def _check_not_nan(options: dict[str, Any]) -> None:
    """With nan for a tolerance or a step a solver would never end."""
    for name in ("rtol", "atol", "first_step", "min_step", "max_step"):
        if options.get(name) is not None and np.isnan(numbers(name, options[name])).any():
            raise NonFiniteError(f"solver_args[{name!r}]", (), np.nan, _FIND)


def _all_steps(stepper: Any, solver: str, T: float, progress: bool) -> tuple[Floats, Floats]:
    """Times (m,) and states (m, 2 n) of all steps of an integrator of SciPy."""
    times, states = [0.0], [stepper.y]
    while stepper.status == "running":
        message = stepper.step()
        if progress:
            print(f"\r{stepper.t:.4g} of {T:.4g} s", end="" if stepper.status == "running" else "\n")
        if stepper.status == "failed":
            raise RuntimeError(f"fdyn: {solver} failed at t = {stepper.t:.4g} s: {message}")
        times.append(stepper.t)
        states.append(stepper.y)
    return np.array(times), np.array(states)
