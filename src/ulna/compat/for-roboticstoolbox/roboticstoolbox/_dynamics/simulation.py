"""How a robot moves under torques: the integrators of scipy on the robot's accelerations."""

from __future__ import annotations

from collections import namedtuple
from typing import Any

import numpy as np

from roboticstoolbox._common.errors import UnknownKey, WrongType
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.errors import MissingExtra, ShapeError
from ulna.typing import Floats

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
            T: Duration [s].
            q0: Configuration at the start, (n,) [rad or m].
            Q: Called as `Q(robot, t, q, qd, **Q_args)`; returns torques (n,) [N m or N]. None for no torques.
            Q_args: Keywords for `Q`.
            qd0: Velocity at the start, (n,) [rad/s or m/s]; None for rest.
            solver: "RK23", "RK45", "DOP853", "Radau", "BDF" or "LSODA".
            solver_args: Keywords for the solver.
            dt: Time between rows [s]; None for a row at each step of the solver.
            progress: Whether to print the time reached.

        Returns:
            Times `t` (m,) [s], `q` (m, n) [rad or m], `qd` (m, n) [rad/s or m/s].

        Raises:
            MissingExtra: SciPy is not installed.
            WrongType: `Q` is no function; a ValueError, too, which the toolbox raises.
            RuntimeError: The solver failed; says when.
            ShapeError: `q0` has another shape.
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
        still, arguments, n = np.zeros(self.n), Q_args or {}, self.n

        def rate(t: float, x: Floats) -> Floats:
            tau = still if Q is None else np.asarray(Q(self, t, x[:n], x[n:], **arguments), dtype=float)
            return np.concatenate([x[n:], self.accel(x[:n], x[n:], tau)])

        start = _state(q0, qd0, n)
        stepper = getattr(integrate, solver)(rate, t0=0.0, y0=start, t_bound=T, **(solver_args or {}))
        t, x = _all_steps(stepper, solver, T, progress)
        if dt is not None:
            even = np.arange(0.0, T, dt)
            x, t = interpolate.interp1d(t, x, axis=0)(even), even
        return fdyn(t, x[:, :n], x[:, n:])


def _state(q0: Any, qd0: Any, n: int) -> Floats:
    """Configuration and velocity at the start, one after the other, (2 n,); at rest where there is no velocity."""
    q = np.asarray(q0, dtype=float)
    if q.shape != (n,):
        raise ShapeError("q0", q.shape, f"({n},)")
    return np.concatenate([q, np.zeros(n) if qd0 is None else np.asarray(qd0, dtype=float)])


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
