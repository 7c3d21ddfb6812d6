"""Exported WebAssembly in node beside native kernels: time of a call, size, and agreement.

Run `python benchmarks/export_wasm.py [ROBOT]`. node must be installed. Each time is the least of many short runs, which a
busy machine disturbs least.
"""

from __future__ import annotations

import gzip
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import ulna

KERNELS = ["fk", "jacobian", "inverse_dynamics", "mass_matrix"]
GOALS, CALLS, RUNS = 200, 200, 300

SCRIPT = """
import { readFileSync } from "node:fs";
import { load } from "./robot.js";
const { kernels, arguments: given, goals, start, calls, runs } = JSON.parse(readFileSync(0, "utf-8"));
const robot = await load();
function least(f) {
  for (let i = 0; i < 4000; i++) f(i);
  let best = Infinity;
  for (let k = 0; k < runs; k++) {
    const begin = performance.now();
    for (let i = 0; i < calls; i++) f(i);
    best = Math.min(best, (performance.now() - begin) / calls);
  }
  return 1e3 * best;
}
const times = {};
for (const name of kernels) {
  const values = given[name].map((x) => Float64Array.from(x));
  const out = robot[name](...values);
  times[name] = least(() => robot[name](...values, out));
}
const poses = goals.map((T) => Float64Array.from(T.flat()));
times["ik from rest"] = least((i) => robot.ik(poses[i % poses.length]));
times["ik near q0"] = least((i) => robot.ik(poses[i % poses.length], start));
console.log(JSON.stringify(times));
"""


def least(f: Callable[[int], Any]) -> float:
    """The least time of a call [us]."""
    best = float("inf")
    for _ in range(RUNS):
        begin = time.perf_counter()
        for i in range(CALLS):
            f(i)
        best = min(best, (time.perf_counter() - begin) / CALLS)
    return 1e6 * best


def of_kernel(kernel: Any, values: list[Any]) -> float:
    """The least time of a call of a kernel [us]."""
    return least(lambda _: kernel(*values))


def main() -> None:
    """Prints the table."""
    node = shutil.which("node")
    if node is None:
        sys.exit("node is not installed.")
    robot = ulna.load(sys.argv[1] if len(sys.argv) > 1 else "panda")
    rng = np.random.default_rng(0)
    goals = robot.fk(robot.random_configuration(GOALS, seed=1))
    start = robot.random_configuration(seed=2)
    values = {k: [rng.uniform(-1, 1, p.shape) for p in robot.kernel(k).function.inputs] for k in KERNELS}
    native = {k: of_kernel(robot.kernel(k), values[k]) for k in KERNELS}
    native["ik from rest"] = least(lambda i: robot.ik(goals[i % GOALS]))
    native["ik near q0"] = least(lambda i: robot.ik(goals[i % GOALS], start))
    with tempfile.TemporaryDirectory() as place:
        folder = ulna.export(robot, [*KERNELS, "ik"], to="wasm", path=Path(place) / "x", name="robot")
        (folder / "times.mjs").write_text(SCRIPT)
        order = {
            "kernels": KERNELS,
            "arguments": {k: [x.tolist() for x in v] for k, v in values.items()},
            "goals": goals.reshape(GOALS, 16).tolist(),
            "start": start.tolist(),
            "calls": CALLS,
            "runs": RUNS,
        }
        done = subprocess.run(
            [node, "times.mjs"],
            cwd=folder,
            input=json.dumps(order),
            capture_output=True,
            text=True,
            check=True,
        )
        sizes = {end: (folder / f"robot.{end}").read_bytes() for end in ("wasm", "js")}
    times = json.loads(done.stdout)
    print("| function | native, from Python [us] | node [us] | ratio |\n|---|---|---|---|")
    for name, value in native.items():
        print(f"| {name} | {value:.2f} | {times[name]:.2f} | {times[name] / value:.1f} |")
    for end, content in sizes.items():
        print(f"{end}: {len(content):,} bytes, {len(gzip.compress(content, 9)):,} gzipped")


if __name__ == "__main__":
    main()
