"""One call of a planner: what it asks for, and what is known while it runs."""

from __future__ import annotations

import time
from typing import Any, NamedTuple, Self

from ulna.planning.joint_box import JointBox
from ulna.planning.result import Outcome
from ulna.planning.search_tree import SearchTree
from ulna.planning.stop import STOP
from ulna.planning.workspace import COARSE
from ulna.system.progress import Report, progress, silent
from ulna.typing import Floats

_SHORT = 0.1  # s; of a search that shows no progress

_NO_SECONDS = {"prepare": 0.0, "search": 0.0, "shorten": 0.0, "improve": 0.0, "certify": 0.0}


class Ending(NamedTuple):
    """How a search ended.

    Attributes:
        outcome: "solved", or what stood in the way.
        reason: A sentence about it; empty where all is well.
        touching: The two things that touch at the start or goal, or come too near to each other; None for others.
    """

    outcome: Outcome
    reason: str
    touching: tuple[str, str] | None = None


class Options(NamedTuple):
    """What one call asks for.

    Attributes:
        shorten: Largest number of shortcut passes.
        iterations: The most samples.
        timeout: The longest time [s].
        seed: Seed of the samples.
        fixed_coordinates: Which coordinates stay where the start has them, truth values, shape (nq,); None for none.
        coarse: Step length of the search divided by that of the certificate [-].
        improve: How many samples are spent on shorter paths once there is one.
        keep_tree: Whether the plan has the trees of the search.
        with_reason: Whether a failure says what touches, which takes a millisecond.
        is_shown: Whether a long search shows how many samples it has taken.
    """

    shorten: int
    iterations: int
    timeout: float
    seed: int
    fixed_coordinates: Any = None
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

    Attributes:
        options: As above.
        q0: As above.
        goals: Those that are left, shape (n, nq): within the limits and free, once `Search` has looked at them.
        goal_indices: Of each of `goals`, which of the goals that the caller gave it is.
        direct_goal: An index into `goals`: the first that the straight motion from the start reaches; -1 for none,
            `stages.NOT_ALL_FREE` where the start or a goal is not free.
        roots: How many points the trees begin with: the start and `goals`.
        samples_used: How many samples the search has used.
        nodes: How many nodes both trees have.
        started: Of a search that began along with the look at start and goals: its first sample, the one after its
            last, and what it returned; None for others.
        improvements: Time since the call [s] and length of the first path and of each shorter one [rad, m].
        seconds: How long each part took [s].
        start_time: When the call began [s].
        last_time: When `add_time_to` was called last [s].
        workspace: The tables and arrays of the search; None before it has begun.
        tree: The nodes that the search reached, if they are kept.
    """

    __slots__ = (
        "_progress", "_report", "direct_goal", "goal_indices", "goals", "improvements", "last_time", "nodes", "options",
        "q0", "roots", "samples_used", "seconds", "start_time", "started", "tree", "workspace",
    )  # fmt: skip

    def __init__(self, options: Options, q0: Floats, goals: Floats) -> None:
        self.options, self.q0, self.goals = options, q0, goals
        self.start_time = self.last_time = time.perf_counter()
        self.goal_indices: list[int] = []
        self.workspace: Any = None
        self.tree: SearchTree | None = None
        self.direct_goal, self.roots, self.samples_used, self.nodes = -1, 0, 0, 0
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

    def should_stop(self) -> bool:
        """Whether the time is up; a search that takes long shows its progress from here on."""
        elapsed = time.perf_counter() - self.start_time
        if elapsed > _SHORT and self.options.is_shown:
            if self._progress is None:  # the thread of a progress takes longer than most searches
                self._progress = progress("Planning")
                self._report = self._progress.__enter__()
            self._report(self.samples_used, self.options.iterations)
        return elapsed > self.options.timeout or (STOP.event is not None and STOP.event.is_set())

    def check_limits(self, box: JointBox) -> Ending | None:
        """Notes in `goal_indices` which goals are within the limits of the joints.

        Args:
            box: The limits.

        Returns:
            Why the search cannot begin: the start or all goals are outside, or there is no goal; else None.
        """
        if not box.holds(self.q0):
            return Ending("start", f"`q0` is out of limits: {box.violations(self.q0)}.")
        if len(self.goals) == 1 and box.holds(self.goals[0]):
            self.goal_indices = [0]
            return None
        if not len(self.goals):
            return Ending("unreachable", "no configuration within the limits was found for the pose.")
        self.goal_indices = [k for k, goal in enumerate(self.goals) if box.holds(goal)]
        if not self.goal_indices:
            return Ending("goal", f"the goal is out of limits: {box.violations(self.goals[0])}.")
        return None

    def limit_reached(self) -> Ending:
        """That no path was found, and within which limit."""
        is_used = self.samples_used >= self.options.iterations
        limit = f"{self.samples_used} samples" if is_used else f"{self.options.timeout:g} s"
        reason = f"no path was found within {limit}. Allow more, or another seed."
        return Ending("iterations" if is_used else "time", reason)

    def add_time_to(self, part: str) -> None:
        """Adds the time since the last such call to a part's."""
        now = time.perf_counter()
        self.seconds[part] += now - self.last_time
        self.last_time = now

    def shortened(self) -> tuple[Floats, int]:
        """The path at which the trees met, shortened, and the index of its goal.

        Returns:
            Points, shape (n, nq), from the very start to the very goal [rad, m], and an index into `goals`.
        """
        points, goal = self.workspace.shortened(self.options.shorten)
        points[0], points[-1] = self.q0, self.goals[goal]
        if self.options.fixed_coordinates is not None:
            points[:, self.options.fixed_coordinates] = self.q0[self.options.fixed_coordinates]
        return points, goal
