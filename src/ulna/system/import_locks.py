"""Python's import system as one lock, which a fork can take while no other thread imports a module.

Python holds a lock for each module that is being imported. A forked child keeps such a lock locked if another thread
held it, and the module stays half imported: the child waits for ever when it imports the module. CPython frees only
the lock that guards the table of these locks (`importlib._bootstrap._module_locks`, Python 3.11 to 3.14).
"""

from __future__ import annotations

import _imp
import time
import weakref
from importlib import _bootstrap
from threading import get_ident
from typing import Any, final

_POLL = 0.002  # s between two looks at the locks of modules


@final
class ImportLock:
    """Held by a thread, no other thread starts, continues or ends an import."""

    def __init__(self) -> None:
        self._held: list[Any] = []
        self._abandoned: weakref.WeakSet[Any] = weakref.WeakSet()

    def acquire(self, timeout: float) -> bool:
        """Takes it when no other thread imports a module; returns False if some thread did for `timeout` [s]."""
        end = time.monotonic() + timeout
        while not self._try():
            if time.monotonic() >= end:
                return False
            time.sleep(_POLL)
        return True

    def release(self) -> None:
        """Lets the other threads import."""
        while self._held:
            self._held.pop().release()
        _imp.release_lock()

    def abandon(self) -> None:
        """From now on, the imports that run now are not waited for."""
        self._abandoned.update(one for one in _module_locks() if self._is_busy(one))

    def renew(self) -> None:
        """Frees the locks of abandoned modules in a forked child; such a module stays half imported there."""
        table: Any = getattr(_bootstrap, "_module_locks", {})
        for name, reference in list(table.items()):
            if reference() in self._abandoned and self._is_busy(reference()):
                del table[name]

    def _try(self) -> bool:
        _imp.acquire_lock()  # with it, no thread gets the lock of a module that it does not have yet
        try:
            free = all(self._stop(one) for one in _module_locks() if one not in self._abandoned)
        except BaseException:  # such as KeyboardInterrupt
            self.release()
            raise
        if not free:
            self.release()
        return free

    def _stop(self, one: Any) -> bool:
        """Keeps other threads from taking the lock of a module; returns False if one has it."""
        if not one.lock.acquire(timeout=_POLL):
            return False
        self._held.append(one.lock)
        return not self._is_busy(one)

    @staticmethod
    def _is_busy(one: Any) -> bool:
        return one.owner not in (None, get_ident())


def _module_locks() -> list[Any]:
    """The locks of the modules that are being imported; none where Python keeps them elsewhere."""
    table: Any = getattr(_bootstrap, "_module_locks", {})
    locks = [reference() for reference in list(table.values())]
    return [one for one in locks if one is not None and hasattr(one, "owner") and hasattr(one, "lock")]
