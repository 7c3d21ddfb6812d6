"""Parts of a computation in threads that are kept for the next one: starting a thread takes longer than many a batch.

A thread takes the next part when it has done one, so that none waits for a slower one, and threads that the system
does not run at once cost nothing: the calling thread computes what nobody has begun. Helpers without work sleep, end
after some seconds, and do not keep the process from ending.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from contextlib import suppress
from contextvars import Context, copy_context
from queue import Empty, SimpleQueue
from typing import TypeVar, final

from ulna.system import forks

T = TypeVar("T")

IDLE = 10.0
"""How long a helper without work is kept [s]."""


def cuts(count: int, threads: int, least: int) -> list[int]:
    """Where to cut `count` items: large parts first and small ones last, so that threads end at about the same time.

    Args:
        count: How many items there are.
        threads: How many threads compute them.
        least: How many items a part has at least; all parts but the last have a multiple of it.

    Returns:
        Where parts begin, and where the last one ends: from 0 to `count`.
    """
    ends = [0]
    while (left := count - ends[-1]) >= 2 * least:
        ends.append(ends[-1] + max(1, left // (2 * threads * least)) * least)
    return [*ends, count]


def in_threads(prepare: Callable[[int], Callable[[], object]], count: int, threads: int) -> bool:
    """Calls what `prepare` returns for 0, 1, ..., in the calling thread and in helpers, until all calls have ended.

    After an exception, Ctrl-C included, no further call begins, and it is raised once those under way have ended, so
    that nothing goes on writing to the caller's arrays.

    Args:
        prepare: Makes the call of a number, in the caller's context (`contextvars`) or a copy of it. Calls should let
            go of the interpreter's lock.
        count: How many calls there are.
        threads: How many threads share them at most.

    Returns:
        Whether all was done; False in a child that was forked meanwhile, and lacks what the helpers of its parent did.
    """
    parts = _Parts(prepare, count)
    try:
        parts.compute_all(lambda: parts.call_helpers(threads - 1))
    finally:
        parts.finish()
    parts.raise_error()
    return not parts.are_forked


def results_in_threads(call: Callable[[int], T], count: int, threads: int) -> list[T]:
    """What a function returns for 0, 1, ..., computed in the calling thread and in helpers (see `in_threads`).

    Args:
        call: The function; its calls should let go of the interpreter's lock.
        count: How many calls there are.
        threads: How many threads share them at most.

    Returns:
        The results in order.
    """
    results: dict[int, T] = {}

    def prepare(k: int) -> Callable[[], object]:
        return lambda: results.__setitem__(k, call(k))

    while not in_threads(prepare, count, threads):
        pass  # a child that was forked meanwhile begins again
    return [results[k] for k in range(count)]


_lock = forks.lock(forks.LIBRARY)


@final
class _Parts:
    """Calls that threads share."""

    def __init__(self, prepare: Callable[[int], Callable[[], object]], count: int) -> None:
        self._prepare, self._count, self._next = prepare, count, 0
        self._helping = 0  # how many helpers may be computing a part
        self._ended: SimpleQueue[None] = SimpleQueue()  # has an item for each helper that ended
        self._errors: list[BaseException] = []
        self._process = os.getpid()

    @property
    def are_forked(self) -> bool:
        """Whether this process is a child of the one that began."""
        return os.getpid() != self._process

    def compute_all(self, before: Callable[[], object] | None = None) -> None:
        """Computes parts until none is left; `before` is called before the first one, when that is prepared."""
        while (number := self._take()) is not None:
            call = self._prepare(number)
            if before is not None:
                before, _ = None, before()
            call()

    def call_helpers(self, threads: int) -> None:
        """Has other threads compute parts."""
        for _ in range(min(threads, self._count - 1)):
            if not _helpers.send(self):
                break

    def _take(self) -> int | None:
        with _lock:
            if self._next >= self._count:
                return None
            self._next += 1
            return self._next - 1

    def help(self) -> None:
        """Computes parts in a helper until none is left."""
        with _lock:
            self._helping += 1
        try:
            self.compute_all()
        except BaseException as error:
            with _lock:
                self._errors.append(error)
                self._next = self._count
        finally:
            with _lock:
                self._helping -= 1
            self._ended.put(None)

    def finish(self) -> None:
        """Begins no further part, and waits for those under way, also after Ctrl-C."""
        interrupted: list[BaseException] = []
        while True:
            try:
                with _lock:
                    self._next = self._count
                    helping = self._helping
                if not helping or self.are_forked:
                    break
                with suppress(Empty):
                    self._ended.get(timeout=0.5)  # a child that forks while it waits would wait for ever
            except BaseException as error:
                interrupted.append(error)
        if interrupted:
            raise interrupted.pop()

    def raise_error(self) -> None:
        """Raises what went wrong in helpers."""
        if self._errors:
            raise self._errors.pop()  # without a reference to it here its frames would be kept by themselves


@final
class _Helpers:
    """Threads that wait for work."""

    def __init__(self) -> None:
        self._idle: list[
            SimpleQueue[tuple[Context, _Parts]]
        ] = []  # where each gets its work; the last one slept least
        forks.in_child(self._forget)

    def _forget(self) -> None:
        """In a forked child: the threads are the parent's."""
        self._idle = []

    def send(self, parts: _Parts) -> bool:
        """Has another thread compute parts if it comes in time; False where none can be started."""
        work = copy_context(), parts
        try:
            self._idle.pop().put(work)
            return True
        except IndexError:
            mailbox: SimpleQueue[tuple[Context, _Parts]] = SimpleQueue()
            mailbox.put(work)
        try:
            threading.Thread(target=self._run, args=(mailbox,), name="ulna helper", daemon=True).start()
            return True
        except RuntimeError:  # no more threads can be started, or the process ends
            return False

    def _run(self, mailbox: SimpleQueue[tuple[Context, _Parts]]) -> None:
        while True:
            try:
                context, parts = mailbox.get(timeout=IDLE)
            except Empty:
                with suppress(ValueError):  # work is on its way: its sender computes it
                    self._idle.remove(mailbox)
                return
            context.run(parts.help)
            del context, parts  # what they hold can go
            self._idle.append(mailbox)


_helpers = _Helpers()
