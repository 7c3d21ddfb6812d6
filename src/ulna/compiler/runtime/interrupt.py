"""Long calls into native code that Ctrl-C ends at once: they run in another thread, which the main thread waits for."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from contextvars import copy_context
from typing import TypeVar

from ulna.system import process_end

T = TypeVar("T")


def interruptible(work: Callable[[], T]) -> T:
    """What `work` returns or raises; called in the main thread, KeyboardInterrupt leaves it at once.

    Python handles signals in the main thread, between its own instructions: while native code runs there, it waits. So
    `work` runs in a separate thread. After an interruption it goes on there and keeps its locks until it is done; its
    result is dropped. Where no thread can be started, it runs in the main one, and also when the process ends: the main
    thread holds the locks then.
    """
    if threading.current_thread() is not threading.main_thread() or process_end.has_begun():
        return work()
    done = threading.Event()
    result: list[T] = []
    errors: list[BaseException] = []

    def run() -> None:
        try:
            result.append(work())
        except BaseException as error:
            errors.append(error)
        finally:
            done.set()

    thread = threading.Thread(target=copy_context().run, args=(run,), name="ulna compiler", daemon=True)
    try:
        with suppress(RuntimeError):  # no more threads can be started, or the process ends
            thread.start()
        while thread.ident is not None and not done.wait(0.1):  # a signal before it does not end it
            pass
    except BaseException:
        _abandoned.append(thread)
        raise
    if thread.ident is None:
        return work()
    if errors:
        raise errors[0]
    return result[0]


_abandoned: list[threading.Thread] = []


def _end() -> None:
    """Lets the process end without tearing LLVM down under a thread that works in it.

    After a KeyboardInterrupt that nobody caught, the process ends by the signal, as Python would end it a little later;
    else it waits.
    """
    working = [thread for thread in _abandoned if thread.is_alive()]
    if working and getattr(sys, "last_type", None) is KeyboardInterrupt:
        for stream in (sys.stdout, sys.stderr):
            with suppress(AttributeError, OSError, ValueError):
                stream.flush()
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        signal.raise_signal(signal.SIGINT)
    for thread in working:
        thread.join()


process_end.call_at_end(_end)
