"""Friction laws and payload capacity."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna import numeric
from ulna.algorithms import Friction
from ulna.compiler import compile
from ulna.errors import InputError, ShapeError
from ulna.model import Drive, dynamic_parameters, with_drives, with_joint_dynamics, with_payload


def test_friction_opposes_the_motion_and_is_smooth() -> None:
    law = Friction(viscous=0.5, coulomb=2.0, width=0.01)
    v = np.array([-1.0, -0.01, 0.0, 0.01, 1.0])
    f = law.torque(v)
    np.testing.assert_allclose(f, [2.5, 2.0 * np.tanh(1.0) + 0.005, 0.0, -2.0 * np.tanh(1.0) - 0.005, -2.5])
    assert law.is_dry and not Friction(viscous=1.0).is_dry


def test_directions_and_stribeck() -> None:
    law = Friction(coulomb=1.0, backward=2.0, static=3.0, stribeck=0.05, width=1e-3)
    np.testing.assert_allclose(law.torque(np.array([10.0, -10.0])), [-1.0, 2.0])
    np.testing.assert_allclose(law.torque(np.array([0.01]))[0], -(1.0 + 2.0 * np.exp(-0.04)), rtol=1e-6)
    np.testing.assert_allclose(law.dry_bound(np.array([0.0, 1.0, -1.0])), [3.0, 1.0, 2.0])


def test_compiled_friction_is_the_same() -> None:
    law = Friction([0.1, 0.2], [1.0, 0.0], [2.0, 0.5], [3.0, 1.0])
    kernel = ulna.compile(lambda v: law.torque(v), v=(2,))
    v = np.random.default_rng(0).uniform(-0.2, 0.2, (50, 2))
    np.testing.assert_allclose(kernel(v), law.torque(v), atol=1e-13)


def test_of_a_model() -> None:
    model = ulna.load("panda").model
    law = Friction.of(model)
    np.testing.assert_array_equal(law.numbers(model.nv)[0], model.damping)
    with pytest.raises(ShapeError, match="viscous"):
        law.numbers(3)


@pytest.mark.parametrize(
    "wrong",
    [{"viscous": -1.0}, {"coulomb": np.nan}, {"width": 0.0}, {"coulomb": [1.0, 2.0], "viscous": [1.0] * 3}],
)
def test_wrong_numbers_are_refused(wrong) -> None:
    with pytest.raises(InputError):
        Friction(**wrong)


def test_payload_capacity_brings_one_joint_to_its_limit() -> None:
    robot = ulna.load("panda")
    q = robot.configurations["qr"]
    capacity = robot.payload_capacity(q)
    assert capacity.shape == (7,)
    most = float(capacity.min())
    loaded = with_payload(robot.model, None, most)
    tau = ulna.Robot(loaded).gravity_regressor(q) @ dynamic_parameters(loaded)
    used = np.abs(tau) / robot.limits.effort
    assert used.max() == pytest.approx(1.0, abs=1e-9)
    assert used.argmax() == capacity.argmin()


def test_an_effort_limit_of_zero_in_a_model_is_none_for_payloads_too() -> None:
    robot = ulna.load("panda")
    unknown = ulna.Robot(with_joint_dynamics(robot.model, effort=[0.0, *robot.limits.effort[1:]]))
    q = robot.configurations["ready"]
    capacity = unknown.payload_capacity(q)
    assert capacity[0] == np.inf
    np.testing.assert_array_equal(capacity[1:], robot.payload_capacity(q)[1:])
    assert np.isnan(robot.payload_capacity(q, effort=np.zeros(7))[1])  # given as such, it holds nothing


def test_payload_capacity_of_batches_and_wrenches() -> None:
    robot = ulna.load("panda")
    q = robot.random_configuration(4, seed=0)
    w = [0.0, 0.0, -9.81, 0.0, 0.0, 0.0]
    effort = np.array([87.0, 87.0, 87.0, 87.0, 12.0, 12.0, np.inf])
    found = robot.payload_capacity(q, "panda_hand_tcp", w, effort)
    np.testing.assert_allclose(found[:, :6], robot.payload_capacity(q)[:, :6])
    assert np.isinf(found[:, 6]).all()
    weak = robot.payload_capacity(robot.configurations["qr"], effort=np.full(7, 1.0))
    assert np.isnan(weak[1]) and np.isnan(weak[3])


def test_joints_without_load_hold_any_multiple_in_either_precision() -> None:
    """Torques of rounding errors, some 1e-6 N m in float32, made millions of kilograms of what is no limit."""
    robot = ulna.load("panda")
    q = robot.random_configuration(200, seed=7001)
    exact = robot.payload_capacity(q)
    limits, load = np.full(7, 50.0), np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0])
    expected = robot.payload_capacity(q, effort=limits)
    single = robot.kernel("payload_multiples", dtype="float32")(q, load, limits)
    assert np.isinf(exact[:, 0]).all() and np.isinf(expected[:, 0]).all() and np.isinf(single[:, 0]).all()
    np.testing.assert_array_equal(np.isinf(single), np.isinf(expected))
    same = np.isfinite(expected)
    np.testing.assert_allclose(single[same], expected[same], rtol=0.02)
    small = robot.payload_capacity(q, wrench=1e-9 * load, effort=limits)  # the answer scales with the load
    np.testing.assert_allclose(small[same], 1e9 * expected[same], rtol=1e-9)
    assert np.isinf(robot.payload_capacity(q[0], wrench=np.zeros(6), effort=limits)).all()
    with pytest.raises(InputError, match="`effort` holds -1"):
        robot.payload_capacity(q[0], effort=-np.ones(7))


def test_of_drives_keeps_both_directions() -> None:
    model = ulna.load("ur5").model
    name = model.joint_names[1]
    drives = {name: Drive(1e-4, 1e-3, 0.2, 0.4, gear=-50.0)}
    law = Friction.of_drives(model, drives)
    viscous, forward, backward = law.numbers(model.nv)
    assert viscous[1] == pytest.approx(2.5)
    assert forward[1] == pytest.approx(10.0)
    assert backward[1] == pytest.approx(20.0)
    assert with_drives(model, drives).friction[1] == pytest.approx(15.0)
    assert forward[0] == backward[0] == model.friction[0]


def test_friction_of_a_drive_is_that_of_the_toolbox() -> None:
    rtb = pytest.importorskip("roboticstoolbox")
    link = rtb.RevoluteDH(Jm=2e-4, B=1.5e-3, Tc=[0.4, -0.45], G=-62.6)
    drive = Drive(link.Jm, link.B, link.Tc[0], -link.Tc[1], gear=link.G)
    at_joint = drive.at_joint
    assert at_joint["armature"] == pytest.approx(2e-4 * 62.6**2)
    law = Friction(at_joint["damping"], 62.6 * drive.both_ways[0], 62.6 * drive.both_ways[1], width=1e-4)
    for speed in (-1.0, -0.1, 0.2, 2.0):
        assert law.torque(np.array([speed]))[0] == pytest.approx(link.friction(speed), rel=1e-12)


def test_derivatives_of_tanh_are_finite_for_all_numbers() -> None:
    kernel = compile(lambda x: numeric.tanh(x[0]), x=(1,))
    derivative = kernel.jacobian()
    for x in (-1e300, -400.0, -3.0, 0.0, 0.5, 19.0, 21.0, 400.0, 1e300):
        assert kernel([x]) == pytest.approx(np.tanh(x), abs=3e-16)
        assert derivative([x])[0] == pytest.approx(1.0 / np.cosh(min(abs(x), 300.0)) ** 2, abs=1e-15)
    assert np.isnan(kernel([np.nan]))


def test_a_law_keeps_copies_of_the_arrays_it_is_given() -> None:
    """The caller's array became read-only, and a law made of a view changed with what it is a view of."""
    own, rows = np.full(2, 0.5), np.ones((3, 2))
    law, of_view = Friction(viscous=own), Friction(viscous=rows[1])
    own[:], rows[:] = 2.0, 3.0
    np.testing.assert_array_equal(law.viscous, [0.5, 0.5])
    np.testing.assert_array_equal(of_view.viscous, [1.0, 1.0])


def test_equal_laws_share_a_kernel() -> None:
    robot = ulna.load("ur5", visuals="simple")
    each = np.full(6, 0.3)
    one, same = Friction(0.5, each, stribeck=0.1), Friction(0.5, each.copy(), stribeck=0.1)
    assert one == same and hash(one) == hash(same) and one != 0.5
    assert robot.kernel("forward_dynamics", friction=one) is robot.kernel("forward_dynamics", friction=same)
    for other in (
        Friction(0.5, each + 0.1, stribeck=0.1),
        Friction(0.5, each),
        Friction(0.5, each, each, stribeck=0.1),
    ):
        assert one != other
        assert robot.kernel("forward_dynamics", friction=one) is not robot.kernel(
            "forward_dynamics", friction=other
        )
    traced = compile(
        lambda c, v: Friction(coulomb=c).torque(v) + Friction(coulomb=2.0 * c).torque(v), c=(), v=()
    )
    assert traced(2.0, 0.3) == pytest.approx(3.0 * Friction(coulomb=2.0).torque(0.3))
