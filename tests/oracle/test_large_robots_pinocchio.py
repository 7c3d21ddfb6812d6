"""Robots with many joints, against Pinocchio, whose data grow with the cube: 1,000 joints would take 70 GB."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pin = pytest.importorskip("pinocchio")

import ulna  # noqa: E402
from support.long_robots import configurations, long_robot  # noqa: E402
from support.pinocchio_models import Twin, to_pinocchio  # noqa: E402

SIZES = [(60, 0.0), (100, 0.3), pytest.param(200, 0.05, marks=pytest.mark.slow)]


def assert_close(a, b) -> None:
    assert np.abs(a - b).max() <= 2e-11 * np.abs(b).max()


def looped_case(
    joints: int, branching: float, monkeypatch: pytest.MonkeyPatch
) -> tuple[ulna.Robot, Twin, Any, np.random.Generator, tuple[Any, Any, Any]]:
    """A long robot whose kernels are loops, Pinocchio's twin of it with data, and q, v and a."""
    monkeypatch.setattr(ulna.kernels, "LOOPED_ABOVE", 0)
    monkeypatch.setattr(ulna.kernels, "_MAX_STAGES", 0)
    robot = ulna.Robot(long_robot(joints, branching))
    twin = to_pinocchio(robot.model)
    rng = np.random.default_rng(joints)
    q = configurations(robot.model, rng, 1)[0]
    v, a = rng.standard_normal((2, robot.model.nv)) / np.sqrt(joints)
    return robot, twin, twin.pin.createData(), rng, (q, v, a)


@pytest.mark.parametrize(("joints", "branching"), SIZES)
def test_large_robots_agree_with_pinocchio(
    joints: int, branching: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, twin, data, rng, (q, v, a) = looped_case(joints, branching, monkeypatch)
    q_, v_, a_ = twin.q(q), twin.v(v), twin.v(a)
    pin.computeJointJacobians(twin.pin, data, q_)
    pin.updateFramePlacements(twin.pin, data)
    tool = robot.model.frames.index(robot.model.frame(robot.model.tool))
    index = dict((f.name, i) for f, i in twin.frames)[robot.model.frames[tool].name]
    assert_close(robot.fk(q), data.oMf[index].homogeneous)
    for name, reference in (("world", pin.WORLD), ("local_world_aligned", pin.LOCAL_WORLD_ALIGNED)):
        J = twin.columns(pin.getFrameJacobian(twin.pin, data, index, reference))
        assert_close(robot.jacobian(q, reference=name), J)
    pin.forwardKinematics(twin.pin, data, q_, v_, a_)
    for name, reference in (("local", pin.LOCAL), ("local_world_aligned", pin.LOCAL_WORLD_ALIGNED)):
        for classical in (False, True):
            theirs = (pin.getFrameClassicalAcceleration if classical else pin.getFrameAcceleration)(
                twin.pin, data, index, reference
            )
            assert_close(
                robot.frame_acceleration(q, v, a, reference=name, classical=classical), theirs.vector
            )
    assert_close(twin.v(robot.inverse_dynamics(q, v, a)), pin.rnea(twin.pin, data, q_, v_, a_))
    assert_close(twin.v(robot.bias_forces(q, v)), pin.nonLinearEffects(twin.pin, data, q_, v_))
    assert_close(twin.v(robot.gravity_forces(q)), pin.computeGeneralizedGravity(twin.pin, data, q_))
    M = twin.both(np.triu(pin.crba(twin.pin, data, q_)) + np.triu(data.M, 1).T)
    assert_close(robot.mass_matrix(q), M)
    tau = rng.standard_normal(robot.model.nv)
    assert_close(twin.v(robot.forward_dynamics(q, v, tau)), pin.aba(twin.pin, data, q_, v_, twin.v(tau)))
    upper = np.triu(pin.computeMinverse(twin.pin, data, q_))
    assert_close(robot.inverse_mass_matrix(q), twin.both(upper + np.triu(upper, 1).T))


@pytest.mark.parametrize(("joints", "branching"), SIZES)
def test_regressors_and_momentum_agree_with_pinocchio(
    joints: int, branching: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, twin, data, _, (q, v, a) = looped_case(joints, branching, monkeypatch)
    state = twin.q(q), twin.v(v), twin.v(a)
    names = ("joint_torque_regressor", "centroidal_derivatives", "centroidal_matrix_dot")
    regressor, derivatives, matrix_dot = (robot.kernel(name) for name in names)
    assert all("loops over" in repr(kernel) for kernel in (regressor, derivatives, matrix_dot))
    theirs = pin.computeJointTorqueRegressor(twin.pin, data, *state)
    order = [twin.pin.getJointId(joint.name) - 1 for joint in robot.model.joints]
    theirs = theirs.reshape(robot.nv, -1, 10)[:, order].reshape(robot.nv, -1)
    assert_close(regressor(q, v, a), twin.columns(theirs.T).T)
    for x, y in zip(
        derivatives(q, v, a), pin.computeCentroidalDynamicsDerivatives(twin.pin, data, *state), strict=True
    ):
        assert_close(x, twin.columns(y))
    pin.dccrba(twin.pin, data, *state[:2])
    assert_close(matrix_dot(q, v), twin.columns(data.dAg))


@pytest.mark.parametrize(("joints", "branching"), SIZES)
def test_derivatives_under_forces_agree_with_pinocchio(
    joints: int, branching: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, twin, data, rng, (q, v, a) = looped_case(joints, branching, monkeypatch)
    model = robot.model
    theirs, ours = pin.StdVec_Force([pin.Force.Zero() for _ in range(twin.pin.njoints)]), {}
    for k in (3, joints // 2, joints):
        frame, wrench = model.frame(f"l{k}"), rng.standard_normal(6)
        joint = model.joints[frame.joint]
        theirs[twin.pin.getJointId(joint.name)] = pin.Force(
            frame.placement.act(ulna.Force(wrench[:3], wrench[3:])).vector()
        )
        ours[f"l{k}"] = wrench
    by_q, by_v, M = pin.computeRNEADerivatives(twin.pin, data, twin.q(q), twin.v(v), twin.v(a), theirs)
    found = robot.derivatives.inverse_dynamics(q, v, a, ours, "local")
    for x, y in zip(found, (by_q, by_v, np.triu(M) + np.triu(M, 1).T), strict=True):
        assert_close(x, twin.both(y))


@pytest.mark.parametrize(("joints", "branching"), SIZES)
def test_derivatives_of_frames_agree_with_pinocchio(
    joints: int, branching: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, twin, data, _, (q, v, a) = looped_case(joints, branching, monkeypatch)
    model = robot.model
    tool = model.frames.index(model.frame(model.tool))
    index = dict((f.name, i) for f, i in twin.frames)[model.frames[tool].name]
    pin.computeJointJacobiansTimeVariation(twin.pin, data, twin.q(q), twin.v(v))
    pin.updateFramePlacements(twin.pin, data)
    references: tuple[tuple[Any, Any], ...] = (
        ("world", pin.WORLD),
        ("local", pin.LOCAL),
        ("local_world_aligned", pin.LOCAL_WORLD_ALIGNED),
    )
    for name, reference in references:
        theirs = pin.getFrameJacobianTimeVariation(twin.pin, data, index, reference)
        assert_close(robot.jacobian_dot(q, v, reference=name), twin.columns(theirs))
    pin.computeForwardKinematicsDerivatives(twin.pin, data, twin.q(q), twin.v(v), twin.v(a))
    theirs = pin.getFrameVelocityDerivatives(twin.pin, data, index, pin.LOCAL)
    for x, y in zip(robot.derivatives.frame_velocity(q, v), theirs, strict=True):
        assert_close(x, twin.columns(y))
    _, *theirs = pin.getFrameAccelerationDerivatives(twin.pin, data, index, pin.LOCAL)
    for x, y in zip(robot.derivatives.frame_acceleration(q, v, a), theirs, strict=True):
        assert_close(x, twin.columns(y))
    for name, _ in references:  # along v, the Hessian is the rate of the Jacobian
        along = np.tensordot(v, robot.derivatives.jacobian(q, reference=name), 1)
        assert_close(along, robot.jacobian_dot(q, v, reference=name))
