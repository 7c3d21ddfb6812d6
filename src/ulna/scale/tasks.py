"""Parts of a job on a cluster: some of them under way at any time, repeated when their worker is lost.

Short parts are sent several at a time; which are sent together changes nothing in the results. Towards the end, a
worker that has nothing to do gets parts that others have not begun.
"""

from __future__ import annotations

import errno
import math
import pickle
import queue
import threading
import time
from asyncio import CancelledError
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple, final

from ulna.errors import UlnaError
from ulna.lazy import Portable
from ulna.scale.job import State
from ulna.scale.task_sizes import FEW, TaskSizes, UnderWay
from ulna.scale.task_work import give_back, work_parts

_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EACCES, errno.EPERM}
_ATTEMPTS = 3  # of a part whose work raises an error that is not Ulna's
_COUNT = 3.0  # s between two questions how many workers there are
_TICK = 0.25  # s between looks at the connection
_SENT = 2**23  # bytes that parts of a task may need together

Inputs = Callable[[int], tuple[Any, ...]]
"""The further arguments of the work of a part."""


def is_storage_error(error: BaseException) -> bool:
    """Whether an error says that nothing can be written: a full disk, a limit, missing rights."""
    return isinstance(error, OSError) and error.errno in _FULL


class Interrupted(Exception):
    """The cluster cannot go on; says why."""


class _Task(NamedTuple):
    """A task that was sent: its name and future, its parts, and what is expected of it."""

    name: str
    future: Any
    parts: tuple[int, ...]
    expected: UnderWay


@final
class Tasks:
    """Does parts of a job on a cluster.

    Args:
        client: The client of the scheduler.
        task: `task(part, *inputs)` does one part.
        parts: The numbers of the parts, in order.
        inputs: `inputs(part)` is what a part needs beside its number.
        retries: How often a part may lose its worker.
        patience: How long to wait for a lost scheduler to come back [s].
    """

    def __init__(
        self,
        client: Any,
        task: Portable,
        parts: Sequence[int],
        inputs: Inputs,
        retries: int,
        patience: float,
    ) -> None:
        self._client, self._task, self._inputs = client, task, inputs
        self._waiting, self._returned = parts, list[int]()  # both in order; the returned ones go first
        self._retries, self._patience = retries, patience
        self._tasks: dict[int, _Task] = {}  # by the first of the parts of a task
        self._sizes = TaskSizes()
        self._failures: dict[int, int] = {}
        self._losses: dict[int, int] = {}
        self._submissions = 0
        self._ended: queue.SimpleQueue[int] = queue.SimpleQueue()
        self._question: _Question | None = None  # which parts workers give back
        self._asked = -math.inf
        self._lost_since: float | None = None
        self._count, self._counted = 1, -_COUNT
        self._alone_since: float | None = None

    def results(self) -> Iterator[tuple[int, State]]:
        """The results as they come, never more than some ahead of the first part that is missing.

        Yields:
            The number of a part, and what its work returned.

        Raises:
            Interrupted: If the scheduler is lost, a part fails again and again, or nothing can be written.
            UlnaError: What the work of a part raised.
        """
        try:
            while self._returned or self._waiting or self._tasks:
                self._submit_waiting()
                for first in sorted(self._ended_tasks()):
                    if first in self._tasks and self._tasks[first].future.done():
                        parts, content = self._take_results(first)
                        self._submit_waiting()  # before the results are read and added, which may take long
                        if parts:  # a task that was begun again on another worker may have done more
                            yield from zip(parts, pickle.loads(content), strict=False)
        finally:
            if self._question is not None:
                self._question.join(_TICK)
            for task in self._tasks.values():
                with suppress(Exception, CancelledError):
                    task.future.cancel()

    def _submit_waiting(self) -> None:
        """Submits parts while there is room; where none are left for a thread, asks others to give some back."""
        if not self._is_connected():
            return
        threads = self._threads()
        if self._question is not None and self._question.kept is not None:
            self._collect_returned_parts(self._question.kept)
            self._question = None
        if self._sizes.seconds is None and not self._tasks and not self._returned:
            self._submit_first(threads)
        while left := len(self._returned) + len(self._waiting):
            room = self._sizes.room(left, threads)
            if len(self._tasks) >= room:
                return
            under_way = [task.expected for task in self._tasks.values()]
            together, limit = self._sizes.next(left, threads, under_way, time.monotonic())
            again = self._returned[:together]
            parts = (*again, *self._waiting[: together - len(again)])
            last = min(self._tasks, default=parts[0]) + 2 * room * self._sizes.most
            parts = tuple(part for part in parts if part <= last)
            if not parts:
                return  # the first is late: what waits for it must not fill the memory
            sent = self._submit(parts, limit)
            del self._returned[:sent]
            self._waiting = self._waiting[max(sent - len(again), 0) :]
        self._ask_for_parts(threads)

    def _submit_first(self, threads: int) -> None:
        """Submits a task for each thread, of two threads with every second part: results then come in order."""
        count, limit = self._sizes.first(len(self._waiting), threads)
        parts, self._waiting = self._waiting[: count * threads], self._waiting[count * threads :]
        for k in range(min(threads, len(parts))):
            sent = self._submit(tuple(parts[k::threads]), limit)
            self._returned += parts[k::threads][sent:]
        self._returned.sort()

    def _ask_for_parts(self, threads: int) -> None:
        """Asks tasks that end late for parts that they have not begun, where threads have nothing to do."""
        idle, now = threads - len(self._tasks), time.monotonic()
        is_too_early = self._question is not None or now - self._asked < _TICK
        names = [task.name for task in self._tasks.values() if len(task.parts) > 1]
        if idle > 0 and names and threads <= FEW and not is_too_early:
            self._asked = now
            share = idle / (idle + len(self._tasks))
            self._question = _Question(self._client, names, share, lambda: self._ended.put(-1))
            self._question.start()

    def _collect_returned_parts(self, kept: Mapping[str, int]) -> None:
        """Notes which parts tasks have given back: all but the first ones, as many as they have kept."""
        for first, task in self._tasks.items():
            parts = task.parts[kept.get(task.name, len(task.parts)) :]
            if parts:
                left = task.parts[: -len(parts)]
                expected = task.expected._replace(count=len(left))
                self._tasks[first] = task._replace(parts=left, expected=expected)
                self._returned += parts
                self._asked = -math.inf
        self._returned.sort()

    def _threads(self) -> int:
        """How many threads the workers have; asked now and then, since workers come and go.

        Raises:
            Interrupted: If there have been no workers for too long.
        """
        now = time.monotonic()
        if now - self._counted > _COUNT:
            with suppress(OSError, CancelledError):
                self._count = sum(self._client.nthreads().values())
                self._alone_since = None if self._count else self._alone_since or now
            self._counted = now
        if self._alone_since is not None and now - self._alone_since > self._patience:
            raise Interrupted("All workers are lost.")
        return max(self._count, 1)

    def _submit(self, parts: tuple[int, ...], limit: float) -> int:
        """Submits parts as one task, as many as may be sent at a time; returns how many."""
        from dask.sizeof import sizeof  # pyright: ignore[reportMissingImports]

        self._submissions += 1
        key = f"ulna-part-{parts[0]}-{self._task.digest[:8]}-{id(self)}-{self._submissions}"
        inputs, size = [], 0
        for part in parts:
            inputs.append(self._inputs(part))
            size += sizeof(inputs[-1])
            if size > _SENT:
                break
        parts = parts[: len(inputs)]
        further = inputs if any(inputs) else None
        future = self._client.submit(work_parts, key, self._task, parts, further, limit, key=key, pure=False)
        expected = UnderWay(time.monotonic(), len(parts), limit, self._sizes.seconds)
        self._tasks[parts[0]] = _Task(key, future, parts, expected)
        future.add_done_callback(lambda _: self._ended.put(parts[0]))
        return len(parts)

    def _ended_tasks(self) -> set[int]:
        """First parts of tasks that have ended since the last look; all where the connection was lost meanwhile."""
        ended = set()
        with suppress(queue.Empty):
            ended.add(self._ended.get(timeout=_TICK))
            while True:
                ended.add(self._ended.get_nowait())
        if not ended and self._is_connected():
            ended = {first for first, task in self._tasks.items() if task.future.done()}
        return ended

    def _is_connected(self) -> bool:
        """Whether the scheduler answers; raises once it has not for too long."""
        if self._client.status == "running":
            self._lost_since = None
            return True
        now = time.monotonic()
        self._lost_since = now if self._lost_since is None else self._lost_since
        if self._client.status == "closed" or now - self._lost_since > self._patience:
            raise Interrupted("The scheduler does not answer any more.")
        return False

    def _take_results(self, first: int) -> tuple[Sequence[int], bytes]:
        """The parts that a task has done, and their results; no parts where they are to be done again."""
        _, future, parts, _ = self._tasks.pop(first)
        self._begin_next()
        if future.status == "finished":
            try:
                content, count, seconds, size = future.result(timeout=60.0)
            except (Exception, CancelledError) as error:  # its worker was lost with it
                self._redo(parts, error)
                return (), b""
            self._sizes.learn(seconds, size / count, self._count)
            self._returned = sorted([*self._returned, *parts[count:]])
            return parts[:count], content
        if future.status == "error":
            self._examine(parts, future.exception())
        else:
            self._redo(parts, None)
        return (), b""

    def _begin_next(self) -> None:
        """Notes that the first task that waited for a thread begins, where there is one."""
        for first, task in [*self._tasks.items()][self._count - 1 : self._count]:
            begun = task.expected._replace(begun=time.monotonic())
            self._tasks[first] = task._replace(expected=begun)

    def _examine(self, parts: Sequence[int], error: BaseException) -> None:
        """Decides what an error of a task means: the end, or another attempt."""
        from distributed import KilledWorker  # pyright: ignore[reportMissingImports]

        if isinstance(error, UlnaError):
            raise error
        if is_storage_error(error):
            raise Interrupted(f"A worker cannot write: {error}.") from error
        if isinstance(error, KilledWorker):
            self._redo(parts, error)
            return
        if len(parts) == 1:
            part = parts[0]
            self._failures[part] = self._failures.get(part, 0) + 1
            if self._failures[part] >= _ATTEMPTS:
                raise Interrupted(
                    f"Part {part} failed {_ATTEMPTS} times: {type(error).__name__}: {error}."
                ) from error
        self._submit_each(parts)

    def _redo(self, parts: Sequence[int], error: BaseException | None) -> None:
        """Does parts again whose worker was lost."""
        while not self._is_connected():
            time.sleep(_TICK)
        for part in parts:
            self._losses[part] = self._losses.get(part, 0) + 1
            if self._losses[part] > self._retries:
                raise Interrupted(
                    f"Part {part} lost its worker {self._losses[part]} times; workers may lack memory ({error!r})."
                )
        self._submit_each(parts)

    def _submit_each(self, parts: Sequence[int]) -> None:
        """Submits parts in tasks of one, so that the one that fails is known."""
        for part in parts:
            self._submit((part,), 0.0)


@final
class _Question(threading.Thread):
    """Asks workers to give back parts, while the job goes on: a worker that is lost meanwhile answers late or never.

    Args:
        client: The client of the scheduler.
        names: The names of the tasks that are asked.
        share: Which share of the parts that they have not begun [-].
        ended: What to call at the end.

    Attributes:
        kept: By the names of tasks, how many parts each has now in all; None before the answer.
    """

    def __init__(self, client: Any, names: Sequence[str], share: float, ended: Callable[[], object]) -> None:
        super().__init__(daemon=True)
        self._client, self._names, self._share, self._tell = client, names, share, ended
        self.kept: dict[str, int] | None = None

    def run(self) -> None:
        """Asks."""
        kept: dict[str, int] = {}
        with suppress(Exception, CancelledError):
            answers = self._client.run(give_back, self._names, self._share, on_error="ignore")
            for answer in answers.values():
                kept |= answer
        self.kept = kept
        self._tell()
