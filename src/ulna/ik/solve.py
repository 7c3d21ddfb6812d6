"""The front of inverse kinematics: what users ask for becomes a `Solver`, compiled once for each kind of question."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.compiler import compile
from ulna.errors import ShapeError
from ulna.ik import search
from ulna.ik.goal import Mask, squared_tolerances
from ulna.ik.question import (
    check_count,
    check_tolerances,
    matrix_of,
    poses_of_parts,
    problem_of,
    refuse,
    refuse_batch,
    refuse_shape,
    rest,
    shift_of,
)
from ulna.ik.result import IKSolution
from ulna.ik.verdict import judge
from ulna.model import Model
from ulna.system.cached import cached_property
from ulna.typing import Floats

_BATCH = 64  # goals from which marching together beats racing one by one
_FEW = 16  # goals left over that race
_ROUNDS = 12  # looks at a batch before the goals left over race
_KEPT = 256  # seeds, and sets of tolerances, that are remembered


@final
class Solver:
    """Inverse kinematics of one robot for one kind of question: which frames, what of them, which joints."""

    def __init__(
        self, model: Model, frames: Sequence[str], masks: Sequence[Mask] | None, joints: Sequence[str] | None
    ) -> None:
        """The arguments are those of `robot.ik`, with `frames` as names."""
        self.problem = problem_of(model, frames, masks, joints)
        unit = tuple((1, entries) for entries in model.quaternions)
        self._race = compile(search.race(self.problem), checked=True, unit_entries=unit)
        self._settings: dict[Any, Floats] = {}
        self._shifts: dict[Any, Floats] = {}
        self._rest = rest(self.problem)
        self._status, self._core = model.nq, len(self.problem.shapes["T"])

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
        """Solves for goals T (..., 4, 4), or (..., k, 4, 4) for k frames; see `robot.ik`."""
        key = (position_tolerance, rotation_tolerance, attempts, q0 is None)
        try:
            settings, shift = self._settings[key], self._shifts[seed]
        except (KeyError, TypeError):  # not met before, or no number at all
            settings = _remember(self._settings, key, _settings(*key))
            shift = _remember(self._shifts, seed, shift_of(seed, self.problem))
        if type(T) is not np.ndarray:
            T = matrix_of(T)
        try:
            if q0 is None and T.ndim > self._core and T.size >= _BATCH * 16 * len(self.problem.frames):
                raw = self._march(T, shift, settings, threads)
            else:
                start = self._rest if q0 is None else q0
                if threads is None:
                    raw = self._race(T, start, shift, settings)
                else:
                    raw = self._race(T, start, shift, settings, threads=threads)
        except ShapeError:
            poses = poses_of_parts(T, self.problem)
            if poses is not None:
                return self(poses, q0, position_tolerance, rotation_tolerance, seed, attempts, threads)
            refuse_shape(T, self.problem)
            refuse_batch(T, q0, self.problem)
            raise
        if raw.ndim == 1:
            if raw[self._status] < 0.5:
                raw = self._nearest(T, raw, shift, settings, None)
        elif (raw[..., self._status] < 0.5).any():
            raw = self._nearest(T, raw, shift, settings, threads)
        return IKSolution(self.problem, raw)

    def _march(self, T: Any, shift: Floats, settings: Floats, threads: int | None) -> Floats:
        """All goals go on together, a few steps at a time; those that have arrived step out, the last few race."""
        core = self.problem.shapes["T"]
        T = batched_array("T", T, core)
        batch = T.shape[: T.ndim - len(core)]
        goals = np.ascontiguousarray(T).reshape(-1, *core)
        rest, n = self._rest, len(self.problem.positions)
        q, told = np.tile(rest, (len(goals), 1)), np.zeros((len(goals), 2))
        state = np.tile(
            np.concatenate([rest[self.problem.positions], [0.0, 0.0, 1e300, 0.0, 0.0]]), (len(goals), 1)
        )
        left, asked = np.arange(len(goals)), goals
        for _ in range(_ROUNDS):
            state = self._marching(asked, rest, shift, settings, state, threads=threads)
            met = state[:, n + 3] > 0.5
            there = left[met]
            q[there[:, None], self.problem.positions] = state[met, :n]
            told[there, 0], told[there, 1] = state[met, n + 4], state[met, n]
            left, state, asked = left[~met], state[~met], asked[~met]
            if len(left) < _FEW:
                break
        out = self._judge(goals, rest, settings, q, told, threads=threads)
        if len(left):
            out[left] = self._race(asked, rest, shift, settings, threads=threads)
        return out.reshape(*batch, -1)

    def _nearest(self, T: Any, raw: Floats, shift: Floats, settings: Floats, threads: int | None) -> Floats:
        """For goals that are not met, the nearest that can be had from where the search ended, by the same kernel.

        Raises:
            InputError: If a goal is no pose.
        """
        core, nq = self.problem.shapes["T"], self.problem.model.nq
        T = np.asarray(T, dtype=float)
        if (raw[..., nq] < -0.5).any():
            refuse(T)
        descent = np.array([*settings[:3], -search.DESCENT])
        effort = slice(nq + 1, nq + 3)  # steps and starting point: those of the search
        if raw.ndim == 1:
            nearest = self._race(T, raw[:nq], shift, descent)
            nearest[effort] = raw[effort]
            return nearest
        flat = raw.reshape(-1, raw.shape[-1]).copy()
        goals = np.broadcast_to(T, (*raw.shape[:-1], *core)).reshape(-1, *core)
        missed = flat[:, nq] < 0.5
        nearest = self._race(goals[missed], flat[missed, :nq], shift, descent, threads=threads)
        nearest[:, effort] = flat[missed, effort]
        flat[missed] = nearest
        return flat.reshape(raw.shape)

    @cached_property
    def _marching(self) -> Any:
        return compile(search.march(self.problem), checked=False)

    @cached_property
    def _judge(self) -> Any:
        return compile(judge(self.problem), checked=True)


def _settings(position_tolerance: float, rotation_tolerance: float, attempts: int, is_free: bool) -> Floats:
    check_tolerances(position_tolerance, rotation_tolerance)
    check_count("attempts", attempts)
    steps = -(-attempts // search.LANES) * search.USUAL + search.ATTEMPT
    squared = squared_tolerances(position_tolerance, rotation_tolerance)
    return np.array([*squared, float(not is_free), float(steps)])


def _remember(known: dict[Any, Floats], key: Any, value: Floats) -> Floats:
    if len(known) >= _KEPT:
        known.clear()
    known[key] = value
    return value
