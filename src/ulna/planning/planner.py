"""Plans motions that touch nothing: from a configuration to a goal, among obstacles."""

from __future__ import annotations

import time
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.collision import LinkPair, SphereChecker, Spheres, World
from ulna.errors import InputError, ShapeError
from ulna.planning import edges, rrt_connect, shortcuts
from ulna.planning.certificate import Certificate, certify
from ulna.planning.goals import goal_configurations
from ulna.planning.result import Outcome, Plan
from ulna.planning.samples import halton
from ulna.planning.tables import Scene, scene
from ulna.planning.touches import deepest_touch
from ulna.typing import ArrayLike, Floats

_SLICE = 256  # samples between two looks at the clock; Ctrl-C is raised there, too
_PLACES = 2048  # of a tree, at first
_NARROWER = (
    1.0,
    0.25,
    0.0625,
)  # parts of `step` that are tried where the start or all goals are too near for it


def plan(
    robot: Any,
    q0: ArrayLike,
    goal: Any,
    world: World | None = None,
    *,
    frame: str | None = None,
    spheres: Spheres | None = None,
    pairs: Iterable[LinkPair] | None = None,
    margin: float = 0.0,
    step: float = 0.01,
    longest: float = 1.5,
    shorten: int = 200,
    iterations: int = 100_000,
    timeout: float = 10.0,
    seed: int = 0,
) -> Plan:
    """A path from a configuration to a goal on which the robot touches neither itself nor the world.

    Both trees of RRT-Connect grow in machine code; the path is shortened by shortcuts, and it is proved in float64 that
    nothing touches between its points either. What counts are the covering spheres of `ulna.collision.fit`.

    Args:
        robot: The robot; its joints are revolute, continuous or prismatic.
        q0: Where it is, shape (nq,) [rad, m].
        goal: A configuration (nq,), several of which one is to be reached (n, nq), a pose of a frame (SE3 or (4, 4)),
            or several (n, 4, 4) [rad, m].
        world: Obstacles; None for none. Moving ones stand where the world has them.
        frame: Whose pose the goal is; None for the robot's tip.
        spheres: Spheres of the links; None for those that are fitted.
        pairs: Pairs of links to check against each other; None for `link_pairs(model)`.
        margin: How near everything may come at least [m].
        step: How far any point moves at most between states that the search checks, with spheres larger by half of it
            [m]. Where the start or every goal is too near to something for that, a fourth and a sixteenth are tried.
        longest: The longest edge of the trees, in joint space [rad, m].
        shorten: How many shortcuts are tried.
        iterations: The most samples.
        timeout: The longest time [s].
        seed: Seed of samples and shortcuts: the same seed, the same path, on processors of one kind.

    Returns:
        The plan. It is false, with an outcome and a reason, where there is no path.

    Raises:
        ShapeError: If `q0` or `goal` has a wrong shape.
        InputError: If numbers make no sense, or the robot has joints that cannot be planned for.
        ModelError: If the robot has no collision geometry.
    """
    start_time = time.perf_counter()
    _check_numbers(margin, step, longest, shorten, iterations, timeout)
    if not hasattr(robot, "collision_checker"):
        raise InputError(
            f"`robot` is a {type(robot).__name__}; expected a Robot, as ulna.load(...) or Robot(model) makes."
        )
    q0 = finite_array("q0", q0)
    if q0.shape != (robot.model.nq,):
        raise ShapeError("q0", q0.shape, f"({robot.model.nq},)")
    options = {"spheres": spheres, "pairs": pairs if pairs is None else tuple(map(tuple, pairs))}
    chosen = {name: value for name, value in options.items() if value is not None}
    place = _scene(robot.collision_checker(world, method="spheres", **chosen))
    goals = goal_configurations(robot, goal, frame, q0, seed)
    search = _Search(place, q0, goals, margin, step, longest, shorten, iterations, timeout, seed, start_time)
    return search.run()


def _check_numbers(
    margin: float, step: float, longest: float, shorten: int, iterations: int, timeout: float
) -> None:
    for name, value, least in (
        ("margin", margin, 0.0), ("step", step, 1e-3), ("longest", longest, 1e-3), ("shorten", shorten, 0),
        ("iterations", iterations, 1), ("timeout", timeout, 0.0),
    ):  # fmt: skip
        if not (np.isfinite(value) and value >= least) and not (name == "timeout" and value == np.inf):
            raise InputError(f"`{name}` is {value!r}; expected a number of at least {least:g}.")


@lru_cache(maxsize=8)
def _scene(checker: SphereChecker) -> Scene:
    return scene(checker)


class _Search:
    """One call of `plan`."""

    def __init__(
        self, place: Scene, q0: Floats, goals: Floats, margin: float, step: float, longest: float, shorten: int,
        iterations: int, timeout: float, seed: int, start_time: float,
    ) -> None:  # fmt: skip
        self.place, self.q0, self.goals, self.margin, self.step = place, q0, goals, margin, step
        self.longest, self.shorten, self.iterations, self.timeout = longest, shorten, iterations, timeout
        self.seed, self.start_time, self.last_time = seed, start_time, start_time
        self.model = place.checker.model
        self.seconds: dict[str, float] = {}
        self.used = self.count = 0
        lanes, nq = place.lanes, self.model.nq
        self.reach = place.reach.astype(np.float32)
        self.q = np.zeros((nq, lanes), np.float32)
        self.c = np.zeros((place.kernel.sizes[1] // lanes, lanes), np.float32)

    def run(self) -> Plan:
        """The whole search."""
        stopped = self._prepare()
        if stopped is not None:
            return stopped
        if len(self.goals) and (np.abs(self.goals - self.q0).max(axis=1) == 0.0).any():
            number = int(np.argmin(np.abs(self.goals - self.q0).max(axis=1)))
            return self._solved(self.q0[None], self.numbers[number])
        points, number = self._grow()
        self._lap("search")
        if points is None:
            limit = f"{self.used} samples" if self.used >= self.iterations else f"{self.timeout:g} s"
            outcome = "iterations" if self.used >= self.iterations else "time"
            return self._failed(outcome, f"no path was found within {limit}. Allow more, or another seed.")
        points = self._shortened(points)
        self._lap("shorten")
        return self._solved(points, self.numbers[number])

    def _prepare(self) -> Plan | None:
        """The tables, and the goals that are free; a plan that says so where the search cannot begin."""
        outside = self._out_of_limits(self.q0)
        if outside:
            return self._failed("start", f"`q0` is out of limits: {outside}.")
        if not len(self.goals):
            return self._failed("unreachable", "no configuration within the limits was found for the pose.")
        inside = [k for k, q in enumerate(self.goals) if not self._out_of_limits(q)]
        if not inside:
            return self._failed("goal", f"the goal is out of limits: {self._out_of_limits(self.goals[0])}.")
        self.numbers, self.goals = inside, self.goals[inside]
        every = np.vstack([self.q0, self.goals])
        for part in _NARROWER:
            self.tables = self.place.tables(self.margin + part * self.step / 2.0)
            free = ~self._touching(every)
            if free[0] and free[1:].any():
                break
        else:
            return self._blocked(free)
        self.step *= part
        self.numbers = [k for k, is_free in zip(self.numbers, free[1:], strict=True) if is_free]
        self.goals = self.goals[free[1:]]
        self._lap("prepare")
        return None

    def _blocked(self, free: Any) -> Plan:
        """The plan that says what the start, or the nearest goal, touches."""
        outcome: Outcome = "goal" if free[0] else "start"
        q = self.goals[0] if free[0] else self.q0
        distance, link, other = deepest_touch(self.place.checker, q)
        what = f"overlaps {other!r} by {-1e3 * distance:.3g} mm"
        if distance > 0.0:
            what = f"comes within {1e3 * distance:.3g} mm of {other!r}"
        who = "the start" if outcome == "start" else "the goal" if len(self.goals) == 1 else "the first goal"
        return self._failed(outcome, f"at {who} {link!r} {what}, by their covering spheres.")

    def _out_of_limits(self, q: Floats) -> str:
        """Joints that are out of limits, by how much; empty where none is."""
        low, high = self.model.lower_position, self.model.upper_position
        texts = []
        for joint in self.model.joints:
            if joint.nq and not low[joint.idx_q] - 1e-9 <= q[joint.idx_q] <= high[joint.idx_q] + 1e-9:
                limits = f"[{low[joint.idx_q]:.4g}, {high[joint.idx_q]:.4g}]"
                texts.append(f"joint {joint.name!r} is at {q[joint.idx_q]:.4g}, its limits are {limits}")
        return "; ".join(texts)

    def _touching(self, points: Floats) -> Any:
        """Which configurations touch anything, (n,)."""
        touching = np.zeros(len(points), np.float32)
        call = _specialized(edges.which_touch, self.place.lanes)
        call(self.place.kernel, self.tables, points.astype(np.float32), touching, self.q, self.c)
        return touching > 0.0

    # search -----------------------------------------------------------------------------------------------

    def _grow(self) -> tuple[Floats | None, int]:
        """Both trees until they meet; the path, and the goal it leads to."""
        nq, places = self.model.nq, _PLACES + len(self.goals)
        nodes = np.full((2, nq, places), rrt_connect.FREE_PLACE, np.float32)
        parents = np.full((2, places), -1, np.int64)
        nodes[0, :, 0], nodes[1, :, : len(self.goals)] = self.q0, self.goals.T
        counts, meeting = np.array([1, len(self.goals)]), np.zeros(2, np.int64)
        low, high = self._sampled_box()
        used = 0
        while self.used < self.iterations and not self._is_late():
            if used == 0:
                count = min(_SLICE, self.iterations - self.used)
                samples = (low + halton(self.used, count, nq, self.seed) * (high - low)).astype(np.float32)
            result = _specialized(rrt_connect.grow, self.place.lanes)(
                self.place.kernel, self.tables, self.reach, self.step, self.longest, samples[used:].copy(), nodes,
                parents, counts, meeting, *np.zeros((3, nq), np.float32), self.q, self.c,
            )  # fmt: skip
            self.count = int(counts.sum())
            self.used += abs(result)
            if result < 0:
                return self._path(nodes, parents, meeting)
            used += result
            if used >= len(samples):
                used = 0
            else:  # no places are left
                nodes = np.concatenate([nodes, np.full_like(nodes, rrt_connect.FREE_PLACE)], axis=2)
                parents = np.concatenate([parents, np.full_like(parents, -1)], axis=1)
        return None, -1

    def _sampled_box(self) -> tuple[Floats, Floats]:
        """The limits; joints without limits turn up to a turn beyond start and goals."""
        ends = np.vstack([self.q0, self.goals])
        low, high = self.model.lower_position, self.model.upper_position
        low = np.where(np.isfinite(low), low, ends.min(axis=0) - np.pi)
        high = np.where(np.isfinite(high), high, ends.max(axis=0) + np.pi)
        return low, high

    def _path(self, nodes: Any, parents: Any, meeting: Any) -> tuple[Floats, int]:
        """The nodes from the start to the goal that was reached, and which goal it is."""
        halves = []
        for tree in (0, 1):
            k, numbers = int(meeting[tree]), []
            while k >= 0:
                numbers.append(k)
                k = int(parents[tree, k])
            halves.append(numbers)
        goal = halves[1][-1]
        points = [nodes[0, :, k] for k in reversed(halves[0])] + [nodes[1, :, k] for k in halves[1]]
        path = np.array(points, float)
        path = path[np.concatenate([[True], np.abs(np.diff(path, axis=0)).max(axis=1) > 0.0])]
        path[0], path[-1] = self.q0, self.goals[goal]
        return path, goal

    def _shortened(self, points: Floats) -> Floats:
        """The path with shortcuts; one point more than it has is room enough, since each adds one at most."""
        if len(points) < 3 or not self.shorten:
            return points
        room = np.zeros((len(points) + self.shorten + 1, points.shape[1]), np.float32)
        room[: len(points)] = points
        draws = np.random.default_rng([self.seed, 3]).random((self.shorten, 2)).astype(np.float32)
        work = np.zeros((2, points.shape[1]), np.float32)
        count = _specialized(shortcuts.shorten, self.place.lanes)(
            self.place.kernel,
            self.tables,
            self.reach,
            self.step,
            room,
            len(points),
            draws,
            *work,
            self.q,
            self.c,
        )
        path = room[:count].astype(float)
        path[0], path[-1] = points[0], points[-1]
        return path

    # results ----------------------------------------------------------------------------------------------

    def _solved(self, points: Floats, goal: int) -> Plan:
        certificate = Certificate((), self.margin, 0)
        if self._unproved(points):
            certificate = certify(self.place, points, self.margin)
        self._lap("certify")
        reason = "" if certificate else f"edges {certificate.unproved} are not proved free"
        return self._result("solved", reason, points, certificate, goal)

    def _unproved(self, points: Floats) -> bool:
        """Whether an edge is not free by the steps of the search: its ends were float32 there, and are float64 here."""
        path = np.ascontiguousarray(points, np.float32)
        call = _specialized(edges.first_edge_that_touches, self.place.lanes)
        return call(self.place.kernel, self.tables, self.reach, self.step, path, self.q, self.c) >= 0

    def _failed(self, outcome: Outcome, reason: str) -> Plan:
        return self._result(outcome, reason, np.zeros((0, self.model.nq)), None, -1)

    def _result(
        self, outcome: Outcome, reason: str, points: Floats, certificate: Certificate | None, goal: int
    ) -> Plan:
        return Plan(
            outcome,
            reason,
            points,
            certificate,
            goal,
            self.used,
            self.count,
            self.step,
            self.seconds,
            self.model,
        )

    def _is_late(self) -> bool:
        return time.perf_counter() - self.start_time > self.timeout

    def _lap(self, name: str) -> None:
        now = time.perf_counter()
        self.seconds[name], self.last_time = now - self.last_time, now


@lru_cache(maxsize=64)
def _specialized(procedure: Any, lanes: int) -> Any:
    return procedure.specialized(W=lanes)
