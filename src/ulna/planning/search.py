"""The search of a planner: trees that grow, a path that is shortened, and its proof."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.collision.touches import deepest_touch
from ulna.planning.certificate import Certificate, certify
from ulna.planning.goals import joint_of_column
from ulna.planning.joint_box import JointBox
from ulna.planning.result import Outcome, Plan
from ulna.planning.run import Ending, Options, Run
from ulna.planning.samples import samples
from ulna.planning.scenes import PlanningScene
from ulna.planning.search_tree import search_tree
from ulna.planning.stages import NOT_ALL_FREE
from ulna.planning.workspace import COARSE, SLICE, Workspace, thread_storage
from ulna.system.cached import cached_property
from ulna.typing import Floats

_SLICE_SECONDS = 0.01  # that the first samples may take, whatever the time limit

MOST_STATES = 1_000_000
"""How many states of a straight motion are checked at most: some tens of milliseconds, in which nothing interrupts."""


class Search:
    """Searches for paths of one robot in one world.

    Args:
        scene: The robot and the world.
        margin: How near everything may come at least [m].
        step: How far any point moves at most between the states by which paths are proved free [m].
        longest: The longest edge of the trees [rad, m].
    """

    _starts_at_once = True  # trees grow as soon as start and goals were examined

    def __init__(self, scene: PlanningScene, margin: float, step: float, longest: float) -> None:
        self._scene, self._margin, self._step, self._longest = scene, margin, step, longest
        self._model = scene.robot.model
        self._storage = threading.local()
        self._box = JointBox(self._model)
        self._wholly_certified = Certificate((), margin, 0)
        low, high = scene.moving.range
        is_limited = self._box.has_limit
        self._range = np.where(is_limited, self._box.low, low), np.where(is_limited, self._box.high, high)

    def run(self, q0: Floats, goals: Floats, options: Options) -> Plan:
        """A path from a configuration to one of several.

        Args:
            q0: Where the robot is, shape (nq,) [rad, m].
            goals: Where it may go, shape (n, nq) [rad, m].
            options: What is asked for.

        Returns:
            The plan, or why there is none.
        """
        workspace = self._workspace(options.coarse)
        workspace.bind(options.improve > 0)  # compiles what a call needs before its clock starts
        if options.improve:
            self._workspace(COARSE[1]).bind(True)
        with Run(options, q0, goals) as run:
            run.workspace = workspace
            return self._planned(run)

    def _planned(self, run: Run) -> Plan:
        """The plan that a run finds, or why there is none."""
        points, goal, failure = self._searched(run)
        if failure is not None:
            return self._result(run, failure, np.zeros((0, self._model.nq)), None, -1)
        if run.options.improve:
            points, goal = self._improved(run, points, goal)
            run.add_time_to("improve")
        points, certificate = self._proved(run, points)
        run.add_time_to("certify")
        reason = "" if certificate else f"edges {certificate.unproved} are not proved free"
        return self._result(run, Ending("solved", reason), points, certificate, run.goal_indices[goal])

    def _searched(self, run: Run) -> tuple[Floats, int, Ending | None]:
        """A path that is not proved yet and the number of its goal; or why there is none."""
        failure = self._prepare(run)
        if failure is not None:
            return run.q0, -1, failure
        if run.direct_goal >= 0:
            return *_straight(run), None
        is_met = self._grow(run)
        run.add_time_to("search")
        if run.options.keep_tree:
            run.tree = search_tree(run.workspace.storage.trees)
        if not is_met:
            return run.q0, -1, run.limit_reached()
        points, goal = self._shortened(run)
        run.add_time_to("shorten")
        return points, goal, None

    # before the search ------------------------------------------------------------------------------------

    def _prepare(self, run: Run) -> Ending | None:
        """Storage, and the goals that are free; why the search cannot begin, where it cannot."""
        if run.workspace is None:
            run.workspace = self._workspace(run.options.coarse)
        run.direct_goal = self._examined(run)
        if run.direct_goal == NOT_ALL_FREE:
            failure = self._keep_free_goals(run)
            if failure is not None:
                return failure
        else:
            run.goal_indices = list(range(len(run.goals)))
        run.roots = 1 + len(run.goals)
        run.add_time_to("prepare")
        return None

    def _examined(self, run: Run) -> int:
        """What `Workspace.examine` returns; the first samples are taken at once where that takes no time."""
        if not len(run.goals) or not self._is_near(run.q0, run.goals).all():
            return NOT_ALL_FREE
        if not self._starts_at_once or run.options.timeout < _SLICE_SECONDS:
            return run.workspace.examine(run.q0, run.goals)
        first, end = self._samples(run, min(SLICE, run.options.iterations))
        run.add_time_to("prepare")
        direct, result = run.workspace.start(run.q0, run.goals, first, end)
        if direct == -1:
            run.started = first, end, result
        run.add_time_to("search")
        return direct

    def _keep_free_goals(self, run: Run) -> Ending | None:
        """Drops goals that are out of limits or touch; why the search cannot begin, where none is left."""
        failure = run.check_limits(self._box)
        if failure is not None:
            return failure
        is_near = self._is_near(run.q0, run.goals[run.goal_indices])
        if not is_near.any():
            return Ending("goal", self._distance_reason(run))
        run.goal_indices = np.array(run.goal_indices)[is_near].tolist()
        run.goals = run.goals[run.goal_indices]
        run.direct_goal = run.workspace.examine(run.q0, run.goals)
        if run.direct_goal != NOT_ALL_FREE:
            return None
        free = run.workspace.free_points(1 + len(run.goals))
        if not (free[0] and any(free[1:])):
            return self._blocked(run, free)
        run.goals = run.goals[free[1:]]
        run.goal_indices = [
            number for number, is_free in zip(run.goal_indices, free[1:], strict=True) if is_free
        ]
        run.direct_goal = run.workspace.examine(run.q0, run.goals)
        return None

    def _is_near(self, q0: Floats, goals: Floats) -> Any:
        """Which goals are so near that a straight motion to them can be checked: all, where all joints have limits."""
        if self._box.is_bounded:
            return np.ones(len(goals), dtype=bool)
        travel = np.abs(goals - q0) @ self._scene.moving.bounds_of_motion[0].T
        return travel.max(axis=1) <= MOST_STATES * self._step

    def _distance_reason(self, run: Run) -> str:
        """Which joint is to move so far that no motion can be checked."""
        goal = run.goals[run.goal_indices[0]]
        change = np.where(self._box.has_limit, 0.0, np.abs(goal - run.q0))
        k = int(np.argmax(change))
        joint = joint_of_column(self._model, k)
        return (
            f"joint {joint!r} is to move by {change[k]:.3g}, from {run.q0[k]:.6g} to {goal[k]:.6g}: too far to check "
            f"the motion in steps of {self._step:g} m. A joint without limits turns to exactly the angle of the goal."
        )

    def _workspace(self, coarse: float) -> Workspace:
        """This thread's storage for a search with steps of a length."""
        kept: dict[float, Workspace] = self._storage.__dict__.setdefault("by_steps", {})
        if coarse not in kept:
            kept[coarse] = self._new_workspace(coarse)
        return kept[coarse]

    def _new_workspace(self, coarse: float) -> Workspace:
        arrays = thread_storage(self._model.nq)
        return Workspace(self._scene, arrays, self._margin, self._step, self._longest, coarse)

    def _shortened(self, run: Run) -> tuple[Floats, int]:
        """The path at which the trees met, shortened, and the number of its goal."""
        return run.shortened()

    def _improved(self, run: Run, points: Floats, goal: int) -> tuple[Floats, int]:
        """The shortest path that more samples find, and the number of its goal."""
        from ulna.planning.improvement import improved  # for few plans

        run.workspace = self._workspace(COARSE[1])  # steps with which nearly every path can be proved
        return improved(
            run,
            points,
            goal,
            self._box.sampled(run.q0, run.goals, run.options.fixed_coordinates),
            self._shortened,
            self._wholly_proved,
        )

    def _wholly_proved(self, run: Run, points: Floats) -> Floats | None:
        """A path, where machine code proves it; None where it does not."""
        return None if self._unproved(run, points) else points

    def _blocked(self, run: Run, free: Sequence[bool]) -> Ending:
        """What the start, or the nearest goal, touches."""
        outcome: Outcome = "goal" if free[0] else "start"
        if not run.options.with_reason:
            return Ending(outcome, "")
        q = run.goals[0] if free[0] else run.q0
        distance, link, other = deepest_touch(self._scene.checker, q, margin=self._margin)
        what = f"overlaps {other!r} by {-1e3 * distance:.3g} mm"
        if distance > 0.0:
            what = f"comes within {1e3 * distance:.3g} mm of {other!r}"
        elif distance == 0.0:
            what = f"comes nearer to {other!r} than its table of clearances can tell"
        who = "the start" if outcome == "start" else "the goal" if len(run.goals) == 1 else "the first goal"
        reason = f"at {who} {link!r} {what}, by their covering spheres."
        if distance > 0.0 and self._margin > 0.0:
            reason += f" `margin` is {1e3 * self._margin:.3g} mm, and counts for each of two links that move."
        others = " or other `pairs`" if other in self._scene.spheres.links else ""
        smaller = " or a smaller `margin`" if self._margin > 0.0 else ""
        reason += (
            ' Where they are apart, plan with method="exact", or give finer spheres (ulna.collision.refine)'
            f"{others}{smaller}."
        )
        return Ending(outcome, reason, (link, other))

    # search -----------------------------------------------------------------------------------------------

    def _grow(self, run: Run) -> bool:
        """Grows both trees until they meet; whether they did."""
        workspace, roots, first, end, result = run.workspace, run.roots, 0, 0, 0
        if run.started is not None:
            (first, end, result), roots = run.started, 0
            run.samples_used += abs(result) - first
            first = result
        while result >= 0 and run.samples_used < run.options.iterations and not run.should_stop():
            if first >= end:
                first, end = self._samples(run, min(SLICE, run.options.iterations - run.samples_used))
            result = workspace.grow(first, end, roots)
            roots = 0
            run.samples_used += abs(result) - first
            first = result
        run.nodes = sum(workspace.storage.trees.counts.tolist())
        return result < 0

    def _samples(self, run: Run, count: int) -> tuple[int, int]:
        """The first row of the storage with the next samples, and the row after them."""
        seed, fixed = run.options.seed, run.options.fixed_coordinates
        is_kept = self._box.is_bounded and fixed is None
        sequence = (self._box.key, seed) if is_kept else None

        def draw() -> Any:
            return samples(run.samples_used, count, seed, *self._box.sampled(run.q0, run.goals, fixed))

        first = run.workspace.storage.hold_samples(sequence, run.samples_used, count, draw)
        return first, first + count

    # results ----------------------------------------------------------------------------------------------

    def _proved(self, run: Run, points: Floats) -> tuple[Floats, Certificate]:
        """A path with its certificate; edges that cannot be proved are replaced by detours where there are some."""
        unproved = self._unproved(run, points)
        for coarse in COARSE[1:]:
            if not unproved:
                return points, self._wholly_certified
            points = self._with_detours(run, points, unproved, coarse)
            unproved = self._unproved(run, points)
        certificate = self._certificate(points, unproved)
        if certificate or run.should_stop():
            return points, certificate
        whole = self._detour(run, points[0], points[-1], COARSE[-1])
        if whole is None or self._unproved(run, whole):
            return points, certificate
        return whole, self._wholly_certified

    def _unproved(self, run: Run, points: Floats) -> list[int]:
        """The edges of a path that machine code does not prove free; beyond the range of float32, float64."""
        low, high = self._range
        if self._box.is_bounded or bool(((low <= points) & (points <= high)).all()):
            return run.workspace.unproved(points)
        return list(certify(self._scene, points, self._margin).unproved)

    def _with_detours(self, run: Run, points: Floats, unproved: Sequence[int], coarse: float) -> Floats:
        """The path with other motions for edges that are not proved, where there are some."""
        pieces = []
        for k, a in enumerate(points):
            pieces.append(a[None])
            if k in unproved and k + 1 < len(points):
                detour = self._detour(run, a, points[k + 1], coarse)
                if detour is not None:
                    pieces.append(detour[1:-1])
        return np.concatenate(pieces)

    def _detour(self, run: Run, a: Floats, b: Floats, coarse: float) -> Floats | None:
        """A path that a search with shorter steps finds in the time that is left; None where it finds none."""
        left = run.options.timeout - (time.perf_counter() - run.start_time)
        options = run.options._replace(
            coarse=coarse,
            timeout=max(left, 0.0),
            improve=0,
            keep_tree=False,
            with_reason=False,
            is_shown=False,
        )
        points, _, failure = self._searched(Run(options, a, b[None]))
        return points if failure is None else None

    def _certificate(self, points: Floats, edges: Sequence[int]) -> Certificate:
        """What float64 proves of edges that machine code has not proved."""
        if len(points) == 1:
            return certify(self._scene, points, self._margin)
        unproved, checks = [], 0
        for k in edges:
            edge = certify(self._scene, points[k : k + 2], self._margin)
            checks += edge.checks
            unproved += [] if edge else [k]
        return Certificate(tuple(unproved), self._margin, checks)

    @cached_property
    def allowed_deviation(self) -> Floats | None:
        """What motions may deviate by from a path that keeps the margin; see `Plan.deviation_bounds`."""
        return self._deviation_bounds()

    def _deviation_bounds(self) -> Floats | None:
        """What motions may deviate by without touching anything; see `Plan`."""
        rows = [bounds for bounds in self._scene.moving.bounds_of_motion if len(bounds)]
        return np.concatenate(rows) / (0.98 * self._margin) if self._margin > 0.0 else None

    def _result(
        self, run: Run, ending: Ending, points: Floats, certificate: Certificate | None, goal: int
    ) -> Plan:
        step = self._step if run.workspace is None else run.workspace.step
        return Plan(
            ending.outcome,
            ending.reason,
            points,
            certificate,
            goal,
            run.samples_used,
            run.nodes,
            step,
            run.seconds,
            self._model,
            tuple(run.improvements),
            self.allowed_deviation,
            run.tree,
            ending.touching,
        )


def _straight(run: Run) -> tuple[Floats, int]:
    """The straight motion to the goal to which one leads, or the start alone where it is a goal; the goal's number."""
    start = run.q0.tolist()
    if start in (goals := run.goals.tolist()):
        return np.array([start]), goals.index(start)
    points = np.empty((2, len(start)))
    points[0], points[1] = run.q0, run.goals[run.direct_goal]
    return points, run.direct_goal
