"""What the solver of projected Gauss-Seidel records of each round."""

from __future__ import annotations

from typing import final

from pinocchio._containers.arguments import check_size
from ulna.typing import Floats

__all__ = ["PGSSolverStats"]


@final
class PGSSolverStats:
    """Residuals of each round, a list each.

    Args:
        max_iterations: How many rounds to expect; lists grow by themselves.

    Attributes:
        iterations: As in the result; Pinocchio leaves it at 0.
        primal_feasibility: How far impulses are from their sets: always 0.
        dual_feasibility: How far velocities are from where they should be, each right after its impulse [m/s].
        dual_feasibility_ncp: The same, after the round.
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

    def add(self, records: Floats) -> None:
        """Adds rounds.

        Args:
            records: Of each its dual feasibility, its complementarity, and its dual feasibility in the end (rounds, 3).
        """
        off, power, in_the_end = records.T.tolist()
        self.primal_feasibility += [0.0] * len(off)
        self.dual_feasibility += off
        self.complementarity += power
        self.dual_feasibility_ncp += in_the_end
