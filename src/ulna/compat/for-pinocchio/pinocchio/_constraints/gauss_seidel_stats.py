"""What the solver of projected Gauss-Seidel records of each round."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

from pinocchio._containers.arguments import check_size

__all__ = ["PGSSolverStats"]


@final
class PGSSolverStats:
    """Residuals of each round, a list each.

    Args:
        max_iterations: How many rounds to expect; lists grow by themselves.

    Attributes:
        iterations: How many rounds there were.
        primal_feasibility: How far impulses are from their sets: always 0.
        dual_feasibility: How far velocities are from where they should be [m/s].
        dual_feasibility_ncp: The same.
        complementarity: How much power impulses and velocities have.
    """

    __slots__ = (
        "complementarity",
        "dual_feasibility",
        "dual_feasibility_ncp",
        "iterations",
        "primal_feasibility",
    )

    def __init__(self, max_iterations: int = 0) -> None:
        self.reserve(max_iterations)
        self.reset()

    def reserve(self, max_iterations: int) -> None:
        """Checks the number; lists grow by themselves."""
        check_size(max_iterations, "max_iterations")

    def reset(self) -> None:
        """Forgets all."""
        self.iterations = 0
        self.primal_feasibility: list[float] = []
        self.dual_feasibility: list[float] = []
        self.dual_feasibility_ncp: list[float] = []
        self.complementarity: list[float] = []

    def size(self) -> int:
        """How many rounds are recorded."""
        return len(self.complementarity)

    def add(self, off: float, power: float) -> None:
        """Records a round.

        Args:
            off: How far velocities are from where they should be [m/s].
            power: How much power impulses and velocities have [any].
        """
        self.primal_feasibility.append(0.0)
        self.dual_feasibility.append(off)
        self.dual_feasibility_ncp.append(off)
        self.complementarity.append(power)


def recorded(
    one_round: Callable[..., Any], problem: tuple[Any, ...], most: int, stats: PGSSolverStats
) -> Any:
    """Runs a solver round by round, and records each.

    Args:
        one_round: The solver for one round: from the problem to impulses, velocities, rounds, residual and power.
        problem: Matrix, velocities, guess, and the two tolerances.
        most: How many rounds at most.
        stats: What is filled.

    Returns:
        What the solver returns for all rounds.
    """
    G, g, guess, enough = problem
    stats.reset()
    while True:
        impulses, velocities, rounds, off, power = one_round(G, g, guess, enough)
        stats.iterations += int(rounds)
        if rounds:
            stats.add(float(off), float(power))
        if not rounds or stats.iterations >= most or (off <= enough[0] and power <= enough[1]):
            return impulses, velocities, stats.iterations, off, power
        guess = impulses
