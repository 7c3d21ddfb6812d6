"""What cannot be a frame, a wrench, a law or a flag is refused, and the message names the argument."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import UlnaError
from ulna.robot import Robot

Q = np.array([0.1, -0.5, 0.2, -2.0, 0.3, 1.6, 0.7])
T = np.eye(4)
WRONG: tuple[Any, ...] = (Q, np.array(1.0), {}, [[1, 2], [3]], object(), 1j, 2.5, {"panda_hand": [0.0] * 6})
CALLS: dict[str, Callable[[Robot, Any], Any]] = {
    "frame of fk": lambda r, x: r.fk(Q, x),
    "frame of jacobian": lambda r, x: r.jacobian(Q, x),
    "frame of jacobian_dot": lambda r, x: r.jacobian_dot(Q, Q, x),
    "frame of manipulability": lambda r, x: r.manipulability(Q, frame=x),
    "frame of ik": lambda r, x: r.ik(T, Q, x),
    "frame of ik_all": lambda r, x: r.ik_all(T, Q, x),
    "frame of ik_classic": lambda r, x: r.ik_classic(T, "chan", Q, x),
    "frame of with_tool": lambda r, x: r.with_tool(x),
    "frame of regressors": lambda r, x: r.regressors.wrench(Q, Q, Q, x),
    "reference of jacobian": lambda r, x: r.jacobian(Q, reference=x),
    "reference of bias_forces": lambda r, x: r.bias_forces(Q, Q, None, x),
    "reference of inverse_dynamics": lambda r, x: r.derivatives.inverse_dynamics(Q, Q, Q, None, x),
    "reference of forward_dynamics": lambda r, x: r.derivatives.forward_dynamics(Q, Q, Q, None, x),
    "representation of analytical_jacobian": lambda r, x: r.analytical_jacobian(Q, x),
    "friction of forward_dynamics": lambda r, x: r.forward_dynamics(Q, Q, Q, friction=x),
    "friction of inverse_dynamics": lambda r, x: r.inverse_dynamics(Q, Q, Q, friction=x),
    "classical of frame_acceleration": lambda r, x: r.frame_acceleration(Q, Q, Q, classical=x),
    "measure of manipulability": lambda r, x: r.manipulability(Q, x),
    "axes of manipulability": lambda r, x: r.manipulability(Q, axes=x),
    "joint of center_of_mass": lambda r, x: r.center_of_mass(Q, x),
    "joint of total_mass": lambda r, x: r.total_mass(x),
    "joints of lock": lambda r, x: r.lock(x if not isinstance(x, dict) else 3),
    "joints of ik": lambda r, x: r.ik(T, Q, joints=x),
    "joints of ik_all": lambda r, x: r.ik_all(T, Q, joints=x),
    "limits of ik_all": lambda r, x: r.ik_all(T, Q, limits=x),
    "turns of ik_all": lambda r, x: r.ik_all(T, Q, turns=x),
    "free of ik_all": lambda r, x: r.ik_all(T, Q, free=x),
    "prefix of attach": lambda r, x: r.attach(r, "panda_link0", prefix=x),
}
NUMBERS: dict[str, Callable[[Robot, Any], Any]] = {
    "damping of operational_space": lambda r, x: r.operational_space.inertia(Q, damping=x),
    "fraction of perturbed": lambda r, x: r.perturbed(x),
    "com of perturbed": lambda r, x: r.perturbed(0.1, 1, x),
    "mass of with_payload": lambda r, x: r.with_payload(mass=x),
    "tolerance of is_same": lambda r, x: r.configuration_space.is_same(Q, Q, x),
    "position_tolerance of ik_all": lambda r, x: r.ik_all(T, Q, position_tolerance=x),
    "rotation_tolerance of ik_all": lambda r, x: r.ik_all(T, Q, rotation_tolerance=x),
    "samples of ik_all": lambda r, x: r.ik_all(T, Q, samples=x if np.ndim(x) == 0 else "many"),
    "limit_gain of ik_classic": lambda r, x: r.ik_classic(T, limit_gain=x if x != -0.5 else None),
}


@pytest.fixture(scope="module")
def panda() -> Robot:
    return ulna.load("panda", visuals="simple")


@pytest.mark.parametrize("name", CALLS)
def test_what_is_no_option_is_refused(name: str, panda: Robot) -> None:
    for wrong in WRONG:
        with pytest.raises(UlnaError, match=name.split(" of ", maxsplit=1)[0]):
            CALLS[name](panda, wrong)


@pytest.mark.parametrize("name", NUMBERS)
def test_what_is_no_number_is_refused(name: str, panda: Robot) -> None:
    for wrong in ("0.1", {}, object(), 1j, float("nan"), -0.5, 10**400):
        with pytest.raises(UlnaError, match=name.partition(" ")[0]):
            NUMBERS[name](panda, wrong)


@pytest.mark.parametrize("wrong", ["1", 0.5, -1, {}, object(), Q])
def test_what_is_no_seed_is_refused(wrong: Any, panda: Robot) -> None:
    for call in (lambda: panda.random_configuration(3, seed=wrong), lambda: panda.perturbed(seed=wrong)):
        with pytest.raises(UlnaError, match="`seed`"):
            call()


@pytest.mark.parametrize("wrong", [Q, np.zeros((2, 6)), 3, [0.0] * 6, "panda_hand", ["panda_hand"]])
def test_forces_are_a_dictionary(wrong: Any, panda: Robot) -> None:
    for call in (panda.bias_forces, panda.derivatives.inverse_dynamics, panda.forward_dynamics):
        arrays = [Q] * (2 if call == panda.bias_forces else 3)
        with pytest.raises(UlnaError, match="(?s)`forces` is .*expected a dictionary"):
            call(*arrays, wrong)
    np.testing.assert_array_equal(panda.bias_forces(Q, Q, {}), panda.bias_forces(Q, Q))


def test_loads_are_wrenches_and_torques(panda: Robot) -> None:
    for name, wrong in (
        ("wrench", np.zeros(3)),
        ("wrench", "heavy"),
        ("effort", np.zeros(6)),
        ("effort", {}),
    ):
        with pytest.raises(UlnaError, match=f"`{name}"):
            panda.payload_capacity(Q, **{name: wrong})
    with pytest.raises(UlnaError, match="`T`"):
        panda.ik_all(None)


def test_a_name_for_a_tool_that_is_a_frame_is_refused(panda: Robot) -> None:
    with pytest.raises(UlnaError, match="`name` is 'grip'.*placement"):
        panda.with_tool("panda_hand", name="grip")
    assert panda.with_tool("panda_hand", ulna.SE3(), "grip").tool == "grip"
    assert panda.with_tool("panda_hand").tool == "panda_hand"
