"""One step of differential inverse kinematics against mink, which has its kinematics from MuJoCo."""

from __future__ import annotations

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")
mink = pytest.importorskip("mink")

import ulna  # noqa: E402
from ulna.ik.differential import (  # noqa: E402
    ComTask,
    DifferentialIK,
    FrameTask,
    PositionLimit,
    PostureTask,
    RelativeFrameTask,
    VelocityLimit,
)

DT = 0.02
TIP, SIDE = "panda_link7", "panda_link3"


def mjcf(robot: ulna.Robot) -> str:
    """The arm as MuJoCo reads it: a chain of bodies, each with one hinge about z."""
    text, closing = "<mujoco><compiler angle='radian'/><worldbody>", ""
    numbers = lambda values: " ".join(repr(float(x)) for x in values)  # noqa: E731
    for joint, inertia in zip(robot.model.joints, robot.model.inertias, strict=True):
        assert joint.kind.axis == (0.0, 0.0, 1.0)
        x, y, z, w = joint.placement.quat_xyzw()
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia.inertia
        text += (
            f"<body name='{joint.child_link}' pos='{numbers(joint.placement.translation)}' "
            f"quat='{numbers((w, x, y, z))}'><joint name='{joint.name}' axis='0 0 1' limited='true' "
            f"range='{numbers((joint.limits.lower[0], joint.limits.upper[0]))}'/>"
            f"<inertial pos='{numbers(inertia.com)}' mass='{inertia.mass!r}' "
            f"fullinertia='{numbers((xx, yy, zz, xy, xz, yz))}'/>"
        )
        closing += "</body>"
    return text + closing + "</worldbody></mujoco>"


@pytest.fixture(scope="module")
def arms() -> tuple[ulna.Robot, mujoco.MjModel]:
    robot = ulna.load("panda", visuals="simple")
    return robot, mujoco.MjModel.from_xml_string(mjcf(robot))


@pytest.mark.parametrize("seed", range(6))
def test_same_velocity(arms, seed: int) -> None:
    robot, theirs = arms
    rng = np.random.default_rng(seed)
    q = robot.random_configuration(seed=rng)
    q[seed] = robot.limits.lower[seed] + 1e-3
    aim = q + 0.1 * rng.standard_normal(7)
    tasks = [
        FrameTask(TIP, [1.0, 2.0, 3.0], 0.5, gain=0.8, damping=0.1),
        PostureTask(0.1, gain=0.3),
        ComTask(0.4, damping=0.0),
    ]
    same = [
        mink.FrameTask(TIP, "body", [1.0, 2.0, 3.0], 0.5, gain=0.8, lm_damping=0.1),
        mink.PostureTask(theirs, 0.1, gain=0.3),
        mink.ComTask(0.4),
    ]
    if seed % 2:
        tasks.append(RelativeFrameTask(TIP, SIDE, 0.7, 0.3, damping=0.0))
        same.append(mink.RelativeFrameTask(TIP, "body", SIDE, "body", 0.7, 0.3))
    ik = DifferentialIK(robot, tasks, [VelocityLimit(), PositionLimit(gain=0.9)], damping=1e-6)
    configuration = mink.Configuration(theirs, aim)
    for task in same:
        task.set_target_from_configuration(configuration)
    configuration.update(q)
    fastest = {name: v for name, v in zip(robot.joint_names, robot.limits.velocity, strict=True)}
    limits = [mink.ConfigurationLimit(theirs, 0.9), mink.VelocityLimit(theirs, fastest)]
    v = mink.solve_ik(configuration, same, DT, "daqp", damping=1e-6, limits=limits, primal_tol=1e-12)
    np.testing.assert_allclose(
        ik.velocity(q, DT, **ik.targets_at(aim)), v, atol=1e-8 * max(1.0, np.abs(v).max())
    )
