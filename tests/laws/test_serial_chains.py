"""The inverse mass matrix of serial chains, and derivatives of their accelerations, by walks along the chain."""

from __future__ import annotations

import ctypes
import pickle
from dataclasses import replace

import numpy as np
import pytest

from support.fenced import fenced
from support.random_models import random_model
from ulna import algorithms, kernels
from ulna.algorithms.derivatives.serial_chains import is_serial
from ulna.compiler.codegen.module import emit_single
from ulna.compiler.runtime import jit
from ulna.model import Model, with_parameters
from ulna.robot import Robot

ONE = ["revolute", "continuous", "prismatic", "helical"]
NAMES = {"inverse_mass_matrix": 1, "forward_dynamics_derivatives": 3}
"""How many arguments they take."""


def chain(seed: int, root: str | None, joints: int) -> Model:
    rng = np.random.default_rng(seed)
    model = random_model(rng, ONE, joints, root=root, mimics=0, branching=0.0)
    return with_parameters(model, {"armature": rng.uniform(0.0, 0.3, model.nv)})


def state(model: Model, count: int, seed: int = 0) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return [Robot(model).random_configuration(seed=seed), *rng.normal(size=(count - 1, model.nv))]


def outputs(x):
    return x if isinstance(x, tuple) else (x,)


def by_definition(model, name, arrays):
    return outputs(getattr(algorithms, name)(model, *arrays))


def is_wide() -> bool:
    return jit.target().register_bytes >= 32


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("root", "joints"),
    [(None, 24), (None, 31), ("free_flyer", 19), ("planar", 22), ("spherical", 23)],
)
def test_walks_equal_the_definition(name, root, joints):
    model = chain(joints, root, joints)
    assert is_serial(model)
    kernel, arrays = kernels.kernel(model, name), state(model, NAMES[name], joints)
    assert ("written out" in repr(kernel)) == is_wide()
    expected = by_definition(model, name, arrays)
    for x in (kernel, pickle.loads(pickle.dumps(kernel))):
        for got, right in zip(outputs(x(*arrays)), expected, strict=True):
            np.testing.assert_allclose(got, right, rtol=1e-7, atol=1e-10 * np.abs(right).max())
    batch = [np.stack([x, x, x]) for x in arrays]
    for got, right in zip(outputs(kernel(*batch)), expected, strict=True):
        np.testing.assert_allclose(got[2], right, rtol=1e-7, atol=1e-10 * np.abs(right).max())


@pytest.mark.parametrize("name", NAMES)
def test_float32_is_precise(name):
    model = chain(0, None, 26)
    arrays = [x.astype(np.float32) for x in state(model, NAMES[name])]
    expected = by_definition(model, name, [x.astype(float) for x in arrays])
    results = outputs(kernels.kernel(model, name, dtype=np.float32)(*arrays))
    for got, right in zip(results, expected, strict=True):
        assert np.abs(got - right).max() < 2e-3 * np.abs(right).max()


@pytest.mark.parametrize("at_end", [False, True])
@pytest.mark.parametrize("register_bytes", [32, 64])
@pytest.mark.parametrize("name", NAMES)
def test_all_widths_of_registers_touch_nothing_else(name, register_bytes, at_end):
    """Arrays begin or end at pages without access."""
    model = chain(3, "free_flyer", 29)
    f = kernels.kernel(model, name).function
    ir = emit_single(f, replace(jit.target(), register_bytes=register_bytes))
    code = jit.load_text(
        ir.replace("define internal void @one(", "define void @one("), ("one",), has_loops=False
    )
    inputs = state(model, NAMES[name], 3)
    held = [
        fenced(int(np.prod(port.shape)), float, at_end).reshape(port.shape)
        for port in (*f.inputs, *f.outputs)
    ]
    for place, x in zip(held, inputs, strict=False):
        place[...] = x
    pointers = [ctypes.c_void_p(x.ctypes.data) for x in held]
    ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * len(pointers))(code.address("one"))(*pointers)
    for got, right in zip(held[len(inputs) :], by_definition(model, name, inputs), strict=True):
        np.testing.assert_allclose(got, right, rtol=1e-7, atol=1e-10 * np.abs(right).max())


def test_a_hundred_joints():
    """Against the mass matrix, bit for bit symmetric; against differences of accelerations."""
    model = chain(1, None, 100)
    q, v, tau = state(model, 3)
    q, v = 0.1 * q, 0.1 * v
    robot = Robot(model)
    inverse, derivatives = robot.inverse_mass_matrix(q), robot.forward_dynamics_derivatives(q, v, tau)
    if is_wide():
        assert "written out" in repr(robot.kernel("forward_dynamics_derivatives"))
    np.testing.assert_array_equal(inverse, inverse.T)
    identity = inverse @ robot.mass_matrix(q)
    assert np.abs(identity - np.eye(100)).max() < 1e-8
    moves = 1e-6 * np.eye(100)[::9]
    for k, difference in enumerate(
        (
            robot.forward_dynamics(q + moves, v, tau) - robot.forward_dynamics(q - moves, v, tau),
            robot.forward_dynamics(q, v + moves, tau) - robot.forward_dynamics(q, v - moves, tau),
            robot.forward_dynamics(q, v, tau + moves) - robot.forward_dynamics(q, v, tau - moves),
        )
    ):
        expected = difference / 2e-6
        scale = np.abs(expected).max()
        np.testing.assert_allclose(derivatives[k][:, ::9].T, expected, rtol=1e-5, atol=1e-6 * scale)
    loops = kernels.looped(model, "inverse_mass_matrix")
    assert loops is not None
    np.testing.assert_allclose(inverse, loops(q), rtol=1e-7, atol=1e-10 * np.abs(inverse).max())


def test_trees_are_not_serial():
    tree = random_model(np.random.default_rng(0), ONE, 30, root=None, mimics=0, branching=0.6)
    assert not is_serial(tree) and algorithms.stages_of_inverse_mass_matrix(tree) is None
    mimics = random_model(np.random.default_rng(0), ONE, 30, root=None, mimics=2, branching=0.0)
    assert not is_serial(mimics)


@pytest.mark.filterwarnings("ignore::ulna.errors.ModelWarning")
def test_reports_do_without_the_graph():
    """It would be refused; float32 is computed in float64, by loops."""
    model = chain(2, None, 90)
    if is_wide():
        report = kernels.kernel(model, "forward_dynamics_derivatives").report()
        assert report.code_bytes > 1000 and report.operations is None
    single = kernels.kernel(model, "inverse_mass_matrix", dtype=np.float32)
    (q,) = state(model, 1)
    q = (0.1 * q).astype(np.float32)
    expected = kernels.kernel(model, "inverse_mass_matrix")(q.astype(float))
    assert np.abs(single(q) - expected).max() < 1e-6 * np.abs(expected).max()
