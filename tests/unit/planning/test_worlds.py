"""Planning with attached objects, margins, clouds and meshes: what is returned is free when sampled densely."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import Obstacle, World
from ulna.compiler.runtime import jit
from ulna.errors import InputError, UnknownName
from ulna.geometry import Box, Cone, Cylinder, HeightField, Mesh, PointCloud, Sphere
from ulna.planning import edges, plan, scene
from ulna.spatial import SE3

FINGERS = ("panda_leftfinger", "panda_rightfinger")


@cache
def panda() -> Any:
    return ulna.load("panda")


def down(x: float, y: float, z: float) -> Any:
    T = np.diag([1.0, -1.0, -1.0, 1.0])
    T[:3, 3] = x, y, z
    return T


@cache
def ends() -> tuple[Any, Any]:
    """Configurations on both sides of a wall."""
    robot = panda()
    return tuple(robot.ik(down(0.5, y, 0.35), robot.configurations["ready"], seed=1).q for y in (-0.25, 0.25))


def wall() -> World:
    world = World().add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])
    return world.add("wall", Box((0.3, 0.02, 0.4)), (0.55, 0.0, 0.2))


def surface_of_wall(count: int) -> Any:
    """Points on the box of the wall."""
    random, half = np.random.default_rng(0), np.array([0.15, 0.01, 0.2])
    points = random.uniform(-half, half, (count, 3))
    face = random.integers(0, 3, count)
    points[np.arange(count), face] = np.sign(points[np.arange(count), face]) * half[face]
    return points


def is_free(path: Any, world: World, method: Any = "exact") -> bool:
    """Whether nothing touches at many states of a path."""
    t = np.linspace(0.0, 1.0, 40)[:, None]
    states = np.concatenate([x + t * (y - x) for x, y in zip(path.points, path.points[1:], strict=False)])
    return not panda().collides(states, world, method=method).any()


def test_what_the_hand_holds_stays_free_too() -> None:
    robot, (a, b) = panda(), ends()
    held = wall().attach(
        "stick", "panda_hand", (0.0, 0.0, 0.18), shape=Box((0.02, 0.02, 0.2)), touches=FINGERS
    )
    p = plan(robot, a, b, held)
    assert p and p.is_certified and is_free(p, held)
    bare = plan(robot, a, b, wall())
    assert bare and not is_free(bare, held)  # or the stick made no difference
    long = held.remove("stick").attach(
        "stick", "panda_hand", (0.0, 0.0, 0.25), shape=Cylinder(0.01, 0.5), touches=FINGERS
    )
    p = plan(robot, a, b, long)
    assert p.outcome == "start" and "'stick' overlaps 'table' by" in p.reason
    resting = long.remove("stick").attach(
        "stick", "panda_hand", (0.0, 0.0, 0.25), shape=Cylinder(0.01, 0.5), touches=[*FINGERS, "table"]
    )
    assert plan(robot, a, a, resting)
    with pytest.raises(UnknownName, match="panda_hand"):
        plan(robot, a, b, wall().attach("cup", "panda_hnd", shape=Sphere(0.05)))


def test_margins_of_pairs_are_kept() -> None:
    robot, (a, b) = panda(), ends()
    apart = wall().set_margin("wall", "panda_hand", 0.05).set_margin("wall", "panda_link7", 0.03)
    p = plan(robot, a, b, apart)
    assert p and p.is_certified and is_free(p, apart) and is_free(p, apart, "spheres")
    p = plan(robot, a, b, wall().set_margin("wall", "panda_hand", 0.5))
    assert p.outcome == "start" and "'panda_hand' overlaps 'wall'" in p.reason


def test_clouds_are_planned_around() -> None:
    robot, (a, b) = panda(), ends()
    cloud = PointCloud(surface_of_wall(4000), 0.005)
    world = wall().remove("wall").add("scan", cloud, (0.55, 0.0, 0.2))
    p = plan(robot, a, b, world)
    assert p and p.is_certified and is_free(p, world)
    straight = a + np.linspace(0.0, 1.0, 50)[:, None] * (b - a)
    assert robot.collides(straight, world).any()  # or there was nothing to plan
    p = plan(robot, a, b, world.move("scan", SE3.from_matrix(down(0.5, 0.25, 0.35))))
    assert p.outcome == "goal" and "'scan'" in p.reason
    kept = world.set_margin("scan", "panda_hand", 0.04)
    p = plan(robot, a, b, kept)
    assert p and is_free(p, kept)
    empty = World().add("nothing", PointCloud([]))
    assert len(plan(robot, a, b, empty).points) == 2
    far = World().add("scan", PointCloud([[0.0, 0.0, 1.0], [900.0, 0.0, 0.0]]))
    with pytest.raises(InputError, match="m from the origin"):
        plan(robot, a, b, far)


def test_height_fields_meshes_and_cones_are_planned_around(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    robot, (a, b) = panda(), ends()
    bowl = trimesh.creation.annulus(0.1, 0.12, 0.4)  # hollow: its hull is not
    bowl.export(tmp_path / "ring.stl")
    ground = HeightField(0.02 * np.sin(np.arange(60).reshape(6, 10)), (0.6, 1.0))
    world = World().add("ground", ground, (0.6, 0.0, -0.05)).add("ridge", Cone(0.15, 0.45), (0.55, 0.0, 0.22))
    world = world.add("ring", Mesh(str(tmp_path / "ring.stl")), (0.5, 0.25, 0.1))
    p = plan(robot, a, b, world.remove("ring"))
    assert p and p.is_certified and is_free(p, world.remove("ring"))
    p = plan(robot, a, robot.ik(down(0.5, 0.25, 0.55), a, seed=1).q, world)
    assert p and p.is_certified and is_free(p, world)


def test_a_mesh_that_is_not_closed_is_its_surface(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    corners = [[0.4, -0.01, 0.0], [0.7, -0.01, 0.0], [0.7, 0.01, 0.4], [0.4, 0.01, 0.4]]
    trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]]).export(tmp_path / "sheet.stl")
    robot, (a, b) = panda(), ends()
    world = World().add("sheet", Mesh(str(tmp_path / "sheet.stl")))
    p = plan(robot, a, b, world)
    assert p and p.is_certified and is_free(p, world)
    straight = a + np.linspace(0.0, 1.0, 50)[:, None] * (b - a)
    assert robot.collides(straight, world).any()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_random_worlds_with_clouds_and_held_objects_are_free_by_coal(seed: int) -> None:
    robot, random = panda(), np.random.default_rng(seed)
    points = random.uniform([-0.8, -0.8, 0.0], [0.8, 0.8, 1.0], (6, 1, 3)) + 0.06 * random.normal(
        size=(6, 60, 3)
    )
    cloud = PointCloud(points[np.linalg.norm(points[:, 0, :2], axis=1) > 0.35].reshape(-1, 3), 0.01)
    world = World().add("scan", cloud, touches=["panda_link0", "panda_link1"])
    world = world.attach("rod", "panda_hand", (0.0, 0.0, 0.15), shape=Cylinder(0.015, 0.2), touches=FINGERS)
    world = world.set_margin("scan", "rod", 0.02)
    solved = 0
    for k in range(12):
        q = random.uniform(robot.limits.lower, robot.limits.upper, size=(2, 7))
        p = plan(robot, q[0], q[1], world, seed=k, timeout=5.0)
        solved += bool(p)
        assert p.reason if not p else p.is_certified and is_free(p, world)
    assert solved >= 1


@pytest.mark.parametrize("lanes", [8, 16])
def test_machine_code_never_says_free_where_clouds_touch(lanes: int) -> None:
    robot = panda()
    random = np.random.default_rng(3)
    points = random.uniform([-0.8, -0.8, 0.0], [0.8, 0.8, 1.0], (60, 3))
    world = World().add(
        "scan", PointCloud(points, 0.02), SE3.from_rpy([0.1, 0.2, 0.3]), touches=["panda_link0"]
    )
    world = world.set_margin("scan", "panda_hand", 0.03)
    place = scene(robot.collision_checker(world, method="spheres"))
    if place.lanes != lanes:
        pytest.skip("this machine has other lanes")
    q = random.uniform(robot.limits.lower, robot.limits.upper, size=(400, 7))
    results = []
    which = edges.first_direct_goal.specialized(W=lanes)
    for call, count in ((which, 400), (which.checked, 40)):
        touching = np.zeros(count, np.float32)
        points, work = q[:count].astype(np.float32), place.moving.work()
        call(place.robot.kernel, place.tables(0.0), np.float32(1.0), points, touching, count, work)
        results.append(touching > 0)
    clearance = place.checker.clearance(q)
    assert 0.1 < results[0].mean() < 0.9
    assert results[0][clearance <= 0.0].all() and not results[0][clearance > 3e-4].any()
    np.testing.assert_array_equal(results[0][:40], results[1])


def test_a_world_that_changes_compiles_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    robot, (a, b) = panda(), ends()
    world = wall().add("scan", PointCloud(surface_of_wall(200), 0.005), (0.55, 0.0, 0.2))
    held = world.attach("can", "panda_hand", (0.0, 0.0, 0.1), shape=Cylinder(0.02, 0.1), touches=FINGERS)
    assert plan(robot, a, b, held)

    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("something was compiled")

    monkeypatch.setattr(jit, "_load", refuse)
    other = held.remove("can").move("wall", (0.6, 0.05, 0.2)).add("ball", Sphere(0.1), (0.3, -0.5, 0.7))
    other = other.add("post", Cylinder(0.03, 0.4), (0.2, 0.5, 0.2)).remove("scan")
    other = other.attach("cup", "panda_hand", (0.0, 0.0, 0.12), shape=Sphere(0.03), touches=FINGERS)
    other = other.set_margin("ball", "panda_hand", 0.02)
    p = plan(robot, a, b, other)
    assert p.outcome == "solved" and len(p.points) > 2


def test_ten_thousand_obstacles() -> None:
    robot, (a, b) = panda(), ends()
    random = np.random.default_rng(1)
    places = random.uniform([-1.5, -1.5, 1.3], [1.5, 1.5, 2.0], (10_000, 3))
    balls = tuple(Obstacle(f"o{k}", Sphere(0.01), SE3.from_translation(p)) for k, p in enumerate(places))
    world = World((*wall(), *balls))
    p = plan(robot, a, b, world)
    assert p and p.is_certified and is_free(p, world, "spheres")


def test_empty_and_huge_clouds() -> None:
    robot, (a, b) = panda(), ends()
    empty = plan(robot, a, b, wall().add("scan", PointCloud(np.zeros((0, 3)), 0.01)))
    np.testing.assert_array_equal(empty.points, plan(robot, a, b, wall()).points)
    far = np.random.default_rng(2).uniform([-1.5, -1.5, 1.3], [1.5, 1.5, 2.0], (400_000, 3))
    points = np.concatenate([far, surface_of_wall(100_000) + [0.55, 0.0, 0.2]])
    world = World().add("scan", PointCloud(points, 0.005))
    p = plan(robot, a, b, world)
    assert p and p.is_certified and len(p.points) > 2 and is_free(p, world, "spheres")
    with pytest.raises(InputError, match="100 m"):
        plan(robot, a, b, World().add("scan", PointCloud(points * 1e3, 0.005)))
