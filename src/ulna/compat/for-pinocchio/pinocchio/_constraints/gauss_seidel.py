"""The solver of constraints that push, rub and hold: projected Gauss-Seidel."""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, ClassVar, final

import numpy as np

from pinocchio._constraints.gauss_seidel_stats import PGSSolverStats, recorded
from pinocchio._constraints.iterative_solver import (
    ConstraintSolverResult,
    IterativeSolver,
    ToleranceSettings,
    check_settings_and_result,
)
from pinocchio._constraints.solver_problem import constraint_kind, delassus_matrix
from pinocchio._containers.arguments import check_size
from pinocchio._containers.arrays import vector
from pinocchio._containers.attributes import AttributeKind, number
from ulna.algorithms.constraints.cone_complementarity import Kind, gauss_seidel
from ulna.compiler import compile as compile_function
from ulna.errors import InputError

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


@final
class PGSSolverResult(ConstraintSolverResult):
    """The solution, and what the next search starts from; `primal_feasibility` is 0."""

    __slots__ = ()


@final
class PGSConstraintSolver(IterativeSolver):
    """Finds impulses of constraints, one after the other, round after round.

    Attributes:
        stats: What was recorded of each round, where the settings say `stat_record`.
    """

    __slots__ = ("stats",)

    def __init__(self, problem_size: int = 0) -> None:
        check_size(problem_size, "problem_size", 100_000)
        self.stats = PGSSolverStats()
        self.reset()

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
            result: What is filled.

        Returns:
            Whether they were found.

        Raises:
            ArgumentError: `settings` or `result` is of another class.
            InputError: No joint moves a constraint.
            WrongShape: The constraints have not as many rows as `g`.
        """
        check_settings_and_result(settings, result, (PGSSolverSettings, PGSSolverResult))
        kinds = tuple(
            constraint_kind(*pair) for pair in zip(constraint_models, constraint_datas, strict=True)
        )
        G = delassus_matrix(delassus, kinds)
        m = len(G)
        g = vector(g, m, "g")
        if not (np.diag(G) > 0.0).all():
            raise InputError(
                "A row of the Delassus matrix is zero: no joint moves it. Leave the constraint out."
            )
        guess = result._impulse_guess
        guess = np.zeros(m) if guess is None else vector(guess, m, "the guess")
        feasible, complementary = settings.thresholds(G, g)
        begun = time.perf_counter()
        enough, most = np.array([feasible, complementary]), int(settings.max_iterations)
        how = float(settings.over_relaxation), bool(settings.solve_ncp)
        if settings.stat_record:
            results = recorded(_kernel(kinds, 1, *how), (G, g, guess, enough), most, self.stats)
        else:
            results = _kernel(kinds, most, *how)(G, g, guess, enough)
        self._finished(time.perf_counter() - begun, settings)
        result._impulses, result._velocities, rounds, off, power = results
        result.iterations, result.primal_feasibility = int(rounds), 0.0
        result.dual_feasibility, result.complementarity = float(off), float(power)
        result.converged = bool(off <= feasible and power <= complementary)
        return result.converged


@lru_cache(maxsize=64)
def _kernel(kinds: tuple[Kind, ...], rounds: int, relaxation: float, sliding: bool) -> Any:
    m = sum(kind.size for kind in kinds)

    def run(G: Any, g: Any, guess: Any, enough: Any) -> Any:
        return tuple(gauss_seidel(G, g, kinds, guess, enough[0], enough[1], rounds, relaxation, sliding))

    return compile_function(run, G=(m, m), g=(m,), guess=(m,), enough=(2,))
