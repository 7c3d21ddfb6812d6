"""Derivatives of dynamics as kernels and methods: by hand, and how they are called."""

from __future__ import annotations

import numpy as np
import pytest

from support.derivatives import by_configuration
from support.random_models import random_model
from ulna import algorithms as alg
from ulna.algorithms.derivatives.inverse_dynamics import inverse_dynamics_derivatives
from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.model import Model, ModelBuilder, Revolute
from ulna.robot import Robot
from ulna.spatial import SE3, Inertia

SHAPES = {
    "inverse_dynamics_derivatives": ((5, 5),) * 3,
    "forward_dynamics_derivatives": ((5, 5),) * 3,
    "centroidal_derivatives": ((6, 5),) * 4,
    "com_velocity_derivatives": ((3, 5),) * 2,
    "frame_velocity_derivatives": ((6, 5),) * 2,
    "frame_acceleration_derivatives": ((6, 5),) * 3,
}


def pendulum(mass: float = 2.0, length: float = 0.5, armature: float = 0.1) -> Model:
    """A point on a rod that turns about y; hanging at q = 0."""
    b = ModelBuilder("pendulum").add_link("base")
    b.add_link("bob", Inertia.from_point(mass, (0.0, 0.0, -length)))
    b.add_joint("j", Revolute((0.0, 1.0, 0.0)), "base", "bob", SE3.trans(0.0, 0.0, 1.0), armature=armature)
    return b.build()


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot(random_model(np.random.default_rng(0), ["revolute", "prismatic", "spherical"], mimics=1))


def test_pendulum_by_hand() -> None:
    model = pendulum()
    q, v, tau = np.array([0.3]), np.array([0.7]), np.array([1.1])
    m, l, g, inertia = 2.0, 0.5, 9.81, 2.0 * 0.25 + 0.1
    by_q, by_v, M = Robot(model).inverse_dynamics_derivatives(q, v, tau)
    np.testing.assert_allclose([by_q[0, 0], by_v[0, 0], M[0, 0]], [m * g * l * np.cos(0.3), 0.0, inertia])
    a_q, a_v, a_tau = Robot(model).forward_dynamics_derivatives(q, v, tau)
    expected = [-m * g * l * np.cos(0.3) / inertia, 0.0, 1.0 / inertia]
    np.testing.assert_allclose([a_q[0, 0], a_v[0, 0], a_tau[0, 0]], expected)


@pytest.mark.parametrize("name", SHAPES)
def test_kernels_of_states_and_batches(robot: Robot, name: str) -> None:
    rng = np.random.default_rng(1)
    q = robot.random_configuration((4,), seed=2)
    arguments = [q, *rng.standard_normal((2, 4, robot.nv))][: len(robot.function(name).inputs)]
    method = getattr(robot, name)
    whole, single = method(*arguments), method(*(x[3] for x in arguments))
    interpreted = robot.function(name)(*arguments)
    for one, many, judge, shape in zip(single, whole, interpreted, SHAPES[name], strict=True):
        assert one.shape == shape
        assert many.shape == (4, *shape)
        np.testing.assert_allclose(many[3], one, atol=1e-10)
        np.testing.assert_allclose(many, judge, atol=1e-9)


def test_forward_inverts_inverse(robot: Robot) -> None:
    rng = np.random.default_rng(3)
    q, (v, a) = robot.random_configuration(seed=4), rng.standard_normal((2, robot.nv))
    by_q, by_v, M = robot.inverse_dynamics_derivatives(q, v, a)
    a_q, a_v, inverse = robot.forward_dynamics_derivatives(q, v, alg.rnea(robot.model, q, v, a))
    np.testing.assert_allclose(M @ inverse, np.eye(robot.nv), atol=1e-9)
    np.testing.assert_allclose(M @ a_q, -by_q, atol=1e-9 * np.abs(by_q).max())
    np.testing.assert_allclose(M @ a_v, -by_v, atol=1e-9 * np.abs(by_v).max())


def test_forces_turn_with_their_frames(robot: Robot) -> None:
    rng = np.random.default_rng(5)
    q, (v, a) = robot.random_configuration(seed=6), rng.standard_normal((2, robot.nv))
    forces = {"tip": rng.standard_normal((2, 6)), "side": rng.standard_normal(6)}
    found = robot.inverse_dynamics_derivatives(q, v, a, forces, "local")[0]
    assert found.shape == (2, robot.nv, robot.nv)
    for k in range(2):
        given = {"tip": forces["tip"][k], "side": forces["side"]}
        expected = by_configuration(
            robot.model, q, lambda x, given=given: robot.inverse_dynamics(x, v, a, given, "local")
        )
        np.testing.assert_allclose(found[k], expected.T, atol=1e-8)
    tau = robot.inverse_dynamics(q, v, a, forces, "local")
    np.testing.assert_allclose(
        robot.forward_dynamics_derivatives(q, v, tau, forces, "local")[0],
        -robot.inverse_mass_matrix(q) @ found,
        atol=1e-8 * np.abs(found).max(),
    )
    with pytest.raises(UnknownName):
        robot.inverse_dynamics_derivatives(q, v, a, {"tpi": np.zeros(6)}, "local")
    with pytest.raises(InputError, match="expected 'local'"):
        robot.forward_dynamics_derivatives(q, v, tau, forces)


def test_refusals(robot: Robot) -> None:
    q, v = robot.neutral, np.zeros(robot.nv)
    with pytest.raises(ShapeError):
        robot.inverse_dynamics_derivatives(q, v[1:], v)
    with pytest.raises(NonFiniteError):
        robot.forward_dynamics_derivatives(q, v * np.nan, v)


def test_symbols_go_through() -> None:
    sympy = pytest.importorskip("sympy")
    q, v, a = (np.array([x]) for x in sympy.symbols("q v a"))
    by_q, by_v, M = inverse_dynamics_derivatives(pendulum(armature=0.0), q, v, a)
    assert sympy.simplify(by_q[0, 0] - 9.81 * sympy.cos(q[0])) == 0
    assert sympy.simplify(by_v[0, 0]) == 0
    assert float(M[0, 0]) == pytest.approx(0.5)


def test_derivatives_of_a_motion_are_in_the_reference_asked_for(robot: Robot) -> None:
    """By the rates they are the Jacobian in that reference, which by default has the axes of the world at the frame."""
    model, rng = robot.model, np.random.default_rng(8)
    frame = model.frames[-1]
    q, v, a = robot.random_configuration(seed=3), rng.normal(size=model.nv), rng.normal(size=model.nv)
    for reference in ("local", "world", "local_world_aligned"):
        found = alg.motion_derivatives(model, q, v, a, frame, reference)  # type: ignore[arg-type]
        J = alg.frame_jacobian(model, q, frame, reference)  # type: ignore[arg-type]
        np.testing.assert_allclose(found[1], J, atol=1e-12)
        np.testing.assert_allclose(found[4], J, atol=1e-12)
    for default, aligned in zip(alg.motion_derivatives(model, q, v, a, frame), found, strict=True):
        np.testing.assert_array_equal(default, aligned)
    with pytest.raises(UnknownName, match="reference"):
        alg.motion_derivatives(model, q, v, a, frame, "globe")  # type: ignore[arg-type]
