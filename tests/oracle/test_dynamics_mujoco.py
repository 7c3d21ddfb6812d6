"""Dynamics against MuJoCo as a second oracle: an arm with slides and offsets, and a floating robot with legs."""

from __future__ import annotations

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from ulna import algorithms as alg  # noqa: E402
from ulna.model import FreeFlyer, Model, ModelBuilder, Prismatic, Revolute  # noqa: E402
from ulna.spatial import SE3, Inertia, quat_xyzw_to_matrix  # noqa: E402
from ulna.typing import Floats  # noqa: E402

BODY = '<inertial pos="{pos}" mass="{mass}" fullinertia="{inertia}"/>'
FIGURES = {
    "pan": (3.0, (0.02, -0.01, 0.1), (0.05, 0.06, 0.03, 0.004, -0.003, 0.002)),
    "lift": (2.2, (0.2, 0.03, 0.0), (0.02, 0.07, 0.06, 0.001, 0.002, -0.004)),
    "slide": (1.1, (0.0, 0.05, 0.12), (0.01, 0.015, 0.008, 0.0, 0.001, 0.0005)),
    "wrist": (0.6, (0.03, 0.0, 0.02), (0.002, 0.003, 0.0025, 0.0, 0.0004, 0.0)),
    "base": (8.0, (0.01, 0.02, 0.03), (0.3, 0.4, 0.5, 0.01, -0.02, 0.03)),
}
"""Mass, centre of mass, inertia about it as xx, yy, zz, xy, xz, yz: MuJoCo's order."""

# name, body it stands on, body it moves, pose, kind, axis, armature
ARM = [
    ("j0", None, "pan", ((0, 0, 0.3), (0.1, -0.2, 0.3)), "hinge", (0, 0, 1), 0.05),
    ("j1", "pan", "lift", ((0.1, 0, 0.2), (1.2, 0, 0.4)), "hinge", (0.6, 0.0, 0.8), 0.0),
    ("j2", "lift", "slide", ((0.4, 0.05, 0), (0, 0.7, 0)), "slide", (0, 1, 0), 0.2),
    ("j3", "slide", "wrist", ((0, 0.1, 0.3), (0.3, 0.2, 0.1)), "hinge", (1, 0, 0), 0.01),
]
LEGS = [
    ("j0", "base", "pan", ((0.2, 0.1, 0), (0.1, -0.2, 0.3)), "hinge", (0, 1, 0), 0.05),
    ("j1", "pan", "lift", ((0.1, 0, -0.2), (1.2, 0, 0.4)), "hinge", (0.6, 0.0, 0.8), 0.0),
    ("j2", "base", "slide", ((-0.2, 0.05, 0), (0, 0.7, 0)), "hinge", (0, 1, 0), 0.2),
    ("j3", "slide", "wrist", ((0, 0.1, -0.3), (0.3, 0.2, 0.1)), "slide", (1, 0, 0), 0.01),
]


class Case:
    """One robot in both libraries, at one state."""

    def __init__(self, joints: list, floating: bool) -> None:
        self.floating = floating
        self.model = ours(joints, floating)
        self.theirs = mujoco.MjModel.from_xml_string(mjcf(joints, floating))
        self.data = mujoco.MjData(self.theirs)
        rng = np.random.default_rng(11)
        m = self.model
        self.q, (self.v, self.a) = alg.random(m, rng), rng.standard_normal((2, m.nv))
        # W: MuJoCo's velocity is W v; its free joint has the linear part in world axes, the angular in the body's
        self.W, self.drift = np.eye(m.nv), np.zeros(m.nv)
        q = self.q
        if floating:
            R = quat_xyzw_to_matrix(q[3:7])
            self.W[:3, :3] = R
            self.drift[:3] = R @ np.cross(self.v[3:6], self.v[:3])
            q = np.concatenate([q[:3], q[6:7], q[3:6], q[7:]])
        self.data.qpos, self.data.qvel = q, self.W @ self.v
        mujoco.mj_forward(self.theirs, self.data)


def ours(joints: list, floating: bool) -> Model:
    b = ModelBuilder("robot")
    b.add_link("world" if not floating else "base", *([inertia("base")] if floating else []))
    if floating:
        b.root_joint(FreeFlyer())
    for name, parent, child, (place, turn), kind, axis, armature in joints:
        b.add_link(child, inertia(child))
        made = Revolute(axis) if kind == "hinge" else Prismatic(axis)
        b.add_joint(name, made, parent or "world", child, SE3.from_rpy(turn, place), armature=armature)
    return b.build()


def inertia(name: str) -> Inertia:
    mass, com, (xx, yy, zz, xy, xz, yz) = FIGURES[name]
    return Inertia.from_com(mass, com, (xx, xy, xz, yy, yz, zz))


def mjcf(joints: list, floating: bool) -> str:
    def inertial(name: str) -> str:
        mass, com, entries = FIGURES[name]
        return BODY.format(pos=words(com), mass=mass, inertia=words(entries))

    def bodies_on(parent: str | None) -> str:
        text = ""
        for name, stands_on, child, (place, turn), kind, axis, armature in joints:
            if stands_on == parent:
                x, y, z, w = SE3.from_rpy(turn).quat_xyzw()
                text += f'<body name="{child}" pos="{words(place)}" quat="{words((w, x, y, z))}">'
                text += f'<joint name="{name}" type="{kind}" axis="{words(axis)}" armature="{armature}"/>'
                text += inertial(child) + bodies_on(child) + "</body>"
        return text

    if floating:
        tree = f'<body name="base"><freejoint/>{inertial("base")}{bodies_on("base")}</body>'
    else:
        tree = bodies_on(None)
    settings = '<compiler angle="radian" autolimits="false"/><option gravity="0 0 -9.81"/>'
    return f"<mujoco>{settings}<worldbody>{tree}</worldbody></mujoco>"


def words(numbers) -> str:
    return " ".join(repr(float(x)) for x in numbers)


def close(actual: Floats, expected: Floats) -> None:
    scale = max(1.0, float(np.abs(expected).max()))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=1e-10 * scale)


@pytest.fixture(scope="module", params=["arm", "legs"])
def case(request: pytest.FixtureRequest) -> Case:
    return Case(ARM, False) if request.param == "arm" else Case(LEGS, True)


def test_mass_matrix(case: Case) -> None:
    columns = np.zeros((case.model.nv, case.model.nv))
    for column, unit in zip(columns, case.W.T, strict=True):
        mujoco.mj_mulM(case.theirs, case.data, column, np.ascontiguousarray(unit))
    close(alg.mass_matrix(case.model, case.q), case.W.T @ columns.T)


def test_torques(case: Case) -> None:
    m, q, v, a = case.model, case.q, case.v, case.a
    case.data.qacc = case.W @ a + case.drift
    mujoco.mj_inverse(case.theirs, case.data)
    close(alg.inverse_dynamics(m, q, v, a), case.W.T @ case.data.qfrc_inverse)


def test_accelerations(case: Case) -> None:
    m, q, v, tau = case.model, case.q, case.v, case.a
    case.data.qfrc_applied = np.linalg.solve(case.W.T, tau)
    mujoco.mj_forward(case.theirs, case.data)
    expected = np.linalg.solve(case.W, case.data.qacc - case.drift)
    close(alg.forward_dynamics(m, q, v, tau), expected)
    close(alg.aba(m, q, v, tau), expected)


def test_energy_and_centre_of_mass(case: Case) -> None:
    m, q, v = case.model, case.q, case.v
    mujoco.mj_energyPos(case.theirs, case.data)
    mujoco.mj_energyVel(case.theirs, case.data)
    close(alg.potential_energy(m, q), case.data.energy[0])
    close(alg.kinetic_energy(m, q, v), case.data.energy[1])
    mujoco.mj_subtreeVel(case.theirs, case.data)
    close(alg.center_of_mass(m, q), case.data.subtree_com[0])
    close(alg.center_of_mass_velocity(m, q, v), case.data.subtree_linvel[0])
    momentum = alg.centroidal_momentum(m, q, v)
    close(momentum[3:], case.data.subtree_angmom[0])
