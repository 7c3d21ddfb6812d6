"""Laws of collision: what is symmetric, what rigid motions leave alone, gradients, segments against dense sampling."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ulna
from support.scenes import BASES, table
from ulna.collision import Checker, SphereChecker, World, fit, sphere_clearance
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Geometry, Shape, Sphere
from ulna.model import FreeFlyer, Model, ModelBuilder
from ulna.spatial import SE3

SHAPES: tuple[Shape, ...] = (
    Sphere(0.2),
    Box((0.2, 0.3, 0.4)),
    Cylinder(0.1, 0.5),
    Capsule(0.1, 0.4),
    Cone(0.2, 0.4),
    Ellipsoid((0.1, 0.2, 0.3)),
)


def floating(shape: Shape) -> Model:
    builder = ModelBuilder("floating")
    builder.root_joint(FreeFlyer())
    builder.add_link("body", collisions=(Geometry("", shape),))
    return builder.build()


def configuration(pose: SE3) -> np.ndarray:
    return np.concatenate([pose.translation, pose.quat_xyzw()])


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(SHAPES), st.sampled_from(SHAPES), st.integers(0, 10**6))
def test_distance_is_symmetric_and_rigid_motions_leave_it(a: Shape, b: Shape, seed: int) -> None:
    rng = np.random.default_rng(seed)
    A, B, move = (SE3.random(rng, reach=0.5) for _ in range(3))
    there = Checker(floating(a), World().add("b", b, B)).distance(configuration(A))
    back = Checker(floating(b), World().add("a", a, A)).distance(configuration(B))
    moved = Checker(floating(a), World().add("b", b, move @ B)).distance(configuration(move @ A))
    # coal's iterations stop within 1e-6, and where shapes overlap the deepest direction need not be unique
    assert float(back) == pytest.approx(float(there), abs=5e-6)
    assert float(moved) == pytest.approx(float(there), abs=5e-6)
    assert (float(there) <= 0.0) == Checker(floating(a), World().add("b", b, B)).collides(
        configuration(A)
    ) or abs(float(there)) < 1e-6
    if float(there) > 1e-3:
        np.testing.assert_allclose(there.points[1] - there.points[0], float(there) * there.normal, atol=1e-5)


@pytest.mark.parametrize("shift", [1, 2, 3])
@pytest.mark.parametrize("number", range(6))
def test_spheres_are_never_farther_than_shapes(number: int, shift: int) -> None:
    a, b = SHAPES[number], SHAPES[(number + shift) % 6]
    rng = np.random.default_rng(number)
    world = World().add("b", b, SE3.random(rng, reach=0.4))
    model = floating(a)
    q = np.array([configuration(SE3.random(rng, reach=0.4)) for _ in range(30)])
    exact = Checker(model, world)
    checker = SphereChecker(model, world, spheres=fit(model, 0.03, 4))
    d, gap = exact.distance(q).distance, checker.clearance(q)
    assert (gap <= np.maximum(d, 0.0) + 2e-6).all()
    assert checker.collides(q)[exact.collides(q)].all()
    assert checker.collides(q, margin=0.05)[exact.collides(q, margin=0.05)].all()


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_gradients_are_derivatives_of_distances(name: str) -> None:
    robot = ulna.load(name)
    world = table(BASES[name])
    checker = Checker(robot.model, world)
    q = robot.random_configuration(12, seed=3)
    step = 1e-5 * np.eye(robot.nv)
    ahead = checker.distance(robot.integrate(q[:, None], step))
    behind = checker.distance(robot.integrate(q[:, None], -step))
    here = checker.distance(q)
    same = (ahead.names == here.names[:, None]).all(axis=-1) & (behind.names == here.names[:, None]).all(
        axis=-1
    )
    numeric = (ahead.distance - behind.distance) / 2e-5
    smooth = same & (here.distance > 1e-3)[:, None]
    # nearest points of parallel edges and faces jump; those of most rows do not, and coal's own error is 1e-6 / 1e-5
    error = np.abs(checker.gradient(q) - numeric)[smooth]
    assert smooth.sum() > 10 and np.median(error) < 1e-3 and (error < 0.03).mean() > 0.9


def test_gradients_of_spheres_are_derivatives() -> None:
    robot = ulna.load("panda")
    f = sphere_clearance(
        robot.model, World(table().obstacles[:3]), spheres=fit(robot.model, 0.03, 3), pairs=(), smooth=0.02
    )
    kernel = ulna.compile(f, robot)
    q = robot.random_configuration(5, seed=1)
    step = 1e-6 * np.eye(7)
    numeric = (kernel(q[:, None] + step) - kernel(q[:, None] - step)) / 2e-6
    np.testing.assert_allclose(kernel.jacobian()(q), numeric, atol=1e-7)


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_segments_against_dense_sampling(name: str) -> None:
    """Contact is never reported later than sampling sees it, and not much earlier than it is there."""
    robot = ulna.load(name)
    checker = Checker(robot.model, table(BASES[name]))
    q = robot.random_configuration(200, seed=5)
    q = q[~checker.collides(q)][:24]
    start, end = q[:12], q[12:]
    found = robot.first_contact(start, end, checker.world)
    times = np.linspace(0.0, 1.0, 401)
    hits = checker.collides(robot.interpolate(start[:, None], end[:, None], times))
    seen = np.where(hits.any(axis=1), times[hits.argmax(axis=1)], np.inf)
    assert (found <= seen).all()
    sure = np.isfinite(seen)
    assert sure.any() and (seen[sure] - found[sure]).max() < 5e-3
    near = checker.distance(robot.interpolate(start, end, np.where(np.isfinite(found), found, 0.0)))
    assert (near.distance[np.isfinite(found)] <= 1.01e-4).all()


def test_a_segment_does_not_tunnel() -> None:
    """A thin wall between two free ends, that a handful of samples would jump over."""
    model, wall = floating(Sphere(0.01)), World().add("wall", Box((1e-3, 9.0, 9.0)))
    ends = [configuration(SE3.from_translation((x, 0.0, 0.0))) for x in (-1.0, 1.0)]
    checker = Checker(model, wall)
    assert not checker.collides(ends).any()
    time = ulna.Robot(model).first_contact(*ends, wall)
    assert 0.5 - (0.0105 + 2e-4) / 2.0 <= time <= 0.5 - 0.0105 / 2.0
    assert ulna.Robot(model).first_contact(*ends, wall, margin=0.1) == pytest.approx(
        0.5 - 0.1105 / 2, abs=2e-4
    )
    assert np.isinf(ulna.Robot(model).first_contact(ends[0], ends[0], wall))
