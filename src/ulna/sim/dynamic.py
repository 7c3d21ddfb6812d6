"""Dynamic simulation: the motion of a robot under torques and gravity, on its configuration manifold.

| symbol | meaning | shape | unit |
|---|---|---|---|
| q, v | configuration and velocity | (nq), (nv) | [rad] or [m], per s |
| u | tangent vector at the start of a step: q = q0 (+) u | (nv) | [rad] or [m] |
| Jr | right Jacobian of the groups: du/dt = Jr(u)^-1 v | (nv, nv) | [1] |

Three integrators, all of which keep unit quaternions:

- "euler": semi-implicit. The velocity first, then the configuration with the new velocity. Of first order, also in the
  energy; friction is implicit and dry friction exact, at any step.
- "rk4": the classical method of Runge and Kutta in the form of Munthe-Kaas, of fourth order; friction is smooth within
  its width, which bounds the step.
- "adaptive": SciPy's solvers, with the error bounded and the step chosen; friction is smooth.

Sources: Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), sections I.1 and IV.8.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from typing import Any, Literal

import numpy as np

from ulna.algorithms.dynamics.joint_friction import Friction
from ulna.checks.arrays import shaped_array
from ulna.checks.quaternions import checked_configuration
from ulna.checks.values import checked_robot, number, one_of, step_count
from ulna.checks.values import count as checked_count
from ulna.checks.values import duration as checked_duration
from ulna.errors import InputError, needed
from ulna.model import Constraint, Model
from ulna.model.constraint import listed
from ulna.robot import Robot
from ulna.sim.plant import Plant, Torque, check_friction, checked_torques
from ulna.sim.recording import Recording
from ulna.system.progress import progress, silent
from ulna.typing import ArrayLike, Floats

Method = Literal["euler", "rk4", "adaptive"]
_METHODS = ("euler", "rk4", "adaptive")
_SOLVERS = ("RK45", "RK23", "DOP853", "Radau", "BDF", "LSODA")
_ERROR = "an error above zero, at most 1"
_RELATIVE_ERROR, _ABSOLUTE_ERROR = 1e-8, 1e-10  # per step
_MAX_STEPS = 10**8  # more do not fit
_DIVERGED = 1e100  # rates of which the squares of solvers overflow
_PROGRESS_STEPS = 20_000  # steps from which progress is shown


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
        q: Configuration, shape (nq,) [rad, m].
        v: Velocity, shape (nv,) [rad/s, m/s].
        tau: Torques of the drives, shape (nv,) [N m, N].
        dt: Duration [s].
        friction: As for `Plant`.

    Returns:
        Configuration, shape (nq,) [rad, m], and velocity, shape (nv,) [rad/s, m/s].

    Raises:
        ShapeError, NonFiniteError: An array does not fit the robot.
        InputError: `dt` is not above zero, or the motion diverged.
    """
    checked_robot(robot)
    check_friction(friction)
    q, v = (
        checked_configuration("q", q, robot.model),
        shaped_array("v", v, robot.nv, labels=robot.model.velocity_names),
    )
    dt = checked_duration("dt", dt)
    moved, speed = _plant(robot, friction).euler(q, v, checked_torques(tau, robot.model), dt)
    if not np.isfinite(moved.sum() + speed.sum()):
        raise _divergence_error(dt, speed)
    return moved, speed


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
    external: Torque | ArrayLike | None = None,
    every: int = 1,
    solver: str | None = None,
    rtol: float | None = None,
    atol: float | None = None,
) -> Recording:
    """The motion of a robot from a state, under torques, gravity and friction. Position limits do not stop it.

    Args:
        robot: The robot.
        q: Configuration at the start, shape (nq,) [rad, m].
        v: Velocity at the start, shape (nv,) [rad/s, m/s]; None for rest.
        torque: Function of time [s], configuration and velocity that returns the torques of the drives, shape (nv,)
            [N m, N]; or constant torques; None for none. "euler" calls it once a step; "rk4" and "adaptive" also in
            between and out of order, so there it must have no memory.
        duration: How long [s].
        dt: Step [s]; for "adaptive" the time between rows of the recording.
        method: "euler", "rk4" or "adaptive".
        friction: As for `Plant`; smooth when there are constraints.
        constraints: Contacts and loops that bind the robot; contacts hold where they are at the start.
        kp: Gain [1/s^2] that pulls constraints together again, critically damped.
        external: Generalised forces from outside, shape (nv,) [N m, N], or a function as `torque`: J' f for a force f
            at a frame with Jacobian J. They are not in the recorded tau.
        every: Records each of so many steps; the start and the end are recorded anyway.
        solver: For "adaptive": a method of `scipy.integrate.solve_ivp`; None for "LSODA" with friction, which bends
            its way around stiffness, and "DOP853" without.
        rtol: Relative error per step, for "adaptive" [-]; None for 1e-8.
        atol: Absolute error per step, for "adaptive" [rad, m, rad/s, m/s]; None for 1e-10.

    Returns:
        A recording with columns t, q, v and tau.

    Raises:
        ShapeError, NonFiniteError: An array does not fit the robot, or the motion diverged.
        InputError: `dt`, `duration` or `every` is out of range; the step is too long for "rk4" with this friction; or
            an argument is given that the method does not have.
        UnknownName: There is no such method.
        MissingExtra: "adaptive" without SciPy.

    Example:
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> run = ulna.sim.simulate(robot, q, torque=lambda t, q, v: robot.gravity_forces(q), duration=0.1)
        >>> np.allclose(run.q[-1], q)
        True
    """
    model = checked_robot(robot).model
    _check_method(method, solver=solver, rtol=rtol, atol=atol)
    kp = number("kp", kp, "a gain that is not below zero [1/s^2]", least=0.0)
    check_friction(friction)
    start = checked_configuration("q", q, model)
    speed = np.zeros(model.nv) if v is None else shaped_array("v", v, model.nv, labels=model.velocity_names)
    law = _torque_law(torque, model)
    push = None if external is None else _torque_law(external, model)
    if isinstance(constraints, tuple | list) and not constraints:
        plant = _plant(robot, friction)
    else:
        plant = Plant(robot, friction, _constrained_acceleration(robot, start, constraints, kp))
    duration, count = step_count(duration, dt, _MAX_STEPS)
    every = checked_count("every", every)
    times = np.linspace(0.0, duration, count + 1)
    if method == "adaptive":
        rows = times[[*range(0, count, every), count]]
        return _adaptive(plant, start, speed, law, push, rows, solver, rtol, atol)
    if method == "rk4":
        _check_stable_step(plant, start, duration / count)
    return _equal_steps(plant, start, speed, law, push, times, method, every)


def _check_method(method: Method, **of_adaptive: Any) -> None:
    one_of("method", method, _METHODS)
    for name, value in of_adaptive.items():
        if value is not None and method != "adaptive":
            raise InputError(
                f"simulate: `{name}` is for method='adaptive'; with method={method!r} the step is `dt` and errors are "
                f"not bounded. Leave `{name}` out, or pass method='adaptive'."
            )


def _equal_steps(
    plant: Plant,
    q: Floats,
    v: Floats,
    law: Torque,
    push: Torque | None,
    times: Floats,
    method: Method,
    every: int,
) -> Recording:
    """Steps of one length under a law and forces from outside, of which each `every`-th is recorded."""
    model = plant.robot.model
    recording, count, total = Recording(), len(times) - 1, _sum(law, push, model)
    step = float(times[-1]) / count
    with progress("Simulating") if count >= _PROGRESS_STEPS else contextlib.nullcontext(silent) as report:
        for k in range(count):
            t = float(times[k])
            tau = checked_torques(law(t, q, v), model)
            if k % every == 0:
                recording.add(t, q, v=v, tau=tau)
            if method == "euler":
                applied = tau if push is None else tau + checked_torques(push(t, q, v), model)
                q, v = plant.euler(q, v, applied, step)
            else:
                q, v = plant.rk4(q, v, total, t, step)
            if not np.isfinite(v).all():
                raise _divergence_error(float(times[k + 1]), v)
            if k % 1000 == 0:
                report(k, count)
    end = float(times[-1])
    recording.add(end, q, v=v, tau=checked_torques(law(end, q, v), model))
    return recording


def _adaptive(
    plant: Plant,
    q: Floats,
    v: Floats,
    law: Torque,
    push: Torque | None,
    times: Floats,
    solver: str | None,
    rtol: float | None,
    atol: float | None,
) -> Recording:
    """Steps u and v from a base that follows, where rotations make the tangent space bend."""
    n, integrate = plant.robot.nv, _adaptive_solver(plant, solver, rtol, atol)
    model = plant.robot.model
    recording, total = Recording(), _sum(law, push, model)
    recording.add(times[0], q, v=v, tau=checked_torques(law(float(times[0]), q, v), model))
    t, row = float(times[0]), 1
    while row < len(times):
        base = q

        def rates(t: float, y: Floats, base: Floats = base) -> Floats:
            out = np.concatenate(plant._rates(base, y[:n], y[n:], total, t))
            if not np.abs(out).max(initial=0.0) < _DIVERGED:  # with nan solvers fail, or never end
                raise _divergence_error(t, y[n:])
            return out

        state = np.concatenate([np.zeros(n), v])
        solution = integrate(rates, (t, float(times[-1])), state, t_eval=times[row:])
        if solution.status < 0 or not np.isfinite(np.asarray(solution.y)).all():
            raise InputError(
                f"The solver failed at t = {solution.t[-1] if len(solution.t) else t:g} s: {solution.message}"
            )
        for at, y in zip(solution.t, np.asarray(solution.y).T, strict=True):
            here, speed = plant._integrate(base, y[:n].copy()), y[n:].copy()
            recording.add(at, here, v=speed, tau=checked_torques(law(float(at), here, speed), model))
        row += len(solution.t)
        if solution.status == 1:
            t, y = float(solution.t_events[0][0]), solution.y_events[0][0]
            q, v = plant._integrate(base, y[:n].copy()), y[n:].copy()
    return recording


def _adaptive_solver(
    plant: Plant, solver: str | None, rtol: float | None, atol: float | None
) -> Callable[..., Any]:
    """SciPy's solver with its options; it stops where u is so long that the tangent space bends too much."""
    with needed("scipy", "ode", "An adaptive solver"):
        from scipy.integrate import solve_ivp
    n = plant.robot.nv
    usual = "LSODA" if plant.friction is not None else "DOP853"
    method = usual if solver is None else one_of("solver", solver, _SOLVERS)
    rtol = number("rtol", _RELATIVE_ERROR if rtol is None else rtol, _ERROR, above=0.0, most=1.0)
    atol = number("atol", _ABSOLUTE_ERROR if atol is None else atol, _ERROR, above=0.0, most=1.0)

    def far(t: float, y: Floats) -> float:
        return float(np.abs(y[:n]).max(initial=0.0)) - 1.5

    far.terminal = True  # type: ignore[attr-defined]
    events = None if plant._is_vector_space else far
    return partial(solve_ivp, method=method, events=events, rtol=rtol, atol=atol)


@lru_cache(maxsize=32)
def _plant(robot: Robot, friction: Friction | Literal["model"] | None) -> Plant:
    return Plant(robot, friction)


def _constrained_acceleration(
    robot: Robot, q: Floats, constraints: Sequence[Constraint] | Constraint, kp: float
) -> Callable[[Floats, Floats, Floats], Floats]:
    """The accelerations of the robot under constraints that hold where they are at `q`."""
    listed_constraints = listed(constraints)
    kernel = robot.kernel("constrained_dynamics", constraints=listed_constraints, stabilised=True)
    has_contacts = any(constraint.is_contact for constraint in listed_constraints)
    anchors = (robot.constraints.anchors(q, listed_constraints),) if has_contacts else ()
    gains = np.tile([kp, 2.0 * np.sqrt(kp)], (len(listed_constraints), 1))
    return lambda q, v, tau: kernel(q, v, tau, *anchors, gains)[0]


def _check_stable_step(plant: Plant, q: Floats, step: float) -> None:
    """Raises InputError where a step [s] is too long for the method of Runge and Kutta with this friction."""
    longest = plant.longest_step(q)
    if step > longest:
        raise InputError(
            f"A step of {step:g} s is too long for friction within a width of {plant.friction.width:g}: 'rk4' is "  # type: ignore[union-attr]
            f"stable up to {longest:.2g} s. Use method='euler', whose friction takes any step, or "
            "'adaptive'; or widen the friction."
        )


def _torque_law(torque: Torque | ArrayLike | None, model: Model) -> Torque:
    if callable(torque):
        return lambda t, q, v: torque(t, q.copy(), v.copy())  # one that writes to them moves nothing
    constant = np.zeros(model.nv) if torque is None else checked_torques(torque, model)
    return lambda t, q, v: constant


def _sum(law: Torque, push: Torque | None, model: Model) -> Torque:
    """The torques of a law and forces from outside together."""
    if push is None:
        return law
    return lambda t, q, v: checked_torques(law(t, q, v), model) + checked_torques(push(t, q, v), model)


def _divergence_error(t: float, v: Floats) -> InputError:
    return InputError(
        f"The motion diverged at t = {t:g} s. Take a smaller `dt`, or check the torques; the velocity is {v}."
    )
