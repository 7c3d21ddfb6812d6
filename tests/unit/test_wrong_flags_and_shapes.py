"""Flags of kernels that are none, shapes of arguments that a function does not have, and what is no robot or model."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from ulna import control
from ulna.collision import World
from ulna.errors import InputError, NonFiniteError, UnknownName


@pytest.mark.parametrize("checked", ["no", [], None, 2.5])
def test_checked_is_a_flag(checked: Any) -> None:
    robot = ulna.load("panda")
    with pytest.raises(InputError, match="`checked` is .*expected True or False"):
        robot.kernel("fk", checked=checked)
    with pytest.raises(InputError, match="`checked` is .*expected True or False"):
        ulna.compile(lambda x: x + 1.0, x=(2,), checked=checked)


def test_a_shape_of_no_argument_is_refused() -> None:
    with pytest.raises(UnknownName, match="No argument of the function named 'check'"):
        ulna.compile(lambda x: x + 1.0, x=(2,), check=True)
    with pytest.raises(UnknownName, match="Did you mean 'q'"):
        ulna.compile(lambda q: q + 1.0, ulna.load("panda"), qq=(7,))
    with pytest.raises(NonFiniteError):
        ulna.compile(lambda x: x + 1.0, x=(2,), checked=True)([0.0, np.nan])


@pytest.mark.parametrize("robot", ["panda", None, 3])
def test_what_is_no_robot_or_model_is_refused(robot: Any) -> None:
    with pytest.raises(InputError, match="expected a Robot"):
        control.obstacle_rows(robot, np.zeros(7))
    with pytest.raises(InputError, match="expected a Robot"):
        control.Reactive(robot)
    with pytest.raises(InputError, match="expected a Model, such as the `model` of a robot"):
        World().add_robot("other", robot)
    with pytest.raises(InputError, match="`model` is of type Robot; expected a Model"):
        World().add_robot("other", ulna.load("panda"))  # type: ignore[arg-type]


@pytest.mark.parametrize("given", ["no", None, 2.5])
def test_flags_are_true_or_false(given: Any) -> None:
    """Any text counted as True: `trusted="no"` had MuJoCo compile a file in this process."""
    from ulna.collision import link_pairs, survey
    from ulna.ik import AccelerationLimit, FrameTask

    robot = ulna.load("panda")
    q, checker = robot.configurations["ready"], robot.collision.checker()
    plan = robot.plan(q, q + 0.01, margin=0.001)
    calls: dict[str, Any] = {
        "mimic": lambda: ulna.load("panda_fingers", mimic=given),
        "trusted": lambda: ulna.load("panda", trusted=given),
        "convex": lambda: survey(robot, count=1, convex=given),
        "broad_phase": lambda: checker.collides(q, broad_phase=given),
        "broad_phase ": lambda: checker.distance(q, broad_phase=given),
        "adjacent": lambda: link_pairs(robot.model, adjacent=given),
        "disabled": lambda: link_pairs(robot.model, disabled=given),
        "check": lambda: robot.with_dynamic_parameters(np.ones(70), check=given),
        "check ": lambda: robot.with_parameters({}, check=given),
        "blend": lambda: plan.trajectory(velocity=1.0, acceleration=1.0, blend=given),
        "straight": lambda: ulna.SE3().interpolate(ulna.SE3(1, 2, 3), 0.5, straight=given),
        "adjustable": lambda: FrameTask("panda_hand", adjustable=given),
        "braking": lambda: AccelerationLimit(1.0, braking=given),
    }
    for name, call in calls.items():
        with pytest.raises(InputError, match=f"`{name.strip()}` is .*expected True or False"):
            call()


def test_margins_of_braking_are_distances() -> None:
    from ulna.ik import AccelerationLimit, PlaneLimit

    for margin in (-0.1, np.nan, np.inf):
        with pytest.raises(
            InputError, match="AccelerationLimit: `margin` is .*expected a number not below 0"
        ):
            AccelerationLimit(1.0, margin=margin)
    for height in (np.nan, np.inf, "3"):
        with pytest.raises(InputError, match="`height of tool_plane` is .*expected a finite number"):
            PlaneLimit("tool", height=height)  # type: ignore[arg-type]
