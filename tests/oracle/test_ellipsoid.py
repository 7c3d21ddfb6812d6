"""Robots with ellipsoid joints move as in Pinocchio, and their derivatives are those of differences.

Pinocchio's own derivatives take the motion subspace of such a joint for constant; so they are no reference here.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ulna import Robot, algorithms
from ulna.algorithms.derivatives.inverse_dynamics import inverse_dynamics_derivatives
from ulna.errors import InputError
from ulna.model import Ellipsoid, Model, ModelBuilder, Prismatic, Revolute
from ulna.spatial import SE3, Inertia, so3_exp

pin = pytest.importorskip("pinocchio")

RADII = {"roll": (0.3, 0.5, 0.8), "ball": (0.4, 0.4, 0.4)}
PLACES = [SE3(so3_exp(np.array([0.3, -0.2, 0.5]) * k), np.array([0.1, -0.2, 0.3]) * k) for k in range(6)]


def inertia(k: int) -> Inertia:
    return Inertia(1.0 + k, np.array([0.1, 0.02, -0.03]) * k, np.diag([0.3, 0.4, 0.5]))


def model() -> Model:
    """base - turn - roll - elbow, and turn - ball - slide."""
    builder = ModelBuilder("rolling")
    builder.add_link("base")
    for k in range(5):
        builder.add_link(f"link{k}", inertia(k))
    builder.add_joint("turn", Revolute(), "base", "link0", PLACES[1])
    builder.add_joint("roll", Ellipsoid(*RADII["roll"]), "link0", "link1", PLACES[2])
    builder.add_joint("elbow", Revolute((0, 1, 0)), "link1", "link2", PLACES[3])
    builder.add_joint("ball", Ellipsoid(*RADII["ball"]), "link0", "link3", PLACES[4])
    builder.add_joint("slide", Prismatic((1, 0, 0)), "link3", "link4", PLACES[5])
    return builder.build()


def reference() -> Any:
    out = pin.Model()
    kinds = (pin.JointModelRZ(), pin.JointModelEllipsoid(*RADII["roll"]), pin.JointModelRY())
    kinds += (pin.JointModelEllipsoid(*RADII["ball"]), pin.JointModelPX())
    for k, (name, kind) in enumerate(zip(("turn", "roll", "elbow", "ball", "slide"), kinds, strict=True)):
        parent = (0, 1, 2, 1, 4)[k]
        place = pin.SE3(PLACES[k + 1].matrix())
        joint = out.addJoint(parent, kind, place, name)
        body = inertia(k)
        out.appendBodyToJoint(joint, pin.Inertia(body.mass, body.com, body.inertia), pin.SE3.Identity())
    return out


STATE = np.random.default_rng(5).uniform(-1.0, 1.0, (4, 9))
MODEL = model()


def test_motion_and_dynamics_equal_pinocchio() -> None:
    m, (q, v, a, tau) = reference(), STATE
    d = m.createData()
    assert (MODEL.nq, MODEL.nv) == (m.nq, m.nv)
    pin.forwardKinematics(m, d, q)
    tip = MODEL.frame("link2")
    pose = algorithms.frame_pose(MODEL, q, tip)
    np.testing.assert_allclose(pose.matrix(), d.oMi[3].homogeneous, atol=1e-13)
    J = pin.computeJointJacobian(m, d, q, 3)
    np.testing.assert_allclose(algorithms.frame_jacobian(MODEL, q, tip, "local"), J, atol=1e-13)
    close = {"rtol": 1e-9, "atol": 1e-11}
    np.testing.assert_allclose(algorithms.inverse_dynamics(MODEL, q, v, a), pin.rnea(m, d, q, v, a), **close)
    M = pin.crba(m, d, q)
    np.testing.assert_allclose(algorithms.mass_matrix(MODEL, q), M, **close)
    by_pinocchio = pin.aba(m, d, q, v, tau)
    np.testing.assert_allclose(algorithms.forward_dynamics(MODEL, q, v, tau), by_pinocchio, **close)
    np.testing.assert_allclose(Robot(MODEL).inverse_dynamics(q, v, a), pin.rnea(m, d, q, v, a), **close)


def test_derivatives_are_those_of_differences() -> None:
    q, v, a, _ = STATE
    h = 1e-6
    dq, dv, da = inverse_dynamics_derivatives(MODEL, q, v, a)
    for k, step in enumerate(h * np.eye(9)):
        by_q = [algorithms.inverse_dynamics(MODEL, q + s * step, v, a) for s in (1.0, -1.0)]
        by_v = [algorithms.inverse_dynamics(MODEL, q, v + s * step, a) for s in (1.0, -1.0)]
        np.testing.assert_allclose(dq[:, k], (by_q[0] - by_q[1]) / (2.0 * h), atol=1e-6)
        np.testing.assert_allclose(dv[:, k], (by_v[0] - by_v[1]) / (2.0 * h), atol=1e-6)
    np.testing.assert_allclose(da, algorithms.mass_matrix(MODEL, q), atol=1e-10)


def test_coriolis_matrix() -> None:
    q, v, _, _ = STATE
    still = np.zeros(9)
    bias = algorithms.inverse_dynamics(MODEL, q, v, still) - algorithms.gravity_forces(MODEL, q)
    np.testing.assert_allclose(algorithms.coriolis_matrix(MODEL, q, v) @ v, bias, atol=1e-10)


def test_the_articulated_body_algorithm_says_what_to_use() -> None:
    with pytest.raises(InputError, match="forward_dynamics"):
        algorithms.aba(MODEL, *STATE[:3])
