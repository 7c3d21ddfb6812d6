"""A search among the real shapes, through coal: slower than with spheres, for what passes closer than spheres allow.

RRT-Connect whose straight motions are checked by conservative advancement (`ulna.collision.first_contact`), so that
each motion in its trees is proved free between its ends. Source: Kuffner and LaValle, RRT-Connect: an efficient
approach to single-query path planning (ICRA 2000); Geraerts and Overmars, Creating high-quality paths for motion
planning, International Journal of Robotics Research 26 (2007), section 5, for the shortcuts.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import final

import numpy as np

from ulna.collision import Checker, LinkPair, World
from ulna.collision.lanes.moving import check_vector_joints
from ulna.collision.segment import NEAR, first_contact_along
from ulna.model import Model
from ulna.planning.certificate import Certificate
from ulna.planning.joint_box import JointBox
from ulna.planning.result import Plan
from ulna.planning.run import Ending, Options, Run
from ulna.planning.samples import samples
from ulna.planning.search_tree import SearchTree
from ulna.typing import Floats

_BLOCK = 64  # samples that are drawn at once
_PART = 0.9  # of a motion up to its first contact that is kept
_SHORTEST = 0.05  # such a motion is kept from this length on, in the longest ones
_SHORTCUTS = 6  # tries in each round


@final
class ExactSearch:
    """Searches for paths of one robot in one world; one thread at a time.

    Args:
        model: The robot; positions of its joints are plain numbers.
        world: Obstacles, and what links carry.
        pairs: Pairs of links to check against each other; None for `link_pairs(model)`.
        margin: How near anything may come at least [m].
        longest: The longest edge of the trees [rad, m].

    Raises:
        InputError: If a joint has a configuration that is no plain numbers.
        ModelError: If the robot has no collision geometry.
        MissingExtra: If coal is not installed.
    """

    def __init__(
        self, model: Model, world: World, pairs: Iterable[LinkPair] | None, margin: float, longest: float
    ) -> None:
        check_vector_joints(model)
        self._checker = Checker(model, world, pairs=pairs)
        self._model, self._margin, self._longest = model, margin, longest
        self._box = JointBox(model)

    def run(self, q0: Floats, goals: Floats, options: Options) -> Plan:
        """A path from a configuration to one of several.

        Args:
            q0: Where the robot is, shape (nq,) [rad, m].
            goals: Where it may go, shape (n, nq) [rad, m].
            options: What is asked for.

        Returns:
            The plan, or why there is none.
        """
        with Run(options, q0, goals) as run:
            return self._planned(run)

    def _planned(self, run: Run) -> Plan:
        """The plan that a run finds, or why there is none."""
        failure = self._prepare(run)
        if failure is not None:
            return self._result(run, failure, np.zeros((0, self._model.nq)), -1)
        points, goal = self._direct(run)
        if not len(points):
            points, goal = self._grown(run)
        run.add_time_to("search")
        if not len(points):
            return self._result(run, run.limit_reached(), points, -1)
        points = self._shortened(run, points)
        run.add_time_to("shorten")
        return self._result(run, Ending("solved", ""), points, run.goal_indices[goal])

    # before the search ------------------------------------------------------------------------------------

    def _prepare(self, run: Run) -> Ending | None:
        """Keeps the goals that are free; why the search cannot begin, where it cannot."""
        failure = run.check_limits(self._box)
        if failure is not None:
            return failure
        touch = self._touch(run.q0)
        if touch is not None:
            return Ending("start", f"at the start {touch[0]}.", touch[1])
        touches = [self._touch(run.goals[k]) for k in run.goal_indices]
        free = [k for k, touch in zip(run.goal_indices, touches, strict=True) if touch is None]
        if not free:
            assert touches[0] is not None
            goal = "the goal" if len(touches) == 1 else "the first goal"
            return Ending("goal", f"at {goal} {touches[0][0]}.", touches[0][1])
        run.goal_indices, run.goals = free, run.goals[free]
        run.add_time_to("prepare")
        return None

    def _touch(self, q: Floats) -> tuple[str, tuple[str, str]] | None:
        """What touches at a configuration, or comes nearer than the margin, in words and by names; None for nothing."""
        nearest = self._checker.distance(q)
        distance = float(nearest.distance)
        if distance > self._margin + NEAR:
            return None
        link, other = nearest.names
        if distance > 0.0:
            return f"{link!r} comes within {1e3 * distance:.3g} mm of {other!r}", (link, other)
        return f"{link!r} overlaps {other!r} by {-1e3 * distance:.3g} mm", (link, other)

    # search -----------------------------------------------------------------------------------------------

    def _contact(self, run: Run, a: Floats, b: Floats) -> float:
        """Up to which part of it a straight motion is proved free; inf for all of it."""
        return first_contact_along(self._checker, a, b - a, self._margin, run.should_stop)

    def _is_free(self, run: Run, a: Floats, b: Floats) -> bool:
        return self._contact(run, a, b) == np.inf

    def _direct(self, run: Run) -> tuple[Floats, int]:
        """The straight motion to the nearest goal that one leads to, and the number of the goal; else no points."""
        distances = np.linalg.norm(run.goals - run.q0, axis=1)
        for k in np.argsort(distances, kind="stable").tolist():
            if distances[k] == 0.0:
                return run.q0[None], k
            if run.should_stop():
                break
            if self._is_free(run, run.q0, run.goals[k]):
                return np.stack([run.q0, run.goals[k]]), k
        return np.zeros((0, self._model.nq)), -1

    def _grown(self, run: Run) -> tuple[Floats, int]:
        """The path at which two trees met, and the number of its goal; no points where they did not."""
        trees = _Tree(run.q0[None]), _Tree(run.goals)
        low, high = self._box.sampled(run.q0, run.goals, run.options.fixed_coordinates)
        points, goal, block = np.zeros((0, self._model.nq)), -1, np.zeros((0, self._model.nq))
        while run.samples_used < run.options.iterations and not run.should_stop():
            if not run.samples_used % _BLOCK:
                rounded = samples(run.samples_used, _BLOCK, run.options.seed, low, high)
                block = np.clip(rounded.astype(float), low, high)
            k = run.samples_used % 2  # the trees take turns
            node = self._extended(run, trees[k], block[run.samples_used % _BLOCK])
            run.samples_used += 1
            if node is None:
                continue
            met = self._connected(run, trees[1 - k], trees[k].nodes[node])
            if met is not None:
                ends = (node, met) if k == 0 else (met, node)
                first, second = (tree.path_to(end) for tree, end in zip(trees, ends, strict=True))
                points, goal = np.vstack([trees[0].nodes[first], trees[1].nodes[second[-2::-1]]]), second[0]
                break
        run.nodes = sum(len(tree.nodes) for tree in trees)
        if run.options.keep_tree:
            run.tree = _search_tree(*trees)
        return points, goal

    def _extended(self, run: Run, tree: _Tree, q: Floats) -> int | None:
        """Grows a tree towards a configuration, by one edge at most; the new node, or None where nothing is free."""
        near = tree.nearest(q)
        a = tree.nodes[near]
        distance = float(np.linalg.norm(q - a))
        if distance == 0.0:
            return near
        b = q if distance <= self._longest else a + (q - a) * (self._longest / distance)
        contact = self._contact(run, a, b)
        if contact == np.inf:
            return tree.add(b, near)
        part = _PART * contact
        if part * float(np.linalg.norm(b - a)) < _SHORTEST * self._longest:
            return None
        return tree.add(a + part * (b - a), near)

    def _connected(self, run: Run, tree: _Tree, q: Floats) -> int | None:
        """Grows a tree towards a configuration until something is in the way; the node that reached it, or None."""
        while not run.should_stop():
            node = self._extended(run, tree, q)
            if node is None:
                return None
            if (tree.nodes[node] == q).all():
                return node
        return None

    def _shortened(self, run: Run, points: Floats) -> Floats:
        """A path of which places are joined by straight motions where these are free, while there is time."""
        points, random = self._joined(run, points), np.random.default_rng([run.options.seed, 1])
        for _ in range(run.options.shorten * _SHORTCUTS):
            if len(points) < 3 or run.should_stop():
                break
            lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
            at = np.sort(random.uniform(0.0, lengths[-1], 2))
            i, j = np.clip(np.searchsorted(lengths, at, side="right"), 1, len(points) - 1).tolist()
            if i == j:
                continue
            part = ((at - lengths[[i - 1, j - 1]]) / (lengths[[i, j]] - lengths[[i - 1, j - 1]]))[:, None]
            ends = points[[i - 1, j - 1]] * (1.0 - part) + points[[i, j]] * part
            if run.options.fixed_coordinates is not None:
                ends[:, run.options.fixed_coordinates] = run.q0[run.options.fixed_coordinates]
            if self._is_free(run, *ends):
                points = np.vstack([points[:i], ends, points[j:]])
        return self._joined(run, points)

    def _joined(self, run: Run, points: Floats) -> Floats:
        """Each point joined to the farthest later one to which a straight motion is free."""
        rows, i = [points[0]], 0
        while i < len(points) - 1:
            j = len(points) - 1
            while j > i + 1 and (
                not run.options.shorten or run.should_stop() or not self._is_free(run, points[i], points[j])
            ):
                j -= 1
            rows.append(points[j])
            i = j
        return np.stack(rows)

    def _result(self, run: Run, ending: Ending, points: Floats, goal: int) -> Plan:
        return Plan(
            ending.outcome,
            ending.reason,
            points,
            Certificate((), self._margin, 0) if len(points) else None,
            goal,
            run.samples_used,
            run.nodes,
            0.0,
            run.seconds,
            self._model,
            tree=run.tree,
            touching=ending.touching,
            method="exact",
        )


class _Tree:
    """Configurations, and the numbers of those that they were reached from; -1 for roots.

    Args:
        roots: The first configurations, shape (n, nq) [rad, m].
    """

    def __init__(self, roots: Floats) -> None:
        self._rows, self.parents = roots.copy(), [-1] * len(roots)

    @property
    def nodes(self) -> Floats:
        """The configurations, shape (n, nq) [rad, m]."""
        return self._rows[: len(self.parents)]

    def nearest(self, q: Floats) -> int:
        """The number of the configuration nearest to another one, shape (nq,) [rad, m]."""
        return int(((self.nodes - q) ** 2).sum(axis=1).argmin())

    def add(self, q: Floats, parent: int) -> int:
        """Adds a configuration; returns its number.

        Args:
            q: The configuration, shape (nq,) [rad, m].
            parent: The number of the one that it was reached from.
        """
        if len(self.parents) == len(self._rows):
            self._rows = np.vstack([self._rows, np.empty_like(self._rows)])
        self._rows[len(self.parents)] = q
        self.parents.append(parent)
        return len(self.parents) - 1

    def path_to(self, number: int) -> list[int]:
        """The numbers of the configurations from a root to one of them."""
        numbers = [number]
        while self.parents[numbers[-1]] >= 0:
            numbers.append(self.parents[numbers[-1]])
        return numbers[::-1]


def _search_tree(first: _Tree, second: _Tree) -> SearchTree:
    count = len(first.parents)
    parents = first.parents + [k if k < 0 else k + count for k in second.parents]
    nodes = np.concatenate([first.nodes, second.nodes])
    return SearchTree(nodes, np.array(parents), np.arange(len(nodes)) < count)
