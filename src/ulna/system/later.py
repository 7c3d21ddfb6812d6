"""Runs work in another thread a moment later, when what somebody waits for now is done."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any

_PAUSE = 0.1
"""How long it waits [s]: LLVM compiles the kernel of a first call meanwhile, and one module at a time."""


def run_later(name: str, work: Callable[..., Any], *arguments: Any) -> None:
    """Starts a thread that waits for a moment and then works; where no thread can be started, nothing happens.

    Args:
        name: The name of the thread. It does not keep the process from ending.
        work: What is called.
        *arguments: With what.
    """
    thread = threading.Timer(_PAUSE, work, arguments)
    thread.name, thread.daemon = name, True
    with suppress(RuntimeError):
        thread.start()
