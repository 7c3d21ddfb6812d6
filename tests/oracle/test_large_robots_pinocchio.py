"""Robots with many joints, against Pinocchio, whose data grow with the cube: 1,000 joints would take 70 GB."""

from __future__ import annotations

import numpy as np
import pytest

pin = pytest.importorskip("pinocchio")

import ulna  # noqa: E402
from support.long_robots import configurations, long_robot  # noqa: E402
from support.pinocchio_models import Twin, to_pinocchio  # noqa: E402

SIZES = [(60, 0.0), (100, 0.3), pytest.param(200, 0.05, marks=pytest.mark.slow)]


def assert_close(a, b) -> None:
    assert np.abs(a - b).max() <= 2e-11 * np.abs(b).max()


@pytest.mark.parametrize(("joints", "branching"), SIZES)
def test_large_robots_agree_with_pinocchio(
    joints: int, branching: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ulna.kernels, "LOOPED_ABOVE", 0)
    robot = ulna.Robot(long_robot(joints, branching))
    twin: Twin = to_pinocchio(robot.model)
    rng = np.random.default_rng(joints)
    q, data = configurations(robot.model, rng, 1)[0], twin.pin.createData()
    v, a = rng.standard_normal((2, robot.model.nv)) / np.sqrt(joints)
    q_, v_, a_ = twin.q(q), twin.v(v), twin.v(a)
    pin.computeJointJacobians(twin.pin, data, q_)
    pin.updateFramePlacements(twin.pin, data)
    tool = robot.model.frames.index(robot.model.frame(robot.model.tool))
    index = dict((f.name, i) for f, i in twin.frames)[robot.model.frames[tool].name]
    assert_close(robot.fk(q), data.oMf[index].homogeneous)
    for name, reference in (("world", pin.WORLD), ("local_world_aligned", pin.LOCAL_WORLD_ALIGNED)):
        J = twin.columns(pin.getFrameJacobian(twin.pin, data, index, reference))
        assert_close(robot.jacobian(q, reference=name), J)
    assert_close(twin.v(robot.inverse_dynamics(q, v, a)), pin.rnea(twin.pin, data, q_, v_, a_))
    assert_close(twin.v(robot.bias_forces(q, v)), pin.nonLinearEffects(twin.pin, data, q_, v_))
    assert_close(twin.v(robot.gravity_forces(q)), pin.computeGeneralizedGravity(twin.pin, data, q_))
    M = twin.both(np.triu(pin.crba(twin.pin, data, q_)) + np.triu(data.M, 1).T)
    assert_close(robot.mass_matrix(q), M)
    tau = rng.standard_normal(robot.model.nv)
    assert_close(twin.v(robot.forward_dynamics(q, v, tau)), pin.aba(twin.pin, data, q_, v_, twin.v(tau)))
    upper = np.triu(pin.computeMinverse(twin.pin, data, q_))
    assert_close(robot.inverse_mass_matrix(q), twin.both(upper + np.triu(upper, 1).T))
