"""Planning as a method of the robot."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna.errors import TraceError
from ulna.planning import plan


def test_the_method_is_the_function() -> None:
    robot = ulna.load("ur5")
    a, b = robot.configurations["qz"] * 0.0 + 0.1, np.array([0.5, -1.0, 0.8, 0.2, 0.3, 0.1])
    p, same = robot.plan(a, b, seed=2), plan(robot, a, b, seed=2)
    assert p and p.is_certified
    np.testing.assert_array_equal(p.points, same.points)
    T = robot.fk(b, "wrist_3_link")
    reached = robot.plan(a, T, frame="wrist_3_link").points[-1]
    np.testing.assert_allclose(robot.fk(reached, "wrist_3_link"), T, atol=2e-6)
    with pytest.raises(TraceError, match=r"robot\.plan takes numbers only"):
        ulna.compile(lambda q: robot.plan(q, b).points, robot)
