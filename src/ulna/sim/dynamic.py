"""A robot under torques and gravity: its motion in time, on the space of its configurations.

| symbol | meaning | shape | unit |
|---|---|---|---|
| q, v | configuration and velocity | (nq), (nv) | [rad] or [m], per s |
| u | tangent vector at the start of a step: q = q0 (+) u | (nv) | [rad] or [m] |
| Jr | right Jacobian of the groups: du/dt = Jr(u)^-1 v | (nv, nv) | [1] |

Three ways to step, all of which keep quaternions on their sphere:

- "euler": semi-implicit. The velocity first, then the configuration with the new velocity. Of first order, also in the
  energy; friction is implicit and dry friction exact, at any step.
- "rk4": the classical method of Runge and Kutta in the form of Munthe-Kaas, of fourth order; friction is smooth within
  its width, which bounds the step.
- "adaptive": SciPy's solvers, with the error bounded and the step chosen; friction is smooth.

Sources: Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), sections I.1 and IV.8.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, Literal, final

import numpy as np

from ulna import algorithms
from ulna.algorithms.constraints.dry_friction import velocity_after_friction
from ulna.algorithms.dynamics.forward_dynamics import forward_dynamics
from ulna.algorithms.dynamics.inverse_mass_matrix import inverse_mass_matrix
from ulna.algorithms.dynamics.joint_friction import Friction
from ulna.checks.arrays import shaped_array
from ulna.checks.values import checked_robot, number, one_of, short_repr, step_count
from ulna.checks.values import count as checked_count
from ulna.checks.values import duration as checked_duration
from ulna.errors import InputError, MissingExtra, UnknownName
from ulna.model import Constraint
from ulna.model.constraint import listed
from ulna.model.joints.base import VectorKind
from ulna.robot import Robot, compile
from ulna.sim.recording import Recording
from ulna.typing import ArrayLike, Floats

Torque = Callable[[float, Floats, Floats], ArrayLike]
"""Joint torques (nv,) at a time, a configuration and a velocity."""

Method = Literal["euler", "rk4", "adaptive"]
_METHODS = ("euler", "rk4", "adaptive")
_SOLVERS = ("RK45", "RK23", "DOP853", "Radau", "BDF", "LSODA")
_ERROR = "an error above zero, at most 1"
_MOST_STEPS = 10**8  # more do not fit


@final
class Plant:
    """A robot that moves as its masses, its friction and its torques have it.

    Args:
        robot: The robot.
        friction: The friction of its joints: "model" for the damping and friction its model names, None for none, or
            a law of `ulna.algorithms.Friction`.
        bound: The accelerations under q, v and tau of a robot that constraints bind; None for a free one. Friction of a
            bound robot is smooth, also in "euler".

    Raises:
        ShapeError: The friction is that of another robot.
    """

    def __init__(
        self,
        robot: Robot,
        friction: Friction | Literal["model"] | None = "model",
        bound: Callable[[Floats, Floats, Floats], Floats] | None = None,
    ) -> None:
        check_friction(friction)
        checked_robot(robot)
        law = Friction.of(robot.model) if isinstance(friction, str) else friction
        self.robot = robot
        self.friction = law if law is not None and (law.is_dry or law.is_viscous) else None
        if self.friction is not None:
            self.friction.numbers(robot.nv)
        joints = [j for j in robot.model.joints if j.mimic is None]
        self._is_vector_space = all(_is_vector_joint(j.kind) for j in joints)
        self._is_bound = bound is not None
        self._acceleration = bound or compile(self._forward_dynamics, robot)
        self._integrate = robot.kernel("integrate")
        self._kernels: dict[str, Any] = {}

    def acceleration(self, q: Floats, v: Floats, tau: Floats) -> Floats:
        """Accelerations (nv,) [rad/s^2, m/s^2] under torques `tau` and smooth friction."""
        if self.friction is not None:
            tau = tau + self._friction_torque(v)
        return self._acceleration(q, v, tau)

    def euler(self, q: Floats, v: Floats, tau: Floats, dt: float) -> tuple[Floats, Floats]:
        """Configuration and velocity after a semi-implicit step of `dt` [s], with exact friction."""
        if self._is_bound:
            free = v + dt * self.acceleration(q, v, tau)
            return self._integrate(q, dt * free), free
        free = v + dt * self._acceleration(q, v, tau)
        if self.friction is not None:
            free = self._velocity_after_friction(self._inverse_mass(q), free, v, dt)
        return self._integrate(q, dt * free), free

    def rk4(self, q: Floats, v: Floats, torque: Torque, t: float, dt: float) -> tuple[Floats, Floats]:
        """Configuration and velocity after a step of `dt` [s] of fourth order; asks for torques four times."""
        rates = [self._rates(q, np.zeros_like(v), v, torque, t)]
        for part in (0.5, 0.5, 1.0):
            du, dv = rates[-1]
            rates.append(self._rates(q, part * dt * du, v + part * dt * dv, torque, t + part * dt))
        (a, b), (c, d), (e, f), (g, h) = rates
        u = dt / 6.0 * (a + 2.0 * (c + e) + g)
        return self._integrate(q, u), v + dt / 6.0 * (b + 2.0 * (d + f) + h)

    def longest_step(self, q: Floats) -> float:
        """The longest step [s] for which smooth friction does not make "rk4" unstable at `q`; inf without friction."""
        if self.friction is None:
            return np.inf
        viscous, forward, backward = self.friction.numbers(self.robot.nv)
        dry = np.maximum(forward, backward)
        if self.friction.static is not None:
            dry = np.maximum(dry, self.friction.static)
        slope = viscous + dry / self.friction.width
        root = np.sqrt(slope)
        fastest = np.linalg.eigvalsh(root[:, None] * self._inverse_mass(q) * root)[-1]
        return 2.7 / fastest if fastest > 0.0 else np.inf

    def _rates(self, q0: Floats, u: Floats, v: Floats, torque: Torque, t: float) -> tuple[Floats, Floats]:
        """du/dt and dv/dt at q0 (+) u."""
        q = self._integrate(q0, u)
        tau = _torques(torque(t, q, v), self.robot.nv)
        return (v if self._is_vector_space else self._tangent(u, v)), self.acceleration(q, v, tau)

    def _forward_dynamics(self, q: Any, v: Any, tau: Any) -> Any:
        return forward_dynamics(self.robot.model, q, v, tau)

    def _kernel(self, name: str, make: Callable[[], Any]) -> Any:
        if name not in self._kernels:
            self._kernels[name] = make()
        return self._kernels[name]

    def _inverse_mass(self, q: Floats) -> Floats:
        model = self.robot.model
        return self._kernel("mass", lambda: compile(lambda q: inverse_mass_matrix(model, q), self.robot))(q)

    def _friction_torque(self, v: Floats) -> Floats:
        law = self.friction
        assert law is not None
        return self._kernel("rub", lambda: compile(law.torque, self.robot))(v)

    def _velocity_after_friction(self, G: Floats, free: Floats, v: Floats, dt: float) -> Floats:
        law, n = self.friction, self.robot.nv
        assert law is not None

        def make() -> Any:
            def settle(G: Any, u: Any, v: Any, h: Any) -> Any:
                return velocity_after_friction(G, u, v, h, law)

            return compile(settle, G=(n, n), u=(n,), v=(n,), h=())

        return self._kernel("settle", make)(G, free, v, dt)

    def _tangent(self, u: Floats, v: Floats) -> Floats:
        model = self.robot.model

        def make() -> Any:
            def tangent(u: Any, v: Any) -> Any:
                base = np.array(model.neutral)
                moved = algorithms.integrate(model, base, u)
                return algorithms.difference_derivatives(model, base, moved)[1] @ v

            return compile(tangent, self.robot, u=(self.robot.nv,))

        return self._kernel("tangent", make)(u, v)


def check_friction(friction: Friction | Literal["model"] | None) -> None:
    """Refuse what is no friction.

    Raises:
        UnknownName: It is none.
    """
    if isinstance(friction, str) and friction == "model":
        return
    if not (friction is None or isinstance(friction, Friction)):
        given = friction if isinstance(friction, str) else short_repr(friction)
        raise UnknownName("friction", given, ("model",), "Give 'model', None or a Friction.")


def dynamic_step(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    dt: float,
    friction: Friction | Literal["model"] | None = "model",
) -> tuple[Floats, Floats]:
    """Configuration and velocity after a short time under constant torques, by the semi-implicit step.

    Args:
        robot: The robot.
        q: Configuration, shape (nq,).
        v: Velocity, shape (nv,) [rad/s or m/s].
        tau: Torques of the drives, shape (nv,) [N m or N].
        dt: Duration [s].
        friction: As for `Plant`.

    Raises:
        ShapeError, NonFiniteError: An array does not fit the robot.
        InputError: `dt` is not above zero.
    """
    checked_robot(robot)
    check_friction(friction)
    q, v = shaped_array("q", q, robot.nq), shaped_array("v", v, robot.nv)
    return _plant(robot, friction).euler(q, v, _torques(tau, robot.nv), checked_duration("dt", dt))


def simulate(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike | None = None,
    torque: Torque | ArrayLike | None = None,
    *,
    duration: float,
    dt: float = 1e-3,
    method: Method = "euler",
    friction: Friction | Literal["model"] | None = "model",
    constraints: Sequence[Constraint] | Constraint = (),
    kp: float = 100.0,
    every: int = 1,
    solver: str | None = None,
    rtol: float = 1e-8,
    atol: float = 1e-10,
) -> Recording:
    """The motion of a robot from a state, under torques, gravity and friction. Position limits do not stop it.

    Args:
        robot: The robot.
        q: Configuration at the start, shape (nq,).
        v: Velocity at the start, shape (nv,) [rad/s or m/s]; None for rest.
        torque: Function of time, configuration and velocity that gives the torques of the drives (nv,) [N m or N];
            or constant torques; None for none. "euler" asks it once a step; "rk4" and "adaptive" also in between and
            out of order, so there it must have no memory.
        duration: How long [s].
        dt: Step [s]; for "adaptive" the time between rows of the recording.
        method: "euler", "rk4" or "adaptive".
        friction: As for `Plant`; smooth when there are constraints.
        constraints: Contacts and loops that bind the robot; contacts hold where they are at the start.
        kp: Gain [1/s^2] that pulls constraints together again, critically damped.
        every: Records each of so many steps; the start and the end are recorded anyway.
        solver: For "adaptive": a method of `scipy.integrate.solve_ivp`; None for "LSODA" with friction, which bends
            its way around stiffness, and "DOP853" without.
        rtol: Relative error per step, for "adaptive".
        atol: Absolute error per step, for "adaptive".

    Returns:
        A recording with columns t, q, v and tau.

    Raises:
        ShapeError, NonFiniteError: An array does not fit the robot, or the motion grew beyond all bounds.
        InputError: `dt`, `duration` or `every` is out of range; or the step is too long for "rk4" with this friction.
        UnknownName: There is no such method.
        MissingExtra: "adaptive" without SciPy.
    """
    model = checked_robot(robot).model
    one_of("method", method, _METHODS)
    kp = number("kp", kp, "a gain that is not below zero [1/s^2]", least=0.0)
    check_friction(friction)
    start, speed = (
        shaped_array("q", q, model.nq),
        np.zeros(model.nv) if v is None else shaped_array("v", v, model.nv),
    )
    law = _torque_law(torque, model.nv)
    bound = not (isinstance(constraints, tuple | list) and not constraints)
    plant = (
        Plant(robot, friction, _constrained_acceleration(robot, start, constraints, kp))
        if bound
        else _plant(robot, friction)
    )
    duration, count = step_count(duration, dt, _MOST_STEPS)
    every = checked_count("every", every)
    times = np.linspace(0.0, duration, count + 1)
    if method == "adaptive":
        return _adaptive(
            plant, start, speed, law, times[[*range(0, count, every), count]], solver, rtol, atol
        )
    step = duration / count
    if method == "rk4" and step > plant.longest_step(start):
        raise InputError(
            f"A step of {step:g} s is too long for friction within a width of {plant.friction.width:g}: 'rk4' is "  # type: ignore[union-attr]
            f"stable up to {plant.longest_step(start):.2g} s. Use method='euler', whose friction takes any step, or "
            "'adaptive'; or widen the friction."
        )
    recording = Recording()
    q, v = start, speed
    for k in range(count):
        t = float(times[k])
        tau = _torques(law(t, q, v), model.nv)
        if k % every == 0:
            recording.add(t, q, v=v, tau=tau)
        q, v = plant.euler(q, v, tau, step) if method == "euler" else plant.rk4(q, v, law, t, step)
        if not np.isfinite(v).all():
            raise _divergence_error(float(times[k + 1]), v)
    recording.add(duration, q, v=v, tau=_torques(law(duration, q, v), model.nv))
    return recording


def _adaptive(
    plant: Plant,
    q: Floats,
    v: Floats,
    law: Torque,
    times: Floats,
    solver: str | None,
    rtol: float,
    atol: float,
) -> Recording:
    """Steps u and v from a base that follows, where rotations make the tangent space bend."""
    try:
        from scipy.integrate import solve_ivp
    except ImportError:
        raise MissingExtra("scipy", "ode", "An adaptive solver") from None
    n = plant.robot.nv
    usual = "LSODA" if plant.friction is not None else "DOP853"
    method = usual if solver is None else one_of("solver", solver, _SOLVERS)
    rtol, atol = (number(n, e, _ERROR, above=0.0, most=1.0) for n, e in (("rtol", rtol), ("atol", atol)))

    def far(t: float, y: Floats) -> float:
        return float(np.abs(y[:n]).max(initial=0.0)) - 1.5

    far.terminal = True  # type: ignore[attr-defined]
    recording = Recording()
    recording.add(times[0], q, v=v, tau=_torques(law(float(times[0]), q, v), n))
    t, row = float(times[0]), 1
    while row < len(times):
        base = q

        def rates(t: float, y: Floats, base: Floats = base) -> Floats:
            return np.concatenate(plant._rates(base, y[:n], y[n:], law, t))

        found = solve_ivp(
            rates,
            (t, float(times[-1])),
            np.concatenate([np.zeros(n), v]),
            method=method,
            t_eval=times[row:],
            events=None if plant._is_vector_space else far,
            rtol=rtol,
            atol=atol,
        )
        if found.status < 0 or not np.isfinite(np.asarray(found.y)).all():
            raise InputError(
                f"The solver gave up at t = {found.t[-1] if len(found.t) else t:g} s: {found.message}"
            )
        for at, y in zip(found.t, np.asarray(found.y).T, strict=True):
            here, speed = plant._integrate(base, y[:n].copy()), y[n:].copy()
            recording.add(at, here, v=speed, tau=_torques(law(float(at), here, speed), n))
        row += len(found.t)
        if found.status == 1:
            t, y = float(found.t_events[0][0]), found.y_events[0][0]
            q, v = plant._integrate(base, y[:n].copy()), y[n:].copy()
    return recording


@lru_cache(maxsize=32)
def _plant(robot: Robot, friction: Friction | Literal["model"] | None) -> Plant:
    return Plant(robot, friction)


def _constrained_acceleration(
    robot: Robot, q: Floats, constraints: Sequence[Constraint] | Constraint, kp: float
) -> Callable[[Floats, Floats, Floats], Floats]:
    """The accelerations of the robot under constraints that hold where they are at `q`."""
    bonds = listed(constraints)
    kernel = robot.kernel("constrained_dynamics", constraints=bonds, stabilised=True)
    held = any(constraint.is_contact for constraint in bonds)
    anchors = (robot.constraint_anchors(q, bonds),) if held else ()
    gains = np.tile([kp, 2.0 * np.sqrt(kp)], (len(bonds), 1))
    return lambda q, v, tau: kernel(q, v, tau, *anchors, gains)[0]


def _is_vector_joint(kind: Any) -> bool:
    """Whether integrating adds, so that u is q - q0."""
    return kind.nq == 1 or isinstance(kind, VectorKind)


def _torque_law(torque: Torque | ArrayLike | None, nv: int) -> Torque:
    if callable(torque):
        return torque
    constant = np.zeros(nv) if torque is None else _torques(torque, nv)
    return lambda t, q, v: constant


def _torques(tau: ArrayLike, nv: int) -> Floats:
    return shaped_array("tau", tau, nv)


def _divergence_error(t: float, v: Floats) -> InputError:
    return InputError(
        f"The motion grew beyond all bounds at t = {t:g} s. Take a smaller `dt`, or look at the torques; "
        f"the velocity is {v}."
    )
