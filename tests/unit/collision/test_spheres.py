"""Covers, sphere checkers, and spheres as values."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import ulna
from support.scenes import table
from ulna.collision import LinkSpheres, SphereChecker, Spheres, World, fit, sphere_clearance
from ulna.collision.compiled import TOUCH
from ulna.collision.cover import cover
from ulna.collision.solids import Solid
from ulna.errors import (
    FormatError,
    InputError,
    ModelError,
    ModelWarning,
    NonFiniteError,
    ShapeError,
    UnknownName,
)
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Geometry, Mesh, Plane, Shape, Sphere
from ulna.model import Model, ModelBuilder, Prismatic
from ulna.spatial import SE3
from ulna.typing import Floats

SHAPES: list[Shape] = [
    Sphere(0.2),
    Capsule(0.05, 0.3),
    Capsule(0.05, 0.0001),
    Cylinder(0.05, 0.3),
    Cylinder(0.3, 0.05),
    Cylinder(0.1, 0.2),
    Box((0.1, 0.2, 0.3)),
    Box((0.02, 0.5, 0.5)),
    Cone(0.1, 0.3),
    Ellipsoid((0.05, 0.1, 0.2)),
]
TETRAHEDRON = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.3]])


def solid(shape: Shape) -> Solid:
    if isinstance(shape, Mesh):
        faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        return Solid("x", shape, -1, SE3.identity(), TETRAHEDRON, faces)
    return Solid("x", shape, -1, SE3.identity(), np.zeros((0, 3)), np.zeros((0, 3), dtype=int))


def inside(shape: Shape, x: Floats) -> Floats:
    """Which points lie in a shape, by its definition."""
    rho, z = np.hypot(x[:, 0], x[:, 1]), x[:, 2]
    match shape:
        case Sphere(radius=r):
            return (x**2).sum(axis=1) <= r * r
        case Capsule(radius=r, length=length):
            return np.hypot(rho, np.maximum(abs(z) - length / 2, 0.0)) <= r
        case Cylinder(radius=r, length=length):
            return (rho <= r) & (abs(z) <= length / 2)
        case Box(size=size):
            return (abs(x) <= np.array(size) / 2).all(axis=1)
        case Cone(radius=r, length=length):
            return (abs(z) <= length / 2) & (rho <= r * (0.5 - z / length))
        case Ellipsoid(radii=radii):
            return ((x / np.array(radii)) ** 2).sum(axis=1) <= 1.0
    return (x >= 0.0).all(axis=1) & (x.sum(axis=1) <= 0.3)  # the tetrahedron


@pytest.mark.parametrize("shape", [*SHAPES, Mesh("tetrahedron")], ids=lambda s: s.describe())
def test_covers_hold_the_shape_and_keep_to_their_bound(shape: Shape) -> None:
    turn = SE3.from_rpy((0.3, -0.5, 1.0), (0.1, 0.2, 0.3))
    centres, radii, excess = cover([solid(shape)], [turn], 0.012, 24)
    assert 0 < len(radii) <= 64
    low, half = solid(shape).bounds
    rng = np.random.default_rng(0)
    x = low + half * rng.uniform(-1.0, 1.0, (60_000, 3))
    corners = low + half * (np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3), axis=-1).reshape(-1, 3))
    x = np.vstack([x, corners])
    x = x[inside(shape, x)]
    gap = np.linalg.norm((turn @ x)[:, None] - centres, axis=-1) - radii
    assert gap.min(axis=1).max() <= 1e-12
    # no point of a sphere is farther from the points inside than the bound and the density of the points allow
    u = rng.standard_normal((400, 3))
    rim = turn.inverse() @ (
        centres[:, None] + radii[:, None, None] * u / np.linalg.norm(u, axis=1, keepdims=True)
    ).reshape(-1, 3)
    from scipy.spatial import KDTree

    assert KDTree(x).query(rim)[0].max() <= excess + 0.02


def test_redundant_spheres_are_removed() -> None:
    big, small = solid(Sphere(0.2)), solid(Box((0.05, 0.05, 0.05)))
    centres, _, _ = cover([small, big], [SE3.identity(), SE3.identity()], 0.012, 24)
    np.testing.assert_allclose(centres, np.zeros((1, 3)))
    with pytest.raises(InputError, match="boundless"):
        cover([solid(Plane())], [SE3.identity()], 0.012, 24)


def test_spheres_are_values() -> None:
    spheres = fit(ulna.load("ur5").model)
    again = Spheres.from_json(spheres.to_json())
    assert again.fingerprint == spheres.fingerprint and again.excess == spheres.excess
    assert fit(ulna.load("ur5").model).fingerprint == spheres.fingerprint  # from the disk
    name = next(iter(spheres.links))
    edited = spheres.replace(name, [[0.0, 0.0, 0.0]], [0.5])
    assert edited.excess[name] is None and edited.fingerprint != spheres.fingerprint
    assert edited.count == spheres.count - len(spheres.links[name].radii) + 1
    np.testing.assert_allclose(spheres.grown(0.1).links[name].radii, spheres.links[name].radii + 0.1)
    for bad in ("{}", "[]", "no", '{"links": {"a": {"centres": 1, "radii": 2}}}'):
        with pytest.raises((FormatError, ShapeError)):
            Spheres.from_json(bad)


@pytest.mark.parametrize(
    ("centres", "radii", "error"),
    [
        ([0.0, 0.0, 0.0], [0.1], ShapeError),
        ([[0.0, 0.0, 0.0]], [0.1, 0.2], ShapeError),
        ([[0.0, 0.0, 0.0]], [-0.1], InputError),
        ([[0.0, np.nan, 0.0]], [0.1], NonFiniteError),
    ],
)
def test_invalid_spheres_are_refused(centres: object, radii: object, error: type) -> None:
    with pytest.raises(error):
        LinkSpheres(np.asarray(centres), np.asarray(radii))


def test_the_checker_is_what_its_function_says() -> None:
    """Verdict, clearance, margin and the function for users' own kernels agree; also with moving obstacles."""
    robot, world = ulna.load("panda"), table()
    world = world.add("plane", Plane(), (0.0, 0.0, -0.5)).add("cone", Cone(0.05, 0.3), (0.4, 0.5, 0.3))
    spheres = fit(robot.model, 0.03, 4)  # few
    checker = SphereChecker(robot.model, world, spheres=spheres)
    q = robot.random_configuration((2, 40), seed=4)
    gaps = checker.clearance(q)
    np.testing.assert_array_equal(checker.collides(q), gaps <= 1e-6)
    np.testing.assert_array_equal(checker.collides(q, margin=0.02), gaps <= 0.02 + 1e-6)
    np.testing.assert_array_equal(checker.collides(q, threads=2), checker.collides(q))
    assert checker.collides(q[0, 0]) == (gaps[0, 0] <= 1e-6)
    assert checker.clearance(q[1, 3]) == pytest.approx(gaps[1, 3], abs=1e-12)
    few = World(world.obstacles[:3])
    f = sphere_clearance(robot.model, few, spheres=spheres)
    expected = SphereChecker(robot.model, few, spheres=spheres).clearance(q[0, :5])
    np.testing.assert_allclose([f(row) for row in q[0, :5]], expected, atol=1e-12)
    smooth = sphere_clearance(robot.model, few, spheres=spheres, smooth=0.01)
    assert all(smooth(row) <= f(row) <= smooth(row) + 0.01 * np.log(3000) for row in q[0, :5])


def test_moving_obstacles_need_no_other_kernel() -> None:
    robot = ulna.load("panda")
    world = World().add("ball", Sphere(0.1), (0.4, 0.0, 0.4), moving=True)
    checker = robot.collision_checker(world, method="spheres")
    q = robot.random_configuration(50, seed=1)
    poses = np.tile(np.eye(4), (50, 1, 1))
    poses[:, :3, 3] = np.random.default_rng(1).uniform(-0.6, 0.6, (50, 3))
    found = checker.clearance(q, {"ball": poses})
    for k in range(0, 50, 7):
        there = SphereChecker(
            robot.model, world.move("ball", SE3.from_matrix(poses[k])), spheres=checker.spheres
        )
        assert there.clearance(q[k]) == pytest.approx(found[k], abs=1e-12)
    assert checker.clearance(q[0], {"ball": poses}).shape == (50,)


def test_wrong_input() -> None:
    robot = ulna.load("panda")
    checker = SphereChecker(robot.model, World().add("ball", Sphere(0.1)))
    q = robot.configurations["qr"]
    with pytest.raises(NonFiniteError):
        checker.collides([*q[:6], np.nan])
    with pytest.raises(NonFiniteError):
        checker.clearance(np.full((3, 7), np.inf))
    with pytest.raises(ShapeError):
        checker.collides(q[:6])
    with pytest.raises(ShapeError):
        checker.collides(np.zeros((4, 6)))
    with pytest.raises(InputError, match="margin"):
        checker.collides(q, margin=-0.1)
    with pytest.raises(UnknownName, match="'ball'"):
        checker.collides(q, {"bal": np.eye(4)})
    with pytest.raises(InputError, match="does not move"):
        checker.collides(q, {"ball": np.eye(4)})
    with pytest.raises(UnknownName, match="panda_hand"):
        SphereChecker(robot.model, spheres=Spheres({"panda_hnd": LinkSpheres(np.zeros((1, 3)), np.ones(1))}))
    with pytest.raises(InputError, match="none for link 'panda_link0'"):
        SphereChecker(robot.model, spheres=Spheres({"panda_hand": LinkSpheres(np.zeros((1, 3)), np.ones(1))}))
    with pytest.raises(InputError, match="tolerance"):
        fit(robot.model, 0.0)
    with pytest.raises(InputError, match="most"):
        fit(robot.model, 0.01, 0)
    builder = ModelBuilder("ghost")
    builder.add_link("only")
    with pytest.raises(ModelError, match="no collision geometry"):
        SphereChecker(builder.build())
    assert checker.collides(np.zeros((0, 7))).shape == (0,)


def two_links(first: str, second: str, shape: Shape) -> Model:
    """Two links of one shape, each on its own slide."""
    builder = ModelBuilder("two")
    builder.add_link("rail")
    for k, name in enumerate((first, second)):
        builder.add_link(name, collisions=(Geometry("", shape),))
        axis = (1.0, 0.0, 0.0) if k else (0.0, 1.0, 0.0)
        builder.add_joint(f"slide{k}", Prismatic(axis), "rail", name, lower=-5.0, upper=5.0)
    return builder.build()


def test_spheres_are_kept_on_disk_and_links_of_equal_shape_are_fitted_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from ulna.collision import covering

    monkeypatch.setenv("ULNA_CACHE", str(tmp_path))
    made: list[str] = []
    real = covering.link_task
    monkeypatch.setattr(covering, "link_task", lambda m, name, s: made.append(name) or real(m, name, s))
    model, steps = two_links("left", "right", Box((0.1, 0.1, 0.1234))), []
    first = fit(model, progress=lambda *step: steps.append(step))
    assert list(first.links) == ["left", "right"] and made == ["left"]
    assert steps == sorted(steps) and steps[0][0] == 0 and steps[-1][0] == steps[-1][1]
    np.testing.assert_array_equal(first.links["left"].centres, first.links["right"].centres)
    assert fit(model) == first and fit(model).excess == first.excess and len(made) == 1
    other = fit(two_links("left", "other", Box((0.1, 0.1, 0.1234)))).links[
        "other"
    ]  # a robot that has such links
    np.testing.assert_array_equal(other.centres, first.links["left"].centres)
    np.testing.assert_array_equal(other.radii, first.links["left"].radii)
    assert other.excess == first.links["left"].excess and len(made) == 1
    fit(two_links("left", "right", Box((0.1, 0.1, 0.1235))))
    assert len(made) == 2


def test_a_link_whose_mesh_is_skipped_is_not_asked_for_spheres() -> None:
    builder = ModelBuilder("gap")
    builder.add_link("rail")
    for k, shape in enumerate((Sphere(0.1), Mesh("nowhere.stl", missing=True))):
        builder.add_link(f"link{k}", collisions=(Geometry("", shape),))
        builder.add_joint(f"slide{k}", Prismatic((1.0, 0.0, 0.0)), "rail", f"link{k}", lower=-5.0, upper=5.0)
    world = World().add("ball", Sphere(0.1), (1.0, 0.0, 0.0))
    with pytest.warns(ModelWarning, match="nowhere"):
        checker = SphereChecker(builder.build(), world, missing="skip")
        assert checker.collides([1.0, 0.0]) and not checker.collides([0.0, 1.0])


def test_spheres_given_to_a_bare_link_are_seen() -> None:
    builder = ModelBuilder("bare")
    builder.add_link("rail")
    builder.add_link("body", collisions=(Geometry("", Sphere(0.1)),))
    builder.add_link("mast")
    builder.add_joint("slide", Prismatic((1.0, 0.0, 0.0)), "rail", "body", lower=-5.0, upper=5.0)
    builder.add_joint("lift", Prismatic((0.0, 0.0, 1.0)), "body", "mast", lower=-5.0, upper=5.0)
    model = builder.build()
    world = World().add("lamp", Sphere(0.1), (0.0, 0.0, 2.0))
    more = fit(model).replace("mast", [[0.0, 0.0, 0.0]], [0.1])
    assert not SphereChecker(model, world).collides([0.0, 2.0])
    assert SphereChecker(model, world, spheres=more).collides([0.0, 2.0])


def test_a_link_that_an_obstacle_may_touch_must_exist() -> None:
    world = World().add("table", Box((1.0, 1.0, 0.1)), touches=["panda_hnd"])
    with pytest.raises(UnknownName, match="panda_hand"):
        SphereChecker(ulna.load("panda").model, world)


def test_more_pairs_of_spheres_than_compile_in_seconds_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    from ulna.collision import sphere_kernels

    sphere_kernels.self_collision_kernel.cache_clear()  # other tests asked for these spheres
    monkeypatch.setattr(sphere_kernels, "MOST_COUPLES", 10)
    robot = ulna.load("panda")
    spheres = robot.collision_spheres(tolerance=0.03, most=3)
    with pytest.raises(InputError, match=r"pairs of its own spheres, more than the 10 .*method='exact'"):
        SphereChecker(robot.model, spheres=spheres).clearance(np.zeros(7))
    checker = SphereChecker(robot.model, spheres=spheres)
    q = robot.random_configuration(100, seed=4) * 1.2  # some beyond the limits, where float64 decides
    touching = checker.collides(q)
    monkeypatch.undo()
    np.testing.assert_array_equal(touching, SphereChecker(robot.model, spheres=spheres).clearance(q) <= TOUCH)


@pytest.mark.parametrize("smooth", [None, 0.02])
def test_gradients_in_single_precision_are_finite_inside_of_obstacles(smooth: float | None) -> None:
    robot = ulna.load("panda")
    one = LinkSpheres(np.array([[0.0, 0.02, 0.05]]), np.array([0.05]))
    world = World().add("room", Box((2.0, 3.0, 4.0)), (0.0, 0.0, 0.3))
    spheres = Spheres({"panda_link4": one, "panda_hand": one})
    f = sphere_clearance(robot.model, world, spheres=spheres, pairs=(), smooth=smooth)
    double, single = (ulna.compile(f, robot, dtype=dtype).jacobian() for dtype in ("float64", "float32"))
    q = robot.configurations["qr"]
    assert np.abs(double(q)).max() > 1e-3
    np.testing.assert_allclose(single(q), double(q), atol=1e-5)
