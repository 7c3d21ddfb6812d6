"""Notifications in the page that show the progress of long tasks."""

from __future__ import annotations

from typing import Any, final

from ulna.system import forks


@final
class ProgressNotifications:
    """A watcher that shows long work in every tab, in those that come later from the next word on.

    Args:
        server: The viser server.
    """

    def __init__(self, server: Any) -> None:
        self._server, self._lock = server, forks.lock()
        self._notifications: dict[str, dict[int, Any]] = {}  # by what is done and by tab

    def __call__(self, what: str, how_far: str) -> None:
        """Show what is being done and how far it is.

        Args:
            what: What is being done.
            how_far: How far it is; empty once it is done.
        """
        with self._lock:
            tabs, shown = self._server.get_clients(), self._notifications.setdefault(what, {})
            for number, tab in tabs.items() if how_far else ():
                if number in shown:
                    shown[number].body = how_far
                else:
                    shown[number] = tab.add_notification(what, how_far, loading=True, with_close_button=False)
            if not how_far:
                for number, notice in self._notifications.pop(what).items():
                    if number in tabs:
                        notice.remove()
