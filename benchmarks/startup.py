"""How long it takes to get going: importing, loading, the first call with a cold and a warm cache; medians of processes.

python benchmarks/startup.py [RUNS]
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile

from _timing import table

_SCRIPT = """
import time
import numpy
t0 = time.perf_counter()
import ulna
t1 = time.perf_counter()
robot = ulna.load("panda", visuals="simple")
t2 = time.perf_counter()
robot.fk(robot.configurations["qr"])
t3 = time.perf_counter()
print(t1 - t0, t2 - t1, t3 - t2)
"""


def once(cache: str) -> list[float]:
    """Seconds of import, load and first call in a new process."""
    environment = {**os.environ, "ULNA_CACHE": cache}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # else every process compiles the sources again
    done = subprocess.run(
        [sys.executable, "-c", _SCRIPT], env=environment, capture_output=True, text=True, check=True
    )
    return [float(word) for word in done.stdout.split()]


def main() -> None:
    """Prints the table."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 15
    once("0")
    cold, warm = [], []
    for _ in range(runs):
        with tempfile.TemporaryDirectory() as folder:
            cold.append(once(folder))
            warm.append(once(folder))

    def ms(samples: list[list[float]], column: int) -> str:
        return f"{1e3 * statistics.median(s[column] for s in samples):.0f} ms"

    rows = [
        ["import ulna, on top of NumPy", ms(cold, 0), ms(warm, 0)],
        ["load the Panda", ms(cold, 1), ms(warm, 1)],
        ["its first forward kinematics", ms(cold, 2), ms(warm, 2)],
    ]
    print(table(f"Getting going, medians of {runs} processes", ["step", "empty cache", "warm cache"], rows))


if __name__ == "__main__":
    main()
