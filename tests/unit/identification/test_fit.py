"""Identification of known robots from separate logs."""

from __future__ import annotations

import builtins
import warnings

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, MissingExtra, ModelError, ModelWarning, NonFiniteError, ShapeError
from ulna.identification import base_parameters, identify
from ulna.identification.blocks import Sought, fit_sums, sums_of
from ulna.model import (
    FreeFlyer,
    ModelBuilder,
    dynamic_parameters,
    lock_joints,
    perturbed,
    with_joint_dynamics,
)
from ulna.robot import Robot
from ulna.spatial import Inertia
from ulna.typing import Floats

WRIST = [f"panda_joint{k}" for k in (1, 2, 3)]
ALL = {"armature": True, "damping": True, "friction": True}


@pytest.fixture(scope="module")
def robot() -> Robot:
    """The last four joints of the Panda."""
    return Robot(lock_joints(ulna.load("panda").model, WRIST, "qr"))


@pytest.fixture(scope="module")
def true(robot: Robot) -> Robot:
    model = perturbed(robot.model, 0.3, seed=1, com=0.01)
    return Robot(with_joint_dynamics(model, armature=0.1, damping=1.0, friction=0.5))


def log(robot: Robot, noise: float = 0.0, rows: int = 200) -> tuple[Floats, Floats, Floats, Floats]:
    """Sums of sines, and the torques of the robot along them."""
    rng = np.random.default_rng(0)
    t = np.linspace(0.0, 10.0, rows)
    w = 2.0 * np.pi * 0.1 * np.arange(1, 6)
    A, B = rng.uniform(-0.5, 0.5, (2, robot.nv, 5))
    s, c = np.sin(np.outer(t, w)), np.cos(np.outer(t, w))
    q = (s / w) @ A.T - (c / w) @ B.T + robot.configurations["qr"]
    v, a = c @ A.T + s @ B.T, (c * w) @ B.T - (s * w) @ A.T
    m = robot.model
    tau = robot.joint_torque_regressor(q, v, a) @ dynamic_parameters(m)
    tau += m.armature * a + m.damping * v + m.friction * np.tanh(v / 1e-2)
    return q, v, a, tau + rng.normal(0.0, noise, tau.shape) if noise else tau


def test_a_log_without_noise_is_explained_wholly(robot: Robot, true: Robot) -> None:
    found = identify(robot, *log(true), **ALL)
    assert found.rms.max() < 1e-9 < found.rms_before.min()
    np.testing.assert_allclose(found.base_values, found.base.of(_parameters(true)), atol=1e-7)
    np.testing.assert_allclose(found.damping, 1.0, atol=1e-8)
    np.testing.assert_allclose(found.friction, 0.5, atol=1e-8)
    # another motion, which the fit has not seen
    q = robot.random_configuration(20, seed=5)
    v, a = np.random.default_rng(6).standard_normal((2, 20, robot.nv))
    Y = robot.joint_torque_regressor(q, v, a)
    theirs = Y @ dynamic_parameters(true.model) + 0.1 * a
    np.testing.assert_allclose(Y @ found.parameters + found.armature * a, theirs, atol=1e-6)


def _parameters(robot: Robot) -> Floats:
    m = robot.model
    return np.concatenate([dynamic_parameters(m), m.armature, m.damping, m.friction])


def test_what_is_not_sought_is_the_models(robot: Robot, true: Robot) -> None:
    start = Robot(with_joint_dynamics(robot.model, armature=0.1, damping=1.0, friction=0.5))
    found = identify(start, *log(true))
    assert found.rms.max() < 1e-9
    assert (found.damping == 1.0).all()
    assert not found.physical and found.iterations == 1


def test_what_the_log_does_not_determine_stays_at_the_prior(robot: Robot, true: Robot) -> None:
    same = identify(robot, *log(robot))
    np.testing.assert_allclose(same.parameters, dynamic_parameters(robot.model), atol=1e-9)
    q, v, a, tau = log(robot)
    still = identify(robot, q[:1], 0 * v[:1], 0 * a[:1], tau[:1])
    unseen = np.abs(still.parameters - dynamic_parameters(robot.model)).reshape(-1, 10)[:, 4:]
    assert unseen.max() < 1e-12  # at rest, inertias do not show
    prior = dynamic_parameters(true.model)
    far = identify(robot, *log(true), **ALL, prior=prior, ridge=1e6)
    np.testing.assert_allclose(far.parameters, prior, atol=1e-6)


def test_bodies_that_can_exist(robot: Robot, true: Robot) -> None:
    data = log(true, noise=0.05)
    linear, physical = identify(robot, *data, **ALL), identify(robot, *data, **ALL, physical=True)
    with pytest.raises(ModelError, match="physical=True"):
        _ = linear.new_model
    model = physical.new_model
    assert all(body.is_physical() for body in model.inertias)
    assert (physical.rms < 1.2 * linear.rms + 1e-3).all()
    assert np.abs(physical.rms - 0.05).max() < 0.01
    again = identify(Robot(model), *data)
    np.testing.assert_allclose(again.rms_before, physical.rms, rtol=1e-6)


def test_drives_that_cannot_exist_are_named_where_a_model_is_made(robot: Robot) -> None:
    q, v, a, tau = log(robot)
    push = np.array([0.0, 2.0, 0.0, 0.0])  # it helps the motion, as a negative damping would
    found = identify(robot, q, v, a, tau - push * v, damping=True)
    with pytest.warns(ModelWarning, match=r"damping of panda_joint5 \(-2\)\. .*physical=True"):
        model = found.new_model
    assert model.damping[1] == 0.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert identify(robot, q, v, a, tau, damping=True).new_model.damping.min() >= 0.0


def test_noise_of_the_joints_weighs_them(robot: Robot, true: Robot) -> None:
    q, v, a, tau = log(true)
    sigma = np.array([1.0, 0.01, 0.01, 0.01])
    tau = tau + np.random.default_rng(9).normal(0.0, 1.0, tau.shape) * sigma
    clean = identify(true, q, v, a, log(true)[3], **ALL).base_values
    errors = []
    for noise in (None, "auto", sigma):
        found = identify(robot, q, v, a, tau, **ALL, noise=noise)
        errors.append(float((np.abs(found.base_values - clean) / np.maximum(np.abs(clean), 0.01)).mean()))
    assert errors[1] < 0.5 * errors[0]
    assert errors[2] < 0.5 * errors[0]


def test_deviations_are_those_of_the_error(robot: Robot, true: Robot) -> None:
    found = identify(robot, *log(true, noise=0.05), **ALL)
    clean = identify(robot, *log(true), **ALL)
    score = (found.base_values - clean.base_values) / found.base_deviations
    assert 0.5 < np.sqrt((score**2).mean()) < 1.5


def test_report_and_picture(robot: Robot, true: Robot, tmp_path) -> None:
    pytest.importorskip("matplotlib")
    found = identify(robot, *log(true, noise=0.05), **ALL)
    text = found.report()
    part = found.base_deviations / np.abs(found.base_values)
    assert 0 < (part < 0.1).sum() < found.base.count
    assert f"; {(part < 0.1).sum()} known to better than 10 %" in text
    clean = identify(robot, *log(true), **ALL)
    assert f"; {clean.base.count} known to better than 10 %" in clean.report()
    assert "linear least squares, 200 samples, 4 joints" in text
    assert all(name in text for name in robot.joint_names)
    figure = found.plot(tmp_path / "fit.png", t=np.linspace(0.0, 10.0, 200))
    assert len(figure.axes) == robot.nv
    assert (tmp_path / "fit.png").stat().st_size > 10_000


def test_logs_have_as_many_columns_as_q_and_v() -> None:
    """On a free flyer, seven and six."""
    builder = ModelBuilder("body").add_link("world").add_link("body", Inertia.from_box(1.0, (0.1, 0.2, 0.3)))
    robot = Robot(builder.add_joint("free", FreeFlyer(), "world", "body").build())
    rows = np.tile(robot.neutral, (4, 1))
    with pytest.raises(ShapeError, match=r"`q` has shape \(4, 6\); expected \(4, 7\)"):
        identify(robot, rows[:, :6], *np.zeros((3, 4, 6)))
    with pytest.raises(ShapeError, match=r"`a` has shape \(4, 7\); expected \(4, 6\)"):
        identify(robot, rows, np.zeros((4, 6)), np.zeros((4, 7)), np.zeros((4, 6)))


def test_wrong_logs_are_refused(robot: Robot) -> None:
    q, v, a, tau = log(robot, rows=5)
    with pytest.raises(ShapeError, match="`tau`"):
        identify(robot, q, v, a, tau[:-1])
    with pytest.raises(NonFiniteError, match=r"a\[2, 1\]"):
        bad = a.copy()
        bad[2, 1] = np.nan
        identify(robot, q, v, bad, tau)
    with pytest.raises(InputError, match="no samples.*a joint that never moves"):
        identify(robot, q[:0], v[:0], a[:0], tau[:0])
    with pytest.raises(InputError, match="ridge"):
        identify(robot, q, v, a, tau, ridge=-1.0)
    with pytest.raises(InputError, match="noise"):
        identify(robot, q, v, a, tau, noise="automatic")  # type: ignore[arg-type]
    with pytest.raises(ShapeError, match="prior"):
        identify(robot, q, v, a, tau, prior=[1.0])


def test_a_missing_package_is_named(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    found = identify(robot, *log(robot, rows=5))
    real = builtins.__import__

    def refuse(name: str, *rest, **more):
        if name.split(".", maxsplit=1)[0] == "matplotlib":
            raise ImportError(name)
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", refuse)
    with pytest.raises(MissingExtra, match="needs the package 'matplotlib'"):
        found.plot()


def test_joints_that_did_not_move_are_named() -> None:
    robot = ulna.load("ur5", visuals="simple")
    q, v, a = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 100, 6))
    v[:, 4] = np.random.default_rng(1).normal(0.0, 2e-3, 100)  # noise of the differences of an encoder
    tau = robot.inverse_dynamics(q, v, a)
    found = identify(robot, q, v, a, tau, friction=True)
    assert found.unmoved == ("wrist_2_joint",)
    assert "not moved in this log: wrist_2_joint" in found.report()
    (row,) = [
        x.split() for x in found.report().splitlines() if x.split()[:1] == ["elbow_joint"] and "%" not in x
    ]
    np.testing.assert_allclose(
        [float(x) for x in row[1:]],
        [x[2] for x in (found.armature, found.damping, found.friction)],
        rtol=1e-3,
        atol=1e-12,
    )
    assert "damping" not in identify(robot, q, v, a, tau).report()
    moved = identify(robot, q, v, a, tau, friction=True, width=1e-3)
    assert moved.unmoved == () and "not moved" not in moved.report()


def test_a_long_log_is_reduced_in_parts_that_are_reported(robot: Robot) -> None:
    """Ctrl-C is heard between the parts; the whole log in one QR decomposition took a minute without a word."""
    q, v, a, tau = log(robot, rows=1200)
    seen: list[tuple[int, int]] = []
    whole = sums_of(robot, q, v, a, tau, Sought(), lambda done, of: seen.append((done, of)))
    assert seen == [(512, 1200), (1024, 1200), (1200, 1200)]
    large, found = fit_sums(robot.model, whole, Sought()), identify(robot, q, v, a, tau)
    np.testing.assert_array_equal(found.parameters, large.parameters)
    np.testing.assert_allclose(np.sqrt((found.residuals**2).mean(axis=0)), large.rms, atol=1e-9)

    class Stop(Exception):
        """Stands for KeyboardInterrupt."""

    def stop(done: int, of: int) -> None:
        raise Stop

    with pytest.raises(Stop):
        sums_of(robot, q, v, a, tau, Sought(), stop)


def test_robots_without_joints_are_refused() -> None:
    stone = Robot(ModelBuilder("stone").add_link("stone", Inertia.from_sphere(1.0, 0.1)).build())
    with pytest.raises(InputError, match="'stone' has no joints that move"):
        identify(stone, *np.zeros((4, 5, 0)))
    with pytest.raises(InputError, match="'stone' has no joints that move"):
        base_parameters(stone)
    with pytest.raises(InputError, match="'stone' has no joints that move"):
        ulna.trajectory.straight(stone, [], [], duration=1.0)
