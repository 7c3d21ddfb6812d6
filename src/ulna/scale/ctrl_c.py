"""Ctrl-C that waits until processes have started, which do not see it."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

from ulna.system import ctrl_c


@contextmanager
def later() -> Iterator[None]:
    """Ctrl-C within the block is raised at its end.

    Threads that start within it, and processes that these start, never see Ctrl-C, where the system can block signals
    of a thread. Dask cannot close a cluster that has half started, and workers would write where they were.

    Raises:
        KeyboardInterrupt: If Ctrl-C came.
    """
    with ctrl_c.later() as is_postponed:
        if not is_postponed or not hasattr(signal, "pthread_sigmask"):
            yield  # whoever has other plans for Ctrl-C keeps them
            return
        from multiprocessing import resource_tracker

        resource_tracker.ensure_running()  # the thread that starts it would have Ctrl-C no longer blocked
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
