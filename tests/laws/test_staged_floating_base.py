"""The centroidal matrix of revolute joints on a floating base, whose base has columns of its own, equals its definition."""

from __future__ import annotations

import ctypes
import gc
import pickle
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from support.fenced import fenced
from support.random_models import random_model
from ulna import algorithms, kernels
from ulna.algorithms.derivatives.staged_floating_base import centroidal_matrix_of_floating_base
from ulna.compiler import compile
from ulna.compiler.codegen.module import emit_single
from ulna.compiler.forms.columns import DeferredFunction
from ulna.compiler.runtime import jit
from ulna.model import Model
from ulna.robot import Robot

KINDS = ["revolute", "continuous"]
"""Their random axes become those of the frames, in either direction."""


def tree(seed: int, joints: int = 24, branching: float = 0.6) -> Model:
    rng = np.random.default_rng(seed)
    return random_model(rng, KINDS, joints, root="free_flyer", mimics=0, branching=branching)


def configurations(model: Model, count: int, far: float = 1.0) -> np.ndarray:
    """With the base so many times as far away."""
    q = Robot(model).random_configuration((count,), seed=0)
    q[:, :3] *= far
    return q


def assert_matrix(got: np.ndarray, model: Model, q: np.ndarray, tolerance: float = 1e-12) -> None:
    expected = algorithms.centroidal_matrix(model, q)
    np.testing.assert_allclose(got, expected, rtol=0.0, atol=tolerance * np.abs(expected).max())


@pytest.mark.parametrize("branching", [0.0, 0.3, 0.9])
@pytest.mark.parametrize(("seed", "joints"), [(0, 18), (1, 24), (2, 29), (3, 32), (4, 41)])
def test_it_equals_the_definition(seed, joints, branching):
    model = tree(seed, joints, branching)
    assert centroidal_matrix_of_floating_base(model) is not None
    kernel = kernels.kernel(model, "centroidal_matrix")
    for q in configurations(model, 20):
        matrix = kernel(q)
        assert_matrix(matrix, model, q)
        np.testing.assert_array_equal(matrix[3:, :3], 0.0)


def test_it_does_not_depend_on_where_the_robot_is():
    """The frame is that of the base: a kilometre away nothing is lost."""
    model = tree(5)
    near, kernel = configurations(model, 10), kernels.kernel(model, "centroidal_matrix")
    for q, away in zip(near, configurations(model, 10, far=1000.0), strict=True):
        np.testing.assert_array_equal(kernel(q), kernel(away))


def test_float32_is_precise():
    model = tree(6)
    kernel = kernels.kernel(model, "centroidal_matrix", dtype=np.float32)
    for q in configurations(model, 20).astype(np.float32):
        assert_matrix(kernel(q), model, q.astype(float), 2e-5)


@pytest.mark.parametrize("register_bytes", [32, 64])
@pytest.mark.parametrize("joints", [18, 25])
def test_all_widths_of_registers(register_bytes, joints):
    """LLVM divides what is wider than the registers of this machine."""
    model = tree(7, joints)
    f = kernels.kernel(model, "centroidal_matrix").function
    ir = emit_single(f, replace(jit.target(), register_bytes=register_bytes))
    assert "@one.bodies" in ir
    code = jit.load_text(
        ir.replace("define internal void @one(", "define void @one("), ("one",), has_loops=False
    )
    for q in configurations(model, 3):
        matrix = np.full((6, model.nv), np.nan)
        pointers = [ctypes.c_void_p(x.ctypes.data) for x in (q, matrix)]
        ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(code.address("one"))(*pointers)
        assert_matrix(matrix, model, q)


@pytest.mark.parametrize("at_end", [False, True])
def test_nothing_beside_the_arrays_is_touched(at_end):
    """They begin or end at a page without access."""
    model = tree(8)
    (given,) = configurations(model, 1)
    q, out = fenced(model.nq, float, at_end), fenced(6 * model.nv, float, at_end).reshape(6, model.nv)
    q[...] = given
    kernel = kernels.kernel(model, "centroidal_matrix")
    kernel(q, out=out)
    np.testing.assert_array_equal(out, kernel(given))


def test_packed_pickled_and_batched():
    model = tree(9)
    kernel, q = kernels.kernel(model, "centroidal_matrix"), configurations(model, 11)
    packed, pattern, copied = kernel.packed(), kernel.pattern(), pickle.loads(pickle.dumps(kernel))
    for one, of_batch in zip(q, kernel(q), strict=True):
        matrix = kernel(one)
        np.testing.assert_array_equal(pattern.unpack(packed(one)), matrix)
        np.testing.assert_array_equal(copied(one), matrix)
        np.testing.assert_allclose(of_batch, matrix, rtol=0.0, atol=1e-13 * np.abs(matrix).max())


def test_batches_in_stages_are_computed_sample_by_sample():
    model = tree(10)
    name = "centroidal_matrix"
    form = replace(kernels.kernel(model, name).function.columns, serves_batches=True)
    in_stages = compile(DeferredFunction(name, "", form, partial(kernels.function, model, name)))
    q = configurations(model, 9)
    for one, matrix in zip(q, in_stages(q), strict=True):
        assert_matrix(matrix, model, one)


def test_results_are_new_arrays_in_all_threads():
    """Those that are kept do not change, others are freed."""
    model = tree(11)
    kernel, q = kernels.kernel(model, "centroidal_matrix"), configurations(model, 64)
    expected = [kernel(one) for one in q]
    assert len({matrix.ctypes.data for matrix in expected}) == len(q)
    copies = [matrix.copy() for matrix in expected]

    def work(_: int) -> list[np.ndarray]:
        return [kernel(one) for _ in range(20) for one in q][-len(q) :]

    with ThreadPoolExecutor(4) as pool:
        for results in pool.map(work, range(8)):
            np.testing.assert_array_equal(results, copies)
    np.testing.assert_array_equal(expected, copies)
    gc.collect()
    before = sys.getallocatedblocks()
    for _ in range(2000):
        kernel(q[0])
    assert sys.getallocatedblocks() - before < 50


def test_robots_that_do_not_suit_take_the_other_form():
    rng = np.random.default_rng(0)
    with_slides = random_model(rng, ["revolute", "prismatic"], 24, root="free_flyer", mimics=0)
    small, standing = tree(0, 12), random_model(rng, KINDS, 24, root=None, mimics=0)
    for model in (with_slides, small, standing):
        assert centroidal_matrix_of_floating_base(model) is None
        (q,) = configurations(model, 1)
        assert_matrix(kernels.kernel(model, "centroidal_matrix")(q), model, q)
