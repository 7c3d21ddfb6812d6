"""The kinds of joints against Pinocchio's: pose, subspace, bias, integrate, difference, derivatives."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from ulna.model import (
    Composite,
    Continuous,
    Cylindrical,
    FreeFlyer,
    Helical,
    JointKind,
    Planar,
    Prismatic,
    Revolute,
    Spherical,
    Translation,
    Universal,
)
from ulna.spatial import SE3

pin = pytest.importorskip("pinocchio")

AXIS = np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8])
OTHER = np.array([1.0, 0.2, 0.1]) / np.linalg.norm([1.0, 0.2, 0.1])
PLACE = SE3.from_rpy((0.3, -0.4, 1.1), (0.1, 0.2, -0.3))


def same(q: np.ndarray) -> np.ndarray:
    return q


def cos_sin(q: np.ndarray) -> np.ndarray:
    """Pinocchio writes a free angle as its cosine and sine, always at the end of q."""
    return np.concatenate([q[:-1], [np.cos(q[-1]), np.sin(q[-1])]])


def composite() -> Any:
    joint = pin.JointModelComposite()
    place = pin.SE3(PLACE.rotation, PLACE.translation)
    joint.addJoint(pin.JointModelRX(), place)
    joint.addJoint(pin.JointModelPrismaticUnaligned(AXIS), place)
    joint.addJoint(pin.JointModelSpherical(), place)
    return joint


def cylindrical() -> Any:
    """Pinocchio has none; a prismatic and a revolute joint about the same axis are one."""
    joint = pin.JointModelComposite()
    joint.addJoint(pin.JointModelPrismaticUnaligned(AXIS), pin.SE3.Identity())
    joint.addJoint(pin.JointModelRevoluteUnaligned(AXIS), pin.SE3.Identity())
    return joint


CASES: dict[str, tuple[JointKind, Callable[[], Any], Callable[[np.ndarray], np.ndarray]]] = {
    "RX": (Revolute((1, 0, 0)), pin.JointModelRX, same),
    "RY": (Revolute((0, 1, 0)), pin.JointModelRY, same),
    "RZ": (Revolute((0, 0, 1)), pin.JointModelRZ, same),
    "RevoluteUnaligned": (Revolute(AXIS), lambda: pin.JointModelRevoluteUnaligned(AXIS), same),
    "PX": (Prismatic((1, 0, 0)), pin.JointModelPX, same),
    "PrismaticUnaligned": (Prismatic(AXIS), lambda: pin.JointModelPrismaticUnaligned(AXIS), same),
    "HZ": (Helical((0, 0, 1), 0.3), lambda: pin.JointModelHZ(0.3), same),
    "HelicalUnaligned": (Helical(AXIS, -0.2), lambda: pin.JointModelHelicalUnaligned(AXIS, -0.2), same),
    "RUBX": (Continuous((1, 0, 0)), pin.JointModelRUBX, cos_sin),
    "RUBZ": (Continuous((0, 0, 1)), pin.JointModelRUBZ, cos_sin),
    "Cylindrical": (Cylindrical(AXIS), cylindrical, same),
    "Universal": (
        Universal((1, 0, 0), (0, 1, 0)),
        lambda: pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]),
        same,
    ),
    "Universal askew": (Universal(AXIS, OTHER), lambda: pin.JointModelUniversal(AXIS, OTHER), same),
    "Translation": (Translation(), pin.JointModelTranslation, same),
    "Planar": (Planar(), pin.JointModelPlanar, cos_sin),
    "Spherical": (Spherical(), pin.JointModelSpherical, same),
    "FreeFlyer": (FreeFlyer(), pin.JointModelFreeFlyer, same),
    "Composite": (
        Composite((Revolute((1, 0, 0)), Prismatic(AXIS), Spherical()), (PLACE, PLACE, PLACE)),
        composite,
        same,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_against_pinocchio(name: str) -> None:
    kind, make, translate = CASES[name]
    model = pin.Model()
    index = model.addJoint(0, make(), pin.SE3.Identity(), "joint")
    data = model.createData()
    assert kind.nv == model.nv
    rng = np.random.default_rng(7)
    for _ in range(5):
        q, other, v = kind.random(rng), kind.random(rng), rng.standard_normal(kind.nv)
        p, p_other = translate(q), translate(other)

        pin.forwardKinematics(model, data, p, v, np.zeros(model.nv))
        np.testing.assert_allclose(kind.transform(q).matrix(), data.oMi[index].homogeneous, atol=1e-14)
        np.testing.assert_allclose(kind.bias(q, v).vector(), data.a[index].vector, atol=1e-13)

        pin.computeJointJacobians(model, data, p)
        expected = pin.getJointJacobian(model, data, index, pin.LOCAL).reshape(6, -1)
        columns = np.stack([s.vector() for s in kind.motion_subspace(q)], axis=1)
        np.testing.assert_allclose(columns, expected, atol=1e-14)

        reached = pin.integrate(model, p, v)
        np.testing.assert_allclose(translate(kind.integrate(q, v)), reached, atol=1e-13)
        np.testing.assert_allclose(kind.difference(q, other), pin.difference(model, p, p_other), atol=1e-12)

        by_q, by_v = kind.integrate_derivatives(q, v)
        expected_q, expected_v = pin.dIntegrate(model, p, v)
        np.testing.assert_allclose(by_q, expected_q, atol=1e-12)
        np.testing.assert_allclose(by_v, expected_v, atol=1e-12)
        by_0, by_1 = kind.difference_derivatives(q, other)
        expected_0, expected_1 = pin.dDifference(model, p, p_other)
        np.testing.assert_allclose(by_0, expected_0, atol=1e-11)
        np.testing.assert_allclose(by_1, expected_1, atol=1e-11)
