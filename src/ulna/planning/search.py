"""The search of a planner: trees that grow, a path that is shortened, and its proof."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ulna.planning.certificate import Certificate, certify
from ulna.planning.result import Outcome, Plan
from ulna.planning.samples import samples
from ulna.planning.tables import Scene
from ulna.planning.touches import deepest_touch
from ulna.planning.workspace import SLICE, Workspace, thread_storage
from ulna.typing import Floats


@dataclass(frozen=True)
class Options:
    """What one call asks for.

    Attributes:
        shorten: How often at most the path is shortened.
        iterations: The most samples.
        timeout: The longest time [s].
        seed: Seed of the samples.
        is_strict: Whether the search itself takes steps so short that nothing can touch in between.
        still: Which numbers of a configuration stay where the start has them, shape (nq,); None for none.
    """

    shorten: int
    iterations: int
    timeout: float
    seed: int
    is_strict: bool = False
    still: Any = None


class _Run:
    """What is known of one call while it runs."""

    def __init__(self, options: Options, q0: Floats, goals: Floats) -> None:
        self.options, self.q0, self.goals = options, q0, goals
        self.start_time = self.last_time = time.perf_counter()
        self.numbers: list[int] = []
        self.workspace: Any = None
        self.direct, self.roots, self.used, self.nodes = -1, 0, 0, 0
        self.seconds = dict.fromkeys(("prepare", "search", "shorten", "certify"), 0.0)

    def is_late(self) -> bool:
        """Whether the time is up."""
        return time.perf_counter() - self.start_time > self.options.timeout

    def note(self, part: str) -> None:
        """Adds the time since the last note to a part's."""
        now = time.perf_counter()
        self.seconds[part] += now - self.last_time
        self.last_time = now


class Search:
    """Searches for paths of one robot in one world.

    Args:
        scene: The robot and the world.
        margin: How near everything may come at least [m].
        step: How far any point moves at most between the states by which paths are proved free [m].
        longest: The longest edge of the trees [rad, m].
    """

    def __init__(self, scene: Scene, margin: float, step: float, longest: float) -> None:
        self._scene, self._margin, self._step, self._longest = scene, margin, step, longest
        self._model = scene.robot.model
        self._storage = threading.local()
        self._limits = self._model.lower_position - 1e-9, self._model.upper_position + 1e-9
        self._is_bounded = bool(np.isfinite(self._limits).all())
        self._blocks: dict[tuple[int, int, int], Any] = {}

    def run(self, q0: Floats, goals: Floats, options: Options) -> Plan:
        """A path from a configuration to one of several.

        Args:
            q0: Where the robot is, shape (nq,) [rad, m].
            goals: Where it may go, shape (n, nq) [rad, m].
            options: What is asked for.

        Returns:
            The plan, or why there is none.
        """
        self._workspace(2, False)  # compiles before the clock starts
        run = _Run(options, q0, goals)
        stopped = self._prepare(run)
        if stopped is not None:
            return stopped
        if run.direct >= 0:
            same = (run.goals == q0).all(axis=1)
            if same.any():
                return self._solved(run, q0[None], int(same.argmax()))
            return self._solved(run, np.stack([q0, run.goals[run.direct]]), run.direct)
        is_met = self._grow(run)
        run.note("search")
        if not is_met:
            is_used = run.used >= options.iterations
            limit = f"{run.used} samples" if is_used else f"{options.timeout:g} s"
            reason = f"no path was found within {limit}. Allow more, or another seed."
            return self._failed(run, "iterations" if is_used else "time", reason)
        points, goal = run.workspace.shortened(options.shorten)
        points[0], points[-1] = q0, run.goals[goal]
        if options.still is not None:
            points[:, options.still] = q0[options.still]
        run.note("shorten")
        return self._solved(run, points, goal)

    # before the search ------------------------------------------------------------------------------------

    def _prepare(self, run: _Run) -> Plan | None:
        """Storage, and the goals that are free; a plan that says so where the search cannot begin."""
        outside = self._out_of_limits(run.q0)
        if outside:
            return self._failed(run, "start", f"`q0` is out of limits: {outside}.")
        if not len(run.goals):
            return self._failed(
                run, "unreachable", "no configuration within the limits was found for the pose."
            )
        low, high = self._limits
        inside = ((run.goals >= low) & (run.goals <= high)).all(axis=1).nonzero()[0]
        if not len(inside):
            return self._failed(
                run, "goal", f"the goal is out of limits: {self._out_of_limits(run.goals[0])}."
            )
        if len(inside) < len(run.goals):
            run.goals = run.goals[inside]
        for part in (1, 2) if run.options.is_strict else (2,):
            run.workspace = self._workspace(part, run.options.is_strict)
            free, run.direct = run.workspace.examine(run.q0, run.goals)
            if free[0] and free[1:].any():
                break
        else:
            return self._blocked(run, free)
        run.numbers, run.roots = inside.tolist(), len(free)
        if not free.all():
            run.direct = int(free[1 : 1 + run.direct].sum()) if run.direct >= 0 else -1
            run.numbers, run.goals = inside[free[1:]].tolist(), run.goals[free[1:]]
        run.note("prepare")
        return None

    def _workspace(self, part: int, is_strict: bool) -> Workspace:
        """This thread's storage."""
        storage, key = self._storage.__dict__, (part, is_strict)
        if key not in storage:
            arrays = thread_storage(self._model.nq)
            storage[key] = Workspace(
                self._scene, arrays, self._margin, self._step, self._longest, part, is_strict
            )
        return storage[key]

    def _blocked(self, run: _Run, free: Any) -> Plan:
        """The plan that says what the start, or the nearest goal, touches."""
        outcome: Outcome = "goal" if free[0] else "start"
        q = run.goals[0] if free[0] else run.q0
        distance, link, other = deepest_touch(self._scene.checker, q)
        what = f"overlaps {other!r} by {-1e3 * distance:.3g} mm"
        if distance > 0.0:
            what = f"comes within {1e3 * distance:.3g} mm of {other!r}"
        who = "the start" if outcome == "start" else "the goal" if len(run.goals) == 1 else "the first goal"
        return self._failed(run, outcome, f"at {who} {link!r} {what}, by their covering spheres.")

    def _out_of_limits(self, q: Floats) -> str:
        """Joints that are out of limits, by how much; empty where none is."""
        low, high = self._limits
        if ((low <= q) & (q <= high)).all():
            return ""
        texts = []
        for joint in self._model.joints:
            k = joint.idx_q
            if joint.nq and not low[k] <= q[k] <= high[k]:
                limits = f"[{low[k] + 1e-9:.4g}, {high[k] - 1e-9:.4g}]"
                texts.append(f"joint {joint.name!r} is at {q[k]:.4g}, its limits are {limits}")
        return "; ".join(texts)

    # search -----------------------------------------------------------------------------------------------

    def _grow(self, run: _Run) -> bool:
        """Grows both trees until they meet; whether they did."""
        workspace, roots = run.workspace, run.roots
        low, high = self._sampled_box(run)
        first = count = result = 0
        while run.used < run.options.iterations and not run.is_late():
            if first >= count:
                first, count = 0, min(SLICE, run.options.iterations - run.used)
                workspace.storage.samples[:count] = self._samples(run, count, low, high)
            result = workspace.grow(first, count, roots)
            roots = 0
            run.used += abs(result) - first
            if result < 0:
                break
            first = result
        run.nodes = int(workspace.storage.trees.counts.sum())
        return result < 0

    def _samples(self, run: _Run, count: int, low: Floats, high: Floats) -> Any:
        """The next samples, shape (count, nq); the first ones are kept."""
        key = run.used, count, run.options.seed
        if not self._is_bounded or run.options.still is not None or run.used >= 16 * SLICE:
            return samples(*key, low, high)
        if key not in self._blocks:
            if len(self._blocks) >= 64:
                self._blocks.clear()
            self._blocks[key] = samples(*key, low, high)
        return self._blocks[key]

    def _sampled_box(self, run: _Run) -> tuple[Floats, Floats]:
        """The limits; joints without limits turn up to a turn beyond start and goals."""
        low, high = self._model.lower_position, self._model.upper_position
        if not self._is_bounded:
            ends = np.vstack([run.q0, run.goals])
            low = np.where(np.isfinite(low), low, ends.min(axis=0) - np.pi)
            high = np.where(np.isfinite(high), high, ends.max(axis=0) + np.pi)
        if run.options.still is not None:
            low, high = (np.where(run.options.still, run.q0, limit) for limit in (low, high))
        return low, high

    # results ----------------------------------------------------------------------------------------------

    def _solved(self, run: _Run, points: Floats, goal: int) -> Plan:
        points, certificate = self._proved(run, points)
        run.note("certify")
        reason = "" if certificate else f"edges {certificate.unproved} are not proved free"
        return self._result(run, "solved", reason, points, certificate, run.numbers[goal])

    def _proved(self, run: _Run, points: Floats) -> tuple[Floats, Certificate]:
        """A path with its certificate; edges that cannot be proved are replaced by detours where there are some."""
        certificate = self._certificate(run, points)
        if certificate or run.options.is_strict:
            return points, certificate
        pieces = []
        for k, (a, b) in enumerate(pairwise(points)):
            pieces.append(a[None])
            if k in certificate.unproved:
                rest = run.options.timeout - (time.perf_counter() - run.start_time)
                options = replace(run.options, is_strict=True, timeout=max(rest, 0.0))
                detour = self.run(a, b[None], options)
                pieces.append(detour.points[1:-1])
        repaired = np.concatenate([*pieces, points[-1:]])
        if len(repaired) > len(points):
            better = self._certificate(run, repaired)
            if len(better.unproved) < len(certificate.unproved):
                points, certificate = repaired, better
        if certificate:
            return points, certificate
        rest = run.options.timeout - (time.perf_counter() - run.start_time)
        whole = self.run(points[0], points[-1:], replace(run.options, is_strict=True, timeout=max(rest, 0.0)))
        return (whole.points, whole.certificate) if whole.is_certified else (points, certificate)

    def _certificate(self, run: _Run, points: Floats) -> Certificate:
        unproved = run.workspace.unproved(points)
        if not unproved:
            return Certificate((), self._margin, 0)
        certificate = Certificate((), self._margin, 0)
        for k in unproved:
            edge = certify(self._scene, points[k : k + 2], self._margin)
            failed = () if edge else (k,)
            checks = certificate.checks + edge.checks
            certificate = Certificate((*certificate.unproved, *failed), self._margin, checks)
        return certificate

    def _failed(self, run: _Run, outcome: Outcome, reason: str) -> Plan:
        return self._result(run, outcome, reason, np.zeros((0, self._model.nq)), None, -1)

    def _result(
        self, run: _Run, outcome: Outcome, reason: str, points: Floats, certificate: Certificate | None, goal: int
    ) -> Plan:  # fmt: skip
        step = self._step if run.workspace is None else run.workspace.step
        return Plan(
            outcome, reason, points, certificate, goal, run.used, run.nodes, step, run.seconds, self._model
        )
