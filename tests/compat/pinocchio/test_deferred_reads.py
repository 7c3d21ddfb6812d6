"""Fields that an algorithm leaves to be computed when they are read: by one native call, with the same numbers."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.compiler.runtime.repeated_calls import forget


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _algorithms(pin: Any) -> list[Callable[..., Any]]:
    return [
        lambda m, d, q, v, a: pin.forwardKinematics(m, d, q),
        lambda m, d, q, v, a: pin.forwardKinematics(m, d, q, v),
        lambda m, d, q, v, a: pin.forwardKinematics(m, d, q, v, a),
        lambda m, d, q, v, a: pin.rnea(m, d, q, v, a),
        lambda m, d, q, v, a: pin.aba(m, d, q, v, a),
        lambda m, d, q, v, a: pin.crba(m, d, q),
        lambda m, d, q, v, a: pin.nonLinearEffects(m, d, q, v),
        lambda m, d, q, v, a: pin.computeGeneralizedGravity(m, d, q),
        lambda m, d, q, v, a: pin.computeJointTorqueRegressor(m, d, q, v, a),
        lambda m, d, q, v, a: pin.computeAllTerms(m, d, q, v),
        lambda m, d, q, v, a: pin.ccrba(m, d, q, v),
    ]


def _reads(pin: Any) -> list[Callable[[Any, Any], Any]]:
    def placements(model: Any, data: Any) -> Any:
        pin.updateGlobalPlacements(model, data)
        return [M.homogeneous for M in data.oMi]

    fields = ("v", "a", "a_gf", "f", "h", "ov", "oa", "of", "oh")
    return [
        placements,
        lambda m, d: pin.getVelocity(m, d, 3).vector,
        lambda m, d: pin.getVelocity(m, d, 3, pin.WORLD).vector,
        lambda m, d: pin.getAcceleration(m, d, 4).vector,
        lambda m, d: pin.getClassicalAcceleration(m, d, 4, pin.LOCAL_WORLD_ALIGNED).vector,
        lambda m, d: pin.getFrameVelocity(m, d, 5).vector,
        lambda m, d: pin.getFrameVelocity(m, d, 3, pin.SE3(np.eye(3), np.ones(3)), pin.WORLD).vector,
        lambda m, d: pin.jointBodyRegressor(m, d, 4),
        lambda m, d: pin.frameBodyRegressor(m, d, 6),
        *(lambda m, d, field=field: [x.vector for x in getattr(d, field)] for field in fields),
        lambda m, d: [M.homogeneous for M in d.liMi],
        *(lambda m, d, field=field: list(getattr(d, field)) for field in ("com", "vcom")),
    ]


def _answer(read: Any, model: Any, data: Any) -> Any:
    try:
        return np.array(read(model, data))
    except Exception as error:
        return type(error).__name__, str(error)


def _forgotten(data: Any) -> Any:
    """The Data, in which nothing that is read is bound."""
    forget(data)
    data._bound_at.clear()
    data._bound_reads.clear()
    return data


@pytest.mark.parametrize("changing", [False, True])
def test_reads_are_those_of_a_data_that_binds_nothing(pin: Any, changing: bool) -> None:
    """After algorithms in any order, whatever was read before, and whether numbers of the model change meanwhile."""
    model, rng = pin.buildSampleModelManipulator(), np.random.default_rng(5)
    data, other = model.createData(), model.createData()
    algorithms, reads = _algorithms(pin), _reads(pin)
    states = rng.uniform(-1.0, 1.0, (3, 6))
    for data_of in (data, other):  # beyond the first calls, and with everything stored
        for algorithm in algorithms * 11:
            algorithm(model, data_of, *states)
    for _ in range(400):
        algorithm, states = rng.choice(np.array(algorithms)), rng.uniform(-1.0, 1.0, (3, 6))
        for one in (data, other):
            algorithm(model, one, *states)
        if changing and rng.random() < 0.1:
            model.inertias[int(rng.integers(1, 7))].mass = rng.uniform(1.0, 3.0)
            model.gravity.linear[2] = -rng.uniform(1.0, 10.0)
        for k in rng.choice(len(reads), rng.integers(1, 4)):
            own, wanted = _answer(reads[k], model, data), _answer(reads[k], model, _forgotten(other))
            if isinstance(wanted, tuple):
                assert own == wanted
            else:
                np.testing.assert_allclose(own, wanted, rtol=1e-9, atol=1e-11)


@pytest.mark.usefixtures("compiled_at_once")
def test_reads_keep_no_data_alive(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, states = model.createData(), np.random.default_rng(2).uniform(-1.0, 1.0, (3, 6))
    for _ in range(15):
        for algorithm in _algorithms(pin):
            algorithm(model, data, *states)
            for read in _reads(pin):
                _answer(read, model, data)
    assert data._bound_reads
    gone = weakref.ref(data)
    del data
    gc.collect()
    assert gone() is None


@pytest.mark.usefixtures("compiled_at_once")
def test_a_read_field_is_of_the_numbers_at_the_time_of_the_call(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, (q, v, a) = model.createData(), np.random.default_rng(2).uniform(-1.0, 1.0, (3, 6))
    for _ in range(15):
        pin.rnea(model, data, q, v, a)
        wanted = data.f[3].vector.copy()
    assert data._bound_reads
    pin.rnea(model, data, q, v, a)
    model.inertias[4].mass *= 2.0
    np.testing.assert_allclose(data.f[3].vector, wanted, rtol=1e-12)
    pin.rnea(model, data, q, v, a)
    assert not np.allclose(data.f[3].vector, wanted)


def test_classical_accelerations_have_the_velocities_of_the_last_algorithm(pin: Any) -> None:
    """As in Pinocchio, where rnea leaves velocities and no accelerations."""
    model = pin.buildSampleModelManipulator()
    data, (q, v, a) = model.createData(), np.random.default_rng(2).uniform(-1.0, 1.0, (3, 6))
    for k in range(1, 5):
        pin.forwardKinematics(model, data, q, v, a)
        pin.rnea(model, data, q, k * v, a)
        found = pin.getClassicalAcceleration(model, data, 5)
        velocity, acceleration = pin.getVelocity(model, data, 5), pin.getAcceleration(model, data, 5)
        np.testing.assert_allclose(
            found.linear, pin.classicAcceleration(velocity, acceleration), rtol=1e-12, atol=1e-12
        )


@pytest.mark.usefixtures("compiled_at_once")
@pytest.mark.parametrize("massless", [(), (6,), (5, 6), (2,)])
def test_centres_of_mass_of_subtrees(pin: Any, massless: tuple[int, ...]) -> None:
    """In the frame of each joint, and their rates; joints that move no mass keep what they have."""
    model = pin.buildSampleModelManipulator()
    for i in massless:
        model.inertias[i] = pin.Inertia.Zero()
    data, (q, v, a) = model.createData(), np.random.default_rng(2).uniform(-1.0, 1.0, (3, 6))
    bodies = model.createData()
    for k in range(1, 5):
        pin.centerOfMass(model, data, q, k * v, a)
        pin.forwardKinematics(model, bodies, q, k * v, a)
        for i in range(1, 7):
            subtree = [j for j in range(i, 7) if model.inertias[j].mass]
            found = [data.com[i], data.vcom[i], data.acom[i]]
            if not subtree:
                assert not np.any(found)
                continue
            mass = sum(model.inertias[j].mass for j in subtree)
            sums = np.zeros((3, 3))
            for j in subtree:
                M, body, V = bodies.oMi[j], model.inertias[j], bodies.v[j]
                point = pin.SE3(np.eye(3), body.lever)
                rate = M.rotation @ point.actInv(V).linear
                gain = M.rotation @ pin.classicAcceleration(V, bodies.a[j], point)
                sums += body.mass * np.array([M.act(body.lever), rate, gain])
            wanted = [bodies.oMi[i].actInv(sums[0] / mass), *(sums[1:] / mass) @ bodies.oMi[i].rotation]
            np.testing.assert_allclose(found, wanted, rtol=1e-10, atol=1e-12)


@pytest.mark.usefixtures("compiled_at_once")
def test_the_reference_frame_may_be_left_out_without_python(
    pin: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once a kernel is noted, neither the function nor its table is asked again."""
    from ulna.compiler.runtime import repeated_calls

    model = pin.buildSampleModelManipulator()
    data, (q, v, a) = model.createData(), np.random.default_rng(2).uniform(-1.0, 1.0, (3, 6))
    calls = (pin.getVelocity, pin.getAcceleration, pin.getClassicalAcceleration, pin.jointBodyRegressor)
    pin.forwardKinematics(model, data, q, v, a)
    for _ in range(repeated_calls._SKIPPED + 1):  # a row that replaces one of another test comes so late
        for algorithm in (pin.rnea, pin.computeJointTorqueRegressor, pin.rnea):
            algorithm(model, data, q, v, a)
            for call in calls:
                call(model, data, 3)
    noted: list[Any] = []
    monkeypatch.setattr(repeated_calls._Table, "put", lambda *arguments: noted.append(arguments))
    for _ in range(3):
        pin.rnea(model, data, q, v, a)
        for call in calls:
            call(model, data, 3)
    assert not noted or repeated_calls._own_type() is None
