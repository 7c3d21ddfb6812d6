"""The search along constraints: as that of a planner, with nodes, shortcuts and points of paths on the constraints."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from ulna.planning import projected_rrt
from ulna.planning.certificate import Certificate
from ulna.planning.path_constraints import TOLERANCE_RESERVE, Constraints
from ulna.planning.path_length import length
from ulna.planning.projected_rrt import Projection
from ulna.planning.run import Ending, Run
from ulna.planning.scenes import PlanningScene
from ulna.planning.search import Search
from ulna.planning.workspace import COARSE, Workspace, thread_storage
from ulna.typing import Floats

STRIDE = 0.1
"""How long motions between nodes are at most [rad, m]."""

LEFT = 0.05
"""What a projection leaves of the violation, in tolerances."""

_ROUNDS = 20  # steps of a projection at most
_REFINEMENTS = 6  # how often edges that leave the constraints are divided
_SHORTCUTS = 20  # tries for each round of `shorten`


class ConstrainedWorkspace(Workspace):
    """A workspace whose trees grow along constraints.

    Args:
        scene: The robot and the world.
        storage: The thread's arrays.
        constraints: The constraints.
        margin: How near everything may come at least [m].
        step: How far any point moves at most between the states by which a path is proved free [m].
        coarse: Step length of the search divided by that of the certificate [-].
    """

    def __init__(
        self,
        scene: PlanningScene,
        storage: Any,
        constraints: Constraints,
        margin: float,
        step: float,
        coarse: float,
    ) -> None:
        super().__init__(scene, storage, margin, step, STRIDE, coarse)
        model, self._step = constraints.model, constraints.step_kernel
        inputs = np.concatenate([np.zeros(model.nq), np.ones(model.nq), constraints.parameters])
        with np.errstate(over="ignore"):  # tolerances and edges may be as good as infinite
            inputs = inputs.astype(np.float32)
        self.projection = Projection(
            inputs[:, None].copy(), np.zeros((model.nq + 1, 1), np.float32),
            model.lower_position.astype(np.float32), model.upper_position.astype(np.float32),
            np.float32(LEFT), _ROUNDS, np.float32(STRIDE),
        )  # fmt: skip

    def set_fixed_coordinates(self, fixed_coordinates: Any) -> None:
        """Says which coordinates do not move.

        Args:
            fixed_coordinates: Truth values, shape (nq,); None for none.
        """
        n = self.storage.nq
        self.projection.inputs[n : 2 * n, 0] = 1.0 if fixed_coordinates is None else ~fixed_coordinates

    def _bind(self) -> None:
        s = self.storage
        if self._trees is s.trees and self._path is s.path and self._points is s.points:
            return
        super()._bind()
        self._grow_along = self._bound(
            projected_rrt.grow_along, self._tables, self._growth, s.samples, 0, 0, s.points, s.touching, 0, s.trees,
            self._step, self.projection,
        )  # fmt: skip
        self._walk = self._bound(
            projected_rrt.walk_between, self._tables, self._growth, s.points, np.zeros(2, np.float32), s.trees,
            self._step, self.projection,
        )  # fmt: skip

    def _grow(self, first: int, count: int, roots: int) -> int:
        for name, value in (("first", first), ("count", count), ("roots", roots)):
            self._grow_along.set(name, value)
        return self._grow_along()

    def bind(self, with_bound: bool) -> None:
        """Binds the procedures to the thread's arrays; compiles them the first time.

        Args:
            with_bound: Whether `grow_below` will be called, too; it takes no other procedure here.
        """
        self._bind()

    def grow_below(self, bound: float, first: int, count: int, roots: int) -> int:
        """As `grow`: nodes along constraints have no costs, and only the samples know of the bound."""
        return self.grow(first, count, roots)

    def path_between(self, a: Floats, b: Floats) -> Floats | None:
        """The path from one configuration to another along the constraints, as straight as they allow.

        Args:
            a: Shape (nq,) [rad, m].
            b: Shape (nq,) [rad, m].

        Returns:
            Its points, both ends among them, shape (n, nq) [rad, m]; None if it does not get there.
        """
        self._bind()
        points = self.storage.points
        kept = points[:2].copy()
        points[0], points[1] = a, b
        is_there = self._walk()
        points[:2] = kept
        if not is_there:
            return None
        trees = self.storage.trees
        inner = self._joint_box.clipped(trees.nodes[0, :, 1 : int(trees.counts[0])].T)
        return np.concatenate([a[None], inner, b[None]])

    def projected(self, points: Floats) -> tuple[Floats, Any]:
        """Configurations, moved to the constraints.

        Args:
            points: Shape (n, nq) [rad, m].

        Returns:
            The same shape, and which of them got there, shape (n,).
        """
        q, done = np.ascontiguousarray(points, np.float32), np.zeros(len(points), np.float32)
        projected_rrt.project_all(self._step, self.projection, q, done, len(q))
        return self._joint_box.clipped(q), done > 0.0


class ConstrainedSearch(Search):
    """Searches for paths on which constraints are kept.

    Args:
        scene: The robot and the world.
        margin: How near everything may come at least [m].
        step: How far any point moves at most between the states by which paths are proved free [m].
        constraints: The constraints.
    """

    _starts_at_once = False

    def __init__(self, scene: PlanningScene, margin: float, step: float, constraints: Constraints) -> None:
        super().__init__(scene, margin, step, STRIDE)
        self._constraints = constraints

    def _new_workspace(self, coarse: float) -> Workspace:
        arrays = thread_storage(self._model.nq)
        return ConstrainedWorkspace(self._scene, arrays, self._constraints, self._margin, self._step, coarse)

    def _prepare(self, run: Run) -> Ending | None:
        start, goals = self._constraints.violations(run.q0), self._constraints.violations(run.goals)
        most = 1.0 - TOLERANCE_RESERVE
        limit = f"times their tolerance, more than the {most:g} that leave room for motions that cut corners."
        if start > most:
            return Ending("start", f"`q0` violates the constraints: {start:.3g} {limit}")
        kept = np.flatnonzero(goals <= most)
        if len(run.goals) and not len(kept):
            return Ending("goal", f"the goal violates the constraints: {goals.min():.3g} {limit}")
        run.goals = run.goals[kept]
        failure = super()._prepare(run)
        run.goal_indices = kept[run.goal_indices].tolist()
        if failure is None:
            run.workspace.set_fixed_coordinates(run.options.fixed_coordinates)
            if run.direct_goal >= 0 and not (run.goals[run.direct_goal] == run.q0).all():
                run.direct_goal = -1  # a straight way leaves the constraints
        return failure

    def _shortened(self, run: Run) -> tuple[Floats, int]:
        """The path at which the trees met, with shortcuts along the constraints."""
        points, goal = run.workspace.shortened(0)
        points[0], points[-1] = run.q0, run.goals[goal]
        random = np.random.default_rng([run.options.seed, 2])
        for _ in range(_SHORTCUTS * run.options.shorten):
            if len(points) < 3 or run.should_stop():
                break
            i, j = np.sort(random.choice(len(points), 2, replace=False))
            if j - i < 2:
                continue
            path = run.workspace.path_between(points[i], points[j])
            if path is not None and length(path) < length(points[i : j + 1]) - 1e-3:
                points = np.concatenate([points[:i], path, points[j + 1 :]])
        if run.options.fixed_coordinates is not None:
            points[:, run.options.fixed_coordinates] = run.q0[run.options.fixed_coordinates]
        return points, goal

    def _improved(self, run: Run, points: Floats, goal: int) -> tuple[Floats, int]:
        workspace = self._workspace(COARSE[1])
        assert isinstance(workspace, ConstrainedWorkspace)
        workspace.set_fixed_coordinates(run.options.fixed_coordinates)
        return super()._improved(run, points, goal)

    def _wholly_proved(self, run: Run, points: Floats) -> Floats | None:
        points = self._refined(run, points)
        leaves = len(points) > 1 and self._constraints.unproved_edges(points)
        return None if leaves else super()._wholly_proved(run, points)

    def _proved(self, run: Run, points: Floats) -> tuple[Floats, Certificate]:
        points, _ = super()._proved(run, self._refined(run, points))
        points = self._refined(run, points)
        certificate = self._certificate(points, self._unproved(run, points))
        leaving = self._constraints.unproved_edges(points) if len(points) > 1 else []
        unproved = tuple(sorted({*certificate.unproved, *leaving}))
        return points, Certificate(unproved, certificate.clearance, certificate.checks)

    def _deviation_bounds(self) -> Floats | None:
        bounds = super()._deviation_bounds()
        if bounds is None:
            return None
        return np.concatenate([bounds, self._constraints.lipschitz_rows / TOLERANCE_RESERVE])

    def _refined(self, run: Run, points: Floats) -> Floats:
        """The path, with more points on the constraints where it would leave them in between."""
        for _ in range(_REFINEMENTS):
            edges = self._constraints.unproved_edges(points) if len(points) > 1 else []
            if not edges:
                break
            middles, is_there = run.workspace.projected(0.5 * (points[edges] + points[np.array(edges) + 1]))
            inserted = dict(zip(edges, zip(middles, is_there, strict=True), strict=True))
            pieces = [points[:1]]
            for k, (_, b) in enumerate(pairwise(points)):
                middle, ok = inserted.get(k, (b, False))
                pieces += [middle[None], b[None]] if ok else [b[None]]
            if len(pieces) == len(points):
                break
            points = np.concatenate(pieces)
        return points
