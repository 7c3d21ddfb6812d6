"""Every configuration of an arm that reaches a pose: distinct, within limits, certified by forward kinematics."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache, partial
from typing import Any, final

import numpy as np

from ulna.checks.arrays import batched_array, shaped_array
from ulna.checks.masked import check_not_masked
from ulna.checks.quaternions import checked_configurations
from ulna.checks.values import count as checked_count
from ulna.checks.values import flag, number, short_repr
from ulna.checks.values import names as checked_names
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError
from ulna.ik import deferred
from ulna.ik.analytic.candidates import Source, between, source_of
from ulna.ik.analytic.solutions import SolutionFilter
from ulna.lazy import Collection, is_deferred
from ulna.model import Model
from ulna.spatial import SE3
from ulna.typing import ArrayLike, Floats

_ONE = np.zeros(1)
_ROWS = 100_000  # configurations processed together, which bounds memory


@final
@dataclass(frozen=True, eq=False)
class Branches(Collection):
    """The solutions of one pose, or of a batch of poses.

    Of one pose, the arrays hold exactly its solutions; of a batch, each pose has as many rows as the most any
    of them has, and unused rows are nan. `batch[i]` are the solutions of pose i.

    Of a Dask array of poses all arrays are Dask arrays, with as many rows for each pose as it can have solutions.

    Attributes:
        q: Configurations, (..., k, nq) [rad or m], the nearest to `q0` first where it was given.
        position_error: Their distance from the goal by forward kinematics, (..., k) [m].
        rotation_error: Their angle from the goal, (..., k) [rad].
        total: How many distinct configurations reach the pose, those outside the limits counted, (...).
        miss: Errors of the nearest candidate, (..., 2) [m, rad].
        complete: Whether these are all there are: not of redundant arms, nor of those solved from random starts.
        method: The method, as text.
    """

    q: Floats
    position_error: Floats
    rotation_error: Floats
    total: Any
    miss: Floats
    complete: bool
    method: str

    def _arrays(self) -> tuple[Any, ...]:
        arrays = (self.q, self.position_error, self.rotation_error, self.total, self.miss)
        return arrays if isinstance(self.complete, bool) else (*arrays, self.complete)

    def _with_arrays(self, arrays: Sequence[Any]) -> Branches:
        q, position_error, rotation_error, total, miss, complete = arrays
        is_complete = complete if is_deferred(complete) else bool(complete)
        return Branches(q, position_error, rotation_error, total, miss, is_complete, self.method)

    @property
    def count(self) -> Any:
        """How many solutions there are, (...)."""
        return np.isfinite(self.position_error).sum(axis=-1)

    @property
    def found(self) -> Any:
        """The former name of `total`."""
        return self.total

    @property
    def reason(self) -> Any:
        """Why there is no solution, as text; "" where there is one. A list of such for a batch."""
        self._require_numbers("reason")
        if self.q.ndim > 2:
            return [self[i].reason for i in range(len(self.q))]
        if self.count:
            return ""
        if self.total:
            return (
                f"{self.total} configurations reach the pose, each with a joint outside its limits "
                "(ik_all(T, limits=False) returns them)"
            )
        return (
            f"no configuration reaches the pose: the nearest candidate misses it by {self.miss[0]:.3g} m and "
            f"{self.miss[1]:.3g} rad"
        )

    def __len__(self) -> int:
        """How many solutions a pose has; how many poses a batch."""
        return len(self.q)

    def __iter__(self) -> Iterator[Any]:
        """The configurations of a pose; the poses of a batch."""
        return iter(self.q) if self.q.ndim == 2 else (self[i] for i in range(len(self.q)))

    def __getitem__(self, index: Any) -> Any:
        """A configuration of a pose; a pose of a batch."""
        if self.q.ndim == 2:
            return self.q[index]
        q, here = self.q[index], self.position_error[index]
        details = (here, self.rotation_error[index], self.total[index], self.miss[index])
        if q.ndim == 2:
            known = np.isfinite(here)
            q, details = q[known], (here[known], details[1][known], int(details[2]), details[3])
        return Branches(q, *details, self.complete, self.method)

    def __repr__(self) -> str:
        if self.is_lazy:
            return (
                f"<lazy branches of poses {self.total.shape}, at most {self.q.shape[-2]} each; {self.method}>"
            )
        label = "all" if self.complete else "found"
        if self.q.ndim > 2:
            return f"<branches of {self.total.size} poses, {int(self.count.sum())} {label}; {self.method}>"
        return f"<{len(self.q)} branches, {label}; {self.method}>"


def ik_all(
    model: Model,
    T: ArrayLike,
    frame: str,
    q0: ArrayLike | None = None,
    *,
    joints: Sequence[str] | None = None,
    free: str | None = None,
    samples: int | ArrayLike | None = None,
    limits: bool = True,
    turns: bool = False,
    position_tolerance: float = 1e-9,
    rotation_tolerance: float = 1e-9,
    seed: int = 0,
) -> Branches:
    """All configurations that put a frame at a pose; see `ulna.Robot.ik_all`.

    Args:
        model: The robot.
        T: T_world_frame, (..., 4, 4).
        frame: Name of the frame.
        q0: Configuration (nq,) or (..., nq) [rad or m] whose nearest solutions come first; None for neutral.
        joints: Names of the joints that may move; None for the last seven that move the frame.
        free: The joint of a seven-joint arm that is held at samples; None for the one that suits best.
        samples: Number of samples of the free joint, or the values themselves, (s,) [rad or m]; None for 32.
        limits: Whether to leave out what is outside the joint limits.
        turns: Whether to list solutions that differ by whole turns within the limits.
        position_tolerance: Largest distance from the goal [m].
        rotation_tolerance: Largest angle from the goal [rad].
        seed: Seed of the random starts.

    Returns:
        The solutions of each goal, with their errors.

    Raises:
        InputError: If `T` is no pose, or an option does not fit the arm.
        UnknownName: If there is no such frame or joint.
    """
    names, options = _checked(frame, joints, free, limits, turns, position_tolerance, rotation_tolerance)
    if is_deferred(T) or is_deferred(q0):
        return _deferred(model, T, frame, q0, names, free, samples, options | {"seed": seed})
    goals = _goals(T)
    batch = goals.shape[:-2]
    base = _start(model, q0, batch)
    source = source_of(model, frame, names, free, _fixed_values(base, between(model, frame, names)))
    values = _values(model, source, samples, None if q0 is None else base)
    select = SolutionFilter(source, q0 is not None, *options.values())
    goals, base = goals.reshape(-1, 4, 4), base.reshape(-1, model.nq)
    step = max(1, _ROWS // (64 * max(len(values), 1)))
    poses: list[Any] = []
    complete = source.free is None
    for start in range(0, len(goals), step):
        part, is_complete = select(goals[start : start + step], base[start : start + step], values, seed)
        complete = complete and is_complete
        poses += part
    return _packed(poses, batch, model.nq, complete, _method(source, values))


def _checked(
    frame: Any,
    joints: Any,
    free: Any,
    limits: Any,
    turns: Any,
    position_tolerance: Any,
    rotation_tolerance: Any,
) -> tuple[tuple[str, ...] | None, dict[str, Any]]:
    """The names of the joints, and the options of `SolutionFilter`, in its order."""
    if not isinstance(frame, str):
        raise InputError(
            f"`frame` is {short_repr(frame)}; expected the name of one frame, or None for the tool."
        )
    if not (free is None or isinstance(free, str)):
        raise InputError(f"`free` is {short_repr(free)}; expected the name of a joint, or None.")
    expected = "a number above zero"
    options = {
        "limits": flag("limits", limits),
        "turns": flag("turns", turns),
        "position_tolerance": number("position_tolerance", position_tolerance, f"{expected} [m]", above=0.0),
        "rotation_tolerance": number(
            "rotation_tolerance", rotation_tolerance, f"{expected} [rad]", above=0.0
        ),
    }
    return None if joints is None else checked_names("joints", joints), options


def _deferred(
    model: Model,
    T: Any,
    frame: str,
    q0: Any,
    joints: tuple[str, ...] | None,
    free: str | None,
    samples: int | ArrayLike | None,
    options: dict[str, Any],
) -> Branches:
    """The solutions of poses in lazy or labelled arrays; the free joint has the same values in every block."""
    fixed = between(model, frame, joints)
    is_single = q0 is None or (not is_deferred(q0) and np.ndim(q0) == 1)
    if fixed and not is_single:
        raise InputError(
            "`q0` is lazy or a batch, but joints that are held at their values in `q0` change the arm. "
            "Pass one `q0` of shape (nq,), or NumPy arrays."
        )
    base = _start(model, q0 if is_single else None, ())
    source = source_of(model, frame, joints, free, _fixed_values(base, fixed))
    values = _values(model, source, samples, base if is_single and q0 is not None else None)
    max_solutions = source.max_candidates * len(values) * (_turns(source) if options["turns"] else 1)
    given = None if source.free is None else values
    solve_block = partial(_solve_block, model, frame, joints, free, given, options)
    arrays = deferred.branches(solve_block, T, q0, model.nq, model.position_names, max_solutions)
    q, position_error, rotation_error, total, miss, complete = arrays
    method = _method(source, values)
    return Branches(q, position_error, rotation_error, total, miss, complete.all(), method)


def _solve_block(
    model: Model, frame: str, joints: Any, free: Any, values: Any, options: Any, T: Any, q0: Any
) -> Any:
    """The branches of a block of poses."""
    return ik_all(model, T, frame, q0, joints=joints, free=free, samples=values, **options)


def _turns(source: Source) -> int:
    """How often at most a solution is listed with whole turns added."""
    widths = zip(source.lower, source.upper, source.periods, strict=True)
    finite = [(high - low) / period for low, high, period in widths if np.isfinite([low, high, period]).all()]
    return int(np.prod([np.floor(width + 1e-9) + 1 for width in finite]))


def _goals(T: Any) -> Floats:
    """The goals (..., 4, 4); `SolutionFilter` finds invalid rotations, which no configuration reaches."""
    check_not_masked("T", T)
    if isinstance(T, np.ndarray) and T.dtype == np.float64 and T.shape[-2:] == (4, 4):
        return T
    if isinstance(T, SE3):
        return T.matrix()
    return SE3.from_matrix(batched_array("T", T, (4, 4))).matrix()


def _start(model: Model, q0: ArrayLike | None, batch: tuple[int, ...]) -> Floats:
    """The configurations (*batch, nq) of all joints before the arm's are found."""
    if q0 is None:
        default = _clipped_neutral(model)
        return np.broadcast_to(default, (*batch, model.nq)) if batch else default
    q = checked_configurations("q0", q0, model)
    try:
        return np.broadcast_to(q, (*batch, model.nq))
    except ValueError:
        raise ShapeError(
            "q0", q.shape, f"({model.nq},) or {(*batch, model.nq)}, the batch of the poses"
        ) from None


@lru_cache(maxsize=64)
def _clipped_neutral(model: Model) -> Floats:
    return np.clip(model.neutral, model.lower_position, model.upper_position)


def _fixed_values(base: Floats, places: tuple[int, ...]) -> tuple[float, ...]:
    """The coordinates at `places`, which must be the same throughout a batch."""
    if not places or not base.size:
        return (0.0,) * len(places)
    values = base[..., list(places)].reshape(-1, len(places))
    if not (values == values[0]).all():
        raise InputError(
            "`q0` differs within the batch in joints that are held between those of the arm, which then has another "
            "shape for each pose; solve pose by pose."
        )
    return tuple(values[0].tolist())


def _values(model: Model, source: Source, samples: int | ArrayLike | None, q0: Floats | None) -> Floats:
    """Values of the free coordinate; where it is given, that of one `q0` comes first."""
    if source.free is None:
        if samples is not None:
            raise InputError(
                f"`samples` is {short_repr(samples)}, but no joint of this arm is given values, as one of seven joints "
                "is; expected None."
            )
        return _ONE
    axis = source.arm.axes[source.free]
    if isinstance(samples, (list, tuple, np.ndarray)) and np.ndim(samples):
        return shaped_array("samples", samples, None)
    count = 32 if samples is None else _sample_count(samples, axis.name)
    lower, upper = model.lower_position[axis.index], model.upper_position[axis.index]
    if np.isfinite(lower) and np.isfinite(upper):
        grid = np.linspace(lower, upper, count + 2)[1:-1]
    elif axis.motion == "turn":
        grid = np.linspace(-np.pi, np.pi, count, endpoint=False)
    else:
        raise InputError(
            f"Joint {axis.name!r} has no limits to sample between; give `samples` as values, or limits in the model."
        )
    start_values = np.unique(q0[..., axis.index]) if q0 is not None else _ONE[:0]
    return np.concatenate([start_values, grid]) if len(start_values) == 1 else grid


def _sample_count(samples: Any, joint: str) -> int:
    try:
        return checked_count("samples", samples, most=1_000_000)
    except InputError:
        raise InputError(
            f"`samples` is {short_repr(samples)}; expected a count from 1, or values of joint {joint!r}, (s,)."
        ) from None


def _method(source: Source, values: Floats) -> str:
    if source.free is None:
        return source.method
    name = source.arm.axes[source.free].name
    sampled = (
        f"{len(values)} values from {values.min():.3g} to {values.max():.3g}" if len(values) else "no value"
    )
    return f"{source.method}; joint {name} at {sampled}"


def _packed(poses: list[Any], batch: tuple[int, ...], nq: int, complete: bool, method: str) -> Branches:
    if not batch:
        q, position, rotation, reachable, miss = poses[0]
        return Branches(q, position, rotation, int(reachable), miss, complete, method)
    most = max((len(pose[0]) for pose in poses), default=0)
    q = np.full((len(poses), most, nq), np.nan)
    errors = np.full((2, len(poses), most), np.nan)
    for i, (rows, position, rotation, _, _) in enumerate(poses):
        q[i, : len(rows)], errors[0, i, : len(rows)], errors[1, i, : len(rows)] = rows, position, rotation
    reachable = np.array([pose[3] for pose in poses], dtype=int).reshape(batch)
    miss = np.array([pose[4] for pose in poses]).reshape(*batch, 2)
    errors = errors.reshape(2, *batch, most)
    return Branches(q.reshape(*batch, most, nq), errors[0], errors[1], reachable, miss, complete, method)
