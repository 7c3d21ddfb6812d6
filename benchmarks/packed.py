"""Whole matrices against packed ones: batches, into arrays that exist.

    python benchmarks/packed.py [--samples N] [robot ...]

Needs `pin` and `example-robot-data`, as derivatives.py does, with whose robots it works. "numbers" is what a sample of each writes; times are medians, in
turns, for a sample of a batch.
"""

from __future__ import annotations

import argparse
import os
from functools import partial

import numpy as np
from _timing import medians, shown, table
from derivatives import ROBOTS, load

import ulna
from ulna.model import Model

KERNELS = ("mass_matrix", "inverse_mass_matrix", "coriolis_matrix", "inverse_dynamics_derivatives")


def row(label: str, model: Model, name: str, samples: int) -> list[str]:
    """One quantity of one robot."""
    robot, rng = ulna.Robot(model), np.random.default_rng(0)
    whole = robot.kernel(name)
    packed = whole.packed()
    inputs = [np.array([robot.random_configuration(seed=k) for k in range(samples)])]
    inputs += [rng.uniform(-1.0, 1.0, (samples, port.size)) for port in whole.function.inputs[1:]]
    calls = [partial(kernel, *inputs, out=kernel(*inputs)) for kernel in (whole, packed)]
    slow, fast = (t / samples for t in medians(calls))
    numbers = [str(sum(port.size for port in kernel.function.outputs)) for kernel in (whole, packed)]
    return [label, name, *numbers, shown(slow), shown(fast), f"{slow / fast:.2f}"]


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=1000)
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(ROBOTS)}; default all")
    given = parser.parse_args()
    os.environ["ULNA_QUIET"] = "1"
    rows = []
    for label in given.robots or ROBOTS:
        model, _ = load(ROBOTS[label])
        rows += [row(label, model, name, given.samples) for name in KERNELS]
    head = ["robot", "quantity", "numbers", "packed", "whole, one sample", "packed, one sample", "ratio"]
    print(table(f"Packed matrices, batches of {given.samples:,}", head, rows))


if __name__ == "__main__":
    main()
