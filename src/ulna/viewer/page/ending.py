"""The end of a program: its tabs get all that they need to show the scene and play its motion without it."""

from __future__ import annotations

import sys
import time
from typing import Any

from ulna.viewer.page.server import has_delivered, is_connected, visits_of

_DELIVERY_TIME = 10.0  # s that connected tabs have to take what is left
_LOADING_TIME = 15.0  # s that a tab which is loading has, at the end of the program
_QUIET_TIME = 0.5  # s of loading after which a message says what is waited for
_QUIET_DELIVERY_TIME = 2.0  # s of delivery after which a message says so


def has_tabs(server: Any, at_exit: bool) -> bool:
    """Whether any tab is connected, or, at the end of the program, is about to be.

    Args:
        server: The viser server.
        at_exit: Whether the program ends.

    Returns:
        Whether there is one.
    """
    return is_connected(server) or (at_exit and visits_of(server).is_loading())


def wait_for_tabs(server: Any, at_exit: bool) -> None:
    """Wait until connected tabs have everything, at the end of the program also for tabs that are loading.

    It waits at most 10 s for connected tabs and 15 s for those that are loading; Ctrl-C ends it.

    Args:
        server: The viser server.
        at_exit: Whether the program ends.
    """
    began, printed = time.monotonic(), False
    visits = visits_of(server)
    try:
        while (passed := time.monotonic() - began) < _LOADING_TIME:
            loading = at_exit and visits.is_loading()
            if not loading and (not is_connected(server) or has_delivered(server) or passed > _DELIVERY_TIME):
                return
            if not printed and passed > (_QUIET_TIME if loading else _QUIET_DELIVERY_TIME):
                printed = True
                state, limit = ("loading", _LOADING_TIME) if loading else ("receiving", _DELIVERY_TIME)
                print(
                    f"The page is still {state}; it gets {limit:.0f} s at most, to show the motion by itself then. "
                    "Ctrl-C ends this.",
                    file=sys.stderr,
                    flush=True,
                )
            time.sleep(0.02)
    except KeyboardInterrupt:
        print("", file=sys.stderr)
