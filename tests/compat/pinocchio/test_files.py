"""Files of Ulna's package keep every number, and what they cannot be read from is said."""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import FormatError, InputError
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Mesh, Shape, Sphere


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _things(pin: Any) -> list[Any]:
    """A model with joints of many kinds and a named posture, its data after algorithms, and its geometries."""
    model = pin.buildSampleModelHumanoid(False)
    model.addJoint(3, pin.JointModelHelicalUnaligned([1.0, 2.0, 3.0], 0.2), pin.SE3.Random(), "screw")
    model.addJoint(4, pin.JointModelUniversal(1, 0, 0, 0, 1, 0), pin.SE3.Random(), "cross")
    model = pin.transformJointIntoMimic(model, 3, 5, 0.2, 0.1)
    model.referenceConfigurations["rest"] = pin.neutral(model)
    data = model.createData()
    q = 0.1 * np.arange(model.nq)
    pin.forwardKinematics(model, data, q, 0.2 * np.arange(model.nv))
    pin.crba(model, data, q)
    pin.centerOfMass(model, data, q)
    geometries = pin.buildSampleGeometryModelHumanoid(pin.buildSampleModelHumanoid())
    geometries.addAllCollisionPairs()
    geometries.geometryObjects[0].meshMaterial = pin.GeometryPhongMaterial(np.ones(4), np.ones(4), 0.5)
    places = geometries.createData()
    places.deactivateCollisionPair(3)
    return [model, data, geometries, places, geometries.geometryObjects[0]]


def _empty_like(pin: Any, thing: Any) -> Any:
    made: Any = {
        "Data": lambda: pin.Model().createData(),
        "GeometryData": lambda: pin.GeometryModel().createData(),
        "GeometryObject": lambda: pin.GeometryObject.CreateCapsule(1.0, 1.0),
    }
    return made.get(type(thing).__name__, type(thing))()


def test_everything_comes_back_to_the_last_bit(pin: Any, tmp_path: Path) -> None:
    file = tmp_path / "file"
    for thing in _things(pin):
        for save, load, more in (
            ("saveToText", "loadFromText", ()),
            ("saveToXML", "loadFromXML", ("thing",)),
            ("saveToBinary", "loadFromBinary", ()),
        ):
            twin = _empty_like(pin, thing)
            assert twin != thing
            getattr(thing, save)(file, *more)
            getattr(twin, load)(str(file), *more)
            assert twin == thing, (type(thing), save)
        twin = _empty_like(pin, thing)
        twin.loadFromString(thing.saveToString())
        assert twin == thing
        assert pickle.loads(pickle.dumps(thing)) == thing


FORMER = {
    "_arrays": "StdVec_SE3",
    "_constraints": "RigidConstraintModel",
    "_data": "Data",
    "_enums": "ReferenceFrame",
    "_geometry": "GeometryModel",
    "_geometry_object": "GeometryObject",
    "_inertia": "Inertia",
    "_joints": "JointModelRX",
    "_model": "Model",
    "_package": "LogLevel",
    "_se3": "SE3",
    "_vectors": "Motion",
}
"""A class of each of some modules that are no longer there."""


@pytest.mark.parametrize("module", FORMER)
def test_pickles_that_name_former_modules_are_read(pin: Any, module: str) -> None:
    name = FORMER[module]
    cls = getattr(pin, name)
    stream = f"cpinocchio.{module}\n{cls.__name__}\n.".encode()
    assert pickle.loads(stream) is cls
    with pytest.raises(AttributeError):
        pickle.loads(f"cpinocchio.{module}\nNoSuchClass\n.".encode())


def test_a_model_that_was_loaded_computes(pin: Any) -> None:
    model = _things(pin)[0]
    twin = pin.Model()
    twin.loadFromString(model.saveToString())
    q, v = 0.1 * np.arange(model.nq), 0.2 * np.arange(model.nv)
    np.testing.assert_array_equal(
        pin.rnea(twin, twin.createData(), q, v, v), pin.rnea(model, model.createData(), q, v, v)
    )
    twin.inertias[1].mass *= 2.0  # and its numbers are live
    heavier = pin.rnea(twin, twin.createData(), q, v, v)
    assert heavier[2] > pin.rnea(model, model.createData(), q, v, v)[2]


def test_other_files_are_refused(pin: Any, tmp_path: Path) -> None:
    model, data, *_ = _things(pin)
    file = tmp_path / "file"
    with pytest.raises(FormatError, match="cannot be read"):
        pin.Model().loadFromText(tmp_path / "none")
    data.saveToText(file)
    with pytest.raises(FormatError, match="holds a Data; expected a Model"):
        pin.Model().loadFromText(file)
    file.write_text("22 serialization::archive 19 0 0", encoding="utf-8")
    for load in ("loadFromText", "loadFromBinary"):
        with pytest.raises(FormatError, match="Files of other programs"):
            getattr(pin.Model(), load)(file)
    model.saveToXML(file, "model")
    with pytest.raises(FormatError, match="no element <robot>"):
        pin.Model().loadFromXML(file, "robot")
    model.saveToBinary(file)
    file.write_bytes(file.read_bytes()[:-300])
    with pytest.raises(FormatError):
        pin.Model().loadFromBinary(file)
    for text in ("", "[]", "3", '{"#": "Popen"}', '{"#": "Model", "state": {"#": "dict", "items": []}}'):
        with pytest.raises(FormatError):
            pin.Model().loadFromString(text)


def test_buffers_in_memory(pin: Any) -> None:
    model = _things(pin)[0]
    stream, twin = pin.serialization.StreamBuffer(), pin.Model()
    pin.serialization.saveToBinary(model, stream)
    pin.serialization.loadFromBinary(twin, stream)
    assert twin == model
    small = pin.serialization.StaticBuffer(10)
    with pytest.raises(InputError, match="reserve"):
        pin.serialization.buffer_copy(small, stream)
    small.reserve(stream.size())
    pin.serialization.buffer_copy(small, stream)
    assert small.tobytes() == bytes(stream.view())
    with pytest.raises(InputError, match="pickle"):
        pin.serialization.saveToBinary(pin.SE3(), stream)


def test_a_mesh_made_in_memory_is_refused(pin: Any) -> None:
    coal = pytest.importorskip("coal")
    mesh = coal.BVHModelOBBRSS()
    thing = pin.GeometryObject("mesh", 0, pin.SE3(), mesh)
    with pytest.raises(InputError, match="made in memory"):
        thing.saveToString()


def test_pickle_keeps_a_mesh_made_in_memory(pin: Any) -> None:
    coal = pytest.importorskip("coal")
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(1, 3)
    mesh.addVertices(np.eye(3))
    mesh.addTriangles(np.array([[0, 1, 2]]))
    mesh.endModel()
    thing = pin.GeometryObject("mesh", 0, pin.SE3(), mesh)
    other = pickle.loads(pickle.dumps(thing))
    assert other == thing and other.geometry.num_vertices == 3
    thing.geometry = coal.Sphere(1.0)
    assert other != thing


@pytest.mark.parametrize(
    ("name", "sizes", "shape"),
    [
        ("Box", (0.1, 0.2, 0.3), Box((0.1, 0.2, 0.3))),
        ("Sphere", (0.4,), Sphere(0.4)),
        ("Capsule", (0.1, 0.5), Capsule(0.1, 0.5)),
        ("Cylinder", (0.1, 0.5), Cylinder(0.1, 0.5)),
        ("Cone", (0.1, 0.5), Cone(0.1, 0.5)),
        ("Ellipsoid", (0.1, 0.2, 0.3), Ellipsoid((0.1, 0.2, 0.3))),
    ],
)
def test_shapes_of_coal_are_drawn_and_distinguished(
    pin: Any, name: str, sizes: tuple[float, ...], shape: Shape
) -> None:
    coal = pytest.importorskip("coal")
    thing = pin.GeometryObject("thing", 0, pin.SE3.Identity(), getattr(coal, name)(*sizes))
    same = pin.GeometryObject("thing", 0, pin.SE3.Identity(), getattr(coal, name)(*sizes))
    assert thing.shape == shape and thing == same
    assert shape.describe() in repr(thing)
    assert "made in memory" not in thing.saveToString()
    same.geometry = getattr(coal, name)(*(1.5 * size for size in sizes))
    assert thing != same


def test_a_mesh_whose_scale_was_changed_is_pickled_as_it_is(pin: Any, tmp_path: Path) -> None:
    pytest.importorskip("coal")
    file = tmp_path / "one.obj"
    file.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", encoding="utf-8")
    thing = pin.GeometryObject("mesh", 0, pin.SE3(), Mesh(str(file)), str(file))
    thing.geometry.computeLocalAABB()
    thing.meshScale = np.full(3, 2.0)
    other = pickle.loads(pickle.dumps(thing))
    other.geometry.computeLocalAABB()
    assert other.geometry.aabb_radius == thing.geometry.aabb_radius
    assert other.shape.scale == (2.0, 2.0, 2.0)
