"""Several threads that call the same function at the same time."""

from __future__ import annotations

import threading
from collections.abc import Callable


def call_at_once(run: Callable[[], object], callers: int) -> None:
    """Calls a function in several threads, and raises what one of them raised.

    Args:
        run: The function.
        callers: How many threads call it.
    """
    errors: list[BaseException] = []

    def call() -> None:
        try:
            run()
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=call) for _ in range(callers)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if errors:
        raise errors[0]
