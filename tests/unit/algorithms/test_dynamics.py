"""Dynamics where the answer is known by hand, and what is said when there is none."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import random_model
from ulna import algorithms as alg
from ulna.algorithms.dynamics.forward_dynamics import prefers_mass_matrix
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.errors import InputError, UnknownName
from ulna.model import FreeFlyer, Model, ModelBuilder, Prismatic, Revolute
from ulna.robots.panda import panda
from ulna.spatial import SE3, Inertia
from ulna.typing import Floats

MASS, REACH, TURN = 2.0, 0.7, 0.05


def pendulum(armature: float = 0.0, mimic: bool = False) -> Model:
    """A rod that turns about y and hangs down at zero; `mimic` hangs a second one beside it that turns twice as far."""
    b = ModelBuilder("pendulum")
    b.add_link("base")
    rod = Inertia.from_com(MASS, (0.0, 0.0, -REACH), (TURN, 0, 0, TURN, 0, TURN))
    b.add_link("rod", rod)
    b.add_joint("hinge", Revolute((0, 1, 0)), "base", "rod", armature=armature)
    if mimic:
        b.add_link("other", rod)
        b.add_joint("follower", Revolute((0, 1, 0)), "base", "other", mimic=("hinge", 2.0, 0.1))
    return b.build()


def test_pendulum() -> None:
    m, g = pendulum(armature=0.3), 9.81
    q, v, a = np.array([0.4]), np.array([1.5]), np.array([-0.7])
    J = MASS * REACH**2 + TURN + 0.3
    torque = J * a + MASS * g * REACH * np.sin(q)
    np.testing.assert_allclose(alg.inverse_dynamics(m, q, v, a), torque, rtol=1e-14)
    np.testing.assert_allclose(alg.forward_dynamics(m, q, v, torque), a, rtol=1e-14)
    np.testing.assert_allclose(alg.aba(m, q, v, torque), a, rtol=1e-14)
    np.testing.assert_allclose(alg.mass_matrix(m, q), [[J]], rtol=1e-14)
    np.testing.assert_allclose(alg.inverse_mass_matrix(m, q), [[1 / J]], rtol=1e-14)
    np.testing.assert_allclose(alg.kinetic_energy(m, q, v), 0.5 * J * 1.5**2, rtol=1e-14)
    np.testing.assert_allclose(alg.potential_energy(m, q), -MASS * g * REACH * np.cos(0.4), rtol=1e-14)
    np.testing.assert_allclose(
        alg.center_of_mass(m, q), [-REACH * np.sin(0.4), 0.0, -REACH * np.cos(0.4)], atol=1e-15
    )
    np.testing.assert_array_equal(alg.coriolis_matrix(m, q, v), [[0.0]])


def test_pendulum_with_a_mimic_one() -> None:
    m, J = pendulum(mimic=True), MASS * REACH**2 + TURN
    q, v = np.array([0.4]), np.array([1.5])
    np.testing.assert_allclose(alg.mass_matrix(m, q), [[J * (1 + 2.0**2)]], rtol=1e-14)
    weight = MASS * 9.81 * REACH * (np.sin(0.4) + 2.0 * np.sin(2.0 * 0.4 + 0.1))
    np.testing.assert_allclose(alg.gravity_forces(m, q), [weight], rtol=1e-14)
    np.testing.assert_allclose(alg.forward_dynamics(m, q, v, np.zeros(1)), [-weight / (5 * J)], rtol=1e-14)
    with pytest.raises(InputError, match=r"takes no mimic joints and no ellipsoids; use forward_dynamics"):
        alg.aba(m, q, v, np.zeros(1))


def test_a_thrown_body_falls_freely() -> None:
    b = ModelBuilder("stone")
    b.add_link("stone", Inertia.from_com(3.0, (0.1, 0.2, -0.3), (0.2, 0.01, 0.0, 0.3, 0.02, 0.4)))
    b.root_joint(FreeFlyer())
    m = b.build()
    rng = np.random.default_rng(0)
    q, v = alg.random(m, rng), rng.standard_normal(6)
    a = alg.forward_dynamics(m, q, v, np.zeros(6))
    np.testing.assert_allclose(alg.center_of_mass_acceleration(m, q, v, a), [0.0, 0.0, -9.81], atol=1e-13)
    rate = alg.centroidal_momentum_rate(m, q, v, a)
    np.testing.assert_allclose(rate, [0.0, 0.0, -3.0 * 9.81, 0.0, 0.0, 0.0], atol=1e-13)


def wrenches_in(m: Model, q: Floats, frame, local: Floats) -> dict[str, Floats]:
    """A wrench on a frame, written in each reference."""
    T = alg.frame_pose(m, q, frame)
    aligned = np.concatenate([T.rotation @ local[:3], T.rotation @ local[3:]])
    world = np.concatenate([aligned[:3], aligned[3:] + np.cross(T.translation, aligned[:3])])
    return {"local": local, "local_world_aligned": aligned, "world": world}


@pytest.mark.parametrize("reference", ["local", "local_world_aligned", "world"])
def test_forces_at_frames_cost_their_jacobians(reference: str) -> None:
    rng = np.random.default_rng(3)
    m = random_model(rng, root="planar", mimics=1)
    frames = [m.frame("tip"), m.frame("side"), m.frame("tip"), m.frame("link0")]
    q = alg.random(m, rng)
    given = [wrenches_in(m, q, f, rng.standard_normal(6))[reference] for f in frames]
    external = alg.at_joints(m, q, np.stack(given), frames, reference)
    v, a = rng.standard_normal((2, m.nv))
    expected = alg.inverse_dynamics(m, q, v, a) - sum(
        alg.frame_jacobian(m, q, f, reference).T @ w for f, w in zip(frames, given, strict=True)
    )
    np.testing.assert_allclose(alg.inverse_dynamics(m, q, v, a, external), expected, atol=1e-11)
    np.testing.assert_allclose(alg.forward_dynamics(m, q, v, expected, external), a, atol=1e-9)


def test_forces_on_the_world_move_nothing() -> None:
    m = panda()
    base = m.frame("panda_link0")
    external = alg.at_joints(m, np.zeros(7), np.ones((1, 6)), [base])
    assert external == [None] * 7
    with pytest.raises(UnknownName, match="No reference named 'word'"):
        alg.at_joints(m, np.zeros(7), np.ones((1, 6)), [base], "word")  # type: ignore[arg-type]


def test_batches_broadcast() -> None:
    m = panda()
    rng = np.random.default_rng(4)
    q, v, a = rng.standard_normal((3, 1, 7)), rng.standard_normal((4, 7)), rng.standard_normal(7)
    frame = m.frame("panda_hand")
    external = alg.at_joints(m, q, rng.standard_normal((2, 1, 1, 1, 6)), [frame])
    assert alg.inverse_dynamics(m, q, v, a, external).shape == (2, 3, 4, 7)
    assert alg.forward_dynamics(m, q, v, a, external).shape == (2, 3, 4, 7)
    assert alg.aba(m, q, v, a, external).shape == (2, 3, 4, 7)
    assert alg.static_torque(m, q, external).shape == (2, 3, 1, 7)
    assert alg.coriolis_matrix(m, q, v).shape == (3, 4, 7, 7)
    assert alg.mechanical_energy(m, q, v).shape == (3, 4)
    assert alg.potential_energy(m, q).shape == (3, 1)
    assert alg.center_of_mass_acceleration(m, q, v, a).shape == (3, 4, 3)
    assert alg.centroidal_momentum_rate(m, q, v, a).shape == (3, 4, 6)


def test_a_robot_that_cannot_move() -> None:
    b = ModelBuilder("stone")
    b.add_link("stone", Inertia.from_sphere(1.0, 0.1))
    m, none = b.build(), np.zeros((2, 0))
    assert alg.inverse_dynamics(m, none, none, none).shape == (2, 0)
    assert alg.forward_dynamics(m, none, none, none).shape == (2, 0)
    assert alg.mass_matrix(m, none).shape == alg.inverse_mass_matrix(m, none).shape == (2, 0, 0)
    np.testing.assert_array_equal(alg.mechanical_energy(m, none, none), [0.0, 0.0])
    assert m.mass == 1.0
    assert alg.total_mass(m) == 0.0
    with pytest.raises(InputError, match="What moves of 'stone' has no mass"):
        alg.center_of_mass(m, none)


def test_massless_ends_have_no_centre() -> None:
    b = ModelBuilder("rail")
    b.add_link("base")
    b.add_link("cart", Inertia.from_sphere(1.0, 0.1))
    b.add_link("mark")
    b.add_joint("slide", Prismatic((1, 0, 0)), "base", "cart")
    b.add_joint("hinge", Revolute((0, 0, 1)), "cart", "mark", SE3.trans(0.0, 0.0, 0.2))
    m = b.build()
    with pytest.raises(InputError, match="What joint 'hinge' moves has no mass"):
        alg.center_of_mass(m, np.zeros(2), "hinge")
    with pytest.raises(UnknownName, match="slide"):
        alg.center_of_mass(m, np.zeros(2), "slid")
    np.testing.assert_allclose(alg.center_of_mass(m, np.array([0.3, 1.0])), [0.3, 0.0, 0.0])


def test_which_algorithm_forward_dynamics_uses() -> None:
    assert prefers_mass_matrix(panda())
    assert prefers_mass_matrix(random_model(np.random.default_rng(0), mimics=1))
    legs = random_model(np.random.default_rng(0), ["revolute"] * 12, root="free_flyer", mimics=0)
    assert not prefers_mass_matrix(legs)


def test_factors_keep_zeros_and_take_batches() -> None:
    M = np.array([[4.0, 1.0, 2.0], [1.0, 3.0, 0.0], [2.0, 0.0, 5.0]])
    factors = Factors(M)
    assert 1 not in factors.lower[2]
    np.testing.assert_allclose(factors.inverse() @ M, np.eye(3), atol=1e-15)
    b = np.array([1.0, -2.0, 3.0])
    np.testing.assert_allclose(M @ np.stack(factors.solve(list(b))), b)
    many = np.stack([M, 2.0 * M])
    np.testing.assert_allclose(Factors(many).inverse() @ many, np.stack([np.eye(3)] * 2), atol=1e-15)


def test_symbols() -> None:
    sympy = pytest.importorskip("sympy")
    m = pendulum()
    q, v, a = (np.array([sympy.Symbol(n)]) for n in "qva")
    tau = alg.inverse_dynamics(m, q, v, a)[0]
    expected = (MASS * REACH**2 + TURN) * a[0] + MASS * 9.81 * REACH * sympy.sin(q[0])
    assert abs(float((tau - expected).subs({"q": 0.3, "v": 1.1, "a": -0.2}))) < 1e-13
