"""Input and output of the ADMM solver: settings, results, and a record of the iterations."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._containers.arrays import vector
from pinocchio._containers.enums import _Named
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["ADMMProximalRule", "ADMMSolverResult", "ADMMSolverSettings", "ADMMSolverStats", "ADMMUpdateRule"]


class ADMMUpdateRule(_Named):
    """How the weight rho of the consensus changes."""

    SPECTRAL = 0
    OSQP = 1
    LINEAR = 2
    CONSTANT = 3


class ADMMProximalRule(_Named):
    """Whether the proximal weight is the setting `mu_prox`, or follows from the largest eigenvalue."""

    MANUAL = 0
    AUTOMATIC = 1


_NOT_OFFERED = {
    "anderson_capacity": 0,
    "dual_momentum": 0.0,
    "tau": 0.5,
    "tau_prox": 1.0,
    "rho_update_ratio": 0.0,
}
"""Settings of Pinocchio's variant that are taken at their default values alone."""


@final
class ADMMSolverSettings:
    """When a solution is good enough, and how it is sought.

    Attributes:
        absolute_feasibility_tol: How far impulses and velocities may be from where they should be.
        relative_feasibility_tol: The same, as a part of the largest velocity without impulses.
        absolute_complementarity_tol: How much power impulses and velocities may have.
        relative_complementarity_tol: The same, as a part of the largest velocity without impulses, squared, by the
            mean diagonal entry of the Delassus matrix.
        max_iterations: How many iterations at most.
        solve_ncp: Whether contacts slide as Coulomb says; else a convex problem is solved.
        mu_prox: The proximal weight, with the rule MANUAL.
        admm_proximal_rule: MANUAL or AUTOMATIC.
        admm_update_rule: How rho changes: SPECTRAL, OSQP, LINEAR or CONSTANT.
        rho_init: rho at first; None for one between the eigenvalues.
        rho_min, rho_max: Bounds of rho.
        rho_momentum: What part of rho stays at a change.
        rho_min_update_frequency: How many iterations there are between changes, at least.
        ratio_primal_dual: By what factor residuals may differ before rho changes.
        linear_update_rule_factor: The factor of the rule LINEAR.
        spectral_rho_power_init: The power of the rule SPECTRAL at first.
        spectral_rho_power_factor: By how much that power changes.
        max_delassus_decomposition_updates: How many times matrices are inverted at most.
        warmstart_rho_with_previous_result: Whether rho is at first that of the result.
        lanczos_size: Accepted: eigenvalues are computed to the last digit.
        measure_timings: Whether `getElapsedTime` is measured.
        stat_record: Whether iterations are recorded in `solver.stats`.
    """

    def __init__(self) -> None:
        self.absolute_feasibility_tol = self.absolute_complementarity_tol = 1e-6
        self.relative_feasibility_tol = self.relative_complementarity_tol = 1e-6
        self.max_iterations, self.solve_ncp, self.mu_prox = 1000, True, 1e-6
        self.admm_proximal_rule, self.admm_update_rule = ADMMProximalRule.MANUAL, ADMMUpdateRule.OSQP
        self.rho_init: float | None = None
        self.rho_min, self.rho_max, self.rho_momentum = 1e-6, 1e6, 0.0
        self.rho_min_update_frequency, self.ratio_primal_dual = 1, 10.0
        self.linear_update_rule_factor = 2.0
        self.spectral_rho_power_init, self.spectral_rho_power_factor = 0.2, 0.05
        self.max_delassus_decomposition_updates = self.lanczos_size = 2**31 - 1
        self.warmstart_rho_with_previous_result = self.measure_timings = self.stat_record = False
        self.__dict__.update(_NOT_OFFERED)

    def checkValidity(self) -> None:
        """Checks all settings.

        Raises:
            InputError: A number makes no sense, or is not offered.
        """
        tolerances = [
            self.absolute_feasibility_tol,
            self.relative_feasibility_tol,
            self.absolute_complementarity_tol,
            self.relative_complementarity_tol,
        ]
        if not (min(tolerances) >= 0.0 and max(tolerances) > 0.0):
            raise InputError(
                f"The tolerances are {tolerances}; expected numbers not below zero, and one above."
            )
        for name, usual in _NOT_OFFERED.items():
            if getattr(self, name) != usual:
                raise InputError(f"`{name}` is {getattr(self, name)!r}; only {usual!r} is offered here.")
        for name in ("max_iterations", "rho_min_update_frequency", "lanczos_size"):
            value = getattr(self, name)
            if int(value) != value or value < 1:
                raise InputError(f"`{name}` is {value!r}; expected a whole number from 1.")
        if not 0.0 < self.rho_min <= self.rho_max:
            raise InputError(
                f"`rho_min` is {self.rho_min!r}, `rho_max` {self.rho_max!r}; expected 0 < rho_min <= rho_max."
            )
        limits = {"mu_prox": 0.0, "linear_update_rule_factor": 1.0, "ratio_primal_dual": 1.0}
        for name, least in limits.items():
            if not getattr(self, name) >= least:
                raise InputError(
                    f"`{name}` is {getattr(self, name)!r}; expected a number not below {least:g}."
                )
        if not 0.0 <= self.rho_momentum < 1.0:
            raise InputError(f"`rho_momentum` is {self.rho_momentum!r}; expected a number from 0, below 1.")
        if self.rho_init is not None and not self.rho_init > 0.0:
            raise InputError(f"`rho_init` is {self.rho_init!r}; expected None or a number above zero.")

    def bounded(self, rho: float) -> float:
        """rho within its bounds."""
        return min(max(rho, self.rho_min), self.rho_max)

    def proximal_weight(self, largest: float) -> float:
        """The proximal weight for a matrix with that largest eigenvalue."""
        return (
            1e-6 * largest if self.admm_proximal_rule == ADMMProximalRule.AUTOMATIC else float(self.mu_prox)
        )


@final
class ADMMSolverResult:
    """What was found, and what the next search starts from.

    Attributes:
        converged: Whether it is good enough.
        iterations: How many iterations it took.
        primal_feasibility: How far impulses are from their sets.
        dual_feasibility: How far velocities are from where they should be [m/s].
        complementarity: How much power impulses and velocities have.
        rho, mu_prox, spectral_rho_power: The weights at the end, and the power of the rule SPECTRAL.
        delassus_decomposition_update_count: How many matrices were inverted.
    """

    def __init__(self) -> None:
        self._impulse_guess: Floats | None = None
        self._velocity_guess: Floats | None = None
        self.reset()

    def reset(self) -> None:
        """Forgets the solution."""
        self._impulses: Floats | None = None
        self._velocities: Floats | None = None
        self._shift: Floats | None = None
        self.converged, self.iterations, self.delassus_decomposition_update_count = False, 0, 0
        self.primal_feasibility = self.dual_feasibility = self.complementarity = np.nan
        self.rho = self.mu_prox = self.spectral_rho_power = np.nan

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

    def fill(self, impulses: Floats, velocities: Floats, shift: Floats, **values: Any) -> None:
        """Takes a solution over.

        Args:
            impulses: Impulses (m,) [N s].
            velocities: Velocities of the constraints with them (m,) [m/s].
            shift: De Saxce's shift (m,) [m/s].
            **values: The attributes.
        """
        self._impulses, self._velocities, self._shift = impulses, velocities, shift
        self.__dict__.update(values)

    def _solution(self, what: Floats | None) -> Floats:
        if what is None:
            raise InputError("The result is empty; give it to ADMMConstraintSolver().solve(...) first.")
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

    def retrieveDesaxceTerm(self, desaxce_term: Floats) -> None:
        """Copies De Saxce's shift into an array."""
        desaxce_term[...] = self._solution(self._shift)

    def setConstraintImpulseGuess(self, impulse_guess: Any) -> None:
        """Impulses that the next search starts from."""
        self._impulse_guess = vector(impulse_guess, np.size(impulse_guess), "impulse_guess").copy()

    def clearConstraintImpulseGuess(self) -> None:
        """Lets the next search start from no impulses."""
        self._impulse_guess = None

    def setConstraintVelocityGuess(self, velocity_guess: Any) -> None:
        """Velocities that the next search starts from."""
        self._velocity_guess = vector(velocity_guess, np.size(velocity_guess), "velocity_guess").copy()

    def clearConstraintVelocityGuess(self) -> None:
        """Lets the next search start from the velocities that follow from the impulses."""
        self._velocity_guess = None

    def guesses(self, size: int) -> tuple[Floats | None, Floats | None]:
        """The guesses of impulses and velocities.

        Raises:
            WrongShape: One has another size.
        """
        pairs = (
            (self._impulse_guess, "the guess of impulses"),
            (self._velocity_guess, "the guess of velocities"),
        )
        impulses, velocities = (None if x is None else vector(x, size, name) for x, name in pairs)
        return impulses, velocities


_RECORDED = {
    "primal_feasibility": "primal",
    "dual_feasibility": "dual",
    "dual_feasibility_ncp": "dual",
    "complementarity": "complementarity",
    "rho": "rho",
    "mu_prox": "mu",
    "delassus_decomposition_update_count": "factorizations",
}


@final
class ADMMSolverStats:
    """Residuals and weights of each iteration, a list each.

    Attributes:
        iterations: How many there were.
    """

    primal_feasibility: list[float]
    dual_feasibility: list[float]
    dual_feasibility_ncp: list[float]
    complementarity: list[float]
    rho: list[float]
    mu_prox: list[float]
    delassus_decomposition_update_count: list[int]

    def __init__(self, max_iterations: int = 0) -> None:
        self.reset()

    def reserve(self, max_iterations: int) -> None:
        """Nothing: lists grow by themselves."""

    def reset(self) -> None:
        """Forgets all."""
        self.iterations = 0
        for name in _RECORDED:
            setattr(self, name, [])

    def size(self) -> int:
        """How many iterations are recorded."""
        return len(self.rho)

    def add(self, search: Any) -> None:
        """Records an iteration of a search."""
        self.iterations = search.iterations
        for name, source in _RECORDED.items():
            getattr(self, name).append(getattr(search, source))
