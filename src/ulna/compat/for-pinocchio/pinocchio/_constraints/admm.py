"""The solver of constraints that push, rub and hold: alternating directions (ADMM), with a proximal term.

| symbol | meaning | shape | unit |
|---|---|---|---|
| G, g | Delassus matrix; velocities of the constraints without impulses | (m, m), (m,) | |
| x, y | impulses that solve the linear equations; the nearest impulses that the constraints may have | (m,) | [N s] |
| z | velocities with them, shifted by s | (m,) | [m/s] |
| s | De Saxce's shift of contacts: mu times the tangential velocity, along the normal | (m,) | [m/s] |
| rho, mu | weights of y = x, and of the proximal term | | [1/kg] |

    (G + (rho + mu) I) x = z + rho y + mu x - g - s,   y = P(x - z / rho),   z <- z - rho (x - y)

Source: Boyd et al., Distributed optimization by ADMM (2011), section 3; Stellato et al., OSQP (2020), section 5.2, for
the rule of rho; Carpentier, Montaut & Le Lidec, From compliant to rigid contact simulation (2024).
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any, final

import numpy as np

from pinocchio._constraints.admm_settings import (
    ADMMSolverResult,
    ADMMSolverSettings,
    ADMMSolverStats,
    ADMMUpdateRule,
)
from pinocchio._constraints.iterative_solver import IterativeSolver, check_settings_and_result
from pinocchio._constraints.solver_problem import constraint_kind, delassus_matrix
from pinocchio._containers.arguments import check_size
from pinocchio._containers.arrays import vector
from ulna.algorithms.constraints.cone_complementarity import Bounded, Frictional, Kind, Unilateral
from ulna.typing import Floats

__all__ = ["ADMMConstraintSolver"]


@final
class ADMMConstraintSolver(IterativeSolver):
    """Finds impulses of all constraints at once, by alternating directions.

    Attributes:
        stats: What was recorded at each iteration, where the settings say `stat_record`.
    """

    def __init__(self, problem_size: int = 0) -> None:
        check_size(problem_size, "problem_size", 100_000)
        self.stats = ADMMSolverStats()
        self.reset()

    def reset(self) -> None:
        """Forgets the last search and its records."""
        super().reset()
        self.stats.reset()

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

        Args:
            g: Velocities of the constraints without impulses (m,) [m/s].
            constraint_models: Contacts, anchors, loops, limits and frictions of joints.
            constraint_datas: Their data, after `calc`.
            settings: When the search ends, and how it is made.
            result: What is filled.

        Returns:
            Whether they were found.

        Raises:
            ArgumentError: `settings` or `result` is of another class.
            WrongShape: The constraints have not as many rows as `g`.
        """
        check_settings_and_result(settings, result, (ADMMSolverSettings, ADMMSolverResult))
        kinds = [constraint_kind(*pair) for pair in zip(constraint_models, constraint_datas, strict=True)]
        G = delassus_matrix(delassus, kinds)
        g = vector(g, len(G), "g")
        begun = time.perf_counter()
        self.stats.reset()
        search = _Search(G, g, kinds, settings, result)
        while not search.step() and search.iterations < settings.max_iterations:
            if settings.stat_record:
                self.stats.add(search)
        if settings.stat_record:
            self.stats.add(search)
        search.store(result)
        self._finished(time.perf_counter() - begun, settings)
        return result.converged


class _Sets:
    """The sets of the impulses of all rows, for projections of all at once."""

    def __init__(self, kinds: Sequence[Kind], size: int) -> None:
        starts = np.cumsum([0, *(kind.size for kind in kinds)])
        contacts = [
            (kind, at) for kind, at in zip(kinds, starts, strict=False) if isinstance(kind, Frictional)
        ]
        self.contacts = np.array([[at, at + 1, at + 2] for _, at in contacts], int).reshape(-1, 3)
        self.friction = np.array([kind.friction for kind, _ in contacts])
        self._lower, self._upper = np.full(size, -np.inf), np.full(size, np.inf)
        for kind, at in zip(kinds, starts, strict=False):
            rows = slice(at, at + kind.size)
            if isinstance(kind, Unilateral):
                self._lower[rows] = 0.0
            elif isinstance(kind, Bounded):
                self._lower[rows], self._upper[rows] = kind.lower, kind.upper

    def project(self, x: Floats) -> Floats:
        """The nearest impulses of the sets."""
        out = np.clip(x, self._lower, self._upper)
        forces, mu = x[self.contacts], self.friction
        normal, slip = forces[:, 2], np.hypot(forces[:, 0], forces[:, 1])
        inside, against = slip <= mu * normal, mu * slip <= -normal
        pressed = np.where(against, 0.0, (normal + mu * slip) / (1.0 + mu * mu))
        scale = np.where(slip > 0.0, mu * pressed / np.where(slip > 0.0, slip, 1.0), 0.0)
        nearest = np.stack([forces[:, 0] * scale, forces[:, 1] * scale, pressed], axis=1)
        out[self.contacts] = np.where(inside[:, None], forces, nearest)
        return out

    def shift(self, velocities: Floats) -> Floats:
        """De Saxce's shift."""
        out = np.zeros(len(velocities))
        sliding = velocities[self.contacts]
        out[self.contacts[:, 2]] = self.friction * np.hypot(sliding[:, 0], sliding[:, 1])
        return out

    def powers(self, impulses: Floats, velocities: Floats) -> Floats:
        """The products of impulses and velocities: of each contact, and of all other rows."""
        products = impulses * velocities
        others = np.where(np.isfinite(self._lower) & np.isinf(self._upper), products, 0.0)
        upper, lower = np.isfinite(self._upper), np.isfinite(self._lower)
        both = upper & lower
        gap = np.where(velocities > 0.0, impulses - self._lower, self._upper - impulses)
        others = np.where(both, np.where(both, gap, 0.0) * np.abs(velocities), others)
        return np.concatenate([others, products[self.contacts].sum(axis=1)])


class _Search:
    """The iterates, and how far they are from a solution."""

    def __init__(
        self,
        G: Floats,
        g: Floats,
        kinds: Sequence[Kind],
        settings: ADMMSolverSettings,
        result: ADMMSolverResult,
    ) -> None:
        size = len(G)
        self._G, self._g, self._settings, self._sets = G, g, settings, _Sets(kinds, size)
        values = np.linalg.eigvalsh(G) if size else np.ones(1)
        self._largest, self._smallest = float(values[-1]), float(max(values[0], 0.0))
        self.mu = settings.proximal_weight(self._largest)
        self.power = float(settings.spectral_rho_power_init)
        self.rho = self._first_rho(result)
        self.factorizations, self.iterations, self._waited = 0, 0, 0
        guess, velocities = result.guesses(size)
        self.y = self.x = self._sets.project(np.zeros(size) if guess is None else guess)
        self.shift = self._sets.shift(G @ self.y + g) if settings.solve_ncp else np.zeros(size)
        self.z = G @ self.y + g + self.shift if velocities is None else velocities
        self.primal = self.dual = self.complementarity = np.inf
        self._feasible, self._complementary = settings.thresholds(G, g)
        self._factor()

    def _first_rho(self, result: ADMMSolverResult) -> float:
        settings = self._settings
        if settings.warmstart_rho_with_previous_result and result.isValid():
            self.power = result.spectral_rho_power
            return float(result.rho)
        return settings.bounded(self._spectral() if settings.rho_init is None else float(settings.rho_init))

    def _spectral(self) -> float:
        """A weight between the least and the greatest eigenvalue: sqrt(L m) (L / m)^p."""
        least = max(self._smallest, self.mu, 1e-300)
        return float(np.sqrt(self._largest * least) * (self._largest / least) ** self.power)

    def _factor(self) -> None:
        self._inverse = np.linalg.inv(self._G + (self.rho + self.mu) * np.eye(len(self._G)))
        self.factorizations += 1

    def step(self) -> bool:
        """One iteration; returns whether its result is good enough."""
        settings, before, sets = self._settings, self.y, self._sets
        self.iterations += 1
        if settings.solve_ncp:
            self.shift = sets.shift(self._G @ self.y + self._g)
        right = self.z + self.rho * self.y + self.mu * self.x - self._g - self.shift
        self.x = self._inverse @ right
        self._right, self._rho_of_step = right, self.rho
        self.y = sets.project(self.x - self.z / self.rho)
        change = self.rho * (self.x - self.y)
        self.z = self.z - change
        self._measure()
        if self._is_good():
            return True
        self._update(float(np.abs(self.rho * (self.y - before)).max(initial=0.0)))
        return False

    @property
    def linear_residual(self) -> float:
        """How far the equations that the last iteration solved are from zero."""
        left = self._G @ self.x + (self._rho_of_step + self.mu) * self.x
        return float(np.abs(left - self._right).max(initial=0.0))

    def _is_good(self) -> bool:
        feasible = max(self.primal, self.dual) <= self._feasible
        return feasible and self.complementarity <= self._complementary

    def _measure(self) -> None:
        velocities = self._G @ self.y + self._g
        exact = velocities + (self._sets.shift(velocities) if self._settings.solve_ncp else 0.0)
        self.primal = float(np.abs(self.x - self.y).max(initial=0.0))
        self.dual = float(np.abs(exact - self.z).max(initial=0.0))
        self.complementarity = float(np.abs(self._sets.powers(self.y, exact)).max(initial=0.0))

    def _update(self, dual: float) -> None:
        """Changes rho by the rule of the settings where one residual, `primal` or `dual`, is much larger."""
        settings, rule = self._settings, self._settings.admm_update_rule
        self._waited += 1
        may = self.factorizations < settings.max_delassus_decomposition_updates
        if rule == ADMMUpdateRule.CONSTANT or not may or self._waited < settings.rho_min_update_frequency:
            return
        primal, dual = max(self.primal, 1e-300), max(dual, 1e-300)
        ratio = settings.ratio_primal_dual
        if primal <= ratio * dual and dual <= ratio * primal:
            return
        grows = primal > dual
        if rule == ADMMUpdateRule.SPECTRAL:
            self.power += settings.spectral_rho_power_factor if grows else -settings.spectral_rho_power_factor
            wanted = self._spectral()
        elif rule == ADMMUpdateRule.LINEAR:
            factor = settings.linear_update_rule_factor
            wanted = self.rho * (factor if grows else 1.0 / factor)
        else:
            scale = max(float(np.abs(self.x).max(initial=0.0)), 1e-300)
            force = max(
                float(np.abs(self.z).max(initial=0.0)), float(np.abs(self._g).max(initial=0.0)), 1e-300
            )
            wanted = self.rho * float(np.sqrt((primal / scale) / (dual / force)))
        wanted = settings.bounded(settings.rho_momentum * self.rho + (1.0 - settings.rho_momentum) * wanted)
        if wanted != self.rho:
            self.rho, self._waited = wanted, 0
            self._factor()

    def store(self, result: ADMMSolverResult) -> None:
        """Writes the last iterate into the result."""
        velocities = self._G @ self.y + self._g
        shift = self._sets.shift(velocities) if self._settings.solve_ncp else np.zeros(len(velocities))
        result.fill(
            self.y,
            velocities,
            shift,
            converged=self._is_good(),
            iterations=self.iterations,
            primal_feasibility=self.primal,
            dual_feasibility=self.dual,
            complementarity=self.complementarity,
            rho=self.rho,
            mu_prox=self.mu,
            spectral_rho_power=self.power,
            delassus_decomposition_update_count=self.factorizations,
        )
