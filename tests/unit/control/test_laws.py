"""Control laws: the published formulas, and robots that come to rest where they should, driven by torques."""

import pickle
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import control
from ulna.algorithms import Friction
from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.model import with_joint_dynamics
from ulna.sim import simulate
from ulna.spatial import so3_exp, so3_log


@pytest.fixture(scope="module")
def panda():
    return ulna.load("panda")


@pytest.fixture(scope="module")
def state(panda):
    rng = np.random.default_rng(3)
    return panda.random_configuration(20, seed=3), rng.normal(0.0, 0.5, (20, 7))


def test_joint_pd_is_its_formula_and_comes_to_rest_at_the_goal(panda, state):
    q, v = state
    law = control.joint_pd(panda, bounded=False)
    goal, k, d = np.array(panda.configurations["qr"]), np.full(7, 80.0), np.array([30, 30, 20, 15, 3, 3, 1.0])
    expected = k * (goal - q) - d * v + panda.gravity_forces(q)
    np.testing.assert_allclose(law(q, v, goal, np.zeros(7), k, d), expected, rtol=1e-12, atol=1e-10)

    start = goal + 0.3
    log = simulate(
        panda, start, torque=lambda t, q, v: law(q, v, goal, np.zeros(7), k, d), duration=6.0, dt=1e-3
    )
    assert np.abs(log.q[-1] - goal).max() < 1e-3 and np.abs(log["v"][-1]).max() < 1e-3


def test_computed_torque_compensates_friction(panda: ulna.Robot) -> None:
    arm = ulna.Robot(with_joint_dynamics(panda.model, damping=2.0, friction=1.5))
    kp, kd = np.full(7, 100.0), np.full(7, 20.0)
    goal = np.array(arm.configurations["qr"])

    def wanted(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        swing = 0.4 * np.sin(2.0 * t)
        return goal + swing, 0.8 * np.cos(2.0 * t) * np.ones(7), -4.0 * swing * np.ones(7)

    def largest_error(**options: bool) -> float:
        law = control.computed_torque(arm, bounded=False, **options)
        run = simulate(
            arm,
            *wanted(0.0)[:2],
            torque=lambda t, q, v: law(q, v, *wanted(t), kp, kd),
            duration=1.5,
            dt=1e-3,
        )
        return float(np.abs(run.q - np.array([wanted(t)[0] for t in run.t])).max())

    assert largest_error(friction=True) < 0.005
    assert largest_error() > 0.05
    q, v = goal + 0.1, np.full(7, 0.3)
    plain = control.computed_torque(arm, bounded=False)
    given = control.computed_torque(arm, bounded=False, friction=Friction(viscous=2.0))
    arguments = (q, v, goal, v, np.zeros(7), kp, kd)
    np.testing.assert_allclose(given(*arguments) - plain(*arguments), 2.0 * v, atol=1e-9)


def test_computed_torque_follows_a_motion_as_a_free_mass_would(panda, state):
    q, v = state
    law = control.computed_torque(panda, bounded=False)
    kp, kd = np.full(7, 100.0), np.full(7, 20.0)
    goal = np.array(panda.configurations["qr"])
    a = kp * (goal - q) - kd * v
    np.testing.assert_allclose(
        law(q, v, goal, np.zeros(7), np.zeros(7), kp, kd),
        panda.inverse_dynamics(q, v, a),
        rtol=1e-11,
        atol=1e-9,
    )

    def wanted(t):
        swing = 0.4 * np.sin(2.0 * t)
        return goal + swing, 0.8 * np.cos(2.0 * t) * np.ones(7), -4.0 * swing * np.ones(7)

    log = simulate(
        panda,
        goal + 0.2,
        0.8 * np.ones(7),
        torque=lambda t, q, v: law(q, v, *wanted(t), kp, kd),
        duration=1.0,
        dt=5e-4,
        method="rk4",
        friction=None,
    )
    # Critically damped with 1/T = 10/s: e(t) = e0 (1 + 10 t) exp(-10 t) from rest.
    e = np.array([q - wanted(t)[0] for t, q in zip(log.t, log.q, strict=True)])
    expected = 0.2 * (1.0 + 10.0 * log.t) * np.exp(-10.0 * log.t)
    np.testing.assert_allclose(e, np.tile(expected[:, None], (1, 7)), atol=2e-3)


def test_torques_stay_within_the_effort_limits(panda, state):
    q, v = state
    law = control.computed_torque(panda)
    tau = law(q, v, q + 3.0, v, v, np.full(7, 1e4), np.full(7, 1e2))
    assert (np.abs(tau) <= panda.limits.effort).all() and (np.abs(tau) == panda.limits.effort).any()


def test_resolved_rate_gives_the_twist_slowly_enough_and_keeps_calm_when_singular(panda, state):
    q, _ = state
    law = control.resolved_rate(panda, bounded=False)
    twist = np.array([0.05, -0.02, 0.03, 0.1, 0.0, -0.1])
    rest = np.full(7, 0.1)
    v = law(q, twist, 0.0, rest)
    J = panda.jacobian(q)
    np.testing.assert_allclose((J @ v[..., None])[..., 0], twist[None].repeat(20, 0), atol=1e-7)
    pinv = np.linalg.pinv(J)
    expected = (pinv @ twist) + rest - (pinv @ (J @ rest)[..., None])[..., 0]
    np.testing.assert_allclose(v, expected, rtol=1e-5, atol=1e-7)
    fast = control.resolved_rate(panda)(q, 100.0 * twist, 0.0, np.zeros(7))
    assert (np.abs(fast) <= panda.limits.velocity * (1 + 1e-12)).all()
    moved = (J @ fast[..., None])[..., 0]
    np.testing.assert_allclose(moved / np.linalg.norm(moved, axis=1)[:, None], (twist / np.linalg.norm(twist))[None].repeat(20, 0), atol=1e-6)  # fmt: skip
    stretched = np.zeros(7)
    assert np.abs(law(stretched, np.array([0, 0, 0.1, 0, 0, 0]), 0.1, np.zeros(7))).max() < 1.0


def test_impedance_is_a_spring_at_the_tool(panda):
    """Pushed by a constant force, the tool gives way by force over stiffness; the elbow does not matter."""
    law = control.impedance(panda, bounded=False)
    q0 = np.array(panda.configurations["qr"])
    T, zero = panda.fk(q0), np.zeros(6)
    turn = so3_exp(np.array([0.0, 0.0, 0.7]))
    T[:3, :3] = T[:3, :3] @ turn
    q0 = panda.ik(T, q0).q
    stiffness = np.array([400.0, 300.0, 500.0, 30.0, 30.0, 30.0])
    damping = np.array([40.0, 40.0, 40.0, 4.0, 4.0, 4.0])
    rest = np.full(7, 5.0), np.full(7, 5.0)
    force = np.array([5.0, -3.0, 4.0, 0.0, 0.0, 0.0])

    def drive(t, q, v):
        return law(q, v, T, zero, stiffness, damping, q0, *rest) + panda.jacobian(q).T @ force

    log = simulate(panda, q0, torque=drive, duration=6.0, dt=1e-3, friction=None)
    pose = panda.fk(log.q[-1])
    in_goal = T[:3, :3].T @ force[:3]
    expected = T[:3, :3] @ (in_goal / stiffness[:3])
    np.testing.assert_allclose(pose[:3, 3] - T[:3, 3], expected, atol=3e-4)
    assert np.linalg.norm(so3_log(T[:3, :3].T @ pose[:3, :3])) < 0.03
    assert np.abs(log["v"][-1]).max() < 1e-2


def test_operational_space_control_moves_the_tool_as_a_free_mass(panda):
    law = control.operational_space(panda, regularisation=1e-6, bounded=False)
    q0 = np.array(panda.configurations["qr"])
    goal, zero = panda.fk(q0), np.zeros(6)
    goal[:3, 3] += 0.05, 0.1, -0.08
    kp, kd = np.full(6, 64.0), np.full(6, 16.0)
    rest = np.full(7, 2.0), np.full(7, 2.0)

    def drive(t, q, v):
        return law(q, v, goal, zero, zero, kp, kd, q0, *rest)

    log = simulate(panda, q0, torque=drive, duration=1.2, dt=5e-4, method="rk4", friction=None)
    away = panda.fk(log.q)[:, :3, 3] - goal[:3, 3]
    fall = (1.0 + 8.0 * log.t) * np.exp(-8.0 * log.t)
    np.testing.assert_allclose(away, away[0] * fall[:, None], atol=5e-4)


def test_admittance_moves_as_a_mass_on_a_spring(panda):
    law = control.admittance()
    T = panda.fk(panda.configurations["qr"])
    mass, damping, stiffness = np.full(6, 2.0), np.full(6, 30.0), np.full(6, 100.0)
    force = np.array([1.0, 2.0, -3.0, 0.2, 0.0, -0.1])
    x = rate = np.zeros(6)
    for _ in range(4000):
        led, x, rate = law(T, x, rate, force, mass, damping, stiffness, 1e-3)
    np.testing.assert_allclose(x, force / stiffness, rtol=1e-3)
    np.testing.assert_allclose(led[:3, 3] - T[:3, 3], T[:3, :3] @ x[:3], atol=1e-12)
    np.testing.assert_allclose(so3_log(T[:3, :3].T @ led[:3, :3]), x[3:], atol=1e-12)
    stiff = law(T, x, rate, force, mass, damping, np.full(6, 1e12), 1.0)  # a step far too long stays bounded
    assert np.abs(stiff[1]).max() < 1.0


def test_the_reactive_controller_reaches_goals_within_limits(panda):
    controller = control.Reactive(panda)
    q = np.array(panda.configurations["qr"])
    goal = panda.fk(q)
    goal[:3, 3] += 0.1, 0.25, -0.15
    arrived = False
    for _ in range(800):
        twist, arrived = control.p_servo(panda.fk(q), goal, 1.5, 0.005, "angle-axis")
        if arrived:
            break
        lack = np.abs(twist).sum() / 1.5
        v = controller(q, twist, 1.0 / lack)
        assert (np.abs(v) <= panda.limits.velocity + 1e-12).all()
        q = q + 0.02 * v
        assert panda.limits.contains(q)
    assert arrived


def test_the_reactive_controller_stops_at_limits_and_keeps_rows(panda):
    controller = control.Reactive(panda, stop=0.02)
    q = np.array(panda.configurations["qr"])
    q[1] = panda.limits.upper[1] - 0.02
    v = controller(q, [0.5, 0, -0.5, 0, 0, 0], 100.0)
    assert v[1] <= 1e-12
    free = controller(q, [0.0, 0.3, 0, 0, 0, 0])
    row = panda.jacobian(q)[1:2]
    held = controller(q, [0.0, 0.3, 0, 0, 0, 0], rows=(row, [0.05]))
    assert row @ free > 0.1 and row @ held <= 0.05 + 1e-9
    np.testing.assert_array_equal(controller(q, [0.0, 0.3, 0, 0, 0, 0], rows=(row, [9.0])), free)
    with pytest.raises(InputError, match="No joint velocity"):
        controller(q, [0.0, 0.3, 0, 0, 0, 0], rows=(np.vstack([row, -row]), [-5.0, -5.0]))
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(controller))(q, [0.0, 0.3, 0, 0, 0, 0]), free)


def test_mistakes_are_named(panda):
    with pytest.raises(UnknownName, match="panda_hand"):
        control.impedance(panda, "panda_hnd")
    with pytest.raises(UnknownName, match="local"):
        control.resolved_rate(panda, reference="lokal")
    with pytest.raises(InputError, match="stop"):
        control.Reactive(panda, stop=1.0, influence=0.5)
    law = control.joint_pd(panda)
    q = np.zeros(7)
    with pytest.raises(ShapeError, match="stiffness"):
        law(q, q, q, q, np.ones(6), q)
    with pytest.raises(NonFiniteError, match="q_goal"):
        law(q, q, q * np.nan, q, q, q)
    with pytest.raises(ShapeError, match="rows"):
        control.Reactive(panda)(q, np.zeros(6), rows=(np.zeros((2, 7)), [1.0]))
    rows = np.eye(7)[:1]
    reactive = control.Reactive(panda)
    with pytest.raises(ShapeError, match=r"rows\[0\]"):
        reactive(q, np.zeros(6), rows=(np.ones((7, 2)), [1.0, 1.0]))
    with pytest.raises(ShapeError, match="one configuration"):
        reactive(np.zeros((2, 7)), np.zeros(6), rows=(rows, [1.0]))
    for bad in ((rows * np.nan, [1.0]), (rows, [np.nan]), (rows, [-np.inf])):
        with pytest.raises(NonFiniteError, match="rows"):
            reactive(q, np.ones(6), rows=bad)
    reactive(q, np.ones(6), rows=(rows, [np.inf]))
    with pytest.raises(InputError, match="slack_weight"):
        reactive(q, np.ones(6), -1.0)
    for wrong in ("gain", "velocity_weight", "manipulability_weight"):
        with pytest.raises(InputError, match=wrong):
            control.Reactive(panda, **{wrong: -1.0})
    with pytest.raises(InputError, match="influence"):
        control.Reactive(panda, influence=np.inf)
    for make in (control.impedance, control.operational_space):
        with pytest.raises(InputError, match="regularisation"):
            make(panda, regularisation=0.0)


def test_admittance_refuses_what_holds_nothing():
    law, six, one = control.admittance(), np.zeros(6), np.ones(6)
    for mass, damping, stiffness, dt in (
        (six, six, six, 1e-3),
        (-one, six, six, 1e-3),
        (one, one, one, -1e-3),
        (np.array([one, -one]), one, one, 1e-3),
    ):
        with pytest.raises(InputError, match="must not be negative"):
            law(np.eye(4), six, six, one, mass, damping, stiffness, dt)
    _, x, _ = law(np.eye(4), six, six, one, six, one, six, 1e-3)  # a damper alone is enough
    np.testing.assert_allclose(x, 1e-3)
    assert law.operations < 300


def test_resolved_rate_over_computed_torque_brings_the_tool_to_its_goal(panda):
    """Velocities become torques: the inner law follows what the outer one asks for, in the simulator."""
    rate, track = control.resolved_rate(panda), control.computed_torque(panda)
    q0, zero = np.array(panda.configurations["qr"]), np.zeros(7)
    goal = panda.fk(q0)
    goal[:3, 3] += 0.08, -0.1, 0.05
    stiff, damped = np.zeros(7), np.full(7, 60.0)

    def drive(t, q, v):
        twist, _ = control.p_servo(panda.fk(q), goal, 3.0, method="angle-axis")
        return track(q, v, q, rate(q, twist, 0.01, zero), zero, stiff, damped)

    log = simulate(panda, q0, torque=drive, duration=3.0, dt=1e-3)
    pose = panda.fk(log.q[-1])
    assert np.linalg.norm(pose[:3, 3] - goal[:3, 3]) < 1e-3
    assert np.linalg.norm(so3_log(pose[:3, :3].T @ goal[:3, :3])) < 1e-3
    assert (np.abs(log["tau"]) <= panda.limits.effort + 1e-9).all()


def test_reactive_over_computed_torque_keeps_its_limits(panda):
    reactive, track = control.Reactive(panda), control.computed_torque(panda)
    q0, zero = np.array(panda.configurations["qr"]), np.zeros(7)
    goal = panda.fk(q0)
    goal[:3, 3] += 0.1, 0.2, -0.1

    def drive(t, q, v):
        twist, _ = control.p_servo(panda.fk(q), goal, 2.0, method="angle-axis")
        firm = 5.0 / max(float(np.abs(twist).sum()), 1e-4)  # the nearer, the less the twist may give way
        return track(q, v, q, reactive(q, twist, firm), zero, zero, np.full(7, 60.0))

    log = simulate(panda, q0, torque=drive, duration=3.0, dt=1e-3)
    assert panda.limits.contains(log.q).all() and (np.abs(log["v"]) <= panda.limits.velocity).all()
    assert np.linalg.norm(panda.fk(log.q[-1])[:3, 3] - goal[:3, 3]) < 5e-3


def test_admittance_over_impedance_yields_to_a_pushing_hand(panda):
    """A stiff arm that measures a push moves as the soft spring of its admittance would."""
    give, hold = control.admittance(), control.impedance(panda)
    q0 = np.array(panda.configurations["qr"])
    T, six = panda.fk(q0), np.zeros(6)
    mass, damping, stiffness = np.full(6, 2.0), np.full(6, 40.0), np.full(6, 100.0)
    stiff, calm = np.repeat([3000.0, 100.0], 3), np.repeat([150.0, 8.0], 3)
    rest = np.full(7, 5.0)
    push = np.array([3.0, 0, 0, 0, 0, 0])
    state = [six, six]

    def drive(t, q, v):
        led, *state[:] = give(T, *state, push, mass, damping, stiffness, 1e-3)
        return hold(q, v, led, six, stiff, calm, q0, rest, rest)

    log = simulate(panda, q0, torque=drive, duration=3.0, dt=1e-3)
    moved = T[:3, :3].T @ (panda.fk(log.q[-1])[:3, 3] - T[:3, 3])
    np.testing.assert_allclose(moved, [0.03, 0.0, 0.0], atol=1e-3)


def test_negative_gains_are_refused(panda: ulna.Robot) -> None:
    """A law with one drove the robot away from its goal without a word."""
    q, zero, rest = panda.configurations["ready"], np.zeros(7), (panda.neutral, np.ones(7), np.ones(7))
    T, six = panda.fk(q), np.zeros(6)
    laws: list[tuple[Any, list[Any], list[int]]] = [
        (control.joint_pd(panda), [q, zero, q, zero, np.ones(7), np.ones(7)], [4, 5]),
        (control.computed_torque(panda), [q, zero, q, zero, zero, np.ones(7), np.ones(7)], [5, 6]),
        (control.impedance(panda), [q, zero, T, six, np.ones(6), np.ones(6), *rest], [4, 5, 7, 8]),
        (
            control.operational_space(panda),
            [q, zero, T, six, six, np.ones(6), np.ones(6), *rest],
            [5, 6, 8, 9],
        ),
        (control.resolved_rate(panda), [q, six, 0.1, zero], [2]),
    ]
    for law, arguments, gains in laws:
        expected = law(*arguments)
        for k in gains:
            name = law.function.inputs[k].name
            for wrong in (-1e-9, -1.0):
                changed = list(arguments)
                changed[k] = np.array(arguments[k], dtype=float)
                changed[k].flat[-1] = wrong
                message = f"`{name}` holds {wrong:g}; expected numbers of zero or more"
                message = message.replace("+", "[+]")
                with pytest.raises(InputError, match=message):
                    law(*changed)
                with pytest.raises(InputError, match=message):  # in a batch
                    law(*(np.stack([a, b]) for a, b in zip(arguments, changed, strict=True)))
                with pytest.raises(InputError, match=message):  # another type, pickled, and a derivative
                    pickle.loads(pickle.dumps(law))(*(np.asarray(x).tolist() for x in changed))
            changed[k] = -0.0 * np.asarray(arguments[k])
            assert np.isfinite(law(*changed)).all()
        np.testing.assert_array_equal(law(*arguments), expected)
    with pytest.raises(InputError, match="`stiffness` holds -1"):
        laws[0][0].jacobian()(q, zero, q, zero, -np.ones(7), np.ones(7))
