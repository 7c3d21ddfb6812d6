"""Motions that leave the range of floats, and torque laws that write to their arguments."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import InputError
from ulna.sim import dynamic_step, simulate


@pytest.mark.parametrize("solver", [None, "DOP853", "Radau", "BDF"])
@pytest.mark.parametrize("friction", ["model", None])
def test_adaptive_solvers_say_that_a_motion_diverged(solver: str | None, friction: Any) -> None:
    pytest.importorskip("scipy")
    robot = ulna.load("panda")  # LSODA never ended, Radau and BDF raised SciPy's ValueError
    options: Any = {"duration": 0.05, "method": "adaptive", "friction": friction, "solver": solver}
    with pytest.raises(InputError, match="diverged at t = 0 s"):
        simulate(robot, robot.neutral, torque=np.full(7, 1e300), **options)


def test_a_step_that_diverges_is_refused() -> None:
    robot = ulna.load("panda")
    with pytest.raises(InputError, match="diverged"):
        dynamic_step(robot, robot.neutral, np.zeros(7), np.full(7, 1e308), 1e300)


@pytest.mark.parametrize("method", ["euler", "rk4", "adaptive"])
@pytest.mark.parametrize("argument", ["torque", "external"])
def test_a_law_that_writes_to_its_arguments_moves_nothing(method: Any, argument: str) -> None:
    robot = ulna.load("ur5")
    q0 = np.array([0.0, -1.0, 1.2, 0.0, 0.5, 0.0])

    def law(t: float, q: Any, v: Any) -> Any:
        return -20.0 * (q - q0) - 2.0 * v

    def writing(t: float, q: Any, v: Any) -> Any:
        q -= q0
        v *= -2.0
        return v - 20.0 * q

    options: Any = {"duration": 0.02, "method": method, "friction": None}
    expected = simulate(robot, q0 + 0.1, np.ones(6), **{argument: law}, **options)
    run = simulate(robot, q0 + 0.1, np.ones(6), **{argument: writing}, **options)
    for name in ("q", "v", "tau"):
        np.testing.assert_allclose(run[name], expected[name], rtol=0.0, atol=1e-12)
