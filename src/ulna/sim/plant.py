"""The dynamics of a robot with joint friction, and single steps of its integrators: see `ulna.sim.dynamic`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, final

import numpy as np

from ulna import algorithms
from ulna.algorithms.constraints.dry_friction import velocity_after_friction
from ulna.algorithms.dynamics.forward_dynamics import forward_dynamics
from ulna.algorithms.dynamics.inverse_mass_matrix import inverse_mass_matrix
from ulna.algorithms.dynamics.joint_friction import Friction
from ulna.checks.arrays import shaped_array
from ulna.checks.values import checked_robot, short_repr
from ulna.errors import UnknownName
from ulna.model import Model
from ulna.robot import Robot, compile
from ulna.sim.stops import Stops
from ulna.typing import ArrayLike, Floats

Torque = Callable[[float, Floats, Floats], ArrayLike]
"""Joint torques (nv,) at a time, a configuration and a velocity."""


@final
class Plant:
    """The dynamics of a robot with joint friction, and their integrators.

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
        self._is_vector_space = all(j.kind.is_vector for j in joints)
        self._is_bound = bound is not None
        self._acceleration = bound or compile(self._forward_dynamics, robot)
        self._integrate = robot.kernel("integrate")
        self._kernels: dict[str, Any] = {}

    def acceleration(self, q: Floats, v: Floats, tau: Floats) -> Floats:
        """Accelerations under torques and smooth friction.

        Args:
            q: Configuration, shape (nq,) [rad, m].
            v: Velocity, shape (nv,) [rad/s or m/s].
            tau: Torques, shape (nv,) [N m or N].

        Returns:
            Accelerations, shape (nv,) [rad/s^2 or m/s^2].
        """
        if self.friction is not None:
            tau = tau + self._friction_torque(v)
        return self._acceleration(q, v, tau)

    def euler(self, q: Floats, v: Floats, tau: Floats, dt: float) -> tuple[Floats, Floats]:
        """A semi-implicit step with exact friction.

        Args:
            q: Configuration, shape (nq,) [rad, m].
            v: Velocity, shape (nv,) [rad/s or m/s].
            tau: Torques, shape (nv,) [N m or N].
            dt: The step [s].

        Returns:
            Configuration, shape (nq,) [rad, m], and velocity, shape (nv,) [rad/s, m/s], after the step.
        """
        if self._is_bound:
            free = v + dt * self.acceleration(q, v, tau)
            return self._integrate(q, dt * free), free
        free = v + dt * self._acceleration(q, v, tau)
        if self.friction is not None:
            free = self._velocity_after_friction(self._inverse_mass(q), free, v, dt)
        return self._integrate(q, dt * free), free

    def euler_within(
        self, q: Floats, v: Floats, tau: Floats, dt: float, stops: Stops
    ) -> tuple[Floats, Floats]:
        """As `euler`, for a free robot whose position limits are inelastic stops.

        A joint that would pass its limit comes to rest there, by an impulse that acts on all joints, as friction does.

        Args:
            q: Configuration, shape (nq,) [rad, m].
            v: Velocity, shape (nv,) [rad/s or m/s].
            tau: Torques, shape (nv,) [N m or N].
            dt: The step [s].
            stops: The position limits.

        Returns:
            Configuration, shape (nq,) [rad, m], within the limits, and velocity, shape (nv,) [rad/s, m/s].
        """
        moved, final = self.euler(q, v, tau, dt)
        if stops.contains(moved):
            return moved, final
        low, high = (below, above) = stops.beyond(moved)
        free, G = v + dt * self._acceleration(q, v, tau), self._inverse_mass(q)
        while (below | above).any():  # a stop may push another joint to its own
            forward, backward = np.where(low, np.inf, 0.0), np.where(high, np.inf, 0.0)
            final = self._velocity_at_stops(G, free, v, dt, forward, backward)
            moved = self._integrate(q, dt * final)
            below, above = stops.beyond(moved)
            below, above = below & ~low, above & ~high
            low, high = low | below, high | above
        return stops.held(moved, low & (final <= 0.0), high & (final >= 0.0)), final

    def prepare_stops(self) -> None:
        """Compile what `euler_within` takes at the first contact with a stop."""
        n = self.robot.nv
        zeros = np.zeros(n)
        self._inverse_mass(np.array(self.robot.neutral))
        self._velocity_at_stops(np.eye(n), zeros, zeros, 1e-3, zeros, zeros)

    def rk4(self, q: Floats, v: Floats, torque: Torque, t: float, dt: float) -> tuple[Floats, Floats]:
        """A Runge-Kutta step of fourth order.

        Args:
            q: Configuration, shape (nq,) [rad, m].
            v: Velocity, shape (nv,) [rad/s or m/s].
            torque: Returns the torques; called four times.
            t: The time at the start [s].
            dt: The step [s].

        Returns:
            Configuration, shape (nq,) [rad, m], and velocity, shape (nv,) [rad/s, m/s], after the step.
        """
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
        tau = checked_torques(torque(t, q, v), self.robot.model)
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

    def _velocity_at_stops(
        self, G: Floats, free: Floats, v: Floats, dt: float, forward: Floats, backward: Floats
    ) -> Floats:
        law, n = self.friction or Friction(), self.robot.nv

        def make() -> Any:
            def settle(G: Any, u: Any, v: Any, h: Any, forward: Any, backward: Any) -> Any:
                return velocity_after_friction(G, u, v, h, law, (forward, backward))

            return compile(settle, G=(n, n), u=(n,), v=(n,), h=(), forward=(n,), backward=(n,))

        return self._kernel("stop", make)(G, free, v, dt, forward, backward)

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
    """Check a friction argument.

    Raises:
        UnknownName: It is none.
    """
    if isinstance(friction, str) and friction == "model":
        return
    if not (friction is None or isinstance(friction, Friction)):
        name = friction if isinstance(friction, str) else short_repr(friction)
        raise UnknownName("friction", name, ("model",), "Give 'model', None or a Friction.")


def checked_torques(tau: ArrayLike, model: Model) -> Floats:
    """Joint torques as an array.

    Args:
        tau: Joint torques, shape (nv,) [N m, N].
        model: The model.

    Returns:
        A new array, shape (nv,) [N m, N].

    Raises:
        ShapeError: another shape.
        NonFiniteError: nan or inf among them.
    """
    return shaped_array("tau", tau, model.nv, labels=model.velocity_names)
