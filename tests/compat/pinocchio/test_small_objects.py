"""Products and sums of placements, motions, forces, inertias and quaternions are those of `ulna.spatial`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna import spatial


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _value(body: Any) -> spatial.Inertia:
    return spatial.Inertia(body.mass, body.lever, body.inertia)


def _same(body: Any, wanted: spatial.Inertia) -> None:
    assert body.mass == pytest.approx(wanted.mass, rel=1e-14)
    np.testing.assert_allclose(body.lever, wanted.com, atol=1e-14)
    np.testing.assert_allclose(body.inertia, wanted.inertia, atol=1e-14)


def test_inertias(pin: Any) -> None:
    pin.seed(1)
    a, b, M, v = pin.Inertia.Random(), pin.Inertia.Random(), pin.SE3.Random(), pin.Motion.Random()
    one, other, twist = _value(a), _value(b), spatial.Motion(v.linear, v.angular)
    _same(a + b, one + other)
    _same(M.act(a), M._pose().act(one))
    _same(M.actInv(a), M._pose().act_inverse(one))
    _same((a + b) - b, one)
    _same(pin.Inertia.FromDynamicParameters(a.toDynamicParameters()), one)
    np.testing.assert_allclose(a.matrix(), one.matrix(), atol=1e-15)
    np.testing.assert_allclose(a.inverse() @ a.matrix(), np.eye(6), atol=1e-11)
    np.testing.assert_allclose((a * v).vector, one.apply(twist).vector(), atol=1e-14)
    np.testing.assert_allclose(a.vxiv(v).vector, twist.cross(one.apply(twist)).vector(), atol=1e-14)
    np.testing.assert_allclose(a.variation(v), v.dualAction @ a.matrix() - a.matrix() @ v.action, atol=1e-14)
    assert a.vtiv(v) == pytest.approx(2.0 * one.kinetic_energy(twist), rel=1e-13)
    assert one.is_physical()


def test_sums_and_differences_without_mass(pin: Any) -> None:
    nothing, body = pin.Inertia.Zero(), pin.Inertia(2.0, np.ones(3), np.eye(3))
    assert (nothing + nothing).isZero() and (body - body).isZero()
    _same(nothing + body, _value(body))
    _same(body + nothing, _value(body))


def test_solid_bodies(pin: Any) -> None:
    _same(pin.Inertia.FromSphere(2.0, 0.3), spatial.Inertia.from_sphere(2.0, 0.3))
    _same(pin.Inertia.FromBox(2.0, 0.3, 0.4, 0.5), spatial.Inertia.from_box(2.0, (0.3, 0.4, 0.5)))
    _same(pin.Inertia.FromEllipsoid(2.0, 0.3, 0.4, 0.5), spatial.Inertia.from_ellipsoid(2.0, (0.3, 0.4, 0.5)))


def test_motions_and_quaternions(pin: Any) -> None:
    v, w, f = pin.Motion.Random(), pin.Motion.Random(), pin.Force.Random()
    np.testing.assert_allclose((v ^ w).vector, v.action @ w.vector, atol=1e-15)
    np.testing.assert_allclose(v.cross(f).vector, v.dualAction @ f.vector, atol=1e-15)
    A, B = pin.SE3.Random(), pin.SE3.Random()
    p, r = pin.Quaternion(A.rotation), pin.Quaternion(B.rotation)
    np.testing.assert_allclose((p * r).matrix(), A.rotation @ B.rotation, atol=1e-15)
    np.testing.assert_allclose(p * np.arange(3.0), A.rotation @ np.arange(3.0), atol=1e-14)
    np.testing.assert_allclose((p.inverse() * p).coeffs(), [0, 0, 0, 1], atol=1e-15)
    half = p.slerp(0.5, r)
    assert half.angularDistance(p) == pytest.approx(half.angularDistance(r), abs=1e-12)
    np.testing.assert_allclose(A * np.ones(3), A.rotation @ np.ones(3) + A.translation, atol=1e-15)


def test_nearly_equal_objects_are_told_by_each_part(pin: Any) -> None:
    A = pin.SE3.Random()
    B = A.copy()
    assert A.isApprox(B) and A == B
    B.translation[2] += 1e-9
    assert not A.isApprox(B) and A.isApprox(B, 1e-6) and A != B
    v = pin.Motion(np.zeros(3), np.ones(3))
    w = v.copy()
    w.linear[0] = 1e-9
    assert v.isApprox(v.copy()) and not v.isApprox(w) and not w.isApprox(v)


def test_a_copied_model_shares_nothing(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()
    other = model.copy()
    assert other == model
    other.inertias[3].mass += 1.0
    other.jointPlacements[2].translation[0] += 1.0
    other.frames[-1].placement.translation[1] += 1.0
    other.gravity.linear[0], other.armature[3], other.lowerPositionLimit[0] = 1.0, 2.0, 3.0
    fresh = pin.buildSampleModelHumanoid()
    assert model == fresh and other != model
    assert model.inertias[3] == fresh.inertias[3] and model.frames[-1].placement == fresh.frames[-1].placement
    other.addFrame(pin.Frame("new", 1, 0, pin.SE3.Random(), pin.OP_FRAME))
    assert other.nframes == model.nframes + 1
