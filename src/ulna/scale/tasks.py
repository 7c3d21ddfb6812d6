"""Parts of a job on a cluster: some of them under way at any time, repeated when their worker is lost.

Parts that take less than some tenths of a second are sent several at a time, for the scheduler needs about a
millisecond for a task. Which parts are sent together changes nothing in the results.
"""

from __future__ import annotations

import errno
import queue
import time
from asyncio import CancelledError
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import Any, final

from ulna.errors import JobStopped, UlnaError
from ulna.lazy import Portable
from ulna.scale.job import State

_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EACCES, errno.EPERM}
_ATTEMPTS = 3  # of a part whose work raises an error that is not Ulna's
_COUNT = 3.0  # s between two questions how many workers there are
_TICK = 0.25  # s between looks at the connection
_SECONDS = 0.3  # that a task takes, where several parts are sent at a time
_BYTES = 2**24  # that the results of a task may have

Inputs = Callable[[int], tuple[Any, ...]]
"""The further arguments of the work of a part."""


def is_storage_error(error: BaseException) -> bool:
    """Whether an error says that nothing can be written: a full disk, a limit, missing rights."""
    return isinstance(error, OSError) and error.errno in _FULL


class Interrupted(Exception):
    """The cluster cannot go on; says why."""


def work_parts(
    task: Portable, parts: Sequence[int], inputs: Sequence[tuple[Any, ...]]
) -> tuple[list[State], float]:
    """The results of some parts, one after the other; what a task does on a worker.

    Args:
        task: `task(part, *inputs)` does one part.
        parts: Their numbers.
        inputs: The further arguments of each.

    Returns:
        The results, and how long the last part took [s].
    """
    out, seconds = [], 0.0
    for part, further in zip(parts, inputs, strict=True):
        start = time.perf_counter()
        out.append(task(part, *further))
        seconds = time.perf_counter() - start
    return out, seconds


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
        self._client, self._task, self._parts, self._inputs = client, task, parts, inputs
        self._retries, self._patience = retries, patience
        self._futures: dict[int, tuple[Any, tuple[int, ...]]] = {}  # by the first of the parts of a task
        self._together = 1  # parts of a task
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
        following = 0
        try:
            while following < len(self._parts) or self._futures:
                following = self._submitted(following)
                for first in sorted(self._ended_tasks()):
                    if first in self._futures and self._futures[first][0].done():
                        yield from self._results(first)
        finally:
            for future, _ in self._futures.values():
                with suppress(Exception, CancelledError):
                    future.cancel()

    def _submitted(self, following: int) -> int:
        """Submits parts while there is room; returns the place of the next one."""
        room = 2 * self._threads() + 2 if self._is_connected() else 0
        first = min(self._futures, default=None)
        while following < len(self._parts) and len(self._futures) < room:
            left = -(
                -(len(self._parts) - following) // (2 * room)
            )  # at the end all workers have something to do
            parts = tuple(self._parts[following : following + min(self._together, left)])
            if first is not None and parts[-1] - first > 2 * room * self._together:
                break  # the first is late: what waits for it must not fill the memory
            self._submit(parts)
            first = parts[0] if first is None else first
            following += len(parts)
        return following

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

    def _submit(self, parts: tuple[int, ...]) -> None:
        self._submissions += 1
        key = f"ulna-part-{parts[0]}-{self._task.digest[:8]}-{id(self)}-{self._submissions}"
        inputs = [self._inputs(part) for part in parts]
        future = self._client.submit(work_parts, self._task, parts, inputs, key=key, pure=False)
        self._futures[parts[0]] = future, parts
        future.add_done_callback(lambda _: self._ended.put(parts[0]))

    def _ended_tasks(self) -> set[int]:
        """First parts of tasks that have ended since the last look; all where the connection was lost meanwhile."""
        ended = set()
        with suppress(queue.Empty):
            ended.add(self._ended.get(timeout=_TICK))
            while True:
                ended.add(self._ended.get_nowait())
        if not ended and self._is_connected():
            ended = {first for first, (future, _) in self._futures.items() if future.done()}
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

    def _results(self, first: int) -> Iterator[tuple[int, State]]:
        """What the parts of a task returned; nothing where they are to be done again."""
        future, parts = self._futures.pop(first)
        if future.status == "finished":
            try:
                results, seconds = future.result(timeout=60.0)
            except (Exception, CancelledError) as error:  # its worker was lost with it
                self._lose(parts, error)
                return
            self._adapt(results, seconds)
            yield from zip(parts, results, strict=True)
        elif future.status == "error":
            self._examine(parts, future.exception())
        else:
            self._lose(parts, None)

    def _adapt(self, results: Sequence[State], seconds: float) -> None:
        """Chooses how many parts the next tasks have: some tenths of a second of work, and not too many results."""
        size = sum(array.nbytes for array in results[-1].values())
        most = min(_SECONDS / max(seconds, 1e-9), _BYTES / max(size, 1))
        self._together = max(1, int(min(most, 2 * self._together)))

    def _examine(self, parts: tuple[int, ...], error: BaseException) -> None:
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

    def _lose(self, parts: tuple[int, ...], error: BaseException | None) -> None:
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

    def _submit_each(self, parts: tuple[int, ...]) -> None:
        """Submits parts in tasks of one, so that the one that fails is known."""
        for part in parts:
            self._submit((part,))


def stopped(error: Interrupted, done: int, parts: int, store: str) -> JobStopped:
    """The error for the user.

    Args:
        error: Why the cluster cannot go on.
        done: How many parts are done.
        parts: How many there are.
        store: Where they are.

    Returns:
        The error.
    """
    return JobStopped(str(error), done, parts, store)
