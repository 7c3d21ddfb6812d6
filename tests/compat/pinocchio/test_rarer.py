"""What Pinocchio cannot be asked, for it crashes or refuses: broad phases, margins, callbacks, Gram and Schmidt, joints."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError, UnknownName


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


@pytest.fixture
def arm(pin: Any) -> tuple[Any, Any, Any, Any]:
    """The sample manipulator, stretched out, with all pairs of its geometries."""
    pytest.importorskip("coal")
    model = pin.buildSampleModelManipulator()
    geometries = pin.buildSampleGeometryModelManipulator(model)
    geometries.addAllCollisionPairs()
    data, places = model.createData(), geometries.createData()
    pin.updateGeometryPlacements(model, data, geometries, places, np.zeros(6))
    return model, data, geometries, places


def test_every_broad_phase_finds_what_the_pairs_do(pin: Any, arm: Any) -> None:
    model, data, geometries, places = arm
    names = [n for n in dir(pin) if "BroadPhaseManager_" in n and not n.startswith("StdVec")]
    assert len(names) == 12
    for k, q in enumerate(np.random.default_rng(2).uniform(-2, 2, (6, 6))):
        pin.updateGeometryPlacements(model, data, geometries, places, q)
        places.setSecurityMargins(geometries, np.full((6, 6), 0.1 * (k % 2)))
        wanted = pin.computeCollisions(geometries, places)
        hits = {i for i, r in enumerate(places.collisionResults) if r.isCollision()}
        for name in names:
            manager = getattr(pin, name)(model, geometries, places)
            manager.update()
            assert pin.computeCollisions(manager) == wanted
            near = pin.CollisionCallBackCollect(geometries, places)
            manager.collide(near)
            assert hits <= set(near.pair_indexes)
            assert manager.getManager().size() == 6


def test_custom_callbacks(pin: Any, arm: Any) -> None:
    model, data, geometries, places = arm

    class First(pin.CollisionCallBackBase):
        def collide(self, first: Any, second: Any) -> bool:
            self.seen = (first.geometryObjectIndex, second.geometryObjectIndex)
            self.collision = True
            return True

    manager = pin.BroadPhaseManager_SaPCollisionManager(model, geometries, places)
    own = First(geometries, places)
    assert pin.computeCollisions(manager, own)
    assert own.seen[0] < own.seen[1]
    count = pin.CollisionCallBackDefault(geometries, places)
    counted = [manager.collide(count) and count.count for _ in range(2)]
    assert counted[0] == counted[1] > 0  # each time from the start
    stops = pin.CollisionCallBackDefault(geometries, places, True)
    assert pin.computeCollisions(model, data, manager, stops, np.zeros(6))
    assert 1 <= stops.count < len(geometries.collisionPairs)
    other = pin.BroadPhaseManager_SaPCollisionManager(manager)
    assert other.collide(manager, pin.CollisionCallBackDefault(geometries, places))
    assert manager.collide(other.getCollisionObjects()[0], First(geometries, places))


def test_pools_and_their_data(pin: Any, arm: Any) -> None:
    model, _, geometries, places = arm
    pool = pin.GeometryPool(model, geometries, 2)
    moved = geometries.copy()
    moved.geometryObjects[0].placement = pin.SE3(np.eye(3), [0.0, 0.0, 9.0])
    pool.sync(moved, [0])
    assert pool.getGeometryModel(1).geometryObjects[0].placement.translation[2] == 9.0
    pool.update(places)
    assert pool.getGeometryData(1) == places
    pool.resize(3)
    assert (pool.size(), len(pool.getGeometryDatas()), pool.copy().size()) == (3, 3, 3)
    with pytest.raises(InputError, match="resize"):
        pool.getData(3)
    with pytest.raises(InputError, match=r"expected \(6, n\)"):
        pin.computeCollisionsInParallel(2, pool, np.zeros((5, 2)))
    paths = pin.computeCollisionsInParallel(2, pool, [np.zeros((6, 2)), np.zeros((6, 3))])
    assert [len(path) for path in paths] == [2, 3]


def test_data_of_geometries_are_copied_whole(pin: Any, arm: Any) -> None:
    _, _, geometries, places = arm
    places.deactivateCollisionPair(2)
    for twin in (places.copy(), copy.copy(places), copy.deepcopy(places)):
        assert twin == places
        twin.oMg[0].translation[:] = 1.0
        assert twin != places
    with pytest.raises(InputError, match=r"expected \(6, 6\)"):
        places.setActiveCollisionPairs(geometries, np.eye(5))


def test_gram_and_schmidt(pin: Any) -> None:
    matrix = np.random.default_rng(1).normal(size=(5, 3))
    spanned = matrix.copy()
    pin.orthonormalization(matrix)
    assert pin.isOrthonormal(matrix)
    assert not pin.isOrthonormal(spanned)
    np.testing.assert_allclose(matrix @ (matrix.T @ spanned), spanned, atol=1e-12)
    vector = np.ones(5)
    pin.orthogonalization(matrix, vector)
    np.testing.assert_allclose(matrix.T @ vector, 0.0, atol=1e-12)
    with pytest.raises(InputError, match="in place"):
        pin.orthonormalization([[1, 2], [3, 4]])


def test_kinds_of_joints_that_are_refused(pin: Any) -> None:
    with pytest.raises(InputError, match="expected a plain joint"):
        pin.JointModelComposite().addJoint(pin.JointModelComposite(pin.JointModelRX()))
    with pytest.raises(UnknownName, match="'first'"):
        pin.JointModelComposite(pin.JointModelRX(), pin.SE3(), "first").getJointId("frist")
    with pytest.raises(InputError, match="in the model already"):
        pin.JointModelMimic(pin.JointModelRX(), 1.0, 0.0)
    with pytest.raises(AttributeError, match="follows no joint"):
        _ = pin.JointModelRX().scaling


def test_joints_data_do_not_share_numbers(pin: Any) -> None:
    joint = pin.JointModelComposite(pin.JointModelRX()).addJoint(pin.JointModelSpherical())
    joint.setIndexes(1, 0, 0)
    data = joint.createData()
    twin = data.copy()
    joint.calc(data, np.array([0.3, 0.5, 0.5, 0.5, 0.5]), np.ones(4))
    assert twin != data
    assert twin.M.isIdentity()
    assert not data.joints[0].M.isIdentity()
    np.testing.assert_allclose(data.S @ np.ones(4), data.v.vector, atol=1e-12)


def test_what_the_world_carries_counts_the_first_joint(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    pin.forwardKinematics(model, data, np.zeros(6))
    whole = pin.computeSupportedInertiaByFrame(model, data, 0, True)
    assert whole.mass == pytest.approx(pin.computeTotalMass(model))


def test_impossible_settings_are_refused(pin: Any) -> None:
    assert pin.sharedMemory()
    with pytest.raises(InputError, match="live references"):
        pin.sharedMemory(False)
    with pytest.raises(InputError, match="URDF"):
        pin.RobotWrapper().initFromSDF("robot.sdf")
    with pytest.raises(InputError, match="LOCAL, WORLD"):
        model = pin.buildSampleModelManipulator()
        pin.computeJointKinematicRegressor(model, model.createData(), 1, 0)


def test_data_of_other_pairs_are_refused(pin: Any, arm: Any) -> None:
    _, _, geometries, places = arm
    geometries = geometries.copy()
    geometries.removeCollisionPair(geometries.collisionPairs[0])
    with pytest.raises(InputError, match="Make a new one"):
        pin.computeCollisions(geometries, places)
    with pytest.raises(InputError, match="twice"):
        pin.CollisionPair(1, 1)
    with pytest.raises(InputError, match="no geometry -1"):
        pin.CollisionPair(-1, 1)


def test_a_request_that_is_passed_and_arguments_by_name(pin: Any, arm: Any) -> None:
    _, _, geometries, places = arm
    near = pin.coal.CollisionRequest()
    near.security_margin = 9.0
    assert all(
        pin.computeCollision(geometries, places, k, near) for k in range(len(geometries.collisionPairs))
    )
    assert pin.computeCollisions(geometry_model=geometries, geometry_data=places) == pin.computeCollisions(
        geometries, places
    )
    with pytest.raises(InputError, match=r"computeCollisions was given 1 arguments, and places; expected \("):
        pin.computeCollisions(geometries, places=places)


def test_lists_of_a_size(pin: Any) -> None:
    forces = pin.StdVec_Force(3, pin.Force(np.arange(6.0)))
    forces[0].linear = np.ones(3)
    np.testing.assert_array_equal(forces[1].vector, np.arange(6.0))
    assert len(pin.StdVec_Force(forces)) == 3
    copied = forces.copy()
    copied[0].linear = np.zeros(3)
    np.testing.assert_array_equal(forces[0].linear, np.ones(3))
    with pytest.raises(OverflowError, match="size"):
        pin.StdVec_Force(2**70, pin.Force())


def test_joints_that_roll_on_an_ellipsoid(pin: Any) -> None:
    joint = pin.JointModelEllipsoid(0.1, 0.2, 0.3)
    joint.radius_y = 0.4
    assert (joint.radius_x, joint.radius_y, joint.radius_z, joint.nq, joint.nv) == (0.1, 0.4, 0.3, 3, 3)
    assert joint != pin.JointModelEllipsoid(0.1, 0.2, 0.3)
    with pytest.raises(TypeError, match="three radii"):
        pin.JointModelEllipsoid(0.1)
    model = pin.Model()
    model.addJoint(0, joint, pin.SE3.Identity(), "rolls")
    model.appendBodyToJoint(1, pin.Inertia.Random(), pin.SE3.Identity())
    data, (q, v, a) = model.createData(), np.random.default_rng(4).uniform(-1.0, 1.0, (3, 3))
    assert isinstance(joint.createData(), pin.JointDataEllipsoid)
    pin.forwardKinematics(model, data, q, v)
    x, y, z = (pin.AngleAxis(angle, axis).matrix() for angle, axis in zip(q, np.eye(3), strict=True))
    R = x @ y @ z
    np.testing.assert_allclose(data.oMi[1].rotation, R, atol=1e-14)
    np.testing.assert_allclose(data.oMi[1].translation, R[:, 2] * (0.1, 0.4, 0.3), atol=1e-14)
    np.testing.assert_allclose(data.v[1].vector, data.joints[1].S @ v, atol=1e-14)
    tau = pin.rnea(model, data, q, v, a)
    np.testing.assert_allclose(pin.aba(model, data, q, v, tau), a, atol=1e-9)
    again = pin.Model()
    again.loadFromString(model.saveToString())
    assert again.joints[1] == model.joints[1]


def test_fields_of_a_data_are_there_or_the_nearest_is_named(pin: Any) -> None:
    data = pin.buildSampleModelManipulator().createData()
    with pytest.raises(AttributeError, match="'oMi'"):
        data.oMI
    assert not np.array(data.oL).any() and not np.array(data.vxI).any() and (data.q_in == 0.0).all()
    assert copy.deepcopy(data).M.shape == (6, 6)


def test_data_can_be_made_without_a_model_and_loaded(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, loaded, q = model.createData(), pin.Data(), np.linspace(0.1, 0.6, 6)
    pin.forwardKinematics(model, data, q)
    assert len(loaded.oMi) == 1
    loaded.loadFromString(data.saveToString())
    assert loaded.oMi[3] == data.oMi[3]
    np.testing.assert_array_equal(pin.rnea(model, loaded, q, q, q), pin.rnea(model, data, q, q, q))


def test_motions_and_forces_are_divided_by_numbers_and_as_arrays_by_arrays(pin: Any) -> None:
    numbers = np.arange(1.0, 7.0)
    for kind in (pin.Motion, pin.Force):
        np.testing.assert_array_equal((kind(numbers) / 2).vector, numbers / 2.0)
        np.testing.assert_array_equal(kind(numbers) / numbers, np.ones(6))
        np.testing.assert_array_equal(kind(numbers) / np.ones((3, 1)), np.tile(numbers, (3, 1)))
        with pytest.raises(TypeError):
            kind(numbers) / "2"


def test_configurations_of_a_model_are_arrays_however_they_are_given(pin: Any) -> None:
    configurations = pin.buildSampleModelManipulator().referenceConfigurations
    configurations.update({"a": [1.0, 2.0]}, b=np.ones((3, 1)))
    configurations |= {"c": (4, 5)}
    assert configurations.setdefault("a", [7.0]).tolist() == [1.0, 2.0]
    assert configurations.setdefault("d", [7.0]).tolist() == [7.0]
    assert {key: q.tolist() for key, q in configurations.items()} == {
        "a": [1.0, 2.0], "b": [1.0, 1.0, 1.0], "c": [4.0, 5.0], "d": [7.0]
    }  # fmt: skip
    assert configurations == copy.deepcopy(configurations) != {"a": np.ones(2)}
    with pytest.raises(InputError, match="matrix"):
        configurations["matrix"] = np.ones((2, 2))


def test_pairs_of_geometries_stay_pairs_in_files_and_copies(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    geometries = pin.buildSampleGeometryModelManipulator(model)
    geometries.addAllCollisionPairs()
    loaded = pin.GeometryModel()
    loaded.loadFromString(geometries.saveToString())
    for one in (loaded, pickle.loads(pickle.dumps(geometries)), copy.deepcopy(geometries)):
        assert one == geometries
        assert pickle.loads(pickle.dumps(list(one.collisionPairs))) == list(geometries.collisionPairs)
        with pytest.raises(TypeError, match="CollisionPair"):
            one.collisionPairs.append((0, 1))
        one.addGeometryObject(geometries.geometryObjects[0])
        assert one.ngeoms == geometries.ngeoms + 1
    data = pickle.loads(pickle.dumps(geometries.createData()))
    data.activeCollisionPairs = [False] * len(geometries.collisionPairs)
    data.activeCollisionPairs[0] = 1
    assert data.activeCollisionPairs[0] is True and not any(list(data.activeCollisionPairs)[1:])
    with pytest.raises(TypeError, match="True or False"):
        data.activeCollisionPairs[0] = "no"


def test_a_visualizer_of_ones_own_keeps_its_own_viewer(pin: Any) -> None:
    from pinocchio.visualize import BaseVisualizer

    class Own(BaseVisualizer):
        def initViewer(self) -> None:
            self.viewer = "a window"

    model = pin.buildSampleModelManipulator()
    own = Own(model, None, pin.buildSampleGeometryModelManipulator(model))
    own.initViewer()
    assert own.viewer == "a window"
    with pytest.raises(InputError, match="a window"):
        BaseVisualizer(model).viewer = "a window"
