"""Ctrl-C that waits until processes have started, which do not see it."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def later() -> Iterator[None]:
    """Ctrl-C within the block is raised at its end.

    Threads that start within it, and processes that these start, never see Ctrl-C, where the system can block signals
    of a thread. Dask cannot close a cluster that has half started, and workers would write where they were.

    Raises:
        KeyboardInterrupt: If Ctrl-C came.
    """
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield  # whoever has other plans for Ctrl-C keeps them
        return
    came: list[Any] = []
    before = signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    can_block = hasattr(signal, "pthread_sigmask")
    if can_block:
        from multiprocessing import resource_tracker

        resource_tracker.ensure_running()  # the thread that starts it would have Ctrl-C no longer blocked
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT}) if can_block else set()
    try:
        yield
    finally:
        if can_block:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        signal.signal(signal.SIGINT, before)
        if came:
            raise KeyboardInterrupt
