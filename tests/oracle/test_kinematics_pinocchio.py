"""Kinematics against Pinocchio: robots of example-robot-data, and random robots with every kind of joint.

Three answers of Pinocchio 4.1 are not asked for, because they are not the derivatives they are meant to be
(the laws in tests/laws check ours by differences): the derivatives of the Jacobian of composite joints, which
take their motion subspace for constant, and of mimic joints; and the Hessian in LOCAL between coordinates of
one joint.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

pin = pytest.importorskip("pinocchio")

from support.pinocchio_models import REFERENCES, SINGLE_JOINT_KINDS, Twin, from_pinocchio, to_pinocchio  # noqa: E402
from support.random_models import KINDS, random_model  # noqa: E402
from ulna import algorithms as alg  # noqa: E402
from ulna.model import Continuous  # noqa: E402
from ulna.robots import example_robot_data  # noqa: E402
from ulna.typing import Floats  # noqa: E402

FIXED = ("panda", "ur5", "tiago", "kinova", "allegro_left_hand", "xarm7", "double_pendulum_continuous")
FLOATING = ("talos", "g1", "solo12", "anymal", "hector")


@cache
def twin(name: str) -> Twin:
    if name.startswith("random"):
        number = int(name.split("-")[1])
        rng = np.random.default_rng(number)
        every = list(KINDS)
        kinds, root, mimics = [
            (SINGLE_JOINT_KINDS, None, 0),
            (every, "free_flyer", 0),
            (every, "planar", 0),
            (SINGLE_JOINT_KINDS, None, 1),  # Pinocchio crashes on composite and mimic joints in one model
            (SINGLE_JOINT_KINDS, None, 2),
        ][number]
        return to_pinocchio(random_model(rng, kinds, root=root, mimics=mimics))
    if example_robot_data.share_folder() is None:
        pytest.skip("example-robot-data is not installed")
    urdf = str(example_robot_data.files(name)[0])
    if example_robot_data.DESCRIPTIONS[name].floating:
        return from_pinocchio(pin.buildModelFromUrdf(urdf, pin.JointModelFreeFlyer()))
    return from_pinocchio(pin.buildModelFromUrdf(urdf))


def states(t: Twin, seed: int) -> list[tuple[Floats, Floats, Floats]]:
    """Neutral, where many robots are singular; a hair beside it; anywhere."""
    rng = np.random.default_rng(seed)
    neutral = alg.neutral(t.model)
    beside = alg.integrate(t.model, neutral, 1e-8 * rng.standard_normal(t.model.nv))
    anywhere = [alg.random(t.model, rng) for _ in range(2)]
    return [(q, *rng.standard_normal((2, t.model.nv))) for q in (neutral, beside, *anywhere)]


def close(actual: Floats, expected: Floats) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=1e-10 * scale)


NAMES = [*FIXED, *FLOATING, *(f"random-{i}" for i in range(5))]


@pytest.fixture(scope="module", params=NAMES)
def robot(request: pytest.FixtureRequest) -> Twin:
    return twin(request.param)


def some_frames(t: Twin) -> list:
    """The last of every tenth of the frames: fingers, feet, heads."""
    return [*t.frames[:: max(1, len(t.frames) // 6)], t.frames[-1]]


def check_kinematics(t: Twin) -> None:
    model, data = t.model, t.pin.createData()
    mimics = any(joint.mimic for joint in model.joints)
    for q, v, a in states(t, 1):
        pin.forwardKinematics(t.pin, data, t.q(q), t.v(v), t.v(a))
        pin.updateFramePlacements(t.pin, data)
        poses = alg.frame_poses(model, q, [frame for frame, _ in t.frames])
        for pose, (_, k) in zip(poses, t.frames, strict=True):
            close(pose.matrix(), data.oMf[k].homogeneous)
        pin.computeJointJacobians(t.pin, data, t.q(q))
        if not mimics:
            close(alg.joint_jacobians(model, q), t.columns(data.J))
        for frame, k in some_frames(t):
            for name, reference in REFERENCES.items():
                close(
                    alg.frame_jacobian(model, q, frame, name),
                    t.columns(pin.getFrameJacobian(t.pin, data, k, reference)),
                )
                V = alg.frame_velocity(model, q, v, frame, name)
                close(V.vector(), pin.getFrameVelocity(t.pin, data, k, reference).vector)
                A = alg.frame_acceleration(model, q, v, a, frame, name)
                close(A.vector(), pin.getFrameAcceleration(t.pin, data, k, reference).vector)
                A = alg.frame_acceleration(model, q, v, a, frame, name, classical=True)
                close(A.vector(), pin.getFrameClassicalAcceleration(t.pin, data, k, reference).vector)


def test_poses_twists_accelerations_jacobians(robot: Twin) -> None:
    check_kinematics(robot)


@pytest.mark.parametrize("name", [*FIXED, *FLOATING, "random-0"])
def test_derivatives_of_the_jacobian(name: str) -> None:
    t = twin(name)
    data = t.pin.createData()
    several = any(joint.kind.nv > 1 for joint in t.model.joints)
    for q, v, _ in states(t, 2)[1:3]:
        pin.computeJointJacobiansTimeVariation(t.pin, data, t.q(q), t.v(v))
        pin.updateFramePlacements(t.pin, data)
        for frame, k in some_frames(t)[::2]:
            for reference, theirs in REFERENCES.items():
                close(
                    alg.frame_jacobian_dot(t.model, q, v, frame, reference),
                    t.columns(pin.getFrameJacobianTimeVariation(t.pin, data, k, theirs)),
                )
        pin.computeJointKinematicHessians(t.pin, data, t.q(q))
        frame, k = t.frames[-1]
        for reference, theirs in REFERENCES.items():
            if reference == "local" and several:
                continue
            H = pin.getFrameKinematicHessian(t.pin, data, k, theirs)
            H = H.reshape(-1).reshape(H.shape, order="F")  # the binding hands out columns as rows
            close(np.moveaxis(alg.frame_hessian(t.model, q, frame, reference), -3, -1), t.both(H))


@pytest.mark.parametrize("name", [*FIXED, *FLOATING, "random-0"])
def test_derivatives_of_velocity_and_acceleration(name: str) -> None:
    t = twin(name)
    data = t.pin.createData()
    q, v, a = states(t, 3)[2]
    pin.computeForwardKinematicsDerivatives(t.pin, data, t.q(q), t.v(v), t.v(a))
    pin.updateFramePlacements(t.pin, data)
    for frame, k in some_frames(t):
        theirs = pin.getFrameVelocityDerivatives(t.pin, data, k, pin.LOCAL)
        for mine, other in zip(alg.frame_velocity_derivatives(t.model, q, v, frame), theirs, strict=True):
            close(mine, t.columns(other))
        _, *theirs = pin.getFrameAccelerationDerivatives(t.pin, data, k, pin.LOCAL)
        for mine, other in zip(
            alg.frame_acceleration_derivatives(t.model, q, v, a, frame), theirs, strict=True
        ):
            close(mine, t.columns(other))


@pytest.mark.parametrize("name", [*FIXED, *FLOATING, "random-0", "random-1", "random-2"])
def test_configuration_space(name: str) -> None:
    t = twin(name)
    model = t.model
    rng = np.random.default_rng(4)
    q0 = alg.random(model, rng)
    v = rng.uniform(-1.0, 1.0, model.nv)
    q1 = alg.integrate(model, q0, v)
    close(_up_to_sign(t, t.q(q1)), _up_to_sign(t, pin.integrate(t.pin, t.q(q0), t.v(v))))
    close(t.v(alg.difference(model, q0, q1)), pin.difference(t.pin, t.q(q0), t.q(q1)))
    middle = alg.interpolate(model, q0, q1, 0.3)
    close(_up_to_sign(t, t.q(middle)), _up_to_sign(t, pin.interpolate(t.pin, t.q(q0), t.q(q1), 0.3)))
    close(alg.distance(model, q0, q1), pin.distance(t.pin, t.q(q0), t.q(q1)))
    close(t.q(alg.neutral(model)), pin.neutral(t.pin))
    for mine, theirs in zip(
        alg.integrate_derivatives(model, q0, v), pin.dIntegrate(t.pin, t.q(q0), t.v(v)), strict=True
    ):
        close(mine, t.both(theirs))
    for mine, theirs in zip(
        alg.difference_derivatives(model, q0, q1), pin.dDifference(t.pin, t.q(q0), t.q(q1)), strict=True
    ):
        close(mine, t.both(theirs))


def _up_to_sign(t: Twin, q: Floats) -> Floats:
    """`q` with the quaternions, which may come with either sign, replaced by rotation matrices."""
    data = t.pin.createData()
    pin.forwardKinematics(t.pin, data, q)
    return np.stack([M.homogeneous for M in data.oMi])


def test_free_angles_differ_the_short_way() -> None:
    t = twin("double_pendulum_continuous")
    assert any(isinstance(joint.kind, Continuous) for joint in t.model.joints)
    q0, q1 = np.full(t.model.nq, 3.0), np.full(t.model.nq, -3.0)
    close(alg.difference(t.model, q0, q1), pin.difference(t.pin, t.q(q0), t.q(q1)))
    close(alg.difference(t.model, q0, q1), np.full(t.model.nv, 2.0 * np.pi - 6.0))


REST = set(example_robot_data.DESCRIPTIONS) - {*FIXED, *FLOATING} - {"ur3_empty"}  # whose URDF has no name


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(REST))
def test_every_robot_of_example_robot_data(name: str) -> None:
    check_kinematics(twin(name))
