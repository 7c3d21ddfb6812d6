"""The search for a configuration: damped least squares from many starting points at once, in the lanes of a register.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| lambda | damping: grows with the error, vanishes at the goal | [m^2] | Sugihara 2011, eq. 18 |
| u_s | starting point number s: frac(s alpha + u_0), with alpha_j = phi^-j, phi^(d+1) = phi + 1 | [0, 1)^d | Roberts
2018, the sequence R_d |

An attempt that has not arrived after `ATTEMPT_STEPS` steps, or has stalled, is replaced by the next starting point.
All lanes search for a single goal; the goals of a batch advance in lock-step, one in each lane.

Where no attempt arrives, the same code descends from the best of them to a local minimum of the squared error, with a
damping after Marquardt's rule, so that no step leads away (Nocedal & Wright 2006, section 10.3). A negative number
of steps selects it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ulna import numeric
from ulna.compiler import Function, trace
from ulna.compiler.forms.lanes import choose, in_any_lane, lane, least
from ulna.errors import InputError
from ulna.ik.acceptance import acceptance, are_rotations, unwound
from ulna.ik.problem import Errors, Problem, errors, step
from ulna.typing import Array, Floats

LANES = 8
ATTEMPT_STEPS = 24  # steps: most attempts that succeed do so within 12
MEAN_STEPS = 10  # steps that an attempt takes in the mean
STALL_STEPS = 7  # steps before an attempt may count as stalled
STALL_RATIO = 0.8  # the part of the squared error that may remain after a step for it to count as progress
BATCH_STEPS = 4  # steps of a batch between two removals of the goals that are met
NEAR_START = 1.0  # rad or m: how near to q0 an answer must be to be taken before other lanes have answered
_DAMPING = 0.04  # tuned on Panda, UR5 and an arm of Talos for the fewest steps in the mean
_MIN_DAMPING = 1e-9
_INFINITE_ERROR = 1e300
DESCENT = 400  # evaluations of the error until a descent ends
_FIRST, _SMALLEST, _LARGEST = 0.03, 1e-9, 1e6  # damping of a descent, in squares of the problem's length


class Attempt(NamedTuple):
    """The state of the search in one lane."""

    q: Array
    """Configuration, (nq,)."""
    number: Any
    """Number of the starting point it started from."""
    age: Any
    """How many steps ago; in a descent the damping [m^2]."""
    before: Any
    """Squared error before the last step [m^2]; in a descent 1 where the best configuration is evaluated again."""
    is_met: Any
    """1 if the goals are met, or a descent has ended, else 0."""
    best: Array
    """The configuration with the least error so far, or the one that meets the goals, (nq,)."""
    least: Any
    """Its squared error [m^2]."""

    def flat(self, problem: Problem) -> tuple[Any, ...]:
        """As numbers, those of `q` and `best` that can change."""
        return (
            *self.q[problem.positions],
            *self.best[problem.positions],
            self.number,
            self.age,
            self.before,
            self.is_met,
            self.least,
        )

    @classmethod
    def of(cls, problem: Problem, q0: Array, flat: Sequence[Any]) -> Attempt:
        """The inverse of `flat`; what cannot change comes from `q0`.

        Args:
            problem: The problem.
            q0: Configuration (nq,) [rad or m].
            flat: The numbers, in the order of `flat`.

        Returns:
            The attempt.
        """
        n = len(problem.positions)
        number, age, before, is_met, smallest = flat[2 * n :]
        q, best = problem.replaced(q0, flat[:n]), problem.replaced(q0, flat[n : 2 * n])
        return cls(q, number, age, before, is_met, best, smallest)

    @classmethod
    def first(cls, q: Array, number: Any) -> Attempt:
        """An attempt before its first step.

        Args:
            q: Configuration (nq,) [rad or m].
            number: Number of the starting point.

        Returns:
            The attempt.
        """
        return cls(q, number, 0.0, _INFINITE_ERROR, 0.0, q, _INFINITE_ERROR)


def starting_point(problem: Problem, q0: Array, shift: Array, number: Any, radius: Any) -> Array:
    """Starting point `number`: a point of the ranges, drawn towards `q0` by the fraction 1 - `radius`.

    Args:
        problem: The problem, with the ranges of the coordinates.
        q0: Configuration (nq,) [rad or m].
        shift: Where the sequence begins, (d,) of [0, 1).
        number: Number of the starting point.
        radius: 0 for `q0` itself, up to 1 for the whole ranges.

    Returns:
        Configuration (nq,) [rad or m].
    """
    low, high = problem.range
    alpha = _golden(len(low))
    out = np.array(q0, dtype=object)
    for j, i in enumerate(problem.drawn):
        turns = number * alpha[j] + shift[j]
        there = low[j] + (high[j] - low[j]) * (turns - np.floor(turns))
        out[i] = q0[i] + radius * (there - q0[i])
    return out


def _golden(d: int) -> Floats:
    phi = 2.0
    for _ in range(60):
        phi = (1.0 + phi) ** (1.0 / (d + 1))
    return phi ** -np.arange(1.0, d + 1.0)


def advance(
    problem: Problem,
    now: Attempt,
    q0: Array,
    goals: Array,
    tolerances: Array,
    shift: Array,
    near: Any,
    stride: float,
    descends: Any = None,
) -> Attempt:
    """One step of an attempt, or the beginning of the next one; `stride` starting points lie between the two.

    Where `descends` is given and holds, it is a step of a descent instead.

    Args:
        problem: The problem.
        now: The attempt.
        q0: Configuration (nq,) [rad or m] that starting points are drawn about.
        goals: Goals of the frames, (k, 4, 4).
        tolerances: Those of `goal.squared_tolerances`, (2,) [m^2, rad^2].
        shift: Where the sequence of starting points begins, (d,).
        near: 1 to begin near `q0` and draw from growing regions, 0 to draw from the whole ranges.
        stride: Number of lanes that share the sequence [-].
        descends: Condition under which it is a step of a descent; None for a search.

    Returns:
        The attempt after the step.
    """
    at = errors(problem, now.q, goals, tolerances)
    scale = problem.length**2
    damping = _DAMPING * at.squared + _MIN_DAMPING * scale
    lower = None if descends is None else descent(now, at.squared, scale)
    if lower is not None:
        damping = numeric.where(descends, lower.damping, damping)
    q = step(problem, now.q, at, damping)
    over = _is_over(now, at)
    following = now.number + stride
    start = starting_point(problem, q0, shift, following, _draw_radius(following, near))
    better = at.is_met | (at.squared < now.least)
    keeps, restarts = at.is_met, over
    age, before = numeric.where(over, 0.0, now.age + 1.0), numeric.where(over, _INFINITE_ERROR, at.squared)
    is_met = numeric.where(at.is_met, 1.0, 0.0)
    if lower is not None and descends is not None:
        chosen = partial(numeric.where, descends)
        keeps, restarts = keeps & ~descends, chosen(lower.is_worse, over)
        start = chosen(now.best, start)
        age, before = chosen(lower.damping, age), chosen(lower.is_worse, before)
        is_met = chosen(lower.is_over, is_met)
    return Attempt(
        numeric.where(keeps, now.q, numeric.where(restarts, start, q)),
        numeric.where(over, following, now.number),
        age,
        before,
        is_met,
        numeric.where(better, now.q, now.best),
        numeric.where(better, at.squared, now.least),
    )


def _is_over(now: Attempt, at: Errors) -> Any:
    """Whether an attempt ends without success: it has been long, or comes no nearer."""
    stalled = (now.age >= STALL_STEPS) & (at.squared > STALL_RATIO * now.before)
    return ((now.age >= float(ATTEMPT_STEPS)) | stalled) & ~at.is_met


class Descent(NamedTuple):
    """The next state of a descent after one evaluation of the error."""

    damping: Any
    """For the next step [m^2]."""
    is_worse: Any
    """Whether the last step led away, so that the best configuration is evaluated again."""
    is_over: Any
    """Whether the error changes no more."""


def descent(now: Attempt, squared: Any, scale: float) -> Descent:
    """Marquardt's rule, where `squared` is the squared error at `now.q` [m^2].

    Args:
        now: The attempt.
        squared: Squared error at `now.q` [m^2].
        scale: Square of the length that a radian counts [m^2].

    Returns:
        Damping [m^2], whether to return to the best configuration, and whether the descent is over.
    """
    again = now.before > 0.5
    nearer = (squared < now.least) & ~again
    worse = ~(squared < now.least) & ~again
    damping = numeric.where(nearer, 0.2 * now.age, numeric.where(worse, 5.0 * now.age, now.age))
    slow = now.least - squared < 1e-12 * now.least
    over = (nearer & slow) | (damping >= _LARGEST * scale)
    return Descent(numeric.maximum(damping, _SMALLEST * scale), worse, over)


def _draw_radius(number: Any, near: Any) -> Any:
    """How far from q0 starting point `number` may lie, 0 to 1: with `near` (1, else 0) growing from 0, else 1."""
    widening = numeric.minimum(number * (1.0 / (2 * LANES)), 1.0)
    return numeric.where(number < 0.5, 0.0, 1.0 - near * (1.0 - widening))


def multi_start(problem: Problem, lanes: int = LANES) -> Function:
    """The search of one goal in all lanes.

    Inputs: goals T, (4, 4) or for k > 1 frames (k, 4, 4), q0 (nq,), shift (d,) of the starting points, and settings
    (4,): `goal.squared_tolerances`, 1 to stay near q0 else 0, the greatest number of steps; less than zero for a
    descent from q0 of so many.

    Output: (nq + 3 + 2 k,): q, whether it meets the goals (-1: a goal is no rotation), steps, number of the starting
    point, and for each frame the errors of position [m] and rotation [rad].

    Args:
        problem: The problem.
        lanes: How many attempts are under way at once, 1, 2, 4 or 8.

    Returns:
        The search as a function, not compiled.

    Raises:
        InputError: For another number of lanes.
    """
    if lanes not in (1, 2, 4, 8):
        raise InputError(f"`lanes` is {lanes!r}; expected 1, 2, 4 or 8.")

    def search(T: Array, q0: Array, shift: Array, settings: Array) -> Array:
        goals, tolerances, near, limit = problem.goals(T), settings[:2], settings[2], abs(settings[3])
        descends = settings[3] < 0.0
        home = problem.clip(q0)
        number = lane(lanes)
        start = starting_point(problem, home, shift, number, _draw_radius(number, near))
        first = Attempt.first(start, number)._replace(
            age=numeric.where(descends, _FIRST * problem.length**2, 0.0),
            before=numeric.where(descends, 1.0, _INFINITE_ERROR),
        )
        is_valid = are_rotations(goals)

        def go_on(*state: Any) -> Any:
            now, steps = Attempt.of(problem, home, state[:-1]), state[-1]
            is_met = now.is_met > 0.5
            close = (number < 0.5) & (_offset(problem, now.q, home) < NEAR_START**2)
            is_over = is_met & ((near < 0.5) | close | (steps > float(ATTEMPT_STEPS)))
            is_over = numeric.where(descends, is_met & (number < 0.5), is_over)
            return (steps < limit) & is_valid & ~in_any_lane(is_over)

        def body(*state: Any) -> tuple[Any, ...]:
            now = Attempt.of(problem, home, state[:-1])
            then = advance(problem, now, home, goals, tolerances, shift, near, float(lanes), descends)
            return (*then.flat(problem), state[-1] + 1.0)

        state = numeric.loop(go_on, body, (*first.flat(problem), 0.0), 2**30)
        last, steps = Attempt.of(problem, home, state[:-1]), state[-1]
        chosen = number == _best_lane(last, near * _offset(problem, last.best, home), number, descends, lanes)
        q = problem.replaced(home, [choose(chosen, x) for x in last.best[problem.positions]])
        q = unwound(problem, q, home, near)
        chosen_number = choose(chosen, last.number)
        return numeric.vector(*q, *acceptance(problem, q, goals, tolerances, is_valid, steps, chosen_number))

    shapes: dict[str, Any] = {**problem.shapes, "shift": (len(problem.drawn),), "settings": (4,)}
    return trace(search, name="ik", lanes=lanes, **shapes)


def _offset(problem: Problem, q: Array, home: Array) -> Any:
    """Squared distance of the joints that are drawn from where they begin."""
    return sum(((q[i] - home[i]) * (q[i] - home[i]) for i in problem.drawn), 0.0)


def _best_lane(last: Attempt, cost: Any, number: Any, descends: Any, lanes: int) -> Any:
    """The lane that meets the goals at the least cost, or has the least error; lane 0 for a descent, which is there."""
    is_met = last.is_met > 0.5
    rank = numeric.where(in_any_lane(is_met), numeric.where(is_met, cost, _INFINITE_ERROR), last.least)
    rank = numeric.where(descends, number, rank)
    return least(numeric.where(rank <= least(rank), number, float(lanes)))


def batch_steps(problem: Problem) -> Function:
    """`BATCH_STEPS` steps of one attempt at one goal, for batches in lock-step: state (n + 5,) in, state out.

    Inputs: as those of `multi_start`, and the state: positions of the joints that may move, number of the starting
    point, age, squared error before, whether the goals are met, steps.
    """
    n = len(problem.positions)

    def steps_of_attempt(T: Array, q0: Array, shift: Array, settings: Array, state: Array) -> Array:
        goals, home = problem.goals(T), problem.clip(q0)

        def attempt(flat: Sequence[Any]) -> Attempt:
            q = problem.replaced(home, flat[:n])
            number, age, before, is_met = flat[n : n + 4]
            return Attempt(q, number, age, before, is_met, q, _INFINITE_ERROR)

        def body(*flat: Any) -> tuple[Any, ...]:
            now = attempt(flat)
            then = advance(problem, now, home, goals, settings[:2], shift, settings[2], 1.0)
            after = (then.number, then.age, then.before, then.is_met, flat[-1] + 1.0)
            return (*then.q[problem.positions], *after)

        return numeric.vector(*numeric.loop(lambda *flat: flat[-2] < 0.5, body, tuple(state), BATCH_STEPS))

    shapes: dict[str, Any] = {
        **problem.shapes,
        "shift": (len(problem.drawn),),
        "settings": (4,),
        "state": (n + 5,),
    }
    return trace(steps_of_attempt, name="ik_batch", **shapes)
