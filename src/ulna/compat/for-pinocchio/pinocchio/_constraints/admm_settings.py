"""Input and output of the ADMM solver: settings, results, and a record of the iterations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

import numpy as np

from pinocchio._constraints.iterative_solver import ConstraintSolverResult, ToleranceSettings
from pinocchio._containers.arguments import check_size
from pinocchio._containers.arrays import StdVec, vector
from pinocchio._containers.attributes import AttributeKind, flag, number, one_of, whole
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
class ADMMSolverSettings(ToleranceSettings):
    """When a solution is good enough, and how it is computed; the other attributes are those of `ToleranceSettings`.

    Attributes:
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
    """

    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        **dict.fromkeys(("mu_prox", "rho_min", "rho_max", "rho_momentum", "ratio_primal_dual"), number),
        **dict.fromkeys(
            ("linear_update_rule_factor", "spectral_rho_power_init", "spectral_rho_power_factor"), number
        ),
        **dict.fromkeys(("dual_momentum", "tau", "tau_prox", "rho_update_ratio"), number),
        **dict.fromkeys(("rho_min_update_frequency", "lanczos_size", "anderson_capacity"), whole),
        "max_delassus_decomposition_updates": whole,
        "rho_init": lambda target, name, value: None if value is None else number(target, name, value),
        "admm_proximal_rule": one_of(ADMMProximalRule),
        "admm_update_rule": one_of(ADMMUpdateRule),
        "warmstart_rho_with_previous_result": flag,
    }

    def __init__(self) -> None:
        super().__init__()
        self.mu_prox = 1e-6
        self.admm_proximal_rule, self.admm_update_rule = ADMMProximalRule.MANUAL, ADMMUpdateRule.OSQP
        self.rho_init: float | None = None
        self.rho_min, self.rho_max, self.rho_momentum = 1e-6, 1e6, 0.0
        self.rho_min_update_frequency, self.ratio_primal_dual = 1, 10.0
        self.linear_update_rule_factor = 2.0
        self.spectral_rho_power_init, self.spectral_rho_power_factor = 0.2, 0.05
        self.max_delassus_decomposition_updates = self.lanczos_size = 2**31 - 1
        self.warmstart_rho_with_previous_result = False
        self.__dict__.update(_NOT_OFFERED)

    def checkValidity(self) -> None:
        """Checks all settings.

        Raises:
            InputError: A number makes no sense, or is not offered.
        """
        super().checkValidity()
        for name, usual in _NOT_OFFERED.items():
            if getattr(self, name) != usual:
                raise InputError(f"`{name}` is {getattr(self, name)!r}; only {usual!r} is offered here.")
        self._check_whole_number("rho_min_update_frequency")
        self._check_whole_number("lanczos_size")
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
class ADMMSolverResult(ConstraintSolverResult):
    """The solution, and what the next search starts from; the other attributes are those of `ConstraintSolverResult`.

    Attributes:
        rho, mu_prox, spectral_rho_power: The weights at the end, and the power of the rule SPECTRAL.
        delassus_decomposition_update_count: How many matrices were inverted.
    """

    def reset(self) -> None:
        """Forgets the solution."""
        super().reset()
        self._shift: Floats | None = None
        self.primal_feasibility = self.dual_feasibility = self.complementarity = np.nan
        self.rho = self.mu_prox = self.spectral_rho_power = np.nan
        self.delassus_decomposition_update_count = 0

    def fill(self, impulses: Floats, velocities: Floats, shift: Floats, **values: Any) -> None:
        """Stores a solution.

        Args:
            impulses: Impulses (m,) [N s].
            velocities: Velocities of the constraints with them (m,) [m/s].
            shift: De Saxce's shift (m,) [m/s].
            **values: The attributes.
        """
        self._impulses, self._velocities, self._shift = impulses, velocities, shift
        for name, value in values.items():
            setattr(self, name, value)

    def retrieveDesaxceTerm(self, desaxce_term: Floats) -> None:
        """Copies De Saxce's shift into an array."""
        desaxce_term[...] = self._solution(self._shift)

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
    "linear_system_residual": "linear_residual",
    "linear_system_consistency": "linear_residual",
}


@final
class ADMMSolverStats:
    """Residuals and weights of each iteration, a list each.

    Attributes:
        iterations: How many there were.
        delassus_decomposition_update_count: How many matrices were inverted.
        linear_system_residual, linear_system_consistency: How far the solved equations are from zero.
        anderson_size: Zeros: iterates are not extrapolated.
    """

    primal_feasibility: StdVec[float]
    dual_feasibility: StdVec[float]
    dual_feasibility_ncp: StdVec[float]
    complementarity: StdVec[float]
    rho: StdVec[float]
    mu_prox: StdVec[float]
    linear_system_residual: StdVec[float]
    linear_system_consistency: StdVec[float]

    def __init__(self, max_iterations: int = 0) -> None:
        check_size(max_iterations, "max_iterations", 2**63 - 1)
        self.reset()

    def reserve(self, max_iterations: int) -> None:
        """Nothing: lists grow by themselves."""

    def reset(self) -> None:
        """Forgets all."""
        self.iterations = self.delassus_decomposition_update_count = 0
        self.anderson_size: StdVec[int] = StdVec()
        for name in _RECORDED:
            setattr(self, name, StdVec())

    def size(self) -> int:
        """How many iterations are recorded."""
        return len(self.rho)

    def add(self, search: Any) -> None:
        """Records an iteration of a search."""
        self.iterations, self.delassus_decomposition_update_count = search.iterations, search.factorizations
        self.anderson_size.append(0)
        for name, source in _RECORDED.items():
            getattr(self, name).append(getattr(search, source))
