"""The solver of constraints that push, rub and hold: projected Gauss-Seidel."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any, ClassVar, final

import numpy as np

from pinocchio._constraints._procedures.gauss_seidel_rounds import (
    FIXED,
    Outcome,
    Problem,
    gauss_seidel_search,
)
from pinocchio._constraints._procedures.solver_rows import CONVERGED_OUT, HEAD
from pinocchio._constraints.gauss_seidel_stats import PGSSolverStats
from pinocchio._constraints.iterative_solver import (
    ConstraintSolverResult,
    IterativeSolver,
    ToleranceSettings,
    check_settings_and_result,
    repeated,
)
from pinocchio._constraints.solver_problem import AT_ONCE, RowStorage, operator_for, sets_of
from pinocchio._containers.arrays import vector
from pinocchio._containers.attributes import AttributeKind, number
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["PGSConstraintSolver", "PGSSolverResult", "PGSSolverSettings"]


@final
class PGSSolverSettings(ToleranceSettings):
    """When a solution is good enough, and how it is computed; the other attributes are those of `ToleranceSettings`.

    Attributes:
        over_relaxation: What part of each correction is made, above 0 and below 2.
    """

    __slots__ = ("over_relaxation",)
    _kinds: ClassVar[Mapping[str, AttributeKind]] = {"over_relaxation": number}

    def __init__(self) -> None:
        super().__init__()
        self.over_relaxation = 1.0

    def checkValidity(self) -> None:
        """Raises InputError when a number makes no sense."""
        super().checkValidity()
        if not 0.0 < self.over_relaxation < 2.0:
            raise InputError(
                f"`over_relaxation` is {self.over_relaxation!r}; expected a number above 0, below 2."
            )

    def numbers(self) -> tuple[float, ...]:
        """The settings as `gauss_seidel_search` takes them."""
        return (
            self.absolute_feasibility_tol,
            self.absolute_complementarity_tol,
            self.relative_feasibility_tol,
            self.over_relaxation,
            self.solve_ncp,
            self.max_iterations,
        )


@final
class PGSSolverResult(ConstraintSolverResult):
    """The solution, and what the next search starts from; `primal_feasibility` is 0.

    The velocities of a constraint are those right after its impulses were corrected last, before later ones were.
    """

    __slots__ = ()


@repeated
@final
class PGSConstraintSolver(IterativeSolver):
    """Finds impulses of constraints, one after the other, round after round.

    Attributes:
        stats: What was recorded of each round, where the settings say `stat_record`.
    """

    __slots__ = ()
    _recorded = PGSSolverStats

    def solve(
        self,
        delassus: Any,
        g: Any,
        constraint_models: Any,
        constraint_datas: Any,
        settings: PGSSolverSettings,
        result: PGSSolverResult,
    ) -> bool:
        """Whether impulses were found; they, or the best there are, are in the result.

        Args:
            g: Velocities of the constraints without impulses (m,) [m/s].
            constraint_models: Contacts, anchors, loops, limits and frictions of joints.
            constraint_datas: Their data, after `calc`.
            settings: When the search ends.
            result: What is filled; the guess in it serves this search alone.

        Returns:
            Whether they were found.

        Raises:
            ArgumentError: `settings` or `result` is of another class.
            WrongShape: The constraints have not as many rows as `g`.
        """
        packed = check_settings_and_result(settings, result, (PGSSolverSettings, PGSSolverResult))
        sets = sets_of(constraint_models, constraint_datas)
        operator = operator_for(delassus, sets)
        m = operator.size()
        velocities = vector(g, m, "g")
        out = result.place_for(m)
        begun = time.perf_counter()
        sizes = len(sets.kinds), m
        storage: _Storage | None = self._storage
        if storage is None or storage.sizes != sizes:
            storage = self._storage = _Storage(sizes)
        self._calls = None  # until the arrays are those of such a search again
        storage.put_sets(sets)
        problem = operator._G, operator._compliance, operator._damping, velocities
        storage.solve(problem, settings, packed, out, self.stats)
        self._finished(time.perf_counter() - begun, settings)
        self._repeat(storage.run, delassus, g, constraint_models, constraint_datas, settings, result)
        return result.converged


class _Storage(RowStorage):
    """The iterates, and the procedure bound to them.

    Attributes:
        run: The procedure.
    """

    def __init__(self, sizes: tuple[int, int]) -> None:
        super().__init__(sizes, HEAD, 4)
        vectors = [self.vector() for _ in range(5)]
        self._numbers, self._fixed = np.zeros(3), np.zeros(len(FIXED))
        self._settings = self._fixed.data.cast("B")
        self._problem = Problem(self.G, self.g, *vectors)
        self.run = self._bound(np.zeros((0, 3)))

    def _bound(self, records: Floats) -> Any:
        """The procedure, which records rounds where there is room for them."""
        return gauss_seidel_search.bind(
            self.given, self.rows, self._problem, Outcome(self._numbers, records), self._fixed, self.span,
            are_arrays_private=True,
        )  # fmt: skip

    def solve(
        self,
        problem: tuple[Floats, ...],
        settings: PGSSolverSettings,
        packed: bytes,
        out: Floats,
        stats: PGSSolverStats,
    ) -> None:
        """Makes rounds.

        Args:
            problem: As `search` takes it.
            settings: When the search ends.
            packed: The same, as native code takes it.
            out: What the solution is written into (n,); see `Given`.
            stats: What is filled, where the settings say so.
        """
        self._settings[:] = packed
        if stats.size():
            stats.reset()
        most = int(settings.max_iterations) + 1
        run, records = self.run, np.zeros((min(AT_ONCE, most) if settings.stat_record else 0, 3))
        if settings.stat_record:
            run = self._bound(records)
        for first, done in self.search(run, problem, most, out):
            if settings.stat_record:
                stats.add(records[: done - first + int(out[CONVERGED_OUT])])
                stats.iterations = done
