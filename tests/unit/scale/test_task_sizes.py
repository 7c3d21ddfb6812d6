"""Tasks of a job are few, and all threads end together: by a clock of its own."""

from __future__ import annotations

import heapq
import itertools

import pytest

from ulna.scale.task_sizes import TaskSizes, UnderWay

_TASK = 0.01  # s that a task takes beside its parts


def _simulated(count: int, seconds: float, speeds: list[float]) -> tuple[float, int]:
    """When all parts are done on threads of these speeds [s], and how many tasks that took."""
    sizes, left, now, tasks = TaskSizes(), count, 0.0, 0
    under_way: dict[int, UnderWay] = {}
    waiting: list[int] = []
    idle, ends = list(range(len(speeds))), list[tuple[float, int, int, int]]()
    numbers = itertools.count()
    while left or under_way:
        while left and len(under_way) < sizes.room(left, len(speeds)):
            size, limit = sizes.next(left, len(speeds), list(under_way.values()), now)
            assert 1 <= size <= left
            number = next(numbers)
            under_way[number], left, tasks = UnderWay(now, size, limit, sizes.seconds), left - size, tasks + 1
            waiting.append(number)
        while idle and waiting:
            number, thread = waiting.pop(0), idle.pop()
            _, size, limit, _ = under_way[number]
            part = seconds / speeds[thread]
            done = min(size, 1 + int(limit / part))
            heapq.heappush(ends, (now + done * part + _TASK, number, thread, done))
        now, number, thread, done = heapq.heappop(ends)
        left += under_way.pop(number).count - done
        sizes.learn(seconds / speeds[thread], 100.0, len(speeds))
        idle.append(thread)
    return now, tasks


@pytest.mark.parametrize(
    ("count", "seconds", "speeds", "most_tasks", "late"),
    [
        (100, 0.0112, [1.0, 1.0], 6, 0.06),  # a second of work
        (400, 0.0098, [1.0, 1.0], 6, 0.04),
        (1000, 0.0605, [1.0, 1.0], 40, 0.02),  # a minute
        (20, 0.5, [1.0, 1.0], 14, 0.06),  # long parts
        (400, 0.0098, [1.0, 0.8], 8, 0.04),  # other programs take a fifth of a processor
        (1000, 0.01, [1.0, 0.9], 12, 0.02),
        (16_000, 0.0065, [1.0] * 32, 300, 0.05),
        (3, 0.001, [1.0] * 8, 3, 40.0),
    ],
)
def test_tasks_are_few_and_end_together(
    count: int, seconds: float, speeds: list[float], most_tasks: int, late: float
) -> None:
    took, tasks = _simulated(count, seconds, speeds)
    assert tasks <= most_tasks
    assert took <= (1.0 + late) * count * seconds / sum(speeds)


def test_large_results_are_sent_in_small_tasks() -> None:
    sizes = TaskSizes()
    sizes.learn(0.001, 2**22, 2)
    assert sizes.next(10_000, 2, [], 0.0)[0] == sizes.most == 4


def test_tasks_grow_with_the_threads_that_a_scheduler_serves() -> None:
    sizes = TaskSizes()
    sizes.learn(0.01, 100.0, 2)
    assert sizes.next(10**6, 2, [], 0.0)[0] == 200
    sizes.learn(0.01, 100.0, 1000)
    assert sizes.next(10**6, 1000, [], 0.0)[0] == 500
    assert sizes.room(10**6, 1000) == 2000


def test_a_thread_gets_what_fills_it_until_the_others_end() -> None:
    """One thread is busy for another second; three seconds of work are left: both end in two seconds."""
    sizes = TaskSizes()
    sizes.learn(0.01, 100.0, 2)
    count, limit = sizes.next(300, 2, [UnderWay(5.0, 150, 10.0, None)], 5.5)
    assert count == 202 - 2 and limit == pytest.approx(1.05 * 2.0)
    assert sizes.next(50, 2, [UnderWay(5.0, 150, 10.0, None)], 5.5)[0] == 50, "the busy one gets none"


def test_parts_that_a_task_will_return_are_shared_evenly() -> None:
    """The other thread has 16 parts of 10 ms, does 6 of them and returns 10: of these and 90 others, both get half."""
    sizes = TaskSizes()
    sizes.learn(0.01, 100.0, 2)
    assert sizes.next(90, 2, [UnderWay(5.0, 16, 0.055, None)], 5.06)[0] == 50 + 2
