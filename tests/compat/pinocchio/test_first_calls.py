"""First calls of a model compile nothing, and answer what is compiled later."""

from __future__ import annotations

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


@pytest.fixture
def frequent(pin: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The usual mode, as in a process where nothing was compiled yet; the class that counts."""
    from pinocchio._model.first_calls import FirstCalls

    monkeypatch.delenv("ULNA_COMPILE", raising=False)
    monkeypatch.setattr(FirstCalls, "_compiled_models", 0)
    return FirstCalls


def _tree(pin: Any) -> Any:
    """A model with joints of all kinds, branches, a mimic joint, armature, and gravity along no axis."""
    pin.seed(3)
    kinds = [
        pin.JointModelFreeFlyer(),
        pin.JointModelRX(),
        pin.JointModelComposite(pin.JointModelPZ(), pin.SE3.Random()).addJoint(
            pin.JointModelRY(), pin.SE3.Random()
        ),
        pin.JointModelPlanar(),
        pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.6, 0.8])),
        pin.JointModelSpherical(),
        pin.JointModelHelicalUnaligned(np.array([0.6, 0.0, 0.8]), 0.3),
        pin.JointModelRUBZ(),
        pin.JointModelTranslation(),
        pin.JointModelPrismaticUnaligned(np.array([0.6, 0.8, 0.0])),
        pin.JointModelSphericalZYX(),
        pin.JointModelRZ(),
    ]
    model = pin.Model()
    for k, kind in enumerate(kinds):
        joint = model.addJoint([0, 1, 2, 2, 1, 4, 5, 0, 8, 9, 8, 2][k], kind, pin.SE3.Random(), f"joint {k}")
        model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Random())
        model.addFrame(pin.Frame(f"frame {k}", joint, 0, pin.SE3.Random(), pin.OP_FRAME))
    model._make_mimic(2, 12, -0.7, 0.2)
    model.armature[:] = np.linspace(0.1, 0.5, model.nv)
    model.gravity.linear[:] = 1.0, -2.0, 3.0
    model.inertias[0] = pin.Inertia.Random()
    return model


def _state(pin: Any, model: Any) -> dict[str, Any]:
    rng = np.random.default_rng(0)
    q = pin.integrate(model, pin.neutral(model), rng.uniform(-1.0, 1.0, model.nv))
    v, a, tau = rng.normal(size=(3, model.nv))
    return {"q": q, "v": v, "a": a, "t": tau, "f": rng.normal(size=(model.njoints - 1, 6))}


def test_tables_of_joints_give_what_the_algorithms_give(pin: Any) -> None:
    from pinocchio._data.algorithm import ALGORITHMS
    from pinocchio._data.evaluated_model import EvaluatedModel, evaluator_of
    from pinocchio._tables.fields import FIELDS, TableFields

    model = _tree(pin)
    data, state, moment = model.createData(), _state(pin, model), EvaluatedModel(model)
    evaluator = evaluator_of(model, data)
    evaluator.load(model)
    compared = 0
    for algorithm in ALGORITHMS:
        if not algorithm.fills or not algorithm.has_fields_in(FIELDS) or "constraint" in algorithm.name:
            continue
        if algorithm.kernel.__name__ == "not_applicable":
            continue
        inputs = {letter: state[letter] for letter in algorithm.inputs}
        models = (moment.model, moment.frames) if algorithm.depends_on == "frames" else (moment.model,)
        wanted = algorithm.kernel(*models)(*inputs.values())
        wanted = wanted if isinstance(wanted, tuple) else (wanted,)
        fields = TableFields(evaluator, model, inputs)
        for name, values in zip(algorithm.fills, wanted, strict=True):
            scale = max(1.0, float(np.abs(np.asarray(values, float)).max()))
            np.testing.assert_allclose(
                fields.field(name), values, rtol=0, atol=1e-11 * scale, err_msg=f"{algorithm.name} {name}"
            )
            compared += 1
    assert compared > 80


def test_fields_that_are_computed_when_read_are_those_of_the_algorithms(pin: Any) -> None:
    from pinocchio._data import deferred_fields
    from pinocchio._data.compiled_fields import split_forces
    from pinocchio._data.evaluated_model import EvaluatedModel
    from pinocchio._tables import deferred

    model = _tree(pin)
    data, state, moment = model.createData(), _state(pin, model), EvaluatedModel(model)
    for table, functions, letters in (
        (deferred.joint_placements, deferred_fields._joint_placements, "q"),
        (deferred.velocities, deferred_fields._body_velocities, "qv"),
        (deferred.accelerations, deferred_fields._body_accelerations, "qva"),
        (deferred.dynamics, deferred_fields._body_dynamics, "qva"),
        (deferred.dynamics, deferred_fields._body_dynamics, "qvaf"),
        (deferred.subtree_momenta, deferred_fields._subtree_momenta, "qva"),
    ):
        inputs = [state[letter] for letter in letters]
        own = table(moment.evaluator(data), *inputs)
        forces = split_forces(inputs.pop()) if "f" in letters else None
        for name, compute in functions(moment.model, *inputs, forces).items():
            wanted = compute()
            np.testing.assert_allclose(own[name], wanted, rtol=0, atol=1e-11 * max(1.0, np.abs(wanted).max()))


@pytest.mark.parametrize("name", ["LOCAL", "WORLD", "LOCAL_WORLD_ALIGNED"])
def test_jacobians_of_frames_are_those_of_the_algorithms(pin: Any, monkeypatch: Any, name: str) -> None:
    from pinocchio._containers.enums import reference_of
    from pinocchio._model.compiled_model import fixed_frames
    from pinocchio._model.core_model import core_model

    from ulna import algorithms

    monkeypatch.setenv("ULNA_COMPILE", "never")
    model = _tree(pin)
    data, state, reference = model.createData(), _state(pin, model), getattr(pin, name)
    q, v, key = state["q"], state["v"], model.nframes - 1
    core, frame = core_model(model), fixed_frames(model)[key]
    wanted = algorithms.frame_jacobian(core, q, frame, reference_of(reference))
    np.testing.assert_allclose(pin.computeFrameJacobian(model, data, q, key, reference), wanted, atol=1e-12)
    pin.computeJointJacobiansTimeVariation(model, data, q, v)
    np.testing.assert_allclose(pin.getFrameJacobian(model, data, key, reference), wanted, atol=1e-12)
    rate = algorithms.frame_jacobian_dot(core, q, v, frame, reference_of(reference))
    np.testing.assert_allclose(
        pin.getFrameJacobianTimeVariation(model, data, key, reference), rate, atol=1e-11
    )


def test_many_models_are_called_without_compiling(pin: Any, frequent: Any, monkeypatch: Any) -> None:
    monkeypatch.setattr(pin._model.compiled_model, "compile_function", None)
    for _ in range(3):
        model = pin.buildSampleModelHumanoidRandom()
        data, q, v = model.createData(), pin.neutral(model), np.ones(model.nv)
        for _ in range(10):
            tau = pin.rnea(model, data, q, v, v)
        pin.forwardKinematics(model, data, q, v, v)
        pin.computeJointJacobians(model, data, q)
        M, h = pin.crba(model, data, q), pin.nle(model, data, q, v)
        np.testing.assert_allclose(M @ v + h, tau, atol=1e-9)
        np.testing.assert_allclose(pin.aba(model, data, q, v, tau), v, atol=1e-7)
        assert np.isfinite(np.array([force.vector for force in data.f])).all()


def test_first_calls_under_constraints_are_those_of_compiled_ones(pin: Any, frequent: Any) -> None:
    model = pin.buildSampleModelManipulator()
    q, v = np.linspace(0.1, 0.6, 6), np.linspace(-1.0, 1.0, 6)
    held = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 5, pin.LOCAL)
    held.setBaumgarteCorrectorParameters(pin.BaumgarteCorrectorParameters(3.0, 2.0))
    settings, found = pin.ProximalSettings(1e-9, 1e-4, 5), []
    for _ in range(2):  # evaluated, then compiled
        data, known = model.createData(), held.createData()
        pin.constraintDynamics(model, data, q, v, v, [held], [known], settings)
        pin.computeConstraintDynamicsDerivatives(model, data, [held], [known], settings)
        here = [
            data.ddq.copy(),
            data.lambda_c.copy(),
            data.nle.copy(),
            data.J.copy(),
            data.oMi[3].homogeneous,
        ]
        here += [data.ddq_dq.copy(), data.dlambda_dv.copy(), data.dAdq.copy(), known.contact_force.vector]
        after = pin.impulseDynamics(model, data, q, v, [held], [known], 0.3, settings)
        found.append([*here, after, data.impulse_c.copy()])
    assert frequent._compiled_models == 1
    for first, compiled in zip(*found, strict=True):
        np.testing.assert_allclose(first, compiled, rtol=1e-9, atol=1e-9)


def test_what_is_called_often_is_compiled(pin: Any, frequent: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    results = [pin.nle(model, data, q, q) for _ in range(14)]
    assert "nonLinearEffects" in vars(data._bound) and "rnea" not in vars(data._bound)
    assert np.array_equal(results[-1], results[-2]) and frequent._compiled_models == 1
    np.testing.assert_allclose(results[0], results[-1], rtol=1e-13)


def test_each_compiled_model_doubles_how_often_the_next_is_called_first(frequent: Any) -> None:
    def calls(counts: Any, function: str) -> int:
        k = 0
        while counts.includes(function, 10):
            k += 1
        return k

    first, second, third = frequent(), frequent(), frequent()
    assert calls(first, "rnea") == 10 and calls(second, "rnea") == 20 and calls(second, "aba") == 20
    assert calls(third, "rnea") == 40 and calls(first, "aba") == 10  # a model keeps its number
    assert frequent._compiled_models == 3


def test_the_environment_says_when_models_are_compiled(pin: Any, frequent: Any, monkeypatch: Any) -> None:
    counts = frequent()
    monkeypatch.setenv("ULNA_COMPILE", "first")
    assert not counts.includes("rnea", 10)
    monkeypatch.setenv("ULNA_COMPILE", "never")
    assert all(counts.includes("rnea", 1) for _ in range(5))
    monkeypatch.setenv("ULNA_COMPILE", "somtimes")
    with pytest.warns(UserWarning, match="'somtimes'; expected one of frequent, first, never"):
        assert counts.includes("rnea", 1)


def test_accelerations_without_inertia_are_refused_as_when_compiled(pin: Any, frequent: Any) -> None:
    model = pin.Model()
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "loose")
    data = model.createData()
    with pytest.raises(Exception, match="without bound"):
        pin.aba(model, data, np.zeros(1), np.zeros(1), np.zeros(1))


def test_models_of_the_same_joints_share_what_depends_on_them_alone(pin: Any) -> None:
    one, other = pin.buildSampleModelHumanoidRandom(), pin.buildSampleModelHumanoidRandom()
    assert one._compiled_structure() is other._compiled_structure()
    assert one.copy()._compiled_structure() is one._compiled_structure()
    assert pin.buildSampleModelManipulator()._compiled_structure() is not one._compiled_structure()


def test_functions_of_configurations_take_lists_and_columns(pin: Any) -> None:
    model = _tree(pin)
    q, rest = _state(pin, model)["q"], pin.neutral(model)
    column = np.stack([q, q], axis=1)[:, 0]
    assert not column.flags.c_contiguous
    for at in (q, list(q), column):
        assert pin.distance(model, at, rest) == pytest.approx(np.linalg.norm(pin.difference(model, q, rest)))
        np.testing.assert_allclose(pin.normalize(model, at), q, atol=1e-15)
        assert pin.squaredDistance(model, at, rest).sum() == pytest.approx(pin.distance(model, q, rest) ** 2)
    rest[0] = 5.0
    assert pin.neutral(model)[0] == 0.0
    for function in (pin.neutral, pin.normalize, pin.distance):
        with pytest.raises(TypeError, match="expected a pinocchio.Model"):
            function(3, q, q) if function is pin.distance else function(3, *[q] * (function is pin.normalize))


def test_each_link_of_the_core_model_hangs_on_its_joint(pin: Any) -> None:
    from pinocchio._model.core_model import core_model

    core = core_model(pin.buildSampleModelManipulator())
    joints = list(range(-1, len(core.joints)))  # -1 is the world
    assert [link.joint for link in core.links] == [frame.joint for frame in core.frames] == joints
    assert [joint.parent for joint in core.joints] == joints[:-1]
