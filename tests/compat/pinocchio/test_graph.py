"""Models built of graphs place bodies and masses alike, whatever body is the root; joints are as Pinocchio names them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError, ModelError, UnknownName


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def pose(pin: Any, k: float) -> Any:
    return pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5]) * k), np.array([0.1, -0.2, 0.3]) * k)


def graph_of(pin: Any, names: list[str]) -> Any:
    """A chain of bodies b0, b1, ... with these joints."""
    G = pin.graph
    z, x, y = np.eye(3)[[2, 0, 1]]
    kinds = {
        "revolute": lambda: G.JointRevolute(z),
        "prismatic": lambda: G.JointPrismatic(np.array([0.6, 0.0, 0.8])),
        "unbounded": lambda: G.JointRevoluteUnbounded(x),
        "helical": lambda: G.JointHelical(y, 0.3),
        "universal": lambda: G.JointUniversal(x, y),
        "translation": G.JointTranslation,
        "spherical": G.JointSpherical,
        "zyx": G.JointSphericalZYX,
        "planar": G.JointPlanar,
        "free": G.JointFreeFlyer,
        "fixed": lambda: G.JointFixed(pose(pin, 0.3)),
        "composite": lambda: G.JointComposite(
            [G.JointRevolute(z), G.JointPrismatic(x)], [pose(pin, 0.4), pose(pin, 0.7)]
        ),
    }
    g = G.ModelGraph()
    for k in range(len(names) + 1):
        g.addBody(f"b{k}", pin.Inertia(1.0 + k, np.array([0.1, 0.0, 0.2]), np.diag([0.3, 0.4, 0.5])))
    for k, name in enumerate(names):
        g.addJoint(name, kinds[name](), f"b{k}", pose(pin, k + 1), f"b{k + 1}", pose(pin, -0.5 * k - 1))
    return g


CHAINS = (
    ["revolute", "prismatic", "universal", "fixed"],
    ["unbounded", "helical", "composite"],
    ["spherical", "translation", "zyx"],
    ["planar", "free"],
)


@pytest.mark.parametrize("names", CHAINS, ids=" ".join)
def test_bodies_are_where_the_converter_says(pin: Any, names: list[str]) -> None:
    g, last = graph_of(pin, names), f"b{len(names)}"
    m, info = pin.graph.buildModelWithBuildInfo(g, "b0", pose(pin, 0.2))
    d, rng = m.createData(), np.random.default_rng(3)
    q = pin.integrate(m, pin.neutral(m), rng.uniform(-0.6, 0.6, m.nv))
    v = rng.uniform(-1.0, 1.0, m.nv)
    pin.forwardKinematics(m, d, q, v)
    pin.updateFramePlacements(m, d)
    at = m.getFrameId(last, pin.BODY)
    other, other_info = pin.graph.buildModelWithBuildInfo(g, last, d.oMf[at], pin.graph.JointFreeFlyer())
    convert = pin.graph.createConverter(m, other, info, other_info)
    q2, v2 = convert.convertConfigurationVector(q), convert.convertTangentVector(q, v)
    v2[:6] = pin.getFrameVelocity(m, d, at, pin.LOCAL).vector
    e = other.createData()
    pin.forwardKinematics(other, e, q2, v2)
    pin.updateFramePlacements(other, e)
    for k in range(len(names) + 1):
        here, there = (x.getFrameId(f"b{k}", pin.BODY) for x in (m, other))
        np.testing.assert_allclose(d.oMf[here].homogeneous, e.oMf[there].homogeneous, atol=1e-12)
        velocity = pin.getFrameVelocity(other, e, there, pin.WORLD).vector
        np.testing.assert_allclose(pin.getFrameVelocity(m, d, here, pin.WORLD).vector, velocity, atol=1e-11)
    fixed = m.inertias[0]  # the root body moves with the other model only
    assert np.isclose(sum(i.mass for i in m.inertias), sum(i.mass for i in other.inertias))
    kinetic = pin.computeKineticEnergy(m, d, q, v)
    assert fixed.mass > 0.0
    assert np.isclose(kinetic, pin.computeKineticEnergy(other, e, q2, v2), rtol=1e-9, atol=1e-9)


def test_limits_locks_merges_and_geometries(pin: Any) -> None:
    G = pin.graph
    g = graph_of(pin, ["revolute", "prismatic"])
    builder = g.edgeBuilder().withName("more").withJointType(G.JointRevolute(np.eye(3)[0]))
    builder = builder.withSourceVertex("b2").withQref([0.5]).withMinConfig([-1.0]).withMaxConfig([3.0])
    g.addBody("b3", pin.Inertia.Identity())
    builder.withTargetVertex("b3").withMaxVel([8.0]).withDamping([0.1]).withArmature([0.3]).build()
    m = G.buildModel(g, "b3", pin.SE3.Identity())
    assert list(m.names) == ["universe", "more", "prismatic", "revolute"]
    assert (m.lowerPositionLimit[0], m.upperPositionLimit[0], m.armature[0]) == (-3.0, 1.0, 0.3)
    assert m.lowerVelocityLimit[0] == -8.0 and m.damping[0] == 0.1
    locked = G.lockJoints(g, ["prismatic"], [np.array([0.2])])
    assert list(G.buildModel(locked, "b0", pin.SE3.Identity()).names) == ["universe", "revolute", "more"]
    both = G.merge(
        G.prefixNames(g, "a/"), G.prefixNames(g, "c/"), "a/b1", "c/b2", pose(pin, 1.0), G.JointSpherical()
    )
    assert G.buildModel(both, "a/b0", pin.SE3.Identity()).nq == 10
    g.geometryBuilder().withBody("b1").withName("ball").withGeom(G.Sphere(0.2)).build()
    g.addGeometry(
        "b2", G.Geometry("box", pose(pin, 1.0), G.VISUAL, np.ones(3), np.ones(4), G.Box([1.0, 2.0, 3.0]))
    )
    m = G.buildModel(g, "b0", pin.SE3.Identity())
    seen = G.buildGeometryModel(g, m, pin.VISUAL)
    assert [o.name for o in seen.geometryObjects] == ["ball", "box"]
    assert [o.name for o in G.buildGeometryModel(g, m, pin.COLLISION).geometryObjects] == ["ball"]
    assert seen.geometryObjects[1].parentJoint == m.getJointId("prismatic")


def test_invalid_graphs_are_refused(pin: Any) -> None:
    G = pin.graph
    g, one = graph_of(pin, ["revolute", "prismatic"]), pin.SE3.Identity()
    with pytest.raises(UnknownName, match="'b0'"):
        G.buildModel(g, "b", one)
    with pytest.raises(ModelError, match="already"):
        g.addBody("b0", pin.Inertia.Identity())
    with pytest.raises(UnknownName, match="'revolute'"):
        G.lockJoints(g, ["revolut"], [np.zeros(1)])
    g.addBody("end", pin.Inertia.Identity())
    g.addJoint("rolls", G.JointEllipsoid(0.1, 0.2, 0.3), "b2", one, "end", one)
    assert G.buildModel(g, "b0", one).nq == 5
    with pytest.raises(InputError, match="cannot be reversed"):
        G.buildModel(g, "end", one)
    g.addJoint("loop", G.JointFixed(), "b0", one, "end", one)
    with pytest.raises(ModelError, match="closes a loop"):
        G.buildModel(g, "b0", one)
    g.addFrame("sensor", G.SensorFrame())
    with pytest.raises(ModelError, match="JointFixed"):
        g.addJoint("bad", G.JointRevolute(np.eye(3)[2]), "b0", one, "sensor", one)
