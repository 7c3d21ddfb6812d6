"""Calls without q on models built joint by joint: kernels answer them, and they follow the model's numbers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using

_ENOUGH = 12
"""After so many calls a model is compiled."""


@pytest.fixture(autouse=True)
def _is_first_model(pin: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The more models are compiled, the more calls of the next one are evaluated first."""
    from pinocchio._model.first_calls import FirstCalls

    monkeypatch.setattr(FirstCalls, "_compiled_models", 0)


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _chain(pin: Any, joints: int) -> Any:
    model, parent = pin.Model(), 0
    for k in range(joints):
        kind = (pin.JointModelRX, pin.JointModelRY, pin.JointModelPZ)[k % 3]()
        parent = model.addJoint(parent, kind, pin.SE3(np.eye(3), np.array([0.1, 0.0, 0.2])), f"joint {k}")
        inertia = pin.Inertia(1.0 + k % 4, np.array([0.0, 0.1, 0.05]), 0.1 * np.eye(3))
        model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
    return model


def _state(pin: Any, model: Any) -> tuple[Any, Any]:
    rng = np.random.default_rng(7001)
    q = pin.integrate(model, pin.neutral(model), rng.uniform(-1.0, 1.0, model.nv))
    return q, rng.normal(size=model.nv)


@pytest.mark.parametrize("rows", [64, 3])
def test_a_model_built_joint_by_joint_is_answered_by_kernels(
    pin: Any, rows: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pinocchio._model import row_storage

    monkeypatch.setattr(row_storage, "_BLOCK_ROWS", rows)
    model = _chain(pin, 4)
    assert len(model._parameter_blocks("inertias")) == (1 if rows == 64 else 2)
    data, (q, v) = model.createData(), _state(pin, model)
    found: list[Any] = []
    for name, call in (
        ("Coriolis matrix", lambda: [pin.getCoriolisMatrix(model, data)]),
        ("centroidal derivatives", lambda: pin.getCentroidalDynamicsDerivatives(model, data)),
    ):
        for _ in range(_ENOUGH):
            pin.computeRNEADerivatives(model, data, q, v, v)
            results = call()
        found += results
        pin.computeRNEADerivatives(model, data, q, v, v)
        assert data._bound_at[f"{name} of fields"]() is not NotImplemented
    other = model.createData()
    expected = (
        pin.computeCoriolisMatrix(model, other, q, v),
        *pin.computeCentroidalDynamicsDerivatives(model, other, q, v, v),
    )
    for one, another in zip(found, expected, strict=True):
        assert np.allclose(one, another, rtol=1e-9, atol=1e-9 * max(1.0, np.abs(another).max()))


def test_the_second_call_after_an_algorithm_leaves_the_kernel_of_the_first(pin: Any) -> None:
    model = _chain(pin, 4)
    data, (q, v) = model.createData(), _state(pin, model)

    def bound_after(times: int) -> Any:
        for _ in range(times):
            pin.computeRNEADerivatives(model, data, q, v, v)
            for _ in range(2):
                pin.getCentroidalDynamicsDerivatives(model, data)
        return data._bound_at["centroidal derivatives of fields"]

    bound = bound_after(_ENOUGH)
    assert all(bound_after(1) is bound for _ in range(5))


def test_the_universe_of_a_new_model_stays_the_one_that_was_read(pin: Any) -> None:
    model = pin.Model()
    universe, body, frame = model.jointPlacements[0], model.inertias[0], model.frames[0]
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "first")
    universe.translation = np.array([1.0, 2.0, 3.0])
    body.mass = 4.0
    assert model.jointPlacements[0].translation.tolist() == [1.0, 2.0, 3.0]
    assert model.inertias[0].mass == 4.0
    assert model.frames[0].placement == frame.placement


def test_masses_follow_the_model_after_a_jacobian_without_q(pin: Any) -> None:
    model = _chain(pin, 4)
    data, (q, _) = model.createData(), _state(pin, model)
    pin.forwardKinematics(model, data, q)
    for _ in range(_ENOUGH):
        pin.jacobianCenterOfMass(model, data)
    for mass in (5.0, 6.0, 7.5):
        model.inertias[2].mass = mass
        J = pin.jacobianCenterOfMass(model, data)
        assert data.mass[0] == pytest.approx(sum(model.inertias[k].mass for k in range(1, model.njoints)))
        assert np.allclose(J, pin.jacobianCenterOfMass(model, model.createData(), q))


def test_energies_without_q_are_numbers_of_what_the_data_holds(pin: Any) -> None:
    model = _chain(pin, 4)
    data, (q, v) = model.createData(), _state(pin, model)
    calls = pin.computeKineticEnergy, pin.computePotentialEnergy, pin.computeMechanicalEnergy
    for scale in np.linspace(0.5, 2.0, _ENOUGH):
        pin.forwardKinematics(model, data, q, scale * v)
        kinetic, potential, both = (call(model, data) for call in calls)
        assert type(kinetic) is type(potential) is type(both) is float
        assert kinetic == pytest.approx(scale**2 * pin.computeKineticEnergy(model, model.createData(), q, v))
        assert both == pytest.approx(kinetic + potential)
    data.v[1] = pin.Motion.Zero()
    assert pin.computeKineticEnergy(model, data) < kinetic


def test_joint_jacobians_without_q_follow_placements(pin: Any) -> None:
    model = _chain(pin, 4)
    data, (q, _) = model.createData(), _state(pin, model)
    for scale in np.linspace(0.1, 1.0, _ENOUGH):
        pin.forwardKinematics(model, data, scale * q)
        J = pin.computeJointJacobians(model, data)
        assert np.allclose(J, pin.computeJointJacobians(model, model.createData(), scale * q))
        assert np.allclose(data.J, J)
