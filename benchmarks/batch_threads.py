"""Batches in two threads beside one.

    python benchmarks/batch_threads.py [Panda] [G1]

Batches of 1 to 30 ms into arrays that exist. One thread and two take turns; medians of the ratios, so that other programs
and the clock of the processor hit both alike. Measure on a machine whose other cores are free.
"""

from __future__ import annotations

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


def row(label: str, name: str, kernel: Any, duration: float) -> list[str]:
    q = arguments(kernel, 1000)
    out = kernel(*q)
    rows = int(1000 * duration / min(seconds(lambda: kernel(*q, out=out)) for _ in range(50)))
    q = arguments(kernel, rows)
    out = kernel(*q)
    took: list[tuple[float, float]] = []
    until = time.monotonic() + SECONDS
    while time.monotonic() < until or len(took) < 9:
        took.append((seconds(lambda: kernel(*q, out=out)), seconds(lambda: kernel(*q, threads=2, out=out))))
    alone, ratio = (
        statistics.median(one for one, _ in took),
        statistics.median(one / two for one, two in took),
    )
    return [label, name, f"{rows:,}", f"{alone * 1e3:.1f} ms", f"{ratio:.2f}"]


def main() -> None:
    rows = [
        row(label, name, ulna.load(label.lower()).kernel(name), duration * 1e-3)
        for label in sys.argv[1:] or ["Panda", "G1"]
        for name in KERNELS
        for duration in MILLISECONDS
    ]
    head = ["robot", "quantity", "samples", "one thread", "two threads"]
    print(table("Batches in two threads", head, rows))


if __name__ == "__main__":
    main()
