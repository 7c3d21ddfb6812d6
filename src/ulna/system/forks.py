"""Locks that are free in forked children.

A child of `os.fork` has one thread. A lock that another thread held stays locked in it for ever, and what that thread
was changing stays half changed; LLVM has such data, too. So every lock of Ulna is made here, and a fork waits until no
other thread holds one: a compilation that runs is finished first. Where there is no fork, these are plain locks.

Locks that may be held for as long as a user's function runs (those of the viewer, say) are waited for `LONGEST_WAIT`
seconds only. The child then gets a new lock in place of one that is still held.

A fork also waits until no other thread imports a module, since Python frees no lock of a module in the child
(`import_locks.py`): at most `IMPORT_WAIT` seconds. A module that takes longer stays half imported in the child, as
in a circular import. Later forks do not wait for it again.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
import weakref
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, final

from ulna.system.import_locks import ImportLock

OUTER, RECIPES, KERNEL, COMPILER, LIBRARY = range(5)
"""The order in which locks are taken: whoever holds one takes only those of a higher rank, or of the same twice."""

LONGEST_WAIT = 5.0
"""How long a fork waits for locks of rank OUTER [s]; it waits for the others as long as it takes."""

IMPORT_WAIT = 30.0
"""How long a fork waits for imports in other threads [s]."""

_SLICE = 0.05  # s for which a fork holds some locks while it waits for another


@final
@dataclass
class _Fork:
    """A fork under way: the locks that it holds, and those that it did not wait for."""

    held: list[Any] = field(default_factory=list)
    renewed: list[Any] = field(default_factory=list)
    waited: dict[int, float] = field(default_factory=dict)
    interrupted: bool = False


_locks: dict[int, tuple[int, weakref.ref[Any]]] = {}
_calls: dict[int, tuple[weakref.ref[Any], str]] = {}
_one_at_a_time = threading.RLock()
_forks: list[_Fork] = []
_imports = ImportLock()


def lock(rank: int = OUTER) -> threading.RLock:
    """A re-entrant lock that no other thread holds while the process forks."""
    made = threading.RLock()
    adopt(made, rank)
    return made


def adopt(foreign: Any, rank: int = LIBRARY) -> None:
    """Treats a lock of another library like one from `lock`.

    Args:
        foreign: The lock.
        rank: The order in which locks are taken before a fork; outer ones have the lower rank.
    """
    key = id(foreign)
    _locks[key] = rank, weakref.ref(foreign, lambda _: _locks.pop(key, None))


def in_child(method: Callable[[], None]) -> None:
    """Has a method called in forked children, while its object lives."""
    owner: Any = getattr(method, "__self__", None)
    if owner is None:
        raise TypeError(
            f"{method!r} is no bound method; expected a method of the object whose life it shares."
        )
    key = id(owner)
    # Not a WeakMethod: its own callback prints an error where it is called while the interpreter ends.
    _calls[key] = weakref.ref(owner, lambda _: _calls.pop(key, None)), method.__name__


def _before() -> None:
    _one_at_a_time.acquire()
    fork = _Fork()
    _forks.append(fork)
    while True:
        try:
            busy = _take(fork)
            if busy is None:
                return
            _wait(fork, *busy)
        except KeyboardInterrupt:  # a fork cannot be called off; Ctrl-C comes after it
            fork.interrupted = True
            _release(fork)


def _take(fork: _Fork) -> tuple[int, Any] | None:
    """Takes all locks, outer ones first; where another thread does not let go of one, none, and returns that one.

    Letting go of all makes a deadlock impossible even where some thread takes locks in another order.
    """
    known = list(_locks.values())
    ours = [(rank, one) for rank, one in ((rank, made()) for rank, made in known) if one is not None]
    for rank, one in [*sorted(ours, key=lambda pair: pair[0]), *_of_python()]:
        if any(one is renewed for renewed in fork.renewed):
            continue
        if not one.acquire(timeout=_SLICE):
            _release(fork)
            return rank, one
        fork.held.append(one)
    ids = {id(pair) for pair in known}
    if all(id(pair) in ids for pair in list(_locks.values())):
        return None
    _release(fork)  # there is one more by now
    return _take(fork)


def _of_python() -> list[tuple[int, Any]]:
    """The locks of Python that a fork takes, after those of Ulna.

    The module logging takes its lock after this, in a separate hook. A thread that has it may import, as
    `logging.config` does, and would then wait for the fork that waits for it: so it is taken before the imports stop.
    """
    logging = getattr(sys.modules.get("logging"), "_lock", None)
    return [*([(LIBRARY, logging)] if hasattr(logging, "_is_owned") else []), (LIBRARY, _imports)]


def _wait(fork: _Fork, rank: int, one: Any) -> None:
    """Waits for a lock that another thread holds, or gives it up."""
    began = time.monotonic()
    if one.acquire(timeout=1.0):
        one.release()
        return
    waited = fork.waited[id(one)] = fork.waited.get(id(one), 0.0) + time.monotonic() - began
    if one is _imports and waited > IMPORT_WAIT:
        _imports.abandon()
    elif rank == OUTER and waited > LONGEST_WAIT:
        fork.renewed.append(one)


def _release(fork: _Fork) -> None:
    while fork.held:
        with suppress(RuntimeError):  # in a child, logging may have made its lock anew already
            fork.held.pop().release()


def _after_in_parent() -> None:
    fork = _forks.pop()
    _release(fork)
    _one_at_a_time.release()
    if (
        fork.interrupted
    ):  # what this function raises would be ignored, so another thread sends the signal again
        main = threading.main_thread().ident
        timer = threading.Timer(0.01, signal.pthread_kill, (main, signal.SIGINT))
        timer.daemon = True
        timer.start()


def _after_in_child() -> None:
    fork = _forks.pop()
    _release(fork)
    for one in fork.renewed:
        renew(one)
    _imports.renew()
    _one_at_a_time.release()
    for owned, name in list(_calls.values()):
        owner = owned()
        if owner is not None:
            getattr(owner, name)()


def renew(one: Any) -> None:
    """Unlocks a lock whose thread does not exist in this forked child."""
    again = getattr(one, "_at_fork_reinit", None)  # what Python's own modules call for theirs
    if again is not None:
        again()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_before, after_in_parent=_after_in_parent, after_in_child=_after_in_child)
