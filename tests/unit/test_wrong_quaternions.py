"""Configurations whose quaternions are not of unit length are refused where no kernel of the user checks them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import Checker
from ulna.errors import InputError
from ulna.geometry import Geometry, Sphere
from ulna.model import Circle, Composite, FreeFlyer, ModelBuilder, PlanarCircle, Prismatic, Revolute
from ulna.robot import Robot
from ulna.sim import Body, dynamic_step, simulate
from ulna.spatial import SE3, Inertia


@pytest.fixture(scope="module")
def robot() -> Robot:
    """A free body with an arm."""
    builder = ModelBuilder("floating").add_link("world")
    ball = Geometry("", Sphere(0.1))
    builder.add_link("trunk", Inertia.from_box(2.0, (0.1, 0.2, 0.3)), collisions=(ball,))
    builder.add_link("arm", Inertia.from_box(1.0, (0.1, 0.1, 0.1)), collisions=(ball,))
    builder.add_link("hand", Inertia.from_box(1.0, (0.1, 0.1, 0.1)), collisions=(ball,))
    builder.add_joint("base", FreeFlyer(), "world", "trunk")
    builder.add_joint("shoulder", Revolute((0, 0, 1)), "trunk", "arm", SE3.trans(0.3, 0, 0))
    builder.add_joint("wrist", Revolute((0, 1, 0)), "arm", "hand", SE3.trans(0.3, 0, 0))
    return Robot(builder.build())


@pytest.mark.parametrize("length", [0.0, 2.0, 1.001])
def test_quaternions_that_are_not_unit_are_refused(robot: Robot, length: float) -> None:
    q = length * robot.neutral
    tau = np.zeros(robot.nv)
    body = Body(robot)
    asked: list[Any] = [
        lambda: simulate(robot, q, duration=0.01),
        lambda: dynamic_step(robot, q, tau, tau, 0.01),
        lambda: Body(robot, q=q),
        lambda: setattr(body, "q", q),
        lambda: setattr(body, "target", q),
        lambda: robot.collides(q),
        lambda: robot.collides(np.stack([robot.neutral, q])),
        lambda: robot.distance(q),
        lambda: Checker(robot.model).collides(q),
        lambda: robot.ik_all(robot.fk(robot.neutral), q0=q),
    ]
    for k, ask in enumerate(asked):
        with pytest.raises(InputError, match=rf"\[\.\.\., 3:7\]` has length {length:g}; .*normalize"):
            ask()
            pytest.fail(f"question {k} was answered")


def test_unit_quaternions_pass(robot: Robot) -> None:
    q = robot.configuration_space.normalize(2.0 * robot.neutral)
    assert not robot.collides(q)
    assert robot.distance(q).distance == pytest.approx(0.4)
    assert len(simulate(robot, q, duration=0.01)) == 11
    assert ulna.sim.Simulation().add(robot, q=q).q.shape == (robot.nq,)


@pytest.mark.parametrize("length", [0.0, 2.0, 1.001])
def test_cosine_and_sine_that_are_not_unit_are_refused(length: float) -> None:
    """The pose of such a joint would be no rotation."""
    builder = ModelBuilder("wheel").add_link("world").add_link("rim", Inertia.from_box(1.0, (0.1, 0.2, 0.3)))
    both = Composite((Prismatic((1, 0, 0)), Circle((0, 1, 0))))
    builder.add_link("hub", collisions=(Geometry("", Sphere(0.1)),)).add_joint("a", both, "world", "hub")
    builder.add_joint("b", PlanarCircle((0, 0, 1)), "hub", "rim", SE3.trans(0, 0, 1.0))
    robot = Robot(builder.build())
    good = robot.random_configuration(seed=0)
    assert robot.model.unit_vectors == ((1, 2), (5, 6)) and robot.model.quaternions == ()
    for cosine in (1, 5):
        q = good.copy()
        q[cosine : cosine + 2] *= length
        asked: list[Any] = [
            lambda q=q: robot.fk(q),
            lambda q=q: robot.fk(np.stack([good, q])),
            lambda q=q: robot.integrate(q, np.zeros(robot.nv)),
            lambda q=q: robot.collides(q),
            lambda q=q: simulate(robot, q, duration=0.01),
            lambda q=q: robot.ik(robot.fk(good), q0=q, mask="position"),
        ]
        for k, ask in enumerate(asked):
            where = rf"\[\.\.\., {cosine}:{cosine + 2}\]` has length {length:g}; expected cosine and sine"
            with pytest.raises(InputError, match=where):
                ask()
                pytest.fail(f"question {k} was answered")
        if length:
            assert robot.configuration_space.is_same(robot.configuration_space.normalize(q), good)
    with pytest.raises(InputError, match="of length 0, which is no rotation"):
        robot.configuration_space.normalize(np.zeros(robot.nq))
