"""Objects that links carry, and margins of pairs, in every collision check."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import Obstacle, SphereChecker, World, attached, sphere_clearance
from ulna.collision.sphere_kernels import self_collision_kernel
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.geometry import Box, Cylinder, Geometry, Plane, Sphere
from ulna.model import FreeFlyer, ModelBuilder
from ulna.spatial import SE3

HAND = SE3.from_translation([0.0, 0.0, 0.1]) @ SE3.from_rpy([0.3, 0.0, 0.0])
FINGERS = ("panda_leftfinger", "panda_rightfinger")


@cache
def panda() -> Any:
    return ulna.load("panda")


def table() -> World:
    return World().add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])


def held() -> World:
    world = table().add("can", Cylinder(0.03, 0.12), (0.5, 0.0, 0.15))
    return world.attach("can", "panda_hand", HAND, touches=FINGERS)


def configurations(count: int) -> Any:
    robot = panda()
    return np.random.default_rng(1).uniform(robot.limits.lower, robot.limits.upper, (count, robot.nq))


def test_an_attached_object_is_an_obstacle_no_longer() -> None:
    world = held()
    assert world.names == ("table",) and "can" not in world and world.attached("can").link == "panda_hand"
    assert "can on panda_hand" in repr(world) and world.fingerprint != table().fingerprint
    down = world.detach("can", (0.4, 0.1, 0.15), touches=FINGERS)
    assert down.names == ("table", "can") and not down.attachments and down["can"].touches == FINGERS
    np.testing.assert_allclose(down["can"].pose.translation, [0.4, 0.1, 0.15])
    assert world.remove("can").fingerprint == table().fingerprint
    new = table().attach("cup", "panda_hand", shape=Cylinder(0.03, 0.1))
    assert isinstance(new.attached("cup").shape, Cylinder)


@pytest.mark.parametrize(
    ("make", "error", "text"),
    [
        (
            lambda w: w.attach("cup", "panda_hand"),
            InputError,
            "no shape is given, and no obstacle has that name",
        ),
        (
            lambda w: w.attach("can", "panda_hand", shape=Sphere(0.1)),
            InputError,
            "attached object named 'can'",
        ),
        (lambda w: w.add("can", Sphere(0.1)), InputError, "attached object named 'can' already"),
        (lambda w: w.attach("table", "panda_hand", np.zeros(7)), ShapeError, "quaternion"),
        (lambda w: w.attach("table", "panda_hand", touches="can"), InputError, "expected a list"),
        (lambda w: w.detach("cam", (0, 0, 0)), UnknownName, "'can'"),
        (lambda w: w.remove("cam"), UnknownName, "'can'"),
        (lambda w: w.set_margin("can", "can", 0.1), InputError, "two different names"),
        (lambda w: w.set_margin("can", "table", -0.1), InputError, "not below 0"),
        (lambda w: w.set_margin("can", "table", None), InputError, "not below 0"),
    ],
)
def test_invalid_attachments_are_refused(make: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        make(held())


@pytest.mark.parametrize("method", ["exact", "spheres"])
def test_robots_refuse_what_they_cannot_carry(method: Any) -> None:
    robot, q, cup = panda(), panda().configurations["ready"], Cylinder(0.03, 0.1)
    for world, error, text in [
        (World().attach("cup", "panda_hnd", shape=cup), UnknownName, "panda_hand"),
        (World().attach("cup", "panda_link0", shape=cup), InputError, "does not move"),
        (World().attach("cup", "panda_hand", shape=Plane()), InputError, "expected a body"),
        (World().attach("cup", "panda_hand", shape=cup, touches=["tabel"]), UnknownName, "tabel"),
        (table().set_margin("tabel", "panda_hand", 0.1), UnknownName, "table"),
    ]:
        with pytest.raises(error, match=text):
            robot.collides(q, world, method=method)


def test_distances_of_attached_objects_are_those_of_obstacles_that_move_along() -> None:
    """The same object as an obstacle at the hand's pose, and on a separate flying body, by other code."""
    robot, q = panda(), configurations(150)
    world = table().attach("can", "panda_hand", HAND, shape=Cylinder(0.03, 0.12), touches=FINGERS)
    T = robot.fk(q, "panda_hand") @ HAND.matrix()
    rigid = [link.name for link in robot.model.links if link.joint == robot.model.link("panda_hand").joint]
    beside = table().add("can", Cylinder(0.03, 0.12), moving=True, touches=[*FINGERS, *rigid])
    builder = (
        ModelBuilder("can").add_link("base").add_link("can", collisions=[Geometry("", Cylinder(0.03, 0.12))])
    )
    flying = ulna.Robot(builder.add_joint("fly", FreeFlyer(), "base", "can").build())
    poses, ground = SE3.from_matrix(T), World(tuple(replace(o, touches=()) for o in table()))
    flown = flying.distance(np.concatenate([poses.translation, poses.quat_xyzw()], axis=-1), ground).distance
    expected = np.minimum(robot.distance(q, beside, moving={"can": T}).distance, flown)
    d = robot.distance(q, world)
    np.testing.assert_allclose(d.distance, expected, atol=2e-6)
    assert (d.distance < robot.distance(q, table()).distance - 1e-6).any()
    np.testing.assert_array_equal(robot.collides(q, world), d.distance <= 0.0)
    assert not robot.collides(robot.configurations["ready"], world)


def test_spheres_see_attached_objects_and_compile_nothing_for_them() -> None:
    robot, q = panda(), configurations(300)
    small = (
        World()
        .add("ball", Sphere(0.1), (0.4, 0.0, 0.5))
        .attach("can", "panda_hand", shape=Cylinder(0.02, 0.1))
    )
    robot.collides(q[0], small, method="spheres")  # not a batch, whose doubts alone need this kernel
    robot.collision.checker(small, method="spheres").clearance(q)
    made = self_collision_kernel.cache_info().misses
    checker = robot.collision.checker(held().add("ball", Sphere(0.1), (0.4, 0.0, 0.5)), method="spheres")
    clearance = checker.clearance(q)
    assert np.allclose(checker.clearance(q[0]), clearance[0], atol=1e-12)
    exact = robot.distance(q, checker.world).distance
    free = clearance > 0.0
    assert 0.05 < free.mean() < 0.95 and (clearance[free] <= exact[free] + 1e-6).all()
    np.testing.assert_array_equal(checker.collides(q), clearance <= 1e-6)
    without = robot.collision.checker(checker.world.remove("can"), method="spheres").clearance(q)
    assert (clearance < without - 1e-9).any() and (clearance <= without + 1e-12).all()
    assert self_collision_kernel.cache_info().misses == made
    function = sphere_clearance(robot.model, checker.world)
    np.testing.assert_allclose([function(x) for x in q[:5]], clearance[:5], atol=1e-12)


def test_two_held_objects_may_touch_each_other_and_what_they_stand_on() -> None:
    b = ModelBuilder("two arms").add_link("base").add_link("left").add_link("right")
    b.add_link("body", collisions=[Geometry("", Sphere(0.01))])
    from ulna.model import Fixed, Prismatic

    b.add_joint("l", Prismatic((1.0, 0.0, 0.0)), "base", "left").add_joint(
        "r", Prismatic((1.0, 0.0, 0.0)), "base", "right"
    )
    robot = ulna.Robot(b.add_joint("b", Fixed(), "base", "body", SE3.from_translation([0, 0, 9.0])).build())
    world = World().attach("one", "left", (0, 0, 0.2), shape=Sphere(0.1)).add("floor", Plane(), (0, 0, 0.11))
    two = world.attach("two", "right", (0, 0, 0.3), shape=Sphere(0.1))
    for kwargs in ({}, {"method": "spheres"}):
        assert robot.collides([0.0, 1.0], world, **kwargs)  # with the floor
        free = world.remove("floor").attach("two", "right", (0, 0, 0.3), shape=Sphere(0.1))
        assert robot.collides([0.0, 0.1], free, **kwargs) and not robot.collides([0.0, 0.2], free, **kwargs)
        allowed = world.remove("floor").attach("two", "right", shape=Sphere(0.1), touches=["one"])
        assert not robot.collides([0.0, 0.1], allowed, **kwargs)
        standing = World().add("floor", Plane(), (0, 0, 0.11), touches=["one"])
        standing = standing.attach("one", "left", (0, 0, 0.2), shape=Sphere(0.1))
        assert not robot.collides([0.0, 1.0], standing, **kwargs)
    assert robot.distance([0.0, 1.0], two.remove("floor")).distance == pytest.approx(np.hypot(1.0, 0.1) - 0.2)
    time = robot.collision.first_contact([0.0, 1.0], [0.0, 0.0], two.remove("floor"))
    assert time == pytest.approx(1.0 - np.sqrt(0.2**2 - 0.1**2), abs=1e-3)


def test_margins_of_pairs_make_distances_smaller() -> None:
    robot, q = panda(), configurations(200)
    world = (
        held().add("ball", Sphere(0.1), (0.4, 0.0, 0.6)).add("post", Cylinder(0.05, 1.0), (-0.4, 0.3, 0.5))
    )
    world = world.add("floor", Plane(), (0, 0, -0.5))
    margins = {
        ("panda_hand", "ball"): 0.05, ("can", "table"): 0.03, ("panda_link4", "panda_hand"): 0.02,
        ("can", "panda_link3"): 0.04, ("panda_link5", "post"): 0.03, ("panda_hand", "floor"): 0.2,
    }  # fmt: skip
    apart = world
    for pair, distance in margins.items():
        apart = apart.set_margin(*pair, distance)
    assert (
        apart.margin("ball", "panda_hand") == 0.05
        and apart.set_margin("can", "table", 0).margin("can", "table") == 0
    )
    assert not apart.remove("can").remove("ball").remove("post").remove("floor").margin("can", "table")
    exact, checker = robot.collision.checker(world), robot.collision.checker(apart)
    for x in q[:25]:
        expected = min(
            p.distance - margins.get(p.names, margins.get(p.names[::-1], 0.0)) for p in exact.nearest(x)
        )
        assert checker.distance(x).distance == pytest.approx(expected, abs=2e-6)
    d = checker.distance(q).distance
    np.testing.assert_array_equal(checker.collides(q), d <= 0.0)
    assert (d < exact.distance(q).distance - 1e-3).any()
    clearance = SphereChecker(robot.model, apart).clearance(q)
    free = clearance > 0.0
    assert (clearance[free] <= d[free] + 1e-6).all() and free.any()
    function = sphere_clearance(robot.model, apart)
    np.testing.assert_allclose([function(x) for x in q[:5]], clearance[:5], atol=1e-12)


def test_ik_free_keeps_the_held_object_out_of_the_table() -> None:
    robot = panda()
    T = SE3.from_translation([0.5, 0.1, 0.14]).matrix() @ np.diag([1.0, -1.0, -1.0, 1.0])
    assert robot.ik_free(T, table(), frame="panda_hand", seed=1).success
    solution = robot.ik_free(T, held(), frame="panda_hand", seed=1)
    assert not solution.success and "can" in solution.reason


def test_ten_thousand_obstacles_are_taken() -> None:
    place = SE3.from_translation([0.0, 0.0, 1.5])
    world = World([Obstacle(f"o{k}", Sphere(0.01), place) for k in range(10_000)])  # type: ignore[arg-type]
    more = world.add("last", Sphere(0.01))
    assert len(more) == 10_001 and more["o9999"].name == "o9999" and "last" in more and "last" not in world
    with pytest.raises(InputError, match="named 'o5' already"):
        more.add("o5", Sphere(0.01))
    with pytest.raises(InputError, match="named 'last' already"):
        more.add("last", Sphere(0.01))


def test_spheres_of_attached_objects_are_read_from_the_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    stored: dict[str, bytes] = {}
    monkeypatch.setattr(attached.disk_cache, "read", stored.get)
    monkeypatch.setattr(attached.disk_cache, "write", stored.__setitem__)
    rod = Cylinder(0.012, 0.31)
    attached._covering.cache_clear()
    made = attached._covering(rod, b"")
    attached._covering.cache_clear()
    monkeypatch.setattr(attached, "cover", None)  # nothing is fitted any more
    read = attached._covering(rod, b"")
    for name in ("centres", "radii", "excess"):
        np.testing.assert_array_equal(getattr(read, name), getattr(made, name))
    assert len(made.radii) <= 64 and made.excess < 0.006
    random = np.random.default_rng(0)
    turn, z = random.uniform(0.0, 2.0 * np.pi, 4000), random.uniform(-0.155, 0.155, 4000)
    side = np.column_stack([0.012 * np.cos(turn), 0.012 * np.sin(turn), z])
    caps = np.column_stack([side[:, :2] * random.uniform(size=(4000, 1)) ** 0.5, np.copysign(0.155, z)])
    surface = np.concatenate([side, caps])
    apart = np.linalg.norm(surface[:, None] - made.centres, axis=-1) - made.radii
    assert apart.min(axis=1).max() <= 1e-9
    with pytest.raises(TypeError):
        attached._covering(Cylinder(0.013, 0.31), b"")
    attached._covering.cache_clear()
