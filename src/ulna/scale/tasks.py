"""Parts of a job on a cluster: some of them under way at any time, repeated when their worker is lost.

Short parts are sent several at a time; which are sent together changes nothing in the results.
"""

from __future__ import annotations

import errno
import pickle
import queue
import time
from asyncio import CancelledError
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import Any, NamedTuple, final

from ulna.errors import UlnaError
from ulna.lazy import Portable
from ulna.scale.job import State
from ulna.scale.task_sizes import RETURNED, TaskSizes, UnderWay

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


def work_parts(
    task: Callable[..., State], parts: Sequence[int], inputs: Sequence[tuple[Any, ...]] | None, limit: float
) -> tuple[bytes, float, int]:
    """The results of some parts, one after the other, until time or memory is used up; what a task does on a worker.

    Args:
        task: `task(part, *inputs)` does one part.
        parts: Their numbers.
        inputs: The further arguments of each; None for none.
        limit: For how long another part may begin [s].

    Returns:
        The results of the first parts, at least of one, pickled: Dask would send each array with a header of its own;
        how long a part took [s]; and how many bytes the results have.
    """
    out: list[State] = []
    size, start = 0, time.perf_counter()
    first = now = start
    for k, part in enumerate(parts):
        out.append(task(part, *(inputs[k] if inputs else ())))
        size += sum(array.nbytes for array in out[-1].values())
        now = time.perf_counter()
        first = now if k == 0 else first
        if now - start > limit or size >= RETURNED:
            break
    is_alone = len(out) == 1  # else the first, where functions may be compiled, says nothing of the others
    seconds = now - start if is_alone else (now - first) / (len(out) - 1)
    return pickle.dumps(out, protocol=5), seconds, size


class _Task(NamedTuple):
    """A task that was sent: its future, its parts, and what is expected of it."""

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
                        found = self._results(first)
                        self._submit_waiting()  # before the results are added, which may take long
                        yield from found
        finally:
            for task in self._tasks.values():
                with suppress(Exception, CancelledError):
                    task.future.cancel()

    def _submit_waiting(self) -> None:
        """Submits parts while there is room."""
        if not self._is_connected():
            return
        threads = self._threads()
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
        future = self._client.submit(work_parts, self._task, parts, further, limit, key=key, pure=False)
        expected = UnderWay(time.monotonic(), len(parts), limit, self._sizes.seconds)
        self._tasks[parts[0]] = _Task(future, parts, expected)
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

    def _results(self, first: int) -> list[tuple[int, State]]:
        """What the parts of a task returned; nothing where they are to be done again."""
        future, parts, _ = self._tasks.pop(first)
        if future.status == "finished":
            try:
                content, seconds, size = future.result(timeout=60.0)
            except (Exception, CancelledError) as error:  # its worker was lost with it
                self._lose(parts, error)
                return []
            results = pickle.loads(content)
            self._sizes.learn(seconds, size / len(results), self._count)
            self._returned = sorted([*self._returned, *parts[len(results) :]])
            return list(zip(parts, results, strict=False))
        if future.status == "error":
            self._examine(parts, future.exception())
        else:
            self._lose(parts, None)
        return []

    def _examine(self, parts: Sequence[int], error: BaseException) -> None:
        """Decides what an error of a task means: the end, or another attempt."""
        from distributed import KilledWorker  # pyright: ignore[reportMissingImports]

        if isinstance(error, UlnaError):
            raise error
        if is_storage_error(error):
            raise Interrupted(f"A worker cannot write: {error}.") from error
        if isinstance(error, KilledWorker):
            self._lose(parts, error)
            return
        if len(parts) == 1:
            part = parts[0]
            self._failures[part] = self._failures.get(part, 0) + 1
            if self._failures[part] >= _ATTEMPTS:
                raise Interrupted(
                    f"Part {part} failed {_ATTEMPTS} times: {type(error).__name__}: {error}."
                ) from error
        self._submit_each(parts)

    def _lose(self, parts: Sequence[int], error: BaseException | None) -> None:
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
