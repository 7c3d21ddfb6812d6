"""Derivatives of dynamics against Pinocchio: robots of example-robot-data, and random robots of its joint kinds.

Pinocchio 4.1 is not asked for robots with composite joints, whose motion subspace its derivatives take for constant, nor
with mimic joints, which they refuse; the laws in tests/laws check those by differences.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

pin = pytest.importorskip("pinocchio")

from support.pinocchio_models import SINGLE_JOINT_KINDS, Twin, from_pinocchio, to_pinocchio  # noqa: E402
from support.random_models import random_model  # noqa: E402
from ulna.algorithms import integrate, neutral, random  # noqa: E402
from ulna.algorithms.derivatives.centroidal import centroidal_derivatives, com_velocity_derivatives  # noqa: E402
from ulna.algorithms.derivatives.forward_dynamics import forward_dynamics_derivatives  # noqa: E402
from ulna.algorithms.derivatives.inverse_dynamics import inverse_dynamics_derivatives  # noqa: E402
from ulna.robots import example_robot_data  # noqa: E402
from ulna.spatial import Force  # noqa: E402
from ulna.typing import Floats  # noqa: E402

FIXED = ("panda", "ur5", "tiago", "double_pendulum_continuous")
FLOATING = ("talos", "g1", "solo12", "anymal")
ROOTS = {"random-0": None, "random-1": "free_flyer", "random-2": "planar"}


@cache
def twin(name: str) -> Twin:
    if name in ROOTS:
        rng = np.random.default_rng(int(name[-1]))
        return to_pinocchio(random_model(rng, SINGLE_JOINT_KINDS, root=ROOTS[name], mimics=0))
    if example_robot_data.share_folder() is None:
        pytest.skip("example-robot-data is not installed")
    urdf = str(example_robot_data.files(name)[0])
    if example_robot_data.DESCRIPTIONS[name].floating:
        return from_pinocchio(pin.buildModelFromUrdf(urdf, pin.JointModelFreeFlyer()))
    return from_pinocchio(pin.buildModelFromUrdf(urdf))


def states(t: Twin) -> list[tuple[Floats, Floats, Floats]]:
    """A hair beside neutral, where many robots are singular, and anywhere."""
    rng = np.random.default_rng(1)
    beside = integrate(t.model, neutral(t.model), 1e-8 * rng.standard_normal(t.model.nv))
    return [(q, *rng.standard_normal((2, t.model.nv))) for q in (beside, random(t.model, rng))]


def close(actual: Floats, expected: Floats, tolerance: float = 1e-10) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def symmetric(upper: Floats) -> Floats:
    return np.triu(upper) + np.triu(upper, 1).T


def forces(t: Twin) -> tuple[list[Force], pin.StdVec_Force]:
    """Random forces on all bodies, in the moving frames, for both libraries."""
    rng = np.random.default_rng(2)
    theirs = pin.StdVec_Force([pin.Force.Zero() for _ in range(t.pin.njoints)])
    ours = []
    for joint in t.model.joints:
        wrench = rng.standard_normal(6)
        ours.append(Force(wrench[:3], wrench[3:]))
        theirs[t.pin.getJointId(joint.name)] = pin.Force(wrench)
    return ours, theirs


def check_inverse(t: Twin) -> None:
    data = t.pin.createData()
    ours, theirs = forces(t)
    same_frames = not any(joint.kind.name == "planar" for joint in t.model.joints)  # the twin turns those
    for q, v, a in states(t):
        for mine, other in ((None, ()), (ours, (theirs,))) if same_frames else ((None, ()),):
            by_q, by_v, M = pin.computeRNEADerivatives(t.pin, data, t.q(q), t.v(v), t.v(a), *other)
            found = inverse_dynamics_derivatives(t.model, q, v, a, mine)
            for x, y in zip(found, (by_q, by_v, symmetric(M)), strict=True):
                close(x, t.both(y))


def check_forward(t: Twin) -> None:
    data = t.pin.createData()
    for q, v, tau in states(t):
        # a relative error of a comes from the condition of M, hence of the masses of the robot
        slack = 1e-14 * float(np.linalg.cond(inverse_dynamics_derivatives(t.model, q, v, tau)[2]))
        if slack > 1.0:  # fingers without mass: any force accelerates them without bound, in both libraries
            continue
        by_q, by_v, inverse = pin.computeABADerivatives(t.pin, data, t.q(q), t.v(v), t.v(tau))
        found = forward_dynamics_derivatives(t.model, q, v, tau)
        for x, y in zip(found, (by_q, by_v, symmetric(inverse)), strict=True):
            close(x, t.both(y), max(1e-10, slack))


def check_centroidal(t: Twin) -> None:
    data = t.pin.createData()
    for q, v, a in states(t):
        theirs = pin.computeCentroidalDynamicsDerivatives(t.pin, data, t.q(q), t.v(v), t.v(a))
        for x, y in zip(centroidal_derivatives(t.model, q, v, a), theirs, strict=True):
            close(x, t.columns(y))
        pin.computeForwardKinematicsDerivatives(t.pin, data, t.q(q), t.v(v), t.v(a))
        pin.centerOfMass(t.pin, data, t.q(q), t.v(v))
        theirs = t.columns(pin.getCenterOfMassVelocityDerivatives(t.pin, data))
        known = np.isfinite(
            theirs
        )  # Pinocchio divides by the mass beyond a joint, which is zero in some fingers
        close(com_velocity_derivatives(t.model, q, v)[0][known], theirs[known])


@pytest.mark.parametrize("name", [*FIXED, *FLOATING, *ROOTS])
def test_centroidal_momentum_and_centre_of_mass(name: str) -> None:
    check_centroidal(twin(name))


@pytest.mark.parametrize("name", [*FIXED, *FLOATING, *ROOTS])
def test_inverse_dynamics(name: str) -> None:
    check_inverse(twin(name))


@pytest.mark.parametrize("name", [*FIXED, *FLOATING, *ROOTS])
def test_forward_dynamics(name: str) -> None:
    check_forward(twin(name))


REST = set(example_robot_data.DESCRIPTIONS) - {*FIXED, *FLOATING} - {"ur3_empty"}  # whose URDF has no name


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(REST))
def test_every_robot(name: str) -> None:
    t = twin(name)
    check_inverse(t)
    check_forward(t)
    check_centroidal(t)
