"""The front of inverse kinematics: what users ask for becomes a `Solver`, compiled once for each kind of question."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, final

import numpy as np

from ulna.errors import InputError, ShapeError, UnknownName
from ulna.ik import search
from ulna.ik.approach import approach
from ulna.ik.goal import mask_of
from ulna.ik.problem import Problem
from ulna.ik.result import IKSolution
from ulna.ik.verdict import judge
from ulna.model import Model
from ulna.spatial.check import checked_rotation
from ulna.trace import compile
from ulna.typing import Floats

REST = ("rest", "home", "ready", "qr", "half_sitting", "standing")
"""Names of configurations that a search sets out from, the first that the robot has."""

_BATCH = 64  # goals from which marching together beats racing one by one
_FEW = 16  # goals left over that race
_ROUNDS = 12  # looks at a batch before the goals left over race


@final
class Solver:
    """Inverse kinematics of one robot for one kind of question: which frames, what of them, which joints."""

    def __init__(
        self, model: Model, frames: Sequence[str], masks: Sequence[Any] | None, joints: Sequence[str] | None
    ) -> None:
        """The arguments are those of `robot.ik`, with `frames` as names."""
        self.problem = _problem(model, frames, masks, joints)
        self._race = compile(search.race(self.problem), checked=True)
        self._settings: dict[Any, Floats] = {}
        self._shifts: dict[Any, Floats] = {}
        self._rest = rest(self.problem)
        self._status = model.nq

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
        settings = self._settings.get(key)
        if settings is None:
            settings = self._settings[key] = _settings(*key)
        shift = self._shifts.get(seed)
        if shift is None:
            shift = self._shifts[seed] = np.random.default_rng(seed).random(len(self.problem.drawn))
        if type(T) is not np.ndarray:
            T = _matrix(T)
        single = len(self.problem.frames) == 1
        rows = T.ndim - (2 if single else 3)
        if q0 is None and rows > 0 and T.size >= _BATCH * 16 * len(self.problem.frames):
            raw = self._march(T, shift, settings, threads)
        else:
            start = self._rest if q0 is None else q0
            options = {} if threads is None else {"threads": threads}
            raw = self._race(T, start, shift, settings, **options)
        if raw.ndim == 1:
            if raw[self._status] < 0.5:
                raw = self._nearest(T, raw, settings)
        elif (raw[..., self._status] < 0.5).any():
            raw = self._nearest(T, raw, settings)
        return IKSolution(self.problem, raw)

    def _march(self, T: Any, shift: Floats, settings: Floats, threads: int | None) -> Floats:
        """All goals go on together, a few steps at a time; those that have arrived step out, the last few race."""
        core = self.problem.shapes["T"]
        if T.shape[T.ndim - len(core) :] != core:
            raise ShapeError("T", T.shape, _shown(core))
        batch = T.shape[: T.ndim - len(core)]
        goals = np.ascontiguousarray(T, dtype=float).reshape(-1, *core)
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

    def _nearest(self, T: Any, raw: Floats, settings: Floats) -> Floats:
        """For goals that are not met, the nearest that can be had from where the search ended.

        Raises:
            InputError: If a goal is no pose.
        """
        core = self.problem.shapes["T"]
        T = np.asarray(T, dtype=float)
        flat, nq = raw.reshape(-1, raw.shape[-1]).copy(), self.problem.model.nq
        goals = np.broadcast_to(T, (*raw.shape[:-1], *core)).reshape(-1, *core)
        if (flat[:, nq] < -0.5).any():
            _refuse(T)
        missed = flat[:, nq] < 0.5
        found = flat[missed]
        q = self._approach(goals[missed], found[:, :nq])
        flat[missed] = self._judge(goals[missed], found[:, :nq], settings, q, found[:, nq + 1 : nq + 3])
        return flat.reshape(raw.shape)

    @cached_property
    def _marching(self) -> Any:
        return compile(search.march(self.problem), checked=False)

    @cached_property
    def _judge(self) -> Any:
        return compile(judge(self.problem), checked=True)

    @cached_property
    def _approach(self) -> Any:
        return compile(approach(self.problem))


def named_goals(T: Any, frame: Any, mask: Any) -> tuple[Any, tuple[str | None, ...], tuple[Any, ...] | None]:
    """Goals, names of their frames and their masks, out of what users may pass: see `robot.ik`."""
    if isinstance(T, Mapping):
        if frame is not None:
            raise InputError(f"`T` names the frames {list(T)}, so `frame` must be None; it is {frame!r}.")
        if not T:
            raise InputError("`T` is an empty dictionary; expected a pose for at least one frame.")
        names = tuple(T)
        T = np.stack([_matrix(pose) for pose in T.values()], axis=-3) if len(T) > 1 else _matrix(T[names[0]])
    elif isinstance(frame, (list, tuple)):
        names = tuple(frame)
        if not names:
            raise InputError("`frame` is empty; expected the name of a frame, or several.")
        if len(names) == 1:
            T = _matrix(T)
            T = T[..., 0, :, :] if T.ndim > 2 and T.shape[-3] == 1 else T
    else:
        names = (frame,)
    several = isinstance(mask, Mapping) or (
        isinstance(mask, (list, tuple)) and any(not isinstance(m, (int, float)) for m in mask)
    )
    if mask is None:
        return T, names, None
    if not several:
        return T, names, (_key(mask),) * len(names)
    if isinstance(mask, Mapping):
        for key in mask:
            if key not in names:
                raise UnknownName("frame of `mask`", key, [str(n) for n in names])
        return T, names, tuple(_key(mask.get(name, "pose")) for name in names)
    if len(mask) != len(names):
        raise InputError(f"`mask` has {len(mask)} entries for {len(names)} frames; expected one for each.")
    return T, names, tuple(_key(m) for m in mask)


def rest(problem: Problem) -> Floats:
    """The configuration a search without `q0` sets out from: a named one, or neutral, or the middle of the limits."""
    model = problem.model
    for name in REST:
        if name in model.configurations:
            return np.array(model.configurations[name])
    q = model.neutral.copy()
    low, high = problem.range
    inside = (q[problem.drawn] >= low) & (q[problem.drawn] <= high)
    q[problem.drawn] = np.where(inside, q[problem.drawn], 0.5 * (low + high))
    return q


def _problem(
    model: Model, frames: Sequence[str], masks: Sequence[Any] | None, joints: Sequence[str] | None
) -> Problem:
    found = tuple(model.frame(name) for name in frames)
    if len({f.name for f in found}) < len(found):
        raise InputError(f"`frame` names {list(frames)}; a frame can have one goal only.")
    moved = sorted({i for f in found for i in model.support(f.joint)})
    moved = sorted({model.joint_index(_source(model, i)) for i in moved})
    if joints is not None:
        allowed = {model.joint_index(name) for name in joints}
        followers = [name for name in joints if model.joint(name).mimic is not None]
        if followers:
            raise InputError(f"`joints` names {followers[0]!r}, which follows another joint; name that one.")
        moved = [i for i in moved if i in allowed]
    if not moved:
        raise InputError(f"No joint that may move carries {', '.join(f.name for f in found)}.")
    chosen = tuple(mask_of(m) for m in masks or ["pose"] * len(found))
    problem = Problem(model, found, chosen, tuple(moved))
    n = len(problem.velocities)
    if masks is None and problem.rows > n:
        raise InputError(
            f"{', '.join(f.name for f in found)} is moved by {n} joint coordinates, too few for all {problem.rows} "
            'directions of its goal. Say what counts: mask="position", mask="position+z" (and where the tool\'s z axis '
            'points), mask="z", or six weights (x, y, z, rx, ry, rz). mask="pose" asks for the whole pose all the same.'
        )
    return problem


def _source(model: Model, index: int) -> str:
    """Name of the joint that moves joint `index`: itself, or the one it follows."""
    joint = model.joints[index]
    if joint.mimic is None:
        return joint.name
    return next(j.name for j in model.joints if j.mimic is None and j.idx_v == joint.idx_v)


def _settings(position_tolerance: float, rotation_tolerance: float, attempts: int, is_free: bool) -> Floats:
    tolerances = {
        "position_tolerance": (position_tolerance, "length above 0 in metres"),
        "rotation_tolerance": (rotation_tolerance, "angle above 0 in radians"),
    }
    for name, (value, expected) in tolerances.items():
        if not (isinstance(value, (int, float, np.number)) and 0.0 < value < float("inf")):
            raise InputError(f"`{name}` is {value!r}; expected a {expected}.")
    if not isinstance(attempts, (int, np.integer)) or attempts < 1:
        raise InputError(f"`attempts` is {attempts!r}; expected a whole number, 1 or more.")
    steps = -(-attempts // search.LANES) * search.USUAL + search.ATTEMPT
    return np.array([position_tolerance**2, rotation_tolerance**2, float(not is_free), float(steps)])


def _matrix(T: Any) -> Any:
    return np.asarray(T.matrix() if hasattr(T, "matrix") else T)


def _refuse(T: Floats) -> None:
    """Says what is wrong with goals that are no poses."""
    checked_rotation("T", T[..., :3, :3], "ulna.spatial.nearest_rotation(R)")
    rows = T[..., 3, :].reshape(-1, 4)
    wrong = rows[(rows != (0.0, 0.0, 0.0, 1.0)).any(axis=1)][0]
    mend = "" if T[..., :3, 3].any() else " The matrix looks transposed."
    raise InputError(f"`T` has the last row {wrong.tolist()}; expected [0, 0, 0, 1].{mend}")


def _shown(core: tuple[int, ...]) -> str:
    return "(" + ", ".join(["...", *map(str, core)]) + ")"


def _key(mask: Any) -> Any:
    return tuple(mask) if isinstance(mask, (list, np.ndarray)) else mask
