"""Loaders of meshes read what they are passed for; whatever is none is refused. Extra arguments of geometries are, too."""

from __future__ import annotations

import importlib
import pickle
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using

MESH = """\
solid corner
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
facet normal 1 0 0
outer loop
vertex 0 0 0
vertex 0 1 0
vertex 0 0 1
endloop
endfacet
endsolid corner
"""
ARM = """<robot name="arm"><link name="base">
<collision><geometry><mesh filename="corner.stl" scale="2 2 2"/></geometry></collision>
<collision><geometry><sphere radius="0.1"/></geometry></collision></link></robot>"""


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    pytest.importorskip("coal")
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


@pytest.fixture
def file(tmp_path: Path) -> str:
    (tmp_path / "corner.stl").write_text(MESH, encoding="utf-8")
    (tmp_path / "arm.urdf").write_text(ARM, encoding="utf-8")
    return str(tmp_path / "arm.urdf")


def test_a_loader_reads_the_meshes(pin: Any, file: str) -> None:
    coal: Any = importlib.import_module("coal")
    model = pin.buildModelFromUrdf(file)
    for loader, kind in (
        (coal.MeshLoader(coal.BV_OBBRSS), coal.BV_OBBRSS),
        (coal.CachedMeshLoader(coal.BV_AABB), coal.BV_AABB),
    ):
        geometries = pin.buildGeomFromUrdf(model, file, pin.COLLISION, None, None, loader)
        mesh, ball = (g.geometry for g in geometries.geometryObjects)
        assert mesh.getNodeType() == kind and isinstance(ball, coal.Sphere)
        by_others = (
            pin.buildGeomFromUrdfString(model, ARM, pin.COLLISION, None, str(Path(file).parent), loader),
            pin.buildModelsFromUrdf(file, meshLoader=loader, geometry_types=pin.COLLISION)[1],
            pin.RobotWrapper.BuildFromURDF(file, None, None, False, loader).collision_model,
        )
        assert [g.geometryObjects[0].geometry.getNodeType() for g in by_others[1:]] == [kind, kind]
        assert by_others[0].ngeoms == 2
        kept = pickle.loads(pickle.dumps(geometries))
        assert kept.geometryObjects[0].meshPath == geometries.geometryObjects[0].meshPath


def test_an_invalid_loader_is_refused(pin: Any, file: str) -> None:
    model = pin.buildModelFromUrdf(file)
    for wrong in (3, "x", object()):
        with pytest.raises(TypeError, match="MeshLoader"):
            pin.buildGeomFromUrdf(model, file, pin.COLLISION, None, None, wrong)
        with pytest.raises(TypeError, match="MeshLoader"):
            pin.buildModelsFromUrdf(file, meshLoader=wrong)


def test_arguments_that_nothing_takes_are_refused(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, geometries = model.createData(), pin.buildSampleGeometryModelManipulator(model)
    known, q = geometries.createData(), pin.neutral(model)
    for wrong in (
        lambda: pin.computeCollisions(geometries, known, "a"),
        lambda: pin.computeDistances(geometries, known, 3),
        lambda: pin.computeDistances(model, data, geometries, known, q, 3),
        lambda: geometries.findCollisionPair(3),
        lambda: known.setActiveCollisionPairs(3, np.eye(6), True),
        lambda: pin.AngleAxis(0.4, np.ones(3), 3),
        lambda: pin.BoxSet(pin.BoxSet(-np.ones(3), np.ones(3)), 3),
        lambda: pin.ModelPool(pin.ModelPool(model, 2), 3),
        lambda: pin.JointModelHelicalUnaligned(np.ones(3), 0.4, 3),
        lambda: pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1], 3),
        lambda: pin.JointModelMimic(model.joints[2], "a", 0.4),
        lambda: pin.getConstraintJacobian(model, data, None, None),
        lambda: pin.getKKTContactDynamicMatrixInverse(model, data, None),
        lambda: pin.rpy.rotate(3, 0.4),
        lambda: pin.PseudoInertia("a", np.ones(3), np.eye(3)),
        lambda: pin.Symmetric3(np.ones(6), 3),
        lambda: model.getChildJoints(0),
    ):
        with pytest.raises(TypeError):
            wrong()
    with pytest.raises(ValueError, match="tool"):
        pin.JointModelComposite(pin.JointModelRX(), pin.SE3.Identity(), "wrist").getJointId("tool")


def test_child_joints_are_the_ends_of_the_tree(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()
    ends = [i for i in range(1, model.njoints) if i not in list(model.parents)]
    assert list(model.getChildJoints()) == ends and len(ends) == 5
    assert [list(c) for c in model.children][1] == [
        i for i in range(model.njoints) if i and model.parents[i] == 1
    ]


def test_changes_of_shapes_and_pairs_are_seen_by_the_next_query(pin: Any) -> None:
    """Calls of coal are kept with the geometry model; another shape, geometry or pair, or a radius, counts at once."""
    coal: Any = importlib.import_module("coal")
    model = pin.Model()
    data, geometries = model.createData(), pin.GeometryModel()
    for k, x in enumerate((0.0, 1.0, 5.0)):
        place = pin.SE3(np.eye(3), np.array([x, 0.0, 0.0]))
        geometries.addGeometryObject(pin.GeometryObject(f"ball{k}", 0, place, coal.Sphere(0.1)))
    geometries.addCollisionPair(pin.CollisionPair(0, 1))
    geometries.addCollisionPair(pin.CollisionPair(0, 2))
    known, second = geometries.createData(), geometries.createData()
    q = pin.neutral(model)

    def nearest() -> tuple[int, float, bool]:
        for each in (known, second):
            k = pin.computeDistances(model, data, geometries, each, q)
        return (
            k,
            each.distanceResults[k].min_distance,
            pin.computeCollisions(model, data, geometries, known, q, True),
        )

    assert nearest() == (0, pytest.approx(0.8), False)
    geometries.geometryObjects[1].geometry.radius = 0.95
    assert nearest() == (0, pytest.approx(-0.05), True)
    geometries.geometryObjects[1].geometry = coal.Sphere(0.3)
    assert nearest() == (0, pytest.approx(0.6), False)
    geometries.collisionPairs[0].first, geometries.collisionPairs[0].second = 1, 2
    assert nearest() == (0, pytest.approx(3.6), False)
    known.deactivateCollisionPair(0)
    second.deactivateCollisionPair(0)
    assert nearest() == (1, pytest.approx(4.8), False)
    other = pickle.loads(pickle.dumps(geometries))
    assert pin.computeDistances(model, data, other, other.createData(), q) == 0
    assert geometries.copy().ngeoms == 3 and "_pair_calls" not in geometries.__getstate__()
    known.collisionRequests[1].security_margin = 5.0
    assert pin.computeCollisions(model, data, geometries, known, q)
    known.deactivateAllCollisionPairs()
    assert not pin.computeCollisions(model, data, geometries, known, q)
    assert pin.computeDistances(model, data, geometries, known, q) == 2
