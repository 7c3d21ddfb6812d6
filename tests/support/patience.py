"""Waits for what happens in another thread, process or browser."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

LONGEST_WAIT = 300.0
"""How long a condition is waited for [s]: only a test that fails waits so long, so that a busy machine fails none."""


def patient(pause: float = 0.05) -> Callable[..., Any]:
    """A `wait(condition, patience=LONGEST_WAIT)`: returns what the condition returns once that is true, or its last result.

    Args:
        pause: Between two questions [s].
    """

    def wait(condition: Callable[[], Any], patience: float = LONGEST_WAIT) -> Any:
        due, found = time.monotonic() + patience, None
        while not found and time.monotonic() < due:
            found = condition()
            if not found:
                time.sleep(pause)
        return found

    return wait
