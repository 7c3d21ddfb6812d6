"""What is asked of all joints at once agrees with what is asked of one frame, and with the torques."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

from support.random_models import random_model
from ulna import algorithms
from ulna.model import Frame, Model
from ulna.spatial import SE3


def _case(seed: int) -> tuple[Model, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    return model, algorithms.random(model, rng), *rng.normal(size=(2, model.nv))


def _frame(joint: int) -> Frame:
    return Frame("", joint, SE3.identity(), "user", "", SE3.identity())


@pytest.mark.parametrize("seed", range(3))
def test_accelerations_of_joints_are_those_of_their_frames(seed: int) -> None:
    model, q, v, a = _case(seed)
    for i, found in enumerate(algorithms.joint_accelerations(model, q, v, a)):
        wanted = algorithms.frame_acceleration(model, q, v, a, _frame(i), "local")
        np.testing.assert_allclose(found.vector(), wanted.vector(), rtol=0, atol=1e-10)


@pytest.mark.parametrize("seed", range(3))
def test_jacobians_of_joints_change_as_their_differences_say(seed: int) -> None:
    model, q, v, _ = _case(seed)
    h = 1e-6
    ahead, behind = (
        algorithms.joint_jacobians(model, algorithms.integrate(model, q, s * h * v)) for s in (1, -1)
    )
    found = algorithms.joint_jacobians_dot(model, q, v)
    np.testing.assert_allclose(
        found, (ahead - behind) / (2 * h), rtol=0, atol=1e-6 * (1 + np.abs(found).max())
    )


@pytest.mark.parametrize("seed", range(3))
def test_torques_of_inverse_dynamics_are_those_of_the_joints(seed: int) -> None:
    model, q, v, a = _case(seed)
    tau = np.zeros(model.nv)
    for joint, force in zip(model.joints, algorithms.joint_wrenches(model, q, v, a), strict=True):
        ratio = 1.0 if joint.mimic is None else joint.mimic.multiplier
        for k, S in enumerate(joint.kind.motion_subspace(joint.q_of(q))):
            tau[joint.idx_v + k] += ratio * S.dot(force)
    wanted = algorithms.inverse_dynamics(model, q, v, a) - model.armature * a
    np.testing.assert_allclose(tau, wanted, rtol=0, atol=1e-9 * (1 + np.abs(wanted).max()))


@pytest.mark.parametrize("reference", ["local", "local_world_aligned"])
def test_points_change_as_their_differences_say(reference: Literal["local", "local_world_aligned"]) -> None:
    model, q, v, a = _case(1)
    frame = model.frame("tip")

    def moves(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        u = algorithms.frame_velocity(model, q, v, frame, reference).linear
        gain = algorithms.frame_acceleration(model, q, v, a, frame, reference, classical=True).linear
        return np.concatenate([u, gain])

    u_q, u_v, A_q, A_v, A_a = algorithms.point_derivatives(model, q, v, a, frame, reference)
    still = np.zeros((3, model.nv))
    h, eye = 1e-6, np.eye(model.nv)
    for found, at in (
        (np.vstack([u_q, A_q]), lambda step: moves(algorithms.integrate(model, q, step), v, a)),
        (np.vstack([u_v, A_v]), lambda step: moves(q, v + step, a)),
        (np.vstack([still, A_a]), lambda step: moves(q, v, a + step)),
    ):
        wanted = np.stack([(at(h * e) - at(-h * e)) / (2 * h) for e in eye], axis=-1)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-6 * (1 + np.abs(wanted).max()))
