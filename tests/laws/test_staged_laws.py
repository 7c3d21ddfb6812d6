"""What is computed in stages equals the graphs of the same quantities, on random trees, in all widths of registers."""

from __future__ import annotations

import ctypes
import pickle
import re
import weakref
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from support.fenced import fenced
from support.random_models import random_model, several_roots
from ulna import algorithms, kernels
from ulna.algorithms.derivatives.columns_in_one_frame import suits_one_frame
from ulna.compiler import compile
from ulna.compiler.codegen.module import emit_batch, emit_single
from ulna.compiler.forms.columns import DeferredFunction
from ulna.compiler.runtime import jit
from ulna.model import Model
from ulna.robot import Robot
from ulna.spatial import SE3

FORMS = {
    "inverse_dynamics_derivatives": algorithms.stages_of_inverse_dynamics_derivatives,
    "forward_dynamics_derivatives": algorithms.stages_of_forward_dynamics_derivatives,
    "coriolis_matrix": algorithms.stages_of_coriolis_matrix,
    "mass_matrix": algorithms.stages_of_mass_matrix,
    "centroidal_matrix": algorithms.stages_of_centroidal_matrix,
    "centroidal_derivatives": algorithms.stages_of_centroidal_derivatives,
    "joint_torque_regressor": algorithms.stages_of_joint_torque_regressor,
    "gravity_regressor": algorithms.stages_of_gravity_regressor,
}
ALGORITHMS = {
    "inverse_dynamics_derivatives": algorithms.inverse_dynamics_derivatives,
    "forward_dynamics_derivatives": algorithms.forward_dynamics_derivatives,
    "coriolis_matrix": algorithms.coriolis_matrix,
    "mass_matrix": algorithms.mass_matrix,
    "centroidal_matrix": algorithms.centroidal_matrix,
    "centroidal_derivatives": algorithms.centroidal_derivatives,
    "joint_torque_regressor": algorithms.joint_torque_regressor,
    "gravity_regressor": algorithms.gravity_regressor,
}
WITH_PRODUCTS = {"joint_torque_regressor", "gravity_regressor"}
"""Those that are not written for a sample in each lane."""
ONE = ["revolute", "continuous", "prismatic", "helical", "universal"]


def tree(seed: int, root: str | None = "free_flyer", joints: int = 22) -> Model:
    """A tree with branches and about 30 velocities."""
    rng = np.random.default_rng(seed)
    return random_model(rng, ONE, joints, root=root, mimics=0, branching=0.6)


def state(model: Model, count: int, seed: int = 0) -> list[np.ndarray]:
    """q, and as many vectors as are wanted."""
    rng = np.random.default_rng(seed)
    return [Robot(model).random_configuration(seed=seed), *rng.normal(size=(count - 1, model.nv))]


def by_definition(model: Model, name: str, arrays: list[np.ndarray]) -> tuple[Any, ...]:
    """The same on numbers, by the algorithm that is the definition."""
    return outputs(ALGORITHMS[name](model, *arrays))


def outputs(x: Any) -> tuple[Any, ...]:
    return x if isinstance(x, tuple) else (x,)


@pytest.fixture(autouse=True)
def _for_all_sizes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Some quantities take the form of stages only for larger robots than these."""
    for name in FORMS:
        monkeypatch.setitem(kernels.QUANTITIES, name, replace(kernels.QUANTITIES[name], stages_from=24))
    monkeypatch.setattr(kernels, "_made", weakref.WeakValueDictionary())


@pytest.mark.parametrize("name", FORMS)
@pytest.mark.parametrize(
    ("seed", "root"),
    [(1, "free_flyer"), (2, None), (3, "planar"), (4, "spherical"), (5, "free_flyer"), (6, "several")],
)
def test_stages_equal_the_graph(name, seed, root):
    model = several_roots(np.random.default_rng(seed)) if root == "several" else tree(seed, root)
    assert suits_one_frame(model)
    kernel = kernels.kernel(model, name)
    assert kernel.function.columns is not None
    arrays = state(model, len(kernel.function.inputs), seed)
    if jit.target().register_bytes >= 32:
        assert "one.0.0" in kernel.ir() or "head.0.0" in kernel.ir()
    for got, expected in zip(outputs(kernel(*arrays)), by_definition(model, name, arrays), strict=True):
        np.testing.assert_allclose(got, expected, rtol=1e-8, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("name", FORMS)
def test_float32_is_precise(name):
    model = tree(6)
    kernel = kernels.kernel(model, name, dtype=np.float32)
    arrays = [x.astype(np.float32) for x in state(model, len(kernel.function.inputs), 6)]
    expected = by_definition(model, name, [x.astype(float) for x in arrays])
    for got, right in zip(outputs(kernel(*arrays)), expected, strict=True):
        assert np.abs(got - right).max() < 1e-4 * np.abs(right).max()


@pytest.mark.parametrize("register_bytes", [32, 64])
@pytest.mark.parametrize("name", FORMS)
def test_all_widths_of_registers(name, register_bytes):
    """LLVM divides what is wider than the registers of this machine."""
    model = tree(7)
    f = kernels.kernel(model, name).function
    ir = emit_single(f, replace(jit.target(), register_bytes=register_bytes))
    ir = ir.replace("define internal void @one(", "define void @one(")
    code = jit.load_text(ir, ("one",), has_loops=False)
    arrays = state(model, len(f.inputs), 7)
    results = [np.full(port.shape, np.nan) for port in f.outputs]
    pointers = [ctypes.c_void_p(x.ctypes.data) for x in (*arrays, *results)]
    ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * len(pointers))(code.address("one"))(*pointers)
    for got, expected in zip(results, by_definition(model, name, arrays), strict=True):
        np.testing.assert_allclose(got, expected, rtol=1e-8, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("at_end", [False, True])
@pytest.mark.parametrize("name", FORMS)
def test_nothing_beside_the_arrays_is_touched(name, at_end):
    """The arrays begin or end at a page without access."""
    model = tree(8)
    kernel = kernels.kernel(model, name)
    arrays = state(model, len(kernel.function.inputs), 8)
    expected: Any = outputs(kernel(*arrays))

    def apart(shape: Any) -> np.ndarray:
        return fenced(int(np.prod(shape)), float, at_end).reshape(shape)

    inputs = [apart(x.shape) for x in arrays]
    for target, x in zip(inputs, arrays, strict=True):
        target[...] = x
    out = tuple(apart(x.shape) for x in expected)
    kernel(*inputs, out=out if len(out) > 1 else next(iter(out)))
    for got, wanted in zip(out, expected, strict=True):
        np.testing.assert_array_equal(got, wanted)


def for_batches(model: Model, name: str) -> Any:
    """The function, whose batches are computed in stages, too."""
    f = kernels.kernel(model, name).function
    form = replace(f.columns, serves_batches=True)
    return DeferredFunction(name, "", form, partial(kernels.function, model, name))


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("name", sorted(FORMS.keys() - WITH_PRODUCTS))
@pytest.mark.parametrize(("seed", "root"), [(1, "free_flyer"), (2, None)])
def test_batches_in_stages_equal_single_calls(name, seed, root, dtype):
    model = tree(seed, root)
    kernel = compile(for_batches(model, name), dtype)
    samples = [state(model, len(kernel.function.inputs), seed) for seed in range(11)]
    arrays = [np.stack(column).astype(dtype) for column in zip(*samples, strict=True)]
    if jit.target().register_bytes >= 32:
        assert "@samples.read" in kernel.ir(batch=True)
    results, tolerance = outputs(kernel(*arrays)), 1e-9 if dtype is np.float64 else 1e-3
    for k in range(len(samples)):
        expected = outputs(compile(for_batches(model, name))(*(array[k].astype(float) for array in arrays)))
        for got, right in zip(results, expected, strict=True):
            assert np.abs(got[k] - right).max() < tolerance * np.abs(right).max()


@pytest.mark.parametrize("register_bytes", [32, 64])
@pytest.mark.parametrize("name", FORMS)
def test_batches_in_all_widths_of_registers(name, register_bytes):
    """Arrays begin and end at pages without access."""
    model, count = tree(7), 13
    f = for_batches(model, name)
    ir = emit_batch(f, replace(jit.target(), register_bytes=register_bytes))
    code = jit.load_text(ir, ("batch",), has_loops=False)
    samples = [state(model, len(f.inputs), seed) for seed in range(count)]
    arrays = [np.stack(column) for column in zip(*samples, strict=True)]
    for at_end in (False, True):
        ports = [port.shape for port in (*f.inputs, *f.outputs)]
        held = [fenced(int(np.prod(shape)) * count, float, at_end).reshape(count, *shape) for shape in ports]
        for place, array in zip(held, arrays, strict=False):
            place[...] = array
        called(code.address("batch"), held, count)
        for k in (0, count - 1):
            for got, right in zip(held[len(arrays) :], by_definition(model, name, samples[k]), strict=True):
                np.testing.assert_allclose(got[k], right, rtol=1e-8, atol=1e-11 * np.abs(right).max())


def called(address: int, arrays: list[np.ndarray], count: int) -> None:
    """Calls NumPy's inner loop of a generalised ufunc."""
    strides = [x.strides[0] for x in arrays] + [step for x in arrays for step in x.strides[1:]]
    pointers = (ctypes.c_void_p * len(arrays))(*(x.ctypes.data for x in arrays))
    loop = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 4)(address)
    loop(
        ctypes.cast(pointers, ctypes.c_void_p),
        ctypes.cast((ctypes.c_int64 * 1)(count), ctypes.c_void_p),
        ctypes.cast((ctypes.c_int64 * len(strides))(*strides), ctypes.c_void_p),
        None,
    )


def test_batches_of_derivatives_do_not_need_the_graph():
    """It takes LLVM four times as long."""
    model = tree(12)
    kernel = kernels.kernel(model, "forward_dynamics_derivatives")
    kernel(*(np.stack([x, x]) for x in state(model, 3)))
    if jit.target().register_bytes >= 32:
        assert "_traced" not in vars(kernel.function)


def test_batches_of_long_kernels_are_in_stages(monkeypatch):
    model = tree(13)
    assert not kernels.kernel(model, "coriolis_matrix").function.columns.serves_batches
    monkeypatch.setattr(kernels, "_STAGED_BATCHES_ABOVE", 1000)
    monkeypatch.setattr(kernels, "_made", weakref.WeakValueDictionary())
    assert kernels.kernel(model, "coriolis_matrix").function.columns.serves_batches


def test_trees_that_do_not_suit_take_another_form():
    rng = np.random.default_rng(0)
    spherical = random_model(rng, ["spherical"], 12, root="free_flyer", mimics=0, branching=0.5)
    mimics = random_model(rng, ["revolute"], 30, root="free_flyer", mimics=2, branching=0.5)
    for model in (spherical, mimics):
        assert not suits_one_frame(model)
        for form in FORMS.values():
            assert form(model) is None
        kernel, arrays = kernels.kernel(model, "coriolis_matrix"), state(model, 2)
        expected = algorithms.coriolis_matrix(model, *arrays)
        np.testing.assert_allclose(kernel(*arrays), expected, rtol=1e-8, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("name", ["inverse_dynamics_derivatives", "forward_dynamics_derivatives"])
@pytest.mark.parametrize(
    ("seed", "root"),
    [(1, "free_flyer"), (2, None), (3, "planar"), (4, "spherical"), (6, "several"), (7, "chain")],
)
def test_derivatives_under_external_forces_equal_the_definition(name, seed, root):
    """At links, one of them twice, at one that stands fixed where there is one, and at a frame between."""
    rng = np.random.default_rng(seed)
    if root == "chain":
        model = random_model(rng, ["revolute", "prismatic"], 25, root=None, mimics=0, branching=0.0)
    else:
        model = several_roots(rng) if root == "several" else tree(seed, root)
    links = model.link_names
    place = SE3.trans(0.1, -0.2, 0.3) @ SE3.ry(0.7)
    model = Robot(model).with_tool(links[len(links) // 2], place, "between").model
    frames = (links[-1], links[0], "between", links[-1])
    kernel = kernels.kernel(model, name, forces=frames)
    assert kernel.function.columns is not None
    samples = [[*state(model, 3, k), rng.normal(size=(4, 6))] for k in range(3)]
    batch = outputs(kernel(*(np.stack(column) for column in zip(*samples, strict=True))))
    for k, arrays in enumerate(samples):
        external = algorithms.at_joints(
            model, arrays[0], arrays[3], [model.frame(frame) for frame in frames], "local"
        )
        expected = ALGORITHMS[name](model, *arrays[:3], external)
        for got, of_batch, right in zip(kernel(*arrays), batch, expected, strict=True):
            np.testing.assert_allclose(got, right, rtol=1e-8, atol=1e-11 * np.abs(right).max())
            np.testing.assert_allclose(of_batch[k], right, rtol=1e-8, atol=1e-11 * np.abs(right).max())


@pytest.mark.parametrize("name", [*FORMS, "inverse_mass_matrix"])
@pytest.mark.parametrize(("seed", "root"), [(1, "free_flyer"), (3, "planar"), (8, "chain")])
def test_packed_matrices_are_entries_of_those_in_stages(name, seed, root):
    """Single calls and batches, without the graph; what is not stored is zero."""
    if root == "chain":
        rng = np.random.default_rng(seed)
        model = random_model(rng, ["revolute", "prismatic"], 20, root="free_flyer", mimics=0, branching=0.0)
    else:
        model = tree(seed, root)
    kernel = kernels.kernel(model, name)
    packed, patterns = kernel.packed(), outputs(kernel.pattern())
    samples = [state(model, len(kernel.function.inputs), k) for k in range(11)]
    for values, pattern, whole in zip(
        outputs(packed(*samples[0])), patterns, outputs(kernel(*samples[0])), strict=True
    ):
        np.testing.assert_array_equal(values, whole[pattern.rows, pattern.columns])
        np.testing.assert_allclose(pattern.unpack(values), whole, rtol=1e-9, atol=1e-12 * np.abs(whole).max())
    if jit.target().register_bytes >= 32:
        assert "_traced" not in vars(kernel.function) and "_traced" not in vars(packed.function)
    batch = outputs(packed(*(np.stack(column) for column in zip(*samples, strict=True))))
    copied = pickle.loads(pickle.dumps(packed))
    for k in (0, 10):
        for values, pattern, whole, again in zip(
            batch, patterns, outputs(kernel(*samples[k])), outputs(copied(*samples[k])), strict=True
        ):
            np.testing.assert_allclose(
                pattern.unpack(values[k]), whole, rtol=1e-8, atol=1e-11 * np.abs(whole).max()
            )
            np.testing.assert_array_equal(again, whole[pattern.rows, pattern.columns])


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("name", ["inverse_dynamics_derivatives", "forward_dynamics_derivatives"])
def test_packed_batches_in_stages(name, dtype):
    model = tree(5)
    whole = compile(for_batches(model, name), dtype)
    packed = whole.packed()
    if jit.target().register_bytes >= 32:
        assert "@samples.read" in packed.ir(batch=True)
    samples = [state(model, len(whole.function.inputs), seed) for seed in range(11)]
    arrays = [np.stack(column).astype(dtype) for column in zip(*samples, strict=True)]
    for values, pattern, right in zip(
        outputs(packed(*arrays)), outputs(whole.pattern()), outputs(whole(*arrays)), strict=True
    ):
        np.testing.assert_array_equal(values, right[:, pattern.rows, pattern.columns])


@pytest.mark.parametrize("name", FORMS)
@pytest.mark.parametrize(("seed", "root"), [(1, "free_flyer"), (2, None)])
def test_patterns_of_stages_have_the_entries_of_the_graph(name, seed, root):
    """And few more: those that are zero for these axes and offsets, whatever the tree."""
    f = kernels.function(tree(seed, root), name)
    for known, right in zip(outputs(f.pattern()), outputs(replace(f, columns=None).pattern()), strict=True):
        stored, needed = (set(zip(x.rows.tolist(), x.columns.tolist(), strict=True)) for x in (known, right))
        assert known.is_symmetric == right.is_symmetric
        assert needed <= stored and len(stored) - len(needed) < 0.1 * len(stored)


def test_kernels_in_stages_are_pickled():
    kernel = kernels.kernel(tree(10), "coriolis_matrix")
    copied = pickle.loads(pickle.dumps(kernel))
    arrays = state(tree(10), 2)
    np.testing.assert_array_equal(copied(*arrays), kernel(*arrays))


def test_outputs_are_written_after_all_inputs_are_read():
    """Arrays of results may be those of arguments."""
    for form in (make(tree(11)) for make in FORMS.values()):
        stages = getattr(form, "head", form).stages
        written = [any(re.fullmatch(r"o\d", name) for name in stage.writes) for stage in stages]
        read = [any(re.fullmatch(r"i\d", name) for name in getattr(stage, "reads", ())) for stage in stages]
        if not hasattr(form, "head"):  # whose outputs are local arrays
            assert not any(read[written.index(True) :])


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("name", FORMS)
def test_large_robots_take_stages_where_they_would_be_looped_over(name, dtype, monkeypatch):
    """Batches, too, and neither calls nor texts nor pickles need the graph."""
    monkeypatch.setattr(kernels, "LOOPED_ABOVE", 1000)
    model = random_model(np.random.default_rng(0), ["revolute"], 70, root=None, mimics=0, branching=0.1)
    kernel, loops = kernels.kernel(model, name, dtype), kernels.looped(model, name)
    is_in_stages = jit.target().register_bytes >= 32 and name != "forward_dynamics_derivatives"
    assert is_in_stages == ("written out" in repr(kernel)) and loops is not None
    samples = [state(model, len(kernel.function.inputs), seed) for seed in range(5)]
    arrays = [np.stack(column).astype(dtype) for column in zip(*samples, strict=True)]
    copied = pickle.loads(pickle.dumps(kernel))
    tolerance = 1e-9 if dtype is np.float64 else 1e-3
    for k, results in enumerate((outputs(copied(*arrays)), outputs(kernel(*(x[1] for x in arrays))))):
        expected = outputs(loops(*(x.astype(float) for x in arrays)))
        for got, right in zip(results, expected, strict=True):
            wanted = right[1] if k else right
            assert np.abs(got - wanted).max() < tolerance * np.abs(wanted).max()
    assert "_traced" not in vars(kernel.function)


@pytest.mark.parametrize("joints", [12, 13, 20])
def test_inverses_of_the_mass_matrix_of_trees_too_small_or_branched_for_walks(joints):
    model = tree(9, "free_flyer", joints)
    q = state(model, 1)[0]
    identity = kernels.kernel(model, "inverse_mass_matrix")(q) @ kernels.kernel(model, "mass_matrix")(q)
    np.testing.assert_allclose(identity, np.eye(model.nv), atol=1e-8)
