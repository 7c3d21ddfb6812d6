"""How long kernels take to make: operations, tracing, compiling with an empty cache, fetching from a full one.

    python benchmarks/compile.py [--kernels NAME,NAME] [robot ...]

Needs `pin` and `example-robot-data`, as derivatives.py does, with whose robots it works. Each number is the time of this process's processor, so that a busy machine distorts it
little. "one call" is what a first call waits for, "batch" what the first batch waits for after that.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from _timing import shown, table
from derivatives import ROBOTS, load

from ulna import kernels
from ulna.compiler import compile
from ulna.model import Model

KERNELS = (
    "fk",
    "inverse_dynamics",
    "mass_matrix",
    "inverse_mass_matrix",
    "forward_dynamics",
    "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives",
)


def busy(f: Callable[[], Any]) -> tuple[float, Any]:
    """Seconds of processor that `f` takes, and what it returns."""
    start = time.process_time()
    result = f()
    return time.process_time() - start, result


def row(label: str, model: Model, name: str) -> list[str]:
    """What one kernel costs."""
    tracing, f = busy(lambda: kernels.function(model, name))
    times = []
    for _ in ("cold", "warm"):
        one, kernel = busy(lambda: compile(f))
        batch, _ = busy(lambda kernel=kernel: kernel.gufunc)
        times += [shown(tracing + one), shown(batch)]
    sizes = [f"{len(kernel.ir(batch)) / 1e6:.1f} MB" for batch in (False, True)]
    return [label, name, f"{f.operations:,}", shown(tracing), *times, *sizes]


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kernels", default=",".join(KERNELS))
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(ROBOTS)}; default all")
    given = parser.parse_args()
    os.environ["ULNA_QUIET"] = "1"
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        os.environ["ULNA_CACHE"] = folder
        compile(np.sin, x=(2,))  # LLVM has started
        for label in given.robots or ROBOTS:
            model, _ = load(ROBOTS[label])
            rows += [row(label, model, name) for name in given.kernels.split(",")]
    head = ["robot", "kernel", "operations", "tracing", "one call, cold", "batch, cold", "one call, warm", "batch, warm",
            "IR of one call", "IR of a batch"]  # fmt: skip
    print(f"Python {sys.version.split()[0]}, NumPy {np.__version__}\n")
    print(table("Making kernels", head, rows))


if __name__ == "__main__":
    main()
