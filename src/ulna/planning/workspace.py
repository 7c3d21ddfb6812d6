"""Storage of one thread for a scene, and the procedures of planning bound to it: calls cost about a microsecond."""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable
from functools import lru_cache
from typing import Any

import numpy as np

from ulna.collision.lanes.moving import Moving
from ulna.collision.lanes.tables import Scene
from ulna.collision.lanes.touching import Work
from ulna.compiler.procedures import aligned
from ulna.planning import bounded_rrt
from ulna.planning.edges import Proof
from ulna.planning.joint_box import JointBox
from ulna.planning.rrt_connect import EVERYWHERE, FREE_PLACE, Growth
from ulna.planning.stages import EXAMINE, GROW, PROVE, SHORTEN, START, run_stage
from ulna.planning.trees import Trees
from ulna.system.collector import paused_collection
from ulna.typing import Floats

SLICE = 512
"""The most samples between two looks at the clock; Ctrl-C is raised there, too."""

ROOM = 4 * SLICE
"""How many samples are held."""

PARTS = (1.0, 0.25, 0.0625)
"""The three steps of a proof, in parts of the longest."""

COARSE = (8.0, 2.0, 0.5)
"""Step length of the search divided by that of the certificate: at first, and where its path touches in between."""

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
        self.samples, self.parts = np.zeros((ROOM, nq), np.float32), np.zeros(ROOM, np.float32)
        self._sequence: Hashable = None
        self._begin = self._end = 0
        self._works: dict[tuple[int, int, int], Work] = {}
        self.make_trees(_CAPACITY)
        self.make_path(_INITIAL_CAPACITY)
        self.make_points(_POINTS)

    def work(self, moving: Moving) -> Work:
        """Working storage of checks, which all that have it in one size share: it stays in the processor's caches.

        Args:
            moving: What moves.

        Returns:
            The arrays.
        """
        work = moving.work()
        return self._works.setdefault((work.q.shape[1], len(work.c), len(work.placed)), work)

    def hold_samples(self, sequence: Hashable, number: int, count: int, draw: Callable[[], Any]) -> int:
        """Holds samples of a sequence, those that are held already included.

        Args:
            sequence: What decides the sequence; None for samples that are of none.
            number: The number of the first sample in its sequence.
            count: How many samples, at most `SLICE`.
            draw: Returns them, shape (count, nq) [rad, m].

        Returns:
            The row of the first one.
        """
        if sequence is None or sequence != self._sequence or not self._begin <= number <= self._end:
            self._sequence, self._begin, self._end = sequence, number, number
        if number + count > self._begin + ROOM:
            self._begin = self._end = number
        row = number - self._begin
        if number + count > self._end:
            self.samples[row : row + count] = draw()
            self._end = number + count
        return row

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
        self.ends = np.zeros((room, self.nq))


class Workspace:
    """A scene's tables, and procedures bound to them and to a thread's arrays.

    Args:
        scene: The robot and the world.
        storage: The thread's arrays.
        margin: How near everything may come at least [m].
        step: How far any point moves at most between the states by which a path is proved free [m].
        longest: The longest edge of the trees [rad, m].
        coarse: Step length of the search divided by that of the certificate [-].
    """

    def __init__(
        self, scene: Scene, storage: Storage, margin: float, step: float, longest: float, coarse: float
    ) -> None:  # fmt: skip
        self.step, self.storage = coarse * step, storage
        tables = [scene.tables(margin + size * step / 2.0) for size in PARTS]
        self._tables, self._work = tables[-1], storage.work(scene.moving)
        self._kernel, self._lanes = scene.robot.kernel, scene.lanes
        self._proof = Proof(tables[0], tables[1], tables[2], np.float32(step))
        numbers = (self.step, longest, _DOMAIN * longest, _LEAST_DOMAIN * longest, _CHANGE)
        self._joint_box = JointBox(scene.robot.model)
        self._growth = Growth._make(map(np.float32, numbers))
        self._box = np.stack([self._joint_box.low, self._joint_box.high])
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
            self._bind_stages(s)

    def _bind_stages(self, s: Storage) -> None:
        """Binds the procedure that every search needs."""
        numbers = np.zeros(5, np.int64)
        special = _specialized(run_stage, self._lanes)
        self._numbers = numbers.data  # a memoryview, whose numbers are read and set in a fraction of the time
        self._run = special.bind(
            numbers, self._kernel, self._proof, self._growth, self._box, s.ends, s.samples, s.points, s.touching,
            s.trees, s.path, self._work, are_arrays_private=True,
        ).unguarded  # fmt: skip
        self._grow_below: Any = None  # only some searches need it

    def _run_stage(self, stage: int, count: int, first: int = 0, roots: int = 0) -> int:
        """Runs a stage of `stages.run_stage`."""
        numbers = self._numbers
        numbers[0], numbers[1], numbers[2], numbers[3] = stage, first, count, roots
        return self._run()

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
        """Looks whether start and goals are within the limits and free, and for the first goal straight ahead.

        Args:
            q0: The start, shape (nq,) [rad, m].
            goals: Goals, shape (n, nq) [rad, m].

        Returns:
            The number of the goal; -1 for none; `NOT_ALL_FREE` where the start or a goal is not.
        """
        self._run_stage(EXAMINE, 0, 0, self._hold_ends(q0, goals))
        return self._goal_straight_ahead()

    def start(self, q0: Floats, goals: Floats, first: int, count: int) -> tuple[int, int]:
        """Examines start and goals, and grows new trees where all are free and none is straight ahead.

        Args:
            q0: The start, shape (nq,) [rad, m].
            goals: Goals, shape (n, nq) [rad, m].
            first: The sample to begin with.
            count: How many samples there are.

        Returns:
            What `examine` returns, and where that is -1 what `grow` returns.
        """
        roots = self._hold_ends(q0, goals)
        result = self._run_stage(START, count, first, roots)
        direct = self._goal_straight_ahead()
        if direct == -1:
            self._make_places(result, count)
        return direct, result

    def _hold_ends(self, q0: Floats, goals: Floats) -> int:
        """Holds start and goals, and makes room for trees from them; returns how many they are."""
        count = 1 + len(goals)
        if count > len(self.storage.points):
            self.storage.make_points(2 * count)
        self._make_places_for_roots(count)
        self._bind()
        ends = self.storage.ends
        ends[0], ends[1:count] = q0, goals
        return count

    def _make_places_for_roots(self, roots: int) -> None:
        if 2 * roots + 64 > self.storage.trees.nodes.shape[2]:
            self.storage.make_trees(2 * roots + _CAPACITY)

    def _make_places(self, result: int, count: int) -> None:
        """Enlarges the trees where samples are left because no places were."""
        if 0 <= result < count:
            self.storage.enlarge_trees()

    def _goal_straight_ahead(self) -> int:
        found = self._numbers[4]
        return found - 1 if found > 0 else found

    def free_points(self, count: int) -> list[bool]:
        """Which of start and goals, all within the limits, were found free when they were examined.

        Args:
            count: How many they are.

        Returns:
            Truth values.
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
        self._make_places_for_roots(roots)
        self._bind()
        result = self._grow(first, count, roots)
        self._make_places(result, count)
        return result

    def _grow(self, first: int, count: int, roots: int) -> int:
        """Grows the trees with samples as long as they have places; see `rrt_connect.grow`."""
        return self._run_stage(GROW, count, first, roots)

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
        self._make_places(result, count)
        return result

    def shortened(self, rounds: int) -> tuple[Floats, int]:
        """The path at which the trees met, shorter, and the number of the goal among those that are free.

        Args:
            rounds: How often it is shortened at most.

        Returns:
            Points within the limits, shape (n, nq) [rad, m], in float64; the ends are those of float32.
        """
        count = -1
        while count < 0:
            self._bind()
            count = self._run_stage(SHORTEN, rounds)
            if count < 0:
                self.storage.make_path(2 * len(self.storage.path))
        return self._joint_box.clipped(self.storage.path[:count]), self._numbers[4]

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
        numbers: list[int] = []
        edge = self._run_stage(PROVE, count)
        while edge >= 0:
            numbers.append(edge)
            edge = self._run_stage(PROVE, count, edge + 1) if count > 1 else -1
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
