"""A model whose numbers change again and again: what Pinocchio answers, with nothing compiled anew, in the same memory."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.memory import least_growth
from support.two_pythons import both

pytestmark = pytest.mark.usefixtures("compiled_at_once")


def test_after_many_changes_answers_are_pinocchios(tmp_path: Path) -> None:
    pytest.importorskip("pinocchio")
    mine, theirs = both(Path(__file__).with_name("asked_changes.py"), tmp_path)
    for own, wanted in zip(mine, theirs, strict=True):
        for name, values in wanted.items():
            scale = max(1.0, float(np.abs(values).max()))
            np.testing.assert_allclose(own[name], values, rtol=0, atol=1e-9 * scale, err_msg=name)


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _changed(model: Any, k: int) -> None:
    model.inertias[2].mass = 1.0 + 0.01 * k
    model.jointPlacements[3].translation[1] = 0.01 * k
    model.gravity.linear[0] = 0.1 * k
    model.armature[1] = 0.2 * k
    model.frames[-1].placement.translation[2] = 0.03 * k


def _answers(pin: Any, model: Any, data: Any, q: Any) -> list[Any]:
    pin.framesForwardKinematics(model, data, q)
    J = pin.computeFrameJacobian(model, data, q, model.nframes - 1, pin.LOCAL)
    place = data.oMf[-1].homogeneous.copy()
    return [pin.rnea(model, data, q, q, q), pin.aba(model, data, q, q, q), J, place, pin.crba(model, data, q)]


def test_nothing_is_compiled_once_numbers_keep_changing(pin: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    for k in range(6):
        _changed(model, k)
        _answers(pin, model, data, q)
    other = model.copy()
    with monkeypatch.context() as patch:
        patch.setattr(pin._model.compiled_model, "compile_function", None)
        patch.setattr(pin._model.compiled_model, "core_model", None)
        for k in range(6, 40):
            _changed(model, k)
            found = _answers(pin, model, data, q)
    _changed(other, 39)
    for own, wanted in zip(found, _answers(pin, other, other.createData(), q), strict=True):
        np.testing.assert_allclose(own, wanted, rtol=1e-12, atol=1e-12)


def test_changed_numbers_are_read_by_native_calls_alone(pin: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    for k in range(6):
        _changed(model, k)
        _answers(pin, model, data, q)
    monkeypatch.setattr(pin._algorithms.dynamics, "run", None)
    monkeypatch.setattr(pin._algorithms.kinematics, "run", None)
    for k in range(6, 12):
        _changed(model, k)
        tau = pin.rnea(model, data, q, q, q)
        pin.framesForwardKinematics(model, data, q)
    monkeypatch.undo()
    other = model.copy()
    wanted = other.createData()
    np.testing.assert_allclose(tau, pin.rnea(other, wanted, q, q, q), rtol=1e-12)
    pin.framesForwardKinematics(other, wanted, q)
    np.testing.assert_allclose(data.oMf[-1].homogeneous, wanted.oMf[-1].homogeneous, atol=1e-12)


def test_two_thousand_changes_take_no_memory(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)

    def change(count: int) -> None:
        for k in range(count):
            _changed(model, k)
            _answers(pin, model, data, q)

    change(200)
    assert least_growth(lambda: change(2000), 2**20) < 2**20


def test_what_is_read_late_is_of_the_numbers_of_its_call(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    for k in range(6):
        _changed(model, k)
        pin.rnea(model, data, q, q, q)
        pin.crba(model, data, q)
    pin.rnea(model, data, q, q, q)
    pin.centerOfMass(model, data, q)
    other = model.copy()
    for k in range(6, 9):
        _changed(model, k)
        pin.crba(model, data, 2.0 * q)  # leaves forces and centres as they are
        pin.computeJointTorqueRegressor(model, model.createData(), q, q, q)  # takes up the numbers anew
    pin.computeTotalMass(model)
    wanted = other.createData()
    pin.rnea(other, wanted, q, q, q)
    pin.centerOfMass(other, wanted, q)
    for name in ("f", "h", "a_gf"):
        for own, theirs in zip(getattr(data, name), getattr(wanted, name), strict=True):
            np.testing.assert_allclose(own.vector, theirs.vector, atol=1e-12)
    np.testing.assert_allclose(data.com[2], wanted.com[2], atol=1e-12)
    np.testing.assert_allclose(list(data.mass), list(wanted.mass), atol=1e-12)


def test_a_joint_added_to_a_model_that_kept_changing_is_noticed(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    for k in range(6):
        _changed(model, k)
        pin.rnea(model, data, q, q, q)
    model.addJoint(6, pin.JointModelRX(), pin.SE3.Identity(), "more")
    longer, other = np.append(q, 0.3), model.copy()
    with pytest.raises(ValueError, match="createData"):
        pin.rnea(model, data, longer, longer, longer)
    mine, wanted = (pin.rnea(m, m.createData(), longer, longer, longer) for m in (model, other))
    np.testing.assert_array_equal(mine, wanted)
