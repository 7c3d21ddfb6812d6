"""Dynamics against Pinocchio: robots of example-robot-data, fixed and floating, and random robots of every kind of joint.

What Pinocchio 4.1 is not asked for: the Coriolis matrix and the rate of the centroidal matrix of composite joints, whose
motion subspace it takes for constant; anything but the torques of mimic joints, whose crba leaves entries unset.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

pin = pytest.importorskip("pinocchio")

from support.pinocchio_models import SINGLE_JOINT_KINDS, Twin, from_pinocchio, to_pinocchio  # noqa: E402
from support.random_models import KINDS, random_model  # noqa: E402
from ulna import algorithms as alg  # noqa: E402
from ulna.robots import example_robot_data  # noqa: E402
from ulna.spatial import Force  # noqa: E402
from ulna.typing import Floats  # noqa: E402

QUICK = ("panda", "ur5", "kinova", "double_pendulum_continuous", "solo12+", "g1+", "anymal+", "talos")
RANDOM = {
    "random plain": (SINGLE_JOINT_KINDS, None, 0),
    "random floating": (SINGLE_JOINT_KINDS, "free_flyer", 0),
    "random every kind": (list(KINDS), "planar", 0),
    "random mimic": (SINGLE_JOINT_KINDS, None, 2),
}
REST = sorted(
    {
        f"{name}{'+' * (number % 2)}"
        for number, name in enumerate(sorted(set(example_robot_data.DESCRIPTIONS) - {"ur3_empty"}))
    }
    - set(QUICK)
)
"""Every robot, each second on a free flyer, "+": the recursions are the same for both. The URDF of ur3_empty has no name."""


@cache
def twin(name: str) -> Twin:
    if name in RANDOM:
        kinds, root, mimics = RANDOM[name]
        number = list(RANDOM).index(name)
        return to_pinocchio(random_model(np.random.default_rng(40 + number), kinds, root=root, mimics=mimics))
    if example_robot_data.share_folder() is None:
        pytest.skip("example-robot-data is not installed")
    urdf = str(example_robot_data.files(name.removesuffix("+"))[0])
    return from_pinocchio(pin.buildModelFromUrdf(urdf, *[pin.JointModelFreeFlyer()] * name.endswith("+")))


class State:
    """A robot at a random place, in both libraries."""

    def __init__(self, name: str) -> None:
        self.twin, rng = twin(name), np.random.default_rng(7)
        self.model, self.pin = self.twin.model, self.twin.pin
        self.q = alg.random(self.model, rng)
        self.v, self.a = rng.standard_normal((2, self.model.nv))
        self.theirs = self.twin.q(self.q), self.twin.v(self.v), self.twin.v(self.a)
        self.data = self.pin.createData()
        self.rng = rng

    def back(self, vector: Floats) -> Floats:
        """A tangent vector of Pinocchio's in our order."""
        return self.twin.columns(vector)


def close(actual: Floats, expected: Floats, tolerance: float = 1e-10) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def check_torques(s: State) -> None:
    m, q, v, a = s.model, s.q, s.v, s.a
    pq, pv, pa = s.theirs
    close(alg.inverse_dynamics(m, q, v, a), s.back(pin.rnea(s.pin, s.data, pq, pv, pa)))
    close(alg.bias_forces(m, q, v), s.back(pin.nonLinearEffects(s.pin, s.data, pq, pv)))
    close(alg.gravity_forces(m, q), s.back(pin.computeGeneralizedGravity(s.pin, s.data, pq)))
    M = pin.crba(s.pin, s.data, pq)
    close(alg.mass_matrix(m, q), s.twin.both(np.triu(M) + np.triu(M, 1).T))


def check_forces(s: State) -> None:
    m, q, v, a = s.model, s.q, s.v, s.a
    pq, pv, pa = s.theirs
    external: list[Force | None] = [None] * len(m.joints)
    wrenches = [pin.Force.Zero() for _ in range(s.pin.njoints)]
    for i in range(
        0, len(m.joints), 2
    ):  # a frame for each of half of the joints; both libraries share the frames
        frame, k = next(pair for pair in s.twin.frames if pair[0].joint == i)
        w = s.rng.standard_normal(6)
        external[i] = frame.placement.act(Force(w[:3], w[3:]))
        wrenches[s.pin.frames[k].parentJoint] = s.pin.frames[k].placement.act(pin.Force(w))
    close(alg.inverse_dynamics(m, q, v, a, external), s.back(pin.rnea(s.pin, s.data, pq, pv, pa, wrenches)))


def check_accelerations(s: State) -> None:
    m, q, v = s.model, s.q, s.v
    pq, pv, tau = s.theirs
    M = alg.mass_matrix(m, q)
    condition = float(np.linalg.cond(M)) if m.nv else 1.0
    if condition > 1e12:
        return  # something moves no mass: there is no acceleration to compare
    tolerance = 1e-10 + 1e-14 * condition
    theirs = s.back(pin.aba(s.pin, s.data, pq, pv, tau))
    close(alg.aba(m, q, v, s.a), theirs, tolerance)
    close(alg.by_mass_matrix(m, q, v, s.a), theirs, tolerance)
    inverse = pin.computeMinverse(s.pin, s.data, pq)
    close(alg.inverse_mass_matrix(m, q), s.twin.both(np.triu(inverse) + np.triu(inverse, 1).T), tolerance)


def check_energy_and_mass(s: State) -> None:
    m, q, v, a = s.model, s.q, s.v, s.a
    pq, pv, pa = s.theirs
    drives = 0.5 * float(
        v @ (m.armature * v)
    )  # Pinocchio's energy holds those of some joints and not of others
    s.pin.armature[:] = 0.0
    close(alg.kinetic_energy(m, q, v) - drives, pin.computeKineticEnergy(s.pin, s.data, pq, pv))
    s.pin.armature[:] = m.armature[s.twin.order]
    close(alg.potential_energy(m, q), pin.computePotentialEnergy(s.pin, s.data, pq))
    if not alg.total_mass(m) > 0.0:
        return
    close(alg.total_mass(m), pin.computeTotalMass(s.pin))
    pin.centerOfMass(s.pin, s.data, pq, pv, pa)
    close(alg.center_of_mass(m, q), s.data.com[0])
    close(alg.center_of_mass_velocity(m, q, v), s.data.vcom[0])
    close(alg.center_of_mass_acceleration(m, q, v, a), s.data.acom[0])
    joint = m.joints[len(m.joints) // 2]
    k, has_mass = s.pin.getJointId(joint.name), alg.total_mass(m, joint.name) > 0.0
    if has_mass:
        close(alg.center_of_mass(m, q, joint.name), s.data.oMi[k].act(s.data.com[k]))
    close(alg.center_of_mass_jacobian(m, q), s.twin.columns(pin.jacobianCenterOfMass(s.pin, s.data, pq)))
    if has_mass:
        theirs = pin.getJacobianSubtreeCenterOfMass(s.pin, s.data, k)
        close(alg.center_of_mass_jacobian(m, q, joint.name), s.twin.columns(theirs))


def check_momentum(s: State) -> None:
    m, q, v, a = s.model, s.q, s.v, s.a
    if not alg.total_mass(m) > 0.0:
        return
    pq, pv, pa = s.theirs
    close(alg.centroidal_momentum(m, q, v), pin.computeCentroidalMomentum(s.pin, s.data, pq, pv).vector)
    pin.computeCentroidalMomentumTimeVariation(s.pin, s.data, pq, pv, pa)
    close(alg.centroidal_momentum_rate(m, q, v, a), s.data.dhg.vector)
    close(alg.centroidal_matrix(m, q), s.twin.columns(pin.computeCentroidalMap(s.pin, s.data, pq)))
    pin.ccrba(s.pin, s.data, pq, pv)
    close(alg.centroidal_inertia(m, q), s.data.Ig.inertia)


def check_rates(s: State) -> None:
    m, q, v = s.model, s.q, s.v
    pq, pv, _ = s.theirs
    close(alg.coriolis_matrix(m, q, v), s.twin.both(pin.computeCoriolisMatrix(s.pin, s.data, pq, pv)))
    if alg.total_mass(m) > 0.0:
        theirs = pin.computeCentroidalMapTimeVariation(s.pin, s.data, pq, pv)
        close(alg.centroidal_matrix_dot(m, q, v), s.twin.columns(theirs))


def check_all(s: State) -> None:
    for check in (check_torques, check_forces, check_accelerations, check_energy_and_mass, check_momentum, check_rates):  # fmt: skip
        check(s)


@pytest.mark.parametrize("name", [*QUICK, "random plain", "random floating"])
def test_robots(name: str) -> None:
    check_all(State(name))


def test_composite_joints() -> None:
    s = State("random every kind")
    for check in (check_torques, check_forces, check_accelerations, check_energy_and_mass, check_momentum):
        check(s)


def test_mimic_joints() -> None:
    s = State("random mimic")
    pq, pv, pa = s.theirs
    close(alg.inverse_dynamics(s.model, s.q, s.v, s.a), s.back(pin.rnea(s.pin, s.data, pq, pv, pa)))
    rest = pin.rnea(s.pin, s.data, pq, pv, 0.0 * pa).copy()
    columns = [pin.rnea(s.pin, s.data, pq, pv, unit) - rest for unit in np.eye(s.pin.nv)]
    close(alg.mass_matrix(s.model, s.q), s.twin.both(np.stack(columns)))


@pytest.mark.slow
@pytest.mark.parametrize("name", REST)
def test_every_robot_of_example_robot_data(name: str) -> None:
    check_all(State(name))
