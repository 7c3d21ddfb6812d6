"""One stage of an optimal control problem: dynamics and cost of a step, with their derivatives, as one kernel.

| symbol | meaning | shape |
|---|---|---|
| x = (q, v) | state; its changes dx = (dq, dv) lie in the tangent space | (nx,), (ndx,) |
| u | torques of the driven joints | (nu,) |
| x' | the state one step later: v' = v + h a(q, v, S u), q' = q (+) h v' | (nx,) |
| fx, fu | derivatives of x' by x and u: dx' = fx dx + fu du | (ndx, ndx), (ndx, nu) |
| l, lx, lu, lxx, lux, luu | cost of the step, its gradient and Hessian | (), (ndx,), (nu,), ... |

The derivatives of the acceleration are those of the dynamics (Carpentier & Mansard 2018), the step on the manifold has
those of `integrate`; the cost is differentiated by the compiler. A cost that is a vector of residuals r counts as
r @ r / 2, and its Hessian as that of Gauss and Newton, J' J, which has no negative direction (Nocedal & Wright 2006,
eq. 10.24).
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ulna import algorithms
from ulna.compiler import Function, compile, trace
from ulna.errors import InputError, UnknownName
from ulna.model import FreeFlyer
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


@dataclass(frozen=True)
class System:
    """Dynamics in steps; its functions take one sample and can be traced.

    Attributes:
        nx: How many numbers a state has.
        ndx: How many numbers a change of the state has.
        nu: How many numbers a control has.
        step: The next state of a state and a control.
        step_derivatives: Its derivatives by state and control.
        plus: A state and a change to the changed state.
        minus: The change that leads from one state to another.
        split: What a cost takes of a state.
        names: What these are called.
    """

    nx: int
    ndx: int
    nu: int
    step: Callable[[Array, Array], Array]
    step_derivatives: Callable[[Array, Array], tuple[Array, Array]]
    plus: Callable[[Array, Array], Array]
    minus: Callable[[Array, Array], Array]
    split: Callable[[Array], tuple[Array, ...]]
    names: tuple[str, ...]


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
        system, extra = self.system, _extra(cost, self.system.names, shapes)
        parts = _CostParts(system, cost, extra, has_control=False)

        def run(x: Array, *p: Array) -> tuple[Any, ...]:
            return parts.at(x, (), p)

        return TerminalStage(
            compile(trace(run, name="terminal", x=(system.nx,), **extra)), tuple(extra.items())
        )

    @cached_property
    def follow(self) -> Any:
        """The kernel of a step under a control law: (x, x_ref, u_ref, k, K, alpha, *parameters) -> (x_next, u, cost).

        The control is `u_ref + alpha * k + K @ (x - x_ref)`, the difference taken on the manifold.
        """
        system, calc = self.system, self.calc.function

        def run(x: Array, x_ref: Array, u_ref: Array, k: Array, K: Array, alpha: Any, *p: Array) -> Any:
            u = u_ref + alpha * k + K @ system.minus(x_ref, x)
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
    if not dt > 0.0:
        raise InputError(f"`dt` is {dt!r}; expected a number above zero [s].")
    return _made(_robot_system(robot, float(dt), actuated), cost, shapes)


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
    )
    return _made(system, cost, shapes)


def _made(system: System, cost: Callable[..., Any], shapes: dict[str, Any]) -> Stage:
    """The compiled stage."""
    extra = _extra(cost, (*system.names, "u"), shapes)
    parts = _CostParts(system, cost, extra, has_control=True)
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


def _robot_system(robot: Robot, dt: float, actuated: Sequence[str] | None) -> System:
    """The dynamics of a robot in steps."""
    model, nq, nv = robot.model, robot.nq, robot.nv
    driven = _driven(robot, actuated)

    def parts(x: Array, u: Array) -> tuple[Array, Array, Array]:
        tau = np.zeros(nv, dtype=object)
        tau[driven] = u
        return x[:nq], x[nq:], tau

    def step(x: Array, u: Array) -> Array:
        q, v, tau = parts(x, u)
        after = v + dt * algorithms.forward_dynamics(model, q, v, tau)
        return np.concatenate([algorithms.integrate(model, q, dt * after), after])

    def step_derivatives(x: Array, u: Array) -> tuple[Array, Array]:
        q, v, tau = parts(x, u)
        after = v + dt * algorithms.forward_dynamics(model, q, v, tau)
        by_q, by_v, by_tau = algorithms.forward_dynamics_derivatives(model, q, v, tau)
        along, of_step = algorithms.integrate_derivatives(model, q, dt * after)
        rate = np.concatenate([dt * by_q, np.eye(nv) + dt * by_v], axis=1)
        place = dt * (of_step @ rate) + np.concatenate([along, np.zeros((nv, nv))], axis=1)
        push = dt * by_tau[:, driven]
        return np.concatenate([place, rate]), np.concatenate([dt * (of_step @ push), push])

    def plus(x: Array, dx: Array) -> Array:
        return np.concatenate([algorithms.integrate(model, x[:nq], dx[:nv]), x[nq:] + dx[nv:]])

    def minus(x0: Array, x1: Array) -> Array:
        return np.concatenate([algorithms.difference(model, x0[:nq], x1[:nq]), x1[nq:] - x0[nq:]])

    def split(x: Array) -> tuple[Array, ...]:
        return x[:nq], x[nq:]

    return System(nq + nv, 2 * nv, len(driven), step, step_derivatives, plus, minus, split, ("q", "v"))


def _driven(robot: Robot, actuated: Sequence[str] | None) -> list[int]:
    """The entries of the torques that a control drives."""
    joints = [joint for joint in robot.model.joints if joint.kind.nv]
    names = [joint.name for joint in joints]
    if isinstance(actuated, str):
        actuated = (actuated,)
    for name in actuated or ():
        if name not in names:
            raise UnknownName("joint", name, names)
    chosen = [
        joint
        for joint in joints
        if (not isinstance(joint.kind, FreeFlyer) if actuated is None else joint.name in actuated)
    ]
    entries = [k for joint in chosen for k in range(joint.idx_v, joint.idx_v + joint.kind.nv)]
    if not entries:
        raise InputError("No joint is driven; expected at least one name in `actuated`.")
    return entries


def _extra(
    cost: Callable[..., Any], first: Sequence[str], shapes: dict[str, Any]
) -> dict[str, tuple[int, ...]]:
    """The shapes of the arguments of a cost after the first ones."""
    parameters = inspect.signature(cost).parameters
    names = [n for n, p in parameters.items() if n in shapes or p.default is p.empty]
    call = f"cost({', '.join(first)}, ...)"
    if len(names) < len(first):
        raise InputError(f"`cost` takes {len(names)} arguments, {', '.join(names)}; expected {call}.")
    for name in shapes:
        if name not in names[len(first) :]:
            raise UnknownName(
                "further argument of the cost", name, names[len(first) :], f"It is called as {call}."
            )
    for name in names[len(first) :]:
        if name not in shapes:
            raise UnknownName("shape of argument", name, shapes, f"Give it: {name}=(3,), or () for a number.")
        if name in ("x", "u", "z_"):
            raise InputError(
                f"`cost` has an argument {name!r}; expected another name, which stages use themselves."
            )
    return {n: s if isinstance(s, tuple) else (s,) for n in names[len(first) :] for s in (shapes[n],)}


class _CostParts:
    """Value, gradient and Hessian of a cost along the changes z = (dx, du) of state and control."""

    def __init__(
        self, system: System, cost: Callable[..., Any], extra: dict[str, tuple[int, ...]], has_control: bool
    ) -> None:
        n, nu = system.ndx, system.nu if has_control else 0
        controls: dict[str, Any] = {"u": (nu,)} if has_control else {}
        shapes: dict[str, Any] = {"z_": (n + nu,), "x": (system.nx,), **controls, **extra}

        def along(z: Array, x: Array, *rest: Array) -> Any:
            arguments = [*system.split(system.plus(x, z[:n]))]
            if has_control:
                arguments.append(rest[0] + z[n:])
            return cost(*arguments, *rest[len(controls) :])

        self._traced = trace(along, name="cost", **shapes)
        returned = [port.shape for port in self._traced.outputs]
        if len(returned) != 1 or len(returned[0]) > 1:
            shown = ", ".join(map(str, returned))
            raise InputError(
                f"`cost` returns the shape {shown}; expected a number, or one vector of residuals."
            )
        self._is_number = returned[0] == ()
        self._origin = np.zeros(n + nu)
        self._first: Function = self._traced.jacobian("z_")
        self._second: Function | None = self._traced.hessian("z_") if self._is_number else None

    def value(self, x: Array, controls: tuple[Array, ...], p: Sequence[Array]) -> Any:
        """The cost at a state."""
        r = self._traced(self._origin, x, *controls, *p)
        return r if self._is_number else 0.5 * (r @ r)

    def at(self, x: Array, controls: tuple[Array, ...], p: Sequence[Array]) -> tuple[Any, Array, Array]:
        """Cost, gradient and Hessian at a state."""
        arguments = (self._origin, x, *controls, *p)
        first = self._first(*arguments)
        if self._second is not None:
            return self._traced(*arguments), first, self._second(*arguments)
        r = self._traced(*arguments)
        return 0.5 * (r @ r), r @ first, first.T @ first
