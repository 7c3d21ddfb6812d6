"""The solver behind `robot.ik`: one `Solver` for each set of frames, masks and joints, compiled once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.checks.first_error import without_context
from ulna.checks.values import count as check_count
from ulna.compiler import compile
from ulna.errors import ShapeError
from ulna.ik import deferred, search
from ulna.ik.acceptance import acceptance_kernel
from ulna.ik.arguments import (
    check_batch_axes,
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
from ulna.ik.result import IKSolution
from ulna.lazy import is_deferred
from ulna.model import Model
from ulna.system.cached import cached_property
from ulna.system.progress import progress
from ulna.typing import Floats

_BATCH_FROM = 64  # goals from which the lock-step batch beats one multi-start search after the other
_SINGLE_BELOW = 16  # unmet goals of a batch below which each is searched for alone
_ROUNDS = 12  # rounds of a batch before each unmet goal is searched for alone
_PART = 2**14  # goals that are solved between two reports of progress
_CACHED = 256  # seeds, and sets of tolerances, that are remembered


@final
class Solver:
    """Inverse kinematics of one robot for given frames, masks and joints."""

    def __init__(
        self, model: Model, frames: Sequence[str], masks: Sequence[Mask] | None, joints: Sequence[str] | None
    ) -> None:
        """The arguments are those of `robot.ik`.

        Args:
            model: The robot.
            frames: Names of the frames.
            masks: Which parts of each pose count; None for all.
            joints: Names of the joints that move; None for all.
        """
        self._arguments = model, tuple(frames), masks, joints
        self.problem = problem_of(model, frames, masks, joints)
        unit = tuple((1, entries) for entries in model.unit_vectors)
        self._multi_start = compile(search.multi_start(self.problem), checked=True, unit_entries=unit)
        self._settings: dict[Any, Floats] = {}
        self._shifts: dict[Any, Floats] = {}
        self._default_start = default_start(self.problem)
        self._status, self._core = model.nq, len(self.problem.shapes["T"])
        self._batch_size = _BATCH_FROM * 16 * len(self.problem.frames)  # entries of T

    def __reduce__(self) -> tuple[Any, ...]:
        return Solver, self._arguments

    def __call__(
        self,
        T: Any,
        q0: Any = None,
        position_tolerance: float = 1e-6,
        rotation_tolerance: float = 1e-6,
        seed: int = 0,
        attempts: int = 400,
        threads: int | None = None,
    ) -> IKSolution:
        """Solves for goals; see `robot.ik`.

        Args:
            T: Goals, shape (..., 4, 4), or (..., k, 4, 4) for k frames [m].
            q0: Where the first search begins, shape (..., nq) [rad, m]; None for a default.
            position_tolerance: Largest distance from the goal [m].
            rotation_tolerance: Largest angle from the goal [rad].
            seed: Seed of the drawn configurations.
            attempts: The largest number of searches.
            threads: How many threads a large batch may use; None for one.

        Returns:
            The solution.
        """
        key = (position_tolerance, rotation_tolerance, attempts, q0 is None)
        try:
            settings, shift = self._settings[key], self._shifts[seed]
        except (KeyError, TypeError):  # not seen before, or not a number
            with without_context():
                settings = _remember(self._settings, key, search_settings(*key))
                shift = _remember(self._shifts, seed, shift_of(seed, self.problem))
        if type(T) is not np.ndarray or (q0 is not None and type(q0) is not np.ndarray):
            if is_deferred(T) or is_deferred(q0):
                options = (position_tolerance, rotation_tolerance, seed, attempts, threads)
                return IKSolution(self.problem, deferred.solve(self, self.problem, T, q0, options))
            T = matrix_of(T)
        try:
            raw = self._searched(T, q0, shift, settings, threads)
        except ShapeError:
            poses = poses_of_parts(T, self.problem)
            if poses is not None:
                return self(poses, q0, position_tolerance, rotation_tolerance, seed, attempts, threads)
            check_goal_shape(T, self.problem)
            check_batch_axes(T, q0, self.problem)
            raise
        if raw.ndim == 1:
            if raw[self._status] < 0.5:
                raw = self._nearest(T, raw, shift, settings, None)
        elif (raw[..., self._status] < 0.5).any():
            raw = self._nearest(T, raw, shift, settings, threads)
        return IKSolution(self.problem, raw)

    def _searched(self, T: Any, q0: Any, shift: Floats, settings: Floats, threads: int | None) -> Floats:
        """What the search finds, as `search.multi_start` has it; large batches in parts."""
        if T.ndim > self._core and T.size >= self._batch_size:
            return self._search_in_parts(T, q0, shift, settings, threads)
        start = self._default_start if q0 is None else q0
        if threads is None:
            return self._multi_start(T, start, shift, settings)
        return self._multi_start(T, start, shift, settings, threads=threads)

    def _search_in_parts(
        self, T: Any, q0: Any, shift: Floats, settings: Floats, threads: int | None
    ) -> Floats:
        """A large batch part by part, so that progress is shown and Ctrl-C is heard in between."""
        solve = self._search_batch if q0 is None else self._search_near
        core = self.problem.shapes["T"]
        try:
            start = np.zeros(self.problem.model.nq) if q0 is None else np.asarray(q0)
            batch = np.broadcast_shapes(T.shape[: T.ndim - len(core)], start.shape[:-1])
        except ValueError:
            return solve(T, q0, shift, settings, threads)  # raises and says why
        count = int(np.prod(batch))
        if count <= _PART or T.shape[T.ndim - len(core) :] != core:
            return solve(T, q0, shift, settings, threads)
        goals = np.broadcast_to(T, (*batch, *core)).reshape(-1, *core)
        starts = None if q0 is None else np.broadcast_to(start, (*batch, start.shape[-1])).reshape(count, -1)
        out = np.empty((count, 0))
        with progress("Inverse kinematics") as report:
            for first in range(0, count, _PART):
                part = slice(first, min(first + _PART, count))
                raw = solve(goals[part], None if starts is None else starts[part], shift, settings, threads)
                out = np.empty((count, raw.shape[-1])) if first == 0 else out
                out[part] = raw
                report(part.stop, count)
        return out.reshape(*batch, -1)

    def _search_near(self, T: Any, q0: Any, shift: Floats, settings: Floats, threads: int | None) -> Floats:
        options = {} if threads is None else {"threads": threads}
        return self._multi_start(T, q0, shift, settings, **options)

    def _search_batch(self, T: Any, q0: Any, shift: Floats, settings: Floats, threads: int | None) -> Floats:
        """All goals advance in lock-step; those that are met are removed, the last few use multi-start."""
        core = self.problem.shapes["T"]
        T = batched_array("T", T, core)
        batch = T.shape[: T.ndim - len(core)]
        goals = np.ascontiguousarray(T).reshape(-1, *core)
        start_q, n = self._default_start, len(self.problem.positions)
        q, counts = np.tile(start_q, (len(goals), 1)), np.zeros((len(goals), 2))
        state = np.tile(
            np.concatenate([start_q[self.problem.positions], [0.0, 0.0, 1e300, 0.0, 0.0]]),
            (len(goals), 1),
        )
        unmet, open_goals = np.arange(len(goals)), goals
        for _ in range(_ROUNDS):
            state = self._batch_steps(open_goals, start_q, shift, settings, state, threads=threads)
            met = state[:, n + 3] > 0.5
            done = unmet[met]
            q[done[:, None], self.problem.positions] = state[met, :n]
            counts[done, 0], counts[done, 1] = state[met, n + 4], state[met, n]
            unmet, state, open_goals = unmet[~met], state[~met], open_goals[~met]
            if len(unmet) < _SINGLE_BELOW:
                break
        out = self._accept(goals, start_q, settings, q, counts, threads=threads)
        if len(unmet):
            out[unmet] = self._multi_start(open_goals, start_q, shift, settings, threads=threads)
        return out.reshape(*batch, -1)

    def _nearest(self, T: Any, raw: Floats, shift: Floats, settings: Floats, threads: int | None) -> Floats:
        """For goals that are not met, the nearest that can be had from where the search ended, by the same kernel.

        Raises:
            InputError: If a goal is no pose.
        """
        core, nq = self.problem.shapes["T"], self.problem.model.nq
        T = np.asarray(T, dtype=float)
        if (raw[..., nq] < -0.5).any():
            raise_invalid_pose(T)
        descent = np.array([*settings[:3], -search.DESCENT])
        effort = slice(nq + 1, nq + 3)  # steps and starting point: those of the search
        if raw.ndim == 1:
            nearest = self._multi_start(T, raw[:nq], shift, descent)
            nearest[effort] = raw[effort]
            return nearest
        flat = raw.reshape(-1, raw.shape[-1]).copy()
        goals = np.broadcast_to(T, (*raw.shape[:-1], *core)).reshape(-1, *core)
        missed = flat[:, nq] < 0.5
        nearest = self._search_in_parts(goals[missed], flat[missed, :nq], shift, descent, threads)
        nearest[:, effort] = flat[missed, effort]
        flat[missed] = nearest
        return flat.reshape(raw.shape)

    @cached_property
    def _batch_steps(self) -> Any:
        return compile(search.batch_steps(self.problem), checked=False)

    @cached_property
    def _accept(self) -> Any:
        return compile(acceptance_kernel(self.problem), checked=True)


def search_settings(
    position_tolerance: float,
    rotation_tolerance: float,
    attempts: int,
    is_free: bool,
    lanes: int = search.LANES,
) -> Floats:
    """The settings that `search.multi_start` takes, (4,).

    Args:
        position_tolerance: Largest distance from the goal [m].
        rotation_tolerance: Largest angle from the goal [rad].
        attempts: About how many starting points are tried.
        is_free: Whether the first solution met is taken, wherever it is, instead of one near the start.
        lanes: How many attempts are under way at once.

    Returns:
        The settings, (4,).

    Raises:
        InputError: If a tolerance or the number of attempts means nothing.
    """
    check_tolerances(position_tolerance, rotation_tolerance)
    check_count("attempts", attempts)
    steps = -(-attempts // lanes) * search.MEAN_STEPS + search.ATTEMPT_STEPS
    squared = squared_tolerances(position_tolerance, rotation_tolerance)
    return np.array([*squared, float(not is_free), float(steps)])


def _remember(known: dict[Any, Floats], key: Any, value: Floats) -> Floats:
    if len(known) >= _CACHED:
        known.clear()
    known[key] = value
    return value
