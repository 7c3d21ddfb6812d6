"""Point clouds and height fields as obstacles."""

from __future__ import annotations

import itertools
from functools import cache
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import World, sphere_clearance
from ulna.collision.grids import grid_of, joined, least_distances
from ulna.collision.point_grid import COARSE, FINE, Clouds, clearances, least_square
from ulna.collision.point_sets import MOST_POINTS, surface_points, thinned
from ulna.compiler.procedures import Array1, Array2, f32, procedure
from ulna.errors import InputError, ModelError, ShapeError
from ulna.geometry import Box, Cone, Geometry, HeightField, PointCloud, Sphere
from ulna.model import ModelBuilder, Prismatic
from ulna.planning import Planner
from ulna.spatial import SE3


@cache
def panda() -> Any:
    return ulna.load("panda")


def configurations(count: int) -> Any:
    robot = panda()
    return np.random.default_rng(5).uniform(robot.limits.lower, robot.limits.upper, (count, robot.nq))


def scan(count: int) -> Any:
    """Points on a table top, a wall and a shelf."""
    random = np.random.default_rng(0)
    share = count // 4
    return np.concatenate(
        [
            random.uniform([-0.2, -0.8, -0.1], [1.0, 0.8, -0.1], (count - 2 * share, 3)),
            random.uniform([0.6, -0.8, 0.0], [0.61, 0.8, 0.8], (share, 3)),
            random.uniform([0.2, -0.3, 0.9], [0.6, 0.3, 0.91], (share, 3)),
        ]
    )


def brute(points: Any, centres: Any, radii: Any, rho: float) -> Any:
    """Least distances by looking at every point."""
    apart = np.linalg.norm(centres[..., :, None, :] - points, axis=-1) - radii[:, None] - rho
    return apart.min(axis=(-2, -1))


def test_grids_return_the_least_distance_near_and_a_lower_bound_far() -> None:
    random = np.random.default_rng(1)
    points, radii = scan(2000), random.uniform(0.01, 0.12, 4)
    centres = random.uniform([-1.5, -1.5, -0.6], [2.0, 1.5, 1.6], (400, 4, 3))
    d, expected = (
        least_distances(grid_of(points, 0.004), centres, radii),
        brute(points, centres, radii, 0.004),
    )
    assert (d <= expected + 1e-9).all()
    near = expected < 0.02  # then no centre is farther than T
    assert 0.1 < near.mean() < 0.9
    np.testing.assert_allclose(d[near], expected[near], atol=1e-5)
    assert (d[~near] > 0.015).all()


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((1, 3)),
        np.zeros((50, 3)) + 3.0,
        np.array([[0.0, 0.0, 0.0], [60.0, -70.0, 80.0]]),
        np.linspace([0, 0, 0], [0, 0, 4.0], 300),
    ],
    ids=["one", "equal", "far apart", "a line"],
)
def test_grids_of_odd_clouds(points: Any) -> None:
    random = np.random.default_rng(2)
    at = points[random.integers(len(points), size=300)]
    centres = (at + random.normal(scale=0.15, size=(300, 3)))[:, None]
    radii = np.array([0.1])
    d, expected = least_distances(grid_of(points, 0.02), centres, radii), brute(points, centres, radii, 0.02)
    assert (d <= expected + 1e-9).all()
    near = expected < 0.0
    assert near.any()
    np.testing.assert_allclose(d[near], expected[near], atol=1e-4)


def test_machine_code_of_grids_agrees_with_the_interpreter() -> None:
    random = np.random.default_rng(3)
    grid = joined([(grid_of(scan(300), 0.01), np.eye(4))])
    assert isinstance(grid, Clouds)
    centres = random.uniform([-0.5, -1, -0.3], [1.2, 1, 1.2], (12, 3)).astype(np.float32)
    results = []
    for call in (clearances, clearances.checked, clearances.interpret):
        results.append(np.zeros(6, np.float32))
        call(grid, centres, np.array([0.05, 0.1], np.float32), results[-1], 2)
    np.testing.assert_array_equal(results[0], results[1])
    np.testing.assert_allclose(results[0], results[2], atol=1e-6)


@pytest.mark.parametrize("method", ["exact", "spheres"])
def test_a_cloud_is_balls_about_its_points(method: Any) -> None:
    """The same as separate obstacles."""
    robot, q, points = panda(), configurations(60), scan(60)
    T = SE3.from_translation([0.1, 0.0, 0.2]) @ SE3.from_rpy([0.1, 0.2, 0.3])
    balls = World()
    for k, p in enumerate(points):
        balls = balls.add(f"p{k}", Sphere(0.03), T @ p, touches=["panda_link0"])
    cloud = World().add("scan", PointCloud(points, 0.03), T, touches=["panda_link0"])
    one, other = (robot.collision.checker(w, method=method) for w in (balls, cloud))
    expected, d = one.collides(q), other.collides(q)
    np.testing.assert_array_equal(d, expected)
    assert 0.1 < d.mean() < 0.95
    if method == "exact":
        np.testing.assert_allclose(other.distance(q).distance, one.distance(q).distance, atol=2e-4)
    else:
        clearance, bound = one.clearance(q), other.clearance(q)
        assert (bound <= clearance + 1e-9).all()
        np.testing.assert_allclose(bound[clearance < 0], clearance[clearance < 0], atol=1e-5)
    margin = robot.collision.checker(cloud.set_margin("scan", "panda_hand", 0.1), method=method)
    assert (margin.collides(q) >= d).all() and (margin.collides(q) > d).any()


def test_clouds_move() -> None:
    robot, q = panda(), configurations(5)
    cloud = World().add("scan", PointCloud(scan(500), 0.01), moving=True, touches=["panda_link0"])
    poses = SE3.from_translation(np.random.default_rng(4).uniform(-0.2, 0.2, (5, 3))).matrix()
    for method in ("exact", "spheres"):
        together = robot.collides(q, cloud, moving={"scan": poses}, method=method)
        one_by_one = [
            robot.collides(x, cloud.move("scan", T), method=method) for x, T in zip(q, poses, strict=True)
        ]
        np.testing.assert_array_equal(together, one_by_one)
        assert robot.collides(q[0], cloud, moving={"scan": poses[0]}, method=method) == one_by_one[0]


@cache
def probe() -> Any:
    """A ball that can be anywhere."""
    b = ModelBuilder("probe").add_link("base").add_link("tip", collisions=[Geometry("", Sphere(0.05))])
    for k, axis in enumerate(np.eye(3)):
        parent = "base" if k == 0 else f"m{k}"
        child = "tip" if k == 2 else f"m{k + 1}"
        if child != "tip":
            b.add_link(child)
        b.add_joint(f"j{k}", Prismatic(tuple(axis)), parent, child)
    return ulna.Robot(b.build())


def odd_clouds() -> dict[str, Any]:
    """Clouds that grids have to cope with, by name."""
    random = np.random.default_rng(11)
    turn = SE3.from_rpy([0.4, -0.7, 0.3]).rotation
    return {
        "one": np.array([[0.3, -0.2, 0.1]]),
        "equal": np.full((40, 3), 2.0),
        "two far apart": np.array([[0.0, 0.0, 0.0], [60.0, -70.0, 80.0]]),
        "a line": np.linspace([0, 0, 0], [0, 0, 4.0], 300),
        "a plane askew": np.append(random.uniform(-0.6, 0.6, (3000, 2)), np.zeros((3000, 1)), axis=1)
        @ turn.T,
        "a dense ball": random.normal(scale=0.03, size=(4000, 3)),
        "a room": scan(4000),
        "far from the origin": scan(1000) + [90.0, -60.0, 30.0],
        "a town": random.uniform([-400, -400, 0], [400, 400, 30], (3000, 3)),
        "a planet": random.normal(size=(200, 3)) * 6e6,
    }


@procedure(constants={"W": 8})
def bounds_of(clouds: Clouds, level: int, at: Array2[f32], squares: Array1[f32], W: int) -> None:
    for n in range(0, at.shape[1], W):
        x, y, z = at[0, n : n + W], at[1, n : n + W], at[2, n : n + W]
        squares[n : n + W] = least_square(clouds, 0, level, x, y, z)


@pytest.mark.parametrize("name", odd_clouds())
def test_bounds_of_both_grids_are_below_distances_and_close(name: str) -> None:
    points = odd_clouds()[name].astype(np.float32)
    random = np.random.default_rng(12)
    clouds = grid_of(points.astype(float), 0.005)
    assert sum(a.nbytes for a in clouds) < 40e6
    size = float(np.ptp(points, axis=0).max())
    near = points[random.integers(len(points), size=1000)]
    around = [random.normal(scale=s, size=(500, 3)) for s in (0.05, 0.3)]
    anywhere = random.uniform(points.min(axis=0) - 0.5, points.max(axis=0) + 0.5, (500, 3))
    outside = near[:100] + random.normal(size=(100, 3)) * (2.0 * size + 1.0)
    middles = near[:100]  # on the points themselves
    at = np.concatenate([near[:500] + around[0], near[500:] + around[1], anywhere, outside, middles])
    at = at[: len(at) // 8 * 8].astype(np.float32)
    d = np.sqrt([((points.astype(float) - p) ** 2).sum(axis=1).min() for p in at.astype(float)])
    rounding = 3e-6 + 3e-7 * float(np.abs(at).max())
    for level in (FINE, COARSE):
        squares = np.zeros(len(at), np.float32)
        bounds_of(clouds, level, np.ascontiguousarray(at.T), squares)
        bound = np.sqrt(np.maximum(squares, 0.0))
        assert (bound <= d + rounding).all()
        edge, asked = np.sqrt(clouds.grids[0, level, 4]), clouds.grids[0, level, 8]
        told = (d > 2.0 * edge) & (d < asked)
        loss = (d - bound)[told] / edge
        assert not len(loss) or (np.median(loss) < 0.7 and loss.max() < 1.5)
        assert (bound[d > asked + edge] > 0.9 * asked).all()
    assert clouds.grids[0, FINE, 8] > 0.09 and clouds.grids[0, COARSE, 8] > 0.25


@pytest.mark.parametrize("name", odd_clouds())
def test_spheres_touch_clouds_where_a_point_is_near(name: str) -> None:
    """No touch is missed and none is invented, in single configurations, batches and searches."""
    points, rho, r = odd_clouds()[name], 0.01, 0.05
    points = points[np.linalg.norm(points, axis=1) < 95.0]
    if not len(points):
        return
    T = SE3.from_translation([0.5, -1.0, 0.2]) @ SE3.from_rpy([0.1, 0.2, 0.3])
    world = World().add("scan", PointCloud(points, rho), T)
    random = np.random.default_rng(13)
    q = T @ (points[random.integers(len(points), size=400)] + random.normal(scale=0.04, size=(400, 3)))
    placed = T @ points
    gap = np.array([np.linalg.norm(placed - p, axis=1).min() for p in q]) - r - rho
    robot, sure = probe(), np.abs(gap) > 3e-4
    assert (gap < 0)[sure].any() and (name == "a dense ball" or (gap > 0)[sure].any())
    checker = robot.collision.checker(world, method="spheres")
    np.testing.assert_array_equal(checker.collides(q)[sure], (gap < 0)[sure])
    for k in np.flatnonzero(sure)[:60]:
        assert checker.collides(q[k]) == (gap[k] < 0)
    planner = Planner(robot, world)
    for k in np.flatnonzero(np.abs(gap) > 1e-3)[:60]:
        assert (planner.plan(q[k], q[k]).outcome == "solved") == (gap[k] > 0)


def test_plans_among_points_touch_none_between_their_samples() -> None:
    robot, random = panda(), np.random.default_rng(14)
    points = scan(1000)
    world = World().add("scan", PointCloud(points, 0.01), touches=["panda_link0"])
    planner, found = Planner(robot, world, method="spheres"), 0
    spheres = robot.collision.checker(world, method="spheres").spheres
    free = [x for x in configurations(60) if planner.plan(x, x)]
    for path in itertools.starmap(planner.plan, itertools.pairwise(free)):
        if not path or path.method != "spheres":  # real shapes may be nearer to the points than spheres
            continue
        found += 1
        assert path.is_certified
        parts = random.uniform(size=(20, 1))
        at = np.concatenate([a + parts * (b - a) for a, b in itertools.pairwise(path.points)])
        poses = robot.link_poses(at)
        for link, balls in spheres.links.items():
            if link != "panda_link0":
                T = poses[:, robot.link_names.index(link)]
                centres = balls.centres @ T[:, :3, :3].mT + T[:, None, :3, 3]
                squares = (centres**2).sum(axis=-1)[..., None] - 2.0 * centres @ points.T
                apart = np.sqrt((squares + (points**2).sum(axis=1)).min(axis=-1)) - balls.radii - 0.01
                assert (apart > 0.0).all()
    assert found > 5


def test_height_fields_are_their_triangles() -> None:
    robot = probe()
    x, y = np.meshgrid(np.linspace(-1, 1, 21), np.linspace(-0.5, 0.5, 11), indexing="ij")
    field = HeightField(0.1 * np.sin(4 * x) + 0.05 * y, (2.0, 1.0))
    assert field == HeightField(field.heights.copy(), (2.0, 1.0)) and field != HeightField(
        field.heights + 1.0, (2.0, 1.0)
    )
    ground = World().add("ground", field, (0.0, 0.0, 0.2))
    q = np.random.default_rng(6).uniform([-1, -0.5, -0.1], [1, 0.5, 0.6], (200, 3))
    exact = robot.distance(q, ground).distance
    clearance = robot.collision.checker(ground, method="spheres").clearance(q)
    assert (clearance <= exact + 1e-6).all() and (exact - clearance)[abs(exact - 0.02) < 0.02].max() < 0.012
    above = robot.distance([0.0, 0.0, 0.5], World().add("flat", HeightField(np.zeros((2, 2)), (1.0, 1.0))))
    assert above.distance == pytest.approx(0.45, abs=1e-6)


@pytest.mark.parametrize("cone", [Cone(0.2, 0.3), Cone(0.05, 0.3), Cone(0.3, 0.05)])
def test_cones_are_covered_closely(cone: Cone) -> None:
    robot = probe()
    world = World().add("cone", cone, (0.0, 0.0, 0.1))
    q = np.random.default_rng(0).uniform(-0.4, 0.4, (500, 3))
    exact, clearance = (
        robot.distance(q, world).distance,
        robot.collision.checker(world, method="spheres").clearance(q),
    )
    free = clearance > 0.0
    assert (clearance[free] <= exact[free] + 1e-6).all() and (exact - clearance)[free].max() < 0.0071


def test_surfaces_are_covered_by_their_points() -> None:
    random = np.random.default_rng(7)
    vertices = random.uniform(size=(12, 3)) * [0.3, 0.2, 0.05]
    triangles = np.array([[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11], [2, 3, 3]])
    points, rho = surface_points(vertices, triangles)
    weights = random.dirichlet([0.5, 0.5, 0.5], size=(5, 100))
    samples = np.einsum("tnk,tkx->tnx", weights, vertices[triangles]).reshape(-1, 3)
    assert brute(points, samples[:, None], np.zeros(1), rho).max() <= 1e-12


def test_very_many_points_are_merged_and_stay_covered() -> None:
    cloud = PointCloud(
        np.random.default_rng(8).uniform([0, 0, 0], [3, 2, 0.001], (MOST_POINTS + 50_000, 3)), 0.01
    )
    points, radius = thinned(cloud)
    assert 1000 < len(points) <= MOST_POINTS and 0.01 < radius < 0.03
    d = least_distances(grid_of(points, radius), cloud.points[::37][:, None], np.full(1, 1e-6))
    assert d.max() <= -0.01 + 1e-4
    few = PointCloud(np.zeros((5, 3)), 0.01)
    assert thinned(few)[1] == 0.01 and thinned(few)[0] is few.points


def test_invalid_point_clouds_are_refused() -> None:
    robot = panda()
    for make, error, text in [
        (
            lambda: PointCloud(np.full((4, 3), np.nan)),
            InputError,
            "12 numbers that are nan or inf, the first in row 0",
        ),
        (lambda: PointCloud(np.zeros((4, 2))), ShapeError, r"\(n, 3\)"),
        (lambda: PointCloud([["a"]]), InputError, "no array of numbers"),  # type: ignore[list-item]
        (lambda: PointCloud(np.zeros((4, 3)), -1.0), InputError, "not negative"),
        (lambda: HeightField(np.zeros((1, 4)), (1.0, 1.0)), ShapeError, r"at least \(2, 2\)"),
        (lambda: HeightField(np.zeros((2, 4)), (1.0, 0.0)), InputError, "above 0"),
        (
            lambda: sphere_clearance(robot.model, World().add("c", PointCloud(np.ones((1, 3))))),
            InputError,
            "no formula",
        ),
    ]:
        with pytest.raises(error, match=text):
            make()  # type: ignore[no-untyped-call]
    empty = World().add("nothing", PointCloud(np.zeros((0, 3))))
    q = robot.configurations["ready"]
    assert not robot.collides(q, empty) and not robot.collides(q, empty, method="spheres")
    assert "cloud of 0 points" in repr(PointCloud([]))
    b = (
        ModelBuilder("odd")
        .add_link("base")
        .add_link("arm", collisions=[Geometry("", PointCloud(np.zeros((1, 3))))])
    )
    with pytest.raises(ModelError, match="expected a body"):
        ulna.Robot(b.add_joint("j", Prismatic((1.0, 0, 0)), "base", "arm").build()).collides([0.0])
    with pytest.raises(InputError, match="expected a body"):
        robot.collides(q, World().attach("scan", "panda_hand", shape=PointCloud(np.zeros((1, 3)))))


def test_equal_clouds_are_one_value() -> None:
    points = scan(100)
    a, b = PointCloud(points, 0.01), PointCloud(points.copy(), 0.01)
    assert a == b and hash(a) == hash(b) and a != PointCloud(points, 0.02) and a != Box((1, 1, 1))
    assert World().add("s", a).fingerprint == World().add("s", b).fingerprint
    with pytest.raises(ValueError, match="read-only"):
        a.points[0, 0] = 1.0
