"""One call of a planner: what it asks for, and what is known while it runs."""

from __future__ import annotations

import time
from typing import Any, NamedTuple, Self

from ulna.planning.joint_box import JointBox
from ulna.planning.result import Outcome
from ulna.planning.search_tree import SearchTree
from ulna.planning.workspace import COARSE
from ulna.system.progress import Report, progress, silent
from ulna.typing import Floats

Failure = tuple[Outcome, str]
"""What stood in the way, and a sentence about it."""

_SHORT = 0.1  # s; of a search that shows no progress

_NO_SECONDS = {"prepare": 0.0, "search": 0.0, "shorten": 0.0, "improve": 0.0, "certify": 0.0}


class Options(NamedTuple):
    """What one call asks for.

    Attributes:
        shorten: How often at most the path is shortened.
        iterations: The most samples.
        timeout: The longest time [s].
        seed: Seed of the samples.
        still: Which numbers of a configuration stay where the start has them, shape (nq,); None for none.
        coarse: The steps of the search, in those of the proof.
        improve: How many samples are spent on shorter paths once there is one.
        keep_tree: Whether the plan has the trees of the search.
        with_reason: Whether a failure says what touches, which takes a millisecond.
        is_shown: Whether a long search shows how many samples it has taken.
    """

    shorten: int
    iterations: int
    timeout: float
    seed: int
    still: Any = None
    coarse: float = COARSE[0]
    improve: int = 0
    keep_tree: bool = False
    with_reason: bool = True
    is_shown: bool = True


class Run:
    """What is known of one call while it runs; it ends, as a context, when progress is no longer shown.

    Args:
        options: What it asks for.
        q0: Where the robot is, shape (nq,) [rad, m].
        goals: Where it may go, shape (n, nq) [rad, m].
    """

    __slots__ = (
        "_progress", "_report", "direct", "goals", "improvements", "last_time", "nodes", "numbers", "options", "q0",
        "roots", "seconds", "start_time", "started", "tree", "used", "workspace",
    )  # fmt: skip

    def __init__(self, options: Options, q0: Floats, goals: Floats) -> None:
        self.options, self.q0, self.goals = options, q0, goals
        self.start_time = self.last_time = time.perf_counter()
        self.numbers: list[int] = []
        self.workspace: Any = None
        self.tree: SearchTree | None = None
        self.direct, self.roots, self.used, self.nodes = -1, 0, 0, 0
        self.started: tuple[int, int, int] | None = None
        self.improvements: list[tuple[float, float]] = []
        self.seconds = dict(_NO_SECONDS)
        self._progress: Any = None
        self._report: Report = silent

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        if self._progress is not None:
            self._progress.__exit__(*error)

    def is_late(self) -> bool:
        """Whether the time is up; a search that takes long shows its progress from here on."""
        elapsed = time.perf_counter() - self.start_time
        if elapsed > _SHORT and self.options.is_shown:
            if self._progress is None:  # the thread of a progress takes longer than most searches
                self._progress = progress("Planning")
                self._report = self._progress.__enter__()
            self._report(self.used, self.options.iterations)
        return elapsed > self.options.timeout

    def check_limits(self, box: JointBox) -> Failure | None:
        """Notes in `numbers` which goals are within the limits of the joints.

        Args:
            box: The limits.

        Returns:
            Why the search cannot begin: the start or all goals are outside, or there is no goal; else None.
        """
        if not box.holds(self.q0):
            return "start", f"`q0` is out of limits: {box.violations(self.q0)}."
        if len(self.goals) == 1 and box.holds(self.goals[0]):
            self.numbers = [0]
            return None
        if not len(self.goals):
            return "unreachable", "no configuration within the limits was found for the pose."
        self.numbers = [k for k, goal in enumerate(self.goals) if box.holds(goal)]
        if not self.numbers:
            return "goal", f"the goal is out of limits: {box.violations(self.goals[0])}."
        return None

    def limit_reached(self) -> Failure:
        """That no path was found, and within which limit."""
        is_used = self.used >= self.options.iterations
        limit = f"{self.used} samples" if is_used else f"{self.options.timeout:g} s"
        reason = f"no path was found within {limit}. Allow more, or another seed."
        return "iterations" if is_used else "time", reason

    def note(self, part: str) -> None:
        """Adds the time since the last note to a part's."""
        now = time.perf_counter()
        self.seconds[part] += now - self.last_time
        self.last_time = now

    def shortened(self) -> tuple[Floats, int]:
        """The path at which the trees met, shortened, and the number of its goal.

        Returns:
            Points, shape (n, nq), from the very start to the very goal [rad, m], and a number among `goals`.
        """
        points, goal = self.workspace.shortened(self.options.shorten)
        points[0], points[-1] = self.q0, self.goals[goal]
        if self.options.still is not None:
            points[:, self.options.still] = self.q0[self.options.still]
        return points, goal
