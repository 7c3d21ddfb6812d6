"""Long work says how far it is once it takes a while: in the terminal, where there is one, and in open pages."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import final

from ulna.compiler.runtime import jit
from ulna.system import forks

Report = Callable[[int, int], None]
"""Told how much of how much is done."""

Watcher = Callable[[str, str], None]
"""Told what is being done and how far it is; nothing for how far once it is done."""

_PATIENCE = 0.7  # s
_CALM = 0.1  # s between two words about one work

_watchers: list[Watcher] = []


def watch(watcher: Watcher) -> None:
    """Have a watcher told of long work of this process from now on, compilations included."""
    _watchers.append(watcher)
    jit.watchers.append(watcher)


def unwatch(watcher: Watcher) -> None:
    """Tell a watcher no more."""
    for watchers in (_watchers, jit.watchers):
        if watcher in watchers:
            watchers.remove(watcher)


def silent(done: int, of: int) -> None:
    """Tells nobody."""


@contextmanager
def progress(what: str) -> Iterator[Report]:
    """A report that tells of `what` and a count once the work takes a while, and nothing any more when it is over.

    Args:
        what: What is being done: "Loading meshes".
    """
    work = _Work(what)
    try:
        yield work.report
    finally:
        work.finish()


@final
class _Work:
    def __init__(self, what: str) -> None:
        self._what, self._count = what, ""
        self._shown = self._over = False
        self._told_at = 0.0
        self._lock, self._speaking = forks.lock(), forks.lock()
        self._due = True  # whether a word is on its way
        self._timer = self._later(_PATIENCE)

    def report(self, done: int, of: int) -> None:
        with self._lock:
            self._count = f"{done} of {of}" if of > 1 else ""
            if self._due or self._over:
                return
            self._due, wait = True, self._told_at + _CALM - time.monotonic()
            if wait > 0.0:
                self._timer = self._later(wait)
                return
        self._tell()

    def finish(self) -> None:
        with self._lock:
            self._over = True
            self._timer.cancel()
        self._timer.join()
        with self._speaking:
            if not self._shown:
                return
            if _terminal():
                print(f"\r{' ' * (len(self._what) + 24)}\r", end="", file=sys.stderr, flush=True)
            for watcher in tuple(_watchers):
                watcher(self._what, "")

    def _later(self, seconds: float) -> threading.Timer:
        timer = threading.Timer(seconds, self._tell)
        timer.daemon = True
        timer.start()
        return timer

    def _tell(self) -> None:
        with self._speaking:
            with self._lock:
                if self._over:
                    return
                self._due, self._shown = False, True
                self._told_at, count = time.monotonic(), self._count or "..."
            if _terminal():
                print(f"\r{self._what}: {count} ", end="", file=sys.stderr, flush=True)
            for watcher in tuple(_watchers):
                watcher(self._what, count)


def _terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty()
