"""Changes of settings of the whole process that several threads need at overlapping times."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import final

from ulna.system.forks import lock


@final
class SharedContext:
    """Enters a context when the first of several users enters, and leaves it when the last one leaves.

    Contexts that store a setting of the process, and restore it, must not overlap: the one that ends last would restore
    what the other had set.

    Args:
        make: Makes the context.
    """

    def __init__(self, make: Callable[[], AbstractContextManager[object]]) -> None:
        self._make, self._lock, self._users = make, lock(), 0

    @contextmanager
    def __call__(self) -> Iterator[None]:
        """The context, for one user."""
        with self._lock:
            if self._users == 0:
                self._context = self._make()
                self._context.__enter__()
            self._users += 1
        try:
            yield
        finally:
            with self._lock:
                self._users -= 1
                if self._users == 0:
                    self._context.__exit__(None, None, None)
