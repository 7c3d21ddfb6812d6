"""The poses of a scene over time, which a page can play after its program has ended."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from ulna.system import forks
from ulna.typing import Array
from ulna.viewer.graph.node import Snapshot
from ulna.viewer.page.poses import pose_rows

_INTERVAL = 1 / 60  # s between two frames
_CAPACITY = 32_000_000  # bytes of all frames
_MAX_REST = 1.0  # s for which a motion may rest, where its time is the wall clock's
_FIRST_REST = 0.1  # s before it begins to move


@final
@dataclass(frozen=True)
class Frame:
    """The poses of a scene at a time.

    Attributes:
        t: The time since the beginning [s].
        names: Names of the nodes.
        rows: x y z [m], w x y z of each in the world, (n, 7) float32.
    """

    t: float
    names: tuple[str, ...]
    rows: Array


@final
@dataclass(frozen=True)
class MotionPart:
    """Frames of the same nodes.

    Attributes:
        paths: Paths of the nodes in the page.
        t: The times [s], (T,).
        rows: Their poses, (T, n, 7) float32.
    """

    paths: list[str]
    t: list[float]
    rows: Array


@final
class MotionLog:
    """Frames of a scene, 60 in a second at most; when memory is short, every second one is forgotten.

    Their time is the wall clock's, with rests of at most a second, or that of a simulation.

    Args:
        capacity: How many bytes all frames may take.
    """

    def __init__(self, capacity: int = _CAPACITY) -> None:
        self._capacity, self._lock = capacity, forks.lock()
        self._frames: list[Frame] = []
        self._size, self._interval = 0, _INTERVAL
        self._names: tuple[int, tuple[str, ...]] = (-1, ())
        self._wall_time = -np.inf
        self._simulated_time: Callable[[], float] | None = None
        self._labelled = -1.0

    @property
    def frames(self) -> Sequence[Frame]:
        """The frames, in the order of their times."""
        with self._lock:
            return tuple(self._frames)

    def follow_simulation(self, time_now: Callable[[], float]) -> None:
        """Begin again, with the time [s] of a simulation from now on: `add_step` adds the frames."""
        with self._lock:
            self._frames, self._size, self._interval = [], 0, _INTERVAL
            self._simulated_time, self._labelled = time_now, -1.0

    def add_step(self, snapshot: Callable[[], Snapshot], at_end: bool = False) -> None:
        """Add a frame at the simulated time, where the last one is an interval ago.

        Args:
            snapshot: Returns the scene.
            at_end: Whether it is the last frame, which is added in any case.
        """
        if self._simulated_time is None:
            return
        t = self._simulated_time()
        frames = self._frames
        if not at_end and frames and 0.0 < t - frames[-1].t < self._interval - 1e-9:
            return
        self._add(t, snapshot())

    def add_published(self, snapshot: Snapshot) -> float | None:
        """Add what is sent to the page now, unless a simulation adds its steps.

        Args:
            snapshot: The scene.

        Returns:
            Its time [s] for pages, which keep frames, too; None for what is no part of the motion.
        """
        if self._simulated_time is not None:
            t, last = self._simulated_time(), self._labelled
            self._labelled = t
            return t if t != last or t == 0.0 else None
        now = time.monotonic()
        rest = min(now - self._wall_time, _MAX_REST if len(self._frames) > 1 else _FIRST_REST)
        self._wall_time = now
        return self.add_later(rest, snapshot)

    def add_later(self, dt: float, snapshot: Snapshot) -> float:
        """Add a frame some time after the last one.

        Args:
            dt: How long after it [s].
            snapshot: The scene.

        Returns:
            The time of the frame [s].
        """
        t = self._frames[-1].t + dt if self._frames else 0.0
        with self._lock:
            if len(self._frames) > 1 and self._frames[-1].t - self._frames[-2].t < self._interval - 1e-9:
                self._size -= self._frames.pop().rows.nbytes
        self._add(t, snapshot)
        return t

    def parts(self, paths: Mapping[str, Sequence[str]]) -> list[MotionPart]:
        """The motion as pages take it: nodes that move, in parts of frames with the same nodes.

        Args:
            paths: Paths in the page of the nodes that it has, by name.

        Returns:
            The parts; none where nothing moved.
        """
        runs = _runs(self.frames)
        moved = _moved_names(runs) & set(paths)
        out: list[MotionPart] = []
        for names, t, rows in runs:
            chosen = [(i, path) for i, n in enumerate(names) if n in moved for path in paths[n]]
            if chosen:
                out.append(MotionPart([p for _, p in chosen], t, rows[:, [i for i, _ in chosen]]))
        return out

    def _add(self, t: float, snapshot: Snapshot) -> None:
        with self._lock:
            if self._names[0] != snapshot.structure:
                names = tuple(node.name for node in snapshot.nodes)
                self._names = snapshot.structure, self._names[1] if names == self._names[1] else names
            while self._frames and self._frames[-1].t >= t:  # time was set back, or it is this very frame
                self._size -= self._frames.pop().rows.nbytes
            self._frames.append(Frame(t, self._names[1], pose_rows(snapshot.poses)))
            self._size += self._frames[-1].rows.nbytes
            if self._size > self._capacity and len(self._frames) > 4:
                self._frames = [*self._frames[:-1:2], self._frames[-1]]
                self._size, self._interval = sum(f.rows.nbytes for f in self._frames), 2 * self._interval


def _runs(frames: Sequence[Frame]) -> list[tuple[tuple[str, ...], list[float], Array]]:
    """Frames that follow one another and have the same nodes: names, times, and poses (T, n, 7)."""
    runs = (list(run) for _, run in itertools.groupby(frames, lambda frame: id(frame.names)))
    return [(run[0].names, [f.t for f in run], np.stack([f.rows for f in run])) for run in runs]


def _moved_names(runs: Sequence[tuple[tuple[str, ...], list[float], Array]]) -> set[str]:
    """Names of nodes that are not in the same place in all frames."""
    first: dict[str, Array] = {}
    moved: set[str] = set()
    for names, _, rows in runs:
        differs = (rows != rows[0]).any(axis=(0, 2))
        for i, name in enumerate(names):
            if differs[i] or (first.setdefault(name, rows[0, i]) != rows[0, i]).any():
                moved.add(name)
    return moved
