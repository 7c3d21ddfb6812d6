"""Collision-free inverse kinematics of the Panda, at a table and within a shelf, from Python: time and success.

    python benchmarks/ik_free.py [--quick]

Goals are poses of random free configurations, so that every one has an answer. The peers try one start after the other:
the Robotics Toolbox's C++ `ik_LM` from random configurations, and Pinocchio's `computeCollisions` with its tree of boxes
on the same solids and pairs, up to 100 times. Every answer is checked here for all alike: forward kinematics, limits,
and the exact check. One core. A second table has the same goals in one call, by exact shapes and by spheres, and poses
of random configurations, of which some have no free answer.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import pinocchio as pin
from _timing import shown, table

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import ulna
from support.pinocchio_models import to_pinocchio
from support.scenes import geometry_model
from support.scenes import table as table_scene
from ulna.collision import World
from ulna.geometry import Box

TRIES = 100
SHELF = {
    "left": ((0.4, 0.02, 0.8), (0.55, 0.3, 0.4)),
    "right": ((0.4, 0.02, 0.8), (0.55, -0.3, 0.4)),
    "top": ((0.4, 0.6, 0.02), (0.55, 0.0, 0.8)),
    "middle": ((0.4, 0.6, 0.02), (0.55, 0.0, 0.4)),
    "back": ((0.02, 0.6, 0.8), (0.75, 0.0, 0.4)),
}


def scenes() -> dict[str, World]:
    """A table with 20 shapes, and the same with a shelf on it."""
    world = table_scene()
    shelf = world
    for name, (size, place) in SHELF.items():
        shelf = shelf.add(name, Box(size), place)
    return {"table": world, "shelf": shelf}


def goals(robot: ulna.Robot, world: World, is_shelf: bool, count: int) -> np.ndarray:
    """Poses of free configurations, those of the shelf within it."""
    q = robot.random_configuration(200 * count, seed=3)
    T = robot.fk(q[~robot.collides(q, world, method="spheres")])
    if is_shelf:
        x, y, z = np.moveaxis(T[:, :3, 3], -1, 0)
        T = T[(x > 0.35) & (x < 0.75) & (np.abs(y) < 0.3) & (z < 0.8)]
    return T[:count]


def peer(robot: ulna.Robot, world: World) -> Callable[[np.ndarray], Any]:
    """The toolbox's solver and Pinocchio's check, until both are content."""
    import roboticstoolbox as rtb

    toolbox = rtb.models.Panda().ets()
    exact = robot.collision.checker(world)
    twin, geometry = to_pinocchio(robot.model), geometry_model(pin, exact)
    data, found = twin.pin.createData(), geometry.createData()
    tree = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(twin.pin, geometry, found)
    offset = np.linalg.inv(toolbox.eval(np.zeros(7))) @ robot.fk(np.zeros(7))
    correction = np.linalg.inv(offset)
    rng = np.random.default_rng(0)

    def solve(T: np.ndarray, kept: Any = (geometry, found)) -> Any:  # which the tree does not keep alive
        goal = T @ correction
        for _ in range(TRIES):
            start = rng.uniform(robot.limits.lower, robot.limits.upper)
            q = np.asarray(toolbox.ik_LM(goal, q0=start, tol=1e-12).q)
            if robot.limits.contains(q) and met(robot, q, T):
                if pin.computeCollisions(twin.pin, data, tree, twin.q(q), True):
                    continue
                return q
        return None

    return solve


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer goals")
    count = 50 if parser.parse_args().quick else 300
    robot, rows = ulna.load("panda"), []
    for label, world in scenes().items():
        T = goals(robot, world, label == "shelf", count)

        def alone(goal: np.ndarray) -> Any:
            return robot.ik(goal).q

        def free(goal: np.ndarray, world: World = world) -> Any:
            solution = robot.ik_free(goal, world)
            return solution.q if solution else None

        solvers = {
            "robot.ik, blind": alone,
            "robot.ik_free": free,
            "toolbox ik_LM and pin.computeCollisions": peer(robot, world),
        }
        reference = 0.0
        for name, solve in solvers.items():
            solve(T[0])
            spent, good = [], 0
            for goal in T:
                start = time.perf_counter()
                q = solve(goal)
                spent.append(time.perf_counter() - start)
                good += q is not None and is_free(robot, q, goal, world)
            middle, slow = np.quantile(spent, (0.5, 0.99)).tolist()
            reference = middle if name == "robot.ik_free" else reference
            ratio = f"{middle / reference:.1f}" if reference else ""
            mean = float(np.mean(spent))
            rows.append(
                [
                    label,
                    name,
                    f"{100.0 * good / len(T):.1f} %",
                    shown(middle),
                    shown(mean),
                    shown(slow),
                    ratio,
                ]
            )
    header = ["scene", "solver", "free and at the goal", "median", "mean", "p99", "median of ours"]
    print(table(f"Panda, {count} goals, one a call", header, rows))
    print(table("Panda, one call for all goals", BATCH_HEADER, batch_rows(robot, 3 * count)))


BATCH_HEADER = [
    "scene",
    "goals",
    "answered",
    "exact, alone",
    "exact, batch",
    "spheres, alone",
    "spheres, batch",
]


def batch_rows(robot: ulna.Robot, count: int) -> list[list[str]]:
    """Times of a goal in loops of single calls and in one call, in turns."""
    robot.collision.spheres()  # fitted once; then batches use them
    rows = []
    for label, world in scenes().items():
        sets = {
            "of free configurations": goals(robot, world, label == "shelf", count),
            "of random configurations": robot.fk(robot.random_configuration(count, seed=5)),
        }
        for name, T in sets.items():
            times: dict[str, list[float]] = {}
            answers = [robot.ik_free(T, world, method=method) for method in ("exact", "spheres")]
            for _ in range(3):
                for method in ("exact", "spheres"):
                    start = time.perf_counter()
                    for goal in T[: count // 3]:
                        robot.ik_free(goal, world, method=method)
                    middle = time.perf_counter()
                    robot.ik_free(T, world, method=method)
                    times.setdefault(f"{method} alone", []).append((middle - start) / (count // 3))
                    times.setdefault(f"{method} batch", []).append((time.perf_counter() - middle) / len(T))
            shares = ", ".join(f"{100.0 * answer.success.mean():.1f} %" for answer in answers)
            rows.append(
                [label, name, shares, *(shown(float(np.median(values))) for values in times.values())]
            )
    return rows


def met(robot: ulna.Robot, q: np.ndarray, T: np.ndarray) -> bool:
    """Whether a configuration is at the goal."""
    return bool(np.abs(robot.fk(q) - T).max() < 2e-6)


def is_free(robot: ulna.Robot, q: np.ndarray, T: np.ndarray, world: World) -> bool:
    """Whether a configuration is at the goal, within the limits, and touches nothing."""
    return met(robot, q, T) and bool(robot.limits.contains(q, 1e-9)) and not robot.collides(q, world)


if __name__ == "__main__":
    main()
