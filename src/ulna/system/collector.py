"""Pauses Python's collector of cyclic garbage while much is made that stays.

Modules, tables and machine code live as long as the process. While many of them are made, the collector looks through
all objects of the process again and again, finds nothing, and takes a fifth of the time of a first plan.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import final

from ulna.system import forks


@final
class _Pauses:
    """How many pauses are under way, in all threads."""

    def __init__(self) -> None:
        self.count, self.lock, self.is_ours = 0, forks.lock(forks.LIBRARY), False

    def begin(self) -> None:
        """Stops the collector, unless it is stopped."""
        with self.lock:
            if not self.count:
                self.is_ours = gc.isenabled()
                gc.disable()
            self.count += 1

    def end(self) -> None:
        """Lets the collector go on after the last pause, if it was on before the first."""
        with self.lock:
            self.count = max(self.count - 1, 0)
            if not self.count and self.is_ours:
                self.is_ours = False
                gc.enable()

    def forget(self) -> None:
        """Ends the pauses of threads that do not exist in this forked child."""
        self.count = 0
        self.end()


_pauses = _Pauses()
forks.in_child(_pauses.forget)


@contextmanager
def paused_collection() -> Iterator[None]:
    """Within, nothing is collected, unless somebody else starts the collector.

    Yields:
        Nothing.
    """
    _pauses.begin()
    try:
        yield
    finally:
        _pauses.end()
