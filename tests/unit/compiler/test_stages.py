"""Functions in stages: tables of columns, computed a register at a time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ulna.compiler import compile, trace
from ulna.compiler.codegen import sample_stages
from ulna.compiler.codegen.module import emit_batch
from ulna.compiler.codegen.sample_columns import column_groups
from ulna.compiler.forms.stages import Beside, StagedForm, Stages
from ulna.compiler.language.function import Function
from ulna.compiler.runtime import jit
from ulna.errors import TraceError

N = 21  # columns: more than two registers, and no multiple of any
JOINTS = [0, 0, *range(1, N - 1)]
MOVERS = [[], [], *([0, 1, *range(2, k)] if k < 12 else [0, 1, *range(12, k)] for k in range(2, N))]
"""A joint of two columns that carries two chains."""
DIAGONAL = [0.5 if k % 3 else 0.0 for k in range(N)]
WEIGHTS = np.arange(2.0 * N).reshape(2, N)


def form() -> StagedForm:
    """Two matrices of pairs, from tables of which some follow from others."""
    stages = Stages("toy", N, x=(N,), y=(3,))
    stages.constant("weights", WEIGHTS)
    stages.straight(
        lambda x, y: (np.array([x * y[0], np.where(np.arange(N) < 3, 0.0, x)], dtype=object), y[1:] * y[2]),
        ("x", "y"),
        ("t", "shared"),
    )
    stages.lanes(
        lambda t, weights, shared: (np.array([t[0] * weights[1], t[1] - shared[0]]), t[:1] * shared[1]),
        ("t", "weights", "shared"),
        ("u", "w"),
    )
    stages.straight(lambda u: u + np.roll(u, 1, axis=0) * 0.0 + 1.0, ("u",), ("u",))
    stages.pairs(
        (lambda own_t, u, w: (own_t[0] * u[0], own_t[1] + w[0]), ("t",), ("u", "w")),
        (lambda own_u, t: (own_u[1] * t[0], own_u[0] - t[1]), ("u",), ("t",)),
        MOVERS,
        JOINTS,
        {"A": DIAGONAL, "B": None},
    )
    return stages.form("A", "B")


def by_numbers(x, y):
    """The same by loops."""
    t = np.array([x * y[0], np.where(np.arange(N) < 3, 0.0, x)])
    shared = y[1:] * y[2]
    u, w = np.array([t[0] * WEIGHTS[1], t[1] - shared[0]]) + 1.0, t[0] * shared[1]
    A, B = np.zeros((N, N)), np.zeros((N, N))
    for i in range(N):
        for j in range(N):
            if i in MOVERS[j] or JOINTS[i] == JOINTS[j]:
                A[i, j], B[i, j] = t[0, i] * u[0, j], t[1, i] + w[j]
            elif j in MOVERS[i]:
                A[i, j], B[i, j] = u[1, i] * t[0, j], u[0, i] - t[1, j]
        A[i, i] += DIAGONAL[i]
    return A, B


def function() -> Function:
    """The function; its graph is not used by single calls."""
    graph = trace(lambda x, y: (np.outer(x, x) * y[0], np.outer(x, x)), x=(N,), y=(3,))
    return replace(graph, columns=form())


@pytest.mark.parametrize(("dtype", "rtol"), [("float64", 1e-13), ("float32", 1e-5)])
def test_stages_compute_what_loops_do(dtype, rtol):
    if jit.target().register_bytes < 32:
        pytest.skip("registers are too narrow for stages")
    rng = np.random.default_rng(0)
    x, y = rng.normal(size=N).astype(dtype), rng.normal(size=3).astype(dtype)
    kernel = compile(function(), dtype=dtype)
    assert "@one.3.above" in kernel.ir()
    for _ in range(2):  # memory of the first call is used again
        for got, expected in zip(kernel(x, y), by_numbers(x.astype(float), y.astype(float)), strict=True):
            np.testing.assert_allclose(got, expected, rtol=rtol, atol=rtol)


def test_a_stage_that_reads_inputs_after_results_is_refused():
    stages = Stages("late", N, x=(N,))
    stages.straight(lambda x: x * 2.0, ("x",), ("twice",))
    stages.straight(lambda twice: twice + 1.0, ("twice",), ("a",))
    stages.straight(lambda x: x * 3.0, ("x",), ("b",))
    with pytest.raises(TraceError, match="reads 'x' after results"):
        stages.form("a", "b")


def test_pairs_with_other_results_are_refused():
    stages = Stages("toy", N, x=(N,))
    stages.straight(lambda x: np.array([x]), ("x",), ("t",))
    pair = (lambda own_t, t: (own_t[0] * t[0],), ("t",), ("t",))
    with pytest.raises(TraceError, match=r"'A', 'B'"):
        stages.pairs(pair, pair, MOVERS, JOINTS, {"A": None, "B": None})


def test_zeros_of_matrices_follow_from_the_tree():
    A = by_numbers(np.full(N, 0.7), np.full(3, 0.9))[0]
    np.testing.assert_array_equal(form().zeros[0], A == 0.0)


def rows_form() -> StagedForm:
    """A matrix whose rows are computed alike, from a table and from itself."""
    stages = Stages("rows", N, x=(N,))
    stages.straight(lambda x: np.outer([1.0, 2.0, 3.0], x), ("x",), ("t",))
    stages.rows(lambda t: np.concatenate([t[1:], t[:1] * 0.0]) + t, ("t",), "u")
    stages.rows(lambda u, t: u * t[0], ("u", "t"), "u")
    stages.lanes(lambda u: u * 2.0, ("u",), ("out",))
    return stages.form("out", serves_batches=True)


def rows_by_numbers(x):
    t = np.outer([1.0, 2.0, 3.0], x)
    following = np.concatenate([t[:, 1:], 0.0 * t[:, :1]], axis=1)
    return 2.0 * (following + t) * t[:, :1]


def test_rows_are_computed_alike():
    f = replace(trace(lambda x: np.outer(x[:3], x), x=(N,)), columns=rows_form())
    kernel, x = compile(f), np.random.default_rng(0).normal(size=(19, N))
    np.testing.assert_allclose(kernel(x[0]), rows_by_numbers(x[0]), rtol=1e-14)
    for got, row in zip(kernel(x), x, strict=True):
        np.testing.assert_allclose(got, rows_by_numbers(row), rtol=1e-14)


@pytest.mark.parametrize(("dtype", "rtol"), [("float64", 1e-14), ("float32", 1e-6)])
def test_matrices_side_by_side_are_one_output(dtype, rtol):
    """One from straight-line code, the others a register of columns at a time; beside them, arrays one below the other."""

    def beside():
        stages = Stages("beside", 2 * N + 3, x=(N,))
        stages.straight(lambda x: np.outer([1.0, 2.0], x), ("x",), ("t",))
        stages.straight(lambda t: t[:, :3] + 1.0, ("t",), ("few",))
        stages.lanes(lambda t: t * 3.0, ("t",), ("many",), N)
        stages.lanes(lambda t: -t, ("t",), ("more",), N)
        stages.lanes(lambda t: t * 5.0, ("t",), ("above",), N)
        stages.lanes(lambda t: t[:1], ("t",), ("below",), N)
        return stages.form(Beside(("few", "many", "more")), ("above", "below"))

    def definition(x):
        t = np.outer([1.0, 2.0], x)
        rows = [np.concatenate([t[:, :3] + 1.0, 3.0 * t, -t], axis=1), np.concatenate([5.0 * t, t[:1]])]
        return tuple(rows)

    f = replace(trace(definition, x=(N,)), columns=beside())
    assert [port.shape for port in f.columns.outputs] == [(2, 2 * N + 3), (3, N)]
    x = np.random.default_rng(0).normal(size=N).astype(dtype)
    for got, right in zip(compile(f, dtype=dtype)(x), definition(x.astype(float)), strict=True):
        np.testing.assert_allclose(got, right, rtol=rtol)


def batched() -> Function:
    """As `function`, also for batches."""
    f = function()
    return replace(f, columns=replace(form(), serves_batches=True))


@pytest.mark.parametrize(("dtype", "rtol"), [("float64", 1e-13), ("float32", 1e-5)])
@pytest.mark.parametrize("count", [1, 2, 7, 8, 16, 37])
def test_batches_have_one_sample_in_each_lane(dtype, rtol, count):
    if jit.target().register_bytes < 32:
        pytest.skip("registers are too narrow for stages")
    rng = np.random.default_rng(count)
    x, y = rng.normal(size=(count, N)).astype(dtype), rng.normal(size=(count, 3)).astype(dtype)
    kernel = compile(batched(), dtype=dtype)
    assert "@samples.3.above" in kernel.ir(batch=True)
    results = kernel(x, y)
    for k in range(count):
        expected = by_numbers(x[k].astype(float), y[k].astype(float))
        for got, right in zip(results, expected, strict=True):
            np.testing.assert_allclose(got[k], right, rtol=rtol, atol=rtol)


def test_batches_with_gaps_and_shared_arguments():
    rng = np.random.default_rng(0)
    wide, y = rng.normal(size=(23, 2 * N)), rng.normal(size=3)
    kernel, out = compile(batched()), tuple(np.full((23, N, 2 * N), np.nan) for _ in range(2))
    kernel(wide[:, ::2], y, out=tuple(array[:, :, ::2] for array in out))
    for k in range(23):
        for array, right in zip(out, by_numbers(wide[k, ::2], y), strict=True):
            np.testing.assert_allclose(array[k, :, ::2], right, rtol=1e-13, atol=1e-13)
            assert np.isnan(array[k, :, 1::2]).all()


def test_neighbours_that_are_zero_in_the_same_rows_are_one_group():
    zeros = [[False, False, True]] * 3 + [[False, True, False]] * 4 + [[True, True, True]]
    assert column_groups(zeros) == [
        (range(3), frozenset({2})),
        (range(3, 8), frozenset({1})),
    ]


def test_arrays_that_do_not_fit_on_the_stack_are_computed_sample_by_sample(monkeypatch):
    monkeypatch.setattr(sample_stages, "_MAX_MEMORY", 1000)
    text = emit_batch(batched(), replace(jit.target(), register_bytes=32))
    assert "@samples" not in text and "@one.3.above" in text
