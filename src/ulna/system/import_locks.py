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
    """A lock: while a thread holds it, no other thread starts, continues or ends an import."""

    def __init__(self) -> None:
        self._held: list[Any] = []
        self._abandoned: weakref.WeakSet[Any] = weakref.WeakSet()

    def acquire(self, timeout: float) -> bool:
        """Acquires it when no other thread imports a module; returns False if some thread did for `timeout` [s]."""
        end = time.monotonic() + timeout
        while not self._try_acquire():
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
        self._abandoned.update(module_lock for module_lock in _module_locks() if self._is_busy(module_lock))

    def renew(self) -> None:
        """Frees the locks of abandoned modules in a forked child; such a module stays half imported there."""
        table: Any = getattr(_bootstrap, "_module_locks", {})
        for name, reference in list(table.items()):
            if reference() in self._abandoned and self._is_busy(reference()):
                del table[name]

    def _try_acquire(self) -> bool:
        _imp.acquire_lock()  # with it, no thread gets the lock of a module that it does not have yet
        try:
            free = all(
                self._take(module_lock)
                for module_lock in _module_locks()
                if module_lock not in self._abandoned
            )
        except BaseException:  # such as KeyboardInterrupt
            self.release()
            raise
        if not free:
            self.release()
        return free

    def _take(self, module_lock: Any) -> bool:
        """Keeps other threads from taking the lock of a module; returns False if one has it."""
        if not module_lock.lock.acquire(timeout=_POLL):
            return False
        self._held.append(module_lock.lock)
        return not self._is_busy(module_lock)

    @staticmethod
    def _is_busy(module_lock: Any) -> bool:
        return module_lock.owner not in (None, get_ident())


def _module_locks() -> list[Any]:
    """The locks of the modules that are being imported; none where Python keeps them elsewhere."""
    table: Any = getattr(_bootstrap, "_module_locks", {})
    locks = [reference() for reference in list(table.values())]
    return [
        module_lock
        for module_lock in locks
        if module_lock is not None and hasattr(module_lock, "owner") and hasattr(module_lock, "lock")
    ]
