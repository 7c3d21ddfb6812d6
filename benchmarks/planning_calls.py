"""Checks, whole calls and first calls of planning for the Panda, with VAMP beside where it is installed.

python benchmarks/planning_calls.py FOLDER [--plans 100000]

FOLDER is VAMP's unpacked source, with resources/panda, whose spheres and pairs both take. Rounds in turns, medians.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import vamp
from planning_vamp import problems

import ulna
from ulna.collision.lanes.touching import Tables, Work
from ulna.compiler.procedures import Array1, Array2, Kernel, f32, procedure
from ulna.errors import ModelWarning
from ulna.planning import Planner
from ulna.planning.edges import blocks_of_edge, edge_touches
from ulna.planning.workspace import COARSE

FIRST = """
import sys, time, warnings
warnings.simplefilter("ignore")
import numpy as np, ulna
from ulna.collision import World
from ulna.geometry import Box
robot = ulna.load(sys.argv[1], srdf=sys.argv[2])
world = World().add("wall", Box((0.3, 0.02, 0.4)), (0.55, 0.0, 0.2))
start = time.perf_counter()
plan = robot.plan([0.6, 0.5, 0, -1.8, 0, 2.3, 0.8], [-0.6, 0.5, 0, -1.8, 0, 2.3, 0.8], world)
print(bool(plan), 1e3 * (time.perf_counter() - start))
"""


def medians(calls: Mapping[str, Callable[[], object]], count: int, rounds: int = 7) -> dict[str, float]:
    """Medians of the time of a call [us], the calls in turns."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            start = time.perf_counter()
            for _ in range(count):
                call()
            times[name].append(1e6 * (time.perf_counter() - start) / count)
    return {name: float(np.median(values)) for name, values in times.items()}


@procedure(constants={"W": 8})
def _check_edges(
    kernel: Kernel, tables: Tables, step: f32, a: Array2[f32], b: Array2[f32], touches: Array1[np.int64], work: Work,
    W: int,
) -> int:  # fmt: skip
    """Writes 1 for edges on which anything touches, else 0; returns how many states free ones have."""
    states = 0
    for i in range(len(touches)):
        touches[i] = int(edge_touches(kernel, tables, step, a[i], b[i], work, W))
        if touches[i] == 0:
            states += W * blocks_of_edge(tables, step, a[i], b[i], W)
    return states


def edges(robot: ulna.Robot, planner: Planner, problem: Any, count: int = 300) -> None:
    """Prints the time of free edges, a state, both planners in turns on the same edges."""
    q = robot.random_configuration(40 * count, seed=2).astype(np.float32)
    a, b = q[: 20 * count], q[20 * count :]
    workspace = planner._search._workspace(COARSE[0])
    touches = np.zeros(len(a), np.int64)

    def ours() -> int:
        return workspace.call(_check_edges, np.float32(workspace.step), a, b, touches)

    ours()
    there = [vamp.panda.validate(p, problem.environment) for p in a]
    both = [
        k
        for k in np.flatnonzero(touches == 0)
        if there[k] and vamp.panda.validate_motion(a[k], b[k], problem.environment)
    ][:count]
    a, b, touches = a[both], b[both], np.zeros(len(both), np.int64)
    length = np.linalg.norm(b - a, axis=1)
    resolution, rake = vamp.panda.resolution(), 8
    states_there = int((np.maximum(np.ceil(length / rake * resolution), 1) * rake).sum())
    states = ours()

    def theirs() -> None:
        for p, r in zip(a, b, strict=True):
            vamp.panda.validate_motion(p, r, problem.environment)

    us = medians({"Ulna": ours, "VAMP": theirs}, 3, 15)
    print(
        f"{len(both)} free edges of {length.mean():.1f} rad, us a state: Ulna {us['Ulna'] / states:.3f} ({states} states), "
        f"VAMP {us['VAMP'] / states_there:.3f} ({states_there} states, one call from Python an edge)"
    )


def main() -> None:
    """Prints all figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--plans", type=int, default=100_000, help="plans over which memory is watched")
    options = parser.parse_args()
    files = options.folder / "resources" / "panda"
    model = files / "panda_spherized.urdf", files / "panda.srdf"
    warnings.simplefilter("ignore", ModelWarning)
    robot = ulna.load(model[0], srdf=model[1])
    problem = problems(options.folder)[300]
    checker = robot.collision.checker(problem.world, method="spheres")
    q = problem.start
    many = robot.random_configuration(100_000, seed=1)
    checker.collides(many)

    print("one configuration and batches, us each")
    checks = {
        "Ulna": lambda: checker.collides(q),
        "VAMP": lambda: vamp.panda.validate(q, problem.environment),
    }
    print("  from Python:", medians(checks, 2_000))
    print(
        "  batch of 100,000:",
        {k: v / 1e5 for k, v in medians({"Ulna": lambda: checker.collides(many)}, 1).items()},
    )

    planner = Planner(robot)
    empty = vamp.Environment()
    module, search, settings, _ = vamp.configure_robot_and_planner_with_kwargs("panda", "rrtc")
    samples = module.halton()
    near = q + 1e-3
    calls = {
        "Ulna, certified, to a neighbour": lambda: planner.plan(q, near),
        "VAMP, to a neighbour": lambda: search(q, [near], empty, settings, samples),
    }
    print("whole calls without a search, us:", medians(calls, 1_000))

    planner = Planner(robot, problem.world)
    plan = planner.plan(q, problem.goal)
    edges(robot, planner, problem)
    trajectories = {
        "plan": lambda: planner.plan(q, problem.goal),
        "plan and time": lambda: planner.plan(q, problem.goal).trajectory(acceleration=8.0),
    }
    print(f"from goal to motion, {len(plan.points)} points, us:", medians(trajectories, 20))

    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for seed in range(options.plans):
        planner.plan(q, problem.goal, seed=seed % 16)
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(f"memory over {options.plans} plans: {before / 1024:.1f} to {after / 1024:.1f} MiB")

    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "ULNA_CACHE": folder}
        for name in ("first plan ever", "first plan of a process", "first plan of a process"):
            command = [sys.executable, "-c", FIRST, *map(str, model)]
            result = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
            print(f"{name}: {result.stdout.split()[1]} ms, found: {result.stdout.split()[0]}")


if __name__ == "__main__":
    main()
