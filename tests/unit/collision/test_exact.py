"""Exact checks by hand: distances one can compute, poses as inputs, wrong input."""

from __future__ import annotations

import builtins
import itertools
import os
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.scenes import table
from ulna.collision import Checker, World, broad_phase, first_contact
from ulna.collision.solids import link_solids
from ulna.errors import (
    InputError,
    MissingExtra,
    ModelError,
    ModelWarning,
    NonFiniteError,
    ShapeError,
    UnknownName,
)
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Geometry, Mesh, Plane, Shape, Sphere
from ulna.model import Model, ModelBuilder, Prismatic, Revolute
from ulna.spatial import SE3


def slider(shape: Shape) -> Model:
    """A shape that slides along x."""
    builder = ModelBuilder("slider")
    builder.add_link("rail")
    builder.add_link("cart", collisions=(Geometry("", shape),))
    builder.add_joint("slide", Prismatic((1.0, 0.0, 0.0)), "rail", "cart", lower=-5.0, upper=5.0)
    return builder.build()


@pytest.fixture(scope="module")
def robot() -> ulna.Robot:
    return ulna.load("panda")


@pytest.mark.parametrize(
    ("shape", "reach"),
    [
        (Sphere(0.3), 0.3),
        (Box((0.6, 1.0, 1.0)), 0.3),
        (Cylinder(0.3, 2.0), 0.3),
        (Capsule(0.3, 2.0), 0.3),
        (Ellipsoid((0.3, 0.1, 0.9)), 0.3),
        (Cone(0.6, 1.0), 0.3),
    ],
)
def test_distances_by_hand(shape: Shape, reach: float) -> None:
    world = World().add("wall", Box((1.0, 9.0, 9.0)), (2.5, 0.0, 0.0))
    if isinstance(shape, Cone):  # half way up it is half as wide: a ball touches there
        world = World().add("wall", Sphere(1e-3), (2.0 + 1e-3, 0.0, 0.0))
        slope = np.arctan2(0.6, 1.0)
        expected = 1.001 * np.cos(slope) + 0.0
        found = Checker(slider(shape), world).distance([1.0 - 0.3])
        np.testing.assert_allclose(found.distance, (2.001 - 1.0) * np.cos(slope) - 1e-3, atol=1e-6)
        assert expected > 0
        return
    checker = Checker(slider(shape), world)
    q = np.array([[0.0], [1.0], [1.65], [1.9]])
    found = checker.distance(q)
    np.testing.assert_allclose(found.distance, 2.0 - reach - q[:, 0], atol=2e-6)
    np.testing.assert_allclose(found.normal, np.tile([1.0, 0.0, 0.0], (4, 1)), atol=2e-3)
    np.testing.assert_allclose(
        found.points[:, 1] - found.points[:, 0], found.distance[:, None] * found.normal, atol=1e-6
    )
    assert found.names.tolist() == [["cart", "wall"]] * 4
    np.testing.assert_array_equal(checker.collides(q), [False, False, False, True])
    np.testing.assert_array_equal(checker.collides(q, margin=0.1), [False, False, True, True])
    np.testing.assert_allclose(checker.gradient(q)[:, 0], -1.0, atol=1e-5)


def test_a_plane_is_solid_below() -> None:
    world = World().add(
        "floor", Plane(), SE3.from_rpy((0.0, -np.pi / 2, 0.0), (1.0, 0.0, 0.0))
    )  # normal is -x
    checker = Checker(slider(Sphere(0.3)), world)
    np.testing.assert_allclose(checker.distance([[0.0], [0.9]]).distance, [0.7, -0.2], atol=1e-9)
    np.testing.assert_array_equal(checker.collides([[0.0], [0.9], [5.0]]), [False, True, True])


def test_moving_obstacles() -> None:
    world = (
        World()
        .add("ball", Sphere(0.1), (9.0, 0.0, 0.0), moving=True)
        .add("still", Sphere(0.1), (0.0, 3.0, 0.0))
    )
    checker = Checker(slider(Sphere(0.3)), world)
    poses = np.tile(np.eye(4), (3, 2, 1, 1))
    poses[:, :, 0, 3] = [[1.0, 2.0], [3.0, 4.0], [0.3, 0.0]]
    found = checker.distance([[0.0], [1.0]][0], {"ball": poses})
    np.testing.assert_allclose(found.distance, np.minimum(abs(poses[..., 0, 3]) - 0.4, 2.6), atol=1e-6)
    assert checker.collides([0.0], {"ball": poses}).shape == (3, 2)
    with pytest.raises(UnknownName, match="'ball'"):
        checker.collides([0.0], {"bal": np.eye(4)})
    with pytest.raises(InputError, match="does not move"):
        checker.collides([0.0], {"still": np.eye(4)})
    with pytest.raises(InputError):
        checker.collides([0.0], {"ball": np.diag([2.0, 1.0, 1.0, 1.0])})


def test_broad_phase_changes_nothing(robot: ulna.Robot) -> None:
    checker = robot.collision_checker(table())
    q = robot.random_configuration(60, seed=1)
    for margin in (0.0, 0.05, -0.01):
        plain = checker.collides(q, margin=margin, broad_phase=False)
        np.testing.assert_array_equal(checker.collides(q, margin=margin), plain)
        assert 0 < plain.sum() < 60
    few = q[:12]
    np.testing.assert_array_equal(
        checker.distance(few).distance, checker.distance(few, broad_phase=False).distance
    )
    early = checker.distance(q, stop_below=0.0).distance
    np.testing.assert_array_equal(early <= 0.0, checker.distance(q).distance <= 0.0)


def test_a_batch_is_its_rows_and_its_questions_agree(robot: ulna.Robot) -> None:
    world = table()
    q = robot.random_configuration((3, 5), seed=2)
    hit, found = robot.collides(q, world), robot.distance(q, world)
    assert hit.shape == (3, 5) and found.points.shape == (3, 5, 2, 3) and found.names.shape == (3, 5, 2)
    np.testing.assert_array_equal(hit, found.distance <= 0.0)
    checker = robot.collision_checker(world)
    np.testing.assert_array_equal(hit, checker.touching(q).any(axis=-1))
    one = robot.distance(q[1, 2], world)
    assert float(one) == found.distance[1, 2] and robot.collides(q[1, 2], world) == hit[1, 2]
    near = checker.nearest(q[1, 2])
    assert near[0].distance == float(one) and list(near[0].names) == one.names.tolist()
    np.testing.assert_allclose(near[0].gradient, robot.distance_gradient(q[1, 2], world))
    assert len(near) == len(checker.owners)
    assert all(a.distance <= b.distance for a, b in itertools.pairwise(near))
    assert robot.collision_checker(world) is checker


def test_pairs_can_be_left_out(robot: ulna.Robot) -> None:
    world = World().add("shell", Sphere(0.2), (0.0, 0.0, 0.6))
    q = robot.configurations["qr"]
    found = robot.distance(q, world)
    assert float(found) < 0.0
    names = [pair.names for pair in robot.collision_checker(world).nearest(q, within=0.0)]
    assert robot.collides(q, world) and not robot.collides(q, world, without=names)
    assert robot.collides(q, world, without=[])  # other options make another checker
    assert not robot.collides(q, pairs=())
    links = [("panda_link1", "panda_link4")]
    other = [("panda_link1", "panda_link5")]
    one, two = (robot.collision_checker(pairs=chosen) for chosen in (links, other))
    assert one is not two and robot.collision_checker(pairs=list(links)) is one
    assert [set(checker.nearest(q)[0].names) for checker in (one, two)] == [set(*links), set(*other)]


def test_a_base_on_its_table_is_no_collision(robot: ulna.Robot) -> None:
    assert not robot.collides(robot.configurations["qr"], table(count=1, link="panda_link1"))


def test_wrong_input(robot: ulna.Robot) -> None:
    q = robot.configurations["qr"]
    with pytest.raises(NonFiniteError, match=r"q\[0, 3\]` is nan"):
        robot.collides([[*q[:3], np.nan, *q[4:]]])
    with pytest.raises(ShapeError):
        robot.distance(q[:6])
    with pytest.raises(InputError, match="margin"):
        robot.collides(q, margin=np.nan)
    with pytest.raises(UnknownName, match="spheres"):
        robot.collides(q, method="sphere")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="World"):
        robot.collides(q, "table")  # type: ignore[arg-type]
    with pytest.raises(ShapeError, match="one configuration"):
        robot.collision_checker().nearest([q, q])
    with pytest.raises(InputError, match="margin"):
        robot.first_contact(q, q, margin=-0.1)


def test_a_robot_without_geometry_is_never_called_free() -> None:
    builder = ModelBuilder("ghost")
    builder.add_link("only")
    with pytest.raises(ModelError, match="no collision geometry"):
        ulna.Robot(builder.build()).collides([])


def test_a_shape_without_volume_is_refused() -> None:
    with pytest.raises(ModelError, match=r"box 0 x 1 x 1 m of link 'cart'.*no volume"):
        Checker(slider(Box((0.0, 1.0, 1.0))))


def test_missing_meshes() -> None:
    model = slider(Mesh("/nowhere/hand.stl", missing=True))
    with pytest.raises(ModelError, match=r"hand\.stl of link 'cart' of robot 'slider'.*missing='skip'"):
        Checker(model)
    with (
        pytest.warns(ModelWarning, match=r"hand\.stl"),
        pytest.raises(ModelError, match="no collision geometry"),
    ):
        Checker(model, missing="skip")


def test_meshes_and_their_hulls(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    horseshoe = trimesh.util.concatenate(
        [
            trimesh.creation.box((0.2, 1.0, 0.2), trimesh.transformations.translation_matrix((x, 0.0, 0.0)))
            for x in (-0.5, 0.5)
        ]
        + [
            trimesh.creation.box(
                (1.2, 0.2, 0.2), trimesh.transformations.translation_matrix((0.0, -0.6, 0.0))
            )
        ]
    )
    horseshoe.export(tmp_path / "u.stl")
    model = slider(Mesh(str(tmp_path / "u.stl"), (1.0, 1.0, 2.0)))
    world = World().add("peg", Sphere(0.1))
    assert not Checker(model, world).collides([0.0])  # in the gap
    assert Checker(model, world, convex=True).collides([0.0])
    np.testing.assert_allclose(float(Checker(model, world).distance([0.0])), 0.3, atol=1e-6)
    np.testing.assert_allclose(float(Checker(model, world, convex=True).distance([2.0])), 1.3, atol=1e-6)


@pytest.mark.parametrize("corner", [(0.0, 0.0, 0.0), (0.5, 0.0, 0.0)], ids=["a point", "a line"])
def test_triangles_without_area_touch_no_distant_sphere(tmp_path: Path, corner: Any) -> None:
    trimesh = pytest.importorskip("trimesh")
    vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [*corner]]
    mesh = trimesh.Trimesh(vertices, [[0, 1, 2], [0, 3, 1]], process=False)
    mesh.export(tmp_path / "flat.stl")
    model = slider(Mesh(str(tmp_path / "flat.stl")))
    for place in ([3.0, 0.0, 0.0], [0.5, 0.2, 1.0], [0.2, -2.0, 0.1], [0.5, 0.0, 0.06]):
        world = World().add("ball", Sphere(0.05), place)
        nearest = trimesh.proximity.closest_point_naive(mesh, [place])[1][0]
        found = Checker(model, world).distance([0.0])
        np.testing.assert_allclose(found.distance, nearest - 0.05, atol=1e-6)
        assert not Checker(model, world).collides([0.0])


def test_without_coal_the_extra_is_named(monkeypatch: pytest.MonkeyPatch, robot: ulna.Robot) -> None:
    true_import = builtins.__import__

    def without(name: str, *args: Any, **kwargs: Any) -> Any:
        if name == "coal":
            raise ImportError(name)
        return true_import(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingExtra, match=r"pip install .*'coal>="):
        Checker(robot.model)


def test_links_that_are_seen_but_not_checked_are_named() -> None:
    builder = ModelBuilder("half")
    builder.add_link("rail")
    builder.add_link("cart", collisions=(Geometry("", Sphere(0.1)),))
    builder.add_link("mast", visuals=(Geometry("", Sphere(0.1)),))
    builder.add_joint("slide", Prismatic((1.0, 0.0, 0.0)), "rail", "cart", lower=-5.0, upper=5.0)
    builder.add_joint("lift", Prismatic((0.0, 0.0, 1.0)), "cart", "mast", lower=-5.0, upper=5.0)
    half = ulna.Robot(builder.build())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        Checker(half)
        half.plan([0.0, 0.0], [1.0, 1.0])
        half.collides([0.0, 0.0])
    assert [(w.category, w.filename) for w in caught] == [(ModelWarning, __file__)]
    assert "no collision geometry: 'mast'" in str(caught[0].message)


def test_a_plane_does_not_move() -> None:
    with pytest.raises(ModelError, match="'cart'.*half of space"):
        Checker(slider(Plane()))


def test_first_contact_refuses_what_it_cannot_answer(robot: ulna.Robot) -> None:
    q = robot.configurations["qr"]
    with pytest.raises(InputError, match="is exact, by coal"):
        robot.first_contact(q, q + 0.1, method="spheres")
    far = Checker(slider(Sphere(0.1)), World().add("wall", Sphere(0.1), (0.0, 0.0, 9.0)))
    with pytest.raises(InputError, match="units"):
        first_contact(far, [0.0], [1e9])


def test_first_contact_sees_moving_obstacles_where_they_stand() -> None:
    checker = Checker(slider(Sphere(0.1)), World().add("ball", Sphere(0.1), (3.0, 0.0, 0.0), moving=True))
    there = np.eye(4)
    there[0, 3] = 1.2
    assert first_contact(checker, [0.0], [2.0]) == np.inf
    assert first_contact(checker, [0.0], [2.0], moving={"ball": there}) == pytest.approx(0.5, abs=1e-4)


def test_functions_of_a_model_take_its_robot(robot: ulna.Robot) -> None:
    """They ended in "The robot has no attribute 'links'"."""
    from ulna.collision import SphereChecker, fit, link_pairs, survey

    pytest.importorskip("coal")
    q = robot.configurations["ready"]
    assert link_pairs(robot) == link_pairs(robot.model)
    assert Checker(robot).distance(q).distance == Checker(robot.model).distance(q).distance
    spheres = fit(robot)
    assert SphereChecker(robot, spheres=spheres).model is robot.model
    assert survey(robot, 10) == survey(robot.model, 10)
    with pytest.raises(InputError, match=r"`model` is 'panda'; expected a Robot.*or a Model"):
        Checker("panda")


def test_a_mesh_file_that_changes_or_goes_is_read_again(tmp_path: Path) -> None:
    file = tmp_path / "plate.obj"
    corners = "v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nv 0 0 {0}\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"
    file.write_text(corners.format(1.0))
    builder = ModelBuilder("plate")
    builder.add_link("base")
    builder.add_link("plate", collisions=(Geometry("", Mesh(str(file))),))
    builder.add_joint("turn", Revolute((0.0, 0.0, 1.0)), "base", "plate")
    model = builder.build()
    first = link_solids(model)
    assert link_solids(model)[0] is first[0] and first[0].vertices.max() == 1.0
    file.write_text(corners.format(2.0))
    os.utime(file, ns=(1, 1))
    assert link_solids(model)[0].vertices.max() == 2.0
    file.unlink()
    for _ in range(2):
        with pytest.raises(ModelError, match="not found"):
            link_solids(model)
    skipped = ModelBuilder("two")
    skipped.add_link("base", collisions=(Geometry("", Sphere(0.1)), Geometry("", Mesh(str(file)))))
    for _ in range(2):
        with pytest.warns(ModelWarning, match="not found"):
            assert len(link_solids(skipped.build(), "skip")) == 1


def test_large_batches_are_placed_in_parts(robot: ulna.Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    world = table(count=4).add("ball", Sphere(0.1), moving=True)
    checker = Checker(robot, world.attach("cup", "panda_hand", (0.0, 0.0, 0.1), shape=Cylinder(0.03, 0.1)))
    q = robot.random_configuration(300, seed=1)
    ball = SE3.random(np.random.default_rng(2), (300,)).matrix()
    touching, distance = checker.collides(q, {"ball": ball}), checker.distance(q, {"ball": ball}).distance
    monkeypatch.setattr(broad_phase, "_PLACED", 64)
    np.testing.assert_array_equal(checker.collides(q, {"ball": ball}), touching)
    np.testing.assert_array_equal(checker.distance(q, {"ball": ball}).distance, distance)
    both = checker.collides(q[:, None], {"ball": ball[:2]})
    assert both.shape == (300, 2) and (both[:, 1] == checker.collides(q, {"ball": ball[1]})).all()
    q[299, 3] = np.nan
    with pytest.raises(NonFiniteError, match=r"q\[299, 3\]` is nan"):
        checker.collides(q, {"ball": ball})
