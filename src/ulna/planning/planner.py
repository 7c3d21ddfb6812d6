"""Plans motions that touch nothing: from a configuration to a goal, among obstacles."""

from __future__ import annotations

import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache, partial
from math import isfinite
from operator import is_
from typing import TYPE_CHECKING, Any, Literal, final, get_args

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.attributes import FixedAttributes
from ulna.checks.labels import in_order
from ulna.checks.values import flag, number, short_repr
from ulna.collision import LinkPair, Spheres, World
from ulna.collision.lanes.moving import links_of
from ulna.collision.pairs import checked_pairs
from ulna.errors import InputError, MissingExtra, ShapeError, UnknownName
from ulna.lazy import is_deferred
from ulna.planning import deferred
from ulna.planning.goals import goal_configurations, moving_columns
from ulna.planning.result import Plan
from ulna.planning.run import Options
from ulna.planning.scenes import PlanningScene
from ulna.planning.search import Search
from ulna.planning.stop import STOP
from ulna.system import process_end
from ulna.system.cached import cached_property
from ulna.system.progress import progress
from ulna.typing import ArrayLike, Floats

if TYPE_CHECKING:  # what only some plans need is imported where it is used
    from ulna.planning.constrained import ConstrainedSearch
    from ulna.planning.exact_search import ExactSearch
    from ulna.planning.path_constraints import PathConstraint

Method = Literal["auto", "spheres", "exact"]
"""What a search checks: covering spheres, the real shapes through coal, or these where spheres refuse start or goal."""

_STEP = 0.01  # [m]
_FLOAT64 = np.dtype(np.float64)
_WAIT = 0.1  # s; Ctrl-C that comes just as a wait without an end begins would be missed


def plan(
    robot: Any,
    q0: ArrayLike,
    goal: Any,
    world: World | None = None,
    *,
    frame: str | None = None,
    joints: Sequence[str] | None = None,
    spheres: Spheres | None = None,
    pairs: Iterable[LinkPair] | None = None,
    margin: float = 0.0,
    step: float = _STEP,
    longest: float = 1.0,
    shorten: int = 5,
    improve: int = 0,
    iterations: int = 100_000,
    timeout: float = 10.0,
    seed: int = 0,
    constraints: PathConstraint | Sequence[PathConstraint] | None = None,
    keep_tree: bool = False,
    method: Method = "auto",
) -> Plan:
    """A path from a configuration to a goal on which the robot touches neither itself nor the world.

    Both trees of RRT-Connect grow in machine code; the path is shortened, its corners are cut, and it is proved that
    nothing touches between its points either. What counts are the covering spheres of `ulna.collision.fit`.

    Args:
        robot: The robot; positions of its joints are plain numbers, those of composites too: no planar, spherical or
            free-flying joints.
        q0: Where it is, shape (nq,) [rad, m]; of a Dask array (..., nq) the result is a lazy array of plans.
        goal: A configuration (nq,), several of which one is to be reached (n, nq); a pose of a frame (SE3 or (4, 4)),
            several (n, 4, 4), a `Region`, or a list of poses and regions; a dictionary from frames to poses and
            regions that are to be met at once [rad, m].
        world: Obstacles; None for none. Moving ones stand where the world has them.
        frame: Whose pose the goal is; None for the robot's tip.
        joints: Names of the joints that may move; the others stay where `q0` has them. None for all.
        spheres: Spheres of the links; None for those that are fitted.
        pairs: Pairs of links to check against each other; None for `link_pairs(model)`.
        margin: How near everything may come at least; by spheres two links that move stay twice as far apart [m].
        step: How far any point moves at most between the states by which the path is proved free, with spheres larger
            by half of it [m]. Where the start or every goal is too near to something for that, a fourth and a sixteenth
            are tried. The search itself takes longer steps.
        longest: The longest edge of the trees, in joint space [rad, m].
        shorten: How often at most the path is shortened and its corners are cut.
        improve: How many samples are spent on shorter paths once there is one; without constraints the path
            approaches the shortest with their number. `timeout` ends this, too.
        iterations: The most samples for the first path.
        timeout: The longest time [s].
        seed: Seed of the samples: the same seed, the same path, on processors of one kind.
        constraints: What frames keep on the whole way, start and goal included: `PathConstraint`, or several.
        keep_tree: Whether `plan.tree` has the configurations that the search reached, for `viewer.plan`.
        method: "spheres"; "exact", which asks coal for the real shapes: far slower, for robots and places where
            things pass closer than spheres allow, and takes no `spheres`, `step`, `improve` and `constraints`; "auto"
            plans by spheres, and by the real shapes where spheres refuse the start or every goal, none of these
            arguments is used and coal is installed.

    Returns:
        The plan. It is false, with an outcome and a reason, where there is no path.

    Raises:
        ShapeError: If `q0` or `goal` has a wrong shape.
        InputError: If numbers make no sense, the robot has joints that cannot be planned for, or the method does not
            take an argument.
        UnknownName: If there is no such method.
        ModelError: If the robot has no collision geometry.

    Example:
        >>> from ulna.collision import World
        >>> from ulna.geometry import Box
        >>> robot = ulna.load("panda")
        >>> world = World().add("post", Box((0.1, 0.1, 1.0)), (0.5, 0.0, 0.3))
        >>> q = robot.configurations["ready"]
        >>> path = robot.plan(q + [-0.6, 0, 0, 0, 0, 0, 0], q + [0.6, 0, 0, 0, 0, 0, 0], world)
        >>> path.success, path.is_certified
        (True, True)
    """
    asked = robot, world, spheres, pairs, margin, step, longest, method
    return _planner_for(*asked).plan(
        q0,
        goal,
        frame=frame,
        joints=joints,
        shorten=shorten,
        improve=improve,
        iterations=iterations,
        timeout=timeout,
        seed=seed,
        constraints=constraints,
        keep_tree=keep_tree,
    )


@final
class Planner(FixedAttributes):
    """Plans for one robot in one world, and keeps what calls have in common: for many plans.

    Args:
        robot: The robot; positions of its joints are plain numbers, those of composites too: no planar, spherical or
            free-flying joints.
        world: Obstacles; None for none.
        spheres: Spheres of the links; None for those that are fitted.
        pairs: Pairs of links to check against each other; None for `link_pairs(model)`.
        margin: How near everything may come at least; by spheres two links that move stay twice as far apart [m].
        step: How far any point moves at most between the states by which paths are proved free [m].
        longest: The longest edge of the trees, in joint space [rad, m].
        roadmap: How many samples a roadmap is made of, along which plans are searched first: for many plans in a world
            of narrow passages; 0 for none.
        method: "auto", "spheres" or "exact", as for `ulna.planning.plan`; with a roadmap "auto" means "spheres".

    Raises:
        InputError: If numbers make no sense, or the robot has joints that cannot be planned for.
        ModelError: If the robot has no collision geometry.
        MissingExtra: If a roadmap is asked for and scipy is not installed.

    Example:
        >>> from ulna.planning import Planner
        >>> robot = ulna.load("panda")
        >>> planner = Planner(robot)  # prepared once, for many plans
        >>> q = robot.configurations["ready"]
        >>> [bool(planner.plan(q, q + [turn, 0, 0, 0, 0, 0, 0])) for turn in (0.5, 1.0)]
        [True, True]
    """

    robot: Any
    model: Any
    scene: PlanningScene

    def __init__(
        self,
        robot: Any,
        world: World | None = None,
        *,
        spheres: Spheres | None = None,
        pairs: Iterable[LinkPair] | None = None,
        margin: float = 0.0,
        step: float = _STEP,
        longest: float = 1.0,
        roadmap: int = 0,
        method: Method = "auto",
    ) -> None:
        _check_scene(robot, world)
        margin, step, longest = _checked_lengths(margin, step, longest)
        _check_method(method)
        pairs = pairs if pairs is None else checked_pairs(robot.model, pairs)
        self.robot, self.model = robot, robot.model
        numbers = {"margin": margin, "step": step, "longest": longest, "roadmap": roadmap}
        self._arguments = (robot, world), {"spheres": spheres, "pairs": pairs, "method": method, **numbers}
        self._is_exact, self._batches = method == "exact", 0
        self._shape = (self.model.nq,)
        self._last_options: tuple[tuple[Any, ...], Any] = (object(),), None
        self._may_be_exact = method != "spheres" and spheres is None and step == _STEP and not roadmap
        if self._is_exact:
            _check_exact(spheres=spheres is None, step=step == _STEP, roadmap=not roadmap)
            self._search = self._exact_search
            return
        checker = _self_checker(robot, spheres, pairs)
        robot_alone = links_of(checker.model, checker.spheres, checker.pairs, checker.missing, checker.tables)
        world = World() if world is None else world
        self.scene = PlanningScene(robot_alone, checker.spheres, checker.pairs, world, checker.missing)
        size, self._lengths = _count("roadmap", roadmap, 0), (margin, step)
        lengths = (self.scene, margin, step, longest)
        self._search = _roadmap_search(*lengths, size) if size else Search(*lengths)
        self._constrained: dict[tuple[PathConstraint, ...], ConstrainedSearch] = {}

    def __reduce__(self) -> tuple[Any, ...]:
        arguments, options = self._arguments
        return partial(Planner, **options), arguments

    def plan(
        self,
        q0: ArrayLike,
        goal: Any,
        *,
        frame: str | None = None,
        joints: Sequence[str] | None = None,
        shorten: int = 5,
        improve: int = 0,
        iterations: int = 100_000,
        timeout: float = 10.0,
        seed: int = 0,
        constraints: PathConstraint | Sequence[PathConstraint] | None = None,
        keep_tree: bool = False,
    ) -> Plan:
        """A path from a configuration to a goal; see `ulna.planning.plan`.

        Args:
            q0: Where the robot is, shape (nq,) [rad, m].
            goal: As for `ulna.planning.plan` [rad, m].
            frame: Whose pose the goal is; None for the robot's tip.
            joints: Names of the joints that may move; None for all.
            shorten: How often at most the path is shortened and its corners are cut.
            improve: How many samples are spent on shorter paths once there is one.
            iterations: The most samples for the first path.
            timeout: The longest time [s].
            seed: Seed of the samples.
            constraints: What frames keep on the whole way.
            keep_tree: Whether `plan.tree` has the configurations that the search reached.

        Returns:
            The plan. It is false, with an outcome and a reason, where there is no path.

        Raises:
            ShapeError: If `q0` or `goal` has a wrong shape.
            InputError: If numbers make no sense.
        """
        options = self._options(shorten, iterations, timeout, seed, improve, keep_tree)
        if frame is joints is constraints is None and self._are_configurations(q0, goal):
            ends = np.empty((2, self.model.nq))
            ends[0], ends[1] = q0, goal
            return self._finished(self._search.run(ends[0], ends[1:], options), ends[0], ends[1:], options)
        if is_deferred(q0) or is_deferred(goal):
            chosen = {
                **{"frame": frame, "joints": joints, "constraints": constraints, "keep_tree": keep_tree},
                **{"shorten": shorten, "improve": improve, "iterations": iterations},
                **{"timeout": timeout, "seed": seed},
            }
            return deferred.plans(self, q0, goal, chosen)
        return self._plan_to_goal(q0, goal, frame, joints, constraints, options)

    def _options(
        self, shorten: int, iterations: int, timeout: float, seed: int, improve: int, keep_tree: bool
    ) -> Options:
        """The options of a plan, checked."""
        asked = shorten, iterations, timeout, seed, improve, keep_tree, not self._batches
        known, options = self._last_options
        if not all(map(is_, asked, known)):  # most calls ask for the same as the call before
            options = _checked_options(*asked)
            self._last_options = asked, options
        if self._is_exact:
            _check_exact(improve=not options.improve)
        return options

    def _plan_to_goal(
        self,
        q0: Any,
        goal: Any,
        frame: str | None,
        joints: Sequence[str] | None,
        constraints: Any,
        options: Options,
    ) -> Plan:
        """The plan for any goal, not only configurations."""
        # A copy: the caller's may change meanwhile.
        q0 = finite_array("q0", in_order("q0", q0, self.model.position_names))
        if q0.shape != (self.model.nq,):
            raise ShapeError("q0", q0.shape, f"({self.model.nq},)")
        goals = goal_configurations(self.robot, goal, frame, q0, options.seed, joints, options.timeout)
        allowed = options.timeout
        options = options._replace(timeout=max(allowed - goals.seconds, 0.0))
        if joints is not None:
            moving = moving_columns(self.model, joints)
            options = options._replace(fixed_coordinates=None if moving.all() else ~moving)
        search = self._search_along(constraints)
        if options.fixed_coordinates is None or self._is_exact:
            plan = search.run(q0, goals.configurations, options)
        else:
            plan = self._run_with_still_joints(search, constraints, q0, goals.configurations, options)
        if search is self._search:
            plan = self._finished(plan, q0, goals.configurations, options)
        if plan.outcome == "unreachable" and goals.is_late:
            reason = f"no configuration was found for the pose within {allowed:g} s. Allow more."
            return replace(plan, outcome="time", reason=reason)
        if plan.outcome == "unreachable" and goals.reason:
            return replace(plan, reason=f"{plan.reason.rstrip('.')}: {goals.reason}.")
        is_renumbered = plan and goals.numbers[plan.goal] != plan.goal
        return replace(plan, goal=goals.numbers[plan.goal]) if is_renumbered else plan

    def _are_configurations(self, q0: Any, goal: Any) -> bool:
        """Whether start and goal are one configuration each, as arrays of float64, which need no more looks."""
        return (
            type(q0) is type(goal) is np.ndarray
            and q0.shape == goal.shape == self._shape
            and q0.dtype is goal.dtype is _FLOAT64
            and isfinite(sum(q0.tolist()) + sum(goal.tolist()))  # nan and inf never become finite by sums
        )

    def _run_with_still_joints(
        self, search: Any, constraints: Any, q0: Floats, goals: Floats, options: Options
    ) -> Plan:
        """A plan for some joints; where it is refused, pairs that stay as they are count by their real shapes."""
        plan = search.run(q0, goals, options._replace(with_reason=False))
        if plan.outcome not in ("start", "goal"):
            return plan
        others = self._without_still_pairs(q0, options.fixed_coordinates)
        if others is not None:
            search = others._search_along(constraints)
        return search.run(q0, goals, options)

    def _without_still_pairs(self, q0: Floats, still: Any) -> Planner | None:
        """The planner without the pairs of links that stay as they are, if their real shapes are apart; else None."""
        from ulna.planning.still_links import are_apart, divided_pairs, divided_worlds  # for few plans

        (robot, _), options = self._arguments
        chosen = tuple(still.tolist())
        together, others = divided_pairs(self.model, self.scene.link_pairs, chosen)
        carried, world = divided_worlds(self.model, self.scene.world, chosen)
        margin, missing = self._lengths[0], self.scene.missing
        if not (together or carried.attachments):
            return None
        if not are_apart(self.model, together, carried, q0, margin, missing):
            return None
        lengths = margin, options["step"], options["longest"]
        return _planner(robot, world, options["spheres"], others, *lengths, "spheres")

    def _finished(self, plan: Plan, q0: Floats, goals: Floats, options: Options) -> Plan:
        """A plan; where covering spheres refuse the start or every goal, the one among the real shapes if allowed."""
        if plan.touching is None or plan.method == "exact" or not self._may_be_exact or options.improve:
            return plan
        try:
            search = self._exact_search
        except MissingExtra:
            return plan
        left = options.timeout - sum(plan.seconds.values())
        exact = search.run(q0, goals, options._replace(timeout=max(left, 0.0)))
        if exact.outcome in ("iterations", "time"):
            return replace(exact, reason=f"{exact.reason} By covering spheres there is none: {plan.reason}")
        return replace(exact, deviation_bounds=self._deviation_bounds) if exact else exact

    @cached_property
    def _exact_search(self) -> ExactSearch:
        """The search among the real shapes."""
        from ulna.planning.exact_search import ExactSearch  # for few plans

        (_, world), options = self._arguments
        world = World() if world is None else world
        return ExactSearch(self.model, world, options["pairs"], options["margin"], options["longest"])

    @cached_property
    def _deviation_bounds(self) -> Floats | None:
        """As for paths by spheres, where links keep twice the margin from each other, but half as far."""
        assert isinstance(self._search, Search)
        bounds = self._search.allowed_deviation
        return None if bounds is None else 2.0 * bounds

    def _search_along(self, constraints: Any) -> Search | ExactSearch:
        """The search that keeps constraints."""
        if constraints is None or (isinstance(constraints, Sequence) and not len(constraints)):
            return self._search
        from ulna.planning.constrained import ConstrainedSearch
        from ulna.planning.path_constraints import Constraints, PathConstraint

        items = (constraints,) if isinstance(constraints, PathConstraint) else constraints
        if self._is_exact:
            _check_exact(constraints=False)
        if isinstance(items, str) or not isinstance(items, Iterable):
            raise InputError(
                f"`constraints` is {items!r}; expected PathConstraint(frame, Region(...)) or several."
            )
        items = tuple(items)
        for item in items:
            if not isinstance(item, PathConstraint):
                raise InputError(
                    f"`constraints` holds {item!r}; expected PathConstraint(frame, Region(...)) or several."
                )
        search = self._constrained.get(items)
        if search is None:  # other threads may add and remove searches meanwhile
            search = ConstrainedSearch(self.scene, *self._lengths, Constraints(self.model, items))
            if len(self._constrained) >= 8:
                self._constrained.clear()
            search = self._constrained.setdefault(items, search)
        return search

    def plan_all(
        self, starts: ArrayLike, goals: Any, *, threads: int | None = None, **options: Any
    ) -> list[Plan]:
        """A path for each of many problems: what `plan` returns for each, in any number of threads.

        Args:
            starts: Where the robot is, shape (n, nq), or (nq,) for all problems [rad, m].
            goals: One goal for each start, as `plan` takes them: configurations, shape (n, nq), poses, shape (n, 4, 4),
                or a sequence [rad, m].
            threads: How many threads; None for one.
            **options: Of `plan`; the same for all.

        Returns:
            The plans, in order.

        Raises:
            ShapeError: If there are not as many starts as goals.
            InputError: If `threads` makes no sense; what `plan` raises.
        """
        q0 = finite_array("starts", in_order("starts", starts, self.model.position_names))
        goal_list = list(goals)
        if q0.shape not in ((self.model.nq,), (len(goal_list), self.model.nq)):
            raise ShapeError("starts", q0.shape, f"({len(goal_list)}, {self.model.nq}), one for each goal")
        start_of_each = np.broadcast_to(q0, (len(goal_list), self.model.nq))
        workers = 1 if threads is None else _count("threads", threads, 1)
        is_stopped = threading.Event()

        def one(number: int) -> Plan | None:
            STOP.event = is_stopped
            if is_stopped.is_set():
                return None
            return self.plan(start_of_each[number], goal_list[number], **options)

        count, out = len(goal_list), []
        with self._in_batch(), progress("Planning") as report:
            if workers == 1 or count < 2 or process_end.has_begun():
                for number in range(count):
                    report(number, count)
                    out.append(self.plan(start_of_each[number], goal_list[number], **options))
                return out
            # Imported here: while the process ends, the import fails.
            from concurrent.futures import ThreadPoolExecutor, wait

            pool = ThreadPoolExecutor(min(workers, count))
            try:  # the search releases the GIL
                for number, future in enumerate([pool.submit(one, number) for number in range(count)]):
                    while not future.done():
                        wait((future,), _WAIT)
                    out.append(future.result())
                    report(number + 1, count)
                return out
            finally:  # after Ctrl-C the plans under way end within milliseconds
                is_stopped.set()
                pool.shutdown(cancel_futures=True)

    @contextmanager
    def _in_batch(self) -> Iterator[None]:
        """Within, the progress of the batch is shown, not that of each search."""
        self._batches += 1
        try:
            yield
        finally:
            self._batches -= 1


def _check_scene(robot: Any, world: Any) -> None:
    if not hasattr(robot, "collision_checker"):
        raise InputError(
            f"`robot` is a {type(robot).__name__}; expected a Robot, as ulna.load(...) or Robot(model) makes."
        )
    if world is not None and not isinstance(world, World):
        raise InputError(f"`world` is {short_repr(world)}; expected a World, as `World().add(...)` makes.")


def _checked_lengths(margin: Any, step: Any, longest: Any) -> tuple[float, float, float]:
    return (
        number("margin", margin, "a length, not below 0 [m]", least=0.0),
        number("step", step, "a length of at least 0.001 [m]", least=1e-3),
        number("longest", longest, "a distance from 0.001 to 1e6 [rad, m]", least=1e-3, most=1e6),
    )


def _checked_options(
    shorten: Any, iterations: Any, timeout: Any, seed: Any, improve: Any, keep_tree: Any, is_shown: bool
) -> Options:
    return Options(
        _count("shorten", shorten, 0), _count("iterations", iterations, 1), _seconds(timeout), _count("seed", seed, 0),
        improve=_count("improve", improve, 0), keep_tree=flag("keep_tree", keep_tree), is_shown=is_shown,
    )  # fmt: skip


def _count(name: str, value: Any, least: int) -> int:
    if type(value) is not int:
        value = number(name, value, f"an integer of at least {least}", least=least)
    if value != int(value) or value < least:
        raise InputError(f"`{name}` is {value!r}; expected an integer of at least {least}.")
    return int(value)


def _seconds(timeout: Any) -> float:
    return np.inf if timeout == np.inf else number("timeout", timeout, "seconds, not below 0", least=0.0)


def _roadmap_search(*arguments: Any) -> Search:
    from ulna.planning.roadmap import RoadmapSearch

    return RoadmapSearch(*arguments)


_last: list[Any] = [((object(),), None)]
"""What was asked for last, all of it frozen, and the planner for it: most programs plan for one robot in one world."""


def _planner_for(*asked: Any) -> Planner:
    """The planner for a robot, a world, spheres, pairs, margin, step, longest edge and method."""
    robot, world, spheres, pairs, margin, step, longest, method = asked
    asked = getattr(robot, "model", None), *asked
    known, planner = _last[0]
    if all(map(is_, asked, known)):
        return planner
    _check_scene(robot, world)
    _check_method(method)
    chosen = pairs if pairs is None else checked_pairs(robot.model, pairs)
    planner = _planner(robot, world, spheres, chosen, *_checked_lengths(margin, step, longest), method)
    if pairs is None:  # others may change
        _last[0] = asked, planner
    return planner


@lru_cache(maxsize=16)
def _planner(
    robot: Any, world: World | None, spheres: Spheres | None, pairs: Any, margin: float, step: float, longest: float,
    method: Method,
) -> Planner:  # fmt: skip
    lengths: dict[str, Any] = {"margin": margin, "step": step, "longest": longest}
    return Planner(robot, world, spheres=spheres, pairs=pairs, method=method, **lengths)


def _check_method(method: Any) -> None:
    if method not in get_args(Method):
        raise UnknownName("method", method, get_args(Method))


def _check_exact(**unused: bool) -> None:
    """Raises InputError if an argument has another value than that which has no effect."""
    for name, is_unused in unused.items():
        if not is_unused:
            raise InputError(
                f'method="exact" takes no `{name}`; leave it out, or plan with method="spheres".'
            )


@lru_cache(maxsize=16)
def _self_checker(robot: Any, spheres: Spheres | None, pairs: Any) -> Any:
    options = {"spheres": spheres, "pairs": pairs}
    given = {name: value for name, value in options.items() if value is not None}
    return robot.collision_checker(None, method="spheres", **given)
