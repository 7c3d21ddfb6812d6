"""Logs that do not say how well they determine parameters, and arguments that are none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import InputError
from ulna.identification import base_parameters, identify
from ulna.identification.blocks import Sought, fit_sums, sums_of
from ulna.robot import Robot
from ulna.typing import Floats


@pytest.fixture(scope="module")
def robot() -> Robot:
    return ulna.load("ur5")


def log(robot: Robot, rows: int) -> tuple[Floats, Floats, Floats, Floats]:
    """A log of twice the torques, with noise."""
    rng = np.random.default_rng(3)
    q, v, a = rng.uniform(-1, 1, (3, rows, 6))
    return q, v, a, 2.0 * robot.inverse_dynamics(q, v, a) + 0.1 * rng.standard_normal((rows, 6))


def test_as_many_parameters_as_torques_are_known_to_no_precision(robot: Robot) -> None:
    fit = identify(robot, *log(robot, 1))
    assert fit.base.count == 6  # six torques, which fit exactly, noise and all
    assert fit.rms.max() < 1e-9
    assert np.isinf(fit.base_deviations).all()
    assert "0 known to better than 10 %" in fit.report()
    assert "WARNING" in fit.report()
    assert np.isfinite(identify(robot, *log(robot, 20)).base_deviations).all()


@pytest.mark.parametrize("size", [3.0, 0.1])  # the mean of the second is rounded
def test_a_constant_torque_that_does_not_fit_is_not_explained(robot: Robot, size: float) -> None:
    still = np.zeros((50, 6))
    torque = np.tile([size, 0.0, 0.0, 0.0, 0.0, 0.0], (50, 1))  # gravity makes none about the vertical
    fit = identify(robot, still, still, still, torque)
    assert fit.rms[0] == pytest.approx(size)
    assert fit.explained[0] == pytest.approx(0.0)
    sums = sums_of(robot, still, still, still, torque, Sought())
    assert fit_sums(robot.model, sums, Sought()).explained[0] == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"friction": "yes"}, "`friction` is 'yes'; expected True or False"),
        ({"physical": "no"}, "`physical` is 'no'; expected True or False"),
        ({"width": 0.0}, "`width` is 0.0; expected a velocity above zero"),
        ({"ridge": "a"}, "`ridge` is 'a'; expected a finite number"),
        ({"ridge": -1.0}, "`ridge` is -1.0; expected a finite number"),
        ({"physical": True, "progress": 3}, "`progress` is 3; expected a function"),
    ],
)
def test_what_is_no_option_is_refused(robot: Robot, options: dict[str, Any], expected: str) -> None:
    with pytest.raises(InputError, match=expected):
        identify(robot, *log(robot, 3), **options)


@pytest.mark.parametrize(
    "options", [{"samples": 0}, {"samples": 2.5}, {"seed": "a"}, {"friction": "yes"}, {"damping": None}]
)
def test_base_parameters_refuse_what_is_no_option(robot: Robot, options: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="expected"):
        base_parameters(robot, **options)


def test_a_name_is_no_robot(robot: Robot) -> None:
    with pytest.raises(InputError, match="expected a Robot"):
        identify("ur5", *log(robot, 1))
    with pytest.raises(InputError, match="expected a Robot"):
        base_parameters("ur5")
