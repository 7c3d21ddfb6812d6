"""Stepping a robot under torques: friction that sticks and slides, recordings, refusals."""

from __future__ import annotations

import builtins
import math
from typing import Any

import numpy as np
import pytest

from ulna.algorithms import Friction
from ulna.errors import InputError, MissingExtra, NonFiniteError, ShapeError, UnknownName
from ulna.loading import load
from ulna.model import ModelBuilder, Prismatic, Revolute
from ulna.robot import Robot
from ulna.sim import Plant, Recording, dynamic_step, simulate
from ulna.spatial import SE3, Inertia


def slope(angle: float, friction: float, mass: float = 2.0) -> Robot:
    """A block that slides along x, down a slope."""
    builder = (
        ModelBuilder("slope").add_link("ground").add_link("block", Inertia.from_box(mass, (0.1, 0.1, 0.1)))
    )
    tilt = SE3.ry(angle)
    builder.add_joint("slide", Prismatic((1, 0, 0)), "ground", "block", tilt, friction=friction)
    return Robot(builder.build())


def flywheel(friction: float = 0.0, damping: float = 0.0) -> Robot:
    """A wheel of 0.5 kg m^2 about the vertical."""
    builder = (
        ModelBuilder("flywheel")
        .add_link("ground")
        .add_link("wheel", Inertia.from_com(1.0, (0, 0, 0), np.eye(3) / 2))
    )
    builder.add_joint("axle", Revolute((0, 0, 1)), "ground", "wheel", friction=friction, damping=damping)
    return Robot(builder.build())


@pytest.mark.parametrize("dt", [1e-3, 0.1])
def test_a_block_sticks_below_the_angle_of_friction(dt: float) -> None:
    pull = 2.0 * 9.81 * math.sin(0.3)
    still = simulate(slope(0.3, 1.01 * pull), [0.0], duration=1.0, dt=dt)
    assert np.abs(still["q"]).max() == 0.0
    assert np.abs(still["v"]).max() == 0.0
    moving = simulate(slope(0.3, 0.9 * pull), [0.0], duration=1.0, dt=dt)
    np.testing.assert_allclose(moving["v"][:, 0], 0.1 * pull / 2.0 * moving["t"], atol=1e-12)


def test_a_wheel_comes_to_rest_and_stays() -> None:
    rest = simulate(flywheel(friction=0.1), [0.0], [1.0], duration=8.0, dt=0.01)
    expected = np.maximum(1.0 - 0.2 * rest["t"], 0.0)
    np.testing.assert_allclose(rest["v"][:, 0], expected, atol=2.1e-3)
    assert (rest["v"][-200:] == 0.0).all()
    assert rest["q"][-1, 0] == pytest.approx(2.5, abs=0.01)


def test_directions_of_friction_differ() -> None:
    law = Friction(coulomb=0.1, backward=0.3)
    ahead = simulate(flywheel(), [0.0], [1.0], duration=1.0, friction=law)
    back = simulate(flywheel(), [0.0], [-1.0], duration=1.0, friction=law)
    assert ahead["v"][-1, 0] == pytest.approx(0.8, abs=1e-9)
    assert back["v"][-1, 0] == pytest.approx(-0.4, abs=1e-9)


def test_static_friction_has_to_be_broken() -> None:
    law = Friction(coulomb=0.1, static=0.3, stribeck=0.01)
    assert simulate(flywheel(), [0.0], torque=[0.29], duration=1.0, friction=law)["v"][-1, 0] == 0.0
    moving = simulate(flywheel(), [0.0], [0.5], [0.29], duration=1.0, friction=law)
    assert moving["v"][-1, 0] == pytest.approx(0.5 + 0.19 / 0.5, abs=1e-9)


@pytest.mark.parametrize("method", ["euler", "rk4", "adaptive"])
def test_viscous_friction_slows_exponentially(method) -> None:
    if method == "adaptive":
        pytest.importorskip("scipy")
    out = simulate(flywheel(damping=0.5), [0.0], [1.0], duration=2.0, dt=1e-3, method=method)
    np.testing.assert_allclose(out["v"][:, 0], np.exp(-out["t"]), atol=4e-4 if method == "euler" else 1e-6)
    stiff = simulate(flywheel(damping=1e6), [0.0], [1.0], duration=0.1, dt=0.01)
    assert 0.0 <= stiff["v"][-1, 0] < 1e-6


def test_methods_agree_where_friction_is_smooth() -> None:
    pytest.importorskip("scipy")
    robot, law = flywheel(), Friction(coulomb=0.1, width=0.05)
    ends = [
        simulate(robot, [0.0], [1.0], duration=7.0, dt=1e-2, friction=law, method=method)["q"][-1, 0]
        for method in ("rk4", "adaptive")
    ]
    assert ends[0] == pytest.approx(ends[1], abs=1e-6)


def test_torques_are_asked_with_the_state() -> None:
    asked = []

    def torque(t, q, v):
        asked.append((t, q.copy(), v.copy()))
        return -4.0 * q - 1.0 * v

    out = simulate(flywheel(), [1.0], torque=torque, duration=5.0, dt=1e-2)
    assert len(asked) == 501
    assert asked[1][0] == 0.01
    np.testing.assert_allclose(out["tau"][:, 0], -4.0 * out["q"][:, 0] - out["v"][:, 0])
    assert abs(out["q"][-1, 0]) < 0.01


@pytest.mark.parametrize("method", ["euler", "rk4", "adaptive"])
def test_forces_from_outside_act_and_are_not_recorded_as_torques(method) -> None:
    if method == "adaptive":
        pytest.importorskip("scipy")
    robot = load("panda", visuals="simple")
    q0 = robot.configurations["ready"]
    calls = []

    def law(t, q, v):
        calls.append(t)
        return robot.gravity_forces(q)

    def push(t, q, v):
        return robot.jacobian(q).T @ [0.0, 0.0, -20.0, 0.0, 0.0, 0.0]

    options: dict[str, Any] = {"duration": 0.05, "dt": 5e-3, "method": method, "friction": None}
    pushed = simulate(robot, q0, torque=law, external=push, **options)
    steps = len(calls)
    summed = simulate(robot, q0, torque=lambda t, q, v: law(t, q, v) + push(t, q, v), **options)
    np.testing.assert_allclose(pushed.q, summed.q, rtol=0, atol=1e-9)
    np.testing.assert_allclose(pushed["tau"], robot.gravity_forces(pushed.q), rtol=0, atol=1e-9)
    assert np.abs(pushed.q[-1] - q0).max() > 1e-3
    constant = simulate(robot, q0, torque=law, external=push(0.0, q0, None), **options)
    np.testing.assert_allclose(constant.q, pushed.q, rtol=0, atol=1e-3)
    if method == "euler":
        assert steps == 11  # once a step, and at the end
    with pytest.raises(ShapeError):
        simulate(robot, q0, external=np.zeros(6), **options)


def test_recordings() -> None:
    out = simulate(flywheel(), [0.0], [1.0], duration=1.0, dt=0.1, every=4)
    np.testing.assert_allclose(out["t"], [0.0, 0.4, 0.8, 1.0])
    np.testing.assert_allclose(out["q"][:, 0], out["t"])
    assert out["tau"].shape == (4, 1)
    q, v = dynamic_step(flywheel(), [0.0], [1.0], [0.5], 0.1)
    np.testing.assert_allclose([q[0], v[0]], [0.11, 1.1])


def test_a_step_too_long_for_smooth_friction_is_refused() -> None:
    robot = flywheel(friction=10.0)
    limit = Plant(robot).longest_step(np.zeros(1))
    assert limit == pytest.approx(2.7 * 0.5 * 1e-2 / 10.0)
    with pytest.raises(InputError, match="method='euler'"):
        simulate(robot, [0.0], [1.0], duration=0.1, dt=1.1 * limit, method="rk4")
    fine = simulate(robot, [0.0], [1.0], duration=0.1, dt=0.5 * limit, method="rk4")
    assert abs(fine["v"][-1, 0]) < 0.01
    assert Plant(flywheel(), None).longest_step(np.zeros(1)) == np.inf


def test_wrong_input_is_refused() -> None:
    robot = flywheel()
    with pytest.raises(ShapeError, match="`q`"):
        simulate(robot, [0.0, 0.0], duration=1.0)
    with pytest.raises(ShapeError, match="`tau`"):
        simulate(robot, [0.0], torque=lambda t, q, v: [0.0, 1.0], duration=1.0)
    with pytest.raises(NonFiniteError):
        simulate(robot, [0.0], torque=lambda t, q, v: v * np.nan, duration=1.0)
    for wrong in ({"duration": 0.0}, {"duration": 1.0, "dt": -1.0}, {"duration": 1.0, "every": 0}):
        with pytest.raises(InputError):
            simulate(robot, [0.0], **wrong)
    with pytest.raises(UnknownName, match="euler"):
        simulate(robot, [0.0], duration=1.0, method="eular")  # type: ignore[arg-type]
    with pytest.raises(UnknownName, match="friction"):
        simulate(robot, [0.0], duration=1.0, friction="models")  # type: ignore[arg-type]
    with pytest.raises(ShapeError):
        simulate(robot, [0.0], duration=1.0, friction=Friction([1.0, 2.0]))


def test_a_diverging_motion_is_reported() -> None:
    with pytest.raises(InputError, match="diverged at t = 0.1 s"):
        simulate(flywheel(), [1.0], torque=[1e308], duration=1.0, dt=0.1)


def test_scipy_is_named_where_it_lacks(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def refuse(name: str, *rest, **more):
        if name.startswith("scipy"):
            raise ImportError(name)
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", refuse)
    with pytest.raises(MissingExtra, match=r"pip install .*'scipy>="):
        simulate(flywheel(), [0.0], duration=1.0, method="adaptive")


def test_a_recording_says_what_it_holds() -> None:
    robot = load("ur5")
    recording = simulate(robot, robot.neutral, duration=0.02, dt=1e-2)
    assert repr(recording) == "<recording from 0 to 0.02 s: t (3,), q (3, 6), v (3, 6), tau (3, 6)>"
    assert repr(Recording()) == "<recording without rows>"


@pytest.mark.parametrize("method", ["euler", "rk4"])
@pytest.mark.parametrize("option", [{"solver": "RK45"}, {"rtol": 1e-6}, {"atol": 1e-6}])
def test_options_of_adaptive_steps_are_refused_elsewhere(method: Any, option: Any) -> None:
    with pytest.raises(InputError, match=f"`{next(iter(option))}` is for method='adaptive'"):
        simulate(flywheel(), [0.0], duration=0.1, method=method, **option)


def test_a_wider_tolerance_takes_a_larger_error() -> None:
    pytest.importorskip("scipy")
    robot = load("ur5")
    start, v = np.full(6, 0.3), np.full(6, 0.5)
    options: Any = {"duration": 0.5, "dt": 0.5, "method": "adaptive", "friction": None}
    exact = simulate(robot, start, v, **options).q[-1]
    wide = simulate(robot, start, v, rtol=1e-3, atol=1e-3, **options).q[-1]
    assert 1e-8 < abs(exact - wide).max() < 1e-2
