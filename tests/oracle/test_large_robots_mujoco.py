"""Robots with thousands of joints, against MuJoCo: Pinocchio's data would take more than 70 GB for 1,000 joints."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from support.long_robots import configurations, long_robot
from ulna.model import Model, Prismatic

mujoco = pytest.importorskip("mujoco")

# MuJoCo refuses chains much longer than a thousand joints, and takes minutes to compile trees of 5,000.
SIZES = [(300, 0.1), *(pytest.param(*s, marks=pytest.mark.slow) for s in ((1000, 0.0), (2000, 0.2)))]


def to_mujoco(model: Model) -> Any:
    """The robot of a model of revolute and prismatic joints."""
    spec = mujoco.MjSpec()
    spec.option.gravity = model.gravity
    spec.option.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    bodies = {-1: spec.worldbody}
    for index, (joint, inertia) in enumerate(zip(model.joints, model.inertias, strict=True)):
        place, full = joint.placement, inertia.inertia
        w, x, y, z = np.roll(place.quat_xyzw(), 1)
        body = bodies[index] = bodies[joint.parent].add_body(
            name=f"b{index}", pos=place.translation, quat=[w, x, y, z], mass=inertia.mass, ipos=inertia.com,
            fullinertia=[full[0, 0], full[1, 1], full[2, 2], full[0, 1], full[0, 2], full[1, 2]],
            explicitinertial=True,
        )  # fmt: skip
        kind = (
            mujoco.mjtJoint.mjJNT_SLIDE if isinstance(joint.kind, Prismatic) else mujoco.mjtJoint.mjJNT_HINGE
        )
        body.add_joint(type=kind, axis=joint.kind.axis, armature=joint.armature[0])
    return spec.compile()


def assert_close(a: Any, b: Any, tolerance: float = 1e-10) -> None:
    assert np.abs(a - b).max() <= tolerance * np.abs(b).max()


@pytest.mark.parametrize(("joints", "branching"), SIZES)
def test_large_robots_agree_with_mujoco(
    joints: int, branching: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ulna.kernels, "LOOPED_ABOVE", 0)
    model = long_robot(joints, branching)
    robot, reference = ulna.Robot(model), to_mujoco(model)
    data, rng = mujoco.MjData(reference), np.random.default_rng(joints)
    q = configurations(model, rng, 1)[0]
    v, a = rng.standard_normal((2, model.nv)) / np.sqrt(joints)
    data.qpos, data.qvel, data.qacc = q, v, a
    mujoco.mj_inverse(reference, data)
    assert "loops over" in repr(robot.kernel("inverse_dynamics"))
    body = data.body(f"b{model.frame(model.tool).joint}")
    assert_close(robot.fk(q)[:3, 3], body.xpos)
    assert_close(robot.fk(q)[:3, :3], body.xmat.reshape(3, 3))
    assert_close(robot.inverse_dynamics(q, v, a), data.qfrc_inverse)
    assert_close(robot.bias_forces(q, v), data.qfrc_bias)
    if joints <= 1000:
        data.qfrc_applied = data.qfrc_inverse
        mujoco.mj_forward(reference, data)
        assert_close(robot.forward_dynamics(q, v, data.qfrc_applied), data.qacc, 1e-5)


@pytest.mark.parametrize(("joints", "branching"), SIZES[:2])
def test_external_forces_and_damping_agree_with_mujoco(
    joints: int, branching: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """MuJoCo's forces act at the centres of mass of bodies, along the axes of the world."""
    monkeypatch.setattr(ulna.kernels, "LOOPED_ABOVE", 0)
    model = long_robot(joints, branching)
    robot, reference = ulna.Robot(model), to_mujoco(model)
    data, rng = mujoco.MjData(reference), np.random.default_rng(joints)
    q = configurations(model, rng, 1)[0]
    v, a, damping = rng.standard_normal((3, model.nv)) / np.sqrt(joints)
    damping = np.abs(damping)
    reference.dof_damping[:] = damping
    data.qpos, data.qvel, data.qacc = q, v, a
    mujoco.mj_inverse(reference, data)
    forces, pulled = {}, np.zeros(model.nv)
    for k in (joints // 5, joints // 2, joints):
        body = reference.body(f"b{model.frame(f'l{k}').joint}").id
        force, torque = rng.standard_normal((2, 3))
        mujoco.mj_applyFT(reference, data, force, torque, data.xipos[body], body, pulled)
        data.xfrc_applied[body] = np.concatenate([force, torque])
        forces[f"l{k}"] = np.concatenate(
            [force, torque + np.cross(data.xipos[body] - data.xpos[body], force)]
        )
    friction = ulna.algorithms.Friction(viscous=damping)
    torques = robot.inverse_dynamics(q, v, a, forces, friction=friction)
    assert "loops over" in repr(robot.kernel("inverse_dynamics", forces=tuple(forces), friction=friction))
    assert_close(torques, data.qfrc_inverse - pulled)
    assert_close(robot.bias_forces(q, v, forces), data.qfrc_bias - pulled)
    data.qfrc_applied = torques
    mujoco.mj_forward(reference, data)
    assert_close(robot.forward_dynamics(q, v, torques, forces, friction=friction), data.qacc, 1e-5)
    still = np.zeros(model.nv)
    assert_close(robot.static_torque(q, forces), robot.inverse_dynamics(q, still, still, forces))
