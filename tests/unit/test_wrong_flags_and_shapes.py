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
