"""Tables of proved clearance: what they take to make, what they tell from touching, and plans with them.

python benchmarks/planning_tables.py [ROBOT ...] [--count 1000] [--problems 20]

Of random configurations it counts those that touch by coal, by spheres with tables, and by spheres alone. Random
problems without obstacles begin and end where coal says that links are 2 mm apart; humanoids begin at rest (all joints
at 0; a Talos half sitting) and move their right arm. Tables are made anew, in a folder of their own; spheres are those that are stored.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

import ulna
from ulna import algorithms
from ulna.collision import Checker, SphereChecker
from ulna.collision.table_choice import pair_tables
from ulna.errors import ModelWarning
from ulna.planning import Planner

ROBOTS = ("ur5", "ur3", "ur10", "g1", "talos")
APART = 2e-3  # of links at the ends of problems [m]


def made(spheres: SphereChecker) -> tuple[int, float, float]:
    """Makes the tables anew: their number, processor time [s] and size on disk [MB]."""
    before = os.environ.get("ULNA_CACHE")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["ULNA_CACHE"] = folder
        pair_tables.cache_clear()
        start = time.process_time()
        tables = pair_tables(spheres.model, spheres.spheres, spheres.pairs, "skip")
        seconds = time.process_time() - start
        size = sum(
            os.path.getsize(os.path.join(where, f)) for where, _, files in os.walk(folder) for f in files
        )
    if before is None:
        del os.environ["ULNA_CACHE"]
    else:
        os.environ["ULNA_CACHE"] = before
    pair_tables.cache_clear()
    return len(tables), seconds, size / 1e6


def shares(model: Any, count: int) -> tuple[float, float, float, int]:
    """The shares that touch by coal, with tables and by spheres, and how often tables miss a contact."""
    q = algorithms.random(model, np.random.default_rng(1), (count,))
    exact = np.asarray(Checker(model, missing="skip").collides(q))
    tables = np.asarray(SphereChecker(model, missing="skip").collides(q))
    spheres = np.asarray(SphereChecker(model, missing="skip", tables=False).collides(q))
    return exact.mean(), tables.mean(), spheres.mean(), int((exact & ~tables).sum())


def right_arm(model: Any) -> list[str] | None:
    """The joints of a humanoid's right arm; None for other robots."""
    parts = ("shoulder", "elbow", "wrist", "arm_right")
    names = [
        joint.name for joint in model.joints if "right" in joint.name and any(p in joint.name for p in parts)
    ]
    return names or None


def plans(robot: Any, count: int) -> tuple[int, float]:
    """How many problems are solved and certified, and the median time of a call [ms]."""
    model, exact, planner = (
        robot.model,
        Checker(robot.model, missing="skip"),
        Planner(robot, method="spheres"),
    )
    rng, joints, times, solved = np.random.default_rng(3), right_arm(robot.model), [], 0
    columns: Sequence[int] = (
        range(model.nq) if joints is None else [model.joint(name).idx_q for name in joints]
    )

    # at rest a Talos has its arms within its legs
    home = np.asarray(robot.configurations.get("half_sitting", algorithms.neutral(model)), float)

    def free() -> Any:
        while True:
            q = home.copy()
            q[list(columns)] = algorithms.random(model, rng)[list(columns)]
            if exact.distance(q).distance > APART:
                return q

    for _ in range(count):
        start, goal = (free() if joints is None else home), free()
        planner.plan(start, goal, joints=joints, timeout=2.0)
        begin = time.perf_counter()
        path = planner.plan(start, goal, joints=joints, timeout=2.0)
        times.append(1e3 * (time.perf_counter() - begin))
        solved += path.is_certified
        for a, b in zip(path.points[:-1], path.points[1:], strict=True):
            assert not exact.collides(a + np.linspace(0.0, 1.0, 40)[:, None] * (b - a)).any()
    return solved, float(np.median(times))


def main() -> None:
    """Prints a row for each robot."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("robots", nargs="*", default=ROBOTS)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--problems", type=int, default=20)
    options = parser.parse_args()
    warnings.simplefilter("ignore", ModelWarning)
    print("| robot | touch by coal | with tables | by spheres | missed | tables | s | MB | plans | ms |")
    for name in options.robots:
        robot = ulna.load(name)
        number, seconds, size = made(SphereChecker(robot.model, missing="skip", tables=False))
        coal, tables, spheres, missed = shares(robot.model, options.count)
        solved, median = plans(robot, options.problems)
        print(
            f"| {name} | {100 * coal:.1f} % | {100 * tables:.1f} % | {100 * spheres:.1f} % | {missed} | {number} | "
            f"{seconds:.1f} | {size:.1f} | {solved} of {options.problems} | {median:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
