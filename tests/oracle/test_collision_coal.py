"""The compiled spheres against coal: never free where it says touching."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from support.scenes import BASES, table
from ulna.collision import Checker, SphereChecker, World
from ulna.geometry import Cone, Ellipsoid, Plane
from ulna.spatial import SE3

pytest.importorskip("coal")


def scene(link: str) -> World:
    """The table, and the kinds of obstacle that it lacks."""
    return (
        table(link)
        .add("cone", Cone(0.1, 0.4), (-0.4, 0.3, 0.2))
        .add("egg", Ellipsoid((0.1, 0.15, 0.2)), SE3.from_rpy((0.4, 0.2, 0.0), (-0.3, -0.5, 0.5)))
        .add("wall", Plane(), SE3.from_rpy((0.0, np.pi / 2, 0.0), (-0.8, 0.0, 0.0)))
    )


def check(name: str, count: int, seed: int) -> None:
    robot = ulna.load(name)
    world = scene(BASES[name])
    exact, spheres = Checker(robot.model, world), SphereChecker(robot.model, world)
    rng = np.random.default_rng(seed)
    half = robot.random_configuration(count // 2, seed=rng)
    beyond = rng.uniform(-4.0, 4.0, (count - count // 2, robot.nq))  # also beyond the limits
    q = np.concatenate([half, beyond])
    touching, seen = exact.collides(q), spheres.collides(q)
    assert not (touching & ~seen).any()
    assert 0.05 < touching.mean() < 0.95 and (seen & ~touching).mean() < 0.15
    some = q[:: max(1, count // 300)]
    d, gap = exact.distance(some).distance, spheres.clearance(some)
    assert (gap <= np.maximum(d, 0.0) + 2e-6).all()


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_spheres_never_say_free_where_coal_says_touching(name: str) -> None:
    check(name, 2000, 0)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_spheres_never_say_free_in_a_long_sweep(name: str) -> None:
    check(name, 50_000, 1)
