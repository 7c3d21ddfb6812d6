"""What is known of tabs before they are connected: a browser was started, a page was asked for."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, final

_LOADING_TIMEOUT = 30.0  # s from the request for the page until its tab is connected


@final
class Visits:
    """Times at which a browser was last started, asked for the page, and was connected.

    Tabs that are left from an earlier program on the port connect without asking for the page: they are not those
    that a browser which was just started opens.

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
        """A browser asks for the page; other requests do not count."""
        is_page = request.path.partition("?")[0] == "/" and not request.headers.get("Upgrade")
        if is_page and "gzip" in request.headers.get("Accept-Encoding", ""):
            self.requested_at = self.now()

    def note_connected(self) -> None:
        """A tab is connected: it gets the scene from now on."""
        self.connected_at = self.now()

    def is_loading(self) -> bool:
        """Whether a tab is about to be connected: it asked for the page, or its browser has just been started."""
        requested, connected = self.requested_at, self.connected_at
        if self.opened_at is not None and (requested is None or requested < self.opened_at):
            return True
        if requested is None or self.now() - requested > _LOADING_TIMEOUT:
            return False
        return connected is None or connected < requested
