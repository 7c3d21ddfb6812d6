"""What a machine can do without Dask: two plain processes that share the parts of a job; and what else runs on it."""

from __future__ import annotations

import multiprocessing
import pickle
import time
from pathlib import Path
from typing import Any

from ulna import scale

_STAT = Path("/proc/stat")


class TwoProcesses:
    """Two processes that take parts from one counter, and send all of their results when none are left."""

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._spent = 0.0
        self._next = context.Value("q", 0)
        self._pipes, self._processes = [], []
        for _ in range(2):
            here, there = context.Pipe()
            process = context.Process(target=_serve, args=(there, self._next), daemon=True)
            process.start()
            self._pipes.append(here)
            self._processes.append(process)

    def run(self, job: scale.Job) -> Any:
        """The result of a job."""
        self._next.value, state, results = 0, job.start(), {}
        for pipe in self._pipes:
            pipe.send(job.for_workers())
        for pipe in self._pipes:
            content, seconds = pipe.recv()
            results |= pickle.loads(content)
            self._spent += seconds
        for part in range(job.parts):
            job.fold(state, part, results[part])
        return job.finish(state, None)

    def processor_time(self) -> float:
        """Of the two, and of this process [s]."""
        return time.process_time() + self._spent

    def close(self) -> None:
        """Ends the two."""
        for pipe, process in zip(self._pipes, self._processes, strict=True):
            pipe.send(None)
            process.join()


def _serve(pipe: Any, following: Any) -> None:
    known: dict[bytes, Any] = {}  # a job that was sent before has its kernels
    while True:
        content = pipe.recv_bytes()
        job = known.setdefault(content, pickle.loads(content))
        if job is None:
            return
        start, results = time.process_time(), {}
        while True:
            with following.get_lock():
                part = following.value
                following.value += 1
            if part >= job.parts:
                break
            results[part] = job.work(part, *job.inputs(part))
        pipe.send((pickle.dumps(results, protocol=5), time.process_time() - start))


def busy() -> float:
    """For how long the processors of this machine have worked since it started, whatever the program [s]; 0 where the
    system does not say.
    """
    if not _STAT.exists():
        return 0.0
    user, nice, system, _, _, *others = map(int, _STAT.read_text().split("\n", 1)[0].split()[1:9])
    return (user + nice + system + sum(others)) / 100.0
