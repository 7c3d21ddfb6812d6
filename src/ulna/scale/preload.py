"""What workers of a cluster of this machine do first: they leave Ctrl-C to the process that they work for."""

from __future__ import annotations

import signal
from typing import Any


def dask_setup(worker: Any) -> None:
    """Called by Dask in a worker process. A terminal sends Ctrl-C to all processes; the first of them ends the others.

    Args:
        worker: The worker.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
