"""Geometries are placed by one native call, which notices every change of them."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


class Scene:
    """An arm with a sphere on each joint."""

    def __init__(self, pin: Any) -> None:
        self.pin, self.model = pin, pin.buildSampleModelManipulator()
        self.data, self.geometries = self.model.createData(), pin.GeometryModel()
        for joint in range(self.model.njoints):
            self.geometries.addGeometryObject(self.sphere(joint))
        self.places = self.geometries.createData()

    def sphere(self, joint: int) -> Any:
        return self.pin.GeometryObject(
            f"on {joint}", joint, self.pin.SE3.Random(), self.pin.hppfcl.Sphere(0.1)
        )

    def check(self, times: int = 1) -> None:
        for _ in range(times):
            q = self.pin.randomConfiguration(self.model)
            self.pin.forwardKinematics(self.model, self.data, q)
            self.pin.updateGeometryPlacements(self.model, self.data, self.geometries, self.places)
            for shape, found in zip(self.geometries.geometryObjects, self.places.oMg, strict=True):
                wanted = self.data.oMi[shape.parentJoint].homogeneous @ shape.placement.homogeneous
                np.testing.assert_allclose(found.homogeneous, wanted, atol=1e-14)


@pytest.fixture
def scene(pin: Any) -> Scene:
    pytest.importorskip("coal")
    made = Scene(pin)
    made.check(15)
    return made


def test_nothing_is_compiled_for_hundreds_of_geometries(pin: Any) -> None:
    pytest.importorskip("coal")
    scene = Scene(pin)
    for k in range(100):
        scene.geometries.addGeometryObject(scene.sphere(k % scene.model.njoints))
    scene.places = scene.geometries.createData()
    scene.check(15)
    assert scene.places._placing.objects is None
    scene.geometries.geometryObjects[50].placement = pin.SE3.Random()
    scene.check()


def test_placements_and_joints_of_geometries_may_change(scene: Scene) -> None:
    shape = scene.geometries.geometryObjects[3]
    live = shape.placement.translation
    live[:] = 1.0, 2.0, 3.0
    scene.check(2)
    shape.placement = scene.pin.SE3.Random()
    scene.check(2)
    np.testing.assert_array_equal(live, shape.placement.translation)
    shape.parentJoint = 1
    scene.check(3)


def test_geometries_may_be_replaced(scene: Scene) -> None:
    scene.geometries.geometryObjects[2] = scene.sphere(5)
    scene.check(3)
    scene.geometries.geometryObjects.reverse()
    scene.check(3)
    scene.geometries.addGeometryObject(scene.sphere(1))
    with pytest.raises(scene.pin.Exception, match="was made for"):
        scene.pin.updateGeometryPlacements(scene.model, scene.data, scene.geometries, scene.places)
    scene.places = scene.geometries.createData()
    scene.check(3)
    scene.geometries.geometryObjects[0].parentJoint = 100
    with pytest.raises(IndexError, match="joints up to 100"):
        scene.pin.updateGeometryPlacements(scene.model, scene.data, scene.geometries, scene.places)


def test_copies_are_placed_on_their_own(scene: Scene) -> None:
    before = [place.homogeneous for place in scene.places.oMg]
    others = (
        scene.geometries.copy(),
        copy.deepcopy(scene.geometries),
        pickle.loads(pickle.dumps(scene.geometries)),
    )
    other_places = scene.places.copy()
    for other in others:
        other.geometryObjects[3].placement.translation[:] = 9.0
        scene.pin.updateGeometryPlacements(scene.model, scene.data, other, other_places)
        assert other_places.oMg[3] != scene.places.oMg[3]
    assert all(np.array_equal(a, b.homogeneous) for a, b in zip(before, scene.places.oMg, strict=True))
    scene.check(3)


def test_another_data_or_a_configuration_may_be_passed(scene: Scene) -> None:
    pin, model = scene.pin, scene.model
    scene.data = model.createData()
    scene.check(3)
    q = pin.randomConfiguration(model)
    for _ in range(3):
        pin.updateGeometryPlacements(model, scene.data, scene.geometries, scene.places, q)
    wanted = [scene.data.oMi[g.parentJoint] * g.placement for g in scene.geometries.geometryObjects]
    assert all(a.isApprox(b) for a, b in zip(wanted, scene.places.oMg, strict=True))
