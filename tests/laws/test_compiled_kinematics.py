"""Kinematics traced, interpreted and compiled give what the same source gives on plain floats."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from support.random_models import random_model
from ulna import algorithms as alg
from ulna.compiler import compile, trace
from ulna.model import Frame, Model
from ulna.robot import Robot
from ulna.robots.panda import panda

MODELS: dict[str, Callable[[], Model]] = {
    "every_kind": lambda: random_model(np.random.default_rng(0), mimics=2),
    "floating": lambda: random_model(
        np.random.default_rng(1), ("revolute", "universal", "composite"), 5, root="free_flyer"
    ),
    "planar": lambda: random_model(
        np.random.default_rng(2), ("continuous", "prismatic", "spherical"), root="planar"
    ),
}

FUNCTIONS: dict[str, Callable[[Model, Frame], Callable[..., Any]]] = {
    "pose": lambda m, f: lambda q: alg.frame_pose(m, q, f).matrix(),
    "poses": lambda m, f: lambda q: np.stack([T.matrix() for T in alg.frame_poses(m, q, m.frames)], axis=-3),
    "velocity": lambda m, f: lambda q, v: alg.frame_velocity(m, q, v, f, "world").vector(),
    "acceleration": lambda m, f: (
        lambda q, v, a: alg.frame_acceleration(m, q, v, a, f, classical=True).vector()
    ),
    "jacobian": lambda m, f: lambda q: alg.frame_jacobian(m, q, f),
    "jacobian world": lambda m, f: lambda q: alg.frame_jacobian(m, q, f, "world"),
    "jacobian local": lambda m, f: lambda q: alg.frame_jacobian(m, q, f, "local"),
    "jacobian dot": lambda m, f: lambda q, v: alg.frame_jacobian_dot(m, q, v, f),
    "hessian local": lambda m, f: lambda q: alg.frame_hessian(m, q, f, "local"),
    "analytical": lambda m, f: lambda q: alg.analytical_jacobian(m, q, f, "rpy/zyx"),
    "analytical exp": lambda m, f: lambda q, v: alg.analytical_jacobian_dot(m, q, v, f, "exp"),
    "manipulability": lambda m, f: lambda q: alg.manipulability(m, q, f, axes="trans"),
    "gradient": lambda m, f: lambda q: alg.manipulability_gradient(m, q, f, "trans"),
    "derivatives": lambda m, f: lambda q, v, a: alg.frame_acceleration_derivatives(m, q, v, a, f),
    "integrate": lambda m, f: lambda q, v: alg.integrate(m, q, v),
    "difference": lambda m, f: lambda q, v: alg.difference(m, q, alg.integrate(m, q, 0.5 * v)),
    "interpolate": lambda m, f: lambda q, v: alg.interpolate(m, q, alg.integrate(m, q, 0.5 * v), 0.25),
    "normalize": lambda m, f: lambda q: alg.normalize(m, 2.0 * q),
    "distance": lambda m, f: lambda q, v: alg.distance(m, q, alg.integrate(m, q, 0.5 * v)),
    "integrate derivatives": lambda m, f: lambda q, v: alg.integrate_derivatives(m, q, v),
    "difference derivatives": lambda m, f: (
        lambda q, v: alg.difference_derivatives(m, q, alg.integrate(m, q, v))
    ),
}

COMPILED = {"pose", "velocity", "jacobian", "gradient", "integrate", "difference"}
"""Those that are also made into machine code here; the compiler has its own tests for every operation."""


@pytest.fixture(scope="module", params=MODELS)
def model(request: pytest.FixtureRequest) -> Model:
    return MODELS[request.param]()


@pytest.mark.parametrize("name", FUNCTIONS)
def test_traced_equals_plain(model: Model, name: str) -> None:
    rng = np.random.default_rng(3)
    f = FUNCTIONS[name](model, model.frame("tip"))
    count = f.__code__.co_argcount
    arrays = [alg.random(model, rng, (5,)), *rng.standard_normal((2, 5, model.nv))][:count]
    shapes = {n: x.shape[-1:] for n, x in zip("qva", arrays, strict=False)}
    traced = trace(f, name=name.replace(" ", "_"), **shapes)
    expected = f(*arrays)
    _close(traced(*arrays), expected)
    if name in COMPILED:
        kernel = compile(traced)
        _close(kernel(*arrays), expected)
        _close(kernel(*(x[0] for x in arrays)), f(*(x[0] for x in arrays)))


def _close(actual: Any, expected: Any) -> None:
    pairs = zip(actual, expected, strict=True) if isinstance(expected, tuple) else [(actual, expected)]
    for x, y in pairs:
        scale = max(1.0, float(np.abs(y).max(initial=0.0)))
        np.testing.assert_allclose(x, y, rtol=0.0, atol=1e-11 * scale)


def test_derivatives_by_the_compiler_agree_with_the_closed_forms(model: Model) -> None:
    """Two roads to one number: automatic differentiation of the twist, and the Jacobian."""
    tip, rng = model.frame("tip"), np.random.default_rng(4)
    q, v = alg.random(model, rng), rng.standard_normal(model.nv)
    twist = trace(
        lambda q, v: alg.frame_velocity(model, q, v, tip, "local").vector(), q=(model.nq,), v=(model.nv,)
    )
    _close(twist.jacobian("v")(q, v), alg.frame_jacobian(model, q, tip, "local"))
    _close(twist.jacobian("v")(q, v), alg.frame_velocity_derivatives(model, q, v, tip)[1])


def test_link_poses_are_the_poses_of_the_links_frames(model: Model) -> None:
    robot = Robot(model)
    q = robot.random_configuration(3, seed=5)
    _close(robot.link_poses(q), robot.fk(q, model.link_names))


BUDGET = {
    "pose": 150,
    "jacobian": 190,
    "jacobian local": 175,
    "velocity": 260,
    "jacobian dot": 420,
    "acceleration": 375,
    "manipulability": 320,
}


@pytest.mark.parametrize("name", BUDGET)
def test_the_price_of_the_panda(name: str) -> None:
    """Scalar operations of one evaluation; a change that makes the arm's kinematics dearer must say so."""
    model = panda()
    f = FUNCTIONS[name](model, model.frame(model.tool))
    shapes = dict(zip("qva", [(7,)] * f.__code__.co_argcount, strict=False))
    assert trace(f, **shapes).operations <= BUDGET[name]
