"""Pauses Python's collector of cyclic garbage while much is made that stays.

Modules, tables and machine code live as long as the process. While many of them are made, the collector looks through
all objects of the process again and again, finds nothing, and takes a fifth of the time of a first plan.

A pause sets the threshold of the youngest generation to 0, which stops automatic collection, and `gc.isenabled()` stays
as it was: dask.array asks for that when it is imported, for good, and would leave the collector off after each slice.
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
        self.count, self.lock, self.threshold = 0, forks.lock(forks.LIBRARY), 0

    def begin(self) -> None:
        """Stops the collector, unless it is stopped."""
        with self.lock:
            if not self.count:
                self.threshold = gc.get_threshold()[0]
                gc.set_threshold(0)
            self.count += 1

    def end(self) -> None:
        """Lets the collector go on after the last pause, unless somebody else has set its threshold."""
        with self.lock:
            self.count = max(self.count - 1, 0)
            if not self.count and self.threshold and not gc.get_threshold()[0]:
                gc.set_threshold(self.threshold)
                self.threshold = 0

    def forget(self) -> None:
        """Ends the pauses of threads that do not exist in this forked child."""
        self.count = 0
        self.end()


_pauses = _Pauses()
forks.in_child(_pauses.forget)


@contextmanager
def paused_collection() -> Iterator[None]:
    """Within, nothing is collected, unless somebody asks for it or sets the collector's threshold.

    Yields:
        Nothing.
    """
    _pauses.begin()
    try:
        yield
    finally:
        _pauses.end()
