"""Robots with rolling joints, one of which mimics another joint, against Pinocchio's model of their turns: its q is C times ours plus c."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import random_inertia, random_pose
from ulna import Robot
from ulna.model import ModelBuilder, Prismatic, Revolute, Rolling

pin = pytest.importorskip("pinocchio")

RATIO, OFFSET = -0.7, 0.4


class Case:
    """Two joints, a rolling one, and one that rolls as the first joint turns; and the same as six joints of Pinocchio."""

    def __init__(self) -> None:
        rng = np.random.default_rng(12)
        builder, twin = ModelBuilder("finger").add_link("base"), pin.Model()
        kinds = Revolute(), Rolling(0.03, 0.05), Prismatic((1, 0, 0)), Rolling(-0.3, 0.1)
        distances = {1: 0.08, 3: -0.2}
        parent, index = "base", 0
        for k, kind in enumerate(kinds):
            place, inertia = random_pose(rng), random_inertia(rng)
            builder.add_link(f"link{k}", inertia=inertia)
            mimic = ("joint0", RATIO, OFFSET) if k == 3 else None
            builder.add_joint(f"joint{k}", kind, parent, f"link{k}", place, mimic=mimic)
            first = {0: pin.JointModelRZ(), 2: pin.JointModelPX()}.get(k, pin.JointModelRY())
            T = pin.SE3(place.rotation, place.translation)
            index = twin.addJoint(index, first, T, f"{k}.0")
            if k in distances:
                T = pin.SE3(np.eye(3), np.array([0.0, 0.0, distances[k]]))
                index = twin.addJoint(index, pin.JointModelRY(), T, f"{k}.1")
            body = pin.Inertia(inertia.mass, inertia.com, inertia.inertia)
            twin.appendBodyToJoint(index, body, pin.SE3.Identity())
            parent = f"link{k}"
        self.robot, self.twin, self.data = Robot(builder.build()), twin, twin.createData()
        self.C, self.c = np.zeros((6, 3)), np.zeros(6)
        self.C[0, 0] = self.C[3, 2] = 1.0
        self.C[[1, 2], 1] = 5 / 8, 3 / 8
        self.C[[4, 5], 0] = RATIO * -0.5, RATIO * 1.5
        self.c[[4, 5]] = OFFSET * -0.5, OFFSET * 1.5


@pytest.fixture(scope="module")
def case() -> Case:
    return Case()


def states(seed: int) -> tuple[np.ndarray, ...]:
    return tuple(np.random.default_rng(seed).uniform(-1.5, 1.5, (3, 3)))


@pytest.mark.parametrize("seed", range(4))
def test_kinematics(case: Case, seed: int) -> None:
    q, _, _ = states(seed)
    at = case.C @ q + case.c
    pin.forwardKinematics(case.twin, case.data, at)
    np.testing.assert_allclose(case.robot.fk(q, "link3"), case.data.oMi[6].homogeneous, atol=1e-13)
    J = pin.computeJointJacobian(case.twin, case.data, at, 6) @ case.C
    np.testing.assert_allclose(case.robot.jacobian(q, "link3", reference="local"), J, atol=1e-13)


@pytest.mark.parametrize("seed", range(4))
def test_dynamics(case: Case, seed: int) -> None:
    C, (q, v, a) = case.C, states(seed)
    at = C @ q + case.c
    tau = C.T @ pin.rnea(case.twin, case.data, at, C @ v, C @ a)
    np.testing.assert_allclose(case.robot.inverse_dynamics(q, v, a), tau, atol=1e-11)
    np.testing.assert_allclose(case.robot.forward_dynamics(q, v, tau), a, atol=1e-9)
    M = C.T @ pin.crba(case.twin, case.data, at) @ C
    np.testing.assert_allclose(case.robot.mass_matrix(q), M, atol=1e-12)
    by_q, by_v, _ = pin.computeRNEADerivatives(case.twin, case.data, at, C @ v, C @ a)
    ours = case.robot.derivatives.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(ours[0], C.T @ by_q @ C, atol=1e-10)
    np.testing.assert_allclose(ours[1], C.T @ by_v @ C, atol=1e-10)
    momentum = pin.computeCentroidalMomentum(case.twin, case.data, at, C @ v).vector
    np.testing.assert_allclose(case.robot.centroidal.momentum(q, v), momentum, atol=1e-12)
