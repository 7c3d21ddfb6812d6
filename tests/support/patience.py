"""Waits for what happens in another thread, process or browser."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any


def patient(seconds: float, pause: float = 0.05) -> Callable[..., Any]:
    """A `wait(condition, patience=seconds)`: what the condition gives as soon as that is something, or its last answer.

    Args:
        seconds: How long it waits unless told otherwise [s].
        pause: Between two questions [s].
    """

    def wait(condition: Callable[[], Any], patience: float = seconds) -> Any:
        due, found = time.monotonic() + patience, None
        while not found and time.monotonic() < due:
            found = condition()
            if not found:
                time.sleep(pause)
        return found

    return wait
