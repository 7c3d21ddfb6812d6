"""A robot answers for its dynamics by name: batches, forces at frames, friction, refusals."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from support.random_models import random_model
from ulna import algorithms as alg
from ulna.errors import ModelError, NonFiniteError, ShapeError, UnknownName
from ulna.model import ModelBuilder, Revolute
from ulna.robots.panda import panda
from ulna.spatial import Inertia

METHODS = {
    "inverse_dynamics": 3,
    "forward_dynamics": 3,
    "bias_forces": 2,
    "gravity_forces": 1,
    "static_torque": 1,
    "mass_matrix": 1,
    "inverse_mass_matrix": 1,
    "coriolis_matrix": 2,
    "kinetic_energy": 2,
    "potential_energy": 1,
    "mechanical_energy": 2,
    "center_of_mass": 1,
    "center_of_mass_velocity": 2,
    "center_of_mass_acceleration": 3,
    "center_of_mass_jacobian": 1,
    "centroidal_momentum": 2,
    "centroidal_momentum_rate": 3,
    "centroidal_inertia": 1,
    "centroidal_matrix": 1,
    "centroidal_matrix_dot": 2,
}


@pytest.fixture(scope="module")
def robot() -> ulna.Robot:
    return ulna.Robot(panda())


@pytest.fixture(scope="module")
def state() -> tuple[np.ndarray, ...]:
    return tuple(np.random.default_rng(4).uniform(0.1, 1.0, (3, 2, 3, 7)))


@pytest.mark.parametrize("method", METHODS)
def test_every_method_takes_batches_and_refuses_nan(robot: ulna.Robot, state, method: str) -> None:
    arrays = [np.array(x) for x in state[: METHODS[method]]]
    f = getattr(robot, method)
    whole = f(*arrays)
    np.testing.assert_allclose(whole[1, 2], f(*(a[1, 2] for a in arrays)), rtol=1e-10, atol=1e-11)
    arrays[-1][0, 1, 2] = np.nan
    with pytest.raises(NonFiniteError, match=r"\[0, 1, 2\]` is nan"):
        f(*arrays)
    with pytest.raises(ShapeError, match="expected"):
        f(*(a[..., :6] for a in arrays))


def test_forces_at_named_frames(robot: ulna.Robot, state) -> None:
    q, v, a = state
    weight = np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0])
    push = np.random.default_rng(1).standard_normal((3, 6))
    forces = {"panda_hand": weight, "panda_link4": push}
    tau = robot.inverse_dynamics(q, v, a, forces)
    less = sum(
        np.einsum("...ij,...i->...j", robot.jacobian(q, name), np.broadcast_to(w, (2, 3, 6)))
        for name, w in forces.items()
    )
    np.testing.assert_allclose(tau, robot.inverse_dynamics(q, v, a) - less, atol=1e-11)
    np.testing.assert_allclose(robot.forward_dynamics(q, v, tau, forces), a, atol=1e-9)
    np.testing.assert_allclose(robot.bias_forces(q, v, forces), robot.bias_forces(q, v) - less, atol=1e-11)
    np.testing.assert_allclose(robot.static_torque(q, forces), robot.gravity_forces(q) - less, atol=1e-11)
    np.testing.assert_allclose(robot.static_torque(q), robot.gravity_forces(q), atol=1e-12)
    local = robot.static_torque(q, {"panda_hand": weight}, "local")
    lever = np.einsum("...ij,i->...j", robot.jacobian(q, "panda_hand", "local"), weight)
    np.testing.assert_allclose(local, robot.gravity_forces(q) - lever, atol=1e-11)


def test_the_kernel_takes_the_wrenches_side_by_side(robot: ulna.Robot, state) -> None:
    q, v, a = (x[0, 0] for x in state)
    kernel = robot.kernel("inverse_dynamics", forces=["panda_hand", "panda_link4"], reference="local")
    w = np.random.default_rng(2).standard_normal((2, 6))
    forces = {"panda_hand": w[0], "panda_link4": w[1]}
    np.testing.assert_allclose(
        kernel(q, v, a, w), robot.inverse_dynamics(q, v, a, forces, "local"), atol=1e-12
    )


def test_invalid_forces_are_refused(robot: ulna.Robot, state) -> None:
    q = state[0][0, 0]
    with pytest.raises(UnknownName, match="Did you mean 'panda_hand'"):
        robot.static_torque(q, {"panda_hnd": np.zeros(6)})
    with pytest.raises(ShapeError, match=r"forces\['panda_hand'\]` has shape \(3,\); expected \(..., 6\)"):
        robot.static_torque(q, {"panda_hand": np.zeros(3)})
    with pytest.raises(UnknownName, match="local_world_aligned"):
        robot.static_torque(q, {"panda_hand": np.zeros(6)}, "local_world")  # type: ignore[arg-type]
    with pytest.raises(UnknownName, match="forces"):
        robot.kernel("inverse_dynamics", force=("panda_hand",))


def test_friction_on_request() -> None:
    model = random_model(np.random.default_rng(5), ["revolute", "prismatic", "helical"], mimics=0)
    robot, rng = ulna.Robot(model), np.random.default_rng(6)
    q, v, a = rng.standard_normal((3, 3))
    law = alg.Friction.of(model)
    assert np.abs(law.torque(v)).min() > 0.0
    tau = robot.inverse_dynamics(q, v, a)
    with_friction = robot.inverse_dynamics(q, v, a, friction=True)
    np.testing.assert_allclose(with_friction, tau - law.torque(v), atol=1e-12)
    np.testing.assert_allclose(robot.forward_dynamics(q, v, with_friction, friction=True), a, atol=1e-9)
    other = alg.Friction(viscous=2.0)
    np.testing.assert_allclose(robot.inverse_dynamics(q, v, a, friction=other), tau + 2.0 * v, atol=1e-12)
    assert (
        robot.inverse_dynamics(q, 0.0 * v, a, friction=True) == robot.inverse_dynamics(q, 0.0 * v, a)
    ).all()


def test_mass_and_centre_of_parts(robot: ulna.Robot, state) -> None:
    q = state[0]
    assert robot.total_mass() == pytest.approx(sum(float(i.mass) for i in robot.model.inertias))
    assert robot.total_mass("panda_joint7") == pytest.approx(float(robot.model.inertias[6].mass))
    tip = robot.center_of_mass(q, "panda_joint7")
    T = robot.fk(q, "panda_joint7")
    com = robot.model.inertias[6].com
    np.testing.assert_allclose(tip, T[..., :3, :3] @ com + T[..., :3, 3], atol=1e-12)
    with pytest.raises(UnknownName, match="panda_joint7"):
        robot.center_of_mass(q, "panda_joint8")
    with pytest.raises(UnknownName, match="There are: 'panda_joint1'"):
        robot.total_mass("nothing")


def test_inside_a_function_of_the_user(robot: ulna.Robot, state) -> None:
    q, v, _ = (x[0, 0] for x in state)
    held = ulna.compile(
        lambda q, v, w: robot.static_torque(q, {"panda_hand": w}) - 3.0 * v, robot, w=(6,)
    )  # gravity compensation under a load, with damping
    w = np.array([0.0, 0.0, -5.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(held(q, v, w), robot.static_torque(q, {"panda_hand": w}) - 3.0 * v, atol=1e-12)


def test_joints_that_move_no_mass_are_named() -> None:
    b = (
        ModelBuilder("idle")
        .add_link("base")
        .add_link("a", Inertia.from_point(1.0, (0.1, 0, 0)))
        .add_link("b")
    )
    b.add_joint("turn", Revolute((0, 0, 1)), "base", "a").add_joint("spin", Revolute((1, 0, 0)), "a", "b")
    robot = ulna.Robot(b.build())
    z = np.zeros(2)
    for ask in (
        lambda: robot.forward_dynamics(z, z, z),
        lambda: robot.inverse_mass_matrix(z),
        lambda: robot.forward_dynamics_derivatives(z, z, z),
        lambda: robot.operational_inertia(z),
    ):
        with pytest.raises(ModelError, match=r"'spin' of 'idle'.*robot\.lock\(\['spin'\]\)"):
            ask()
    assert robot.inverse_dynamics(z, z, z).shape == (2,)
    assert np.isfinite(robot.lock(["spin"]).forward_dynamics([0.0], [0.0], [1.0])).all()
    driven = robot.with_parameters({"armature": [0.0, 0.1]})
    assert np.isfinite(driven.forward_dynamics(z, z, z)).all()
