"""Batches in two threads beside one, and beside two processes.

    python benchmarks/batch_threads.py [Panda] [G1] [--seconds 1]

Batches of 1 to 30 ms into arrays that exist; medians of ratios, so that other programs and the clock of the processor hit all
alike. "In turns": one thread and two take turns. "In a row": ten batches by one thread, then ten by two. "Two processes": as
many rows a second as two processes get done that compute half of the rows each, again and again, beside one process alone:
what the machine has to give. Measure on a machine whose other cores are free.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import statistics
import time
from collections.abc import Callable
from typing import Any

os.environ["ULNA_QUIET"] = "1"

import numpy as np
from _timing import table

import ulna

KERNELS = ("fk", "mass_matrix", "inverse_dynamics", "forward_dynamics")
MILLISECONDS = (1.0, 3.0, 10.0, 30.0)
ROW = 10
"""Batches in a row."""
SLICE = 20
"""For how many batches of one thread processes are counted at a time."""


def seconds(f: Callable[[], object]) -> float:
    start = time.perf_counter()
    f()
    return time.perf_counter() - start


def batch(robot: str, name: str, rows: int) -> tuple[Any, list[np.ndarray], Any]:
    """A kernel, arguments for so many rows, and arrays for the results."""
    kernel = ulna.load(robot).kernel(name)
    rng = np.random.default_rng(0)
    q = [rng.standard_normal((rows, *port.shape)) for port in kernel.function.inputs]
    return kernel, q, kernel(*q)


class OtherProcess:
    """A process that computes a batch again and again until it is stopped."""

    def __init__(self, robot: str, name: str, rows: int) -> None:
        context = multiprocessing.get_context("spawn")
        self._is_wanted, self._count = context.Event(), context.Value("q", -1, lock=False)
        arguments = (self._is_wanted, self._count, robot, name, rows)
        self._process = context.Process(target=_compute, args=arguments, daemon=True)
        self._process.start()
        while self._count.value < 0:
            time.sleep(0.01)

    def beside(self, f: Callable[[], object], duration: float) -> tuple[float, float]:
        """How often a second `f` is called, and the other process computes its batch, for so many seconds."""
        begun = self._count.value
        self._is_wanted.set()
        calls, start = 0, time.perf_counter()
        while (took := time.perf_counter() - start) < duration:
            f()
            calls += 1
        others = self._count.value - begun
        self._is_wanted.clear()
        return calls / took, others / took

    def end(self) -> None:
        """Ends it."""
        self._process.terminate()
        self._process.join()


def _compute(is_wanted: Any, count: Any, robot: str, name: str, rows: int) -> None:
    kernel, q, out = batch(robot, name, rows)
    count.value = 0
    while (
        is_wanted.wait()
    ):  # asleep meanwhile: a process that looks now and then would take the core from a thread
        kernel(*q, out=out)
        count.value += 1


def row(robot: str, name: str, duration: float, measure: float) -> tuple[list[str], list[float]]:
    kernel, q, out = batch(robot, name, 1000)
    rows = int(1000 * duration / min(seconds(lambda: kernel(*q, out=out)) for _ in range(50)))
    kernel, q, out = batch(robot, name, rows)
    half = [x[: rows // 2] for x in q]
    half_out = tuple(o[: rows // 2] for o in out) if isinstance(out, tuple) else out[: rows // 2]
    one, two = lambda: kernel(*q, out=out), lambda: kernel(*q, out=out, threads=2)
    alone: list[float] = []
    ratios: list[list[float]] = [[], [], []]
    other = OtherProcess(robot, name, rows // 2)
    until = time.monotonic() + measure
    while time.monotonic() < until or len(alone) < 5 * ROW:
        turns = [(seconds(one), seconds(two)) for _ in range(ROW)]
        alone += [took for took, _ in turns]
        ratios[0].append(statistics.median(took / shared for took, shared in turns))
        in_row = [statistics.median(seconds(f) for _ in range(ROW)) for f in (one, two)]
        ratios[1].append(in_row[0] / in_row[1])
        both = other.beside(lambda: kernel(*half, out=half_out), SLICE * duration)
        ratios[2].append(sum(both) / 2.0 * in_row[0])
    other.end()
    found = [statistics.median(values) for values in ratios]
    took = f"{statistics.median(alone) * 1e3:.1f} ms"
    return [robot, name, f"{rows:,}", took, *(f"{ratio:.2f}" for ratio in found)], found


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("robots", nargs="*", default=["Panda", "G1"])
    parser.add_argument("--seconds", type=float, default=1.0, help="how long a row is measured")
    chosen = parser.parse_args()
    rows = []
    for milliseconds in MILLISECONDS:
        all_found = []
        for robot in chosen.robots:
            for name in KERNELS:
                shown, found = row(robot.lower(), name, milliseconds * 1e-3, chosen.seconds)
                rows.append(shown)
                all_found.append(found)
        for label, values in zip(
            ("in turns", "in a row", "two processes"), zip(*all_found, strict=True), strict=True
        ):
            spread = f"{min(values):.2f} to {max(values):.2f}"
            print(f"{milliseconds:.0f} ms, {label}: {statistics.median(values):.2f} ({spread})", flush=True)
    head = ["robot", "quantity", "samples", "one thread", "in turns", "in a row", "two processes"]
    print(table("Batches in two threads", head, rows))


if __name__ == "__main__":
    main()
