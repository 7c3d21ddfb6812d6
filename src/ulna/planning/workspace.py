"""Storage of one thread for a scene, and the procedures of planning bound to it: calls cost about a microsecond."""

from __future__ import annotations

import threading
from functools import lru_cache
from typing import Any

import numpy as np

from ulna.collision.lanes.tables import Scene
from ulna.compiler.procedures import aligned
from ulna.planning import bounded_rrt, edges, rrt_connect, shortcuts
from ulna.planning.edges import Proof
from ulna.planning.rrt_connect import EVERYWHERE, FREE_PLACE, Growth
from ulna.planning.trees import Trees
from ulna.system.collector import paused_collection
from ulna.typing import Floats

SLICE = 512
"""The most samples between two looks at the clock; Ctrl-C is raised there, too."""

PARTS = (1.0, 0.25, 0.0625)
"""The three steps of a proof, in parts of the longest."""

COARSE = (8.0, 2.0, 0.5)
"""The steps of the search, and of searches for detours where its path touches in between, in those of the proof."""

_CAPACITY = 2048  # of a tree, at first
_INITIAL_CAPACITY = 512  # points of a path, at first
_POINTS = 16  # start and goals, at first
_DOMAIN, _LEAST_DOMAIN, _CHANGE = 4.0, 1.0, 1e-4  # of nodes, in the longest edge but the last


class Storage:
    """Arrays that all scenes of a thread share, for configurations of one length; larger ones replace them.

    Args:
        nq: How many numbers a configuration has.
    """

    def __init__(self, nq: int) -> None:
        self.nq = nq
        self.samples, self.parts = np.zeros((SLICE, nq), np.float32), np.zeros(SLICE, np.float32)
        self.make_trees(_CAPACITY)
        self.make_path(_INITIAL_CAPACITY)
        self.make_points(_POINTS)

    def make_trees(self, capacity: int) -> None:
        """Makes empty trees with places for so many nodes."""
        nodes = aligned(np.full((2, self.nq, capacity), FREE_PLACE, np.float32))
        self.trees = Trees(
            nodes, np.full((2, capacity), EVERYWHERE, np.float32), np.zeros((2, capacity), np.float32),
            np.full((2, capacity), -1, np.int64), np.zeros(2, np.int64), np.zeros(2, np.int64),
            *np.zeros((4, self.nq), np.float32),
        )  # fmt: skip

    def enlarge_trees(self) -> None:
        """Makes trees of the same nodes with twice the places."""
        fills = {"nodes": FREE_PLACE, "radii": EVERYWHERE, "costs": 0.0, "parents": -1}
        larger = {}
        for name, fill in fills.items():
            old = getattr(self.trees, name)
            larger[name] = aligned(np.concatenate([old, np.full_like(old, fill)], axis=-1))
        self.trees = self.trees._replace(**larger)

    def make_path(self, room: int) -> None:
        """Makes room for a path of so many points."""
        self.path = np.zeros((room, self.nq), np.float32)

    def make_points(self, room: int) -> None:
        """Makes room for start and goals."""
        self.points, self.touching = np.zeros((room, self.nq), np.float32), np.zeros(room, np.float32)


class Workspace:
    """A scene's tables, and procedures bound to them and to a thread's arrays.

    Args:
        scene: The robot and the world.
        storage: The thread's arrays.
        margin: How near everything may come at least [m].
        step: How far any point moves at most between the states by which a path is proved free [m].
        longest: The longest edge of the trees [rad, m].
        coarse: The steps of the search, in those of the proof [-].
    """

    def __init__(
        self, scene: Scene, storage: Storage, margin: float, step: float, longest: float, coarse: float
    ) -> None:  # fmt: skip
        self.step, self.storage = coarse * step, storage
        tables = [scene.tables(margin + size * step / 2.0) for size in PARTS]
        self._tables, self._work = tables[-1], scene.moving.work()
        self._kernel, self._lanes = scene.robot.kernel, scene.lanes
        self._proof = Proof(tables[0], tables[1], tables[2], np.float32(step))
        numbers = (self.step, longest, _DOMAIN * longest, _LEAST_DOMAIN * longest, _CHANGE)
        self._growth = Growth._make(map(np.float32, numbers))
        self._trees = self._path = self._points = None

    def bind(self, with_bound: bool) -> None:
        """Binds the procedures to the thread's arrays, unless they are bound to these; compiles them the first time.

        Args:
            with_bound: Whether `grow_below` will be called, too.
        """
        self._bind()
        s = self.storage
        if with_bound and self._grow_below is None:
            self._grow_below = self._bound(
                bounded_rrt.grow_below, self._tables, self._growth, s.samples, s.parts, 0, 0, s.points, s.touching, 0,
                np.float32(0.0), s.trees,
            )  # fmt: skip

    def _bind(self) -> None:
        s = self.storage
        if self._trees is s.trees and self._path is s.path and self._points is s.points:
            return
        self._trees, self._path, self._points = s.trees, s.path, s.points
        with paused_collection():
            self._bind_all(s)

    def _bind_all(self, s: Storage) -> None:
        """Binds the procedures that every search needs."""
        self._direct = self._bound(edges.first_direct_goal, self._tables, self.step, s.points, s.touching, 0)
        self._grow = self._bound(
            rrt_connect.grow, self._tables, self._growth, s.samples, 0, 0, s.points, s.touching, 0, s.trees
        )
        self._grow_below: Any = None  # only some searches need it
        self._shorten = self._bound(shortcuts.shortened_path, self._tables, self.step, s.trees, s.path, 0)
        self._check = self._bound(edges.first_unproved_edge, self._proof, s.path, 0, 0)

    def _bound(self, procedure: Any, *arguments: Any) -> Any:
        special = _specialized(procedure, self._lanes)
        return special.bind(self._kernel, *arguments, self._work, are_arrays_private=True)

    def call(self, procedure: Any, *arguments: Any) -> Any:
        """Calls a procedure with the scene.

        Args:
            procedure: One that takes the kernel and the tables first, and working storage last.
            *arguments: What it takes in between.

        Returns:
            What it returns.
        """
        return _specialized(procedure, self._lanes)(self._kernel, self._tables, *arguments, self._work)

    def bound(self, procedure: Any, *arguments: Any) -> Any:
        """A procedure bound to the scene and to arrays that only the caller has, for many calls.

        Args:
            procedure: One that takes the kernel and the tables first, and working storage last.
            *arguments: What it takes in between.

        Returns:
            What is called without arguments, and runs it.
        """
        return self._bound(procedure, self._tables, *arguments)

    def examine(self, q0: Floats, goals: Floats) -> int:
        """The first goal to which the straight motion is free.

        Args:
            q0: The start, shape (nq,) [rad, m].
            goals: Goals, shape (n, nq) [rad, m].

        Returns:
            A number among the goals; -1 for none. What `free_points` says of start and goals follows.
        """
        count = 1 + len(goals)
        if count > len(self.storage.points):
            self.storage.make_points(2 * count)
        self._bind()
        points = self.storage.points
        points[0], points[1:count] = q0, goals
        self._direct.set("count", count)
        return max(self._direct.unguarded() - 1, -1)

    def free_points(self, count: int) -> list[bool]:
        """Which of the start and the goals that were examined last are free.

        Args:
            count: How many there are.

        Returns:
            Truth values, the start's first.
        """
        return [touching == 0.0 for touching in self.storage.touching[:count].tolist()]

    def grow(self, first: int, count: int, roots: int) -> int:
        """Grows the trees with samples; see `rrt_connect.grow`.

        Args:
            first: The sample to begin with.
            count: How many samples there are.
            roots: How many points that `examine` was given are roots of new trees; 0 to go on.

        Returns:
            The number of the first sample that was not used; where the trees met, minus that, minus 1.
        """
        if 2 * roots + 64 > self.storage.trees.nodes.shape[2]:
            self.storage.make_trees(2 * roots + _CAPACITY)
        self._bind()
        self._grow.set("first", first)
        self._grow.set("count", count)
        self._grow.set("roots", roots)
        result = self._grow()
        if 0 <= result < count:  # no places are left
            self.storage.enlarge_trees()
        return result

    def grow_below(self, bound: float, first: int, count: int, roots: int) -> int:
        """Grows the trees with samples until they meet by a path shorter than a bound; see `bounded_rrt.grow_below`.

        Args:
            bound: The bound [rad, m].
            first: The sample to begin with.
            count: How many samples there are.
            roots: How many points that `examine` was given are roots of new trees; 0 to go on.

        Returns:
            The number of the first sample that was not used; where the trees met, minus that, minus 1.
        """
        self.bind(with_bound=True)
        for name, value in (("first", first), ("count", count), ("roots", roots), ("bound", bound)):
            self._grow_below.set(name, value)
        result = self._grow_below()
        if 0 <= result < count:  # no places are left
            self.storage.enlarge_trees()
        return result

    def shortened(self, rounds: int) -> tuple[Floats, int]:
        """The path at which the trees met, shorter, and the number of the goal among those that are free.

        Args:
            rounds: How often it is shortened at most.

        Returns:
            Points, shape (n, nq) [rad, m], in float64; the ends are those of float32.
        """
        count = -1
        while count < 0:
            self._bind()
            self._shorten.set("rounds", rounds)
            count = self._shorten()
            if count < 0:
                self.storage.make_path(2 * len(self.storage.path))
        trees = self.storage.trees
        node, parents = int(trees.meeting[1]), trees.parents[1]
        while parents[node] >= 0:
            node = int(parents[node])
        return self.storage.path[:count].astype(float), node

    def unproved(self, points: Floats) -> list[int]:
        """The edges of a path, by number, of which machine code does not prove that nothing touches on them.

        Args:
            points: The path, shape (n, nq) [rad, m].

        Returns:
            The numbers.
        """
        count = len(points)
        if count > len(self.storage.path):
            self.storage.make_path(2 * count)
        self._bind()
        self.storage.path[:count] = points
        self._check.set("count", count)
        self._check.set("first", 0)
        numbers: list[int] = []
        while (edge := self._check.unguarded()) >= 0:
            numbers.append(edge)
            if count == 1:
                break
            self._check.set("first", edge + 1)
        return numbers


_STORAGE = threading.local()


def thread_storage(nq: int) -> Storage:
    """This thread's arrays for configurations of a length.

    Args:
        nq: The length.

    Returns:
        The arrays.
    """
    stores: dict[int, Storage] = _STORAGE.__dict__.setdefault("by_length", {})
    if nq not in stores:
        stores[nq] = Storage(nq)
    return stores[nq]


@lru_cache(maxsize=64)
def _specialized(procedure: Any, lanes: int) -> Any:
    return procedure.specialized(W=lanes)
