"""The spatial types against Pinocchio, and their accuracy against sixty digits of mpmath."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ulna import spatial as sp
from ulna.spatial import SE3, SO3, Force, Inertia, Motion

pin = pytest.importorskip("pinocchio")
mp = pytest.importorskip("mpmath")

ANGLES = [0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 0.03, 0.1, 0.199, 0.201, 0.5, 1.0, 2.0, 3.0]
NEAR_PI = [np.pi - d for d in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)]

THEIR_ERROR = 1e-6
"""Pinocchio's 6x6 Jacobians are off by 4e-8 at 1e-3 rad; the tests against mpmath settle who is right."""


def close(a: Any, b: Any, tolerance: float = 1e-13) -> None:
    np.testing.assert_allclose(np.asarray(a, float), np.asarray(b, float), rtol=tolerance, atol=tolerance)


def rotation_vectors(angle: float, count: int = 12) -> np.ndarray:
    rng = np.random.default_rng(5)
    axes = np.concatenate([np.eye(3), -np.eye(3), rng.standard_normal((count - 6, 3))])
    return angle * axes / np.linalg.norm(axes, axis=-1, keepdims=True)


def theirs(pose: SE3) -> Any:
    return pin.SE3(pose.rotation, pose.translation)


# Pinocchio


@pytest.mark.parametrize("angle", ANGLES + NEAR_PI)
def test_exponentials_and_their_derivatives(angle: float) -> None:
    rng = np.random.default_rng(6)
    for w in rotation_vectors(angle):
        v = rng.standard_normal(3)
        x = np.concatenate([v, w])
        close(sp.so3_exp(w), pin.exp3(w))
        close(sp.se3_exp(x), pin.exp6(pin.Motion(v, w)).homogeneous)
        close(sp.so3_right_jacobian(w), pin.Jexp3(w), 1e-12)
        close(sp.se3_right_jacobian(x), pin.Jexp6(pin.Motion(v, w)), THEIR_ERROR if angle == 1e-3 else 1e-11)
        close(sp.quat_exp(w), pin.exp3_quat(w))


@pytest.mark.parametrize("angle", [*ANGLES, 3.1])
def test_logarithms_and_their_derivatives(angle: float) -> None:
    rng = np.random.default_rng(7)
    tolerance = THEIR_ERROR if angle == 1e-3 else 1e-9
    for w in rotation_vectors(angle):
        pose = SE3(sp.so3_exp(w), rng.standard_normal(3))
        close(sp.so3_log(pose.rotation), pin.log3(pose.rotation), 1e-10)
        close(pose.log().vector(), pin.log6(theirs(pose)).vector, 1e-10)
        close(sp.so3_right_jacobian_inverse(w), pin.Jlog3(pose.rotation), 1e-9)
        close(sp.se3_right_jacobian_inverse(pose.log().vector()), pin.Jlog6(theirs(pose)), tolerance)


def test_quaternions_and_rpy() -> None:
    rng = np.random.default_rng(8)
    for r in SO3.random(rng, (50,)):
        quat = pin.Quaternion(r.matrix).coeffs()
        close(r.quat_xyzw(), quat * np.sign(quat[3]))
        close(sp.quat_xyzw_to_matrix(quat), r.matrix)
        close(r.rpy(), pin.rpy.matrixToRpy(r.matrix))
        close(SO3.from_rpy(r.rpy()), pin.rpy.rpyToMatrix(r.rpy()))
        close(sp.rpy_rate_matrix(r.rpy()), pin.rpy.computeRpyJacobian(r.rpy(), pin.ReferenceFrame.WORLD))
        close(
            sp.rpy_rate_matrix_inverse(r.rpy()),
            pin.rpy.computeRpyJacobianInverse(r.rpy(), pin.ReferenceFrame.WORLD),
            1e-10,
        )
        angle_axis = pin.AngleAxis(r.matrix)
        angle, axis = r.angle_axis()
        close(angle, angle_axis.angle, 1e-12)
        close(axis, angle_axis.axis, 1e-12)


def test_actions_on_twists_wrenches_and_inertias() -> None:
    rng = np.random.default_rng(9)
    for pose, other in zip(SE3.random(rng, (20,)), SE3.random(rng, (20,)), strict=True):
        a = theirs(pose)
        close(pose @ other, (a * theirs(other)).homogeneous)
        close(pose.inverse(), a.inverse().homogeneous)
        close(pose.adjoint(), a.action)
        close(pose.dual_adjoint(), a.inverse().action.T)
        m, n, f = (rng.standard_normal(6) for _ in range(3))
        ours, mine = Motion.from_vector(m), pin.Motion(m)
        close(pose.act(ours), a.act(mine).vector)
        close(pose.act_inverse(ours), a.actInv(mine).vector)
        close(pose.act(Force.from_vector(f)), a.act(pin.Force(f)).vector)
        close(pose.act_inverse(Force.from_vector(f)), a.actInv(pin.Force(f)).vector)
        close(ours.cross(Motion.from_vector(n)), mine.cross(pin.Motion(n)).vector)
        close(ours.cross(Force.from_vector(f)), mine.cross(pin.Force(f)).vector)
        close(ours.cross_matrix(), mine.action)
        close(ours.dot(Force.from_vector(f)), mine.dot(pin.Force(f)))

        root = rng.standard_normal((3, 3))
        mass, com, moments = 2.5, rng.standard_normal(3), root @ root.T
        body, peer = Inertia(mass, com, moments), pin.Inertia(mass, com, moments)
        close(body.matrix(), peer.matrix())
        close(body.parameters(), peer.toDynamicParameters())
        close(Inertia.from_parameters(peer.toDynamicParameters()), peer.matrix(), 1e-12)
        close(body.apply(ours), (peer * mine).vector)
        close(pose.act(body), a.act(peer).matrix(), 1e-12)
        close(pose.act_inverse(body), a.actInv(peer).matrix(), 1e-12)
        close(body + pose.act(body), (peer + a.act(peer)).matrix(), 1e-12)
        close(body.kinetic_energy(ours), 0.5 * peer.vtiv(mine), 1e-12)


def test_solids() -> None:
    close(Inertia.from_sphere(2.0, 0.3), pin.Inertia.FromSphere(2.0, 0.3).matrix())
    close(
        Inertia.from_ellipsoid(2.0, [0.1, 0.2, 0.3]), pin.Inertia.FromEllipsoid(2.0, 0.1, 0.2, 0.3).matrix()
    )
    close(Inertia.from_cylinder(2.0, 0.3, 0.7), pin.Inertia.FromCylinder(2.0, 0.3, 0.7).matrix())
    close(Inertia.from_box(2.0, [0.1, 0.2, 0.3]), pin.Inertia.FromBox(2.0, 0.1, 0.2, 0.3).matrix())
    close(Inertia.from_capsule(2.0, 0.3, 0.7), pin.Inertia.FromCapsule(2.0, 0.3, 0.7).matrix())


# mpmath


def exact(w: np.ndarray) -> tuple[list[Any], Any, Any]:
    """The rotation vector, its length and its skew matrix in sixty digits."""
    x, y, z = (mp.mpf(float(c)) for c in w)
    return [x, y, z], mp.sqrt(x * x + y * y + z * z), mp.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def error(ours: np.ndarray, judge: Any) -> float:
    return float(max(abs(mp.mpf(float(a)) - b) for a, b in zip(np.ravel(ours), judge, strict=True)))


@pytest.mark.parametrize("angle", [a for a in ANGLES if a > 0.0] + NEAR_PI)
def test_maps_are_accurate_to_rounding(angle: float) -> None:
    rng = np.random.default_rng(10)
    with mp.workdps(60):
        for w, v in zip(rotation_vectors(angle), rng.standard_normal((12, 3)), strict=True):
            _, t, big_w = exact(w)
            _, _, big_v = exact(v)
            a, b, c = mp.sin(t) / t, (1 - mp.cos(t)) / t**2, (t - mp.sin(t)) / t**3
            e = (t**2 + 2 * mp.cos(t) - 2) / (2 * t**4)
            f = (2 * t - 3 * mp.sin(t) + t * mp.cos(t)) / (2 * t**5)
            r = mp.eye(3) + a * big_w + b * big_w**2
            jacobian = mp.eye(3) + b * big_w + c * big_w**2
            corner = (
                big_v / 2
                + c * (big_w * big_v + big_v * big_w + big_w * big_v * big_w)
                + e * (big_w**2 * big_v + big_v * big_w**2 - 3 * big_w * big_v * big_w)
                + f * (big_w * big_v * big_w**2 + big_w**2 * big_v * big_w)
            )
            inverse = jacobian**-1
            x = np.concatenate([v, w])
            assert error(sp.so3_exp(w), r) < 2e-15
            assert error(sp.so3_left_jacobian(w), jacobian) < 2e-15
            assert error(sp.so3_left_jacobian_inverse(w), inverse) < 2e-15
            assert error(sp.se3_left_jacobian(x)[:3, 3:], corner) < 1e-14
            assert error(sp.se3_left_jacobian_inverse(x)[:3, 3:], -inverse * corner * inverse) < 1e-14
            assert (
                error(sp.se3_exp(x).translation, jacobian * mp.matrix([mp.mpf(float(n)) for n in v])) < 3e-15
            )
            rounded = np.array(r.tolist(), dtype=float)
            assert np.abs(sp.so3_log(rounded) - w).max() < 1e-15 * angle
