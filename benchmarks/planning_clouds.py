"""Plans problems of MotionBenchMaker's Panda against boxes and capsules, and against 10,000 points of their surface.

python benchmarks/planning_clouds.py FOLDER [--every 10] [--rounds 3] [--points 10000]

FOLDER is VAMP's unpacked source, as for planning_vamp.py; VAMP plans with its trees of points (CAPT) beside. Only problems
whose start and goal all find free count. Of each problem the least time of all rounds is taken.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np
import vamp
from planning_vamp import Problem, problems

import ulna
from ulna.collision import World
from ulna.collision.grids import grid_of
from ulna.geometry import Box, Capsule, PointCloud
from ulna.planning import Planner

RADIUS = 0.0025


def surface(world: World, count: int) -> np.ndarray:
    """Points on the surfaces of boxes and capsules, shape (count, 3)."""
    random = np.random.default_rng(0)
    areas = np.array([_area(obstacle.shape) for obstacle in world])
    numbers = random.multinomial(count, areas / areas.sum())
    return np.concatenate(
        [o.pose @ _points(o.shape, n, random) for o, n in zip(world, numbers, strict=True) if n]
    )


def _area(shape: Any) -> float:
    if isinstance(shape, Box):
        x, y, z = shape.size
        return 2.0 * (x * y + y * z + z * x)
    return 2.0 * np.pi * shape.radius * (shape.length + 2.0 * shape.radius)


def _points(shape: Any, n: int, random: np.random.Generator) -> np.ndarray:
    if isinstance(shape, Box):
        size = np.array(shape.size)
        areas = np.prod(size) / size
        axis = random.choice(3, n, p=areas / areas.sum())
        points = random.uniform(-0.5, 0.5, (n, 3))
        points[np.arange(n), axis] = random.choice([-0.5, 0.5], n)
        return points * size
    assert isinstance(shape, Capsule)
    direction = random.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    is_side = random.uniform(size=n) < shape.length / (shape.length + 2.0 * shape.radius)
    direction[is_side, 2] = 0.0
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    height = np.sign(direction[:, 2:]) * shape.length / 2.0
    height[is_side] = random.uniform(-0.5, 0.5, (int(is_side.sum()), 1)) * shape.length
    return direction * shape.radius + np.concatenate([np.zeros((n, 2)), height], axis=1)


def of_vamp(points: np.ndarray, rounds: int) -> tuple[Any, float]:
    """VAMP's world of points, and how long it takes to make [s]."""
    least, greatest = vamp.panda.min_max_radii()
    times = []
    for _ in range(rounds):
        environment = vamp.Environment()
        rows = points.astype(np.float32).tolist()
        start = time.process_time()
        environment.add_pointcloud(rows, least, greatest, RADIUS)
        times.append(time.process_time() - start)
    return environment, min(times)


def main() -> None:
    """Plans all problems in four ways, and prints what each took."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--every", type=int, default=10, help="take every n-th problem")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--points", type=int, default=10_000)
    options = parser.parse_args()
    files = options.folder / "resources" / "panda"
    robot = ulna.load(files / "panda_spherized.urdf", srdf=files / "panda.srdf")
    module, search, settings, _ = vamp.configure_robot_and_planner_with_kwargs("panda", "rrtc")
    samples = module.halton()
    chosen: list[tuple[Problem, Planner, Planner, Any]] = []
    made: list[tuple[float, float]] = []
    for problem in problems(options.folder)[:: options.every]:
        points = surface(problem.world, options.points)
        times = []
        for _ in range(options.rounds):
            start = time.process_time()
            grid_of(points, RADIUS)
            times.append(time.process_time() - start)
        environment, seconds = of_vamp(points, options.rounds)
        made.append((min(times), seconds))
        cloud = World().add("scan", PointCloud(points, RADIUS))
        planners = [Planner(robot, where, method="spheres") for where in (problem.world, cloud)]
        if all(p.plan(problem.start, problem.goal) for p in planners):
            chosen.append((problem, *planners, environment))
    ms = 1e3 * np.median(made, axis=0)
    print(
        f"{len(chosen)} problems; {options.points} points ready: Ulna {ms[0]:.1f} ms, VAMP {ms[1]:.1f} ms of processor time (median)"
    )
    least = np.full((len(chosen), 4), np.inf)
    for _ in range(options.rounds):
        for k, (problem, shapes, cloud_planner, environment) in enumerate(chosen):
            for column, planner in ((0, shapes), (1, cloud_planner)):
                start = time.process_time()
                found = planner.plan(problem.start, problem.goal)
                least[k, column] = min(least[k, column], 1e6 * (time.process_time() - start))
                assert found.is_certified
            for column, place in ((2, problem.environment), (3, environment)):
                samples.reset()
                result = search(problem.start, [problem.goal], place, settings, samples)
                if result.solved:
                    least[k, column] = min(least[k, column], result.nanoseconds / 1e3)
    for name, column in (
        ("Ulna, shapes", 0),
        ("Ulna, points", 1),
        ("VAMP, shapes, plan only", 2),
        ("VAMP, points, plan only", 3),
    ):
        times = least[np.isfinite(least[:, column]), column]
        print(
            f"{name:24} median {np.median(times):8.0f} us, mean {times.mean():8.0f}, 95 % {np.percentile(times, 95):8.0f}, solved {len(times)}"
        )


if __name__ == "__main__":
    main()
