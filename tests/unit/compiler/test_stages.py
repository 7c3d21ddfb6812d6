"""Functions in stages: tables of columns, computed a register at a time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ulna.compiler import compile, trace
from ulna.compiler.forms.stages import StagedForm, Stages
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
    stages.straight(lambda x: x * 2.0, ("x",), ("a",))
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
