"""Parts of a job on a cluster: some of them under way at any time, repeated when their worker is lost."""

from __future__ import annotations

import errno
import queue
import time
from asyncio import CancelledError
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any, final

from ulna.errors import JobStopped, UlnaError
from ulna.lazy import Portable
from ulna.scale.job import State

_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EACCES, errno.EPERM}
_ATTEMPTS = 3  # of a part whose work raises an error that is not Ulna's
_COUNT = 3.0  # s between two questions how many workers there are
_TICK = 0.25  # s between looks at the connection


def is_storage_error(error: BaseException) -> bool:
    """Whether an error says that nothing can be written: a full disk, a limit, missing rights."""
    return isinstance(error, OSError) and error.errno in _FULL


class Interrupted(Exception):
    """The cluster cannot go on; says why."""


@final
class Tasks:
    """Does parts of a job on a cluster.

    Args:
        client: The client of the scheduler.
        task: `task(part)` does one part.
        parts: The numbers of the parts, in order.
        retries: How often a part may lose its worker.
        patience: How long to wait for a lost scheduler to come back [s].
    """

    def __init__(
        self, client: Any, task: Portable, parts: Sequence[int], retries: int, patience: float
    ) -> None:
        self._client, self._task, self._parts = client, task, parts
        self._retries, self._patience = retries, patience
        self._futures: dict[int, Any] = {}
        self._failures: dict[int, int] = {}
        self._losses: dict[int, int] = {}
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
                for part in self._ended_parts():
                    future = self._futures.get(part)
                    if future is not None and future.done():
                        result = self._result(part, future)
                        if result is not None:
                            yield part, result
        finally:
            for future in self._futures.values():
                with suppress(Exception, CancelledError):
                    future.cancel()

    def _submitted(self, following: int) -> int:
        """Submits parts while there is room; returns the place of the next one."""
        room = 2 * self._threads() + 2 if self._is_connected() else 0
        first = min(self._futures, default=None)
        while following < len(self._parts) and len(self._futures) < room:
            part = self._parts[following]
            if first is not None and part - first > 2 * room:
                break  # the first is late: what waits for it must not fill the memory
            self._submit(part)
            first = part if first is None else first
            following += 1
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

    def _submit(self, part: int) -> None:
        key = f"ulna-part-{part}-{self._task.digest[:8]}-{id(self)}-{self._attempt(part)}"
        future = self._client.submit(self._task, part, key=key, pure=False)
        self._futures[part] = future
        future.add_done_callback(lambda _: self._ended.put(part))

    def _attempt(self, part: int) -> int:
        return self._failures.get(part, 0) + self._losses.get(part, 0)

    def _ended_parts(self) -> set[int]:
        """Parts that have ended since the last look; all under way where the connection was lost meanwhile."""
        ended = set()
        with suppress(queue.Empty):
            ended.add(self._ended.get(timeout=_TICK))
            while True:
                ended.add(self._ended.get_nowait())
        if not ended and self._is_connected():
            ended = {part for part, future in self._futures.items() if future.done()}
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

    def _result(self, part: int, future: Any) -> State | None:
        """What a part returned; None where it is to be done again."""
        del self._futures[part]
        if future.status == "finished":
            try:
                return future.result(timeout=60.0)
            except (Exception, CancelledError) as error:  # its worker was lost with it
                self._lose(part, error)
                return None
        if future.status == "error":
            self._examine(part, future.exception())
        else:
            self._lose(part, None)
        return None

    def _examine(self, part: int, error: BaseException) -> None:
        """Decides what an error of a part means: the end, or another attempt."""
        from distributed import KilledWorker  # pyright: ignore[reportMissingImports]

        if isinstance(error, UlnaError):
            raise error
        if is_storage_error(error):
            raise Interrupted(f"A worker cannot write: {error}.") from error
        if isinstance(error, KilledWorker):
            self._lose(part, error)
            return
        self._failures[part] = self._failures.get(part, 0) + 1
        if self._failures[part] >= _ATTEMPTS:
            raise Interrupted(
                f"Part {part} failed {_ATTEMPTS} times: {type(error).__name__}: {error}."
            ) from error
        self._submit(part)

    def _lose(self, part: int, error: BaseException | None) -> None:
        """Does a part again whose worker was lost."""
        while not self._is_connected():
            time.sleep(_TICK)
        self._losses[part] = self._losses.get(part, 0) + 1
        if self._losses[part] > self._retries:
            raise Interrupted(
                f"Part {part} lost its worker {self._losses[part]} times; workers may lack memory ({error!r})."
            )
        self._submit(part)


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
