"""The solver of constraints that push, rub and hold: alternating directions (ADMM), see `admm_iterations`."""

from __future__ import annotations

import math
import time
from typing import Any, final

import numpy as np

from pinocchio._constraints._procedures import admm_iterations as entries
from pinocchio._constraints._procedures.admm_iterations import Basis, Iterates, admm_iterations, admm_start
from pinocchio._constraints._procedures.anderson import History
from pinocchio._constraints._procedures.square_root_free import Factors
from pinocchio._constraints.admm_settings import (
    ADMMProximalRule,
    ADMMSolverResult,
    ADMMSolverSettings,
    ADMMSolverStats,
    ADMMUpdateRule,
)
from pinocchio._constraints.iterative_solver import IterativeSolver, check_settings_and_result
from pinocchio._constraints.solver_problem import RowStorage, operator_for, sets_of
from pinocchio._containers.arrays import vector
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["ADMMConstraintSolver"]

_AT_ONCE = 1000
"""So many iterations does one native call make, which Ctrl-C does not reach."""


@final
class ADMMConstraintSolver(IterativeSolver):
    """Finds impulses of all constraints at once, by alternating directions.

    Attributes:
        stats: What was recorded at each iteration, where the settings say `stat_record`.
    """

    __slots__ = ()
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
        g = vector(g, m, "g")
        guesses = result.take_guesses(m)
        begun = time.perf_counter()
        columns = max(2, min(m, settings.lanczos_size)) if m > 1 else 1
        sizes = len(sets.kinds), m, int(settings.anderson_capacity), columns
        storage: _Storage | None = self._storage
        if storage is None or storage.of != sizes:
            storage = self._storage = _Storage(*sizes)
        storage.fill(operator, g, sets, operator._compliance)
        least = min(operator._compliance.tolist(), default=0.0) + settings.mu_prox
        iterations, power = storage.search(guesses, least, settings, packed, result, self.stats)
        storage.store(result, iterations, power)
        operator._damp(float(storage.now[entries.WEIGHT]))
        self._finished(time.perf_counter() - begun, settings)
        return result.converged


class _Storage(RowStorage):
    """The iterates, and the procedures bound to them."""

    def __init__(self, count: int, m: int, capacity: int, columns: int) -> None:
        super().__init__((count, m))
        self.of = count, m, capacity, columns
        self.now, self._fixed = np.zeros(len(entries.NOW)), np.zeros(len(entries.FIXED))
        self._settings = self._fixed.data.cast("B")[: 8 * entries.HAS_IMPULSES]
        self._vectors = [self.g, *(self.vector() for _ in range(11))]
        width = self.width
        self._factors = Factors(np.zeros((m, width)), np.zeros(m))
        self._basis = Basis(np.zeros((columns, width)), np.zeros(columns), np.zeros(max(columns - 1, 0)))
        past, differences = [np.zeros((capacity, width)) for _ in range(3)], max(capacity - 1, 0)
        self._history = History(
            past[0], past[1], past[2], np.zeros((differences, width)), self.vector(), np.zeros(differences),
            np.zeros(differences, np.int64), np.zeros(2, np.int64),
        )  # fmt: skip
        at = self._iterates(np.zeros((0, entries.RECORDED)))
        self._start = admm_start.bind(
            self.rows, at, self._history, self._factors, self._basis, self._fixed,
            are_arrays_private=True,
        )  # fmt: skip
        self._iterations = self._bound(at)

    def _iterates(self, records: Floats) -> Iterates:
        return Iterates._make([self.G, *self._vectors, self.now, records])

    def _bound(self, at: Iterates) -> Any:
        return admm_iterations.bind(
            self.rows, at, self._history, self._factors, self._fixed, 0, 0, are_arrays_private=True
        )

    def search(
        self,
        guesses: tuple[Floats | None, Floats | None],
        least: float,
        settings: ADMMSolverSettings,
        packed: bytes,
        result: ADMMSolverResult,
        stats: ADMMSolverStats,
    ) -> tuple[int, float]:
        """Searches from guesses of impulses and velocities.

        Args:
            guesses: Impulses and velocities (m,), each where there is one.
            least: The least eigenvalue that the matrix can have with the proximal term [1/kg].
            settings: When the search ends, and how it is made.
            packed: The same, as native code takes it.
            result: Of the search before.
            stats: What is filled, where the settings say so.

        Returns:
            The number of iterations, and the power of the rule SPECTRAL.
        """
        if stats.size():
            stats.reset()
        is_warm = settings.warmstart_rho_with_previous_result and result.isValid()
        rho = result.rho if is_warm else settings.rho_init
        power = result.spectral_rho_power if is_warm else settings.spectral_rho_power_init
        is_spectral = settings.admm_update_rule == ADMMUpdateRule.SPECTRAL
        self._settings[:] = packed
        given = [guess is not None for guess in guesses]
        self._fixed[entries.HAS_IMPULSES :] = *given, is_spectral or rho is None
        self.now[entries.MU], self.now[entries.COUNT] = settings.mu_prox, 1.0
        for target, guess in zip((entries.X_AT, entries.Z_AT), guesses, strict=True):
            self._vectors[target][: self.m] = 0.0 if guess is None else guess
        is_solved = self._start()
        largest = float(self.now[entries.LARGEST])
        if rho is None:
            rho = _spectral(1.0 if math.isnan(largest) else largest, least, power)
        rho = max(min(rho, settings.rho_max), settings.rho_min)
        self.now[entries.RHO] = rho
        if settings.admm_proximal_rule == ADMMProximalRule.AUTOMATIC:
            self.now[entries.MU] = rho
        self.now[entries.ENDED] = float(is_solved)
        if is_solved:
            return 0, power
        if is_spectral:
            _check_apart(largest, least)
            self._fixed[entries.FACTOR] = (largest / least) ** settings.spectral_rho_power_factor
        done = self._iterate(settings, stats)
        if is_spectral:
            power = math.log(self.now[entries.RHO] / math.sqrt(largest * least)) / math.log(largest / least)
        return done, power

    def _iterate(self, settings: ADMMSolverSettings, stats: ADMMSolverStats) -> int:
        """Makes iterations; returns how many were not good enough."""
        run, done, most = self._iterations, 0, int(settings.max_iterations) + 1
        at_once = min(_AT_ONCE, most)
        if settings.stat_record:
            records = np.zeros((at_once, entries.RECORDED))
            run = self._bound(self._iterates(records))
        while done < most and not self.now[entries.ENDED]:
            first = done
            run.set("first", first)
            run.set("last", min(first + at_once, most))
            done = run()
            if settings.stat_record:
                stats.add(records[: done - first + int(self.now[entries.ENDED])])
        if settings.stat_record:
            stats.iterations = done
            stats.delassus_decomposition_update_count = int(self.now[entries.COUNT])
        return done

    def store(self, result: ADMMSolverResult, iterations: int, power: float) -> None:
        """Writes the last iterate into the result.

        Args:
            result: What is filled.
            iterations: How many there were.
            power: Of the rule SPECTRAL [-].
        """
        now = self.now.tolist()
        y, z, shift = (self._vectors[k][: self.m] for k in (entries.Y_AT, entries.Z_AT, entries.S_AT))
        residuals = now[entries.PRIMAL], now[entries.DUAL], now[entries.POWER]
        result.fill(y.copy(), z - shift, iterations, bool(now[entries.ENDED]), residuals)
        result.fill_weights(
            z.copy(), shift.copy(), (now[entries.RHO], now[entries.MU], power), int(now[entries.COUNT])
        )


def _spectral(largest: float, least: float, power: float) -> float:
    """A weight between the least and the greatest eigenvalue: sqrt(L l) (L / l)^power."""
    return math.sqrt(largest * least) * (largest / least) ** power


def _check_apart(largest: float, least: float) -> None:
    """Raises where the rule SPECTRAL has no factor."""
    if not largest > least:
        raise InputError(
            f"The largest eigenvalue of the Delassus matrix is {largest!r}, the least one counts as {least!r}: the "
            "rule SPECTRAL needs them apart. Take the rule OSQP, or a smaller `mu_prox`."
        )
