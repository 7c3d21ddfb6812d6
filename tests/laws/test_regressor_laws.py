"""Laws of the regressors: derivatives of energies, batches, symbols, mimic joints, payloads."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import KINDS, random_model
from ulna import algorithms as alg
from ulna import kernels
from ulna.algorithms.dynamics.rnea_point_accelerations import inverse_dynamics
from ulna.model import dynamic_parameters, perturbed, with_dynamic_parameters, with_payload
from ulna.spatial import Inertia, Motion
from ulna.typing import Floats


def state(model, seed: int, size: tuple[int, ...] = ()) -> tuple[Floats, Floats, Floats]:
    rng = np.random.default_rng(seed)
    v, a = rng.standard_normal((2, *size, model.nv))
    return alg.random(model, rng, size), v, a


MODELS = [
    random_model(np.random.default_rng(k), list(KINDS), root=root, mimics=2)
    for k, root in enumerate((None, "free_flyer", "planar"))
]


@pytest.mark.parametrize("model", MODELS)
def test_power_of_the_torques_is_the_rate_of_energy(model) -> None:
    q, v, a = state(model, 1)
    p = dynamic_parameters(model)
    h = 1e-5

    def energy(t: float) -> float:
        there = alg.integrate(model, q, t * v + 0.5 * t * t * a)
        # the velocity along this curve, right to first order in t
        return (
            alg.kinetic_energy_regressor(model, there, v + t * a) @ p
            + alg.potential_energy_regressor(model, there) @ p
        )

    rate = (energy(h) - energy(-h)) / (2 * h)
    power = v @ (alg.joint_torque_regressor(model, q, v, a) @ p)
    assert power == pytest.approx(rate, rel=1e-5, abs=1e-5)


@pytest.mark.parametrize("model", MODELS)
def test_gravity_is_the_gradient_of_potential_energy(model) -> None:
    q, _, _ = state(model, 2)
    h = 1e-6
    for k in range(model.nv):
        step = h * np.eye(model.nv)[k]
        ahead, behind = alg.integrate(model, q, step), alg.integrate(model, q, -step)
        slope = (
            alg.potential_energy_regressor(model, ahead) - alg.potential_energy_regressor(model, behind)
        ) / (2 * h)
        np.testing.assert_allclose(alg.gravity_regressor(model, q)[k], slope, atol=1e-7)


@pytest.mark.parametrize("model", MODELS)
def test_batches_are_stacks_and_kernels_agree(model) -> None:
    q, v, a = state(model, 3, (3,))
    whole = alg.joint_torque_regressor(model, q, v, a)
    stacked = [alg.joint_torque_regressor(model, *x) for x in zip(q, v, a, strict=True)]
    np.testing.assert_allclose(whole, np.stack(stacked), atol=1e-12)
    f = kernels.function(model, "joint_torque_regressor")
    np.testing.assert_allclose(f(q[0], v[0], a[0]), whole[0], atol=1e-11)
    kinetic = kernels.function(model, "kinetic_energy_regressor")(q[0], v[0])
    np.testing.assert_allclose(kinetic, alg.kinetic_energy_regressor(model, q, v)[0], atol=1e-11)
    assert alg.potential_energy_regressor(model, q).shape == (3, 10 * len(model.joints))
    assert alg.static_regressor(model, q).shape == (3, 3, 4 * len(model.joints))
    assert alg.frame_regressor(model, q, v, a, model.frame("tip")).shape == (3, 6, 10)


def test_a_body_regressor_gives_the_wrench() -> None:
    rng = np.random.default_rng(5)
    V, A = (Motion(*rng.standard_normal((2, 4, 3))) for _ in range(2))
    body = Inertia.from_com(2.0, (0.1, -0.2, 0.3), (0.4, 0.01, 0.02, 0.5, 0.03, 0.6))
    wrench = body.apply(A) + V.cross(body.apply(V))
    np.testing.assert_allclose(alg.body_regressor(V, A) @ body.parameters(), wrench.vector(), atol=1e-12)


@pytest.mark.parametrize("model", MODELS)
def test_a_payload_adds_the_frame_regressor(model) -> None:
    q, v, a = state(model, 6)
    frame = model.frame("tip")
    loaded = with_payload(model, "tip", 1.5, (0.1, 0.0, 0.2), (0.01, 0, 0, 0.02, 0, 0.03))
    body = Inertia.from_com(1.5, (0.1, 0.0, 0.2), (0.01, 0, 0, 0.02, 0, 0.03))
    wrench = alg.frame_regressor(model, q, v, a, frame) @ body.parameters()
    more = alg.frame_jacobian(model, q, frame, "local").T @ wrench
    tau = [alg.joint_torque_regressor(m, q, v, a) @ dynamic_parameters(m) for m in (model, loaded)]
    np.testing.assert_allclose(tau[1] - tau[0], more, atol=1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_regressor_times_parameters_is_inverse_dynamics(model) -> None:
    q, v, a = state(model, 10, (3,))
    tau = alg.joint_torque_regressor(model, q, v, a) @ dynamic_parameters(model) + model.armature * a
    np.testing.assert_allclose(tau, inverse_dynamics(model, q, v, a), rtol=1e-10, atol=1e-10)
    other = perturbed(model, 0.5, seed=11)
    changed = with_dynamic_parameters(model, dynamic_parameters(other))
    np.testing.assert_allclose(
        inverse_dynamics(changed, q, v, a), inverse_dynamics(other, q, v, a), atol=1e-9
    )


def test_torques_are_those_of_another_model_with_its_parameters() -> None:
    model = MODELS[1]
    q, v, a = state(model, 7)
    other = perturbed(model, 0.5, seed=8)
    np.testing.assert_allclose(
        alg.joint_torque_regressor(model, q, v, a), alg.joint_torque_regressor(other, q, v, a), atol=0
    )


def test_symbols() -> None:
    sympy = pytest.importorskip("sympy")
    model = random_model(np.random.default_rng(9), ["revolute", "prismatic"], mimics=0)
    q, v, a = (np.array(sympy.symbols(f"{n}0:2"), dtype=object) for n in "qva")
    Y = alg.joint_torque_regressor(model, q, v, a)
    rng = np.random.default_rng(1)
    numbers = rng.standard_normal((3, 2))
    chosen = dict(zip([*q, *v, *a], numbers.ravel(), strict=True))
    values = [[float(sympy.sympify(y).subs(chosen)) for y in row] for row in Y]
    np.testing.assert_allclose(values, alg.joint_torque_regressor(model, *numbers), atol=1e-9)
