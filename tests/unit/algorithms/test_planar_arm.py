"""Kinematics of robots simple enough to work out by hand, in numbers and in symbols."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna import algorithms as alg
from ulna.model import Composite, FreeFlyer, Model, ModelBuilder, Prismatic, Revolute, Spherical
from ulna.spatial import SE3, Motion

A, B = 0.7, 0.4  # lengths of the arm's links [m]


@pytest.fixture(scope="module")
def arm() -> Model:
    """Two links in the plane z = 0, as in every textbook."""
    builder = ModelBuilder("arm")
    for name in ("base", "upper", "lower"):
        builder.add_link(name)
    builder.add_joint("shoulder", Revolute((0, 0, 1)), "base", "upper")
    builder.add_joint("elbow", Revolute((0, 0, 1)), "upper", "lower", SE3.trans(A, 0.0, 0.0))
    builder.add_frame("hand", "lower", SE3.trans(B, 0.0, 0.0))
    return builder.set_tool("hand").build()


Q = np.array([0.3, 0.8])
S1, C1, S12, C12 = np.sin(0.3), np.cos(0.3), np.sin(1.1), np.cos(1.1)


@pytest.mark.parametrize("q", [np.zeros(0), np.zeros((5, 0))])
def test_what_has_no_joints_cannot_move(q: np.ndarray) -> None:
    robot = ulna.Robot(ModelBuilder("rock").add_link("base").build())
    still = np.zeros(q.shape[:-1])
    for measure in ("yoshikawa", "inverse_condition", "minimum_singular_value", "asada"):
        np.testing.assert_array_equal(robot.manipulability(q, measure), still, strict=True)
    np.testing.assert_array_equal(robot.derivatives.manipulability(q), q, strict=True)


def test_pose_of_the_planar_arm(arm: Model) -> None:
    T = alg.frame_pose(arm, Q, arm.frame("hand"))
    np.testing.assert_allclose(T.translation, [A * C1 + B * C12, A * S1 + B * S12, 0.0], atol=1e-15)
    np.testing.assert_allclose(T.rotation, [[C12, -S12, 0], [S12, C12, 0], [0, 0, 1]], atol=1e-15)


def test_jacobians_of_the_planar_arm(arm: Model) -> None:
    hand = arm.frame("hand")
    x, y = A * C1 + B * C12, A * S1 + B * S12
    aligned = np.array([[-y, -B * S12], [x, B * C12], [0, 0], [0, 0], [0, 0], [1, 1]])
    np.testing.assert_allclose(alg.frame_jacobian(arm, Q, hand), aligned, atol=1e-15)
    # the body's point that passes the world's origin: at rest for joint 1, circling the elbow for joint 2
    world = np.array([[0, A * S1], [0, -A * C1], [0, 0], [0, 0], [0, 0], [1, 1]])
    np.testing.assert_allclose(alg.frame_jacobian(arm, Q, hand, "world"), world, atol=1e-15)
    s2, c2 = np.sin(0.8), np.cos(0.8)
    local = np.array([[A * s2, 0], [A * c2 + B, B], [0, 0], [0, 0], [0, 0], [1, 1]])
    np.testing.assert_allclose(alg.frame_jacobian(arm, Q, hand, "local"), local, atol=1e-15)


def test_manipulability_of_the_planar_arm(arm: Model) -> None:
    """Siciliano, example 3.7: a b |sin q2|, independent of q1."""
    mask = (True, True, False, False, False, False)
    m = alg.manipulability(arm, Q, arm.frame("hand"), axes=mask)
    assert abs(m - A * B * np.sin(0.8)) < 1e-15
    gradient = alg.manipulability_gradient(arm, Q, arm.frame("hand"), mask)
    np.testing.assert_allclose(gradient, [0.0, A * B * np.cos(0.8)], atol=1e-15)
    straight = np.array([0.3, 0.0])
    assert alg.manipulability(arm, straight, arm.frame("hand"), axes=mask) < 1e-16
    assert alg.manipulability(arm, Q, arm.frame("hand")) == 0.0  # six directions, two joints


def test_centripetal_acceleration(arm: Model) -> None:
    """The stretched arm turns at 2 rad/s: its hand accelerates inward at r w^2, but not spatially."""
    q, v, hand = np.zeros(2), np.array([2.0, 0.0]), arm.frame("hand")
    classical = alg.frame_acceleration(arm, q, v, None, hand, classical=True)
    np.testing.assert_allclose(classical.vector(), [-(A + B) * 4.0, 0, 0, 0, 0, 0], atol=1e-15)
    for reference in ("world", "local", "local_world_aligned"):
        assert alg.frame_acceleration(arm, q, v, None, hand, reference).is_close(Motion.zero(), 1e-15)


def test_symbols_give_the_formulas(arm: Model) -> None:
    sympy = pytest.importorskip("sympy")
    cos, sin = sympy.cos, sympy.sin
    q1, q2, v1, v2 = sympy.symbols("q1 q2 v1 v2", real=True)
    q, v = np.array([q1, q2], dtype=object), np.array([v1, v2], dtype=object)
    hand = arm.frame("hand")
    a, b = sympy.Float(A), sympy.Float(B)
    x, y = a * cos(q1) + b * cos(q1 + q2), a * sin(q1) + b * sin(q1 + q2)

    def vanishes(expression: object) -> bool:
        numeric = sympy.lambdify((q1, q2, v1, v2), expression)
        return all(abs(numeric(*z)) < 1e-14 for z in np.random.default_rng(0).uniform(-3, 3, (5, 4)))

    T = alg.frame_pose(arm, q, hand).matrix()
    assert vanishes(T[0, 3] - x)
    assert vanishes(T[1, 3] - y)
    J = alg.frame_jacobian(arm, q, hand)
    H = alg.frame_hessian(arm, q, hand)
    dJ = alg.frame_jacobian_dot(arm, q, v, hand)
    V = alg.frame_velocity(arm, q, v, hand).vector()
    for i, coordinate in enumerate((x, y)):
        assert vanishes(V[i] - coordinate.diff(q1) * v1 - coordinate.diff(q2) * v2)
        for j, qj in enumerate((q1, q2)):
            assert vanishes(J[i, j] - coordinate.diff(qj))
            assert vanishes(dJ[i, j] - coordinate.diff(qj, q1) * v1 - coordinate.diff(qj, q2) * v2)
            for k, qk in enumerate((q1, q2)):
                assert vanishes(H[k, i, j] - coordinate.diff(qj, qk))
    mask = (True, True, False, False, False, False)
    m = alg.manipulability(arm, q, hand, axes=mask)
    assert vanishes(m - sympy.Abs(a * b * sin(q2)))
    next_q = alg.integrate(arm, q, v)
    assert vanishes(next_q[0] - q1 - v1)


def test_mimic_joints_add_to_their_source() -> None:
    """A gripper: the second finger follows the first with twice its stroke, from an offset."""
    builder = ModelBuilder("gripper")
    for name in ("palm", "left", "right"):
        builder.add_link(name)
    builder.add_joint("left", Prismatic((0, 1, 0)), "palm", "left")
    builder.add_joint("right", Prismatic((0, -1, 0)), "left", "right", mimic=("left", 2.0, 0.1))
    builder.add_frame("tip", "right")
    model = builder.build()
    assert (model.nq, model.nv) == (1, 1)
    q, v, tip = np.array([0.3]), np.array([5.0]), model.frame("tip")
    assert abs(alg.frame_pose(model, q, tip).translation[1] - (0.3 - (2.0 * 0.3 + 0.1))) < 1e-15
    np.testing.assert_allclose(alg.frame_jacobian(model, q, tip)[:, 0], [0, 1 - 2, 0, 0, 0, 0])
    assert alg.frame_velocity(model, q, v, tip).linear[1] == -5.0
    assert len(alg.joint_poses(model, q)) == 2


def test_a_composite_is_its_parts() -> None:
    parts = (Spherical(), Prismatic((0, 0, 1)), Revolute((1, 0, 0)))
    places = (SE3.rx(0.3), SE3.trans(0.1, 0.2, 0.3), SE3.ry(0.2))
    whole = ModelBuilder("whole").add_link("a").add_link("b")
    whole.add_joint("joint", Composite(parts, places), "a", "b", SE3.rz(0.5)).add_frame(
        "tip", "b", SE3.trans(0, 0, 1)
    )
    row = ModelBuilder("row").add_link("a").add_link("x").add_link("y").add_link("b")
    row.add_joint("1", parts[0], "a", "x", SE3.rz(0.5) @ places[0]).add_joint(
        "2", parts[1], "x", "y", places[1]
    )
    row.add_joint("3", parts[2], "y", "b", places[2]).add_frame("tip", "b", SE3.trans(0, 0, 1))
    one, other = whole.build(), row.build()
    rng = np.random.default_rng(0)
    q, v, a = alg.random(one, rng), *rng.standard_normal((2, one.nv))
    f, g = one.frame("tip"), other.frame("tip")
    assert alg.frame_pose(one, q, f).is_close(alg.frame_pose(other, q, g), 1e-14)
    np.testing.assert_allclose(alg.frame_hessian(one, q, f), alg.frame_hessian(other, q, g), atol=1e-14)
    A = alg.frame_acceleration(one, q, v, a, f)
    assert A.is_close(alg.frame_acceleration(other, q, v, a, g), 1e-14)
    assert len(alg.joint_poses(one, q)) == 1


def test_a_free_flyer_moves_in_its_own_axes() -> None:
    builder = ModelBuilder("drone").add_link("body")
    model = builder.root_joint(FreeFlyer()).build()
    quarter = np.array([0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)])
    q = np.array([1.0, 2.0, 3.0, *quarter])
    v = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    body = model.frame("body")
    np.testing.assert_allclose(alg.frame_velocity(model, q, v, body).linear, [0.0, 1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(alg.integrate(model, q, v)[:3], [1.0, 3.0, 3.0], atol=1e-15)
    turn = np.array([1.0, 0.0, 0.0, 0.0, 0.0, np.pi / 2])
    start = alg.neutral(model)
    np.testing.assert_array_equal(start, [0, 0, 0, 0, 0, 0, 1])
    np.testing.assert_allclose(alg.integrate(model, start, turn)[:2], [2 / np.pi, 2 / np.pi], atol=1e-15)
    np.testing.assert_allclose(
        alg.difference(model, start, alg.integrate(model, start, turn)), turn, atol=1e-14
    )
    assert abs(alg.distance(model, start, q) ** 2 - alg.squared_distance(model, start, q)) < 1e-12
    flipped = q * np.array([1, 1, 1, -1, -1, -1, -1])
    assert alg.is_same(model, q, flipped)
    assert not alg.is_same(model, q, start)


def test_random_configurations_keep_the_limits(arm: Model) -> None:
    rng = np.random.default_rng(0)
    q = alg.random(arm, rng, (100,), lower=np.array([-0.1, 1.0]), upper=np.array([0.1, 1.5]))
    assert q.shape == (100, 2)
    assert (q >= [-0.1, 1.0]).all()
    assert (q <= [0.1, 1.5]).all()
    assert alg.random(arm, rng).shape == (2,)
