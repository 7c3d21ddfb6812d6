"""Robots with constant-velocity joints, against Pinocchio's model of their turns, whose coordinates are C times theirs."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import random_inertia, random_pose
from ulna import Robot
from ulna.model import ConstantVelocity, ModelBuilder, Prismatic, Revolute

pin = pytest.importorskip("pinocchio")

DISTANCE = {"one point": 0.0, "distance": 0.08}


class Case:
    """A revolute joint, a constant-velocity one and a prismatic one, and the same as seven joints of Pinocchio."""

    def __init__(self, distance: float) -> None:
        rng = np.random.default_rng(11)
        builder, twin = ModelBuilder("arm").add_link("base"), pin.Model()
        kinds = Revolute((0, 0, 1)), ConstantVelocity(distance), Prismatic((1, 0, 0))
        turns = pin.JointModelRX(), pin.JointModelRY(), pin.JointModelRY(), pin.JointModelRX()
        chains = (pin.JointModelRZ(),), turns, (pin.JointModelPX(),)
        parent, index = "base", 0
        for k, (kind, chain) in enumerate(zip(kinds, chains, strict=True)):
            place, inertia = random_pose(rng), random_inertia(rng)
            builder.add_link(f"link{k}", inertia=inertia)
            builder.add_joint(f"joint{k}", kind, parent, f"link{k}", place)
            T = pin.SE3(place.rotation, place.translation)
            for i, joint in enumerate(chain):
                index = twin.addJoint(index, joint, T, f"{k}.{i}")
                T = pin.SE3(np.eye(3), np.array([0.0, 0.0, distance if i == 1 else 0.0]))
            body = pin.Inertia(inertia.mass, inertia.com, inertia.inertia)
            twin.appendBodyToJoint(index, body, pin.SE3.Identity())
            parent = f"link{k}"
        self.robot, self.twin, self.data = Robot(builder.build()), twin, twin.createData()
        self.C = np.zeros((6, 4))
        self.C[0, 0] = self.C[5, 3] = 1.0
        self.C[[1, 4], 1] = self.C[[2, 3], 2] = 0.5


@pytest.fixture(scope="module", params=DISTANCE)
def case(request: pytest.FixtureRequest) -> Case:
    return Case(DISTANCE[request.param])


def states(seed: int) -> tuple[np.ndarray, ...]:
    return tuple(np.random.default_rng(seed).uniform(-1.5, 1.5, (3, 4)))


@pytest.mark.parametrize("seed", range(4))
def test_kinematics(case: Case, seed: int) -> None:
    q, _, _ = states(seed)
    pin.forwardKinematics(case.twin, case.data, case.C @ q)
    np.testing.assert_allclose(case.robot.fk(q, "link2"), case.data.oMi[6].homogeneous, atol=1e-13)
    J = pin.computeJointJacobian(case.twin, case.data, case.C @ q, 6) @ case.C
    np.testing.assert_allclose(case.robot.jacobian(q, "link2", reference="local"), J, atol=1e-13)


@pytest.mark.parametrize("seed", range(4))
def test_dynamics(case: Case, seed: int) -> None:
    C, (q, v, a) = case.C, states(seed)
    tau = C.T @ pin.rnea(case.twin, case.data, C @ q, C @ v, C @ a)
    np.testing.assert_allclose(case.robot.inverse_dynamics(q, v, a), tau, atol=1e-11)
    np.testing.assert_allclose(case.robot.forward_dynamics(q, v, tau), a, atol=1e-9)
    M = C.T @ pin.crba(case.twin, case.data, C @ q) @ C
    np.testing.assert_allclose(case.robot.mass_matrix(q), M, atol=1e-12)
    by_q, by_v, _ = pin.computeRNEADerivatives(case.twin, case.data, C @ q, C @ v, C @ a)
    ours = case.robot.derivatives.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(ours[0], C.T @ by_q @ C, atol=1e-10)
    np.testing.assert_allclose(ours[1], C.T @ by_v @ C, atol=1e-10)
    momentum = pin.computeCentroidalMomentum(case.twin, case.data, C @ q, C @ v).vector
    np.testing.assert_allclose(case.robot.centroidal.momentum(q, v), momentum, atol=1e-12)
