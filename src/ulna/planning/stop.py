"""What ends the searches of a thread early."""

from __future__ import annotations

import threading


class Stop(threading.local):
    """Of each thread: what ends its searches early when it is set, as Ctrl-C ends those of a batch."""

    event: threading.Event | None = None


STOP = Stop()
