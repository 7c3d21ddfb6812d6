"""The paths of many planning problems, and why others have none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np

from ulna.checks.values import count
from ulna.planning.result import Outcome
from ulna.scale.archive import StoredResult
from ulna.typing import Array, Floats

OUTCOMES: tuple[Outcome, ...] = ("solved", "start", "goal", "unreachable", "iterations", "time")


@final
@dataclass(frozen=True, eq=False, repr=False)
class PlanSet(StoredResult):
    """The plans of n problems.

    Attributes:
        starts: Where the robot was, (n, nq) [rad, m].
        goals: Where it was to go: configurations, (n, nq) [rad, m], or poses, (n, 4, 4) [m].
        worlds: The number of each problem's world, (n,).
        outcomes: How each ended, as a place in ("solved", "start", "goal", "unreachable", "iterations", "time"), (n,).
        certified: Whether it is proved that nothing touches anywhere on the path, (n,).
        cost: The lengths of the paths in joint space; nan where there is none, (n,) [rad, m].
        iterations: Samples that each search took, (n,).
        points: The points of all paths, one path after the other, (rows, nq) [rad, m].
        offsets: Where each path begins among them, and where the last one ends, (n + 1,).
        texts: What stood in the way, one text after the other, as bytes of UTF-8.
        text_offsets: Where each text begins among them, (n + 1,).
        job: What was asked: robot, seed, options.
    """

    KIND: ClassVar[str] = "plans"
    starts: Floats
    goals: Floats
    worlds: Array
    outcomes: Array
    certified: Array
    cost: Floats
    iterations: Array
    points: Floats
    offsets: Array
    texts: Array
    text_offsets: Array

    def __len__(self) -> int:
        return len(self.starts)

    @property
    def success(self) -> Array:
        """Which problems are solved, (n,)."""
        return self.outcomes == 0

    def path(self, number: int) -> Floats:
        """The path of a problem, (points, nq) [rad, m]; of no points where there is none.

        Args:
            number: The number of the problem.

        Returns:
            The points of the path.

        Raises:
            InputError: If there is no such problem.
        """
        k = self._checked(number)
        return self.points[self.offsets[k] : self.offsets[k + 1]]

    def outcome(self, number: int) -> Outcome:
        """How a problem ended, in one word, as `Plan.outcome`."""
        return OUTCOMES[int(self.outcomes[self._checked(number)])]

    def reason(self, number: int) -> str:
        """What stood in the way of a path or its proof, as `Plan.reason`; empty where nothing did."""
        k = self._checked(number)
        return self.texts[self.text_offsets[k] : self.text_offsets[k + 1]].tobytes().decode()

    def counts(self) -> dict[Outcome, int]:
        """How many problems ended in each way."""
        return {name: int((self.outcomes == k).sum()) for k, name in enumerate(OUTCOMES)}

    def _checked(self, number: int) -> int:
        return count("number", number, least=0, most=len(self) - 1)

    def __repr__(self) -> str:
        solved = int(self.success.sum())
        text = f"{solved:,} of {len(self):,} problems solved"
        if solved:
            text += f", {int(self.certified.sum()):,} certified, median length {np.nanmedian(self.cost):.3g}"
        others = [f"{n:,} {name}" for name, n in self.counts().items() if n and name != "solved"]
        return f"<plans of {self.job['robot']!r}: {text}{'; ' if others else ''}{', '.join(others)}>"
