"""How many parts the next task of a job has, so that tasks are few and all threads end together.

A task takes client, scheduler and worker some 10 ms of processor time together, whatever it does. Tasks are therefore
as long as they may be; towards the end each fills its thread up to the time when all can end together. A task that is
late returns what it has not begun, and gives parts back to threads that have nothing to do: work stealing [Blumofe &
Leiserson 1999] by the coordinator. Guided self-scheduling [Polychronopoulos & Kuck 1987] has to end with many short
tasks instead.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from heapq import heapreplace
from typing import NamedTuple, final

RETURNED = 2**24
"""Bytes that the results of a task may have; one that has more ends early."""

_LONGEST, _SHORTEST = 3.0, 0.03  # s that a task takes, where its parts are short
_SCHEDULER = 0.005  # s by which tasks grow for each thread, so that the scheduler keeps up with many workers
_FIRST, _FIRST_SECONDS = 16, 0.1  # parts of a task, and s for it, where nothing is known of their time yet
_FIRST_OF_FEW = 1000  # parts of a task, where few threads can share them again
_LATE = 1.05  # of the time that is expected of a task: no further part begins later
_UNEVEN = 0.02  # s by which a task may be longer than its share
_SHARES = 1.3  # of the parts that are left, for each thread: a task that waits for another has one of them
FEW = 16
"""Threads that can get their last tasks one after the other, without waiting long, and can be asked for parts."""


class UnderWay(NamedTuple):
    """A task that has been sent.

    Attributes:
        begun: When it was sent, or the task before it on its thread has ended [s].
        count: How many parts it has.
        limit: For how long another of them may begin [s].
        seconds: How long a part was expected to take when it was sent [s]; None where nothing was known.
    """

    begun: float
    count: int
    limit: float
    seconds: float | None


@final
class TaskSizes:
    """Chooses how many parts a task has, from the time and the memory that parts took."""

    def __init__(self) -> None:
        self.seconds: float | None = None
        """How long a part took on the thread whose task ended last [s]; None where nothing is known."""
        self._longest = _LONGEST
        self.most = _FIRST
        """The most parts of a task."""

    def learn(self, seconds: float, size: float, threads: int) -> None:
        """Takes in what a task measured.

        Args:
            seconds: How long a part took [s].
            size: How many bytes its result has [-].
            threads: How many threads the workers have.
        """
        self.seconds = max(seconds, 1e-9)
        self._longest = max(_LONGEST, _SCHEDULER * threads)
        self.most = max(1, int(min(self._longest / self.seconds, RETURNED / max(size, 1.0))))

    def first(self, left: int, threads: int) -> tuple[int, float]:
        """The size of the first task of each thread.

        Args:
            left: How many parts there are.
            threads: How many threads the workers have.

        Returns:
            How many parts, and for how long another of them may begin [s].
        """
        if threads > FEW:
            return max(1, min(left // (2 * threads), _FIRST)), _FIRST_SECONDS
        return min(-(-left // threads), _FIRST_OF_FEW), _LONGEST

    def room(self, left: int, threads: int) -> int:
        """How many tasks there may be at a time: one more for each thread while there is much to do.

        Args:
            left: How many parts have not been sent.
            threads: How many threads the workers have.

        Returns:
            The number.
        """
        is_long = self.seconds is not None and left * self.seconds > self._longest * threads
        return 2 * threads if is_long or threads > FEW else threads

    def next(self, left: int, threads: int, under_way: Sequence[UnderWay], now: float) -> tuple[int, float]:
        """The size of the next task.

        Args:
            left: How many parts have not been sent.
            threads: How many threads the workers have.
            under_way: The other tasks, in the order in which they were sent.
            now: The time [s].

        Returns:
            How many parts, and for how long another of them may begin [s].
        """
        if self.seconds is None:
            return max(1, min(left // (2 * threads), self.most)), _FIRST_SECONDS
        share = left * self.seconds / threads
        if len(under_way) >= threads:  # it waits for another to end: further ones will follow
            seconds = max(share / _SHARES, _SHORTEST)
        elif share > 2.0 * self._longest:
            seconds = self._longest
        else:
            seconds = self._until_the_end(left, threads, under_way, now)
        count = int((min(seconds, self._longest) + _UNEVEN) / self.seconds)
        count = max(1, min(count, left, self.most))
        return count, _LATE * count * self.seconds

    def _until_the_end(self, left: int, threads: int, under_way: Sequence[UnderWay], now: float) -> float:
        """For how long the thread that is free first works if all threads end together [s]; in equal tasks."""
        assert self.seconds is not None
        free = [-math.inf] * threads
        for task in under_way:
            seconds = task.seconds or self.seconds  # other threads may be slower than the one that ended last
            done = min(task.count, int(task.limit / seconds) + 1)  # it returns the others
            heapreplace(free, max(free[0], task.begun) + done * seconds)
            left += task.count - done
        end = _level([max(time, now) for time in free], left * self.seconds)
        rest = end - now
        return max(rest / math.ceil(rest / self._longest), _SHORTEST)


def _level(free: list[float], work: float) -> float:
    """When threads end that are free at these times and share so much work; those free later get none of it [s]."""
    free = sorted(free)
    ends = ((sum(free[:k]) + work) / k for k in range(len(free), 0, -1))
    return next(end for end, last in zip(ends, reversed(free), strict=True) if end >= last)
