"""Motors, friction and payloads against the Robotics Toolbox, on its Puma 560."""

from __future__ import annotations

import numpy as np
import pytest

rtb = pytest.importorskip("roboticstoolbox")

from ulna.algorithms import Friction  # noqa: E402
from ulna.model import Drive, ModelBuilder, Revolute, dynamic_parameters, with_drives  # noqa: E402
from ulna.robot import Robot  # noqa: E402
from ulna.spatial import SE3, Inertia  # noqa: E402


@pytest.fixture(scope="module")
def puma() -> tuple[Robot, Friction, rtb.DHRobot]:
    peer = rtb.models.DH.Puma560()
    builder = ModelBuilder("puma560").add_link("link0")
    for k, link in enumerate(peer.links):
        beyond = SE3.trans(0.0, 0.0, link.d) @ SE3.trans(link.a, 0.0, 0.0) @ SE3.rx(link.alpha)
        builder.add_link(f"link{k + 1}", Inertia.from_com(link.m, np.ravel(link.r), np.asarray(link.I)))
        builder.add_joint(f"joint{k + 1}", Revolute((0, 0, 1)), f"link{k}", f"link{k + 1}", offset=beyond)
    drives = {
        f"joint{k + 1}": Drive(link.Jm, abs(link.B), link.Tc[0], -link.Tc[1], gear=link.G)
        for k, link in enumerate(peer.links)
    }
    model = with_drives(builder.build(), drives)
    return Robot(model), Friction.of_drives(model, drives, width=1e-6), peer


def test_torques_with_motors_and_friction(puma) -> None:
    robot, law, peer = puma
    p = dynamic_parameters(robot.model)
    rng = np.random.default_rng(0)
    for _ in range(4):
        q, v, a = rng.uniform(-2.0, 2.0, (3, 6))
        tau = robot.joint_torque_regressor(q, v, a) @ p + robot.model.armature * a - law.torque(v)
        np.testing.assert_allclose(tau, peer.rne(q, v, a), rtol=1e-9, atol=1e-9)


def test_the_recorded_gravity_load(puma) -> None:
    robot, _, peer = puma
    tau = robot.gravity_regressor(peer.qn) @ dynamic_parameters(robot.model)
    np.testing.assert_allclose(tau, [0.0, 31.6398804, 6.03513802, 0.0, 0.0282528, 0.0], atol=1e-6)


def test_payload_capacity(puma) -> None:
    robot, _, peer = puma
    limit = [56.0, 97.0, 52.0, 10.0, 10.0, 10.0]
    w = np.array([3.0, -2.0, -9.81, 0.1, 0.2, 0.3])
    rng = np.random.default_rng(1)
    q = rng.uniform(-2.0, 2.0, (6, 6))
    theirs = peer.payload_capacity(q, limit, w)
    np.testing.assert_allclose(robot.payload_capacity(q, "link6", w, limit), theirs, rtol=1e-8)
    local = peer.payload_capacity(q, limit, w, frame="ee")
    np.testing.assert_allclose(robot.payload_capacity(q, "link6", w, limit, "local"), local, rtol=1e-8)
    weak = [56.0, 9.0, 52.0, 10.0, 10.0, 10.0]
    ours = robot.payload_capacity(q, "link6", w, weak)
    np.testing.assert_allclose(ours, peer.payload_capacity(q, weak, w), rtol=1e-8)
    assert np.isnan(ours).any()


@pytest.mark.parametrize("axes", ["all", "trans", "rot"])
def test_manipulability_by_asada(puma, axes: str) -> None:
    robot, _, peer = puma
    for q in np.random.default_rng(2).uniform(-2.0, 2.0, (6, 6)):
        theirs = peer.manipulability(q, method="asada", axes=axes)
        assert robot.manipulability(q, "asada", axes, frame="link6") == pytest.approx(
            float(np.squeeze(theirs)), rel=1e-8
        )
