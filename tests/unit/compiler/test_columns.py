"""Functions with a second form, whose body is evaluated for all columns of a register at once."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from support.fenced import fenced
from support.random_models import random_model
from ulna import kernels
from ulna.algorithms.dynamics.mass_matrix_factors import Factors, elimination_paths
from ulna.compiler import Function, compile, trace
from ulna.compiler.codegen.arithmetic import Arithmetic
from ulna.compiler.codegen.columns import shared_rows
from ulna.compiler.codegen.module import emit_single
from ulna.compiler.forms.columns import Columns, row_places, with_columns
from ulna.compiler.runtime import jit
from ulna.errors import TraceError
from ulna.robot import Robot

N, M = 5, 19


def _body(table, column):
    """A product with a shared number, a plain entry, a shared number alone, a constant and the same result twice."""
    x = table[0] * column[0] - column[1] / table[1]
    return np.array([x, column[2], table[2], 1.5, x])


def _matrix(a):
    """Numbers of an input and others computed from them."""
    return np.array([[a[i, j] * (1.0 if j % 2 else a[0, 0]) for j in range(M)] for i in range(N)])


def _form(a):
    return Columns([a[0, 1], 2.0 + np.sin(a[1, 1]), a[2, 2] * a[0, 3]], [_matrix(a), -2.0, a], _body, N)


def _plain(a):
    table, matrices, body, *_ = _form(a)
    unit = np.eye(N, M)
    whole = (x * unit if isinstance(x, float) else x for x in matrices)
    return tuple(np.stack([body(table, B[:, k]) for k in range(M)], axis=1) for B in whole)


def _function() -> Function:
    return with_columns(trace(_plain, a=(N, M)), _form, a=(N, M))


@pytest.fixture(scope="module")
def samples():
    return np.random.default_rng(4).normal(size=(11, N, M))


@pytest.mark.parametrize(("dtype", "rtol"), [("float64", 1e-14), ("float32", 1e-5)])
def test_single_calls_equal_the_graph_and_batches(samples, dtype, rtol):
    kernel = compile(_function(), dtype=dtype)
    expected = _plain(samples[0])
    inputs = samples.astype(dtype)
    batch = kernel(inputs)
    for k in range(3):
        np.testing.assert_allclose(kernel(inputs[0])[k], expected[k], rtol=rtol, atol=rtol)
        np.testing.assert_allclose(kernel.function(samples)[k][0], expected[k], rtol=1e-14)
        stack = [kernel(x)[k] for x in inputs]
        np.testing.assert_allclose(batch[k], stack, rtol=rtol, atol=rtol)


def test_outputs_may_be_inputs(samples):
    kernel = compile(_function())
    a, expected = samples[3].copy(), kernel(samples[3])
    others = np.empty((N, M)), np.empty((N, M))
    kernel(a, out=(a, *others))
    for got, wanted in zip((a, *others), expected, strict=True):
        np.testing.assert_array_equal(got, wanted)


@pytest.mark.parametrize("at_end", [False, True])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_nothing_beside_the_arrays_is_touched(samples, dtype, at_end):
    """The arrays begin or end at a page without access."""
    kernel = compile(_function(), dtype=dtype)
    arrays = [fenced(N * M, dtype, at_end).reshape(N, M) for _ in range(4)]
    arrays[0][...] = samples[2]
    kernel(arrays[0], out=tuple(arrays[1:]))
    for got, wanted in zip(arrays[1:], kernel(samples[2].astype(dtype)), strict=True):
        np.testing.assert_array_equal(got, wanted)


def test_a_pickled_kernel_gives_the_same_bits(samples):
    kernel = compile(_function())
    copied = pickle.loads(pickle.dumps(kernel))
    assert copied.function.columns is not None
    for got, wanted in zip(copied(samples[1]), kernel(samples[1]), strict=True):
        np.testing.assert_array_equal(got, wanted)


@pytest.mark.parametrize("is_deferred", [False, True])
@pytest.mark.parametrize("name", ["inverse_mass_matrix", "forward_dynamics_derivatives"])
def test_derivatives_have_no_columns(name, is_deferred):
    """A derivative once took the form of columns of its function: wrong numbers, and writes beside the arrays."""
    kinds = ["revolute", "revolute", "prismatic"]
    robot = Robot(
        random_model(np.random.default_rng(2), kinds, 7, root="free_flyer", mimics=0, branching=0.5)
    )
    function = robot.kernel(name).function if is_deferred else robot.function(name)
    assert function.columns is not None
    arguments = [robot.random_configuration(seed=1), *np.random.default_rng(2).normal(size=(2, robot.nv))]
    arguments = arguments[: len(function.inputs)]
    seeds = [np.random.default_rng(3).normal(size=x.shape) for x in arguments]
    derivative = function.jvp()
    assert derivative.columns is None
    expected = derivative(*arguments, *seeds)
    values = compile(derivative)(*arguments, *seeds)
    values, expected = (x if isinstance(x, tuple) else (x,) for x in (values, expected))
    for value, right in zip(values, expected, strict=True):
        np.testing.assert_allclose(value, right, rtol=1e-9, atol=1e-9 * np.abs(right).max())
    for other in (function.vjp(), function.jacobian()):
        assert other.columns is None


def test_narrow_registers_take_the_graph():
    f, target = _function(), jit.target()
    wide = replace(target, register_bytes=32, arithmetic=Arithmetic())
    assert "@column0(" in emit_single(f, wide)
    assert "@column0(" not in emit_single(f, replace(wide, register_bytes=16))


def test_rows_shorter_than_a_register_take_narrower_ones():
    f, target = _function(), replace(jit.target(), arithmetic=Arithmetic())
    shortened = emit_single(f, replace(target, register_bytes=256))
    assert shortened == emit_single(f, replace(target, register_bytes=128))
    assert f"<{M} x double>" not in shortened and "load <16 x double>" in shortened


@pytest.mark.parametrize("width", [3, 4, 5, 7])
def test_forms_of_few_columns_equal_the_graph(width):
    rng = np.random.default_rng(width)

    def plain(a):
        table = a[0, 1], 2.0 + np.sin(a[1, 1]), a[2, 2] * a[0, 0]
        return np.stack([_body(table, a[:, k]) for k in range(width)], axis=1)

    def form(a):
        return Columns([a[0, 1], 2.0 + np.sin(a[1, 1]), a[2, 2] * a[0, 0]], [a], _body, N)

    f = with_columns(trace(plain, a=(N, width)), form, a=(N, width))
    kernel, a = compile(f), rng.normal(size=(9, N, width))
    if jit.target().register_bytes >= 32:
        assert ("@column0(" in kernel.ir()) == (width >= 4)
    for x in a:
        np.testing.assert_allclose(kernel(x), plain(x), rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(kernel(a), [plain(x) for x in a], rtol=1e-13, atol=1e-13)


def test_a_form_with_other_results_is_refused():
    f = trace(_plain, a=(N, M))
    with pytest.raises(TraceError, match="3 outputs"):
        with_columns(f, lambda a: Columns([a[0, 0]], [a], lambda t, c: c * t[0], N), a=(N, M))


def _paths():
    """Of a tree with a branch whose rows are longer than one register."""
    parents = [-1, *range(9), 4, 10, 10, 0, 13, 13, 2]
    paths = []
    for k, parent in enumerate(parents):
        paths.append([*paths[parent], parent] if parent >= 0 else [])
        assert all(i < k for i in paths[k])
    return paths


def _factored(a):
    """The rows of a matrix, the entries of an input with a heavy diagonal, and a body that solves with its factors."""
    paths = _paths()
    places, size = row_places(paths)
    table = [0.0] * size
    for k, path in enumerate(paths):
        table[places[k] : places[k] + len(path) + 1] = [*(a[k, j] for j in path), 20.0 + a[k, k]]

    def body(table, column):
        lower = [{j: table[places[k] + n] for n, j in enumerate(path)} for k, path in enumerate(paths)]
        return np.array(Factors.of(lower, table[size:]).solve(list(column)), dtype=object)

    return Columns(table, [a, -1.0], body, len(a), paths)


def _solved(a):
    paths, n = _paths(), len(a)
    M = np.full((n, n), 0.0, dtype=object)
    for k, path in enumerate(paths):
        M[k, k] = 20.0 + a[k, k]
        for j in path:
            M[k, j] = M[j, k] = a[k, j]
    factors = Factors(M)
    columns = [factors.solve(list(a[:, k])) for k in range(n)]
    return np.array(columns).T, -factors.inverse()


@pytest.mark.parametrize(("dtype", "rtol"), [("float64", 1e-14), ("float32", 1e-5)])
def test_a_matrix_is_factored_by_rows(dtype, rtol):
    n = len(_paths())
    f = with_columns(trace(_solved, a=(n, n)), _factored, a=(n, n))
    kernel, a = compile(f, dtype=dtype), np.random.default_rng(8).normal(size=(n, n))
    assert "@factors(" in kernel.ir() or jit.target().register_bytes < 32
    for got, expected in zip(kernel(a.astype(dtype)), f(a), strict=True):
        np.testing.assert_allclose(got, expected, rtol=rtol, atol=rtol)


def test_paths_of_a_tree_begin_with_those_of_their_ancestors():
    M = np.eye(6) * 9.0
    for i, j in ((1, 0), (3, 1), (4, 0), (4, 2), (5, 2)):  # 4 couples 0 and 2
        M[i, j] = M[j, i] = 1.0
    assert elimination_paths(M) == [[], [0], [0], [0, 1], [0, 2], [0, 2]]


@pytest.mark.parametrize(
    ("name", "parameters"), [("inverse_mass_matrix", ("armature",)), ("forward_dynamics_derivatives", ())]
)
def test_matrices_of_a_tree_equal_the_interpreted_graph(name, parameters):
    kinds = ["revolute", "revolute", "prismatic"]
    model = random_model(np.random.default_rng(2), kinds, 7, root="free_flyer", mimics=1, branching=0.5)
    kernel = kernels.kernel(model, name, parameters=parameters)
    assert kernel.function.columns is not None
    rng = np.random.default_rng(1)
    sizes = [port.shape for port in kernel.function.inputs]
    q = Robot(model).random_configuration(seed=3)
    arrays = [q if shape == q.shape else rng.uniform(0.1, 1.0, shape) for shape in sizes]
    expected, got = kernel.function(*arrays), kernel(*arrays)
    pairs = zip(expected, got, strict=True) if isinstance(got, tuple) else [(expected, got)]
    for a, b in pairs:
        np.testing.assert_allclose(b, a, atol=1e-12 * abs(a).max(), rtol=1e-9)


def test_single_calls_do_not_trace_the_graph():
    """It is traced when a batch, a pickle or the interpreter needs it, and is that of `kernels.function`."""
    model = random_model(np.random.default_rng(3), ["revolute"], 7, root="free_flyer", mimics=0)
    kernel, q = kernels.kernel(model, "inverse_mass_matrix"), Robot(model).random_configuration((3,), seed=0)
    singles = [kernel(x) for x in q]
    if jit.target().register_bytes >= 32:
        assert "_traced" not in vars(kernel.function)
    np.testing.assert_allclose(kernel(q), singles, atol=1e-12 * np.abs(singles).max())
    plain = kernels.function(model, "inverse_mass_matrix")
    assert kernel.function.fingerprint == plain.fingerprint
    assert (kernel.function.signature, kernel.operations) == (plain.signature, plain.operations)
    copied = pickle.loads(pickle.dumps(kernel))
    assert copied.function.fingerprint == plain.fingerprint
    np.testing.assert_array_equal(copied(q[0]), singles[0])
    assert copied.__doc__ == kernel.__doc__


def test_batches_sample_by_sample_share_the_code_of_single_calls(samples, monkeypatch):
    """It would be compiled twice, which takes as long again."""

    def form(a):
        return _form(a)._replace(serves_batches=True)

    loaded, load = [], jit.load
    monkeypatch.setattr(jit, "load", lambda f, ir, names: loaded.append(names) or load(f, ir, names))
    kernel = compile(with_columns(trace(_plain, a=(N, M)), form, a=(N, M)))
    wide = np.repeat(samples[..., None], 2, axis=-1)
    for batch in (samples, wide[..., 0]):
        results = kernel(batch)
        for k, sample in enumerate(samples):
            for got, expected in zip(results, kernel(sample), strict=True):
                np.testing.assert_array_equal(got[k], expected)
    if jit.target().register_bytes >= 32:
        assert loaded == [("entry", "work", "batch")]
    copied = pickle.loads(pickle.dumps(kernel))
    np.testing.assert_array_equal(copied(samples)[0], kernel(samples)[0])


def _chain(table, column):
    """The more of the first entries are zero, the fewer operations it has: 10 products and 9 sums."""
    total = 0.0
    for entry in column:
        total = total + table[0] * entry
    return np.array([total])


def test_columns_share_code_where_it_has_few_more_operations():
    body = trace(_chain, table=(1,), column=(10,))
    sets = [frozenset(range(k)) for k in (0, 1, 4, 5)]  # 19, 17, 11 and 9 operations
    assert shared_rows(body, sets, 1.0) == {rows: rows for rows in sets}
    assert shared_rows(body, sets, 1.3) == dict(zip(sets, [sets[0], sets[0], sets[2], sets[2]], strict=True))
    assert set(shared_rows(body, sets, 3.0).values()) == {frozenset()}
    apart = [frozenset({0}), frozenset({1})]  # what both leave out is nothing
    assert shared_rows(body, apart, 1.2) == dict.fromkeys(apart, frozenset())


def test_humanoids_have_few_bodies_of_columns():
    """Each of them is some thousand operations of a robot's factors."""
    model = random_model(
        np.random.default_rng(3), ("revolute",), 30, root="free_flyer", mimics=0, branching=0.5
    )
    kernel = kernels.kernel(model, "inverse_mass_matrix")
    if jit.target().register_bytes >= 32:
        assert 1 <= kernel.ir().count("define internal void @column") <= 5
    q = Robot(model).random_configuration(seed=0)
    mass = kernels.kernel(model, "mass_matrix")(q)
    np.testing.assert_allclose(kernel(q) @ mass, np.eye(model.nv), atol=1e-8)
