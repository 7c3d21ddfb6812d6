"""The solver of constraints that push, rub and hold: projected Gauss-Seidel."""

from __future__ import annotations

import time
from functools import lru_cache
from typing import Any, final

import numpy as np

from pinocchio._constraints.gauss_seidel_stats import PGSSolverStats, recorded
from pinocchio._constraints.solver_problem import constraint_kind, delassus_matrix
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import numbers, vector
from ulna.algorithms.constraints.cone_complementarity import Kind, gauss_seidel
from ulna.compiler import compile as compile_function
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["PGSConstraintSolver", "PGSSolverResult", "PGSSolverSettings"]


@final
class PGSSolverSettings:
    """When a solution is good enough, and how it is sought.

    Attributes:
        absolute_feasibility_tol: How far velocities may be from where they should be [m/s].
        relative_feasibility_tol: The same, as a part of the largest velocity without impulses.
        absolute_complementarity_tol: How much power impulses and velocities may have.
        relative_complementarity_tol: The same, as a part of the largest velocity without impulses, squared, by the
            mean diagonal entry of the Delassus matrix.
        max_iterations: How many rounds at most.
        over_relaxation: What part of each correction is made, above 0 and below 2.
        solve_ncp: Whether contacts slide as Coulomb says; else a convex problem is solved.
        measure_timings: Whether `getElapsedTime` is measured.
        stat_record: Whether residuals of each round are recorded in `solver.stats`, which takes longer.
    """

    __slots__ = (
        "absolute_complementarity_tol",
        "absolute_feasibility_tol",
        "max_iterations",
        "measure_timings",
        "over_relaxation",
        "relative_complementarity_tol",
        "relative_feasibility_tol",
        "solve_ncp",
        "stat_record",
    )

    def __init__(self) -> None:
        self.absolute_feasibility_tol = self.absolute_complementarity_tol = 1e-6
        self.relative_feasibility_tol = self.relative_complementarity_tol = 1e-6
        self.max_iterations, self.over_relaxation, self.solve_ncp = 1000, 1.0, True
        self.measure_timings = self.stat_record = False

    def checkValidity(self) -> None:
        """Raises InputError when a number makes no sense."""
        tolerances = (
            self.absolute_feasibility_tol,
            self.relative_feasibility_tol,
            self.absolute_complementarity_tol,
            self.relative_complementarity_tol,
        )
        if not (min(tolerances) >= 0.0 and max(tolerances) > 0.0):
            raise InputError(
                f"The tolerances are {tolerances}; expected numbers not below zero, and one above."
            )
        if not 0.0 < self.over_relaxation < 2.0:
            raise InputError(
                f"`over_relaxation` is {self.over_relaxation!r}; expected a number above 0, below 2."
            )
        if int(self.max_iterations) != self.max_iterations or self.max_iterations < 1:
            raise InputError(f"`max_iterations` is {self.max_iterations!r}; expected a whole number from 1.")


@final
class PGSSolverResult:
    """What was found, and what the next search starts from.

    Attributes:
        converged: Whether it is good enough.
        iterations: How many rounds it took.
        primal_feasibility: How far impulses are from their sets: always 0.
        dual_feasibility: How far velocities are from where they should be [m/s].
        complementarity: How much power impulses and velocities have.
    """

    __slots__ = (
        "_guess",
        "_impulses",
        "_velocities",
        "complementarity",
        "converged",
        "dual_feasibility",
        "iterations",
        "primal_feasibility",
    )

    def __init__(self) -> None:
        self._guess: Floats | None = None
        self.reset()

    def reset(self) -> None:
        """Forgets the solution."""
        self._impulses: Floats | None = None
        self._velocities: Floats | None = None
        self.converged, self.iterations = False, 0
        self.primal_feasibility = self.dual_feasibility = self.complementarity = -1.0

    def isValid(self) -> bool:
        """Whether it holds a solution."""
        return self._impulses is not None

    @property
    def problem_size(self) -> int:
        """How many rows there are."""
        return 0 if self._impulses is None else len(self._impulses)

    def constraintSize(self) -> int:
        """How many rows there are."""
        return self.problem_size

    def _solution(self, what: Floats | None) -> Floats:
        if what is None:
            raise InputError("The result is empty; give it to PGSConstraintSolver().solve(...) first.")
        return what

    def retrieveConstraintImpulses(self) -> Floats:
        """The impulses [N s], a copy."""
        return self._solution(self._impulses).copy()

    def retrieveConstraintVelocities(self) -> Floats:
        """The velocities of the constraints with them [m/s], a copy."""
        return self._solution(self._velocities).copy()

    def retrievePrimalSolution(self, primal_solution: Floats) -> None:
        """Copies the impulses into an array."""
        primal_solution[...] = self._solution(self._impulses)

    def retrieveDualSolution(self, dual_solution: Floats) -> None:
        """Copies the velocities into an array."""
        dual_solution[...] = self._solution(self._velocities)

    def setConstraintImpulseGuess(self, impulse_guess: Any) -> None:
        """Impulses that the next search starts from."""
        self._guess = numbers(impulse_guess, "impulse_guess").reshape(-1).copy()

    def clearConstraintImpulseGuess(self) -> None:
        """Lets the next search start from zero."""
        self._guess = None


@final
class PGSConstraintSolver:
    """Finds impulses of constraints, one after the other, round after round.

    Attributes:
        stats: What was recorded of each round, where the settings say `stat_record`.
    """

    __slots__ = ("_elapsed", "_valid", "stats")

    def __init__(self, problem_size: int = 0) -> None:
        self.stats = PGSSolverStats()
        self.reset()

    def reset(self) -> None:
        """Forgets the last search."""
        self._elapsed, self._valid = 0.0, False

    def isValid(self) -> bool:
        """Whether it has solved something."""
        return self._valid

    def getElapsedTime(self) -> float:
        """How long the last search took [microseconds]; 0 where the settings do not say `measure_timings`."""
        return self._elapsed

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
            delassus: Delassus operator, or matrix (m, m).
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
        if not isinstance(settings, PGSSolverSettings) or not isinstance(result, PGSSolverResult):
            raise ArgumentError(
                f"The settings are {settings!r} and the result {result!r}; expected PGSSolverSettings() and "
                "PGSSolverResult()."
            )
        settings.checkValidity()
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
        guess = np.zeros(m) if result._guess is None else vector(result._guess, m, "the guess")
        largest = float(np.abs(g).max(initial=0.0))
        power = m * largest * largest / float(np.trace(G)) if m else 0.0
        feasible = settings.absolute_feasibility_tol + settings.relative_feasibility_tol * largest
        complementary = settings.absolute_complementarity_tol + settings.relative_complementarity_tol * power
        begun = time.perf_counter()
        enough, most = np.array([feasible, complementary]), int(settings.max_iterations)
        how = float(settings.over_relaxation), bool(settings.solve_ncp)
        if settings.stat_record:
            results = recorded(_kernel(kinds, 1, *how), (G, g, guess, enough), most, self.stats)
        else:
            results = _kernel(kinds, most, *how)(G, g, guess, enough)
        elapsed = 1e6 * (time.perf_counter() - begun)
        self._elapsed, self._valid = elapsed if settings.measure_timings else 0.0, True
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
