"""What the iterative solvers of constraints share: tolerances, results, and the state of a solver."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from pinocchio._containers.arguments import ArgumentError, check_size
from pinocchio._containers.arrays import vector
from pinocchio._containers.attributes import AttributeKind, CheckedAttributes, flag, number, whole
from ulna.errors import InputError
from ulna.typing import Floats


class ToleranceSettings(CheckedAttributes):
    """Tolerances of a solver, and what it records.

    Attributes:
        absolute_feasibility_tol: Greatest residual of impulses and velocities.
        relative_feasibility_tol: Greatest change of the iterates in an iteration, as a part of the largest entry: where
            it is met the search ends, whatever the residuals are. ADMM adds the same part of impulses and velocities to
            `absolute_feasibility_tol`.
        absolute_complementarity_tol: Greatest power of impulses and velocities.
        relative_complementarity_tol: Accepted, as in Pinocchio, and not used.
        max_iterations: How many iterations at most, after the first one.
        solve_ncp: Whether contacts slide as Coulomb says; else a convex problem is solved. PGS always lets them slide;
            there it is about `stats.dual_feasibility_ncp` alone.
        measure_timings: Whether `getElapsedTime` is measured.
        stat_record: Whether iterations are recorded in `solver.stats`, which takes longer.
    """

    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        **dict.fromkeys(("absolute_feasibility_tol", "relative_feasibility_tol"), number),
        **dict.fromkeys(("absolute_complementarity_tol", "relative_complementarity_tol"), number),
        **dict.fromkeys(("solve_ncp", "measure_timings", "stat_record"), flag),
        "max_iterations": whole,
    }
    __slots__ = (
        "_packed",
        "absolute_complementarity_tol",
        "absolute_feasibility_tol",
        "max_iterations",
        "measure_timings",
        "relative_complementarity_tol",
        "relative_feasibility_tol",
        "solve_ncp",
        "stat_record",
    )

    _packed: bytes | None

    def __init__(self) -> None:
        self.absolute_feasibility_tol = self.absolute_complementarity_tol = 1e-6
        self.relative_feasibility_tol = self.relative_complementarity_tol = 1e-6
        self.max_iterations, self.solve_ncp = 1000, True
        self.measure_timings = self.stat_record = False

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)
        object.__setattr__(self, "_packed", None)

    def packed(self) -> bytes:
        """The settings as native code takes them, checked.

        Returns:
            Numbers of 8 bytes each.

        Raises:
            InputError: A number makes no sense.
        """
        packed: bytes | None = self._packed
        if packed is None:
            self.checkValidity()
            packed = np.array(self.numbers(), float).tobytes()
            object.__setattr__(self, "_packed", packed)
        return packed

    def numbers(self) -> tuple[float, ...]:
        """The settings as native code takes them."""
        raise NotImplementedError

    def checkValidity(self) -> None:
        """Checks the settings.

        Raises:
            InputError: A number makes no sense.
        """
        tolerances = (
            self.absolute_feasibility_tol,
            self.relative_feasibility_tol,
            self.absolute_complementarity_tol,
            self.relative_complementarity_tol,
        )
        if not all(tolerance >= 0.0 for tolerance in tolerances):
            raise InputError(f"The tolerances are {tolerances}; expected numbers not below zero.")


class ConstraintSolverResult:
    """Impulses and velocities of a solution, and the impulses that the next search starts from.

    Attributes:
        converged: Whether the solution is within the tolerances.
        iterations: How many iterations came before the one that was good enough; where none was, how many were made.
        primal_feasibility: How far impulses are from their sets.
        dual_feasibility: How far velocities are from where they should be [m/s].
        complementarity: How much power impulses and velocities have.
    """

    __slots__ = (
        "_impulse_guess",
        "_impulses",
        "_velocities",
        "_velocity_guess",
        "complementarity",
        "converged",
        "dual_feasibility",
        "iterations",
        "primal_feasibility",
    )

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forgets the solution, and what the next search starts from."""
        self._impulse_guess: Floats | None = None
        self._velocity_guess: Floats | None = None
        self._impulses: Floats | None = None
        self._velocities: Floats | None = None
        self.converged, self.iterations = False, 0
        self.primal_feasibility = self.dual_feasibility = self.complementarity = np.nan

    def take_guesses(self, size: int) -> tuple[Floats | None, Floats | None]:
        """What a search starts from; later ones do not.

        Args:
            size: Number of rows.

        Returns:
            Impulses and velocities (size,), each where it was given.

        Raises:
            WrongShape: One has another size.
        """
        if self._impulse_guess is None and self._velocity_guess is None:
            return None, None
        guesses = []
        for name in ("impulse", "velocity"):
            guess = getattr(self, f"_{name}_guess")
            guesses.append(None if guess is None else vector(guess, size, f"the guess of the {name}"))
        self._impulse_guess = self._velocity_guess = None
        return guesses[0], guesses[1]

    def fill(
        self,
        impulses: Floats,
        velocities: Floats,
        iterations: int,
        converged: bool,
        residuals: tuple[float, float, float],
    ) -> None:
        """Stores a solution.

        Args:
            impulses: Impulses (m,) [N s].
            velocities: Velocities of the constraints with them (m,) [m/s].
            iterations: How many iterations came before the last one, or were made in vain.
            converged: Whether it is within the tolerances.
            residuals: Primal feasibility, dual feasibility, complementarity [any].
        """
        self._impulses, self._velocities = impulses, velocities
        self.iterations, self.converged = iterations, converged
        self.primal_feasibility, self.dual_feasibility, self.complementarity = residuals

    def resize(self, problem_size: int) -> None:
        """Forgets the solution; the next search sizes it by itself."""
        self.reset()

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

    def _solution(self, values: Floats | None) -> Floats:
        if values is None:
            solver = type(self).__name__.replace("SolverResult", "ConstraintSolver")
            raise InputError(f"The result is empty; give it to {solver}().solve(...) first.")
        return values

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
        self._impulse_guess = vector(impulse_guess, np.size(impulse_guess), "impulse_guess").copy()

    def clearConstraintImpulseGuess(self) -> None:
        """Lets the next search start from no impulses."""
        self._impulse_guess = None

    def setConstraintVelocityGuess(self, velocity_guess: Any) -> None:
        """Velocities that the next search of ADMM starts from; PGS starts from impulses alone."""
        self._velocity_guess = vector(velocity_guess, np.size(velocity_guess), "velocity_guess").copy()

    def clearConstraintVelocityGuess(self) -> None:
        """Lets the next search start from the velocities that follow from the impulses."""
        self._velocity_guess = None


class IterativeSolver:
    """The state of a solver after its last search."""

    __slots__ = ("_elapsed", "_storage", "_valid", "stats")
    _recorded: ClassVar[Any]
    """The class of its records."""

    def __init__(self, problem_size: int = 0) -> None:
        check_size(problem_size, "problem_size", 100_000)
        self.stats: Any = self._recorded()
        self._storage: Any = None
        self.reset()

    def reset(self) -> None:
        """Forgets the last search and its records."""
        self._elapsed, self._valid = 0.0, False
        self.stats.reset()

    def isValid(self) -> bool:
        """Whether it has solved something."""
        return self._valid

    def getElapsedTime(self) -> float:
        """How long the last search took [microseconds]; 0 where the settings do not say `measure_timings`."""
        return self._elapsed

    def _finished(self, seconds: float, settings: ToleranceSettings) -> None:
        """Stores that a search has ended, and how long it took."""
        self._elapsed, self._valid = 1e6 * seconds if settings.measure_timings else 0.0, True


def check_settings_and_result(settings: Any, result: Any, expected: tuple[type, type]) -> bytes:
    """Checks the classes of the settings and of the result, and the values of the settings.

    Args:
        settings: Settings of the solver.
        result: Result to fill.
        expected: The classes of both.

    Returns:
        The settings as native code takes them.

    Raises:
        ArgumentError: One is of another class.
        InputError: A number of the settings makes no sense.
    """
    if not isinstance(settings, expected[0]) or not isinstance(result, expected[1]):
        names = " and ".join(f"{cls.__name__}()" for cls in expected)
        raise ArgumentError(f"The settings are {settings!r} and the result {result!r}; expected {names}.")
    return settings.packed()
