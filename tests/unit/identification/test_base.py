"""Base parameters."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, ShapeError
from ulna.identification import base_parameters, base_parameters_of
from ulna.model import ModelBuilder, Revolute, dynamic_parameters, perturbed
from ulna.spatial import SE3, Inertia


def pendulum() -> ulna.Robot:
    builder = (
        ModelBuilder("pendulum").add_link("base").add_link("rod", Inertia.from_point(1.0, (0.0, 0.0, -0.5)))
    )
    builder.add_joint("hinge", Revolute((0, 1, 0)), "base", "rod", SE3.trans(0.0, 0.0, 1.0))
    return ulna.Robot(builder.build())


def test_a_pendulum_has_three() -> None:
    base = base_parameters(pendulum())
    assert base.expressions == ("mx(hinge)", "mz(hinge)", "Iyy(hinge)")
    assert str(base).startswith("3 base parameters of 10 parameters")
    with_drive = base_parameters(pendulum(), armature=True, damping=True, friction=True)
    assert with_drive.expressions[2] == "Iyy(hinge) + armature(hinge)"
    assert with_drive.count == 5


def test_the_panda_has_forty_three() -> None:
    robot = ulna.load("panda")
    base = base_parameters(robot)
    assert base.count == 43
    q = robot.random_configuration(5, seed=1)
    v, a = np.random.default_rng(2).standard_normal((2, 5, 7))
    Y = robot.joint_torque_regressor(q, v, a)
    p = dynamic_parameters(perturbed(robot.model, 0.3, seed=3))
    np.testing.assert_allclose(base.columns(Y) @ base.of(p), Y @ p, atol=1e-9)


def test_dependent_columns_are_found_by_their_factors() -> None:
    rng = np.random.default_rng(0)
    c = rng.standard_normal((20, 2))
    W = np.column_stack([c[:, 0], 1e6 * c[:, 1], 0.0 * c[:, 0], 2.0 * c[:, 0] - 3.0 * c[:, 1]])
    base = base_parameters_of(W, ["a", "b", "c", "d"])
    assert base.independent == (0, 1)
    np.testing.assert_allclose(base.matrix, [[1, 0, 0, 2.0], [0, 1, 0, -3e-6]], rtol=1e-9)
    assert base.expressions == ("a + 2 d", "b - 3e-06 d")
    assert base_parameters_of(np.zeros((3, 2))).count == 0


def test_wrong_input_is_refused() -> None:
    with pytest.raises(ShapeError):
        base_parameters_of(np.zeros(3))
    with pytest.raises(InputError, match="names"):
        base_parameters_of(np.zeros((3, 2)), ["a"])
    with pytest.raises(ShapeError):
        base_parameters_of(np.eye(2)).of([1.0])
