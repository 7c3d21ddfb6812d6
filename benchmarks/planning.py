"""Planning around a wall with the Panda, 200 seeds: how often it succeeds, and how long each part takes.

python benchmarks/planning.py
"""

from __future__ import annotations

import numpy as np

import ulna
from ulna.collision import World
from ulna.geometry import Box, Cylinder, Sphere
from ulna.planning import plan


def main(seeds: int = 200) -> None:
    """Plans with each seed and prints medians."""
    robot = ulna.load("panda")
    world = (
        World()
        .add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])
        .add("wall", Box((0.3, 0.02, 0.4)), (0.55, 0.0, 0.2))
        .add("ball", Sphere(0.1), (0.3, -0.5, 0.6))
        .add("post", Cylinder(0.04, 0.5), (0.35, 0.45, 0.25))
    )
    ends = []
    for y in (-0.25, 0.25):
        T = np.diag([1.0, -1.0, -1.0, 1.0])
        T[:3, 3] = 0.5, y, 0.35
        ends.append(robot.ik(T, robot.configurations["ready"], seed=1).q)
    start, goal = ends
    plan(robot, start, goal, world)  # compiles
    plans = [plan(robot, start, goal, world, seed=seed) for seed in range(seeds)]
    total = 1e3 * np.array([sum(p.seconds.values()) for p in plans])
    print(f"solved {sum(map(bool, plans))} of {seeds}, certified {sum(p.is_certified for p in plans)}")
    print(f"whole call: median {np.median(total):.2f} ms, 95th percentile {np.percentile(total, 95):.2f} ms")
    for part in ("prepare", "search", "shorten", "certify"):
        print(f"{part:8} {1e3 * np.median([p.seconds[part] for p in plans]):.2f} ms")


if __name__ == "__main__":
    main()
