"""What is known of tabs before they are connected: a browser was started, a page was asked for."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, final

_LONGEST_LOADING = 30.0  # s from the request for the page until its tab is connected


@final
class Visits:
    """Times at which a browser was last started, asked for the page, and opened its socket.

    Args:
        now: Returns the time [s].
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self.now = now
        self.opened_at: float | None = None
        self.requested_at: float | None = None
        self.connected_at: float | None = None

    def note_opened(self) -> None:
        """A browser was started with the address of the page."""
        self.opened_at = self.now()

    def note_request(self, request: Any) -> None:
        """A client asks for the page or opens its socket; other requests do not count."""
        if request.headers.get("Upgrade"):
            self.connected_at = self.now()
        elif request.path.partition("?")[0] == "/" and "gzip" in request.headers.get("Accept-Encoding", ""):
            self.requested_at = self.now()

    def is_loading(self) -> bool:
        """Whether a tab is about to open its socket: it asked for the page, or its browser has just been started."""
        seen = [t for t in (self.requested_at, self.connected_at) if t is not None]
        if self.opened_at is not None and self.opened_at > max(seen, default=-1.0):
            return True
        return (
            self.requested_at is not None
            and self.requested_at > (-1.0 if self.connected_at is None else self.connected_at)
            and self.now() - self.requested_at < _LONGEST_LOADING
        )
