"""Progress of long tasks, reported after a short delay in the terminal, in notebooks and in open pages."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, final

from ulna.system import forks

Report = Callable[[int, int], None]
"""Called with how many steps are done, and of how many."""

Watcher = Callable[[str, str], None]
"""Called with the name of a task and its progress; the progress is empty when the task is finished."""

_DELAY = 0.7  # s
_INTERVAL = 0.1  # s between two messages about one task

_watchers: list[Watcher] = []


def watch(watcher: Watcher) -> None:
    """Call a watcher with the progress of long tasks of this process from now on."""
    _watchers.append(watcher)


def unwatch(watcher: Watcher) -> None:
    """Do not call a watcher any more."""
    if watcher in _watchers:
        _watchers.remove(watcher)


def silent(done: int, of: int) -> None:
    """Reports nothing.

    Args:
        done: Number of parts that are done.
        of: Number of all parts.
    """


@contextmanager
def progress(what: str) -> Iterator[Report]:
    """A report function for a task; reports are shown once the task takes longer than a short delay.

    Args:
        what: What is being done: "Loading meshes".
    """
    work = _Task(what)
    try:
        yield work.report
    finally:
        work.finish()


@final
class _Task:
    def __init__(self, what: str) -> None:
        self._what, self._count = what, ""
        self._shown = self._finished = False
        self._output: Any = None  # the line below a notebook's cell
        self._reported_at = 0.0
        self._lock, self._output_lock = forks.lock(), forks.lock()
        self._report_pending = True  # whether a word is on its way
        self._timer = self._start_timer(_DELAY)

    def report(self, done: int, of: int) -> None:
        with self._lock:
            self._count = f"{done} of {of}" if of > 1 else ""
            if self._report_pending or self._finished:
                return
            self._report_pending, wait = True, self._reported_at + _INTERVAL - time.monotonic()
            if wait > 0.0:
                self._timer = self._start_timer(wait)
                return
        self._report_now()

    def finish(self) -> None:
        with self._lock:
            self._finished = True
            self._timer.cancel()
        self._timer.join()
        with self._output_lock:
            if not self._shown:
                return
            if self._output is not None:
                self._output.update({"text/plain": ""}, raw=True)
            elif _terminal():
                print(f"\r{' ' * (len(self._what) + 24)}\r", end="", file=sys.stderr, flush=True)
            for watcher in tuple(_watchers):
                watcher(self._what, "")

    def _start_timer(self, seconds: float) -> threading.Timer:
        timer = threading.Timer(seconds, self._report_now)
        timer.daemon = True
        timer.start()
        return timer

    def _display(self, text: str) -> None:
        """Shows the text below the cell, in an output of its own: what is printed would stay in the saved notebook."""
        from IPython.display import display  # pyright: ignore[reportMissingImports]

        if self._output is None:
            self._output = display({"text/plain": text}, raw=True, display_id=True)
        else:
            self._output.update({"text/plain": text}, raw=True)

    def _report_now(self) -> None:
        with self._output_lock:
            with self._lock:
                if self._finished:
                    return
                self._report_pending, self._shown = False, True
                self._reported_at, count = time.monotonic(), self._count or "..."
            if _notebook():
                self._display(f"{self._what}: {count}")
            elif _terminal():
                print(f"\r{self._what}: {count} ", end="", file=sys.stderr, flush=True)
            for watcher in tuple(_watchers):
                watcher(self._what, count)


def _terminal() -> bool:
    """Whether what is printed on the error stream is seen as it comes."""
    return not _quiet() and sys.stderr is not None and sys.stderr.isatty()


def _notebook() -> bool:
    """Whether the task runs in a cell of a notebook."""
    return not _quiet() and type(sys.stderr).__module__.startswith("ipykernel")


def _quiet() -> bool:
    return os.environ.get("ULNA_QUIET", "0") not in ("", "0")
