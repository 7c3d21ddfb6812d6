"""The solver of constraints that push, rub and hold: projected Gauss-Seidel."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any, ClassVar, final

import numpy as np

from pinocchio._constraints._procedures.gauss_seidel_rounds import (
    FIXED,
    ROUNDS,
    Outcome,
    Problem,
    gauss_seidel_rounds,
)
from pinocchio._constraints.gauss_seidel_stats import PGSSolverStats
from pinocchio._constraints.iterative_solver import (
    ConstraintSolverResult,
    IterativeSolver,
    ToleranceSettings,
    check_settings_and_result,
)
from pinocchio._constraints.solver_problem import RowStorage, operator_for, sets_of
from pinocchio._containers.arrays import vector
from pinocchio._containers.attributes import AttributeKind, number
from ulna.errors import InputError

__all__ = ["PGSConstraintSolver", "PGSSolverResult", "PGSSolverSettings"]

_AT_ONCE = 1000
"""So many rounds does one native call make, which Ctrl-C does not reach."""


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
        """The settings as `gauss_seidel_rounds` takes them."""
        return (
            self.absolute_feasibility_tol,
            self.absolute_complementarity_tol,
            self.relative_feasibility_tol,
            self.over_relaxation,
            self.solve_ncp,
            0.0,
        )


@final
class PGSSolverResult(ConstraintSolverResult):
    """The solution, and what the next search starts from; `primal_feasibility` is 0.

    The velocities of a constraint are those right after its impulses were corrected last, before later ones were.
    """

    __slots__ = ()


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
        g = vector(g, m, "g")
        guess = result.take_guesses(m)[0]
        begun = time.perf_counter()
        sizes = len(sets.kinds), m
        storage: _Storage | None = self._storage
        if storage is None or storage.sizes != sizes:
            storage = self._storage = _Storage(sizes)
        storage.fill(operator, g, sets, operator._compliance + operator._damping)
        iterations = storage.search(guess, settings, packed, self.stats)
        off, power, converged = storage.numbers.tolist()
        result.fill(
            storage.x[:m].copy(), storage.y[:m].copy(), iterations, bool(converged), (0.0, off, power)
        )
        self._finished(time.perf_counter() - begun, settings)
        return result.converged


class _Storage(RowStorage):
    """The iterates, and the procedure bound to them."""

    def __init__(self, sizes: tuple[int, int]) -> None:
        super().__init__(sizes)
        self.x, self.y, *work = (self.vector() for _ in range(5))
        self.numbers, self._fixed = np.zeros(3), np.zeros(len(FIXED))
        self._fixed_bytes = self._fixed.data.cast("B")
        self._problem = Problem(self.G, self.g, self.x, self.y, *work)
        self._rounds = self._bound(np.zeros((0, 3)))

    def _bound(self, records: Any) -> Any:
        """The procedure, which records rounds where there is room for them."""
        outcome = Outcome(self.numbers, records)
        return gauss_seidel_rounds.bind(
            self.rows, self._problem, outcome, self._fixed, are_arrays_private=True
        )

    def search(self, guess: Any, settings: PGSSolverSettings, packed: bytes, stats: PGSSolverStats) -> int:
        """Makes rounds; returns how many were not good enough.

        Args:
            guess: Impulses to start from (m,), or None.
            settings: When the search ends.
            packed: The same, as native code takes it.
            stats: What is filled, where the settings say so.

        Returns:
            The number of rounds before the last one, or of all.
        """
        self.x[: self.m] = 0.0 if guess is None else guess
        run, done, most = self._rounds, 0, int(settings.max_iterations) + 1
        at_once = min(_AT_ONCE, most)
        self._fixed_bytes[:] = packed
        self.numbers[2] = 0.0
        if stats.size():
            stats.reset()
        if settings.stat_record:
            records = np.zeros((at_once, 3))
            run = self._bound(records)
        while done < most and not self.numbers[2]:
            self._fixed[ROUNDS] = min(at_once, most - done)
            made = run()
            if settings.stat_record:
                stats.add(records[: made + int(self.numbers[2])])
            done += made
        if settings.stat_record:
            stats.iterations = done
        return done
