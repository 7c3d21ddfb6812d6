"""Keeping a page open while a tab shows it; returning at once where no tab can be opened."""

from __future__ import annotations

import os
import sys
import time

from ulna.viewer.page import Page
from ulna.viewer.page.browser import somebody_can_look


def keep_open(page: Page, seconds: float | None = None) -> None:
    """Keep a page open until Ctrl-C, until it is closed, or until the last tab that looked at it has gone.

    Without a display and without an interactive terminal it prints a message and returns at once.

    Args:
        page: The page.
        seconds: The longest it stays open [s]; without an end when not given.
    """
    if page.closed:
        return
    if page.clients == 0 and not somebody_can_look():
        print(f"There is no screen to show {page.url} on, so it is not held open.", flush=True)
        return
    print_address(page)
    was_visited, without_tabs = page.visited, 0.0
    end = None if seconds is None else time.monotonic() + seconds
    try:
        while not page.closed and (end is None or time.monotonic() < end):
            time.sleep(0.1)
            if page.clients:
                was_visited, without_tabs = True, 0.0
            elif was_visited:
                without_tabs += 0.1
                if without_tabs > 3.0:  # longer than a reload takes
                    print("The page was closed.", flush=True)
                    return
    except KeyboardInterrupt:
        print("", file=sys.stderr)
    finally:
        page.close()


def print_address(page: Page) -> None:
    """Print the address of a page, and how it is seen from elsewhere."""
    print(f"Look at {page.url} (Ctrl-C ends it)", flush=True)
    if "SSH_CONNECTION" in os.environ:
        print(
            f"From elsewhere: ssh -L {page.port}:localhost:{page.port} ... and open the same address there.",
            flush=True,
        )
