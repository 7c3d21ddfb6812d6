"""The solver of constraints that push, rub and hold: alternating directions (ADMM), see `admm_iterations.py`."""

from __future__ import annotations

import time
from typing import Any, final

import numpy as np

from pinocchio._constraints._procedures import admm_iterations as entries
from pinocchio._constraints._procedures.admm_iterations import Basis, Iterates, admm_search
from pinocchio._constraints._procedures.anderson import History
from pinocchio._constraints._procedures.solver_rows import CONVERGED_OUT, HAS_IMPULSES_OUT, HAS_VELOCITIES_OUT
from pinocchio._constraints._procedures.square_root_free import Factors
from pinocchio._constraints.admm_settings import (
    ADMMSolverResult,
    ADMMSolverSettings,
    ADMMSolverStats,
)
from pinocchio._constraints.iterative_solver import (
    IterativeSolver,
    check_settings_and_result,
    repeated,
)
from pinocchio._constraints.solver_problem import AT_ONCE, RowStorage, SearchError, operator_for, sets_of
from pinocchio._containers.arrays import vector
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["ADMMConstraintSolver"]


@repeated
@final
class ADMMConstraintSolver(IterativeSolver):
    """Finds impulses of all constraints at once, by alternating directions.

    Attributes:
        stats: What was recorded at each iteration, where the settings say `stat_record`.
    """

    __slots__ = ()
    _damps = True
    _recorded = ADMMSolverStats

    def solve(
        self,
        delassus: Any,
        g: Any,
        constraint_models: Any,
        constraint_datas: Any,
        settings: ADMMSolverSettings,
        result: ADMMSolverResult,
    ) -> bool:
        """Whether impulses were found; they, or the best there are, are in the result.

        The damping of the operator does not count. Afterwards it is the weight of the last linear equations.

        Args:
            g: Velocities of the constraints without impulses (m,) [m/s].
            constraint_models: Contacts, anchors, loops, limits and frictions of joints.
            constraint_datas: Their data, after `calc`.
            settings: When the search ends, and how it is made.
            result: What is filled; the guesses in it serve this search alone.

        Returns:
            Whether they were found.

        Raises:
            ArgumentError: `settings` or `result` is of another class.
            WrongShape: The constraints have not as many rows as `g`.
        """
        packed = check_settings_and_result(settings, result, (ADMMSolverSettings, ADMMSolverResult))
        sets = sets_of(constraint_models, constraint_datas)
        operator = operator_for(delassus, sets)
        m = operator.size()
        velocities = vector(g, m, "g")
        if not result.isValid():
            result.rho = np.nan
        out = result.place_for(m)
        begun = time.perf_counter()
        columns = max(2, min(m, settings.lanczos_size)) if m > 1 else 1
        sizes = len(sets.kinds), m, int(settings.anderson_capacity), columns
        storage: _Storage | None = self._storage
        if storage is None or storage.of != sizes:
            storage = self._storage = _Storage(*sizes)
        self._calls = None  # until the arrays are those of such a search again
        storage.put_sets(sets)
        problem = operator._G, operator._compliance, operator._damping, velocities
        storage.solve(problem, settings, packed, out, self.stats)
        operator._damp(float(storage.now[entries.WEIGHT]))
        self._finished(time.perf_counter() - begun, settings)
        self._repeat(storage.run, delassus, g, constraint_models, constraint_datas, settings, result)
        return result.converged


class _Storage(RowStorage):
    """The iterates, and the procedures bound to them."""

    def __init__(self, count: int, m: int, capacity: int, columns: int) -> None:
        super().__init__((count, m), entries.HEAD, 6)
        self.of = count, m, capacity, columns
        self.now, self._fixed = np.zeros(len(entries.NOW)), np.zeros(len(entries.FIXED))
        self._settings = self._fixed.data.cast("B")
        self._vectors = [self.vector() for _ in range(11)]
        width = self.width
        self._factors = Factors(np.zeros((m, width)), np.zeros(m))
        self._basis = Basis(np.zeros((columns, width)), np.zeros(columns), np.zeros(max(columns - 1, 0)))
        past, differences = [np.zeros((capacity, width)) for _ in range(3)], max(capacity - 1, 0)
        self._history = History(
            past[0], past[1], past[2], np.zeros((differences, width)), self.vector(), np.zeros(differences),
            np.zeros(differences, np.int64), np.zeros(2, np.int64),
        )  # fmt: skip
        self.run = self._bound(np.zeros((0, entries.RECORDED)))

    def _bound(self, records: Floats) -> Any:
        """The procedure, which records iterations where there is room for them."""
        at = Iterates._make([self.G, self.g, *self._vectors, self.now, records])
        return admm_search.bind(
            self.given, self.rows, at, self._history, self._factors, self._basis, self._fixed, self.span,
            are_arrays_private=True,
        )  # fmt: skip

    def solve(
        self,
        problem: tuple[Floats, ...],
        settings: ADMMSolverSettings,
        packed: bytes,
        out: Floats,
        stats: ADMMSolverStats,
    ) -> None:
        """Searches from what the result has.

        Args:
            problem: As `search` takes it.
            settings: When the search ends, and how it is made.
            packed: The same, as native code takes it.
            out: What the solution is written into (n,); see `Given`.
            stats: What is filled, where the settings say so.

        Raises:
            InputError: The rule SPECTRAL has no factor.
        """
        if stats.size():
            stats.reset()
        self._settings[:] = packed
        most = int(settings.max_iterations) + 1
        columns = min(AT_ONCE, most) if settings.stat_record else 0, entries.RECORDED
        run, records = self.run, np.zeros(columns)
        if settings.stat_record:
            run = self._bound(records)
        try:
            for first, done in self.search(run, problem, most, out):
                if len(records) and self.now[entries.COUNT] > 1.0:  # else what they start from is a solution
                    stats.add(records[: done - first + int(out[CONVERGED_OUT])])
                    stats.iterations = done
                    stats.delassus_decomposition_update_count = int(self.now[entries.COUNT])
        except SearchError:
            out[[HAS_IMPULSES_OUT, HAS_VELOCITIES_OUT]] = 0.0
            raise _not_apart(*self.now[[entries.LARGEST, entries.LEAST]].tolist()) from None


def _not_apart(largest: float, least: float) -> InputError:
    """What is wrong where the rule SPECTRAL has no factor."""
    return InputError(
        f"The largest eigenvalue of the Delassus matrix is {largest!r}, the least one counts as {least!r}: the rule "
        "SPECTRAL needs them apart. Take the rule OSQP, or a smaller `mu_prox`."
    )
