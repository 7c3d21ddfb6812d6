"""Batches in two threads beside one, and beside what two processes get done at once, which the machine allows.

    python benchmarks/batch_threads.py [Panda] [G1]

Batches of 1 to 30 ms into arrays that exist. One thread, two threads and two processes with half of the batch each take
turns; medians of the ratios to one thread, so that other programs and the clock of the processor hit all alike.
"""

from __future__ import annotations

import multiprocessing
import os
import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

os.environ["ULNA_QUIET"] = "1"

import numpy as np
from _timing import table

import ulna

KERNELS = ("fk", "mass_matrix", "inverse_dynamics", "forward_dynamics")
MILLISECONDS = (1.0, 3.0, 10.0, 30.0)
SECONDS = 1.5
"""How long a row is measured."""


def seconds(f: Callable[[], object]) -> float:
    start = time.perf_counter()
    f()
    return time.perf_counter() - start


def arguments(kernel: Any, rows: int) -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    return [rng.standard_normal((rows, *port.shape)) for port in kernel.function.inputs]


class Other:
    """A forked process that computes a batch whenever asked to."""

    def __init__(self, kernel: Any, rows: int) -> None:
        context = multiprocessing.get_context("fork")
        self.pipe, other = context.Pipe()
        self.process = context.Process(target=self.run, args=(kernel, rows, other), daemon=True)
        self.process.start()

    def run(self, kernel: Any, rows: int, pipe: Any) -> None:
        """What the process does."""
        q = arguments(kernel, rows)
        out = kernel(*q)
        while pipe.recv():
            kernel(*q, out=out)
            pipe.send(True)

    def beside(self, f: Callable[[], object]) -> None:
        """Computes the batch while `f` runs here."""
        self.pipe.send(True)
        f()
        self.pipe.recv()

    def end(self) -> None:
        """Ends the process."""
        self.pipe.send(False)
        self.process.join()


def row(label: str, name: str, kernel: Any, duration: float) -> list[str]:
    q = arguments(kernel, 1000)
    out = kernel(*q)
    rows = int(1000 * duration / min(seconds(lambda: kernel(*q, out=out)) for _ in range(50)))
    q = arguments(kernel, rows)
    out, half = kernel(*q), [x[: rows // 2] for x in q]
    part = kernel(*half)
    other = Other(kernel, rows // 2)
    candidates = (
        lambda: kernel(*q, out=out),
        lambda: kernel(*q, threads=2, out=out),
        lambda: other.beside(lambda: kernel(*half, out=part)),
    )
    took: list[list[float]] = []
    until = time.monotonic() + SECONDS
    while time.monotonic() < until or len(took) < 9:
        took.append([seconds(f) for f in candidates])
    other.end()
    ratios = [statistics.median(one / x[k] for one, *x in took) for k in (0, 1)]
    alone = statistics.median(one for one, *_ in took)
    return [label, name, f"{rows:,}", f"{alone * 1e3:.1f} ms", *(f"{ratio:.2f}" for ratio in ratios)]


def main() -> None:
    rows = [
        row(label, name, ulna.load(label.lower()).kernel(name), duration * 1e-3)
        for label in sys.argv[1:] or ["Panda", "G1"]
        for name in KERNELS
        for duration in MILLISECONDS
    ]
    head = ["robot", "quantity", "samples", "one thread", "two threads", "two processes"]
    print(table("Batches in two threads", head, rows))


if __name__ == "__main__":
    main()
