"""The classic numerical solvers as published: one search after the other, from drawn configurations.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| e | errors p* - p and axis times angle, weighted; 1 rad counts as 1 m | (m,) | Corke & Haviland 2023 II, eq. 5 |
| J | their Jacobian, world axes | (m, n) | |
| E | e^T e / 2 | | eq. 9 |
| "newton_raphson" | dq = J^+ e | (n,) | Whitney 1969; Corke & Haviland II, eq. 8 |
| "gauss_newton" | dq = (J^T J)^+ J^T e, which is the same where J has full rank; solved so | (n,) | eq. 11 |
| "wampler" | dq = (J^T J + lambda I)^-1 J^T e | (n,) | Wampler 1986 |
| "chan" | the same with lambda E | (n,) | Chan & Lawrence 1988 |
| "sugihara" | the same with E + lambda | (n,) | Sugihara 2011, eq. 18 |
| "qp" | least |J dq - e|^2 + lambda E |dq|^2 that ends within the limits | (n,) | Corke & Haviland II, eq. 26 |
| z | what the joints would rather do: away from their limits and towards manipulability | (n,) | |
| dq_0 | (I - J^+ J) z, what they may do of it without moving the frame | (n,) | Liegeois 1977 |

A limit pushes a joint that is within `influence` of it with the gain times ((distance - influence)/influence)^2. The
limits do not bind a search, that of "qp" excepted; an answer beyond them is passed over, and the next search begins.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, final

import numpy as np

from ulna import algorithms, numeric
from ulna.checks.values import count as check_count
from ulna.compiler import Function, compile, trace
from ulna.errors import InputError, UnknownName
from ulna.ik import deferred
from ulna.ik.acceptance import acceptance, are_rotations, unwound
from ulna.ik.arguments import (
    check_goal_shape,
    check_tolerances,
    default_start,
    matrix_of,
    poses_of_parts,
    problem_of,
    raise_invalid_pose,
    shift_of,
)
from ulna.ik.goal import Mask, squared_tolerances
from ulna.ik.problem import Errors, Problem, errors
from ulna.ik.qp import solve_box
from ulna.ik.result import IKSolution
from ulna.ik.search import starting_point
from ulna.lazy import is_deferred
from ulna.linalg import solve_damped, solve_spd
from ulna.model import Model
from ulna.typing import Array

Method = Literal["newton_raphson", "gauss_newton", "wampler", "chan", "sugihara", "qp"]
DAMPING: dict[Method, float] = {
    "newton_raphson": 0.0,
    "gauss_newton": 0.0,
    "wampler": 1e-4,
    "chan": 1.0,
    "sugihara": 1e-4,
    "qp": 1.0,
}
"""The methods, with the damping that is taken where none is given."""

SETTINGS = (
    "position_tolerance", "rotation_tolerance", "iterations", "searches", "damping", "limit_gain", "influence",
    "manipulability_gain",
)  # fmt: skip
"""What the kernel takes beside goal and start, in order; the tolerances squared."""

_FADING_ERROR = 1e-3  # squared error [m^2] at which the null motion has faded to a half
_SINGULAR = 1e-14  # keeps the pseudoinverse finite where J loses rank


def classic(problem: Problem, method: Method, has_null_motion: bool) -> Function:
    """A classic solver as a kernel.

    Inputs: T and q0 as those of `search.multi_start`, shift (d,) of the starting points, settings as `SETTINGS` names
    them. Output as that of `search.multi_start`, with iterations of all searches in place of steps, and the number of
    searches that had failed before in place of the starting point.

    Args:
        problem: The problem.
        method: Name of the solver, as in the table above.
        has_null_motion: Whether the joints avoid limits and singularities with the motion that the goals leave
            free.

    Returns:
        The traced function.
    """
    n = len(problem.positions)

    def solve(T: Array, q0: Array, shift: Array, settings: Array) -> Array:
        goals, tolerances = problem.goals(T), settings[:2]
        most, searches, damping = settings[2], settings[3], settings[4]
        is_valid = are_rotations(goals)

        def go_on(*flat: Any) -> Any:
            return (flat[-1] < 0.5) & (flat[-2] < searches) & is_valid

        def body(*flat: Any) -> tuple[Any, ...]:
            q, (age, total, failed, _) = problem.replaced(q0, flat[:n]), flat[n:]
            at = errors(problem, q, goals, tolerances)
            is_met = at.is_met & _is_within(problem, q)
            over = (at.is_met | (age >= most)) & ~is_met
            gains = settings[5:8] if has_null_motion else None
            moved = problem.moved(q, _step(problem, method, q, at, damping, gains))
            start = starting_point(problem, q0, shift, failed + 1.0, 1.0)
            following = numeric.where(is_met, q, numeric.where(over, start, moved))
            return (
                *following[problem.positions],
                numeric.where(over, 0.0, age + 1.0),
                total + numeric.where(is_met, 0.0, 1.0),
                numeric.where(over, failed + 1.0, failed),
                numeric.where(is_met, 1.0, 0.0),
            )

        state = numeric.loop(go_on, body, (*q0[problem.positions], 0.0, 0.0, 0.0, 0.0), 2**30)
        q = unwound(problem, problem.replaced(q0, state[:n]), q0, 0.0)
        report = acceptance(problem, q, goals, tolerances, is_valid, state[n + 1], state[n + 2])
        within = numeric.where(_is_within(problem, q), report[0], numeric.minimum(report[0], 0.0))
        return numeric.vector(*q, within, *report[1:])

    shapes: dict[str, Any] = {**problem.shapes, "shift": (len(problem.drawn),), "settings": (len(SETTINGS),)}
    return trace(solve, name=f"ik_{method}", **shapes)


def _step(problem: Problem, method: Method, q: Array, at: Errors, damping: Any, gains: Array | None) -> Array:
    """The step of a search from q, with the null motion of these gains; None for no such motion."""
    null_velocity = None
    if gains is not None:
        # It fades near the goal, where what it does to e would keep the search from ending.
        null_velocity = _null_velocity(problem, q, *gains) * (at.squared / (at.squared + _FADING_ERROR))
    if method == "qp":
        return bounded_move(problem, q, at, damping, null_velocity)
    dq = move(at, method, damping)
    if null_velocity is not None:
        dq = dq + null_velocity - solve_damped(at.J, at.J @ null_velocity, _SINGULAR)
    return dq


def move(at: Errors, method: Method, damping: Any) -> Array:
    """The step of a search, by all methods but "qp".

    Args:
        at: Errors and Jacobian at the configuration.
        method: Name of the solver.
        damping: lambda of the table above.

    Returns:
        dq (n,) [rad or m].
    """
    if method in ("newton_raphson", "gauss_newton"):
        rows, columns = at.J.shape
        if rows > columns:  # J J^T has no inverse, J^T J has
            return solve_spd(at.J.T @ at.J + _SINGULAR * np.eye(columns), at.J.T @ at.e)
        return solve_damped(at.J, at.e, _SINGULAR)
    energy = 0.5 * at.squared
    weight = {"wampler": damping, "chan": damping * energy, "sugihara": energy + damping}[method]
    J = at.J
    return solve_spd(J.T @ J + (weight + _SINGULAR) * np.eye(J.shape[1]), J.T @ at.e)


def bounded_move(problem: Problem, q: Array, at: Errors, damping: Any, null_velocity: Array | None) -> Array:
    """The step of "qp", which ends within the limits; with `null_velocity` its objective also rewards motion along z.

    Args:
        problem: The problem, with the limits.
        q: Configuration (nq,) [rad or m].
        at: Errors and Jacobian there.
        damping: lambda of the table above.
        null_velocity: z, (n,); None for none.

    Returns:
        dq (n,) [rad or m].
    """
    lower, upper = (
        _of_velocities(problem, bound, missing)
        for bound, missing in zip(problem.limits, (-1, 1), strict=True)
    )
    here = _of_velocities(problem, q, 0)
    weight = damping * 0.5 * at.squared + _SINGULAR
    pull = at.J.T @ at.e if null_velocity is None else at.J.T @ at.e + weight * null_velocity
    H = at.J.T @ at.J + weight * np.eye(len(here))
    return solve_box(H, -pull, numeric.minimum(lower - here, 0.0), numeric.maximum(upper - here, 0.0)).x


def _of_velocities(problem: Problem, positions: Array, missing: float) -> Array:
    """The positions that belong to velocities, (n,); infinite, or 0, with the sign of `missing` where none does."""
    out = []
    for joint in (problem.model.joints[i] for i in problem.joints):
        single = joint.nq == joint.nv
        for k in range(joint.nv):
            out.append(positions[joint.idx_q + k] if single else (missing * np.inf if missing else 0.0))
    return np.array(out, dtype=getattr(positions, "dtype", float))


def _null_velocity(
    problem: Problem, q: Array, limit_gain: Any, influence: Any, manipulability_gain: Any
) -> Array:
    """z."""
    lower, upper = problem.limits
    null_velocity = np.zeros(len(problem.velocities), dtype=object)
    place = {velocity: k for k, velocity in enumerate(problem.velocities)}
    for joint in (problem.model.joints[i] for i in problem.joints):
        if joint.nq != 1 or joint.nv != 1:
            continue
        k, i = place[joint.idx_v], joint.idx_q
        for bound, sign in ((lower[i], 1.0), (upper[i], -1.0)):
            if np.isfinite(bound):
                short = numeric.minimum(sign * (q[i] - bound) - influence, 0.0) / influence
                null_velocity[k] = null_velocity[k] + sign * limit_gain * short * short
    for frame in problem.frames:
        gradient = algorithms.manipulability_gradient(problem.model, q, frame)
        null_velocity = null_velocity + manipulability_gain * gradient[problem.velocities]
    return null_velocity


def _is_within(problem: Problem, q: Array) -> Any:
    lower, upper = problem.limits
    good: Any = True
    for i in problem.positions:
        if np.isfinite(lower[i]):
            good = good & (q[i] >= lower[i])
        if np.isfinite(upper[i]):
            good = good & (q[i] <= upper[i])
    return good


@final
class ClassicSolver:
    """A classic solver of one robot for given frames, masks and joints."""

    def __init__(
        self,
        model: Model,
        frames: Sequence[str],
        masks: Sequence[Mask] | None,
        joints: Sequence[str] | None,
        method: Method,
        has_null_motion: bool,
    ) -> None:
        """The arguments are those of `robot.ik_classic`.

        Args:
            model: The robot.
            frames: Names of the frames.
            masks: Which parts of each pose count; None for all.
            joints: Names of the joints that move; None for all.
            method: The name of the method.
            has_null_motion: Whether joints keep away from limits, or seek manipulability, in the null space.

        Raises:
            UnknownName: There is no such method.
        """
        if not isinstance(method, str) or method not in DAMPING:
            raise UnknownName("method", method, DAMPING)
        self.problem = problem_of(model, frames, masks, joints, radian=1.0, by_angle=True)
        unit = tuple((1, entries) for entries in model.unit_vectors)
        self._kernel = compile(
            classic(self.problem, method, has_null_motion), checked=True, unit_entries=unit
        )
        self._default_start = default_start(self.problem)
        self._arguments = model, tuple(frames), masks, joints, method, has_null_motion

    def __reduce__(self) -> tuple[Any, ...]:
        return ClassicSolver, self._arguments

    def __call__(
        self, T: Any, q0: Any, settings: dict[str, Any], seed: int, threads: int | None
    ) -> IKSolution:
        """Solves for goals.

        Args:
            T: Goals, shape (..., 4, 4), or (..., k, 4, 4) for k frames [m].
            q0: Where the first search begins, shape (..., nq) [rad, m]; None for a default.
            settings: Values of `SETTINGS` by name.
            seed: Seed of the drawn configurations.
            threads: How many threads a large batch may use; None for one.

        Returns:
            The solution.

        Raises:
            InputError: A setting is out of range.
        """
        if is_deferred(T) or is_deferred(q0):
            options = (settings, seed, threads)
            return IKSolution(self.problem, deferred.solve(self, self.problem, T, q0, options))
        check_tolerances(settings["position_tolerance"], settings["rotation_tolerance"])
        check_count("iterations", settings["iterations"])
        check_count("searches", settings["searches"])
        for name in ("damping", "limit_gain", "influence", "manipulability_gain"):
            value = settings[name]
            if not (isinstance(value, (int, float, np.number)) and 0.0 <= value < float("inf")):
                raise InputError(f"`{name}` is {value!r}; expected a number, not below 0.")
        if not settings["influence"]:
            raise InputError("`influence` is 0; expected a number above 0.")
        numbers = np.array([float(settings[name]) for name in SETTINGS])
        numbers[:2] = squared_tolerances(settings["position_tolerance"], settings["rotation_tolerance"])
        shift = shift_of(seed, self.problem)
        goals = matrix_of(T)
        poses = poses_of_parts(goals, self.problem)
        T = goals if poses is None else poses
        check_goal_shape(T, self.problem)
        raw = self._kernel(T, self._default_start if q0 is None else q0, shift, numbers, threads=threads)
        if (raw[..., self.problem.model.nq] < -0.5).any():
            raise_invalid_pose(np.asarray(T, dtype=float))
        return IKSolution(self.problem, raw)
