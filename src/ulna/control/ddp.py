"""Differential dynamic programming: the controls that minimise a cost over a horizon, with feedback around them.

Each iteration evaluates all knots in one batched call of the stage, runs backwards over them (`backward`), and forwards
under the control laws u + alpha k + K (x (-) x_ref), with a line search over alpha. Dynamics count to first order
(iLQR), the cost to second. Limits of the controls are kept by both passes (Tassa, Mansard & Todorov 2014). References:
Li & Todorov 2004; Tassa, Erez & Todorov 2012, section II, whose schedule of mu is simplified here; on manifolds,
Mastalli et al. 2020.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import count, function, number, short_repr
from ulna.control.backward import Gains, backward
from ulna.control.bounds import least_and_greatest
from ulna.control.stages import Stage, StageDerivatives, TerminalDerivatives, TerminalStage
from ulna.errors import InputError, ShapeError
from ulna.typing import ArrayLike, Floats

_SMALLEST_MU, _LARGEST_MU = 1e-9, 1e9
_STEPS = tuple(0.5**k for k in range(12))
_MIN_REGULARIZATION = 1e-4
"""The part of the expected decrease that a step must achieve."""


class DDPIteration(NamedTuple):
    """How far the search is.

    Attributes:
        number: Number of the iteration, from 1.
        cost: Cost after it.
        decrease: By how much the cost would change at most, to first and second order.
        step: Length of the step, alpha; 0 where none was accepted.
        mu: Regularisation.
    """

    number: int
    cost: float
    decrease: float
    step: float
    mu: float


@dataclass(frozen=True, eq=False)
class DDPSolution:
    """What `ddp` found.

    Attributes:
        states: (N + 1, nx).
        controls: (N, nu).
        gains: K (N, nu, ndx): near the solution, `u = controls[i] + gains[i] @ (x (-) states[i])` is the best control.
            Rows of controls that are at a limit are zero.
        cost: Cost of the whole horizon.
        iterations: One entry for each iteration.
        is_converged: Whether the expected decrease fell below the tolerance, without regularisation, too.
        reason: In words.
    """

    states: Floats
    controls: Floats
    gains: Floats
    cost: float
    iterations: tuple[DDPIteration, ...]
    is_converged: bool
    reason: str

    def __repr__(self) -> str:
        word = "converged" if self.is_converged else "not converged"
        return f"<DDP solution: cost {self.cost:.6g}, {word} after {len(self.iterations)} iterations; {self.reason}>"


def ddp(
    stage: Stage,
    terminal: TerminalStage,
    x0: ArrayLike,
    controls: ArrayLike,
    *,
    parameters: Sequence[Any] = (),
    terminal_parameters: Sequence[Any] = (),
    limits: ArrayLike | None = None,
    iterations: int = 200,
    tolerance: float = 1e-9,
    progress: Callable[[DDPIteration], Any] | None = None,
) -> DDPSolution:
    """Minimises the sum of the costs of N stages and of the last state by differential dynamic programming.

    The controls keep their limits; limits of joints need a cost. Ctrl-C ends the search at once.

    Args:
        stage: The stage.
        terminal: The end, of the same system: `stage.terminal(...)`.
        x0: First state (nx,) [any].
        controls: Controls to start from (N, nu), clipped to the limits [any]; zeros, or what keeps the robot still.
        parameters: The further arguments of the stage's cost, each of its shape, or (N, ...) for one of each knot.
        terminal_parameters: The further arguments of the last cost.
        limits: Greatest size of the controls, () or (nu,), or least and greatest controls, (2, nu) [any]; np.inf for no
            limit. None for the effort limits of the robot's joints (those of 0 say that none is known), and for no
            limits of a custom stage.
        iterations: The largest number of iterations.
        tolerance: Ends where the cost can decrease by less than this, relative to it (to 1 where it is below 1) [-].
        progress: Called after each iteration with a `DDPIteration`; True as its answer ends the search.

    Returns:
        The solution.

    Raises:
        ShapeError: If an array has a wrong shape.
        NonFiniteError: If `x0`, the first controls or parameters are not finite.
        InputError: If the controls lead to states that are not finite, or an argument makes no sense.
    """
    iterations = count("iterations", iterations, 0)
    tolerance = number("tolerance", tolerance, "a number not below 0", least=0.0)
    progress = progress if progress is None else function("progress", progress)
    search = _Search(stage, terminal, x0, controls, parameters, terminal_parameters, limits)
    mu, done, converged, reason = 0.0, [], False, f"{iterations} iterations were not enough"
    gains: Gains | None = None
    while len(done) < iterations:
        model = *search.derivatives(), search.allowed_changes()
        gains, mu = _regularised(*model, mu)
        if gains is None:
            reason = "the Hessian of the cost by the controls is not positive"
            break
        decrease, small = gains.decrease, tolerance * max(1.0, abs(search.cost))
        if decrease <= small and (possible := _possible_decrease(*model, gains, mu)) <= small:
            converged, reason = True, f"the cost could decrease by {possible:.1e} only"
            break
        step = search.forward(gains)
        done.append(DDPIteration(len(done) + 1, search.cost, decrease, step, mu))
        mu = _next_mu(mu, step)
        if progress is not None and progress(done[-1]):
            reason = "`progress` asked to stop"
            break
        if step == 0.0 and mu > _LARGEST_MU:
            reason = "no step decreases the cost"
            break
    K = np.zeros((len(search.controls), stage.nu, stage.ndx)) if gains is None else gains.K
    return DDPSolution(search.states, search.controls, K, search.cost, tuple(done), converged, reason)


def _regularised(
    knots: StageDerivatives, end: TerminalDerivatives, changes: Floats | None, mu: float
) -> tuple[Gains | None, float]:
    """Control laws with the least regularisation from `mu` on under which the model has a minimum; None without one."""
    while (gains := backward(knots, end, mu, changes)) is None and mu < _LARGEST_MU:
        mu = max(10.0 * mu, _SMALLEST_MU)
    return gains, mu


def _possible_decrease(
    knots: StageDerivatives, end: TerminalDerivatives, changes: Floats | None, gains: Gains, mu: float
) -> float:
    """What could be gained with as little regularisation as possible: with much of it every step is short."""
    least = _regularised(knots, end, changes, 0.0)[0] if mu > 0.0 else gains
    return (gains if least is None else least).decrease


def _next_mu(mu: float, step: float) -> float:
    """More regularisation after a short step or none, less after a long one."""
    if step >= 0.5:
        return mu / 10.0 if mu > _SMALLEST_MU else 0.0
    return mu if step >= 0.05 else max(10.0 * mu, 1e-6 if step == 0.0 else _SMALLEST_MU)


class _Search:
    """States and controls so far; their cost."""

    def __init__(
        self,
        stage: Stage,
        terminal: TerminalStage,
        x0: ArrayLike,
        controls: ArrayLike,
        parameters: Sequence[Any],
        terminal_parameters: Sequence[Any],
        limits: ArrayLike | None,
    ) -> None:
        _check_parts(stage, terminal)
        self.stage, self.terminal = stage, terminal
        known = stage.system.control_limits
        self.limits = known if limits is None else least_and_greatest("limits", limits, stage.nu)
        self.controls = np.clip(_finite("controls", controls, ("N", stage.nu)), *self.limits)
        x0 = _finite("x0", x0, (stage.nx,))
        knots = len(self.controls)
        self.parameters = _each_knot("parameters", stage.parameters, parameters, knots)
        self.rows = list(zip(*map(list, self.parameters), strict=True)) or [()] * knots
        self.last = [
            p[0] for p in _each_knot("terminal_parameters", terminal.parameters, terminal_parameters, 1)
        ]
        self.states = np.empty((knots + 1, stage.nx))
        self.states[0] = x0
        total = 0.0
        for i, (u, row) in enumerate(zip(self.controls, self.rows, strict=True)):
            self.states[i + 1], cost = stage.calc(self.states[i], u, *row)
            total += cost
        self.cost = float(total + terminal(self.states[-1], *self.last).cost)
        if not np.isfinite(self.cost):
            raise InputError(
                "`controls` lead to a cost that is not finite; expected controls under which the system stays near "
                "its first state, such as torques against gravity."
            )

    def derivatives(self) -> tuple[StageDerivatives, TerminalDerivatives]:
        """Dynamics and cost of all knots, in one call, and of the end."""
        knots = self.stage(self.states[:-1], self.controls, *self.parameters)
        return knots, self.terminal(self.states[-1], *self.last)

    def allowed_changes(self) -> Floats | None:
        """By how much each control may change at least and at most, (2, N, nu); None where none has limits."""
        if np.isinf(self.limits).all():
            return None
        return self.limits[:, None] - self.controls

    def forward(self, gains: Gains) -> float:
        """Takes the longest step that decreases the cost enough; returns its length, or 0 if there is none."""
        for alpha in _STEPS:
            states, controls, cost = self._rolled_out(gains, alpha)
            expected = alpha * gains.first + alpha * alpha * gains.second
            if cost - self.cost <= _MIN_REGULARIZATION * expected < 0.0:  # also False for nan
                self.states, self.controls, self.cost = states, controls, cost
                return alpha
        return 0.0

    def _rolled_out(self, gains: Gains, alpha: float) -> tuple[Floats, Floats, float]:
        """States, controls and cost under the control laws."""
        follow, total, step = self.stage.follow, 0.0, np.array(alpha)
        states, controls = np.empty_like(self.states), np.empty_like(self.controls)
        x = states[0] = self.states[0]
        rows = zip(self.states, self.controls, gains.k, gains.K, self.rows, strict=False)
        for i, (x_ref, u_ref, k, K, row) in enumerate(rows):
            x, controls[i], cost = follow(x, x_ref, u_ref, k, K, step, *self.limits, *row)
            states[i + 1] = x
            total += cost
            if not total < np.inf:
                return states, controls, np.inf
        return states, controls, float(total + self.terminal(x, *self.last).cost)


def _finite(name: str, value: ArrayLike, shape: tuple[Any, ...]) -> Floats:
    """A copy of an array of that shape, with finite numbers."""
    array = finite_array(name, value).copy()
    if array.ndim != len(shape) or array.shape[1:] != shape[1:] or shape[0] not in ("N", *array.shape[:1]):
        raise ShapeError(
            name, array.shape, "(" + ", ".join(map(str, shape)) + ("," if len(shape) == 1 else "") + ")"
        )
    if not len(array):
        raise ShapeError(name, array.shape, "one row at least")
    return array


def _check_parts(stage: Any, terminal: Any) -> None:
    """Refuses what is no stage and no end of the same system."""
    if not isinstance(stage, Stage):
        raise InputError(f"`stage` is {short_repr(stage)}; expected a Stage, as `ulna.control.stage` makes.")
    if not isinstance(terminal, TerminalStage):
        raise InputError(
            f"`terminal` is {short_repr(terminal)}; expected the end of a problem, as `stage.terminal(...)` makes."
        )
    size = terminal.derivatives.function.inputs[0].shape[0]
    if size != stage.nx:
        raise InputError(
            f"`terminal` takes states of {size} numbers, and `stage` makes {stage.nx}; expected both of one system, as "
            "`stage.terminal(...)` makes."
        )


def _each_knot(
    name: str, known: Sequence[tuple[str, tuple[int, ...]]], values: Sequence[Any], knots: int
) -> list[Floats]:
    """The further arguments of a cost, one of each for every knot."""
    if len(values) != len(known):
        names = ", ".join(key for key, _ in known) or "nothing"
        raise InputError(f"`{name}` has {len(values)} entries; expected {len(known)}: {names}.")
    arrays = []
    for (key, shape), value in zip(known, values, strict=True):
        array = finite_array(key, value)
        if array.shape not in (shape, (knots, *shape)):
            raise ShapeError(key, array.shape, f"{shape} or {(knots, *shape)}")
        arrays.append(np.ascontiguousarray(np.broadcast_to(array, (knots, *shape))))
    return arrays
