"""Kernels compiled ahead, in the background: processes beside this one fill the disk cache, and this one loads them.

LLVM compiles one function at a time in a process, and tracing holds the GIL; so parallel work needs processes. A worker
is another Python that reads a function and then names of kernels from its input, and answers each name on its output
once the code is in the cache. A thread of this process makes each kernel when its worker has answered, which takes
milliseconds. Whatever goes wrong in a worker (it cannot start, it is killed) costs time only: the thread compiles the
kernel itself.
"""

from __future__ import annotations

import atexit
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, final

from ulna import disk_cache
from ulna.system import forks

_running: weakref.WeakSet[Preparation] = weakref.WeakSet()
_WORKER = "from ulna.methods.background_compilation import work; work()"


@final
class Preparation:
    """Kernels on their way, as `robot.prepare` returns it; nobody needs to wait for them.

    Args:
        marks: What is prepared, by name: an entry of the disk cache that says that it was prepared before.
        make: Makes the kernel of a name in this process.
        task: A function of a name that makes it in another process, as `pickle` writes it.
        workers: How many processes compile at most; 0 for none, where this process does.
        must_succeed: Whether `wait` raises what went wrong.
    """

    def __init__(
        self,
        marks: Mapping[str, str],
        make: Callable[[str], Any],
        task: bytes,
        workers: int,
        must_succeed: bool,
    ) -> None:
        self.names = tuple(marks)
        self.errors: dict[str, Exception] = {}
        """What went wrong, by name."""
        self.seconds: dict[str, float] = {}
        """When each was there, after the start [s]."""
        self._marks, self._make, self._task, self._must_succeed = marks, make, task, must_succeed
        self._began, self._cancelled = time.perf_counter(), False
        self._condition = threading.Condition(forks.lock())
        self._waiting: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._compiled: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._processes: list[subprocess.Popen[bytes]] = []
        self._start(workers)

    @property
    def done(self) -> tuple[str, ...]:
        """The names of the kernels that are there, in the order in which they came."""
        return tuple(self.seconds)

    @property
    def pending(self) -> tuple[str, ...]:
        """The names of those that are not; none once all is done or cancelled."""
        if self._cancelled:
            return ()
        return tuple(name for name in self.names if name not in self.seconds and name not in self.errors)

    def wait(self, timeout: float | None = None) -> bool:
        """Waits until all kernels are there.

        Args:
            timeout: How long at most [s]; None for as long as it takes.

        Returns:
            Whether none is pending.

        Raises:
            UlnaError: What went wrong first, with kernels that were asked for by name.
        """
        limit = None if timeout is None else time.monotonic() + timeout
        while self.pending:
            left = 0.1 if limit is None else min(limit - time.monotonic(), 0.1)
            if left <= 0.0:
                return False
            with self._condition:
                self._condition.wait(left)  # in slices: a forked child has no thread that would notify
        if self._must_succeed:
            for error in self.errors.values():
                raise error
        return True

    def as_ready(self) -> Iterator[str]:
        """The names of the kernels as they come, until none is pending; those that failed are left out."""
        shown = 0
        while True:
            is_last = not self.pending
            for name in self.done[shown:]:
                shown += 1
                yield name
            if is_last:
                return
            with self._condition:
                self._condition.wait(0.1)

    def cancel(self) -> None:
        """Ends the processes that compile. What is not prepared is compiled when it is first used."""
        self._cancelled = True
        self._compiled.put("")  # the thread that waits for it ends
        for process in self._processes:
            process.kill()
        for process in self._processes:
            with suppress(subprocess.TimeoutExpired):
                process.wait(5.0)
        with self._condition:
            self._condition.notify_all()

    def __repr__(self) -> str:
        failed = f", {len(self.errors)} failed" if self.errors else ""
        return f"<preparation: {len(self.seconds)} of {len(self.names)} kernels{failed}>"

    def _start(self, workers: int) -> None:
        forks.in_child(self._detach_in_child)
        _running.add(self)
        parallel = workers > 0 and disk_cache.folder() is not None and bool(sys.executable)
        new = [name for name, mark in self._marks.items() if parallel and disk_cache.read(mark) is None]
        for name in self.names:
            (self._waiting if name in new else self._compiled).put(name)
        for _ in range(min(workers, len(new))):
            threading.Thread(target=self._compile_all, name="ulna prepare", daemon=True).start()
        threading.Thread(target=self._load_compiled, name="ulna prepare", daemon=True).start()

    def _compile_all(self) -> None:
        """Has one worker compile kernel after kernel; once it has ended, this process compiles the others."""
        process = None if self._cancelled else self._new_process()
        works = process is not None
        while not self._cancelled:
            try:
                name = self._waiting.get_nowait()
            except queue.Empty:
                break
            works = works and _is_compiled_by(process, name)
            self._compiled.put(name)
        if process is not None:
            with suppress(OSError):
                process.communicate()

    def _new_process(self) -> subprocess.Popen[bytes] | None:
        """A worker that has read its task; None where there can be none."""
        folder = str(Path(__file__).parents[2])
        path = os.pathsep.join([folder, *filter(None, [os.environ.get("PYTHONPATH")])])
        try:
            process = subprocess.Popen(
                [sys.executable, "-P", "-c", _WORKER],
                env={**os.environ, "PYTHONPATH": path, "ULNA_QUIET": "1"},
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            )  # fmt: skip
        except (OSError, ValueError):
            return None
        self._processes.append(process)
        assert process.stdin is not None
        try:
            process.stdin.write(self._task)
            process.stdin.flush()
        except OSError:  # it ended before it read its task
            process.kill()
            with suppress(OSError):
                process.communicate()
            return None
        if self._cancelled:
            process.kill()
        return process

    def _load_compiled(self) -> None:
        """Makes each kernel in this process, once a worker has compiled it."""
        for _ in self.names:
            name = self._compiled.get()
            if self._cancelled:
                return
            try:
                self._make(name)
                disk_cache.write(self._marks[name], b"")  # before who waits goes on, and prepares it again
                self.seconds[name] = time.perf_counter() - self._began
            except Exception as error:  # raised where somebody waits
                self.errors[name] = error
            with self._condition:
                self._condition.notify_all()

    def _detach_in_child(self) -> None:
        """In a forked child: threads and processes are the parent's."""
        self._processes.clear()
        self._cancelled = True


def _is_compiled_by(process: Any, name: str) -> bool:
    """Whether a worker has compiled a kernel, or tried to."""
    try:
        process.stdin.write(f"{name}\n".encode())
        process.stdin.flush()
        return bool(process.stdout.readline())
    except (OSError, ValueError):
        return False


def work() -> None:
    """What a worker does: reads a function from its input, then calls it with each line, and answers with a line."""
    signal.signal(
        signal.SIGINT, signal.SIG_DFL
    )  # Ctrl-C reaches all processes of a terminal; this one ends silently
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what libraries print is no answer
    make = pickle.load(sys.stdin.buffer)
    for line in sys.stdin.buffer:
        with suppress(Exception):  # the process that waits meets it, too
            make(line.decode().rstrip("\n"))
        print(file=answers, flush=True)


@atexit.register
def _cancel_all() -> None:
    for preparation in list(_running):
        preparation.cancel()
