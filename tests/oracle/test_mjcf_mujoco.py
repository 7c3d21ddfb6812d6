"""Random MJCF trees against MuJoCo: where bodies and sites are, mass matrix, gravity and bias forces."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from support.mjcf_compare import differences
from support.mjcf_physics import loaded
from support.random_mjcf import RandomMjcf
from ulna.typing import Floats

mj: Any = pytest.importorskip("mujoco")


def numbers(values: Floats) -> str:
    return " ".join(f"{x:.9f}" for x in np.atleast_1d(values))


def joints(rng: np.random.Generator, body: int) -> str:
    """Up to three joints of a body; a ball joint stands alone or last, as MuJoCo asks for hinges and slides."""
    text = ""
    for k in range(rng.integers(0, 4)):
        kind = "ball" if k == 0 and rng.random() < 0.2 else str(rng.choice(["hinge", "slide"]))
        rest = (
            "" if kind == "ball" else f'axis="{numbers(rng.normal(size=3))}" ref="{rng.uniform(-1, 1):.6f}"'
        )
        text += (
            f'<joint name="j{body}_{k}" type="{kind}" pos="{numbers(rng.normal(size=3))}" {rest} '
            f'armature="{rng.uniform(0, 0.1):.6f}"/>'
        )
        if kind == "ball":
            break
    return text


def tree(rng: np.random.Generator, bodies: int, floating: bool) -> str:
    parents = [-1, *(int(rng.integers(0, b)) for b in range(1, bodies))]

    def body(b: int) -> str:
        motion = "<freejoint/>" if b == 0 and floating else joints(rng, b)
        shape = rng.choice(["sphere", "box", "capsule", "ellipsoid", "cylinder"])
        below = "".join(body(c) for c in range(bodies) if parents[c] == b)
        return (
            f'<body name="b{b}" pos="{numbers(rng.normal(size=3))}" quat="{numbers(rng.normal(size=4))}">{motion}'
            f'<geom type="{shape}" size="{numbers(rng.uniform(0.1, 0.4, 3))}" pos="{numbers(rng.normal(size=3))}" '
            f'euler="{numbers(rng.uniform(-3, 3, 3))}" density="300"/>'
            f'<site name="s{b}" pos="{numbers(rng.normal(size=3))}" quat="{numbers(rng.normal(size=4))}"/>{below}</body>'
        )

    return (
        f'<mujoco model="tree"><compiler angle="radian"/><option gravity="{numbers(rng.normal(size=3) * 5)}"/>'
        f"<worldbody>{body(0)}</worldbody></mujoco>"
    )


def to_ulna(m: Any, qpos: Floats) -> Floats:
    """MuJoCo's positions with quaternions as xyzw."""
    q = np.array(qpos)
    for j in range(m.njnt):
        free = m.jnt_type[j] == int(mj.mjtJoint.mjJNT_FREE)
        at = int(m.jnt_qposadr[j]) + (3 if free else 0)
        if free or m.jnt_type[j] == int(mj.mjtJoint.mjJNT_BALL):
            q[at : at + 4] = np.roll(q[at : at + 4], -1)
    return q


def random_position(m: Any, rng: np.random.Generator) -> Floats:
    qpos = np.array(m.qpos0)
    mj.mj_integratePos(m, qpos, rng.normal(size=m.nv), 1.0)
    return qpos


@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_a_random_tree_moves_as_in_mujoco(seed: int, floating: bool) -> None:
    rng = np.random.default_rng(seed)
    text = tree(rng, int(rng.integers(2, 8)), floating)
    m = mj.MjModel.from_xml_string(text)
    d, robot = mj.MjData(m), ulna.load(text)
    assert (robot.nq, robot.nv) == (m.nq, m.nv)
    assert robot.joint_names == tuple(m.joint(j).name or "b0_free" for j in range(m.njnt))
    for _ in range(3):
        d.qpos, d.qvel = random_position(m, rng), 0.0
        mj.mj_forward(m, d)
        q = to_ulna(m, d.qpos)
        for b in range(m.nbody - 1):
            T = robot.fk(q, f"b{b}")
            np.testing.assert_allclose(T[:3, 3], d.body(f"b{b}").xpos, atol=1e-12)
            np.testing.assert_allclose(T[:3, :3], d.body(f"b{b}").xmat.reshape(3, 3), atol=1e-12)
            np.testing.assert_allclose(robot.fk(q, f"s{b}")[:3, 3], d.site(f"s{b}").xpos, atol=1e-12)
        # v of a free joint: MuJoCo's linear part is in the world, ours in the body.
        turn = np.eye(m.nv)
        if floating:
            turn[:3, :3] = d.body("b0").xmat.reshape(3, 3).T
        M = np.zeros((m.nv, m.nv))
        mj.mj_fullM(m, d, M)
        np.testing.assert_allclose(
            turn.T @ robot.mass_matrix(q) @ turn, M, atol=1e-9 * np.abs(M).max(initial=1.0)
        )
        np.testing.assert_allclose(
            turn.T @ robot.gravity_forces(q),
            d.qfrc_bias,
            atol=1e-9 * (1.0 + np.abs(d.qfrc_bias).max(initial=0.0)),
        )
        if not floating:
            d.qvel = rng.normal(size=m.nv)
            mj.mj_forward(m, d)
            bias = robot.bias_forces(q, d.qvel)
            np.testing.assert_allclose(
                bias, d.qfrc_bias, atol=1e-9 * (1.0 + np.abs(d.qfrc_bias).max(initial=0.0))
            )


@pytest.mark.parametrize(
    "seeds",
    [range(5), *(pytest.param(range(k, k + 30), marks=pytest.mark.slow) for k in range(5, 185, 30))],
    ids=str,
)
def test_random_documents_of_all_that_is_honoured(seeds: range) -> None:
    """Poses, mass matrix, gravity, bias, damping, friction, limits, efforts, couplings, contacts and shapes."""
    for seed in seeds:
        text = RandomMjcf(seed).text
        said = "".join(loaded(text)[1])
        assert not said or "<geom contype conaffinity>" in said or "<joint armature>" in said, (seed, said)
        found = set(differences(text))
        if "<geom contype conaffinity>" in said:
            found.discard("contacts")  # links are checked with all of their shapes
        if "<joint armature>" in said:
            found.discard("bias")
        assert not found, (seed, found)
