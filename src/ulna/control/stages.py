"""One stage of an optimal control problem: dynamics and cost of a step, with their derivatives, as one kernel.

| symbol | meaning | shape |
|---|---|---|
| x = (q, v) | state; its changes dx = (dq, dv) lie in the tangent space | (nx,), (ndx,) |
| u | torques of the driven joints | (nu,) |
| x' | the state one step later: v' = v + h a(q, v, S u), q' = q (+) h v' | (nx,) |
| fx, fu | derivatives of x' with respect to x and u: dx' = fx dx + fu du | (ndx, ndx), (ndx, nu) |
| l, lx, lu, lxx, lux, luu | cost of the step, its gradient and Hessian | (), (ndx,), (nu,), ... |

The derivatives of the acceleration are those of the dynamics (Carpentier & Mansard 2018), the step on the manifold has
those of `integrate`; the cost is differentiated by the compiler. A cost that is a vector of residuals r counts as
r @ r / 2, and its Hessian as that of Gauss and Newton, J' J, which has no negative direction (Nocedal & Wright 2006,
eq. 10.24).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ulna import numeric
from ulna.checks.frozen_calls import warn_of_frozen_calls
from ulna.checks.values import checked_robot, count, function, number
from ulna.compiler import compile, trace
from ulna.control.stage_costs import CostParts, extra_shapes
from ulna.control.systems import System, robot_system
from ulna.errors import InputError
from ulna.robot import Robot
from ulna.system.cached import cached_property
from ulna.typing import Array


class StageDerivatives(NamedTuple):
    """What a stage evaluates to: the next state and the cost, and their derivatives; leading axes as the arguments'."""

    x_next: Array
    fx: Array
    fu: Array
    cost: Any
    lx: Array
    lu: Array
    lxx: Array
    lux: Array
    luu: Array


class TerminalDerivatives(NamedTuple):
    """What the end of a problem evaluates to: the cost, its gradient and its Hessian."""

    cost: Any
    lx: Array
    lxx: Array


@dataclass(frozen=True, eq=False)
class Stage:
    """Dynamics and cost of one step, compiled; made by `stage` or `custom_stage`.

    `stage(x, u, *parameters)` returns `StageDerivatives`; all arguments take leading axes, such as one of knots, and
    broadcast. `calc(x, u, *parameters)` returns the next state and the cost alone.
    """

    system: System = field(repr=False)
    calc: Any
    derivatives: Any
    parameters: tuple[tuple[str, tuple[int, ...]], ...]

    @property
    def nx(self) -> int:
        """How many numbers a state has."""
        return self.system.nx

    @property
    def ndx(self) -> int:
        """How many numbers a change of the state has."""
        return self.system.ndx

    @property
    def nu(self) -> int:
        """How many numbers a control has."""
        return self.system.nu

    def __call__(self, x: Any, u: Any, *parameters: Any) -> StageDerivatives:
        """Dynamics, cost and their derivatives.

        Args:
            x: States (..., nx) [any].
            u: Controls (..., nu) [any].
            *parameters: The further arguments of the cost, (...) each.

        Returns:
            The next state, the cost, and their derivatives.
        """
        return StageDerivatives(*self.derivatives(x, u, *parameters))

    def terminal(self, cost: Callable[..., Any], **shapes: Any) -> TerminalStage:
        """The cost of the last state.

        Args:
            cost: As for `stage`, but without controls: `cost(q, v, ...)`, or `cost(x, ...)` of a custom stage.
            **shapes: Shapes of its further arguments, such as `target=(3,)`.

        Returns:
            The end of a problem.

        Raises:
            UnknownName: If the shape of an argument is missing.
            InputError: If the cost is neither a number nor a vector of residuals.
        """
        system, extra = self.system, extra_shapes(cost, self.system.names, shapes)
        parts = CostParts(system, cost, extra, has_control=False)
        sizes: dict[str, Any] = {"x": (system.nx,), **extra}

        def run(x: Array, *p: Array) -> tuple[Any, ...]:
            return parts.at(x, (), p)

        return TerminalStage(compile(trace(run, name="terminal", **sizes)), tuple(extra.items()))

    @cached_property
    def follow(self) -> Any:
        """The kernel of a step under a control law, to the next state, the control and the cost.

        Its arguments are (x, x_ref, u_ref, k, K, alpha, low, high, *parameters). The control is
        `u_ref + alpha * k + K @ (x - x_ref)`, the difference taken on the manifold, clipped to `low` and `high`.
        """
        system, calc = self.system, self.calc.function

        def run(
            x: Array, x_ref: Array, u_ref: Array, k: Array, K: Array, alpha: Any, low: Array, high: Array, *p: Array
        ) -> Any:  # fmt: skip
            u = numeric.clip(u_ref + alpha * k + K @ system.minus(x_ref, x), low, high)
            after, cost = calc(x, u, *p)
            return after, u, cost

        nx, ndx, nu = self.nx, self.ndx, self.nu
        shapes: dict[str, Any] = {
            "x": (nx,),
            "x_ref": (nx,),
            "u_ref": (nu,),
            "k": (nu,),
            "K": (nu, ndx),
            "alpha": (),
            "low": (nu,),
            "high": (nu,),
        }
        shapes |= dict(self.parameters)
        return compile(trace(run, name="follow", **shapes))


@dataclass(frozen=True, eq=False)
class TerminalStage:
    """The cost of the last state, compiled; made by `Stage.terminal`."""

    derivatives: Any
    parameters: tuple[tuple[str, tuple[int, ...]], ...]

    def __call__(self, x: Any, *parameters: Any) -> TerminalDerivatives:
        """The cost, its gradient and its Hessian.

        Args:
            x: States (..., nx) [any].
            *parameters: The further arguments of the cost, (...) each.

        Returns:
            Cost (...), gradient (..., ndx), Hessian (..., ndx, ndx).
        """
        return TerminalDerivatives(*self.derivatives(x, *parameters))


def stage(
    robot: Robot, cost: Callable[..., Any], *, dt: float, actuated: Sequence[str] | None = None, **shapes: Any
) -> Stage:
    """A stage of a robot driven by torques: a semi-implicit Euler step of its forward dynamics, and a cost.

    Args:
        robot: The robot. A state is x = (q, v), (nq + nv,); free flyers and continuous joints move on their manifolds.
        cost: Function `cost(q, v, u, ...)` of one sample, as for `ulna.compile`. It returns a number, whose exact
            Hessian is taken, or a vector of residuals r, which counts as r @ r / 2 with the Hessian of Gauss and
            Newton.
        dt: Length of the step [s].
        actuated: Names of the driven joints; u has their torques [N m or N], in the order of the model. Default: all
            but free flyers.
        **shapes: Shapes of the further arguments of the cost, such as `target=(3,)`.

    Returns:
        The stage.

    Raises:
        InputError: If `dt` is not above zero, or the cost is neither a number nor a vector of residuals.
        UnknownName: If there is no such joint, or the shape of an argument is missing.

    Example:
        >>> robot = ulna.load("panda")
        >>> effort = ulna.control.stage(robot, lambda q, v, u: u @ u, dt=0.01)
        >>> x, u = np.zeros((50, 14)), np.zeros((50, 7))
        >>> effort(x, u).fx.shape
        (50, 14, 14)
    """
    dt = number("dt", dt, "a number above zero [s]", above=0.0)
    return _made(robot_system(checked_robot(robot), dt, actuated), function("cost", cost), shapes)


def custom_stage(
    step: Callable[[Array, Array], Array], cost: Callable[..., Any], *, nx: int, nu: int, **shapes: Any
) -> Stage:
    """A stage with dynamics of your own, in a vector space.

    Args:
        step: Function `step(x, u)` of one sample that returns the next state (nx,), as for `ulna.compile`.
        cost: Function `cost(x, u, ...)`, as for `stage`.
        nx: How many numbers a state has.
        nu: How many numbers a control has.
        **shapes: Shapes of the further arguments of the cost.

    Returns:
        The stage.

    Raises:
        InputError: If `step` does not return a state, or the cost is neither a number nor a vector of residuals.
        UnknownName: If the shape of an argument is missing.
    """
    nx, nu = count("nx", nx), count("nu", nu)
    warn_of_frozen_calls(function("step", step))
    traced = trace(step, name="step", x=(nx,), u=(nu,))
    if [port.shape for port in traced.outputs] != [(nx,)]:
        shown = ", ".join(str(port.shape) for port in traced.outputs)
        raise InputError(f"`step` returns the shape {shown}; expected ({nx},), the next state.")
    by_x, by_u = traced.jacobian("x"), traced.jacobian("u")
    system = System(
        nx,
        nx,
        nu,
        traced,
        step_derivatives=lambda x, u: (by_x(x, u), by_u(x, u)),
        plus=lambda x, dx: x + dx,
        minus=lambda x0, x1: x1 - x0,
        split=lambda x: (x,),
        names=("x",),
        control_limits=np.array([[-np.inf], [np.inf]]) * np.ones(nu),
    )
    return _made(system, cost, shapes)


def _made(system: System, cost: Callable[..., Any], shapes: dict[str, Any]) -> Stage:
    """The compiled stage."""
    extra = extra_shapes(cost, (*system.names, "u"), shapes)
    parts = CostParts(system, cost, extra, has_control=True)
    n = system.ndx

    def calc(x: Array, u: Array, *p: Array) -> tuple[Any, Any]:
        return system.step(x, u), parts.value(x, (u,), p)

    def run(x: Array, u: Array, *p: Array) -> tuple[Any, ...]:
        fx, fu = system.step_derivatives(x, u)
        value, gradient, hessian = parts.at(x, (u,), p)
        blocks = (hessian[:n, :n], hessian[n:, :n], hessian[n:, n:])
        return system.step(x, u), fx, fu, value, gradient[:n], gradient[n:], *blocks

    arguments = dict[str, Any](x=(system.nx,), u=(system.nu,), **extra)
    calculated, derived = (trace(f, name=name, **arguments) for f, name in ((calc, "calc"), (run, "stage")))
    return Stage(system, compile(calculated), compile(derived), tuple(extra.items()))
