"""What a task does on a worker: parts of a job one after the other, of which it can give some back meanwhile."""

from __future__ import annotations

import pickle
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any, final

from ulna.scale.job import State
from ulna.scale.task_sizes import RETURNED

_WORTH = 0.08  # s that parts which have not begun take, at least, for some of them to be done elsewhere


@final
class _PartsLeft:
    """Which of its parts a task still has to do: those from one place up to another."""

    def __init__(self, count: int, start: float) -> None:
        self._next, self._end, self._start, self._lock = 0, count, start, threading.Lock()

    def take(self) -> int | None:
        """The place of the next part; None where there is none."""
        with self._lock:
            if self._next == self._end:
                return None
            self._next += 1
            return self._next - 1

    def give_back(self, share: float, now: float) -> int:
        """Gives back a share of the parts that are left, where these take long; returns how many it has in all."""
        with self._lock:
            left = self._end - self._next
            if left * (now - self._start) / max(self._next, 1) > _WORTH:
                self._end -= int(left * share)
            return self._end


_tasks: dict[str, _PartsLeft] = {}
"""The tasks that this process works on, by name."""


def work_parts(
    name: str,
    work: Callable[..., State],
    parts: Sequence[int],
    inputs: Sequence[tuple[Any, ...]] | None,
    limit: float,
) -> tuple[bytes, int, float, int]:
    """The results of some parts, one after the other, until time or memory is used up.

    Args:
        name: The name of the task.
        work: `work(part, *inputs)` does one part.
        parts: Their numbers.
        inputs: The further arguments of each; None for none.
        limit: For how long another part may begin [s].

    Returns:
        The results of the first parts, at least of one, pickled: Dask would send each array with a header of its own;
        how many parts; how long a part took [s]; and how many bytes the results have.
    """
    out: list[State] = []
    size, start = 0, time.perf_counter()
    first = now = start
    left = _tasks[name] = _PartsLeft(len(parts), start)
    try:
        while (k := left.take()) is not None:
            out.append(work(parts[k], *(inputs[k] if inputs else ())))
            size += sum(array.nbytes for array in out[-1].values())
            now = time.perf_counter()
            first = now if k == 0 else first
            if now - start > limit or size >= RETURNED:
                break
    finally:
        _tasks.pop(name, None)
    is_alone = len(out) == 1  # else the first, where functions may be compiled, says nothing of the others
    seconds = now - start if is_alone else (now - first) / (len(out) - 1)
    return pickle.dumps(out, protocol=5), len(out), seconds, size


def give_back(names: Sequence[str], share: float) -> dict[str, int]:
    """Has tasks of this process give back the last of the parts that they have not begun, where these take long.

    Args:
        names: The names of the tasks; others than those that this process works on are left out.
        share: Which share of these parts [-].

    Returns:
        By name, how many parts a task has now in all: the first ones.
    """
    now, tasks = time.perf_counter(), {name: _tasks.get(name) for name in names}
    return {name: left.give_back(share, now) for name, left in tasks.items() if left is not None}
