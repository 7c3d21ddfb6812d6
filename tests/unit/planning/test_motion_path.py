"""The curve that motions follow: exact, or near the path by what the bounds allow; continuous joints as planned."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import ulna
from ulna.errors import InputError
from ulna.geometry import Box, Geometry
from ulna.model import Continuous, ModelBuilder
from ulna.planning import plan
from ulna.planning.jerk_motion import jerk_limited_motion
from ulna.planning.motion_path import motion_path


def test_the_curve_passes_all_numbers_between_the_points() -> None:
    robot = ulna.load("panda")
    path = motion_path(robot.model, np.array([np.zeros(7), np.full(7, 5.0)]))
    q = path(np.linspace(0.0, path.duration, 11))
    np.testing.assert_allclose(q, np.linspace(0.0, 5.0, 11)[:, None] * np.ones(7), atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_blends_deviate_by_no_more_than_they_may(seed: int) -> None:
    random = np.random.default_rng(seed)
    model = ulna.load("panda").model
    points = random.normal(size=(12, 7)) * 10.0 ** random.uniform(-3, 0.5)
    bounds = random.uniform(0.0, 1.0, (4, 7)) * 10.0 ** random.uniform(0, 3)
    curve = motion_path(model, points, bounds)
    s = np.linspace(0.0, curve.duration, 40_000)
    q, v = curve.state(s)[:2]
    t = np.linspace(0.0, 1.0, 3_000)[:, None]
    near = np.full(len(q), np.inf)
    samples = range(0, len(q), 400)
    polyline = np.concatenate([a + t * (b - a) for a, b in pairwise(points)])
    for k in samples:
        near[k] = (np.abs(polyline - q[k]) @ bounds.T).max(axis=1).min()
    spacing = (np.abs(np.diff(points, axis=0)) @ bounds.T).max() / 3_000
    assert near[list(samples)].max() <= 1.0 + spacing
    speed = np.linalg.norm(v, axis=1)
    assert speed.max() < 1.0 + 1e-9 and np.abs(np.diff(v, axis=0)).max() < 0.5  # the tangent does not jump
    np.testing.assert_allclose(q[[0, -1]], points[[0, -1]], atol=1e-9)


def test_continuous_joints_turn_the_way_that_was_planned() -> None:
    """A turn of 5 rad is no turn of -1.28 rad: only the former was certified."""
    b = ModelBuilder("one").add_link("base").add_link("arm", collisions=[Geometry("", Box((0.4, 0.1, 0.1)))])
    b.add_joint("turn", Continuous((0, 0, 1)), "base", "arm", velocity=2.0)
    robot = ulna.Robot(b.build())
    p = plan(robot, [0.0], [5.0])
    assert p.is_certified
    motion = p.trajectory(acceleration=5.0, torque=np.inf)
    q = motion(np.linspace(0.0, motion.duration, 200))
    assert (np.diff(q[:, 0]) >= -1e-12).all() and q[-1, 0] == pytest.approx(5.0)


def test_points_that_repeat_count_once() -> None:
    model = ulna.load("panda").model
    a, b, c = np.random.default_rng(0).normal(size=(3, 7))
    for make in (lambda q: motion_path(model, q), lambda q: jerk_limited_motion(model, q, None, 5.0, 60.0)):
        motion, repeated = make(np.stack([a, b, c])), make(np.stack([a, a, b, b, c, c]))
        assert repeated.duration == motion.duration
        np.testing.assert_array_equal(repeated(0.4 * motion.duration), motion(0.4 * motion.duration))
        for points in ([a], [a, a]):
            with pytest.raises(InputError, match="The start is the goal; there is nothing to move"):
                make(np.stack(points))
