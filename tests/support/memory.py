"""Whether work that is done again and again keeps memory."""

from __future__ import annotations

import gc
import os
from collections.abc import Callable
from pathlib import Path

import pytest

_STATUS = Path("/proc/self/statm")


def least_growth(work: Callable[[], object], limit: float, attempts: int = 6) -> float:
    """The least by which the memory of this process grows while some work is done, in several attempts.

    What leaks, leaks each time; what other threads take meanwhile, or a huge page at once, is not there each time.

    Args:
        work: What is done.
        limit: Growth below which no further attempt is made [byte].
        attempts: How often it is done at most.

    Returns:
        The growth [byte]. The test is skipped where the system does not say.
    """
    least = float("inf")
    for _ in range(attempts):
        before = resident()
        work()
        least = min(least, resident() - before)
        if least < limit:
            break
    return least


def resident() -> int:
    """Memory of this process [byte]."""
    if not _STATUS.exists():
        pytest.skip("no /proc here")
    gc.collect()
    return int(_STATUS.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
