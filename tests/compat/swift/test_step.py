"""A step of the environment: what it moves, what is shown, and that a script's arrays stay the script's."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using

pytest.importorskip("spatialmath")


@pytest.fixture
def scene() -> Iterator[tuple[Any, Any, Any]]:
    """An environment, a robot in it, and what the viewer has of the robot."""
    with using("roboticstoolbox"):
        import roboticstoolbox as rtb
        import swift

        env, robot = swift.Swift(), rtb.models.DH.Planar3()
        env.launch(headless=True)
        robot.q, robot.qd = [0.1, 0.2, 0.3], [1.0, 0.0, -1.0]
        handle = env.add(robot)
        yield env, robot, handle.figures[0]
        env.close()


def test_a_step_shows_the_configuration_that_it_reached(scene: tuple[Any, Any, Any]) -> None:
    env, robot, figure = scene
    env.step(0.1)
    np.testing.assert_allclose(figure.q, [0.2, 0.2, 0.2], atol=1e-15)
    robot.q[0] = 5.0  # in place, and shown by the next step only
    np.testing.assert_allclose(figure.q, [0.2, 0.2, 0.2], atol=1e-15)
    robot.qd = np.zeros(3)
    env.step(0.1)
    np.testing.assert_allclose(figure.q, robot.q, atol=1e-15)
    assert robot.q[0] == 5.0 and env.sim_time == pytest.approx(0.2)


def test_readonly_and_position_mode_are_shown_where_the_script_puts_them(scene: tuple[Any, Any, Any]) -> None:
    env, robot, figure = scene
    robot.control_mode = "p"
    robot.q = [0.5, 0.6, 0.7]
    env.step(0.1)
    assert figure.q.tolist() == robot.q.tolist() == [0.5, 0.6, 0.7]


def test_a_velocity_that_is_no_number_stops_the_step_and_leaves_the_configuration(
    scene: tuple[Any, Any, Any],
) -> None:
    env, robot, _ = scene
    robot.qd = [np.nan, 0.0, 0.0]
    with pytest.raises(ValueError, match="finite"):
        env.step(0.1)
    assert robot.q.tolist() == [0.1, 0.2, 0.3]
    robot.qd = np.zeros(3)
    env.step(0.1)
    assert robot.q.tolist() == [0.1, 0.2, 0.3]


def test_things_that_come_and_go_during_a_step_are_stepped_from_the_next_on(
    scene: tuple[Any, Any, Any],
) -> None:
    env, robot, _ = scene
    import spatialgeometry as sg

    ball = sg.Sphere(0.1)
    number = env.add(ball)
    ball.v = [1.0, 0, 0, 0, 0, 0]
    env.step(0.1)
    assert ball.T[0, 3] == pytest.approx(0.1)
    env.remove(number)
    env.step(0.1)
    assert ball.T[0, 3] == pytest.approx(0.1) and robot.q[0] == pytest.approx(0.3)


@pytest.mark.parametrize("dt", [-0.1, float("nan"), "x"])
def test_times_below_zero_are_refused(scene: tuple[Any, Any, Any], dt: Any) -> None:
    with pytest.raises((ValueError, TypeError), match="dt"):
        scene[0].step(dt)
