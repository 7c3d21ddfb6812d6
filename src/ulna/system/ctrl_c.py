"""Ctrl-C that waits until a block of code is done."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def later() -> Iterator[bool]:
    """Ctrl-C within the block is raised at its end.

    Yields:
        Whether it is: not in other threads than the main one, where it is never raised, and not where a program has a
        handler of its own.

    Raises:
        KeyboardInterrupt: If Ctrl-C came.
    """
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield False
        return
    came: list[Any] = []
    before = signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    try:
        yield True
    finally:
        signal.signal(signal.SIGINT, before)
        if came:
            raise KeyboardInterrupt
