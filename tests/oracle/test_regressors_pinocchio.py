"""Regressors against Pinocchio: the matrices themselves, and inverse dynamics, energies and centre of mass."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

pin = pytest.importorskip("pinocchio")

from support.pinocchio_models import SINGLE_JOINT_KINDS, Twin, from_pinocchio, to_pinocchio  # noqa: E402
from support.random_models import KINDS, random_model  # noqa: E402
from ulna import algorithms as alg  # noqa: E402
from ulna.algorithms.dynamics import regressors as reg  # noqa: E402
from ulna.model import dynamic_parameters  # noqa: E402
from ulna.robots import example_robot_data  # noqa: E402
from ulna.typing import Floats  # noqa: E402

NAMES = ("random-plain", "random-free", "random-every", "random-mimic", "panda", "talos", "solo12", "ur5")


@cache
def twin(name: str) -> Twin:
    if name == "random-plain":
        return to_pinocchio(random_model(np.random.default_rng(1), SINGLE_JOINT_KINDS, mimics=0))
    if name == "random-free":
        return to_pinocchio(
            random_model(np.random.default_rng(2), SINGLE_JOINT_KINDS, root="free_flyer", mimics=0)
        )
    if name == "random-every":
        return to_pinocchio(random_model(np.random.default_rng(3), list(KINDS), root="planar", mimics=0))
    if name == "random-mimic":
        return to_pinocchio(random_model(np.random.default_rng(4), SINGLE_JOINT_KINDS, mimics=2))
    if example_robot_data.share_folder() is None:
        pytest.skip("example-robot-data is not installed")
    urdf = str(example_robot_data.files(name)[0])
    if example_robot_data.DESCRIPTIONS[name].floating:
        return from_pinocchio(pin.buildModelFromUrdf(urdf, pin.JointModelFreeFlyer()))
    return from_pinocchio(pin.buildModelFromUrdf(urdf))


def state(t: Twin, seed: int) -> tuple[Floats, Floats, Floats]:
    rng = np.random.default_rng(seed)
    q = alg.random(t.model, rng)
    v, a = rng.standard_normal((2, t.model.nv))
    return q, v, a


def close(ours: Floats, theirs: Floats, tolerance: float = 1e-10) -> None:
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=tolerance * max(1.0, np.abs(theirs).max()))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("seed", range(2))
def test_torques_are_linear_in_the_parameters(name: str, seed: int) -> None:
    t = twin(name)
    q, v, a = state(t, seed)
    p = dynamic_parameters(t.model)
    tau = t.columns(pin.rnea(t.pin, t.pin.createData(), t.q(q), t.v(v), t.v(a)))
    close(reg.joint_torque_regressor(t.model, q, v, a) @ p + t.model.armature * a, tau)
    data = t.pin.createData()
    close(
        reg.gravity_regressor(t.model, q) @ p, t.columns(pin.computeGeneralizedGravity(t.pin, data, t.q(q)))
    )


def blocks(t: Twin, matrix: Floats, size: int) -> Floats:
    """A regressor of Pinocchio, its blocks of columns in the order of our joints."""
    ids = [t.pin.getJointId(joint.name) - 1 for joint in t.model.joints]
    return np.concatenate([matrix[..., size * i : size * (i + 1)] for i in ids], axis=-1)


@pytest.mark.parametrize("name", [n for n in NAMES if n not in ("random-every", "random-mimic")])
def test_regressors_are_pinocchios(name: str) -> None:
    t = twin(name)
    q, v, a = state(t, 5)
    data = t.pin.createData()
    theirs = pin.computeJointTorqueRegressor(t.pin, data, t.q(q), t.v(v), t.v(a))
    ours = reg.joint_torque_regressor(t.model, q, v, a)
    turned = [joint.name for joint in t.model.joints if joint.kind.name == "planar"]
    keep = np.repeat([joint.name not in turned for joint in t.model.joints], 10)
    theirs = np.swapaxes(t.columns(np.swapaxes(blocks(t, theirs, 10), -1, -2)), -1, -2)
    close(ours[:, keep], theirs[:, keep])
    few = np.repeat([joint.name not in turned for joint in t.model.joints], 4)
    static = blocks(t, pin.computeStaticRegressor(t.pin, data, t.q(q)), 4)
    close(reg.static_regressor(t.model, q)[:, few], static[:, few])
    kinetic = blocks(t, pin.computeKineticEnergyRegressor(t.pin, data, t.q(q), t.v(v)), 10)
    close(reg.kinetic_energy_regressor(t.model, q, v)[keep], kinetic[keep])
    potential = blocks(t, pin.computePotentialEnergyRegressor(t.pin, data, t.q(q)), 10)
    close(reg.potential_energy_regressor(t.model, q)[keep], potential[keep])


@pytest.mark.parametrize("name", ["random-plain", "random-free", "panda", "talos"])
def test_frame_regressors_are_pinocchios(name: str) -> None:
    t = twin(name)
    q, v, a = state(t, 6)
    data = t.pin.createData()
    pin.rnea(t.pin, data, t.q(q), t.v(v), t.v(a))
    for frame, index in t.frames[:: max(1, len(t.frames) // 6)]:
        if frame.joint >= 0:
            theirs = pin.frameBodyRegressor(t.pin, data, index)
            close(reg.frame_regressor(t.model, q, v, a, frame), theirs)


@pytest.mark.parametrize("name", [n for n in NAMES if n != "random-mimic"])  # Pinocchio refuses
def test_energies_and_centre_of_mass(name: str) -> None:
    t = twin(name)
    q, v, _ = state(t, 7)
    data, p = t.pin.createData(), dynamic_parameters(t.model)
    # not computeKineticEnergy, which counts the drives' inertia in part
    mass = np.triu(pin.crba(t.pin, data, t.q(q)))
    mass = t.both(mass + np.triu(mass, 1).T) - np.diag(t.model.armature)
    close(reg.kinetic_energy_regressor(t.model, q, v) @ p, np.asarray(0.5 * v @ mass @ v))
    potential = pin.computePotentialEnergy(t.pin, data, t.q(q))
    close(reg.potential_energy_regressor(t.model, q) @ p, np.asarray(potential))
    com = pin.centerOfMass(t.pin, data, t.q(q))
    close(reg.static_regressor(t.model, q) @ p.reshape(-1, 10)[:, :4].ravel(), com)
