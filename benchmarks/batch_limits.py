"""How near batches come to what the processor allows: arithmetic, code and writing, each as a part of the time.

    python benchmarks/batch_limits.py [--clock 3.0] [robot ...]

Batches of 1,000 samples into arrays that exist, one core, medians. Arithmetic is what `kernel.report(batch=True)` counts:
two vector instructions a cycle at the clock that is given [GHz], 20 for a sine or cosine; rows are the shuffles that
move samples into lanes and back, at the same rate; code is the fetching of code that exceeds the first cache, which a
processor does beside the arithmetic; writing is NumPy filling the results, which takes turns with it where results
exceed the first cache. So arithmetic, rows and writing together are the limit.
"""

from __future__ import annotations

import argparse
import os

os.environ["ULNA_QUIET"] = "1"

import numpy as np
from _speed_robots import PEERS
from _timing import medians, shown, table
from derivatives import ROBOTS, load

from ulna.compiler.codegen.scheduling import chunks
from ulna.compiler.language.function import Function
from ulna.compiler.language.ops import TABLE, Op
from ulna.compiler.runtime import report
from ulna.robot import Robot

BATCH = 1_000
HEAD = ("robot", "quantity", "a sample", "arithmetic", "rows", "writing", "together", "code", "spills")


def row(label: str, robot: Robot, name: str, clock: float) -> list[str]:
    """One robot and one quantity."""
    rng, kernel = np.random.default_rng(0), robot.kernel(name)
    count = len(kernel.function.inputs)
    arrays = [robot.random_configuration((BATCH,), seed=1), *rng.standard_normal((3, BATCH, robot.nv))][
        :count
    ]
    out = kernel(*arrays)
    results = out if isinstance(out, tuple) else (out,)

    def write() -> None:
        for array in results:
            array.fill(0.0)

    took, written = medians([lambda: kernel(*arrays, out=out), write], 9, 0.01)
    costs = kernel.report(batch=True)
    functions = {row.op.name.lower() for row in TABLE if row.kind == "function"}
    weights = {kind: report._FUNCTION for kind in functions} | report._SLOW
    operations = sum(weights.get(kind, 1.0) * n for kind, n in costs.counts.items())
    cycles = took / BATCH * clock * 1e9 * costs.lanes
    arithmetic = operations / report._VECTOR_INSTRUCTIONS / cycles
    is_long = costs.code_bytes > report._INSTRUCTION_CACHE
    code = costs.code_bytes / report._BYTES_OF_CODE / cycles if is_long else 0.0
    rows = shuffles(kernel.function, costs.lanes) / report._VECTOR_INSTRUCTIONS / cycles
    parts = arithmetic, rows, written / took, arithmetic + rows + written / took, code
    return [label, name, shown(took / BATCH), *(f"{part:.0%}" for part in parts), str(costs.spills)]


def shuffles(f: Function, lanes: int) -> int:
    """How many shuffles move a register of samples into lanes, and results back; chunks of nothing but zeros take none."""
    zero, start, total = set(), 0, 0
    for number, index in enumerate(f.results):
        if f.graph.op[index] == Op.CONST and f.graph.data[index] == 0.0:
            zero.add(number)
    for port in f.inputs:
        total += sum(_of_chunk(width, lanes) for _, width in chunks(lanes, port.size))
    for port in f.outputs:
        for first, width in chunks(lanes, port.size):
            if not zero.issuperset(range(start + first, start + first + width)):
                total += _of_chunk(width, lanes)
        start += port.size
    return total


def _of_chunk(width: int, lanes: int) -> int:
    """Parts of rows are joined to registers, or taken out of them, and exchanged in log2(width) rounds."""
    return (lanes - width) + width * (width.bit_length() - 1)


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--clock", type=float, default=3.0, help="of the processor [GHz]")
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(ROBOTS)}; default all")
    given = parser.parse_args()
    rows = []
    for label in given.robots or ROBOTS:
        robot = Robot(load(ROBOTS[label])[0])
        rows += [row(label, robot, name, given.clock) for name in PEERS]
    print(table(f"Batches of {BATCH:,} and their limits, at {given.clock} GHz", HEAD, rows))


if __name__ == "__main__":
    main()
