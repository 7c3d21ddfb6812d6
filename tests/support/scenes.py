"""A table with things on it, and the same collision geometry for Pinocchio."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.collision import Checker, World
from ulna.geometry import Box, Capsule, Cylinder, Sphere
from ulna.spatial import SE3

BASES = {"panda": "panda_link0", "ur5": "base_link"}
LOW = {"base_link": ("shoulder_link",)}
"""Links that turn flat over the table, by the base they stand on: their spheres reach into it."""


def table(link: str = "panda_link0", count: int = 20, seed: int = 0) -> World:
    """A table in front of an arm with `count - 1` boxes, cylinders, balls and capsules standing on it."""
    rng = np.random.default_rng(seed)
    world = World().add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=[link, *LOW.get(link, ())])
    kinds = (
        (Box((0.08, 0.06, 0.2)), 0.1),
        (Cylinder(0.04, 0.25), 0.125),
        (Sphere(0.06), 0.06),
        (Capsule(0.03, 0.15), 0.105),
    )
    for k in range(count - 1):
        shape, height = kinds[k % 4]
        place = (rng.uniform(0.25, 0.85), rng.uniform(-0.7, 0.7), height)
        world = world.add(f"thing{k}", shape, SE3.from_rpy((0.0, 0.0, rng.uniform(-3.0, 3.0)), place))
    return world


def geometry_model(pin: Any, checker: Checker) -> Any:
    """Pinocchio's geometry model with the solids and pairs of a checker; joints must come in the same order."""
    from ulna.collision.narrow import geometry_of

    model = pin.GeometryModel()
    for k, solid in enumerate(checker.solids):
        place = pin.SE3(solid.placement.matrix())
        model.addGeometryObject(pin.GeometryObject(f"{k}", solid.joint + 1, place, geometry_of(solid, False)))
    for i, j in np.argwhere(checker.mask).tolist():
        model.addCollisionPair(pin.CollisionPair(i, j))
    return model
