"""Models at the edge of what a model can be: dynamics equal to Pinocchio's, or to those of a model without mimic joints."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import ulna
from ulna.errors import ModelError, ModelWarning
from ulna.model import FreeFlyer, ModelBuilder, Revolute
from ulna.robot import Robot
from ulna.spatial import SE3, Inertia

pin = pytest.importorskip("pinocchio")

BODY = Inertia.from_com(1.0, (0.05, 0.02, 0.03), np.diag([0.1, 0.2, 0.15]))


def link(name: str, mass: float | None = 1.0, size: float = 0.3) -> str:
    if mass is None:
        return f'<link name="{name}"/>'
    a, b, c = (mass * size**2 * k for k in (0.4, 0.6, 0.5))
    return (
        f'<link name="{name}"><inertial><origin xyz="{0.1 * size} {0.2 * size} 0"/><mass value="{mass}"/>'
        f'<inertia ixx="{a}" iyy="{b}" izz="{c}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def joint(name: str, kind: str, parent: str, child: str, axis: str = "0 0 1") -> str:
    limit = "" if kind in ("fixed", "floating") else '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.1 0.2 0.3" rpy="0.3 0.2 0.1"/><axis xyz="{axis}"/>{limit}</joint>'
    )


CASES = {
    "no joint": link("b"),
    "no joint moves": link("b") + link("a") + joint("j1", "fixed", "b", "a"),
    "one joint": link("b") + link("a") + joint("j1", "revolute", "b", "a"),
    "floating": link("b") + link("a") + joint("j1", "floating", "b", "a"),
    "nothing between two joints": link("b", None)
    + link("a", None)
    + link("c")
    + joint("j1", "prismatic", "b", "a")
    + joint("j2", "revolute", "a", "c", "0 1 0"),
    "long axes": link("b")
    + link("a")
    + link("c")
    + joint("j1", "prismatic", "b", "a", "0 0 0.001")
    + joint("j2", "revolute", "a", "c", "10 20 30"),
    "a grain on a ship": link("b")
    + link("a", 1e9, 30.0)
    + link("c", 1e-12, 1e-3)
    + joint("j1", "revolute", "b", "a")
    + joint("j2", "revolute", "a", "c", "0 1 0"),
    "a ship on a grain": link("b")
    + link("a", 1e-6, 1e-2)
    + link("c", 1e3)
    + joint("j1", "revolute", "b", "a")
    + joint("j2", "revolute", "a", "c", "0 1 0"),
}


@pytest.mark.parametrize("case", CASES)
def test_dynamics_are_those_of_pinocchio(case: str) -> None:
    text = f'<robot name="edge">{CASES[case]}</robot>'
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)  # axes that are not of length 1
        robot = ulna.load(text)
    model = pin.buildModelFromXML(text)
    data, rng = model.createData(), np.random.default_rng(3)
    q = robot.random_configuration(seed=3)
    v, a = rng.normal(size=(2, robot.nv))
    tau = pin.rnea(model, data, q, v, a)
    np.testing.assert_allclose(
        robot.inverse_dynamics(q, v, a), tau, rtol=1e-9, atol=1e-12 * abs(tau).max(initial=0)
    )
    M = pin.crba(model, data, q)
    scale = np.sqrt(np.diag(M))
    ours = robot.mass_matrix(q)
    np.testing.assert_allclose(
        np.triu(ours) / np.outer(scale, scale), np.triu(M) / np.outer(scale, scale), atol=1e-10
    )
    np.testing.assert_allclose(
        robot.inverse_mass_matrix(q) @ ours * np.outer(1 / scale, scale) ** -1, np.eye(robot.nv), atol=1e-7
    )
    pin.framesForwardKinematics(model, data, q)
    poses = robot.fk(q, "all")
    for name in robot.link_names:
        pose = data.oMf[model.getFrameId(name, pin.FrameType.BODY)].homogeneous
        np.testing.assert_allclose(poses[robot.model.frame_index(name)], pose, atol=1e-12)


def arm(*followed: tuple[float, float]) -> Robot:
    """Three joints; with multipliers and offsets, each follows the one before."""
    builder = ModelBuilder("arm").add_link("l0")
    for k, axis in enumerate(np.eye(3)[[2, 1, 0]].tolist()):
        mimic = (f"j{k}", *followed[k - 1]) if k and followed else None
        builder.add_link(f"l{k + 1}", BODY)
        builder.add_joint(
            f"j{k + 1}", Revolute(tuple(axis)), f"l{k}", f"l{k + 1}", SE3.trans(0.1, 0.2, 0.3), mimic=mimic
        )
    return Robot(builder.build())


@pytest.mark.parametrize("ratios", [(-2.0, -0.5), (0.0, 3.0), (2.0, 0.0), (-1.0, -1.0), (1e-8, 1e8)])
def test_a_joint_that_follows_a_follower_moves_with_the_product(ratios: tuple[float, float]) -> None:
    robot, free = arm((ratios[0], 0.1), (ratios[1], 0.2)), arm()
    q, v, a = np.array([[0.3], [0.7], [-0.4]])
    G = np.array([1.0, ratios[0], ratios[0] * ratios[1]])
    second = ratios[0] * q[0] + 0.1
    Q = np.array([q[0], second, ratios[1] * second + 0.2])
    np.testing.assert_allclose(robot.mass_matrix(q)[0, 0], G @ free.mass_matrix(Q) @ G, rtol=1e-12)
    tau = robot.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(tau[0], G @ free.inverse_dynamics(Q, G * v, G * a), rtol=1e-12)
    np.testing.assert_allclose(robot.forward_dynamics(q, v, tau), a, rtol=1e-12)


@pytest.mark.parametrize(
    "inertia", [Inertia.from_point(1.0), Inertia.from_com(1.0, (0, 0, 0), np.diag([0.1, 0.1, 0]))]
)
def test_a_free_body_without_inertia_about_a_line_is_refused(inertia: Inertia) -> None:
    builder = ModelBuilder("thin").add_link("world").add_link("rod", inertia)
    builder.add_joint("root", FreeFlyer(), "world", "rod")
    with pytest.raises(ModelError, match="'root'.*some motion"):
        Robot(builder.build()).kernel("forward_dynamics")
