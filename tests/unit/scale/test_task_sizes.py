"""Tasks of a job are few, and all threads end together: by a clock of its own."""

from __future__ import annotations

import pytest

from ulna.scale.task_sizes import TaskSizes, UnderWay

_TASK = 0.01  # s that a task takes beside its parts


class _Threads:
    """Threads that work on tasks of parts, by a clock of their own."""

    def __init__(self, count: int, seconds: float, speeds: list[float]) -> None:
        self.sizes, self.left, self.now, self.tasks = TaskSizes(), count, 0.0, 0
        self._part = [seconds / speed for speed in speeds]
        self._under_way: dict[int, UnderWay] = {}
        self._waiting, self._idle = list[int](), [*range(len(speeds))]
        self._ends = dict[
            int, tuple[float, int, int]
        ]()  # by task: when it ends, on which thread, after which part
        self._first = self.sizes.first(count, len(speeds))

    def run(self) -> None:
        """Does all parts."""
        while self.left or self._under_way:
            self._submit()
            self._begin()
            self._share()
            self._end()

    def _submit(self) -> None:
        threads = len(self._part)
        while self.left and len(self._under_way) < self.sizes.room(self.left, threads):
            under_way = [*self._under_way.values()]
            size, limit = (
                self._first if not self.now else self.sizes.next(self.left, threads, under_way, self.now)
            )
            size = min(size, self.left)
            assert size >= 1
            self._under_way[self.tasks] = UnderWay(self.now, size, limit, self.sizes.seconds)
            self._waiting.append(self.tasks)
            self.left, self.tasks = self.left - size, self.tasks + 1

    def _begin(self) -> None:
        while self._idle and self._waiting:
            number, thread = self._waiting.pop(0), self._idle.pop()
            task = self._under_way[number] = self._under_way[number]._replace(begun=self.now)
            done = min(task.count, 1 + int(task.limit / self._part[thread]))
            self._ends[number] = (self.now + done * self._part[thread] + _TASK, thread, done)

    def _share(self) -> None:
        """Has tasks give back parts that they have not begun where threads are idle, as the coordinator does."""
        if self.left or not self._idle or not self._ends:
            return
        share = len(self._idle) / len(self._part)
        for number, (end, thread, done) in self._ends.items():
            task = self._under_way[number]
            begun = 1 + int((self.now - task.begun) / self._part[thread])
            if (done - begun) * self._part[thread] > 0.08:
                back = int((done - begun) * share)
                self._under_way[number] = task._replace(count=task.count - back)
                self._ends[number] = (end - back * self._part[thread], thread, done - back)
                self.left += back
        self._submit()
        self._begin()

    def _end(self) -> None:
        number = min(self._ends, key=lambda k: self._ends[k][0])
        self.now, thread, done = self._ends.pop(number)
        self.left += self._under_way.pop(number).count - done
        self.sizes.learn(self._part[thread], 100.0, len(self._part))
        self._idle.append(thread)


def _simulated(count: int, seconds: float, speeds: list[float]) -> tuple[float, int]:
    """When all parts are done on threads of these speeds [s], and how many tasks that took."""
    threads = _Threads(count, seconds, speeds)
    threads.run()
    return threads.now, threads.tasks


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
    assert sizes.next(10**6, 2, [], 0.0)[0] == 300
    sizes.learn(0.01, 100.0, 1000)
    assert sizes.next(10**6, 1000, [], 0.0)[0] == 500
    assert sizes.room(10**6, 1000) == 2000


def test_a_thread_gets_what_fills_it_until_the_others_end() -> None:
    """One thread is busy for another second; three seconds of work are left: both end in two seconds."""
    sizes = TaskSizes()
    sizes.learn(0.01, 100.0, 2)
    count, limit = sizes.next(300, 2, [UnderWay(5.0, 150, 10.0, None)], 5.5)
    assert count == 200 + 2 and limit == pytest.approx(1.05 * 2.02)
    assert sizes.next(50, 2, [UnderWay(5.0, 150, 10.0, None)], 5.5)[0] == 50, "the busy one gets none"


def test_parts_that_a_task_will_return_are_shared_evenly() -> None:
    """The other thread has 16 parts of 10 ms, does 6 of them and returns 10: of these and 90 others, both get half."""
    sizes = TaskSizes()
    sizes.learn(0.01, 100.0, 2)
    assert sizes.next(90, 2, [UnderWay(5.0, 16, 0.055, None)], 5.06)[0] == 50 + 2


def test_a_task_that_waits_begins_when_its_thread_is_free() -> None:
    """Both threads are busy for a second, and a task of half a second follows on one: the other gets as much more."""
    sizes = TaskSizes()
    sizes.learn(0.01, 100.0, 2)
    under_way = [UnderWay(5.0, 100, 10.0, None), UnderWay(5.0, 50, 10.0, None)]
    assert sizes.next(100, 2, [under_way[1]], 5.0)[0] == 75 + 2
    late = under_way[1]._replace(begun=6.0)
    assert sizes.next(100, 2, [late], 6.0)[0] == 75 + 2
