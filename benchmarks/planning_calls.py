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
from ulna.planning.workspace import COARSE, Workspace, thread_storage

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


def _free_walk(
    robot: ulna.Robot, problem: Any, is_free: Callable[[Any, Any], bool], length: float, count: int
) -> Any:
    """Configurations, each joined to the next by a motion of at most a length that both planners find free."""
    random = np.random.default_rng(2)
    points, q = [], problem.start.astype(np.float32)
    while len(points) < count:
        target = random.uniform(robot.limits.lower, robot.limits.upper)
        part = min(1.0, length / np.linalg.norm(target - q))
        step = (q + part * (target - q)).astype(np.float32)
        path = vamp.panda.Path()
        path.append(q)
        path.append(step)
        if path.validate(problem.environment) and is_free(q[None], step[None]):
            points.append(q)
            q = step
    return np.array(points)


def edges(robot: ulna.Robot, planner: Planner, problem: Any, length: float, count: int = 1_000) -> None:
    """Prints the time of free edges, a state, both planners in turns along the same path.

    VAMP checks a path at the resolution of its search; its `validate_motion` in Python would take one state a radian.
    """
    workspace = Workspace(planner.scene, thread_storage(robot.nq), 0.0, 0.01, 1.0, COARSE[0])
    touches, step = np.zeros(count - 1, np.int64), np.float32(workspace.step)

    def is_free(a: Any, b: Any) -> bool:
        return workspace.call(_check_edges, step, a, b, touches[:1]) > 0

    points = _free_walk(robot, problem, is_free, length, count)
    a, b, path = points[:-1].copy(), points[1:].copy(), vamp.panda.Path()
    ours = workspace.bound(_check_edges, step, a, b, touches)
    for q in points:
        path.append(q)
    assert path.validate(problem.environment)
    states = ours()
    assert not touches.any()
    lengths = np.linalg.norm(b - a, axis=1)
    rake = 8
    states_there = int((np.maximum(np.ceil(lengths / rake * vamp.panda.resolution()), 1) * rake).sum())
    us = medians({"Ulna": ours, "VAMP": lambda: path.validate(problem.environment)}, 3, 15)
    print(
        f"{count - 1} free edges of {lengths.mean():.1f} rad, us a state: "
        f"Ulna {us['Ulna'] / states:.4f} ({states} states), VAMP {us['VAMP'] / states_there:.4f} ({states_there} states); "
        f"us an edge: Ulna {us['Ulna'] / len(a):.2f}, VAMP {us['VAMP'] / len(a):.2f}"
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
    for length in (1.0, 3.0, 9.0):
        edges(robot, planner, problem, length)
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
