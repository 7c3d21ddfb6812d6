"""Laws of the operational space: forces at a frame move it as its inertia says; energy; the Robotics Toolbox's formulas."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from support.derivatives import along
from support.random_models import random_model
from ulna import algorithms as alg
from ulna.algorithms import Task
from ulna.errors import InputError, UnknownName
from ulna.model import Model
from ulna.robots.panda import panda
from ulna.robots.ur5 import ur5
from ulna.spatial import Force
from ulna.typing import Floats

MODELS = {
    "panda": panda,
    "ur5": ur5,
    "floating": lambda: random_model(np.random.default_rng(0), ["revolute"] * 3, root="free_flyer", mimics=1),
}
TASKS = [
    ("local_world_aligned", None),
    ("local", None),
    ("world", None),
    ("local", "rpy/xyz"),
    ("local", "eul"),
]


def close(actual: Floats, expected: Floats, tolerance: float = 1e-9) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def times(matrix: Floats, v: Floats) -> Floats:
    return (matrix @ v[..., None])[..., 0]


@pytest.fixture(scope="module", params=MODELS)
def model(request: pytest.FixtureRequest) -> Model:
    return MODELS[request.param]()


def state(model: Model, seed: int) -> tuple[Floats, Floats, Floats]:
    rng = np.random.default_rng(seed)
    return alg.random(model, rng, (2,)), *rng.standard_normal((2, 2, model.nv))


@pytest.mark.parametrize(("reference", "representation"), TASKS)
def test_the_force_that_a_motion_takes(model: Model, reference, representation) -> None:
    """tau = J^T f for f = L x'' + C_x x' + g_x makes the frame accelerate by x'', while v is what x' asks for."""
    q, v, x = state(model, 1)
    task = Task(model.frame(model.tool), reference, representation)
    J = task.jacobian(model, q)
    M = alg.mass_matrix(model, q)
    L = alg.operational_inertia(model, q, task)
    consistent = np.linalg.inv(M) @ np.swapaxes(J, -1, -2) @ L
    close(J @ consistent, np.broadcast_to(np.eye(6), L.shape), 1e-6)
    v = times(consistent, times(J, v))  # without motion in the null space
    x = x[..., :6]
    f = times(L, x) + times(alg.operational_coriolis(model, q, v, task), times(J, v)) + alg.operational_gravity(model, q, task)  # fmt: skip
    tau = times(np.swapaxes(J, -1, -2), f)
    close(alg.operational_acceleration(model, q, v, tau, task), x, 1e-6)
    energy = 0.5 * np.einsum("ni,nij,nj->n", times(J, v), L, times(J, v))
    close(alg.kinetic_energy(model, q, v), energy, 1e-7)


def test_the_acceleration_is_the_rate_of_the_velocity(model: Model) -> None:
    q, v, tau = (x[0] for x in state(model, 2))
    task = Task(model.frame(model.tool))
    a = alg.forward_dynamics(model, q, v, tau)
    rate = along(model, q, v, lambda there: times(task.jacobian(model, there), v))
    close(alg.operational_acceleration(model, q, v, tau, task), rate + task.jacobian(model, q) @ a, 1e-7)


def test_a_force_at_the_frame_accelerates_it_by_its_mobility(model: Model) -> None:
    q, v, _ = (x[0] for x in state(model, 3))
    frame = model.frame(model.tool)
    task, f = Task(frame, "local"), np.arange(1.0, 7.0)
    external: list[Force | None] = [None] * len(model.joints)
    external[frame.joint] = frame.placement.act(Force(f[:3], f[3:]))
    rest = alg.forward_dynamics(model, q, v, 0.0 * v)
    gain = task.jacobian(model, q) @ (alg.forward_dynamics(model, q, v, 0.0 * v, external) - rest)
    close(alg.operational_inertia(model, q, task) @ gain, f, 1e-7)


def test_six_joints_have_the_formulas_of_the_toolbox() -> None:
    """inertia_x, coriolis_x, gravload_x with the inverse of a square Jacobian: Corke 2023, section 9.4."""
    model = ur5()
    q, v, _ = state(model, 4)
    task = Task(model.frame(model.tool), representation="rpy/xyz")
    J, dJ = task.jacobian(model, q), task.jacobian_dot(model, q, v)
    Ji = np.linalg.inv(J)
    Jt = np.swapaxes(Ji, -1, -2)
    M, C = alg.mass_matrix(model, q), alg.coriolis_matrix(model, q, v)
    close(alg.operational_inertia(model, q, task), Jt @ M @ Ji, 1e-8)
    close(alg.operational_coriolis(model, q, v, task), Jt @ (C - M @ Ji @ dJ) @ Ji, 1e-8)
    close(alg.operational_gravity(model, q, task), times(Jt, alg.gravity_forces(model, q)), 1e-8)


def test_methods_of_the_robot() -> None:
    robot = ulna.Robot(panda())
    q, v, tau = state(robot.model, 5)
    task = Task(robot.model.frame("panda_hand"), "local", damping=0.1)
    options = {"frame": "panda_hand", "reference": "local"}
    close(robot.operational_inertia(q, **options, damping=0.1), alg.operational_inertia(robot.model, q, task))
    close(robot.operational_coriolis(q, v, **options, damping=0.1), alg.operational_coriolis(robot.model, q, v, task))  # fmt: skip
    close(robot.operational_gravity(q, **options, damping=0.1), alg.operational_gravity(robot.model, q, task))
    close(robot.operational_acceleration(q, v, tau, **options), alg.operational_acceleration(robot.model, q, v, tau, task))  # fmt: skip
    stretched = robot.operational_inertia(np.zeros(7), damping=0.1)  # singular, and still finite
    assert np.isfinite(stretched).all()
    with pytest.raises(UnknownName, match="rpy/xyz"):
        robot.operational_inertia(q, representation="rpy/xzy")  # type: ignore[arg-type]


def test_too_few_joints_need_damping() -> None:
    arm = ulna.Robot(random_model(np.random.default_rng(1), ["revolute", "revolute"], mimics=0))
    q = np.array([0.3, -0.4])
    with pytest.raises(InputError, match="damping"):
        alg.operational_inertia(arm.model, np.zeros(2), Task(arm.model.frame("link0")))
    with pytest.raises(InputError, match="damping"):
        arm.operational_inertia(q, "link0")
    assert np.isfinite(arm.operational_inertia(q, damping=0.01)).all()
