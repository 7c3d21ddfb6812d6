"""What the iterative solvers of constraints share: tolerances, results, and the state of a solver."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np

from pinocchio._constraints._procedures.solver_rows import (
    CONVERGED_OUT,
    DUAL_OUT,
    HAS_IMPULSES_OUT,
    HAS_VELOCITIES_OUT,
    HEAD,
    ITERATIONS_OUT,
    POWER_OUT,
    PRIMAL_OUT,
)
from pinocchio._constraints.anchors import PointContactConstraintModel
from pinocchio._constraints.delassus import DelassusOperatorDense
from pinocchio._constraints.solver_problem import AT_ONCE
from pinocchio._containers.arguments import ArgumentError, check_size, checks_itself
from pinocchio._containers.arrays import vector
from pinocchio._containers.attributes import AttributeKind, CheckedAttributes, flag, number, whole
from ulna.compiler.runtime.procedure_method import Calls, Slot, has_machine_code, procedure_method
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


def entry(place: int, kind: AttributeKind, text: str) -> Any:
    """An attribute that is an entry of the numbers of a result.

    Args:
        place: Its index.
        kind: What may be assigned to it; `whole` and `flag` are read as integers and truth values.
        text: What it is.

    Returns:
        The property.
    """
    read: Any = {whole: int, flag: bool}.get(kind, float)

    def get(result: ConstraintSolverResult) -> Any:
        return read(result._values.item(place))

    def put(result: ConstraintSolverResult, value: Any) -> None:
        result._values[place] = kind(result, f"entry {place}", value)

    return property(get, put, doc=text)


class ConstraintSolverResult:
    """Impulses and velocities of a solution, and the impulses that the next search starts from.

    Attributes:
        converged: Whether the solution is within the tolerances.
        iterations: How many iterations came before the one that was good enough; where none was, how many were made.
        primal_feasibility: How far impulses are from their sets.
        dual_feasibility: How far velocities are from where they should be [m/s].
        complementarity: How much power impulses and velocities have.
    """

    __slots__ = ("_impulse_guess", "_size", "_values", "_velocity_guess")
    _impulse_guess: Floats | None
    _velocity_guess: Floats | None
    """What the next search starts from, until there is a place in `_values` for so many rows."""
    _head, _vectors = HEAD, 4
    """How many numbers `_values` begins with, and how many vectors follow."""
    _values: Floats
    """All that `Given.out` is."""
    _size: int | None
    """How many rows there are, where there is a solution."""
    primal_feasibility = entry(PRIMAL_OUT, number, "How far impulses are from their sets.")
    dual_feasibility = entry(DUAL_OUT, number, "How far velocities are from where they should be [m/s].")
    complementarity = entry(POWER_OUT, number, "How much power impulses and velocities have.")
    iterations = entry(ITERATIONS_OUT, whole, "How many iterations were not good enough.")
    converged = entry(CONVERGED_OUT, flag, "Whether the solution is within the tolerances.")

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forgets the solution, and what the next search starts from."""
        self._impulse_guess = self._velocity_guess = None
        self._size, self._values = None, np.full(self._head, np.nan)
        self._values[[ITERATIONS_OUT, CONVERGED_OUT, HAS_IMPULSES_OUT, HAS_VELOCITIES_OUT]] = 0.0

    def __copy__(self) -> Self:
        other = type(self)()
        for name in ConstraintSolverResult.__slots__:
            setattr(other, name, getattr(self, name))
        other._values = self._values.copy()
        return other

    def place_for(self, size: int) -> Floats:
        """The array that a solution of so many rows is written into, with what the search starts from.

        Raises:
            WrongShape: That is of another number of rows.
        """
        waiting = self._impulse_guess is not None or self._velocity_guess is not None
        if size == self._size and not waiting:
            return self._values
        guesses = self._impulse_guess, self._velocity_guess
        places = HAS_IMPULSES_OUT, HAS_VELOCITIES_OUT
        for k, name in enumerate(("impulse", "velocity")):
            given = self._vector(2 + k) if self._values[places[k]] and size != self._size else guesses[k]
            if given is not None:
                vector(given, size, f"the guess of the {name}")
        if size != self._size:
            length = self._vectors * size
            self._values = np.concatenate([self._values[: self._head], np.zeros(length)])
            self._size = size
        for k, guess in enumerate(guesses):
            if guess is not None:
                self._vector(2 + k)[:] = guess
                self._values[places[k]] = 1.0
        self._impulse_guess = self._velocity_guess = None
        return self._values

    def resize(self, problem_size: int) -> None:
        """Forgets the solution; the next search sizes it by itself."""
        self.reset()

    def isValid(self) -> bool:
        """Whether it holds a solution."""
        return self._size is not None

    @property
    def problem_size(self) -> int:
        """How many rows there are."""
        return self._size or 0

    def constraintSize(self) -> int:
        """How many rows there are."""
        return self.problem_size

    def _vector(self, k: int) -> Floats:
        if self._size is None:
            solver = type(self).__name__.replace("SolverResult", "ConstraintSolver")
            raise InputError(f"The result is empty; give it to {solver}().solve(...) first.")
        start = self._head + k * self._size
        return self._values[start : start + self._size]

    def retrieveConstraintImpulses(self) -> Floats:
        """The impulses [N s], a copy."""
        return self._vector(0).copy()

    def retrieveConstraintVelocities(self) -> Floats:
        """The velocities of the constraints with them [m/s], a copy."""
        return self._vector(1).copy()

    def retrievePrimalSolution(self, primal_solution: Floats) -> None:
        """Copies the impulses into an array."""
        primal_solution[...] = self._vector(0)

    def retrieveDualSolution(self, dual_solution: Floats) -> None:
        """Copies the velocities into an array."""
        dual_solution[...] = self._vector(1)

    def setConstraintImpulseGuess(self, impulse_guess: Any) -> None:
        """Impulses that the next search starts from."""
        guess = vector(impulse_guess, np.size(impulse_guess), "impulse_guess")
        self.clearConstraintImpulseGuess()
        if len(guess) == self._size:
            self._vector(2)[:] = guess
            self._values[HAS_IMPULSES_OUT] = 1.0
        else:
            self._impulse_guess = guess.copy()

    def clearConstraintImpulseGuess(self) -> None:
        """Lets the next search start from no impulses."""
        self._impulse_guess, self._values[HAS_IMPULSES_OUT] = None, 0.0

    def setConstraintVelocityGuess(self, velocity_guess: Any) -> None:
        """Velocities that the next search of ADMM starts from; PGS starts from impulses alone."""
        guess = vector(velocity_guess, np.size(velocity_guess), "velocity_guess")
        self.clearConstraintVelocityGuess()
        if len(guess) == self._size:
            self._vector(3)[:] = guess
            self._values[HAS_VELOCITIES_OUT] = 1.0
        else:
            self._velocity_guess = guess.copy()

    def clearConstraintVelocityGuess(self) -> None:
        """Lets the next search start from the velocities that follow from the impulses."""
        self._velocity_guess, self._values[HAS_VELOCITIES_OUT] = None, 0.0


class IterativeSolver:
    """The state of a solver after its last search.

    A search that is made for the second time leaves a table in `_calls`, by which others like it run without Python.
    """

    __slots__ = ("_calls", "_elapsed", "_key", "_storage", "_table", "_valid", "stats")
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
        self._calls = self._table = self._key = None
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

    def _repeat(self, run: Any, *arguments: Any) -> None:
        """Has searches like the last one run without Python, if the one before was like it.

        Args:
            run: The bound procedure that made it.
            *arguments: The arguments of `solve`.
        """
        operator, g, models, datas, settings, _ = arguments
        key = None
        if self._may_be_repeated(operator, g, models, datas, settings):
            kinds = tuple(map(type, arguments))
            key = (run, settings.packed(), kinds, list(models), len(datas))
        last, self._key = self._key, key
        if key is None or last is None or key[1] is not last[1] or key != last:
            self._table = None
            return
        if self._table is None:
            calls = Calls(run, (self, *arguments))
            calls.expect_kind(1, 5, 6)
            calls.expect_same(Slot(0, "stats"))
            calls.expect_same(Slot(5, "_packed"))
            calls.expect_same(Slot(6, "_impulse_guess"))
            calls.expect_same(Slot(6, "_velocity_guess"))
            calls.expect_entries(3)
            calls.expect_length(4)
            for name in ("G", "compliance", "damping"):
                calls.take_array(Slot(1, f"_{name}"), f"given.{name}", self._damps and name == "damping")
            calls.take_array(Slot(2), "given.g")
            calls.take_array(Slot(6, "_values"), "given.out", True)
            self._storage.is_written_elsewhere = True
            for k, one in enumerate(models):
                calls.take_float(one, "_friction", self._storage.rows.upper[3 * k : 3 * k + 1])
            self._table = calls.table()
        self._calls = self._table[0]

    _damps: ClassVar[bool] = False
    """Whether the damping of the operator is written."""

    _serves: ClassVar[bool] = False
    """Whether searches can be made without Python."""

    def _may_be_repeated(self, operator: Any, g: Any, models: Any, datas: Any, settings: Any) -> bool:
        return (
            self._serves
            and type(operator) is DelassusOperatorDense
            and type(g) is np.ndarray
            and 0 < len(g) <= _MOST_ROWS
            and settings.max_iterations < AT_ONCE
            and not (settings.stat_record or settings.measure_timings)
            and isinstance(models, list)
            and isinstance(datas, list)
            and all(type(one) is PointContactConstraintModel for one in models)
        )


_MOST_ROWS = 48
"""Searches of more rows take so long that Python counts little, and let other threads run meanwhile."""


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


def repeated(solver: type) -> Any:
    """Has searches of a class of solvers run without Python where one like them was made before."""
    solver.solve = procedure_method(checks_itself(solver.solve), solver, "_calls")  # type: ignore[attr-defined]
    solver._serves = has_machine_code(solver, "solve")  # type: ignore[attr-defined]
    return solver
