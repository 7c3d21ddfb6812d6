"""What cannot be a robot, a flag, a threshold or a length is refused when a law, a curve or a body is made of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import UlnaError
from ulna.trajectory import bspline

ROBOT = ulna.load("panda", visuals="simple")
POINTS = np.array([[0.0, 0.0], [1.0, 0.5], [0.5, 2.0]])
LAWS = {
    "joint_pd": ulna.control.joint_pd,
    "computed_torque": ulna.control.computed_torque,
    "impedance": ulna.control.impedance,
    "operational_space": ulna.control.operational_space,
    "resolved_rate": ulna.control.resolved_rate,
}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_laws_are_made_for_robots(law: Callable[..., Any]) -> None:
    for wrong in (None, "panda", 3, np.zeros(7)):
        with pytest.raises(UlnaError, match="`robot` is"):
            law(wrong)
    for wrong in ("no", None, 0.5, np.zeros(2)):
        with pytest.raises(UlnaError, match="`bounded` is"):
            law(ROBOT, bounded=wrong)


def test_numbers_and_laws_of_control() -> None:
    for wrong in ("viscous", 0.3, None, {}):
        with pytest.raises(UlnaError, match="`friction` is"):
            ulna.control.computed_torque(ROBOT, friction=wrong)  # type: ignore[arg-type]
    for law in (ulna.control.impedance, ulna.control.operational_space):
        for wrong in ("1e-3", None, np.nan, 0.0):
            with pytest.raises(UlnaError, match="`regularisation` is"):
                law(ROBOT, regularisation=wrong)  # type: ignore[arg-type]
    for wrong in ("0.1", None, float("nan"), {}, np.zeros(3)):
        with pytest.raises(UlnaError, match="`threshold` is"):
            ulna.p_servo(np.eye(4), np.eye(4), threshold=wrong)  # type: ignore[arg-type]
    with pytest.raises(UlnaError, match="method"):
        ulna.p_servo(np.eye(4), np.eye(4), method=np.zeros(2))  # type: ignore[arg-type]
    assert ulna.p_servo(np.eye(4), np.eye(4), threshold=1)[1]


def test_curves_leave_no_argument_out() -> None:
    with pytest.raises(UlnaError, match="`times` .*through=True"):
        bspline(POINTS, 2.0, times=[0.0, 1.0, 2.0])
    for wrong in ("yes", None, np.zeros(2), 0.5):
        with pytest.raises(UlnaError, match="`through` is"):
            bspline(POINTS, 2.0, through=wrong)  # type: ignore[arg-type]
    for wrong in (4, "3", np.zeros(2), 3.0):
        with pytest.raises(UlnaError, match="`degree` is"):
            bspline(POINTS, 2.0, degree=wrong)  # type: ignore[arg-type]
    np.testing.assert_allclose(bspline(POINTS, 2.0, through=True, times=[0.0, 0.5, 2.0]).q(0.5), POINTS[1])


@pytest.mark.parametrize("wrong", [None, "1", {}, 1j, np.nan], ids=str)
def test_bodies_have_masses_and_lengths(wrong: Any) -> None:
    make = ulna.Inertia
    for call in (lambda x: make.from_sphere(x, 0.1), lambda x: make.from_cone(x, 0.1, 0.2)):
        with pytest.raises(UlnaError, match="`mass"):
            call(wrong)
    for call in (lambda x: make.from_sphere(1.0, x), lambda x: make.from_cylinder(1.0, x, 0.3)):
        with pytest.raises(UlnaError, match="`radius"):
            call(wrong)
    with pytest.raises(UlnaError, match="`length"):
        make.from_capsule(1.0, 0.1, wrong)
