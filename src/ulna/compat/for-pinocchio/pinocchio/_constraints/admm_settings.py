"""Input and output of the ADMM solver: settings, results, and a record of the iterations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, final

from pinocchio._constraints._procedures import admm_iterations as entries
from pinocchio._constraints.iterative_solver import ConstraintSolverResult, ToleranceSettings, entry
from pinocchio._containers.arguments import check_size
from pinocchio._containers.arrays import StdVec
from pinocchio._containers.attributes import AttributeKind, flag, number, one_of, whole
from pinocchio._containers.enums import _Named
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["ADMMProximalRule", "ADMMSolverResult", "ADMMSolverSettings", "ADMMSolverStats", "ADMMUpdateRule"]


class ADMMUpdateRule(_Named):
    """How the weight rho of the consensus changes."""

    SPECTRAL, OSQP, LINEAR, CONSTANT = map(ord, "SOLC")


class ADMMProximalRule(_Named):
    """Whether the proximal weight is the setting `mu_prox`, or that of the consensus, rho."""

    MANUAL, AUTOMATIC = map(ord, "MA")


@final
class ADMMSolverSettings(ToleranceSettings):
    """When a solution is good enough, and how it is computed; the other attributes are those of `ToleranceSettings`.

    Attributes:
        mu_prox: The proximal weight, with the rule MANUAL, and for the eigenvalues.
        admm_proximal_rule: MANUAL or AUTOMATIC.
        admm_update_rule: How rho changes: SPECTRAL, OSQP, LINEAR or CONSTANT.
        tau, tau_prox: By what rho and the proximal weight are multiplied, above 0, at most 1.
        dual_momentum: What part of velocities stays in each iteration.
        rho_init: rho at first; None for one between the eigenvalues.
        rho_min, rho_max: Bounds of rho.
        rho_momentum: What part of rho stays at a change, of its logarithm.
        rho_min_update_frequency: How many iterations there are between changes, at least.
        rho_update_ratio: A change is made where one of the old and the new rho is at least this many times the other.
        ratio_primal_dual: By what factor residuals may differ before rho changes.
        linear_update_rule_factor: The factor of the rule LINEAR, above 1.
        spectral_rho_power_init: The power of the rule SPECTRAL at first.
        spectral_rho_power_factor: By how much that power changes.
        max_delassus_decomposition_updates: How many times matrices are factorized at most; at least twice.
        warmstart_rho_with_previous_result: Whether rho is at first that of the result.
        lanczos_size: How many rows the matrix has that the largest eigenvalue is estimated from, at least 2.
        anderson_capacity: From how many iterates the next one is extrapolated; not at all below 2.
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
        self.tau, self.tau_prox, self.dual_momentum, self.rho_update_ratio = 0.5, 1.0, 0.0, 0.0
        self.anderson_capacity = 0

    def checkValidity(self) -> None:
        """Checks all settings.

        Raises:
            InputError: A number makes no sense.
        """
        super().checkValidity()
        if not 0.0 <= self.rho_min <= self.rho_max:
            raise InputError(
                f"`rho_min` is {self.rho_min!r}, `rho_max` {self.rho_max!r}; expected 0 <= rho_min <= rho_max."
            )
        positive = ["mu_prox", "tau", "tau_prox", "ratio_primal_dual"]
        if self.rho_init is not None:
            positive.append("rho_init")
        for name in positive:
            if not getattr(self, name) > 0.0:
                raise InputError(f"`{name}` is {getattr(self, name)!r}; expected a number above zero.")
        for name in ("tau", "tau_prox", "rho_momentum"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(f"`{name}` is {getattr(self, name)!r}; expected a number of at most one.")
        if not self.dual_momentum >= 0.0:
            raise InputError(f"`dual_momentum` is {self.dual_momentum!r}; expected a number not below zero.")
        least = 1.0 if self.admm_update_rule == ADMMUpdateRule.LINEAR else -1.0
        if not self.linear_update_rule_factor > least:
            raise InputError(
                f"`linear_update_rule_factor` is {self.linear_update_rule_factor!r}; expected a number above 1."
            )

    def numbers(self) -> tuple[float, ...]:
        """The settings as `admm_search` takes them."""
        rule = self.admm_update_rule
        return (
            self.tau,
            self.tau_prox,
            self.dual_momentum,
            self.rho_momentum,
            self.rho_min,
            self.rho_max,
            self.rho_update_ratio,
            self.ratio_primal_dual,
            self.absolute_feasibility_tol,
            self.relative_feasibility_tol,
            self.absolute_complementarity_tol,
            self.linear_update_rule_factor,
            0.0 if rule == ADMMUpdateRule.CONSTANT else 2.0 if rule == ADMMUpdateRule.OSQP else 1.0,
            self.admm_proximal_rule == ADMMProximalRule.AUTOMATIC,
            self.solve_ncp,
            self.rho_min_update_frequency,
            self.max_delassus_decomposition_updates,
            self.mu_prox,
            rule == ADMMUpdateRule.SPECTRAL,
            self.spectral_rho_power_factor,
            -1.0 if self.rho_init is None else self.rho_init,
            self.spectral_rho_power_init,
            self.warmstart_rho_with_previous_result,
            self.max_iterations,
        )


@final
class ADMMSolverResult(ConstraintSolverResult):
    """The solution, and what the next search starts from; the other attributes are those of `ConstraintSolverResult`.

    Attributes:
        rho, mu_prox, spectral_rho_power: The weights at the end, and the power of the rule SPECTRAL.
        delassus_decomposition_update_count: How many matrices were factorized, with one for the proximal weight alone.
    """

    __slots__ = ()
    _head, _vectors = entries.HEAD, 6
    rho = entry(entries.RHO_OUT, number, "The weight of the consensus at the end.")
    mu_prox = entry(entries.MU_OUT, number, "The proximal weight at the end [1/kg].")
    spectral_rho_power = entry(entries.EXPONENT_OUT, number, "The power of the rule SPECTRAL [-].")
    delassus_decomposition_update_count = entry(
        entries.COUNT_OUT, whole, "How many matrices were factorized."
    )

    def reset(self) -> None:
        """Forgets the solution, and what the next search starts from."""
        super().reset()
        self._values[entries.COUNT_OUT] = 0.0

    def retrieveDualSolution(self, dual_solution: Floats) -> None:
        """Copies the velocities with De Saxce's shift into an array."""
        dual_solution[...] = self._vector(4)

    def retrieveDesaxceTerm(self, desaxce_term: Floats) -> None:
        """Copies De Saxce's shift into an array."""
        desaxce_term[...] = self._vector(5)


_RECORDED = (
    "primal_feasibility",
    "dual_feasibility",
    "dual_feasibility_ncp",
    "complementarity",
    "rho",
    "mu_prox",
    "anderson_size",
    "linear_system_residual",
    "linear_system_consistency",
)
"""The columns of the records, see `admm_iterations`."""


@final
class ADMMSolverStats:
    """Residuals and weights of each iteration, a list each.

    Attributes:
        iterations: How many there were.
        delassus_decomposition_update_count: How many matrices were factorized, with one for the proximal weight alone.
        linear_system_residual, linear_system_consistency: How far the solved equations are from zero.
        anderson_size: From how many iterates the next one could be extrapolated.
    """

    primal_feasibility: StdVec[float]
    dual_feasibility: StdVec[float]
    dual_feasibility_ncp: StdVec[float]
    complementarity: StdVec[float]
    rho: StdVec[float]
    mu_prox: StdVec[float]
    anderson_size: StdVec[int]
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
        for name in _RECORDED:
            setattr(self, name, StdVec())

    def size(self) -> int:
        """How many iterations are recorded."""
        return len(self.rho)

    def add(self, records: Floats) -> None:
        """Adds iterations.

        Args:
            records: Of each what `admm_search` records (iterations, 9).
        """
        for name, column in zip(_RECORDED, records.T.tolist(), strict=True):
            getattr(self, name).extend(map(int, column) if name == "anderson_size" else column)
