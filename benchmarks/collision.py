"""Collision checks of the Panda on a table with 20 shapes: compiled spheres, coal through Ulna, coal through Pinocchio.

    python benchmarks/collision.py

The same solids and pairs for all; times per configuration, in batches of 500 random configurations, in one process.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
from _timing import medians, shown, table

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import ulna
from support.pinocchio_models import to_pinocchio
from support.scenes import geometry_model
from support.scenes import table as scene

COUNT = 500


def main() -> None:
    robot, world = ulna.load("panda"), scene()
    exact = robot.collision.checker(world)
    spheres = robot.collision.checker(world, method="spheres")
    twin, geometry = to_pinocchio(robot.model), geometry_model(pin, exact)
    data, found = twin.pin.createData(), geometry.createData()
    tree = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(twin.pin, geometry, found)
    q = robot.random_configuration(COUNT, seed=1)
    rows = [twin.q(row) for row in q]

    def through_pin() -> list[bool]:
        return [pin.computeCollisions(twin.pin, data, geometry, found, row, True) for row in rows]

    def through_tree() -> list[bool]:
        return [pin.computeCollisions(twin.pin, data, tree, row, True) for row in rows]

    def distances() -> list[float]:
        return [pin.computeDistances(twin.pin, data, geometry, found, row) for row in rows]

    truth, seen = exact.collides(q), spheres.collides(q)
    assert (truth == through_pin()).all() and not (truth & ~seen).any()
    candidates = {
        "Ulna, spheres: touching or free": lambda: spheres.collides(q),
        "Ulna, spheres: clearance": lambda: spheres.clearance(q),
        "Ulna, coal: touching or free": lambda: exact.collides(q),
        "Ulna, coal: all pairs, no boxes": lambda: exact.collides(q, broad_phase=False),
        "pin.computeCollisions, stops at the first": through_pin,
        "pin.computeCollisions with its tree of boxes": through_tree,
        "Ulna, coal: least distance": lambda: exact.distance(q),
        "pin.computeDistances": distances,
    }
    times = [t / COUNT for t in medians(list(candidates.values()), repeat=9, seconds=0.001)]
    reference = times[4]
    lines = [(name, shown(t), f"{reference / t:.2f}") for name, t in zip(candidates, times, strict=True)]
    title = f"Panda, table with {len(world)} shapes: {int(exact.mask.sum())} pairs of solids, {spheres.spheres.count} spheres"
    print(table(title, ("check", "per configuration", "times as fast as pin.computeCollisions"), lines))
    print(f"touching {truth.mean():.3f} of configurations; spheres say touching of {seen.mean():.3f}")
    start, end = q[~truth][:20], q[~truth][20:40]
    (segment,) = medians([lambda: robot.collision.first_contact(start, end, world)], repeat=3)
    print(f"first_contact: {shown(segment / 20)} a segment")


if __name__ == "__main__":
    np.set_printoptions(precision=4)
    main()
