"""Collision-free inverse kinematics: many configurations that reach a goal, the nearest free one of them.

An arm with finitely many solutions is asked for all of them (`ulna.ik.branches`), so that "all collide" is an answer.
Any other is asked from more and more starting points, farther and farther from where it stands. What is returned
touches nothing by the exact shapes, or by spheres that contain them.

The search for one goal is a generator: it yields what it wants computed, and continues with the answer. The searches
of a batch advance together, so that what they want is computed in a few large batches.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, TypeAlias, TypeVar, final

import numpy as np

from ulna import kernels
from ulna.checks.arrays import batched_array
from ulna.checks.labels import in_order
from ulna.checks.values import count as check_count
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.ik.analytic.candidates import ClosedForm, Elimination, between, source_of
from ulna.ik.arguments import matrix_of
from ulna.ik.branches import Branches, ik_all
from ulna.ik.contacts import Contacts, Distances
from ulna.ik.result import IKSolution
from ulna.ik.singular import any_singular
from ulna.ik.solve import Solver
from ulna.typing import Array, ArrayLike, Floats

T_ = TypeVar("T_")

_COLUMNS = (
    "q",
    "success",
    "position_error",
    "rotation_error",
    "distance",
    "candidates",
    "reason",
)  # of a FreeSolution

_FIRST, _MOST = 7, 64  # starting points of the first and of the largest round
_FULL_RANGE_START = 64  # the starting point from which on they are drawn from the whole ranges
_SAME_SOLUTION = 1e-3  # rad or m: solutions this near are one
_CHECKED = 16  # configurations checked together; at first fewer, since the nearest is often free
_EXPLAINED = 32  # configurations examined to explain why there is no solution


@final
@dataclass(frozen=True, eq=False)
class FreeSolution:
    """The answer of `robot.ik_free`, for one goal or a batch of them; it counts as true when it is met and free.

    Attributes:
        q: The configuration, (..., nq). Where there is no solution: of those that reach the goal the one that
            overlaps least; where none does, the nearest that was found.
        success: Whether the goal is met within the limits and nothing touches, (...).
        position_error: Distance from the goal [m], (...), or (..., k) for k frames.
        rotation_error: Angle from the goal [rad], likewise.
        distance: How far everything is apart at least [m], (...): computed where there is no solution, else nan.
        candidates: How many configurations that reach the goal were looked at, (...).
        reason: Why there is no solution, as text; "" where there is one. An array of such for a batch.
    """

    q: Floats
    success: Any
    position_error: Any
    rotation_error: Any
    distance: Any
    candidates: Any
    reason: Any

    def reshaped(self, batch: tuple[int, ...]) -> FreeSolution:
        """The same solutions, of a batch with one axis, along several.

        Args:
            batch: The lengths of the axes.

        Returns:
            The solutions.
        """
        columns = (getattr(self, name) for name in _COLUMNS)
        return FreeSolution(*(column.reshape(*batch, *column.shape[1:]) for column in columns))

    def __bool__(self) -> bool:
        if np.ndim(self.success):
            raise TypeError(
                "A batch of solutions has no single truth; use `.success.all()` or `.success.any()`."
            )
        return self.success

    def __repr__(self) -> str:
        if np.ndim(self.success):
            return f"<{self.success.size} free IK solutions, {int(self.success.sum())} of them successful>"
        status = "free solution" if self.success else f"no free solution: {self.reason}"
        counted = f"{self.candidates} candidate{'' if self.candidates == 1 else 's'}"
        with np.printoptions(precision=4, suppress=True):
            return f"<IK {status}, q={self.q}, {counted}>"


@final
@dataclass(frozen=True)
class FreeOptions:
    """The options of `robot.ik_free`.

    Attributes:
        margin: What comes as near as this counts as touching [m].
        moving: Poses of the world's moving obstacles, T_world_shape (4, 4), by name.
        position_tolerance: [m].
        rotation_tolerance: [rad].
        seed: Chooses the starting points.
        attempts: How many starting points are tried at most, of arms without finitely many solutions.
    """

    margin: float
    moving: Mapping[str, ArrayLike] | None
    position_tolerance: float
    rotation_tolerance: float
    seed: int
    attempts: int

    @property
    def tolerances(self) -> tuple[float, float]:
        """Those of position [m] and rotation [rad]."""
        return self.position_tolerance, self.rotation_tolerance

    def __post_init__(self) -> None:
        check_count("attempts", self.attempts)
        if not (np.isfinite(self.margin) and self.margin >= 0.0):
            raise InputError(f"`margin` is {self.margin!r}; expected a finite length, not below 0 [m].")


@dataclass(frozen=True, eq=False)
class _Reach:
    """Wants configurations that reach goals (n, ...), from starts (n, nq), whatever they touch."""

    T: Floats
    q0: Floats

    def __len__(self) -> int:
        return len(self.T)


@dataclass(frozen=True, eq=False)
class _Touch:
    """Wants to know which configurations (n, nq) touch anything."""

    q: Floats

    def __len__(self) -> int:
        return len(self.q)


@dataclass(frozen=True, eq=False)
class _Apart:
    """Wants to know how far everything is apart in configurations (n, nq)."""

    q: Floats


Search: TypeAlias = Generator[Any, Any, T_]


@final
class FreeSolver:
    """Inverse kinematics of one robot in one world, for one `Solver`.

    Args:
        solver: What finds single solutions.
        contacts: The check of the robot in its world.
        apart: The kernel of the distance of two configurations.
    """

    def __init__(self, solver: Solver, contacts: Contacts, apart: Any) -> None:
        self.solver, self.contacts, self._apart = solver, contacts, apart
        self.model = contacts.model
        self.is_finite = self._has_branches()

    def _has_branches(self) -> bool:
        """Whether all configurations that reach a pose can be listed."""
        problem = self.solver.problem
        if len(problem.frames) != 1 or problem.rows != 6 or len(problem.velocities) != 6:
            return False
        frame = self.model.frame_name(problem.frames[0])
        fixed = self.model.neutral[list(between(self.model, frame, self._arm))]
        source = source_of(self.model, frame, self._arm, None, tuple(fixed.tolist()))
        return isinstance(source, (ClosedForm, Elimination))

    @property
    def _arm(self) -> tuple[str, ...]:
        """The joints that may move, those that do not carry the frame left out."""
        return tuple(self.model.joints[i].name for i in self.solver.problem.joints)

    def __call__(self, T: Any, q0: ArrayLike | None, options: FreeOptions) -> FreeSolution:
        """Solves for goals; see `robot.ik_free`.

        Args:
            T: Goals, shape (..., 4, 4), or (..., k, 4, 4) for k frames [m].
            q0: Where the first search begins, shape (..., nq) [rad, m]; None for a default.
            options: The options of the search.

        Returns:
            The solution.
        """
        core: Any = self.solver.problem.shapes["T"]
        T = batched_array("T", matrix_of(T), core)
        batch = T.shape[: T.ndim - len(core)]
        starts: Any = [None]
        if q0 is not None:
            start = batched_array("q0", in_order("q0", q0, self.model.position_names), (self.model.nq,))
            batch = np.broadcast_shapes(batch, start.shape[:-1])
            starts = np.broadcast_to(start, (*batch, self.model.nq)).reshape(-1, self.model.nq)
        goals = np.broadcast_to(T, (*batch, *core)).reshape(-1, *core)
        if q0 is None:
            starts = starts * max(len(goals), 1)
        if not batch:
            first = self.solver(goals[0], starts[0], *options.tolerances, options.seed)
            if (
                first
                and q0 is None
                and not self.contacts.touching(first.q[None], options.margin, options.moving)[0]
            ):
                return _answer(first, True, np.nan, 1, "")
            return _together([self._search(goals[0], starts[0], first, options)], self._answers(options))[0]
        return self._batch(goals, starts, options).reshaped(batch)

    def _batch(self, goals: Floats, starts: Any, options: FreeOptions) -> FreeSolution:
        """Several goals: those whose first solution is free are answered at once, in arrays."""
        is_anywhere = starts[0] is None if len(goals) else True
        first = self.solver(goals, None if is_anywhere else starts, *options.tolerances, options.seed)
        is_free = np.asarray(first.success).copy()
        if is_anywhere:
            is_free[is_free] = ~self.contacts.touching(first.q[is_free], options.margin, options.moving)
        else:
            is_free[:] = False
        rest = np.flatnonzero(~is_free)
        searches = [self._search(goals[k], starts[k], first[k], options) for k in rest.tolist()]
        answers = _together(searches, self._answers(options))
        return _filled(first, is_free, rest, answers)

    def _search(
        self, T: Floats, q0: Floats | None, first: IKSolution, options: FreeOptions
    ) -> Search[FreeSolution]:
        """One goal, of which a first solution is known; without `q0` it touches something."""
        if not first:
            return _answer(
                first, False, np.nan, 0, f"no configuration was found that reaches the goal; {first.reason}"
            )
        home = first.q if q0 is None else q0
        branches = self._branches(T, home, options) if self.is_finite else None
        reaching: list[IKSolution] = []
        if branches is None:
            reaching.append(first)
            if q0 is not None and (yield from self._first_free(reaching)):
                return _answer(first, True, np.nan, 1, "")
        for starts in self._starts(home, first.q, branches, options):
            solutions = yield from self._new_solutions(T, starts, home, reaching)
            reaching += solutions
            chosen = yield from self._first_free(solutions)
            if chosen is not None:
                return _answer(chosen, True, np.nan, len(reaching), "")
        reaching.sort(key=lambda solution: self._apart(home, solution.q))
        nearest = yield _Apart(np.array([s.q for s in reaching[:_EXPLAINED]]))
        return self._all_collide(reaching, nearest, self._are_all(branches), options)

    def _answers(self, options: FreeOptions) -> dict[type, Callable[[list[Any]], list[Any]]]:
        """What computes each kind of request: from the requests of several searches to an answer for each."""

        def reach(requests: list[_Reach]) -> list[Any]:
            T = np.concatenate([request.T for request in requests])
            starts = np.concatenate([request.q0 for request in requests])
            if len(T) == 1:  # as `robot.ik` solves for one
                return [[self.solver(T[0], starts[0], *options.tolerances, options.seed)]]
            solutions = self.solver(T, starts, *options.tolerances, options.seed)
            return [solutions[part] for part in _parts(requests)]

        def touch(requests: list[_Touch]) -> list[Any]:
            q = np.concatenate([request.q for request in requests])
            touching = self.contacts.touching(q, options.margin, options.moving)
            return [touching[part] for part in _parts(requests)]

        def apart(requests: list[_Apart]) -> list[Any]:
            return [self.contacts.distances(request.q, options.moving) for request in requests]

        return {_Reach: reach, _Touch: touch, _Apart: apart}

    def _branches(self, T: Floats, home: Floats, options: FreeOptions) -> Branches:
        """All solutions of an arm that has finitely many."""
        return ik_all(
            self.model,
            T,
            self.model.frame_name(self.solver.problem.frames[0]),
            home,
            joints=self._arm,
            position_tolerance=options.position_tolerance,
            rotation_tolerance=options.rotation_tolerance,
        )

    def _are_all(self, branches: Branches | None) -> bool:
        """Whether no other configuration reaches the goal; a singular one may stand for many, where a joint is free."""
        if branches is None or not branches.complete or not len(branches.q):
            return False
        problem = self.solver.problem
        frame = self.model.frame_name(problem.frames[0])
        J = kernels.kernel(self.model, "jacobian", frame=frame)(branches.q)[..., problem.velocities]
        return not any_singular(J)

    def _starts(
        self, home: Floats, first: Floats, branches: Branches | None, options: FreeOptions
    ) -> Iterator[Floats]:
        """Starting points (k, nq) in rounds: all branches, then points drawn around `home`, farther and farther."""
        if branches is not None:
            yield np.vstack([first, branches.q])
            if self._are_all(branches):
                return
        rng = np.random.default_rng(options.seed)
        drawn, done = self.solver.problem.drawn, 1
        low, high = self.solver.problem.range
        while done < options.attempts:
            count = min(done + _FIRST, _MOST, options.attempts - done)
            radius = np.minimum((done + np.arange(count)) / _FULL_RANGE_START, 1.0)[:, None]
            starts = np.repeat(home[None], count, axis=0)
            there = rng.uniform(low, high, (count, len(low)))
            starts[:, drawn] += radius * (there - starts[:, drawn])
            done += count
            yield starts

    def _new_solutions(
        self, T: Floats, starts: Floats, home: Floats, reaching: Sequence[IKSolution]
    ) -> Search[list[IKSolution]]:
        """The solutions met from starting points that were not found before, the nearest to `home` first."""
        solutions = yield _Reach(np.broadcast_to(T, (len(starts), *T.shape)), starts)
        if isinstance(solutions, list):  # a single one
            return solutions if solutions[0] else []
        good = np.flatnonzero(solutions.success)
        known = np.array([solution.q for solution in reaching]).reshape(-1, self.model.nq)
        return [solutions[k] for k in good[self._distinct(solutions.q[good], known, home)].tolist()]

    def _distinct(self, q: Floats, known: Floats, home: Floats) -> list[int]:
        """Which of some configurations are neither known nor found twice, the nearest to `home` first."""
        both = np.concatenate([known, q])
        far = self._apart(home, both)
        order = np.argsort(far, kind="stable")
        ranked = far[order]  # those that are alike are about as far from home: only such pairs are compared
        first, rank = np.searchsorted(ranked, ranked - 2.0 * _SAME_SOLUTION), np.arange(len(both))
        counts = rank - first
        later = np.repeat(rank, counts)
        earlier = np.arange(len(later)) - np.repeat(np.cumsum(counts) - counts - first, counts)
        if not len(later):
            return [k - len(known) for k in order.tolist() if k >= len(known)]
        alike = self._apart(both[order[later]], both[order[earlier]]) < _SAME_SOLUTION
        pairs = list(zip(later[alike].tolist(), earlier[alike].tolist(), strict=True))
        is_known = (order < len(known)).tolist()
        again = {one for pair in pairs for one, other in (pair, pair[::-1]) if is_known[other]}
        for a, b in pairs:  # in the order of the later one, so that what is said of the earlier one is final
            if b not in again:
                again.add(a)
        first_ones = (k for number, k in enumerate(order.tolist()) if number not in again)
        return [k - len(known) for k in first_ones if k >= len(known)]

    def _first_free(self, solutions: Sequence[IKSolution]) -> Search[IKSolution | None]:
        """The first solution that touches nothing."""
        done = 0
        while done < len(solutions):
            part = solutions[done : done + min(3 * done + 1, _CHECKED)]
            done += len(part)
            q = np.array([solution.q for solution in part])
            free = np.flatnonzero(~(yield _Touch(q)))
            if len(free):
                return part[int(free[0])]
        return None

    def _all_collide(
        self, reaching: Sequence[IKSolution], nearest: Distances, complete: bool, options: FreeOptions
    ) -> FreeSolution:
        """All collide: the one that overlaps least, of those nearest to the start."""
        best = int(np.argmax(nearest.lengths))
        a, b = nearest.names(best)
        d = float(nearest.lengths[best])
        how = f"overlap by {-1e3 * d:.3g} mm" if d < 0.0 else f"are {1e3 * d:.3g} mm apart"
        missing = (
            f", less than the margin of {1e3 * options.margin:.3g} mm" if d >= 0.0 < options.margin else ""
        )
        count = f"{len(reaching)} configuration{'s' * (len(reaching) > 1)}"
        which = "all there are" if complete else "as many as were found"
        return _answer(
            reaching[best],
            False,
            d,
            len(reaching),
            f"{count} reach the goal ({which}), and all collide; at best {a} and {b} {how}{missing}",
        )


def _together(searches: Sequence[Search[Any]], answers: Mapping[type, Any]) -> list[Any]:
    """The results of searches that advance together, requests of one kind answered at once."""
    results: list[Any] = [None] * len(searches)
    waiting: dict[int, Any] = {}

    def advance(number: int, answer: Any) -> None:
        try:
            waiting[number] = searches[number].send(answer)
        except StopIteration as end:
            results[number] = end.value

    for number in range(len(searches)):
        advance(number, None)
    while waiting:
        requests, waiting = waiting, {}
        for kind, answer in answers.items():
            chosen = [number for number, request in requests.items() if type(request) is kind]
            if chosen:
                replies = answer([requests[number] for number in chosen])
                for number, reply in zip(chosen, replies, strict=True):
                    advance(number, reply)
    return results


def _parts(requests: Sequence[Any]) -> list[slice]:
    """Where the rows of each request are in those of all."""
    ends = np.cumsum([0, *(len(request) for request in requests)]).tolist()
    return [slice(a, b) for a, b in pairwise(ends)]


def _answer(
    solution: IKSolution, success: bool, distance: float, candidates: int, reason: str
) -> FreeSolution:
    errors = solution.position_error, solution.rotation_error
    return FreeSolution(solution.q, success, *errors, distance, candidates, reason)


def _filled(first: IKSolution, is_free: Array, rest: Array, answers: Sequence[FreeSolution]) -> FreeSolution:
    """The answers of a batch as one: first solutions that are free, and what searches found of the rest."""
    errors = np.array(first.position_error), np.array(first.rotation_error)
    reasons = np.full(len(is_free), "", dtype=object)
    batch = FreeSolution(
        np.array(first.q), is_free, *errors, np.full(len(is_free), np.nan), is_free.astype(int), reasons
    )
    for number, answer in zip(rest.tolist(), answers, strict=True):
        for name in _COLUMNS:
            getattr(batch, name)[number] = getattr(answer, name)
    return batch
