"""Threads that compute rows of batches: they wait in machine code, without the interpreter's lock, for the next batch.

A helper without a batch sleeps, ends after some seconds, and does not keep the process from ending. One that the system
does not run at once costs nothing: the calling thread computes what nobody has begun.
"""

from __future__ import annotations

import ctypes
import threading
from array import array
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any, final

from ulna.compiler.codegen.shared_batch import BOX, ENDED, SHARE_IR
from ulna.compiler.runtime import jit
from ulna.compiler.runtime.object_layout import c_function
from ulna.system import forks

IDLE = 10.0
"""How long a helper without a batch is kept [s]."""


@cache
def code() -> jit.Code:
    """The machine code of helpers and of who calls them."""
    return jit.load_text(SHARE_IR, ("help", "run"), has_loops=False)


@final
class Helper:
    """A thread and its box, which belongs to one caller at a time.

    Attributes:
        box: The words that machine code reads (see `codegen.shared_batch.BOX`).
        address: Where they lie.
        thread: The thread.
    """

    def __init__(self) -> None:
        make, self._free = ctypes.pythonapi.PyThread_allocate_lock, ctypes.pythonapi.PyThread_free_lock
        make.restype, self._free.argtypes = ctypes.c_void_p, [ctypes.c_void_p]
        acquire = ctypes.pythonapi.PyThread_acquire_lock
        acquire.argtypes = [ctypes.c_void_p, ctypes.c_int]
        self._locks = [make(), make()]
        for lock in self._locks:
            if not lock:
                raise MemoryError("CPython could not make a lock for a helper thread.")
            acquire(lock, 1)
        words = dict(zip(("wake", "done"), self._locks, strict=True)) | {
            "acquire": c_function("PyThread_acquire_lock_timed"),
            "release": c_function("PyThread_release_lock"),
            "idle": int(IDLE * 1e6),
        }
        self.box = array("q", [words.get(name, 0) for name in BOX])
        self.address = self.box.buffer_info()[0]
        self.thread = threading.Thread(target=self._run, name="ulna helper", daemon=True)

    @property
    def has_ended(self) -> bool:
        """Whether it takes no batch any more."""
        return self.box[0] == ENDED

    def _run(self) -> None:
        help_with = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(code().address("help"))
        help_with(self.address)
        with suppress(ValueError):  # a caller has it, which finds that it has ended
            helpers.idle.remove(self)
        self.free_locks()

    def free_locks(self) -> None:
        """Frees the locks, which nobody takes any more."""
        for lock in self._locks:
            self._free(lock)


@final
class Helpers:
    """The helpers of a process.

    Attributes:
        idle: Those that no caller has; the last one slept least.
    """

    def __init__(self) -> None:
        self.idle: list[Helper] = []
        self._generation = object()
        forks.in_child(self._forget)

    def _forget(self) -> None:
        """In a forked child: the threads are the parent's."""
        self.idle = []
        self._generation = object()

    def compute(self, count: int, run: Callable[[int, int], Any]) -> Any:
        """Calls machine code that posts a batch to the boxes of helpers, and returns when they are done with it.

        Args:
            count: How many helpers it may have; there are fewer where no more threads can be started.
            run: What is called with the address of the boxes' addresses and their number.

        Returns:
            What `run` returns.
        """
        generation, taken = self._generation, self._take(count)
        boxes = array("q", [helper.address for helper in taken])
        try:
            return run(boxes.buffer_info()[0], len(taken))
        finally:
            if generation is self._generation:  # else their threads are those of the parent
                self.idle.extend([helper for helper in taken if not helper.has_ended])

    def _take(self, count: int) -> list[Helper]:
        taken: list[Helper] = []
        while len(taken) < count:
            try:
                helper = self.idle.pop()
            except IndexError:
                helper = Helper()
                try:
                    helper.thread.start()
                except RuntimeError:  # no more threads can be started, or the process ends
                    helper.free_locks()
                    break
            if not helper.has_ended:
                taken.append(helper)
        return taken


helpers = Helpers()
