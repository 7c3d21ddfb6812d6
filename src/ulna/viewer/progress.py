"""Long work says how far it is: a line in the terminal after a moment, and whoever else wants to know."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Report = Callable[[int, int], None]
"""Told how much of how much is done."""

_PATIENCE = 0.7  # s


def silent(done: int, of: int) -> None:
    """Tells nobody."""


@contextmanager
def progress(what: str, *others: Report) -> Iterator[Report]:
    """A report that shows `what` and a count in the terminal, where there is one, once the work takes a while.

    Args:
        what: What is being done: "Loading meshes".
        others: Told as well.
    """
    began, shown = time.monotonic(), False
    terminal = sys.stderr is not None and sys.stderr.isatty()

    def report(done: int, of: int) -> None:
        nonlocal shown
        for other in others:
            other(done, of)
        if terminal and (shown or time.monotonic() - began > _PATIENCE):
            shown = True
            print(f"\r{what}: {done} of {of} ", end="", file=sys.stderr, flush=True)

    try:
        yield report
    finally:
        if shown:
            print(f"\r{' ' * (len(what) + 24)}\r", end="", file=sys.stderr, flush=True)
