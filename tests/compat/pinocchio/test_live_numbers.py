"""A number of a model that changes is noticed by the very next call, whoever changed it, and by whatever reference."""

from __future__ import annotations

import gc
import sys
import weakref
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


@pytest.fixture(autouse=True, params=["first", "never"])
def _mode(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Everything is compiled, or everything is evaluated."""
    monkeypatch.setenv("ULNA_COMPILE", request.param)


@pytest.fixture
def model(pin: Any) -> Any:
    made = pin.Model()
    joint = 0
    for k, kind in enumerate((pin.JointModelRY, pin.JointModelPZ, pin.JointModelSpherical)):
        joint = made.addJoint(joint, kind(), pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3])), f"j{k}")
        made.appendBodyToJoint(joint, pin.Inertia.FromBox(1.0 + k, 0.2, 0.3, 0.4), pin.SE3.Identity())
        made.addJointFrame(joint)
    made.addFrame(pin.Frame("tip", joint, 0, pin.SE3(np.eye(3), np.ones(3)), pin.OP_FRAME))
    return made


def _state(pin: Any, model: Any) -> tuple[Any, ...]:
    q = pin.integrate(model, pin.neutral(model), np.linspace(0.2, 0.9, model.nv))
    return (q, *np.random.default_rng(0).normal(size=(3, model.nv)))


def _all(pin: Any, model: Any, data: Any) -> dict[str, Any]:
    """What every bound algorithm answers."""
    q, v, a, tau = _state(pin, model)
    tip = model.nframes - 1
    found = {"rnea": pin.rnea(model, data, q, v, a)}
    found["f"] = np.array([f.vector for f in data.f[1:]])  # rnea leaves that of the universe, as in Pinocchio
    found |= {"aba": pin.aba(model, data, q, v, tau), "crba": pin.crba(model, data, q)}
    found |= {"nle": pin.nle(model, data, q, v), "g": pin.computeGeneralizedGravity(model, data, q)}
    found |= {"Minv": pin.computeMinverse(model, data, q), "C": pin.computeCoriolisMatrix(model, data, q, v)}
    found["by q"], found["by v"], _ = pin.computeRNEADerivatives(model, data, q, v, a)
    found["ddq by q"], found["ddq by v"], _ = pin.computeABADerivatives(model, data, q, v, tau)
    found |= {
        "com": pin.centerOfMass(model, data, q, v, a),
        "vcom": data.vcom[0].copy(),
        "acom": data.acom[0].copy(),
    }
    found |= {
        "mass": np.array(list(data.mass)),
        "com 2": data.com[2].copy(),
        "Jcom": pin.jacobianCenterOfMass(model, data, q),
    }
    found |= {"Ag": pin.computeCentroidalMap(model, data, q), "dAg": pin.dccrba(model, data, q, v)}
    found |= {"hg": pin.computeCentroidalMomentum(model, data, q, v).vector.copy(), "Ig": data.Ig.inertia}
    found |= {
        "K": pin.computeKineticEnergy(model, data, q, v),
        "P": pin.computePotentialEnergy(model, data, q),
    }
    pin.forwardKinematics(model, data, q, v, a)
    found |= {"v": np.array([m.vector for m in data.v]), "a": np.array([m.vector for m in data.a])}
    found |= {"liMi": np.array([M.homogeneous for M in data.liMi])}
    pin.framesForwardKinematics(model, data, q)
    found["oMf"] = np.array([M.homogeneous for M in data.oMf])
    found |= {
        "J": pin.computeJointJacobians(model, data, q),
        "J tip": pin.getFrameJacobian(model, data, tip, pin.LOCAL),
    }
    found |= {"dJ": pin.computeJointJacobiansTimeVariation(model, data, q, v)}
    pin.computeAllTerms(model, data, q, v)
    return found | {"all M": data.M.copy(), "all nle": data.nle.copy(), "all dJ": data.dJ.copy()}


def _few(pin: Any, model: Any, data: Any) -> dict[str, Any]:
    """What an algorithm of each kind answers: of placements, of all numbers, of all frames, of one frame."""
    q, v, a, _ = _state(pin, model)
    found = {"rnea": pin.rnea(model, data, q, v, a), "crba": pin.crba(model, data, q)}
    pin.framesForwardKinematics(model, data, q)
    found |= {"oMi": data.oMi[3].homogeneous, "oMf": data.oMf[-1].homogeneous}
    found |= {"J": pin.computeJointJacobians(model, data, q)}
    return found | {"J tip": pin.getFrameJacobian(model, data, model.nframes - 1, pin.LOCAL)}


def _set(path: str, change: Callable[[Any], Any]) -> Callable[[Any, Any], None]:
    def act(pin: Any, model: Any) -> None:
        owner, _, name = path.rpartition(".")
        names = {"model": model, "pin": pin}
        holder = eval(owner, names)
        setattr(holder, name, change(getattr(holder, name)))

    act.__name__ = path
    return act


def _add(path: str, step: float = 0.25) -> Callable[[Any, Any], None]:
    def act(pin: Any, model: Any) -> None:
        exec(f"{path} += {step}", {"model": model, "pin": pin, "np": np})

    act.__name__ = path
    return act


CHANGES = (
    _set("model.inertias[2].mass", lambda m: 2.0 * m),
    _set("model.inertias[1].inertia", lambda i: 2.0 * i),
    _set("model.inertias[3].lever", lambda c: c + 0.1),
    _add("model.inertias[3].lever[1]"),
    _add("model.jointPlacements[2].translation[0]"),
    _add("model.jointPlacements[1].translation[2]"),
    _add("model.armature[2]"),
    _add("model.armature[:]"),
    _set("model.armature", lambda a: a + 0.5),
    _add("model.gravity.linear[0]"),
    _set("model.gravity.linear", lambda g: -g),
    _add("model.gravity.vector[2]"),
    _add("model.frames[-1].placement.translation[1]"),
)


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__)
def test_a_changed_number_changes_what_bound_algorithms_answer(pin: Any, model: Any, change: Any) -> None:
    data = model.createData()
    before = _few(pin, model, data)
    assert _same(before, _few(pin, model, data)) == set()
    change(pin, model)
    after = _few(pin, model, data)
    fresh = _few(pin, model.copy(), model.copy().createData())
    assert _same(after, fresh) == set()
    assert _same(after, before)  # something did change


def _same(a: dict[str, Any], b: dict[str, Any]) -> set[str]:
    """What differs."""
    return {name for name in a if not np.allclose(a[name], b[name], rtol=1e-12, atol=1e-12)}


@pytest.mark.parametrize("states", [1, 5])
def test_gravity_with_an_angular_part_is_refused(pin: Any, model: Any, states: int) -> None:
    q, v, a, tau = _state(pin, model)
    data, calls = model.createData(), [lambda d: pin.rnea(model, d, q, v, a)]
    if states == 1:
        calls += [
            lambda d: pin.computeGeneralizedGravity(model, d, q),
            lambda d: pin.aba(model, d, q, v, tau),
            lambda d: pin.forwardDynamics(model, d, q, v, tau, np.eye(1, model.nv), np.zeros(1)),
        ]
    for k in range(states):  # from the fourth on, kernels read gravity at every call
        model.gravity.linear[0] = 0.1 * k
        usual = [call(data) for call in calls]
    free = _without_gravity(pin, model, q, v)
    expected = [call(data) for call in free]
    for call, wanted in zip(calls, usual, strict=True):
        np.testing.assert_array_equal(call(data), wanted)
        model.gravity.angular[1] = 0.5
        for each in (data, data, model.createData()):
            with pytest.raises(InputError, match=r"model.gravity.angular = np.zeros"):
                call(each)
        for each in (data, model.createData()):
            for other, same in zip(free, expected, strict=True):
                np.testing.assert_allclose(other(each), same, atol=1e-11)
        with pytest.raises(InputError, match="angular part"):
            model.ulna()
        model.gravity.angular[1] = 0.0
        np.testing.assert_array_equal(call(data), wanted)
    model.gravity = pin.Motion(np.array([0.0, 0.0, -9.81]), np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(model.gravity.angular, [1.0, 2.0, 3.0])
    with pytest.raises(InputError, match=r"angular part of model.gravity is \[1.0, 2.0, 3.0\]"):
        pin.rnea(model, data, q, v, a)
    with pytest.raises(InputError, match="angular part"):
        pin.computeStaticTorqueDerivatives(model, data, q, [pin.Force.Zero()] * model.njoints)
    with pytest.raises(InputError, match="angular part"):
        pin.rneaInParallel(1, pin.ModelPool(model, 1), q[:, None], v[:, None], a[:, None])
    model.gravity.angular = np.zeros(3)


def _without_gravity(pin: Any, model: Any, q: Any, v: Any) -> list[Any]:
    """Calls that do not read gravity."""

    def placed(data: Any) -> Any:
        pin.forwardKinematics(model, data, q, v)
        return data.oMi[model.njoints - 1].homogeneous

    return [
        placed,
        lambda d: pin.computeJointJacobians(model, d, q),
        lambda d: pin.crba(model, d, q),
        lambda d: pin.computeMinverse(model, d, q),
        lambda d: pin.computeCoriolisMatrix(model, d, q, v),
        lambda d: pin.ccrba(model, d, q, v),
        lambda d: pin.centerOfMass(model, d, q, v),
        lambda d: pin.computeKineticEnergy(model, d, q, v),
        lambda d: pin.jacobianCenterOfMass(model, d, q),
    ]


def test_references_held_since_before_the_first_call_are_live(pin: Any, model: Any) -> None:
    held = model.jointPlacements[2].translation, model.inertias[1], model.inertias[3].lever, model.armature
    place = model.frames[-1].placement.translation
    data = model.createData()
    before = _all(pin, model, data)
    held[0][0] += 0.3
    held[1].mass *= 3.0
    held[2][2] += 0.2
    held[3][0] += 0.7
    place[0] += 0.4
    after = _all(pin, model, data)
    assert _same(after, _all(pin, model.copy(), model.copy().createData())) == set()
    assert {"rnea", "crba", "oMf", "com", "J", "J tip"} <= _same(after, before)


def test_what_is_asked_late_belongs_to_the_numbers_of_its_time(pin: Any, model: Any) -> None:
    q, v, a, _ = _state(pin, model)
    data, other = model.createData(), model.copy()
    pin.rnea(model, data, q, v, a)
    pin.centerOfMass(model, data, q)
    model.inertias[2].mass *= 2.0
    model.jointPlacements[2].translation[0] += 1.0
    pin.crba(model, data, 0.0 * q + pin.neutral(model))  # of the new numbers, at another q
    wanted = other.createData()
    pin.rnea(other, wanted, q, v, a)
    pin.centerOfMass(other, wanted, q)
    for name in ("f", "h", "a_gf", "v"):
        for own, theirs in zip(getattr(data, name), getattr(wanted, name), strict=True):
            np.testing.assert_allclose(own.vector, theirs.vector, atol=1e-12)
    np.testing.assert_allclose(data.com[2], wanted.com[2], atol=1e-12)
    assert data.mass[2] == wanted.mass[2]


def test_one_data_may_serve_two_models_in_turns(pin: Any, model: Any) -> None:
    heavy, data = model.copy(), model.createData()
    heavy.inertias[3].mass = 9.0
    q, v, a, _ = _state(pin, model)
    for _ in range(3):
        for one in (model, heavy):
            np.testing.assert_array_equal(
                pin.rnea(one, data, q, v, a), pin.rnea(one, one.createData(), q, v, a)
            )


def test_frames_added_taken_away_and_renamed_are_noticed(pin: Any, model: Any) -> None:
    q = _state(pin, model)[0]
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    pin.framesForwardKinematics(model, data, q)
    grip = pin.Frame("grip", 1, 0, pin.SE3.Random(), pin.OP_FRAME)
    model.frames.append(grip)
    with pytest.raises(ValueError, match="createData"):
        pin.framesForwardKinematics(model, data, q)
    model.frames.pop()
    pin.framesForwardKinematics(model, data, q)
    model.frames[-1].parentJoint = 1
    pin.framesForwardKinematics(model, data, q)
    np.testing.assert_allclose(
        data.oMf[-1].homogeneous, (data.oMi[1] * model.frames[-1].placement).homogeneous, atol=1e-12
    )


def test_results_are_copies_and_blocks_are_live(pin: Any, model: Any) -> None:
    q, v, a, _ = _state(pin, model)
    data = model.createData()
    M, J, kept = data.M, data.J, data.oMi[3].translation
    first = pin.crba(model, data, q)
    columns = pin.computeJointJacobians(model, data, q)
    np.testing.assert_array_equal(M, first)
    np.testing.assert_array_equal(J, columns)
    np.testing.assert_array_equal(kept, data.oMi[3].translation)
    first[:], columns[:] = 0.0, 0.0
    assert M.any()
    assert J.any()
    tau = pin.rnea(model, data, q, v, a)
    pin.rnea(model, data, q, 2.0 * v, a)
    assert (tau != data.tau).any()
    np.testing.assert_allclose(
        pin.rnea(model, data, q, v, data.ddq), pin.rnea(model, data, q, v, 0.0 * a), rtol=1e-12
    )
    place = pin.updateFramePlacement(model, data, model.nframes - 1)
    place.translation[:] = 0.0
    assert data.oMf[-1].translation.any()


def test_data_is_freed(pin: Any, model: Any) -> None:
    data = model.createData()
    _all(pin, model, data)
    seen = weakref.ref(data)
    counts = [sys.getrefcount(x) for x in (model, None)]
    del data
    gc.collect()
    assert seen() is None
    assert sys.getrefcount(model) <= counts[0]


def test_arguments_to_be_converted_bind_nothing_anew(pin: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from pinocchio._algorithms import configurations
    from pinocchio._data import binding

    model = pin.buildSampleModelManipulator()
    data = model.createData()
    q = np.linspace(0.1, 0.6, 6)
    wanted = pin.rnea(model, data, q, q, q), pin.integrate(model, q, q)
    monkeypatch.setattr(binding, "_bind", None)
    monkeypatch.setattr(configurations, "BoundKernel", None)
    for given in (np.tile(q[:, None], 3)[:, 1], list(q), q.reshape(-1, 1)):
        assert np.array_equal(pin.rnea(model, data, given, given, given), wanted[0])
        assert np.array_equal(pin.integrate(model, given, given), wanted[1])


_ARM = """<robot name="two"><link name="base"/>
<link name="a"><inertial><mass value="1.5"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0 0 0.2"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="2" velocity="3"/></joint></robot>"""


def test_a_text_that_was_built_before_gives_a_model_of_its_own(pin: Any) -> None:
    first = pin.buildModelFromXML(_ARM)
    first.inertias[1].mass, first.jointPlacements[1].translation[2], first.names[1] = 9.0, 0.9, "other"
    first.upperPositionLimit[0], first.frames[2].name = 0.1, "changed"
    first.addFrame(pin.Frame("tool", 1, 0, pin.SE3.Identity(), pin.OP_FRAME))
    again = pin.buildModelFromXML(_ARM)
    assert again == pin.buildModelFromXML(_ARM) and again != first and again.nframes == first.nframes - 1
    assert (again.inertias[1].mass, again.jointPlacements[1].translation[2]) == (1.5, 0.2)
    assert (again.names[1], again.upperPositionLimit[0]) == ("j", 1.0)
    floating = pin.buildModelFromXML(_ARM, pin.JointModelFreeFlyer(), "root")
    assert floating.nq == 8 and floating.names[1] == "root" and again.nq == 1
    added = pin.buildModelFromXML(_ARM, pin.JointModelRX(), pin.Model())
    assert added.njoints == 3


def test_masses_are_those_of_the_moment(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    for k in range(8):
        model.inertias[3].mass = 1.0 + k
        total = sum(inertia.mass for inertia in list(model.inertias)[1:])
        assert pin.computeTotalMass(model) == pytest.approx(total)
        assert pin.computeTotalMass(model, data) == pytest.approx(total)
        model.inertias[6].mass = 2.0 + k
        pin.computeSubtreeMasses(model, data)
        assert data.mass[6] == pytest.approx(2.0 + k)
        assert data.mass[3] == pytest.approx(sum(inertia.mass for inertia in list(model.inertias)[3:]))
        assert data.mass[0] == data.mass[1]
    with pytest.raises(TypeError, match="model"):
        pin.computeTotalMass(3)


def test_regressors_of_bodies_follow_the_state_and_the_frame(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, rng = model.createData(), np.random.default_rng(2)
    last = model.nframes - 1
    for _ in range(4):
        q, v, a = rng.standard_normal((3, 6))
        pin.rnea(model, data, q, v, a)
        wanted = pin.bodyRegressor(data.v[6], data.a_gf[6])
        np.testing.assert_allclose(pin.jointBodyRegressor(model, data, 6), wanted, atol=1e-12)
        np.testing.assert_allclose(data.bodyRegressor, wanted, atol=1e-12)
        model.frames[last].placement.translation = rng.standard_normal(3)
        M = model.frames[last].placement
        placed = pin.bodyRegressor(M.actInv(data.v[6]), M.actInv(data.a_gf[6]))
        np.testing.assert_allclose(pin.frameBodyRegressor(model, data, last), placed, atol=1e-12)
        data.liMi[1].translation = rng.standard_normal(3)
        pin.updateGlobalPlacements(model, data)
        np.testing.assert_allclose(data.oMi[1].translation, data.liMi[1].translation, atol=1e-15)
