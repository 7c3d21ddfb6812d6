"""The simulation: commands mean the same whenever they are set, limits hold, time is kept."""

import pickle
import time

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.model import ModelBuilder, Revolute
from ulna.sim import Body, Simulation, plant
from ulna.spatial import SE3, Inertia


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.fixture(scope="module")
def pendulum() -> ulna.Robot:
    """A point of 1 kg, 1 m from an axis along y, hanging at q = 0."""
    builder = ModelBuilder("pendulum").add_link("base")
    builder.add_link("bob", inertia=Inertia(1.0, (0.0, 0.0, -1.0), 1e-9 * np.eye(3)))
    builder.add_joint("hinge", Revolute((0, 1, 0)), "base", "bob", SE3.identity(), lower=-1.0, upper=2.0)
    return ulna.Robot(builder.build())


def test_velocity_moves_and_stops_at_limits(panda: ulna.Robot) -> None:
    sim = Simulation()
    arm = sim.add(panda, q=panda.configurations["qr"], qd=[0.1, -10, 0, 0, 0, 0, 0])
    sim.step(0.5)
    assert arm.q[0] == pytest.approx(0.05)
    assert arm.q[1] == panda.limits.lower[1]
    assert arm.qd[1] == -10  # as it was set
    assert arm.recording["v"][-1, 1] == pytest.approx((panda.limits.lower[1] + 0.3) / 0.5)  # as it was
    assert sim.t == 0.5
    np.testing.assert_array_equal(arm.recording.t, [0.0, 0.5])


def test_all_limits_hold_where_asked(panda: ulna.Robot) -> None:
    sim = Simulation()
    free = sim.add(panda, q=panda.configurations["qr"], qd=[0, 9, 0, 0, 0, 0, 0], limits="none", name="free")
    slow = sim.add(panda, q=panda.configurations["qr"], qd=[0, 9, 0, 0, 0, 0, 0], limits="all", name="slow")
    sim.step(1.0)
    assert free.q[1] == pytest.approx(-0.3 + 9)
    assert slow.q[1] == pytest.approx(min(-0.3 + panda.limits.velocity[1], panda.limits.upper[1]))


def test_a_limit_of_zero_is_none_as_everywhere() -> None:
    builder = ModelBuilder("unknown").add_link("base").add_link("arm", Inertia(1.0, (0, 0, 0), np.eye(3)))
    builder.add_joint(
        "j", Revolute((0, 0, 1)), "base", "arm", lower=-1.0, upper=1.0, velocity=0.0, effort=0.0
    )
    robot = ulna.Robot(builder.build())
    sim = Simulation()
    there = sim.add(robot, control="position", name="there")
    fast = sim.add(robot, qd=[0.5], limits="all", name="fast")
    driven = sim.add(robot, control="torque", limits="all", name="driven")
    there.target, driven.tau = [0.5], [2.0]
    sim.step(0.1)
    assert there.q[0] == 0.5 and fast.q[0] == pytest.approx(0.05)
    assert driven.qd[0] == pytest.approx(0.2) and driven.recording["tau"][-1] == [2.0]


@pytest.mark.parametrize("early", [True, False])
def test_settings_before_or_after_adding_mean_the_same(panda: ulna.Robot, early: bool) -> None:
    sim, body = Simulation(), Body(panda)
    if not early:
        sim.add(body)
    body.q, body.qd = panda.configurations["qr"], np.full(7, 0.1)
    if early:
        sim.add(body)
    sim.step(1.0)
    np.testing.assert_allclose(body.q, panda.configurations["qr"] + 0.1)


def test_what_is_moved_by_hand_is_recorded_with_its_velocity(panda: ulna.Robot) -> None:
    sim, qd = Simulation(), np.linspace(-0.3, 0.4, 7)
    arm = sim.add(panda, q=panda.configurations["qr"], control="position")
    for _ in range(2):
        arm.q = arm.q + 0.01 * qd
        sim.step(0.01)
    sim.step(0.01)
    np.testing.assert_allclose(arm.recording["v"], [np.zeros(7), qd, qd, np.zeros(7)], atol=1e-12)
    np.testing.assert_array_equal(arm.qd, np.zeros(7))
    with pytest.raises(UnknownName, match="No control named 'speed'"):
        arm.control = "speed"  # type: ignore[assignment]
    arm.control = "velocity"  # what was moved by hand has no swing
    sim.step(0.01)
    np.testing.assert_array_equal(arm.recording["v"][-1], np.zeros(7))


def test_a_target_is_reached_at_the_limit_of_speed_by_all_joints_at_once(panda: ulna.Robot) -> None:
    sim = Simulation()
    arm = sim.add(panda, q=panda.configurations["qr"], control="position")
    sim.step(0.1)
    np.testing.assert_array_equal(arm.q, panda.configurations["qr"])
    arm.target = goal = panda.configurations["ready"]
    way = np.abs(goal - panda.configurations["qr"])
    least = float((way / panda.limits.velocity).max())
    sim.step(least / 2)
    np.testing.assert_allclose(arm.q, (goal + panda.configurations["qr"]) / 2, atol=1e-12)
    sim.step(0.6 * least)
    np.testing.assert_array_equal(arm.q, goal)


def test_acceleration_is_integrated_exactly_and_ends_at_a_stop(pendulum: ulna.Robot) -> None:
    sim = Simulation()
    body = sim.add(pendulum, control="acceleration")
    body.qdd = [2.0]
    sim.run(1.0, 0.1)
    assert body.q[0] == pytest.approx(1.0)
    assert body.qd[0] == pytest.approx(2.0)
    sim.run(1.0, 0.1)
    assert body.q[0] == 2.0
    assert body.qd[0] == 0.0


def test_torques_swing_a_pendulum_as_long_as_physics_says(pendulum: ulna.Robot) -> None:
    sim = Simulation(substep=1e-4)
    body = sim.add(pendulum, q=[0.1], control="torque", friction=None)
    sim.run(
        2 * np.pi / np.sqrt(9.81) * (1 + 0.1**2 / 16), 0.01
    )  # one period, with the first term for amplitude
    assert body.q[0] == pytest.approx(0.1, abs=1e-4)
    assert body.recording["tau"].shape == (len(body.recording), 1)


def test_a_swing_ends_at_a_position_limit(pendulum: ulna.Robot) -> None:
    sim = Simulation()
    body = sim.add(pendulum, q=[1.5], control="torque", friction=None)
    sim.run(2.5, 0.001)
    way = body.recording.q[:, 0]
    assert way.min() == -1.0
    assert way[np.argmin(way) :].max() == pytest.approx(
        1.0, abs=2e-3
    )  # the stop took all speed, gravity gave the rest


def test_a_law_of_torques_holds_its_robot(panda: ulna.Robot) -> None:
    sim, q = Simulation(), panda.configurations["qr"]
    arm = sim.add(panda, q=q, control="torque")
    arm.tau = lambda t, q, qd: panda.gravity_forces(q)
    sim.run(0.05, 0.01)
    np.testing.assert_allclose(arm.q, q, atol=1e-12)
    with pytest.raises(ShapeError, match="`tau`"):
        arm.tau = lambda t, q, qd: np.zeros(3)
        sim.step(0.01)


def test_effort_is_limited_where_asked(panda: ulna.Robot) -> None:
    sim = Simulation()
    arm = sim.add(panda, q=panda.configurations["qr"], control="torque", limits="all")
    arm.tau = np.full(7, 1e6)
    sim.step(1e-3)
    np.testing.assert_array_equal(arm.recording["tau"][-1], panda.limits.effort)


def test_steps_are_reported_and_recorded(panda: ulna.Robot) -> None:
    seen = []
    sim = Simulation().each_step(lambda sim: seen.append((sim.steps, round(sim.t, 9))))
    arm, quiet = sim.add(panda), sim.add(panda, name="quiet", record=False)
    sim.run(0.03, 0.01)
    assert seen == [(1, 0.01), (2, 0.02), (3, 0.03)]
    assert (len(arm.recording), len(quiet.recording)) == (4, 0)
    assert sim["quiet"] is quiet
    sim.reset()
    assert (sim.t, len(arm.recording)) == (0.0, 1)
    sim.remove(quiet)
    assert sim.bodies == (arm,)


def test_real_time_is_kept_and_a_pause_ends_with_its_patience(panda: ulna.Robot) -> None:
    sim = Simulation(realtime=True, speed=2.0)
    sim.add(panda)
    began = time.perf_counter()
    sim.run(0.4, 0.02)
    assert time.perf_counter() - began >= 0.18
    sim.paused = True
    sim.step(0.001)  # nobody could end the pause, so it does not hang
    asked = []
    sim.patience = lambda: asked.append(1) or len(asked) < 3
    sim.step(0.001)
    assert len(asked) == 3


def test_mistakes_are_named(panda: ulna.Robot, pendulum: ulna.Robot) -> None:
    sim = Simulation()
    arm = sim.add(panda)
    for name, size in (("q", 7), ("qd", 7), ("qdd", 7), ("tau", 7), ("target", 7)):
        with pytest.raises(ShapeError, match=f"`{name}`"):
            setattr(arm, name, np.zeros(size + 1))
        with pytest.raises(NonFiniteError, match=name):
            setattr(arm, name, np.full(size, np.nan))
    with pytest.raises(UnknownName, match="velocity"):
        arm.control = "velocty"  # type: ignore[assignment]
    with pytest.raises(UnknownName, match="position"):
        Body(panda, limits="positon")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="already"):
        sim.add(panda)
    with pytest.raises(UnknownName, match="'panda'"):
        sim["pnda"]
    for wrong in (0.0, -1.0, np.nan):
        with pytest.raises(InputError, match="dt"):
            sim.step(wrong)
    wild = Simulation()
    body = wild.add(pendulum, control="torque", limits="none")
    body.tau = [1e308]
    with pytest.raises(InputError, match="diverged"):
        wild.run(10.0, 1.0)


def test_nothing_that_is_given_is_ignored(panda: ulna.Robot) -> None:
    sim, body = Simulation(), Body(panda)
    with pytest.raises(InputError, match="`q` is given for <'panda' under velocity control>"):
        sim.add(body, q=panda.configurations["qr"])
    for thing, name in ((body, "tua"), (body, "dq"), (sim, "realtme")):
        with pytest.raises(AttributeError, match=name):
            setattr(thing, name, 1.0)


def test_simulations_are_pickled(panda: ulna.Robot) -> None:
    sim = Simulation()
    sim.add(panda, q=panda.configurations["qr"], control="torque")
    sim.run(0.01)
    again = pickle.loads(pickle.dumps(sim))
    for one in (sim, again):
        one.run(0.01)
    np.testing.assert_array_equal(again["panda"].q, sim["panda"].q)
    assert again.t == sim.t and len(again["panda"].recording) == 3


@pytest.mark.parametrize("realtime", [True, False])
def test_stops_are_compiled_before_real_time_runs(
    panda: ulna.Robot, monkeypatch: pytest.MonkeyPatch, realtime: bool
) -> None:
    """The first contact with a limit compiled for a second, while the clock ran."""
    compiled = []
    monkeypatch.setattr(
        plant, "compile", lambda f, *a, **k: compiled.append(f.__name__) or ulna.compile(f, *a, **k)
    )
    sim = Simulation(realtime=realtime, speed=1e3)
    body = sim.add(panda, q=panda.configurations["qr"], control="torque", friction=None)
    sim.step(1e-3)
    assert ("settle" in compiled) == realtime
    before = len(compiled)
    q = panda.limits.upper.copy()
    body.q, body.qd = q, np.ones(7)
    sim.step(1e-3)
    assert (len(compiled) > before) != realtime
    assert (body.q <= q).all() and (body.qd <= 1e-12).all()
