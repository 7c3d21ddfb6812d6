"""The progress of a job: written to standard error, or passed to a function."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import final

from ulna.checks.values import flag

_EVERY = {True: 0.2, False: 10.0}  # s between two lines, on a terminal and elsewhere


@final
@dataclass(frozen=True)
class Progress:
    """The progress of a job.

    Attributes:
        done: How many parts are done.
        parts: How many there are.
        seconds: How long this run has taken [s].
        here: How many parts this run has done; the others were in the store.
    """

    done: int
    parts: int
    seconds: float
    here: int

    @property
    def remaining(self) -> float:
        """How long the rest will take at this speed [s]; inf before the first part is done."""
        return (self.parts - self.done) * self.seconds / self.here if self.here else float("inf")

    def __str__(self) -> str:
        text = f"{self.done} of {self.parts} parts, {100 * self.done // max(self.parts, 1)} %"
        return text if not self.here else f"{text}, {_duration(self.remaining)} left"


Reporter = Callable[[Progress], object]


def reporter(progress: bool | Reporter, name: str) -> Reporter:
    """The function that receives the progress of a job.

    Args:
        progress: True for lines on standard error, False for none, or a function of a `Progress`.
        name: The name of the job.

    Returns:
        A function of a `Progress`.

    Raises:
        InputError: `progress` is neither a truth value nor a function.
    """
    if callable(progress):
        return progress
    return _Lines(name) if flag("progress", progress) and sys.stderr is not None else lambda _: None


class _Lines:
    """Writes to standard error: one line that changes on a terminal, else a line now and then."""

    def __init__(self, name: str) -> None:
        self._name, self._last, self._is_terminal = name, -math.inf, sys.stderr.isatty()

    def __call__(self, progress: Progress) -> None:
        now, is_last = time.monotonic(), progress.done == progress.parts
        if not is_last and now - self._last < _EVERY[self._is_terminal]:
            return
        self._last = now
        clear = "\x1b[K"  # the rest of a longer line before
        start, end = ("\r", f"{clear}\n" if is_last else clear) if self._is_terminal else ("", "\n")
        print(f"{start}{self._name}: {progress}", end=end, file=sys.stderr, flush=True)


def _duration(seconds: float) -> str:
    if seconds < 100.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000.0 else f"{seconds / 3600:.1f} h"
